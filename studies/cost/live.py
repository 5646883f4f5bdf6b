# SPDX-License-Identifier: LGPL-3.0-or-later
"""Latency of the live page in headless Chromium, from a change to the picture.

    python -m studies.cost.live [CASE ...]

moves four sliders of each case 50 times, one change after the other, and prints the median and the
95th percentile of the time in ms after which each stage of the results is drawn.
"""

from __future__ import annotations

import sys
import threading
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from runs import CASES
from runs.live.knobs import Draft
from runs.live.server import LivePage, make_server
from tests.system.browser import Page, blank_page, find_browser

CHANGES = 50
STAGES = ("rest", "preview", "motion")
BOOMS = ("lift.toml", "crane.toml", "inspection-arm.toml")

# Moves a slider to a fraction of its range near the value of the file.
MOVE = """(() => {{
  const slider = document.querySelectorAll('#list input[type=range]')[{slider}];
  slider.value = {start} * (1 + {part});
  slider.dispatchEvent(new Event('input'));
}})()"""


def measure(page: Page, address: str) -> dict[str, list[float]]:
    """Return the latencies in ms of each stage over the changes of one case."""
    page.open(address, 1200)
    page.wait_for("document.body.dataset.answered == number")
    starts = page.evaluate(
        "[...document.querySelectorAll('#list input[type=range]')].map(one => Number(one.value))"
    )
    moved = [index for index, value in enumerate(starts) if value][:4]
    page.evaluate("Object.values(latencies).forEach(list => list.length = 0)")
    for change in range(CHANGES):
        slider = moved[change % len(moved)]
        part = 0.002 * (1 + change % 7)
        page.evaluate(MOVE.format(slider=slider, start=starts[slider], part=part))
        page.wait_for("document.body.dataset.answered == number")
    found = page.evaluate("latencies")
    return {stage: found[stage] for stage in STAGES}


def main() -> None:
    """Print a line for each case and stage."""
    browser = find_browser()
    if browser is None:
        sys.exit("there is no chromium on PATH")
    print(f"{'case':<22}{'stage':<10}{'changes':>8}{'median':>8}{'95 %':>8}  ms")
    for name in sys.argv[1:] or BOOMS:
        live = LivePage(Draft.load(str(CASES / name)))
        server, address = make_server(live)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        with TemporaryDirectory() as profile, blank_page(browser, Path(profile)) as page:
            for stage, passed in measure(page, address).items():
                median, high = np.percentile(passed, (50.0, 95.0))
                print(f"{name:<22}{stage:<10}{len(passed):>8}{median:>8.0f}{high:>8.0f}")
        server.shutdown()
        server.server_close()


if __name__ == "__main__":
    main()
