# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of a run, with all models and units."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib import image

from protractile.cases import run_case
from protractile.runs.case import reading as case_file
from protractile.runs.case.schema import LimitsTable
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.summary import FirstPeak
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.figure_context import Figure, FigureContext
from protractile.runs.report.figures import FOLDER, figures_of, write_pictures
from protractile.runs.report.force_figures import first_contacts
from protractile.runs.report.model_tables import model_table
from protractile.runs.report.motion_figures import close_up, heads, tip
from protractile.runs.report.static_charts import draw_chart
from tests.runs.case_texts import shipped
from tests.runs.summaries import changed, rubbing

pytestmark = pytest.mark.slow


WITH_PLAY = ["kantorovich-4", "kantorovich-5", "beam-fe"]


@pytest.fixture(scope="module")
def results() -> Results:
    return run_case(shipped("coarse"), [*WITH_PLAY, "beam-fe-bonded"])


def context(results: Results) -> FigureContext:
    return FigureContext(results)


@pytest.fixture(scope="module")
def everything(results: Results) -> list[Figure]:
    return figures_of(results)


def curves_of(figures: Sequence[Figure], *names: str) -> list[Curve]:
    charts = [figure.chart for figure in figures if figure.name in names or not names]
    return [*chain(*(chart.curves for chart in charts if chart is not None))]


def model_of(curve: Curve) -> str:
    """Return the model of a curve, without its remark on bonded joints."""
    return curve.name.removesuffix(" (beam)")


def test_draws_each_figure_as_png(everything: list[Figure], tmp_path: Path) -> None:
    assert [figure.name for figure in everything] == [
        "boom", "tip", "tip-close-up", "head", "contact-first", "at-rest", "envelopes",
        "modes",
    ]  # fmt: skip
    assert [figure.name for figure in everything if figure.main] == ["boom", "tip", "at-rest"]
    # Of motions without friction under given normal forces a curve is a sample.
    assert sum("possible motions" in figure.caption for figure in everything) == 1
    write_pictures(everything, tmp_path)
    files = {path.stem: path for path in (tmp_path / FOLDER).iterdir()}
    assert files.keys() == {figure.name for figure in everything}
    for figure in everything:
        pixels = image.imread(files[figure.name])
        assert pixels.shape[1] == round(theme.WIDTH * theme.DPI)
        # More than a white sheet: ink in the middle as well as in the title.
        assert (pixels[..., :3].min(axis=2) < 0.5).mean() > 0.005
        assert figure.title
        assert figure.caption.endswith(".")


def test_every_axis_says_its_unit(everything: list[Figure]) -> None:
    along = {"at-rest", "envelopes", "modes"}
    charts = {figure.name: figure.chart for figure in everything if figure.chart is not None}
    for name, chart in charts.items():
        assert chart.along == ("x along the boom (m)" if name in along else "time (s)")
        unit = {"tip": "mm", "tip-close-up": "mm", "head": "mm"}.get(name, "kN")
        assert name in along or all(title.endswith(f"({unit})") for title in chart.panels)


@pytest.mark.parametrize("name", ["tip", "contact-first", "at-rest"])
def test_pictures_and_plots_show_the_same(results: Results, name: str) -> None:
    """Reference: other code, matplotlib and plotly of the same data."""
    chart = next(figure.chart for figure in figures_of(results) if figure.name == name)
    with matplotlib.rc_context(theme.RC):
        panels = draw_chart(chart, name).axes
    plot = chart.figure
    assert [axes.get_title(loc="left") for axes in panels] == [
        note.text.removeprefix("<b>").removesuffix("</b>") for note in plot.layout.annotations
    ]
    for number, axes in enumerate(panels):
        traces = [t for t in plot.data if t.yaxis == f"y{number + 1 if number else ''}" and t.name]
        assert traces
        # In an overlap a model has a curve of each segment.
        found = [
            sorted((name, float(np.nanmax(values)), color) for name, values, color in curves)
            for curves in (
                [(str(n.get_label()), n.get_ydata(), str(n.get_color())) for n in axes.get_lines()],
                [(t.name, np.asarray(t.y, dtype=float), t.line.color) for t in traces],
            )
        ]
        for (name, most, color), trace in zip(*found, strict=True):
            assert trace == (name, pytest.approx(most, rel=1e-6), color)


def test_deflections_are_in_millimetres(results: Results) -> None:
    """Reference: the trajectories themselves, in m."""
    curves = {model_of(curve): curve.values for curve in curves_of(tip(context(results)))}
    for name in results.trajectories["model"].values:
        deflection = results.trajectories["tip"].sel(model=name).values
        np.testing.assert_allclose(curves[name], 1000.0 * deflection, rtol=1e-12)


def test_contact_forces_keep_their_impulse(results: Results) -> None:
    """Reference: analytic. A running mean preserves the sum except at both ends."""
    (figure,) = first_contacts(context(results))
    assert len(figure.chart.curves) == 2 * len(WITH_PLAY)
    for curve in figure.chart.curves:
        force = results.trajectories["contact_force"].sel(model=curve.name)
        force = force.isel(station=curve.panel).values
        ends = np.abs(force[:10]).sum() + np.abs(force[-10:]).sum()
        total = curve.values.sum() * 1000.0
        assert ends < 0.5 * abs(force.sum())
        assert total == pytest.approx(force.sum(), abs=ends + 1.0e-6 * abs(total))


def test_constant_contact_force_is_drawn_in_full(results: Results) -> None:
    """Reference: analytic. The running mean of a constant is this constant, also at both ends."""
    pressed = results.trajectories.copy(deep=True)
    pressed["contact_force"][:] = 1000.0
    for stretch in (pressed, pressed.isel(time=slice(0, 5))):
        pressed_run = replace(results, trajectories=stretch)
        for curve in curves_of(first_contacts(context(pressed_run))):
            assert curve.values == pytest.approx(1.0, rel=1e-12)


def test_one_colour_per_model_in_all_figures(everything: list[Figure]) -> None:
    names = {*WITH_PLAY, "beam-fe-bonded"}
    curves = curves_of(everything, "tip", "tip-close-up", "head", "contact-first")
    shades = {(model_of(curve), curve.color) for curve in curves if model_of(curve) in names}
    assert {name for name, _ in shades} == names
    assert len(shades) == len({shade for _, shade in shades}) == len(names)


def test_close_up_marks_first_contacts_and_peaks(results: Results) -> None:
    (figure,) = close_up(context(results))
    marks = {curve.marker: {*curve.at} for curve in curves_of([figure]) if not curve.linestyle}
    models = results.summary.models
    assert marks["o"] == {models[name].first_contact for name in WITH_PLAY}
    peaks = {model.first_peak["tip"].time for model in models.values()} - {None}
    assert peaks
    assert marks["v"] == peaks
    peakless = [name for name, model in models.items() if model.first_peak["tip"].time is None]
    assert peakless
    assert figure.caption.endswith(f" No peak within 0.6 s: {', '.join(peakless)}.")
    for name in models:
        results = changed(results, name, first_peak={"tip": FirstPeak(None, None)})
    assert close_up(context(results)) == []


def test_draws_a_play_free_boom_alone(results: Results) -> None:
    bonded = ["beam-fe-bonded"]
    models = {name: results.summary.models[name] for name in bonded}
    alone = replace(
        results,
        case=case_file.select(results.case, "", bonded),
        trajectories=results.trajectories.sel(model=bonded),
        summary=results.summary.model_copy(update={"models": models}),
    )
    figures = figures_of(alone)
    assert [figure.name for figure in figures] == [
        "boom", "tip", "tip-close-up", "head", "at-rest", "envelopes", "modes",
    ]  # fmt: skip
    assert "chaotic" not in " ".join(figure.caption for figure in figures)


def test_figures_omit_values_that_are_not_finite(results: Results, tmp_path: Path) -> None:
    broken = results.trajectories.copy(deep=True)
    for variable in broken.data_vars:
        broken[variable][dict(model=1, time=slice(300, None))] = np.nan
    figures = figures_of(replace(results, trajectories=broken))
    assert len(figures) == 8
    write_pictures(figures, tmp_path)


def test_the_title_follows_the_motion_downwards(results: Results) -> None:
    down = results.trajectories.copy(deep=True)
    down["tip"] *= -1.0
    upwards, downwards = (
        tip(context(run_of))[0].title for run_of in (results, replace(results, trajectories=down))
    )
    assert downwards == upwards.replace("deflection ", "deflection −")
    assert upwards.partition(" mm in ")[2] in WITH_PLAY
    assert "without" not in upwards


def test_initial_contact_is_no_first_contact(results: Results) -> None:
    """Reference: a summary with first contacts at 0 s."""
    models = {
        name: model.model_copy(update={"first_contact": 0.0 if name in WITH_PLAY else None})
        for name, model in results.summary.models.items()
    }
    pressed = results.trajectories.assign(contact_force=results.trajectories["gap"] * 0.0 + 1e3)
    still = replace(
        results,
        case=results.case.model_copy(update={"statements": ()}),
        trajectories=pressed,
        summary=results.summary.model_copy(update={"models": models}),
    )
    (figure,) = close_up(context(still))
    assert figure.title.startswith("Tip, first ")
    assert "touch" not in figure.title + figure.caption
    assert "verdicts" not in figure.caption
    assert not any(curve.marker == "o" for curve in curves_of([figure]))
    (figure,) = first_contacts(context(still))
    assert "impacts" not in figure.caption
    assert "impacts" in first_contacts(context(results))[0].caption
    assert "first contact\ns" not in model_table(still).headings
    assert "first contact\ns" in model_table(results).headings


def test_runs_with_friction_are_regular(results: Results) -> None:
    """Reference: friction under given normal forces, which prevents divergence."""
    run = context(replace(results, case=rubbing(results.case)))
    assert not any("chaotic" in figure.caption for figure in tip(run) + heads(run))


def test_a_long_curve_keeps_its_extremes(tmp_path: Path) -> None:
    """Reference: analytic, one sample of 5 among 200 001 of a sine."""
    time = np.linspace(0.0, 10.0, 200_001)
    values = np.sin(time)
    values[123_456] = 5.0
    with matplotlib.rc_context(theme.RC):
        sheet = draw_chart(Chart(time, [Curve("sine", values, "#000000")], ["y (m)"]), "A sine")
    (line,) = sheet.axes[0].get_lines()
    assert len(line.get_xdata()) < 2000
    assert max(line.get_ydata()) == 5.0
    assert line.get_xdata()[np.argmax(line.get_ydata())] == time[123_456]


def test_every_head_has_a_figure(results: Results) -> None:
    head = results.trajectories["head"]
    data = results.trajectories.assign({"head-2": head, "head-2_rotation": head})
    joints = results.case.joints * 2
    case = results.case.model_copy(update={"joints": joints})
    found = heads(context(replace(results, trajectories=data, case=case)))
    assert [figure.name for figure in found] == ["head", "head-2"]
    assert "Dashed: beam-fe-bonded (beam), without play." in found[0].caption
    assert "beam-fe-bonded (beam)" in [curve.name for curve in curves_of(found)]


def test_a_boom_in_space_moves_to_the_sides(results: Results) -> None:
    """Reference: the trajectories, with half the tip deflection laterally."""
    data = results.trajectories.assign(tip_lateral=0.5 * results.trajectories["tip"])
    data = data.assign_coords(direction=("station", ["z", "y"]))
    in_space = replace(results, trajectories=data)
    limits = LimitsTable(tip_lateral=0.2)
    limited = replace(in_space, case=results.case.model_copy(update={"limits": limits}))
    vertical, lateral = tip(context(limited))
    *curves, limit = curves_of([lateral])
    assert np.abs(limit.values) == pytest.approx(200.0)
    assert "limit" not in [curve.name for curve in curves_of([vertical])]
    for curve in curves:
        height = data["tip"].sel(model=model_of(curve)).values
        np.testing.assert_allclose(curve.values, 500.0 * height, rtol=1e-12)
    (figure,) = first_contacts(context(in_space))
    assert figure.chart.panels == ["x = 9 m: force (kN)", "x = 10 m, lateral: force (kN)"]
