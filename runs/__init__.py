# SPDX-License-Identifier: LGPL-3.0-or-later
"""Case files in, trajectories, verdicts and a report out."""

import logging
import os
import warnings
from pathlib import Path
from typing import Any

# Of the cases that come with the program.
CASES = Path(__file__).parent / "cases"

# Before numpy reads it. Parallelism is ranks, members and points; what BLAS sums over threads
# differs in the last bit between one process and several, and contact amplifies that.
os.environ.setdefault("OMP_NUM_THREADS", "1")


def _say_nothing(*warning: Any, **where: Any) -> None:
    """Libraries warn their callers, some while they are imported; a user cannot mend it."""


# Filters hold as before: tests make errors of warnings.
warnings.showwarning = _say_nothing
logging.getLogger().addHandler(logging.NullHandler())
