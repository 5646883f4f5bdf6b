# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tipping moments and outrigger forces of a combination."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import acos, atan2, cos, degrees, hypot, radians, sin
from typing import NamedTuple

from protractile.analysis.rows import BEAM, COMBINATION, Row
from protractile.analysis.states import States
from protractile.geometry.boom import Boom
from protractile.geometry.chassis import CraneForce
from protractile.geometry.cylinder import EarthPoint
from protractile.geometry.head import Head
from protractile.geometry.load import Moment, PartialLoad
from protractile.geometry.support import Support
from protractile.runs.case.actions import head_of, loads, tip_thrusts
from protractile.runs.case.combinations import CombinedCase, tip_masses
from protractile.runs.case.schema import Case

# Stabilising moment in N·m that counts as none.
_NO_MOMENT = 1.0e-9


class LuffedPoint(NamedTuple):
    """A point that luffs with a boom about its foot pin."""

    along: float  #: distance in m from the foot pin along the boom
    up: float  #: distance in m from the foot pin across the boom, upwards
    #: what does not luff: distance in m ahead of the slewing axis, and height in m above the ground
    #: of the chassis; both from the foot pin without chassis
    ahead: float
    above: float

    @property
    def farthest(self) -> float:
        """The largest radius in m at any luffing angle."""
        return self.ahead + hypot(self.along, self.up)

    def at(self, angle: float) -> tuple[float, float]:
        """Return radius and height in m at a luffing angle in degrees."""
        x, z = cos(radians(angle)), sin(radians(angle))
        return (
            self.ahead + self.along * x - self.up * z,
            self.above + self.along * z + self.up * x,
        )

    def angle(self, radius: float) -> float | None:
        """Return the luffing angle in degrees at a radius in m; None if it is out of reach."""
        ratio = (radius - self.ahead) / hypot(self.along, self.up)
        return degrees(acos(ratio) - atan2(self.up, self.along)) if abs(ratio) <= 1.0 else None


def foot_of(boom: Boom) -> Support:
    """Return the foot pin about which the boom luffs; one at x = 0 on the axis without any."""
    return next((one.foot for one in boom.segments if one.foot is not None), Support(0.0))


def luffed_point(
    case: Case, boom: Boom, x: float, up: float, head: Head | None = None
) -> LuffedPoint:
    """Return a point of a boom from its foot pin, which may lie below or above the axis.

    Args:
        case: case with the chassis.
        boom: the boom.
        x: x of the point in m.
        up: its distance in m above the axis.
        head: head of the boom, if the point is where the load hangs.
    """
    ahead, above = (
        (case.chassis.foot_ahead, case.chassis.foot_above) if case.chassis else (0.0, 0.0)
    )
    if head is not None:
        level = head.level or EarthPoint(0.0, 0.0)
        ahead, above = ahead + level.front, above - level.below
        head = replace(head, level=None).in_boom_axes(boom.segments[-1], 0.0)
        x, up = x + head.ahead, up - head.below
    foot = foot_of(boom)
    return LuffedPoint(x - foot.x, up + foot.depth, ahead, above)


def hook_point(case: Case, boom: Boom, tip: float = 0.0) -> LuffedPoint:
    """Return the place of the load of a boom with a tip deflection in m."""
    return luffed_point(case, boom, boom.tip, tip, head_of(case))


def outrigger_rows(combined: CombinedCase, states: States) -> Iterator[Row]:
    """Yield the largest forces of the outriggers in a combination; none without chassis.

    The factors of the combination apply to the boom and its loads, and not to the masses of the
    chassis. The payload hangs at the deflected tip; the weight of the boom acts at the straight
    one. Loads and wind act in the plane of the boom.
    """
    case = combined.of
    if case.chassis is None or case.gravity is None:
        return
    gravity, forces = case.gravity.acceleration, [*_forces(combined, states)]
    for name, force in case.chassis.outrigger_forces(forces, gravity):
        yield _row(combined, "outrigger_force", f"{name} outriggers", force)


def tipping_proofs(combined: CombinedCase, states: States) -> Iterator[Row]:
    """Yield the proof of tipping about each line; arguments as in :func:`outrigger_rows`."""
    case, factor = combined.of, combined.combination.resistance.tipping
    if case.chassis is None or case.gravity is None:
        return
    gravity, forces = case.gravity.acceleration, [*_forces(combined, states)]
    for name, overturning, stabilising in case.chassis.tipping(forces, gravity):
        # A crane without stabilising moment tips.
        limit = max(stabilising / factor, _NO_MOMENT)
        yield _row(combined, "tipping", f"{name} line", overturning, limit)


def _row(
    combined: CombinedCase, quantity: str, place: str, value: float, limit: float | None = None
) -> Row:
    state = COMBINATION + combined.name
    return Row(BEAM, state, True, quantity, "chassis", place, value, limit=limit)


def _forces(combined: CombinedCase, states: States) -> Iterator[CraneForce]:
    """Yield the forces on the boom of a combination, in its plane."""
    case, factors, boom = combined.of, combined.factors, states.boom
    assert case.gravity is not None
    assert combined.case.gravity is not None
    angle = combined.case.gravity.angle
    along, up = cos(radians(angle)), sin(radians(angle))
    gravity = case.gravity.acceleration
    tip = min(states.observed("tip").tolist())
    masses = tip_masses(case, combined.table)
    hung = sum(mass for _, mass in masses)
    moment = sum(segment.mass_moment for segment in boom.segments) - hung * boom.tip
    centre = luffed_point(case, boom, moment / (boom.mass - hung), 0.0)
    weight = factors["dead"] * gravity * (boom.mass - hung)
    yield CraneForce(weight, centre.at(angle)[0])
    radius, _ = hook_point(case, boom, tip).at(angle)
    for group, hanging in masses:
        yield CraneForce(factors[group] * gravity * hanging, radius)
    acting = combined.case.gravity.model_copy(update={"acceleration": 0.0})
    # The wind meets the payload without its weight.
    payload = combined.case.payload and combined.case.payload.model_copy(update={"gravity": 0.0})
    without = {"payload": payload, "hoist": None, "gravity": acting, "base": ()}
    others = combined.case.model_copy(update=without)
    # The moment of a force on the load about the end of the boom is among the loads.
    radius, above = luffed_point(case, boom, boom.tip, tip).at(angle)
    for thrust in tip_thrusts(others, boom.segments):
        yield CraneForce(thrust.force * up, radius, -thrust.force * along, above)
    for load in loads(others, boom.segments, boom.joints):
        if load.direction != "z":
            continue
        segment = boom.segments[load.segment]
        if isinstance(load, Moment):
            yield CraneForce(0.0, moment=-load.magnitude)
            continue
        force = load.resultant(segment.length)
        span = load.span if isinstance(load, PartialLoad) else segment.ends
        x = sum(span) / 2.0 if load.x is None else load.x
        place = luffed_point(case, boom, x, 0.0).at(angle)
        yield CraneForce(-force * along, place[0], -force * up, place[1])
