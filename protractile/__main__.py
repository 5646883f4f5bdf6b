# SPDX-License-Identifier: LGPL-3.0-or-later
"""The command ``protractile``, which installs signal handlers before slow imports."""

from __future__ import annotations

from protractile.runs.process.ending import leave, listen


def main() -> None:
    """Run the command line of this process, and exit."""
    listen()
    from protractile.runs import cli

    try:
        cli.main()
    except SystemExit as end:
        leave(int(end.code or 0))


if __name__ == "__main__":
    main()
