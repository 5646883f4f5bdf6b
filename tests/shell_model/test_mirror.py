# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motions fall into four families that a box's shell keeps apart."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from dynamics.failure import NumericsError
from geometry.mesh import SegmentMesh, mesh_segment
from shell_model.mirror import ALONG_Y, ALONG_Z, BREATHING, FAMILIES, TWISTING, Mirrors
from shell_model.products import times
from shell_model.segment_shell import SegmentShell, assemble_segment
from tests.shell_model.booms import HELD, box_segment
from tests.shell_model.conftest import BOX

Shells = Callable[..., SegmentShell]


@pytest.mark.quick
def test_rigid_motions_belong_to_their_families(box_shell: Shells) -> None:
    """Reference: analytic. Slides along x, y, z, then turns about them."""
    shell = box_shell(0.5)
    mirrors = Mirrors(shell)
    motions = shell.rigid_motions()
    families = (BREATHING, ALONG_Y, ALONG_Z, TWISTING, ALONG_Z, ALONG_Y)
    for motion, mine in zip(motions.T[:, :, None], families, strict=True):
        for family in FAMILIES:
            expected = motion if family == mine else np.zeros_like(motion)
            assert mirrors.part(motion, family) == pytest.approx(expected, abs=1.0e-12)
    mirrors.destroy()


@pytest.mark.quick
def test_forces_stay_in_the_family_of_the_motion(box_shell: Shells) -> None:
    """Reference: analytic. The families make up every motion, and K and M keep them apart."""
    shell = box_shell(0.5, supports=HELD)
    mirrors = Mirrors(shell)
    motion = np.random.default_rng(1).standard_normal((shell.num_dofs, 1)) * shell.free[:, None]
    parts = [mirrors.part(motion, family) for family in FAMILIES]
    assert np.sum(parts, axis=0) == pytest.approx(motion, abs=1.0e-12)
    for matrix in (shell.stiffness, shell.mass):
        for family, part in zip(FAMILIES, parts, strict=True):
            force = times(matrix, part)
            left = force - mirrors.part(force, family)
            assert np.abs(left).max() < 1.0e-12 * np.abs(force).max()
    mirrors.destroy()


def _shifted(mesh: SegmentMesh) -> SegmentMesh:
    points = mesh.points.copy()
    points[np.abs(points[:, 0] - 5.0).argmin(), 0] += 0.01
    return replace(mesh, points=points)


def _one_diagonal_turned(mesh: SegmentMesh) -> SegmentMesh:
    """Two triangles of a rectangle cut the other way; every node stays where it was."""
    triangles = mesh.triangles.copy()
    for other in range(1, len(triangles)):
        shared = np.intersect1d(triangles[0], triangles[other])
        ends = mesh.points[shared]
        if shared.size == 2 and (np.abs(ends[0] - ends[1]) > 1.0e-9).sum() == 2:
            break
    (a,), (b,) = (np.setdiff1d(triangles[k], shared) for k in (0, other))
    triangles[0], triangles[other] = [a, b, shared[0]], [a, b, shared[1]]
    return replace(mesh, triangles=triangles)


@pytest.mark.quick
@pytest.mark.parametrize(("spoil", "what"), [(_shifted, "mesh"), (_one_diagonal_turned, "shell")])
def test_refuses_a_mesh_that_is_no_mirror_image(
    spoil: Callable[[SegmentMesh], SegmentMesh], what: str
) -> None:
    mesh = spoil(mesh_segment(BOX, {"start": 0.0, "end": 10.0}, 0.5))
    shell = assemble_segment(MPI.COMM_WORLD, box_segment("box", 0.0, 10.0, BOX), mesh)
    message = f"^a segment's {what} is not its own mirror image in y and in z$"
    with pytest.raises(NumericsError, match=message):
        Mirrors(shell)
