# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slewing and luffing of a boom."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from dynamics.excitation import HistorySum
from dynamics.frame_motion import FrameAcceleration, FrameMotion, Spin
from geometry.axial import AxialChange, Thrust, lumped_masses, with_compression
from geometry.boom import BoomError, Direction, PointMass, Segment
from geometry.joint import Joint
from geometry.load import AngularAcceleration, Load
from geometry.telescoping import drives_of
from runs.case.schema import Case


def check_turning(case: Case) -> None:
    """Check the data of slewing and luffing.

    Raises:
        BoomError: a key is missing or contradicts another one, or the boom admits no turning.
    """
    for key, table in (("slew", case.slew), ("luff", case.luff)):
        if table is None:
            continue
        if table.speed is not None and not table.ramp:
            raise BoomError(
                f"{key}.ramp",
                f"missing; a speed reached at once takes an endless force; it is "
                f"{table.meaning('ramp')}",
            )
        table.history(key)
        if case.hoist is not None and not case.hoist.hanging:
            raise BoomError(key, "the load of hoist lies on the ground; give hoist.hanging = true")
    if case.luff is not None:
        if case.gravity is None:
            raise BoomError(
                "luff", "the table gravity, which has the luffing angle at t = 0, is missing"
            )
        farthest = case.gravity.angle + (case.luff.travel or 0.0)
        if abs(farthest) > 90.0:
            raise BoomError(
                "luff.travel", f"leads to {farthest:g} degrees; the angle must stay within ± 90"
            )


def frame_motion(case: Case, segments: Sequence[Segment]) -> FrameMotion:
    """Return the motion of the boom's frame by slewing and luffing, of a checked case."""
    histories = {
        key: table.history(key)
        for key, table in (("slew", case.slew), ("luff", case.luff))
        if table is not None
    }
    foot = segments[0].foot
    return FrameMotion(
        **histories,
        angle=0.0 if case.gravity is None else case.gravity.angle,
        foot=segments[0].start if foot is None else foot.x,
        radius=0.0 if case.slew is None else case.slew.radius,
        gravity=0.0 if case.gravity is None else case.gravity.acceleration,
    )


def turning_loads(
    frame: FrameMotion, segments: Sequence[Segment], joints: Sequence[Joint]
) -> Iterator[Load]:
    """Yield the inertia loads and weight changes across the boom due to slewing and luffing."""
    if not (frame.slew.kinks or frame.luff.kinks):
        return
    directions: tuple[Direction, ...] = ("z", "y")
    for number, segment in enumerate(segments):
        extension = HistorySum(tuple(drive.history for drive in drives_of(joints, number)))
        for direction in directions:
            mass = segment.mass_per_length
            uniform, linear, *points = (
                FrameAcceleration(frame, direction, x, extension)
                for x in (0.0, None, *(point.x for point in segment.masses))
            )
            if linear.peak or uniform.peak:
                yield Load(number, direction, -mass, None, uniform, inertial=True)
                yield AngularAcceleration(number, direction, -1.0, None, linear)
                for point, history in zip(segment.masses, points, strict=True):
                    yield Load(number, direction, -point.mass, point.x, history)


def turning_changes(
    frame: FrameMotion, segments: Sequence[Segment], joints: Sequence[Joint], hanging: float
) -> Iterator[AxialChange]:
    """Yield the changes of axial forces due to slewing and luffing, and centrifugal terms.

    ``hanging`` is the mass in kg of a load on a rope, which counts as a mass at the tip.
    """
    if not (frame.slew.kinks or frame.luff.kinks):
        return
    directions: tuple[Direction, ...] = ("y", "z")
    masses = [lumped_masses(segment) for segment in segments]
    yield from (
        AxialChange(spin, masses=masses, direction=direction)
        for direction in directions
        if (spin := Spin(frame, direction)).peak
    )
    if hanging:
        masses[-1] += (PointMass(segments[-1].end, hanging),)
    drives_of_segments = [tuple(drives_of(joints, number)) for number in range(len(segments))]
    for drives in dict.fromkeys(drives_of_segments):
        extension = HistorySum(tuple(drive.history for drive in drives))
        for x in (0.0, None):
            history = FrameAcceleration(frame, "x", x, extension)
            thrusts = [
                Thrust(number, mass.x, mass.mass * (1.0 if x is not None else mass.x))
                for number, masses_of_segment in enumerate(masses)
                if drives_of_segments[number] == drives
                for mass in masses_of_segment
            ]
            if history.peak:
                loaded_segments = with_compression(segments, joints, thrusts)
                yield AxialChange(history, [segment.compression for segment in loaded_segments])
