# SPDX-License-Identifier: LGPL-3.0-or-later
"""Commands that are killed at random moments after their imports, and repeated.

Either the old files stay, or all new ones are complete. The next run writes the same files as an
undisturbed run, to the last byte, and no others.
"""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import chdir, suppress
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from protractile.runs.folder.cache import VARIABLE
from protractile.runs.process.ranks import launcher
from tests.system.run_folder import ROOT, write_coarse
from tests.torture.shared_cache import COMMAND, IN_THE_MAKING, Row, left, run_here

# The first moment of all is late in a command, whose imports are over then.
_SEED = 76
_COMMAND = sys.executable, "-c", COMMAND
_RANKS = launcher(), "-n", "2", *_COMMAND

# How each command starts, its models and what it varies.
_BEAMS = "kantorovich-4,beam-fe-bonded"
Command = tuple[Sequence[str], Sequence[str]]
COMMANDS: Mapping[str, Command] = {
    "run": (_COMMAND, ("run", "case.toml", "--models", _BEAMS)),
    "sweep": (_COMMAND, ("sweep", "case.toml", "--models", _BEAMS,
                         "--vary", "joint.play=0.01:0.014:3")),
    "run on two ranks": (_RANKS, ("run", "case.toml", "--models", f"{_BEAMS},shell",
                                  "--mesh-size", "1", "--no-pictures")),
}  # fmt: skip


def rows(
    folder: Path, tries: int = 20, commands: Mapping[str, Command] = COMMANDS
) -> Iterator[Row]:
    """Yield the remains of killed commands; a breach is a loss, a residue or a difference.

    Args:
        folder: an empty one to work in.
        tries: tries of each command.
        commands: by their names.
    """
    random = np.random.default_rng(_SEED)
    for name, (start, arguments) in commands.items():
        place, command = folder / name, [*start, *arguments]
        place.mkdir()
        write_coarse(place, 0.1)
        assert _undisturbed(place, arguments)
        shutil.copytree(place, folder / "old", symlinks=True)
        old = left(place / "out")
        write_coarse(place, 0.2)
        begin = time.monotonic()
        assert _undisturbed(place, arguments)
        lasts = time.monotonic() - begin
        new = left(place / "out")
        breaches = 0
        for moment in random.uniform(0.0, lasts, tries):
            shutil.rmtree(place)
            shutil.copytree(folder / "old", place, symlinks=True)
            write_coarse(place, 0.2)
            process = _start(place, command)
            while process.poll() is None and not _in_the_making(place):
                time.sleep(0.005)
            time.sleep(moment)
            _kill(process)
            kept = left(place / "out") in (old, new)
            again = _undisturbed(place, arguments) and left(place / "out") == new
            breaches += not (kept and again) or _in_the_making(place)
        shutil.rmtree(folder / "old")
        yield f"{name}, killed", tries, breaches, "what was there, then what an undisturbed leaves"


def listens(process: subprocess.Popen[Any]) -> bool:
    """Return whether a process has a handler for SIGTERM."""
    with suppress(OSError):
        status = Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8")
        (caught,) = (line for line in status.splitlines() if line.startswith("SigCgt:"))
        return bool(int(caught.split()[1], 16) & 1 << (signal.SIGTERM - 1))
    return False


def _in_the_making(place: Path) -> bool:
    """Return whether a folder has anything that is not whole yet."""
    return any(place.rglob(f"*{IN_THE_MAKING}*"))


def _undisturbed(place: Path, arguments: Sequence[str]) -> bool:
    """Run a command in this process, which has all imports; return whether it ends well."""
    with chdir(place), patch.dict(os.environ, {VARIABLE: "cache"}):
        return run_here([*arguments, "--out", "out"])[0] == 0


def _start(place: Path, command: Sequence[str]) -> subprocess.Popen[bytes]:
    """Start a command in a session of its own."""
    (place / "tmp").mkdir(exist_ok=True)
    own = {"PYTHONPATH": str(ROOT), VARIABLE: "cache", "TMPDIR": str(place / "tmp")}
    # A process that has entered MPI by itself must not pass its own rank on.
    outside = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_C", "PMIX_", "PMI"))}
    return subprocess.Popen(
        [*command, "--out", "out"],
        cwd=place,
        env=outside | own,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


def _kill(process: subprocess.Popen[bytes]) -> None:
    """Kill all processes of the session of a process, in every process group."""
    while sessions := _of_session(process.pid):
        for pid in sessions:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        process.poll()
        time.sleep(0.01)
    process.wait()


def _of_session(session: int) -> list[int]:
    """Return the living processes of a session."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            state, _, _, its_session, *_ = path.read_text().rpartition(")")[2].split()
            if int(its_session) == session and state != "Z":
                found.append(int(path.parent.name))
    return found
