# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of a run, with all models and units."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib import image
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D

from protractile.cases import run_case
from protractile.runs.case import reading as case_file
from protractile.runs.case.schema import LimitsTable
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.summary import FirstPeak
from protractile.runs.report import theme
from protractile.runs.report.figure_context import Figure, FigureContext, new_sheet
from protractile.runs.report.figures import draw
from protractile.runs.report.force_figures import contact_peaks, first_contacts, friction
from protractile.runs.report.model_tables import model_table
from protractile.runs.report.motion_figures import close_up, energies, heads, horizons, tip
from tests.runs.case_texts import shipped
from tests.runs.summaries import HORIZONS, changed, rubbing

pytestmark = pytest.mark.slow


WITH_PLAY = ["kantorovich-4", "kantorovich-5", "beam-fe"]


@pytest.fixture(scope="module")
def results() -> Results:
    return run_case(shipped("coarse"), [*WITH_PLAY, "beam-fe-bonded"])


# Pixels per inch of the figures.
SMALL = 30

Everything = tuple[list[Figure], dict[str, Sheet]]


class Drawn:
    """Figures in a folder, and their matplotlib sheets by the stems of file names."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.sheets = folder, dict[str, Sheet]()

    def __call__(
        self, of: Callable[[FigureContext], list[Figure]], results: Results
    ) -> list[Figure]:
        """Draw some of the figures of a run anew."""
        for earlier in self.folder.glob("*.png"):
            earlier.unlink()
        with matplotlib.rc_context(theme.RC):
            return of(FigureContext(results, self.folder))


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Drawn]:
    found, save = Drawn(tmp_path_factory.mktemp("figures")), Sheet.savefig

    def keep(sheet: Sheet, path: Path, **_: Any) -> None:
        """Keep a sheet, and write it at a small size to prove that it can be drawn."""
        found.sheets[Path(path).stem] = sheet
        sheet.set_dpi(SMALL)
        save(sheet, path)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Sheet, "savefig", keep)
        yield found


@pytest.fixture(scope="module")
def everything(
    results: Results, drawn: Drawn, tmp_path_factory: pytest.TempPathFactory
) -> Everything:
    return draw(results, tmp_path_factory.mktemp("everything")), dict(drawn.sheets)


def model_of(line: Line2D) -> str:
    """Return the model of a line, without its remark on bonded joints."""
    return str(line.get_label()).removesuffix(" (beam)")


def labels(axes: Axes) -> list[str]:
    return list(dict.fromkeys(axes.get_legend_handles_labels()[1]))


def with_friction(results: Results) -> Results:
    """Return the same run with invented friction: 1 kN up at 9 m, nothing at 10 m."""
    data = results.trajectories.copy(deep=True)
    data["friction_force"] = 0.0 * data["contact_force"].fillna(0.0)
    data["friction_force"][dict(station=0)] = 1000.0
    data["friction_loss"] = 0.1 * data["work"]
    return replace(results, case=rubbing(results.case), trajectories=data)


def test_draws_each_figure_as_png(everything: Everything) -> None:
    figures, _ = everything
    stems = [figure.path.stem for figure in figures]
    assert stems == [
        "boom", "tip", "tip-close-up", "head", "contact-first", "contact-peaks", "at-rest",
        "envelopes", "modes", "energies", "energy-residual",
    ]  # fmt: skip
    assert sorted(figures[0].path.parent.iterdir()) == sorted(f.path for f in figures)
    # Of motions without friction under given normal forces a curve is a sample.
    assert sum("possible motions" in figure.caption for figure in figures) == 1
    for figure in figures:
        pixels = image.imread(figure.path)
        assert pixels.shape[1] == round(theme.WIDTH * SMALL)
        # More than a white sheet: ink in the middle as well as in the title.
        assert (pixels[..., :3].min(axis=2) < 0.5).mean() > 0.005
        assert figure.title
        assert figure.caption.endswith(".")


def test_every_axis_says_its_unit(everything: Everything) -> None:
    _, sheets = everything
    along = {"boom": 1, "at-rest": -1, "envelopes": -1, "modes": -1}
    for stem, panel in along.items():
        assert sheets[stem].axes[panel].get_xlabel().endswith("(m)")
    for stem in sheets.keys() - along.keys():
        sheet = sheets[stem]
        assert sheet.axes[-1].get_xlabel() == "time (s)"
        unit = {"tip": "mm", "tip-close-up": "mm", "head": "mm", "energies": "J"}.get(stem, "kN")
        heading = sheet.get_supylabel() or sheet.axes[0].get_ylabel()
        expected = "–" if stem == "energy-residual" else unit
        assert heading.endswith(f"({expected})"), stem


def test_deflections_are_in_millimetres(results: Results, drawn: Drawn) -> None:
    """Reference: the trajectories themselves, in m."""
    drawn(tip, results)
    (axes,) = drawn.sheets["tip"].axes
    curves = {model_of(line): np.asarray(line.get_ydata()) for line in axes.get_lines()}
    for name in results.trajectories["model"].values:
        deflection = results.trajectories["tip"].sel(model=name).values
        np.testing.assert_allclose(curves[name], 1000.0 * deflection, rtol=1e-12)


def test_contact_forces_keep_their_impulse(results: Results, drawn: Drawn) -> None:
    """Reference: analytic. A running mean preserves the sum except at both ends."""
    (figure,) = drawn(first_contacts, results)
    assert len(figure.chart.curves) == 2 * len(WITH_PLAY)
    for curve in figure.chart.curves:
        force = results.trajectories["contact_force"].sel(model=curve.name)
        force = force.isel(station=curve.panel).values
        ends = np.abs(force[:10]).sum() + np.abs(force[-10:]).sum()
        total = curve.values.sum() * 1000.0
        assert ends < 0.5 * abs(force.sum())
        assert total == pytest.approx(force.sum(), abs=ends + 1.0e-6 * abs(total))


def test_constant_contact_force_is_drawn_in_full(results: Results, drawn: Drawn) -> None:
    """Reference: analytic. The running mean of a constant is this constant, also at both ends."""
    pressed = results.trajectories.copy(deep=True)
    pressed["contact_force"][:] = 1000.0
    for stretch in (pressed, pressed.isel(time=slice(0, 5))):
        drawn(first_contacts, replace(results, trajectories=stretch))
        panels = drawn.sheets["contact-first"].axes
        for line in (line for axes in panels for line in axes.get_lines()):
            assert line.get_ydata() == pytest.approx(1.0, rel=1e-12)


def test_one_colour_per_model_in_all_figures(everything: Everything) -> None:
    _, sheets = everything
    of_models = ("tip", "tip-close-up", "head", "contact-first", "contact-peaks")
    lines = [line for stem in of_models for axes in sheets[stem].axes for line in axes.get_lines()]
    names = {*WITH_PLAY, "beam-fe-bonded"}
    shades = {(model_of(line), str(line.get_color())) for line in lines if model_of(line) in names}
    assert {name for name, _ in shades} == names
    assert len(shades) == len({shade for _, shade in shades}) == len(names)


def test_close_up_marks_first_contacts_and_peaks(results: Results, drawn: Drawn) -> None:
    (figure,) = drawn(close_up, results)
    marks = {"o": set(), "v": set()}
    for line in drawn.sheets["tip-close-up"].axes[0].get_lines():
        if line.get_marker() in marks and np.size(line.get_xdata()):
            marks[line.get_marker()].add(float(np.asarray(line.get_xdata())[0]))
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
    assert drawn(close_up, results) == []


@pytest.mark.usefixtures("drawn", "unprinted")
def test_draws_a_play_free_boom_alone(results: Results, tmp_path: Path) -> None:
    bonded = ["beam-fe-bonded"]
    models = {name: results.summary.models[name] for name in bonded}
    alone = replace(
        results,
        case=case_file.select(results.case, "", bonded),
        trajectories=results.trajectories.sel(model=bonded),
        summary=results.summary.model_copy(update={"models": models}),
    )
    figures = draw(alone, tmp_path)
    assert [figure.path.stem for figure in figures] == [
        "boom", "tip", "tip-close-up", "head", "at-rest", "envelopes", "modes", "energies",
        "energy-residual",
    ]  # fmt: skip
    assert "chaotic" not in " ".join(figure.caption for figure in figures)


@pytest.mark.usefixtures("drawn")
def test_figures_omit_values_that_are_not_finite(results: Results, tmp_path: Path) -> None:
    broken = results.trajectories.copy(deep=True)
    for variable in broken.data_vars:
        broken[variable][dict(model=1, time=slice(300, None))] = np.nan
    assert len(draw(replace(results, trajectories=broken), tmp_path)) == 11


def test_the_title_follows_the_motion_downwards(results: Results, drawn: Drawn) -> None:
    down = results.trajectories.copy(deep=True)
    down["tip"] *= -1.0
    upwards, downwards = (
        drawn(tip, run_of)[0].title for run_of in (results, replace(results, trajectories=down))
    )
    assert downwards == upwards.replace("deflection ", "deflection −")
    assert upwards.partition(" mm in ")[2] in WITH_PLAY
    assert "without" not in upwards


def test_initial_contact_is_no_first_contact(results: Results, drawn: Drawn) -> None:
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
    (figure,) = drawn(close_up, still)
    assert figure.title.startswith("Tip, first ")
    assert "touch" not in figure.title + figure.caption
    assert "verdicts" not in figure.caption
    lines = drawn.sheets["tip-close-up"].axes[0].get_lines()
    assert not any(line.get_marker() == "o" for line in lines)
    (figure,) = drawn(first_contacts, still)
    assert "impacts" not in figure.caption
    assert "impacts" in drawn(first_contacts, results)[0].caption
    assert "first contact\ns" not in model_table(still).headings
    assert "first contact\ns" in model_table(results).headings


def test_energies_start_with_the_initial_energy(results: Results, drawn: Drawn) -> None:
    """Reference: by hand, an initial strain energy of 5 J."""
    loaded = results.trajectories.assign(strain_energy=results.trajectories["strain_energy"] + 5.0)
    line = {}
    for name, run in (
        ("from zero", results), ("loaded", replace(results, trajectories=loaded))
    ):  # fmt: skip
        (figure,) = drawn(energies, run)
        (work,) = drawn.sheets["energies"].axes[0].get_lines()
        line[name] = np.asarray(work.get_ydata(), dtype=float)
        assert ("the initial energy" in figure.caption) == (name == "loaded")
    np.testing.assert_allclose(line["loaded"] - line["from zero"], 5.0, rtol=1e-9)


def test_friction_is_drawn_at_stations_with_friction(results: Results, drawn: Drawn) -> None:
    """Reference: the forces themselves, 1 kN at one of two stations."""
    assert drawn(friction, results) == []
    regular = drawn(tip, with_friction(results)) + drawn(heads, with_friction(results))
    assert not any("chaotic" in figure.caption for figure in regular)
    drawn(friction, with_friction(results))
    (axes,) = drawn.sheets["friction"].axes
    assert axes.get_title(loc="left") == "x = 9 m"
    assert labels(axes) == WITH_PLAY[-1:]
    (line,) = axes.get_lines()
    np.testing.assert_allclose(np.asarray(line.get_ydata())[5:-5], 1.0)
    (figure,) = drawn(energies, with_friction(results))
    axes = drawn.sheets["energies"].axes[0]
    assert "friction loss" in labels(axes)
    hatches = {str(area.get_label()): area.get_hatch() for area in axes.collections}
    assert hatches == {"strain": None, "kinetic": None, "contact": None, "friction loss": "///"}
    assert "; hatched: friction loss." in figure.caption


def test_a_long_curve_has_no_gaps(tmp_path: Path) -> None:
    """Reference: the same curve, 60 turns of a spiral, in one piece."""
    angle = np.linspace(0.0, 120.0 * np.pi, 20_001)
    pictures = []
    for pieces in ({}, {"agg.path.chunksize": 0}):
        with matplotlib.rc_context(theme.RC | pieces):
            sheet, (axes,) = new_sheet(1, 4.0)
            axes.plot(angle * np.cos(angle), angle * np.sin(angle))
            sheet.savefig(tmp_path / "curve.png")
        pictures.append(image.imread(tmp_path / "curve.png"))
    np.testing.assert_array_equal(*pictures)


@pytest.mark.parametrize("spread", [1.0, 1.5, 30.0, 1.0e4])
def test_peak_forces_have_labels_on_one_scale(
    results: Results, drawn: Drawn, spread: float
) -> None:
    """Reference: the forces, from 20 kN to ``spread`` times this value."""
    data = results.trajectories.copy(deep=True)
    rising = 2.0e4 * np.geomspace(1.0, spread, data.sizes["time"])
    peaks = data["contact_force_peak"]
    peaks.values[...] = np.broadcast_to(rising[:, None], peaks.shape)
    drawn(contact_peaks, replace(results, trajectories=data))
    panels = drawn.sheets["contact-peaks"].axes
    assert len({axes.get_ylim() for axes in panels}) == 1
    for axes in panels:
        low, high = axes.get_ylim()
        assert (low < 20.0, 20.0 * spread < high) == (True, True)
        shown = [tick for tick in axes.get_yticks() if low <= tick <= high]
        assert (2 if spread > 1.0 else 1) <= len(shown) <= 7
        assert all(axes.yaxis.get_major_formatter()(tick) for tick in shown)


def test_every_head_has_a_figure(results: Results, drawn: Drawn) -> None:
    head = results.trajectories["head"]
    data = results.trajectories.assign({"head-2": head, "head-2_rotation": head})
    joints = results.case.joints * 2
    case = results.case.model_copy(update={"joints": joints})
    found = drawn(heads, replace(results, trajectories=data, case=case))
    assert [figure.path.stem for figure in found] == ["head", "head-2"]
    assert "Dashed: beam-fe-bonded (beam), without play." in found[0].caption
    assert "beam-fe-bonded (beam)" in labels(drawn.sheets["head"].axes[0])


def test_a_boom_in_space_moves_to_the_sides(results: Results, drawn: Drawn) -> None:
    """Reference: the trajectories, with half the tip deflection laterally."""
    data = results.trajectories.assign(tip_lateral=0.5 * results.trajectories["tip"])
    data = data.assign_coords(direction=("station", ["z", "y"]))
    in_space = replace(results, trajectories=data)
    limits = LimitsTable(tip_lateral=0.2)
    drawn(tip, replace(in_space, case=results.case.model_copy(update={"limits": limits})))
    drawn(first_contacts, in_space)
    (axes,) = drawn.sheets["tip-lateral"].axes
    *lines, limit = axes.get_lines()
    assert np.abs(limit.get_ydata()) == pytest.approx(200.0)
    assert "limit" not in labels(drawn.sheets["tip"].axes[0])
    for line in lines:
        height = data["tip"].sel(model=model_of(line)).values
        np.testing.assert_allclose(np.asarray(line.get_ydata()), 500.0 * height, rtol=1e-12)
    titles = [panel.get_title(loc="left") for panel in drawn.sheets["contact-first"].axes]
    assert titles == ["x = 9 m", "x = 10 m, lateral"]


def test_measured_horizons_are_drawn(results: Results, drawn: Drawn) -> None:
    """Reference: the numbers of the summary."""
    assert drawn(horizons, results) == []
    drawn(horizons, changed(results, "beam-fe", horizons=HORIZONS))
    (axes,) = drawn.sheets["horizons"].axes
    points = [np.asarray(line.get_xydata()) for line in axes.get_lines() if line.get_xydata().size]
    first, of_step, last = points
    np.testing.assert_allclose(first, [[-12.0, 1.5], [-6.0, 1.0]])
    np.testing.assert_allclose(of_step, [[-12.0, 1.2]])
    np.testing.assert_allclose(last, [[-12.0, 6.0], [-6.0, np.nan]])
