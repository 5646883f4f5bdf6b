# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of the parts of a boom: segments, stiffeners, joints and masses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

from protractile.analysis.rows import Row
from protractile.geometry.boom import Boom, Direction, Joint
from protractile.geometry.fit import room
from protractile.geometry.section import Section
from protractile.geometry.units import System
from protractile.geometry.walls import outer_surfaces
from protractile.runs.case.schema import Case
from protractile.runs.report.tables import Cell, Column, Table


def segment_table(case: Case, boom: Boom) -> Table:
    """Return the table of positions, masses and sections of segments, in the case's units."""
    column, segments, boxes = partial(column_in_units, case.system), boom.segments, []
    axes = []
    for table, segment in zip(case.segments, segments, strict=True):
        box = "unknown" if segment.section is None else _size(segment.section)
        if segment.head_section is not None:
            box += f" to\n{_size(segment.head_section)}"
        inferred = table.section is None and segment.section is not None
        boxes.append(f"{box}, inferred" if inferred else box)
        ends = [each for each in (segment.section, segment.head_section) if each is not None]
        if any("z" not in each.mirrors for each in ends):
            heights = " to ".join(case.system.text(-outer_surfaces(one)[0], "m") for one in ends)
            axes.append(f"{segment.name} {heights}")
    columns = [
        Column("segment", [segment.name for segment in segments]),
        Column(f"x\n{case.system.label('m')}", [_span(case.system, one.ends) for one in segments]),
        Column("mass\nkg/m", [segment.mass_per_length for segment in segments], ".4g"),
        column("I_y", "m^4", [segment.second_moment_of_area for segment in segments]),
        Column("rotary inertia\nper length\nkg m", [one.rotary_inertia for one in segments], ".3g"),
        Column("h × b of\nmid-lines, t of\nflange / web, mm", boxes),
    ]
    above = "Height of the axis, through the centroid, above the outer surface of the bottom: "
    return Table("Segments", columns, [f"{above}{', '.join(axes)}."] if axes else [])


def stiffener_table(boom: Boom, system: System) -> Table:
    """Return the table of stiffeners, for segments with sections."""
    rows: list[tuple[Cell, ...]] = []
    for segment in boom.segments:
        parts = [("diaphragm", plate.thickness) for plate in segment.diaphragms]
        parts += [(", ".join(("collar", *one.walls)), one.thickness) for one in segment.collars]
        for (name, thickness), (ends, mass) in zip(parts, segment.stiffeners, strict=False):
            rows.append((name, segment.name, _span(system, ends), thickness, mass))
    columns = ("thickness", ".3g", "mm"), ("mass", ".3g", "kg")
    headings = ("stiffener", "segment", f"x\n{system.label('m')}", *columns)
    return Table.of_rows("", "Stiffeners", headings, rows)


def joint_table(case: Case, boom: Boom) -> Table:
    """Return the table of overlaps, stations, clearances and friction of joints."""
    system, m = case.system, case.system.label("m")
    rows = []
    for joint in boom.joints:
        outer, inner = boom.segments[joint.outer], boom.segments[joint.inner]
        free = "unknown"
        if outer.section is not None and inner.section is not None:
            height, width = room(joint, outer, inner)
            free = f"{1e3 * height:.1f} in height\n{1e3 * width:.1f} in width"
        cells = (
            f"{inner.name} in {outer.name}",
            f"{system.of(min(outer.end, inner.end) - max(outer.start, inner.start), 'm'):g}",
            ", ".join(f"{system.of(x, 'm'):g}" for x in joint.stations),
            "bonded" if joint.bonded else "\n".join(_clearances(joint)),
            free,
            _friction(joint),
        )
        rows.append(cells)
    sizes = f"overlap\n{m}", f"stations\n{m}", "clearance\nmm", "gap without pads\nmm"
    headings = ("joint", *sizes, "friction")
    inside = "A pad at the end of the overlap has its centre half a pad length inside the overlap."
    notes = [inside] if any(joint.padded for joint in boom.joints) else []
    return Table.of_rows("", "Joints", headings, rows, notes)


def mass_table(boom: Boom, system: System) -> Table:
    """Return the table of masses of each segment with its attachments, and their sum."""
    segments = boom.segments
    plain_masses = [segment.mass_per_length * segment.length for segment in segments]
    masses = [segment.mass for segment in segments]
    moments = [segment.mass_moment for segment in segments]
    whole, moment = sum(masses), sum(moments)
    centres = [moment / mass for moment, mass in zip(moments, masses, strict=True)]
    attached = [mass - part for mass, part in zip(masses, plain_masses, strict=True)]
    columns = [
        Column("segment", [*(segment.name for segment in segments), "all"]),
        Column("own mass", [*plain_masses, sum(plain_masses)], ".4g", "kg"),
        Column("attached mass", [*attached, whole - sum(plain_masses)], ".4g", "kg"),
        column_in_units(system, "centre of mass x", "m", [*centres, moment / whole]),
    ]
    return Table("Masses", columns)


def column_in_units(
    system: System, title: str, si: str, values: Sequence[float], form: str = ".4g"
) -> Column:
    """Return a column in the units of the case, from values in the SI unit ``si``."""
    return Column(f"{title}\n{system.label(si)}", [system.of(value, si) for value in values], form)


def _span(system: System, ends: tuple[float, float]) -> str:
    return "–".join(f"{system.of(x, 'm'):g}" for x in dict.fromkeys(ends))


def _size(section: Section) -> str:
    """Return lines of text: height and width of a section, its plate thicknesses, and its bends."""
    size, plates = str(section).replace(", R ", "\nR ").rsplit(" x ", 1)
    return f"{size.replace(' x ', ' × ')}\nt {plates}"


def _clearances(joint: Joint) -> Iterator[str]:
    """Yield texts of the clearances of a joint in mm, along z, and in 3-D booms also along y."""
    sides: Mapping[Direction, tuple[str, str]] = {"z": ("above", "below"), "y": ("right", "left")}
    for direction, names in sides.items():
        if direction == "y" and joint.lateral_play is None:
            return
        both = [1e3 * clearance for clearance in joint.clearances(direction)]
        parts = [f"{number:g} {name}" for number, name in zip(both, names, strict=True)]
        text = ("lateral " if direction == "y" else "") + f"± {both[0]:g}"
        yield text if both[0] == both[1] else ", ".join(parts)


def _friction(joint: Joint) -> str:
    if joint.friction == 0.0:
        return "none"
    forces = ", ".join(f"{force:g}" for force in joint.normal_forces) + " N"
    return (
        f"{joint.friction:g}, normal force {forces if any(joint.normal_forces) else 'of contacts'}"
    )


def panel_table(weakest: Sequence[Row], system: System) -> Table:
    """Return the table of the plate of each segment that buckles first by panel formulas."""
    columns = "segment", "wall", f"x\n{system.label('m')}", ("buckling factor", ".3g")
    rows = [
        (row.part, row.place, f"{system.of(row.x or 0.0, 'm'):.6g}", row.value) for row in weakest
    ]
    note = (
        "Static state under the maximum loads. Walls are long panels on simple supports, with "
        "k = 4 in compression, 23.9 in bending, 5.34 in shear, and their interaction; pad forces "
        "are neglected."
    )
    return Table.of_rows("", "Buckling of walls, estimate", columns, rows, [note])
