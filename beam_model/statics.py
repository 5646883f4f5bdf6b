# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static states and reactions: forces of supports, joints, cylinders and stops on beams.

The reaction at a node is the residual K w − f. Here K is the stiffness of a segment without
supports, f the load, and w the static deflection.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import NamedTuple

import numpy as np

from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.component import Component, SegmentModel
from protractile.beam_model.elements import Theory
from protractile.beam_model.finite_element import finite_element_segment, finite_element_segments
from protractile.beam_model.lines import lines_of_modes
from protractile.beam_model.segment_model import gap_system, system_without_drives
from protractile.beam_model.wall_compliance import with_wall_springs
from protractile.dynamics.equilibrium import equilibrium_at
from protractile.dynamics.excitation import InitialImpulse, ReleasedLoad
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import Line
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import contact_centres, pad_places
from protractile.geometry.load import Load
from protractile.geometry.section import EACH_SIDE

# Minimum number of elements of the longest segment in a boom with axial forces or tapers.
ELEMENTS_WITH_AXIAL_FORCE = 20

# Function of a gap system and the lines along its segments that returns the completed system.
Completion = Callable[[GapSystem, Sequence[Line]], GapSystem]


class NodeReaction(NamedTuple):
    """Reaction of the ground, or at a joint the force of the outer segment, on a segment."""

    segment: int  #: index of the segment
    x: float  #: position in m
    force: float  #: force along z in N
    moment: float  #: moment in N·m, positive towards a larger slope


@dataclass(frozen=True)
class StaticState:
    """Static state of a boom."""

    boom: Boom  #: the boom
    system: GapSystem  #: gap system of its beams
    position: Array  #: modal coordinates (num_modes,) in √kg·m
    _modes: BoomModes  #: modes of the segments
    _elements: Elements  #: elements of the segments
    _hung: Sequence[Load]  #: forces of loads that the boom lacks
    _time: float  #: time of the loads in s

    @cached_property
    def reactions(self) -> list[NodeReaction]:
        """The reactions on each segment, from its start to its end."""
        loaded = replace(self.boom, loads=(*self.boom.loads, *self._hung))
        position = self.position[: self._modes.omega2.size]
        net = {
            reaction[:2]: reaction
            for number, component in enumerate(self._elements.unsupported)
            for reaction in _reactions(loaded, number, component, self._modes, position, self._time)
        }
        # At a joint, the residual of the outer segment includes the force on the inner one.
        for joint in sorted(self.boom.joints, key=lambda joint: -joint.inner):
            for x in chain.from_iterable(contact_centres(self.boom, joint)):
                inner, outer = net[joint.inner, x], net[joint.outer, x]
                net[joint.outer, x] = outer._replace(
                    force=outer.force + inner.force, moment=outer.moment + inner.moment
                )
        return [*net.values()]

    @property
    def tip(self) -> float:
        """The deflection of the tip in m."""
        return float(self.system.observers["tip"].row @ self.position)


@dataclass(frozen=True)
class Elements:
    """Segments of a boom with beam elements whose static solution is exact."""

    boom: Boom  #: boom with joints bonded or with play
    #: minimum number of elements of the longest segment. Section forces need more than one, since
    #: they are interpolated between elements.
    count: int = 1

    @cached_property
    def segments(self) -> list[SegmentModel]:
        """The segments with their supports."""
        return finite_element_segments(self.boom, *self._kind, rotary_inertia=True)

    @cached_property
    def unsupported(self) -> list[Component]:
        """The components along z without supports, with nodes at all possible supports."""
        size, theory = self._kind
        components = []
        for number, segment in enumerate(self.boom.segments):
            breaks = [*_reaction_places(self.boom, number), *self.boom.stations_of(number)]
            free_segment = replace(segment, supports=())
            model = finite_element_segment(free_segment, size, breaks, theory, rotary_inertia=False)
            components.append(model.components["z"])
        return components

    @property
    def _kind(self) -> tuple[float, Theory]:
        """The element length in m, smaller with axial forces or tapers, and the theory."""
        segments, count = self.boom.segments, self.count
        if self.boom.compressed or any(one.head_section is not None for one in segments):
            count = max(count, ELEMENTS_WITH_AXIAL_FORCE)
        longest = max(segment.length for segment in segments) / count
        return longest, static_theory(self.boom)


def static_theory(boom: Boom) -> Theory:
    """Return the beam theory for statics: Timoshenko if all segments have sections."""
    all_have_sections = all(segment.section is not None for segment in boom.segments)
    return "timoshenko" if all_have_sections else "euler-bernoulli"


def static_state(
    boom: Boom,
    elements: Elements | None = None,
    walls: float = 1.0,
    time: float = 0.0,
    complete: Completion | None = None,
    hung: Sequence[Load] = (),
) -> StaticState:
    """Return the static state of a boom of beam elements with wall compliance at pads.

    Args:
        boom: boom with its loads.
        elements: elements of the boom, if available.
        walls: factor of the compliance of walls under pads, see
            :mod:`.beam_model.wall_compliance`; 0 for rigid walls.
        time: time of the loads in s.
        complete: adds what the boom lacks, such as a load on a rope; nothing unless given.
        hung: forces at t = 0 of a load that ``complete`` adds.

    Raises:
        NumericsError: there is no equilibrium.
    """
    elements = elements or Elements(boom)
    modes = BoomModes(boom, elements.segments)
    system = loaded_system(boom, modes, walls, complete)
    position = equilibrium_at(system, time)
    return StaticState(boom, system, position, modes, elements, hung, time)


def loaded_system(
    boom: Boom, modes: BoomModes, walls: float = 1.0, complete: Completion | None = None
) -> GapSystem:
    """Return the gap system of a boom of beams with wall compliance at pads and all loads.

    ``modes`` are those of the boom's segments; the other arguments are as in :func:`static_state`.
    """
    system = with_wall_springs(system_without_drives(boom, modes, EACH_SIDE), boom, walls)
    if complete is not None:
        # The coordinates of wall springs come after those of the segments.
        along = lines_of_modes(boom, modes) if boom.axial_changes else ()
        system = complete(system, [line.extend(system.num_modes) for line in along])
    return system.gather_loads()


def telescoping_system(boom: Boom) -> GapSystem:
    """Return the gap system of a boom of :class:`Elements`, with drives."""
    return gap_system(boom, Elements(boom).segments).gather_loads()


def _reaction_places(boom: Boom, number: int) -> set[float]:
    """Return the x in m of all possible supports of a segment."""
    places = {support.x for support in boom.segments[number].supports}
    places |= {stop.x for stop in boom.stops if stop.segment == number}
    places |= {jack.x for jack in boom.cylinders if jack.segment == number}
    return places | pad_places(boom, number)


def _reactions(
    boom: Boom, number: int, component: Component, modes: BoomModes, position: Array, time: float
) -> list[NodeReaction]:
    """Return the residuals of a segment at all its possible supports."""
    nodes = component.breaks
    displacements = [
        row @ position
        for x in nodes
        for row in (modes.beams[number].at("z", x, order) for order in (0, 1))
    ]
    load = component.load.copy()
    for applied_load in boom.loads:
        history = applied_load.history
        if isinstance(history, ReleasedLoad):
            factor = float(time <= 0.0)
        else:
            factor = 0.0 if isinstance(history, InitialImpulse) else history(np.array([time]))[0]
        if applied_load.segment == number and applied_load.direction == "z":
            load += factor * applied_load.push(component.beam)
    stiffness = component.stiffness - component.geometric_stiffness
    residual = (stiffness @ np.array(displacements) - load).reshape(-1, 2)
    return [
        NodeReaction(number, x, *map(float, residual[np.abs(nodes - x).argmin()]))
        for x in sorted(_reaction_places(boom, number))
    ]
