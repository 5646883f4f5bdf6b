# SPDX-License-Identifier: LGPL-3.0-or-later
"""The error of invalid user input."""

from __future__ import annotations

from protractile.runs.process.terminal import shorten


class BadInput(Exception):
    """An input error, with its file, its key and a message that tells the valid input."""

    def __init__(self, file: str, key: str, what: str) -> None:
        super().__init__(" ".join(f"{shorten(file)}: {shorten(key)}: {what}".split()))
        self.file = file
        self.key = key
        self.what = what
