# SPDX-License-Identifier: LGPL-3.0-or-later
"""The report as a reader meets it: in a real browser, as narrow as a telephone."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from runs.case import reading as case_file
from runs.case.schema import EnsembleTable
from runs.paper.rules import judge
from runs.pipeline.run import run_case
from runs.report import output
from tests.system.browser import Page, blank_page, find_browser
from tests.system.run_folder import COARSE

pytestmark = pytest.mark.slow


MODELS = ["kantorovich-4", "kantorovich-5", "beam-fe-tied"]
WIDTH = 400

BROKEN = "[...document.images].filter(i => !i.complete || i.naturalWidth == 0).map(i => i.alt)"
DEAD = (
    "[...document.links].map(a => a.getAttribute('href'))"
    ".filter(to => to[0] != '#' || !document.getElementById(to.slice(1)))"
)
# A telephone widens its window with the page: what counts is the width that it was given.
WIDE = (
    "[...document.querySelectorAll('body *')].filter(e => !e.closest('.scroll, pre') &&"
    f" e.getBoundingClientRect().right > {WIDTH + 1}).map(e => e.tagName)"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run with ensembles and measured horizons."""
    case = case_file.select(case_file.load(COARSE), "", MODELS, None)
    ensemble = EnsembleTable(members=3, relative=1e-6, seed=1, vary="load")
    time = case.time.model_copy(update={"duration": 2.0})
    case = case.model_copy(update={"time": time, "ensemble": ensemble})
    finished = run_case(case, "", None, tmp_path_factory.mktemp("mesh"), lambda *_: None)
    assert finished is not None
    finished.results.summary.models["kantorovich-5"].horizons = {
        "relatives": [1e-12, 1e-9, 1e-6, 1e-3],
        "shares": [0.01, 0.2],
        "times": [[1.5, 1.9], [1.2, None], [0.9, None], [0.6, None]],
        "of_step": [1.3, None],
        "rate": [23.0, None],
        "step_change": None,
        "limits": ["step", "physics"],
    }
    out = output.prepare(str(tmp_path_factory.mktemp("run") / "out"), "")
    output.write(finished, judge(finished.results), out, out)
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
    assert page.evaluate("innerWidth") == WIDTH
    assert page.evaluate("document.images.length") == len(list((folder / "figures").iterdir()))
    assert page.evaluate(BROKEN) == []
    assert page.evaluate(DEAD) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= WIDTH
    assert page.evaluate(WIDE) == []


def test_the_browser_would_notice(page: Page, tmp_path: Path) -> None:
    """Reference: a page that has every fault, of which each is found."""
    path = tmp_path / "faulty.html"
    path.write_text(
        '<!DOCTYPE html><html><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1"></head><body>'
        '<img alt="none" src="nowhere.png"><a href="#nowhere">nowhere</a>'
        '<p style="width: 900px">wide</p><script>nothing.here()</script></body></html>',
        encoding="utf-8",
    )
    page.complaints.clear()
    page.open(path, WIDTH)
    text = json.dumps(page.complaints)
    page.complaints.clear()
    assert "ERR_FILE_NOT_FOUND" in text
    assert "Uncaught" in text
    assert page.evaluate(BROKEN) == ["none"]
    assert page.evaluate(DEAD) == ["#nowhere"]
    assert page.evaluate("document.documentElement.scrollWidth") >= 900
    assert "P" in page.evaluate(WIDE)
