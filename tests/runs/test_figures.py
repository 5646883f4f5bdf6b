# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of a run, with all models and units."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib import image
from plotly.graph_objects import Figure as Plot

from protractile.analysis.curves import Curve as Along
from protractile.analysis.curves import Curves
from protractile.cases import run_case
from protractile.runs.case.limits import LimitsTable
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.summary import FirstPeak
from protractile.runs.report import theme
from protractile.runs.report.charts import Curve
from protractile.runs.report.figure_context import Figure, FigureContext
from protractile.runs.report.figures import FOLDER, figures_of, write_pictures
from protractile.runs.report.force_figures import first_contacts
from protractile.runs.report.motion_figures import close_up, tip
from protractile.runs.report.rest_figures import chart_along, rest_curves
from protractile.runs.report.static_charts import draw_chart
from tests.runs.case_texts import shipped
from tests.runs.summaries import changed, rubbing

pytestmark = pytest.mark.slow


WITH_PLAY = ["kantorovich-4", "kantorovich-5", "beam-fe"]


@pytest.fixture(scope="module")
def results() -> Results:
    return run_case(shipped("coarse"), [*WITH_PLAY, "beam-fe-bonded"])


def curves_of(figures: Sequence[Figure]) -> list[Curve]:
    return [curve for figure in figures for curve in figure.chart.curves]


def model_of(curve: Curve) -> str:
    """Return the model of a curve, without its remark on bonded joints."""
    return curve.name.removesuffix(" (beam)")


def test_draws_each_figure_as_png(
    results: Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Values that are not finite are left out."""
    broken = results.trajectories.copy(deep=True)
    for variable in broken.data_vars:
        broken[variable][dict(model=1, time=slice(300, None))] = np.nan
    figures = figures_of(replace(results, trajectories=broken))
    assert [(figure.name, figure.main) for figure in figures] == [
        ("boom", True), ("tip", True), ("tip-close-up", False), ("head", False),
        ("contact-first", False), ("at-rest", True), ("envelopes", False), ("modes", False),
    ]  # fmt: skip
    # Of motions without friction under given normal forces a curve is a sample.
    assert sum("possible motions" in figure.caption for figure in figures) == 1
    monkeypatch.setitem(theme.RC, "savefig.dpi", 50)
    write_pictures(figures, tmp_path)
    for figure in figures:
        if figure.chart is not None:
            Plot(figure.chart.plain)
            of_boom = figure.name in {"at-rest", "envelopes", "modes"}
            assert figure.chart.along == ("x along the boom (m)" if of_boom else "time (s)")
            unit = "kN" if figure.name == "contact-first" else "mm"
            assert of_boom or all(title.endswith(f"({unit})") for title in figure.chart.panels)
        pixels = image.imread(tmp_path / FOLDER / f"{figure.name}.png")
        assert pixels.shape[1] == round(theme.WIDTH * 50)
        # More than a white sheet: ink in the middle as well as in the title.
        assert (pixels[..., :3].min(axis=2) < 0.5).mean() > 0.005


@pytest.mark.parametrize("name", ["contact-first", "at-rest"])
def test_pictures_and_plots_show_the_same(results: Results, name: str) -> None:
    """Reference: other code, matplotlib and plotly of the same data."""
    chart = next(figure.chart for figure in figures_of(results) if figure.name == name)
    with matplotlib.rc_context(theme.RC):
        panels = draw_chart(chart, name).axes
    plot = Plot(chart.plain)
    titles = [
        note.text.removeprefix("<b>").removesuffix("</b>") for note in plot.layout.annotations
    ]
    assert [axes.get_title(loc="left") for axes in panels] == titles
    for number, axes in enumerate(panels):
        traces = [t for t in plot.data if t.yaxis == f"y{number + 1 if number else ''}" and t.name]
        drawn = [(str(n.get_label()), n.get_ydata(), n.get_color()) for n in axes.get_lines()]
        shown = [(t.name, np.asarray(t.y, dtype=float), t.line.color) for t in traces]
        assert traces
        # In an overlap a model has a curve of each segment.
        one, other = (sorted((n, float(np.nanmax(y)), c) for n, y, c in x) for x in (drawn, shown))
        for (name, most, color), trace in zip(one, other, strict=True):
            assert trace == (name, pytest.approx(most, rel=1e-6), color)


def test_tips_are_in_millimetres_also_downwards(results: Results) -> None:
    """Reference: the trajectories themselves, in m, with half the tip deflection laterally."""
    down = results.trajectories.assign(tip=-results.trajectories["tip"])
    upwards, downwards = (
        tip(FigureContext(x))[0] for x in (results, replace(results, trajectories=down))
    )
    assert downwards.title == upwards.title.replace("deflection ", "deflection −")
    assert upwards.title.partition(" mm in ")[2] in WITH_PLAY
    regular = replace(results, case=rubbing(results.case))
    assert "chaotic" in upwards.caption
    assert "chaotic" not in tip(FigureContext(regular))[0].caption
    data = results.trajectories.assign(tip_lateral=0.5 * results.trajectories["tip"])
    data = data.assign_coords(direction=("station", ["z", "y"]))
    case = results.case.model_copy(update={"limits": LimitsTable(tip_lateral=0.2)})
    in_space = FigureContext(replace(results, trajectories=data, case=case))
    vertical, lateral = tip(in_space)
    *curves, limit = curves_of([lateral])
    assert np.abs(limit.values) == pytest.approx(200.0)
    for factor, drawn in ((1000.0, curves_of([vertical])), (500.0, curves)):
        assert "limit" not in [curve.name for curve in drawn]
        for curve in drawn:
            height = data["tip"].sel(model=model_of(curve)).values
            np.testing.assert_allclose(curve.values, factor * height, rtol=1e-12)
    (figure,) = first_contacts(in_space)
    assert figure.chart.panels == ["x = 9 m: force (kN)", "x = 10 m, lateral: force (kN)"]


def test_section_forces_are_in_the_units_of_their_panels() -> None:
    """Reference: by hand, 1 m, 1 N and 1 N·m."""
    factors = {"mm": 1e3, "kN": 1e-3, "kN m": 1e-3}
    ones = dict.fromkeys(["deflection", "normal", "moment", "lateral_moment", "torque"], np.ones(2))
    static = Curves([Along("beam", "rest", True, "arm", 0.0, np.arange(2.0), ones)])
    chart = chart_along(rest_curves(static, "beam", "k"))
    assert len(chart.panels) == len(ones)
    for curve in chart.curves:
        unit = chart.panels[curve.panel].rpartition("(")[2].removesuffix(")")
        assert curve.values.tolist() == [factors[unit]] * 2


def test_contact_forces_keep_their_impulse(results: Results) -> None:
    """Reference: analytic. A running mean preserves the sum except at both ends, and constants."""
    (figure,) = first_contacts(FigureContext(results))
    assert len(figure.chart.curves) == 2 * len(WITH_PLAY)
    for curve in figure.chart.curves:
        force = results.trajectories["contact_force"].sel(model=curve.name)
        force = force.isel(station=curve.panel).values
        ends = np.abs(force[:10]).sum() + np.abs(force[-10:]).sum()
        total = curve.values.sum() * 1000.0
        assert ends < 0.5 * abs(force.sum())
        assert total == pytest.approx(force.sum(), abs=ends + 1.0e-6 * abs(total))
    pressed = results.trajectories.copy(deep=True)
    pressed["contact_force"][:] = 1000.0
    for stretch in (pressed, pressed.isel(time=slice(0, 5))):
        context = FigureContext(replace(results, trajectories=stretch))
        for curve in curves_of(first_contacts(context)):
            assert curve.values == pytest.approx(1.0, rel=1e-12)


def test_close_up_marks_first_contacts_and_peaks(results: Results) -> None:
    """Reference: the summary; a contact at 0 s is no first contact."""
    (figure,) = close_up(FigureContext(results))
    marks = {curve.marker: {*curve.at} for curve in curves_of([figure]) if not curve.linestyle}
    models = results.summary.models
    assert marks["o"] == {models[name].first_contact for name in WITH_PLAY}
    assert marks["v"] == {model.first_peak["tip"].time for model in models.values()} - {None}
    peakless = [name for name, model in models.items() if model.first_peak["tip"].time is None]
    assert peakless
    assert figure.caption.endswith(f" No peak within 0.6 s: {', '.join(peakless)}.")
    still = results
    for name in WITH_PLAY:
        still = changed(still, name, first_contact=0.0)
    (figure,) = close_up(FigureContext(still))
    assert "touch" not in figure.title + figure.caption
    assert not any(curve.marker == "o" for curve in curves_of([figure]))
    for name in models:
        results = changed(results, name, first_peak={"tip": FirstPeak(None, None)})
    assert close_up(FigureContext(results)) == []
