# SPDX-License-Identifier: LGPL-3.0-or-later
"""Joints, in which segments slide in one another, stops and drives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, SkipValidation
from pydantic.dataclasses import dataclass as part

from geometry.arrays import Array
from geometry.boom_error import BoomError
from geometry.fields import (
    MOST_STATIONS,
    PART,
    Few,
    Flag,
    In,
    Length,
    NotNegative,
    Place,
    Positive,
    SegmentRef,
)
from geometry.section import Direction, Side

PadSide = Literal["above", "below", "left", "right"]

# Right is where y is positive, as for the plates of a section.
SIDES: Mapping[PadSide, tuple[Direction, Side]] = {
    "above": ("z", 1),
    "below": ("z", -1),
    "left": ("y", -1),
    "right": ("y", 1),
}


# Modulus in Pa of cast polyamide 6 with the 2.5 % of water that it absorbs from air, by the data
# sheet of PolyJARID; dry it has 3.2e9.
POLYAMIDE = 1.9e9


@part(frozen=True, slots=True, config=PART)
class PadSize:
    """A slide pad beside a corner: a patch of the inner segment's wall.

    >>> padded = replace(boom.joints[0], pad=pt.PadSize(length=0.2, width=0.06))
    >>> replace(boom, joints=(padded,)).joints[0].pad.length
    0.2
    """

    length: Length
    """the length along x in m"""
    width: Length
    """the width from the corner inwards in m"""
    offset: Annotated[NotNegative, In("m")] = 0.0
    """the distance in m between the pad and the corner"""
    thickness: Length | None = field(default=None, kw_only=True)
    """the thickness in m, from which the joint's stiffness follows unless given"""
    modulus: Annotated[Positive, In("Pa")] = field(default=POLYAMIDE, kw_only=True)
    """the modulus of compression in Pa; that of moist cast polyamide unless given"""
    allowable_pressure: Annotated[Positive, In("Pa")] | None = field(default=None, kw_only=True)
    """the pressure in Pa that it may bear; not judged unless given"""
    bears: Literal["wall", "corner"] = field(default="wall", kw_only=True)
    """what its force presses: the wall under it, which bends, or the corner, by a chamfered pad or
    one that lies on the web"""

    @property
    def area(self) -> float:
        """Area in m²."""
        return self.length * self.width

    @property
    def stiffness(self) -> float | None:
        """Stiffness k = E A/t in N/m; None without a thickness."""
        return None if self.thickness is None else self.modulus * self.area / self.thickness

    def span(self, x: float, overlap: tuple[float, float]) -> tuple[float, float]:
        """Return both ends in m along x: centred at x, but moved inwards where the overlap ends."""
        first, last = overlap
        start = min(max(x - 0.5 * self.length, first), last - self.length)
        return start, start + self.length


@part(frozen=True, slots=True, config=PART, kw_only=True)
class SlidePad(PadSize):
    """One of several pads at each station: a pair of them, beside both corners of a wall.

    Those of one side share its force as they are stiff.

    >>> short = pt.SlidePad(length=0.1, width=0.03, side="below", thickness=0.02)
    >>> short.touches("z", -1), short.touches("z", 1)
    (True, False)
    """

    side: PadSide
    """the wall of the inner segment that it is on; right is where y is positive"""
    thickness: Length
    """the thickness in m, from which its stiffness follows"""
    shim: Annotated[NotNegative, In("m")] = 0.0
    """how far in m it stands out beyond the play that the joint leaves"""

    @property
    def stiffness(self) -> float:
        """Stiffness k = E A/t in N/m."""
        return self.modulus * self.area / self.thickness

    def touches(self, direction: Direction, side: Side) -> bool:
        """Return whether the pad is on this side."""
        return SIDES[self.side] == (direction, side)


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
        history: history in m since the start, 0 at t = 0; a history of the dynamics.
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


@part(frozen=True, slots=True, config=PART)
class BareJoint:
    """Where an inner segment slides in an outer one, with play: all but contact law and drive."""

    outer: SegmentRef
    """the name of the outer segment"""
    inner: SegmentRef
    """the name of the inner segment"""
    stations: Annotated[tuple[Place, ...], Field(min_length=1, max_length=MOST_STATIONS)]
    """the x in m at which the two may touch, rising; 'tail' is the inner segment's start, 'head'
    the outer one's end, { head = 0.2 } lies 0.2 m before that"""
    play: Annotated[NotNegative, In("m")]
    """the play in m, the clearance above and below together"""
    _: KW_ONLY
    play_above: Annotated[NotNegative, In("m")] | None = None
    """the part of the play in m that is above; half of it unless given"""
    interference: Annotated[NotNegative, In("m")] = 0.0
    """the amount in m by which shims press the inner segment from above and below together, where
    there is no play"""
    friction: Annotated[NotNegative, In("1")] = 0.0
    """the coefficient of dry friction"""
    normal_forces: Annotated[tuple[Annotated[NotNegative, In("N")], ...], Few] = ()
    """the forces in N that press the segments at each station for the friction; in space the
    contact forces of the other plane do unless given"""
    lateral_play: Annotated[NotNegative, In("m")] | None = None
    """the play to the sides in m, left and right together; with it the boom moves in space"""
    lateral_play_right: Annotated[NotNegative, In("m")] | None = None
    """the part of the lateral play in m on the right, towards larger y; half of it unless given"""
    lateral_interference: Annotated[NotNegative, In("m")] = 0.0
    """the amount in m by which shims press from the sides, without lateral play"""
    tied: Flag = False
    """whether the two deflect alike at the stations, without play"""
    pad: PadSize | None = None
    """the table of the slide pads' size, which shells alone heed; the corners of the boxes along
    contact_length unless given"""
    pads: Annotated[tuple[SlidePad, ...], Few] = ()
    """the tables of several slide pads at each station, in place of pad and of a stiffness: on a
    side they press together, and share the force as they are stiff"""
    locked_at: Place | None = None
    """the x in m where the inner segment's axial force enters the outer one: of a locking pin, or,
    below the inner segment, of the foot of the cylinder that pushes its tail; the tail unless
    given. With a drive what is at a distance from the tail goes with the inner segment, all else
    stays on the outer one"""
    contact_length: Length | None = None
    """the length along x in m on which stations press the corners, as long as a slide pad, which
    shells alone heed; a tenth of the least overlap unless given"""
    dashpot: Annotated[NotNegative, In("N s/m")] = 0.0
    """the linear dashpot across the play at each station in N s/m, to the sides too where the boom
    moves in space"""


@part(frozen=True, slots=True, config=PART)
class Joint(BareJoint):
    """A joint in which an inner segment slides in an outer one, touching it at the stations.

    >>> (joint,) = boom.joints
    >>> boom.overlap(joint), joint.clearances("z")
    ((6.0, 8.0), (0.005, 0.005))

    Args:
        contact: law of each station across the play, a
            :class:`dynamics.contact.ContactLaw`; a bonded joint needs none.
        lateral_contact: law along y; as ``contact`` unless given.
        drive: extends the inner segment while the boom moves; without it the joint keeps its
            extension.
    """

    contact: Any = None
    lateral_contact: Any = field(default=None, kw_only=True)
    drive: SkipValidation[Drive | None] = field(default=None, kw_only=True)

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


@part(frozen=True, slots=True, config=PART)
class BareStop:
    """A rest on the ground that a segment may touch across a play: all but its contact law."""

    segment: SegmentRef
    """the name of the segment"""
    x: Place
    """the x in m"""
    play: Annotated[NotNegative, In("m")]
    """the play in m, above and below together"""
    contact_length: Length | None = field(default=None, kw_only=True)
    """the length along x in m on which it presses the corners, which shells alone heed; a fifth of
    the box's height unless given"""


@part(frozen=True, slots=True, config=PART)
class Stop(BareStop):
    """A stop on the ground that a segment meets when it deflects along z.

    >>> rest = pt.Stop(1, 14.0, play=0.2, contact=pt.PowerContact(1e6, exponent=1.0).lower())
    >>> replace(boom, stops=(rest,)).stations[-1]
    (14.0, 'z')

    Args:
        contact: law across the play, a :class:`dynamics.contact.ContactLaw`; one-sided
            where the ground is on one side alone.
    """

    contact: Any

    @property
    def sides(self) -> tuple[Side, ...]:
        """1 where it stops an upward deflection, −1 where it stops a downward one."""
        both: tuple[Side, Side] = (1, -1)
        return tuple(side for side in both if self.contact.one_sided(side) is not None)

    @property
    def law(self) -> Any:
        """Its contact law across the play."""
        return self.contact.behind(0.5 * self.play)
