# SPDX-License-Identifier: LGPL-3.0-or-later
"""Many seeded inputs, several at a time, each in a folder and a process of its own."""

import os
import shutil
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from protractile.runs import CASES
from tests.fuzz import cases, command_lines, contract, python_calls, valid

# Kinds of input, and their shares.
KINDS = {
    "case, varied": 0.26, "case, broken": 0.16, "run, scaled": 0.06, "history": 0.05,
    "command": 0.22, "command line": 0.05, "Python": 0.2,
}  # fmt: skip


def kind_of(seed: int) -> str:
    """Return the kind of a seed's input."""
    return Random(f"kind {seed}").choices(list(KINDS), list(KINDS.values()))[0]


def prepare(seed: int, folder: Path) -> list[str]:
    """Write the files of a seed to a folder; return the arguments of its command.

    A call from Python has none.
    """
    random, kind = Random(seed), kind_of(seed)
    if kind == "Python":
        return []
    text = valid.small(random)
    arguments = ["check", "case.toml"]
    if kind.startswith("case") and random.random() < 0.5:
        text = random.choice(sorted(CASES.glob("*.toml"))).read_text(encoding="utf-8")
    if kind == "case, varied":
        text = valid.varied(text, random)
    if kind == "run, scaled":
        # Beams alone: a shell takes FEniCSx, whose import alone takes longer than a beam's run.
        arguments = ["run", "case.toml", "--models", "beam,series", "--out", "out"]
        text = cases.scaled(text, random)
    if kind == "case, broken" or (kind != "case, varied" and random.random() < 0.1):
        text = cases.mutate(text, random)
    if kind == "history":
        table = '[[base]]\nacceleration = 1.0\nfile = "history.csv"\n\n[[model]]'
        text = text.replace("[[model]]", table, 1)
        (folder / "history.csv").write_bytes(cases.history(random))
    if kind.startswith("command"):
        draw = command_lines.usual if kind == "command" else command_lines.mutate
        arguments = draw(random)
    (folder / "gust.csv").symlink_to(CASES / "gust.csv")
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
            action = prepare(seed, folder) or partial(python_calls.call, seed)
            running[contract.start(action, folder)] = seed, folder
        while running:
            yield _next(running)


def _next(running: dict[int, tuple[int, Path]]) -> tuple[int, contract.Ending]:
    pid, status, used = os.wait3(0)
    seed, folder = running.pop(pid)
    ending = contract.finish(folder, pid, status, used)
    shutil.rmtree(folder)
    return seed, ending
