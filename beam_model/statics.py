# SPDX-License-Identifier: LGPL-3.0-or-later
"""What holds a boom at rest: forces of its supports, joints, cylinders and stops, from beams.

A segment without supports, bent as the boom at rest is, is in balance with its loads but where
something holds it. So what K w − f leaves at a node is the force that acts there, however many
supports there are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from beam_model.boom_modes import BoomModes
from beam_model.component import Component, SegmentModel
from beam_model.elements import Theory
from beam_model.finite_element import finite_element_segment, finite_element_segments
from beam_model.segment_model import gap_system, standing_system
from dynamics.equilibrium import rest_at
from dynamics.gap_system import GapSystem
from geometry.arrays import Array
from geometry.boom import Boom, Direction
from geometry.load import Member

# Of the longest segment, where axial forces soften it.
COMPRESSED_ELEMENTS = 20


class Hold(NamedTuple):
    """What holds a segment at a place, along z in N and towards a larger slope in N·m."""

    segment: int
    x: float
    force: float
    moment: float


class StaticState(NamedTuple):
    """A boom at rest under the loads of t = 0.

    Args:
        boom: what rests.
        system: of its beams.
        position: (num_modes,) of the system in √kg·m.
        holds: by segment, from its start to its end.
    """

    boom: Boom
    system: GapSystem
    position: Array
    holds: list[Hold]

    @property
    def tip(self) -> float:
        """Its deflection in m."""
        return float(self.system.observers["tip"].row @ self.position)


@dataclass(frozen=True)
class Elements:
    """The segments of a boom as elements that are exact in statics, with play or without.

    Args:
        boom: whose joints may be tied or not.
    """

    boom: Boom

    @cached_property
    def segments(self) -> list[SegmentModel]:
        """As their supports hold them."""
        return _segments(self.boom)

    @cached_property
    def unsupported(self) -> list[Component]:
        """What bends along z without their supports."""
        return [_unsupported(self.boom, number) for number in range(len(self.boom.segments))]


def static_state(
    boom: Boom,
    elements: Elements | None = None,
) -> StaticState:
    """A boom of beam elements at rest, of Timoshenko's where all sections are known.

    Args:
        boom: with its loads.
        elements: of its segments, if they are known from the same boom with play or without.

    Raises:
        NumericsError: it has no rest.
    """
    elements = elements or Elements(boom)
    modes = BoomModes(boom, elements.segments)
    system = standing_system(boom, modes).gathered()
    position = rest_at(system)
    holds = [
        hold
        for number, component in enumerate(elements.unsupported)
        for hold in _holds(boom, number, component, modes, position)
    ]
    return StaticState(boom, system, position, holds)


def drawn_out(boom: Boom) -> GapSystem:
    """The beams of :func:`static_state`, and all that its drives move."""
    return gap_system(boom, _segments(boom)).gathered()


def _segments(boom: Boom) -> list[SegmentModel]:
    return finite_element_segments(boom, _size(boom), _theory(boom), rotary_inertia=False)


def _theory(boom: Boom) -> Theory:
    known = all(segment.section is not None for segment in boom.segments)
    return "timoshenko" if known else "euler-bernoulli"


def handed_on(boom: Boom, holds: Sequence[Hold]) -> list[Hold]:
    """What holds a boom, each force once: without what segments hand on where they stand in others.

    So where a segment stands in another one, its hold is what that does to it, and elsewhere what
    the ground does.

    Args:
        boom: at rest.
        holds: of all its segments, of which those of an outer one lack what the inner one hands on.
    """
    whole = {hold[:2]: hold for hold in holds}
    for joint in sorted(boom.joints, key=lambda joint: -joint.inner):
        for x in joint.stations:
            inner, outer = whole[joint.inner, x], whole[joint.outer, x]
            whole[joint.outer, x] = outer._replace(
                force=outer.force + inner.force, moment=outer.moment + inner.moment
            )
    return [whole[hold[:2]] for hold in holds]


def _size(boom: Boom) -> float:
    """Of elements in m: the longest are exact in statics but for axial forces and tapers."""
    longest = max(segment.length for segment in boom.segments)
    tapers = any(segment.head_section is not None for segment in boom.segments)
    return longest / COMPRESSED_ELEMENTS if boom.compressed or tapers else longest


def _unsupported(boom: Boom, number: int) -> Component:
    """A segment as it bends along z without its supports, with nodes where it may be held."""
    alone = replace(boom.segments[number], supports=())
    breaks = [*_held_places(boom, number), *boom.stations_of(number)]
    model = finite_element_segment(alone, _size(boom), breaks, _theory(boom), rotary_inertia=False)
    return model.components["z"]


def _held_places(boom: Boom, number: int) -> set[float]:
    """x in m on a segment where something may hold it."""
    places = {support.x for support in boom.segments[number].supports}
    places |= {stop.x for stop in boom.stops if stop.segment == number}
    places |= {jack.x for jack in boom.cylinders if jack.segment == number}
    joints = (joint for joint in boom.joints if number in (joint.outer, joint.inner))
    return places | {x for joint in joints for x in joint.stations}


def _holds(
    boom: Boom, number: int, component: Component, modes: BoomModes, position: Array
) -> list[Hold]:
    """What is left of a segment without its supports where something may hold it."""
    nodes = component.breaks
    bent = [
        row @ position
        for x in nodes
        for row in (modes.displacement(number, x, "z"), modes.rotation(number, x, "z"))
    ]
    load = component.load.copy()
    for given in boom.loads:
        # What is over by t = 0 has no values.
        if given.segment == number and given.direction == "z" and callable(given.history):
            load += given.history(np.zeros(1))[0] * given.push(_Bare(component))
    stiffness = component.stiffness - component.softening
    left = (stiffness @ np.array(bent) - load).reshape(-1, 2)
    return [
        Hold(number, x, *map(float, left[np.abs(nodes - x).argmin()]))
        for x in sorted(_held_places(boom, number))
    ]


@dataclass(frozen=True, slots=True)
class _Bare(Member):
    """A segment's own coordinates along z as loads push them."""

    component: Component

    def force(self, x: float, direction: Direction) -> Array:
        return self.component.at(x)

    def moment(self, x: float, direction: Direction) -> Array:
        assert self.component.rotation is not None
        return self.component.rotation(x)

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        return self.component.unit_load if span is None else self.component.uniform_load(*span)

    def inertia(self, direction: Direction, force: float) -> Array:
        return force * self.component.inertia

    def torque(self, x: float) -> Array:
        return np.zeros(len(self.component.load))

    def turning(self, direction: Direction) -> Array:
        return np.zeros(len(self.component.load))
