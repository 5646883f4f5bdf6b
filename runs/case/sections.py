# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of section shapes in a case file, and the sections that they define."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from geometry.polygon import closed_polygon
from geometry.profiles import hexagon, octagon, u_section
from geometry.section import BoxSection, Section
from runs.case.limits import MOST_FACETS, CaseTable, Few, In, Length, Number


class ShapeTable(CaseTable):
    """What every shape's table has."""

    shape: str

    @abstractmethod
    def section(self) -> Section:
        """Return the section of these numbers.

        Raises:
            SectionError: the section is invalid.
        """


class SectionTable(ShapeTable):
    """A box by its wall mid-lines and thicknesses."""

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

    def section(self) -> BoxSection:
        return BoxSection(self.height, self.width, self.flange, self.web)


class UnequalBoxTable(ShapeTable):
    """A box with flanges of different thickness, by its wall mid-lines and thicknesses."""

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

    def section(self) -> BoxSection:
        return BoxSection(self.height, self.width, self.top, self.web, bottom_flange=self.bottom)


class PolygonTable(ShapeTable):
    """Flat plates once around a cell, by the corners of their mid-lines."""

    shape: Literal["polygon"]
    """the shape of the section"""
    corners: Annotated[tuple[tuple[Number, Number], ...], Few, In("m")]
    """the corners of the mid-lines in turn, as pairs of y and z in m from anywhere"""
    thicknesses: Annotated[tuple[Length, ...], Few]
    """the thickness of each plate in m, from each corner to the next; the last one closes the
    cell"""

    def section(self) -> Section:
        return closed_polygon(self.corners, self.thicknesses)


class _FoldedTable(ShapeTable):
    """What sections of a top, a bottom and folded sides have."""

    height: Length
    """the height of the top's mid-line above the bottom's in m"""
    width: Length
    """the greatest distance of the sides' mid-lines in m"""
    top: Length
    """the thickness of the top in m"""
    bottom: Length
    """the thickness of the bottom, with its bends, in m"""
    web: Length
    """the thickness of the other plates in m"""


class HexagonTable(_FoldedTable):
    """A hexagon that lies on a flat bottom, its sides folded in the middle."""

    shape: Literal["hexagon"]
    """the shape of the section"""
    flat: Length
    """the width of the top, and of the bottom, in m"""

    def section(self) -> Section:
        return hexagon(self.height, self.width, self.flat, self.top, self.bottom, self.web)


class OctagonTable(_FoldedTable):
    """A rectangle whose corners are cut at 45°."""

    shape: Literal["octagon"]
    """the shape of the section"""
    chamfer: Length
    """what is cut of the rectangle's sides at each end in m"""

    def section(self) -> Section:
        return octagon(self.height, self.width, self.chamfer, self.top, self.bottom, self.web)


class UTable(_FoldedTable):
    """A U whose bends are folded of flat plates, closed by a flat top."""

    shape: Literal["U"]
    """the shape of the section"""
    radius: Length
    """the radius of the bottom's two bends in m"""
    facets: Annotated[int, Field(strict=True, ge=1, le=MOST_FACETS)] = 3
    """the number of flat plates in each bend, which touch its circle"""

    def section(self) -> Section:
        sizes = self.height, self.width, self.radius, self.facets
        return u_section(*sizes, self.top, self.bottom, self.web)


SHAPES: Mapping[str, type[ShapeTable]] = {
    "box": SectionTable,
    "unequal box": UnequalBoxTable,
    "polygon": PolygonTable,
    "hexagon": HexagonTable,
    "octagon": OctagonTable,
    "U": UTable,
}


def _shape(given: Any) -> str:
    """Return the shape of a section's table; default a box."""
    if isinstance(given, Mapping):
        return str(given.get("shape", "box"))
    return str(getattr(given, "shape", "box"))


AnySection = Annotated[
    Annotated[SectionTable, Tag("box")]
    | Annotated[UnequalBoxTable, Tag("unequal box")]
    | Annotated[PolygonTable, Tag("polygon")]
    | Annotated[HexagonTable, Tag("hexagon")]
    | Annotated[OctagonTable, Tag("octagon")]
    | Annotated[UTable, Tag("U")],
    Discriminator(_shape),
]
