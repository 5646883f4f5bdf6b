# SPDX-License-Identifier: LGPL-3.0-or-later
"""The four families of motions of a box that mirrors itself in y and in z.

Mirrored motions stay mirrored: bending along z, bending along y, twisting, and breathing with
stretching do not know of each other within a segment. A computation that drifts from one family
into another by round-off grows the drift: the other family's low modes are what a solve enlarges
most. Held within its family, it gives the same numbers on any number of ranks.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc
from scipy.spatial import cKDTree

from dynamics.failure import NumericsError
from shell_model.products import times
from shell_model.segment_shell import ON_LINE, SegmentShell

Array = npt.NDArray[np.float64]

# What the stiffness may carry from one family into another, over its own size.
_DRIFT = 1.0e-9


class Family(NamedTuple):
    """1 where a motion is its own image in the mirror of an axis, −1 where it is its opposite."""

    y: int
    z: int


BREATHING, ALONG_Z, ALONG_Y, TWISTING = (
    Family(1, 1),
    Family(1, -1),
    Family(-1, 1),
    Family(-1, -1),
)
FAMILIES: Final = (BREATHING, ALONG_Z, ALONG_Y, TWISTING)


class Mirrors:
    """The images of a shell's motions in the planes y = 0 and z = 0. Collective.

    Raises:
        NumericsError: the shell is not its own image.
    """

    def __init__(self, shell: SegmentShell) -> None:
        self._images = [_image(shell, axis) for axis in (1, 2)]
        trial = np.sin(np.arange(*shell.owned, dtype=np.float64))[:, None] * shell.free[:, None]
        push = times(shell.stiffness, self.part(trial, TWISTING)) * shell.free[:, None]
        drift = push - self.part(push, TWISTING)
        squares = shell.comm.allreduce(np.array([(drift**2).sum(), (push**2).sum()]))
        if squares[0] > _DRIFT**2 * squares[1]:
            raise NumericsError("a segment's shell is not its own mirror image in y and in z")

    def part(self, block: Array, family: Family) -> Array:
        """(num_owned, num_columns) the part of each column that belongs to a family."""
        for image, sign in zip(self._images, family, strict=True):
            block = 0.5 * (block + sign * times(image, block))
        return block

    def destroy(self) -> None:
        for image in self._images:
            image.destroy()


def _image(shell: SegmentShell, axis: int) -> PETSc.Mat:
    """The matrix that takes a motion to its image: displacements as arrows, rotations as axes."""
    mirror = np.ones(3)
    mirror[axis] = -1.0
    first, _ = shell.owned
    partners = np.empty(shell.free.size, dtype=PETSc.IntType)
    signs = np.empty(shell.free.size)
    for nodes, dofs, sign in (
        (shell.nodes, shell.node_dofs, mirror),
        (shell.rotation_nodes, shell.rotation_dofs, -mirror),
    ):
        all_nodes = np.concatenate(shell.comm.allgather(nodes))
        all_dofs = np.concatenate(shell.comm.allgather(dofs))
        distance, partner = cKDTree(all_nodes).query(nodes * mirror)
        if distance.max(initial=0.0) > ON_LINE:
            raise NumericsError("a segment's mesh is not its own mirror image in y and in z")
        partners[dofs - first] = all_dofs[partner]
        signs[dofs - first] = sign
    return PETSc.Mat().createAIJ(
        shell.stiffness.getSizes(),
        csr=(np.arange(shell.free.size + 1, dtype=PETSc.IntType), partners, signs),
        comm=shell.comm,
    )
