# SPDX-License-Identifier: LGPL-3.0-or-later
"""Linear dashpots at joints, across the play, at supports and along cylinders."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import find_peaks

from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.kantorovich import rigid_segment
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import closed_contact_damping
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import AdaptiveStep
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, BoomError, Cylinder, Joint, Material, Pad, Support
from tests.beam_model.exact import beam, beam_elements
from tests.touching import touching

SPRING, DASHPOT = 2.0e6, 900.0
# A spring both ways, since no play is between its sides.
BOTH_WAYS = PowerContact(SPRING, exponent=1.0).with_clearance(0.0)


def decrements(system: GapSystem, position: Array, duration: float, name: str) -> Array:
    """Return the logarithmic decrements of successive maxima of an output about 0."""
    run = AdaptiveStep()(Motion(system, duration, 1e-4, position))
    swing = run.data[name].values
    peaks, _ = find_peaks(swing)
    # The parabola through three points finds the maximum between two outputs.
    before, at, after = (swing[peaks + shift] for shift in (-1, 0, 1))
    heights = at + 0.125 * (after - before) ** 2 / (2.0 * at - before - after)
    return -np.diff(np.log(heights))


def test_a_rigid_segment_on_two_stations_loses_its_swing() -> None:
    """Reference: analytic. On two springs and two dashpots ζ = c/√(2km), δ = 2πζ/√(1 − ζ²)."""
    outer = beam(name="outer", start=0.0, end=4.0, supports=(Support(0.0, "clamped"),))
    inner = beam(name="inner", start=3.0, end=4.0, section=None)
    joint = Joint(0, 1, stations=(3.25, 3.75), play=0.0, dashpot=DASHPOT)
    boom = Boom((outer, inner), (joint,))
    system = gap_system(touching(boom, BOTH_WAYS), [rigid_segment(one) for one in boom.segments])
    mass = inner.mass_per_length * inner.length
    ratio = DASHPOT / np.sqrt(2.0 * SPRING * mass)
    assert 0.01 < ratio < 0.1
    raised = np.linalg.lstsq(system.rows, np.full(2, 1e-3), rcond=None)[0]
    expected = 2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2)
    found = decrements(system, raised, 0.5, "tip")
    assert found.size > 5
    assert found == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("held", ["support", "cylinder"])
def test_a_rigid_segment_on_its_hinge_loses_its_swing(held: str) -> None:
    """Reference: analytic, ζ = c r / 2√(k I) and δ = 2πζ/√(1 − ζ²) with the lever arm r about the
    hinge at (3, −0.25) m. The cylinder is between (1.4, −2) and (6, −0.5) m.
    """
    supports, cylinders = [Support(3.0, depth=0.25 if held == "cylinder" else 0.0)], []
    if held == "support":
        arm, damping = 2.5, 4.0e3
        supports.append(Support(5.5, stiffness=SPRING, dashpot=damping))
    else:
        line = np.array([4.6, 1.5]) / np.hypot(4.6, 1.5)
        # (6 − 3, −0.5 + 0.25) × line
        arm, damping = 3.0 * line[1] + 0.25 * line[0], 8.0e3
        cylinders.append(
            Cylinder(0, 6.0, depth=0.5, ground=(1.4, -2.0), stiffness=SPRING, dashpot=damping)
        )
    segment = beam(supports=supports)
    boom = Boom((segment,), (), cylinders=tuple(cylinders))
    system = gap_system(boom, [rigid_segment(segment)])
    mass = segment.mass_per_length * segment.length
    inertia = mass * segment.length**2 / 3.0 + segment.rotary_inertia * segment.length
    omega = arm * np.sqrt(SPRING / inertia)
    assert np.sqrt(system.omega2) == pytest.approx([omega], rel=1e-9)
    ratio = 0.5 * damping * arm / np.sqrt(SPRING * inertia)
    assert 0.005 < ratio < 0.1
    found = decrements(system, np.ones(1), 12.5 * 2.0 * np.pi / omega, "tip")
    assert found.size > 8
    assert found == pytest.approx(2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2), rel=1e-4)
    hertz, ratios = closed_contact_damping(system)
    assert (hertz, ratios) == (pytest.approx([omega / (2.0 * np.pi)]), pytest.approx([ratio]))


def test_a_nearly_rigid_bar_on_a_dashpot_loses_its_swing() -> None:
    """Reference: analytic, the rigid bar: ζ = c r / 2√(k I). Bending has much higher frequencies;
    the default step must not cause damping by them.
    """
    arm, damping, spring = 10.0, 1.0e3, 2.0e5
    stiff = Material(youngs_modulus=2.1e15, poissons_ratio=0.3, density=7850.0)
    supports = (Support(0.0), Support(arm, stiffness=spring, dashpot=damping))
    segment = replace(beam(start=0.0, end=arm, supports=supports), material=stiff)
    boom = Boom((segment,), ())
    system = gap_system(boom, finite_element_segments(boom, 1.0, "timoshenko", True))
    mass = segment.mass_per_length * arm
    inertia = mass * arm**2 / 3.0 + segment.rotary_inertia * arm
    omega, ratio = arm * np.sqrt(spring / inertia), 0.5 * damping * arm / np.sqrt(spring * inertia)
    assert 0.02 < ratio < 0.06
    first = np.eye(system.num_modes)[np.argmin(system.omega2)]
    found = decrements(system, first, 8.5 * 2.0 * np.pi / omega, "tip")
    assert found.size > 5
    assert found == pytest.approx(2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2), rel=2e-3)


@pytest.mark.parametrize("spatial", [False, True], ids=["flat", "in space"])
def test_a_dashpot_reads_the_axis(
    paper_boom: Boom, spatial_boom: Boom, paper_law: PowerContact, spatial: bool
) -> None:
    """Reference: analytic, √c (u − w) at each station along each direction."""
    boom = spatial_boom if spatial else paper_boom
    (joint,) = boom.joints
    boom = replace(boom, joints=(replace(joint, dashpot=DASHPOT),))
    models = finite_element_segments(boom, 2.0, "euler-bernoulli", rotary_inertia=False)
    system = gap_system(touching(boom, paper_law, paper_law), models)
    modes = BoomModes(boom, models)
    expected = [
        np.sqrt(DASHPOT) * (modes.displacement(1, x, along) - modes.displacement(0, x, along))
        for along in boom.directions
        for x in joint.stations
    ]
    np.testing.assert_allclose(system.dashpots, expected, atol=1e-12)


def test_dashpots_and_pads_take_no_part_in_a_bonded_boom(
    paper_boom: Boom,
) -> None:
    """Reference: the same boom without them, to the last bit."""
    (joint,) = paper_boom.joints
    there = replace(joint, dashpot=DASHPOT, pad=Pad(0.2, 0.06))
    dragged = replace(paper_boom, joints=(there,))
    models = beam_elements(paper_boom, 1.0)
    bare, bonded = (gap_system(boom.bonded, models) for boom in (paper_boom, dragged))
    np.testing.assert_array_equal(bonded.frequencies, bare.frequencies)
    assert not bonded.damping.any()
    assert not bonded.dashpots.any()
    what = "the joint is bonded, and nothing moves; leave it out"
    with pytest.raises(BoomError, match=rf"^joints\[0\]\.dashpot: {re.escape(what)}$"):
        replace(paper_boom, joints=(replace(joint, bonded=True, dashpot=1.0),))
    with pytest.raises(BoomError, match=r"^Joint.dashpot: must be a number not less than 0"):
        replace(joint, dashpot=-1.0)
