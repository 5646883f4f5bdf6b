# SPDX-License-Identifier: LGPL-3.0-or-later
"""The live page in a real browser: numbers change, results follow, refusals are shown."""

import re
import threading
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import sleep

import pytest

from protractile.runs import CASES
from protractile.runs.case.schema import Case
from protractile.runs.live.controls import Draft
from protractile.runs.live.server import LivePage, make_server
from tests.system.browser import Page, blank_page, find_browser

pytestmark = pytest.mark.slow

# Sets a field as a user does.
SET = (
    "(e => {{ e.value = {}; e.dispatchEvent(new Event('input')); }})"
    "(document.getElementById('number {}'))"
)
SLIDE = (
    "(e => {{ e.value = {}; e.dispatchEvent(new Event('input')); }})"
    "(document.querySelector('input[type=range][aria-label=\"{}\"]'))"
)
ANSWERED = "document.body.dataset.answered == number"
REFUSED = "document.getElementById('shown').classList.contains('stale')"
# Height of the tip in the picture, in m.
END = "Math.max(...document.getElementById('boom').data[1].y)"
ROW = (
    "[...document.querySelectorAll('#{} tr')].find(r => r.cells[0].textContent.startsWith('{}'))"
    ".cells[1].textContent"
)


# Words of labels, headings and first cells that stand on two lines.
BROKEN_WORDS = """
[...document.querySelectorAll('label span, label, h2, button, td:first-child')].flatMap(owner =>
  [...owner.childNodes].filter(node => node.nodeType == 3).flatMap(node =>
    [...node.textContent.matchAll(/[^\\s-]+/g)].filter(word => {
      const range = document.createRange();
      range.setStart(node, word.index);
      range.setEnd(node, word.index + word[0].length);
      return new Set([...range.getClientRects()].map(one => Math.round(one.top))).size > 1;
    }).map(word => word[0])))
"""


@contextmanager
def live_page(case: str, profile: Path) -> Iterator[Page]:
    """Yield the live page of a shipped case, with its first results."""
    with served_page(case, profile) as (page, _):
        yield page


@contextmanager
def served_page(case: str, profile: Path) -> Iterator[tuple[Page, LivePage]]:
    """Yield the live page of a shipped case, with its first results, and what serves it."""
    browser = find_browser()
    if browser is None:
        pytest.skip("the live page is opened in chromium, and there is none on PATH")
    live = LivePage(Draft.load(str(CASES / case)))
    server, address = make_server(live)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with blank_page(browser, profile) as opened:
        opened.open(address, 1200)
        opened.wait_for(ANSWERED)
        yield opened, live
    server.shutdown()
    server.server_close()
    live.shells.end()


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with live_page("lift.toml", tmp_path_factory.mktemp("profile")) as opened:
        yield opened


def tip(page: Page) -> float:
    """Return the static tip deflection under the maximum load in mm."""
    text = page.evaluate(ROW.format("rest", "Static tip deflection (maximum load)"))
    return float(re.sub(r"[^0-9.−]", "", text).replace("−", "-"))


def test_a_slider_changes_numbers_and_pictures(page: Page) -> None:
    """Reference: physics. More payload lowers the tip, also in the picture."""
    before, drawn = tip(page), page.evaluate(END)
    moved = page.evaluate(ROW.format("motion", "Maximum dynamic"))
    page.evaluate(SLIDE.format(300, "Payload"))
    page.wait_for(ANSWERED)
    assert page.evaluate("document.getElementById('number payload.mass').value") == "300"
    assert tip(page) < before - 20.0
    # The boom leans at 45 degrees and is drawn to scale.
    assert page.evaluate(END) - drawn == pytest.approx(
        1e-3 * (tip(page) - before) / 2**0.5, rel=0.05
    )
    assert page.evaluate(ROW.format("motion", "Maximum dynamic")) != moved
    page.evaluate(SET.format(150, "payload.mass"))
    page.wait_for(ANSWERED)
    assert tip(page) == before


def test_a_refusal_stands_at_its_field(page: Page) -> None:
    page.evaluate(SET.format(-1, "joint.play"))
    page.wait_for(REFUSED)
    message = (
        "document.getElementById('number joint.play').closest('.control').querySelector('.message')"
    )
    assert page.evaluate(f"{message}.textContent") == "must be a number not less than 0, got -1"
    page.evaluate(SET.format(0.003, "joint.play"))
    page.wait_for(f"{ANSWERED} && !{REFUSED}")
    assert page.evaluate(f"{message}.textContent") == ""


def test_the_last_of_many_changes_is_shown(page: Page) -> None:
    for mass in (160, 170, 180, 190, 200):
        page.evaluate(SET.format(mass, "payload.mass"))
    page.wait_for(ANSWERED)
    last = tip(page)
    page.evaluate(SET.format(150, "payload.mass"))
    page.wait_for(ANSWERED)
    before = tip(page)
    page.evaluate(SET.format(200, "payload.mass"))
    page.wait_for(ANSWERED)
    assert tip(page) == last < before
    page.evaluate(SET.format(150, "payload.mass"))
    page.wait_for(ANSWERED)


def test_any_other_number_is_found(page: Page) -> None:
    search = (
        "(e => {{ e.value = '{}'; e.dispatchEvent(new Event('change')); }})"
        "(document.getElementById('search'))"
    )
    page.evaluate(search.format("segment[2].section.height"))
    page.wait_for("document.getElementById('number segment[2].section.height')")
    page.evaluate(search.format("joint[7].play"))
    said = "document.getElementById('search-message').textContent"
    page.wait_for(said)
    assert page.evaluate(said) == (
        "joint[7].play: is not a number of the case; choose one of the list"
    )


def test_pinned_results_stand_beside_new_ones(page: Page) -> None:
    before = page.evaluate(ROW.format("rest", "Static tip deflection (maximum load)"))
    page.evaluate("document.getElementById('pin').click()")
    page.evaluate(SET.format(0.005, "joint.play"))
    page.wait_for(ANSWERED)
    pinned = ROW.format("rest", "Static tip deflection (maximum load)").replace(
        "cells[1]", "cells[2]"
    )
    assert page.evaluate(pinned) == before
    assert page.evaluate(ROW.format("rest", "Static tip deflection (maximum load)")) != before
    assert page.evaluate("document.getElementById('tip').data.length") == 2
    page.evaluate("document.getElementById('pin').click()")
    page.evaluate(SET.format(0.003, "joint.play"))
    page.wait_for(ANSWERED)
    assert page.evaluate("document.getElementById('tip').data.length") == 1


def test_the_case_is_saved_with_its_changes(page: Page) -> None:
    """Reference: the text that the page receives, read as a case file."""
    page.evaluate(
        "URL.createObjectURL = blob => { blob.text().then(text => { window.saved = text; });"
        " return 'data:,'; }"
    )
    page.evaluate(SET.format(0.004, "joint.play"))
    page.evaluate("document.getElementById('save').click()")
    page.wait_for("window.saved")
    case = Case.model_validate(tomllib.loads(page.evaluate("saved")))
    assert [joint.play for joint in case.joints] == [0.004, 0.004]
    page.evaluate(SET.format(0.003, "joint.play"))
    page.wait_for(ANSWERED)


def test_a_shell_runs_beside_the_beam(tmp_path: Path) -> None:
    """After a cancelled run, the next one shows its results and report."""
    press = "document.getElementById('run').click()"
    progress = "document.getElementById('progress').textContent"
    with served_page("coarse.toml", tmp_path) as (page, live):
        page.evaluate(press)
        page.wait_for(f"{progress}.includes(' s)')")
        page.evaluate(press)
        page.wait_for(f"{progress} == 'cancelled'")
        while live.shells.running:
            sleep(0.05)
        page.evaluate(press)
        page.wait_for("document.getElementById('run').textContent == 'Run the shell'", 600.0)
        assert page.evaluate(progress).startswith("finished in")
        heads = "[...document.querySelectorAll('#compared th')].map(head => head.textContent)"
        assert page.evaluate(heads) == ["", "shell", "beam"]
        link = "document.getElementById('report')"
        assert not page.evaluate(f"{link}.hidden")
        page.open(page.evaluate(f"{link}.href"), 1200)
        assert "shell" in page.evaluate("document.body.textContent")


@pytest.mark.parametrize("width", [400, 800, 1200])
def test_the_page_fits_its_window(page: Page, width: int) -> None:
    page.set_width(width)
    page.wait_for(f"document.documentElement.scrollWidth <= {width}")


@pytest.mark.parametrize("width", [400, 800, 1200])
def test_no_word_of_a_label_breaks(page: Page, width: int) -> None:
    """Reference: the browser, which draws a whole word in one rectangle."""
    page.set_width(width)
    assert page.evaluate(BROKEN_WORDS) == []


def test_the_browser_has_nothing_to_complain_of(page: Page) -> None:
    assert page.complaints == []
