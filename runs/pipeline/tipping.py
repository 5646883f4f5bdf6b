# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tipping moments and outrigger forces of a combination."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, radians, sin

from protractile.analysis.rows import BEAM, COMBINATION, Row
from protractile.analysis.states import States
from protractile.geometry.axial import lumped_masses
from protractile.geometry.boom import Boom
from protractile.geometry.chassis import CraneForce
from protractile.geometry.load import Load, Moment, PartialLoad
from protractile.runs.case.combinations import CombinedCase, load_tables, tip_masses
from protractile.runs.case.schema import Case

# Stabilising moment in N·m that counts as none.
_NO_MOMENT = 1.0e-9


def hook_place(case: Case, boom: Boom, angle: float, tip: float) -> tuple[float, float]:
    """Return radius and height in m of the tip of a boom.

    They count from the slewing axis and the ground of the chassis, or from the foot pin without
    chassis.

    Args:
        case: case with the chassis.
        boom: the boom.
        angle: luffing angle in degrees.
        tip: tip deflection in m.
    """
    length, turn = boom.tip - foot_of(boom), radians(angle)
    chassis = case.chassis
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
    one. Loads across the boom act in its plane.
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
    ahead, above = hook_place(case, boom, angle, 0.0)
    start = ahead - (boom.tip - foot) * along, above - (boom.tip - foot) * up
    masses = tip_masses(case, combined.table)
    points = [point for segment in boom.segments for point in lumped_masses(segment)]
    hung = sum(mass for _, mass in masses)
    mass = sum(point.mass for point in points) - hung
    moment = sum(point.mass * (point.x - foot) for point in points) - hung * (boom.tip - foot)
    weight = factors["dead"] * gravity
    yield CraneForce(weight * mass, start[0] + moment / mass * along)
    radius, _ = hook_place(case, boom, angle, tip)
    for group, hanging in masses:
        yield CraneForce(factors[group] * gravity * hanging, radius)
    for load in boom.loads[: len(load_tables(case, combined.table))]:
        if load.direction != "z":
            continue
        segment = boom.segments[load.segment]
        if isinstance(load, Moment):
            yield CraneForce(0.0, moment=-load.magnitude)
            continue
        force = load.resultant(segment.length)
        x = _centre(load, segment.ends) - foot
        place = start[0] + x * along, start[1] + x * up
        yield CraneForce(-force * along, place[0], -force * up, place[1])


def _centre(load: Load, ends: tuple[float, float]) -> float:
    """Return the x in m of the resultant of a load."""
    if load.x is not None:
        return load.x
    return sum(load.span if isinstance(load, PartialLoad) else ends) / 2.0
