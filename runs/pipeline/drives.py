# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a boom's drives do, before anything moves."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dynamics.excitation import followed
from geometry.boom import Boom, Joint
from geometry.drive import Drive
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
            f"{said(overlap_left(boom, joint))} of overlap "
            "are left."
        )


def overlap_left(boom: Boom, joint: Joint) -> float:
    """In m where a drive has drawn a joint out farthest."""
    outer, inner = boom.segments[joint.outer], boom.segments[joint.inner]
    farthest = 0.0 if joint.drive is None else joint.drive.reach[1]
    return min(outer.end, inner.end) - inner.start - farthest


def _span(drive: Drive) -> tuple[float, float]:
    """When it begins and ends, in s."""
    kinks = drive.history.kinks
    return max(0.0, min(kinks)), max(kinks)


def fastest(drive: Drive) -> float:
    """Its largest speed in m/s."""
    times = followed([drive.history], _span(drive)[1])
    return float(np.abs(np.diff(drive.history(times)) / np.diff(times)).max())
