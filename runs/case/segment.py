# SPDX-License-Identifier: LGPL-3.0-or-later
"""A segment of the boom in a case file, with its supports, masses, collars and diaphragms."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from runs.case.limits import (
    CaseTable,
    Few,
    In,
    Length,
    Name,
    NotNegative,
    Number,
    Positive,
    fault_at,
    left_out,
)
from runs.case.places import End, Place
from runs.case.sections import AnySection


class MaterialTable(CaseTable):
    """Isotropic linear elasticity: the case's for all segments, or a segment's own."""

    youngs_modulus: Annotated[Positive, In("Pa")]
    """Young's modulus E in Pa"""
    poissons_ratio: Annotated[float, Field(strict=True, gt=-1.0, lt=0.5), In("1")]
    """Poisson's ratio"""
    density: Annotated[Positive, In("kg/m^3")]
    """the density in kg/m^3"""
    yield_strength: Annotated[Positive, In("Pa")] | None = None
    """the yield strength in Pa, beside which a run shows stresses"""


class SupportTable(CaseTable):
    """A place where the ground holds a segment; in space it holds sideways and in twist too."""

    bare: ClassVar[str] = "x"

    x: Place
    """the x in m"""
    kind: Literal["pinned", "hinged", "clamped"] = "pinned"
    """whether the slope is free or held; of a hinge, a pin across the boom, it is free in the plane
    of bending and held sideways"""
    stiffness: Annotated[Positive, In("N/m")] | None = None
    """the stiffness of an elastic support in N/m; rigid unless given"""
    rotation_stiffness: Annotated[Positive, In("N m/rad")] | None = None
    """the stiffness in N m/rad against the slopes that the kind leaves free; none unless given"""
    dashpot: Annotated[NotNegative, In("N s/m")] = 0.0
    """the linear dashpot of an elastic support in N s/m, beside its stiffness"""
    depth: Annotated[Number, In("m")] = 0.0
    """how far in m its pin is below the segment's axis, of the first support of a segment with a
    cylinder or axial forces"""


class MassTable(CaseTable):
    """A mass on a segment."""

    x: Place
    """the x in m"""
    mass: Annotated[Positive, In("kg")]
    """the mass in kg"""


class CollarTable(CaseTable):
    """A doubler around a segment; the walls' mid-surfaces stay where they are."""

    span: tuple[Place, Place]
    """the x of its two ends in m, rising"""
    thickness: Length
    """the thickness in m that it adds to all walls"""


class DiaphragmTable(CaseTable):
    """A plate that closes a segment's box, welded to its walls."""

    x: Place
    """the x in m"""
    thickness: Length
    """the thickness in m"""


def _support(given: Any) -> Any:
    """Return a plain place as a pinned support."""
    place = isinstance(given, int | float | str) and not isinstance(given, bool)
    return {SupportTable.bare: given} if place else given


Support = Annotated[
    SupportTable, BeforeValidator(_support, json_schema_input_type=Number | End | SupportTable)
]


class SegmentTable(CaseTable):
    """One box of the boom."""

    name: Name
    """what the joints and the results call the segment"""
    span: tuple[Annotated[Number, In("m")], Annotated[Number, In("m")]] | None = None
    """the x of its two ends in m, rising; or give length"""
    length: Length | None = None
    """the length in m of a segment whose place follows from the extension of the joint in which it
    slides; the first one then starts at 0"""
    material: MaterialTable | None = None
    """the table of the segment's own material; the case's unless given"""
    supports: Annotated[tuple[Support, ...], Few] = ()
    """the places that the ground holds: an x in m each, or a table"""
    masses: Annotated[tuple[MassTable, ...], Few] = ()
    """the masses on the segment"""
    mass_per_length: Annotated[Positive, In("kg/m")] | None = None
    """the mass per length in kg/m; follows from the section unless given"""
    second_moment_of_area: Annotated[Positive, In("m^4")] | None = None
    """the second moment of area in m^4; follows from the section unless given"""
    rotary_inertia: Annotated[NotNegative, In("kg m")] | None = None
    """the rotary inertia in kg m; density times second moment unless given"""
    height_to_width: Annotated[Positive, In("1")] | None = None
    """the ratio of the mid-lines of a uniform-wall box, to infer its section"""
    section: AnySection | None = None
    """the table of the plates; unless given a box is inferred from mass and second moment, with
    height_to_width, or with the room in the segment around it"""
    head_section: AnySection | None = None
    """the table of the plates at the head, of the section's shape: the segment tapers from its
    section at the tail to this one"""
    load: Annotated[Number, In("N/m")] = 0.0
    """the uniform load in N/m, positive upwards, applied at t = 0 and kept"""
    viscous_damping: Annotated[NotNegative, In("N s/m^2")] = 0.0
    """the viscous damping per length in N s/m^2"""
    lateral_load: Annotated[Number, In("N/m")] = 0.0
    """the uniform load along y in N/m, applied at t = 0 and kept"""
    lateral_second_moment_of_area: Annotated[Positive, In("m^4")] | None = None
    """the second moment of area for bending along y in m^4; follows from the section unless
    given"""
    lateral_rotary_inertia: Annotated[NotNegative, In("kg m")] | None = None
    """the same in kg m; density times second moment unless given"""
    torsion_constant: Annotated[Positive, In("m^4")] | None = None
    """the torsion constant in m^4; follows from the section unless given"""
    polar_inertia: Annotated[Positive, In("kg m")] | None = None
    """the mass moment of inertia about the axis per length in kg m; follows from the section unless
    given"""
    collars: Annotated[tuple[CollarTable, ...], Few] = ()
    """the doublers around the box: stiffness of shells alone, mass of all models"""
    diaphragms: Annotated[tuple[DiaphragmTable, ...], Few] = ()
    """the plates that close the box: stiffness of shells alone, mass of all models"""

    @model_validator(mode="after")
    def _has_a_place(self) -> Self:
        if self.span is None and self.length is None:
            raise fault_at(self, "missing", "span")
        if self.span is not None and self.length is not None:
            raise left_out(self, "span", "length")
        return self
