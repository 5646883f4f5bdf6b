# SPDX-License-Identifier: LGPL-3.0-or-later
"""Construction of the boom and its contact laws from a case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import radians

import numpy as np

from protractile.dynamics.energy import DRIVEN_ENERGIES
from protractile.dynamics.excitation import InitialImpulse, ReleasedLoad
from protractile.dynamics.stick_slip import ELASTIC_DRIVE_VARIABLES
from protractile.dynamics.trajectory import DRIVE_VARIABLES, STATION_VARIABLES
from protractile.geometry.axial import foot_thrust, with_compression
from protractile.geometry.boom import Boom, BoomError, Joint, Segment
from protractile.geometry.boom_checks import check_order
from protractile.geometry.cylinder import Cylinder, EarthPoint
from protractile.geometry.joint import BareJoint
from protractile.geometry.place import resolve_distances, resolve_segments
from protractile.geometry.support import Support
from protractile.geometry.support_check import check_contacts_at_rest
from protractile.runs.case import actions, motions
from protractile.runs.case.actions import field_values
from protractile.runs.case.contact import JointTable
from protractile.runs.case.load_tables import TelescopingTable
from protractile.runs.case.schema import Case
from protractile.runs.case.sections import SegmentTable
from protractile.runs.case.segments import infer_sections, pinned_masses, segment_of


def build_boom(case: Case) -> Boom:
    """Return the boom of a case. Sections that the case does not give are inferred.

    Raises:
        BoomError: the boom is invalid.
    """
    _check_observations(case)
    segments, joints = _segments_and_joints(case)
    along = 0.0 if case.gravity is None else case.gravity.along
    hoist = case.hoist
    hanging = hoist.mass if hoist and hoist.hanging else 0.0
    thrusts = (*actions.thrusts(case, segments), *actions.tip_thrusts(case, segments))
    segments = with_compression(segments, joints, thrusts, along)
    motions.check_turning(case)
    motions.check_hoist(case)
    _check_planar(case)
    frame = motions.frame_motion(case, segments)
    boom = Boom(
        segments,
        joints,
        (*actions.loads(case, segments, joints), *motions.turning_loads(frame, segments, joints)),
        tuple(actions.stops(case)),
        case.observe,
        _cylinders(case, segments),
        (
            *motions.hoist_changes(case, segments, joints),
            *motions.turning_changes(
                frame, segments, joints, 0.0 if hoist and hoist.dropped else hanging
            ),
        ),
        tuple(actions.leads(case, segments)),
    )
    boom = _with_pulling_cylinders(boom)
    check_contacts_at_rest(boom)
    motions.check_elastic_drives(case, boom)
    return boom


def _segments_and_joints(case: Case) -> tuple[tuple[Segment, ...], tuple[Joint, ...]]:
    """Return the segments of a case without axial forces, and its joints."""
    check_names("segment", [segment.name for segment in case.segments])
    _check_joint_segments(case)
    ends = _spans(case.segments, telescoped_joints(case))
    joints = tuple(_joint(case, number, ends) for number in range(len(case.joints)))
    sections = enumerate(infer_sections(case, joints))
    segments = [segment_of(case, number, one, ends[number]) for number, one in sections]
    for number, mass in [*pinned_masses(case, segments)]:
        segments[number] = replace(segments[number], masses=(*segments[number].masses, mass))
    return tuple(segments), joints


def hold_ground(changed: Case, original: Case) -> Case:
    """Return a changed case whose cylinders stand where they stand in the original case.

    If the luffing angle is changed, the ground of cylinders in the axes of the boom, which holds at
    the original angle, is given in earth axes.
    """
    if changed.gravity is None or original.gravity is None:
        return changed
    angle = original.gravity.angle
    luffing = [one for one in changed.cylinders if not isinstance(one.ground, EarthPoint)]
    if changed.gravity.angle == angle or not luffing:
        return changed
    foot = _foot(_segments_and_joints(changed)[0])
    if foot is None:
        return changed
    on_earth = tuple(cylinder.on_earth(radians(angle), foot) for cylinder in changed.cylinders)
    return changed.model_copy(update={"cylinders": on_earth})


def _cylinders(case: Case, segments: Sequence[Segment]) -> tuple[Cylinder, ...]:
    """Return the cylinders with their ground in the axes of the boom."""
    angle = radians(0.0 if case.gravity is None else case.gravity.angle)
    cylinders = tuple(
        resolve_segments(cylinder, f"cylinders[{number}]", segments)
        for number, cylinder in enumerate(case.cylinders)
    )
    if (foot := _foot(segments)) is None:
        for number, cylinder in enumerate(cylinders, start=1):
            if isinstance(cylinder.ground, EarthPoint):
                what = "no segment has a support, from whose pin front and below are measured; "
                raise BoomError(f"cylinder[{number}].ground", f"{what}give one")
        return cylinders
    cylinders = tuple(cylinder.in_boom_axes(angle, foot) for cylinder in cylinders)
    if case.luff is not None and case.luff.travel:
        for number, cylinder in enumerate(cylinders):
            luffed = cylinder.luffed(radians(case.luff.travel), foot)
            luffed.check(f"cylinders[{number}]", case.spatial)
    return cylinders


def _with_pulling_cylinders(boom: Boom) -> Boom:
    """Return the boom with the stiffness of its cylinders that pull under the loads at t = 0.

    Moments about the foot pin decide, without the deflections.
    """
    cylinders = tuple(
        replace(cylinder, stiffness=cylinder.oil_stiffness(pulls=True))
        if cylinder.stiffness is None and _pulls(boom, cylinder)
        else cylinder
        for cylinder in boom.cylinders
    )
    return boom if cylinders == boom.cylinders else replace(boom, cylinders=cylinders)


def _pulls(boom: Boom, cylinder: Cylinder) -> bool:
    segment = boom.segments[cylinder.segment]
    if (foot := segment.foot) is None:
        return False
    thrust = foot_thrust(boom.segments, boom.joints, cylinder.segment, 0.0, boom.axial_changes)
    turn = float(thrust) * foot.depth
    for each in boom.segments:
        turn += each.load * each.length * (0.5 * sum(each.ends) - foot.x)
    for load in boom.loads:
        if load.direction == "z" and not isinstance(load.history, InitialImpulse):
            released = isinstance(load.history, ReleasedLoad)
            factor = 1.0 if released else float(load.history(np.zeros(1))[0])
            turn += factor * load.turn(boom.segments[load.segment].ends, foot.x)
    return turn * cylinder.arm(foot) > 0.0


def _foot(segments: Sequence[Segment]) -> Support | None:
    """Return the foot of the first segment that has one, about whose pin the boom luffs."""
    return next((segment.foot for segment in segments if segment.foot is not None), None)


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


def _check_planar(case: Case) -> None:
    """Check that a planar boom has no lateral actions."""
    winds = () if case.hoist is None else case.hoist.wind
    lateral_actions = {
        "slew": case.slew,
        "limits.tip_lateral": case.limits and case.limits.tip_lateral,
        **{
            f"load[{number}].direction": not isinstance(load.direction, str)
            and load.direction % 180.0
            for number, load in enumerate(case.loads, start=1)
        },
        "head.beside": case.head and case.head.beside,
        "wind.direction": case.wind and case.wind.dynamic_pressure and case.wind.direction % 180.0,
        **{
            f"segment[{i}].lateral_load": segment.lateral_load
            for i, segment in enumerate(case.segments, 1)
        },
        **{f"base[{i}].direction": load.direction == "y" for i, load in enumerate(case.base, 1)},
        **{f"hoist.wind[{i}].direction": wind.direction == "y" for i, wind in enumerate(winds, 1)},
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


def telescoped_joints(case: Case) -> tuple[JointTable, ...]:
    """Return the joints with their extensions at the fraction of the stroke of the case.

    Raises:
        BoomError: no joint has an extension, or one is below that of the retracted boom.
    """
    lengths = {one.name: one.length for one in case.segments}
    if case.telescoping is None and not any(joint.stroke for joint in case.joints):
        return case.joints
    table, strokes = case.telescoping or TelescopingTable(), dict[int, tuple[float, float]]()
    for number, joint in enumerate(case.joints):
        inner, outer = (lengths.get(name) for name in (joint.inner, joint.outer))
        if joint.stroke or (joint.extension is not None and inner is not None):
            longer = inner - outer if inner and outer else 0.0
            least = max(table.retracted, longer) if joint.retracted is None else joint.retracted
            stroke = joint.stroke or (joint.extension or 0.0) - least
            if stroke < 0.0:
                what = f"must be at least {least:g} m, that of the retracted boom"
                raise BoomError(f"joint[{number + 1}].extension", what)
            strokes[number] = least, stroke
    if not strokes:
        raise BoomError("telescoping", "no joint has an extension; give the largest one to each")
    travel = table.extension * sum(stroke for _, stroke in strokes.values())
    joints = list(case.joints)
    from_tip, at_once = (table.order == order for order in ("from the tip", "in proportion"))
    for number, (least, stroke) in sorted(strokes.items(), reverse=from_tip):
        moved = table.extension * stroke if at_once else min(stroke, travel)
        travel -= moved
        joints[number] = replace(joints[number], extension=least + moved, stroke=None)
    return tuple(joints)


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
    sliding = [joint for joint in joints if joint.extension is not None]
    for number, joint in enumerate(joints, start=1):
        if joint.extension is None:
            continue
        where = f"joint[{number}].extension"
        if lengths[joint.inner] is None:
            raise BoomError(
                where,
                f"{joint.inner!r} has a span, which says how far it is out; give it by its length, "
                "or leave extension or stroke out",
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
