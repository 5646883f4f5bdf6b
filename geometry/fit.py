# SPDX-License-Identifier: LGPL-3.0-or-later
"""Checks of clearances between sections, of slide pads, and of contact faces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations, product

from protractile.geometry.assembly import Assembly
from protractile.geometry.fields import BoomError
from protractile.geometry.joint import SIDES, Joint, Pad, SlidePad
from protractile.geometry.section import Direction, Side
from protractile.geometry.segment import SAME_PLACE, Segment
from protractile.geometry.typography import TO_MILLI
from protractile.geometry.walls import free_room

_WHERE: Mapping[tuple[Direction, Side], str] = {
    ("z", 1): "top",
    ("z", -1): "bottom",
    ("y", 1): "right",
    ("y", -1): "left",
}


# A larger play in m is probably in mm.
_LARGE_PLAY = 0.3


def check_room(
    where: str, joint: Joint, outer: Segment, inner: Segment, extension: float | None = None
) -> None:
    """Check that the inner segment of a joint fits with its play, if both sections are given.

    Args:
        where: the joint, or the drive with the ``extension`` in m, for messages.

    Raises:
        BoomError: the segment does not fit.
    """
    if outer.section is None or inner.section is None:
        return
    near = SAME_PLACE * outer.length
    height, width = room(joint, outer, inner, extension or 0.0)
    if height < joint.play - near or width < 0.0:
        if extension is not None:
            raise BoomError(
                where,
                f"moves {inner.name!r} by {extension:g} m to where it does not fit in "
                f"{outer.name!r}: {height:.6g} m of height and {width:.6g} m of width are free "
                f"there, and a play of {joint.play:.6g} m is asked for; make the travel or the "
                "taper smaller",
            )
        in_millimetres = ""
        if joint.play > _LARGE_PLAY:
            in_millimetres = f"; if it is in mm, give {joint.play / TO_MILLI:g} m"
        raise BoomError(
            f"{where}.play",
            f"{inner.name!r} does not fit in {outer.name!r}: {height:.6g} m of height and "
            f"{width:.6g} m of width are free, and a play of {joint.play:.6g} m is "
            f"asked for; make the inner section or the play smaller{in_millimetres}",
        )
    if extension is None and width < (joint.lateral_play or 0.0) - near:
        raise BoomError(
            f"{where}.lateral_play",
            f"{inner.name!r} does not fit in {outer.name!r}: {width:.6g} m of width are free, and "
            f"a lateral play of {joint.lateral_play:.6g} m is asked for; make the inner "
            "section or the lateral play smaller",
        )


def room(
    joint: Joint, outer: Segment, inner: Segment, extension: float = 0.0
) -> tuple[float, float]:
    """Return the smallest clearances in m, along z and along y, at an extension in m.

    Both segments have sections. Tapers are linear, so that the ends of the overlap govern.
    """
    first, last = max(outer.start, inner.start + extension), min(outer.end, inner.end + extension)
    sizes = [
        free_room(outer.section_at(x), inner.section_at(x - extension), joint.play)
        for x in (first, last)
    ]
    heights, widths = zip(*sizes, strict=True)
    return min(heights), min(widths)


def check_contact_faces(
    where: str,
    segment: Segment,
    directions: tuple[Direction, ...],
    places: Sequence[float],
    around: Segment | None = None,
) -> None:
    """Check that a segment with a section has contact faces on both sides.

    Args:
        where: attribute of the boom with this segment, for messages.
        places: x in m of the contacts.
        around: outer segment, if any.

    Raises:
        BoomError: a face is missing, or wider than the face of the outer segment.
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
            [member.section_at(x).face(*sides).width for member in (around, segment)]
            for x in places
        ]
        free, width = min(faces, key=lambda pair: pair[0] - pair[1])
        if width > free:
            raise BoomError(
                f"{where}.section",
                f"its {place} is {width:.6g} m wide, and that of {around.name!r}, which it "
                f"touches, {free:.6g} m; make it narrower",
            )


def check_pads(where: str, joint: Joint, boom: Assembly) -> None:
    """Check the pads of a joint.

    Raises:
        BoomError: a pad does not fit, two pads overlap, or a side has no pads; the message names an
            attribute of ``where``.
    """
    if joint.pad is not None:
        _check_pad(f"{where}.pad", joint, joint.pad, boom)
    for number, pad in enumerate(joint.pads):
        if SIDES[pad.side][0] not in boom.directions:
            raise BoomError(
                f"{where}.pads[{number}].side",
                "the boom is flat, and nothing presses laterally; leave the pad out, or give "
                "the joints lateral_play",
            )
        _check_pad(f"{where}.pads[{number}]", joint, pad, boom)
    for side, (direction, _) in SIDES.items():
        pads = [pad for pad in joint.pads if pad.side == side]
        if joint.pads and not pads and direction in boom.directions:
            raise BoomError(f"{where}.pads", f"none is {side}; give each side one at least")
        for first, second in combinations(pads, 2):
            near, far = sorted((first, second), key=lambda pad: pad.offset)
            if far.offset < near.offset + near.width:
                raise BoomError(
                    f"{where}.pads",
                    f"two lie on one another {side}, {far.offset:g} m from the corner; give the "
                    f"outer one a width of at most {far.offset - near.offset:g} m",
                )


def check_pads_in_travel(where: str, joint: Joint, boom: Assembly) -> None:
    """Check that all pads of a joint stay in the overlap while the joint telescopes.

    Raises:
        BoomError: a pad leaves the overlap, or is longer than the smallest overlap; the message
            names an attribute of ``where``.
    """
    sizes = {f"{where}.contact_length": joint.contact_length}
    pads = {} if joint.pad is None else {f"{where}.pad": joint.pad}
    pads |= {f"{where}.pads[{number}]": pad for number, pad in enumerate(joint.pads)}
    sizes |= {f"{key}.length": pad.length for key, pad in pads.items()}
    assert joint.drive is not None
    start, end = boom.overlap(joint)
    inner, outer = boom.segments[joint.inner], boom.segments[joint.outer]
    out, near = joint.drive.reach[1], SAME_PLACE * outer.length
    for key, length in sizes.items():
        if length is not None and length > end - start - out + near:
            raise BoomError(
                key,
                f"must not be above the overlap of {end - start - out:g} m that is left where "
                f"{inner.name!r} extends by {out:g} m, got {length:g} m",
            )
    for key, pad in pads.items():
        for x, carrier in zip(joint.stations, joint.drive.carriers, strict=True):
            for extension, edge in product(joint.drive.reach, pad.span(x, boom.overlap(joint))):
                slides, by = (outer, extension) if carrier == "inner" else (inner, -extension)
                if not slides.holds(edge + by):
                    raise BoomError(
                        f"{key}.length",
                        f"the pad at {x:g} m leaves {slides.name!r} as {inner.name!r} telescopes "
                        f"by {extension:g} m; make it shorter, or move the station",
                    )


def _check_pad(where: str, joint: Joint, pad: Pad, boom: Assembly) -> None:
    if pad.lateral_thickness and (
        isinstance(pad, SlidePad) or not (boom.spatial and pad.thickness)
    ):
        what = "needs pad.thickness in a boom with lateral_play; leave it out"
        raise BoomError(f"{where}.lateral_thickness", what)
    if joint.bonded:
        raise BoomError(where, "the joint is bonded, and nothing touches; leave it out")
    start, end = boom.overlap(joint)
    if not 0.0 < pad.length <= end - start:
        raise BoomError(
            f"{where}.length",
            f"must be above 0 and not above the overlap of {end - start:g} m, got {pad.length:g} m",
        )
    if pad.bears == "corner" and pad.offset:
        raise BoomError(
            f"{where}.offset", "the pad bears on the corner; leave offset out, or bears = 'corner'"
        )
    room = pad_room(joint, pad, boom)
    if not 0.0 < pad.width <= room - pad.offset:
        beside = f" less the offset of {pad.offset:g} m" if pad.offset else ""
        raise BoomError(
            f"{where}.width",
            f"must be above 0 and not above half a wall of the inner segment, {room:.6g} m"
            f"{beside}, got {pad.width:g} m",
        )


def pad_room(joint: Joint, pad: Pad, boom: Assembly) -> float:
    """Return half the width in m of the narrowest wall of a pad; infinite without a section."""
    inner = boom.segments[joint.inner]
    if inner.section is None:
        return float("inf")
    return 0.5 * min(
        face.width
        for x in joint.stations
        for face in inner.section_at(x).faces
        if face.direction in boom.directions
        and (not isinstance(pad, SlidePad) or pad.touches(face.direction, face.side))
    )
