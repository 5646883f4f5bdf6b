# SPDX-License-Identifier: LGPL-3.0-or-later
"""``python -m tests.fuzz [COUNT]``: outcomes of drawn inputs, as a table; exit 1 on a breach.

About half of the inputs are valid. ``python -m tests.fuzz --seed N DIR`` writes the files of one
input to a folder, and prints its command.
"""

import argparse
import shlex
import sys
from pathlib import Path

import pandas as pd

from tests.fuzz.campaign import kind_of, prepare, run


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("count", nargs="?", type=int, default=1000, help="number of inputs")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="seed of the first one")
    parser.add_argument("--seed", nargs=2, metavar=("N", "DIR"), help="write one input to a folder")
    given = parser.parse_args()
    if given.seed:
        number, folder = int(given.seed[0]), Path(given.seed[1])
        folder.mkdir(parents=True, exist_ok=True)
        arguments = prepare(number, folder)
        repeat = f"python -m tests.fuzz.python_calls {number}"
        print(f"cd {folder} && protractile {shlex.join(arguments)}" if arguments else repeat)
        return 0
    rows = []
    for seed, ending in run(range(given.first, given.first + given.count)):
        breach = ending.breach()
        if breach:
            print(f"{seed}: {breach}", flush=True)
        used = ending.seconds, ending.memory / 1e9
        rows.append((kind_of(seed), f"exit {ending.status}", ending.accepted, bool(breach), *used))
    table = pd.DataFrame(rows, columns=["input", "status", "accepted", "breaches", "CPU s", "GB"])
    most = {"accepted": "mean", "breaches": "sum", "CPU s": "max", "GB": "max"}
    statuses = pd.crosstab(table["input"], table["status"])
    print(statuses.join(table.groupby("input").agg(most)).round(2).to_string())
    kept = given.count - int(table["breaches"].sum())
    print(f"{table['accepted'].mean():.0%} of the inputs are accepted")
    print(f"{kept} of {given.count} keep the contract")
    return 0 if kept == given.count else 1


if __name__ == "__main__":
    sys.exit(main())
