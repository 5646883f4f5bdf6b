# SPDX-License-Identifier: LGPL-3.0-or-later
"""Displacement and stress of a reduced shell: what pictures and field files are made from."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.spatial import cKDTree

from dynamics.gap_system import GapSystem
from geometry.boom import Boom
from geometry.cylinder import force_name
from shell_model.reduction.segment import ReducedSegment
from shell_model.segment_shell import SegmentShell
from shell_model.shell import ON_LINE
from shell_model.stress.recovery import gather_stress_modes
from shell_model.stress.stresses import COMPONENTS, Modes

_Variable = tuple[tuple[str, ...], npt.NDArray[Any], dict[str, str]]


def gather_fields(
    shells: Sequence[SegmentShell], reduced: Sequence[ReducedSegment]
) -> xr.Dataset | None:
    """Bring the shapes and their stresses to rank 0. Collective; None elsewhere.

    Returns:
        ``points`` (point, component) in m, ``triangles`` (triangle, corner), ``segment`` and
        ``wall`` (triangle), ``thickness`` (triangle) in m, ``modes`` (mode, point, component) in
        1/√kg: the displacement in m is the sum of the modal coordinates times ``modes``. For
        segment k, from 1 on, ``coordinates_k`` (own_k, mode) times the modal coordinates are its
        own ones, and the sum of these times ``stress_k`` (own_k, triangle_k, stress) are its
        stresses in Pa; ``plate_k`` names the plates that ``wall`` numbers. Other segments'
        coordinates have no stress there, so half of the numbers of two segments and two thirds of
        those of three need not be kept.
    """
    parts = []
    stresses = []
    for shell, segment in zip(shells, reduced, strict=True):
        points = shell.comm.bcast(None if shell.mesh is None else shell.mesh.points)
        distance, vertex = cKDTree(points).query(shell.nodes)
        at_vertex = distance < ON_LINE
        first, _ = shell.owned
        rows = shell.node_dofs[at_vertex] - first
        mine = (vertex[at_vertex], segment.shapes[rows].astype(np.float32))
        gathered = shell.comm.gather(mine)
        if gathered is not None:
            modes = np.zeros((segment.omega2.size, len(points), 3), dtype=np.float32)
            for places, shapes in gathered:
                modes[:, places, :] = np.moveaxis(shapes, 2, 0)
            parts.append(modes)
        stress = gather_stress_modes(shell, segment.shapes)
        if stress is not None:
            stresses.append(stress)
    meshes = [shell.mesh for shell in shells if shell.mesh is not None]
    if not meshes:
        return None
    offsets = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    all_modes: npt.NDArray[np.float32] = np.zeros(
        (sum(len(part) for part in parts), offsets[-1], 3), dtype=np.float32
    )
    done = 0
    for part, begin, end in zip(parts, offsets[:-1], offsets[1:], strict=True):
        all_modes[done : done + len(part), begin:end] = part
        done += len(part)
    triangles = [mesh.triangles + begin for mesh, begin in zip(meshes, offsets[:-1], strict=True)]
    thickness = [shell.thickness for shell in shells if shell.thickness is not None]
    return xr.Dataset(
        {
            "points": (("point", "component"), np.concatenate([m.points for m in meshes])),
            "triangles": (("triangle", "corner"), np.concatenate(triangles).astype(np.int32)),
            "segment": (
                "triangle",
                np.repeat(
                    np.arange(len(meshes), dtype=np.int32), [len(m.triangles) for m in meshes]
                ),
            ),
            "wall": ("triangle", np.concatenate([m.walls for m in meshes]).astype(np.int32)),
            "thickness": ("triangle", np.concatenate(thickness), {"units": "m"}),
            **_axial_stress(shells),
            "modes": (("mode", "point", "component"), all_modes),
            **_own_stresses(stresses),
        },
        coords={
            "stress": list(COMPONENTS),
            **{f"plate_{k}": list(mesh.plates) for k, mesh in enumerate(meshes, start=1)},
        },
    )


def with_cylinders(
    fields: xr.Dataset, boom: Boom, shells: Sequence[SegmentShell], system: GapSystem
) -> xr.Dataset:
    """Fields with the stresses of what luffing cylinders push along the boom, on rank 0.

    Args:
        fields: of the system's coordinates.
        boom: its feet hold what is pushed.
        shells: of its segments.
        system: whose observers read the cylinders' forces.
    """
    for number, cylinder in enumerate(boom.cylinders, start=1):
        k = cylinder.segment + 1
        foot = boom.segments[cylinder.segment].foot
        pulled = shells[cylinder.segment].pulled(partial(cylinder.pull, foot=foot))
        if pulled is None:
            continue
        stress = np.zeros((1, pulled.size, len(COMPONENTS)), dtype=np.float32)
        stress[0, :, COMPONENTS.index("membrane_x")] = pulled
        row = system.observers[force_name(number)].row[None]
        grown: dict[str, Any] = {}
        for name, more in ((f"coordinates_{k}", row), (f"stress_{k}", stress)):
            own = fields[name]
            grown[name] = own.dims, np.concatenate([own.values, more]), own.attrs
        fields = fields.drop_vars(list(grown)).assign(grown)
    return fields


def _axial_stress(shells: Sequence[SegmentShell]) -> dict[str, _Variable]:
    """Where there are axial forces."""
    if not any(shell.segment.compression for shell in shells):
        return {}
    stresses = [shell.axial_stress for shell in shells]
    whole = np.concatenate([stress for stress in stresses if stress is not None])
    return {"axial_stress": (("triangle",), whole, {"units": "Pa"})}


def _own_stresses(stresses: Sequence[Modes]) -> dict[str, _Variable]:
    """The variables of every segment that give its stresses."""
    every = np.eye(sum(len(modes) for modes in stresses))
    first = np.cumsum([0, *(len(modes) for modes in stresses)])
    variables: dict[str, _Variable] = {}
    for k, modes in enumerate(stresses, start=1):
        own = every[first[k - 1] : first[k]]
        variables[f"coordinates_{k}"] = ((f"own_{k}", "mode"), own, {})
        dims = (f"own_{k}", f"triangle_{k}", "stress")
        variables[f"stress_{k}"] = (dims, modes, {"units": "Pa"})
    return variables
