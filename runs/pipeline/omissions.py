# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cautions on inputs that were probably forgotten, given twice, or swapped."""

from __future__ import annotations

from collections.abc import Iterator
from math import isclose

from protractile.geometry.boom import Boom
from protractile.geometry.section import BoxSection
from protractile.runs.case.actions import STANDARD_GRAVITY
from protractile.runs.case.schema import Case

# Relative difference up to which two masses are the same.
_SAME_MASS = 0.025
# Ratio of the thicknesses of flange and web of a box below which they are probably swapped.
_THIN_FLANGE = 0.85
# Multiple of the weight of a segment: a larger load along it has another unit.
_MAX_LINE_LOAD = 5.0


def omission_cautions(case: Case, boom: Boom) -> Iterator[str]:
    """Yield a caution for each input that was probably forgotten, given twice, or swapped."""
    yield from _hoists(case)
    yield from _load_cases(case, boom)
    if case.cylinders and case.gravity and "angle" not in case.gravity.model_fields_set:
        yield (
            "gravity.angle: missing, so that the boom on its cylinder is horizontal; give the "
            "luffing angle in degrees, 0 if it is"
        )
    for number, segment in enumerate(boom.segments, start=1):
        section, table = segment.section, case.segments[number - 1]
        if not isinstance(section, BoxSection) or table.section is None:
            continue
        if section.flange < _THIN_FLANGE * section.web:
            flange, web = (case.system.text(one, "m") for one in (section.flange, section.web))
            yield (
                f"segment[{number}].section: the flanges of {flange} are thinner than the webs of "
                f"{web}; usual is the contrary: check whether they are swapped"
            )
    for number, combination in enumerate(case.combinations, start=1):
        factors = [combination.factors.of(group) for group in ("dead", "payload", "wind")]
        factors += [combination.factors.of("dynamic"), combination.factors.of("test")]
        if not any(factors):
            yield f"combination[{number}].factors: all are 0, so that no load acts"


def tip_weights(case: Case) -> dict[str, float]:
    """Return the masses in kg at the tip that weigh, by their names in messages."""
    payload, hoist = case.payload, case.hoist
    masses = {} if hoist is None else {"load of [hoist]": hoist.mass}
    if payload is not None and (case.gravity is not None or payload.gravity != 0.0):
        masses["payload"] = payload.mass
    return masses


def _hoists(case: Case) -> Iterator[str]:
    if case.hoist is None:
        return
    payload = 0.0 if case.payload is None else case.payload.mass
    if isclose(payload, case.hoist.mass, rel_tol=_SAME_MASS):
        yield (
            f"payload.mass: the {case.system.text(payload, 'kg')} at the tip are also the load of "
            "[hoist], so that they weigh twice; leave one of them out"
        )
    if case.hoist.has_winch and not case.axial:
        yield (
            "axial: missing, so that the rope of [hoist] does not press the boom on its way to the "
            "winch; give [[axial]] with falls and the mass on the rope"
        )


def _load_cases(case: Case, boom: Boom) -> Iterator[str]:
    """Yield cautions on loads of load cases along whole segments that are far from usual."""
    segments = {one.name: one for one in boom.segments}
    for number, load_case in enumerate(case.load_cases, start=1):
        for i, load in enumerate(load_case.loads or (), start=1):
            segment = segments.get(load.segment)
            if segment is None or load.x is not None or load.moment:
                continue
            ratio = abs(load.magnitude) / (STANDARD_GRAVITY * segment.mass_per_length)
            if ratio > _MAX_LINE_LOAD:
                size = case.system.text(load.magnitude, "N/m")
                yield (
                    f"load_case[{number}].load[{i}].magnitude: {size} is {ratio:.3g} times the "
                    f"weight of {load.segment!r}; check the unit, {case.system.label('N/m')}: a "
                    "force at one place needs x"
                )
