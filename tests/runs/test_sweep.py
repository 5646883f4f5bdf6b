# SPDX-License-Identifier: LGPL-3.0-or-later
"""Sweeps: keys, points, quantities, files and charts."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from PIL import Image

from protractile.analysis.rows import MOTION
from protractile.cases import run_case
from protractile.geometry.section import Section
from protractile.geometry.typography import number
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.quantities import QUANTITIES, settling_time
from protractile.runs.report import theme
from protractile.runs.report.figure_context import Figure
from protractile.runs.sweep import output
from protractile.runs.sweep import run as sweep
from protractile.runs.sweep.points import Plan
from protractile.runs.sweep.run import Outcome
from tests.runs.case_texts import read_case, refused
from tests.runs.summaries import FAST, Planned, run


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch) -> list[Case]:
    """Return the cases of points, which have a tip of their play."""
    cases: list[Case] = []

    def count(case: Case, *_: object) -> Outcome:
        cases.append(case)
        return Outcome({case.models[0].name: {"tip": case.joints[0].play}}, {})

    monkeypatch.setattr(sweep, "run_point", count)
    return cases


@pytest.mark.parametrize(
    ("given", "values"),
    [
        ("0:0.02:5", [0.0, 0.005, 0.01, 0.015, 0.02]),
        ("0.01,0,0.002", [0.0, 0.002, 0.01]),
        ("0:0.01:11", [round(0.001 * i, 3) for i in range(11)]),
        ("0.014:0.004:2", [0.004, 0.014]),
    ],
)
def test_values_have_short_decimals(planned: Planned, given: str, values: list[float]) -> None:
    """Reference: the same decimals in Python, so that sweeps share their points."""
    (variation,) = planned(f"joint.play={given}").variations
    assert list(variation.values) == values
    assert [point.case.joints[0].play for point in planned(f"joint.play={given}").points] == values


def test_values_are_set_at_their_keys(planned: Planned) -> None:
    sweeping = planned("segment[2].load=20,40", "segment[2].span[2]=18.5,19", "payload.mass=5,9")
    assert list(sweeping.units) == ["N/m", "m", "kg"]
    assert [point.label for point in sweeping.points][:3] == [
        "segment[2].load=20 segment[2].span[2]=18.5 payload.mass=5",
        "segment[2].load=20 segment[2].span[2]=18.5 payload.mass=9",
        "segment[2].load=20 segment[2].span[2]=19 payload.mass=5",
    ]
    case = sweeping.points[-1].case
    assert [segment.load for segment in case.segments] == [83.16, 40.0]
    assert [segment.span for segment in case.segments] == [(0.0, 10.0), (9.0, 19.0)]
    assert case.payload.mass == 9.0
    both = planned("segment.load=1,2").points[1].case
    assert [segment.load for segment in both.segments] == [2.0, 2.0]


def test_sections_are_inferred_with_the_play_of_the_case(planned: Planned) -> None:
    """Reference: the boxes of a case file with another ratio and the play of 14 mm."""

    def boxes(case: Case) -> list[Section | None]:
        return [segment.section for segment in build_boom(case).segments]

    own = Path("case.toml").read_text(encoding="utf-8")
    flat = own.replace("height_to_width = 1.5", "height_to_width = 1.4")
    texts = ("segment[1].height_to_width=1.4,1.5", "joint.play=0,0.01")
    found = [boxes(point.case) for point in planned(*texts, models=["timoshenko"]).points]
    first, second = (boxes(read_case(Path(), text)) for text in (flat, own))
    assert found == [first, first, second, second]


@pytest.mark.parametrize(
    ("texts", "line"),
    [
        (["joint.plaz=0,1"], "joint.plaz: unknown key; the nearest known one is play"),
        (["joint.play"], "joint.play: not understood; give KEY=START:STOP:COUNT or KEY=A,B,..."),
        (["joint..play=1,2"], "joint..play: not understood; give a key such as joint[1].play"),
        (["joint.play=0:1"],
         "joint.play: '0:1' is not understood; give KEY=START:STOP:COUNT or KEY=A,B,..."),
        (["joint.play=0:1:x"], "joint.play: COUNT must be a whole number, got 'x'; give "
         "KEY=START:STOP:COUNT or KEY=A,B,..."),
        (["joint.play=0:1:1"], "joint.play: COUNT must be from 2 to 10000, got 1"),
        (["joint.play=0,inf"],
         "joint.play: must be finite numbers, got 'inf'; give KEY=START:STOP:COUNT or KEY=A,B,..."),
        (["joint.play=0"], "joint.play: there is only one value; give two or more"),
        (["joint.play=1,1"], "joint.play: a value is given twice in '1,1'; give each once"),
        (["joint.play=0,0.01", "joint.play=0,0.02"],
         "joint.play: given twice; give all its values at once"),
        (["joint[2].play=0,0.01"],
         "joint[2].play: the case has no joint[2], its last one is joint[1]"),
        (["load.magnitude=1,2"], "load.magnitude: the case has no load; there is nothing to vary"),
        (["time[1].step=1,2"], "time[1].step: time is not a list; leave out [1]"),
        (["joint.play.x=1,2"], "joint.play.x: joint[1].play is not a table; end the key there"),
        (["ensemble.members=2,3"], "ensemble.members: a sweep runs no ensembles; leave it out"),
        (["limits.tip=2,3"], "limits.tip: no run depends on it; leave it out"),
        (["payload.gravity=1,2"], "payload.gravity=1: payload.mass: missing; it is the mass in kg"),
        (["joint.play=0,0.01", "segment[2].span[2]=8,19"], "joint.play=0 segment[2].span[2]=8: "
         "segment[2].span: must run from a smaller to a larger x, got [9, 8] m"),
        (["model[3].element_length=0.5,1"], "model[3].element_length: no model of the sweep "
         "depends on it; leave it out, or run a model that does"),
    ],
    ids=lambda value: value if isinstance(value, str) else " ".join(value),
)  # fmt: skip
def test_a_mistake_is_said_with_its_option(planned: Planned, texts: list[str], line: str) -> None:
    with refused(f"case.toml: --vary {line}"):
        planned(*texts)


def test_a_box_without_room_for_the_play_is_refused(planned: Planned) -> None:
    with refused(
        "case.toml: --vary joint.play=0.02: joint[1].play: 'inner' does not fit in 'outer': 0.014 "
        "m of height and 0.044042 m of width are free, and a play of 0.02 m is asked for; make "
        "the inner section or the play smaller (the boxes are those that the case infers with its "
        "own play)"
    ):
        planned("joint.play=0:0.02:3", models=["timoshenko"])
    with refused("case.toml: --vary: 10100 points are too many; at most 10000 are run"):
        planned("joint.play=0:0.01:101", "segment.load=1:2:100")
    # Beams without plates accept any play.
    assert len(planned("joint.play=0.01,0.1").points) == 2
    with refused(
        "case.toml: --out .: contains other files; give a new folder or one of an earlier sweep"
    ):
        sweep.prepare(Path(), planned("joint.play=0,0.01").file)


def test_decay_has_the_settling_time_of_the_formula() -> None:
    """Reference: analytic, τ ln 20 for exp(−t/τ), whose late mean has an error of e⁻¹⁶."""
    time = np.linspace(0.0, 20.0, 20001)
    assert settling_time(time, 0.3 - 0.1 * np.exp(-time)) == pytest.approx(np.log(20.0), abs=2e-3)
    # Undamped motion never settles, and rest has settled.
    assert settling_time(time, 0.3 + np.cos(time)) is None
    assert settling_time(time, np.full(time.size, 0.3)) == 0.0


@pytest.mark.slow
@pytest.mark.usefixtures("unprinted")
def test_numbers_are_those_of_single_runs(planned: Planned) -> None:
    """Reference: run_case on the case file; the mass of the boom by hand."""
    sweeping = planned("joint.play=0.008,0.014")
    data = output.write(sweeping, run(sweeping), Path("out"))
    single = run_case(case_file.load("case.toml"), FAST)
    for name, summary in single.summary.models.items():
        there = data.sel({"joint.play": 0.014, "model": name})
        tip = single.trajectories["tip"].sel(model=name).values
        assert float(there["tip_amplitude"]) == 0.5 * (tip.max() - tip.min()) > 0.0
        rows = single.rows.where(model=name, play=True)
        (moved,) = rows.where(state=MOTION, quantity="tip")
        assert float(there["mass"]) == pytest.approx(831.6 + 550.7)
        assert float(there["tip_at_rest"]) == rows.at_rest(moved)
        assert float(there["first_frequency"]) == rows.where(quantity="frequency")[0].value
        assert float(there["dynamic_factor"]) == rows.dynamic_factor(moved)
        assert np.isnan(there["damage"])
        for key in ("peak_contact_force", "first_contact", "energy_residual"):
            expected = getattr(summary, key)
            assert np.isnan(there[key]) if expected is None else there[key] == expected
    stored = xr.load_dataset("out/sweep.nc", engine="scipy")
    assert stored["tip_amplitude"].dims == ("joint.play", "model")
    units = {name: stored[name].attrs["units"] for name in ("joint.play", "tip", "stress")}
    assert units == {"joint.play": "m", "tip": "m", "stress": "Pa"}
    rows = pd.read_csv("out/sweep.csv", index_col=["joint.play", "model"])
    assert list(rows.index) == [(play, model) for play in (0.008, 0.014) for model in FAST]
    for quantity in QUANTITIES:
        np.testing.assert_allclose(rows[quantity.name], stored[quantity.name].values.ravel(), 1e-8)


def test_completed_points_are_not_repeated(
    planned: Planned, ran: list[Case], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: by construction. Other models and sources are other points."""
    first = run(planned("joint.play=0:0.01:2"))
    finer = run(planned("joint.play=0:0.01:3"))
    again = run(planned("joint.play=0:0.01:3"))
    assert [case.joints[0].play for case in ran] == [0.0, 0.01, 0.005]
    assert again == finer
    assert [finer[0], finer[2]] == first
    run(planned("joint.play=0,0.01", models=["kantorovich-5"]))
    assert len(ran) == 5
    monkeypatch.setattr("protractile.runs.folder.cache.program", lambda: {"sources": "changed"})
    run(planned("joint.play=0,0.01"))
    assert len(ran) == 7


@pytest.mark.slow
@pytest.mark.usefixtures("unprinted")
def test_failing_model_leaves_a_gap(planned: Planned) -> None:
    """A run with such a short step would take days; a model with its own step is not affected."""
    sweeping = planned("model[1].step=1e-12,1e-5")
    outcomes = run(sweeping)
    data = output.write(sweeping, outcomes, Path("out"))
    assert data["failed"].values.tolist() == [[1, 0], [0, 0]]
    assert np.isnan(data["tip_amplitude"].values).tolist() == [[True, False], [False, False]]
    failure = "a step of 1e-12 s makes 2e+11 steps; make it longer"
    assert [*outcomes[0].failures.values()] == [failure]
    rows = pd.read_csv("out/sweep.csv", keep_default_na=False)
    assert list(rows["failure"]) == [failure, "", "", ""]


def test_other_errors_end_the_sweep(planned: Planned, monkeypatch: pytest.MonkeyPatch) -> None:
    def break_down(case: Case, *others: object) -> Outcome:
        if case.joints[0].play == 0.0:
            return Outcome({}, {"kantorovich-4": "no number is finite"})
        raise RuntimeError("broken")

    monkeypatch.setattr(sweep, "run_point", break_down)
    with pytest.raises(RuntimeError, match="broken"):
        run(planned("joint.play=0,0.01"))
    assert len(list(Path("out/points").iterdir())) == 1


# Invented numbers of charts.
CHARTED = ("tip_amplitude", "contact_force")


def written(sweeping: Plan, *quantities: str) -> list[str]:
    """Draw invented numbers with a gap, and return the names of the charts."""
    outcomes = [
        Outcome(
            {
                name: dict.fromkeys(quantities or CHARTED, 1.0 + 0.1 * i)
                for name in FAST[: 1 if i == 2 else 2]
            },
            {FAST[1]: "no number is finite"} if i == 2 else {},
        )
        for i in range(len(sweeping.points))
    ]
    Path("out").mkdir()
    output.write(sweeping, outcomes, Path("out"))
    return sorted(path.name for path in Path("out/figures").glob("*.png"))


@pytest.mark.slow
@pytest.mark.usefixtures("unprinted")
def test_three_keys_are_lines_in_several_charts(planned: Planned) -> None:
    """Reference: by hand, one chart for each two of the third and second keys' values."""
    texts = "joint.play=0,0.01", "segment[2].load=20,40,60", "damping.modal=0,0.1"
    assert written(planned(*texts)) == [f"sweep-lines-{number}.png" for number in range(1, 5)]


@pytest.mark.slow
def test_cells_of_a_map_show_their_values(planned: Planned, figures: list[Figure]) -> None:
    """Reference: the invented numbers in kN; the computation of one failed."""
    (name,) = written(planned("joint.play=6e-3:14e-3:3", "segment[2].load=20,40"), "contact_force")
    with Image.open(Path("out") / "figures" / name) as image:
        assert image.size[0] == round(theme.WIDTH * theme.DPI)
        assert np.asarray(image.convert("L")).min() < 128
    (figure,) = figures
    assert figure.chart.along == "play (mm)"
    assert figure.chart.keys.abscissas == ["6", "10", "14"]
    assert figure.chart.keys.ordinates == ["20", "40"]
    assert figure.chart.keys.title == "contact force (kN)"
    shown = [sorted(filter(None, cells.texts.ravel())) for cells in figure.chart.maps]
    forces = [number(1e-3 * (1.0 + 0.1 * i)) for i in range(6)]
    assert shown == [sorted(forces), sorted(["×", *forces[:2], *forces[3:]])]


@pytest.mark.usefixtures("unprinted")
def test_lines_are_in_shown_units_with_gaps(planned: Planned, figures: list[Figure]) -> None:
    """Reference: the invented numbers 1.0, 1.1, ... in m and N; one model lacks the third."""
    assert written(planned("joint.play=0:0.009:4")) == ["sweep-lines.png"]
    (figure,) = figures
    chart = figure.chart
    assert sorted(chart.panels) == ["contact force (kN)", "tip amplitude (mm)"]
    assert chart.along == "play (mm)"
    for panel, title in enumerate(chart.panels):
        factor = 1e-3 if "kN" in title else 1e3
        lines = {curve.name: curve for curve in chart.curves if curve.panel == panel}
        assert list(lines) == FAST
        for name, third in zip(FAST, (1.2, math.nan), strict=True):
            expected = factor * np.array([1.0, 1.1, third, 1.3])
            np.testing.assert_allclose(lines[name].values, expected, rtol=1e-12)
    np.testing.assert_allclose(chart.time, [0.0, 3.0, 6.0, 9.0])
