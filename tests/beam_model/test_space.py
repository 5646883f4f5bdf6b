# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms in space: two planes and a twist, pads in the corners, friction across planes."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model.component import SegmentModel
from protractile.beam_model.finite_element import (
    Theory,
    finite_element_segment,
    finite_element_segments,
)
from protractile.beam_model.kantorovich import kantorovich_segment
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Joint, Support
from tests.beam_model.exact import beam, frequencies
from tests.touching import in_space, touching

LAW = PowerContact(stiffness=1.0e9, exponent=1.0).with_clearance(7.0e-3)
LATERAL_LAW = PowerContact(stiffness=3.0e8, exponent=1.0).with_clearance(5.0e-3)


def beams(
    boom: Boom, length: float = 1.0, theory: Theory = "euler-bernoulli"
) -> list[SegmentModel]:
    return finite_element_segments(boom, length, theory, True)


def pushed(boom: Boom, *loads: float) -> Boom:
    """Return the boom with uniform loads along y in N/m."""
    segments = []
    for segment, load in zip(boom.segments, loads, strict=True):
        segments.append(replace(segment, lateral=replace(segment.lateral, load=load)))
    return replace(boom, segments=tuple(segments))


def rolled(boom: Boom) -> Boom:
    """Return the boom with y and z exchanged."""
    joints = tuple(replace(j, play=j.lateral_play, lateral_play=j.play) for j in boom.joints)
    return replace(boom, segments=tuple(s.turned() for s in boom.segments), joints=joints)


@pytest.mark.parametrize(
    ("supports", "numbers", "rigid"),
    [
        ((Support(3.0),), (0.5, 1.5, 2.5), 0),
        ((), (1.0, 2.0, 3.0), 1),
        ((Support(3.0, stiffness=1e6), Support(8.0, "clamped")), (1.0, 2.0, 3.0), 0),
    ],
    ids=["held and free", "free", "held at both ends"],
)
def test_twisting_frequencies(
    supports: tuple[Support, ...], numbers: tuple[float, ...], rigid: int
) -> None:
    """Reference: analytic, ω = κ π/L √(G J_t / I), κ = ½, 3/2, …, and (κπh/L)²/24 above."""
    segment = in_space(beam(supports=supports))
    lateral = segment.lateral
    speed = np.sqrt(
        segment.material.shear_modulus * lateral.torsion_constant / lateral.polar_inertia
    )
    expected = np.array(numbers) * np.pi / 5.0 * speed
    series = kantorovich_segment(segment, 14, "complete", False).components["twist"]
    assert series.rigid_modes == rigid
    np.testing.assert_allclose(frequencies(series)[:3], expected, rtol=1e-9)
    errors = []
    for count in (20, 40):
        model = finite_element_segment(segment, 5.0 / count, (), "euler-bernoulli", False)
        twist = model.components["twist"]
        assert twist.rigid_modes == rigid
        errors.append(frequencies(twist)[:3] / expected - 1.0)
    np.testing.assert_allclose(errors[1], (np.array(numbers) * np.pi / 40.0) ** 2 / 24.0, rtol=0.02)
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 2.0, atol=0.03)


def test_a_torque_twists_in_proportion_to_its_arm() -> None:
    """Reference: analytic, T x/(G J_t) up to the torque and constant beyond; exact at nodes."""
    segment = in_space(beam(supports=(Support(3.0),)))
    stiffness = segment.material.shear_modulus * segment.lateral.torsion_constant
    model = finite_element_segment(segment, 1.7, (5.5,), "timoshenko", False).components["twist"]
    rest = np.linalg.solve(model.stiffness, 900.0 * model.at(5.5))
    for x, arm in ((4.0, 1.0), (5.5, 2.5), (7.1, 2.5), (8.0, 2.5)):
        assert model.at(x) @ rest == pytest.approx(900.0 * arm / stiffness, rel=1e-12)


def test_pads_press_as_one_without_roll(spatial_boom: Boom) -> None:
    """Reference: analytic. Under rigid translations of the inner segment along z and y, each
    station has the force of its contact law.
    """
    system = gap_system(touching(spatial_boom, LAW, LATERAL_LAW), beams(spatial_boom))
    up, aside = rigid_motion(system, ""), rigid_motion(system, "_lateral")
    for height, shift in ((8.0e-3, 0.0), (-9.0e-3, 5.5e-3), (7.5e-3, -6.0e-3)):
        gaps = system.rows @ (height * up + shift * aside)
        forces = np.array([law.force(y) for law, y in zip(system.laws, gaps, strict=True)])
        summed = np.bincount(system.station_of_row, forces)
        expected = [LAW.force(np.array(height))] * 2 + [LATERAL_LAW.force(np.array(shift))] * 2
        assert summed == pytest.approx(np.array(expected, dtype=float), rel=1e-9, abs=1e-3)


def rigid_motion(system: GapSystem, suffix: str) -> Array:
    """Return the translation (num_modes,) of the inner segment by 1 m."""
    rigid = system.omega2 == 0.0
    rows = np.array(
        [
            system.observers[name + s].row[rigid]
            for name in ("tip", "tail")
            for s in ("", "_lateral")
        ]
    )
    motion = np.zeros(system.num_modes)
    wanted = [1.0, 0.0] if suffix == "" else [0.0, 1.0]
    # The smallest such motion does not roll.
    motion[rigid] = np.linalg.pinv(rows) @ np.array(2 * wanted)
    return motion


def test_pads_resist_roll(spatial_boom: Boom) -> None:
    """Reference: analytic. A segment in contact along z that rolls by θ stores k b² θ²/8 at each
    station, with half the law at ± b/2. In contact along y it stores k h² θ²/8.
    """
    system = gap_system(touching(spatial_boom, LAW, LATERAL_LAW), beams(spatial_boom))
    inner = spatial_boom.segments[1]
    roll = np.zeros(system.num_modes)
    up, aside = rigid_motion(system, ""), rigid_motion(system, "_lateral")
    # The one rigid motion that neither tip nor tail show: 1/√(I L) of twist in its mode.
    shown = np.abs(up) + np.abs(aside) > 1e-9
    hidden = (system.omega2 == 0.0) & ~shown
    assert hidden.sum() >= 1
    twist = np.flatnonzero(hidden)[-1]
    roll[twist] = np.sqrt(inner.lateral.polar_inertia * inner.length)

    def stored(motion: Array) -> float:
        gaps = system.rows @ motion
        return float(sum(law.energy(y) for law, y in zip(system.laws, gaps, strict=True)))

    theta = 2.0e-3
    for pressed, law, arm in (
        (8.0e-3 * up, LAW, inner.section.width),
        (-6.0e-3 * aside, LATERAL_LAW, inner.section.height),
    ):
        more = stored(pressed + theta * roll) - stored(pressed)
        assert more == pytest.approx(2.0 * law.law.stiffness * arm**2 * theta**2 / 8.0, rel=1e-6)
        # As much to the other side.
        assert stored(pressed - theta * roll) - stored(pressed) == pytest.approx(more, rel=1e-6)


NAMES = ("tip", "head", "tail")


def agree(one: Trajectory, other: Trajectory, suffix: str, of_other: str) -> None:
    """Check that outputs of two runs agree to 1e-9 of their range."""
    for name in NAMES:
        expected = one.data[f"{name}{suffix}"].values
        error = np.abs(other.data[f"{name}{of_other}"].values - expected).max()
        assert error < 1e-9 * np.ptp(expected), name


def test_the_vertical_plane_is_flat_boom(spatial_boom: Boom) -> None:
    """Reference: the flat model, to round-off, which contacts amplify to 3e-8 in 0.5 s."""
    (joint,) = spatial_boom.joints
    flat = replace(spatial_boom, joints=(replace(joint, lateral_play=None),))
    runs = []
    for boom, lateral in ((flat, ()), (spatial_boom, (LATERAL_LAW,))):
        system = gap_system(touching(boom, LAW, lateral), beams(boom))
        runs.append(FixedStep(1.0e-4)(Motion(system, 0.4)))
    plane, space = runs
    assert plane.data.attrs["contact_changes"] > 10
    agree(plane, space, "", "")
    for name in NAMES:
        assert np.abs(space.data[f"{name}_lateral"].values).max() < 1e-15


def test_a_boom_on_its_side_does_the_same_on_its_side(spatial_boom: Boom) -> None:
    """Reference: analytic, the exchange of y and z. Contacts amplify round-off to 1e-13 until
    0.16 s. Later steps with 16 friction rows may have several solutions.
    """
    (joint,) = spatial_boom.joints
    boom = pushed(replace(spatial_boom, joints=(replace(joint, friction=0.2),)), 40.0, 30.0)
    upright = gap_system(touching(boom, LAW, LATERAL_LAW), beams(boom))
    side = rolled(boom)
    lying = gap_system(touching(side, LATERAL_LAW, LAW), beams(side))
    assert len(upright.frictions) == 16
    one, other = (FixedStep(1.0e-4)(Motion(system, 0.15)) for system in (upright, lying))
    assert one.data["friction_loss"].values[-1] > 0.1
    assert one.data.attrs["contact_changes"] > 20
    agree(one, other, "", "_lateral")
    agree(one, other, "_lateral", "")


def test_friction_rubs_in_the_plane_of_contact(paper_boom: Boom) -> None:
    """Reference: external source, (28), with N at each station and the sliding u − w; analytic,
    (10), (11): pads in contact along z rub along y, and conversely.
    """
    (joint,) = paper_boom.joints
    joint = replace(joint, friction=0.2, normal_forces=(4500.0, 5000.0))
    boom = replace(paper_boom, joints=(joint,))
    system = gap_system(touching(boom, LAW), beams(boom))
    np.testing.assert_array_equal(system.friction_rows, system.rows)
    assert [
        (f.coefficient, f.station, f.normal_force, f.normal_rows) for f in system.frictions
    ] == [
        (0.2, 0, 4500.0, ()),
        (0.2, 1, 5000.0, ()),
    ]
    # In space the same forces are shared out to the pads.
    space = replace(
        boom,
        segments=tuple(in_space(segment) for segment in boom.segments),
        joints=(replace(joint, lateral_play=0.01),),
    )
    system = gap_system(touching(space, LAW, LATERAL_LAW), beams(space))
    assert [(friction.station, friction.normal_force) for friction in system.frictions] == [
        (station, n) for station, n in enumerate((1125.0, 1250.0) * 2) for _ in "1234"
    ]
    up, aside = rigid_motion(system, ""), rigid_motion(system, "_lateral")
    free = replace(joint, normal_forces=(), lateral_play=0.01)
    space = touching(replace(space, joints=(free,)), LAW, LATERAL_LAW)
    system = gap_system(space, beams(space))
    for row, friction in zip(system.friction_rows, system.frictions, strict=True):
        (contact,) = friction.normal_rows
        assert friction.station == system.station_of_row[contact]
        along_z = [1.0, 0.0] if friction.station < 2 else [0.0, 1.0]
        pressed = system.rows[contact]
        assert [pressed @ up, pressed @ aside] == pytest.approx(along_z, abs=1e-9)
        assert [row @ aside, row @ up] == pytest.approx(along_z, abs=1e-9)


def test_bonded_in_space_nothing_moves_between_the_segments(spatial_boom: Boom) -> None:
    """Reference: analytic, frequencies of the flat boom, the boom on its side, and twist."""
    boom = pushed(spatial_boom, 5.0, 6.0)
    system = gap_system(boom.bonded, beams(boom))
    assert (system.omega2 > 1.0).all()
    assert not system.laws
    joint = Joint(0, 1, (9.0, 10.0), play=0.0)
    flat = Boom(boom.segments, (joint,))
    side = Boom(tuple(s.turned() for s in boom.segments), (joint,))
    bending = [gap_system(b.bonded, beams(b)).omega2 for b in (flat, side)]
    for omega2 in np.concatenate(bending):
        assert np.abs(system.omega2 / omega2 - 1.0).min() < 1e-9
    assert system.num_modes == sum(b.size for b in bending) + 11 - 2 + 11 - 2
