# SPDX-License-Identifier: LGPL-3.0-or-later
"""The boom as shells that touch at its stations: from plates to a gap system."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np
import xarray as xr
from mpi4py import MPI

from dynamics.contact import ContactLaw
from dynamics.gap_system import GapSystem
from geometry.arrays import Array
from geometry.boom import Boom, BoomError, Direction
from geometry.contact_places import ContactLine
from geometry.grading import graded_mesh
from geometry.mesh import SegmentMesh, collar_breaks, diaphragm_breaks, mesh_segment
from geometry.spots import spots
from shell_model.contact.local_compliance import (
    compliance,
    extrapolated_error,
    full_compliance,
    local_compliance,
)
from shell_model.contact.rows import gap_rows, ties
from shell_model.contact.surface import SurfaceOptions, without_stiff_modes
from shell_model.cross_section import Outline, Reading, Row
from shell_model.reduction.coordinates import BoomCoordinates
from shell_model.reduction.segment import KrylovOptions, reduce_segment
from shell_model.segment_shell import SegmentShell, assemble_segment
from shell_model.stress.fields import gather_fields


@dataclass(frozen=True, slots=True)
class ShellOptions:
    """How a boom becomes shells.

    Args:
        mesh_size: edge length in m, of a graded mesh far from all that presses.
        contact_line: ``near webs`` passes the force from the inner segment's webs to the outer
            one's, as pads in the corners do; ``across`` spreads it over the width of the
            inner segment's flanges, which then bow, in a flat boom; ``surface`` touches over the
            whole overlap of facing walls.
        surface: its points and penalty, and its own shifts and moments of the reduction.
        krylov: the reduction.
        contact_tolerance: relative error of what gives way where something presses, which grades
            the mesh (:mod:`geometry.spots`); uniform unless given, and at a surface.
        mesh_folder: where gmsh's files ``SEGMENT.msh`` go, if anywhere.
    """

    mesh_size: float = 0.1
    contact_line: ContactLine = "near webs"
    surface: SurfaceOptions = field(default_factory=SurfaceOptions)
    krylov: KrylovOptions = field(default_factory=KrylovOptions)
    contact_tolerance: float | None = None
    mesh_folder: Path | None = None

    @property
    def order(self) -> float:
        """Of the local compliance in the edge length, at least."""
        return 1.0 if self.contact_tolerance is None or self.contact_line == "surface" else 2.0

    @property
    def coarser(self) -> ShellOptions:
        """With edges of twice the length, beside which a mesh tells its own error."""
        tolerance = self.contact_tolerance
        return replace(
            self,
            mesh_size=2.0 * self.mesh_size,
            contact_tolerance=None if tolerance is None else 4.0 * tolerance,
            mesh_folder=None,
        )


@dataclass(frozen=True, slots=True)
class ReducedShell:
    """A gap system and what it cost to get there.

    Args:
        system: of all segments.
        num_dofs: of the shells before the reduction.
        fields: displacement of every mesh vertex for each mode, on rank 0 (see ``fields``).
        errors: measured reduction errors, the worst over the segments: ``contact_compliance`` as a
            part of the local one, NaN where there is none, ``readings`` relative, and
            ``frequency_limit_in_hz`` up to which each mode is right in itself.
        local_compliance: (num_rows,) of the contacts in m/N, see
            :func:`shell_model.contact.local_compliance.local_compliance`.
        mesh_error: the largest part of the local compliance by which the mesh may be off; NaN where
            there is none.
        seconds: wall time of each stage: mesh, assembly, rows (of contacts and readings, their
            values for each coordinate), reduction, fields (of displacement and stress), mesh error.
        meshes: of the segments, on rank 0.
    """

    system: GapSystem
    num_dofs: int
    fields: xr.Dataset | None
    errors: dict[str, float]
    local_compliance: Array
    mesh_error: float
    seconds: dict[str, float]
    meshes: Sequence[SegmentMesh]


def reduce_boom(
    boom: Boom,
    laws: Sequence[ContactLaw],
    options: ShellOptions,
    comm: MPI.Comm,
    progress: Callable[[str, float], None] | None = None,
    lateral_laws: Sequence[ContactLaw] = (),
) -> ReducedShell:
    """Mesh, assemble and reduce every segment. Collective.

    Args:
        boom: all its segments with box sections.
        laws: one for each joint, along z.
        options: mesh, contact points, reduction.
        comm: the ranks that share the work; the result is the same on each.
        progress: called with the stage and the part of it that is done.
        lateral_laws: one for each joint, along y; none for a flat boom.

    Raises:
        BoomError: a segment has no box section, or the contact line does not suit the boom.
    """
    seconds = dict.fromkeys(("mesh", "assembly", "reduction"), 0.0)
    planes: Mapping[Direction, Sequence[ContactLaw]] = {"z": laws, "y": lateral_laws}
    shells: list[SegmentShell] = []
    tell = progress or (lambda stage, part: None)
    for number, segment in enumerate(boom.segments):
        start = perf_counter()
        mesh = segment_mesh(boom, number, options) if comm.rank == 0 else None
        seconds["mesh"] += perf_counter() - start
        tell("mesh", (number + 1) / len(boom.segments))
        start = perf_counter()
        shells.append(assemble_segment(comm, segment, mesh))
        seconds["assembly"] += perf_counter() - start
        tell("assembly", (number + 1) / len(boom.segments))

    start = perf_counter()
    tied = ties(boom, shells)
    rows = gap_rows(boom, shells, planes, options.contact_line, options.surface)
    own_loads = [own_load(boom, number, shell) for number, shell in enumerate(shells)]
    timed_loads = [(load, load.push(_Member(shells[load.segment]))) for load in boom.loads]
    contacts = [contact.reading for contact in rows.contacts]
    readings = contacts + [friction.reading for friction in rows.frictions] + tied
    krylov = options.krylov
    if options.contact_line == "surface":
        krylov = replace(krylov, shifts=options.surface.shifts, moments=options.surface.moments)
    observed = _observed(boom, shells)
    seconds["rows"] = perf_counter() - start
    start = perf_counter()
    reduced = []
    lost = np.zeros(len(contacts))
    for number, shell in enumerate(shells):
        joined = [shell.row(reading[number]) for reading in readings if number in reading]
        inputs = [*joined, own_loads[number]]
        inputs += [push for load, push in timed_loads if load.segment == number]
        read = [shell.row(reading[number]) for reading, _ in observed.values() if number in reading]
        read_rows = np.array(read).reshape(-1, shell.free.size).T
        report = partial(_report_part, tell, number, len(shells))
        own = reduce_segment(shell, np.column_stack(inputs), krylov, report, readings=read_rows)
        if options.contact_line == "surface" and joined:
            own = without_stiff_modes(comm, own, np.column_stack(joined))
        reduced.append(own)
        touching = [i for i, reading in enumerate(contacts) if number in reading]
        lost[touching] += own.lost_compliance[: len(touching)]
    seconds["reduction"] = perf_counter() - start
    start = perf_counter()
    coordinates = BoomCoordinates(comm, shells, reduced, tied)
    system = rows.system(
        coordinates.row,
        coordinates.omega2,
        np.sum([coordinates.push(k, load) for k, load in enumerate(own_loads)], axis=0),
        boom.stations,
        observed,
        [(coordinates.push(load.segment, push), load.history) for load, push in timed_loads],
    )
    seconds["rows"] += perf_counter() - start
    start = perf_counter()
    fields = gather_fields(shells, reduced)
    if fields is not None:
        fields = coordinates.of_fields(fields)
    seconds["fields"] = perf_counter() - start
    start = perf_counter()
    apart = BoomCoordinates(comm, shells, reduced, ())
    apart_rows = np.array([apart.row(reading) for reading in contacts])
    whole = compliance(apart.omega2, apart_rows.reshape(-1, apart.omega2.size))
    laws_of_rows, stations = system.laws, system.station_of_row.tolist()
    local = local_compliance(whole, laws_of_rows, stations)
    coarse = assemble_segments(boom, options.coarser, comm)
    same = gap_rows(boom, coarse, planes, options.contact_line, options.surface)
    coarser = local_compliance(full_compliance(coarse, same.contacts), laws_of_rows, stations)
    off = extrapolated_error(local, coarser, options.order)
    seconds["mesh error"] = perf_counter() - start
    return ReducedShell(
        system=system,
        num_dofs=sum(shell.num_dofs for shell in shells),
        fields=fields,
        errors={
            "contact_compliance": _largest(lost / local),
            "readings": max(r.reading_error for r in reduced),
            "frequency_limit_in_hz": min(r.frequency_limit for r in reduced),
        },
        local_compliance=local,
        mesh_error=_largest(off),
        seconds=seconds,
        meshes=[shell.mesh for shell in shells if shell.mesh is not None],
    )


def _report_part(tell: Callable[[str, float], None], number: int, count: int, part: float) -> None:
    tell("reduction", (number + part) / count)


def segment_mesh(boom: Boom, number: int, options: ShellOptions) -> SegmentMesh:
    """Mesh the walls of one segment, with mesh lines wherever something acts."""
    segment = boom.segments[number]
    if segment.section is None:
        raise BoomError(
            f"segment[{number + 1}]",
            f"{segment.name!r} has no box section, which a shell needs; give height_to_width or "
            "section",
        )
    breaks = {"start": segment.start, "end": segment.end}
    supports = sorted(support.x for support in segment.supports)
    breaks |= {f"support-{k}": x for k, x in enumerate(supports, start=1)}
    breaks |= {f"station-{k}": x for k, x in enumerate(boom.stations_of(number), start=1)}
    breaks |= collar_breaks(segment) | diaphragm_breaks(segment)
    box = segment.section, breaks, options.mesh_size
    closed = tuple(diaphragm_breaks(segment))
    if options.contact_tolerance is None or options.contact_line == "surface":
        mesh = mesh_segment(*box, closed=closed)
    else:
        fine = spots(boom, number, options.contact_tolerance, options.contact_line)
        mesh = graded_mesh(*box, fine, closed=closed)
    if options.mesh_folder is not None:
        mesh.write_gmsh(options.mesh_folder / f"{segment.name}.msh", closed)
    return mesh


def assemble_segments(boom: Boom, options: ShellOptions, comm: MPI.Comm) -> list[SegmentShell]:
    """The shells of all segments, not reduced. Collective."""
    shells = []
    for number, segment in enumerate(boom.segments):
        mesh = segment_mesh(boom, number, options) if comm.rank == 0 else None
        shells.append(assemble_segment(comm, segment, mesh))
    return shells


def own_load(boom: Boom, number: int, shell: SegmentShell) -> Array:
    """(num_owned,) the uniform loads of a segment that are applied at t = 0 and kept, in N."""
    segment = boom.segments[number]
    load = segment.load * shell.unit_loads["z"]
    if boom.spatial and segment.lateral is not None:
        load += segment.lateral.load * shell.unit_loads["y"]
    return load


@dataclass(frozen=True, slots=True)
class _Member:
    """A segment as loads push it, see :class:`geometry.load.Member`; (num_owned,) each.

    At one place a force is spread over the walls that carry it in their own plane, a moment over
    all of them as bending stress is.
    """

    shell: SegmentShell

    def force(self, x: float, direction: Direction) -> Array:
        return self.shell.row(self.shell.outline(x).wall_deflection(direction))

    def moment(self, x: float, direction: Direction) -> Array:
        return self.shell.row(self.shell.outline(x).rotation(direction))

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        if span is None:
            return self.shell.unit_loads[direction]
        return self.shell.load_between(direction, *span)

    def inertia(self, direction: Direction, force: float) -> Array:
        acceleration = force / self.shell.segment.mass_per_length
        whole = force * self.shell.unit_loads[direction]
        return whole + acceleration * self.shell.stiffener_loads[direction]


def _largest(parts: Array) -> float:
    """Of those that are known; NaN where none is."""
    return float(np.nanmax(parts)) if np.isfinite(parts).any() else float("nan")


def _observed(boom: Boom, shells: Sequence[SegmentShell]) -> dict[str, tuple[Reading, str]]:
    """What is reported of the boom's ends, with its unit. Collective."""
    readings = _IN_SPACE if boom.spatial else _IN_PLANE
    observed: dict[str, tuple[Reading, str]] = {}
    for name, (number, x) in boom.observed.items():
        outline = shells[number].outline(x)
        for suffix, (row, unit) in readings.items():
            observed[name + suffix] = (Reading({number: row(outline)}), unit)
    return observed


_SectionReadings = Mapping[str, tuple[Callable[[Outline], Row], str]]

_IN_PLANE: _SectionReadings = {
    "": (Outline.mean_deflection, "m"),
    "_rotation": (Outline.rotation, "rad"),
    "_distortion": (Outline.distortion, "m"),
}
_IN_SPACE: _SectionReadings = {
    **_IN_PLANE,
    "_lateral": (partial(Outline.mean_deflection, direction="y"), "m"),
    "_twist": (Outline.twist, "rad"),
}
