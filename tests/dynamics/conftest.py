# SPDX-License-Identifier: LGPL-3.0-or-later
"""A single mass, the smallest gap system."""

from collections.abc import Callable

import numpy as np
import pytest

from dynamics.contact import PowerContact
from dynamics.gap_system import GapSystem
from tests.modal import modal_system


def one_mass(
    mass: float,
    law: PowerContact | None = None,
    spring: float = 0.0,
    force: float = 0.0,
    dashpot: float = 0.0,
) -> GapSystem:
    """Return a mass in kg on a spring in N/m and a dashpot in N·s/m, before a stop.

    Its only modal coordinate is √m times the position; ``tip`` is the position.
    """
    row = np.array([1.0 / np.sqrt(mass)])
    laws = [] if law is None else [law]
    rows, damping = row[: len(laws)], np.array([dashpot / mass])
    return modal_system([spring / mass], force * row, rows, laws, tip=row, damping=damping)


@pytest.fixture(name="one_mass")
def _one_mass() -> Callable[..., GapSystem]:
    return one_mass
