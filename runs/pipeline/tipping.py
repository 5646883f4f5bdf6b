# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tipping moments and outrigger forces of a combination."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, radians, sin

from protractile.analysis.rows import BEAM, COMBINATION, Row
from protractile.analysis.states import States
from protractile.geometry.boom import Boom
from protractile.geometry.chassis import CraneForce
from protractile.geometry.load import Moment, PartialLoad
from protractile.runs.case.actions import head_of, loads, tip_thrusts
from protractile.runs.case.combinations import CombinedCase, tip_masses
from protractile.runs.case.schema import Case

# Stabilising moment in N·m that counts as none.
_NO_MOMENT = 1.0e-9


def hook_place(case: Case, boom: Boom, angle: float, tip: float) -> tuple[float, float]:
    """Return radius and height in m of the load at the tip of a boom.

    They count from the slewing axis and the ground of the chassis, or from the foot pin without
    chassis.

    Args:
        case: case with the chassis.
        boom: the boom.
        angle: luffing angle in degrees.
        tip: tip deflection in m.
    """
    chassis, turn = case.chassis, radians(angle)
    length = boom.tip - foot_of(boom)
    if (head := head_of(case)) is not None:
        head = head.in_boom_axes(boom.segments[-1], turn)
        length, tip = length + head.ahead, tip - head.below
    ahead, above = (0.0, 0.0) if chassis is None else (chassis.foot_ahead, chassis.foot_above)
    return (
        ahead + length * cos(turn) - tip * sin(turn),
        above + length * sin(turn) + tip * cos(turn),
    )


def foot_of(boom: Boom) -> float:
    """Return the x in m of the foot pin about which the boom luffs."""
    return next((one.foot.x for one in boom.segments if one.foot is not None), 0.0)


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
    gravity, foot = case.gravity.acceleration, foot_of(boom)
    tip = min(states.observed("tip").tolist())
    chassis = case.chassis
    start = (chassis.foot_ahead, chassis.foot_above) if chassis else (0.0, 0.0)
    masses = tip_masses(case, combined.table)
    hung = sum(mass for _, mass in masses)
    moment = sum(segment.mass_moment for segment in boom.segments) - hung * boom.tip
    centre = moment / (boom.mass - hung) - foot
    weight = factors["dead"] * gravity * (boom.mass - hung)
    yield CraneForce(weight, start[0] + centre * along)
    radius, above = hook_place(case, boom, angle, tip)
    for group, hanging in masses:
        yield CraneForce(factors[group] * gravity * hanging, radius)
    acting = combined.case.gravity.model_copy(update={"acceleration": 0.0})
    # The wind meets the payload without its weight.
    payload = combined.case.payload and combined.case.payload.model_copy(update={"gravity": 0.0})
    without = {"payload": payload, "hoist": None, "gravity": acting, "base": ()}
    others = combined.case.model_copy(update=without)
    # The moment of a force on the load about the end of the boom is among the loads.
    radius, above = hook_place(case.model_copy(update={"head": None}), boom, angle, tip)
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
        x = (sum(span) / 2.0 if load.x is None else load.x) - foot
        place = start[0] + x * along, start[1] + x * up
        yield CraneForce(-force * along, place[0], -force * up, place[1])
