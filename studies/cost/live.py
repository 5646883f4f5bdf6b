# SPDX-License-Identifier: LGPL-3.0-or-later
"""Latency of the live page in headless Chromium, from the last movement of a slider to the picture.

    python -m studies.cost.live [CASE ...]

The command changes four sliders of each case, 50 times by a click and 50 times by a drag. For each
stage of the results, it prints median and 95th percentile of the latency in ms.
"""

from __future__ import annotations

import sys
import threading
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from protractile.runs import CASES
from protractile.runs.live.controls import Draft
from protractile.runs.live.server import LivePage, make_server
from tests.system.browser import Page, blank_page, find_browser

CHANGES = 50
STAGES = ("rest", "preview", "motion")
BOOMS = ("lift.toml", "crane.toml", "inspection-arm.toml")

# Number of movements of a slider in each change, one every 16 ms as a mouse makes them.
MOVEMENTS = {"click": 1, "drag": 25}

# Moves a slider in steps to a fraction of its range near the value of the file.
MOVE = """(() => {{
  const slider = document.querySelectorAll('#list input[type=range]')[{slider}];
  let moved = window.moved = 0;
  const move = () => {{
    slider.value = {start} * (1 + {part} * ++moved / {movements});
    Object.values(latencies).forEach(list => list.length = 0);
    slider.dispatchEvent(new Event('input'));
    if (moved < {movements}) setTimeout(move, 16); else window.moved = moved;
  }};
  move();
}})()"""


def measure(page: Page, address: str, movements: int) -> dict[str, list[float]]:
    """Return the latencies in ms by stage, from the last movement of each change."""
    page.open(address, 1200)
    page.wait_for("document.body.dataset.answered == number")
    starts = page.evaluate(
        "[...document.querySelectorAll('#list input[type=range]')].map(one => Number(one.value))"
    )
    used = [index for index, value in enumerate(starts) if value][:4]
    found: dict[str, list[float]] = {stage: [] for stage in STAGES}
    for change in range(CHANGES):
        slider, part = used[change % len(used)], 0.002 * (1 + change % 7)
        start = starts[slider]
        page.evaluate(MOVE.format(slider=slider, start=start, part=part, movements=movements))
        page.wait_for(f"moved == {movements} && document.body.dataset.answered == number")
        latencies = page.evaluate("latencies")
        for stage in STAGES:
            found[stage] += latencies[stage]
    return found


def main() -> None:
    """Print a line for each case and stage."""
    browser = find_browser()
    if browser is None:
        sys.exit("there is no chromium on PATH")
    print(f"{'case':<22}{'change':<8}{'stage':<10}{'changes':>8}{'median':>8}{'95 %':>8}  ms")
    for name in sys.argv[1:] or BOOMS:
        live = LivePage(Draft.load(str(CASES / name)))
        server, address = make_server(live)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        with TemporaryDirectory() as profile, blank_page(browser, Path(profile)) as page:
            for change, movements in MOVEMENTS.items():
                for stage, passed in measure(page, address, movements).items():
                    median, high = np.percentile(passed, (50.0, 95.0))
                    print(
                        f"{name:<22}{change:<8}{stage:<10}{len(passed):>8}{median:>8.0f}{high:>8.0f}"
                    )
        server.shutdown()
        server.server_close()


if __name__ == "__main__":
    main()
