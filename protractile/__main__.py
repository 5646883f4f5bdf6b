# SPDX-License-Identifier: LGPL-3.0-or-later
"""The command ``protractile``: listens for signals before it imports what takes seconds."""

from __future__ import annotations

from runs.process.ending import listen


def main() -> None:
    """Run the command line that this process was given, and exit."""
    listen()
    from runs import cli

    cli.main()


if __name__ == "__main__":
    main()
