# SPDX-License-Identifier: LGPL-3.0-or-later
"""Loads that are out of proportion, of the wrong sign, given twice or forgotten."""

from __future__ import annotations

from collections.abc import Iterator
from math import isclose

import numpy as np

from dynamics.excitation import Ramp, Step, Thrown
from geometry.boom import Boom
from geometry.load import Load
from geometry.segment import Segment
from runs.case.actions import STANDARD_GRAVITY, across
from runs.case.schema import Case

# Of the boom's weight: loads below it are not felt, loads beyond it no boom carries.
LIGHT, HEAVY = 1.0e-3, 1.0e2

# Of the boom's weight: loads upwards beyond it are weights of the wrong sign.
LIFTING = 0.3

# Parts by which two numbers may differ and be the same: two weights, a mass and a force.
SAME, ALIKE = 0.01, 0.05


def _weight(segment: Segment) -> float:
    """In N, with what the segment carries."""
    return STANDARD_GRAVITY * segment.mass


def load_slips(case: Case, boom: Boom) -> Iterator[str]:
    """What to look at again of the loads of a case, a line each."""
    yield from _sizes(case, boom)
    yield from _given_twice(case, boom)
    yield from _without_gravity(case, boom)


def _sizes(case: Case, boom: Boom) -> Iterator[str]:
    weight = sum(map(_weight, boom.segments))
    added = [load for load in boom.loads if load.direction == "z" and not _thrown(load)]
    forces = [segment.load * segment.length for segment in boom.segments]
    forces += [load.resultant(boom.segments[load.segment].length) for load in added]
    payload = case.payload
    if payload is not None and STANDARD_GRAVITY * payload.mass < LIGHT * weight:
        yield (
            f"the payload of {payload.mass:g} kg is less than a thousandth of the boom's "
            f"{weight / STANDARD_GRAVITY:.4g} kg; check the units"
        )
    largest = max(map(abs, forces))
    if largest > HEAVY * weight:
        yield (
            f"a load of {largest:.4g} N is more than a hundred times the boom's weight of "
            f"{weight:.4g} N; check the units"
        )
    lift, turn = np.sum(list(_lasting(boom)), axis=0)
    if lift > LIFTING * weight:
        yield (
            f"the loads pull upwards, by {lift:.4g} N in all; those that pull down, as weights "
            "do, are negative"
        )
    elif case.gravity is not None and turn > 0.0:
        yield (
            f"the loads lift the boom: about its base they turn it up by {turn:.4g} N m more than "
            "weights turn it down; those that pull down are negative"
        )


def _lasting(boom: Boom) -> Iterator[tuple[float, float]]:
    """Of each load along z that comes and stays: N, and N m about the boom's base."""
    base = boom.segments[0].start
    for segment in boom.segments:
        force = segment.load * segment.length
        yield force, force * (0.5 * (segment.start + segment.end) - base)
    for load in boom.loads:
        if load.direction == "z" and isinstance(load.history, Step | Ramp):
            segment = boom.segments[load.segment]
            force = load.resultant(segment.length)
            middle = np.mean([*load.places.values()] or [segment.start, segment.end])
            yield force, force * (float(middle) - base)


def _given_twice(case: Case, boom: Boom) -> Iterator[str]:
    """Loads that are given again, as another load or as a weight; masses given for forces."""
    for name, tables in (("load", case.loads), ("axial", case.axial)):
        for number, table in enumerate(tables):
            if table in tables[:number]:
                first = tables.index(table) + 1
                yield f"{name}[{number + 1}]: is {name}[{first}] once more; leave one of them out"
    weighing = (STANDARD_GRAVITY, *([] if case.gravity is None else [across(case.gravity)]))

    def weighs(force: float, mass: float) -> bool:
        return any(isclose(-force, g * mass, rel_tol=SAME) for g in weighing)

    for number, segment in enumerate(boom.segments, start=1):
        if case.gravity is not None and weighs(segment.load, segment.mass_per_length):
            yield (
                f"segment[{number}].load: {segment.load:g} N/m is the weight of {segment.name!r}, "
                "which the table gravity adds already; leave it out"
            )
    for number, (table, load) in enumerate(zip(case.loads, boom.loads, strict=False), start=1):
        at_tip = load.x == boom.tip and load.direction == "z" and not table.moment
        if case.payload is None or not at_tip:
            continue
        mass, force, where = case.payload.mass, load.magnitude, f"load[{number}].magnitude"
        if weighs(force, mass) and isinstance(load.history, Step):
            yield (
                f"{where}: {force:g} N at the tip is the weight of the payload, which acts "
                "already; leave it out"
            )
        if isclose(-force, mass, rel_tol=ALIKE):
            yield (
                f"{where}: {force:g} N at the tip is a tenth of what the payload of {mass:g} kg "
                f"weighs; if it is in kg, give {force * STANDARD_GRAVITY:.4g} N"
            )


def _without_gravity(case: Case, boom: Boom) -> Iterator[str]:
    """A payload on a boom that nothing presses down."""
    payload, weights = case.payload, [-segment.load for segment in boom.segments]
    weights += [-load.magnitude for load in boom.loads if load.x is None and load.direction == "z"]
    if payload and case.gravity is None and payload.gravity is None and max(weights) <= 0.0:
        mass = sum(segment.mass for segment in boom.segments) - payload.mass
        yield (
            f"gravity: missing, so that the payload of {payload.mass:g} kg weighs and the "
            f"{mass:.4g} kg of the boom do not; give the table gravity, or the payload its own"
        )


def _thrown(load: Load) -> bool:
    """Whether it is but the impulse of an initial velocity."""
    return isinstance(load.history, Thrown)
