# SPDX-License-Identifier: LGPL-3.0-or-later
"""The whole campaign, as a table; exit status 1 if anything was lost, or wrong and believed."""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from runs.report.tables import TextTable
from tests.torture import flipped_bits, full_disk, kills, shared_cache

CAMPAIGNS = full_disk, kills, flipped_bits, shared_cache


def main() -> None:
    found = []
    for campaign in CAMPAIGNS:
        with TemporaryDirectory() as folder:
            for name, tries, breaches, what in campaign.rows(Path(folder)):
                found.append((name, str(tries), str(breaches), what))
                print(f"{name}: {breaches} of {tries}", file=sys.stderr)
    headings = "what was done", "tries", "breaches", "what was to be"
    TextTable("Torture", headings, found).show(Console())
    sys.exit(any(breaches != "0" for _, _, breaches, _ in found))


if __name__ == "__main__":
    main()
