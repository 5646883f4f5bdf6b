# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plates of shells: bending, patch tests, and buckling of walls and of segments at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from protractile.dynamics.equilibrium import equilibrium_at
from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Support
from protractile.geometry.mesh import mesh_segment
from protractile.geometry.plating import plain_thickness
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.buckling import ShellState, buckle_segments, buckling_modes
from protractile.shell_model.segment.shell import ON_LINE
from studies.reference_models.benchmarks import PUBLISHED, X, Y, Z, grid, twisted_beam
from studies.reference_models.finite_strip import Strips
from studies.reference_models.plates import STEEL, SupportedPlate, rectangle, rigidities
from studies.reference_models.single_segment import natural_frequencies, shell_alone
from studies.reference_models.static_shell import StaticShell, hold
from studies.wall_buckling import BOXES, COLUMN, PLATES, PRESSED, TUBE, LoadedBox, LoadedPlate
from tests.shell_model.booms import HELD, box_segment, reduce_quickly
from tests.shell_model.conftest import BOX, box_shell

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
def test_plates_vibrate_as_known() -> None:
    """Reference: analytic, Kirchhoff for t/a = 1e-3, Mindlin (1951) with 5/6, 4 to 14 % lower."""
    thin, thick = (SupportedPlate(1.0, 0.8, thickness) for thickness in (0.001, 0.1))
    assert (thick.mindlin(4) < 0.96 * thick.kirchhoff(4)).all()
    for plate, exact in ((thin, thin.kirchhoff(4)), (thick, thick.mindlin(4))):
        errors = np.array([plate.frequencies(n, 4) / exact - 1.0 for n in (16, 32)])
        assert np.abs(errors[-1]).max() < 7.0e-3
        assert (np.log2(errors[0] / errors[1]) > 1.5).all()


def torsion_constant(corners: Sequence[tuple[float, float]], thickness: float) -> float:
    """Return J in m⁴ of a shell of 1 m along x: torque over G times the rate of twist.

    Walls are between corners (y, z) in m, about the shear centre. End sections rotate without
    distortion and are free to warp. The rate is measured between the quarter points, away from
    local bending at the ends.
    """
    walls = len(corners) - 1

    def surface(along: Array, around: Array) -> Array:
        y, z = (np.interp(around * walls, np.arange(walls + 1), c) for c in np.transpose(corners))
        return np.stack([along, y, z], axis=1)

    points, triangles = grid(surface, 80, 4 * walls)
    # In a closed section the last point around is the first one.
    points, same = np.unique(points.round(12), axis=0, return_inverse=True)
    shell = StaticShell(points, same.ravel()[triangles], thickness, STEEL)
    turn = np.cross([1.0, 0.0, 0.0], shell.nodes)
    held = hold(shell.node_dofs[:1, X])
    for x in (0.0, 1.0):
        at = shell.at(X, x)
        held |= hold(shell.node_dofs[at][:, [Y, Z]], x * turn[at][:, [Y, Z]])
    solution = shell.solve(held, np.zeros(shell.num_dofs))
    torque = float((shell.forces(solution)[shell.node_dofs] * turn)[shell.at(X, 1.0)].sum())
    angles = []
    for x in (0.25, 0.75):
        at = shell.at(X, x)
        off = turn[at] - turn[at].mean(axis=0)
        angles.append(float((off * solution[shell.node_dofs[at]]).sum() / (off**2).sum()))
    return 0.5 * torque / (STEEL.shear_modulus * (angles[1] - angles[0]))


@pytest.mark.slow
def test_sections_twist_after_saint_venant_and_bredt() -> None:
    """Reference: analytic, Σ b t³/3, of which corner and edges contribute 0.3 %; + 4 A² t/Σ b."""
    angle = torsion_constant([(0.1, 0.0), (0.0, 0.0), (0.0, 0.1)], 1.0e-3)
    assert angle == pytest.approx(0.2e-9 / 3.0, rel=3.0e-3)
    corners = [(-0.03, -0.05), (0.03, -0.05), (0.03, 0.05), (-0.03, 0.05), (-0.03, -0.05)]
    bredt = 0.32e-9 / 3.0 + 4.0 * 0.006**2 * 1.0e-3 / 0.32
    assert torsion_constant(corners, 1.0e-3) == pytest.approx(bredt, rel=5.0e-4)


# Columns are the directions of x, y and normal of the patch, oblique to all axes of space.
OBLIQUE = np.asarray(Rotation.from_rotvec([0.7, -1.1, 0.4]).as_matrix())


def test_constant_strains_are_exact() -> None:
    """Reference: analytic, displacements and rotations of all nodes for prescribed edges, under
    membrane, bending and shear strains, on a distorted mesh, oblique in space.

    Bending is u_z = −xᵀ κ x/2; normals remain perpendicular to the surface but for shear.
    """

    def surface(x: Array, y: Array) -> Array:
        inside = (np.abs(x - 0.5) < 0.5 - ON_LINE) & (np.abs(y - 0.5) < 0.5 - ON_LINE)
        off = 0.05 * inside
        x, y = x + off * np.sin(17.0 * x + 5.0 * y), y + off * np.cos(7.0 * x - 13.0 * y)
        return np.asarray(np.stack([x, y, np.zeros_like(x)], axis=1) @ OBLIQUE.T)

    spin, tilt, shear = 6.0e-4, np.array([3.0e-4, -5.0e-4]), np.array([8.0e-4, -2.0e-4])
    slope = tilt + shear
    gradient = np.array([[1e-3, 4e-4 - spin, 0.0], [4e-4 + spin, -7e-4, 0.0], [*slope, 0.0]])
    curvature = 1.0e-3 * np.array([[1.2, 0.5, 0.0], [0.5, -0.6, 0.0], [0.0, 0.0, 0.0]])

    def displacement(p: Array) -> Array:
        bent = np.einsum("ni,ij,nj->n", p, curvature, p)
        return np.asarray(p @ gradient.T - 0.5 * np.outer(bent, [0.0, 0.0, 1.0]))

    def rotation(p: Array) -> Array:
        turned = np.cross([0.0, 0.0, 1.0], p @ curvature)
        return np.asarray(turned + np.array([tilt[1], -tilt[0], spin]))

    thickness = 0.05
    shell = StaticShell(*grid(surface, 4, 4), thickness, STEEL)
    exact, held = np.zeros(shell.num_dofs), dict[int, float]()
    for places, dofs, field in (
        (shell.nodes, shell.node_dofs, displacement),
        (shell.rotation_nodes, shell.rotation_dofs, rotation),
    ):
        exact[dofs] = field(places @ OBLIQUE) @ OBLIQUE.T
        edge = np.abs(places @ OBLIQUE[:, :2] - 0.5).max(axis=1) > 0.5 - ON_LINE
        held |= hold(dofs[edge], exact[dofs[edge]])
    # The couple per area that equilibrium needs: e3 × Q for shear force Q.
    q1, q2 = rigidities(thickness)[1] * shear
    couple = OBLIQUE @ np.array([-q2, q1, 0.0])
    found = shell.solve(held, shell.surface_load(np.zeros(3), couple))
    for dofs in (shell.node_dofs, shell.rotation_dofs):
        assert np.abs(found[dofs] - exact[dofs]).max() < 1.0e-11 * np.abs(exact[dofs]).max()


def test_a_turned_box_vibrates_alike() -> None:
    """Reference: analytic, equal frequencies for any orientation; round-off is 1e-11."""
    mesh = mesh_segment(BOX, {"start": 0.0, "end": 10.0}, 0.5)
    thickness = plain_thickness(BOX, mesh)
    straight, turned = (
        natural_frequencies(
            StaticShell(mesh.points @ turn.T, mesh.triangles, thickness, STEEL).held({}), 16
        )[6:]
        for turn in (np.eye(3), OBLIQUE)
    )
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
    """Reference: analytic, Navier's double sine series (1823), with shear deflection."""
    plate, shear = rigidities(FLANGE)
    waves = np.pi * np.arange(1, 401)[:, None] / SIDES
    means = (np.cos(waves * START) - np.cos(waves * END)) / (waves * (END - START))
    k2 = np.add.outer(waves[:, 0] ** 2, waves[:, 1] ** 2)
    given = 4.0 / np.prod(SIDES) * (1.0 / (plate * k2**2) + 1.0 / (shear * k2))
    exact = float((given * np.outer(*means.T) ** 2).sum())
    assert pressed_shell(0.0125) == pytest.approx(exact, rel=0.01)


def test_a_curved_shell_needs_a_stiff_drilling_tie() -> None:
    """Reference: external, 5.4245e-3, 1.7532e-3 (MacNeal and Harder 1985); ties to 10⁴ agree
    within 0.1 %, the soft tie errs by 5 %.
    """
    assert twisted_beam(4) == pytest.approx(PUBLISHED.twisted_beam, rel=5.0e-4)
    stiff = np.array([twisted_beam(4, drilling) for drilling in (2.0, 20.0, 200.0, 2.0e3, 2.0e4)])
    assert (np.ptp(stiff, axis=0) < 1.0e-3 * stiff[0]).all()
    soft = np.array(twisted_beam(4, 1.0e-2)) / PUBLISHED.twisted_beam
    assert (soft > 1.05).all()


def extrapolated(coarse: float, fine: float) -> float:
    """Return the limit of two meshes, one with edges of half the length, at an order of 2."""
    return float(fine * np.cbrt(fine / coarse))


@pytest.mark.parametrize("plate", PLATES, ids=lambda plate: plate.name)
def test_plates_buckle_at_known_factors(plate: LoadedPlate) -> None:
    """Reference: analytic, from above with order 2; the limit of two meshes within 0.6 %."""
    first, coarse, fine = (float(plate.shell(n)[0]) for n in (4, 8, 16))
    assert first > coarse > fine > plate.factor
    assert fine < 1.035 * plate.factor
    assert np.log2((first - coarse) / (coarse - fine)) > 1.0
    assert extrapolated(coarse, fine) == pytest.approx(plate.factor, rel=6.0e-3)


def test_tension_has_no_factor() -> None:
    pulled = replace(PLATES[0], forces=((1.0, 0.5, 0.0),) * 2)
    assert pulled.shell(4, 2).size == 0


@pytest.mark.slow
def test_a_box_buckles_as_finite_strips() -> None:
    """Reference: other code, finite strips, within 1 % of the limit of two meshes."""
    box = BOXES[-1]  # in compression and bending
    coarse, fine = (float(box.shell(n)[1].factors[0]) for n in (6, 12))
    assert coarse > fine
    assert extrapolated(coarse, fine) == pytest.approx(box.strips(), rel=0.01)


@pytest.mark.slow
def test_webs_buckle_under_patch_loads() -> None:
    """Reference: external, k_F = 6 + 2 (h/a)² of EN 1993-1-5, 6.4, within 15 %."""
    pressed = PRESSED[0]
    found = extrapolated(pressed.shell(4), pressed.shell(8))
    assert found == pytest.approx(pressed.fitted, rel=0.15)


@pytest.mark.slow
def test_a_column_buckles_as_a_whole_and_in_its_walls() -> None:
    """Reference: other code, finite strips with one half-wave and with many, within 1 %."""
    whole = Strips.of(COLUMN.section, STEEL).factor(COLUMN.length, 1, COLUMN.stress)
    shell, modes = COLUMN.shell(2, 2)
    assert modes.factors == pytest.approx([whole, whole], rel=0.01)
    first, _ = shell.owned
    moved = modes.shapes[shell.node_dofs - first]
    assert np.linalg.norm(moved, axis=1).max(axis=0) == pytest.approx([1.0, 1.0])


def test_an_unheld_segment_is_refused() -> None:
    shell = shell_alone(box_segment("box", 0.0, 2.0, TUBE), 0.2)
    forces = np.zeros((len(shell.mesh.triangles), 3)) - [1.0, 0.0, 0.0]
    message = r"^the shell has a rigid motion, and cannot buckle; add a support$"
    with pytest.raises(NumericsError, match=message):
        buckling_modes(shell, forces, 1)


@pytest.mark.slow
def test_beam_buckles_at_its_largest_moment() -> None:
    """Reference: other code, finite strips under the largest moment, from below."""
    supports = Support(0.0), Support(4.0)
    segment = box_segment("beam", 0.0, 4.0, TUBE, load=-8.0e3, supports=supports)
    boom, options = Boom((segment,), ()), ShellOptions(0.1)
    shell = reduce_quickly(boom, options, fields=True)
    state = ShellState.from_fields(shell.fields, shell.system, equilibrium_at(shell.system))
    (found,) = buckle_segments(boom, shell.meshes, state, options, 1, MPI.COMM_SELF)
    moment = 8.0e3 * 4.0**2 / 8.0
    bent = LoadedBox("beam", TUBE, 4.0, bending=-moment / TUBE.second_moment_of_area)
    least = bent.strips(16)
    assert least < found.factors[0] < 1.05 * least
    assert 0.05 < found.mesh_errors[0] < 0.1
    size = np.linalg.norm(found.shapes[0], axis=1)
    most = found.mesh.points[size.argmax()]
    assert most[[0, 2]] == pytest.approx([2.0, 0.2], abs=0.3)
