# SPDX-License-Identifier: LGPL-3.0-or-later
"""Units of measurement with their names, sizes in SI units and dimensions; systems of units."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Literal

# Exponents of length, mass and time.
Dimension = tuple[float, float, float]

_NONE, _LENGTH, _MASS, _TIME = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_ACCELERATION, _FORCE, _PRESSURE = (1.0, 0.0, -2.0), (1.0, 1.0, -2.0), (-1.0, 1.0, -2.0)
_MOMENT, _POWER = (2.0, 1.0, -2.0), (2.0, 1.0, -3.0)

_SIZES: Mapping[Dimension, Mapping[str, str]] = {
    _NONE: {"1": "1.0", "-": "1.0", "%": "0.01", "rad": "1.0", "mrad": "1.0e-3", "deg": "1.0"},
    _LENGTH: {"m": "1.0", "km": "1.0e3", "cm": "1.0e-2", "mm": "1.0e-3"}
    | dict.fromkeys(("µm", "um"), "1.0e-6"),
    _MASS: {"kg": "1.0", "t": "1.0e3"},
    _TIME: {"s": "1.0", "ms": "1.0e-3", "µs": "1.0e-6", "min": "60.0", "h": "3600.0"},
    (0.0, 0.0, -1.0): {"Hz": "1.0"},
    _ACCELERATION: {"g": "9.80665"},
    _FORCE: {"N": "1.0", "daN": "10.0", "kN": "1.0e3", "MN": "1.0e6"},
    _MOMENT: {"Nm": "1.0", "kNm": "1.0e3", "Nmm": "1.0e-3", "J": "1.0", "kJ": "1.0e3"},
    _POWER: {"W": "1.0", "kW": "1.0e3"},
    _PRESSURE: {"Pa": "1.0", "kPa": "1.0e3", "MPa": "1.0e6", "GPa": "1.0e9", "bar": "1.0e5"},
}
_SYMBOLS = {name: (size, of) for of, sizes in _SIZES.items() for name, size in sizes.items()}

# Pattern of a factor of a unit: m^2, m2, m-2, N/m^1.5.
_FACTOR = re.compile(r"([^\^0-9-]+|1|-)(?:\^(-?[0-9]{1,2}(?:\.[0-9]{1,9})?)|(-?[0-9]))?")
_PLAIN = str.maketrans("¹²³⁴⁻–μ·*", "1234--µ  ")


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of measurement."""

    factor: float  #: size of the unit in SI units
    dimension: Dimension  #: the exponents of length, mass and time

    @classmethod
    def of(cls, text: str) -> Unit:
        """Return the unit with a name such as ``kN/m``, ``m/s^2``, ``m/s²``, ``N m`` or ``g``.

        Raises:
            ValueError: the unit is unknown.
        """
        above, *below = text.replace("**", "^").translate(_PLAIN).split("/")
        # Sizes are exact fractions, so that 1 t/mm³ is exactly 1e12 kg/m³.
        size: Fraction | float = Fraction(1)
        exponents = [0.0, 0.0, 0.0]
        for part, sign in [(above, 1.0), *((part, -1.0) for part in below)]:
            if not part.strip():
                raise ValueError("no unit")
            for name in part.split():
                power = _FACTOR.fullmatch(name)
                if power is None or power[1] not in _SYMBOLS:
                    raise ValueError("no unit that is known")
                one, dimension = _SYMBOLS[power[1]]
                exponent = sign * float(power[2] or power[3] or 1.0)
                size *= Fraction(one) ** Fraction(exponent)
                for base, power_of in enumerate(dimension):
                    exponents[base] += exponent * power_of
        return cls(float(size), (exponents[0], exponents[1], exponents[2]))

    @staticmethod
    @cache
    def conversion(name: str) -> float:
        """Return the conversion factor from SI units to a unit.

        >>> Unit.conversion("mm"), Unit.conversion("MPa")
        (1000.0, 1e-06)
        """
        return float(1 / Fraction(repr(Unit.of(name).factor)))


SystemName = Literal["SI", "mm-t-s", "N-mm"]
# The units that replace SI units in the other systems, which are the same.
_MILLIMETRES = {"m": "mm", "kg": "t", "Pa": "MPa"}
_NUMBER = r"(-?\d+(?:\.\d+)?(?:e[+-]?\d+)?)"
# An amount, or the two ends of a range, in an SI unit that another system replaces.
_AMOUNT = re.compile(
    rf"(?<![\w.])(?:{_NUMBER} and )?{_NUMBER} "
    r"(m/s\^2|m/s|m|kg/m\^3|kg/m|kg|Pa|N/m|N m)(?![\w/^])"
)
_RAISED = str.maketrans("234", "²³⁴")


@dataclass(frozen=True, slots=True)
class System:
    """A coherent system of units, such as SI, or millimetre, tonne and second."""

    name: SystemName = "SI"

    def unit(self, si: str) -> str:
        """Return the system's unit in place of an SI unit, for example ``N/mm`` for ``N/m``."""
        symbols = {} if self.name == "SI" else _MILLIMETRES
        return re.sub("[A-Za-z]+", lambda match: symbols.get(match[0], match[0]), si)

    def size(self, si: str) -> Fraction:
        """Return the size of the system's unit in the SI unit that it replaces."""
        return Fraction(repr(Unit.of(self.unit(si)).factor / Unit.of(si).factor))

    def of(self, value: float, si: str) -> float:
        """Return a value in the system's unit, from its value in the SI unit ``si``."""
        return scale(value, 1 / self.size(si))

    def label(self, si: str) -> str:
        """Return the system's unit as text for headings, for example ``mm⁴``."""
        return self.unit(si).replace("^", "").translate(_RAISED)

    def convert(self, message: str) -> str:
        """Return a message whose amounts in SI units are in the system's units.

        >>> from protractile.geometry.units import System
        >>> System("mm-t-s").convert("must be below 4.8 m, got 4.9 m of steel")
        'must be below 4800 mm, got 4900 mm of steel'
        """

        def converted(match: re.Match[str]) -> str:
            *numbers, unit = match.groups()
            sizes = [f"{self.of(float(number), unit):.6g}" for number in numbers if number]
            return f"{' and '.join(sizes)} {self.unit(unit)}"

        return message if self.name == "SI" else _AMOUNT.sub(converted, message)

    def text(self, value: float, si: str, digits: int = 4) -> str:
        """Return a value, given in an SI unit, as text in the system's unit: ``12.5 mm``."""
        return f"{float(f'{self.of(value, si):.{digits}g}'):.9g} {self.label(si)}"


def scale(value: float, size: Fraction) -> float:
    """Return value times size in decimal arithmetic, so that 9.7 mm are exactly 0.0097 m.

    Raises:
        OverflowError: the number is too large.
    """
    return float(Fraction(repr(float(value))) * size)
