# SPDX-License-Identifier: LGPL-3.0-or-later
"""Usual ranges of the numbers of a case. A number far outside usually has another unit."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot
from typing import Any, NamedTuple

import numpy as np

from protractile.geometry.boom import Boom, BoomError, Segment
from protractile.geometry.material import Material
from protractile.geometry.section import Direction
from protractile.runs.case.actions import STANDARD_GRAVITY
from protractile.runs.case.contact import JointTable
from protractile.runs.case.motion_tables import max_speed
from protractile.runs.case.schema import Case
from protractile.runs.case.units import System, Unit
from protractile.runs.case.usual_values import key_values

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
        for name in _LIKELY_UNITS.get(self.unit, ()):
            value = system.of(self.value, self.unit) * Unit.of(name).factor
            if self.least <= value <= self.most:
                yield name, value


def check_ranges(case: Case, boom: Boom) -> None:
    """Check that no number is impossible for a boom.

    Raises:
        BoomError: a number is impossible.
    """
    for one in usual_ranges(case, boom):
        if one.impossible:
            raise BoomError(one.key, one.text(case.system))


def usual_ranges(case: Case, boom: Boom) -> Iterator[UsualRange]:
    """Yield the numbers of a case that have a usual range.

    The limits are wide: laboratory booms of 1 m and cranes of 60 m are within them.
    """
    yield from _material_ranges(case)
    for one in key_values(case, boom):
        yield UsualRange(one.key, one.usual.what, one.value, one.unit, *one.usual[1:])
    for number, segment in enumerate(boom.segments):
        yield from _section_ranges(f"segment[{number + 1}]", segment)
    for number in range(len(boom.joints)):
        yield from _joint_ranges(case, boom, number)
    for number, cylinder in enumerate(boom.cylinders, start=1):
        where, what = f"cylinder[{number}].ground", f"the length of cylinder {number}"
        yield UsualRange(where, what, cylinder.length, "m", 0.02 * boom.length, boom.length, 10.0)
        if (foot := boom.segments[cylinder.segment].foot) is not None:
            x, z = cylinder.ground
            away = hypot(x - foot.x, z + foot.depth)
            what = f"the distance from the foot pin to the ground of cylinder {number}"
            yield UsualRange(where, what, away, "m", 0.02 * boom.length, boom.length, 10.0)
    weight = STANDARD_GRAVITY * boom.mass
    for number, axial in enumerate(case.axial, start=1):
        if axial.force is not None:
            where, what = f"axial[{number}].force", "the size of the force along the boom"
            yield UsualRange(where, what, abs(axial.force), "N", 0.0, 100.0 * weight, 100.0)
    if case.gravity is not None:
        where, what = "gravity.acceleration", "the acceleration of gravity"
        yield UsualRange(where, what, case.gravity.acceleration, "m/s^2", 0.0, 12.0, 50.0)
    what = "the damping ratio"
    yield UsualRange("damping.modal", what, case.damping.modal, "1", 0.0, 0.1, 100.0)
    if (category := case.life.detail_category) is not None:
        yield _category_range("life", category, 36.0)


def _category_range(where: str, category: float, least: float) -> UsualRange:
    """Return the range of a detail category; ``least`` is the lowest one of the metal."""
    what = "the detail category after EN 1993-1-9, in N/mm^2,"
    return UsualRange(f"{where}.detail_category", what, category, "1", least, 160.0, 10.0)


def materials(case: Case) -> dict[str, Material]:
    """Return the materials of a case, by their keys."""
    tables = {f"segment[{i}].material": one.material for i, one in enumerate(case.segments, 1)}
    tables = {"material": case.material, **tables}
    return {where: table for where, table in tables.items() if table is not None}


def _material_ranges(case: Case) -> Iterator[UsualRange]:
    """Yield the material data. The ranges cover solids from plastics to tungsten."""
    for where, table in materials(case).items():
        for key, what, unit, limits in (
            ("youngs_modulus", "Young's modulus", "Pa", (1.0e9, 1.0e12, 3.0)),
            ("density", "the density", "kg/m^3", (500.0, 2.5e4, 1000.0)),
            ("yield_strength", "the yield strength", "Pa", (1.0e7, 4.0e9, 10.0)),
        ):
            if (value := getattr(table, key)) is not None:
                yield UsualRange(f"{where}.{key}", what, value, unit, *limits)


def _section_ranges(where: str, segment: Segment) -> Iterator[UsualRange]:
    name, length, section = repr(segment.name), segment.length, segment.section
    low, high = length / 500.0, length / 5.0
    if section is None:
        area = segment.mass_per_length / segment.material.density
        least, most = (area * (height / _HEIGHT_OVER_GYRATION) ** 2 for height in (low, high))
        where, what = f"{where}.second_moment_of_area", f"the second moment of area of {name}"
        yield UsualRange(where, what, segment.second_moment_of_area, "m^4", least, most, 25.0)
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
    if segment.head_section is None:
        plate_value, case_value = section.second_moment_of_area, segment.second_moment_of_area
        where, what = f"{where}.second_moment_of_area", "the second moment of area"
        what = f"{what} beside the plates of {name}"
        yield UsualRange(where, what, case_value, "m^4", 0.5 * plate_value, 2.0 * plate_value, 50.0)


def _joint_ranges(case: Case, boom: Boom, number: int) -> Iterator[UsualRange]:
    table, joint, where = case.joints[number], boom.joints[number], f"joint[{number + 1}]"
    inner = boom.segments[joint.inner]
    yield from _contact_ranges(where, table)
    if joint.detail_category is not None:
        yield _category_range(where, joint.detail_category, 12.0)
    if not joint.bonded:
        outer = boom.segments[joint.outer]
        if outer.section is not None and joint.play:
            what, most = f"the play of {inner.name!r}", 0.06 * outer.section.size("z")
            yield UsualRange(f"{where}.play", what, joint.play, "m", 1.0e-4, most, 1.0e3)
        key = "" if table.extension is None else ".extension"
        what, least = f"the overlap of {inner.name!r}", 0.03 * inner.length
        if joint.drive is not None:
            key, what = ".drive", f"{what} that the drive leaves"
        yield UsualRange(where + key, what, boom.smallest_overlap(joint), "m", least, np.inf, 100.0)
    if joint.drive is not None:
        what = f"the largest speed at which {inner.name!r} moves"
        yield UsualRange(
            f"{where}.drive", what, max_speed(joint.drive.history), "m/s", 0.0, 5.0, 200.0
        )


def _contact_ranges(where: str, table: JointTable) -> Iterator[UsualRange]:
    tables: dict[str, Any] = {where: table, f"{where}.pad": table.pad}
    tables |= {f"{where}.pads[{i}]": pad for i, pad in enumerate(table.pads, start=1)}
    tables[f"{where}.drive"] = table.drive
    for key, what, unit, limits in (
        ("friction", "the coefficient of friction", "1", (0.0, 1.0, 10.0)),
        ("static_friction", "the coefficient of friction", "1", (0.0, 1.0, 10.0)),
        ("interference", "the interference of shims", "m", (0.0, 0.005, 20.0)),
        ("lateral_interference", "the interference of shims", "m", (0.0, 0.005, 20.0)),
        ("shim", "the shim beyond the play", "m", (0.0, 0.02, 10.0)),
        ("thickness", "the thickness of the pad", "m", (0.0005, 0.1, 10.0)),
    ):
        for path, part in tables.items():
            if (value := getattr(part, key, None)) is not None:
                yield UsualRange(f"{path}.{key}", what, value, unit, *limits)
