# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a case file may say. SI units throughout; an unknown key is an error.

The descriptions are what the JSON Schema shows, and what the message for a missing key quotes.
"""

from __future__ import annotations

from abc import abstractmethod
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import PydanticCustomError

from runs.case.contact import JointTable
from runs.case.kinds import KINDS
from runs.case.kinds.model import ModelTable
from runs.case.limits import (
    MOST_MEMBERS,
    MOST_MODELS,
    MOST_SEGMENTS,
    MOST_STATIONS,
    MOST_TIMES,
    Exponent,
    Few,
    Flag,
    Name,
    NotNegative,
    Number,
    Part,
    Positive,
    StatementId,
    Table,
    Text,
    fault_at,
)
from runs.case.places import End, Place
from runs.case.sections import AnySection


class TimeTable(Table):
    """How long, and how finely reported."""

    duration: Positive = Field(description="the simulated time in s, from t = 0")
    output_step: Positive = Field(1.0e-3, description="the interval of the reported times in s")
    step: Positive | None = Field(
        None,
        description="the step of the integrator in s; each model's own, small enough for its "
        "contacts, unless given",
    )


class EnsembleTable(Table):
    """Every model with play once more, many times, with data changed a little."""

    members: Annotated[int, Field(strict=True, ge=2, le=MOST_MEMBERS)] = Field(
        description="the number of runs of each model, the unchanged one among them"
    )
    relative: Part = Field(1.0e-9, description="the largest relative change")
    seed: Annotated[int, Field(strict=True, ge=0, lt=2**63)] = Field(
        1, description="the seed of the changes: the same one gives the same members"
    )
    vary: Literal["load", "clearance"] = Field(
        "load", description="what is changed, all of it by one factor"
    )


class MaterialTable(Table):
    """Isotropic linear elasticity: the case's for all segments, or a segment's own."""

    youngs_modulus: Positive = Field(description="Young's modulus E in Pa")
    poissons_ratio: Annotated[float, Field(strict=True, gt=-1.0, lt=0.5)] = Field(
        description="Poisson's ratio"
    )
    density: Positive = Field(description="the density in kg/m^3")
    yield_strength: Positive | None = Field(
        None, description="the yield strength in Pa, beside which a run shows stresses"
    )


class SupportTable(Table):
    """A place where the ground holds a segment; in space it holds sideways and in twist too."""

    x: Place = Field(description="the x in m")
    kind: Literal["pinned", "hinged", "clamped"] = Field(
        "pinned",
        description="whether the slope is free or held; of a hinge, a pin across the boom, it is "
        "free in the plane of bending and held sideways",
    )
    stiffness: Positive | None = Field(
        None, description="the stiffness of an elastic support in N/m; rigid unless given"
    )
    rotation_stiffness: Positive | None = Field(
        None,
        description="the stiffness in N m/rad against the slopes that the kind leaves free; none "
        "unless given",
    )
    dashpot: NotNegative = Field(
        0.0, description="the linear dashpot of an elastic support in N s/m, beside its stiffness"
    )
    depth: Number = Field(
        0.0,
        description="how far in m its pin is below the segment's axis, of the first support of a "
        "segment with a cylinder",
    )


class MassTable(Table):
    """A mass on a segment."""

    x: Place = Field(description="the x in m")
    mass: Positive = Field(description="the mass in kg")


class CollarTable(Table):
    """A doubler around a segment; the walls' mid-surfaces stay where they are."""

    span: tuple[Place, Place] = Field(description="the x of its two ends in m, rising")
    thickness: Positive = Field(description="the thickness in m that it adds to all walls")


class DiaphragmTable(Table):
    """A plate that closes a segment's box, welded to its walls."""

    x: Place = Field(description="the x in m")
    thickness: Positive = Field(description="the thickness in m")


def _support(given: Any) -> Any:
    """A place alone is a pinned support."""
    place = isinstance(given, int | float | str) and not isinstance(given, bool)
    return {"x": given} if place else given


Support = Annotated[
    SupportTable, BeforeValidator(_support, json_schema_input_type=Number | End | SupportTable)
]


class SegmentTable(Table):
    """One box of the boom."""

    name: Name = Field(description="what the joints and the results call the segment")
    span: tuple[Number, Number] | None = Field(
        None, description="the x of its two ends in m, rising; or give length"
    )
    length: Positive | None = Field(
        None,
        description="the length in m of a segment whose place follows from the extension of the "
        "joint in which it slides; the first one then starts at 0",
    )
    material: MaterialTable | None = Field(
        None, description="the table of the segment's own material; the case's unless given"
    )
    supports: Annotated[tuple[Support, ...], Few] = Field(
        (), description="the places that the ground holds: an x in m each, or a table"
    )
    masses: Annotated[tuple[MassTable, ...], Few] = Field(
        (), description="the masses on the segment"
    )
    mass_per_length: Positive | None = Field(
        None, description="the mass per length in kg/m; follows from the section unless given"
    )
    second_moment_of_area: Positive | None = Field(
        None, description="the second moment of area in m^4; follows from the section unless given"
    )
    rotary_inertia: NotNegative | None = Field(
        None, description="the rotary inertia in kg m; density times second moment unless given"
    )
    height_to_width: Positive | None = Field(
        None, description="the ratio of the mid-lines of a uniform-wall box, to infer its section"
    )
    section: AnySection | None = Field(
        None,
        description="the table of the plates; unless given a box is inferred from mass and second "
        "moment, with height_to_width, or with the room in the segment around it",
    )
    load: Number = Field(
        0.0, description="the uniform load in N/m, positive upwards, applied at t = 0 and kept"
    )
    viscous_damping: NotNegative = Field(
        0.0, description="the viscous damping per length in N s/m^2"
    )
    lateral_load: Number = Field(
        0.0, description="the uniform load along y in N/m, applied at t = 0 and kept"
    )
    lateral_second_moment_of_area: Positive | None = Field(
        None,
        description="the second moment of area for bending along y in m^4; follows from the "
        "section unless given",
    )
    lateral_rotary_inertia: NotNegative | None = Field(
        None, description="the same in kg m; density times second moment unless given"
    )
    torsion_constant: Positive | None = Field(
        None, description="the torsion constant in m^4; follows from the section unless given"
    )
    polar_inertia: Positive | None = Field(
        None,
        description="the mass moment of inertia about the axis per length in kg m; follows from "
        "the section unless given",
    )
    collars: Annotated[tuple[CollarTable, ...], Few] = Field(
        (), description="the doublers around the box, which only shells have, mass and all"
    )
    diaphragms: Annotated[tuple[DiaphragmTable, ...], Few] = Field(
        (), description="the plates that close the box, which only shells have, mass and all"
    )

    @model_validator(mode="after")
    def _has_a_place(self) -> Self:
        if self.span is None and self.length is None:
            raise fault_at(self, "missing", "span")
        if self.span is not None and self.length is not None:
            what = {"what": "span is given; leave one of them out"}
            raise fault_at(self, PydanticCustomError("unsuitable", "{what}", what), "length")
        return self


class StopTable(Table):
    """A rest on the ground that a segment may touch across a play."""

    segment: str = Field(description="the name of the segment")
    x: Place = Field(description="the x in m")
    play: NotNegative = Field(description="the play in m, above and below together")
    stiffness: NotNegative = Field(
        description="the contact stiffness in N/m^n where the segment presses up; 0 for none"
    )
    stiffness_below: NotNegative | None = Field(
        None, description="the same where it presses down; the same unless given"
    )
    exponent: Exponent = Field(1.0, description="the exponent n of the contact law")
    contact_length: Positive | None = Field(
        None,
        description="the length along x in m on which it presses the corners, which shells alone "
        "heed; a fifth of the box's height unless given",
    )


class CylinderTable(Table):
    """A luffing cylinder: a spring between a lug of a segment and a point of the ground."""

    segment: str = Field(description="the name of the segment")
    x: Place = Field(description="the x of the lug in m")
    depth: Number = Field(0.0, description="how far in m the lug is below the segment's axis")
    ground: tuple[Number, Number] = Field(
        description="the other end in m: its x, and how far it is above the boom's axis"
    )
    stiffness: Positive = Field(
        description="the stiffness in N/m along its line, of two side by side together"
    )
    dashpot: NotNegative = Field(
        0.0, description="the linear dashpot in N s/m along its line, of two together"
    )
    spread: NotNegative = Field(
        0.0,
        description="the distance in m across the boom of two side by side, of a boom in space; "
        "one in the middle unless given",
    )


Times = tuple[tuple[Number, Number], ...]


class HistoryTable(Table):
    """How something goes with time: at once and kept, unless one of these is given."""

    ramp: Positive | None = Field(None, description="the time in s in which it rises to its value")
    frequency: Positive | None = Field(None, description="the frequency of a sine in Hz")
    table: Annotated[Times, Field(min_length=2, max_length=MOST_TIMES)] | None = Field(
        None,
        description="pairs of a time in s and a factor, linear between them and constant beyond",
    )
    file: Text | None = Field(
        None, description="a CSV file of such pairs, its path seen from the case file"
    )
    columns: tuple[Text, Text] | None = Field(
        None,
        description="the names of two columns in the heading of the file, of the times and of the "
        "factors; its only two unless given",
    )

    # The key of what the history multiplies.
    amount: ClassVar[str]

    @property
    @abstractmethod
    def unit(self) -> str:
        """Of the amount."""

    @model_validator(mode="after")
    def _has_an_amount(self) -> Self:
        # A file that says its unit does without.
        if self.file is None and self.amount not in self.model_fields_set:
            raise fault_at(self, "missing", self.amount)
        return self


class LoadTable(HistoryTable):
    """A load on one segment."""

    segment: str = Field(description="the name of the segment")
    direction: Literal["z", "y"] = Field("z", description="up, or to the side")
    x: Place | None = Field(
        None, description="the x in m of a point load; along the whole segment unless given"
    )
    start: Place | None = Field(
        None,
        alias="from",
        description="the x in m from which a load along the segment acts; its start unless given",
    )
    end: Place | None = Field(
        None, alias="to", description="the x in m to which it acts; the segment's end unless given"
    )
    magnitude: Number = Field(
        1.0,
        description="the load in N at x, or in N/m along the segment; the moment in N m; a factor, "
        "1 unless given, where the heading of its file says such a unit",
    )
    moment: Flag = Field(
        False, description="whether it is a moment at x, towards a larger slope of the segment"
    )
    released: Flag = Field(
        False, description="whether it has acted for ever, and is let go at t = 0"
    )

    amount: ClassVar[str] = "magnitude"

    @property
    def unit(self) -> str:
        if self.moment:
            return "N m"
        return "N/m" if self.x is None else "N"


class PayloadTable(Table):
    """A mass at the tip."""

    mass: Positive = Field(description="the mass in kg")
    gravity: NotNegative | None = Field(
        None,
        description="the acceleration in m/s^2 by which it alone weighs down from t = 0, 0 for "
        "none; 9.80665 unless given, or that of the table gravity",
    )


class GravityTable(Table):
    """By what everything weighs."""

    acceleration: NotNegative = Field(9.80665, description="the acceleration in m/s^2")
    angle: Annotated[float, Field(strict=True, ge=-90.0, le=90.0)] = Field(
        0.0, description="the luffing angle of the boom in degrees, positive where the tip is up"
    )


class BaseTable(HistoryTable):
    """An acceleration of the ground, which is felt as a load on all masses."""

    direction: Literal["z", "y"] = Field("z", description="up, or to the side")
    acceleration: Number = Field(
        1.0,
        description="the acceleration in m/s^2; a factor, 1 unless given, where the heading of its "
        "file says such a unit",
    )

    amount: ClassVar[str] = "acceleration"

    @property
    def unit(self) -> str:
        return "m/s^2"


class VelocityTable(Table):
    """How a segment moves at t = 0, as a rigid body would."""

    z: Number = Field(0.0, description="the velocity along z in m/s")
    y: Number = Field(0.0, description="the velocity along y in m/s")
    turn: Number = Field(
        0.0, description="the rate of rotation in rad/s by which the velocity along z grows with x"
    )
    lateral_turn: Number = Field(
        0.0, description="the rate of rotation in rad/s by which the velocity along y grows with x"
    )
    x: Place | None = Field(
        None, description="the x in m that has these velocities; the segment's start unless given"
    )


def _velocity(given: Any) -> Any:
    """A number alone is the velocity along z."""
    number = isinstance(given, int | float) and not isinstance(given, bool)
    return {"z": float(given)} if number else given


Velocity = Annotated[
    VelocityTable, BeforeValidator(_velocity, json_schema_input_type=Number | VelocityTable)
]


class StartTable(Table):
    """The state at t = 0."""

    state: Literal["rest", "equilibrium"] = Field(
        "rest", description="straight and unloaded, or at rest under the loads of t = 0"
    )
    velocity: dict[str, Velocity] = Field(
        default_factory=dict,
        description="segment = velocity along z in m/s, or a table with a turn besides",
    )


class ObserveTable(Table):
    """What is recorded of every model besides the ends of the segments."""

    name: Name = Field(description="what the results call it")
    segment: str = Field(description="the name of the segment")
    x: Place = Field(description="the x in m")
    quantity: Literal["deflection", "rotation", "velocity", "acceleration", "lateral", "twist"] = (
        Field(
            "deflection",
            description="the deflection along z, its velocity, its acceleration as the mean of "
            "each output interval, the rotation of the cross-section; in space the lateral "
            "deflection and the twist",
        )
    )


class DampingTable(Table):
    """Damping of the boom."""

    modal: Annotated[float, Field(strict=True, ge=0.0, lt=1.0)] = Field(
        0.0, description="the damping ratio of the boom's modes with pressed joints, 0.02 for 2 %"
    )
    mass: NotNegative = Field(0.0, description="Rayleigh's factor of the mass in 1/s")
    stiffness: NotNegative = Field(0.0, description="Rayleigh's factor of the stiffness in s")


if TYPE_CHECKING:
    Model = ModelTable
else:
    Model = Annotated[reduce(or_, KINDS.values()), Field(discriminator="kind")]


class Case(Table):
    """A boom, and the models to run on it."""

    title: Text = Field(description="the heading of the report")
    statements: Annotated[tuple[StatementId, ...], Few] = Field(
        (), description="the statements of the paper that are judged on the run"
    )
    demand: Annotated[tuple[StatementId, ...], Few] = Field(
        (), description="the statements of the paper that the run must reproduce"
    )
    time: TimeTable = Field(description="the table of the duration and the output step")
    ensemble: EnsembleTable | None = Field(
        None, description="the table of the ensembles; none are run unless given"
    )
    material: MaterialTable | None = Field(
        None,
        description="the table of the elastic constants and density of all segments that have "
        "none of their own",
    )
    segments: Annotated[tuple[SegmentTable, ...], Field(min_length=1, max_length=MOST_SEGMENTS)] = (
        Field(
            alias="segment",
            description="the segments, one [[segment]] each, from the base to the tip",
        )
    )
    joints: Annotated[tuple[JointTable, ...], Field(max_length=MOST_SEGMENTS)] = Field(
        (), alias="joint", description="the joints, one [[joint]] each, from the base to the tip"
    )
    stops: Annotated[tuple[StopTable, ...], Field(max_length=MOST_STATIONS)] = Field(
        (), alias="stop", description="the rests that segments may touch, one [[stop]] each"
    )
    cylinders: Annotated[tuple[CylinderTable, ...], Few] = Field(
        (), alias="cylinder", description="the luffing cylinders, one [[cylinder]] each"
    )
    loads: Annotated[tuple[LoadTable, ...], Few] = Field(
        (), alias="load", description="the loads that are not uniform or not constant"
    )
    payload: PayloadTable | None = Field(None, description="the table of a mass at the tip")
    gravity: GravityTable | None = Field(
        None,
        description="the table of the weight of all masses, across and along the boom; nothing "
        "weighs but the payload unless given",
    )
    base: Annotated[tuple[BaseTable, ...], Few] = Field(
        (), description="the accelerations of the ground"
    )
    observe: Annotated[tuple[ObserveTable, ...], Few] = Field(
        (), description="the places and quantities that are recorded besides, one [[observe]] each"
    )
    start: StartTable = Field(
        StartTable.model_validate({}), description="the table of the state at t = 0"
    )
    damping: DampingTable = Field(
        DampingTable.model_validate({}), description="the table of the boom's damping"
    )
    models: Annotated[tuple[Model, ...], Field(min_length=1, max_length=MOST_MODELS)] = Field(
        alias="model", description="the models to run, one [[model]] each"
    )


def case_schema() -> dict[str, Any]:
    """The JSON Schema of a case file."""
    return {"$schema": GenerateJsonSchema.schema_dialect, **Case.model_json_schema()}
