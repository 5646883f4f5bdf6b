# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static states of a boom of beam elements with and without play, and their reactions."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from protractile.analysis.equilibria import vibrating_system
from protractile.analysis.states import station_loads
from protractile.beam_model.statics import Elements, StaticState, net_reactions, static_state
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.excitation import Step
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import Line
from protractile.geometry.axial import foot_thrust
from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import contact_centres
from protractile.geometry.cylinder import force_name
from protractile.geometry.load import Load
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.models import complete_system

# Elements of the longest segment; a frequency has an error below 0.01 %.
_ELEMENTS = 8
# Fraction of the largest reaction below which a reaction counts as zero.
ROUND_OFF = 1.0e-9


@dataclass(frozen=True, slots=True)
class Reaction:
    """Reaction of a support, a cylinder or a stop on a segment."""

    segment: str  #: name of the segment
    x: float  #: position in m
    force: float  #: force along z in N
    moment: float  #: moment in N·m, positive towards a larger slope
    depth: float | None  #: compression of a stop in m; None for other reactions
    along: float = 0.0  #: axial force towards the tip in N


class Statics(NamedTuple):
    """Static states of beam elements under the loads at t = 0, with and without play.

    If no model of the case has play, both states are those without play.
    """

    with_play: StaticState
    bonded: StaticState


def statics(case: Case, boom: Boom) -> Statics | None:
    """Return the static states; None without an equilibrium."""
    with_play = not all(model.bonded for model in case.models)
    with suppress(*NUMERICAL_ERRORS), np.errstate(all="ignore"):
        elements = Elements(boom, _ELEMENTS)
        bonded = state_at_rest(case, boom.bonded, elements)
        if not with_play:
            return Statics(bonded, bonded)
        return Statics(state_at_rest(case, boom_with_play(case, boom), elements), bonded)
    return None


def state_at_rest(
    case: Case,
    boom: Boom,
    elements: Elements | None = None,
    walls: float = 1.0,
    time: float = 0.0,
) -> StaticState:
    """Return the static state of a case's boom, with the load on its rope.

    Arguments and errors as in :func:`.beam_model.statics.static_state`.
    """
    hoist, gravity = case.hoist, case.gravity
    hung = []
    if hoist is not None and gravity is not None and hoist.hanging and not hoist.dropped:
        last, weight = len(boom.segments) - 1, -hoist.mass * gravity.across
        hung = [Load(last, "z", weight, boom.segments[last].end, Step())]

    def complete(system: GapSystem, lines: Sequence[Line]) -> GapSystem:
        return complete_system(system, case, boom, lines)

    return static_state(boom, elements, walls, time, complete, hung)


def first_frequency(case: Case, state: StaticState) -> float:
    """Return the first natural frequency in Hz about a static state at t = 0."""
    vibrating = vibrating_system(state.system, case.time.duration)
    omega, _ = closed_contact_modes(*(vibrating or (state.system, state.position)))
    return float(omega[0]) / (2.0 * np.pi)


def boom_with_play(case: Case, boom: Boom) -> Boom:
    """Return the boom with the contact laws of the first model with play, or the bonded boom."""
    with_play = next((model for model in case.models if not model.bonded), None)
    return boom.bonded if with_play is None else with_play.model_boom(boom).boom


def reactions(state: StaticState) -> list[Reaction]:
    """Return the support reactions."""
    between = _joint_contacts(state.boom)
    return [
        one for place, one in contact_and_support_reactions(state).items() if place not in between
    ]


def _joint_contacts(boom: Boom) -> set[tuple[int, float]]:
    """Return the contacts of all joints, as index of the inner segment and x in m."""
    return {
        (joint.inner, x)
        for joint in boom.joints
        for centres in contact_centres(boom, joint)
        for x in centres
    }


def contact_and_support_reactions(state: StaticState) -> dict[tuple[int, float], Reaction]:
    """Return reactions and contact forces by segment index and x in m; round-off is set to 0."""
    boom, depths, along = state.boom, _depths(state), _axial_forces(state)
    places = _joint_contacts(boom)
    places |= {(number, one.x) for number, s in enumerate(boom.segments) for one in s.supports}
    places |= {(stop.segment, stop.x) for stop in boom.stops}
    places |= {(cylinder.segment, cylinder.x) for cylinder in boom.cylinders}
    reactions = [
        reaction for reaction in net_reactions(boom, state.reactions) if reaction[:2] in places
    ]
    least = ROUND_OFF * max((abs(reaction.force) for reaction in reactions), default=0.0)
    return {
        reaction[:2]: Reaction(
            segment=boom.segments[reaction.segment].name,
            x=reaction.x,
            force=reaction.force if abs(reaction.force) > least else 0.0,
            moment=reaction.moment,
            depth=depths.get(reaction[:2]),
            along=along[reaction[:2]],
        )
        for reaction in reactions
    }


def _axial_forces(state: StaticState) -> dict[tuple[int, float], float]:
    """Return the axial forces on feet and cylinder lugs in N, by segment index and x in m."""
    boom = state.boom
    forces: dict[tuple[int, float], float] = defaultdict(float)
    for number, segment in enumerate(boom.segments):
        if segment.foot is not None:
            thrust = foot_thrust(boom.segments, boom.joints, number, 0.0, boom.axial_changes)
            forces[number, segment.foot.x] = float(thrust)
    for number, cylinder in enumerate(boom.cylinders, start=1):
        push = cylinder.direction[0] * cylinder_force(state, number)
        foot = boom.segments[cylinder.segment].foot
        forces[cylinder.segment, cylinder.x] += push
        if foot is not None:
            forces[cylinder.segment, foot.x] -= push
    return forces


def _depths(state: StaticState) -> dict[tuple[int, float], float]:
    """Return the compression in m of contacts along z, by segment index and x in m."""
    boom = state.boom
    (loads,) = station_loads(boom, state.system, state.position[None])
    return {
        (at.segment, x): load.depth
        for at, load in zip(boom.stations, loads, strict=True)
        if at.direction == "z"
        for x in ([at.x] if at.joint is None else contact_centres(boom, at.joint)[at.place])
    }


def cylinder_force(state: StaticState, number: int) -> float:
    """Return the axial force of a cylinder in N; numbers start at 1."""
    return float(state.system.observers[force_name(number)].row @ state.position)
