# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beams under axial forces: unstable segments, both planes, bonded booms, static states."""

import numpy as np
import pytest

from protractile.beam_model.boom_modes import ContactPlace, StationCompliance, critical_factor
from protractile.beam_model.kantorovich import rigid_segment
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.static_model import estimate_critical_factor
from protractile.beam_model.statics import static_state
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import Step
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, Joint, Pad, PointMass, Segment, Support
from protractile.geometry.load import Load
from protractile.geometry.profiles import octagon
from tests.beam_model.exact import BUILDS, Build
from tests.booms import ARM, FLY, STEEL
from tests.touching import touching

MAST = (
    octagon(0.56, 0.56, 0.15, 0.007, 0.007, 0.007),
    octagon(0.50, 0.50, 0.135, 0.006, 0.006, 0.006),
)
CLAMP = (Support(0.0, "clamped"),)
LAW = PowerContact(1e9, 1.0).with_clearance(5e-3)


def column(thrust: float, gravity: float = 0.0, **others: object) -> Boom:
    """Return a clamped column of 10 m under a thrust in N and its weight."""
    one = Segment.of_section("column", 0.0, 10.0, STEEL, ARM, supports=CLAMP, **others)
    return Boom(with_compression([one], [], [Thrust(0, 10.0, thrust)], gravity), ())


def telescope(thrust: float) -> Boom:
    """Return a clamped arm and a fly with an overlap of 2 m, with a force at its tip."""
    arm = Segment.of_section("arm", 0.0, 8.0, STEEL, ARM, supports=CLAMP)
    fly = Segment.of_section("fly", 6.0, 14.0, STEEL, FLY, load=-500.0)
    joint = Joint(0, 1, (6.0, 8.0), play=0.01)
    return Boom(with_compression((arm, fly), (joint,), [Thrust(1, 14.0, thrust)]), (joint,))


@BUILDS
def test_segment_held_by_contacts_only_tips_over(build: Build) -> None:
    """Reference: analytic, −P L θ²/2 and m̄ L³ θ̇²/24 of a rotation. Bending changes it by 1e-3."""
    thrust, boom = 5.0e3, telescope(5.0e3)
    fly = boom.segments[1]
    system = gap_system(touching(boom, LAW), build(boom))
    tipping = system.omega2[system.omega2 < 0.0]
    np.testing.assert_allclose(tipping, -12.0 * thrust / (fly.mass_per_length * 8.0**2), rtol=2e-3)
    # Its fall stays what it was, and the arm has none.
    assert np.count_nonzero(system.omega2 == 0.0) == 1
    # Rotary inertia is included in the mass of rigid segments.
    rigid = gap_system(touching(boom, LAW), [rigid_segment(one) for one in boom.segments])
    inertia = fly.mass_per_length * 8.0**3 / 12.0 + fly.rotary_inertia * 8.0
    np.testing.assert_allclose(rigid.omega2.min(), -thrust * 8.0 / inertia, rtol=1e-12)


@BUILDS
def test_soft_walls_at_pads_lower_the_buckling_load(build: Build) -> None:
    """Reference: analytic, P = a²/(2 c L) of a rigid fly on two springs; bending is 0.3 % less."""
    thrust, compliance = 5.0e3, 1.0e-4
    boom = telescope(thrust)
    models = build(boom)
    places = ContactPlace(0, "z", 0), ContactPlace(0, "z", 1)
    soft = critical_factor(boom, models, StationCompliance(places, compliance * np.eye(2)))
    assert soft == pytest.approx(2.0**2 / (2.0 * compliance * 8.0) / thrust, rel=5e-3)
    hard = critical_factor(boom, models, StationCompliance(places, 1.0e-14 * np.eye(2)))
    assert hard == pytest.approx(critical_factor(boom, models), rel=1e-5)


def mast(thrust: float, *loads: Load, lateral_play: float | None = None) -> Boom:
    """Return an octagonal mast on corner pads under an axial force at its tip."""
    segments = (
        Segment.of_section("outer", 0.0, 7.5, STEEL, MAST[0], supports=CLAMP),
        Segment.of_section("inner", 6.2, 13.7, STEEL, MAST[1]),
    )
    pad, contact = Pad(0.2, 0.06, bears="corner"), PowerContact(1e9, 1.0)
    joint = Joint(0, 1, (6.2, 7.5), 0.003, contact=contact, pad=pad, lateral_play=lateral_play)
    compressed = with_compression(segments, (joint,), [Thrust(1, 13.7, thrust)])
    return Boom(compressed, (joint,), loads)


def test_the_estimate_is_the_growth_of_the_tip_on_distorting_sections() -> None:
    """Reference: the tip of the same beam under growing axial forces, by Southwell's plot (1932).

    The forces of both stations distort the sections together, and pads have their centres half
    their length within the overlap. Without both, the estimate is 1.6 times as large.
    """
    push = Load(1, "z", -2000.0, 13.7, Step())
    estimate = estimate_critical_factor(mast(1.0e5, push))
    assert estimate is not None
    parts = 1.0e5 * np.array([0.0, 0.9, 0.97]) * estimate
    tips = np.array([static_state(mast(thrust, push)).tip for thrust in parts])
    growth = tips[1:] - tips[0]
    critical = np.diff(growth)[0] / np.diff(growth / parts[1:])[0]
    assert 1.0e5 * estimate == pytest.approx(critical, rel=0.02)


def test_a_square_column_without_loads_across_it_buckles_as_in_a_plane() -> None:
    """Reference: analytic, the symmetry of a square section; the factor was 1.85 for 3.13."""
    flat, spatial = (
        estimate_critical_factor(mast(1.0e5, lateral_play=play)) for play in (None, 0.003)
    )
    assert spatial == pytest.approx(flat, rel=1e-6)


@BUILDS
def test_weights_of_point_masses_press(build: Build) -> None:
    """Reference: analytic, Euler's and Greenhill's cantilevers (Timoshenko and Gere 1961)."""
    boom = column(0.0, gravity=9.80665, masses=(PointMass(10.0, 5.0e4),))
    (segment,) = boom.segments
    factor = critical_factor(boom, build(boom))
    of_mass = 5.0e4 * 9.80665 * 10.0**2 / (0.25 * np.pi**2 * segment.bending_stiffness)
    own = segment.mass_per_length * 9.80665 * 10.0**3 / (7.8373474 * segment.bending_stiffness)
    assert factor == pytest.approx(1.0 / (of_mass + own), rel=5e-3)
