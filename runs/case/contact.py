# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact between segments in a case file: joints, and the contact law of one model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from geometry.boom import Direction, PadSize, SlidePad
from geometry.section import Side
from runs.case.drive import DriveTable
from runs.case.limits import (
    MOST_STATIONS,
    CaseTable,
    Exponent,
    Few,
    Flag,
    In,
    Length,
    NotNegative,
    Number,
    Positive,
    Text,
    fault_at,
    left_out,
)
from runs.case.places import Place

if TYPE_CHECKING:
    from dynamics.contact import ContactLaw
    from dynamics.contact_table import TableContact

# Modulus in Pa of cast polyamide 6 with the 2.5 % of water that it absorbs from air, by the data
# sheet of PolyJARID; dry it has 3.2e9.
POLYAMIDE = 1.9e9

BOTH: tuple[Side, Side] = (1, -1)

# Number of pads that share the force on one side of a station, one beside each web.
PADS_OF_SIDE = 2

# Number of terms: each is evaluated for every row in every step of the time loop.
MOST_POINTS = 1000

PAD_WITHOUT_STIFFNESS = (
    "has no thickness; give the thickness in m, from which the joint's stiffness follows, or the "
    "joint's stiffness"
)

_OF_POWER = ("stiffness", "stiffness_below", "exponent")


def table_law(points: Sequence[tuple[float, float]], damping: float = 0.0) -> TableContact:
    """Return a contact law through pairs of a penetration in m and a force in N.

    Raises:
        ValueError: the law is invalid.
    """
    from dynamics.contact_table import TableContact

    depths, forces = zip(*points, strict=True)
    return TableContact(depths, forces, damping)


def _check_points(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    try:
        table_law(points)
    except ValueError as error:
        raise PydanticCustomError("unsuitable", "{what}", {"what": str(error)}) from None
    return points


def _check_law(table: JointTable | ContactTable, of_power: Sequence[str]) -> None:
    """Check that a power law has a stiffness, and that tables and pads with a thickness have none.

    Args:
        table: the table with all its keys, in any order.
        of_power: keys of power laws only.

    Raises:
        ValidationError: a key is missing or superfluous.
    """
    tables = [key for key in ("force_table", "force_file") if getattr(table, key)]
    pad = table.thick_pads if isinstance(table, JointTable) else None
    given = pad or next(iter(tables), None)
    if given is None:
        if table.stiffness is None and getattr(table, "pad", None) is not None:
            what = {"what": PAD_WITHOUT_STIFFNESS}
            raise fault_at(table, PydanticCustomError("unsuitable", "{what}", what), "pad")
        if table.stiffness is None:
            raise fault_at(table, "missing", "stiffness")
        return
    others = tables if pad else tables[1:]
    keys = others + [key for key in of_power if getattr(table, key) is not None]
    if keys:
        raise left_out(table, given, *keys)


Forces = Annotated[
    tuple[tuple[Number, Number], ...],
    In("m", "N"),
    Field(min_length=1, max_length=MOST_POINTS),
    AfterValidator(_check_points),
]


class RestitutionTable(CaseTable):
    """How much of its speed a blow gives back."""

    coefficient: Annotated[float, Field(strict=True, gt=0.0, le=1.0), In("1")]
    """the coefficient of restitution"""
    speed: Annotated[Positive, In("m/s")]
    """the speed of the impact in m/s at which it holds"""


class PadTable(CaseTable):
    """A slide pad beside a corner: a patch of the inner segment's wall."""

    length: Length
    """the length along x in m"""
    width: Length
    """the width from the corner inwards in m"""
    offset: Annotated[NotNegative, In("m")] = 0.0
    """the distance in m between the pad and the corner"""
    thickness: Length | None = None
    """the thickness in m, from which the joint's stiffness follows unless given"""
    modulus: Annotated[Positive, In("Pa")] = POLYAMIDE
    """the modulus of compression in Pa; that of moist cast polyamide unless given"""
    allowable_pressure: Annotated[Positive, In("Pa")] | None = None
    """the pressure in Pa that it may bear; not judged unless given"""

    @property
    def size(self) -> PadSize:
        """Dimensions of the contact patch."""
        return PadSize(self.length, self.width, self.offset)

    @property
    def area(self) -> float:
        """Area in m²."""
        return self.length * self.width

    @property
    def stiffness(self) -> float | None:
        """Stiffness k = E A/t in N/m."""
        return None if self.thickness is None else self.modulus * self.area / self.thickness


class SlidePadTable(PadTable):
    """One of several pads at each station: a pair of them, beside both corners of a wall."""

    side: Literal["above", "below", "left", "right"]
    """the wall of the inner segment that it is on; right is where y is positive"""
    thickness: Length
    """the thickness in m, from which its stiffness follows"""
    shim: Annotated[NotNegative, In("m")] = 0.0
    """how far in m it stands out beyond the play that the joint leaves"""

    @property
    def made(self) -> SlidePad:
        """Slide pad with its position and stiffness."""
        covered = self.length, self.width, self.offset
        return SlidePad(*covered, self.side, self.modulus * self.area / self.thickness, self.shim)


class JointTable(CaseTable):
    """Where an inner segment slides in an outer one, with play."""

    outer: str
    """the name of the outer segment"""
    inner: str
    """the name of the inner segment"""
    extension: Annotated[NotNegative, In("m")] | None = None
    """the length in m of the inner segment that is out of the outer one, where the inner one is
    given by its length"""
    drive: DriveTable | None = None
    """the table of what draws the inner segment out while the boom moves, from where it is at t =
    0; it stays there unless given"""
    stations: Annotated[tuple[Place, ...], Field(min_length=1, max_length=MOST_STATIONS)]
    """the x in m at which the two may touch, rising; 'tail' is the inner segment's start, 'head'
    the outer one's end, { head = 0.2 } lies 0.2 m before that"""
    play: Annotated[NotNegative, In("m")]
    """the play in m, the clearance above and below together"""
    play_above: Annotated[NotNegative, In("m")] | None = None
    """the part of the play in m that is above; half of it unless given"""
    interference: Annotated[NotNegative, In("m")] = 0.0
    """the amount in m by which shims press the inner segment from above and below together, where
    there is no play"""
    force_table: Forces | None = None
    """pairs of a penetration in m and a force in N, straight lines between them from 0 on, instead
    of stiffness and exponent"""
    force_file: Text | None = None
    """a CSV file of such pairs, its path seen from the case file"""
    force_columns: tuple[Text, Text] | None = None
    """the names of two columns in the heading of the file, of the penetrations and of the forces;
    its only two unless given"""
    stiffness: Annotated[Positive, In("N/m^n")] | None = None
    """the contact stiffness in N/m^n where the inner segment presses up"""
    stiffness_below: Annotated[NotNegative, In("N/m^n")] | None = None
    """the contact stiffness in N/m^n where the inner segment presses down; the same as above unless
    given"""
    exponent: Exponent | None = None
    """the exponent n of the contact law; 2 unless given"""
    restitution: RestitutionTable | None = None
    """the table of the contact's own damping; none unless given"""
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
    lateral_stiffness: Annotated[Positive, In("N/m^n")] | None = None
    """the contact stiffness to the sides in N/m^n; the same unless given"""
    lateral_exponent: Exponent | None = None
    """the exponent n to the sides; the same unless given"""
    tied: Flag = False
    """whether the two deflect alike at the stations, without play"""
    pad: PadTable | None = None
    """the table of the slide pads' size, which shells alone heed; the corners of the boxes along
    contact_length unless given"""
    pads: Annotated[tuple[SlidePadTable, ...], Few] = ()
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

    @property
    def thick_pads(self) -> str | None:
        """Key of the pads whose thickness determines a stiffness."""
        if self.pads:
            return "pads"
        return "pad.thickness" if self.pad is not None and self.pad.thickness else None

    @property
    def slide_pads(self) -> tuple[SlidePad, ...]:
        """The slide pads of ``pads``."""
        return tuple(pad.made for pad in self.pads)

    @model_validator(mode="after")
    def _pads_or_pad(self) -> Self:
        if self.pads and self.pad is not None:
            raise left_out(self, "pads", "pad")
        return self

    @model_validator(mode="after")
    def _one_law(self) -> Self:
        # To the sides, a lateral stiffness makes a power law beside any table.
        lateral = () if self.lateral_stiffness else ("lateral_exponent",)
        _check_law(self, (*_OF_POWER, *lateral))
        if self.pads and self.lateral_stiffness:
            raise left_out(self, "pads", "lateral_stiffness")
        if self.lateral_exponent and not self.lateral_stiffness and not self.pads:
            raise fault_at(self, "missing", "lateral_stiffness")
        return self

    def exponent_of(self, key: str) -> float | None:
        along_z = 1.0 if self.thick_pads and not self.stiffness else self.exponent
        return self.lateral_exponent or along_z if key == "lateral_stiffness" else along_z

    def law(self, direction: Direction) -> ContactLaw | None:
        """Return the contact law of each station along a direction; None without pads there."""
        if self.pads:
            above, below = (self._of_side(direction, side) for side in BOTH)
            return _law(self, above, below, 1.0) if above or below else None
        of_pads = PADS_OF_SIDE * self.pad.stiffness if self.pad and self.pad.stiffness else None
        exponent = self.exponent if of_pads is None or self.stiffness else 1.0
        if direction == "z":
            return _law(self, self.stiffness or of_pads, self.stiffness_below, exponent)
        stiffness = self.lateral_stiffness or self.stiffness or of_pads
        return _law(self, stiffness, None, self.lateral_exponent or exponent)

    def _of_side(self, direction: Direction, side: Side) -> float:
        """Return the stiffness of all pads on a side in N/m."""
        pads = (pad for pad in self.slide_pads if pad.touches(direction, side))
        return PADS_OF_SIDE * sum(pad.stiffness for pad in pads)


class ContactTable(CaseTable):
    """The contact law that one model uses in all joints, instead of the joints' own."""

    force_table: Forces | None = None
    """pairs of a penetration in m and a force in N, instead of the two below"""
    force_file: Text | None = None
    """a CSV file of such pairs, its path seen from the case file"""
    force_columns: tuple[Text, Text] | None = None
    """the names of two columns in the heading of the file, of the penetrations and of the forces;
    its only two unless given"""
    stiffness: Annotated[Positive, In("N/m^n")] | None = None
    """the contact stiffness in N/m^n"""
    stiffness_below: Annotated[NotNegative, In("N/m^n")] | None = None
    """the contact stiffness in N/m^n below; the same as above unless given"""
    exponent: Exponent | None = None
    """the exponent n of the contact law; 2 unless given"""
    restitution: RestitutionTable | None = None
    """the table of the contact's own damping; none unless given"""

    @model_validator(mode="after")
    def _one_law(self) -> Self:
        _check_law(self, _OF_POWER)
        return self

    def exponent_of(self, key: str) -> float:
        return self.exponent or 2.0

    def law(self, direction: Direction) -> ContactLaw:
        """Return the contact law, as of a joint."""
        below = self.stiffness_below if direction == "z" else None
        return _law(self, self.stiffness, below, self.exponent)


def _law(
    table: JointTable | ContactTable,
    stiffness: float | None,
    below: float | None,
    exponent: float | None,
) -> ContactLaw:
    from dynamics.contact import PowerContact, restitution_damping

    blow = table.restitution
    damping = 0.0 if blow is None else restitution_damping(blow.coefficient, blow.speed)
    if table.force_table is not None and stiffness is None:
        return table_law(table.force_table, damping=damping)
    assert stiffness is not None
    return PowerContact(stiffness, exponent or 2.0, stiffness_below=below, damping=damping)
