# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of a segment, tables of section shapes, and the sections that they define."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache, reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from protractile.geometry.box import BoxSection
from protractile.geometry.fields import (
    Few,
    Flag,
    In,
    Length,
    Name,
    NotNegative,
    Number,
    Positive,
    is_number,
)
from protractile.geometry.material import Material
from protractile.geometry.place import End, Place
from protractile.geometry.polygon import bent, closed_polygon
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.section import Section
from protractile.geometry.segment import PointMass
from protractile.geometry.stiffeners import Collar, Diaphragm
from protractile.geometry.support import Support
from protractile.runs.case.limits import MOST_FACETS, CaseTable, error_at, superfluous_error

# A plain x is a pinned support at x.
_Support = Annotated[
    Support,
    BeforeValidator(
        lambda value: {"x": value} if isinstance(value, str) or is_number(value) else value,
        json_schema_input_type=Annotated[Number, In("m")] | End | Support,
    ),
]


class ShapeTable(CaseTable):
    """Base class of the tables that define a section, one for each shape."""

    # Function that returns the section from all keys except ``shape``.
    make: ClassVar[Callable[..., Section]]
    shape: str
    outside: Flag = False
    """whether heights, widths, corners and the radius of a U are those of the outer surface, as
    drawn, instead of mid-lines, and bend_radius is that of the inner surface"""
    bend_radius: Length | None = None
    """the radius of mid-lines in m, with outside = true the inner radius of the bending tool, at
    bends, which are the corners between plates of one thickness; other corners are welds; all are
    sharp unless given, except the bottom bends of a U, which have its radius"""

    def section(self) -> Section:
        """Return the section that the keys define.

        Raises:
            SectionError: the section is invalid.
        """
        return _section(self)


# Load cases and combinations share the sections of a case, which keep their properties.
@lru_cache(maxsize=256)
def _section(table: ShapeTable) -> Section:
    made = type(table).make(**table.model_dump(exclude={"shape", "outside", "bend_radius"}))
    made = made.within_outline() if table.outside else made
    radius = table.bend_radius
    return made if radius is None else bent(made, radius, inner=table.outside)


class SectionTable(ShapeTable):
    """Keys of a box: distances of wall mid-lines, and thicknesses."""

    make = BoxSection
    shape: Literal["box"] = "box"
    """the shape of the section"""
    height: Length
    """the distance of the flange mid-lines in m"""
    width: Length
    """the distance of the web mid-lines in m"""
    flange: Length
    """the thickness of the two flanges in m"""
    web: Length
    """the thickness of the two webs in m"""


def _unequal_box(height: float, width: float, top: float, bottom: float, web: float) -> BoxSection:
    return BoxSection(height, width, top, web, bottom_flange=bottom)


class UnequalBoxTable(ShapeTable):
    """Keys of a box with flanges of different thickness."""

    make = _unequal_box
    shape: Literal["unequal box"]
    """the shape of the section"""
    height: Length
    """the distance of the flange mid-lines in m"""
    width: Length
    """the distance of the web mid-lines in m"""
    top: Length
    """the thickness of the upper flange in m"""
    bottom: Length
    """the thickness of the lower flange in m"""
    web: Length
    """the thickness of the two webs in m"""


class PolygonTable(ShapeTable):
    """Keys of a closed polygon of flat plates."""

    make = closed_polygon
    shape: Literal["polygon"]
    """the shape of the section"""
    corners: Annotated[tuple[tuple[Number, Number], ...], Few, In("m")]
    """the corners of the mid-lines in order, as pairs of y and z in m from any origin"""
    thicknesses: Annotated[tuple[Length, ...], Few]
    """the thickness of each plate in m, from each corner to the next; the last plate closes the
    cell"""


class _FoldedTable(ShapeTable):
    """Common keys of sections with a top, a bottom and folded sides."""

    height: Length
    """the height of the top's mid-line above the bottom's in m"""
    width: Length
    """the greatest distance between the sides' mid-lines in m"""
    top: Length
    """the thickness of the top in m"""
    bottom: Length
    """the thickness of the bottom, with its bends, in m"""
    web: Length
    """the thickness of the other plates in m"""


class HexagonTable(_FoldedTable):
    """Keys of a hexagon with flat top and bottom, and sides that are folded at mid-height."""

    make = hexagon
    shape: Literal["hexagon"]
    """the shape of the section"""
    flat: Length
    """the width of the top, and of the bottom, in m"""


class OctagonTable(_FoldedTable):
    """Keys of an octagon: a rectangle whose corners are cut at 45°."""

    make = octagon
    shape: Literal["octagon"]
    """the shape of the section"""
    chamfer: Length
    """the length in m by which each cut shortens the rectangle's sides"""


class UTable(_FoldedTable):
    """Keys of a U with a flat top, whose bends consist of flat plates."""

    make = u_section
    shape: Literal["U"]
    """the shape of the section"""
    radius: Length
    """the radius of the bottom's two bends in m"""
    facets: Annotated[int, Field(strict=True, ge=1, le=MOST_FACETS)] = 3
    """the number of flat plates in each bend, which touch its circle, in shells"""
    weld: Length | None = None
    """the height in m of the welds of two half shells above the bottom; below them the webs are as
    thick as the bottom; no welds unless given"""


def _shape(value: Any) -> str:
    """Return the shape of a section's table; the default is a box."""
    if isinstance(value, Mapping):
        return str(value.get("shape", "box"))
    return str(getattr(value, "shape", "box"))


SHAPES: Mapping[str, type[ShapeTable]] = {
    "box": SectionTable,
    "unequal box": UnequalBoxTable,
    "polygon": PolygonTable,
    "hexagon": HexagonTable,
    "octagon": OctagonTable,
    "U": UTable,
}

if TYPE_CHECKING:
    AnySection = ShapeTable
else:
    AnySection = Annotated[
        reduce(or_, (Annotated[table, Tag(shape)] for shape, table in SHAPES.items())),
        Discriminator(_shape),
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
    added_mass_per_length: Annotated[NotNegative, In("kg/m")] = 0.0
    """the mass per length in kg/m of hoses, cables and walkways, in addition to the section"""
    second_moment_of_area: Annotated[Positive, In("m^4")] | None = None
    """the second moment of area in m^4; follows from the section unless given"""
    rotary_inertia: Annotated[NotNegative, In("kg m")] | None = None
    """the rotary inertia in kg m; density times second moment unless given"""
    yield_strengths: Annotated[dict[str, Positive], In("Pa")] = Field(default_factory=dict)
    """plate or side = yield strength in Pa, such as bottom = 9.6e8, of plates that have another one
    than the material"""
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


class MassPinTable(CaseTable):
    """A pin by which a segment carries a mass inside the boom."""

    segment: str
    """the name of the segment"""
    x: Place
    """the x in m"""


class PinnedMassTable(CaseTable):
    """A telescoping cylinder, or hoses, inside the boom, carried by a pin at each end."""

    mass: Annotated[Positive, In("kg")]
    """the mass in kg"""
    pins: tuple[MassPinTable, MassPinTable]
    """its two pins, with the segment and the x of each; they move with their segments"""
    centre: Annotated[NotNegative, In("m")] | None = None
    """the distance in m of its centre of mass from the first pin, towards the second one; halfway
    unless given"""
