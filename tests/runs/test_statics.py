# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static results of check and of each model, the effect of play, and contacts without play."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt
from pathlib import Path

import numpy as np
import pytest

from protractile.analysis.bonded import bonded_system
from protractile.analysis.curves import diagrams
from protractile.analysis.equilibria import (
    equilibria,
    extended_equilibria,
    extended_instants,
    instants,
)
from protractile.analysis.measure import measure_boom
from protractile.analysis.model import AnalysisModel
from protractile.analysis.rows import BEAM, FARTHEST, INITIAL, MOTION, REST, Rows
from protractile.analysis.states import States
from protractile.cases import change
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Excitation, History, PiecewiseLinear, Ramp, Sine, Step
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.travel import RowTable, Travel
from protractile.geometry.place import Distance
from protractile.runs.case.build import build_boom
from protractile.runs.case.load_tables import LoadTable
from protractile.runs.case.reading import select
from protractile.runs.case.schema import Case, StopTable, TimeTable
from protractile.runs.pipeline.combinations import combination_states
from protractile.runs.pipeline.model_quality import quality_notes
from protractile.runs.pipeline.models import build
from protractile.runs.pipeline.results import Results
from studies.reference_models.statics import static_response
from tests.modal import modal_system
from tests.runs.case_texts import CLAMPED, box, elements, read_case, shipped, table
from tests.runs.summaries import answers_of, model_summary, printed_check, summary_of


def told(case: Case) -> list[str]:
    return [" ".join(line.replace("−", "-").split()) for line in printed_check(case).split("\n")]


def test_masses_forces_and_tips_are_those_of_hand() -> None:
    """Reference: by hand, lever rule, 7 + 14 · 9 mm of play; other code, 9.916 mm."""
    lines = told(shipped("coarse"))
    assert "outer 831.6 0 5" in lines
    assert "all 1382 0 8.586" in lines
    rows = {tuple(line.split()[:2]): line.split()[2:] for line in lines}
    for place, expected in {
        ("outer", "0"): [4.552], ("outer", "2"): [-5.934],
        ("inner", "9"): [2.203, 0.0148], ("inner", "10"): [-2.7535, 0.0166],
    }.items():  # fmt: skip
        assert [float(value) for value in rows[place]] == pytest.approx(expected, rel=1e-3)
    # 15 and 17 µm of contact, in which 2.2 and 2.8 kN press, turn the segment, too.
    assert {
        "Static tip deflection (t = 0) in the beam estimate: 143.2 mm; without play 9.916 mm.",
        "Play rotates 'inner' by 14.03 mrad in 'outer', which moves the tip by 133.3 mm, under the "
        "loads at t = 0 s.",
    } <= {*lines}
    heavy = tuple(s.model_copy(update={"load": 1.0e300}) for s in shipped("coarse").segments)
    lines = told(shipped("coarse").model_copy(update={"segments": heavy}))
    assert "There is no static equilibrium under the loads at t = 0." in lines


def test_a_boom_without_play_has_no_tilt_and_its_stops_are_its_own() -> None:
    """Reference: by hand. A tip at 9.916 mm compresses a stop of 10 N/m at 5 mm by 4.916 mm."""
    case = shipped("coarse")
    bonded = tuple(model for model in case.models if model.bonded)
    (state,) = combination_states(case.model_copy(update={"models": bonded}))
    (tip,) = state.rows.where(quantity="tip")
    assert tip.value == pytest.approx(9.916e-3, rel=1e-3)
    stop = StopTable("inner", Distance(head=0.0), play=0.01, stiffness=10.0)
    lines = told(case.model_copy(update={"models": bonded, "stops": (stop,)}))
    assert not any("nan" in line or line.startswith("Play rotates") for line in lines)
    rows = {tuple(line.split()[:2]): line.split()[2:] for line in lines}
    force, *_, depth = rows["inner", "19"]
    assert (float(force), float(depth)) == pytest.approx((-4.916, 4.92), rel=2e-3)
    assert len(rows["inner", "9"]) == len(rows["inner", "10"]) == 1


STIFFENED = f"""
title = "An arm with a doubler and a lid"
time = {{ duration = 1.0 }}
gravity = {{ acceleration = 10.0, angle = 45.0 }}
material = {{ youngs_modulus = 2.1e11, poissons_ratio = 0.3, density = 8000.0 }}
{table("[[model]]", name="series", kind="kantorovich", terms=[12], base="complete")}
{elements("fe", theory="euler-bernoulli", rotary_inertia=False)}
{box("arm", 6.0, (0.3, 0.2, 0.006, 0.005), CLAMPED)}
collars = [{{ span = [{{ head = 1.0 }}, "head"], thickness = 0.02 }}]
diaphragms = [{{ x = "head", thickness = 0.05 }}]
"""


def test_stiffeners_weigh_across_as_along(tmp_path: Path) -> None:
    """Reference: by hand, plates times density; other code, elements with nodes at stiffeners.

    At 45°, both components are equal.
    """
    case = read_case(tmp_path, STIFFENED)
    plain = 2.0 * (0.2 * 0.006 + 0.3 * 0.005) * 6.0 * 8000.0
    collar, lid = 1.0 * 0.02 * 8000.0, 0.2 * 0.3 * 0.05 * 8000.0
    weight = (plain + collar + lid) * 10.0 * sqrt(0.5)
    moment = (plain * 3.0 + collar * 5.5 + lid * 6.0) * 10.0 * sqrt(0.5)
    (row,) = (line.split() for line in told(case) if line.startswith("arm 0 "))
    assert [float(cell) for cell in row[2:]] == pytest.approx(
        [weight / 1e3, weight / 1e3, moment / 1e3], rel=1e-3
    )
    boom = build_boom(case)
    series, beam = (build(case, boom, model).system.gather_loads() for model in case.models)
    of_series, of_beam = (
        one.observers["tip"].row @ static_response(one, one.load) for one in (series, beam)
    )
    assert of_series == pytest.approx(of_beam, rel=1e-4)
    assert series.frequencies[:2] == pytest.approx(beam.frequencies[:2], rel=1e-3)


def ball(*histories: History) -> GapSystem:
    """Return 1 kg under its weight on a floor of 1e6 N/m, and 20 N upwards with each history."""
    floor, one = PowerContact(1e6, 1.0).lower(), np.ones(1)
    lifted = [Excitation(20.0 * one, history) for history in histories]
    system = GapSystem(0.0 * one, -9.81 * one, one[None], [floor], np.array([0]), [0.0], {})
    return replace(system, excitations=lifted)


def test_instants_are_at_extremes_of_loads() -> None:
    """Reference: by hand. A ramp peaks at its end, a sine of 1 Hz at 0.25 and 0.75 s; a boom
    extended from 1 s and retracted at 3 s has the second of two peaks, too.
    """
    assert instants(ball(), 2.0) == [0.0]
    assert instants(ball(Ramp(0.3)), 2.0) == [0.0, 0.3]
    assert instants(ball(Sine(1.0)), 1.0) == pytest.approx([0.0, 0.25, 0.75], abs=1e-3)
    # One of 1000 Hz is 0 at every millisecond.
    _, *peaks = instants(ball(Sine(1000.0)), 2.0)
    assert Sine(1000.0)(np.array(peaks)) == pytest.approx([1.0, -1.0], rel=1e-3)
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
    history = ((0.0, 0.0), (5.5, 0.0), (6.0, 1.0))
    late = LoadTable.model_validate(
        {"segment": "inner", "x": "head", "magnitude": 2e3, "table": history}
    )
    case = case.model_copy(update={"loads": (late,)})
    boom, model = build_boom(case), case.models[1]
    built = build(case, boom, model)
    loaded = AnalysisModel.of(boom, built.system, model.lines(boom, built))
    system = loaded.system
    found = equilibria(system, instants(system, case.time.duration))
    assert list(found) == [0.0, 6.0]
    assert list(extended_equilibria(system, case.time.duration)) == [5.0]
    rest = States.of(loaded, {6.0: found[6.0]})
    (outer, *_) = diagrams(rest, "beam", "rest")
    moment = np.interp(2.0, outer.x, outer.values["moment"])
    assert abs(moment) == pytest.approx(2e3 * 17.0 + 550.7 * 12.0 + 0.5 * 83.16 * 8.0**2, rel=1e-4)
    # Of 1 m of overlap, 4.5 m before the middle and 9 m before the tip of the inner segment.
    head = 550.7 * 5.0 + 2e3 * 10.0
    pressed = (2.0 * head - 550.7 - 2e3) / 1e9
    measured = {(one.quantity, one.place): one.values.item() for one in measure_boom(rest)}
    assert measured["rotation", "in outer"] == pytest.approx(0.014 + pressed, abs=1e-7)
    assert measured["contact_force", "station 2"] == pytest.approx(head, rel=1e-4)


def test_an_instant_without_rest_is_left_out() -> None:
    """Reference: by hand. 9.81 µm at rest; none under 20 N upwards; under 29.81 N again."""
    found = equilibria(ball(Sine(1.0)), instants(ball(Sine(1.0)), 1.0))
    assert list(found) == pytest.approx([0.0, 0.75], abs=1e-3)
    np.testing.assert_allclose(np.ravel(list(found.values())), [-9.81e-6, -29.81e-6], rtol=1e-5)
    assert equilibria(replace(ball(), rows=-np.ones((1, 1)))) == {}


@pytest.fixture(scope="module")
def answers() -> Results:
    """Return the results of a series and elements with play, and of bonded elements."""
    names = ["kantorovich-5", "beam-fe", "beam-fe-bonded"]
    return answers_of(change(select(shipped("coarse"), "", names), **{"time.duration": 0.3}))


def added(results: Results, model: str, state: str, quantity: str) -> tuple[float, float]:
    """Return what play adds to the first result of a quantity, and the result without play."""
    rows = results.rows.where(model=model, state=state, quantity=quantity)
    with_play, without = (abs(rows.where(play=play)[0].value) for play in (True, False))
    return with_play - without, without


def test_play_adds_its_lever_at_rest_and_no_moment(answers: Results) -> None:
    """Reference: by hand. 14 mrad of play and 5 µrad of contacts are 133 mm and 47 µm."""
    without_play = answers.rows.where(play=False)
    assert {row.model for row in without_play} == {"kantorovich-5", "beam-fe", BEAM}
    increase, _ = added(answers, "beam-fe", REST, "tip")
    assert increase == pytest.approx(0.133 + 10.0 * 4.956e-6 - 2.2e-6, abs=1e-7)
    assert added(answers, "kantorovich-5", REST, "tip")[0] == pytest.approx(0.133, rel=5e-3)
    # The stations of the bonded boom bend nothing: what is added is the tilt alone.
    rest = answers.rows.where(model="beam-fe", play=True, state=FARTHEST)
    (tilt,) = rest.where(quantity="rotation_tip")
    assert increase == pytest.approx(abs(tilt.value), rel=1e-6)
    depths = [row.value for row in rest.where(quantity="penetration")]
    assert depths == pytest.approx([2.2028e-6, 2.7535e-6], rel=1e-4)
    curves = answers.curves.where(model="beam-fe", state=REST)
    for one, other in zip(curves.where(play=True), curves.where(play=False), strict=True):
        np.testing.assert_allclose(one.values["moment"], other.values["moment"], atol=0.1)


def test_motions_are_held_against_those_without_play(answers: Results) -> None:
    """Reference: other model, the bonded model of the case with the same elements."""
    moved = answers.rows.where(state=MOTION)
    own = moved.where(model="beam-fe", play=False)
    bonded = moved.where(model="beam-fe-bonded", play=True)
    assert not moved.where(model="beam-fe-bonded", play=False)
    for row, other in zip(own, bonded, strict=True):
        assert row.key == other.key
        assert row.value == pytest.approx(other.value, rel=1e-6)
    largest = abs(moved.where(model="beam-fe", play=True, quantity="tip")[0].value)
    increase, without = added(answers, "beam-fe", MOTION, "tip")
    assert increase == pytest.approx(largest - without, rel=1e-6)
    assert own.where(quantity="stress", part="inner")


def test_notes_name_models_that_are_chaotic_or_need_many_steps(answers: Results) -> None:
    """Reference: by hand, ensembles with and without divergence; a fixed step has no tolerance."""

    def ensemble(time: float | None) -> dict[str, object]:
        return {"horizons": {"0.2": time}, "energy_residual": 1e-6, "slow_peaks": None}

    models = {
        "wild": model_summary(ensemble=ensemble(3.2), step_error=0.34),
        "calm": model_summary(ensemble=ensemble(None), energy_residual=2e-4, step_error=9e-4),
    }
    ten = TimeTable(duration=10.0)
    notes = [*quality_notes(summary_of(models), Rows(), None, ten)]
    assert [note.what for note in notes] == ["horizon", "horizon", "step", "energy"]
    chaotic, regular, step, energy = (note.line for note in notes)
    error = "The estimated error by the time step is at most 34 % of the range of a deflection."
    assert step == (
        f"{error} It is above time.tolerance of 0.1 % in wild: the motion is chaotic, or needs too "
        "many steps."
    )
    assert "after these times: wild 3.20 s." in chaotic
    assert regular == "The motion of calm can be predicted over the whole 10 s."
    assert energy.endswith("in every model; calm has the largest error.")
    fixed = quality_notes(summary_of(models), Rows(), None, TimeTable(duration=10.0, step=1e-5))
    assert [note.line for note in fixed if note.what == "step"] == [error]
    # Of the run, the static tips of both models.
    tips = answers.rows.where(play=True, state=INITIAL, quantity="tip")
    series, beam = (tips.where(model=name)[0].value for name in ("kantorovich-5", "beam-fe"))
    off = f"{100.0 * (series / beam - 1.0):+.2g}".replace("-", "−")
    design = answers.summary.design
    (agreement,) = (note.line for note in design.quality_notes if note.what == "agreement")
    assert agreement.startswith(
        f"kantorovich-5 differs from beam-fe by {off} % in the static tip deflection, "
    )


LAW = PowerContact(1e6, 1.0).with_clearance(0.01)


def test_the_bonded_boom_lacks_the_play_alone() -> None:
    """Reference: by hand, 1 kg on 100 N/m, 1 kg in it under 5 N with plays of 10 mm, and a stop.

    −5/100 m, with play 10 mm and 5 µm lower, and √(100/2) rad/s together. Axial forces take 30 of
    100 N/m. −100 N move both down to the stop by 0.5 m and (100 − 50)/(1e5 + 100) m.
    """
    pair = modal_system(
        [100.0, 0.0],
        [0.0, -5.0],
        [[-1.0, 1.0], [0.0, 1.0]],
        [LAW, PowerContact(1e5, 1.0).with_clearance(0.5)],
        tip=[0.0, 1.0],
        stations=[1.0, 2.0],
        grounded=[1],
        excitations=[Excitation(np.array([1.0, 0.0]), Step())],
    )
    rest = equilibrium(pair, pair.load)
    bonded, basis = bonded_system(pair, [rest])
    hung = equilibrium(bonded, bonded.load)
    np.testing.assert_allclose(basis @ hung, [-0.05, -0.05], rtol=1e-9)
    tip = bonded.observers["tip"].row @ hung
    assert pair.observers["tip"].row @ rest - tip == pytest.approx(-0.01 - 5e-6, rel=1e-6)
    np.testing.assert_allclose(bonded.omega2, [50.0], rtol=1e-12)
    np.testing.assert_allclose(basis @ bonded.excitations[0].load, [0.5, 0.5], rtol=1e-12)
    # So is all where nothing presses.
    np.testing.assert_allclose(bonded_system(pair, [])[0].omega2, [50.0], rtol=1e-12)
    assert (list(bonded.stations), list(bonded.grounded)) == ([2.0], [0])
    deep = basis @ equilibrium(bonded, np.array([0.0, -100.0]) @ basis)
    assert deep[1] == pytest.approx(-0.5 - 50.0 / (1e5 + 100.0), rel=1e-6)
    pressed = replace(pair, geometric_stiffness=np.diag([30.0, 0.0]))
    softer, _ = bonded_system(pressed, [equilibrium(pressed, pressed.load)])
    np.testing.assert_allclose(softer.omega2, [35.0], rtol=1e-12)
    assert softer.in_own_modes() is softer


def test_lateral_contacts_of_both_walls_are_bonded() -> None:
    """Reference: by hand. 5 N bulge walls by 50 mm, 4 N press at the right; 1 N moves 1/4 m."""
    law = PowerContact(1e5, 1.0).with_clearance(0.08)
    system = modal_system(
        [100.0, 100.0, 4.0],
        [4.0, 5.0, 1.0],
        [[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        [law, law],
        station_of_row=np.array([0, 0]),
        stations=[1.0],
        station_directions=("y",),
    )
    rest = equilibrium(system, system.load)
    assert [bool(law.force(gap)) for gap in system.rows @ rest] == [True, False]
    bonded, basis = bonded_system(system, [rest])
    hung = basis @ equilibrium(bonded, bonded.load)
    np.testing.assert_allclose(hung, [0.0, 0.0, 0.25], atol=1e-12)
