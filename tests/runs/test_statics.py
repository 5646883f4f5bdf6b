# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static results of check and of each model."""

from dataclasses import replace
from math import sqrt
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from dynamics.contact import PowerContact
from dynamics.drive.row_table import RowTable
from dynamics.drive.travel import Travel
from dynamics.excitation import Excitation, History, PiecewiseLinear, Ramp, Sine
from dynamics.gap_system import GapSystem
from geometry.fields import Distance
from runs.case.build import build_boom
from runs.case.checked_case import CheckedCase
from runs.case.load_tables import LoadTable
from runs.case.schema import Case, StopTable
from runs.check import check_case
from runs.pipeline.model_quality import cautions
from runs.pipeline.models import build
from runs.pipeline.section_forces import LoadedModel
from runs.pipeline.static_results import (
    extended_instants,
    extended_positions,
    instants,
    positions,
    static_result,
)
from studies.reference_models.statics import static_response
from tests.docs.conftest import toml_blocks
from tests.runs.case_texts import CLAMPED, THIN, box, edited, read_case, shipped
from tests.runs.summaries import model_summary, printed_check, summary_of


def told(case: Case) -> list[str]:
    return [" ".join(line.replace("−", "-").split()) for line in printed_check(case).split("\n")]


def test_masses_forces_and_tips_are_those_of_hand() -> None:
    """Reference: by hand, lever rule, 7 + 14 · 9 mm of play; other code, 9.916 mm."""
    lines = told(shipped("coarse"))
    assert "outer 831.6 0 5" in lines
    assert "all 1382 0 8.586" in lines
    rows = {tuple(line.split()[:2]): line.split()[2:] for line in lines}
    for place, expected in {
        ("outer", "0"): [4.552],
        ("outer", "2"): [-5.934],
        ("inner", "9"): [2.203, 0.0148],
        ("inner", "10"): [-2.7535, 0.0166],
    }.items():
        assert [float(value) for value in rows[place]] == pytest.approx(expected, rel=1e-3)
    # 15 and 17 µm of contact turn the segment, too.
    tips = "Static tip deflection (t = 0) in the beam estimate: 143.2 mm; without play 9.916 mm."
    assert tips in lines
    # What 2.2 and 2.8 kN press contacts of 1e13 N/m² in is in it.
    tilt = (
        "Play rotates 'inner' by 14.03 mrad in 'outer', which moves the tip by 133.3 mm, under the "
        "loads at t = 0 s."
    )
    assert tilt in lines


def test_unequal_plays_are_not_pressed_in() -> None:
    """Reference: by hand, √(F/k) for 2.2 and 2.8 kN on 1e13 N/m², for any play above."""
    case = shipped("coarse")
    (joint,) = case.joints
    joint = replace(joint, play_above=0.001)
    lines = told(case.model_copy(update={"joints": (joint,)}))
    rows = {tuple(line.split()[:2]): line.split()[2:] for line in lines}
    for x, expected in (("9", [2.203, 0.0148]), ("10", [-2.7535, 0.0166])):
        assert [float(value) for value in rows["inner", x]] == pytest.approx(expected, rel=2e-3)


def test_a_boom_without_play_has_no_tilt_and_its_stops_are_its_own() -> None:
    """Reference: by hand. A tip at 9.916 mm compresses a stop of 10 N/m at 5 mm by 4.916 mm."""
    case = shipped("coarse")
    bonded = tuple(model for model in case.models if model.bonded)
    stop = StopTable("inner", Distance(head=0.0), play=0.01, stiffness=10.0)
    lines = told(case.model_copy(update={"models": bonded, "stops": (stop,)}))
    assert not any("nan" in line or line.startswith("Play rotates") for line in lines)
    rows = {tuple(line.split()[:2]): line.split()[2:] for line in lines}
    force, *power, depth = rows["inner", "19"]
    assert power == ["×", "10⁻⁵"]
    assert (float(force), float(depth)) == pytest.approx((-4.916, 4.92), rel=2e-3)
    assert len(rows["inner", "9"]) == len(rows["inner", "10"]) == 1


STIFFENED = f"""
title = "An arm with a doubler and a lid"
time = {{ duration = 1.0 }}
gravity = {{ acceleration = 10.0, angle = 45.0 }}
material = {{ youngs_modulus = 2.1e11, poissons_ratio = 0.3, density = 8000.0 }}
model = [{{ name = "series", kind = "kantorovich", terms = [3], base = "complete" }}]
{box("arm", 6.0, (0.3, 0.2, 0.006, 0.005), CLAMPED)}
collars = [{{ span = [{{ head = 1.0 }}, "head"], thickness = 0.02 }}]
diaphragms = [{{ x = "head", thickness = 0.05 }}]
"""


def test_stiffeners_weigh_across_as_along(tmp_path: Path) -> None:
    """Reference: by hand, plates times density. At 45°, both components are equal."""
    case = read_case(tmp_path, STIFFENED)
    plain = 2.0 * (0.2 * 0.006 + 0.3 * 0.005) * 6.0 * 8000.0
    collar, lid = 1.0 * 0.02 * 8000.0, 0.2 * 0.3 * 0.05 * 8000.0
    weight = (plain + collar + lid) * 10.0 * sqrt(0.5)
    moment = (plain * 3.0 + collar * 5.5 + lid * 6.0) * 10.0 * sqrt(0.5)
    lines = told(case)
    (row,) = (line.split() for line in lines if line.startswith("arm 0 "))
    assert [float(cell) for cell in row[2:]] == pytest.approx(
        [weight / 1e3, weight / 1e3, moment / 1e3], rel=1e-3
    )


def test_series_weigh_and_swing_with_stiffeners_as_elements_do(tmp_path: Path) -> None:
    """Reference: other code, elements with nodes at stiffeners."""
    elements = (
        ', { name = "fe", kind = "finite-element", theory = "euler-bernoulli", '
        "rotary_inertia = false }]"
    )
    text = STIFFENED.replace("}]", "}" + elements, 1).replace("[3]", "[12]")
    case = read_case(tmp_path, text)
    boom = build_boom(case)
    series, beam = (build(case, boom, model).system.gather_loads() for model in case.models)
    tips = [
        float(system.observers["tip"].row @ static_response(system, system.load))
        for system in (series, beam)
    ]
    assert tips[0] == pytest.approx(tips[1], rel=1e-4)
    assert series.frequencies[:2] == pytest.approx(beam.frequencies[:2], rel=1e-3)


def test_a_boom_without_rest_says_so() -> None:
    case = shipped("coarse")
    segments = tuple(s.model_copy(update={"load": 1.0e300}) for s in case.segments)
    lines = told(case.model_copy(update={"segments": segments}))
    assert "There is no static equilibrium under the loads at t = 0." in lines


def test_walls_under_pads_lower_the_tip_as_in_the_shell() -> None:
    """Reference: other code, the shell of the lift at rest, −229.12 mm (−190.18 mm of its beam)."""
    lines = told(shipped("lift"))
    (tip,) = (line for line in lines if line.startswith("Static tip deflection"))
    assert float(tip.split(": ")[1].split()[0]) == pytest.approx(-229.12, rel=0.01)


def test_remedies_for_walls_under_pads_count_under_the_largest_loads() -> None:
    """Reference: the same loads from t = 0 on, without a ramp."""
    case = shipped("lift")
    share, remedies = pad_wall_sentences(case)
    assert share == (
        "Walls bend under pads, which moves the tip by -60.64 of -378.5 mm, 16 %, under the loads "
        "at t = 0.1 s (estimate from plates)."
    )
    assert remedies == (
        "Remedies, with the static tip deflection under these loads (a run with a shell gives "
        "their local plate stresses): pads that bear on the corners, bears = 'corner' (-317.9 mm); "
        "collars on both segments at each pad, as thick as the walls, over half the height of the "
        "box to both sides; two of them per joint obstruct telescoping (-333 mm); "
        "pads half as wide (width), at twice the pressure (-347.8 mm)."
    )
    (load,) = case.loads
    sudden = case.model_copy(update={"loads": (load.model_copy(update={"ramp": None}),)})
    assert pad_wall_sentences(sudden) == [share.replace("0.1 s", "0 s"), remedies]


def test_walls_under_pads_are_the_cause_of_a_large_deflection(tmp_path: Path) -> None:
    """Reference: exact words. A beam has rigid walls, so that its tip has another cause."""
    text = "".join(toml_blocks("tutorial.md")[:3])
    text = edited(text, *THIN, ("magnitude = -1595.0", "magnitude = -2500.0"))
    case = read_case(tmp_path, text)
    cause = "walls under pads cause most of it; change the pads"
    lines = check_case(CheckedCase(case)).lines
    (caution,) = (line for line in lines if "the tip rests" in line)
    assert caution.endswith(f"small-displacement theory is not valid; {cause}")
    names = ["shell", "beam"]
    data = xr.Dataset(
        {"tip": (("model", "time"), np.full((2, 1), -2.0)), "time": [0.0], "model": names}
    )
    summary = summary_of({name: model_summary(static_tip=-0.7) for name in names})
    lines = cautions(case, build_boom(case), data, summary)
    assert [line.rpartition("not valid; ")[2] for line in lines if " tip " in line] == 2 * [
        cause,
        "check units and loads",
    ]


def pad_wall_sentences(case: Case) -> list[str]:
    lines = check_case(CheckedCase(case)).lines
    found = [line for line in lines if line.startswith(("Walls bend", "Remedies"))]
    return [line.replace("−", "-") for line in found]


def ball(*histories: History) -> GapSystem:
    """Return 1 kg under its weight on a floor of 1e6 N/m, and 20 N upwards with each history."""
    floor, one = PowerContact(1e6, 1.0).lower(), np.ones(1)
    lifted = [Excitation(20.0 * one, history) for history in histories]
    system = GapSystem(0.0 * one, -9.81 * one, one[None], [floor], np.array([0]), [0.0], {})
    return replace(system, excitations=lifted)


def test_instants_are_at_extremes_of_loads() -> None:
    """Reference: by hand. A ramp peaks at its end, a sine of 1 Hz at 0.25 and 0.75 s."""
    assert instants(ball(), 2.0) == [0.0]
    assert instants(ball(Ramp(0.3)), 2.0) == [0.0, 0.3]
    assert instants(ball(Sine(1.0)), 1.0) == pytest.approx([0.0, 0.25, 0.75], abs=1e-3)
    # One of 1000 Hz is 0 at every millisecond.
    _, *peaks = instants(ball(Sine(1000.0)), 2.0)
    assert Sine(1000.0)(np.array(peaks)) == pytest.approx([1.0, -1.0], rel=1e-3)


def test_extended_boom_is_under_the_largest_loads_meanwhile() -> None:
    """Reference: by hand. Extended from 1 s, the second of two peaks, retracted at 3 s."""
    ways = PiecewiseLinear([0.0, 1.0, 2.0, 3.0], [0.0, 4.0, 4.0, -1.0])
    still = RowTable.interpolate(lambda s: np.ones((1, 1)), [-1.0, 4.0])
    drawn = [Travel(ways, still, (("rows", 0),), "")]
    system = ball(PiecewiseLinear([0.0, 0.5, 1.0, 1.5, 2.0], [0.0, 1.0, 0.2, 0.6, 0.3]))
    assert instants(system, 4.0) == [0.0, 0.5]
    assert extended_instants(replace(system, travels=drawn), 4.0) == [1.0, 1.5, 3.0]
    assert extended_instants(system, 4.0) == []


def test_a_load_after_the_drive_bends_the_drawn_boom() -> None:
    """Reference: by hand, 2 kN at 19 m, 550.7 N at 14 m, 83.16 N/m, and 14 mrad of play."""
    case = shipped("drawn-out")
    table = ((0.0, 0.0), (5.5, 0.0), (6.0, 1.0))
    late = LoadTable.model_validate(
        {"segment": "inner", "x": "head", "magnitude": 2e3, "table": table}
    )
    case = case.model_copy(update={"loads": (late,)})
    boom, model = build_boom(case), case.models[1]
    built = build(case, boom, model)
    loaded = LoadedModel.of(boom, built.system, model.lines(boom, built))
    system = loaded.system
    found = positions(system, instants(system, case.time.duration))
    assert list(found) == [0.0, 6.0]
    assert list(extended_positions(system, case.time.duration)) == [5.0]
    rest = static_result(loaded, 6.0, found[6.0])
    outer = rest.diagrams[0]
    moment = np.interp(2.0, outer.x, outer.curves["moment"])
    assert abs(moment) == pytest.approx(2e3 * 17.0 + 550.7 * 12.0 + 0.5 * 83.16 * 8.0**2, rel=1e-4)
    # Of 1 m of overlap, 4.5 m before the middle and 9 m before the tip of the inner segment.
    head = 550.7 * 5.0 + 2e3 * 10.0
    pressed = (2.0 * head - 550.7 - 2e3) / 1e9
    assert rest.tilts[0].rotation == pytest.approx(0.014 + pressed, abs=1e-7)
    assert rest.stations[1].force == pytest.approx(head, rel=1e-4)


def test_an_instant_without_rest_is_left_out() -> None:
    """Reference: by hand. 9.81 µm at rest; none under 20 N upwards; under 29.81 N again."""
    found = positions(ball(Sine(1.0)), instants(ball(Sine(1.0)), 1.0))
    assert list(found) == pytest.approx([0.0, 0.75], abs=1e-3)
    np.testing.assert_allclose(np.ravel(list(found.values())), [-9.81e-6, -29.81e-6], rtol=1e-5)
    assert positions(replace(ball(), rows=-np.ones((1, 1)))) == {}
