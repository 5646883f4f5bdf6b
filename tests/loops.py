# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compilation of the time loops that most tests of motions need."""

from pathlib import Path

from dynamics.motion import Motion
from studies.numerics_1997.schemes import NEWMARK, integrate
from tests import rubbing
from tests.modal import oscillator


def compile_loops(rubbed: Path) -> None:
    """Compile the time step, recorded in a file, and the schemes of 1997."""
    rubbing.compile_loop(rubbed)
    integrate(Motion(oscillator(), 1.0, 0.1), NEWMARK, iterated=False)
