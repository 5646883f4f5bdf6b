# SPDX-License-Identifier: LGPL-3.0-or-later
"""Exact properties of the shell element, plates with known solutions, and torsion."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from dynamics.failure import NumericsError
from geometry.arrays import Array, Indices
from shell_model.segment.segment_shell import SegmentShell
from studies.reference_models.benchmarks import PUBLISHED, twisted_beam
from studies.reference_models.plates import STEEL, SupportedPlate
from studies.reference_models.single_segment import natural_frequencies
from studies.reference_models.static_shell import StaticShell, hold
from tests.shell_model.booms import HELD, flat_boom
from tests.shell_model.conftest import BOX
from tests.shell_model.flat_plates import (
    FLANGE,
    OBLIQUE,
    ConstantStrain,
    Patch,
    PressedPlate,
    constant_strains,
)
from tests.shell_model.prismatic import ANGLE, Member, PlainBox
from tests.shell_model.prismatic import BOX as CLOSED

Shells = Callable[..., SegmentShell]

# Lowest natural frequencies in Hz of a box of 10 m on a mesh of 0.5 m: free, and on supports at
# 0 and 2 m, where the first is the slide along x.
FREE = (
    25.23296631827, 34.16495354744, 59.59588382613, 64.99647238202, 65.45243516437, 65.54237275717,
    78.50521431606, 83.36311545635, 89.62613755159, 95.6675575299,
)  # fmt: skip
SUPPORTED = (
    5.37271909244, 7.27710022704, 33.64996850047, 45.57760117127, 59.81964907369, 68.14177774986,
)  # fmt: skip


def test_boxes_have_the_same_frequencies_on_every_release(box_shell: Shells) -> None:
    """Reference: non-regression, with DOLFINx 0.5.2. Round-off is some 1e-11."""
    free = natural_frequencies(box_shell(0.5), 6 + len(FREE))
    np.testing.assert_allclose(free[6:], FREE, rtol=1.0e-8)
    held = natural_frequencies(box_shell(0.5, supports=HELD), 1 + len(SUPPORTED))
    np.testing.assert_allclose(held[1:], SUPPORTED, rtol=1.0e-8)


@pytest.mark.slow
def test_a_thin_plate_vibrates_after_kirchhoff() -> None:
    """Reference: analytic, π² (m²/a² + n²/b²) √(D/ρt), t/a = 1e-3. Order 2, from above."""
    plate = SupportedPlate(1.0, 0.8, 0.001)
    exact = plate.kirchhoff(4)
    errors = np.array([plate.frequencies(n, 4) / exact - 1.0 for n in (8, 16, 32)])
    assert (errors > 0.0).all()
    assert errors[-1].max() < 7.0e-3
    assert errors[-1, 0] < 2.0e-3
    orders = np.log2(errors[:-1] / errors[1:])
    assert (orders > 1.7).all()


@pytest.mark.slow
def test_a_thick_plate_vibrates_after_mindlin() -> None:
    """Reference: analytic, Mindlin (1951) with 5/6, t/a = 0.1: 4 to 14 % below Kirchhoff."""
    plate = SupportedPlate(1.0, 0.8, 0.1)
    exact = plate.mindlin(4)
    assert (exact < 0.96 * plate.kirchhoff(4)).all()
    errors = np.array([plate.frequencies(n, 4) / exact - 1.0 for n in (16, 32)])
    assert np.abs(errors[-1]).max() < 2.5e-3
    assert (np.log2(errors[0] / errors[1]) > 1.5).all()


@pytest.mark.slow
def test_an_open_section_twists_after_saint_venant() -> None:
    """Reference: analytic, Σ b t³/3. Corner and edges contribute 0.3 %."""
    assert ANGLE.torsion_constant(4, 80) == pytest.approx(ANGLE.thin_walled_constant, rel=3.0e-3)


@pytest.mark.slow
def test_a_closed_section_twists_after_bredt() -> None:
    """Reference: analytic, 4 A² t/Σ b + Σ b t³/3; curved shells' penalty errs by 1 %."""
    exact = CLOSED.thin_walled_constant
    assert CLOSED.torsion_constant(4, 80) == pytest.approx(exact, rel=5.0e-4)
    assert exact > 1.0e3 * sum(CLOSED.widths) * CLOSED.thickness**3 / 3.0


@pytest.mark.slow
def test_the_drilling_tie_does_not_matter_to_boxes() -> None:
    """Reference: non-regression. Penalties from 1e-4 to 1 agree with the default within 0.1 %."""
    outer, inner = (segment.section for segment in flat_boom().segments)
    box = PlainBox(outer, 10.0)
    ties = (1.0e-4, 1.0e-2, 1.0)
    frequencies = np.array([box.free_frequencies(0.5, 8, tie) for tie in ties])
    assert (np.ptp(frequencies, axis=0) < 1.0e-3 * frequencies[0]).all()
    compliances = [box.compliance(0.5, (0.0, 2.0), 9.0, 0.5 * inner.width, tie) for tie in ties]
    assert np.ptp(compliances) < 1.0e-3 * min(compliances)
    assert compliances[0] > compliances[1] > compliances[2]


# A Z of three walls.
FOLDED = Member([(-0.2, 0.3), (0.0, 0.3), (0.0, -0.3), (0.2, -0.3)], False, 0.01, 1.0)


def strains_at_centroids(patch: Patch, solution: Array) -> tuple[Array, Array, Array]:
    """ε (num_triangles, 2, 2), κ, γ (num_triangles, 2) along the plate's x and y, from the nodes'
    values and the shape functions' slopes.
    """
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

    midpoints = 0.5 * (corners[:, [1, 2, 0]] + corners[:, [2, 0, 1]])
    at_corners = read(shell.nodes, shell.node_dofs, corners)
    at_midpoints = read(shell.nodes, shell.node_dofs, midpoints)
    turns = read(shell.rotation_nodes, shell.rotation_dofs, midpoints)
    of_midpoints = slopes[:, [1, 2, 0]] + slopes[:, [2, 0, 1]]
    gradient = np.einsum("tni,tnj->tij", at_corners, slopes) / 3.0
    gradient += np.einsum("tni,tnj->tij", at_midpoints, of_midpoints) * 4.0 / 3.0
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
    """Reference: analytic, the displacements for prescribed edges. The test computes the strains of
    every facet from the nodes.
    """
    patch = Patch.of()
    assert patch.error(state) < 1.0e-11
    found = strains_at_centroids(patch, patch.solve(state))
    largest = max(np.abs(part).max() for part in (state.membrane, state.bending, state.shear))
    for value, exact in zip(found, (state.membrane, state.bending, state.shear), strict=True):
        np.testing.assert_allclose(
            value, np.broadcast_to(exact, value.shape), rtol=0.0, atol=1.0e-9 * largest
        )


def test_rigid_motions_have_no_strain() -> None:
    """Reference: analytic, no forces on the nodes of a folded, oblique shell. Forces due to a
    motion of every second node are the scale.
    """
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
    """The shell with one fixed node can still rotate."""
    points, triangles = FOLDED.mesh(2, 2)
    shell = StaticShell(points, triangles, FOLDED.thickness, STEEL)
    load = shell.point_load(points[-1], np.array([0.0, 0.0, 1.0]))
    message = "the shell does not carry its load; hold its rigid motions"
    with pytest.raises(NumericsError, match=message):
        shell.solve(hold(shell.node_dofs[0]), load)


@pytest.mark.parametrize("turn", [[0.7, -1.1, 0.4], [2.0, 0.3, -1.0]])
def test_a_turned_box_vibrates_alike(turn: list[float]) -> None:
    """Reference: analytic, equal frequencies for any orientation; round-off is 1e-11."""
    box = PlainBox(BOX, 10.0)
    straight = box.free_frequencies(0.5, 10)
    rotation = np.asarray(Rotation.from_rotvec(turn).as_matrix())
    turned = box.free_frequencies(0.5, 10, turn=rotation)
    np.testing.assert_allclose(turned, straight, rtol=1.0e-8)


def test_a_small_patch_is_a_point() -> None:
    """Reference: external, α of w = α P a²/D (Timoshenko and Woinowsky-Krieger 1959, table 23)."""
    a, t = 1.0, 2.0e-3
    plate = PressedPlate(a, a, t, (0.49, 0.49), (0.51, 0.51))
    stiffness = STEEL.youngs_modulus * t**3 / (12.0 * (1.0 - STEEL.poissons_ratio**2))
    assert plate.theory() == pytest.approx(0.0116 * a**2 / stiffness, rel=0.01)


@pytest.mark.slow
def test_the_shell_gives_way_as_the_plate() -> None:
    """Reference: analytic, Navier's series; four edges over the shorter side of the patch."""
    assert FLANGE.shell(0.0125) == pytest.approx(FLANGE.theory(), rel=0.01)


@pytest.mark.parametrize(("edges", "allowed"), [(2, 5.0e-3), (4, 5.0e-4)])
def test_a_twisted_beam_gives_way_as_published(edges: int, allowed: float) -> None:
    """Reference: external, 5.4245e-3, 1.7532e-3 (MacNeal and Harder 1985); a tenth at 2n."""
    assert np.array(twisted_beam(edges)) == pytest.approx(
        np.array(PUBLISHED.twisted_beam), rel=allowed
    )


def test_a_curved_shell_needs_a_stiff_drilling_tie() -> None:
    """Reference: external, 5.4245e-3, 1.7532e-3; to 10⁴ within 0.1 %, the soft tie 5 %."""
    stiff = np.array([twisted_beam(4, drilling) for drilling in (2.0, 20.0, 200.0, 2.0e3, 2.0e4)])
    assert (np.ptp(stiff, axis=0) < 1.0e-3 * stiff[0]).all()
    soft = np.array(twisted_beam(4, 1.0e-2)) / PUBLISHED.twisted_beam
    assert (soft > 1.05).all()
