# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compilation of the time loops that most tests of motions need."""

from pathlib import Path

from studies.numerics_1997.schemes import NEWMARK, measured_root
from tests import rubbing


def compile_loops(rubbed: Path) -> None:
    """Compile the time step, recorded in a file, and the schemes of 1997."""
    rubbing.compile_loop(rubbed)
    measured_root(NEWMARK, 0.1)
