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
from tests.system.run_folder import write_coarse

pytestmark = pytest.mark.slow

# Sets a field as a user does.
SET = (
    "(e => {{ e.value = {}; e.dispatchEvent(new Event('input')); }})(document.querySelector('{}'))"
)
ANSWERED = "document.body.dataset.answered == number"
REFUSED = "document.getElementById('shown').classList.contains('stale')"
# Height of the tip in the picture, in m.
END = "Math.max(...document.getElementById('boom').data[1].y)"


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
def served_page(case: Path, profile: Path) -> Iterator[tuple[Page, LivePage]]:
    """Yield the live page of a case, with its first results, and what serves it."""
    browser = find_browser()
    if browser is None:
        pytest.skip("the live page is opened in chromium, and there is none on PATH")
    live = LivePage(Draft.load(str(case)))
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
    folder = tmp_path_factory.mktemp("profile")
    text = (CASES / "lift.toml").read_text("utf-8").replace("duration = 3.0", "duration = 0.5")
    (folder / "lift.toml").write_text(text, "utf-8")
    with served_page(folder / "lift.toml", folder) as (opened, _):
        yield opened


def put(page: Page, key: str, value: float, field: str = '[id="number {}"]') -> None:
    """Set a number of the page, and wait for its results."""
    page.evaluate(SET.format(value, field.format(key)))
    page.wait_for(ANSWERED)


def shown(page: Page, table: str, row: str, cell: int = 1) -> str:
    """Return the text of a cell of the first row of a table with this beginning."""
    rows = f"[...document.querySelectorAll('#{table} tr')]"
    found = f"{rows}.find(r => r.cells[0].textContent.startsWith('{row}'))"
    return str(page.evaluate(f"{found}.cells[{cell}].textContent"))


def tip(page: Page, cell: int = 1) -> float:
    """Return the static tip deflection under the maximum load in mm."""
    text = shown(page, "rest", "Static tip deflection (maximum load)", cell)
    return float(re.sub(r"[^0-9.−]", "", text).replace("−", "-"))


def test_a_slider_changes_numbers_and_pictures(page: Page) -> None:
    """Reference: physics. More payload lowers the tip, also in the picture."""
    before, drawn = tip(page), page.evaluate(END)
    moved = shown(page, "motion", "Maximum dynamic")
    put(page, "Payload", 300, 'input[type=range][aria-label="{}"]')
    assert page.evaluate("document.getElementById('number payload.mass').value") == "300"
    assert tip(page) < before - 20.0
    # The boom leans at 45 degrees and is drawn to scale.
    lower = 1e-3 * (tip(page) - before) / 2**0.5
    assert page.evaluate(END) - drawn == pytest.approx(lower, rel=0.05)
    assert shown(page, "motion", "Maximum dynamic") != moved
    put(page, "payload.mass", 150)
    assert tip(page) == before


def test_a_refusal_stands_at_its_field(page: Page) -> None:
    page.evaluate(SET.format(-1, '[id="number joint.play"]'))
    page.wait_for(REFUSED)
    field = "document.getElementById('number joint.play')"
    message = f"{field}.closest('.control').querySelector('.message').textContent"
    assert page.evaluate(message) == "must be a number not less than 0, got -1"
    put(page, "joint.play", 0.003)
    page.wait_for(f"!{REFUSED}")
    assert page.evaluate(message) == ""


def test_the_last_of_many_changes_is_shown(page: Page) -> None:
    for mass in (160, 170, 180, 190):
        page.evaluate(SET.format(mass, '[id="number payload.mass"]'))
    put(page, "payload.mass", 200)
    last = tip(page)
    put(page, "payload.mass", 150)
    before = tip(page)
    put(page, "payload.mass", 200)
    assert tip(page) == last < before
    put(page, "payload.mass", 150)


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
    before = tip(page)
    curves = "document.getElementById('tip').data.length"
    page.evaluate("document.getElementById('pin').click()")
    put(page, "joint.play", 0.005)
    assert tip(page, 2) == before != tip(page)
    assert page.evaluate(curves) == 2
    page.evaluate("document.getElementById('pin').click()")
    put(page, "joint.play", 0.003)
    assert page.evaluate(curves) == 1


def test_the_case_is_saved_with_its_changes(page: Page) -> None:
    """Reference: the text that the page receives, read as a case file."""
    page.evaluate(
        "URL.createObjectURL = blob => { blob.text().then(text => { window.saved = text; });"
        " return 'data:,'; }"
    )
    put(page, "joint.play", 0.004)
    page.evaluate("document.getElementById('save').click()")
    page.wait_for("window.saved")
    case = Case.model_validate(tomllib.loads(page.evaluate("saved")))
    assert [joint.play for joint in case.joints] == [0.004, 0.004]
    put(page, "joint.play", 0.003)


def test_a_shell_runs_beside_the_beam(tmp_path: Path) -> None:
    """After a cancelled run, the next one shows its results and report."""
    press = "document.getElementById('run').click()"
    progress = "document.getElementById('progress').textContent"
    case = write_coarse(tmp_path, 0.02)
    case.write_text(case.read_text("utf-8").replace("mesh_size = 0.25", "mesh_size = 1.0"), "utf-8")
    with served_page(case, tmp_path / "profile") as (page, live):
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
    """Reference: the browser, which draws a whole word in one rectangle. It has no complaints."""
    page.set_width(width)
    page.wait_for(f"document.documentElement.scrollWidth <= {width}")
    assert page.evaluate(BROKEN_WORDS) == []
    assert page.complaints == []
