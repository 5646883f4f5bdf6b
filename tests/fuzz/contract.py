# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contract of every command and every call from Python for any input, checked in a process.

The exit status is 0, 1, 2 or 3. If it is not 0, stderr has a single printable line of less than
300 characters besides progress. A command needs at most 4 GB, and 60 s of CPU time more than
announced. A call returns, or this program itself raises BadInput, ValueError or NumericsError with
such a line: status 2.
"""

import os
import re
import resource
import sys
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import protractile as pt
from protractile.runs import cli
from protractile.runs.case import reading as case_file
from protractile.runs.pipeline import estimates
from protractile.runs.process.terminal import LONGEST, message

# What commands import when they are given, which each process would do by itself.
for name in ("check", "pipeline.run", "report.output", "paper.rules", "sweep.run"):
    import_module(f"protractile.runs.{name}")
for name in ("optimize", "signal"):
    import_module(f"scipy.{name}")

MOST_MEMORY = 4.0e9
MOST_CPU = 60

# Where a process leaves what it prints, in its folder.
OUT, ERR = ".stdout", ".stderr"


# What runs/process/terminal.py says of what takes long.
PROGRESS = re.compile(r".+: .+ (started|finished|took \d+ s|\d+ %(, \d+ s left)?)")


@dataclass(frozen=True, slots=True)
class Ending:
    """End of a command.

    Args:
        status: status of its exit; negative for the signal that killed it.
        err: text on stderr.
        seconds: seconds of CPU.
        memory: largest resident set in bytes.
    """

    status: int
    err: bytes
    seconds: float
    memory: float

    def breach(self) -> str:
        """Return the violated part of the contract; nothing if it was kept."""
        if self.status not in (0, 1, 2, 3):
            return f"exit status {self.status}: {self.err[-300:]!r}"
        if self.memory > MOST_MEMORY:
            return f"{self.memory / 1e9:.2g} GB"
        said = self.err.decode("utf-8", "replace").splitlines()
        lines = [line for line in said if not PROGRESS.fullmatch(line)]
        if len(lines) != (0 if self.status == 0 else 1):
            return f"{len(lines)} lines with exit status {self.status}: {self.err[-300:]!r}"
        if any(len(line) >= LONGEST or not line.isprintable() for line in lines):
            return f"a line that cannot be read: {lines[0]!r}"
        if any(not line.startswith("protractile: ") or "pydantic" in line for line in lines):
            return f"a line that is not protractile's: {lines[0]!r}"
        return ""

    @property
    def accepted(self) -> bool:
        """Whether the input was valid; status 1 is a limit exceeded, 3 a motion not computed."""
        return self.status in (0, 1, 3)


def start(action: Sequence[str] | Callable[[], object], folder: Path) -> int:
    """Start a command or a call in a folder in a process of its own; return its id."""
    pid = os.fork()
    if pid == 0:
        os._exit(_run(action, folder))
    return pid


def finish(folder: Path, pid: int, status: int, used: resource.struct_rusage) -> Ending:
    """Return the end of a process of :func:`start` that has exited."""
    return Ending(
        os.waitstatus_to_exitcode(status),
        (folder / ERR).read_bytes(),
        used.ru_utime + used.ru_stime,
        1024.0 * used.ru_maxrss,
    )


def _run(action: Sequence[str] | Callable[[], object], folder: Path) -> int:
    os.chdir(folder)
    for name, number in ((OUT, 1), (ERR, 2)):
        os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
    limit = MOST_CPU + (0 if callable(action) else _announced(action))
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
    status: object = 0
    try:
        _call(action) if callable(action) else cli.main(action)
    except SystemExit as end:
        status = end.code
    except BaseException:
        traceback.print_exc()
        status = 70
    sys.stdout.flush()
    sys.stderr.flush()
    return status if isinstance(status, int) else 0


def _call(action: Callable[[], object]) -> None:
    """Make a call; an error that this program raises ends the process as a command would."""
    try:
        action()
    except (pt.BadInput, pt.NumericsError, ValueError) as error:
        *_, (frame, _) = traceback.walk_tb(error.__traceback__)
        if not frame.f_globals["__name__"].startswith("protractile."):
            raise
        print(message(str(error)), file=sys.stderr)
        sys.exit(2)


def _announced(arguments: Sequence[str]) -> int:
    """Return the estimated duration of a run in s."""
    if list(arguments[:2]) not in (["run", "case.toml"], ["sweep", "case.toml"]):
        return 0
    try:
        return int(estimates.run_cost(case_file.load("case.toml")).seconds)
    except Exception:
        return 0
