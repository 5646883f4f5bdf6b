# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling of the walls of a shell in a static state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from protractile.analysis.equilibria import equilibria, extended_equilibria, instants
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.boom import Boom
from protractile.geometry.telescoping import travel

# Relative difference below which two displacements of a mode count as equal.
_MIRRORED = 1.0e-3

if TYPE_CHECKING:
    import xarray as xr
    from mpi4py import MPI

    from protractile.geometry.plating import PlatedMesh
    from protractile.shell_model.boom_shell import ShellOptions
    from protractile.shell_model.buckling import SegmentBuckling, ShellState


@dataclass(frozen=True, slots=True)
class WallBuckling:
    """Lowest buckling factors of the walls of a segment of a shell."""

    segment: str  #: name of the segment
    #: buckling factors of all loads, ascending; empty if no wall is in compression
    factors: list[float]
    mesh_errors: list[float]  #: estimated relative discretisation error of each factor
    walls: list[str]  #: wall with the largest displacement in each mode
    x: list[float]  #: position of this displacement in m


@dataclass(frozen=True, slots=True)
class BuckledShell:
    """Buckling of the segments of a shell."""

    segments: list[WallBuckling]  #: buckling factors of each segment
    #: first mode of each segment with a factor: mesh points ``buckling_points`` in m, displacements
    #: ``buckling_shape`` (buckling_point, component) with a maximum of about 1 in each segment,
    #: ``buckling_triangles`` (buckling_triangle, corner) with segment index ``buckling_segment``,
    #: and ``buckling_factor`` (buckled). None if no segment has a factor.
    shapes: xr.Dataset | None


def buckle_shell(
    boom: Boom,
    meshes: Sequence[PlatedMesh],
    state: ShellState | None,
    options: ShellOptions,
    count: int,
    comm: MPI.Comm,
) -> BuckledShell | None:
    """Return the buckling of a shell's walls in a static state, on rank 0. Collective.

    Args:
        boom: boom with the contacts of the shell.
        meshes: meshes of the segments, on rank 0; empty elsewhere.
        state: the static state, on rank 0; None without an equilibrium.
        options: options of the shell.
        count: number of modes of each segment.
        comm: the ranks that share the work.

    Raises:
        NumericsError: there is no static state, or the modes of a segment cannot be computed.
    """
    from protractile.shell_model.buckling import buckle_segments

    state = comm.bcast(state)
    if state is None:
        raise NumericsError("the boom has no static state in which its walls could buckle")
    of_segments: Sequence[PlatedMesh | None] = meshes or [None] * len(boom.segments)
    results = buckle_segments(boom, of_segments, state, options, count, comm)
    if comm.rank != 0:
        return None
    names = [segment.name for segment in boom.segments]
    segments = [with_locations(name, result) for name, result in zip(names, results, strict=True)]
    return BuckledShell(segments, _first_shapes(results))


def farthest_state(
    boom: Boom, system: GapSystem, fields: xr.Dataset, duration: float
) -> ShellState | None:
    """Return the static state with the largest tip deflection, None without an equilibrium.

    In space, the tip deflection is the resultant of both directions.

    Args:
        boom: boom with the contacts of the shell.
        system: gap system of the shell, whose ``load`` includes all constant loads.
        fields: fields of the reduced shell.
        duration: duration of the motion in s.
    """
    from protractile.shell_model.buckling import ShellState

    rests = equilibria(system, instants(system, duration))
    rests |= extended_equilibria(system, duration)
    if not rests:
        return None
    names = [name for name in ("tip", "tip_lateral") if name in system.observers]
    tips = np.array([system.observers[name].row for name in names])
    time = max(rests, key=lambda time: float(np.linalg.norm(tips @ rests[time])))
    distances = [travel(boom, number, time) for number in range(len(boom.segments))]
    extensions = {
        number: distances[joint.inner] - distances[joint.outer]
        for number, joint in enumerate(boom.joints)
    }
    return ShellState.from_fields(fields, system.at_time(time), rests[time], extensions)


def with_locations(name: str, buckling: SegmentBuckling) -> WallBuckling:
    """Return the buckling factors of a segment, and where each mode displaces most."""
    mesh, shapes = buckling.mesh, buckling.shapes
    assert mesh is not None
    assert shapes is not None
    walls, places = [], []
    for shape in shapes:
        # Mirror images have equal displacements up to round-off; take the first one.
        sizes = np.linalg.norm(shape, axis=1)
        point = int(np.argmax(sizes > (1.0 - _MIRRORED) * sizes.max()))
        # A point on a fold belongs to two walls.
        wall = int(mesh.walls[(mesh.triangles == point).any(axis=1)].min())
        walls.append(mesh.plates[wall] if wall < len(mesh.plates) else "diaphragm")
        places.append(float(mesh.points[point, 0]))
    return WallBuckling(
        name, buckling.factors.tolist(), buckling.mesh_errors.tolist(), walls, places
    )


def _first_shapes(results: Sequence[SegmentBuckling]) -> xr.Dataset | None:
    """Return the first mode of each segment with a factor, as in :class:`BuckledShell`."""
    buckled = [
        (number, result.mesh, result.shapes[0], result.factors[0])
        for number, result in enumerate(results)
        if result.factors.size and result.mesh is not None and result.shapes is not None
    ]
    if not buckled:
        return None
    import xarray as xr

    numbers, meshes, shapes, factors = zip(*buckled, strict=True)
    begins = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])[:-1]
    triangles = [mesh.triangles + begin for mesh, begin in zip(meshes, begins, strict=True)]
    owner = np.repeat(numbers, [len(of_segment) for of_segment in triangles])
    at_points, of_triangles = ("buckling_point", "component"), "buckling_triangle"
    return xr.Dataset(
        {
            "buckling_points": (at_points, np.concatenate([mesh.points for mesh in meshes])),
            "buckling_shape": (at_points, np.concatenate(shapes).astype(np.float32)),
            "buckling_triangles": (
                (of_triangles, "corner"),
                np.concatenate(triangles).astype(np.int32),
            ),
            "buckling_segment": (of_triangles, owner.astype(np.int32)),
            "buckling_factor": ("buckled", list(factors)),
        },
        coords={"buckled": np.array(numbers, dtype=np.int32)},
    )
