# SPDX-License-Identifier: LGPL-3.0-or-later
"""``python -m tests.fuzz [COUNT]``: what slips in input do, as a table; exit 1 on a breach.

``python -m tests.fuzz --seed N DIR`` writes the files of one slip to a folder, and prints its
command.
"""

from __future__ import annotations

import argparse
import shlex
import sys
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.table import Table

from tests.fuzz.campaign import KINDS, kind_of, prepare, run
from tests.fuzz.contract import Ending


@dataclass(slots=True)
class Tally:
    """What became of the slips of one kind."""

    statuses: Counter[int] = field(default_factory=Counter)
    breaches: int = 0
    seconds: float = 0.0
    memory: float = 0.0

    def add(self, ending: Ending) -> None:
        """Count one."""
        self.statuses[ending.status] += 1
        self.breaches += bool(ending.breach())
        self.seconds = max(self.seconds, ending.seconds)
        self.memory = max(self.memory, ending.memory)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("count", nargs="?", type=int, default=1000, help="of slips")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="seed of the first one")
    parser.add_argument("--seed", nargs=2, metavar=("N", "DIR"), help="write one slip to a folder")
    given = parser.parse_args()
    if given.seed:
        number, folder = int(given.seed[0]), Path(given.seed[1])
        folder.mkdir(parents=True, exist_ok=True)
        print(f"cd {folder} && protractile {shlex.join(prepare(number, folder))}")
        return 0
    tallies = {kind: Tally() for kind in KINDS}
    for seed, ending in run(range(given.first, given.first + given.count)):
        tallies[kind_of(seed)].add(ending)
        if breach := ending.breach():
            print(f"{seed}: {breach}", flush=True)
    _show(tallies)
    kept = given.count - sum(tally.breaches for tally in tallies.values())
    print(f"{kept} of {given.count} keep the contract")
    return 0 if kept == given.count else 1


def _show(tallies: Mapping[str, Tally]) -> None:
    table = Table("slip in", "slips", "exit 0", "1", "2", "3", "breaches", "CPU s", "GB")
    for kind, tally in tallies.items():
        counts = [tally.statuses.total(), *(tally.statuses[i] for i in range(4)), tally.breaches]
        most = f"{tally.seconds:.1f}", f"{tally.memory / 1e9:.2g}"
        table.add_row(kind, *map(str, counts), *most)
    Console().print(table)


if __name__ == "__main__":
    sys.exit(main())
