# SPDX-License-Identifier: LGPL-3.0-or-later
"""Displacement fields of a reduced shell: what pictures and field files are made from."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import xarray as xr
from mpi4py import MPI
from scipy.spatial import cKDTree

from geometry.mesh import SegmentMesh
from shell_model.reduction import ReducedSegment
from shell_model.segment_shell import ON_LINE, SegmentShell


def gather_fields(
    comm: MPI.Comm,
    shells: Sequence[SegmentShell],
    reduced: Sequence[ReducedSegment],
    meshes: Sequence[SegmentMesh],
) -> xr.Dataset | None:
    """Bring the shapes to rank 0, vertex by vertex. Collective; None elsewhere.

    Returns:
        ``points`` (point, component) in m, ``triangles`` (triangle, corner), ``segment``
        (triangle), ``modes`` (mode, point, component) in 1/√kg: the displacement in m is the
        sum of the modal coordinates times ``modes``.
    """
    parts = []
    for number, (shell, segment) in enumerate(zip(shells, reduced, strict=True)):
        points = comm.bcast(meshes[number].points if comm.rank == 0 else None)
        distance, vertex = cKDTree(points).query(shell.nodes)
        at_vertex = distance < ON_LINE
        first, _ = shell.owned
        rows = shell.node_dofs[at_vertex] - first
        mine = (vertex[at_vertex], segment.shapes[rows].astype(np.float32))
        gathered = comm.gather(mine)
        if gathered is not None:
            modes = np.zeros((segment.omega2.size, len(points), 3), dtype=np.float32)
            for places, shapes in gathered:
                modes[:, places, :] = np.moveaxis(shapes, 2, 0)
            parts.append(modes)
    if comm.rank != 0:
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
            "modes": (("mode", "point", "component"), all_modes),
        }
    )
