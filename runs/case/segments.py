# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments of a case: beam properties, and sections that are given or inferred."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from protractile.geometry.boom import BoomError, Joint, Lateral, Material, PointMass, Segment
from protractile.geometry.box import infer_inner_section, infer_outer_section
from protractile.geometry.fields import describe
from protractile.geometry.place import at
from protractile.geometry.section import Section, SectionError
from protractile.geometry.taper import check_alike, mean_area, middle_section
from protractile.runs.case.actions import segment_index
from protractile.runs.case.schema import Case
from protractile.runs.case.sections import SegmentTable

# Permitted relative difference between the beam properties of a case and those of its plates: data
# sheets give rounded numbers.
SECTION_TOLERANCE = 0.01


def segment_of(
    case: Case, index: int, section: Section | None, ends: tuple[float, float]
) -> Segment:
    """Return a segment with its section, between the ``ends`` x in m."""
    table = case.segments[index]
    material = material_of(case, index)
    mass, second_moment = _beam_properties(case, index)
    rotary, head = table.rotary_inertia, _head_section(table, index)
    payload: tuple[PointMass, ...] = ()
    if index == len(case.segments) - 1:
        carried = (case.payload.mass if case.payload else 0.0, case.head.mass if case.head else 0.0)
        payload = tuple(PointMass(ends[1], mass) for mass in carried if mass)
    return Segment(
        name=table.name,
        start=ends[0],
        end=ends[1],
        material=material,
        mass_per_length=mass + table.added_mass_per_length,
        second_moment_of_area=second_moment,
        rotary_inertia=material.density * second_moment if rotary is None else rotary,
        section=section,
        head_section=head,
        load=table.load,
        supports=table.supports,
        viscous_damping=table.viscous_damping,
        masses=table.masses + payload,
        lateral=_lateral(table, material, section and middle_section(section, head))
        if case.spatial
        else None,
        collars=table.collars,
        diaphragms=table.diaphragms,
        yield_strengths=tuple(table.yield_strengths.items()),
        added_mass_per_length=table.added_mass_per_length,
    )


def pinned_masses(case: Case, segments: Sequence[Segment]) -> Iterator[tuple[int, PointMass]]:
    """Yield the share of each pin of a mass inside the boom, with the index of its segment.

    The shares are those of a beam on two supports. Statically they are exact for weights across the
    boom; a motion has no inertia of the mass about its own centre.

    Raises:
        BoomError: a segment is unknown, or a pin or the centre is out of place.
    """
    for number, table in enumerate(case.pinned_masses, start=1):
        places = []
        for i, pin in enumerate(table.pins, start=1):
            where = f"pinned_mass[{number}].pins[{i}]"
            index = segment_index(f"{where}.segment", pin.segment, segments)
            places.append((index, at(pin.x, *segments[index].ends)))
            segments[index].check_place(f"{where}.x", places[-1][1])
        part, length = 0.5, abs(places[1][1] - places[0][1])
        if table.centre is not None:
            if table.centre > length:
                what = f"must not be above {length:g} m, the distance of the pins"
                raise BoomError(f"pinned_mass[{number}].centre", f"{what}, got {table.centre:g} m")
            part = table.centre / (length or 1.0)
        for (index, x), share in zip(places, (1.0 - part, part), strict=True):
            if share:
                yield index, PointMass(x, share * table.mass)


def material_of(case: Case, index: int) -> Material:
    """Return the material of a segment: its own, or the material of the case."""
    table = case.segments[index].material or case.material
    if table is None:
        raise BoomError(
            "material",
            f"missing, and {case.segments[index].name!r} has none of its own; it is "
            f"{describe(Case, 'material')}",
        )
    return table


def _lateral(table: SegmentTable, material: Material, section: Section | None) -> Lateral | None:
    """Return the lateral bending and torsion data of a segment; None if they are incomplete."""
    second_moment, torsion = table.lateral_second_moment_of_area, table.torsion_constant
    polar = table.polar_inertia
    if section is not None:
        second_moment = second_moment or section.lateral_second_moment_of_area
        torsion = torsion or section.torsion_constant
        polar = polar or material.density * section.polar_second_moment_of_area
    if second_moment is None or torsion is None or polar is None:
        return None
    rotary = table.lateral_rotary_inertia
    return Lateral(
        second_moment_of_area=second_moment,
        rotary_inertia=material.density * second_moment if rotary is None else rotary,
        torsion_constant=torsion,
        polar_inertia=polar,
        load=table.lateral_load,
    )


def _beam_properties(case: Case, index: int) -> tuple[float, float]:
    """Return the mass per length in kg/m and the second moment of area in m⁴ of a segment."""
    table = case.segments[index]
    section, head = _section_of_table(table, index), _head_section(table, index)
    mass, second_moment = table.mass_per_length, table.second_moment_of_area
    if section is not None:
        _check_plates(case, index, section)
        mass = mass or material_of(case, index).density * mean_area(section, head)
        second_moment = second_moment or middle_section(section, head).second_moment_of_area
    if mass is None:
        raise _missing_key_error(index, "mass_per_length")
    if second_moment is None:
        raise _missing_key_error(index, "second_moment_of_area")
    return mass, second_moment


def _check_plates(case: Case, index: int, section: Section) -> None:
    """Check that a section is defined once, and fits the mass and second moment of the case."""
    table = case.segments[index]
    where = f"segment[{index + 1}]"
    if table.height_to_width is not None:
        raise BoomError(f"{where}.height_to_width", "the section is given; leave one of them out")
    if not case.first_shell:
        return
    density = material_of(case, index).density
    for key, case_value, plate_value in (
        ("mass_per_length", table.mass_per_length, section.mass_per_length(density)),
        ("second_moment_of_area", table.second_moment_of_area, section.second_moment_of_area),
    ):
        if case_value is not None and abs(case_value / plate_value - 1.0) > SECTION_TOLERANCE:
            raise BoomError(
                f"{where}.{key}",
                f"{case_value:g} is not the section's own {plate_value:.6g}, and beams and shell "
                "would be different booms; leave it out, or change the section",
            )


def _missing_key_error(index: int, key: str) -> BoomError:
    what = f"missing; it is {describe(SegmentTable, key)}"
    return BoomError(f"segment[{index + 1}].{key}", what)


def _section_of_table(table: SegmentTable, index: int) -> Section | None:
    if table.section is None:
        return None
    try:
        return table.section.section()
    except SectionError as error:
        raise BoomError(f"segment[{index + 1}].section", str(error)) from None


def _head_section(table: SegmentTable, index: int) -> Section | None:
    if table.head_section is None:
        return None
    where, tail = f"segment[{index + 1}]", _section_of_table(table, index)
    if tail is None:
        raise BoomError(f"{where}.section", "missing; a segment with a head_section tapers from it")
    for key in _SECTION_PROPERTIES:
        if getattr(table, key) is not None:
            raise BoomError(
                f"{where}.{key}",
                "of a segment that tapers it follows from the sections; leave it out",
            )
    try:
        head = table.head_section.section()
        check_alike(tail, head)
    except SectionError as error:
        raise BoomError(f"{where}.head_section", str(error)) from None
    return head


# Keys that a tapered segment must not have, since its sections determine these properties.
_SECTION_PROPERTIES = (
    "mass_per_length", "second_moment_of_area", "rotary_inertia", "lateral_second_moment_of_area",
    "lateral_rotary_inertia", "torsion_constant", "polar_inertia",
)  # fmt: skip


def infer_sections(case: Case, joints: Sequence[Joint]) -> list[Section | None]:
    """Return the section of each segment, given or inferred; None if it is unknown."""
    sections = [_section_of_table(table, i) for i, table in enumerate(case.segments)]
    for i, table in enumerate(case.segments):
        if sections[i] is None and table.height_to_width is not None:
            sections[i] = _infer_section(case, i, infer_outer_section, table.height_to_width)
    # One pass per joint reaches every inner segment, whatever the order of the joints.
    for joint in [*joints] * len(joints):
        outer, table = sections[joint.outer], case.segments[joint.outer]
        if sections[joint.inner] is None and outer is not None:
            if table.head_section is not None:
                raise BoomError(
                    f"segment[{joint.inner + 1}].section",
                    f"missing, and none is inferred within {table.name!r}, which tapers; give it",
                )
            hint = outer, 0.5 * joint.play
            sections[joint.inner] = _infer_section(case, joint.inner, infer_inner_section, *hint)
    return sections


def _infer_section(
    case: Case, index: int, infer: Callable[..., Section], *hint: Any
) -> Section | None:
    """Return the section of a segment by a function of area and second moment; None if none exists.

    Raises:
        BoomError: no section exists, and a model needs it.
    """
    mass, second_moment = _beam_properties(case, index)
    area = mass / material_of(case, index).density
    try:
        return infer(area, second_moment, *hint)
    except SectionError as error:
        if any(model.needs_plates for model in case.models):
            raise BoomError(f"segment[{index + 1}].section", str(error)) from None
        return None
