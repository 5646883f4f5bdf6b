# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motions of a case: slewing, luffing, a load on a rope below the tip, and elastic drives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import pi

from protractile.dynamics.contact import Gap
from protractile.dynamics.excitation import History, is_constant
from protractile.dynamics.frame_motion import FrameAcceleration, FrameMotion, Spin
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.hanging_load import HangingLoad, Pendulum, Release, RopeForce
from protractile.dynamics.motion import initial_state
from protractile.dynamics.motion_laws import HistorySum
from protractile.dynamics.stick_slip import ElasticDrive
from protractile.geometry.axial import AxialChange, Thrust, lumped_masses, with_compression
from protractile.geometry.boom import Boom, BoomError, Direction, Joint, PointMass, Segment
from protractile.geometry.load import AngularAcceleration, Load
from protractile.geometry.telescoping import drives_below, drives_of, telescoping_stations
from protractile.runs.case.actions import lead_of
from protractile.runs.case.contact import JointTable
from protractile.runs.case.load_tables import build_history
from protractile.runs.case.motion_tables import DriveTable
from protractile.runs.case.schema import Case, GravityTable

# Slack in m of a rope that never pulls.
_SLACK = 1.0e6
# Largest natural frequency or decay rate of an elastic drive in Hz; stiffer drives must be rigid.
_MAX_RATE = 1.0e3


def check_turning(case: Case) -> None:
    """Check the data of slewing and luffing.

    Raises:
        BoomError: a key is missing or contradicts another one, or the boom admits no turning.
    """
    for key, table in (("slew", case.slew), ("luff", case.luff)):
        if table is None:
            continue
        if table.speed is not None and not table.ramp:
            raise BoomError(
                f"{key}.ramp",
                f"missing; a speed reached at once takes an endless force; it is "
                f"{table.meaning('ramp')}",
            )
        table.history(key)
        if case.hoist is not None and not case.hoist.hanging:
            raise BoomError(key, "the load of hoist lies on the ground; give hoist.hanging = true")
    if case.luff is not None:
        if case.gravity is None:
            raise BoomError(
                "luff", "the table gravity, which has the luffing angle at t = 0, is missing"
            )
        farthest = case.gravity.angle + (case.luff.travel or 0.0)
        if abs(farthest) > 90.0:
            raise BoomError(
                "luff.travel", f"leads to {farthest:g} degrees; the angle must stay within ± 90"
            )


def frame_motion(case: Case, segments: Sequence[Segment]) -> FrameMotion:
    """Return the motion of the boom's frame by slewing and luffing, of a checked case."""
    turns = {"slew": case.slew, "luff": case.luff}
    histories = {key: table.history(key) for key, table in turns.items() if table is not None}
    gravity, foot = case.gravity or GravityTable(acceleration=0.0), segments[0].foot
    return FrameMotion(
        **histories,
        angle=gravity.angle,
        foot=segments[0].start if foot is None else foot.x,
        depth=0.0 if foot is None else foot.depth,
        radius=0.0 if case.slew is None else case.slew.radius,
        gravity=gravity.acceleration,
    )


def turning_loads(
    frame: FrameMotion, segments: Sequence[Segment], joints: Sequence[Joint]
) -> Iterator[Load]:
    """Yield the inertia loads and weight changes across the boom due to slewing and luffing."""
    if not (frame.slew.kinks or frame.luff.kinks):
        return
    directions: tuple[Direction, ...] = ("z", "y")
    for number, segment in enumerate(segments):
        extension = HistorySum(tuple(drive.history for drive in drives_of(joints, number)))
        for direction in directions:
            mass = segment.mass_per_length
            uniform, linear, *points = (
                FrameAcceleration(frame, direction, x, extension)
                for x in (0.0, None, *(point.x for point in segment.masses))
            )
            if linear.peak or uniform.peak:
                yield Load(number, direction, -mass, None, uniform, inertial=True)
                yield AngularAcceleration(number, direction, -1.0, None, linear)
                for point, history in zip(segment.masses, points, strict=True):
                    yield Load(number, direction, -point.mass, point.x, history)


def turning_changes(
    frame: FrameMotion, segments: Sequence[Segment], joints: Sequence[Joint], hanging: float
) -> Iterator[AxialChange]:
    """Yield the changes of axial forces due to slewing and luffing, and centrifugal terms.

    ``hanging`` is the mass in kg of a load on a rope, which counts as a mass at the tip.
    """
    if not (frame.slew.kinks or frame.luff.kinks):
        return
    directions: tuple[Direction, ...] = ("y", "z")
    masses = [lumped_masses(segment) for segment in segments]
    yield from (
        AxialChange(spin, masses=masses, direction=direction)
        for direction in directions
        if (spin := Spin(frame, direction)).peak
    )
    if hanging:
        masses[-1] += (PointMass(segments[-1].end, hanging),)
    drives_of_segments = [tuple(drives_of(joints, number)) for number in range(len(segments))]
    for drives in dict.fromkeys(drives_of_segments):
        extension = HistorySum(tuple(drive.history for drive in drives))
        for x in (0.0, None):
            history = FrameAcceleration(frame, "x", x, extension)
            thrusts = [
                Thrust(number, mass.x, mass.mass * (1.0 if x is not None else mass.x))
                for number, masses_of_segment in enumerate(masses)
                if drives_of_segments[number] == drives
                for mass in masses_of_segment
            ]
            if history.peak:
                loaded_segments = with_compression(segments, joints, thrusts)
                yield AxialChange(history, [segment.compression for segment in loaded_segments])


def check_hoist(case: Case) -> None:
    """Check the data of a hoisted load.

    Raises:
        BoomError: a key is missing or contradicts another one.
    """
    table = case.hoist
    if table is None:
        return
    if case.gravity is None:
        raise BoomError("hoist.mass", "nothing weighs without the table gravity; give it")
    if table.hanging and table.slack:
        raise BoomError("hoist.slack", "the load hangs; leave slack or hanging out")
    for key in ("pendulum", "dropped"):
        if getattr(table, key) and not table.hanging:
            raise BoomError(f"hoist.{key}", "the load lies on the ground; give hanging = true")
    for key, other in (("phi_2_min", "beta_2"), ("beta_2", "phi_2_min")):
        if getattr(table, key) is None and getattr(table, other) is not None:
            raise BoomError(f"hoist.{key}", f"missing; the hoisting class has it beside {other}")
    if table.phi_2_min is not None and table.hanging:
        raise BoomError("hoist.phi_2_min", "the load hangs, and is not lifted; leave it out")
    if table.wind and table.pendulum is None:
        raise BoomError("hoist.wind", "the load does not swing; give pendulum, its length in m")
    for key in ("travel", "table", "pendulum"):
        if table.dropped and getattr(table, key) is not None:
            raise BoomError(f"hoist.{key}", "the load is dropped at t = 0; leave one of them out")
    if table.pendulum is None and not table.dropped and (case.slew or case.luff):
        raise BoomError(
            "hoist.pendulum",
            "missing; a load swings as the boom turns; it is its distance in m from the tip",
        )
    for number, wind in enumerate(table.wind, start=1):
        build_history(f"hoist.wind[{number}]", wind)
    what = "stiffness is given; leave one of them out"
    if table.stiffness is None:
        what = "missing; give it, or the stiffness of the rope"
    for key in ("area", "modulus", "length"):
        if (getattr(table, key) is None) == (table.stiffness is None):
            raise BoomError(f"hoist.{key}", what)
    if table.has_winch:
        table.history("hoist")
    elif not table.hanging:
        raise BoomError("hoist.travel", "missing; it is the length in m by which the winch hoists")


def hanging_load(case: Case, boom: Boom) -> HangingLoad | None:
    """Return the load on the rope of a checked case; None without a load, or if it is dropped."""
    table = case.hoist
    if table is None or case.gravity is None or table.dropped:
        return None
    history = table.history("hoist") if table.has_winch else None
    gravity, pendulum = case.gravity.acceleration, None
    if table.pendulum is not None:
        last = len(boom.segments) - 1
        extension = HistorySum(tuple(drive.history for drive in drives_of(boom.joints, last)))
        winds = [
            (wind.direction, wind.force, build_history(f"hoist.wind[{number}]", wind))
            for number, wind in enumerate(table.wind, start=1)
        ]
        frame, tip = frame_motion(case, boom.segments), boom.segments[last].end
        pendulum = Pendulum(table.pendulum, frame, tip, extension, winds)
    return HangingLoad(
        table.mass,
        table.rope_stiffness,
        gravity,
        None if history is None or is_constant(history) else history,
        case.gravity.across / gravity,
        None if table.hanging else table.slack,
        pendulum,
    )


def hoist_changes(
    case: Case, segments: Sequence[Segment], joints: Sequence[Joint]
) -> Iterator[AxialChange]:
    """Yield the change of axial forces when the rope lifts a load, or drops it."""
    table = case.hoist
    if table is None or case.gravity is None or not (case.gravity.along or case.rope):
        return
    if table.hanging and not table.dropped:
        return
    weight = (-1.0 if table.dropped else 1.0) * table.mass * case.gravity.acceleration
    leads = tuple(lead_of(case, segments, weight))
    last, end, along = len(segments) - 1, segments[-1].end, case.gravity.sine
    forces = (weight * along, *(lead.force for lead in leads))
    thrusts = [Thrust(last, end, force) for force in forces]
    loaded_segments = with_compression(segments, joints, thrusts)
    force: History = Release()
    if not table.dropped:
        stretch = table.mass * case.gravity.acceleration / table.rope_stiffness
        force = RopeForce(table.history("hoist"), stretch, table.slack)
    compressions = [segment.compression for segment in loaded_segments]
    yield AxialChange(force, compressions, leads=leads)


def with_hanging_load(system: GapSystem, case: Case, boom: Boom) -> GapSystem:
    """Return a model's gap system with the hoisted load of its case, if any.

    Raises:
        NumericsError: see :func:`with_initial_slack`.
    """
    load, tip = hanging_load(case, boom), system.observers["tip"].row
    if load is None:
        return system
    return with_initial_slack(load.attach(system, tip, boom.segments[-1].end), case)


def with_initial_slack(system: GapSystem, case: Case) -> GapSystem:
    """Return the gap system with initial slack of the rope if the load lies on the ground.

    The case gives the slack relative to the initial position of the tip. The last two contacts of
    the system are the rope and the ground.

    Raises:
        NumericsError: the boom has no equilibrium from which to start.
    """
    if case.hoist is None or case.hoist.hanging:
        return system
    *laws, rope, ground = system.laws
    assert isinstance(rope, Gap)
    free_system = replace(system, laws=[*laws, replace(rope, above=_SLACK), ground])
    start = initial_state(free_system, case.start.at_rest)[1]
    taut_rope = replace(rope, above=case.hoist.slack + float(system.rows[-2] @ start))
    return replace(system, laws=[*laws, taut_rope, ground])


def elastic_drives(case: Case, boom: Boom) -> dict[int, ElasticDrive]:
    """Return the data of the elastic drives of a checked case, by the indices of their joints."""
    return {
        number: ElasticDrive(
            _moved_mass(boom, number),
            drive.stiffness,
            drive.dashpot,
            1.0 if drive.static_friction is None else drive.static_friction / joint.friction,
            boom.segments[boom.joints[number].inner].compression.transferred,
            tuple(
                (_moved_mass(boom, number, other), neighbour.drive.history)
                for other, neighbour in enumerate(boom.joints)
                if other != number and neighbour.drive is not None
            ),
        )
        for number, joint, drive in _drives(case)
        if drive.stiffness is not None and boom.joints[number].drive is not None
    }


def with_elastic_drives(system: GapSystem, case: Case, boom: Boom) -> GapSystem:
    """Return the gap system of a model with the data of its elastic drives."""
    drives = elastic_drives(case, boom)
    suffixes = {group.suffix: drives.get(group.joints[0]) for group in telescoping_stations(boom)}
    travels = [
        replace(travel, elastic=None if travel.suffix is None else suffixes[travel.suffix])
        for travel in system.travels
    ]
    return replace(system, travels=travels)


def check_elastic_drives(case: Case, boom: Boom) -> None:
    """Check the data of elastic drives.

    Raises:
        BoomError: data of an elastic drive are invalid.
    """
    for number, joint, drive in _drives(case):
        where = f"joint[{number + 1}].drive"
        if drive.stiffness is None:
            for key in ("dashpot", "static_friction"):
                if getattr(drive, key):
                    raise BoomError(
                        f"{where}.{key}",
                        "without a stiffness the drive is stiff, and its segment neither sticks "
                        f"nor slips; give stiffness, or leave {key} out",
                    )
            continue
        if drive.static_friction is not None and joint.friction == 0.0:
            raise BoomError(
                f"{where}.static_friction",
                "nothing rubs in the joint; give it friction, or leave static_friction out",
            )
        if drive.static_friction is not None and drive.static_friction < joint.friction:
            raise BoomError(
                f"{where}.static_friction",
                f"must be at least the joint's friction of sliding, {joint.friction:g}, got "
                f"{drive.static_friction:g}",
            )
        mass = _moved_mass(boom, number) if boom.joints[number].drive is not None else 0.0
        rates = 2.0 * pi * _MAX_RATE
        for key, value, most, unit in (
            ("stiffness", drive.stiffness, mass * rates**2, "N/m"),
            ("dashpot", drive.dashpot, mass * rates, "N s/m"),
        ):
            if value > most > 0.0:
                raise BoomError(
                    f"{where}.{key}",
                    f"must be at most {most:.3g} {unit} for the {mass:.4g} kg that it draws, got "
                    f"{value:g} {unit}; leave it out where the drive is stiff",
                )


def _drives(case: Case) -> Iterator[tuple[int, JointTable, DriveTable]]:
    for number, joint in enumerate(case.joints):
        if joint.drive is not None:
            yield number, joint, joint.drive


def _moved_mass(boom: Boom, *joints: int) -> float:
    """Return the mass in kg of the segments that every one of these joints' drives moves."""
    return sum(
        segment.mass
        for number, segment in enumerate(boom.segments)
        if set(joints) <= set(drives_below(boom.joints, number))
    )
