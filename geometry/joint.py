# SPDX-License-Identifier: LGPL-3.0-or-later
"""Joints, in which segments slide in one another, stops and drives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from geometry.arrays import Array
from geometry.fault import BoomError
from geometry.section import Direction, SegmentRef, Side

PadSide = Literal["above", "below", "left", "right"]

# Right is where y is positive, as for the plates of a section.
SIDES: Mapping[PadSide, tuple[Direction, Side]] = {
    "above": ("z", 1),
    "below": ("z", -1),
    "left": ("y", -1),
    "right": ("y", 1),
}


@dataclass(frozen=True, slots=True)
class PadSize:
    """A slide pad: its length along x, its width from a corner inwards, how far from that, in m.

    >>> padded = replace(boom.joints[0], pad=pt.PadSize(length=0.2, width=0.06))
    >>> replace(boom, joints=(padded,)).joints[0].pad.length
    0.2
    """

    length: float
    width: float
    offset: float = 0.0

    def span(self, x: float, overlap: tuple[float, float]) -> tuple[float, float]:
        """Return both ends in m along x: centred at x, but moved inwards where the overlap ends."""
        first, last = overlap
        start = min(max(x - 0.5 * self.length, first), last - self.length)
        return start, start + self.length


@dataclass(frozen=True, slots=True)
class SlidePad(PadSize):
    """One of several pads at each station of a joint: a pair, beside both corners of a wall.

    >>> short = pt.SlidePad(length=0.1, width=0.03, side="below", stiffness=2e8)
    >>> short.touches("z", -1), short.touches("z", 1)
    (True, False)

    Args:
        side: on which wall of the inner segment.
        stiffness: beside which those of the same side share its force, in N/m.
        shim: its protrusion into the joint's play in m.
    """

    side: PadSide = "below"
    stiffness: float = 1.0
    shim: float = 0.0

    def touches(self, direction: Direction, side: Side) -> bool:
        """Return whether the pad is on this side."""
        return SIDES[self.side] == (direction, side)


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint in which an inner segment slides in an outer one, touching it at the stations.

    >>> (joint,) = boom.joints
    >>> boom.overlap(joint), joint.clearances("z")
    ((6.0, 8.0), (0.005, 0.005))

    Args:
        outer, inner: names of the two; in a boom their positions in ``Boom.segments``.
        stations: x at which they may touch, rising.
        play: 2Δ in m, the clearance above and below together.
        contact: law of each station across the play, a
            :class:`dynamics.contact.ContactLaw`; a bonded joint needs none.
        lateral_play: the play along y in m; None in a flat boom.
        lateral_contact: law along y; as ``contact`` unless given.
        play_above, lateral_play_right: the part of a play in m that is there; half of it unless
            given.
        interference, lateral_interference: total preload by shims on both sides in m, where
            there is no play.
        friction: μ of (28), and of (10) and (11) in space.
        normal_forces: N of (28) in N, one for each station; empty in space, where the
            contact force of the other plane is the normal force.
        tied: bonded: the segments deflect (and in space twist) alike at the stations.
        pad: size of the slide pads in the corners; without it shells touch in the corners.
        pads: several pads at each station, in place of ``pad``.
        contact_length: of these in m; a tenth of the overlap unless given.
        dashpot: of each station along each direction in N·s/m, across the play.
        locked_at: x in m where the inner segment's axial force enters the outer one, at a pin;
            below the inner segment, the foot of the cylinder that pushes its tail. The tail unless
            given.
        drive: extends the inner segment while the boom moves; without it the joint keeps its
            extension.
    """

    outer: SegmentRef
    inner: SegmentRef
    stations: tuple[float, ...]
    play: float
    contact: Any = None
    _: KW_ONLY
    lateral_play: float | None = None
    lateral_contact: Any = None
    play_above: float | None = None
    lateral_play_right: float | None = None
    interference: float = 0.0
    lateral_interference: float = 0.0
    friction: float = 0.0
    normal_forces: tuple[float, ...] = ()
    tied: bool = False
    pad: PadSize | None = None
    pads: tuple[SlidePad, ...] = ()
    contact_length: float | None = None
    dashpot: float = 0.0
    locked_at: float | None = None
    drive: Drive | None = None

    def clearances(self, direction: Direction) -> tuple[float, float]:
        """Return the clearances above and below in m, along y right and left; < 0 with preload."""
        if direction == "z":
            play, first, pressed = self.play, self.play_above, self.interference
        else:
            assert self.lateral_play is not None
            play, first = self.lateral_play, self.lateral_play_right
            pressed = self.lateral_interference
        first = 0.5 * play if first is None else first
        return first - 0.5 * pressed, play - first - 0.5 * pressed

    def law(self, direction: Direction) -> Any:
        """Return the contact law of each station along a direction, across its clearances.

        Raises:
            BoomError: the joint has no contact.
        """
        law = (self.lateral_contact or self.contact) if direction == "y" else self.contact
        if law is None:
            raise BoomError(
                "joint.contact", "missing; give a contact law, or tie the segments of the joint"
            )
        return law.behind(*self.clearances(direction))

    @property
    def padded(self) -> bool:
        """True if it has pads of a given size."""
        return self.pad is not None or bool(self.pads)

    def pads_of(
        self, direction: Direction, side: Side
    ) -> list[tuple[PadSize | None, float, float]]:
        """Return size, share of the side's force, and shim in m of its pads; 0 means both sides."""
        if not self.pads:
            return [(self.pad, 1.0, 0.0)]
        here = [pad for pad in self.pads if pad.touches(direction, side)]
        whole = sum(pad.stiffness for pad in here)
        return [(pad, pad.stiffness / whole, pad.shim) for pad in here]

    @property
    def without_play(self) -> Joint:
        """The same joint with the segments bonded at its stations."""
        return replace(
            self, tied=True, pad=None, pads=(), contact_length=None, dashpot=0.0, drive=None
        )


@dataclass(frozen=True, slots=True)
class Stop:
    """A stop on the ground that a segment meets when it deflects along z.

    >>> rest = pt.Stop(1, 14.0, play=0.2, contact=pt.PowerContact(1e6, exponent=1.0).lower())
    >>> replace(boom, stops=(rest,)).stations[-1]
    (14.0, 'z')

    Args:
        segment: its name; in a boom its position.
        x: m.
        play: 2Δ in m, half of it each way.
        contact: law across the play, a :class:`dynamics.contact.ContactLaw`; one-sided
            where the ground is on one side alone.
        contact_length: of the segment's corners that it presses, in m; a fifth of the height of
            its box unless given.
    """

    segment: SegmentRef
    x: float
    play: float
    contact: Any
    contact_length: float | None = None

    @property
    def sides(self) -> tuple[Side, ...]:
        """1 where it stops an upward deflection, −1 where it stops a downward one."""
        both: tuple[Side, Side] = (1, -1)
        return tuple(side for side in both if self.contact.one_sided(side) is not None)

    @property
    def law(self) -> Any:
        """Its contact law across the play."""
        return self.contact.behind(0.5 * self.play)


# The segment of its joint on which a station sits and with which it moves.
Carrier = Literal["outer", "inner"]

# Number of times at which the range of a history is evaluated beside its kinks.
_TIMES = 1000


@dataclass(frozen=True)
class Drive:
    """Extension of the inner segment of a joint over time.

    >>> out = pt.Drive(pt.SCurve(travel=1.5, duration=3.0), carriers=("inner", "outer"))
    >>> drawn = replace(boom, joints=(replace(boom.joints[0], drive=out),))
    >>> drawn.joints[0].drive.reach
    (0.0, 1.5)

    Args:
        history: in m since the start, 0 at t = 0; a history of the dynamics.
        carriers: the segment to which each station of the joint is fixed.
        least_overlap: minimum overlap in m.
        locked: the segment to which the place is fixed where the inner one's axial force passes.
    """

    history: Any
    carriers: tuple[Carrier, ...]
    least_overlap: float = 0.0
    locked: Carrier = "inner"

    @cached_property
    def times(self) -> Array:
        """Times (num_times,) from t = 0 on in s, with its kinks."""
        kinks = np.array([0.0, *self.history.kinks])
        times = np.union1d(kinks, np.linspace(kinks.min(), kinks.max(), _TIMES))
        return np.asarray(times[times >= 0.0])

    @cached_property
    def reach(self) -> tuple[float, float]:
        """Smallest extension, not above 0, and largest one, not below 0, in m."""
        ways = self.history(self.times)
        return min(0.0, float(ways.min())), max(0.0, float(ways.max()))
