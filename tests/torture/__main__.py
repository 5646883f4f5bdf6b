# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results of all campaigns as a table; exit status 1 if data are lost or left in the making."""

import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from protractile.runs.report.tables import Table
from tests.torture import full_disk, kills, shared_cache

CAMPAIGNS = {"full-disk": full_disk, "kills": kills, "shared-cache": shared_cache}


def main(names: Sequence[str]) -> None:
    """Run campaigns by their names, all unless some are given."""
    found = []
    for campaign in names or CAMPAIGNS:
        with TemporaryDirectory() as folder:
            for name, tries, breaches, what in CAMPAIGNS[campaign].rows(Path(folder)):
                found.append((name, str(tries), str(breaches), what))
                print(f"{name}: {breaches} of {tries}", file=sys.stderr)
    headings = "campaign", "tries", "breaches", "expected"
    Table.of_rows("torture", "Torture", headings, found).show(Console())
    sys.exit(any(breaches != "0" for _, _, breaches, _ in found))


if __name__ == "__main__":
    main(sys.argv[1:])
