# SPDX-License-Identifier: LGPL-3.0-or-later
"""Whether sections fit in one another, and touch flat on flat."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from geometry.fault import BoomError
from geometry.joint import Joint
from geometry.section import Direction, Side
from geometry.segment import SAME_PLACE, Segment
from geometry.walls import free_room

_WHERE: Mapping[tuple[Direction, Side], str] = {
    ("z", 1): "top",
    ("z", -1): "bottom",
    ("y", 1): "right",
    ("y", -1): "left",
}


def check_room(where: str, joint: Joint, outer: Segment, inner: Segment) -> None:
    """Whether the inner segment of a joint has its play within the outer one, where both are known.

    Raises:
        BoomError: it has not; at a key of the joint ``where``.
    """
    if outer.section is None or inner.section is None:
        return
    near = SAME_PLACE * outer.length
    height, width = room(joint, outer, inner)
    if height < joint.play - near or width < 0.0:
        raise BoomError(
            f"{where}.play",
            f"{inner.name!r} does not fit in {outer.name!r}: {height:.6g} m of height and "
            f"{width:.6g} m of width are free, and a play of {joint.play:.6g} m is "
            "asked for; make the inner section or the play smaller",
        )
    if joint.lateral_play is not None and width < joint.lateral_play - near:
        raise BoomError(
            f"{where}.lateral_play",
            f"{inner.name!r} does not fit in {outer.name!r}: {width:.6g} m of width are free, and "
            f"a lateral play of {joint.lateral_play:.6g} m is asked for; make the inner "
            "section or the lateral play smaller",
        )


def check_drawn_room(where: str, joint: Joint, outer: Segment, inner: Segment, way: float) -> None:
    """Whether the inner segment of a flat joint still has its play where it is drawn by ``way``.

    Raises:
        BoomError: it has not; at a key of the drive ``where``.
    """
    if outer.section is None or inner.section is None:
        return
    near = SAME_PLACE * outer.length
    height, width = room(joint, outer, inner, way)
    if height < joint.play - near or width < 0.0:
        raise BoomError(
            where,
            f"draws {inner.name!r} by {way:g} m to where it does not fit in {outer.name!r}: "
            f"{height:.6g} m of height and {width:.6g} m of width are free there, and a play of "
            f"{joint.play:.6g} m is asked for; make the travel or the taper smaller",
        )


def room(joint: Joint, outer: Segment, inner: Segment, way: float = 0.0) -> tuple[float, float]:
    """How far the inner segment can move along z, and then along y, where that is least, in m.

    At the ends of the overlap, drawn out by ``way`` in m, of segments whose sections are known:
    what tapers does so evenly.
    """
    first, last = max(outer.start, inner.start + way), min(outer.end, inner.end + way)
    found = [
        free_room(outer.section_at(x), inner.section_at(x - way), joint.play) for x in (first, last)
    ]
    heights, widths = zip(*found, strict=True)
    return min(heights), min(widths)


def check_flats(
    where: str,
    segment: Segment,
    directions: tuple[Direction, ...],
    places: Sequence[float],
    around: Segment | None = None,
) -> None:
    """Whether a segment has plates that can touch, as far as its section is known.

    Args:
        where: its key.
        segment: which touches, on both sides.
        directions: along which.
        places: x in m at which it touches.
        around: the segment whose plates it touches, if any.

    Raises:
        BoomError: it has none, or wider ones than the segment around it.
    """
    if segment.section is None:
        return
    flats = {(face.direction, face.side): face for face in segment.section.faces}
    for sides, place in _WHERE.items():
        if sides[0] not in directions:
            continue
        if sides not in flats:
            raise BoomError(
                f"{where}.section",
                f"has no single plate at right angles to {sides[0]} at its {place}, where the boom "
                "touches it; folds and inclined plates cannot be touched, give it a flat there",
            )
        if around is None or around.section is None:
            continue
        faces = [
            [one.section_at(x).face(*sides).width for one in (around, segment)] for x in places
        ]
        free, width = min(faces, key=lambda pair: pair[0] - pair[1])
        if width > free:
            raise BoomError(
                f"{where}.section",
                f"its {place} is {width:.6g} m wide, and that of {around.name!r}, which it "
                f"touches, {free:.6g} m; make it narrower",
            )
