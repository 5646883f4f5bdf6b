# SPDX-License-Identifier: LGPL-3.0-or-later
"""A rectangular box whose four walls have thicknesses of their own."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from geometry.section import (
    Direction,
    Face,
    Offset,
    Plate,
    Section,
    SectionError,
    rectangle,
    rectangle_faces,
)


@dataclass(frozen=True, slots=True)
class UnequalBox(Section):
    """Rectangular box, described by the mid-lines and thicknesses of its walls.

    Its corners are filled, as those of :class:`geometry.section.BoxSection`: all properties but
    those of shear and torsion are those of the outer rectangle less the inner one.

    Args:
        height: distance of the flange mid-lines (along z) in m.
        width: distance of the web mid-lines (along y) in m.
        top, bottom: thicknesses of the flanges in m.
        right, left: thicknesses of the webs in m.

    Raises:
        SectionError: a dimension is not positive and finite, or the walls fill the box.
    """

    height: float
    width: float
    top: float
    bottom: float
    right: float
    left: float

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (np.isfinite(value) and value > 0.0):
                raise SectionError(f"{field.name} must be a positive number of m, got {value}")
        if 0.5 * (self.top + self.bottom) >= self.height:
            raise SectionError(
                f"flanges of {self.top} m and {self.bottom} m leave no room in a box "
                f"{self.height} m high; they must be thinner"
            )
        if 0.5 * (self.right + self.left) >= self.width:
            raise SectionError(
                f"webs of {self.right} m and {self.left} m leave no room in a box "
                f"{self.width} m wide; they must be thinner"
            )

    @property
    def area(self) -> float:
        """Cross-sectional area in m²."""
        return self.height * (self.right + self.left) + self.width * (self.top + self.bottom)

    @property
    def second_moment_of_area(self) -> float:
        """Second moment about y (bending in the plane x-z) in m⁴."""
        return self._second_moment(1)

    @property
    def lateral_second_moment_of_area(self) -> float:
        """Second moment about z (bending in the plane x-y) in m⁴."""
        return self._second_moment(0)

    @property
    def torsion_constant(self) -> float:
        """Bredt's second formula, 4 A² / ∮ ds/t, in m⁴ (Bredt 1896)."""
        around = sum(plate.length / plate.thickness for plate in self.plates)
        return 4.0 * (self.height * self.width) ** 2 / around

    @property
    def shear_area(self) -> float:
        """Area that carries a shear force along z: the two webs, in m²."""
        return self.height * (self.right + self.left)

    @property
    def lateral_shear_area(self) -> float:
        """Area that carries a shear force along y: the two flanges, in m²."""
        return self.width * (self.top + self.bottom)

    @property
    def centroid(self) -> Offset:
        """(y, z) in m from the middle of the mid-lines."""
        outer, inner = self._rectangles()
        areas = np.array([_area(outer), -_area(inner)])
        middles = np.array(
            [[0.5 * (low + high) for low, high in sides] for sides in (outer, inner)]
        )
        y, z = areas @ middles / areas.sum()
        return float(y), float(z)

    @property
    def plates(self) -> tuple[Plate, ...]:
        """Bottom, right, top and left."""
        (y, z), b, h = self.centroid, 0.5 * self.width, 0.5 * self.height
        thicknesses = self.bottom, self.right, self.top, self.left
        return rectangle((-b - y, -h - z), (b - y, h - z), *thicknesses)

    @property
    def faces(self) -> tuple[Face, ...]:
        """All plates."""
        return rectangle_faces(self.plates)

    @property
    def mirrors(self) -> tuple[Direction, ...]:
        """That of y where the webs are alike, that of z where the flanges are."""
        alike: dict[Direction, bool] = {"y": self.right == self.left, "z": self.top == self.bottom}
        return tuple(axis for axis, same in alike.items() if same)

    def carriers(self, direction: Direction) -> tuple[tuple[int, float], ...]:
        """The webs along z, the flanges along y, by the law of the lever."""
        y, z = self.centroid
        if direction == "z":
            return (1, 0.5 + y / self.width), (3, y / self.width - 0.5)
        return (2, -0.5 - z / self.height), (0, 0.5 - z / self.height)

    def __str__(self) -> str:
        walls = " / ".join(f"{1e3 * t:.4g}" for t in (self.top, self.bottom, self.right, self.left))
        return f"{1e3 * self.height:.4g} x {1e3 * self.width:.4g} x {walls}"

    def turned(self) -> UnequalBox:
        """The box lying on its side, y and z exchanged."""
        return UnequalBox(self.width, self.height, self.right, self.left, self.top, self.bottom)

    def _rectangles(self) -> tuple[_Rectangle, _Rectangle]:
        """The outer and the inner one, from the middle of the mid-lines."""
        b, h = 0.5 * self.width, 0.5 * self.height
        walls = (self.left, self.right), (self.bottom, self.top)
        outer, inner = (
            tuple(
                (-size - side * 0.5 * low, size + side * 0.5 * high)
                for size, (low, high) in zip((b, h), walls, strict=True)
            )
            for side in (1.0, -1.0)
        )
        return outer, inner

    def _second_moment(self, axis: int) -> float:
        """∫ y² or z² dA about the centroid in m⁴, by the parallel axes' theorem (Steiner)."""
        centre = self.centroid[axis]
        found = 0.0
        for sign, sides in zip((1.0, -1.0), self._rectangles(), strict=True):
            low, high = sides[axis]
            arm = 0.5 * (low + high) - centre
            found += sign * _area(sides) * ((high - low) ** 2 / 12.0 + arm**2)
        return found


# Where a rectangle begins and ends along y, and along z, in m.
_Rectangle = tuple[tuple[float, float], ...]


def _area(sides: _Rectangle) -> float:
    (left, right), (bottom, top) = sides
    return (right - left) * (top - bottom)
