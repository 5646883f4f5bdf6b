# SPDX-License-Identifier: LGPL-3.0-or-later
"""Exact properties of the shell element, plates with known solutions, and torsion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array, Indices
from protractile.shell_model.segment.shell import ON_LINE
from studies.reference_models.benchmarks import PUBLISHED, X, Y, Z, grid, twisted_beam
from studies.reference_models.plates import STEEL, Field, SupportedPlate, rectangle, rigidities
from studies.reference_models.single_segment import natural_frequencies
from studies.reference_models.static_shell import StaticShell, hold
from tests.shell_model.booms import HELD, flat_boom
from tests.shell_model.conftest import BOX, box_shell
from tests.shell_model.prismatic import ANGLE, Member, PlainBox
from tests.shell_model.prismatic import BOX as CLOSED

# Lowest natural frequencies in Hz of a box of 10 m on a mesh of 0.5 m: free, and on supports at
# 0 and 2 m, where the first is the slide along x.
FREE = (
    25.23296631827, 34.16495354744, 59.59588382613, 64.99647238202, 65.45243516437, 65.54237275717,
    78.50521431606, 83.36311545635, 89.62613755159, 95.6675575299,
)  # fmt: skip
SUPPORTED = (
    5.37271909244, 7.27710022704, 33.64996850047, 45.57760117127, 59.81964907369, 68.14177774986,
)  # fmt: skip


def test_boxes_have_the_same_frequencies_on_every_release() -> None:
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


PATCH_THICKNESS = 0.05

# Columns are the directions of x, y and normal of the patch, oblique to all axes of space.
OBLIQUE = np.asarray(Rotation.from_rotvec([0.7, -1.1, 0.4]).as_matrix())


@dataclass(frozen=True, slots=True)
class ConstantStrain:
    """State of a plate on [0, 1]² with uniform strains.

    Args:
        name: label in tables.
        displacement: function of x and y (num,) in m that returns displacements (num, 3) in m along
            x, y and the normal of the plate.
        rotation: function of x and y that returns rotations (num, 3) in rad about these axes.
        shear: shear strains γ (2,).
    """

    name: str
    displacement: Field
    rotation: Field
    shear: Array

    @property
    def couple(self) -> Array:
        """The couple (3,) per area in N·m/m² that equilibrium needs: e3 × Q for shear force Q."""
        q1, q2 = rigidities(PATCH_THICKNESS)[1] * self.shear
        return np.array([-q2, q1, 0.0])


def constant_strains() -> list[ConstantStrain]:
    """Return three states that together include all membrane, bending and shear strains.

    Bending is u_z = −κ_xx x²/2 − κ_yy y²/2 − κ_xy x y; normals remain perpendicular to the surface.
    """
    none, strain = np.zeros(2), 1.0e-3 * np.array([[1.0, 0.4], [0.4, -0.7]])
    spin, tilt = 6.0e-4, np.array([3.0e-4, -5.0e-4])
    gradient = strain + spin * np.array([[0.0, -1.0], [1.0, 0.0]])
    gamma = np.array([8.0e-4, -2.0e-4])
    slope = gamma + tilt

    def columns(x: Array, *values: Array | float) -> Array:
        return np.stack([np.broadcast_to(value, x.shape) for value in values], axis=1)

    def bent(x: Array, y: Array) -> Array:
        xx, yy, xy = strain[0, 0], strain[1, 1], strain[0, 1]
        return columns(x, 0.0, 0.0, -0.5 * (xx * x**2 + yy * y**2) - xy * x * y)

    def turned(x: Array, y: Array) -> Array:
        along_x, along_y = strain @ np.stack([x, y])
        return columns(x, -along_y, along_x, 0.0)

    return [
        ConstantStrain(
            "membrane",
            lambda x, y: columns(x, *(gradient @ np.stack([x, y])), 0.0),
            lambda x, y: columns(x, 0.0, 0.0, spin),
            none,
        ),
        ConstantStrain("bending", bent, turned, none),
        ConstantStrain(
            "shear",
            lambda x, y: columns(x, 0.0, 0.0, slope[0] * x + slope[1] * y),
            lambda x, y: columns(x, tilt[1], -tilt[0], 0.0),
            gamma,
        ),
    ]


@dataclass(frozen=True, slots=True)
class Patch:
    """Distorted mesh of the plate on [0, 1]², oblique in space.

    Args:
        points: (num_points, 3) in m.
        triangles: (num_triangles, 3).
        shell: shell of steel, ``PATCH_THICKNESS`` thick.
    """

    points: Array
    triangles: Indices
    shell: StaticShell

    @classmethod
    def of(cls, n: int = 4) -> Patch:
        """Create a patch with n edges along each side and shifted inner points."""

        def surface(x: Array, y: Array) -> Array:
            inside = (np.abs(x - 0.5) < 0.5 - ON_LINE) & (np.abs(y - 0.5) < 0.5 - ON_LINE)
            off = 0.2 / n * inside
            x, y = x + off * np.sin(17.0 * x + 5.0 * y), y + off * np.cos(7.0 * x - 13.0 * y)
            return np.asarray(np.stack([x, y, np.zeros_like(x)], axis=1) @ OBLIQUE.T)

        points, triangles = grid(surface, n, n)
        return cls(points, triangles, StaticShell(points, triangles, PATCH_THICKNESS, STEEL))

    def exact(self, state: ConstantStrain) -> Array:
        """Return the exact solution (num_dofs,) in m and rad."""
        shell = self.shell
        solution = np.zeros(shell.num_dofs)
        for places, dofs, field in (
            (shell.nodes, shell.node_dofs, state.displacement),
            (shell.rotation_nodes, shell.rotation_dofs, state.rotation),
        ):
            x, y, _ = OBLIQUE.T @ places.T
            solution[dofs] = field(x, y) @ OBLIQUE.T
        return solution

    def solve(self, state: ConstantStrain) -> Array:
        """Return the shell's solution (num_dofs,), with the exact solution given at the edges."""
        shell, exact = self.shell, self.exact(state)
        held: dict[int, float] = {}
        for places, dofs in (
            (shell.nodes, shell.node_dofs),
            (shell.rotation_nodes, shell.rotation_dofs),
        ):
            edge = np.abs(places @ OBLIQUE[:, :2] - 0.5).max(axis=1) > 0.5 - ON_LINE
            held |= hold(dofs[edge], exact[dofs[edge]])
        return shell.solve(held, shell.surface_load(np.zeros(3), OBLIQUE @ state.couple))

    def error(self, state: ConstantStrain) -> float:
        """Return the largest error of a displacement or rotation, relative to the largest one."""
        found, exact = self.solve(state), self.exact(state)
        return max(
            float(np.abs(found[dofs] - exact[dofs]).max() / np.abs(exact[dofs]).max())
            for dofs in (self.shell.node_dofs, self.shell.rotation_dofs)
        )


# A Z of three walls.
FOLDED = Member([(-0.2, 0.3), (0.0, 0.3), (0.0, -0.3), (0.2, -0.3)], False, 0.01, 1.0)


@pytest.mark.parametrize("state", constant_strains(), ids=lambda state: state.name)
def test_constant_strains_are_exact(state: ConstantStrain) -> None:
    """Reference: analytic, displacements and rotations of all nodes for prescribed edges."""
    assert Patch.of().error(state) < 1.0e-11


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


# Plate like the outer flange of the paper's boom, and corners of a pad beside its web, in m.
SIDES, FLANGE, START, END = (0.6, 0.3), 6.64e-3, np.array([0.25, 0.025]), np.array([0.35, 0.075])


def pressed_shell(size: float) -> float:
    """Return the mean deflection of the pad in m/N under a uniform load of 1 N, on hard simple
    supports, with edges of a size in m that divides all lengths.
    """
    points, triangles = grid(rectangle(*SIDES), *(round(side / size) for side in SIDES))
    shell = StaticShell(points, triangles, FLANGE, STEEL)
    midpoints = points[triangles].mean(axis=1)[:, :2]
    pressed = ((midpoints > START) & (midpoints < END)).all(axis=1)
    load = shell.surface_load(np.array([0.0, 0.0, 1.0 / np.prod(END - START)]), on=pressed)
    held = hold(shell.node_dofs[:, [X, Y]]) | hold(shell.rotation_dofs[:, Z])
    for axis, side in ((X, SIDES[0]), (Y, SIDES[1])):
        for edge in (0.0, side):
            held |= shell.hold_at(axis, edge, [Z], [axis])
    return float(load @ shell.solve(held, load))


@pytest.mark.slow
def test_the_shell_gives_way_as_the_plate() -> None:
    """Reference: analytic, Navier's double sine series (1823), with shear deflection, which adds to
    the bending deflection on these supports; four edges over the shorter side of the pad.
    """
    plate, shear = rigidities(FLANGE)
    waves = np.pi * np.arange(1, 401)[:, None] / SIDES
    means = (np.cos(waves * START) - np.cos(waves * END)) / (waves * (END - START))
    k2 = np.add.outer(waves[:, 0] ** 2, waves[:, 1] ** 2)
    given = 4.0 / np.prod(SIDES) * (1.0 / (plate * k2**2) + 1.0 / (shear * k2))
    exact = float((given * np.outer(*means.T) ** 2).sum())
    assert pressed_shell(0.0125) == pytest.approx(exact, rel=0.01)


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
