# SPDX-License-Identifier: LGPL-3.0-or-later
"""Every figure is drawn from what a run has, shows all its models, and says its units."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import image
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure as Sheet

from runs import case as case_file
from runs import theme
from runs.figures import draw
from runs.pipeline import run_case
from runs.results import Results

COARSE = Path(case_file.__file__).parent / "cases" / "coarse.toml"
WITH_PLAY = ["kantorovich-4", "kantorovich-5", "beam-fe"]


def run(folder: Path, models: list[str]) -> Results:
    case = case_file.select(case_file.load(str(COARSE)), "", models, None)
    finished = run_case(case, "", None, folder, lambda *_: None)
    assert finished is not None
    return finished.results


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return run(tmp_path_factory.mktemp("mesh"), [*WITH_PLAY, "beam-fe-tied"])


@pytest.fixture
def sheets(monkeypatch: pytest.MonkeyPatch) -> dict[str, Sheet]:
    """The matplotlib figure behind each file that is saved, by its stem."""
    saved: dict[str, Sheet] = {}
    save = Sheet.savefig

    def keep(sheet: Sheet, path: Path, **options: Any) -> None:
        saved[path.stem] = sheet
        save(sheet, path, **options)

    monkeypatch.setattr(Sheet, "savefig", keep)
    return saved


def labels(axes: Axes) -> list[str]:
    return list(dict.fromkeys(axes.get_legend_handles_labels()[1]))


def test_draws_each_figure_as_png(results: Results, tmp_path: Path) -> None:
    figures = draw(results, tmp_path)
    stems = [figure.path.stem for figure in figures]
    assert stems == [
        "tip", "tip-close-up", "head", "contact-first", "contact-peaks", "energies",
        "energy-residual",
    ]  # fmt: skip
    assert sorted(tmp_path.iterdir()) == sorted(figure.path for figure in figures)
    for figure in figures:
        pixels = image.imread(figure.path)
        assert pixels.shape[1] == round(theme.WIDTH * theme.DPI)
        # More than a white sheet: ink in the middle as well as in the title.
        assert (pixels[..., :3].min(axis=2) < 0.5).mean() > 0.005
        assert figure.title
        assert figure.caption.endswith(".")


def test_every_axis_says_its_unit(
    results: Results, tmp_path: Path, sheets: dict[str, Sheet]
) -> None:
    draw(results, tmp_path)
    for stem, sheet in sheets.items():
        assert sheet.axes[-1].get_xlabel() == "time (s)"
        unit = {"tip": "mm", "tip-close-up": "mm", "head": "mm", "energies": "J"}.get(stem, "kN")
        heading = sheet.get_supylabel() or sheet.axes[0].get_ylabel()
        expected = "–" if stem == "energy-residual" else unit
        assert heading.endswith(f"({expected})"), stem


def test_deflections_are_in_millimetres(
    results: Results, tmp_path: Path, sheets: dict[str, Sheet]
) -> None:
    """Reference: the trajectories themselves, in m."""
    draw(results, tmp_path)
    (axes,) = sheets["tip"].axes
    drawn = {line.get_label(): np.asarray(line.get_ydata()) for line in axes.get_lines()}
    for name in results.trajectories["model"].values:
        tip = results.trajectories["tip"].sel(model=name).values
        np.testing.assert_allclose(drawn[name], 1000.0 * tip, rtol=1e-12)


def test_contact_forces_keep_their_impulse(
    results: Results, tmp_path: Path, sheets: dict[str, Sheet]
) -> None:
    """Reference: analytic. A running mean has the sum of what it averages, but for its ends."""
    draw(results, tmp_path)
    for i, axes in enumerate(sheets["contact-first"].axes):
        for line in axes.get_lines():
            force = results.trajectories["contact_force"].sel(model=line.get_label())
            force = force.isel(station=i).values
            ends = np.abs(force[:10]).sum() + np.abs(force[-10:]).sum()
            total = np.asarray(line.get_ydata()).sum() * 1000.0
            assert ends < 0.5 * abs(force.sum())
            assert total == pytest.approx(force.sum(), abs=ends + 1.0e-6 * abs(total))


def test_one_colour_per_model_in_all_figures(
    results: Results, tmp_path: Path, sheets: dict[str, Sheet]
) -> None:
    draw(results, tmp_path)
    colours: dict[str, set[str]] = {}
    for stem in ("tip", "tip-close-up", "head", "contact-first", "contact-peaks"):
        for axes in sheets[stem].axes:
            for line in axes.get_lines():
                if str(line.get_label()) in results.summary["models"]:
                    colours.setdefault(str(line.get_label()), set()).add(str(line.get_color()))
    assert set(colours) == {*WITH_PLAY, "beam-fe-tied"}
    assert all(len(shades) == 1 for shades in colours.values())
    assert len(set.union(*colours.values())) == len(colours)


def test_close_up_marks_first_contacts_and_peaks(
    results: Results, tmp_path: Path, sheets: dict[str, Sheet]
) -> None:
    draw(results, tmp_path)
    marks = {"o": set(), "v": set()}
    for line in sheets["tip-close-up"].axes[0].get_lines():
        if line.get_marker() in marks and np.size(line.get_xdata()):
            marks[line.get_marker()].add(float(np.asarray(line.get_xdata())[0]))
    models = results.summary["models"]
    assert marks["o"] == {models[name]["first_contact"] for name in WITH_PLAY}
    peaks = {model["first_peak"]["tip"][0] for model in models.values()} - {None}
    assert peaks
    assert marks["v"] == peaks


def test_draws_a_play_free_boom_alone(tmp_path: Path) -> None:
    alone = run(tmp_path / "mesh", ["beam-fe-tied"])
    (tmp_path / "figures").mkdir()
    figures = draw(alone, tmp_path / "figures")
    stems = [figure.path.stem for figure in figures]
    assert stems == ["tip", "tip-close-up", "head", "energies", "energy-residual"]
    assert "chaotic" not in " ".join(figure.caption for figure in figures)


def test_draws_around_what_is_not_finite(results: Results, tmp_path: Path) -> None:
    broken = results.trajectories.copy(deep=True)
    for variable in broken.data_vars:
        broken[variable][dict(model=1, time=slice(300, None))] = np.nan
    assert len(draw(replace(results, trajectories=broken), tmp_path)) == 7


def test_colours_can_be_told_apart() -> None:
    """Reference: external, WCAG 2.1. A graphical object needs a contrast of 3 to the paper."""
    for colour in (*theme.PALETTE, theme.PLAY_FREE):
        linear = [
            c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)
        ]
        luminance = float(np.dot(linear, [0.2126, 0.7152, 0.0722]))
        assert 1.05 / (luminance + 0.05) > 3.0, colour


def test_more_models_than_colours_still_differ() -> None:
    names = [f"model {i}" for i in range(3 * len(theme.PALETTE))]
    drawn = theme.strokes([*names, "tied"], ["tied"])
    assert len(set(drawn.values())) == len(names) + 1


@pytest.mark.parametrize(
    ("number", "digits", "expected"),
    [(8.3e-5, 1, "8 × 10⁻⁵"), (2.41e6, 3, "2.41 × 10⁶"), (1e-6, 3, "1 × 10⁻⁶")],
)
def test_powers_of_ten_are_set_as_such(number: float, digits: int, expected: str) -> None:
    assert theme.scientific(number, digits) == expected


def test_the_title_follows_the_motion_downwards(results: Results, tmp_path: Path) -> None:
    """A boom under its weight deflects downwards: the title tells how far, with the sign."""
    down = results.trajectories.copy(deep=True)
    down["tip"] *= -1.0
    upwards, downwards = (
        next(figure.title for figure in draw(run, tmp_path) if figure.path.stem == "tip")
        for run in (results, replace(results, trajectories=down))
    )
    assert downwards == upwards.replace("up to ", "up to -").replace("play, ", "play, -")
