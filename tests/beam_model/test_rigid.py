# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rigid segments against rigid-body mechanics."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.kantorovich import rigid_segment
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.boom import Boom, PointMass, Support
from tests.touching import touching

LAW = PowerContact(stiffness=2.0e6, exponent=1.0).with_clearance(7.0e-3)


def rigid(boom: Boom, laws: list[PowerContact]) -> GapSystem:
    return gap_system(touching(boom, laws), [rigid_segment(segment) for segment in boom.segments])


@pytest.fixture
def inside(paper_boom: Boom) -> Boom:
    """Return an inner segment in a clamped outer one, with its midpoint between the stations."""
    outer, inner = paper_boom.segments
    return Boom(
        (
            replace(outer, supports=(Support(0.0, "clamped"),)),
            replace(inner, start=2.0, end=10.0, load=-540.0),
        ),
        (replace(paper_boom.joints[0], stations=(4.0, 8.0)),),
    )


def test_a_segment_falls_on_its_contacts_and_bounces(inside: Boom) -> None:
    """Reference: analytic, free fall through the clearance, then half a period on two springs."""
    system = rigid(inside, [LAW])
    assert system.num_modes == 2
    inner = inside.segments[1]
    mass, force = inner.mass_per_length * inner.length, -inner.load * inner.length
    gravity, omega = force / mass, np.sqrt(2.0 * LAW.law.stiffness / mass)
    fall = np.sqrt(2.0 * LAW.above / gravity)
    speed, sag = gravity * fall, force / (2.0 * LAW.law.stiffness)
    contact = 2.0 / omega * (np.pi - np.arctan(speed * omega / gravity))
    lowest = -LAW.above - sag - np.hypot(sag, speed / omega)
    period = 2.0 * fall + contact

    found = FixedStep(2.0e-6)(Motion(system, 4.0 * period, period / 40.0))
    tip = found.data["tip"].values
    assert tip[20::40] == pytest.approx([lowest] * 4, rel=1e-6)
    assert tip[::40] == pytest.approx(np.zeros(5), abs=1e-6 * LAW.above)
    assert found.data["tail"].values == pytest.approx(tip, abs=1e-12)
    assert found.data.attrs["energy_residual"] < 1e-7


def test_the_boom_rests_as_a_lever(paper_boom: Boom) -> None:
    """Reference: analytic, moments of the inner segment's weight about both stations."""
    outer, inner = paper_boom.segments
    held = replace(outer, supports=(Support(0.0), Support(2.0)))
    system = rigid(replace(paper_boom, segments=(held, inner)), [LAW])
    rest = equilibrium(system, system.load)
    forces = [law.force(row @ rest) for law, row in zip(system.laws, system.rows, strict=True)]
    weight, arm = inner.load * inner.length, 0.5 * (inner.start + inner.end)
    assert forces == pytest.approx([weight * (10.0 - arm), weight * (arm - 9.0)], rel=1e-9)
    assert system.observers["head"].row @ rest == 0.0


def test_a_body_swings_on_springs(paper_boom: Boom) -> None:
    """Reference: analytic, bounce and pitch of a symmetric bar with a mass in its middle."""
    stiffness = 3.0e5
    springs = tuple(Support(x, stiffness=stiffness) for x in (1.0, 9.0))
    bar = replace(paper_boom.segments[0], supports=springs, masses=(PointMass(5.0, 400.0),))
    mass = bar.mass_per_length * bar.length + 400.0
    inertia = bar.mass_per_length * bar.length**3 / 12.0 + bar.rotary_inertia * bar.length
    expected = np.sqrt([2.0 * stiffness / mass, 2.0 * stiffness * 4.0**2 / inertia])
    modes = BoomModes(Boom((bar,), ()), [rigid_segment(bar)])
    assert np.sqrt(np.sort(modes.omega2)) == pytest.approx(np.sort(expected), rel=1e-12)


def test_supports_leave_unheld_rigid_motions_free(paper_boom: Boom, spatial_boom: Boom) -> None:
    outer, inner = spatial_boom.segments
    sizes = {
        name: component.load.size for name, component in rigid_segment(inner).components.items()
    }
    assert sizes == {"z": 2, "y": 2, "twist": 1}
    clamped = rigid_segment(replace(outer, supports=(Support(0.0, "clamped"),)))
    assert [component.load.size for component in clamped.components.values()] == [0, 0, 0]
    hinged = rigid_segment(replace(paper_boom.segments[0], supports=(Support(2.0),)))
    row = hinged.components["z"].at(7.0) / hinged.components["z"].at(3.0)
    assert row == pytest.approx([5.0], rel=1e-12)
