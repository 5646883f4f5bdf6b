# SPDX-License-Identifier: LGPL-3.0-or-later
"""Joints between sliding segments, stops and drives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, SkipValidation

from protractile.dynamics.contact import Gap, PowerContact
from protractile.geometry.arrays import Array
from protractile.geometry.fields import (
    MOST_STATIONS,
    BoomError,
    Category,
    Few,
    Flag,
    In,
    LawOrNone,
    LawRef,
    Length,
    NotNegative,
    Positive,
    part,
)
from protractile.geometry.place import Place, SegmentRef
from protractile.geometry.section import EACH_SIDE, Direction, Side

PadSide = Literal["above", "below", "left", "right"]

# Names of sides. Right is at positive y, as for the plates of a section.
SIDES: Mapping[PadSide, tuple[Direction, Side]] = {
    "above": ("z", 1),
    "below": ("z", -1),
    "left": ("y", -1),
    "right": ("y", 1),
}

# Number of pads that share the force on one side of a station, one beside each web.
PADS_OF_SIDE = 2

# Modulus in Pa of cast polyamide 6 with 2.5 % of moisture (data sheet of PolyJARID); 3.2e9 if dry.
POLYAMIDE = 1.9e9


@part
class Pad:
    """Slide pad: a patch on a wall of the inner segment, beside a corner.

    >>> polyamide = pt.Pad(length=0.2, width=0.06, thickness=0.02)
    >>> padded = replace(boom.joints[0], contact=None, pad=polyamide)
    >>> str(padded.law("z"))
    'k 2.28e+09, n 1'
    """

    length: Length
    """the length along x in m"""
    width: Length
    """the width from the corner inwards in m"""
    offset: Annotated[NotNegative, In("m")] = 0.0
    """the distance in m between the pad and the corner"""
    thickness: Length | None = field(default=None, kw_only=True)
    """the thickness in m, from which the joint's stiffness follows unless given"""
    lateral_thickness: Length | None = field(default=None, kw_only=True)
    """the thickness in m of the pads at the left and right; the same unless given"""
    modulus: Annotated[Positive, In("Pa")] = field(default=POLYAMIDE, kw_only=True)
    """the modulus of compression in Pa; the modulus of moist cast polyamide unless given"""
    allowable_pressure: Annotated[Positive, In("Pa")] | None = field(default=None, kw_only=True)
    """the permitted pressure in Pa; no utilisation unless given"""
    bears: Literal["wall", "corner"] = field(default="wall", kw_only=True)
    """the place of its force: on the wall, which bends, or on the corner, as of a chamfered pad or
    a pad on the web"""

    @property
    def area(self) -> float:
        """The area in m²."""
        return self.length * self.width

    @property
    def stiffness(self) -> float | None:
        """The stiffness in N/m: modulus · area / thickness; None without a thickness."""
        return None if self.thickness is None else self.modulus * self.area / self.thickness

    def span(self, x: float, overlap: tuple[float, float]) -> tuple[float, float]:
        """Return the x in m of both ends: centred at x, but shifted to fit in the overlap."""
        first, last = overlap
        start = min(max(x - 0.5 * self.length, first), last - self.length)
        return start, start + self.length


@part
class SlidePad(Pad):
    """Pair of identical pads at both corners of one wall.

    Pads on one side share the force of this side in proportion to their stiffness.

    >>> short = pt.SlidePad(length=0.1, width=0.03, side="below", thickness=0.02)
    >>> short.touches("z", -1), short.touches("z", 1)
    (True, False)
    """

    side: PadSide = field(kw_only=True)
    """the wall of the inner segment with the pad; right is at positive y"""
    thickness: Length = field(kw_only=True)
    """the thickness in m, which determines the stiffness"""
    shim: Annotated[NotNegative, In("m")] = field(default=0.0, kw_only=True)
    """the thickness in m of its shim, by which the pad protrudes into the joint's play"""

    @property
    def stiffness(self) -> float:
        """The stiffness in N/m: modulus · area / thickness."""
        return self.modulus * self.area / self.thickness

    def touches(self, direction: Direction, side: Side) -> bool:
        """Return whether the pad is on a side."""
        return SIDES[self.side] == (direction, side)


# The segment of a joint to which a station is fixed.
Carrier = Literal["outer", "inner"]

# Number of times, in addition to kinks, at which the range of a history is evaluated.
_TIMES = 1000


@dataclass(frozen=True)
class Drive:
    """Extension of the inner segment of a joint over time.

    >>> out = pt.Drive(pt.SCurve(travel=1.5, duration=3.0), carriers=("inner", "outer"))
    >>> telescoping = replace(boom, joints=(replace(boom.joints[0], drive=out),))
    >>> telescoping.joints[0].drive.reach
    (0.0, 1.5)

    Args:
        history: extension in m over time, 0 at t = 0; see :mod:`.dynamics.motion_laws`.
        carriers: segment to which each station of the joint is fixed.
        least_overlap: minimum overlap in m.
        locked: segment to which the lock is fixed, where the inner segment transfers its axial
            force.
    """

    history: Any
    carriers: tuple[Carrier, ...]
    least_overlap: float = 0.0
    locked: Carrier = "inner"

    @cached_property
    def times(self) -> Array:
        """The times (num_times,) in s of the samples of the history, from t = 0 on."""
        return sample_times(self.history)

    @cached_property
    def reach(self) -> tuple[float, float]:
        """The minimum (at most 0) and the maximum (at least 0) of the extension in m."""
        ways = self.history(self.times)
        return min(0.0, float(ways.min())), max(0.0, float(ways.max()))


def sample_times(history: Any) -> Array:
    """Return the times (num_times,) in s of samples of a history, from t = 0 on.

    Samples are evenly spaced, with additional ones at the kinks of the history.
    """
    kinks = np.array([0.0, *history.kinks])
    times = np.union1d(kinks, np.linspace(kinks.min(), kinks.max(), _TIMES))
    return np.asarray(times[times >= 0.0])


@part
class BareJoint:
    """Joint in which an inner segment slides in an outer one, without contact law and drive."""

    outer: SegmentRef
    """the name of the outer segment"""
    inner: SegmentRef
    """the name of the inner segment"""
    stations: Annotated[tuple[Place, ...], Field(min_length=1, max_length=MOST_STATIONS)]
    """the x in m at which the segments may touch, in ascending order; 'tail' is the inner segment's
    start, 'head' the outer one's end, { head = 0.2 } is 0.2 m before the end"""
    play: Annotated[NotNegative, In("m")]
    """the play in m, the sum of the clearances above and below"""
    _: KW_ONLY
    play_above: Annotated[NotNegative, In("m")] | None = None
    """the clearance in m above; half of the play unless given"""
    interference: Annotated[NotNegative, In("m")] = 0.0
    """the total interference in m of shims above and below, for a joint without play"""
    friction: Annotated[NotNegative, In("1")] = 0.0
    """the coefficient of dry friction"""
    normal_forces: Annotated[tuple[Annotated[NotNegative, In("N")], ...], Few] = ()
    """the normal forces of friction in N at each station; unless given, in space the contact forces
    of the other plane, and 0 in a flat boom with a drive, whose contacts press along the boom"""
    lateral_play: Annotated[NotNegative, In("m")] | None = None
    """the lateral play in m, the sum of left and right; it makes the boom move in space"""
    lateral_play_right: Annotated[NotNegative, In("m")] | None = None
    """the clearance in m on the right, towards larger y; half of the lateral play unless given"""
    lateral_interference: Annotated[NotNegative, In("m")] = 0.0
    """the total interference in m of lateral shims, for a joint without lateral play"""
    bonded: Flag = False
    """whether the segments are bonded at the stations, without play"""
    pad: Pad | None = None
    """the table of the slide pads, a pair on each side of each station, whose thickness sets the
    stiffness; unless given, contact is at the corners of the boxes along contact_length"""
    pads: Annotated[tuple[SlidePad, ...], Few] = ()
    """the tables of several slide pads at each station, instead of pad and stiffness; pads of a
    side share its force in proportion to their stiffness"""
    locked_at: Place | None = None
    """the x in m at which the inner segment transfers its axial force to the outer one: a locking
    pin, or, below the inner segment, the foot of the cylinder that pushes its tail; the tail unless
    given. With a drive, a place given by its distance from the tail moves with the inner segment,
    and any other place stays on the outer one"""
    contact_length: Length | None = None
    """the length along x in m of contact at the corners, usually that of a slide pad, which only
    shells use; a tenth of the least overlap unless given"""
    dashpot: Annotated[NotNegative, In("N s/m")] = 0.0
    """the linear dashpot across the play at each station in N s/m, in space also across the lateral
    play"""
    detail_category: Category | None = None
    """the number of the detail category of the welds of both segments at its stations, for
    [[spectrum]]"""

    @property
    def padded(self) -> bool:
        """True if the joint has pads of a given size."""
        return self.pad is not None or bool(self.pads)

    def pads_of(self, direction: Direction, side: Side) -> list[tuple[Pad | None, float, float]]:
        """Return (size, fraction of the force, shim in m) of each pad on a side; side 0 is both."""
        if self.pad and self.pad.lateral_thickness and direction == "y":
            return [(replace(self.pad, thickness=self.pad.lateral_thickness), 1.0, 0.0)]
        if not self.pads:
            return [(self.pad, 1.0, 0.0)]
        here = [pad for pad in self.pads if pad.touches(direction, side)]
        whole = sum(pad.stiffness for pad in here)
        return [(pad, pad.stiffness / whole, pad.shim) for pad in here]

    def pad_law(self, direction: Direction, damping: float = 0.0) -> PowerContact | None:
        """Return the contact law of each station by its pads; None if none has a thickness.

        ``damping`` is that of the law in s/m.
        """
        above, below = (
            PADS_OF_SIDE
            * sum(pad.stiffness or 0.0 for pad, *_ in self.pads_of(direction, side) if pad)
            for side in EACH_SIDE
        )
        if not (above or below):
            return None
        return PowerContact(above, 1.0, stiffness_below=below, damping=damping)


@part
class Joint(BareJoint):
    """Joint in which an inner segment slides in an outer one and touches it at stations.

    >>> (joint,) = boom.joints
    >>> boom.overlap(joint), joint.clearances("z")
    ((6.0, 8.0), (0.005, 0.005))

    Args:
        contact: law of each station across the play; by default that of the pads, if they have a
            thickness. A bonded joint needs none.
        lateral_contact: law along y; as ``contact`` unless given.
        drive: drive that telescopes the inner segment during the motion; without it the extension
            is constant.
    """

    contact: LawOrNone = None
    lateral_contact: LawOrNone = field(default=None, kw_only=True)
    drive: SkipValidation[Drive | None] = field(default=None, kw_only=True)

    def clearances(self, direction: Direction) -> tuple[float, float]:
        """Return the clearances in m: above and below along z, right and left along y.

        An interference is negative.
        """
        if direction == "z":
            play, first, interference = self.play, self.play_above, self.interference
        else:
            assert self.lateral_play is not None
            play, first = self.lateral_play, self.lateral_play_right
            interference = self.lateral_interference
        first = 0.5 * play if first is None else first
        return first - 0.5 * interference, play - first - 0.5 * interference

    def law(self, direction: Direction) -> Gap:
        """Return the contact law of each station in a direction, with its clearances.

        Raises:
            BoomError: the joint has no contact.
        """
        law = (self.lateral_contact or self.contact) if direction == "y" else self.contact
        law = law or self.pad_law(direction)
        if law is None:
            raise BoomError(
                "joint.contact",
                "missing; give a contact law, or pads with a thickness, or tie the segments of the "
                "joint",
            )
        return law.with_clearance(*self.clearances(direction))


@part
class BareStop:
    """Stop on the ground with a play, without contact law."""

    segment: SegmentRef
    """the name of the segment"""
    x: Place
    """the x in m"""
    play: Annotated[NotNegative, In("m")]
    """the play in m, the sum of above and below"""
    contact_length: Length | None = field(default=None, kw_only=True)
    """the length along x in m of contact at the corners, which only shells use; a fifth of the
    box's height unless given"""


@part
class Stop(BareStop):
    """Stop on the ground that a segment touches when it deflects along z.

    >>> rest = pt.Stop(1, 14.0, play=0.2, contact=pt.PowerContact(1e6, exponent=1.0).lower())
    >>> replace(boom, stops=(rest,)).stations[-1].name
    '14'

    Args:
        contact: law across the play; one-sided if the stop is on one side only.
    """

    contact: LawRef

    @property
    def sides(self) -> tuple[Side, ...]:
        """The sides on which the stop acts: 1 for upward deflections, −1 for downward ones."""
        return tuple(side for side in EACH_SIDE if self.contact.one_sided(side) is not None)

    @property
    def law(self) -> Gap:
        """The contact law across the play."""
        return self.contact.with_clearance(0.5 * self.play)
