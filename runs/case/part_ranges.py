# SPDX-License-Identifier: LGPL-3.0-or-later
"""Usual ranges of materials and sections, for case files and for booms from Python."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from protractile.geometry.boom import Boom, BoomError, Segment
from protractile.geometry.material import Material
from protractile.geometry.section import Direction
from protractile.geometry.units import System, Unit

# Units that a user may have meant, most likely first.
_LIKELY_UNITS = {
    "Pa": ("MPa", "GPa", "kPa", "Pa"),
    "m": ("mm", "cm", "m"),
    "m/s": ("mm/s", "m/s"),
    "m^4": ("cm^4", "mm^4", "m^4"),
    "kg/m^3": ("t/m^3", "t/mm^3", "kg/m^3"),
    "m^2": ("mm^2", "cm^2", "m^2"),
    "N": ("kN", "N"),
    "N/m": ("N/mm", "kN/mm", "N/m"),
    "kg": ("kg", "t"),
}

# Height of a box over its radius of gyration: 2.2 to 2.8 in practice.
_HEIGHT_OVER_GYRATION = 2.5


# Usual yield strengths in Pa, and the factor beyond them at which one is impossible.
_STRENGTHS = 1.0e7, 4.0e9, 10.0


class UsualRange(NamedTuple):
    """A number of a case with its usual range."""

    key: str  #: key in the case file
    what: str  #: description in messages, for example ``the height of 'fly'``
    value: float  #: value in SI units
    unit: str  #: SI unit, ``1`` for none
    least: float  #: smallest usual value
    most: float  #: largest usual value
    margin: float  #: factor beyond these limits at which a value is impossible

    @property
    def unusual(self) -> bool:
        """True if the number is outside its usual range."""
        return not self.least <= self.value <= self.most

    @property
    def impossible(self) -> bool:
        """True if the number is impossible for a boom."""
        return not self.least / self.margin <= self.value <= self.most * self.margin

    def text(self, system: System) -> str:
        """Return a message with the number, its usual range, and the unit the user may mean."""
        limits = [
            f"{word} {system.of(limit, self.unit):.3g}"
            for word, limit in (("from", self.least), ("up to", self.most))
            if 0.0 < limit < np.inf
        ]
        label = "" if self.unit == "1" else f" {system.label(self.unit)}"
        displayed = system.of(self.value, self.unit)
        text = f"{self.what} is {displayed:.5g}{label}, usual is {' '.join(limits)}{label}"
        for name, value in self.likely_units(system):
            return f"{text}; if it is in {name}, give {system.of(value, self.unit):.5g}{label}"
        return f"{text}; check the number and its unit"

    def likely_units(self, system: System) -> Iterator[tuple[str, float]]:
        """Yield the units in which the number is usual, and its values in SI units in these."""
        units = _LIKELY_UNITS.get(self.unit, ())
        # In a case in mm and t, numbers in m and kg are the likely mistake.
        for name in units if system.name == "SI" else reversed(units):
            value = system.of(self.value, self.unit) * Unit.of(name).factor
            if self.least <= value <= self.most:
                yield name, value


def check_parts(boom: Boom) -> None:
    """Check that no material and no section of a boom from Python is impossible.

    Raises:
        BoomError: a number is impossible.
    """
    for number, segment in enumerate(boom.segments):
        where = f"segments[{number}]"
        for usual in (
            *material_ranges({f"{where}.material": segment.material}),
            *section_ranges(where, segment),
        ):
            if usual.impossible:
                raise BoomError(usual.key, usual.text(System()))


def material_ranges(tables: Mapping[str, Material]) -> Iterator[UsualRange]:
    """Yield the material data. The ranges cover solids from plastics to tungsten."""
    for where, table in tables.items():
        for key, what, unit, limits in (
            ("youngs_modulus", "Young's modulus", "Pa", (1.0e9, 1.0e12, 3.0)),
            ("density", "the density", "kg/m^3", (500.0, 2.5e4, 1000.0)),
            ("yield_strength", "the yield strength", "Pa", _STRENGTHS),
        ):
            if (value := getattr(table, key)) is not None:
                yield UsualRange(f"{where}.{key}", what, value, unit, *limits)


def section_ranges(where: str, segment: Segment) -> Iterator[UsualRange]:
    for plate, own in segment.yield_strengths:
        key = f"{where}.yield_strengths.{plate}"
        yield UsualRange(key, "the yield strength", own, "Pa", *_STRENGTHS)
    name, length, section = repr(segment.name), segment.length, segment.section
    low, high = length / 500.0, length / 5.0
    lateral = _lateral_ranges(where, segment)
    mass_key, mass_what = f"{where}.mass_per_length", f"the mass per length of {name}"
    mass_per_length = segment.mass_per_length
    if section is None:
        yield UsualRange(mass_key, mass_what, mass_per_length, "kg/m", 0.02, 2.0e4, 100.0)
        area = mass_per_length / segment.material.density
        least, most = (area * (height / _HEIGHT_OVER_GYRATION) ** 2 for height in (low, high))
        where, what = f"{where}.second_moment_of_area", f"the second moment of area of {name}"
        yield UsualRange(where, what, segment.second_moment_of_area, "m^4", least, most, 25.0)
        yield from lateral
        return
    directions: tuple[tuple[Direction, str], ...] = ("z", "height"), ("y", "width")
    for direction, side in directions:
        size = max(segment.section_at(x).size(direction) for x in segment.ends)
        yield UsualRange(f"{where}.section", f"the {side} of {name}", size, "m", low, high, 5.0)
    walls = [wall for x in segment.ends for wall in segment.section_at(x).plates]
    wall = min(walls, key=lambda wall: wall.thickness / wall.length)
    what = f"the thickness of the {wall.name} of {name}"
    yield UsualRange(
        f"{where}.section", what, wall.thickness, "m", wall.length / 1e3, np.inf, 100.0
    )
    mass = segment.material.density * segment.area
    yield UsualRange(mass_key, mass_what, mass_per_length, "kg/m", 0.5 * mass, 20.0 * mass, 50.0)
    if segment.head_section is None:
        plate_value, case_value = section.second_moment_of_area, segment.second_moment_of_area
        where, what = f"{where}.second_moment_of_area", "the second moment of area"
        what = f"{what} beside the plates of {name}"
        yield UsualRange(where, what, case_value, "m^4", 0.5 * plate_value, 2.0 * plate_value, 50.0)
    yield from lateral


def _lateral_ranges(where: str, segment: Segment) -> Iterator[UsualRange]:
    """Yield the lateral second moment and the torsion constant, by the second moment along z."""
    if segment.lateral is None:
        return
    least, most = (factor * segment.second_moment_of_area for factor in (1.0e-3, 1.0e3))
    for key, what, value in (
        ("lateral_second_moment_of_area", "the lateral second moment of area",
         segment.lateral.second_moment_of_area),
        ("torsion_constant", "the torsion constant", segment.lateral.torsion_constant),
    ):  # fmt: skip
        what = f"{what} of {segment.name!r}"
        yield UsualRange(f"{where}.{key}", what, value, "m^4", least, most, 100.0)
