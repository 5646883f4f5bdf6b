# SPDX-License-Identifier: LGPL-3.0-or-later
"""Steel plates, and their vibration by a shell and in closed form."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.boom import Material
from protractile.shell_model.segment.forms import DRILLING_OF_CURVED, SHEAR_CORRECTION
from studies.reference_models.benchmarks import X, Y, Z, grid
from studies.reference_models.single_segment import natural_frequencies
from studies.reference_models.static_shell import StaticShell

Field = Callable[[Array, Array], Array]

STEEL = Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)


def rigidities(thickness: float) -> tuple[float, float]:
    """Return the bending stiffness D in N·m and S = 5/6 G t in N/m of a steel plate, t in m."""
    bending = STEEL.youngs_modulus * thickness**3 / (12.0 * (1.0 - STEEL.poissons_ratio**2))
    return bending, SHEAR_CORRECTION * STEEL.shear_modulus * thickness


def rectangle(length: float, width: float) -> Field:
    """Return the map of two parameters (num,) to positions (num, 3) in m on a rectangle."""
    return lambda x, y: np.stack([length * x, width * y, np.zeros_like(x)], axis=1)


class SupportedPlate(NamedTuple):
    """Rectangular steel plate of a by b by t in m on hard simple supports.

    At the edges, deflections and rotations about the normal of the edge are zero.
    """

    length: float
    width: float
    thickness: float

    def frequencies(self, n: int, count: int) -> Array:
        """Return the lowest frequencies (count,) in Hz of a shell with n edges along each side."""
        # Drilling stiffness and inertia of the plate add frequencies above
        # √(12 DRILLING G/ρ)/(2π t), which must not be low: thick plates need more stiffness.
        shell = StaticShell(
            *grid(rectangle(self.length, self.width), n, n),
            self.thickness,
            STEEL,
            DRILLING_OF_CURVED,
        )
        held: dict[int, float] = {}
        for axis, size in ((X, self.length), (Y, self.width)):
            for edge in (0.0, size):
                held |= shell.hold_at(axis, edge, [X, Y, Z], [axis])
        return natural_frequencies(shell.held(held), count)

    def kirchhoff(self, count: int) -> Array:
        """Return frequencies (count,) in Hz without shear and rotary inertia (Navier 1823)."""
        t = self.thickness
        speed2 = STEEL.youngs_modulus * t**2 / (12.0 * (1.0 - STEEL.poissons_ratio**2))
        return self._lowest(self._wave_numbers2() * np.sqrt(speed2 / STEEL.density), count)

    def mindlin(self, count: int) -> Array:
        """Return the lowest frequencies (count,) in Hz (Mindlin 1951).

        With k² = (mπ/a)² + (nπ/b)², ω² is the lower root of
        (S k² − ρt ω²)(D k² + S − ρt³/12 ω²) = S² k², S = 5/6 G t.
        """
        t, k2 = self.thickness, self._wave_numbers2()
        plate, shear = rigidities(t)
        mass, inertia = STEEL.density * t, STEEL.density * t**3 / 12.0
        square = mass * inertia
        linear = mass * (plate * k2 + shear) + inertia * shear * k2
        constant = shear * plate * k2**2
        # The lower root, in a form without the difference of nearly equal numbers.
        omega2 = 2.0 * constant / (linear + np.sqrt(linear**2 - 4.0 * square * constant))
        return self._lowest(np.sqrt(omega2), count)

    def _wave_numbers2(self) -> Array:
        waves = np.pi * np.arange(1, 30)
        return np.asarray(np.add.outer((waves / self.length) ** 2, (waves / self.width) ** 2))

    @staticmethod
    def _lowest(omega: Array, count: int) -> Array:
        return np.asarray(np.sort(omega.ravel())[:count] / (2.0 * np.pi))
