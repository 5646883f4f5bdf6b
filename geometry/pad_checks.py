# SPDX-License-Identifier: LGPL-3.0-or-later
"""Whether slide pads have room on the walls that they touch."""

from __future__ import annotations

from itertools import combinations, product
from typing import TYPE_CHECKING

from geometry.fault import BoomError
from geometry.joint import SIDES, Joint, PadSize, SlidePad
from geometry.segment import SAME_PLACE

if TYPE_CHECKING:
    from geometry.boom import Boom


def check_pads(where: str, joint: Joint, boom: Boom) -> None:
    """Whether all pads of a joint can be.

    Raises:
        BoomError: one has no room, two lie on one another, a side has none; at a key of ``where``.
    """
    if joint.pad is not None:
        _check_pad(f"{where}.pad", joint, joint.pad, boom)
    for number, pad in enumerate(joint.pads, start=1):
        if SIDES[pad.side][0] not in boom.directions:
            raise BoomError(
                f"{where}.pads[{number}].side",
                "the boom is flat, and nothing presses to the sides; leave the pad out, or give "
                "the joints lateral_play",
            )
        _check_pad(f"{where}.pads[{number}]", joint, pad, boom)
    for side, (direction, _) in SIDES.items():
        pads = [pad for pad in joint.pads if pad.side == side]
        if joint.pads and not pads and direction in boom.directions:
            raise BoomError(f"{where}.pads", f"none is {side}; give each side one at least")
        for one, other in combinations(pads, 2):
            _check_apart(f"{where}.pads", one, other)


def check_drawn_pads(where: str, joint: Joint, boom: Boom) -> None:
    """Whether all pads of a joint with a drive stay on both of its segments.

    Raises:
        BoomError: one is longer than the least overlap, or leaves it; at a key of ``where``.
    """
    sizes = {f"{where}.contact_length": joint.contact_length}
    pads = {} if joint.pad is None else {f"{where}.pad": joint.pad}
    pads |= {f"{where}.pads[{number}]": pad for number, pad in enumerate(joint.pads, start=1)}
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
                f"{inner.name!r} is drawn out by {out:g} m, got {length:g} m",
            )
    for key, pad in pads.items():
        for x, carrier in zip(joint.stations, joint.drive.carriers, strict=True):
            for way, edge in product(joint.drive.reach, pad.span(x, boom.overlap(joint))):
                slides, by = (outer, way) if carrier == "inner" else (inner, -way)
                if not slides.holds(edge + by):
                    raise BoomError(
                        f"{key}.length",
                        f"the pad at {x:g} m leaves {slides.name!r} as {inner.name!r} is drawn by "
                        f"{way:g} m; make it shorter, or move the station",
                    )


def _check_apart(where: str, one: SlidePad, other: SlidePad) -> None:
    near, far = sorted((one, other), key=lambda pad: pad.offset)
    if far.offset < near.offset + near.width:
        raise BoomError(
            where,
            f"two lie on one another {one.side}, {far.offset:g} m from the corner; give the outer "
            f"one a width of at most {far.offset - near.offset:g} m",
        )


def _check_pad(where: str, joint: Joint, pad: PadSize, boom: Boom) -> None:
    if joint.tied:
        raise BoomError(where, "the joint is tied, and nothing touches; leave it out")
    start, end = boom.overlap(joint)
    if not 0.0 < pad.length <= end - start:
        raise BoomError(
            f"{where}.length",
            f"must be above 0 and not above the overlap of {end - start:g} m, got {pad.length:g} m",
        )
    inner = boom.segments[joint.inner]
    if inner.section is None:
        return
    room = 0.5 * min(
        face.width
        for x in joint.stations
        for face in inner.section_at(x).faces
        if face.direction in boom.directions
        and (not isinstance(pad, SlidePad) or pad.touches(face.direction, face.side))
    )
    if not 0.0 < pad.width <= room - pad.offset:
        beside = f" less the offset of {pad.offset:g} m" if pad.offset else ""
        raise BoomError(
            f"{where}.width",
            f"must be above 0 and not above half a wall of the inner segment, {room:.6g} m"
            f"{beside}, got {pad.width:g} m",
        )
