# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rules on loads and weights: wrong signs and units, and loads that are missing or given twice."""

from __future__ import annotations

from collections.abc import Iterator
from math import isclose

import numpy as np

from protractile.dynamics.excitation import InitialImpulse, Ramp, Step
from protractile.geometry.boom import Boom
from protractile.geometry.load import Load
from protractile.geometry.typography import amount
from protractile.runs.case.actions import STANDARD_GRAVITY
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context

# Fractions of the weight of the boom: smaller loads have no effect, larger ones no boom can carry.
MIN_LOAD, MAX_LOAD = 1.0e-3, 1.0e2
# Range of forces at the tip in N that may be masses in kg by mistake, and the largest fraction of
# the weight of the boom for such a force.
USUAL_LOAD, SMALL_LOAD = (20.0, 500.0), 0.1
# Fraction of the mass of the boom: no boom is built for a smaller payload.
MIN_PAYLOAD = 0.02
# Multiple of the weight of a segment: a larger load along it is probably meant at one point, or has
# another unit.
MAX_LINE_LOAD = 5.0
# Fraction of the length of the boom: a place closer to the tip counts as the tip.
NEAR_TIP = 0.02
# Fraction of the weight of the boom: larger upward loads probably have the wrong sign.
MAX_LIFT = 0.3
# Relative difference up to which a force equals a weight, also with 10 m/s² for gravity; relative
# difference up to which the number of a force in N equals that of a mass in kg.
SAME_LOAD, SAME_WEIGHT = 0.025, 0.05


def sizes(context: Context) -> Iterator[str]:
    """Yield cautions on loads with an unusual size, place or sign."""
    case, boom = context.case, context.boom
    weight = STANDARD_GRAVITY * boom.mass
    added = [
        load
        for load in boom.loads
        if load.direction == "z" and not isinstance(load.history, InitialImpulse)
    ]
    forces = [segment.load * segment.length for segment in boom.segments]
    forces += [load.resultant(boom.segments[load.segment].length) for load in added]
    payload = case.payload
    if payload is not None and STANDARD_GRAVITY * payload.mass < MIN_PAYLOAD * weight:
        yield (
            f"the payload of {payload.mass:g} kg is less than a fiftieth of the boom's "
            f"{weight / STANDARD_GRAVITY:.4g} kg; check the units"
        )
    if payload is not None and payload.mass % 5.0:
        round_mass = 10.0 * round(payload.mass / STANDARD_GRAVITY / 10.0)
        if isclose(payload.mass, STANDARD_GRAVITY * round_mass, rel_tol=5.0e-4):
            yield (
                f"payload.mass: {payload.mass:g} is the weight of {round_mass:g} kg in N; if it "
                f"is in N, give {round_mass:g} kg"
            )
    largest = max(map(abs, forces))
    if largest > MAX_LOAD * weight:
        yield (
            f"a load of {amount(largest, 'N')} is more than a hundred times the boom's weight of "
            f"{amount(weight, 'N')}; check the units"
        )
    for number, load in enumerate(boom.loads[: len(case.loads)], start=1):
        segment = boom.segments[load.segment]
        force = abs(load.resultant(segment.length)) * getattr(load.history, "peak", 1.0)
        if 0.0 < force < MIN_LOAD * weight:
            yield (
                f"load[{number}]: {force:.4g} N is less than a thousandth of the boom's weight of "
                f"{amount(weight, 'N')}; check the units"
            )
        own = STANDARD_GRAVITY * segment.mass_per_length * segment.length
        if type(load) is Load and load.x is None and force > MAX_LINE_LOAD * own:
            yield (
                f"load[{number}]: {load.magnitude:g} N/m along the whole of {segment.name!r} makes "
                f"{amount(force, 'N')}, {force / own:.2g} times its weight; a force at one place "
                "needs x"
            )
        outer = next((joint.outer for joint in boom.joints if joint.inner == load.segment), None)
        if outer is not None and load.x is not None and load.x < boom.segments[outer].end:
            yield (
                f"load[{number}].x: {load.x:g} m on {segment.name!r} lies "
                f"inside {boom.segments[outer].name!r}; usual is the head"
            )
    lift, turn = np.sum(list(_constant_loads(boom)), axis=0)
    if lift > MAX_LIFT * weight:
        yield (
            f"the loads pull upwards, by {amount(lift, 'N')} in all; those that pull down, as "
            "weights do, are negative"
        )
    elif case.gravity is not None and turn > 0.0:
        yield (
            "the loads lift the boom: about its base they turn it up by "
            f"{amount(turn, 'N m')} more than weights turn it down; those that pull down are "
            "negative"
        )
    elif payload is not None and case.gravity is not None:
        uplift = sum(max(load.magnitude, 0.0) for load in added if load.x == boom.tip)
        if uplift > 0.5 * STANDARD_GRAVITY * payload.mass:
            yield (
                f"the loads at the tip lift the payload by {amount(uplift, 'N')}; loads that pull "
                "down are negative"
            )


def _constant_loads(boom: Boom) -> Iterator[tuple[float, float]]:
    """Yield force in N and moment about the base in N m of each constant load along z."""
    base = boom.segments[0].start
    for segment in boom.segments:
        force = segment.load * segment.length
        yield force, force * (0.5 * (segment.start + segment.end) - base)
    for load in boom.loads:
        if load.direction == "z" and isinstance(load.history, Step | Ramp):
            segment = boom.segments[load.segment]
            yield load.resultant(segment.length), load.turn(segment.ends, base)


def repeated_loads(context: Context) -> Iterator[str]:
    """Yield cautions on loads that repeat a load or weight, and on masses given as forces."""
    case, boom = context.case, context.boom
    loads_of_case = boom.loads[: len(case.loads_of_segments)]
    for name, tables in (("load", loads_of_case), ("axial", case.axial)):
        for number, table in enumerate(tables):
            if table in tables[:number]:
                first = tables.index(table) + 1
                yield f"{name}[{number + 1}]: repeats {name}[{first}]; leave one of them out"
    payload, end = case.payload, boom.tip - NEAR_TIP * boom.length
    weight = STANDARD_GRAVITY * boom.mass
    weighing = (STANDARD_GRAVITY, *([] if case.gravity is None else [case.gravity.across]))

    def weighs(force: float, mass: float) -> bool:
        return force < 0.0 and any(isclose(-force, g * mass, rel_tol=SAME_LOAD) for g in weighing)

    for number, segment in enumerate(boom.segments, start=1):
        if case.gravity is not None and weighs(segment.load, segment.mass_per_length):
            yield (
                f"segment[{number}].load: {segment.load:g} N/m is the weight of {segment.name!r}, "
                "which the table gravity adds already; leave it out"
            )
    if payload is not None:
        tip_masses = [mass.mass for mass in boom.segments[-1].masses if mass.x > end]
        if sum(isclose(mass, payload.mass, rel_tol=SAME_LOAD) for mass in tip_masses) > 1:
            yield (
                f"segment[{len(boom.segments)}].masses: the {payload.mass:g} kg of the payload "
                "are repeated at the tip; leave one of them out"
            )
    for (number, table), load in zip(case.loads_of_segments, loads_of_case, strict=True):
        if load.direction == "y" or table.moment or not isinstance(load.history, Step | Ramp):
            continue
        segment, where = boom.segments[load.segment], f"load[{number}].magnitude"
        force = load.resultant(segment.length)
        if case.gravity is not None and weighs(force, segment.mass_per_length * segment.length):
            yield (
                f"{where}: {force:g} N in all is the weight of {segment.name!r}, which the table "
                "gravity adds already; leave it out"
            )
        if load.x is None or load.x < end:
            continue
        mass = 0.0 if payload is None else payload.mass
        same = [
            name for name, weight in tip_weights(case).items() if weight and weighs(force, weight)
        ]
        if same:
            yield (
                f"{where}: if {force:g} N at the tip is the weight of the {same[0]}, it acts "
                "already; leave it out"
            )
        elif mass and isclose(-force, mass, rel_tol=SAME_WEIGHT):
            yield (
                f"{where}: {force:g} N at the tip is a tenth of the weight of the payload of "
                f"{mass:g} kg; if it is in kg, give {force * STANDARD_GRAVITY:.4g} N"
            )
        elif USUAL_LOAD[0] <= -force <= min(USUAL_LOAD[1], SMALL_LOAD * weight):
            yield (
                f"{where}: {force:g} N at the tip is {100.0 * -force / weight:.2g} % of the boom's "
                f"weight; if it is in kg, give its weight, {force * weighing[-1]:.4g} N"
            )


def axial_forces(context: Context) -> Iterator[str]:
    """Yield cautions on axial forces with an unusual sign or size, and on repeated weights."""
    case, boom = context.case, context.boom
    along = 0.0 if case.gravity is None else case.gravity.along
    for number, table in enumerate(case.axial, start=1):
        if not table.force:
            continue
        same = [
            name
            for name, mass in tip_weights(case).items()
            if isclose(table.force, mass * along, rel_tol=SAME_LOAD)
        ]
        where = f"axial[{number}].force: {table.force:g} N"
        if table.force < 0.0:
            yield f"{where} pulls the boom towards its tip; forces towards the base are positive"
        elif table.force < MIN_LOAD * STANDARD_GRAVITY * boom.mass:
            yield f"{where} is less than a thousandth of the boom's weight; check the units"
        elif same:
            yield (
                f"{where} is the weight of the {same[0]} along the boom, which the table gravity "
                "adds already; leave it out"
            )


def missing_loads(context: Context) -> Iterator[str]:
    """Yield cautions if nothing loads the boom or a combination, or if only the payload weighs."""
    case, boom = context.case, context.boom
    amounts = [load.magnitude for load in boom.loads]
    amounts += [
        segment.load or (segment.lateral.load if segment.lateral else 0.0)
        for segment in boom.segments
    ]
    if not any([*amounts, case.driven_segments, case.hoist, case.slew, case.luff]):
        yield (
            "load: nothing loads the boom across its axis or moves it, so that it stays at rest; "
            "give [[load]], [gravity], [payload], [[base]], start.velocity or joint.drive"
        )
    payload, weights = case.payload, [-segment.load for segment in boom.segments]
    weights += [-load.magnitude for load in boom.loads if load.x is None and load.direction == "z"]
    if payload and case.gravity is None and payload.gravity is None and max(weights) <= 0.0:
        yield (
            f"gravity: missing, so that the payload of {payload.mass:g} kg weighs and the "
            f"{boom.mass - payload.mass:.4g} kg of the boom do not; give the table gravity, or the "
            "payload its own"
        )
    for number, combination in enumerate(case.combinations, start=1):
        factors = [combination.factors.of(group) for group in ("dead", "payload", "wind")]
        factors += [combination.factors.of("dynamic"), combination.factors.of("test")]
        if not any(factors):
            yield f"combination[{number}].factors: all are 0, so that no load acts"


def hoisted_loads(context: Context) -> Iterator[str]:
    """Yield cautions on a hoisted load that weighs twice, or whose rope has no axial force."""
    case = context.case
    if case.hoist is None:
        return
    payload = 0.0 if case.payload is None else case.payload.mass
    if isclose(payload, case.hoist.mass, rel_tol=SAME_LOAD):
        yield (
            f"payload.mass: the {case.system.text(payload, 'kg')} at the tip are also the load of "
            "[hoist], so that they weigh twice; leave one of them out"
        )
    if case.hoist.has_winch and not (case.rope or case.axial):
        yield (
            "rope: missing, so that the rope of [hoist] does not press the boom on its way to the "
            "winch; give [rope]"
        )


def load_cases(context: Context) -> Iterator[str]:
    """Yield cautions on loads of load cases along whole segments that are far from usual."""
    case, boom = context.case, context.boom
    segments = {segment.name: segment for segment in boom.segments}
    for number, load_case in enumerate(case.load_cases, start=1):
        for i, load in enumerate(load_case.loads or (), start=1):
            segment = segments.get(load.segment or "")
            if segment is None or load.x is not None or load.moment:
                continue
            ratio = abs(load.magnitude) / (STANDARD_GRAVITY * segment.mass_per_length)
            if ratio > MAX_LINE_LOAD:
                size = case.system.text(load.magnitude, "N/m")
                yield (
                    f"load_case[{number}].load[{i}].magnitude: {size} is {ratio:.3g} times the "
                    f"weight of {load.segment!r}; check the unit, {case.system.label('N/m')}: a "
                    "force at one place needs x"
                )


def tip_weights(case: Case) -> dict[str, float]:
    """Return the masses in kg at the tip that weigh, by their names in messages."""
    payload, hoist = case.payload, case.hoist
    masses = {} if hoist is None else {"load of [hoist]": hoist.mass}
    if payload is not None and (case.gravity is not None or payload.gravity != 0.0):
        masses["payload"] = payload.mass
    return masses
