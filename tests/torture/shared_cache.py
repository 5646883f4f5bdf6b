# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs with a common empty cache, and runs that write to the same folder."""

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from tests.fuzz.contract import PROGRESS
from tests.system.run_folder import COARSE, ROOT
from tests.unprinted import ONE_BLANK_FIGURE

# What was done, how often, how often that broke something, and what was to be.
Row = tuple[str, int, int, str]

_SHELL = "--models", "shell", "--mesh-size", "1"
# In the names of all that is not whole yet.
IN_THE_MAKING = "protractile-"
# The command, with one figure, which is written as all of them are.
COMMAND = f"{ONE_BLANK_FIGURE}\nfrom protractile.runs import cli\ncli.main()\n"


def rows(folder: Path, tries: int = 3) -> Iterator[Row]:
    """Yield the results of simultaneous runs; a breach differs from a run alone, or prints.

    Args:
        folder: an empty one to work in.
        tries: tries of each.
    """
    yield cold_cache(folder / "cold", tries)
    yield one_folder(folder / "one", tries, _SHELL)


def cold_cache(folder: Path, tries: int) -> Row:
    """Yield the results of four runs of one shell."""
    alone = folder / "alone"
    assert _finish([_start(_SHELL, alone, folder / "cache")])
    breaches = 0
    for number in range(tries):
        cache = folder / f"cache-{number}"
        outs = [folder / f"out-{number}-{name}" for name in "abcd"]
        silent = _finish([_start(_SHELL, out, cache) for out in outs])
        same = all(left(out) == left(alone) for out in outs)
        breaches += not (silent and same) or any(cache.glob(f".*{IN_THE_MAKING}*"))
    return "four runs on a cold cache", tries, breaches, "each as alone, no scratch, not a word"


def one_folder(folder: Path, tries: int, models: Sequence[str]) -> Row:
    """Yield the results of two runs of the same models, which are options of the command line."""
    alone, cache = folder / "alone", folder / "cache"
    assert _finish([_start(models, alone, cache)])
    breaches = 0
    for number in range(tries):
        out = folder / f"out-{number}"
        silent = _finish([_start(models, out, cache) for _ in range(2)])
        breaches += not (silent and left(out) == left(alone)) or any(folder.glob(".*"))
    return "two runs in one folder", tries, breaches, "as alone, no scratch, not a word"


def _start(models: Sequence[str], out: Path, cache: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", COMMAND, "run", COARSE, *models, "--out", str(out)],
        env=os.environ | {"PYTHONPATH": str(ROOT), "PROTRACTILE_CACHE": str(cache)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def _finish(processes: Sequence[subprocess.Popen[str]]) -> bool:
    """Return whether all exit with status 0 and print nothing but progress."""
    said = [line for process in processes for line in process.communicate()[1].splitlines()]
    silent = all(PROGRESS.fullmatch(line) for line in said)
    return silent and not any(process.returncode for process in processes)


def left(folder: Path) -> dict[str, bytes]:
    """Return the files of a folder without a sweep's points and the content of timings."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        if path.suffix in {".nc", ".csv", ".msh", ".vtu", ".pvd", ".toml"}
        else b""
        for path in folder.rglob("*")
        if path.is_file()
        and "points" not in path.relative_to(folder).parts
        and IN_THE_MAKING not in str(path)
    }
