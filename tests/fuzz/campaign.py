# SPDX-License-Identifier: LGPL-3.0-or-later
"""Many seeded errors in input, several at a time, each in a folder and a process of its own."""

import os
import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from protractile.runs import CASES
from tests.fuzz import cases, command_lines, contract, histories

COARSE = (CASES / "coarse.toml").read_text(encoding="utf-8")
SHORT = COARSE.replace("duration = 0.6", "duration = 0.02")
# Beams alone: a shell takes FEniCSx, whose import alone takes longer than a beam's run.
WITHOUT_SHELLS = "kantorovich-5,beam-fe"

# Kinds of input, and their shares of all errors.
KINDS = {"case, checked": 0.6, "case, run": 0.1, "history": 0.12, "command line": 0.18}


def kind_of(seed: int) -> str:
    """Return the kind of a seed's error."""
    return Random(f"kind {seed}").choices(list(KINDS), list(KINDS.values()))[0]


def prepare(seed: int, folder: Path) -> list[str]:
    """Write the files of a seed to a folder; return the arguments of its command."""
    random, kind = Random(seed), kind_of(seed)
    path = random.choice(sorted(CASES.glob("*.toml")))
    text = path.read_text(encoding="utf-8")
    arguments = ["check", "case.toml"]
    if kind == "case, run":
        text = SHORT
        arguments = ["run", "case.toml", "--models", WITHOUT_SHELLS, "--out", "out"]
    if kind == "case, checked" or random.random() < 0.2:
        text = cases.mutate(text, random)
    elif kind == "case, run":
        text = cases.scaled(text, random)
    if kind == "history":
        table = '[[base]]\nacceleration = 1.0\nfile = "history.csv"\n\n[[model]]'
        text = text.replace("[[model]]", table, 1)
        histories.put(folder / "history.csv", random)
    if kind == "command line":
        text = SHORT
        arguments = command_lines.mutate(random)
    (folder / "case.toml").write_text(text, encoding="utf-8", errors="surrogateescape")
    return arguments


def run(seeds: Iterable[int]) -> Iterator[tuple[int, contract.Ending]]:
    """Run seeds on all cores; yield each seed and its ending, as they end."""
    running: dict[int, tuple[int, Path]] = {}
    with TemporaryDirectory(prefix="protractile-fuzz-") as top:
        for seed in seeds:
            if len(running) == len(os.sched_getaffinity(0)):
                yield _next(running)
            folder = Path(top, str(seed))
            folder.mkdir()
            running[contract.start(prepare(seed, folder), folder)] = seed, folder
        while running:
            yield _next(running)


def _next(running: dict[int, tuple[int, Path]]) -> tuple[int, contract.Ending]:
    pid, status, used = os.wait3(0)
    seed, folder = running.pop(pid)
    ending = contract.finish(folder, pid, status, used)
    shutil.rmtree(folder)
    return seed, ending
