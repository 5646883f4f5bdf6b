# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plausibility checks of a case, which reveal wrong units and signs."""

from __future__ import annotations

from collections.abc import Iterator
from math import isclose

import numpy as np

from protractile.dynamics.excitation import InitialImpulse, Ramp, Step
from protractile.geometry.boom import Boom
from protractile.geometry.fit import room
from protractile.geometry.joint import SIDES, SlidePad
from protractile.geometry.load import Load
from protractile.geometry.section import Direction
from protractile.geometry.typography import TO_MILLI
from protractile.runs.case.actions import STANDARD_GRAVITY
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.sanity import materials, usual_ranges
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.omissions import omission_cautions, tip_weights

# Angle in degrees up to which a boom is horizontal.
LEVEL_ANGLE = 0.1

# Fractions of the weight of the boom: smaller loads have no effect, larger ones no boom can carry.
MIN_LOAD, MAX_LOAD = 1.0e-3, 1.0e2

# Range of forces at the tip in N that may be masses in kg by mistake, and the largest fraction of
# the weight of the boom for such a force.
USUAL_LOAD, SMALL_LOAD = (20.0, 500.0), 0.1

# Fraction of the mass of the boom: no boom is built for a smaller payload.
MIN_PAYLOAD = 0.02

# Multiple of the weight of a segment: a larger load along it is probably meant at one point.
MAX_LINE_LOAD = 5.0

# Fraction of the length of the boom: a place closer to the tip counts as the tip.
NEAR_TIP = 0.02

# Fraction of the weight of the boom: larger upward loads probably have the wrong sign.
MAX_LIFT = 0.3

# Young's modulus in Pa and density in kg/m³. A modulus within 6 % reveals the material. The density
# may be larger, since it may include other masses, but not twice as large.
MATERIALS = {"steel": (2.1e11, 7850.0), "aluminium": (7.0e10, 2700.0)}
SAME_MODULUS, LEAST_DENSITY, MOST_DENSITY = 0.06, 0.9, 2.0

# Fraction of the peak of a ground acceleration up to which it has ended.
ENDED = 0.01

# Relative difference up to which a force equals a weight, also with 10 m/s² for gravity; relative
# difference up to which the number of a force in N equals that of a mass in kg.
SAME_LOAD, SAME_WEIGHT = 0.025, 0.05


def proportion_cautions(case: Case, boom: Boom) -> list[str]:
    """Return a caution for each suspicious input."""
    unusual = (one for one in usual_ranges(case, boom) if one.unusual)
    texts = [f"{one.key}: {one.text(case.system)}" for one in unusual]
    texts += [
        *_sizes(case, boom),
        *_repeated_loads(case, boom),
        *_axial_forces(case, boom),
        *_missing_loads(case, boom),
        *_ineffective_inputs(case),
        *_materials(case),
        *_table_ends(case, boom),
        *_cylinders(boom),
        *_joints(case),
        *_gaps(boom),
        *_pads(case, boom),
        *_meshes(case, boom),
        *omission_cautions(case, boom),
    ]
    return [f"caution: {case.system.convert(line)}" for line in texts]


def _ineffective_inputs(case: Case) -> Iterator[str]:
    """Yield cautions on inputs without effect, or with less effect than the user may intend."""
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
                f"joint[{number}].normal_forces: they have no effect, since friction is 0; give "
                "friction, usual is 0.05 to 0.3, or leave them out"
            )
    moves = (case.loads, case.base, case.driven_segments, case.hoist, case.slew, case.luff)
    if case.gravity is not None and not case.start.at_rest and any(moves):
        yield (
            "start.state: the boom starts straight and falls under its weight while other loads "
            "act; give 'equilibrium' to start at rest under the loads at t = 0"
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
    """Yield a caution for each material whose density does not match its Young's modulus."""
    for where, table in materials(case).items():
        for name, (modulus, density) in MATERIALS.items():
            if not isclose(table.youngs_modulus, modulus, rel_tol=SAME_MODULUS):
                continue
            part = table.density / density
            if 0.1 < part < LEAST_DENSITY or part > MOST_DENSITY:
                weight = "light" if part < 1.0 else "heavy"
                yield (
                    f"{where}.density: {table.density:g} kg/m³ is {weight} for {name}, whose "
                    f"Young's modulus is given; {name} has {density:g} kg/m³"
                )


def _table_ends(case: Case, boom: Boom) -> Iterator[str]:
    """Yield cautions on tables whose last pair acts where it is unsafe."""
    for number, segment in enumerate(boom.segments, start=1):
        pairs = segment.material.yield_by_thickness
        if not pairs or segment.section is None:
            continue
        plates = [plate for x in segment.ends for plate in segment.section_at(x).plates]
        if (most := max(plate.thickness for plate in plates)) > pairs[-1][0]:
            yield (
                f"segment[{number}].section: a plate of {TO_MILLI * most:.4g} mm is thicker than "
                f"the last pair of yield_by_thickness, {TO_MILLI * pairs[-1][0]:.4g} mm, and takes "
                "its strength; add a pair"
            )
    for number, base in enumerate(case.base, start=1):
        if base.table is None:
            continue
        (end, last), most = base.table[-1], max(abs(factor) for _, factor in base.table)
        if end < case.time.duration and abs(last) > ENDED * most:
            yield (
                f"base[{number}]: its table ends at {end:g} s with {100.0 * abs(last) / most:.3g} "
                "% of its peak, which acts until the run ends; end it with 0"
            )


def _cylinders(boom: Boom) -> Iterator[str]:
    """Yield cautions on cylinders that pull, hold a sliding segment, or are at an unusual place."""
    for number, cylinder in enumerate(boom.cylinders, start=1):
        segment = boom.segments[cylinder.segment]
        if (height := cylinder.ground[1]) > -cylinder.depth:
            yield (
                f"cylinder[{number}].ground: a height of {height:g} m is above the lug, and the "
                "cylinder would pull; usual is below, where heights are negative"
            )
        if cylinder.depth < 0.0:
            yield (
                f"cylinder[{number}].depth: {cylinder.depth:g} m puts the lug above the axis of "
                f"{segment.name!r}; usual is below, where depths are positive"
            )
        foot = segment.foot
        for key, place, name in (
            ("ground", cylinder.ground[0], "the lower end"),
            ("x", -np.inf if foot is None else foot.x, "the foot"),
        ):
            if place > cylinder.x:
                yield (
                    f"cylinder[{number}].{key}: {name} at x = {place:g} m is farther out than the "
                    f"lug at {cylinder.x:g} m; usual is nearer to the base"
                )
        if cylinder.segment:
            yield (
                f"cylinder[{number}].segment: {segment.name!r} slides in another segment; a "
                f"luffing cylinder usually holds {boom.segments[0].name!r}"
            )
        elif any(support.kind == "clamped" for support in segment.supports):
            yield (
                f"cylinder[{number}]: {segment.name!r} has a clamped support, beside which a "
                "cylinder carries little; a foot is usually hinged"
            )


def _joints(case: Case) -> Iterator[str]:
    """Yield a caution for each outer segment that holds more than one inner segment."""
    held: dict[str, str] = {}
    for number, joint in enumerate(case.joints, start=1):
        outer, inner = str(joint.outer), str(joint.inner)
        if outer in held:
            yield (
                f"joint[{number}].outer: {outer!r} holds {held[outer]!r} already; usual is one "
                "segment in another"
            )
        held[outer] = inner


def _gaps(boom: Boom) -> Iterator[str]:
    """Yield a caution for each pad that is thicker than the gap between its segments."""
    for number, joint in enumerate(boom.joints, start=1):
        outer, inner = boom.segments[joint.outer], boom.segments[joint.inner]
        if outer.section is None or inner.section is None:
            continue
        height, width = room(joint, outer, inner)
        gaps: dict[Direction, float] = {"z": height, "y": width}
        pads = {} if joint.pad is None else {"pad": joint.pad}
        pads |= {f"pads[{i}]": pad for i, pad in enumerate(joint.pads, start=1)}
        for key, pad in pads.items():
            for way in [SIDES[pad.side][0]] if isinstance(pad, SlidePad) else boom.directions:
                if (thickness := pad.thickness or 0.0) > gaps[way]:
                    yield (
                        f"joint[{number}].{key}.thickness: a pad of {TO_MILLI * thickness:.4g} mm "
                        f"is thicker than the gap of {TO_MILLI * gaps[way]:.4g} mm between "
                        f"{outer.name!r} and {inner.name!r}, both sides together"
                    )


def _pads(case: Case, boom: Boom) -> Iterator[str]:
    """Yield a caution for each contact that is more compliant than its inner segment in bending."""
    for model in (model for model in case.models if not model.bonded):
        for joint in model.model_boom(boom).boom.joints:
            inner = boom.segments[joint.inner]
            bending = 3.0 * inner.bending_stiffness / inner.length**3
            force = 0.5 * STANDARD_GRAVITY * inner.mass
            stiffness = joint.contact.slope_at(force)
            if stiffness <= 0.0:
                yield (
                    f"the contacts of {inner.name!r} in {model.name!r} do not become stiffer at "
                    f"{force:.3g} N, half the weight of this segment; continue their table of "
                    "forces to larger forces"
                )
            elif stiffness < bending:
                yield (
                    f"the compliance of the contacts of {inner.name!r} in {model.name!r} is "
                    f"{1.0 / stiffness:.3g} m/N, above {1.0 / bending:.3g} m/N of the segment as a "
                    "cantilever; check their stiffness"
                )


def _meshes(case: Case, boom: Boom) -> Iterator[str]:
    with_section = [segment for segment in boom.segments if segment.section is not None]
    sections = [segment.section_at(x) for segment in with_section for x in segment.ends]
    walls = (plate.length for section in sections for plate in section.plates)
    narrowest = min(walls, default=np.inf)
    for model in select_kind(Shell, case.models):
        if model.mesh_size > narrowest:
            yield (
                f"the mesh size of {model.name!r}, {model.mesh_size:g} m, is larger than a wall of "
                f"{narrowest:.3g} m"
            )


def _sizes(case: Case, boom: Boom) -> Iterator[str]:
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
            f"a load of {largest:.4g} N is more than a hundred times the boom's weight of "
            f"{weight:.4g} N; check the units"
        )
    for number, load in enumerate(boom.loads[: len(case.loads)], start=1):
        segment = boom.segments[load.segment]
        force = abs(load.resultant(segment.length)) * getattr(load.history, "peak", 1.0)
        if 0.0 < force < MIN_LOAD * weight:
            yield (
                f"load[{number}]: {force:.4g} N is less than a thousandth of the boom's weight of "
                f"{weight:.4g} N; check the units"
            )
        own = STANDARD_GRAVITY * segment.mass_per_length * segment.length
        if type(load) is Load and load.x is None and force > MAX_LINE_LOAD * own:
            yield (
                f"load[{number}]: {load.magnitude:g} N/m along the whole of {segment.name!r} makes "
                f"{force:.4g} N, {force / own:.2g} times its weight; a force at one place needs x"
            )
        outer = next((one.outer for one in boom.joints if one.inner == load.segment), None)
        if outer is not None and load.x is not None and load.x < boom.segments[outer].end:
            yield (
                f"load[{number}].x: {load.x:g} m on {segment.name!r} lies "
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
    """Yield cautions on loads that repeat a load or weight, and on masses given as forces."""
    loads_of_case = boom.loads[: len(case.loads)]
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
        tip_masses = [one.mass for one in boom.segments[-1].masses if one.x > end]
        if sum(isclose(mass, payload.mass, rel_tol=SAME_LOAD) for mass in tip_masses) > 1:
            yield (
                f"segment[{len(boom.segments)}].masses: the {payload.mass:g} kg of the payload "
                "are repeated at the tip; leave one of them out"
            )
    for number, (table, load) in enumerate(zip(case.loads, loads_of_case, strict=True), start=1):
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
        same = [name for name, one in tip_weights(case).items() if one and weighs(force, one)]
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


def _axial_forces(case: Case, boom: Boom) -> Iterator[str]:
    """Yield cautions on axial forces with an unusual sign or size, and on repeated weights."""
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


def _missing_loads(case: Case, boom: Boom) -> Iterator[str]:
    """Yield a caution if no load or motion acts, or if only the payload has weight."""
    amounts = [load.magnitude for load in boom.loads]
    amounts += [one.load or (one.lateral.load if one.lateral else 0.0) for one in boom.segments]
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
