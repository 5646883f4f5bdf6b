# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments as beams, and their way to a gap system.

Kantorovich series and beam finite elements both end here; from here on they are the same. So
are the flat boom and the one in space, which has more components and more pads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from beam_model.boom_modes import BoomModes
from beam_model.component import SegmentModel
from dynamics.contact import ContactLaw, PowerContact
from dynamics.excitation import Excitation
from dynamics.friction import DryFriction
from dynamics.gap_system import GapSystem, Observer
from geometry.boom import Boom, Direction
from geometry.contact_places import Pad, pads

Array = npt.NDArray[np.float64]


def gap_system(
    boom: Boom,
    models: Sequence[SegmentModel],
    laws: Sequence[ContactLaw],
    lateral_laws: Sequence[ContactLaw] = (),
) -> GapSystem:
    """Segments side by side in modal coordinates, coupled by contact, friction and ties alone.

    Args:
        boom: its joints, loads and stops.
        models: one for each segment.
        laws: one for each joint, along z.
        lateral_laws: one for each joint, along y; none for a flat boom.
    """
    modes = BoomModes(boom, models)
    laws_along = {"z": laws, "y": lateral_laws}
    contacts: list[tuple[Array, ContactLaw, int]] = []
    friction_rows: list[Array] = []
    frictions: list[DryFriction] = []
    for pad in pads(boom):
        law = _law_of(pad, laws_along[pad.direction][pad.number])
        if law is None:
            continue
        if pad.joint.friction > 0.0:
            friction_rows.append(_relative(modes, pad, pad.rubs))
            pressed_by = () if pad.joint.normal_forces else (len(contacts),)
            frictions.append(
                DryFriction(pad.joint.friction, pad.station, pad.prescribed, pressed_by)
            )
        contacts.append((_relative(modes, pad, pad.direction), law, pad.station))
    stations = boom.stations
    for station, stop in enumerate(boom.stops, start=len(stations) - len(boom.stops)):
        law = PowerContact(stop.stiffness, stop.exponent, stop.clearance, stop.stiffness_below)
        contacts.append((modes.displacement(stop.segment, stop.x, "z"), law, station))
    return GapSystem(
        omega2=modes.omega2,
        load=modes.load,
        rows=np.array([row for row, _, _ in contacts]).reshape(-1, modes.omega2.size),
        laws=[law for _, law, _ in contacts],
        station_of_row=np.array([station for _, _, station in contacts], dtype=np.int64),
        stations=[x for x, _ in stations],
        observers=_observers(boom, modes),
        damping=modes.damping,
        friction_rows=np.array(friction_rows).reshape(-1, modes.omega2.size),
        frictions=frictions,
        excitations=[
            Excitation(load.push(_Member(modes, load.segment)), load.history) for load in boom.loads
        ],
        station_directions=[direction for _, direction in stations],
    )


def tied_system(boom: Boom, models: Sequence[SegmentModel]) -> GapSystem:
    """The play-free boom: every joint's segments move alike at its stations."""
    tied = tuple(replace(joint, tied=True) for joint in boom.joints)
    return gap_system(replace(boom, joints=tied), models, ())


def _law_of(pad: Pad, law: ContactLaw) -> ContactLaw | None:
    """A pad's part of its joint's law; None on a side where the law never touches."""
    if pad.side == 0:
        return law
    one_sided = law.one_sided(pad.side)
    return None if one_sided is None else one_sided.shared(pad.weight)


def _relative(modes: BoomModes, pad: Pad, direction: Direction) -> Array:
    """(num_modes,) row that reads u − w of a pad's two points."""
    inner = modes.displacement(pad.joint.inner, pad.x, direction, pad.inner)
    return inner - modes.displacement(pad.joint.outer, pad.x, direction, pad.outer)


def _observers(boom: Boom, modes: BoomModes) -> dict[str, Observer]:
    observers = {}
    for name, (segment, x) in boom.observed().items():
        observers[name] = Observer(modes.displacement(segment, x, "z"))
        if boom.spatial:
            observers[f"{name}_lateral"] = Observer(modes.displacement(segment, x, "y"))
    return observers


@dataclass(frozen=True, slots=True)
class _Member:
    """A segment as loads push it, see :class:`geometry.load.Member`."""

    modes: BoomModes
    segment: int

    def force(self, x: float, direction: Direction) -> Array:
        return self.modes.displacement(self.segment, x, direction)

    def moment(self, x: float, direction: Direction) -> Array:
        return self.modes.rotation(self.segment, x, direction)

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        if span is None:
            return self.modes.unit_load(self.segment, direction)
        return self.modes.load_between(self.segment, direction, *span)

    def inertia(self, direction: Direction, force: float) -> Array:
        return force * self.uniform(direction, None)
