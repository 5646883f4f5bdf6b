# SPDX-License-Identifier: LGPL-3.0-or-later
"""Schema of a case file, in SI units by default; an unknown key is an error.

The string below a key is its description in the JSON Schema and in messages.
"""

from __future__ import annotations

from functools import reduce
from math import radians, sin
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, create_model, model_validator
from pydantic.dataclasses import dataclass

from protractile.geometry.chassis import Chassis
from protractile.geometry.cylinder import Cylinder
from protractile.geometry.fields import (
    MOST_STATIONS,
    PART,
    Few,
    In,
    NotNegative,
    Number,
    Positive,
    is_number,
    rising,
)
from protractile.geometry.head import Head
from protractile.geometry.joint import BareStop
from protractile.geometry.material import Material
from protractile.geometry.observation import Observation, Recorded
from protractile.geometry.place import Place
from protractile.geometry.support import Support
from protractile.geometry.units import System, SystemName
from protractile.runs import clients
from protractile.runs.case.combination_tables import (
    CombinationTable,
    LoadCaseTable,
    SpectrumTable,
)
from protractile.runs.case.contact import JointTable
from protractile.runs.case.inherited import schema_of_file
from protractile.runs.case.kinds import KINDS
from protractile.runs.case.kinds.calibration import CalibratedTable
from protractile.runs.case.kinds.model import ModelTable
from protractile.runs.case.limits import (
    MOST_MEMBERS,
    MOST_MODELS,
    MOST_SEGMENTS,
    CaseTable,
    Count,
    Exponent,
    LimitsTable,
    Part,
    Text,
    unsuitable,
    validation_error,
)
from protractile.runs.case.load_tables import (
    AxialTable,
    GroundAccelerationTable,
    LoadTable,
    PayloadTable,
    RopeTable,
    TelescopingTable,
    WindPressureTable,
)
from protractile.runs.case.motion_tables import HoistTable, LuffTable, SlewTable
from protractile.runs.case.sections import PinnedMassTable, SegmentTable


class TimeTable(CaseTable):
    """Duration, output interval and time step."""

    duration: Annotated[Positive, In("s")] = 2.0
    """the simulated time in s, from t = 0; 2 s unless given, if nothing changes over time"""
    output_step: Annotated[Positive, In("s")] = 1.0e-3
    """the interval of the reported times in s"""
    step: Annotated[Positive, In("s")] | None = None
    """the time step in s; chosen by the tolerance unless given"""
    tolerance: Annotated[Part, Field(ge=1.0e-8)] = 1.0e-3
    """the permitted error of the deflections by the time step, as a fraction of their range"""


class EnsembleTable(CaseTable):
    """Repeated runs of every model with play under slightly changed data."""

    members: Annotated[int, Field(strict=True, ge=2, le=MOST_MEMBERS)]
    """the number of runs of each model, including the unchanged one"""
    relative: Part = 1.0e-9
    """the largest relative change"""
    seed: Annotated[int, Field(strict=True, ge=0, lt=2**63)] = 1
    """the seed of the random changes; the same seed gives the same members"""
    vary: Literal["load", "clearance"] = "load"
    """the data to change, all by the same factor"""


@dataclass(frozen=True, slots=True, config=PART, kw_only=True)
class StopTable(BareStop):
    """A stop on the ground that a segment touches after a play."""

    stiffness: Annotated[NotNegative, In("N/m^n")]
    """the contact stiffness in N/m^n for upward pressure of the segment; 0 for none"""
    stiffness_below: Annotated[NotNegative, In("N/m^n")] | None = None
    """the contact stiffness in N/m^n for downward pressure; as upwards unless given"""
    exponent: Exponent = 1.0
    """the exponent n of the contact law"""


class GravityTable(CaseTable):
    """Weight of all masses, by the luffing angle and the acceleration."""

    acceleration: Annotated[NotNegative, In("m/s^2")] = 9.80665
    """the acceleration in m/s^2"""
    angle: Annotated[float, Field(strict=True, ge=-90.0, le=90.0), In("deg")] = 0.0
    """the luffing angle of the boom in degrees, positive where the tip is up"""

    @property
    def sine(self) -> float:
        """The sine of the luffing angle θ."""
        return sin(radians(self.angle))

    @property
    def cosine(self) -> float:
        """The cosine of the luffing angle θ, exactly 0 at 90 degrees."""
        return sin(radians(90.0 - abs(self.angle)))

    @property
    def across(self) -> float:
        """The component g cos θ in m/s², towards −z."""
        return self.acceleration * self.cosine

    @property
    def along(self) -> float:
        """The component g sin θ in m/s², towards the base."""
        return self.acceleration * self.sine


class VelocityTable(CaseTable):
    """Rigid-body velocity of a segment at t = 0."""

    z: Annotated[Number, In("m/s")] = 0.0
    """the velocity along z in m/s"""
    y: Annotated[Number, In("m/s")] = 0.0
    """the velocity along y in m/s"""
    turn: Annotated[Number, In("rad/s")] = 0.0
    """the rate of rotation in rad/s by which the velocity along z grows with x"""
    lateral_turn: Annotated[Number, In("rad/s")] = 0.0
    """the rate of rotation in rad/s by which the velocity along y grows with x"""
    x: Place | None = None
    """the x in m of the point with these velocities; the segment's start unless given"""


# A plain number is the velocity along z.
Velocity = Annotated[
    VelocityTable,
    BeforeValidator(
        lambda value: {"z": float(value)} if is_number(value) else value,
        json_schema_input_type=Annotated[Number, In("m/s")] | VelocityTable,
    ),
]


# Key that a plain number sets if it stands in place of the table.
PLAIN_NUMBER_KEYS = {Support: "x", VelocityTable: "z", WindPressureTable: "pressure"}


class StartTable(CaseTable):
    """The state at t = 0."""

    state: Literal["rest", "equilibrium"] = "rest"
    """straight and unloaded, or at rest under the loads at t = 0"""
    velocity: dict[str, Velocity] = Field(default_factory=dict)
    """segment = velocity along z in m/s, or a table with further components"""

    @property
    def at_rest(self) -> bool:
        """True if the boom starts at rest under the loads at t = 0."""
        return self.state == "equilibrium"


@dataclass(frozen=True, slots=True, config=PART)
class ObserveTable(Observation):
    """Additional output of every model, besides the ends of the segments."""

    quantity: Recorded = "deflection"
    """the quantity: deflection along z, its velocity, its acceleration as the mean over each output
    interval, rotation of the cross-section; in space also lateral deflection and twist"""


class DampingTable(CaseTable):
    """Damping of the boom."""

    modal: Annotated[float, Field(strict=True, ge=0.0, lt=1.0), In("1")] = 0.0
    """the damping ratio of the boom's modes with closed contacts, 0.02 for 2 %"""
    mass: Annotated[NotNegative, In("1/s")] = 0.0
    """Rayleigh's mass-proportional factor in 1/s"""
    stiffness: Annotated[NotNegative, In("s")] = 0.0
    """Rayleigh's stiffness-proportional factor in s"""


class LifeTable(CaseTable):
    """Data of the fatigue and wear of a run."""

    detail_category: Annotated[Positive, In("1")] | None = None
    """the number of the worst weld's detail category by EN 1993-1-9: 71 for 71 N/mm^2; without it
    stress ranges are counted, and no damage is computed"""
    partial_factor: Annotated[Positive, In("1")] = 1.0
    """the partial factor gamma_Ff gamma_Mf on stress ranges"""
    repeats: Annotated[int, Field(strict=True, ge=1, le=10**9)] = 1
    """the number of occurrences of this motion in the service life"""
    wear: Annotated[Positive, In("1")] | None = None
    """Archard's coefficient of wear of the slide pads in mm^3/(N m), in all systems of units, for
    their wear in motions that telescope; no wear unless given"""


class BucklingTable(CaseTable):
    """Data of the buckling analysis of walls, in the state of largest static tip deflection."""

    modes: Count = 1
    """the number of buckling modes of the walls of each segment of a shell; beams have estimates by
    panel formulas"""
    curve: Annotated[
        tuple[tuple[NotNegative, Annotated[float, Field(strict=True, gt=0.0, le=1.0)]], ...],
        In("1", "1"),
        rising("slendernesses", falling="reduction factors", least=2),
    ] = ()
    """pairs of a slenderness and the reduction of the strength there, for proofs; unless given,
    Winter's curve, and for shear the curve of EN 1993-1-5; beyond the last pair the factor falls
    with the square of the slenderness"""


if TYPE_CHECKING:
    Model = ModelTable

    class ClientKeys(CaseTable):
        """The keys of all clients."""
else:
    Model = Annotated[reduce(or_, KINDS.values()), Field(discriminator="kind")]
    _KEYS = [client.Keys for client in clients.modules("keys")]
    ClientKeys = create_model("ClientKeys", __base__=(*_KEYS, CaseTable))


class CaseHeading(CaseTable):
    """Title and units of a case."""

    title: Text
    """the heading of the report"""
    units: SystemName = "SI"
    """the units of all numbers: SI, or mm, t and s with N and MPa ('mm-t-s', the same as 'N-mm')"""
    shown_units: SystemName | None = None
    """the units in tables of check and in sweeps; the units of the case unless given"""


class Case(ClientKeys, CaseHeading):
    """A boom, and the models to run on it."""

    time: TimeTable = TimeTable.model_validate({})
    """the table of the duration and the output step"""
    ensemble: EnsembleTable | None = None
    """the table of the ensembles; no ensembles unless given"""
    material: Material | None = None
    """the table of elastic constants and density, of segments without a material of their own"""
    segments: Annotated[tuple[SegmentTable, ...], Field(min_length=1, max_length=MOST_SEGMENTS)] = (
        Field(alias="segment")
    )
    """the segments, one [[segment]] each, from the base to the tip"""
    joints: Annotated[tuple[JointTable, ...], Field(max_length=MOST_SEGMENTS)] = Field(
        (), alias="joint"
    )
    """the joints, one [[joint]] each, from the base to the tip"""
    telescoping: TelescopingTable | None = None
    """the table of the fraction of the stroke to which the boom is telescoped; the extensions of
    the joints unless given"""
    pinned_masses: Annotated[tuple[PinnedMassTable, ...], Few] = Field((), alias="pinned_mass")
    """the masses inside the boom that two segments carry, one [[pinned_mass]] each"""
    stops: Annotated[tuple[StopTable, ...], Field(max_length=MOST_STATIONS)] = Field(
        (), alias="stop"
    )
    """the stops that segments may touch, one [[stop]] each"""
    cylinders: Annotated[tuple[Cylinder, ...], Few] = Field((), alias="cylinder")
    """the luffing cylinders, one [[cylinder]] each"""
    chassis: Chassis | None = None
    """the table of the undercarriage, for tipping, outrigger forces and the radii of load charts"""
    loads: Annotated[tuple[LoadTable, ...], Few] = Field((), alias="load")
    """the loads that are not uniform or not constant"""
    axial: Annotated[tuple[AxialTable, ...], Few] = ()
    """the forces along the boom, one [[axial]] each"""
    payload: PayloadTable | None = None
    """the table of a mass at the tip"""
    head: Head | None = None
    """the table of the boom's head, with the place where payload and load hang; the end of the last
    segment unless given"""
    rope: RopeTable | None = None
    """the table of the hoist rope, whose lead presses the boom; no rope unless given"""
    wind: WindPressureTable | None = None
    """the table of the wind on the segments and the load; a load case may have its own"""
    gravity: GravityTable | None = None
    """the table of the weight of all masses, across and along the boom; unless given, only the
    payload has weight"""
    hoist: HoistTable | None = None
    """the table of a load on a rope below the tip"""
    slew: SlewTable | None = None
    """the table of the slewing of the boom"""
    luff: LuffTable | None = None
    """the table of the luffing of the boom"""
    base: Annotated[tuple[GroundAccelerationTable, ...], Few] = ()
    """the accelerations of the ground"""
    observe: Annotated[tuple[ObserveTable, ...], Few] = ()
    """the additional outputs, one [[observe]] each"""
    start: StartTable = StartTable.model_validate({})
    """the table of the state at t = 0"""
    damping: DampingTable = DampingTable.model_validate({})
    """the table of the boom's damping"""
    life: LifeTable = LifeTable.model_validate({})
    """the table of fatigue and wear"""
    buckling: BucklingTable | None = None
    """the table of the buckling analysis of walls; none is made unless given"""
    limits: LimitsTable | None = None
    """the table of limits of results; none are checked unless given"""
    load_cases: Annotated[tuple[LoadCaseTable, ...], Few] = Field((), alias="load_case")
    """the load cases, one [[load_case]] each; the case itself unless given"""
    combinations: Annotated[tuple[CombinationTable, ...], Few] = Field((), alias="combination")
    """the combinations of loads, one [[combination]] each; each load case alone unless given"""
    spectra: Annotated[tuple[SpectrumTable, ...], Few] = Field((), alias="spectrum")
    """the sequences of load cases for the proof of fatigue, one [[spectrum]] each"""
    models: Annotated[tuple[Model, ...], Field(min_length=1, max_length=MOST_MODELS)] = Field(
        (KINDS["finite-element"](name="timoshenko", kind="finite-element"),), alias="model"
    )
    """the models to run, one [[model]] each; a Timoshenko beam of elements of 0.5 m unless given"""

    @model_validator(mode="after")
    def _segments_by_name(self) -> Self:
        """Check that parts refer to their segments by name, since a case file has no indices."""
        groups = {"joint": self.joints, "stop": self.stops, "cylinder": self.cylinders}
        for group, parts in {**groups, "observe": self.observe}.items():
            for number, part in enumerate(parts):
                for key in ("outer", "inner", "segment"):
                    name = getattr(part, key, "")
                    if not isinstance(name, str):
                        raise validation_error(self, "string_type", ((group, number, key), name))
        return self

    @model_validator(mode="after")
    def _gravity_once(self) -> Self:
        if self.gravity and self.payload and self.payload.gravity is not None:
            error = unsuitable(
                "the table gravity is given, by which the payload weighs too; leave one of them out"
            )
            at = ("payload", "gravity"), self.payload.gravity
            raise validation_error(self, error, at)
        return self

    @model_validator(mode="after")
    def _calibrators(self) -> Case:
        """Replace the names of calibrating shells by their tables."""
        by_name = {model.name: model for model in self.models}
        resolved = tuple(
            model.resolve_shell(by_name) if isinstance(model, CalibratedTable) else model
            for model in self.models
        )
        object.__setattr__(self, "models", resolved)
        return self

    @property
    def system(self) -> System:
        """The system of units of tables and sweeps."""
        return System(self.shown_units or self.units)

    @property
    def loads_of_segments(self) -> list[tuple[int, LoadTable]]:
        """The loads across segments, with their numbers in the case; each is one of the boom."""
        numbered = enumerate(self.loads, start=1)
        return [(number, load) for number, load in numbered if not load.oblique]

    @property
    def oblique_loads(self) -> list[tuple[int, LoadTable]]:
        """The other loads, with parts along or beside the axis."""
        return [(n, load) for n, load in enumerate(self.loads, start=1) if load.oblique]

    @property
    def first_shell(self) -> int:
        """The number of the first model that needs a shell; 0 without one."""
        numbered = enumerate(self.models, start=1)
        return next((number for number, model in numbered if model.needs_shell), 0)

    @property
    def spatial(self) -> bool:
        """True if the boom bends in both planes."""
        return any(joint.lateral_play is not None for joint in self.joints)

    @property
    def regular(self) -> bool:
        """True if runs with slightly different data stay close, because of dry friction.

        This needs friction under given normal forces at each station, and no stops. Friction
        under the contact forces alone does not suffice.
        """
        return not self.stops and all(
            joint.bonded or (joint.friction > 0.0 and min(joint.normal_forces, default=0.0) > 0.0)
            for joint in self.joints
        )

    def without_client_keys(self) -> Self:
        """Return the case with defaults for the keys of clients, on which no result depends."""
        fields = ClientKeys.model_fields.items()
        return self.model_copy(
            update={name: field.get_default(call_default_factory=True) for name, field in fields}
        )

    @property
    def driven_segments(self) -> dict[str, str]:
        """The name of the segment that each drive moves, by the suffix of the drive's results."""
        return {
            "" if number == 1 else f"-{number}": joint.inner
            for number, joint in enumerate(self.joints, start=1)
            if joint.drive is not None
        }


def case_schema() -> dict[str, Any]:
    """Return the JSON Schema of a case file."""
    return schema_of_file(Case.model_json_schema())
