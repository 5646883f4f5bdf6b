# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is wrong with a boom, and where."""

from __future__ import annotations


class BoomError(ValueError):
    """A boom that cannot be. ``where`` is the key of the fault, ``segment[2].span`` say."""

    def __init__(self, where: str, what: str) -> None:
        super().__init__(f"{where}: {what}")
        self.where = where
        self.what = what
