# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs that share a cache which is cold, and runs that write to one folder."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from runs import case as case_file

Row = tuple[str, int, int, str]

_ROOT = Path(__file__).parents[2]
_COARSE = Path(case_file.__file__).parent / "cases" / "coarse.toml"
_COMMAND = "from runs import cli; cli.main()"


def rows(folder: Path, tries: int = 5) -> Iterator[Row]:
    """What runs at a time leave; a breach is one that differs from a run alone.

    Args:
        folder: an empty one to work in.
        tries: of each.
    """
    alone = folder / "alone"
    _finish([_start(alone, folder / "no cache")])
    broken = 0
    for number in range(tries):
        cache = folder / f"cache-{number}"
        outs = [folder / f"out-{number}-{name}" for name in "abcd"]
        silent = _finish([_start(out, cache) for out in outs])
        same = all(_left(out) == _left(alone) for out in outs)
        broken += not (silent and same and len(list(cache.iterdir())) == 1)
    yield "four runs on a cold cache", tries, broken, "the same files, one entry, not a word"
    broken = 0
    for number in range(tries):
        out = folder / f"both-{number}"
        silent = _finish([_start(out, folder / "cache-0") for _ in range(2)])
        broken += not (silent and _left(out) == _left(alone))
    yield "two runs in one folder", tries, broken, "the files of one run, whole, not a word"


def _start(out: Path, cache: Path) -> subprocess.Popen[str]:
    arguments = [str(_COARSE), "--models", "shell", "--mesh-size", "1", "--out", str(out)]
    return subprocess.Popen(
        [sys.executable, "-c", _COMMAND, "run", *arguments],
        env=os.environ | {"PYTHONPATH": str(_ROOT), "PROTRACTILE_CACHE": str(cache)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def _finish(processes: Sequence[subprocess.Popen[str]]) -> bool:
    """Whether all end well without a word."""
    said = [process.communicate()[1] for process in processes]
    return not any(said) and not any(process.returncode for process in processes)


def _left(folder: Path) -> dict[str, bytes]:
    """The files of a run, but for those that tell how long it took and what is drawn of that."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        if path.suffix in {".nc", ".csv", ".msh", ".vtu", ".toml"}
        else b""
        for path in folder.rglob("*")
        if path.is_file()
    }
