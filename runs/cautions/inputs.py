# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rules on inputs except loads: unusual, useless, forgotten, and swapped ones."""

from __future__ import annotations

from collections.abc import Iterator
from math import isclose

import numpy as np

from protractile.geometry.box import BoxSection
from protractile.geometry.fit import room
from protractile.geometry.joint import SIDES
from protractile.geometry.segment import SAME_PLACE
from protractile.geometry.typography import TO_MILLI
from protractile.runs.case.actions import STANDARD_GRAVITY
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.sanity import materials, usual_ranges
from protractile.runs.cautions.context import Context, Sentence

# Angle in degrees up to which a boom is horizontal.
LEVEL_ANGLE = 0.1
# Young's modulus in Pa and density in kg/m³. A modulus within 6 % reveals the material. The density
# may be larger, since it may include other masses, but not twice as large.
MATERIALS = {"steel": (2.1e11, 7850.0), "aluminium": (7.0e10, 2700.0)}
SAME_MODULUS, LEAST_DENSITY, MOST_DENSITY = 0.06, 0.9, 2.0
# Fraction of the peak of a ground acceleration up to which it has ended.
ENDED = 0.01
# Ratio of the thicknesses of flange and web of a box below which they are probably swapped.
THIN_FLANGE = 0.85


def unusual_numbers(context: Context) -> Iterator[str]:
    """Yield a caution for each number outside its usual range."""
    for usual in usual_ranges(context.case, context.boom):
        if usual.unusual:
            yield f"{usual.key}: {usual.text(context.case.system)}"


def ineffective_inputs(context: Context) -> Iterator[str]:
    """Yield cautions on inputs that are missing or have less effect than the user may intend."""
    case, duration = context.case, context.case.time.duration
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
    if case.cylinders and case.gravity and "angle" not in case.gravity.model_fields_set:
        yield (
            "gravity.angle: missing, so that the boom on its cylinder is horizontal; give the "
            "luffing angle in degrees, 0 if it is"
        )


def densities(context: Context) -> Iterator[str]:
    """Yield a caution for each material whose density does not match its Young's modulus."""
    for where, table in materials(context.case).items():
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


def table_ends(context: Context) -> Iterator[str]:
    """Yield cautions on tables whose last pair acts where it is unsafe."""
    case, boom = context.case, context.boom
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


def cylinders(context: Context) -> Iterator[str]:
    """Yield cautions on cylinders that hold a sliding segment, or are at an unusual place."""
    boom = context.boom
    for number, cylinder in enumerate(boom.cylinders, start=1):
        segment = boom.segments[cylinder.segment]
        foot = segment.foot
        # A cylinder above the boom holds it by pulling at a lug above the axis.
        if cylinder.depth < 0.0 and not (foot and cylinder.arm(foot) < 0.0):
            yield (
                f"cylinder[{number}].depth: {cylinder.depth:g} m puts the lug above the axis of "
                f"{segment.name!r}; usual is below, where depths are positive"
            )
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


def nesting(context: Context) -> Iterator[str]:
    """Yield a caution for each outer segment that holds more than one inner segment."""
    held: dict[str, str] = {}
    for number, joint in enumerate(context.case.joints, start=1):
        outer, inner = str(joint.outer), str(joint.inner)
        if outer in held:
            yield (
                f"joint[{number}].outer: {outer!r} holds {held[outer]!r} already; usual is one "
                "segment in another"
            )
        held[outer] = inner


def thick_pads(context: Context) -> Iterator[str]:
    """Yield a caution for each joint whose pads on both sides and play need more than its gap."""
    boom = context.boom
    for number, joint in enumerate(boom.joints, start=1):
        outer, inner = boom.segments[joint.outer], boom.segments[joint.inner]
        if outer.section is None or inner.section is None:
            continue
        gaps = zip(boom.directions, room(joint, outer, inner), strict=False)
        for direction, gap in gaps:
            thickest = {
                name: max(pad.thickness or 0.0 for pad, *_ in joint.pads_of(way, side) if pad)
                for name, (way, side) in SIDES.items()
                if way == direction and joint.padded
            }
            play = (joint.play if direction == "z" else joint.lateral_play) or 0.0
            need = sum(thickest.values()) + play
            if any(thickest.values()) and need > gap + SAME_PLACE * outer.length:
                pads = " and ".join(
                    f"{TO_MILLI * thickness:.4g} mm {name}" for name, thickness in thickest.items()
                )
                yield (
                    f"joint[{number}].{'pad.thickness' if joint.pad else 'pads'}: pads of {pads} "
                    f"and the play of {TO_MILLI * play:.4g} mm need {TO_MILLI * need:.4g} mm, and "
                    f"between {outer.name!r} and {inner.name!r} are {TO_MILLI * gap:.4g} mm, both "
                    "sides together; give thinner pads, or check the sections"
                )


def compliant_contacts(context: Context) -> Iterator[str]:
    """Yield a caution for each contact that is more compliant than its inner segment in bending."""
    case, boom = context.case, context.boom
    for model in (model for model in case.models if not model.bonded):
        for joint in model.model_boom(boom).boom.joints:
            inner = boom.segments[joint.inner]
            bending = 3.0 * inner.bending_stiffness / inner.length**3
            force = 0.5 * STANDARD_GRAVITY * inner.mass
            stiffness = joint.law("z").slope_at(force)
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


def mesh_sizes(context: Context) -> Iterator[str]:
    """Yield a caution for each shell whose mesh is coarser than a wall."""
    case, boom = context.case, context.boom
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


def swapped_thicknesses(context: Context) -> Iterator[str]:
    """Yield a caution for each box whose flanges are thinner than its webs."""
    for number, segment in enumerate(context.boom.segments, start=1):
        section, table = segment.section, context.case.segments[number - 1]
        if not isinstance(section, BoxSection) or table.section is None:
            continue
        if section.flange < THIN_FLANGE * section.web:
            system = context.case.system
            flange, web = (
                system.text(thickness, "m") for thickness in (section.flange, section.web)
            )
            yield (
                f"segment[{number}].section: the flanges of {flange} are thinner than the webs of "
                f"{web}; usual is the contrary: check whether they are swapped"
            )


def series(context: Context) -> Iterator[str]:
    """Yield a note on each tabulated history that is shorter or longer than the run."""
    case, duration = context.case, context.case.time.duration
    tables = {f"load[{i}]": load.table for i, load in enumerate(case.loads, start=1)}
    tables |= {f"base[{i}]": base.table for i, base in enumerate(case.base, start=1)}
    for key, table in tables.items():
        if table is None:
            continue
        (first, first_value), (last, last_value) = table[0], table[-1]
        remarks = [
            *([f"its first value, {first_value:g}, is held before"] if first > 0.0 else []),
            *(["what is before t = 0 is left out"] if first < 0.0 else []),
            *([f"its last value, {last_value:g}, is held afterwards"] if last < duration else []),
            *(["what comes after the run is left out"] if last > duration else []),
        ]
        if remarks:
            lasts = f"lasts from {first:g} to {last:g} s, the run {duration:g} s"
            yield Sentence(f"note: the series of {key} {lasts}: {'; '.join(remarks)}")
