# SPDX-License-Identifier: LGPL-3.0-or-later
"""The compiled loops over time, for which most tests of motions would wait each by itself."""

from __future__ import annotations

from pathlib import Path

from studies.numerics_1997.schemes import NEWMARK, measured_root
from tests import rubbing


def compile_loops(rubbed: Path) -> None:
    """Move a system that rubs, told to a file, and one by the numerics of 1997."""
    rubbing.compile_loop(rubbed)
    measured_root(NEWMARK, 0.1)
