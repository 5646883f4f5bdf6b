# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shell model of the boom: meshes, matrices, forces and observers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
from mpi4py import MPI

from protractile.dynamics.gap_builder import GapBuilder, OutputOperator
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.contact_places import ContactLine
from protractile.geometry.grading import graded_mesh
from protractile.geometry.ground import GroundLine, ground_lines, pin_moments
from protractile.geometry.load import Load
from protractile.geometry.mesh import collar_breaks, diaphragm_breaks, mesh_segment, strip_lines
from protractile.geometry.observation import Displacement, Quantity
from protractile.geometry.plating import PlatedMesh, add_thickness, tapered_mesh
from protractile.geometry.refinement import refinement_zones
from protractile.shell_model.contact.rows import ShellContacts, ties
from protractile.shell_model.contact.surface import SurfaceOptions
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from protractile.shell_model.segment.cross_section import Operator, Row, SectionNodes
from protractile.shell_model.segment.segment_shell import SegmentShell, assemble_segment
from protractile.shell_model.stages import Stages


@dataclass(frozen=True, slots=True)
class ShellOptions:
    """Options of the shell model."""

    #: edge length in m; in a graded mesh, the length far from contacts and supports
    mesh_size: float = 0.1
    #: position of contact. With ``near webs``, forces act at the corners, like forces of slide
    #: pads; with ``across``, in a flat boom, over the width of the inner flanges, which bend; with
    #: ``surface``, contact is possible over the whole overlap.
    contact_line: ContactLine = "near webs"
    surface: SurfaceOptions = field(default_factory=SurfaceOptions)  #: options of surface contact
    krylov: KrylovOptions = field(default_factory=KrylovOptions)  #: options of the reduction
    #: permitted relative error of the local compliance at contacts, for a graded mesh
    #: (:mod:`.geometry.refinement`). Without it, and for surface contact, the mesh is uniform.
    contact_tolerance: float | None = None

    @property
    def order(self) -> float:
        """The lower bound of the order of convergence of the local compliance."""
        return 1.0 if self.contact_tolerance is None or self.contact_line == "surface" else 2.0

    @property
    def coarser(self) -> ShellOptions:
        """The options for twice the edge length, to estimate the discretisation error."""
        tolerance = self.contact_tolerance
        return replace(
            self,
            mesh_size=2.0 * self.mesh_size,
            contact_tolerance=None if tolerance is None else 4.0 * tolerance,
        )


@dataclass(frozen=True)
class BoomShell:
    """Distributed shell model of a boom with all degrees of freedom."""

    comm: MPI.Comm  #: ranks that share the model
    shells: Sequence[SegmentShell]  #: shell of each segment
    touching: ShellContacts  #: possible contacts, friction and dashpots at any extension
    rows: GapBuilder[Operator]  #: rows of contacts, friction and dashpots at t = 0
    ties: Sequence[Operator]  #: displacement operators that bonded joints constrain to zero
    #: uniform load vector (num_owned,) of each segment in N, constant from t = 0 on
    own_loads: Sequence[Array]
    #: loads with a history, and their load vectors (num_owned,)
    loads: Sequence[tuple[Load, Array]]
    observed: Mapping[str, OutputOperator[Operator]]  #: outputs of a motion
    lines: Sequence[GroundLine] = ()  #: springs and dashpots to the ground
    #: (segment, load vector) of moments of axial forces, see :func:`.geometry.axial.pin_moments`
    pin_moments: Sequence[tuple[int, Array]] = ()
    helper: Executor | None = None  #: second process for the reduction

    @cached_property
    def symmetries(self) -> Sequence[SymmetryReduction]:
        """The symmetry reductions of the segments, computed once for all solves. Collective.

        Raises:
            NumericsError: a segment is not symmetric.
        """
        return [SymmetryReduction(shell) for shell in self.shells]

    @property
    def num_dofs(self) -> int:
        """The number of degrees of freedom of all segments."""
        return sum(shell.num_dofs for shell in self.shells)

    @property
    def joint_operators(self) -> list[Operator]:
        """The displacement operators of contacts, then of friction."""
        contacts = [contact.operator for contact in self.rows.contacts]
        return contacts + [friction.operator for friction in self.rows.frictions]

    def forces(self, number: int) -> Array:
        """Return all load vectors (num_owned, num_forces) on a segment, contacts first."""
        dashpots = self.columns(
            number, [r for dashpot in self.rows.dashpots.values() for _, r in dashpot.parts]
        )
        return np.column_stack([self.joint_rows(number), dashpots, self.fixed_loads(number)])

    def fixed_loads(self, number: int) -> Array:
        """Return the load vectors (num_owned, num_loads) of loads and ground lines of a segment."""
        loads = [push for load, push in self.loads if load.segment == number]
        loads += [push for segment, push in self.pin_moments if segment == number]
        loads += [line.push for line in self.lines if line.segment == number]
        return np.column_stack([self.own_loads[number], *loads])

    def joint_rows(self, number: int) -> Array:
        """Return the rows (num_owned, num_rows) of contacts, friction and bonded joints."""
        return self.columns(number, [*self.joint_operators, *self.ties])

    def columns(self, number: int, operators: Iterable[Operator]) -> Array:
        """Return rows of operators on a segment as columns (num_owned, num_rows). Collective."""
        shell = self.shells[number]
        rows = [shell.row(operator[number]) for operator in operators if number in operator]
        return np.array(rows).reshape(-1, shell.free.size).T


def assemble_boom(
    boom: Boom,
    options: ShellOptions,
    comm: MPI.Comm,
    stages: Stages | None = None,
) -> BoomShell:
    """Return the full shells of a boom with contacts, loads and outputs. Collective.

    Args:
        boom: boom whose segments all have sections.
        options: options of mesh and contact.
        comm: ranks that share the work.

    Raises:
        BoomError: a segment has no section, or the contact line does not suit the boom.
    """
    watch = stages or Stages()
    shells = assemble_segments(boom, options, comm, watch)
    with watch.stage("rows"):
        touching = ShellContacts.from_shells(boom, shells, options.contact_line, options.surface)
        return BoomShell(
            comm=comm,
            shells=shells,
            touching=touching,
            rows=touching.rows({}),
            ties=ties(boom, shells),
            own_loads=[shell.own_load(boom.directions) for shell in shells],
            loads=[(load, load.push(shells[load.segment])) for load in boom.loads],
            observed=observers(boom, shells),
            lines=list(ground_lines(boom, shells)),
            pin_moments=list(pin_moments(boom, shells)),
        )


def assemble_segments(
    boom: Boom, options: ShellOptions, comm: MPI.Comm, stages: Stages | None = None
) -> list[SegmentShell]:
    """Return the full shells of all segments, without contacts. Collective."""
    watch = stages or Stages()
    shells, count = [], len(boom.segments)
    for number, segment in enumerate(boom.segments):
        with watch.stage("mesh", number, count):
            mesh = segment_mesh(boom, number, options) if comm.rank == 0 else None
        with watch.stage("assembly", number, count):
            shells.append(assemble_segment(comm, segment, mesh))
    return shells


def segment_mesh(boom: Boom, number: int, options: ShellOptions) -> PlatedMesh:
    """Return the mesh of a segment, with mesh lines at all contacts, loads and supports."""
    segment = boom.segments[number]
    if segment.section is None:
        raise BoomError(
            f"segments[{number}].section",
            f"{segment.name!r} has no box section, which a shell needs; give height_to_width or "
            "section",
        )
    breaks = {"start": segment.start, "end": segment.end}
    supports = sorted(support.x for support in segment.supports)
    breaks |= {f"support-{k}": x for k, x in enumerate(supports, start=1)}
    breaks |= {f"station-{k}": x for k, x in enumerate(boom.stations_of(number), start=1)}
    breaks |= {f"observed-{k}": x for k, x in enumerate(boom.observed_places(number), start=1)}
    breaks |= {f"axial-{k}": x for k, x in enumerate(segment.compression.places, start=1)}
    breaks |= {f"extension-{k}": x for k, x in enumerate(boom.moving_intervals(number), start=1)}
    breaks |= collar_breaks(segment) | diaphragm_breaks(segment)
    box = segment.widest, breaks, options.mesh_size
    closed, across = tuple(diaphragm_breaks(segment)), strip_lines(segment)
    if options.contact_tolerance is None or options.contact_line == "surface":
        mesh = mesh_segment(*box, closed=closed, across=across)
    else:
        tolerance, line = options.contact_tolerance, options.contact_line
        fine = refinement_zones(boom, number, tolerance, line)
        mesh = graded_mesh(*box, fine, closed=closed, across=across)
    plated = add_thickness(segment, mesh)
    return plated if segment.head_section is None else tapered_mesh(segment, plated)


def observers(boom: Boom, shells: Sequence[SegmentShell]) -> dict[str, OutputOperator[Operator]]:
    """Return the outputs of segment ends and observations. Collective."""
    ends: tuple[Quantity, ...] = ("deflection", "rotation", "distortion")
    if boom.spatial:
        ends += ("lateral", "twist")
    outlines: dict[tuple[int, float], SectionNodes] = {}
    observed = {}
    for place in boom.all_observations(ends):
        at = place.segment, place.x
        if at not in outlines:
            outlines[at] = shells[place.segment].outline(place.x)
        kind = place.kind
        row = _ROW_OF[kind.displacement](outlines[at])
        observed[place.name] = OutputOperator(
            Operator({place.segment: row}), kind.unit, kind.derivative
        )
    return observed


_ROW_OF: Mapping[Displacement, Callable[[SectionNodes], Row]] = {
    "deflection": SectionNodes.mean_deflection,
    "rotation": SectionNodes.rotation,
    "distortion": SectionNodes.distortion,
    "lateral": partial(SectionNodes.mean_deflection, direction="y"),
    "twist": SectionNodes.twist,
}
