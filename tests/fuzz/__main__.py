# SPDX-License-Identifier: LGPL-3.0-or-later
"""``python -m tests.fuzz [COUNT]``: outcomes of errors in input, as a table; exit 1 on a breach.

``python -m tests.fuzz --seed N DIR`` writes the files of one error to a folder, and prints its
command.
"""

import argparse
import shlex
import sys
from pathlib import Path

import pandas as pd

from tests.fuzz.campaign import kind_of, prepare, run


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("count", nargs="?", type=int, default=1000, help="number of errors")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="seed of the first one")
    parser.add_argument("--seed", nargs=2, metavar=("N", "DIR"), help="write one error to a folder")
    given = parser.parse_args()
    if given.seed:
        number, folder = int(given.seed[0]), Path(given.seed[1])
        folder.mkdir(parents=True, exist_ok=True)
        print(f"cd {folder} && protractile {shlex.join(prepare(number, folder))}")
        return 0
    rows = []
    for seed, ending in run(range(given.first, given.first + given.count)):
        breach = ending.breach()
        if breach:
            print(f"{seed}: {breach}", flush=True)
        used = ending.seconds, ending.memory / 1e9
        rows.append((kind_of(seed), f"exit {ending.status}", bool(breach), *used))
    table = pd.DataFrame(rows, columns=["error in", "status", "breaches", "CPU s", "GB"])
    most = {"breaches": "sum", "CPU s": "max", "GB": "max"}
    statuses = pd.crosstab(table["error in"], table["status"])
    print(statuses.join(table.groupby("error in").agg(most)).round(2).to_string())
    kept = given.count - int(table["breaches"].sum())
    print(f"{kept} of {given.count} keep the contract")
    return 0 if kept == given.count else 1


if __name__ == "__main__":
    sys.exit(main())
