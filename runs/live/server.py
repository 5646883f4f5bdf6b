# SPDX-License-Identifier: LGPL-3.0-or-later
"""Server of the live page, for this machine only, at an address with a secret token.

A shell runs in its own process, while the live page computes the beam.
"""

from __future__ import annotations

import json
import subprocess
import sys
import webbrowser
from collections.abc import Callable, Generator, Iterator
from contextlib import closing, suppress
from dataclasses import asdict, dataclass, field
from functools import cached_property, partial
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from secrets import token_urlsafe
from tempfile import TemporaryDirectory
from threading import Lock
from time import perf_counter
from typing import Any

import numpy as np

from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.runs.case import toml
from protractile.runs.case.messages import BadInput
from protractile.runs.case.reading import check
from protractile.runs.case.schema import Case
from protractile.runs.live.beam import beam_results
from protractile.runs.live.controls import Draft
from protractile.runs.pipeline.estimates import run_cost
from protractile.runs.pipeline.model_run import failure_reason
from protractile.runs.pipeline.results import Results
from protractile.runs.process.ending import when_interrupted
from protractile.runs.report.output import REPORT
from protractile.runs.report.pages import page
from protractile.runs.report.summary_table import deviation_note, summary_table
from protractile.runs.report.viewer import VIEWER

_HTML = "text/html; charset=utf-8"

# Interval in s at which a waiting request checks whether a newer one has replaced it.
_INTERVAL = 0.02

# Maximum size of a request in bytes.
_MAX_SIZE = 1_000_000

# Time in s between two progress reports, and longest wait in s for the end of a cancelled run.
_REPORT_INTERVAL, _WAIT = 0.5, 3.0

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
            command = [sys.executable, "-m", "protractile", "run", _CASE]
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
            # Status 1 is a run that does not meet a demand of the case.
            if status not in (0, 1):
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
    """Error in a request that a newer request of the same tab has replaced."""


@dataclass
class LivePage:
    """Live page of a case, in any number of browser tabs."""

    draft: Draft  #: case with editable values
    token: str = field(default_factory=token_urlsafe)  #: first part of the path of each address
    shells: ShellRuns = field(default_factory=ShellRuns)  #: runs of the shell models of the case
    _newest: dict[str, int] = field(default_factory=dict)
    _computing: Lock = field(default_factory=Lock)

    @cached_property
    def files(self) -> dict[str, tuple[str, bytes]]:
        """The media type and the content of each file of the page, by path."""
        from plotly.offline import get_plotlyjs

        draft = self.draft
        html = page(
            "live.html",
            title=draft.case.title,
            controls=[asdict(control) for control in draft.controls()],
            keys=draft.keys,
            file=Path(draft.file).name,
        )
        return {
            "": (_HTML, html.encode()),
            "plotly.js": ("text/javascript; charset=utf-8", get_plotlyjs().encode()),
        }

    def beam(self, request: dict[str, Any]) -> Generator[Any]:
        """Yield the results of the beam for the numbers in a request.

        A later request of the same tab ends the computation with :class:`Superseded`.
        """
        tab, number = str(request["tab"]), int(request["number"])
        self._newest[tab] = max(number, self._newest.get(tab, 0))

        def check_current() -> None:
            if self._newest[tab] != number:
                raise Superseded

        while not self._computing.acquire(timeout=_INTERVAL):
            check_current()
        try:
            check_current()
            checked = self.draft.beam(self.draft.changed(dict(request["values"])))
            yield from beam_results(checked, self.draft, check_current)
        finally:
            self._computing.release()

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

    @property
    def answers(self) -> dict[str, Callable[[dict[str, Any]], Generator[Any]]]:
        """The functions that answer requests, by the last part of the path."""
        return {"beam": self.beam, "control": self.control, "case": self.case, "shell": self.shell}

    def lines(self, path: str, request: dict[str, Any]) -> Generator[bytes]:
        """Yield the lines of an answer, each a JSON value; an error is the last line."""
        from plotly.io.json import to_json_plotly

        try:
            with np.errstate(all="ignore"), closing(self.answers[path](request)) as answer:
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
        except (KeyError, TypeError, ValueError) as error:
            yield _error_line("", f"the request is not understood ({error})")


def _error_line(key: str, what: str) -> bytes:
    return json.dumps({"stage": "refused", "key": key, "what": what}).encode() + b"\n"


class _Handler(BaseHTTPRequestHandler):
    """Handler of one connection."""

    def __init__(self, live: LivePage, *connection: Any) -> None:
        self._live = live
        super().__init__(*connection)

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
        if path not in self._live.answers:
            self.send_error(HTTPStatus.NOT_FOUND)
            return
        if not (size.isdecimal() and int(size) <= _MAX_SIZE):
            self.send_error(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
            return
        request = None
        with suppress(ValueError):
            request = json.loads(self.rfile.read(int(size)))
        if not isinstance(request, dict):
            self.send_error(HTTPStatus.BAD_REQUEST)
            return
        self._begin("application/x-ndjson")
        # The connection ends if the page sends a newer request, or is closed.
        with suppress(ConnectionError), closing(self._live.lines(str(path), request)) as lines:
            self.wfile.writelines(lines)

    def log_message(self, *_: Any) -> None:
        """Print nothing."""

    def _path(self) -> str | None:
        """Return the part of the path after the token; None if the token is missing or wrong."""
        token, _, path = self.path.removeprefix("/").partition("/")
        return path if token == self._live.token else None

    def _begin(self, kind: str) -> None:
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        # With "no-store" Chromium reports complete answers as aborted.
        self.send_header("Cache-Control", "no-cache")
        self.send_header("Referrer-Policy", "no-referrer")
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
