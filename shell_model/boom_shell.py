# SPDX-License-Identifier: LGPL-3.0-or-later
"""The boom as shells that touch at its stations: from plates to a gap system.

At a station the inner segment's top flange may press up against the outer one's, its bottom
flange down. Which side is which comes from the joint, never from a facet's normal, whose
direction a mesh does not promise. Each flange touches in points whose weights sum to one, so
that a uniform approach gives the paper's law (4) exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr
from mpi4py import MPI

from dynamics.contact import PowerContact
from dynamics.gap_system import GapSystem, Observer
from geometry.boom import Boom, BoomError, Joint
from geometry.mesh import SegmentMesh, mesh_segment
from geometry.section import BoxSection
from shell_model.fields import gather_fields
from shell_model.outline import Outline, Row
from shell_model.reduction import KrylovOptions, ReducedSegment, reduce_segment
from shell_model.segment_shell import SegmentShell, assemble_segment

Array = npt.NDArray[np.float64]
ContactLine = Literal["near webs", "across"]


@dataclass(frozen=True, slots=True)
class ShellOptions:
    """How a boom becomes shells.

    Args:
        mesh_size: target edge length in m.
        contact_line: ``near webs`` passes the force from the inner segment's webs to the outer
            one's, as pads in the corners do; ``across`` spreads it over the width of the
            inner segment's flanges, which then bow.
        krylov: the reduction.
        mesh_folder: where gmsh's files ``SEGMENT.msh`` go, if anywhere.
    """

    mesh_size: float = 0.1
    contact_line: ContactLine = "near webs"
    krylov: KrylovOptions = field(default_factory=KrylovOptions)
    mesh_folder: Path | None = None


@dataclass(frozen=True, slots=True)
class ReducedShell:
    """A gap system and what it cost to get there.

    Args:
        system: of all segments.
        num_dofs: of the shells before the reduction.
        fields: displacement of every mesh vertex for each mode, on rank 0 (see ``fields``).
        errors: measured reduction errors, the worst over the segments: ``contact_compliance``
            relative, and ``frequency_limit_in_hz`` up to which each mode is right in itself.
        seconds: wall time of each stage.
        meshes: of the segments, on rank 0.
    """

    system: GapSystem
    num_dofs: int
    fields: xr.Dataset | None
    errors: dict[str, float]
    seconds: dict[str, float]
    meshes: Sequence[SegmentMesh]


class _Contact(NamedTuple):
    """One row of a joint: the segments' flange deflections at one station, and their law."""

    station: int
    inner: Row
    outer: Row
    law: PowerContact
    joint: Joint


def reduce_boom(
    boom: Boom,
    laws: Sequence[PowerContact],
    options: ShellOptions,
    comm: MPI.Comm,
    progress: Callable[[str, float], None] | None = None,
) -> ReducedShell:
    """Mesh, assemble and reduce every segment. Collective.

    Args:
        boom: all its segments with box sections.
        laws: one for each joint.
        options: mesh, contact points, reduction.
        comm: the ranks that share the work; the result is the same on each.
        progress: called with the stage and the part of it that is done.

    Raises:
        BoomError: a segment has no box section.
    """
    seconds = dict.fromkeys(("mesh", "assembly", "reduction"), 0.0)
    shells: list[SegmentShell] = []
    meshes: list[SegmentMesh] = []
    tell = progress or (lambda stage, part: None)
    for number in range(len(boom.segments)):
        start = perf_counter()
        mesh = _mesh(boom, number, options) if comm.rank == 0 else None
        if mesh is not None:
            meshes.append(mesh)
        seconds["mesh"] += perf_counter() - start
        tell("mesh", (number + 1) / len(boom.segments))
        start = perf_counter()
        shells.append(assemble_segment(comm, boom.segments[number], mesh))
        seconds["assembly"] += perf_counter() - start
        tell("assembly", (number + 1) / len(boom.segments))

    start = perf_counter()
    contacts = _contacts(boom, shells, laws, options.contact_line)
    reduced = []
    for number, shell in enumerate(shells):
        pushes = [
            shell.row(contact.inner if number == contact.joint.inner else contact.outer)
            for contact in contacts
            if number in (contact.joint.inner, contact.joint.outer)
        ]
        report = partial(_report_part, tell, number, len(shells))
        inputs = np.column_stack([*pushes, shell.load])
        reduced.append(reduce_segment(shell, inputs, options.krylov, report))
    system = _gap_system(boom, shells, reduced, contacts)
    seconds["reduction"] = perf_counter() - start
    return ReducedShell(
        system=system,
        num_dofs=sum(shell.num_dofs for shell in shells),
        fields=gather_fields(comm, shells, reduced, meshes),
        errors={
            "contact_compliance": max(r.compliance_error for r in reduced),
            "frequency_limit_in_hz": min(r.frequency_limit for r in reduced),
        },
        seconds=seconds,
        meshes=meshes,
    )


def _report_part(tell: Callable[[str, float], None], number: int, count: int, part: float) -> None:
    tell("reduction", (number + part) / count)


def _mesh(boom: Boom, number: int, options: ShellOptions) -> SegmentMesh:
    segment = boom.segments[number]
    if segment.section is None:
        raise BoomError(
            f"segment[{number + 1}]",
            f"{segment.name!r} has no box section, which a shell needs; give height_to_width or "
            "section",
        )
    breaks = {"start": segment.start, "end": segment.end}
    breaks |= {f"support-{k}": x for k, x in enumerate(sorted(segment.supports), start=1)}
    breaks |= {f"station-{k}": x for k, x in enumerate(boom.stations_of(number), start=1)}
    folder = options.mesh_folder
    return mesh_segment(
        segment.section,
        breaks,
        options.mesh_size,
        msh=None if folder is None else folder / f"{segment.name}.msh",
    )


class ContactPoint(NamedTuple):
    """A mirrored pair of points on facing flanges, with the part of the force it carries.

    ``inner`` and ``outer`` are the distances in m from the middle of each flange.
    """

    inner: float
    outer: float
    weight: float


def contact_points(line: ContactLine, inner: BoxSection, outer: BoxSection) -> list[ContactPoint]:
    """Where facing flanges touch; the weights sum to one.

    Args:
        line: see :class:`ShellOptions`. Across the width, Gauss's rule with eight points.
        inner, outer: the sections of the joint's segments.
    """
    if line == "near webs":
        return [ContactPoint(0.5 * inner.width, 0.5 * outer.width, 1.0)]
    nodes, weights = np.polynomial.legendre.leggauss(8)
    places = 0.5 * inner.width * nodes[nodes > 0.0]
    return [
        ContactPoint(float(y), float(y), float(w))
        for y, w in zip(places, weights[nodes > 0.0], strict=True)
    ]


def _contacts(
    boom: Boom, shells: Sequence[SegmentShell], laws: Sequence[PowerContact], line: ContactLine
) -> list[_Contact]:
    contacts = []
    station = 0
    for joint, law in zip(boom.joints, laws, strict=True):
        inner, outer = shells[joint.inner], shells[joint.outer]
        points = contact_points(line, inner.section, outer.section)
        for x in joint.stations:
            inside, around = inner.outline(x), outer.outline(x)
            for side, stiffness in ((1.0, law.stiffness), (-1.0, law.below)):
                if stiffness == 0.0:
                    continue
                one_sided = law.upper() if side > 0.0 else law.lower()
                contacts += [
                    _Contact(
                        station,
                        inside.flange_deflection(side, point.inner),
                        around.flange_deflection(side, point.outer),
                        one_sided.shared(point.weight),
                        joint,
                    )
                    for point in points
                ]
            station += 1
    return contacts


def _gap_system(
    boom: Boom,
    shells: Sequence[SegmentShell],
    reduced: Sequence[ReducedSegment],
    contacts: Sequence[_Contact],
) -> GapSystem:
    def read(number: int, row: Row) -> Array:
        """A segment's row in all modal coordinates."""
        shell = shells[number]
        parts = [np.zeros(r.omega2.size) for r in reduced]
        parts[number] = shell.comm.allreduce(shell.row(row) @ reduced[number].shapes)
        return np.concatenate(parts)

    load = [
        shell.comm.allreduce(shell.load @ r.shapes)
        for shell, r in zip(shells, reduced, strict=True)
    ]
    return GapSystem(
        omega2=np.concatenate([r.omega2 for r in reduced]),
        load=np.concatenate(load),
        rows=np.array(
            [read(c.joint.inner, c.inner) - read(c.joint.outer, c.outer) for c in contacts]
        ).reshape(len(contacts), -1 if contacts else sum(r.omega2.size for r in reduced)),
        laws=[contact.law for contact in contacts],
        station_of_row=np.array([contact.station for contact in contacts], dtype=np.int64),
        stations=[x for joint in boom.joints for x in joint.stations],
        observers={
            name + suffix: Observer(read(number, row(shells[number].outline(x))), unit)
            for name, (number, x) in boom.observed().items()
            for suffix, (row, unit) in _SECTION_READINGS.items()
        },
    )


_SECTION_READINGS: Mapping[str, tuple[Callable[[Outline], Row], str]] = {
    "": (Outline.mean_deflection, "m"),
    "_rotation": (Outline.rotation, "rad"),
    "_distortion": (Outline.distortion, "m"),
}
