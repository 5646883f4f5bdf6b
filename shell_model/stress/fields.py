# SPDX-License-Identifier: LGPL-3.0-or-later
"""Displacement and stress of a reduced shell: what pictures and field files are made from."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.linalg import block_diag
from scipy.spatial import cKDTree

from dynamics.gap_system import GapSystem
from geometry.arrays import Array
from geometry.boom import Boom
from geometry.cylinder import force_name
from geometry.plating import PlatedMesh
from geometry.segment import Segment
from shell_model.reduction.coordinates import BoomCoordinates
from shell_model.reduction.segment import ReducedSegment
from shell_model.segment.segment_shell import SegmentShell
from shell_model.segment.shell import ON_LINE
from shell_model.stress.recovery import gather_stress_modes
from shell_model.stress.stresses import COMPONENTS, Modes

_Numbers = npt.NDArray[Any]
_Variable = tuple[tuple[str, ...], _Numbers, dict[str, str]]


def gather_fields(
    boom: Boom,
    shells: Sequence[SegmentShell],
    reduced: Sequence[ReducedSegment],
    coordinates: BoomCoordinates,
    system: GapSystem,
) -> xr.Dataset | None:
    """Bring the shapes and their stresses to rank 0. Collective; None elsewhere.

    Args:
        boom: whose feet hold what its cylinders push.
        shells, reduced: of its segments.
        coordinates: the system's first ones.
        system: whose observers read the cylinders' forces.

    Returns:
        ``points`` (point, component) in m, ``triangles`` (triangle, corner), ``segment`` and
        ``wall`` (triangle), ``thickness`` (triangle) in m, ``modes`` (mode, point, component) in
        1/√kg: the displacement in m is the sum of the modal coordinates times ``modes``. For
        segment k, from 1 on, ``coordinates_k`` (own_k, mode) times the modal coordinates are its
        own ones and the forces of its cylinders, and the sum of these times ``stress_k``
        (own_k, triangle_k, stress) are its stresses in Pa; ``plate_k`` names the plates that
        ``wall`` numbers. Other segments' coordinates have no stress there, so half of the numbers
        of two segments and two thirds of those of three need not be kept.
    """
    moved = [_at_vertices(shell, one.shapes) for shell, one in zip(shells, reduced, strict=True)]
    stresses = [
        gather_stress_modes(shell, one.shapes) for shell, one in zip(shells, reduced, strict=True)
    ]
    meshes = [shell.mesh for shell in shells if shell.mesh is not None]
    if not meshes:
        return None
    shapes = [one for one in moved if one is not None]
    begins = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    triangles = [mesh.triangles + begin for mesh, begin in zip(meshes, begins[:-1], strict=True)]
    numbers = np.repeat(np.arange(len(meshes)), [len(mesh.triangles) for mesh in meshes])
    # Springs that go along with pads, behind the coordinates, move nothing else.
    count = coordinates.omega2.size
    modes = np.zeros((system.num_modes, begins[-1], 3), dtype=np.float32)
    modes[:count] = coordinates.of_rows(block_diag(*shapes)).T.reshape(count, -1, 3)
    return xr.Dataset(
        {
            "points": (("point", "component"), np.concatenate([m.points for m in meshes])),
            "triangles": (("triangle", "corner"), np.concatenate(triangles).astype(np.int32)),
            "segment": ("triangle", numbers.astype(np.int32)),
            "wall": ("triangle", np.concatenate([m.walls for m in meshes]).astype(np.int32)),
            "thickness": (
                "triangle",
                np.concatenate([m.thickness for m in meshes]),
                {"units": "m"},
            ),
            **_axial_stress(boom, meshes),
            "modes": (("mode", "point", "component"), modes),
            **_own_stresses(boom, meshes, stresses, coordinates, system),
        },
        coords={
            "stress": list(COMPONENTS),
            **{f"plate_{k}": list(mesh.plates) for k, mesh in enumerate(meshes, start=1)},
        },
    )


def _at_vertices(shell: SegmentShell, shapes: Array) -> _Numbers | None:
    """(3 num_points, num_modes) displacements of a mesh's points on rank 0. Collective."""
    points = shell.comm.bcast(None if shell.mesh is None else shell.mesh.points)
    distance, vertex = cKDTree(points).query(shell.nodes)
    at_vertex = distance < ON_LINE
    first, _ = shell.owned
    rows = shell.node_dofs[at_vertex] - first
    gathered = shell.comm.gather((vertex[at_vertex], shapes[rows].astype(np.float32)))
    if gathered is None:
        return None
    moved = np.zeros((*points.shape, shapes.shape[1]), dtype=np.float32)
    for places, parts in gathered:
        moved[places] = parts
    return moved.reshape(-1, shapes.shape[1])


def _along(segment: Segment, mesh: PlatedMesh, force: Callable[[Array], Array]) -> Array:
    """(num_triangles,) the stress along x in Pa of normal forces in N at x in m.

    The plain walls carry them, and hand them on to collars.
    """
    return force(mesh.along) / segment.area * mesh.even / mesh.thickness


def _axial_stress(boom: Boom, meshes: Sequence[PlatedMesh]) -> dict[str, _Variable]:
    """Where there are axial forces."""
    if not boom.compressed:
        return {}
    stresses = [
        -_along(segment, mesh, segment.compression)
        for segment, mesh in zip(boom.segments, meshes, strict=True)
    ]
    return {"axial_stress": (("triangle",), np.concatenate(stresses), {"units": "Pa"})}


def _own_stresses(
    boom: Boom,
    meshes: Sequence[PlatedMesh],
    stresses: Sequence[Modes | None],
    coordinates: BoomCoordinates,
    system: GapSystem,
) -> dict[str, _Variable]:
    """The variables of every segment that give its stresses."""
    modes = [one for one in stresses if one is not None]
    sizes = [len(one) for one in modes]
    every = coordinates.of_rows(np.eye(sum(sizes)))
    every = np.pad(every, ((0, 0), (0, system.num_modes - every.shape[1])))
    variables: dict[str, _Variable] = {}
    for number, own in enumerate(np.split(every, np.cumsum(sizes)[:-1])):
        k, stress = number + 1, modes[number]
        for force, pushed in _pushed(boom, number, meshes[number]):
            own = np.concatenate([own, system.observers[force].row[None]])
            stress = np.concatenate([stress, pushed])
        variables[f"coordinates_{k}"] = ((f"own_{k}", "mode"), own, {})
        dims = (f"own_{k}", f"triangle_{k}", "stress")
        variables[f"stress_{k}"] = (dims, stress, {"units": "Pa"})
    return variables


def _pushed(boom: Boom, number: int, mesh: PlatedMesh) -> Iterator[tuple[str, Modes]]:
    """The force of each luffing cylinder of a segment, and (1, num_triangles, 6) stresses in Pa of
    what 1 N of it pushes along the boom.
    """
    segment = boom.segments[number]
    for k, cylinder in enumerate(boom.cylinders, start=1):
        if cylinder.segment == number:
            stress = np.zeros((1, len(mesh.triangles), len(COMPONENTS)), dtype=np.float32)
            pull = partial(cylinder.pull, foot=segment.foot)
            stress[0, :, COMPONENTS.index("membrane_x")] = _along(segment, mesh, pull)
            yield force_name(k), stress
