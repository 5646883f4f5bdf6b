# SPDX-License-Identifier: LGPL-3.0-or-later
"""Usual ranges of the numbers of a case. A number far outside usually has another unit."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot

import numpy as np

from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.material import Material
from protractile.geometry.section import Direction
from protractile.runs.case.motion_tables import max_speed
from protractile.runs.case.part_ranges import UsualRange, material_ranges, section_ranges
from protractile.runs.case.schema import Case
from protractile.runs.case.usual_values import key_values


def check_ranges(case: Case, boom: Boom) -> None:
    """Check that no number is impossible for a boom.

    Raises:
        BoomError: a number is impossible.
    """
    for usual in usual_ranges(case, boom):
        if usual.impossible:
            raise BoomError(usual.key, usual.text(case.system))


def usual_ranges(case: Case, boom: Boom) -> Iterator[UsualRange]:
    """Yield the numbers of a case that have a usual range.

    The limits are wide: laboratory booms of 1 m and cranes of 60 m are within them.
    """
    yield from material_ranges(materials(case))
    for value in key_values(case, boom):
        yield UsualRange(value.key, value.usual.what, value.value, value.unit, *value.usual[1:])
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


def materials(case: Case) -> dict[str, Material]:
    """Return the materials of a case, by their keys."""
    tables = {
        f"segment[{i}].material": segment.material for i, segment in enumerate(case.segments, 1)
    }
    tables = {"material": case.material, **tables}
    return {where: table for where, table in tables.items() if table is not None}


def _joint_ranges(case: Case, boom: Boom, number: int) -> Iterator[UsualRange]:
    table, joint, where = case.joints[number], boom.joints[number], f"joint[{number + 1}]"
    inner = boom.segments[joint.inner]
    if not joint.bonded:
        outer = boom.segments[joint.outer]
        plays: dict[Direction, tuple[str, float | None]] = {
            "z": ("play", joint.play),
            "y": ("lateral_play", joint.lateral_play),
        }
        for direction, (key, play) in plays.items():
            size = outer.length / 5.0 if outer.section is None else outer.section.size(direction)
            if play:
                what = f"the {key.replace('_', ' ')} of {inner.name!r}"
                yield UsualRange(f"{where}.{key}", what, play, "m", 1.0e-4, 0.06 * size, 1.0e3)
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
