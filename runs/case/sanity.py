# SPDX-License-Identifier: LGPL-3.0-or-later
"""Usual ranges of the numbers of a case. A number far outside usually has another unit."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot
from typing import Any

import numpy as np

from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.material import Material
from protractile.runs.case.actions import STANDARD_GRAVITY
from protractile.runs.case.contact import JointTable
from protractile.runs.case.motion_tables import max_speed
from protractile.runs.case.part_ranges import UsualRange, material_ranges, section_ranges
from protractile.runs.case.schema import Case
from protractile.runs.case.usual_values import key_values


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
    yield from material_ranges(materials(case))
    for one in key_values(case, boom):
        yield UsualRange(one.key, one.usual.what, one.value, one.unit, *one.usual[1:])
    for number, segment in enumerate(boom.segments):
        yield from section_ranges(f"segment[{number + 1}]", segment)
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
