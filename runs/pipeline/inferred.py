# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of inferred data, before the motion: sections, lengths, contact laws, models."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain, islice, repeat

import numpy as np
from rich.console import Console

from dynamics.damping import pressed_ratios
from dynamics.failure import NUMERICS
from dynamics.motion import rest_of
from geometry.axial import carried, passed_over
from geometry.boom import Boom, Direction, Joint
from geometry.fit import room
from geometry.typography import TO_KILO, TO_MEGA
from runs.case import actions
from runs.case.declared import Declared
from runs.case.kinds.model import ModelTable
from runs.case.schema import Case, Model
from runs.case.units import System
from runs.pipeline.drives import drive_lines, slip_cautions, slip_lines, slippings
from runs.pipeline.estimates import Preview, of_preview
from runs.pipeline.proportions import of_buckling, slips
from runs.pipeline.statics import print_statics
from runs.report.tables import Table

# Number of modes whose damping is shown.
SHOWN_MODES = 3

# Distance from a jump of the force, as a part of the segment.
_BESIDE = 1.0e-9

# A damping ratio below this counts as zero.
_ROUND_OFF = 1.0e-12


def print_inferred(declared: Declared, console: Console) -> None:
    """Print the segments, joints and models of a checked case."""
    case, boom, preview = declared.case, declared.boom, Preview(declared)
    console.print(case.title, markup=False)
    _segments(case, boom).show(console)
    if (stiffeners := _stiffeners(boom, case.system)).rows:
        stiffeners.show(console)
    if boom.joints:
        _joints(case, boom).show(console)
    drives = list(slippings(case, boom))
    for line in (*drive_lines(boom, case.system), *slip_lines(drives, case.system)):
        console.print(line, markup=False, highlight=False)
    _models(case, boom).show(console)
    if boom.compressed:
        print_axial_forces(declared, console)
    if (ratios := _damping_ratios(preview)).rows:
        ratios.show(console)
    print_statics(case, boom, console)
    cautions = *slips(case, boom), *slip_cautions(drives, case.system)
    for line in (*actions.series_notes(case), *cautions):
        console.print(line, markup=False, highlight=False)
    console.print(f"A run may take {of_preview(preview)}.", highlight=False)


def _segments(case: Case, boom: Boom) -> Table:
    system = case.system
    headings = {"span": "m", "m": "kg/m", "J": "m^4", "I_p": "kg m"}
    shown = [f"{name} ({system.label(unit)})" for name, unit in headings.items()]
    rows = []
    for given, segment in zip(case.segments, boom.segments, strict=True):
        box = "unknown" if segment.section is None else str(segment.section)
        if segment.head_section is not None:
            box = f"{box} to {segment.head_section}"
        row = (
            segment.name,
            f"{system.of(segment.start, 'm'):g}–{system.of(segment.end, 'm'):g}",
            f"{system.of(segment.mass_per_length, 'kg/m'):.4g}",
            f"{system.of(segment.second_moment_of_area, 'm^4'):.4g}",
            f"{system.of(segment.rotary_inertia, 'kg m'):.3g}",
            box if given.section is not None or segment.section is None else f"{box}, inferred",
        )
        rows.append(row)
    return Table.of_rows("", "", ("segment", *shown, "box (mm)"), rows)


def _stiffeners(boom: Boom, system: System) -> Table:
    """Return the table of stiffeners of segments with known plates; others have no shell."""
    x, mass = f"x ({system.label('m')})", f"mass ({system.label('kg')})"
    rows = []
    for segment in boom.segments:
        box, density = segment.section, segment.material.density
        if box is None:
            continue
        for one in segment.collars:
            area = segment.mean_perimeter(one) * (one.end - one.start)
            place = f"{system.of(one.start, 'm'):g}–{system.of(one.end, 'm'):g}"
            row = _plate(one.thickness, density * area, system)
            rows.append(("collar", segment.name, place, *row))
        for plate in segment.diaphragms:
            per_thickness = density * segment.section_at(plate.x).enclosed_area
            row = _plate(plate.thickness, per_thickness, system)
            rows.append(("diaphragm", segment.name, f"{system.of(plate.x, 'm'):g}", *row))
    return Table.of_rows("", "", ("stiffener", "of", x, "t (mm)", mass), rows)


def _plate(thickness: float, mass_per_thickness: float, system: System) -> tuple[str, str]:
    mass = system.of(mass_per_thickness * thickness, "kg")
    return f"{1e3 * thickness:g}", f"{mass:.3g}"


def _joints(case: Case, boom: Boom) -> Table:
    system, m = case.system, case.system.label("m")
    lengths = f"overlap ({m})", f"stations ({m})"
    rows = []
    for joint in boom.joints:
        outer, inner = boom.segments[joint.outer], boom.segments[joint.inner]
        free = "unknown"
        if outer.section is not None and inner.section is not None:
            height, width = room(joint, outer, inner)
            free = f"{1e3 * height:.1f} high, {1e3 * width:.1f} wide"
        row = (
            f"{inner.name} in {outer.name}",
            f"{system.of(min(outer.end, inner.end) - max(outer.start, inner.start), 'm'):g}",
            ", ".join(f"{system.of(x, 'm'):g}" for x in joint.stations),
            "tied" if joint.tied else ", ".join(_clearances(joint)),
            free,
            _friction(joint),
        )
        rows.append(row)
    return Table.of_rows(
        "", "", ("joint", *lengths, "clearance (mm)", "free (mm)", "friction"), rows
    )


def _clearances(joint: Joint) -> Iterator[str]:
    """Yield the clearances of a joint in mm, along z, and in space along y."""
    sides: Mapping[Direction, tuple[str, str]] = {"z": ("above", "below"), "y": ("right", "left")}
    for direction, names in sides.items():
        if direction == "y" and joint.lateral_play is None:
            return
        both = [1e3 * clearance for clearance in joint.clearances(direction)]
        parts = [f"{one:g} {name}" for one, name in zip(both, names, strict=True)]
        alike = f"± {both[0]:g}" + (" to the sides" if direction == "y" else "")
        yield alike if both[0] == both[1] else ", ".join(parts)


def _friction(joint: Joint) -> str:
    if joint.friction == 0.0:
        return "none"
    forces = ", ".join(f"{force:g}" for force in joint.normal_forces)
    return f"{joint.friction:g}, pressed by {f'{forces} N' if forces else 'the contacts'}"


def _models(case: Case, boom: Boom) -> Table:
    rows = []
    for model in case.models:
        laws = {str(joint.contact) for joint in model.joined(boom).boom.joints}
        contact = "tied" if model.play_free else "; ".join(sorted(laws))
        rows.append((model.name, model.kind, model.describe(), contact))
    return Table.of_rows("", "", ("model", "kind", "", "contact (k in N/mⁿ)"), rows)


def print_axial_forces(declared: Declared, console: Console) -> None:
    """Print the largest axial force of each segment, and the buckling factor of each model."""
    rows = []
    for number, segment in enumerate(declared.boom.segments):
        force, stress = _hardest(declared.boom, number)
        told = "unknown" if stress is None else f"{stress * TO_MEGA:.4g}"
        rows.append((segment.name, f"{force * TO_KILO:.4g}", told))
    Table.of_rows(
        "", "", ("axial force, pressing", "largest (kN)", "over the plain area (MPa)"), rows
    ).show(console)
    factors = []
    cautions: list[str] = []
    for model in declared.case.models:
        # A shell would have to be computed first.
        name = f"{model.name}, as beam elements" if model.needs_shell else model.name
        factor = model.coarsened(declared.boom).critical_factor(declared.joined(model))
        cautions += of_buckling(name, factor)
        row = "unknown", "unknown"
        if factor is not None:
            row = f"{factor:.4g}", f"{100.0 / factor:.3g} %"
        factors.append((name, *row))
    Table.of_rows(
        "", "", ("joints pressed", "buckling factor", "of the critical forces"), factors
    ).show(console)
    for caution in cautions:
        console.print(caution, markup=False)


def _hardest(boom: Boom, number: int) -> tuple[float, float | None]:
    """Return the extreme axial force of a segment in N and stress in Pa, over all extensions."""
    segment = boom.segments[number]
    jumps = {*segment.compression.places, *passed_over(boom.segments, boom.joints, number)}
    ends = [x + side * _BESIDE * segment.length for x in jumps for side in (-1.0, 1.0)]
    x = np.unique(np.clip([*ends, segment.start, segment.end], segment.start, segment.end))
    times = [joint.drive.times for joint in boom.joints if joint.drive is not None]
    time = np.unique(np.concatenate([np.zeros(1), *times]))
    forces = carried(boom.segments, boom.joints, number, x, time)
    largest = float(forces.flat[np.abs(forces).argmax()])
    if segment.section is None:
        return largest, None
    stresses = forces / [segment.section_at(at).area for at in x]
    return largest, float(stresses.flat[np.abs(stresses).argmax()])


def _damping_ratios(preview: Preview) -> Table:
    """Return the total damping ratios of the first modes of each model, with closed contacts."""
    case, boom = preview.declared.case, preview.declared.boom
    shapes = [f"mode {number}" for number in range(1, SHOWN_MODES + 1)]
    rows = []
    given = [*case.damping.model_dump().values(), *(s.viscous_damping for s in boom.segments)]
    given += [joint.dashpot for joint in boom.joints]
    given += [cylinder.dashpot for cylinder in boom.cylinders]
    given += [support.dashpot for segment in boom.segments for support in segment.supports]
    for model in case.models if any(given) else ():
        # A shell would have to be computed first.
        beam = model.stand_in(boom).beam if model.needs_shell else model.coarsened(boom)
        name = f"{model.name}, as beam elements" if model.needs_shell else model.name
        # Some booms have fewer modes.
        ratios = chain(_ratios(preview, model, beam), repeat(""))
        rows.append((name, *islice(ratios, SHOWN_MODES)))
    return Table.of_rows("", "", ("damping, joints pressed", *shapes), rows)


def _ratios(preview: Preview, model: Model, beam: ModelTable) -> list[str]:
    try:
        with np.errstate(all="ignore"):
            motion = preview.motion(model, beam)
            rest = rest_of(motion.system, preview.declared.case.start.at_rest, motion.position)
            found = pressed_ratios(motion.system, rest)
    except NUMERICS:
        return ["cannot be computed"]
    # The dashpot between open stations leaves only round-off.
    both = (
        (hertz, ratio if ratio > _ROUND_OFF else 0.0) for hertz, ratio in zip(*found, strict=True)
    )
    return [f"{100.0 * ratio:.3g} % at {hertz:.3g} Hz" for hertz, ratio in both]
