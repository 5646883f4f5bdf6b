# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs with a common empty cache, and runs that write to the same folder."""

import io
import os
import subprocess
import sys
from collections.abc import Collection, Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from typing import Any
from unittest.mock import patch

from matplotlib.figure import Figure as Sheet
from PIL import Image

from protractile.runs import cli
from protractile.runs.folder.cache import VARIABLE
from protractile.runs.report.opengl import RenderingUnavailable
from tests import at_once
from tests.fuzz.contract import PROGRESS
from tests.system.run_folder import COARSE, ROOT
from tests.unprinted import ONE_BLANK_FIGURE

# What was done, how often, how often that broke something, and what was to be.
Row = tuple[str, int, int, str]

_SHELL = "--models", "shell", "--mesh-size", "1", "--no-pictures"
# In the names of all that is not whole yet.
IN_THE_MAKING = "protractile-"
# The command, with one figure, which is written as all of them are.
COMMAND = f"{ONE_BLANK_FIGURE}\nfrom protractile.runs import cli\ncli.main()\n"


def rows(folder: Path, tries: int = 3) -> Iterator[Row]:
    """Yield the results of four runs of a shell on a cold cache, and of two in one folder."""
    yield together(folder / "cold", tries, _SHELL, "abcd")
    yield together(folder / "one", tries, _SHELL, "aa")


def together(folder: Path, tries: int, models: Sequence[str], outs: str) -> Row:
    """Yield the results of simultaneous runs; a breach differs from a run alone, or prints.

    Args:
        folder: one that does not exist, to work in.
        tries: tries of the runs, each on a cold cache.
        models: options of the command line.
        outs: a letter for the folder of each run.
    """
    alone = folder / "alone"
    with patch.dict(os.environ, {VARIABLE: str(folder / "cache")}):
        assert run_here(["run", COARSE, *models, "--out", str(alone)])[0] == 0
    breaches = 0
    for number in range(tries):
        cache, places = folder / f"cache-{number}", [folder / f"{name}-{number}" for name in outs]
        silent = _finish([_start(models, out, cache) for out in places])
        same = all(left(out) == left(alone) for out in places)
        rests = any(folder.glob(".*")) or any(cache.glob(f".*{IN_THE_MAKING}*"))
        breaches += not (silent and same) or rests
    name = f"{len(outs)} runs into {len(set(outs))} folders on a cold cache"
    return name, tries, breaches, "as alone, no scratch, not a word"


def _start(models: Sequence[str], out: Path, cache: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-c", COMMAND, "run", COARSE, *models, "--out", str(out)],
        env=os.environ | {"PYTHONPATH": str(ROOT), VARIABLE: str(cache)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def _finish(processes: Sequence[subprocess.Popen[str]]) -> bool:
    """Return whether all exit with status 0 and print nothing but progress."""
    said = [line for process in processes for line in process.communicate()[1].splitlines()]
    silent = all(PROGRESS.fullmatch(line) for line in said)
    return silent and not any(process.returncode for process in processes)


SAME = frozenset({".nc", ".csv", ".msh", ".vtu", ".pvd", ".toml"})


def left(folder: Path, same: Collection[str] = SAME) -> dict[str, bytes]:
    """Return the files of a folder without a sweep's points, with the content of some suffixes."""
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.suffix in same else b""
        for path in folder.rglob("*")
        if path.is_file()
        and "points" not in path.relative_to(folder).parts
        and IN_THE_MAKING not in str(path)
    }


def run_here(command: Sequence[str]) -> tuple[object, int]:
    """Run a command in this process; return its exit status and its number of lines on stderr."""

    def refuse(*arguments: object) -> None:
        raise RenderingUnavailable("left out")

    def dot(sheet: Sheet, file: Any, **options: object) -> None:
        if isinstance(file, io.BytesIO):
            file.write(b"<svg/>")
        else:
            Image.new("L", (1, 1)).save(file)

    status: object = None
    said = io.StringIO()
    with redirect_stdout(io.StringIO()), redirect_stderr(said), suppress(SystemExit):
        try:
            # Drawings and processes take all the time, and a patched disk is one process's.
            with (
                patch("protractile.runs.report.snapshots.render_motion", refuse),
                patch("protractile.runs.process.workers.workers", at_once.workers),
                patch.object(Sheet, "savefig", dot),
            ):
                cli.main(command)
        except SystemExit as ended:
            status = ended.code
            raise
    return status, said.getvalue().count("\n")
