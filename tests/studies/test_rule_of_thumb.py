# SPDX-License-Identifier: LGPL-3.0-or-later
"""The rule of thumb, compared with the mechanics of its derivation and with shells."""

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from protractile.beam_model.statics import static_state
from protractile.runs.case.build import build_boom
from protractile.runs.pipeline.statics import boom_with_play
from studies.calibrated_beams import EULER, PLAIN, SPRUNG
from studies.rule_of_thumb import (
    BOOMS,
    UNEVEN,
    Proportions,
    Rule,
    Sizes,
    boom_case,
    flange_frequency,
    measure,
)
from studies.working_load import Point


def rule(bending: float, shear: float = 0.0) -> Rule:
    return Rule(bending, shear, 0.0, frequency=2.0, lever=19.0)


def fallen(deflection: float, free: float) -> tuple[float, float, float]:
    """Return peak, speed at equilibrium and period of a unit mass that falls through a free travel
    on a spring under a unit force.
    """
    omega = deflection**-0.5
    amplitude = np.sqrt(deflection**2 + 2.0 * deflection * free)
    caught = np.pi - np.arctan(np.sqrt(2.0 * free / deflection))
    period = 2.0 * (np.sqrt(2.0 * free) + caught / omega)
    return free + deflection + float(amplitude), float(amplitude * omega), float(period)


@pytest.mark.parametrize("play", [0.0, 0.004, 0.014])
def test_the_rule_is_the_derivative_of_a_caught_fall(play: float) -> None:
    """Reference: analytic, differences of peak and period over the deflection."""
    small, deflection = 1e-6, 9.6e-3
    point = Point(play, 1.0)
    beam = rule(deflection * (1.0 - small), deflection * small / (1.0 + UNEVEN))
    (peak, speed, period), (nearer, _, sooner) = (
        fallen(one, 9.5 * play) for one in (deflection, deflection * (1.0 - small))
    )
    assert beam.missing_part(EULER) == pytest.approx(small)
    assert beam.peak_error(EULER, point) == pytest.approx(1.0 - nearer / peak, rel=1e-4)
    # The rule's seconds go with its frequency.
    unit = 1.0 / (4.0 * np.pi * np.sqrt(deflection))
    late = 3.0 * (period - sooner)
    expected = late * speed / peak + (1.0 - nearer / peak)
    assert beam.tip_error(EULER, point, 3.0 * period * unit) == pytest.approx(expected, rel=1e-4)


def test_without_play_the_phase_decides() -> None:
    """Reference: analytic, half of the phase difference π n δ."""
    beam = rule(0.0099, 0.0001)
    missing_part = beam.missing_part(EULER)
    assert beam.tip_error(EULER, Point(0.0, 1.0), 5.0) == pytest.approx(
        missing_part * (1.0 + 0.5 * np.pi * 10.0)
    )
    assert beam.missing_part(PLAIN) == pytest.approx(
        UNEVEN / (1.0 + UNEVEN) * missing_part, rel=0.02
    )


def test_the_first_boom_is_the_paper_s() -> None:
    """Reference: external, Rusiński and Wyciślok 1997, section 4: mass per length and J."""
    segments = build_boom(boom_case(Proportions())).segments
    for segment, mass, second in zip(segments, (83.16, 55.07), (3.7986e-4, 2.1829e-4), strict=True):
        assert segment.mass_per_length == pytest.approx(mass, rel=0.01)
        assert segment.second_moment_of_area == pytest.approx(second, rel=0.01)


def test_flange_frequency_equals_a_strip() -> None:
    """Reference: analytic, Timoshenko's π/2 √(D/ρt)/b² for a plate on two supported sides."""
    case = boom_case(Proportions())
    width, wall = 0.83 * 0.4945 / 1.634, 4.87e-3
    rigidity = 2.1e11 * wall**3 / (12.0 * (1.0 - 0.3**2))
    expected = 0.5 * np.pi * np.sqrt(rigidity / (7850.0 * wall)) / width**2
    assert flange_frequency(case) == pytest.approx(expected)


def test_the_rule_lowers_the_tip_by_walls_as_statics_do() -> None:
    """Reference: other code, beam elements with and without springs of the walls."""
    given = BOOMS["pads"]
    case = boom_case(given)
    boom = boom_with_play(case, build_boom(case))
    soft, rigid = (static_state(boom, walls=factor).tip for factor in (1.0, 0.0))
    assert Rule.of(given, case).pressed == pytest.approx(soft - rigid, rel=3e-3)


@pytest.mark.slow
def test_error_of_a_short_boom_follows_the_rule() -> None:
    """Reference: other code, the shell: within 1 % without play and without shear. Contacts of a
    boom with play are more compliant than the rule takes them, by up to 30 % of the small error of
    Timoshenko beams. Beams with springs are five times nearer than others.
    """
    name = "a third as long"
    sizes = Sizes(booms={name: BOOMS[name]}, mesh_size=0.3, plays=(0.0, 4e-3), periods=2.0)
    found = measure(BOOMS[name], sizes)
    for beam, with_play in ((EULER, 0.02), (PLAIN, 0.3)):
        told = [found.rule.peak_error(beam, point) for point in found.points]
        assert (np.abs(found.peaks[beam] / told - 1.0) < [0.02, with_play]).all()
        assert (found.peaks[SPRUNG] < 0.2 * found.peaks[beam]).all()
