# SPDX-License-Identifier: LGPL-3.0-or-later
"""The command ``protractile``, which installs signal handlers before slow imports."""

from __future__ import annotations

from runs.process.ending import listen


def main() -> None:
    """Run the command line of this process, and exit."""
    listen()
    from runs import cli

    cli.main()


if __name__ == "__main__":
    main()
