# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static states of a boom of beam elements with and without play, and their reactions."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from protractile.analysis.equilibria import vibrating_system
from protractile.analysis.rows import BEAM, INITIAL, Row
from protractile.beam_model.statics import Elements, StaticState, static_state
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.excitation import Step
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import Line
from protractile.geometry.axial import foot_thrust
from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import contact_centres
from protractile.geometry.ground import force_name
from protractile.geometry.load import Load
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.models import complete_system

# Elements of the longest segment; a frequency has an error below 0.01 %.
_ELEMENTS = 8
# Fraction of the largest reaction below which a reaction counts as zero, and that of the largest
# reaction times the length of the boom for moments.
_ROUND_OFF, _NO_MOMENT = 1.0e-9, 1.0e-7


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


def reaction_rows(state: StaticState, play: bool = True) -> Iterator[Row]:
    """Yield forces, moments and penetrations of supports, lugs, stops and contacts.

    They act on the segment, positive along z or x, or towards a larger slope; round-off is set to
    0. The place is ``at X m`` for a support or a stop, ``lug at X m`` or ``contact at X m``.
    """
    boom, along, penetrations = state.boom, _axial_forces(state), _penetrations(state)
    kinds = {
        (joint.inner, x): "contact "
        for joint in boom.joints
        for centres in contact_centres(boom, joint)
        for x in centres
    }
    for number, segment in enumerate(boom.segments):
        kinds |= {(number, support.x): "" for support in segment.supports}
    kinds |= {(stop.segment, stop.x): "" for stop in boom.stops}
    kinds |= {(cylinder.segment, cylinder.x): "lug " for cylinder in boom.cylinders}
    reactions = [reaction for reaction in state.reactions if reaction[:2] in kinds]
    most = max(
        map(abs, [*(reaction.force for reaction in reactions), *along.values()]), default=0.0
    )
    for reaction in reactions:
        at = reaction[:2]
        values = {"reaction": reaction.force if abs(reaction.force) > _ROUND_OFF * most else 0.0}
        if abs(reaction.moment) > _NO_MOMENT * most * boom.length:
            values["support_moment"] = reaction.moment
        if abs(along[at]) > _ROUND_OFF * most:
            values["axial_reaction"] = along[at]
        if at in penetrations:
            values["penetration"] = penetrations[at]
        part, place = boom.segments[reaction.segment].name, f"{kinds[at]}at {reaction.x:g} m"
        for name, value in values.items():
            yield Row(BEAM, INITIAL, play, name, part, place, value, reaction.x, time=0.0)


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


def _penetrations(state: StaticState) -> dict[tuple[int, float], float]:
    """Return the compression in m of contacts along z, by segment index and x in m."""
    boom, system = state.boom, state.system
    gaps, penetrations = system.rows @ state.position, dict[tuple[int, float], float]()
    for station in (station for station in boom.stations if station.direction == "z"):
        here = np.flatnonzero(system.station_of_row == station.index)
        penetration = max(
            (float(system.laws[row].penetration(gaps[row])) for row in here), default=0.0
        )
        centres = [station.x]
        if station.joint is not None:
            centres = contact_centres(boom, station.joint)[station.place]
        penetrations |= dict.fromkeys(((station.segment, x) for x in centres), penetration)
    return penetrations


def cylinder_force(state: StaticState, number: int) -> float:
    """Return the axial force of a cylinder in N; numbers start at 1."""
    return float(state.system.observers[force_name(number)].row @ state.position)
