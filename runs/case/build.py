# SPDX-License-Identifier: LGPL-3.0-or-later
"""Construction of the boom and its contact laws from a case."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import radians
from typing import Any

from protractile.dynamics.energy import DRIVEN_ENERGIES
from protractile.dynamics.excitation import InitialImpulse, ReleasedLoad
from protractile.dynamics.stick_slip import ELASTIC_DRIVE_VARIABLES
from protractile.dynamics.trajectory import DRIVE_VARIABLES, STATION_VARIABLES
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, BoomError, Joint, Lateral, Material, PointMass, Segment
from protractile.geometry.boom_checks import check_order
from protractile.geometry.cylinder import Cylinder, EarthPoint
from protractile.geometry.fields import describe, resolve_distances
from protractile.geometry.joint import BareJoint
from protractile.geometry.section import (
    Section,
    SectionError,
    infer_inner_section,
    infer_outer_section,
)
from protractile.geometry.support import Support
from protractile.geometry.support_check import check_contacts_at_rest
from protractile.geometry.taper import check_alike, mean_area, middle_section
from protractile.runs.case import actions, motions
from protractile.runs.case.actions import field_values
from protractile.runs.case.contact import JointTable
from protractile.runs.case.schema import Case
from protractile.runs.case.sections import SegmentTable

# Permitted relative difference between the beam properties of a case and those of its plates: data
# sheets give rounded numbers.
SECTION_TOLERANCE = 0.01


def build_boom(case: Case) -> Boom:
    """Return the boom of a case. Sections that the case does not give are inferred.

    Raises:
        BoomError: the boom is invalid.
    """
    check_names("segment", [segment.name for segment in case.segments])
    _check_joint_segments(case)
    _check_observations(case)
    ends = _spans(case.segments, case.joints)
    joints = tuple(_joint(case, number, ends) for number in range(len(case.joints)))
    sections = _sections(case, joints)
    segments = tuple(
        _segment(case, number, section, ends[number]) for number, section in enumerate(sections)
    )
    along = 0.0 if case.gravity is None else case.gravity.along
    hoist = case.hoist
    hanging = hoist.mass if hoist and hoist.hanging else 0.0
    rope = Thrust(len(segments) - 1, segments[-1].end, hanging * along)
    thrusts = (*actions.thrusts(case, segments), rope)
    segments = with_compression(segments, joints, thrusts, along)
    motions.check_turning(case)
    motions.check_hoist(case)
    _check_planar(case)
    frame = motions.frame_motion(case, segments)
    boom = Boom(
        segments,
        joints,
        (*actions.loads(case, segments), *motions.turning_loads(frame, segments, joints)),
        tuple(actions.stops(case)),
        case.observe,
        _cylinders(case),
        (
            *motions.hoist_changes(case, segments, joints),
            *motions.turning_changes(
                frame, segments, joints, 0.0 if hoist and hoist.dropped else hanging
            ),
        ),
    )
    check_contacts_at_rest(boom)
    motions.check_elastic_drives(case, boom)
    return boom


def hold_ground(changed: Case, original: Case) -> Case:
    """Return a changed case whose cylinders stand where they stand in the original case.

    If the luffing angle is changed, the ground of cylinders in the axes of the boom, which holds at
    the original angle, is given in earth axes.
    """
    if changed.gravity is None or original.gravity is None:
        return changed
    foot, angle = _foot(changed), original.gravity.angle
    if foot is None or changed.gravity.angle == angle or not changed.cylinders:
        return changed
    on_earth = tuple(one.on_earth(radians(angle), foot) for one in changed.cylinders)
    return changed.model_copy(update={"cylinders": on_earth})


def _cylinders(case: Case) -> tuple[Cylinder, ...]:
    """Return the cylinders with their ground in the axes of the boom."""
    angle = radians(0.0 if case.gravity is None else case.gravity.angle)
    foot = _foot(case)
    for number, one in enumerate(case.cylinders, start=1):
        if foot is None and isinstance(one.ground, EarthPoint):
            what = "no segment has a support, from whose pin front and below are measured; give one"
            raise BoomError(f"cylinder[{number}].ground", what)
    if foot is None:
        return case.cylinders
    return tuple(one.in_boom_axes(angle, foot) for one in case.cylinders)


def _foot(case: Case) -> Support | None:
    """Return the foot of the first segment that has one, about whose pin the boom luffs."""
    for table, ends in zip(case.segments, _spans(case.segments, case.joints), strict=True):
        if table.supports:
            supports = [resolve_distances(one, *ends) for one in table.supports]
            return min(supports, key=lambda support: support.x)
    return None


def check_ensemble_data(case: Case, boom: Boom) -> None:
    """Check that the case has the load or the play that its ensemble varies.

    Raises:
        BoomError: the load or the play is missing.
    """
    if case.ensemble is None or all(model.bonded for model in case.models):
        return
    if case.ensemble.vary == "load":
        initial = ReleasedLoad | InitialImpulse
        amounts = [load.magnitude for load in boom.loads if not isinstance(load.history, initial)]
        for segment in boom.segments:
            amounts += [segment.load, segment.lateral.load if segment.lateral else 0.0]
        missing, other = "no load acts from t = 0 on", "clearance"
    else:
        amounts = [joint.play for joint in boom.joints] + [stop.play for stop in boom.stops]
        missing, other = "there is no play", "load"
    if not any(amounts):
        raise BoomError(
            "ensemble.vary",
            f"{missing}, of which members change a part; give vary = {other!r}, or leave the "
            "ensemble out",
        )


def _check_observations(case: Case) -> None:
    check_names("observe", [table.name for table in case.observe])
    taken = {"time", "station", "direction", "place", "model", *STATION_VARIABLES, *DRIVEN_ENERGIES}
    taken |= {
        name + suffix
        for suffix in case.driven_segments
        for name in (*DRIVE_VARIABLES, *ELASTIC_DRIVE_VARIABLES)
    }
    for number, table in enumerate(case.observe, start=1):
        if table.name in taken:
            raise BoomError(
                f"observe[{number}].name",
                f"{table.name!r} is the name of another output already; give it its own",
            )


def check_names(where: str, names: Sequence[str]) -> None:
    """Check that names are unique.

    Raises:
        BoomError: a name occurs twice.
    """
    for number, name in enumerate(names, start=1):
        if (first := names.index(name) + 1) < number:
            raise BoomError(
                f"{where}[{number}].name",
                f"{name!r} is the name of {where}[{first}] already; give each its own",
            )


def _check_joint_segments(case: Case) -> None:
    """Check that each joint connects two segments, and that no two joints connect the same pair."""
    names = [segment.name for segment in case.segments]
    for index, table in enumerate(case.joints):
        where = f"joint[{index + 1}]"
        for end in ("outer", "inner"):
            actions.segment_index(f"{where}.{end}", getattr(table, end), case.segments)
        if table.outer == table.inner:
            raise BoomError(f"{where}.inner", "must be another segment than the outer one")
        for number, other in enumerate(case.joints[:index], start=1):
            if {other.outer, other.inner} == {table.outer, table.inner}:
                raise BoomError(
                    where,
                    f"{table.outer!r} and {table.inner!r} are joined by joint[{number}] already; "
                    "give all their stations there",
                )
        check_order(where, table.outer, table.inner, names)


def _joint(case: Case, index: int, ends: Sequence[tuple[float, float]]) -> Joint:
    table = case.joints[index]
    names = [segment.name for segment in case.segments]
    outer, inner = names.index(table.outer), names.index(table.inner)
    (_, head), (tail, _) = ends[outer], ends[inner]
    if table.bonded and table.friction > 0.0:
        raise BoomError(
            f"joint[{index + 1}].friction", "the joint is bonded, and nothing slides; leave it out"
        )
    _check_plays(f"joint[{index + 1}]", table)
    forces = table.normal_forces
    if table.drive is not None and table.friction > 0.0 and not case.spatial:
        # Friction follows from the contact forces of each station, without given normal forces.
        forces = forces or (0.0,) * len(table.stations)
    changed = {"outer": outer, "inner": inner, "normal_forces": forces}
    joint = Joint(
        **field_values(table, BareJoint) | changed,
        contact=table.law("z"),
        lateral_contact=None if table.lateral_play is None else table.law("y"),
        drive=table.moving_drive(f"joint[{index + 1}]", tail),
    )
    return resolve_distances(joint, tail, head)


def _check_plays(where: str, table: JointTable) -> None:
    """Check that play on one side is at most the whole play, and that shims leave no play."""
    for key, whole, shims in (
        ("play_above", "play", "interference"),
        ("lateral_play_right", "lateral_play", "lateral_interference"),
    ):
        part, play = getattr(table, key), getattr(table, whole)
        if part is not None and not part <= (play or 0.0):
            raise BoomError(f"{where}.{key}", f"must be a part of {whole}, got {part:g} m")
        if getattr(table, shims) > 0.0 and play != 0.0:
            raise BoomError(f"{where}.{shims}", f"shims leave no play; give {whole} = 0")


def _segment(case: Case, index: int, section: Section | None, ends: tuple[float, float]) -> Segment:
    table = case.segments[index]
    material = material_of(case, index)
    mass, second_moment = _beam_properties(case, index)
    rotary, head = table.rotary_inertia, _head_section(table, index)
    payload: tuple[PointMass, ...] = ()
    if case.payload is not None and index == len(case.segments) - 1:
        payload = (PointMass(ends[1], case.payload.mass),)
    return Segment(
        name=table.name,
        start=ends[0],
        end=ends[1],
        material=material,
        mass_per_length=mass,
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
    )


def material_of(case: Case, index: int) -> Material:
    """Return the material of a segment: its own, or the material of the case."""
    table = case.segments[index].material or case.material
    if table is None:
        raise BoomError(
            "material",
            f"missing, and {case.segments[index].name!r} has none of its own; it is "
            f"{describe(Case.model_fields['material'])}",
        )
    return table


def _check_planar(case: Case) -> None:
    """Check that a planar boom has no lateral actions."""
    winds = () if case.hoist is None else case.hoist.wind
    lateral_actions = {
        "slew": case.slew,
        "limits.tip_lateral": case.limits and case.limits.tip_lateral,
        **{
            f"segment[{i}].lateral_load": one.lateral_load for i, one in enumerate(case.segments, 1)
        },
        **{f"base[{i}].direction": one.direction == "y" for i, one in enumerate(case.base, 1)},
        **{f"hoist.wind[{i}].direction": one.direction == "y" for i, one in enumerate(winds, 1)},
        **{
            f"start.velocity.{name}.{key}": getattr(velocity, key)
            for name, velocity in case.start.velocity.items()
            for key in ("y", "lateral_turn")
        },
    }
    for where, action in lateral_actions.items():
        if action and not case.spatial:
            what = "the boom is flat, and nothing moves along 'y'; give the joints lateral_play"
            raise BoomError(where, what)


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
    what = f"missing; it is {describe(SegmentTable.model_fields[key])}"
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


def _sections(case: Case, joints: Sequence[Joint]) -> list[Section | None]:
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


def _spans(
    segments: Sequence[SegmentTable], joints: Sequence[JointTable]
) -> list[tuple[float, float]]:
    """Return the x in m of both ends of each segment; without span the first one starts at x = 0.

    Raises:
        BoomError: a segment has no position, or two different ones.
    """
    lengths = {segment.name: segment.length for segment in segments}
    ends = {segment.name: segment.span for segment in segments if segment.span is not None}
    # The keys of extensions that place inner segments, by the names of these.
    keys: dict[str, str] = {}
    sliding = [one for one in joints if one.extension is not None]
    for number, joint in enumerate(joints, start=1):
        if joint.extension is None:
            continue
        where = f"joint[{number}].extension"
        if lengths[joint.inner] is None:
            raise BoomError(
                where,
                f"{joint.inner!r} has a span, which says how far it is out; give it by its length, "
                "or leave extension out",
            )
        if joint.inner in keys:
            raise BoomError(
                where,
                f"{joint.inner!r} has its place by {keys[joint.inner]}; leave one of them out",
            )
        keys[joint.inner] = where
    first = segments[0]
    if first.length is not None and first.name not in keys:
        ends[first.name] = 0.0, first.length
    # One pass per joint places the segments, in any order of the joints.
    for joint in sliding * len(sliding):
        if joint.outer in ends and joint.inner not in ends:
            start, end = ends[joint.outer]
            length, extension = lengths[joint.inner], joint.extension
            assert length is not None
            assert extension is not None
            least = max(0.0, length - (end - start))
            if not least <= extension < length:
                raise BoomError(
                    keys[joint.inner],
                    f"must be at least {least:g} m and below {length:g} m, so that "
                    f"{joint.inner!r} begins in {joint.outer!r}, got {extension:g} m",
                )
            ends[joint.inner] = end + extension - length, end + extension
    for number, segment in enumerate(segments, start=1):
        if segment.name not in ends:
            raise BoomError(
                f"segment[{number}].length",
                f"nothing says where {segment.name!r} is; give an extension to the joint in which "
                "it slides, or a span to the segment",
            )
    return [ends[segment.name] for segment in segments]
