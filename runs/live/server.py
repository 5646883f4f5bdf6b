# SPDX-License-Identifier: LGPL-3.0-or-later
"""Server of the live page, for this machine only, at an address with a secret token.

A shell runs in its own process, while the live page computes the beam.
"""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import webbrowser
from collections.abc import Callable, Generator, Iterator
from contextlib import ExitStack, closing, suppress
from dataclasses import asdict, dataclass, field
from functools import cached_property, partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from secrets import token_urlsafe
from tempfile import TemporaryDirectory
from threading import Lock, Semaphore
from time import perf_counter
from typing import Any

import numpy as np

from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.runs.case import toml
from protractile.runs.case.reading import check
from protractile.runs.case.schema import Case
from protractile.runs.live.beam import beam_results
from protractile.runs.live.controls import Draft
from protractile.runs.pipeline.estimates import run_cost
from protractile.runs.pipeline.model_run import failure_reason
from protractile.runs.pipeline.results import Results
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.ending import when_interrupted
from protractile.runs.report.output import REPORT
from protractile.runs.report.pages import page
from protractile.runs.report.summary_table import deviation_note, summary_table
from protractile.runs.report.viewer import VIEWER

_HTML = "text/html; charset=utf-8"

# Interval in s at which a waiting request checks whether a newer one has replaced it.
_INTERVAL = 0.02

# Maximum size of a request in bytes, and its number of digits.
_MAX_SIZE, _DIGITS = 1_000_000, 7

# Last part of the path of each kind of request.
ANSWERS = ("beam", "control", "case", "shell")

# Largest number of tabs whose beams are computed at the same time, and of tabs that are remembered.
_MOST_COMPUTATIONS, _MOST_TABS = 4, 100

# Time in s after which a connection without a byte ends.
_SILENCE = 60.0

# Time in s between two progress reports, and longest wait in s for the end of a cancelled run.
_REPORT_INTERVAL, _WAIT = 0.5, 3.0

# Program of a run, which ends with this process. Its first argument is the number of this process.
_RUN = """
import sys
from protractile.runs.process.ending import end_with_parent
end_with_parent(int(sys.argv.pop(1)))
from protractile.__main__ import main
main()
"""

# Name of the case file of a run in its folder.
_CASE = "case.toml"


@dataclass
class ShellRuns:
    """Runs of shells, one at a time. The folder of the last run stays until the page ends."""

    _folder: TemporaryDirectory[str] | None = None
    _process: subprocess.Popen[bytes] | None = None
    _busy: Lock = field(default_factory=Lock)

    def run(self, case: Case, file: str) -> Iterator[Any]:
        """Yield the progress of a run, then its results; closing the generator ends the run.

        Raises:
            BadInput: another run has not ended, or the run fails.
        """
        if not self._busy.acquire(timeout=_WAIT):
            raise BadInput(file, "shell", "another run has not ended; cancel it first")
        try:
            self.end()
            self._folder = TemporaryDirectory(prefix="protractile-live-")
            folder, begin = Path(self._folder.name), perf_counter()
            (folder / _CASE).write_text(toml.dumps(case), encoding="utf-8")
            messages = folder / "messages.txt"
            command = [sys.executable, "-c", _RUN, str(os.getpid()), "run", _CASE]
            with messages.open("wb") as stream:
                self._process = subprocess.Popen(
                    [*command, "--out", "out", "--no-pictures", "--large"],
                    cwd=folder,
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=stream,
                )
            while (status := self._process.poll()) is None:
                line = _last_line(messages) or "starting"
                yield {"stage": "shell", "progress": f"{line} ({perf_counter() - begin:.0f} s)"}
                with suppress(subprocess.TimeoutExpired):
                    self._process.wait(_REPORT_INTERVAL)
            # A run that does not meet a demand of the case has results, too.
            if not (folder / "out").is_dir():
                raise BadInput(file, "shell", _last_line(messages) or f"ended with status {status}")
            results = Results.load(folder / "out")
            table = summary_table(results)
            assert table is not None
            yield {
                "stage": "shell",
                "rows": [table.headings, *table.rows],
                "note": deviation_note(results),
                "progress": f"finished in {perf_counter() - begin:.0f} s",
            }
        finally:
            self._stop()
            self._busy.release()

    @property
    def running(self) -> bool:
        """True until a run has ended, also after its cancellation."""
        return self._busy.locked()

    def file(self, name: str) -> Path | None:
        """Return the report or the viewer of the last run; None without such a file."""
        if self._folder is None or name not in (REPORT, VIEWER):
            return None
        path = Path(self._folder.name) / "out" / name
        return path if path.is_file() else None

    def end(self) -> None:
        """End the process of a run, and remove the folder of the last one."""
        self._stop()
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = None

    def _stop(self) -> None:
        if self._process is not None:
            self._process.terminate()
            self._process.wait()
            self._process = None


def _last_line(messages: Path) -> str:
    lines = messages.read_text(encoding="utf-8", errors="replace").splitlines()
    return lines[-1].removeprefix(f"protractile: {_CASE}: ") if lines else ""


class Superseded(Exception):
    """Error in a request that nobody waits for: its tab is closed, or has sent a newer one."""


@dataclass
class _Tab:
    """The latest request of a browser tab, and the lock of its computation."""

    newest: int = 0
    computing: Lock = field(default_factory=Lock)


@dataclass
class LivePage:
    """Live page of a case, in any number of browser tabs."""

    draft: Draft  #: case with editable values
    token: str = field(default_factory=token_urlsafe)  #: first part of the path of each address
    shells: ShellRuns = field(default_factory=ShellRuns)  #: runs of the shell models of the case
    _tabs: dict[str, _Tab] = field(default_factory=dict)
    _cores: Semaphore = field(default_factory=partial(Semaphore, _MOST_COMPUTATIONS))

    @cached_property
    def files(self) -> dict[str, tuple[str, bytes]]:
        """The media type and the content of each file of the page, by path."""
        from plotly.offline import get_plotlyjs

        draft = self.draft
        html = page(
            Path(__file__).parent / "templates" / "live.html",
            title=draft.case.title,
            controls=[asdict(control) for control in draft.controls()],
            keys=draft.keys,
            file=Path(draft.file).name,
        )
        return {
            "": (_HTML, html.encode()),
            "plotly.js": ("text/javascript; charset=utf-8", get_plotlyjs().encode()),
        }

    def beam(
        self, request: dict[str, Any], closed: Callable[[], bool] = lambda: False
    ) -> Generator[Any]:
        """Yield the results of the beam for the numbers in a request.

        A later request of the same tab ends the computation with :class:`Superseded`, and so does
        the end of the connection, about which ``closed`` is asked.
        """
        name, number = str(request["tab"]), int(request["number"])
        tab = self._tabs.setdefault(name, _Tab())
        tab.newest = max(number, tab.newest)
        idle = [name for name, other in self._tabs.items() if not other.computing.locked()]
        for name in idle[:-_MOST_TABS]:
            del self._tabs[name]

        def check_current() -> None:
            if tab.newest != number or closed():
                raise Superseded

        with ExitStack() as locks:
            for lock in (tab.computing, self._cores):
                while not lock.acquire(timeout=_INTERVAL):
                    check_current()
                locks.callback(lock.release)
            check_current()
            checked = self.draft.beam(self.draft.changed(dict(request["values"])))
            yield from beam_results(checked, self.draft, check_current)

    def control(self, request: dict[str, Any]) -> Generator[Any]:
        """Yield the control for the key in a request."""
        yield asdict(self.draft.control(str(request["key"])))

    def case(self, request: dict[str, Any]) -> Generator[Any]:
        """Yield the text of the case file with the numbers in a request."""
        yield {"stage": "case", "text": toml.dumps(self.draft.changed(dict(request["values"])))}

    def shell(self, request: dict[str, Any]) -> Generator[Any]:
        """Yield progress and results of a shell run; a request must allow a large run."""
        case = self.draft.changed(dict(request["values"]))
        models = *self.draft.beam(case).case.models, *self.draft.shells
        case = check(case.model_copy(update={"models": models}), self.draft.file).case
        cost = run_cost(case)
        if cost.large and not request.get("large"):
            yield {"stage": "large", "what": f"The run may take {cost}. Start it anyway?"}
            return
        yield {"stage": "shell", "progress": f"may take {cost}"}
        yield from self.shells.run(case, self.draft.file)

    def lines(
        self, path: str, request: dict[str, Any], closed: Callable[[], bool] = lambda: False
    ) -> Generator[bytes]:
        """Yield the lines of an answer, each a JSON value; an error is the last line.

        ``path`` is one of :data:`ANSWERS`, and ``closed`` returns True if nobody reads the answer.
        """
        from plotly.io.json import to_json_plotly

        answers: dict[str, Callable[[dict[str, Any]], Generator[Any]]] = {
            "beam": partial(self.beam, closed=closed),
            "control": self.control,
            "case": self.case,
            "shell": self.shell,
        }
        try:
            with np.errstate(all="ignore"), closing(answers[path](request)) as answer:
                for value in answer:
                    yield str(to_json_plotly(value)).encode() + b"\n"
        except Superseded:
            return
        except BadInput as error:
            yield _error_line(error.key, error.what)
        except NUMERICAL_ERRORS as error:
            yield _error_line("", failure_reason(error))
        except OSError as error:
            yield _error_line("", f"a file cannot be used ({error.strerror or error})")
        except (KeyError, TypeError, RecursionError) as error:
            yield _error_line("", f"the request is not understood ({error})")


def _error_line(key: str, what: str) -> bytes:
    return json.dumps({"stage": "refused", "key": key, "what": what}).encode() + b"\n"


class _Handler(BaseHTTPRequestHandler):
    """Handler of one connection."""

    timeout = _SILENCE

    def __init__(self, live: LivePage, *connection: Any) -> None:
        self._live = live
        super().__init__(*connection)

    def handle(self) -> None:
        """Answer a request. A connection that its page ends, or leaves silent, is no error."""
        with suppress(ConnectionError, TimeoutError):
            super().handle()

    def do_GET(self) -> None:
        """Send a file of the page."""
        path = self._path()
        if path in self._live.files:
            kind, content = self._live.files[path]
        elif path is not None and (file := self._live.shells.file(path)) is not None:
            kind, content = _HTML, file.read_bytes()
        else:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        self._begin(kind)
        self.wfile.write(content)

    def do_POST(self) -> None:
        """Answer a request line by line."""
        path, size = self._path(), self.headers.get("Content-Length", "")
        if path not in ANSWERS:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        # A number of thousands of digits is no int.
        if not (size.isdecimal() and len(size) <= _DIGITS and int(size) <= _MAX_SIZE):
            self.send_error(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
            return
        request = None
        with suppress(ValueError, RecursionError):
            request = json.loads(self.rfile.read(int(size)))
        if not isinstance(request, dict):
            self.send_error(HTTPStatus.BAD_REQUEST)
            return
        self._begin("application/x-ndjson")
        with closing(self._live.lines(path, request, self._closed)) as lines:
            self.wfile.writelines(lines)

    def log_message(self, *_: Any) -> None:
        """Print nothing."""

    def _path(self) -> str | None:
        """Return the part of the path after the token; None if the token is missing or wrong.

        Another page in the browser, or another name of this machine, has no access either.
        """
        token, _, path = self.path.removeprefix("/").partition("/")
        own = "{}:{}".format(*self.connection.getsockname())
        asked = self.headers.get("Host"), self.headers.get("Origin", f"http://{own}")
        known = (*asked, token) == (own, f"http://{own}", self._live.token)
        return path if known else None

    def _closed(self) -> bool:
        """Return True if the page has closed the connection: it sent a newer request or is gone."""
        poll = select.poll()
        poll.register(self.connection, select.POLLRDHUP)
        return bool(poll.poll(0))

    def _begin(self, kind: str) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        # With "no-store" Chromium reports complete answers as aborted.
        self.send_header("Cache-Control", "no-cache")
        self.send_header("Referrer-Policy", "same-origin")
        self.end_headers()


def make_server(live: LivePage) -> tuple[ThreadingHTTPServer, str]:
    """Return a server of a live page on a free port, and the page's address."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Handler, live))
    server.daemon_threads = True
    return server, f"http://127.0.0.1:{server.server_port}/{live.token}/"


def serve(file: str, browser: bool) -> None:
    """Serve the live page of a case file, also in the user's browser, until an interrupt.

    Raises:
        BadInput: the file cannot be read, or its content is invalid.
    """
    live = LivePage(Draft.load(file))
    server, address = make_server(live)
    print(f"{address}\nCtrl-C ends the page.", flush=True)
    if browser:
        webbrowser.open(address)
    with when_interrupted(live.shells.end):
        server.serve_forever()
