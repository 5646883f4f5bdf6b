# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of results, and distances between models."""

import re
from dataclasses import replace
from math import log, pi
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from plotly.graph_objects import Figure as Plot

from protractile.analysis.curves import Curves
from protractile.analysis.fatigue import HAS_RAINFLOW
from protractile.analysis.low_pass import mean_period
from protractile.analysis.rows import BEAM, INITIAL, MOTION, REST, Row, Rows
from protractile.cases import change, run_case
from protractile.dynamics.predictability import measure_horizons
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.pipeline.design_results import DesignResults
from protractile.runs.pipeline.models import MotionPlan, build
from protractile.runs.pipeline.results import Results
from protractile.runs.report.figure_context import Figure
from protractile.runs.report.labels import label
from protractile.runs.report.result_tables import play_table, rest_tables, result_tables
from protractile.runs.report.summary_table import (
    deviation_note,
    play_effect,
    summary_table,
    utilisation_verdict,
)
from protractile.runs.report.tables import Table
from protractile.runs.report.terminal_tables import print_results
from protractile.runs.sweep import output
from protractile.runs.sweep.distances import (
    AVERAGING_TIME,
    CHANGE,
    DISTANCES,
    Features,
    Quantities,
    comparison_end,
    sustained_force,
)
from protractile.runs.sweep.points import Plan, plan
from protractile.runs.sweep.run import Outcome
from tests.runs.case_texts import refused, shipped
from tests.runs.summaries import COARSE, printed, rubbing, run

PLAYED, BONDED = "kantorovich-5", "beam-fe-bonded"


@pytest.fixture(scope="module")
def results() -> Results:
    case = change(shipped("coarse"), **{"damping.modal": 0.02})
    return run_case(case, [PLAYED, BONDED])


def with_rows(results: Results, *rows: Row, without: tuple[str, ...] = ()) -> Results:
    """Return results with other rows of their quantities, and without some quantities."""
    changed = {*without} | {row.quantity for row in rows}
    kept = (row for row in results.rows if row.quantity not in changed)
    return replace(results, rows=Rows([*kept, *rows]))


def row_of(quantity: str, value: float, state: str = MOTION, **more: Any) -> Row:
    """Return a row of the model with play."""
    labels = {"model": PLAYED, "play": True, "part": "outer", "place": ""} | more
    return Row(state=state, quantity=quantity, value=value, **labels)


def with_and_without(with_play: float, without: float, *where: Any, **more: Any) -> tuple[Row, Row]:
    """Return the rows of a quantity with and without play."""
    one = row_of(where[0], with_play, *where[1:], **more)
    return one, one._replace(play=False, value=without)


def cells(table: Table | None) -> dict[str, dict[str, str]]:
    return {row[0]: dict(zip(table.headings, row, strict=True)) for row in table.rows}


def test_summary_table_equals_the_design_results(results: Results) -> None:
    """Reference: results.csv, in mm, Hz, s and kN. A vibration decays as exp(−2π ζ f t)."""
    rows = results.rows.where(model=PLAYED, play=True)
    found = cells(summary_table(results))
    frequency = rows.where(quantity="frequency")[0].value
    (tip,) = rows.where(state=INITIAL, quantity="tip")
    largest = abs(rows.where(state=MOTION, quantity="contact_force").largest.value)
    for asked, value, unit in (
        ("Static tip deflection (t = 0), mm", 1e3 * tip.value, 1.0),
        ("First natural frequency, Hz", frequency, 0.1),
        ("Decay time to 10 %, s", log(10.0) / (2.0 * pi * 0.02 * frequency), 0.1),
        ("Contact force, maximum, kN", largest / 1e3, 1.0),
    ):
        said = float(found[asked][PLAYED].replace("−", "-").split()[0])
        assert said == pytest.approx(value, rel=6e-3, abs=0.06 * unit)
    assert found["Contact force, maximum, kN"][BONDED] == "–"
    assert "Fatigue damage (Miner)" not in found
    # A folder of an earlier version has no design results.
    summary = results.summary.model_copy(update={"design": DesignResults({})})
    without = replace(results, summary=summary, rows=Rows(), curves=Curves())
    assert (summary_table(without), result_tables(without), play_effect(without)) == (None, [], "")


def test_period_is_measured_from_the_motion(results: Results) -> None:
    """Reference: analytic, a tip motion 20 mm + 0.1 m (1 − cos). The run has no second peak.

    A tip that starts at 0 has one number.
    """
    asked = "Period of the motion (time history), s", "Tip travel from t = 0, mm"
    assert not {*asked} & cells(summary_table(results)).keys()
    tip = results.trajectories["tip"]
    moving = tip * 0.0 + 0.02 + 0.1 * (1.0 - np.cos(2.0 * np.pi / 0.15 * tip["time"]))
    told = replace(results, trajectories=results.trajectories.assign(tip=moving))
    said = cells(summary_table(told))
    assert [said[one][PLAYED] for one in asked] == ["0.15", "200.0"]


def test_play_is_said_in_a_sentence(results: Results) -> None:
    """Reference: by hand, from given numbers. An increase from nearly nothing has no percentage."""
    told = with_rows(
        results,
        *with_and_without(-0.15, -0.10, "tip", REST, part="tip"),
        *with_and_without(1.5, 2.0, "frequency", INITIAL, part="bending in z", place="1"),
        *with_and_without(9e7, 10e7, "stress", part="inner"),
        *with_and_without(12e7, -10e7, "stress"),
        *with_and_without(-404.0, 1.0, "support_torque", place="at 0 m"),
    )
    assert play_effect(told) == (
        "Play adds 50 mm (+50 %) to the static tip deflection (maximum load) and 20 MPa (+20 %) to "
        "the maximum bending stress. First natural frequency: 1.5 Hz with joints in contact, 2 Hz "
        "with bonded joints."
    )
    rows = cells(play_table(told))
    assert [*rows["maximum bending stress, inner"].values()][-3:] == ["100 MPa", "−10 MPa", "−10"]
    assert rows["static tip deflection (maximum load)"]["with play"] == "150 mm"
    (torque,) = (row for name, row in rows.items() if "torque" in name)
    assert (torque["play adds"], torque["%"]) == ("0.403 kN m", "–")


def test_tables_of_rest_name_their_loads(results: Results) -> None:
    """Reference: by hand. The moment of a hinge is round-off, compared with 5 kN m of a clamp."""
    bears = [
        row_of(name, value, INITIAL, model=BEAM, x=x, place=f"at {x:g} m")
        for x, moment in ((0.0, 5e3), (3.0, 1.6e-7))
        for name, value in (("reaction", 1e3), ("support_moment", moment))
    ]
    tables = rest_tables(with_rows(results, *bears))
    titles = 2 * ["Static state with the largest tip deflection"] + ["Static state at t = 0"]
    assert [table.title.partition(":")[0] for table in tables] == titles
    assert [row[2] for row in tables[-1].rows] == ["5", "0"]


USED = "In this run, without safety factors, the utilisation is"


def with_stress(results: Results, stress: float) -> Results:
    """Return results with a stress in Pa, 10 % more in plates, and f_y = 355 MPa."""
    fibre = row_of("stress", -stress, x=2.0, limit=355e6)
    return with_rows(results, fibre, row_of("wall_stress", 1.1 * stress, x=10.0, limit=355e6))


def test_stresses_near_the_yield_strength_are_marked(results: Results) -> None:
    """Reference: by hand, 300 and 330 MPa, then 340 and 374 MPa of 355 MPa."""
    fibre, wall = (
        f"{what} stress, maximum (utilisation), MPa" for what in ("Bending", "Local plate")
    )
    near, beyond = (summary_table(with_stress(results, stress)) for stress in (300e6, 340e6))
    low, high = "330, 93 %\nouter, x = 10.0 m", "374, 105 %\nbeyond yield\nouter, x = 10.0 m"
    bent = "340, 95.8 %\nouter, x = 2.0 m"
    assert cells(near)[fibre][PLAYED] == "300, 84.5 %\nouter, x = 2.0 m"
    assert [*cells(near)[wall].values()][1:] == [low, "–"]
    assert (cells(beyond)[fibre][PLAYED], cells(beyond)[wall][PLAYED]) == (bent, high)
    assert ({*near.strong}, {*beyond.strong}) == ({low}, {bent, high})


def test_the_verdict_names_the_governing_utilisation_first(results: Results) -> None:
    """Reference: by hand, as above, and a damage of 3.2. Without a yield strength is no verdict."""
    assert utilisation_verdict(results) == ""
    none = "No yield strength is given of outer and inner."
    assert utilisation_verdict(with_stress(results, 340e6)) == (
        f"{USED} 105 % by local plate stress (outer, x = 10 m): exceeds yield; 95.8 % by "
        f"bending stress (outer, x = 2 m): below yield. {none}"
    )
    told = with_rows(results, row_of("damage", 3.2, part="inner", x=10.0, limit=1.0))
    verdict = f"{USED} 320 % by fatigue damage (inner, x = 10 m): exceeds the fatigue life. {none}"
    assert utilisation_verdict(told) == verdict
    terminal = printed(print_results, told, width=250).splitlines()
    assert terminal[-1] == f"{PLAYED}: i{verdict[1:]}"
    assert [*summary_table(told).strong] == ["3.2"]


def test_the_verdict_names_pads_of_unknown_strength(results: Results) -> None:
    """Reference: by hand, a pad without an allowable pressure, and an unloaded pad."""
    pad = row_of("pad_pressure", 27e6, part="inner", place="station 2, below", x=10.0)
    steel = change(results.case, **{"material.yield_strength": 355e6})
    told = with_stress(replace(results, case=steel), 300e6)
    plate, below = f"{USED} 93 % by local plate stress", "below yield."
    where = "(inner, x = 10 m): exceeds the allowable pressure"
    for one, start, end in (
        (pad, plate, "No allowable pressure is given of pads of inner."),
        (pad._replace(value=0.0), plate, below),
        (pad._replace(limit=20e6), f"{USED} 135 % by pad pressure {where}", below),
    ):
        found = with_rows(told, one)
        assert utilisation_verdict(found).startswith(start)
        assert utilisation_verdict(found).endswith(end)


def test_one_line_says_how_near_models_are(results: Results) -> None:
    """Reference: by hand, a second model with a static tip lower by a tenth."""
    assert deviation_note(results) == ""
    own = results.rows.where(model=PLAYED, play=True)
    tip = own.where(state=REST, quantity="tip").largest
    lower = tip._replace(model="kantorovich-4", value=0.9 * tip.value)
    four = results.case.models[0].model_copy(update={"name": "kantorovich-4"})
    case = results.case.model_copy(update={"models": (four, *results.case.models)})
    both = replace(results, case=case, rows=Rows([lower, *results.rows]))
    summary = both.summary.model_copy(deep=True)
    summary.models["kantorovich-4"] = summary.models[PLAYED]
    summary.design.models["kantorovich-4"] = summary.design.models[PLAYED]
    line = f"Deviation of the static tip deflection (maximum load) from {PLAYED}: "
    assert deviation_note(replace(both, summary=summary)) == f"{line}kantorovich-4 −10 %."


def test_every_answer_has_its_table(results: Results) -> None:
    """Reference: the results of a beam with play."""
    tables = {table.name: table for table in result_tables(results)}
    expected = ["play", "tilts", "pressed", "reactions", "modes", "peaks", "stress"]
    assert [*tables] == [*expected, *(["life"] if HAS_RAINFLOW else [])]
    # Contact forces are no support reactions.
    supports = ["support, outer at 0 m", "support, outer at 2 m"]
    assert tables["reactions"].columns[0].cells == supports
    first = results.rows.where(model=BONDED, quantity="frequency")[0]
    shown = cells(tables["modes"])[f"{first.part} 1"][f"{BONDED}\nHz"]
    assert float(shown) == pytest.approx(first.value, rel=1e-3)
    assert not any("wall" in heading for heading in tables["stress"].headings)


@pytest.mark.parametrize(
    ("row", "text"),
    [
        (row_of("tip", 0.1, part="tip"), "maximum dynamic tip deflection"),
        (row_of("tip", 0.1, REST, part="tip"), "static tip deflection (maximum load)"),
        (row_of("cylinder_force", 1e3, part="cylinder", x=1.0), "cylinder force"),
        (row_of("cylinder_force", 1e3, part="cylinder 2"), "cylinder force, cylinder 2"),
        (row_of("bending_moment", 1e3, x=2.0), "bending moment, outer"),
        (row_of("reaction", 1e3, place="at 0 m", x=0.0), "transverse reaction, outer at 0 m"),
        (row_of("rotation", 1e-3, part="inner", place="in outer"),
         "rotation of the joint, inner in outer"),
        (row_of("contact_force", 1e3, part="inner", place="station 1, lateral", x=3.8),
         "contact force, inner, x = 3.8 m, lateral"),
        (row_of("contact_force", 1e3, place="stop 1", x=5.0), "contact force, outer, x = 5 m"),
        (row_of("frequency", 1.5, INITIAL, part="twist", place="2"),
         "natural frequency, twist 2"),
    ],
)  # fmt: skip
def test_labels_name_the_result_and_its_place(row: Row, text: str) -> None:
    """Reference: by hand."""
    assert label(row) == text


SHORT = np.arange(2001) / 1000
SWEPT = ["kantorovich-4", "kantorovich-5", "beam-fe-bonded"]
RUBBING = "friction = 0.2\nnormal_forces = [4500.0, 5000.0]\n"


def features(height: float, period: float) -> Features:
    """Return a vibration from rest with an amplitude in m and a period in s."""
    tip = 0.5 * height * (1.0 - np.cos(2.0 * np.pi * SHORT / period))
    return Features(tip, height, mean_period(SHORT, tip), 2e3 * height, 1e8 * height)


def test_distances_are_parts_of_the_reference() -> None:
    """Reference: analytic. Periods of 0.5 and 0.4 s have a minimum and a maximum at 1 s."""
    own = features(0.10, 0.4)
    heights = dict.fromkeys(("first_peak_off", "pad_force_off", "stress_off", "tip_off"), 0.1)
    off = features(0.11, 0.4).distances_from(own)
    assert off == pytest.approx(heights | {"slow_period_off": 0.0})
    slower = features(0.10, 0.5).distances_from(own)
    assert slower["slow_period_off"] == pytest.approx(0.25)
    assert slower["tip_off"] == pytest.approx(1.0)
    still = replace(own, tip=np.zeros(SHORT.size), slow_period=np.nan, stress=0.0)
    unknown = dict.fromkeys(("slow_period_off", "stress_off", "tip_off"))
    assert own.distances_from(still) == {"first_peak_off": 0.0, "pad_force_off": 0.0} | unknown
    assert replace(own, stress=np.inf).distances_from(own)["stress_off"] is None
    wave = np.sin(4.0 * np.pi * SHORT)
    assert mean_period(SHORT, 0.05 + 1e-3 * wave) == pytest.approx(0.5, rel=0.01)
    # 1e-12 of the deflection is round-off, not a period.
    assert np.isnan(mean_period(SHORT, 0.05 + 0.05e-12 * wave))


def test_a_pad_force_is_held() -> None:
    """Reference: analytic. An impact of 1 ms contributes a twentieth in a window of 20 ms."""
    forces = np.zeros((SHORT.size, 3))
    forces[700, 0] = -4000.0
    forces[1000:, 1] = 150.0
    forces[:, 2] = np.nan
    assert sustained_force(SHORT, forces) == pytest.approx(4000.0 * 1e-3 / AVERAGING_TIME)
    # An interval of output that is longer than the window is the window.
    assert sustained_force(0.1 * np.arange(20), forces[690:710]) == 4000.0
    # Nothing touches, or the run is shorter than the window.
    for unknown in (forces[:, 2:], forces[:1], forces[:10]):
        assert np.isnan(sustained_force(SHORT[: len(unknown)], unknown))


@pytest.fixture
def against(here: Path) -> Plan:
    """Return a sweep of the coarse case with friction, until after its first peak."""
    text = COARSE.read_text(encoding="utf-8")
    text = text.replace("exponent = 2.0\n", f"exponent = 2.0\n{RUBBING}", 1)
    Path("case.toml").write_text(text.replace("= 0.6", "= 0.9", 1), encoding="utf-8")
    return plan("case.toml", ["joint.play=0.008,0.014"], SWEPT, None, "kantorovich-5")


@pytest.mark.usefixtures("unprinted")
def test_sweep_reports_distances_comparison_time_and_step_error(against: Plan) -> None:
    """Reference: other code path, the tips of both models in one run."""
    data = output.write(against, run(against), Path("out"))
    results = run_case(case_file.select(case_file.load("case.toml"), "", SWEPT[:2]))
    one, other = (results.trajectories["tip"].sel(model=name).values for name in SWEPT[:2])
    there = data.sel({"joint.play": 0.014})
    own, bonded = there.sel(model="kantorovich-4"), there.sel(model="beam-fe-bonded")
    assert float(own["tip_off"]) == pytest.approx(np.abs(one - other).max() / np.ptp(other))
    heights = [results.summary.models[name].first_peak["tip"].height for name in SWEPT[:2]]
    assert float(own["first_peak_off"]) == pytest.approx(abs(heights[0] / heights[1] - 1.0))
    # Nothing touches where segments are bonded, and both are far off.
    assert np.isnan(bonded["pad_force_off"])
    assert bonded["first_peak_off"] > 0.5
    assert np.isnan(there["tip_off"].sel(model="kantorovich-5"))
    rows = pd.read_csv("out/sweep.csv", index_col=["joint.play", "model"])
    assert rows.loc[(0.014, "kantorovich-4"), "tip_off"] == pytest.approx(float(own["tip_off"]))
    doubled = results.summary.models["kantorovich-5"].step_error
    assert doubled is not None
    assert 0.0 < doubled < 1.0e-3
    assert float(there["step_error"].sel(model="kantorovich-5")) == pytest.approx(doubled)
    assert data["compared_until"].dims == ("joint.play",)
    assert data["compared_until"].values.tolist() == [0.9, 0.9]
    shown = printed(output.print_ranges, data, against, width=80)
    table = shown.partition("Distances from kantorovich-5")[2]
    first = [line.split()[0] for line in table.splitlines() if line.strip()]
    assert [word for word in first if word in SWEPT] == ["kantorovich-4", "beam-fe-bonded"]
    until, changes = shown.splitlines()[-2:]
    assert until == "tips are compared until 0.9 s"
    assert re.fullmatch(
        r"the time step changes the tip of kantorovich-5 by 0\.0\S* % of its range", changes
    )


@pytest.mark.usefixtures("unprinted")
def test_maps_have_levels_and_times_of_a_shorter_comparison(
    against: Plan, figures: list[Figure]
) -> None:
    """Reference: numbers on both sides of the levels; without values there is no map."""
    keys = ["joint.friction=0.1,0.2", "joint.play=0.008,0.014", "segment.load=20,40"]
    sweeping = plan("case.toml", keys, SWEPT, None, "kantorovich-5")
    parts: Quantities = {distance.name: None for distance in DISTANCES} | {"first_peak_off": 0.002}
    off = ((0.005, 0.9), (0.03, 0.9), (0.1, 0.9), (0.5, 0.9), (0.02, 0.9), (0.03, 0.41))
    outcomes = [
        Outcome({}, {}, {SWEPT[0]: parts | {"tip_off": x}, SWEPT[2]: parts}, until)
        for x, until in (*off, *2 * off[4:5])
    ]
    Path("out").mkdir()
    output.write(sweeping, outcomes, Path("out"))
    drawn = {path.name for path in Path("out/figures").glob("*off.png")}
    assert drawn == {"sweep-first-peak-off.png", "sweep-tip-off.png"}
    chart = figures[-1].chart
    Plot(chart.plain)
    assert chart.panels == [
        f"{SWEPT[0]}, friction {x}" for x in ("0.1: 0.5 to 50 %", "0.2: 2 to 3 %")
    ]
    assert chart.keys.levels == (1.0, 5.0, 20.0)
    assert (chart.keys.abscissas, chart.keys.ordinates) == (["8", "14"], ["20", "40"])
    assert chart.maps[0].values == pytest.approx(np.array([[0.5, 10.0], [3.0, 50.0]]))
    texts = np.array([cells.texts for cells in chart.maps])
    assert np.argwhere(np.char.endswith(texts.astype(str), "\n0.4 s")).tolist() == [[1, 1, 0]]


@pytest.mark.parametrize(
    ("models", "reference", "line"),
    [
        (SWEPT, "shel", "'shel' is not a model that is run; give {}"),
        (SWEPT[:1], SWEPT[0], "no model is compared with 'kantorovich-4'; run another model"),
    ],
)
def test_a_reference_must_be_one_of_several_models(
    against: Plan, models: list[str], reference: str, line: str
) -> None:
    known = "'kantorovich-4', 'kantorovich-5' or 'beam-fe-bonded'"
    with refused(f"case.toml: --against: {line.format(known)}"):
        plan("case.toml", ["joint.play=0.008,0.014"], models, None, reference)


def test_chaos_is_compared_until_its_horizon() -> None:
    """Reference: other code, the horizon that ensembles measure with the same change."""
    case = case_file.select(shipped("coarse"), "", ["kantorovich-4"])
    case = change(case, **{"time.duration": 3.0})
    (model,) = case.models
    until = comparison_end(case, model, run_case(case), None, None)
    moving = MotionPlan.of(build(case, build_boom(case), model).system, case, model)
    found = measure_horizons(
        moving.motion, [CHANGE], "load", partners=1, integrator=moving.integrator
    )
    assert until == found.times[0, 1]
    assert 0.12 < until < 3.0
    regular = rubbing(case)
    assert comparison_end(regular, model, run_case(regular), None, None) == 3.0
