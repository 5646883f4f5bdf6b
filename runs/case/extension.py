# SPDX-License-Identifier: LGPL-3.0-or-later
"""Ends of segments, from their spans, or from their lengths and the extension of joints."""

from __future__ import annotations

from collections.abc import Sequence

from geometry.boom import BoomError
from runs.case.contact import JointTable
from runs.case.segment import SegmentTable


def spans(
    segments: Sequence[SegmentTable], joints: Sequence[JointTable]
) -> list[tuple[float, float]]:
    """Return the x of the ends of each segment in m.

    Args:
        segments: segments with a name each; the first one starts at 0 if it has a length only.
        joints: joints of these segments.

    Raises:
        BoomError: a segment has no position, or two.
    """
    lengths = {segment.name: segment.length for segment in segments}
    ends = {segment.name: segment.span for segment in segments if segment.span is not None}
    drawn = [
        (f"joint[{i}].extension", j) for i, j in enumerate(joints, 1) if j.extension is not None
    ]
    for number, (where, joint) in enumerate(drawn):
        if lengths[joint.inner] is None:
            raise BoomError(
                where,
                f"{joint.inner!r} has a span, which says how far it is out; give it by its length, "
                "or leave extension out",
            )
        for other, before in drawn[:number]:
            if before.inner == joint.inner:
                raise BoomError(
                    where, f"{joint.inner!r} has its place by {other}; leave one of them out"
                )
    first = segments[0]
    if first.length is not None and first.name not in {joint.inner for _, joint in drawn}:
        ends[first.name] = 0.0, first.length
    # One pass per joint places the segments, in any order of the joints.
    for _ in drawn:
        for where, joint in drawn:
            if joint.outer in ends and joint.inner not in ends:
                length = lengths[joint.inner]
                assert length is not None
                ends[joint.inner] = _extension(where, joint, ends[joint.outer], length)
    for number, segment in enumerate(segments, start=1):
        if segment.name not in ends:
            raise BoomError(
                f"segment[{number}].length",
                f"nothing says where {segment.name!r} is; give an extension to the joint in which "
                "it slides, or a span to the segment",
            )
    return [ends[segment.name] for segment in segments]


def _extension(
    where: str, joint: JointTable, outer: tuple[float, float], length: float
) -> tuple[float, float]:
    """Return the ends of an inner segment in m."""
    start, end = outer
    assert joint.extension is not None
    least = max(0.0, length - (end - start))
    if not least <= joint.extension < length:
        raise BoomError(
            where,
            f"must be at least {least:g} m and below {length:g} m, so that {joint.inner!r} begins "
            f"in {joint.outer!r}, got {joint.extension:g} m",
        )
    return end + joint.extension - length, end + joint.extension
