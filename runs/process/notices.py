# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a run has to say beside its results: a line of its own on stderr for each."""

from __future__ import annotations

import logging
import warnings
from typing import Any

from runs.process.shown import message
from runs.process.terminal import say

# Whoever imports the package may listen as to any logger of Python's.
NOTICES = logging.getLogger("protractile")


class _Lines(logging.Handler):
    """Above the bars of the progress, if there are any; what was said is not said again."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.said: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        line = message(record.getMessage())
        if line not in self.said:
            self.said.add(line)
            say(line)


_LINES = _Lines()


def show() -> None:
    """Let notices be seen from now on, and not what libraries tell their callers.

    A user cannot mend it. Filters hold as before: tests make errors of warnings.
    """
    NOTICES.addHandler(_LINES)
    warnings.showwarning = _say_nothing
    logging.getLogger().addHandler(logging.NullHandler())


def _say_nothing(*warning: Any, **where: Any) -> None:
    """Some warn while they are imported."""
