# SPDX-License-Identifier: LGPL-3.0-or-later
"""Error in the data of a boom."""

from __future__ import annotations


class BoomError(ValueError):
    """Error in the data of a boom; ``where`` is an attribute, such as ``segments[1].start``."""

    def __init__(self, where: str, what: str) -> None:
        super().__init__(f"{where}: {what}")
        self.where = where
        self.what = what
