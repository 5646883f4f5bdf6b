# SPDX-License-Identifier: LGPL-3.0-or-later
"""Values of measured channels by a model, at rest and in motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from protractile.analysis.equilibria import vibrating_state
from protractile.analysis.states import States
from protractile.analysis.stresses import Fibres
from protractile.dynamics.damping import closed_contact_damping
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import pads
from protractile.geometry.fields import BoomError
from protractile.geometry.ground import force_name
from protractile.geometry.observation import KINDS
from protractile.geometry.place import at
from protractile.geometry.section import EACH_SIDE
from protractile.geometry.typography import choices
from protractile.runs.measured.keys import Channel


@dataclass(frozen=True)
class Computed:
    """A model in the state of a measurement."""

    damped: GapSystem  #: its system with the damping of its motion
    rest: States  #: the equilibrium under the loads at t = 0; empty without one
    motions: Sequence[States]  #: its motion, and motions with slightly changed loads

    def read(self, channel: Channel) -> Array:
        """Return the values (num_motions, num_times) at the times of a channel, or a single one.

        Raises:
            BoomError: the boom has no such place or section.
            NumericsError: the model has no equilibrium, or fewer modes.
        """
        if channel.table is not None:
            times = channel.times
            return np.array([np.interp(times, s.time, _observe(s, channel)) for s in self.motions])
        if channel.quantity == "free_travel":
            return np.array([[free_travel(self.rest.boom)]])
        if not self.rest.time.size:
            raise NumericsError("the boom has no static equilibrium under the loads at t = 0")
        if channel.quantity in ("frequency", "damping_ratio"):
            values = self.modes[channel.quantity == "damping_ratio"]
            if channel.number > values.size:
                raise NumericsError(f"the model has {values.size} modes only")
            return values[None, channel.number - 1 : channel.number]
        return _observe(self.rest, channel)[None]

    @property
    def modes(self) -> tuple[Array, Array]:
        """Frequencies in Hz and damping ratios of the modes with the contacts closed at rest."""
        rests = dict(zip(self.rest.time.tolist(), self.rest.positions, strict=True))
        return closed_contact_damping(self.damped, vibrating_state(self.damped, rests)[1])


def output_of(channel: Channel) -> str:
    """Return the name of the output of a channel of a place."""
    return f"measured {channel.name}"


def _observe(states: States, channel: Channel) -> Array:
    """Return the values (num_states,) of a channel in states of a model."""
    if channel.quantity == "strain":
        return _strain(states, channel)
    if channel.quantity == "cylinder_force":
        return states.observed(force_name(channel.number))
    return states.observed(output_of(channel) if channel.quantity in KINDS else channel.quantity)


def _strain(states: States, channel: Channel) -> Array:
    """Return the strain (num_states,) in the middle of a side of the section (Navier 1826)."""
    names = [segment.name for segment in states.boom.segments]
    if channel.segment not in names:
        raise BoomError("segment", f"{channel.segment!r} is not a segment; give {choices(names)}")
    number = names.index(channel.segment)
    segment, line = states.boom.segments[number], states.model.lines[number]
    assert channel.x is not None
    x = at(channel.x, *segment.ends)
    if not segment.start <= x <= segment.end:
        raise BoomError("x", f"must be from {segment.start:g} to {segment.end:g} m, got {x:g} m")
    if (fibres := Fibres.of(segment, line)) is None:
        raise BoomError("segment", f"{segment.name!r} has no section, which strains need")
    across = fibres.z if channel.side in ("top", "bottom") else fibres.y
    heights = (1.0 if channel.side in ("top", "right") else -1.0) * across[:, 0]
    outer = np.flatnonzero(heights >= heights.max() - 1.0e-9 * np.ptp(heights))
    forces = states.section_forces(number)
    stress = np.mean([fibres.stress(int(fibre), forces) for fibre in outer], axis=0)
    weights = np.array([np.interp(x, line.x, row) for row in np.eye(line.x.size)])
    return np.asarray(stress @ weights / segment.material.youngs_modulus)


def free_travel(boom: Boom) -> float:
    """Return the travel of the tip in m between its contacts, of rigid segments.

    In each joint the inner segment moves and turns until contacts close. So its travel is the
    solution of a linear program with two unknowns, and the joints add up.

    Raises:
        NumericsError: a joint turns freely.
    """
    from scipy.optimize import linprog

    travel, contacts = 0.0, pads(boom)
    for joint in (joint for joint in boom.joints if not joint.bonded):
        sides = [
            (pad, side)
            for pad in contacts
            if pad.joint is joint and pad.station.direction == "z"
            for side in (EACH_SIDE if pad.side == 0 else (pad.side,))
        ]
        origin = joint.stations[0]
        rows = [[side, side * (pad.midpoint - origin)] for pad, side in sides]
        clearances = [pad.station.law.onset(side) - pad.shim for pad, side in sides]
        for sign in (1.0, -1.0):
            arm = sign * np.array([1.0, boom.tip - origin])
            end = linprog(arm, rows, clearances, bounds=(None, None))
            if end.status:
                raise NumericsError("a joint touches at one station only, and turns freely")
            travel -= end.fun
    return travel
