# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of a segment of the boom."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import BeforeValidator, model_validator

from geometry.fields import End, Few, In, Length, Name, NotNegative, Number, Positive, is_number
from geometry.material import Material
from geometry.segment import PointMass
from geometry.stiffeners import Collar, Diaphragm
from geometry.support import Support
from runs.case.limits import CaseTable, error_at, superfluous_error
from runs.case.sections import AnySection

# A plain x is a pinned support at x.
_Support = Annotated[
    Support,
    BeforeValidator(
        lambda value: {"x": value} if isinstance(value, str) or is_number(value) else value,
        json_schema_input_type=Number | End | Support,
    ),
]


class SegmentTable(CaseTable):
    """A segment of the boom: one box."""

    name: Name
    """the name of the segment in joints and results"""
    span: tuple[Annotated[Number, In("m")], Annotated[Number, In("m")]] | None = None
    """the x of its two ends in m, in ascending order; or give length"""
    length: Length | None = None
    """the length in m, instead of span; the first segment then starts at 0, and the others follow
    from the extension of their joints"""
    material: Material | None = None
    """the table of the segment's own material; the case's unless given"""
    supports: Annotated[tuple[_Support, ...], Few] = ()
    """the supports: an x in m each, or a table"""
    masses: Annotated[tuple[PointMass, ...], Few] = ()
    """the masses on the segment"""
    mass_per_length: Annotated[Positive, In("kg/m")] | None = None
    """the mass per length in kg/m; follows from the section unless given"""
    second_moment_of_area: Annotated[Positive, In("m^4")] | None = None
    """the second moment of area in m^4; follows from the section unless given"""
    rotary_inertia: Annotated[NotNegative, In("kg m")] | None = None
    """the rotary inertia in kg m; density times second moment unless given"""
    height_to_width: Annotated[Positive, In("1")] | None = None
    """the ratio of height to width of the mid-lines, to infer the section of a box with uniform
    walls"""
    section: AnySection | None = None
    """the table of the plates; unless given, a box is inferred from mass and second moment, with
    height_to_width or the space in the outer segment"""
    head_section: AnySection | None = None
    """the table of the plates at the head, for a tapered segment, whose section describes the
    tail; both have the same shape"""
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
    """the rotary inertia for bending along y in kg m; density times second moment unless given"""
    torsion_constant: Annotated[Positive, In("m^4")] | None = None
    """the torsion constant in m^4; follows from the section unless given"""
    polar_inertia: Annotated[Positive, In("kg m")] | None = None
    """the mass moment of inertia about the axis per length in kg m; follows from the section unless
    given"""
    collars: Annotated[tuple[Collar, ...], Few] = ()
    """the doublers around the box: all models have their mass, shells also their stiffness"""
    diaphragms: Annotated[tuple[Diaphragm, ...], Few] = ()
    """the plates that close the box: all models have their mass, shells also their stiffness"""

    @model_validator(mode="after")
    def _has_a_place(self) -> Self:
        if self.span is None and self.length is None:
            raise error_at(self, "missing", "span")
        if self.span is not None and self.length is not None:
            raise superfluous_error(self, "span", "length")
        return self
