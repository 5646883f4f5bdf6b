# SPDX-License-Identifier: LGPL-3.0-or-later
"""The shell of a segment, and its supports."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model.finite_element import Theory, finite_element_segment
from protractile.geometry.boom import Direction, PointMass, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.contact_places import ContactInterval
from protractile.shell_model.contact.wall_rows import CornerLines
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from protractile.shell_model.segment.solver import times
from studies.reference_models.shell_readings import flange_deflection
from studies.reference_models.single_segment import natural_frequencies
from tests.beam_model.exact import frequencies
from tests.shell_model.booms import HELD, STEEL, box_segment, reduce_segment
from tests.shell_model.conftest import BOX, box_shell, compliance


def test_rigid_motions_carry_the_mass_of_the_box() -> None:
    """Reference: analytic, ρ A L and ρ (J_y + J_z) L, except for the effect (t/h)² of corners."""
    shell = box_shell(0.25)
    motions = shell.rigid_motions()
    masses = (motions.T @ times(shell.mass, motions)).diagonal()
    mass = STEEL.density * BOX.area * 10.0
    polar = BOX.second_moment_of_area + BOX.lateral_second_moment_of_area
    assert masses[:3] == pytest.approx([mass] * 3, rel=1.0e-12)
    assert masses[3] == pytest.approx(STEEL.density * polar * 10.0, rel=5.0e-4)


@pytest.mark.slow
def test_free_box_vibrates_as_a_timoshenko_beam_at_long_wavelength() -> None:
    """Reference: other code, Timoshenko elements; errors fall with the square of the wavelength."""
    differences = []
    for length in (10.0, 20.0):
        measured = natural_frequencies(box_shell(0.2, length=length), 10)
        assert measured[:6] == pytest.approx(np.zeros(6), abs=1.0e-3)
        euler, timoshenko = (
            _free_beam_frequency(length, theory) for theory in ("euler-bernoulli", "timoshenko")
        )
        bending = measured[6:][np.argmin(np.abs(measured[6:] - timoshenko))]
        difference = abs(bending / timoshenko - 1.0)
        assert difference < 0.2 * (1.0 - timoshenko / euler)
        differences.append(difference)
    assert differences[1] < 1.0e-3
    assert np.log2(differences[0] / differences[1]) > 1.5


def _free_beam_frequency(length: float, theory: Theory) -> float:
    beam = box_segment("beam", 0.0, length, BOX)
    segment = finite_element_segment(beam, 0.05 * length, (), theory, theory == "timoshenko")
    return float(frequencies(segment.components["z"])[0] / (2.0 * np.pi))


def _overhang_compliance(size: float) -> float:
    shell = box_shell(size, supports=HELD)
    return compliance(shell, shell.outline(10.0).wall_deflection("z"))


@pytest.mark.slow
def test_static_compliance_is_timoshenkos() -> None:
    """Reference: analytic, a² (l + a) / 3EJ + (a + a²/l) / G A_web, l = 2 m, a = 8 m, within 0.1 %,
    a third of the effect of shear in the flanges.
    """
    bending = 64.0 * 10.0 / (3.0 * STEEL.youngs_modulus * BOX.second_moment_of_area)
    shear = (8.0 + 32.0) / (STEEL.shear_modulus * BOX.shear_area)
    assert shear > 0.02 * bending  # the tolerance is smaller than the effect
    coarse, fine = (_overhang_compliance(size) for size in (0.2, 0.1))
    assert fine == pytest.approx(bending + shear, rel=2.0e-3)
    assert abs(fine - coarse) < 2.0e-3 * fine
    assert fine > coarse  # refinement softens a conforming displacement model


def test_outline_rows_read_rigid_motions_exactly() -> None:
    """Reference: analytic, vertical translation and pitch; lateral translation, yaw and roll. In
    roll, (y, z) moves by φ (−z, y).
    """
    shell = box_shell(0.25)
    outline, corners = shell.outline(10.0), CornerLines(shell)
    at_end, within = (ContactInterval.from_station(shell.segment, x, 0.1) for x in (10.0, 7.3))
    in_plane = np.array([0.0, 0.0, 0.03, 0.0, -0.002, 0.0])
    lifted = 0.03 + 0.002 * 5.0
    rows = (
        outline.mean_deflection(), outline.wall_deflection("z"), outline.rotation(),
        outline.distortion(), flange_deflection(outline, 1.0, 0.1),
        flange_deflection(outline, -1.0, 0.5 * BOX.width), outline.twist(),
    )  # fmt: skip
    readings = [shell.row(row) @ shell.rigid_motions() @ in_plane for row in rows]
    expected = [lifted, lifted, 0.002, 0.0, lifted, lifted, 0.0]
    assert readings == pytest.approx(expected, abs=1.0e-12)

    sideways = np.array([0.0, 0.01, 0.0, 0.004, 0.0, 0.003])
    shifted = 0.01 + 0.003 * 5.0
    rows = (
        outline.mean_deflection("y"), outline.wall_deflection("y"), outline.twist(),
        outline.mean_deflection(), corners.deflection(at_end, "z", 0.1, -0.3),
        corners.deflection(at_end, "y", -0.1, 0.3), corners.deflection(within, "y", 0.1, 0.1),
    )  # fmt: skip
    readings = [shell.row(row) @ shell.rigid_motions() @ sideways for row in rows]
    within_shifted = 0.01 + 0.003 * 2.3
    expected = [shifted, shifted, 0.004, 0.0, 4.0e-4, shifted - 1.2e-3, within_shifted - 4.0e-4]
    assert readings == pytest.approx(expected, abs=1.0e-12)


@pytest.mark.slow
def test_a_length_of_a_corner_gives_way_alike_on_any_mesh() -> None:
    """Reference: analytic. With halved edges, changes decrease to a third for a force along a
    length, and stay equal for a point force.
    """
    section = BoxSection(0.2, 0.2, 0.006, 0.006)

    def local(size: float, length: float) -> float:
        shell = box_shell(size, 0.4, section=section)
        stretch = ContactInterval.from_station(shell.segment, 0.2, length)
        pressed = CornerLines(shell).deflection(stretch, "z", 0.0, 1.0)
        spread = shell.outline(0.4).wall_deflection("z"), shell.outline(0.0).wall_deflection("z")
        return compliance(shell, pressed - 0.5 * spread[0] - 0.5 * spread[1])

    lengths = {}
    for length in (0.1, 1.0e-4):
        values = [local(size, length) for size in (0.1, 0.05, 0.025, 0.0125)]
        lengths[length] = np.diff(values)
    assert (lengths[0.1][1:] < lengths[0.1][:-1] / 3.0).all()
    assert (lengths[1.0e-4][1:] > 0.7 * lengths[1.0e-4][:-1]).all()


YOUNG, SHEAR = STEEL.youngs_modulus, STEEL.shear_modulus


@pytest.mark.slow
def test_a_clamped_box_bends_and_twists_as_a_cantilever() -> None:
    """Reference: analytic, L³/3EJ + L/GA along z and y, Bredt's L/GJ_t; shear is 0.5 %."""
    shell = box_shell(0.25, supports=(Support(0.0, "clamped"),))
    end = shell.outline(10.0)
    bending = 10.0**3 / (3.0 * YOUNG)
    expected = [
        bending / BOX.second_moment_of_area + 10.0 / (SHEAR * BOX.shear_area),
        bending / BOX.lateral_second_moment_of_area + 10.0 / (SHEAR * BOX.lateral_shear_area),
        10.0 / (SHEAR * BOX.torsion_constant),
    ]
    rows = end.wall_deflection("z"), end.wall_deflection("y"), end.twist()
    assert [compliance(shell, row) for row in rows] == pytest.approx(expected, rel=2.5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("direction", ["z", "y"])
def test_elastic_supports_give_way_by_their_reactions(direction: Direction) -> None:
    """Reference: analytic, (4² + 5²) / k beyond rigid supports, from −4 and 5 times the force."""
    springs = tuple(Support(x, stiffness=1.0e6) for x in (0.0, 2.0))
    rigid, elastic = (
        compliance(shell, shell.outline(10.0).wall_deflection(direction))
        for shell in (box_shell(0.25, supports=HELD), box_shell(0.25, supports=springs))
    )
    assert elastic - rigid == pytest.approx(41.0e-6, rel=1.0e-3)


@pytest.mark.slow
def test_every_support_holds_the_twist() -> None:
    """Reference: analytic, Bredt, from the support at 2 m to the end."""
    springs = tuple(Support(x, stiffness=1.0e6) for x in (0.0, 2.0))
    for supports in (HELD, springs):
        shell = box_shell(0.25, supports=supports)
        expected = 8.0 / (SHEAR * BOX.torsion_constant)
        assert compliance(shell, shell.outline(10.0).twist()) == pytest.approx(expected, rel=2.0e-3)


def test_supports_leave_unheld_rigid_motions_free() -> None:
    """Reference: analytic, sliding along x but for a clamp, both rotations of one pin."""
    left = {
        (): 6, (Support(0.0),): 3, (Support(0.0, stiffness=10.0),): 3, HELD: 1,
        (Support(0.0, stiffness=10.0), Support(2.0)): 1, (Support(2.0, "clamped"),): 0,
    }  # fmt: skip
    for supports, count in left.items():
        assert box_shell(0.5, supports=supports).rigid_motions().shape[1] == count


def test_point_masses_have_mass_and_no_rotary_inertia() -> None:
    """Reference: analytic: 100 kg translated, 70·3² + 30·5² kg·m² pitch, yaw; no roll."""
    masses = (PointMass(2.0, 70.0), PointMass(10.0, 30.0))
    bare, loaded = (
        np.array([motion @ times(shell.mass, motion[:, None])[:, 0] for motion in motions.T])
        for shell, motions in (
            (shell, shell.rigid_motions())
            for shell in (box_shell(0.5), box_shell(0.5, masses=masses))
        )
    )
    turned = 70.0 * 9.0 + 30.0 * 25.0
    expected = [100.0, 100.0, 100.0, 0.0, turned, turned]
    assert loaded - bare == pytest.approx(expected, rel=1.0e-9, abs=1.0e-9)


@pytest.mark.slow
@pytest.mark.parametrize("direction", ["z", "y"])
@pytest.mark.parametrize("masses", [(), (PointMass(10.0, 200.0),)], ids=["bare", "tip mass"])
def test_lowest_frequency_is_the_beams_in_each_plane(
    direction: Direction, masses: tuple[PointMass, ...]
) -> None:
    """Reference: other code, Timoshenko elements; 0.2 %, the second mode 1.3 %."""
    shell = box_shell(0.25, supports=HELD, masses=masses)
    push = shell.row(shell.outline(10.0).wall_deflection(direction))[:, None]
    found = np.sqrt(reduce_segment(SymmetryReduction(shell), push, KrylovOptions(moments=2)).omega2)
    beam = replace(box_segment("beam", 0.0, 10.0, BOX, supports=HELD), masses=masses)
    elements = finite_element_segment(beam, 0.25, (), "timoshenko", rotary_inertia=True)
    expected = frequencies(elements.components[direction])
    assert found[0] == pytest.approx(expected[0], rel=4.0e-3)
    assert found[1] == pytest.approx(expected[1], rel=2.0e-2)


@pytest.mark.slow
def test_twisting_frequency_is_bredts() -> None:
    """Reference: analytic, √(G J_t / ρ I_p) / 4l for 18 m; 0.3 % of distortion."""
    box = BoxSection(height=0.4, width=0.3, flange=0.02, web=0.02)
    shell = box_shell(0.25, length=20.0, supports=HELD, section=box)
    push = shell.row(shell.outline(20.0).twist())[:, None]
    found = np.sqrt(
        reduce_segment(SymmetryReduction(shell), push, KrylovOptions(moments=2)).omega2[0]
    )
    inertia = STEEL.density * box.polar_second_moment_of_area
    expected = np.sqrt(SHEAR * box.torsion_constant / inertia) * 2.0 * np.pi / (4.0 * 18.0)
    assert found == pytest.approx(expected, rel=0.01)
    # Bredt's torsion is not that of the four plates by themselves.
    plates = 2.0 / 3.0 * (box.height + box.width) * box.web**3
    assert plates < 0.02 * box.torsion_constant
