# SPDX-License-Identifier: LGPL-3.0-or-later
"""The report in a real browser, also at the width of a telephone."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from protractile.runs.case import reading as case_file
from protractile.runs.case.schema import EnsembleTable
from protractile.runs.pipeline.results import prepare, read_netcdf
from protractile.runs.report import output
from protractile.runs.report.additions import judge
from tests.runs.summaries import finished
from tests.system.browser import Page, blank_page, find_browser
from tests.system.run_folder import COARSE

pytestmark = pytest.mark.slow


MODELS = ["kantorovich-4", "kantorovich-5", "beam-fe-bonded"]
WIDTH = 400

BROKEN = "[...document.images].filter(i => !i.complete || i.naturalWidth == 0).map(i => i.alt)"
DEAD = (
    "[...document.links].map(a => a.getAttribute('href'))"
    ".filter(to => to != 'viewer.html' && (to[0] != '#' || !document.getElementById(to.slice(1))))"
)
# Tables that have to be drawn to the side to be read.
CUT = (
    "[...document.querySelectorAll('.scroll')].filter(e => e.scrollWidth > e.clientWidth + 1)"
    ".map(e => e.getAttribute('aria-label'))"
)
# A telephone widens its window with the page: what counts is the width that it was given.
WIDE = (
    "[...document.querySelectorAll('body *')].filter(e => !e.closest('.scroll, pre') &&"
    f" e.getBoundingClientRect().right > {WIDTH + 1}).map(e => e.tagName)"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a run with ensembles and measured horizons."""
    case = case_file.select(case_file.load(COARSE), "", MODELS, None)
    ensemble = EnsembleTable(members=3, relative=1e-6, seed=1, vary="load")
    time = case.time.model_copy(update={"duration": 2.0})
    case = case.model_copy(update={"time": time, "ensemble": ensemble})
    run = finished(case)
    run.results.summary.models["kantorovich-5"].horizons = {
        "relatives": [1e-12, 1e-9, 1e-6, 1e-3], "shares": [0.01, 0.2],
        "times": [[1.5, 1.9], [1.2, None], [0.9, None], [0.6, None]], "of_step": [1.3, None],
        "rate": [23.0, None], "step_change": None, "limits": ["step", "physics"],
    }  # fmt: skip
    out = prepare(str(tmp_path_factory.mktemp("run") / "out"), "")
    out.mkdir()
    output.write(run, judge(run.results), out)
    return out


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    browser = find_browser()
    if browser is None:
        pytest.skip("a report is opened in chromium, and there is none on PATH")
    with blank_page(browser, tmp_path_factory.mktemp("profile")) as opened:
        yield opened


def test_a_report_is_whole_on_a_telephone(page: Page, folder: Path) -> None:
    page.open(folder / "report.html", WIDTH)
    assert page.complaints == []
    # The boom, the tip, the state at rest.
    assert page.evaluate("document.images.length") == 3
    assert page.evaluate("document.documentElement.scrollWidth") <= WIDTH
    for faults in (BROKEN, DEAD, WIDE, CUT):
        assert page.evaluate(faults) == []
    assert (folder / "report.html").stat().st_size < 10_000_000


# The middle of a part of the page, after it has been brought to the window's.
MIDDLE = (
    "(e => {{ e.scrollIntoView({{block: 'center'}}); const b = e.getBoundingClientRect();"
    " return [b.x + b.width / 2, b.y + b.height / 2]; }})(document.querySelector({!r}))"
)
PLOT = "document.querySelector('#figure-tip .plot')"
SHOWN = f"{PLOT}.data.filter(t => t.visible === true && t.name).map(t => t.name)"


def test_a_curve_says_the_number_of_the_file_and_is_hidden_by_its_name(
    page: Page, folder: Path
) -> None:
    """Reference: trajectories.nc. Values under the mouse have five digits.

    On paper a picture replaces the chart of a main figure.
    """
    page.open(folder / "report.html", 1000)
    page.evaluate(MIDDLE.format("#figure-tip"))
    page.wait_for(f"{PLOT}.querySelector('.nsewdrag')")
    page.point_at(*page.evaluate(MIDDLE.format("#figure-tip .nsewdrag")))
    page.wait_for(f"{PLOT}.querySelector('.hoverlayer .legend')")
    text = page.evaluate(f"{PLOT}.querySelector('.hoverlayer').textContent")
    time = page.evaluate(f"{PLOT}._hoverdata[0].x")
    trajectories = read_netcdf(folder / "trajectories.nc")
    assert float(np.abs(trajectories["time"] - time).min()) < 1e-12
    tips = 1e3 * trajectories["tip"].sel(time=time, method="nearest")
    for name in MODELS:
        (number,) = re.findall(rf"{name}(?: \(beam\))?[ :]*([−-]?[0-9.]+)", text)
        expected = pytest.approx(float(tips.sel(model=name)), rel=1e-4)
        assert float(number.replace("−", "-")) == expected
    assert [name.removesuffix(" (beam)") for name in page.evaluate(SHOWN)] == MODELS
    page.point_at(*page.evaluate(MIDDLE.format("#figure-tip .legendtoggle")), press=True)
    page.wait_for(f"{SHOWN}.length == 2")
    picture = "getComputedStyle(document.querySelector('#figure-tip img')).display"
    assert page.evaluate(picture) == "none"
    page.show_as("print")
    assert page.evaluate(picture) == "block"
    assert page.evaluate(f"getComputedStyle({PLOT}).display") == "none"
    page.show_as("")
    assert page.complaints == []


BOOM = "document.getElementById('boom')"
# z of a point that is farthest from the base at the beginning.
FARTHEST = f"{BOOM}.data[0].x.reduce((n, v, i, all) => v > all[n] ? i : n, 0)"
END = f"{BOOM}.data[0].z[{{}}]"
DRAW = (
    "(s => {{ s.value = {}; s.dispatchEvent(new Event('input')); }})"
    "(document.getElementById('time'))"
)
MAGNIFIED = "document.querySelector('header p').textContent.match(/× ([0-9.]+)/)[1]"


def test_the_slider_moves_the_boom(page: Page, folder: Path) -> None:
    """Reference: trajectories.nc times the displayed scale, within 0.2 %."""
    page.open(folder / "viewer.html", 1000)
    page.wait_for(f"{BOOM}.dataset.frame == '0'")
    magnified = float(page.evaluate(MAGNIFIED))
    tips = read_netcdf(folder / "trajectories.nc")["tip"].sel(model="kantorovich-5")
    allowed = 4e-3 * magnified * float(np.abs(tips).max())
    end = END.format(page.evaluate(FARTHEST))
    at_rest = page.evaluate(end)
    for frame in (20, 47):
        page.evaluate(DRAW.format(frame))
        page.wait_for(f"{BOOM}.dataset.frame == '{frame}'")
        time = float(page.evaluate("document.getElementById('now').value").removesuffix(" s"))
        tip = float(tips.sel(time=time, method="nearest"))
        assert abs(magnified * tip) > 5.0 * allowed
        assert page.evaluate(end) - at_rest == pytest.approx(magnified * tip, abs=allowed)
    assert (folder / "viewer.html").stat().st_size < 10_000_000
    assert not [text for text in page.complaints if "WebGL" not in text and "Canvas2D" not in text]
    page.complaints.clear()


@pytest.mark.parametrize(("loaded", "width"), [(400, 400), (1000, 400), (1000, 1000)])
def test_the_colour_bar_is_within_the_window(
    page: Page, folder: Path, loaded: int, width: int
) -> None:
    """Reference: the width of the window, also of one that has become narrower."""
    page.open(folder / "viewer.html", loaded)
    page.wait_for(f"{BOOM}.dataset.frame == '0'")
    page.set_width(width)
    bar = "[...document.querySelectorAll('[class^=cb] text')].map(e => e.getBoundingClientRect())"
    page.wait_for(f"{bar}.length > 2 && {bar}.every(e => e.left >= 0 && e.right <= {width})")
    page.complaints.clear()


def test_the_browser_would_notice(page: Page, tmp_path: Path) -> None:
    """Reference: a page with every fault, all of which are found."""
    path = tmp_path / "faulty.html"
    path.write_text(
        '<!DOCTYPE html><meta name="viewport" content="width=device-width, initial-scale=1">'
        '<img alt="none" src="nowhere.png"><a href="#nowhere">nowhere</a>'
        '<p style="width: 900px">wide</p><script>nothing.here()</script>',
        encoding="utf-8",
    )
    page.open(path, WIDTH)
    text = json.dumps(page.complaints)
    page.complaints.clear()
    assert "ERR_FILE_NOT_FOUND" in text
    assert "Uncaught" in text
    assert (page.evaluate(BROKEN), page.evaluate(DEAD)) == (["none"], ["#nowhere"])
    assert page.evaluate("document.documentElement.scrollWidth") >= 900
    assert "P" in page.evaluate(WIDE)
