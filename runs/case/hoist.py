# SPDX-License-Identifier: LGPL-3.0-or-later
"""Hoisting of a load on a rope below the tip."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from dynamics.contact import Gap
from dynamics.excitation import HistorySum, is_constant
from dynamics.gap_system import GapSystem
from dynamics.hanging_load import HangingLoad, Pendulum, RopeForce
from dynamics.motion import initial_state
from geometry.axial import AxialChange, Thrust, with_compression
from geometry.boom import Boom, BoomError, Joint, Segment
from geometry.telescoping import drives_of
from runs.case.load_tables import build_history
from runs.case.schema import Case
from runs.case.turning import frame_motion

# Slack in m of a rope that never pulls.
_SLACK = 1.0e6


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
    """Return the hoisted load of a checked case; None if there is none, or if it is dropped."""
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
    """Yield the change of axial forces while the rope lifts a load from the ground."""
    table = case.hoist
    if table is None or case.gravity is None or table.hanging or not case.gravity.along:
        return
    rope = Thrust(len(segments) - 1, segments[-1].end, table.mass * case.gravity.along)
    loaded_segments = with_compression(segments, joints, [rope])
    stretch = table.mass * case.gravity.acceleration / table.rope_stiffness
    force = RopeForce(table.history("hoist"), stretch, table.slack)
    yield AxialChange(force, [segment.compression for segment in loaded_segments])


def with_hanging_load(system: GapSystem, case: Case, boom: Boom) -> GapSystem:
    """Return a model's gap system with the hoisted load of its case, if any.

    Raises:
        NumericsError: see :func:`with_initial_slack`.
    """
    load, tip = hanging_load(case, boom), system.observers["tip"].row
    if case.hoist is not None and case.gravity is not None and case.hoist.dropped:
        pull = case.hoist.mass * case.gravity.across
        return replace(system, released_load=system.released_load - pull * tip)
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
