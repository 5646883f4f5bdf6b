# SPDX-License-Identifier: LGPL-3.0-or-later
"""``python -m tests.fuzz [COUNT]``: what slips in input do, as a table; exit 1 on a breach.

``python -m tests.fuzz --seed N DIR`` writes the files of one slip to a folder, and prints its
command.
"""

from __future__ import annotations

import argparse
import shlex
import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

from tests.fuzz.campaign import Tally, prepare, run


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("count", nargs="?", type=int, default=1000, help="of slips")
    parser.add_argument("--seed", nargs=2, metavar=("N", "DIR"), help="write one slip to a folder")
    given = parser.parse_args()
    if given.seed:
        number, folder = int(given.seed[0]), Path(given.seed[1])
        folder.mkdir(parents=True, exist_ok=True)
        print(f"cd {folder} && protractile {shlex.join(prepare(number, folder))}")
        return 0
    tallies = run(range(given.count), lambda done: None)
    _show(tallies)
    breaches = [breach for tally in tallies.values() for breach in tally.breaches]
    for breach in breaches:
        print(breach)
    kept = given.count - len(breaches)
    print(f"{kept} of {given.count} keep the contract")
    return 1 if breaches else 0


def _show(tallies: dict[str, Tally]) -> None:
    table = Table("slip in", "slips", "exit 0", "1", "2", "3", "breaches", "CPU s", "GB")
    for kind, tally in tallies.items():
        counts = [str(tally.statuses[status]) for status in (0, 1, 2, 3)]
        total, breaches = str(tally.statuses.total()), str(len(tally.breaches))
        most = f"{tally.seconds:.1f}", f"{tally.memory / 1e9:.2g}"
        table.add_row(kind, total, *counts, breaches, *most)
    Console().print(table)


if __name__ == "__main__":
    sys.exit(main())
