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


def buckle_shell(
    boom: Boom,
    meshes: Sequence[PlatedMesh],
    state: ShellState | None,
    options: ShellOptions,
    count: int,
    comm: MPI.Comm,
) -> list[WallBuckling]:
    """Return the buckling of the walls of each segment of a shell in a static state. Collective.

    Args:
        boom: boom with the contacts of the shell.
        meshes: meshes of the segments, on rank 0; empty elsewhere.
        state: the static state, on rank 0; None without an equilibrium.
        options: options of the shell.
        count: number of modes of each segment.
        comm: the ranks that share the work; all but rank 0 get no results.

    Raises:
        NumericsError: there is no static state, or the modes of a segment cannot be computed.
    """
    from protractile.shell_model.buckling import buckle_segments

    state = comm.bcast(state)
    if state is None:
        raise NumericsError("the boom has no static state in which its walls could buckle")
    of_segments: Sequence[PlatedMesh | None] = meshes or [None] * len(boom.segments)
    results = buckle_segments(boom, of_segments, state, options, count, comm)
    names = [segment.name for segment in boom.segments]
    found = zip(names, results, strict=True) if comm.rank == 0 else ()
    return [with_locations(name, result) for name, result in found]


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
