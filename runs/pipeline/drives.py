# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a boom's drives do, before anything moves."""

from __future__ import annotations

from collections.abc import Iterator

from geometry.boom import Boom
from geometry.drive import Drive
from runs.case.drive import fastest
from runs.case.units import System


def drive_lines(boom: Boom, system: System) -> Iterator[str]:
    """A sentence for each drive: how far, when, how fast, and what overlap is left.

    Args:
        boom: whose joints may have drives.
        system: the units to say it in.
    """

    def said(length: float) -> str:
        return f"{system.of(length, 'm'):.4g} {system.label('m')}"

    for joint in boom.joints:
        if joint.drive is None:
            continue
        outer, inner = boom.segments[joint.outer], boom.segments[joint.inner]
        begin, end = _span(joint.drive)
        low, high = joint.drive.reach
        ways = [f"{said(way)} {word}" for way, word in ((high, "out"), (-low, "in")) if way > 0.0]
        speed = system.of(fastest(joint.drive), "m/s")
        yield (
            f"A drive draws {inner.name!r} {' and '.join(ways)} of {outer.name!r} from {begin:g} "
            f"to {end:g} s, at {speed:.4g} {system.label('m/s')} at most; "
            f"{said(boom.overlap_left(joint))} of overlap "
            "are left."
        )


def _span(drive: Drive) -> tuple[float, float]:
    """When it begins and ends, in s."""
    kinks = drive.history.kinks
    return max(0.0, min(kinks)), max(kinks)
