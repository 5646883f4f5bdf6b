# SPDX-License-Identifier: LGPL-3.0-or-later
"""Sanity checks of the proportions of a case, which reveal errors of unit or sign."""

from __future__ import annotations

from collections.abc import Iterator
from math import isclose

import numpy as np

from dynamics.equilibrium import equilibrium
from dynamics.excitation import InitialImpulse, Ramp, Step
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem
from geometry.boom import Boom
from runs.case.actions import STANDARD_GRAVITY
from runs.case.sanity import usual_ranges
from runs.case.schema import Case

# Angle in degrees up to which a boom is horizontal.
LEVEL_ANGLE = 0.1

# Fraction of the buckling load above which second-order effects are not small.
NEAR_BUCKLING = 1.0 / 3.0

# Fraction of the length of the boom above which a static deflection is not small.
LARGE_DEFLECTION = 0.05


# Fractions of the weight of the boom: smaller loads have no effect, larger ones no boom can carry.
MIN_LOAD, MAX_LOAD = 1.0e-3, 1.0e2

# Fraction of the weight of the boom: larger upward loads probably have the wrong sign.
MAX_LIFT = 0.3

# Number of periods of the boom beyond which a run is too long for a design.
MANY_PERIODS = 1000.0

# Young's modulus in Pa and density in kg/m³ of steel, and the relative differences within which a
# number counts as the value of steel.
STEEL, STEEL_WITHIN = (2.1e11, 7850.0), (0.06, 0.1)

# Relative differences up to which two loads, and a force and a weight, count as the same.
SAME_LOAD, SAME_WEIGHT = 0.01, 0.05


def proportion_cautions(case: Case, boom: Boom) -> list[str]:
    """Return a caution for each suspicious input."""
    unusual = (one for one in usual_ranges(case, boom) if one.unusual)
    texts = [f"{one.key}: {one.text(case.system)}" for one in unusual]
    texts += [
        *_sizes(case, boom),
        *_repeated_loads(case, boom),
        *_payload_without_gravity(case, boom),
        *_ineffective_inputs(case),
        *_materials(case),
        *_cylinders(case, boom),
        *_pads(case, boom),
        *_meshes(case, boom),
    ]
    return [f"caution: {line}" for line in texts]


def _ineffective_inputs(case: Case) -> Iterator[str]:
    """Yield cautions on inputs that have no effect, or less than the user may intend."""
    duration = case.time.duration
    ramps = [
        (f"{name}[{i}].{key}", getattr(table, key))
        for name, tables in (("load", case.loads), ("base", case.base))
        for i, table in enumerate(tables, start=1)
        for key in ("ramp", "half_sine")
    ]
    for key, ramp in ramps:
        if ramp is not None and ramp > duration:
            kind = key.rpartition(".")[2].replace("_", " ")
            yield (
                f"{key}: the run of {duration:g} s ends at {100.0 * duration / ramp:.3g} % of the "
                f"{kind} of {ramp:g} s; usual is a {kind} that ends within the run"
            )
    for number, joint in enumerate(case.joints, start=1):
        if any(joint.normal_forces) and joint.friction == 0.0:
            yield (
                f"joint[{number}].normal_forces: they press for a friction, which is 0, and do "
                "nothing; give friction, usual is 0.05 to 0.3, or leave them out"
            )
    angle = 0.0 if case.gravity is None else case.gravity.angle
    if LEVEL_ANGLE < abs(angle) <= 0.5 * np.pi:
        yield (
            f"gravity.angle: {angle:g} degrees is nearly level; if it is in radians, give "
            f"{np.rad2deg(angle):.4g}"
        )
    if case.cylinders and angle < -LEVEL_ANGLE:
        yield (
            f"gravity.angle: {angle:g} degrees: the boom on its cylinder points down; upward "
            "angles are positive"
        )


def _materials(case: Case) -> Iterator[str]:
    """Yield a caution for each material with the modulus of steel and another density."""
    tables = {f"segment[{i}].material": one.material for i, one in enumerate(case.segments, 1)}
    for where, table in {"material": case.material, **tables}.items():
        if table is None:
            continue
        off = [
            abs(value / steel - 1.0) > within
            for value, steel, within in zip(
                (table.youngs_modulus, table.density), STEEL, STEEL_WITHIN, strict=True
            )
        ]
        if off == [False, True] and 0.1 * STEEL[1] < table.density < STEEL[1]:
            yield (
                f"{where}.density: {table.density:g} kg/m³ is light for steel, whose Young's "
                f"modulus is given; steel has {STEEL[1]:g} kg/m³"
            )


def _cylinders(case: Case, boom: Boom) -> Iterator[str]:
    """Yield a caution for each cylinder that pulls, holds a sliding segment or is superfluous."""
    for number, (table, cylinder) in enumerate(
        zip(case.cylinders, boom.cylinders, strict=True), start=1
    ):
        segment = boom.segments[cylinder.segment]
        if (height := table.ground[1]) > -table.depth:
            yield (
                f"cylinder[{number}].ground: a height of {height:g} m is above the lug, and the "
                "cylinder would pull; usual is below, where heights are negative"
            )
        if cylinder.segment:
            yield (
                f"cylinder[{number}].segment: {segment.name!r} slides in another segment; a "
                f"luffing cylinder usually holds {boom.segments[0].name!r}"
            )
        elif any(support.clamped for support in segment.supports):
            yield (
                f"cylinder[{number}]: {segment.name!r} has a clamped support, beside which a "
                "cylinder carries little; a foot is usually hinged"
            )


def _pads(case: Case, boom: Boom) -> Iterator[str]:
    """Yield a caution for each contact that is more compliant than its inner segment in bending."""
    for model in (model for model in case.models if not model.bonded):
        for joint in model.model_boom(boom).boom.joints:
            inner = boom.segments[joint.inner]
            bending = 3.0 * inner.bending_stiffness / inner.length**3
            force = 0.5 * STANDARD_GRAVITY * inner.mass
            stiffness = joint.contact.slope_at(force)
            if stiffness < bending:
                yield (
                    f"the compliance of the contacts of {inner.name!r} in {model.name!r} is "
                    f"{1.0 / stiffness:.3g} m/N, above that of the segment as a cantilever, "
                    f"{1.0 / bending:.3g} m/N; check their stiffness"
                )


def _meshes(case: Case, boom: Boom) -> Iterator[str]:
    known = [segment for segment in boom.segments if segment.section is not None]
    sections = [segment.section_at(x) for segment in known for x in segment.ends]
    walls = (plate.length for section in sections for plate in section.plates)
    narrowest = min(walls, default=np.inf)
    for model in case.models:
        edge = model.longest_edge
        if edge > narrowest:
            yield (
                f"the mesh size of {model.name!r}, {edge:g} m, is larger than a wall of "
                f"{narrowest:.3g} m"
            )


def _sizes(case: Case, boom: Boom) -> Iterator[str]:
    weight = STANDARD_GRAVITY * sum(segment.mass for segment in boom.segments)
    added = [
        load
        for load in boom.loads
        if load.direction == "z" and not isinstance(load.history, InitialImpulse)
    ]
    forces = [segment.load * segment.length for segment in boom.segments]
    forces += [load.resultant(boom.segments[load.segment].length) for load in added]
    payload = case.payload
    if payload is not None and STANDARD_GRAVITY * payload.mass < MIN_LOAD * weight:
        yield (
            f"the payload of {payload.mass:g} kg is less than a thousandth of the boom's "
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
            f"a load of {largest:.4g} N is more than a hundred times the boom's weight of "
            f"{weight:.4g} N; check the units"
        )
    for number, load in enumerate(boom.loads[: len(case.loads)], start=1):
        force = abs(load.resultant(boom.segments[load.segment].length))
        if 0.0 < force < MIN_LOAD * weight and load in added:
            yield (
                f"load[{number}]: {force:.4g} N is less than a thousandth of the boom's weight of "
                f"{weight:.4g} N; check the units"
            )
        outer = next((one.outer for one in boom.joints if one.inner == load.segment), None)
        if outer is not None and load.x is not None and load.x < boom.segments[outer].end:
            yield (
                f"load[{number}].x: {load.x:g} m on {boom.segments[load.segment].name!r} lies "
                f"inside {boom.segments[outer].name!r}; usual is the head"
            )
    lift, turn = np.sum(list(_constant_loads(boom)), axis=0)
    if lift > MAX_LIFT * weight:
        yield (
            f"the loads pull upwards, by {lift:.4g} N in all; those that pull down, as weights "
            "do, are negative"
        )
    elif case.gravity is not None and turn > 0.0:
        yield (
            f"the loads lift the boom: about its base they turn it up by {turn:.4g} N m more than "
            "weights turn it down; those that pull down are negative"
        )
    elif payload is not None and case.gravity is not None:
        uplift = sum(max(load.magnitude, 0.0) for load in added if load.x == boom.tip)
        if uplift > 0.5 * STANDARD_GRAVITY * payload.mass:
            yield (
                f"the loads at the tip lift the payload by {uplift:.4g} N; loads that pull down "
                "are negative"
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
            force = load.resultant(segment.length)
            middle = np.mean([*load.places.values()] or [segment.start, segment.end])
            yield force, force * (float(middle) - base)


def _repeated_loads(case: Case, boom: Boom) -> Iterator[str]:
    """Yield cautions on loads that repeat a load or a weight, and on masses in place of forces."""
    for name, tables in (("load", case.loads), ("axial", case.axial)):
        for number, table in enumerate(tables):
            if table in tables[:number]:
                first = tables.index(table) + 1
                yield f"{name}[{number + 1}]: is {name}[{first}] once more; leave one of them out"
    weighing = (STANDARD_GRAVITY, *([] if case.gravity is None else [case.gravity.across]))

    def weighs(force: float, mass: float) -> bool:
        return any(isclose(-force, g * mass, rel_tol=SAME_LOAD) for g in weighing)

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
        if isclose(-force, mass, rel_tol=SAME_WEIGHT):
            yield (
                f"{where}: {force:g} N at the tip is a tenth of the weight of the payload of "
                f"{mass:g} kg; if it is in kg, give {force * STANDARD_GRAVITY:.4g} N"
            )


def _payload_without_gravity(case: Case, boom: Boom) -> Iterator[str]:
    """Yield a caution if a payload has no weight and no other downward load acts."""
    payload, weights = case.payload, [-segment.load for segment in boom.segments]
    weights += [-load.magnitude for load in boom.loads if load.x is None and load.direction == "z"]
    if payload and case.gravity is None and payload.gravity is None and max(weights) <= 0.0:
        mass = sum(segment.mass for segment in boom.segments) - payload.mass
        yield (
            f"gravity: missing, so that the payload of {payload.mass:g} kg weighs and the "
            f"{mass:.4g} kg of the boom do not; give the table gravity, or the payload its own"
        )


def period_cautions(where: str, frequency: float, case: Case) -> list[str]:
    """Return a caution if the run is shorter than one period of the boom, or has very many.

    Args:
        where: model or source of the frequency in the text, for example ``in MODEL``.
        frequency: first frequency in Hz, with closed contacts.
        case: case with the duration of the run.
    """
    periods = case.time.duration * frequency
    if periods > MANY_PERIODS:
        return [
            f"caution: time.duration: the run of {case.time.duration:g} s has {periods:.3g} "
            f"periods {where}; if the duration is in ms, give {1e-3 * case.time.duration:g} s"
        ]
    if periods >= 1.0:
        return []
    return [
        f"caution: time.duration: the run of {case.time.duration:g} s is shorter than one period "
        f"{where}, {1.0 / frequency:.3g} s; usual are three periods at least"
    ]


def static_tip(system: GapSystem) -> float:
    """Return the static tip deflection in m under the constant loads; NaN without an equilibrium.

    Args:
        system: gap system whose ``load`` includes all constant loads from t = 0 on.
    """
    try:
        return float(system.observers["tip"].row @ equilibrium(system, system.load))
    except NumericsError:
        return float("nan")


def buckling_cautions(name: str, critical_factor: float | None) -> list[str]:
    """Return a caution if the axial forces of a model are close to buckling.

    Args:
        name: name of the model.
        critical_factor: buckling factor of its axial forces; None without axial forces, or if it is
            not computed.
    """
    if critical_factor is None or critical_factor * NEAR_BUCKLING >= 1.0:
        return []
    return [
        f"caution: in {name} the axial forces are {100.0 / critical_factor:.3g} % of those under "
        "which the boom buckles, more than a third: deflections grow out of proportion"
    ]


def tip_cautions(where: str, tip: float | None, boom: Boom) -> list[str]:
    """Return a caution if a static deflection is too large.

    Args:
        where: model or source of the deflection in the text, for example ``in MODEL``.
        tip: tip deflection in m; NaN or None without an equilibrium.
        boom: the boom, for its length.
    """
    if tip is None or not abs(tip) > LARGE_DEFLECTION * boom.length:
        return []
    return [
        f"caution: {where} the tip rests at {tip:.3g} m, {100.0 * abs(tip) / boom.length:.2g} % of "
        "the boom's length and more than 5 %: small displacements do not hold; check units and "
        "loads"
    ]
