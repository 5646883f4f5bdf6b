# SPDX-License-Identifier: LGPL-3.0-or-later
"""A page in a real headless browser, driven through the DevTools protocol's pipe.

Its messages are JSON objects that end with a zero byte: requests go to the browser's file
descriptor 3, answers and events come from its 4.
"""

import json
import os
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

SECONDS = 60.0
FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--remote-debugging-pipe",
)  # fmt: skip
COMPLAINTS = (
    "Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded",
    "Network.loadingFailed",
)  # fmt: skip
# Gives the pipes the numbers that the protocol asks for; they may have each other's.
LAUNCH = """
import fcntl, os, sys
ends = [fcntl.fcntl(int(end), fcntl.F_DUPFD, 10) for end in sys.argv[1:3]]
for end, number in zip(ends, (3, 4)):
    os.dup2(end, number)
os.execv(sys.argv[3], sys.argv[3:])
"""


def find_browser() -> str | None:
    """Return the path of Chromium; None if it is not installed."""
    names = ("chromium", "chromium-browser", "google-chrome")
    return next(filter(None, map(shutil.which, names)), None)


class Page:
    """A tab of the browser, with its errors and warnings."""

    def __init__(self, requests: int, answers: int) -> None:
        self._requests, self._answers = requests, answers
        self._rest = b""
        self._number = 0
        self._session: str | None = None
        self._loaded = False
        self.complaints: list[str] = []
        target = self._ask("Target.createTarget", url="about:blank")["targetId"]
        attached = self._ask("Target.attachToTarget", targetId=target, flatten=True)
        self._session = attached["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self._ask(f"{domain}.enable")

    def open(self, source: Path | str, width: int) -> None:
        """Load a file or an address at a width in CSS pixels, as a telephone does."""
        self.set_width(width)
        self._loaded = False
        url = source.resolve().as_uri() if isinstance(source, Path) else source
        self._ask("Page.navigate", url=url)
        while not self._loaded:
            self._receive()

    def set_width(self, width: int) -> None:
        """Set the width of the window in CSS pixels."""
        size = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": True}
        self._ask("Emulation.setDeviceMetricsOverride", **size)

    def evaluate(self, expression: str) -> Any:
        """Return the value of a JavaScript expression in the page."""
        answer = self._ask("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def wait_for(self, expression: str, seconds: float = SECONDS) -> None:
        """Wait until an expression is true, at most for some seconds."""
        end = time.monotonic() + seconds
        while not self.evaluate(f"!!({expression})"):
            assert time.monotonic() < end, f"{expression} stays false"
            time.sleep(0.05)

    def point_at(self, x: float, y: float, press: bool = False) -> None:
        """Move the mouse to a place in CSS pixels, and click there if asked to."""
        self._ask("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        for kind in ("mousePressed", "mouseReleased") if press else ():
            button = {"button": "left", "clickCount": 1}
            self._ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, **button)

    def show_as(self, media: str) -> None:
        """Emulate a medium: ``print`` for paper, an empty text for a screen."""
        self._ask("Emulation.setEmulatedMedia", media=media)

    def _ask(self, method: str, **parameters: Any) -> Any:
        self._number += 1
        number = self._number
        request = {"id": number, "method": method, "params": parameters}
        if self._session is not None:
            request["sessionId"] = self._session
        os.write(self._requests, json.dumps(request).encode() + b"\0")
        while True:
            answer = self._receive()
            if answer.get("id") == number:
                assert "error" not in answer, answer
                return answer["result"]

    def _receive(self) -> Any:
        end = time.monotonic() + SECONDS
        while b"\0" not in self._rest:
            ready, _, _ = select.select([self._answers], [], [], end - time.monotonic())
            part = os.read(self._answers, 1 << 16) if ready else b""
            assert part, "the browser does not answer"
            self._rest += part
        message, _, self._rest = self._rest.partition(b"\0")
        answer = json.loads(message)
        self._loaded |= answer.get("method") == "Page.loadEventFired"
        if answer.get("method") in COMPLAINTS:
            self.complaints.append(json.dumps(answer["params"]))
        return answer


@contextmanager
def blank_page(browser: str, folder: Path) -> Iterator[Page]:
    """Yield one page of a browser, which ends with the context, and has its profile in a folder."""
    to_browser, requests = os.pipe()
    answers, from_browser = os.pipe()
    ends = (str(to_browser), str(from_browser))
    process = subprocess.Popen(
        [sys.executable, "-c", LAUNCH, *ends, browser, *FLAGS, f"--user-data-dir={folder}"],
        pass_fds=(to_browser, from_browser),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(to_browser)
    os.close(from_browser)
    try:
        yield Page(requests, answers)
    finally:
        os.close(requests)
        os.close(answers)
        process.terminate()
        process.wait(SECONDS)
