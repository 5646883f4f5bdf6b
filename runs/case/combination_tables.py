# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of a case for load cases, combinations and spectra."""

from __future__ import annotations

from math import prod
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field

from protractile.geometry.fields import Few, Flag, In, Name, NotNegative, Positive, is_number
from protractile.runs.case.limits import CaseTable
from protractile.runs.case.load_tables import (
    AxialTable,
    GroundAccelerationTable,
    Group,
    LoadTable,
    Telescoped,
    WindPressureTable,
)


class LoadCaseTable(CaseTable):
    """A load case of the boom at rest. Its keys replace keys of the case."""

    name: Name
    """the name of the load case"""
    angle: Annotated[float, Field(strict=True, ge=-90.0, le=90.0), In("deg")] | None = None
    """the luffing angle in degrees, in place of gravity.angle; the ground of cylinders stays where
    it is on the earth"""
    extension: Annotated[dict[str, NotNegative], In("m")] = Field(default_factory=dict)
    """inner segment = extension in m, in place of the joint's extension"""
    telescoped: Telescoped | None = None
    """the fraction of the stroke to which the boom is telescoped, in place of
    telescoping.extension"""
    payload: Annotated[NotNegative, In("kg")] | None = None
    """a mass in kg at the tip in addition to the table payload; it weighs along and across the
    boom, as a load of the group payload; the mass of the table hoist, if any, unless given"""
    loads: Annotated[tuple[LoadTable, ...], Few] | None = Field(None, alias="load")
    """the loads in place of all [[load]] of the case; the loads of the case unless given"""
    axial: Annotated[tuple[AxialTable, ...], Few] | None = None
    """the forces along the boom in place of all [[axial]] of the case; those unless given"""
    base: Annotated[tuple[GroundAccelerationTable, ...], Few] | None = None
    """the accelerations of the ground in place of all [[base]] of the case; those unless given"""
    wind: (
        Annotated[
            WindPressureTable,
            BeforeValidator(
                lambda value: {"pressure": float(value)} if is_number(value) else value,
                json_schema_input_type=Annotated[NotNegative, In("Pa")] | WindPressureTable,
            ),
        ]
        | None
    ) = None
    """the pressure of the wind in Pa, 0 for none, or a table of what differs from the wind of the
    case; a pressure or a speed replaces its history too; the wind of the case unless given"""


# The numbers whose product is the factor.
Factor = Annotated[
    tuple[NotNegative, ...],
    In("1"),
    Field(min_length=1, max_length=9),
    BeforeValidator(
        lambda value: (value,) if is_number(value) else value,
        json_schema_input_type=NotNegative | tuple[NotNegative, ...],
    ),
]


class FactorsTable(CaseTable):
    """Factors of the groups of loads: a number, or numbers whose product is the factor."""

    dead: Factor | None = None
    """the factor of the weight of the boom and of the loads along its segments"""
    payload: Factor | None = None
    """the factor of the payload and of loads without another group"""
    wind: Factor | None = None
    """the factor of the table wind and of loads of the group wind"""
    dynamic: Factor | None = None
    """the factor of accelerations of the ground and of loads of the group dynamic"""
    test: Factor | None = None
    """the factor of loads of the group test"""

    def of(self, group: Group) -> float | None:
        """Return the factor on a group of loads; None if the table does not give it."""
        numbers: tuple[float, ...] | None = getattr(self, group)
        return None if numbers is None else prod(numbers)


class ResistanceTable(CaseTable):
    """Factors by which proofs divide resistances."""

    material: Annotated[Positive, In("1")] = 1.0
    """the factor on yield strengths"""
    stability: Annotated[Positive, In("1")] = 1.0
    """the factor on buckling resistances of plates and of the boom"""
    pad: Annotated[Positive, In("1")] = 1.0
    """the factor on allowable pressures of pads"""
    cylinder: Annotated[Positive, In("1")] = 1.0
    """the factor on capacities of cylinders"""
    pin: Annotated[Positive, In("1")] = 1.0
    """the factor on shear resistances of pins"""
    tipping: Annotated[Positive, In("1")] = 1.0
    """the factor on the stabilising moment of the chassis"""


ProofName = Literal["yield", "plate", "column", "pad", "cylinder", "pin", "deflection", "tipping"]
# The proofs of a combination unless it names others.
PROOFS: tuple[ProofName, ...] = ("yield", "plate", "column", "pad", "cylinder", "pin")


class CombinationTable(CaseTable):
    """A combination of loads, in some of the load cases or in all."""

    name: Name
    """the name of the combination"""
    load_cases: Annotated[tuple[str, ...], Field(min_length=1)] | None = None
    """the names of its load cases; all unless given"""
    factors: FactorsTable
    """group = factor, for each group of its load cases"""
    resistance: ResistanceTable = ResistanceTable.model_validate({})
    """the table of resistance factors"""
    motion: Flag = False
    """whether prove and runs take the extremes of the motion under these loads, by the first model
    of beam elements, in place of those at rest"""
    proofs: Annotated[tuple[ProofName, ...], Field(min_length=1)] = PROOFS
    """the proofs that the combination demands; a proof compares the design effect with the limit
    design value (EN 13001-3-1): yield (static strength), plate (plate buckling), column (column
    buckling), pad (pressure), cylinder (force) and pin (shear) unless given; deflection (static
    tip deflection) compares with limits.tip_at_rest, tipping the overturning with the stabilising
    moment about each tipping line of the chassis"""


class SpectrumTable(CaseTable):
    """A sequence of load cases that repeats, for the proof of fatigue."""

    name: Name
    """the name of the spectrum"""
    load_cases: Annotated[tuple[str, ...], Field(min_length=2, max_length=1000)]
    """the names of the load cases in their order, from which the sequence starts again"""
    repeats: Annotated[int, Field(strict=True, ge=1, le=10**9)]
    """the number of repetitions in the service life"""
    motion: Flag = False
    """whether the cycles of the motions under the loads of the load cases count, by the first model
    of beam elements, in place of their states at rest"""
