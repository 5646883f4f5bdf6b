# SPDX-License-Identifier: LGPL-3.0-or-later
"""The section's table of a case file, of each shape, and the section that it declares."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from geometry.section import BoxSection, Section
from geometry.unequal_box import UnequalBox
from runs.case.limits import Positive, Table


class ShapeTable(Table):
    """What every shape's table has."""

    shape: str

    @abstractmethod
    def section(self) -> Section:
        """The section of these numbers.

        Raises:
            SectionError: there is none.
        """


class SectionTable(ShapeTable):
    """A box by its wall mid-lines and thicknesses."""

    shape: Literal["box"] = Field("box", description="the shape of the section")
    height: Positive = Field(description="the distance of the flange mid-lines in m")
    width: Positive = Field(description="the distance of the web mid-lines in m")
    flange: Positive = Field(description="the thickness of the two flanges in m")
    web: Positive = Field(description="the thickness of the two webs in m")

    def section(self) -> BoxSection:
        return BoxSection(self.height, self.width, self.flange, self.web)


class UnequalBoxTable(ShapeTable):
    """A box with flanges of different thickness, by its wall mid-lines and thicknesses."""

    shape: Literal["unequal box"] = Field(description="the shape of the section")
    height: Positive = Field(description="the distance of the flange mid-lines in m")
    width: Positive = Field(description="the distance of the web mid-lines in m")
    top: Positive = Field(description="the thickness of the upper flange in m")
    bottom: Positive = Field(description="the thickness of the lower flange in m")
    web: Positive = Field(description="the thickness of the two webs in m")

    def section(self) -> UnequalBox:
        return UnequalBox(self.height, self.width, self.top, self.bottom, self.web, self.web)


SHAPES: Mapping[str, type[ShapeTable]] = {"box": SectionTable, "unequal box": UnequalBoxTable}


def _shape(given: Any) -> str:
    """That of a section's table; a box unless given."""
    if isinstance(given, Mapping):
        return str(given.get("shape", "box"))
    return str(getattr(given, "shape", "box"))


AnySection = Annotated[
    Annotated[SectionTable, Tag("box")] | Annotated[UnequalBoxTable, Tag("unequal box")],
    Discriminator(_shape),
]
