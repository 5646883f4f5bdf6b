# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contract of every command for any input, and a process that checks it.

The exit status is 0, 1, 2 or 3. If it is not 0, stderr has a single printable line of less than
300 characters besides progress. A command needs at most 4 GB, and 60 s of CPU time more than
announced.
"""

import os
import re
import resource
import sys
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from protractile.runs import cli
from protractile.runs.case import reading as case_file
from protractile.runs.pipeline import estimates
from protractile.runs.process.terminal import LONGEST

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
PROGRESS = re.compile(r".+: .+ (started|finished|took \d+ s|\d+ %, \d+ s left)")


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
        if any(not line.startswith("protractile: ") for line in lines):
            return f"a line that is not protractile's: {lines[0]!r}"
        return ""


def start(arguments: Sequence[str], folder: Path) -> int:
    """Start a command in a folder in a process of its own; return its id."""
    pid = os.fork()
    if pid == 0:
        os._exit(_run(arguments, folder))
    return pid


def finish(folder: Path, pid: int, status: int, used: resource.struct_rusage) -> Ending:
    """Return the end of a process of :func:`start` that has exited."""
    return Ending(
        os.waitstatus_to_exitcode(status),
        (folder / ERR).read_bytes(),
        used.ru_utime + used.ru_stime,
        1024.0 * used.ru_maxrss,
    )


def _run(arguments: Sequence[str], folder: Path) -> int:
    os.chdir(folder)
    for name, number in ((OUT, 1), (ERR, 2)):
        os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
    limit = MOST_CPU + _announced(arguments)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
    try:
        cli.main(arguments)
    except SystemExit as end:
        status = end.code
    except BaseException:
        traceback.print_exc()
        status = 70
    sys.stdout.flush()
    sys.stderr.flush()
    return status if isinstance(status, int) else 0


def _announced(arguments: Sequence[str]) -> int:
    """Return the estimated duration of a run in s."""
    if arguments[:2] != ["run", "case.toml"]:
        return 0
    try:
        return int(estimates.run_cost(case_file.load("case.toml")).seconds)
    except Exception:
        return 0
