# SPDX-License-Identifier: LGPL-3.0-or-later
"""Dry friction between two segments that slide on one another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class DryFriction:
    """Coulomb's law on one sliding row: |R| ≤ μ N, and R = −μ N sign(ṡ) while it slides.

    (28) of Rusiński and Wyciślok (1997) with a prescribed normal force; (11), where contact forces
    of the other plane press.

    >>> rubbed = replace(
    ...     ball, load=np.zeros(1), friction_rows=np.ones((1, 1)),
    ...     frictions=[DryFriction(coefficient=0.2, station=0, normal_force=10.0)],
    ... )
    >>> slid = simulate(rubbed, 1.0, position=[1.0], velocity=[-1.0])
    >>> print(f"{float(slid.data['height'][-1]):.3f} m")
    0.750 m

    Args:
        coefficient: μ, not negative.
        station: position in the system's stations.
        normal_force: the prescribed part of N in N, not negative.
        pressed_by: contact rows whose |F| add to N.

    Raises:
        ValueError: an argument is negative or not finite.
    """

    coefficient: float
    station: int
    normal_force: float = 0.0
    pressed_by: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if not 0.0 <= self.coefficient < np.inf:
            raise ValueError(f"coefficient must be finite, not negative, got {self.coefficient}")
        if not 0.0 <= self.normal_force < np.inf:
            raise ValueError(
                f"normal_force must be finite, not negative, got {self.normal_force} N"
            )
