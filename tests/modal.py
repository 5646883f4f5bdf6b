# SPDX-License-Identifier: LGPL-3.0-or-later
"""Small systems by the numbers that a test is about."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import ContactLaw, PowerContact
from protractile.dynamics.gap_system import GapSystem, Observer


def modal_system(
    omega2: ArrayLike,
    load: ArrayLike,
    rows: ArrayLike = (),
    laws: Sequence[ContactLaw] = (),
    tip: ArrayLike | None = None,
    **more: Any,
) -> GapSystem:
    """Return a system whose contact rows have a station each unless others are given.

    Args:
        omega2: (num_modes,) as the next ones in a :class:`GapSystem`.
        load: (num_modes,).
        rows: (num_rows, num_modes).
        laws: one for each row.
        tip: (num_modes,) row of the observer ``tip``.
        more: what else a system has, or has otherwise.
    """
    modes, stations = np.array(omega2, dtype=float), range(len(laws))
    usual = {
        "station_of_row": np.array(stations, dtype=np.int64),
        "stations": [float(number) for number in stations],
        "observers": {} if tip is None else {"tip": Observer(np.array(tip, dtype=float))},
    }
    contacts = np.array(rows, dtype=float).reshape(len(laws), modes.size)
    return GapSystem(modes, np.array(load, dtype=float), contacts, laws, **usual | more)


def damping_matrix(system: GapSystem) -> Array:
    """Return C (num_modes, num_modes) in 1/s."""
    return np.diag(system.damping) + system.dashpots.T @ system.dashpots


def oscillator() -> GapSystem:
    """Return 1 kg on a spring of 1 N/m."""
    return modal_system([1.0], [0.0], tip=[1.0])


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
