# SPDX-License-Identifier: LGPL-3.0-or-later
"""Distances of swept models from a reference."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from plotly.graph_objects import Figure as Plot

from protractile.analysis.low_pass import mean_period
from protractile.cases import change, run_case
from protractile.dynamics.predictability import measure_horizons
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.pipeline.models import MotionPlan, build
from protractile.runs.report.figure_context import Figure
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
