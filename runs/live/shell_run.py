# SPDX-License-Identifier: LGPL-3.0-or-later
"""Run of a shell in its own process, while the live page computes the beam."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from time import perf_counter
from typing import Any

from runs.case import toml
from runs.case.messages import BadInput
from runs.case.schema import Case
from runs.pipeline.results import Results
from runs.report.output import REPORT
from runs.report.summary_table import deviation_note, summary_table
from runs.report.viewer import VIEWER

# Time in s between two progress reports, and longest wait in s for the end of a cancelled run.
_INTERVAL, _WAIT = 0.5, 3.0

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

        Args:
            case: the case, with the models to run.
            file: name of the case in messages.

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
            while (status := self._wait()) is None:
                line = _last_line(messages) or "starting"
                yield {"stage": "shell", "progress": f"{line} ({perf_counter() - begin:.0f} s)"}
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

    def _wait(self) -> int | None:
        """Wait a short while for the process, and return its status; None while it runs."""
        assert self._process is not None
        try:
            return self._process.wait(_INTERVAL)
        except subprocess.TimeoutExpired:
            return None

    def _stop(self) -> None:
        if self._process is not None:
            self._process.terminate()
            self._process.wait()
            self._process = None


def _last_line(messages: Path) -> str:
    lines = messages.read_text(encoding="utf-8", errors="replace").splitlines()
    return lines[-1].removeprefix(f"protractile: {_CASE}: ") if lines else ""
