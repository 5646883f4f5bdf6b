# SPDX-License-Identifier: LGPL-3.0-or-later
"""Checks of a segment: its length, taper, supports, masses and stiffeners."""

from __future__ import annotations

from itertools import combinations, pairwise, product

from protractile.geometry.fields import BoomError
from protractile.geometry.section import COMPONENT, SectionError
from protractile.geometry.segment import SAME_PLACE, Segment
from protractile.geometry.stiffeners import Collar
from protractile.geometry.support import check_support
from protractile.geometry.taper import check_alike
from protractile.geometry.typography import choices

# Minimum distance of supports as a fraction of a segment's length. The stiffness of an element
# between them is proportional to the inverse cube of its length and would cause loss of digits.
APART = 1.0e-4


def check_segment(segment: Segment, where: str) -> None:
    """Check the data of a segment.

    Args:
        segment: segment of a boom.
        where: attribute of the boom, for example ``segments[1]``.

    Raises:
        BoomError: the length is not positive, or a support, mass, collar or diaphragm is
            invalid or not on the segment.
    """
    if not segment.start < segment.end:
        raise BoomError(
            f"{where}.start",
            f"must run from a smaller to a larger x, got [{segment.start:g}, {segment.end:g}] m",
        )
    _check_taper(segment, f"{where}.head_section")
    for support in segment.supports:
        segment.check_place(f"{where}.supports", support.x)
        check_support(f"{where}.supports", support)
    places, near = sorted(support.x for support in segment.supports), APART * segment.length
    if any(right - left <= near for left, right in pairwise(places)):
        raise BoomError(
            f"{where}.supports",
            f"two are within {near:g} m of one another; give one, or move them farther apart",
        )
    for mass in segment.masses:
        segment.check_place(f"{where}.masses", mass.x)
    _check_collars(segment, where)
    _check_diaphragms(segment, where)
    plates = [] if segment.section is None else [each.name for each in segment.section.plates]
    names = dict.fromkeys([*(name.partition("-")[0] for name in plates), *plates])
    for name, _ in segment.yield_strengths:
        if name not in names:
            what = f"{name!r} is no plate of {segment.name!r}; give {choices([*names])}"
            raise BoomError(f"{where}.yield_strengths", what)


def _check_taper(segment: Segment, where: str) -> None:
    if segment.head_section is None:
        return
    if segment.section is None:
        raise BoomError(where, "a segment tapers from a section; give section, at its tail")
    try:
        check_alike(segment.section, segment.head_section)
    except SectionError as error:
        raise BoomError(where, str(error)) from None


def _check_collars(segment: Segment, where: str) -> None:
    for number, collar in enumerate(segment.collars):
        key = f"{where}.collars[{number}]"
        _check_strips(segment, key, collar)
        _check_thickness(segment, key, collar.thickness)
        if not collar.length > SAME_PLACE * segment.length:
            raise BoomError(
                f"{key}.span",
                "must run from a smaller to a larger x, got "
                f"[{collar.span[0]:g}, {collar.span[1]:g}] m",
            )
        for x in collar.span:
            segment.check_place(f"{key}.span", x)
    for first, second in combinations(segment.collars, 2):
        start = max(first.span[0], second.span[0])
        common = min(first.span[1], second.span[1]) - start
        if common > SAME_PLACE * segment.length and _share_wall(segment, first, second):
            raise BoomError(
                f"{where}.collars",
                f"two lie on one another from {start:g} m on; give one of the thickness of "
                "both there",
            )


def _share_wall(segment: Segment, first: Collar, second: Collar) -> bool:
    """Return whether two collars cover a common part of a wall."""
    if segment.section is None:
        return True
    return any(
        a.wall == b.wall and min(a.high, b.high) - max(a.low, b.low) > segment.widest.near
        for a, b in product(first.strips(segment.widest), second.strips(segment.widest))
    )


def _check_strips(segment: Segment, where: str, collar: Collar) -> None:
    if segment.section is None:
        return
    plates = {plate.name: plate for plate in segment.widest.plates}
    for name in collar.walls:
        if name not in plates:
            raise BoomError(
                f"{where}.walls",
                f"{name!r} is no wall of {segment.name!r}; give {choices([*plates])}",
            )
    if collar.across is not None:
        low, high = collar.across
        half = 0.5 * min(plates[name].length for name in collar.walls or plates)
        if not low < high <= half * (1.0 + SAME_PLACE):
            raise BoomError(
                f"{where}.across",
                "must run from a smaller to a larger distance from the middle of the wall, at "
                f"most {half:.6g} m, got [{low:g}, {high:g}] m",
            )


def _check_diaphragms(segment: Segment, where: str) -> None:
    for number, diaphragm in enumerate(segment.diaphragms):
        key = f"{where}.diaphragms[{number}]"
        _check_thickness(segment, key, diaphragm.thickness)
        segment.check_place(f"{key}.x", diaphragm.x)
    places = sorted(diaphragm.x for diaphragm in segment.diaphragms)
    if any(right - left <= SAME_PLACE * segment.length for left, right in pairwise(places)):
        raise BoomError(f"{where}.diaphragms", "a place is given twice; give each once")


def _check_thickness(segment: Segment, where: str, thickness: float) -> None:
    if segment.section is None:
        return
    ends = segment.section, segment.head_section or segment.section
    half = 0.5 * min(end.size(axis) for end in ends for axis in COMPONENT)
    if thickness > half:
        raise BoomError(
            f"{where}.thickness",
            f"must be at most {half:.6g} m, half of the box's smallest size, got {thickness:g}",
        )
