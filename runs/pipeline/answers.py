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
_DIGITS = 5


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
        pad: the most that one of its pads bears in N, not negative, where those of a side share its
            force as they are stiff and shims press first; None without pads.
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
        along: along the boom, towards its tip, in N.
    """

    segment: str
    x: float
    force: float
    moment: float
    depth: float | None
    along: float = 0.0


@dataclass(frozen=True, slots=True)
class AtRest:
    """A model of the boom at rest.

    Args:
        time: whose loads act, and as far drawn out as it is then, in s.
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
class Shape:
    """How a segment moves in a mode: at x in m ``deflection``, in space ``lateral``, ``twist``."""

    segment: str
    x: list[float]
    curves: dict[str, list[float]]


@dataclass(frozen=True, slots=True)
class Mode:
    """A mode of the boom with its joints pressed as they are at rest.

    Args:
        frequency: in Hz.
        way: what moves most: ``bending in z``, ``bending in y``, ``twist``.
        number: among the model's modes of this way, from 1 on.
        share: of that way in the kinetic energy, from 0 to 1.
        shapes: of each segment, what moves most 1 m or 1 rad at most.
    """

    frequency: float
    way: str
    number: int
    share: float
    shapes: list[Shape]


@dataclass(frozen=True, slots=True)
class Match:
    """A mode of another model that is that of the reference.

    Args:
        number: among the other model's modes, from 1 on.
        frequency: in Hz.
        off: by what part it differs from the reference's.
        alike: the modal assurance criterion of both shapes, from 0 to 1.
    """

    number: int
    frequency: float
    off: float
    alike: float


@dataclass(frozen=True, slots=True)
class ModesBeside:
    """The modes of all models beside those of a reference.

    Args:
        reference: the name of the model.
        matches: of each other model with play, for each mode of the reference; None where it has
            none like it.
    """

    reference: str
    matches: dict[str, list[Match | None]]


@dataclass(frozen=True, slots=True)
class Envelope:
    """What a segment has gone through: the least and the largest of every curve of a diagram.

    Args:
        segment: its name.
        x: (num_places) in m; a place where something jumps stands twice.
        low, high: of each curve over the run, as of :class:`Diagram`.
    """

    segment: str
    x: list[float]
    low: dict[str, list[float]]
    high: dict[str, list[float]]


@dataclass(frozen=True, slots=True)
class FibreStress:
    """The stress along x in an outer fibre of a segment where it is largest, of section forces.

    Args:
        segment: its name.
        x, y, z: where, in m; y is 0 in a flat boom.
        stress: in Pa, positive where it pulls.
        time: when, in s.
        utilisation: of the yield strength; None where the case does not tell that.
        at_rest: the largest |stress| of the segment at rest under the largest loads in Pa; None
            where there is no rest.
    """

    segment: str
    x: float
    y: float
    z: float
    stress: float
    time: float
    utilisation: float | None
    at_rest: float | None


@dataclass(frozen=True, slots=True)
class WallStress:
    """The largest von Mises stresses of a shell's segment near stations and supports.

    Args:
        segment: its name.
        x: of the place near which the patch is, in m.
        patch: the mean over a patch of a wall in Pa, which settles as the mesh refines.
        time: of that, in s.
        triangle: of any triangle in Pa, which may grow as the mesh refines.
        utilisation: of the patch, as of :class:`FibreStress`.
    """

    segment: str
    x: float
    patch: float
    time: float
    triangle: float
    utilisation: float | None


@dataclass(frozen=True, slots=True)
class Peak:
    """The largest of a motion beside the largest at rest, by their absolute values.

    Args:
        what: ``deflection``, ``contact force``, ``cylinder force``, ``reaction``, where something
            acts along the boom also ``reaction along the boom`` and ``reaction, across and along``,
            ``moment at the support`` or ``bending moment``; in space those to the sides, called
            ``lateral``, and ``torque at the support``.
        where: the place, as the results or the case name it.
        unit: of the SI.
        largest: of the motion; of contacts the mean over an output interval, which is what a pad
            feels, not the peak of a blow.
        time: when, in s.
        at_rest: the largest at rest under the largest loads, wherever it is drawn to; None where
            there is no rest.
    """

    what: str
    where: str
    unit: str
    largest: float
    time: float
    at_rest: float | None

    @property
    def factor(self) -> float | None:
        """The dynamic factor; None where nothing is at rest."""
        return self.largest / self.at_rest if self.at_rest else None


@dataclass(frozen=True, slots=True)
class Moved:
    """What a model has gone through.

    Args:
        envelopes: of each segment.
        peaks: largest over static.
        fibres: of each segment whose section is known; none of rigid ones.
        walls: of shells.
    """

    envelopes: list[Envelope]
    peaks: list[Peak]
    fibres: list[FibreStress]
    walls: list[WallStress]


@dataclass(frozen=True, slots=True)
class Life:
    """What the stress of a segment's outer fibre does to a detail there, where it varies most.

    Args:
        segment: its name.
        x, y, z: where, in m.
        cycles: how many are counted in the run, of whatever range.
        largest: range in Pa.
        equivalent: the range in Pa that, once in a run, does as much as all of them at a slope
            of 3.
        ranges: (num_classes) the middles of classes of ranges in Pa, rising, and
        counts: how many cycles each has.
        damage: of the run, of the case's detail category; None without one.
        life_damage: of as many runs as the case tells.
    """

    segment: str
    x: float
    y: float
    z: float
    cycles: float
    largest: float
    equivalent: float
    ranges: list[float]
    counts: list[float]
    damage: float | None
    life_damage: float | None


@dataclass(frozen=True, slots=True)
class Swing:
    """How far the tip swings while the boom is drawn out, and afterwards.

    A swing is the largest distance of the tip from where it would rest, drawn out as far as it is
    and under the loads of that moment.

    Args:
        tip: the swing in m.
        time: when it is, in s.
        speed: the mean speed of the fastest drive while it moves, in m/s.
        where_begun, where_ended: those of the same boom that stands where drives begin and end,
            under the same loads, in m; None where that cannot be computed.
    """

    tip: float
    time: float
    speed: float
    where_begun: float | None
    where_ended: float | None


@dataclass(frozen=True, slots=True)
class ModelAnswers:
    """Of one model.

    Args:
        rests: under the loads of t = 0, and where these change also those of the instants at which
            they are largest; none where it has no rest.
        drawn: where drives have drawn it farthest out or in, under the loads of then and under the
            largest while it is there.
        tied: as ``rests``, without play; of the instants at which drives have it where it begins.
        modes: the first ones at rest under the loads of t = 0; none where it has no rest.
        tied_modes: of what ``tied`` is of, without their shapes.
        moved: over the run.
        tied_moved: what it would have gone through without play; None without any, and where that
            cannot be computed. Walls of shells are left out.
        life: of each segment whose section is known, where cycles can be counted.
        tied_life: likewise without play.
        swing: while it is drawn out; None where it is not, before drives end, and without a rest.
    """

    rests: list[AtRest] = field(default_factory=list)
    drawn: list[AtRest] = field(default_factory=list)
    tied: list[AtRest] = field(default_factory=list)
    modes: list[Mode] = field(default_factory=list)
    tied_modes: list[Mode] = field(default_factory=list)
    moved: Moved | None = None
    tied_moved: Moved | None = None
    life: list[Life] = field(default_factory=list)
    tied_life: list[Life] = field(default_factory=list)
    swing: Swing | None = None

    @property
    def farthest_rest(self) -> AtRest | None:
        """That whose tip is farthest, wherever it is drawn to; None without any."""
        return max([*self.rests, *self.drawn], key=lambda rest: abs(rest.tip), default=None)


@dataclass(frozen=True, slots=True)
class Added:
    """What play adds to a number.

    Args:
        what: as of :class:`Peak`, or ``deflection at rest``, ``first frequency``, ``stress``.
        where: the place; empty where it is of the whole boom.
        unit: of the SI.
        played, tied: the number with play and without, by its absolute value.
    """

    what: str
    where: str
    unit: str
    played: float
    tied: float

    @property
    def added(self) -> float:
        """In the unit."""
        return self.played - self.tied

    @property
    def share(self) -> float | None:
        """Of the number without play; None where that is nothing."""
        return self.added / self.tied if self.tied else None


@dataclass(frozen=True, slots=True)
class PlayAdds:
    """What play adds in one model.

    Args:
        model: with play.
        numbers: at rest, of the modes, of the motions, each beside that of the same model without
            play.
    """

    model: str
    numbers: list[Added]


@dataclass(frozen=True, slots=True)
class QualityNote:
    """How far numbers can be trusted: one line.

    Args:
        what: ``agreement``, ``horizon``, ``reduction``, ``mesh``, ``energy`` or ``step``.
        line: says it.
    """

    what: str
    line: str


@dataclass(frozen=True, slots=True)
class Answers:
    """Of a run.

    Args:
        models: by their names.
        reactions: at rest under the loads of t = 0, of beam elements, as ``check`` has them; none
            where there is no rest.
        tied_reactions: the same without play.
        modes: of the models side by side; None where fewer than two have any.
        play: of each model with play.
        trust: how far to trust them.
    """

    models: dict[str, ModelAnswers]
    reactions: list[Reaction] = field(default_factory=list)
    tied_reactions: list[Reaction] = field(default_factory=list)
    modes: ModesBeside | None = None
    play: list[PlayAdds] = field(default_factory=list)
    trust: list[QualityNote] = field(default_factory=list)
