# SPDX-License-Identifier: LGPL-3.0-or-later
"""What each model says of the boom at rest."""

from dataclasses import replace

import numpy as np
import pytest

from dynamics.contact import PowerContact
from dynamics.drive.row_table import RowTable
from dynamics.drive.travel import Travel
from dynamics.excitation import Excitation, History, PiecewiseLinear, Ramp, Sine
from dynamics.gap_system import GapSystem
from protractile.cases import change
from runs import CASES
from runs.case import reading as case_file
from runs.case.build import build_boom
from runs.case.load_tables import LoadTable
from runs.pipeline.design_results import DesignResults
from runs.pipeline.models import build
from runs.pipeline.static_results import (
    extended_instants,
    extended_positions,
    instants,
    positions,
    static_result,
)
from tests.runs.summaries import answers_of


@pytest.fixture(scope="module")
def answers() -> DesignResults:
    """Of the paper's boom by elements, with play."""
    case = change(case_file.load(str(CASES / "coarse.toml")), **{"time.duration": 0.05})
    models = tuple(model for model in case.models if model.name == "timoshenko")
    return answers_of(case.model_copy(update={"models": models}))


def test_a_joint_tilts_by_its_play(answers: DesignResults) -> None:
    """Reference: by hand. Play of 14 mm over 1 m turns by 14 mrad, what lifts the tip, 10 m on, by
    133 mm; contacts of 1e9 N/m are pressed in by 2.2 and 2.8 µm by the forces of the lever rule.
    """
    (rest,) = answers.models["timoshenko"].static
    (tilt,) = rest.tilts
    assert tilt.rotation == pytest.approx(0.014 + 4.956e-6, abs=1e-8)
    assert tilt.tip == pytest.approx(-0.007 - 2.2e-6 + 10.0 * (0.014 + 4.956e-6), abs=1e-7)
    assert [pressed.force for pressed in rest.stations] == pytest.approx([-2202.8, 2753.5])
    assert [pressed.depth for pressed in rest.stations] == pytest.approx(
        [2.2028e-6, 2.7535e-6], rel=1e-4
    )


def test_play_adds_its_lever_and_no_moment(answers: DesignResults) -> None:
    """Reference: by hand. The boom is statically determinate: its play turns it as a lever does,
    and moments stay what they are without it.
    """
    found = answers.models["timoshenko"]
    (rest,), (bonded,) = found.static, found.static_bonded
    # The bonded boom's stations bend nothing: what is added is the tilt alone.
    assert rest.tip - bonded.tip == pytest.approx(rest.tilts[0].tip, rel=1e-6)
    for one, other in zip(rest.diagrams, bonded.diagrams, strict=True):
        np.testing.assert_allclose(one.curves["moment"], other.curves["moment"], atol=0.1)


def test_support_reactions_follow_the_lever_rule(answers: DesignResults) -> None:
    """Reference: by hand, 831.6 N at 5 m and 550.7 N at 14 m on 0 and 2 m."""
    at_start, at_two = answers.reactions
    assert at_two.force == pytest.approx(-(831.6 * 5.0 + 550.7 * 14.0) / 2.0)
    assert at_start.force == pytest.approx(-831.6 - 550.7 - at_two.force)


def ball(*histories: History) -> GapSystem:
    """1 kg under its weight on a floor of 1e6 N/m, and 20 N upwards by each history."""
    floor, one = PowerContact(1e6, 1.0).lower(), np.ones(1)
    lifted = [Excitation(20.0 * one, history) for history in histories]
    system = GapSystem(0.0 * one, -9.81 * one, one[None], [floor], np.array([0]), [0.0], {})
    return replace(system, excitations=lifted)


def test_loads_are_taken_where_they_are_largest() -> None:
    """Reference: by hand. A ramp has risen at its end, a sine of 1 Hz peaks at 0.25 and 0.75 s."""
    assert instants(ball(), 2.0) == [0.0]
    assert instants(ball(Ramp(0.3)), 2.0) == [0.0, 0.3]
    assert instants(ball(Sine(1.0)), 1.0) == pytest.approx([0.0, 0.25, 0.75], abs=1e-3)


def test_no_swing_of_a_load_is_missed() -> None:
    """Reference: by hand, of 1000 Hz; at every millisecond it is nothing."""
    _, *peaks = instants(ball(Sine(1000.0)), 2.0)
    assert Sine(1000.0)(np.array(peaks)) == pytest.approx([1.0, -1.0], rel=1e-3)


def test_a_drawn_boom_rests_under_the_largest_loads_of_where_it_is() -> None:
    """Reference: by hand. Out from 1 s on, while the second of two peaks comes; in at 3 s."""
    ways = PiecewiseLinear([0.0, 1.0, 2.0, 3.0], [0.0, 4.0, 4.0, -1.0])
    still = RowTable.interpolate(lambda s: np.ones((1, 1)), [-1.0, 4.0])
    drawn = [Travel(ways, still, (("rows", 0),), "")]
    system = ball(PiecewiseLinear([0.0, 0.5, 1.0, 1.5, 2.0], [0.0, 1.0, 0.2, 0.6, 0.3]))
    assert instants(system, 4.0) == [0.0, 0.5]
    assert extended_instants(replace(system, travels=drawn), 4.0) == [1.0, 1.5, 3.0]
    assert extended_instants(system, 4.0) == []


def test_a_load_after_the_drive_bends_the_drawn_boom() -> None:
    """Reference: by hand. Drawn out to 19 m, 2 kN at the tip, 550.7 N at 14 m, 83.16 N/m beyond the
    support at 2 m bend there; play of 14 mm over 1 m turns by 14 mrad, and what presses by more.
    """
    case = case_file.load(str(CASES / "drawn-out.toml"))
    table = ((0.0, 0.0), (5.5, 0.0), (6.0, 1.0))
    late = LoadTable.model_validate(
        {"segment": "inner", "x": "head", "magnitude": 2e3, "table": table}
    )
    case = case.model_copy(update={"loads": (late,)})
    boom, model = build_boom(case), case.models[1]
    built = build(case, boom, model)
    system, lines = built.system.gather_loads(), model.lines(boom, built)
    found = positions(system, instants(system, case.time.duration))
    assert list(found) == [0.0, 6.0]
    assert list(extended_positions(system, case.time.duration)) == [5.0]
    rest = static_result(boom, system, lines, 6.0, found[6.0])
    outer = rest.diagrams[0]
    moment = np.interp(2.0, outer.x, outer.curves["moment"])
    assert abs(moment) == pytest.approx(2e3 * 17.0 + 550.7 * 12.0 + 0.5 * 83.16 * 8.0**2, rel=1e-4)
    # Of 1 m of overlap, 4.5 m before the middle and 9 m before the tip of the inner segment.
    head = 550.7 * 5.0 + 2e3 * 10.0
    pressed = (2.0 * head - 550.7 - 2e3) / 1e9
    assert rest.tilts[0].rotation == pytest.approx(0.014 + pressed, abs=1e-7)
    assert rest.stations[1].force == pytest.approx(head, rel=1e-4)


def test_an_instant_without_rest_is_left_out() -> None:
    """Reference: by hand. The ball rests 9.81 µm deep, flies under 20 N, and 29.81 N press it."""
    found = positions(ball(Sine(1.0)), instants(ball(Sine(1.0)), 1.0))
    assert list(found) == pytest.approx([0.0, 0.75], abs=1e-3)
    np.testing.assert_allclose(np.ravel(list(found.values())), [-9.81e-6, -29.81e-6], rtol=1e-5)
    assert positions(replace(ball(), rows=-np.ones((1, 1)))) == {}
