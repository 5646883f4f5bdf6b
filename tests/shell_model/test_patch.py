# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the element must do exactly, however its facets lie in space."""

from __future__ import annotations

import numpy as np
import pytest

from geometry.arrays import Array, Indices

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from dynamics.failure import NumericsError
from studies.reference_models.plates import OBLIQUE, STEEL, ConstantStrain, Patch, constant_strains
from studies.reference_models.prismatic import Member, PlainBox
from studies.reference_models.static_shell import StaticShell, hold
from tests.shell_model.conftest import BOX

# A Z of three walls.
FOLDED = Member([(-0.2, 0.3), (0.0, 0.3), (0.0, -0.3), (0.2, -0.3)], False, 0.01, 1.0)


def strains_at_centroids(patch: Patch, solution: Array) -> tuple[Array, Array, Array]:
    """ε (num_triangles, 2, 2), κ, γ (num_triangles, 2) along the plate's x and y, from the nodes'
    values and the shape functions' slopes."""
    shell = patch.shell
    corners = patch.points[patch.triangles] @ OBLIQUE
    # Slopes of the three barycentric coordinates, (num_triangles, 3, 2).
    edges = corners[:, [2, 0, 1], :2] - corners[:, [1, 2, 0], :2]
    twice = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
    slopes = np.stack([-edges[..., 1], edges[..., 0]], axis=2) / twice[:, None, None]

    def read(nodes: Array, dofs: Indices, places: Array) -> Array:
        distance, node = cKDTree(nodes).query(places @ OBLIQUE.T)
        assert distance.max() < 1.0e-9
        return np.asarray(solution[dofs[node]] @ OBLIQUE)

    middles = 0.5 * (corners[:, [1, 2, 0]] + corners[:, [2, 0, 1]])
    at_corners = read(shell.nodes, shell.node_dofs, corners)
    at_middles = read(shell.nodes, shell.node_dofs, middles)
    turns = read(shell.rotation_nodes, shell.rotation_dofs, middles)
    of_middles = slopes[:, [1, 2, 0]] + slopes[:, [2, 0, 1]]
    gradient = np.einsum("tni,tnj->tij", at_corners, slopes) / 3.0
    gradient += np.einsum("tni,tnj->tij", at_middles, of_middles) * 4.0 / 3.0
    # θ × e3 is (θ_y, -θ_x).
    normals = np.stack([turns[..., 1], -turns[..., 0]], axis=2)
    bending = -2.0 * np.einsum("tni,tnj->tij", normals, slopes)
    membrane = gradient[:, :2]
    shear = gradient[:, 2] + normals.mean(axis=1)
    return (
        0.5 * (membrane + membrane.swapaxes(1, 2)),
        0.5 * (bending + bending.swapaxes(1, 2)),
        shear,
    )


@pytest.mark.parametrize("state", constant_strains(), ids=lambda state: state.name)
def test_constant_strains_are_exact(state: ConstantStrain) -> None:
    """Reference: analytic. Fields between edges that are held so, and the strains of every facet,
    which the test takes from the nodes itself."""
    patch = Patch.of()
    assert patch.error(state) < 1.0e-11
    found = strains_at_centroids(patch, patch.solve(state))
    largest = max(np.abs(part).max() for part in (state.membrane, state.bending, state.shear))
    for value, exact in zip(found, (state.membrane, state.bending, state.shear), strict=True):
        np.testing.assert_allclose(
            value, np.broadcast_to(exact, value.shape), rtol=0.0, atol=1.0e-9 * largest
        )


def test_rigid_motions_have_no_strain() -> None:
    """Reference: analytic, no force on any node, against the forces when every other node alone
    moves. A folded shell, oblique in space."""
    points, triangles = FOLDED.mesh(3, 5)
    turn = np.asarray(Rotation.from_rotvec([-0.8, 0.5, 1.9]).as_matrix())
    shell = StaticShell(points @ turn.T, triangles, FOLDED.thickness, STEEL)
    motions = shell.held({}).rigid_motions()
    assert motions.shape == (shell.num_dofs, 6)
    for motion in motions.T:
        force = np.abs(shell.forces(motion))
        strained = motion.copy()
        strained[shell.node_dofs[::2]] = 0.0
        strained[shell.rotation_dofs[::2]] = 0.0
        assert force.max() < 1.0e-10 * np.abs(shell.forces(strained)).max()


def test_a_loose_shell_is_refused() -> None:
    """Held at one node it still turns."""
    points, triangles = FOLDED.mesh(2, 2)
    shell = StaticShell(points, triangles, FOLDED.thickness, STEEL)
    load = shell.point_load(points[-1], np.array([0.0, 0.0, 1.0]))
    message = "the shell does not carry its load; hold its rigid motions"
    with pytest.raises(NumericsError, match=message):
        shell.solve(hold(shell.node_dofs[0]), load)


@pytest.mark.parametrize("turn", [[0.7, -1.1, 0.4], [2.0, 0.3, -1.0]])
def test_a_turned_box_vibrates_alike(turn: list[float]) -> None:
    """Reference: analytic, the same frequencies wherever the box points; round-off is 1e-11."""
    box = PlainBox(BOX, 10.0)
    straight = box.free_frequencies(0.5, 10)
    rotation = np.asarray(Rotation.from_rotvec(turn).as_matrix())
    turned = box.free_frequencies(0.5, 10, turn=rotation)
    np.testing.assert_allclose(turned, straight, rtol=1.0e-8)
