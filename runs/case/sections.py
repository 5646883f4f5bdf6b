# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of section shapes in a case file, and the sections that they define."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag

from geometry.fields import Few, In, Length, Number
from geometry.polygon import closed_polygon
from geometry.profiles import hexagon, octagon, u_section
from geometry.section import BoxSection, Section
from runs.case.limits import MOST_FACETS, CaseTable


class ShapeTable(CaseTable):
    """Keys of every shape of a section."""

    # Function that returns the section from all keys except ``shape``.
    make: ClassVar[Callable[..., Section]]
    shape: str

    def section(self) -> Section:
        """Return the section that the keys define.

        Raises:
            SectionError: the section is invalid.
        """
        return type(self).make(**self.model_dump(exclude={"shape"}))


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
    """the number of flat plates in each bend, which touch its circle"""


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
