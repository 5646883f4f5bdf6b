# SPDX-License-Identifier: LGPL-3.0-or-later
"""The automatic step resolves contact, sliding and excitations, and fits the output."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from dynamics.integrators.step import (
    PHASE,
    closing_speeds,
    contact_frequencies,
    contact_step,
    sliding_frequencies,
)

from dynamics.contact import PowerContact
from dynamics.excitation import Excitation, Ramp, Sine, Table
from dynamics.friction import DryFriction
from dynamics.gap_system import GapSystem


def test_closing_speeds_by_hand(one_mass: Callable[..., GapSystem]) -> None:
    """Reference: analytic. A step load swings a spring mass at F/√(k m); a free one falls 2Δ."""
    law = PowerContact(stiffness=1.0e6, exponent=1.0, clearance=0.2)
    swinging = one_mass(4.0, law, spring=100.0, force=30.0)
    assert closing_speeds(swinging) == pytest.approx([1.5], rel=1e-14)
    falling = one_mass(4.0, law, force=-40.0)
    assert closing_speeds(falling) == pytest.approx([np.sqrt(2.0 * 10.0 * 0.4)], rel=1e-14)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
def test_contact_frequency_by_hand(one_mass: Callable[..., GapSystem], exponent: float) -> None:
    """Reference: analytic. Penetration from k pⁿ⁺¹/(n+1) = ½ m (2v)², then √(n k pⁿ⁻¹/m)."""
    law = PowerContact(2.0e6, exponent, clearance=0.2, stiffness_below=5.0e6)
    system = one_mass(4.0, law, force=-40.0)
    energy = 0.5 * 4.0 * (2.0 * closing_speeds(system)[0]) ** 2
    (frequency,) = contact_frequencies(system)
    depth = (frequency**2 * 4.0 / (exponent * 5.0e6)) ** (1.0 / (exponent - 1.0)) if (
        exponent > 1.0
    ) else np.sqrt(2.0 * energy / 5.0e6)  # fmt: skip
    assert law.lower().energy(np.array(-0.2 - depth)) == pytest.approx(energy, rel=1e-9)
    assert frequency == pytest.approx(
        np.sqrt(exponent * 5.0e6 * depth ** (exponent - 1.0) / 4.0), rel=1e-9
    )


def test_step_is_a_whole_part_of_the_output_step(one_mass: Callable[..., GapSystem]) -> None:
    """Reference: analytic, √(k/m) = 500 rad/s for a linear stop: at most 0.03/500 s."""
    system = one_mass(4.0, PowerContact(1.0e6, 1.0, 0.2), force=-40.0)
    for output_step in (1.0e-3, 0.7e-3, 1.0e-5):
        step = contact_step(system, output_step)
        parts = output_step / step
        assert parts == pytest.approx(round(parts), rel=1e-12)
        assert step * 500.0 <= PHASE * (1.0 + 1e-12)
        assert output_step / (round(parts) - 1) * 500.0 > PHASE if round(parts) > 1 else True


def test_without_contact_the_output_step_serves(one_mass: Callable[..., GapSystem]) -> None:
    assert contact_step(one_mass(1.0, spring=1.0e12), 0.1) == 0.1


def test_a_soft_contact_leaves_the_step_to_the_stiffest_mode(
    one_mass: Callable[..., GapSystem],
) -> None:
    """Reference: analytic, 1/ω: far from half a period, at which impulses pump a mode."""
    stop = PowerContact(stiffness=1.0e-3, exponent=2.0, clearance=0.1)
    system = one_mass(1.0, stop, spring=4.0e8, force=1.0)
    assert contact_step(system, 1.0e-3) == pytest.approx(1.0 / 2.0e4, rel=1e-12)


def test_excitations_count_with_their_largest_value(one_mass: Callable[..., GapSystem]) -> None:
    """Reference: analytic. 30 N and 2 · 5 N swing 4 kg on 100 N/m at (30 + 10)/√(400) m/s; without
    a spring they fall at 10 m/s²."""
    law = PowerContact(stiffness=1.0e6, exponent=1.0, clearance=0.2)
    for spring, expected in ((100.0, 2.0), (0.0, np.sqrt(2.0 * 10.0 * 0.4))):
        system = one_mass(4.0, law, spring=spring, force=-30.0)
        load = 5.0 * system.observers["tip"].row
        system = replace(system, excitations=[Excitation(load, Table((0.0, 1.0), (0.5, -2.0)))])
        assert closing_speeds(system) == pytest.approx([expected], rel=1e-14)


def test_an_excitation_is_resolved(one_mass: Callable[..., GapSystem]) -> None:
    """Reference: analytic, 2π · 50 Hz times the step is at most the phase; straight lines are exact
    at any."""
    system = one_mass(4.0, spring=100.0)
    load = np.ones(1)
    for history, fastest in ((Sine(50.0), 100.0 * np.pi), (Ramp(1.0e-4), 0.0)):
        step = contact_step(replace(system, excitations=[Excitation(load, history)]), 1.0e-2)
        assert step == 1.0e-2 / max(1.0, np.ceil(1.0e-2 * fastest / PHASE))


def test_sliding_is_resolved() -> None:
    """Reference: analytic. Speeds |Q|/ω of 2, 1 and an initial 3 in a row of 1, 2, 0.5."""
    omega = np.array([3.0, 8.0, 20.0])
    system = GapSystem(
        omega2=omega**2,
        load=np.array([6.0, 8.0, 0.0]),
        rows=np.zeros((0, 3)),
        laws=[],
        station_of_row=np.zeros(0, dtype=np.int64),
        stations=[0.0],
        observers={},
        friction_rows=np.array([[1.0, -2.0, 0.5], [0.0, 0.0, 1.0]]),
        frictions=[DryFriction(0.2, 0, 10.0)] * 2,
    )
    initial = np.array([0.0, 0.0, 3.0])
    expected = [(2.0 * 3.0 + 2.0 * 8.0 + 1.5 * 20.0) / (2.0 + 2.0 + 1.5), 20.0]
    assert sliding_frequencies(system, initial) == pytest.approx(expected, rel=1e-14)
    # Nothing moves the second row from rest; the highest mode then still limits the step.
    assert sliding_frequencies(system) == pytest.approx([5.5, 0.0], rel=1e-14)
    assert contact_step(system, 1.0) == pytest.approx(1.0 / np.ceil(5.5 / PHASE), rel=1e-12)
    assert contact_step(system, 1.0, phase=0.5) == pytest.approx(1.0 / 20.0, rel=1e-12)
