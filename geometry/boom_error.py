# SPDX-License-Identifier: LGPL-3.0-or-later
"""Errors in a boom, and their places."""

from __future__ import annotations


class BoomError(ValueError):
    """An impossible boom: ``where`` is the object and its attribute, ``segments[1].start`` say."""

    def __init__(self, where: str, what: str) -> None:
        super().__init__(f"{where}: {what}")
        self.where = where
        self.what = what
