# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a designer asks of a boom, answered: part of ``summary.json``; SI units.

Forces of a section are those of the part beyond it on the part before it: the normal force pulls
where it is positive, a moment where it is positive pulls at the top (a lateral one at larger y).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from geometry.arrays import Array

# Digits that are kept of curves.
_DIGITS = 6


def rounded(values: Array | Iterable[float]) -> list[float]:
    """As a file keeps them."""
    return [float(f"{value:.{_DIGITS}g}") for value in values]


@dataclass(frozen=True, slots=True)
class Diagram:
    """A segment at rest, from its start to its end.

    Args:
        segment: its name.
        x: (num_places) in m; a place where something jumps stands twice.
        normal: N in N.
        curves: what the model knows of the other quantities of :data:`dynamics.line.Quantity`:
            ``deflection`` in m, ``shear`` in N, ``moment`` in N·m; in space ``lateral`` in m,
            ``twist`` in rad, ``lateral_shear``, ``lateral_moment``, ``torque``.
    """

    segment: str
    x: list[float]
    normal: list[float]
    curves: dict[str, list[float]]


@dataclass(frozen=True, slots=True)
class Tilt:
    """What a joint gives way by its play and by what its contacts are pressed in.

    Args:
        inner, outer: names of the segments.
        rotation: of the inner one in the outer one in rad, towards a larger slope.
        tip: what that moves the tip by as a lever, in m.
    """

    inner: str
    outer: str
    rotation: float
    tip: float


@dataclass(frozen=True, slots=True)
class Pressed:
    """A station.

    Args:
        place: its name, as trajectories have it.
        x: in m.
        direction: z or y.
        force: in N, positive where the inner segment presses up (along y: towards larger y).
        pad: force of each pad that bears it in N, not negative; None without pads.
        depth: how far the contact that is pressed most is pressed in, in m.
    """

    place: str
    x: float
    direction: str
    force: float
    pad: float | None
    depth: float


@dataclass(frozen=True, slots=True)
class Reaction:
    """What a support, a cylinder or a stop does to a segment at x in m.

    Args:
        segment: its name.
        x: in m.
        force: along z in N.
        moment: towards a larger slope in N·m.
        depth: how far a stop is pressed in, in m; None of what does not give way so.
    """

    segment: str
    x: float
    force: float
    moment: float
    depth: float | None


@dataclass(frozen=True, slots=True)
class AtRest:
    """A model of the boom at rest.

    Args:
        time: whose loads act, in s.
        tip: its deflection in m.
        tip_lateral: likewise along y, in space.
        diagrams: of each segment.
        tilts: of the joints with play and two stations at least.
        stations: of the joints with play, and of stops.
        cylinders: forces along them in N by the names of the results.
    """

    time: float
    tip: float
    tip_lateral: float | None
    diagrams: list[Diagram]
    tilts: list[Tilt]
    stations: list[Pressed]
    cylinders: dict[str, float]


@dataclass(frozen=True, slots=True)
class ModelAnswers:
    """Of one model.

    Args:
        rests: under the loads of t = 0, and where these change also those of the instants at which
            they are largest; none where it has no rest.
        tied: the same without play; of a shell those of Timoshenko elements.
    """

    rests: list[AtRest] = field(default_factory=list)
    tied: list[AtRest] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Answers:
    """Of a run.

    Args:
        models: by their names.
        reactions: at rest under the loads of t = 0, of beam elements, as ``check`` has them; none
            where there is no rest.
        tied_reactions: the same without play.
    """

    models: dict[str, ModelAnswers]
    reactions: list[Reaction] = field(default_factory=list)
    tied_reactions: list[Reaction] = field(default_factory=list)
