# SPDX-License-Identifier: LGPL-3.0-or-later
"""The one form that every model takes before it moves.

    ä_i + c_i ȧ_i + ω_i² a_i = Q_i − Σ_j B_ji F_j(y_j),    y_j = Σ_i B_ji a_i

in mass-normalised modal coordinates a. Segments that only contact couples stand side by
side in a; a contact row B_j reads the relative displacement u − w of one place.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynamics.contact import PowerContact

Array = npt.NDArray[np.float64]


class Observer(NamedTuple):
    """A named output: its row (num_modes,) over the modal coordinates, and its unit."""

    row: Array
    unit: str = "m"


@dataclass(frozen=True, slots=True)
class GapSystem:
    """Modal equations of motion with gap contact.

    Args:
        omega2: (num_modes,) ω² in rad²/s²; rigid modes exactly 0.
        load: (num_modes,) modal load in N/√kg, applied at t = 0 and kept.
        rows: (num_rows, num_modes) contact rows B in 1/√kg.
        laws: (num_rows) the contact law of each row.
        station_of_row: (num_rows,) position in ``stations`` of each row.
        stations: x of the stations in m.
        observers: name → what a trajectory records.
        damping: (num_modes,) c = 2ζω in 1/s; zero unless given.

    Raises:
        ValueError: shapes do not agree, or a number is not finite or out of range.
    """

    omega2: Array
    load: Array
    rows: Array
    laws: Sequence[PowerContact]
    station_of_row: npt.NDArray[np.int64]
    stations: Sequence[float]
    observers: Mapping[str, Observer]
    damping: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        n, m = self.omega2.size, len(self.laws)
        if self.damping.size == 0:
            object.__setattr__(self, "damping", np.zeros(n))
        expected = {
            "omega2": (self.omega2, (n,)),
            "load": (self.load, (n,)),
            "damping": (self.damping, (n,)),
            "rows": (self.rows, (m, n)),
            "station_of_row": (self.station_of_row, (m,)),
            **{f"observer {name!r}": (row, (n,)) for name, (row, _) in self.observers.items()},
        }
        for name, (array, shape) in expected.items():
            if array.shape != shape:
                raise ValueError(f"{name} must have the shape {shape}, got {array.shape}")
            if not np.isfinite(array).all():
                raise ValueError(f"{name} must be finite")
        if m and not 0 <= self.station_of_row.min() <= self.station_of_row.max() < len(
            self.stations
        ):
            raise ValueError("station_of_row must hold positions in stations")
        if (self.omega2 < 0.0).any() or (self.damping < 0.0).any():
            raise ValueError("omega2 and damping must not be negative")

    @property
    def num_modes(self) -> int:
        """Number of modal coordinates."""
        return self.omega2.size

    @property
    def frequencies(self) -> Array:
        """(num_modes,) natural frequencies without contact in Hz, rising."""
        return np.sort(np.sqrt(self.omega2)) / (2.0 * np.pi)

    @property
    def row_masses(self) -> Array:
        """(num_rows,) 1 / B_j B_jᵀ in kg: the mass that a blow on one row moves at once."""
        return np.asarray(1.0 / np.einsum("ij,ij->i", self.rows, self.rows))

    def static_response(self, force: Array) -> Array:
        """(num_modes,) rest position under a modal force, for a system without rigid modes.

        Args:
            force: (num_modes,) in N/√kg.

        Raises:
            ValueError: the system has rigid modes.
        """
        if (self.omega2 == 0.0).any():
            raise ValueError("a system with rigid modes has no static response")
        return force / self.omega2
