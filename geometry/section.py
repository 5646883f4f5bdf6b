# SPDX-License-Identifier: LGPL-3.0-or-later
"""Thin-walled sections: their protocol, the box, and inference of a box from beam properties.

A section consists of flat plates around a cell. Coordinates (y, z) are relative to its centroid;
y is lateral, z in the plane of bending. Other modules do not depend on the number of plates: meshes
and shells use plates, contacts use faces, beams use properties.

Shells need plates, but beam data give only area and second moment. A box with uniform walls has
three parameters: height, width and thickness. The third condition is a given height-to-width ratio
for the outermost segment, and the clearance within the next larger section for all others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.polynomial import Polynomial

from protractile.geometry.arrays import Array, Mask
from protractile.geometry.fields import is_positive

Direction = Literal["z", "y"]
Side = Literal[-1, 0, 1]
EACH_SIDE: tuple[Side, Side] = (1, -1)
Offset = tuple[float, float]

# Index of each direction in (x, y, z).
COMPONENT: Mapping[Direction, int] = {"y": 1, "z": 2}

# Minimum height of an inferred inner box, as a fraction of the height inside the outer section.
SMALLEST = 1.0e-6

# Fraction of the modulus of a root below which its imaginary part is round-off.
_REAL = 1.0e-8


class SectionError(ValueError):
    """Error for impossible data of a section."""


class Plate(NamedTuple):
    """Flat wall of a section.

    Args:
        name: name in results.
        start, end: (y, z) in m of the ends of its mid-line.
        thickness: thickness in m.
    """

    name: str
    start: Offset
    end: Offset
    thickness: float

    @property
    def length(self) -> float:
        """The length of the mid-line in m."""
        return float(np.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]))

    @property
    def midpoint(self) -> Offset:
        """The midpoint (y, z) of the mid-line in m."""
        return 0.5 * (self.start[0] + self.end[0]), 0.5 * (self.start[1] + self.end[1])

    @property
    def tangent(self) -> Array:
        """The unit vector (2,) from the start to the end."""
        return np.asarray(np.subtract(self.end, self.start) / self.length)

    def distance(self, places: Array) -> Array:
        """Return the distance (num_places,) in m of points (num_places, 2) from the mid-line."""
        return distance_from_line(np.array(self.start), np.array(self.end), places)


def distance_from_line(start: Array, end: Array, places: Array) -> Array:
    """Return the distance (num_places,) in m of points (num_places, 2) from a line or from lines.

    ``start`` and ``end`` (2,), or (num_places, 2) for a line of each point, are its ends in m.
    """
    arms, length = places - start, np.linalg.norm(end - start, axis=-1)
    tangent = (end - start) / length[..., None]
    along = (arms * tangent).sum(axis=-1)
    beyond = np.maximum(np.maximum(-along, along - length), 0.0)
    across = arms[..., 0] * tangent[..., 1] - arms[..., 1] * tangent[..., 0]
    return np.asarray(np.hypot(beyond, across))


class Face(NamedTuple):
    """Plate normal to y or z, at which contact is possible.

    Args:
        plate: index in the plates of the section.
        direction: axis of the outward normal.
        side: sign of the outward normal along this axis.
        offset: coordinate in m of the mid-line along the direction.
        low, high: coordinates in m of both ends of the mid-line along the other axis.
        thickness: thickness of the plate in m.
    """

    plate: int
    direction: Direction
    side: Side
    offset: float
    low: float
    high: float
    thickness: float

    @classmethod
    def from_plate(
        cls, plates: Sequence[Plate], number: int, direction: Direction, side: Side
    ) -> Face:
        """Return the face of the plate with the index ``number``, normal to ``direction``."""
        plate, normal = plates[number], COMPONENT[direction] - 1
        low, high = sorted((plate.start[1 - normal], plate.end[1 - normal]))
        return cls(number, direction, side, plate.start[normal], low, high, plate.thickness)

    @property
    def width(self) -> float:
        """The distance between both ends of the mid-line in m."""
        return self.high - self.low

    @property
    def outside(self) -> float:
        """The coordinate in m of the outer surface."""
        return self.offset + 0.5 * self.side * self.thickness

    @property
    def inside(self) -> float:
        """The coordinate in m of the inner surface."""
        return self.offset - 0.5 * self.side * self.thickness


class Section(Protocol):
    """Thin-walled section with one cell."""

    @property
    def area(self) -> float:
        """The cross-sectional area in m²."""

    @property
    def second_moment_of_area(self) -> float:
        """The second moment about y (bending in the plane x-z) in m⁴."""

    @property
    def lateral_second_moment_of_area(self) -> float:
        """The second moment about z (bending in the plane x-y) in m⁴."""

    @property
    def torsion_constant(self) -> float:
        """The torsion constant in m⁴ (Bredt 1896).

        It is 4 A_m² / ∮ dℓ/t_w: A_m is ``enclosed_area``, ℓ the coordinate along mid-lines, t_w
        the wall thickness.
        """

    @property
    def shear_area(self) -> float:
        """The shear area in m² for a force along z."""

    @property
    def lateral_shear_area(self) -> float:
        """The shear area in m² for a force along y."""

    @property
    def plates(self) -> tuple[Plate, ...]:
        """The plates in order around the section; each begins where the previous one ends."""

    @property
    def faces(self) -> tuple[Face, ...]:
        """The faces, one for each direction and side with a plate normal to it."""

    @property
    def mirrors(self) -> tuple[Direction, ...]:
        """The normals of the symmetry planes, ``y`` before ``z``."""

    def shear_plates(self, direction: Direction) -> tuple[tuple[int, float], ...]:
        """Return (index, force in N along the tangent) of the plates under a shear force of 1 N.

        The shear force acts at the centroid.
        """

    def __str__(self) -> str:
        """Return the dimensions in mm, as in tables."""

    def turned(self) -> Section:
        """Return the section rotated by 90°, with y and z exchanged."""

    @property
    def polar_second_moment_of_area(self) -> float:
        """The polar second moment in m⁴."""
        return self.second_moment_of_area + self.lateral_second_moment_of_area

    @property
    def perimeter(self) -> float:
        """The length of all mid-lines in m."""
        return sum(plate.length for plate in self.plates)

    @property
    def enclosed_area(self) -> float:
        """The area within the mid-lines in m²."""
        start, end = (np.array([getattr(p, at) for p in self.plates]) for at in ("start", "end"))
        return float(0.5 * abs(start[:, 0] @ end[:, 1] - start[:, 1] @ end[:, 0]))

    def mass_per_length(self, density: float) -> float:
        """Return the mass per length in kg/m, for a density in kg/m³."""
        return density * self.area

    def reach(self, direction: Direction) -> tuple[float, float]:
        """Return the smallest and the largest coordinate of the mid-lines in a direction in m."""
        reached = [plate.start[COMPONENT[direction] - 1] for plate in self.plates]
        return min(reached), max(reached)

    @property
    def bounds(self) -> tuple[Offset, Offset]:
        """The smallest and largest (y, z) of the mid-lines in m."""
        (y_low, y_high), (z_low, z_high) = self.reach("y"), self.reach("z")
        return (y_low, z_low), (y_high, z_high)

    def size(self, direction: Direction) -> float:
        """Return the extent of the mid-lines in a direction in m."""
        low, high = self.reach(direction)
        return high - low

    def face(self, direction: Direction, side: float) -> Face:
        """Return the face whose outward normal has a direction and the sign of ``side``."""
        return next(f for f in self.faces if f.direction == direction and f.side * side > 0.0)

    def on_plates(self, places: Array) -> Mask:
        """Return the mask (num_places,) of points (num_places, 2) that are on a mid-line."""
        distance = np.min([plate.distance(places) for plate in self.plates], axis=0)
        return np.asarray(distance < self.near)

    @property
    def near(self) -> float:
        """The distance in m below which points coincide."""
        return _ON_PLATE * self.size("z")


# Distance below which points coincide, as a fraction of the height of a section.
_ON_PLATE = 1.0e-7


# Outward normals of the plates of a rectangle in their order: bottom, right, top, left.
OUTWARDS: Sequence[tuple[Direction, Side]] = (("z", -1), ("y", 1), ("z", 1), ("y", -1))


@dataclass(frozen=True, slots=True)
class BoxSection(Section):
    """Rectangular box, described by the mid-lines and thicknesses of its four walls.

    Area, centroid and second moments are exact for the outer rectangle without the inner one.

    >>> box = pt.BoxSection(height=0.4, width=0.3, flange=0.008, web=0.006)
    >>> print(f"{1e4 * box.area:.0f} cm²")
    96 cm²

    Args:
        height: distance of the flange mid-lines (along z) in m.
        width: distance of the web mid-lines (along y) in m.
        flange: thickness in m of the upper flange, and of the lower flange without
            ``bottom_flange``.
        web: thickness in m of the right web (y > 0), and of the left web without ``left_web``.
        bottom_flange: thickness of the lower flange in m; None if equal to ``flange``.
        left_web: thickness of the left web in m; None if equal to ``web``.

    Raises:
        SectionError: a dimension is not positive and finite, or the walls fill the box.
    """

    height: float
    width: float
    flange: float
    web: float
    bottom_flange: float | None = None
    left_web: float | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            needed = field.default is MISSING
            if (needed or value is not None) and not is_positive(value):
                raise SectionError(f"{field.name} must be a positive number of m, got {value}")
        for name, other in (("bottom_flange", self.flange), ("left_web", self.web)):
            if getattr(self, name) == other:
                object.__setattr__(self, name, None)
        flange, web = (0.5 * sum(pair) for pair in self._walls)
        if flange >= self.height or web >= self.width:
            flanges, webs = (
                " and ".join(f"{thickness} m" for thickness in dict.fromkeys(pair))
                for pair in self._walls
            )
            raise SectionError(
                f"walls of {flanges} (flange) and {webs} (web) leave no room in a box "
                f"of {self.height} m x {self.width} m; the walls must be thinner"
            )

    @property
    def _walls(self) -> tuple[Offset, Offset]:
        """The thicknesses in m of upper and lower flange, and of right and left web."""
        flanges = self.flange, self.bottom_flange or self.flange
        return flanges, (self.web, self.left_web or self.web)

    @property
    def area(self) -> float:
        return self.shear_area + self.lateral_shear_area

    @property
    def second_moment_of_area(self) -> float:
        return _hollow_rectangle(self.width, self.height, *reversed(self._walls))[1]

    @property
    def lateral_second_moment_of_area(self) -> float:
        return _hollow_rectangle(self.height, self.width, *self._walls)[1]

    @property
    def torsion_constant(self) -> float:
        (top, bottom), (right, left) = self._walls
        around = self.height / right + self.height / left
        around += self.width / top + self.width / bottom
        return 4.0 * (self.height * self.width) ** 2 / around

    @property
    def shear_area(self) -> float:
        """The shear area in m² for a force along z: the area of both webs."""
        return self.height * sum(self._walls[1])

    @property
    def lateral_shear_area(self) -> float:
        """The shear area in m² for a force along y: the area of both flanges."""
        return self.width * sum(self._walls[0])

    @property
    def centroid(self) -> Offset:
        """The centroid (y, z) in m from the middle of the mid-lines."""
        y, _ = _hollow_rectangle(self.height, self.width, *self._walls)
        z, _ = _hollow_rectangle(self.width, self.height, *reversed(self._walls))
        return y, z

    def __str__(self) -> str:
        flanges, webs = self._walls
        walls = [f"{1e3 * thickness:.4g}" for thickness in (*flanges, *webs)]
        if self.mirrors == ("y", "z"):
            walls = list(dict.fromkeys(walls))
        return f"{1e3 * self.height:.4g} x {1e3 * self.width:.4g} x {' / '.join(walls)}"

    def turned(self) -> BoxSection:
        (top, bottom), (right, left) = self._walls
        return BoxSection(self.width, self.height, right, top, left, bottom)

    @property
    def plates(self) -> tuple[Plate, ...]:
        """The four plates in the order bottom, right, top, left."""
        (y, z), b, h = self.centroid, 0.5 * self.width, 0.5 * self.height
        (top, bottom), (right, left) = self._walls
        (y0, z0), (y1, z1) = (-b - y, -h - z), (b - y, h - z)
        return (
            Plate("bottom", (y0, z0), (y1, z0), bottom),
            Plate("right", (y1, z0), (y1, z1), right),
            Plate("top", (y1, z1), (y0, z1), top),
            Plate("left", (y0, z1), (y0, z0), left),
        )

    @property
    def faces(self) -> tuple[Face, ...]:
        """The faces of all plates."""
        plates = self.plates
        return tuple(Face.from_plate(plates, n, *normal) for n, normal in enumerate(OUTWARDS))

    @property
    def mirrors(self) -> tuple[Direction, ...]:
        """The normals of the symmetry planes: ``y`` for equal webs, ``z`` for equal flanges."""
        alike: dict[Direction, bool] = {"y": not self.left_web, "z": not self.bottom_flange}
        return tuple(axis for axis, same in alike.items() if same)

    def shear_plates(self, direction: Direction) -> tuple[tuple[int, float], ...]:
        """Return (index, force in N) of the webs for z, or of the flanges for y, by equilibrium."""
        y, z = self.centroid
        if direction == "z":
            return (1, 0.5 + y / self.width), (3, y / self.width - 0.5)
        return (2, -0.5 - z / self.height), (0, 0.5 - z / self.height)


def _hollow_rectangle(
    width: float, height: float, webs: Offset, flanges: Offset
) -> tuple[float, float]:
    """Return the height of the centroid in m and the second moment in m⁴ of a hollow rectangle.

    Args:
        width, height: width and height of the mid-lines in m.
        webs: thicknesses of the webs in m.
        flanges: thicknesses of the upper and the lower flange in m.

    Returns:
        The height above the middle of the mid-lines, and the second moment about the centroidal
        axis along the width, by the parallel axis theorem.
    """
    web, flange = 0.5 * sum(webs), 0.5 * sum(flanges)
    # The centres of the outer rectangle and of the hole are at ±middle from the mid-lines' centre.
    middle = 0.25 * (flanges[0] - flanges[1])
    whole, hole = (width + web) * (height + flange), (width - web) * (height - flange)
    centre = middle * (whole + hole) / (whole - hole)
    outside, inside = (width + web) * (height + flange) ** 3, (width - web) * (height - flange) ** 3
    steiner = whole * (middle - centre) ** 2 - hole * (middle + centre) ** 2
    return centre, (outside - inside) / 12.0 + steiner


def infer_outer_section(
    area: float, second_moment_of_area: float, height_to_width: float
) -> BoxSection:
    """Return the box with uniform walls of an area, second moment and height-to-width ratio.

    Args:
        area: area in m².
        second_moment_of_area: second moment about y in m⁴.
        height_to_width: ratio of height to width of the mid-lines.

    Raises:
        SectionError: no wall thickness gives these values.
    """

    # Height b, width b/r and wall thickness c/b give 6 J = c ((1 + 3/r) b² + (3 + 1/r) c²/b²). The
    # larger of the two roots b² has the thinner wall.
    c = area / (2.0 * (1.0 + 1.0 / height_to_width))
    high, low = 1.0 + 3.0 / height_to_width, (3.0 + 1.0 / height_to_width) * c**2
    half = 3.0 * second_moment_of_area / c
    root = half**2 - high * low
    try:
        if root < 0.0:
            raise SectionError("no height has this J")
        height = float(np.sqrt((half + np.sqrt(root)) / high))
        return BoxSection(height, height / height_to_width, c / height, c / height)
    except SectionError:
        raise SectionError(
            f"no uniform-wall box has A = {area:.6g} m², J = {second_moment_of_area:.6g} m⁴ and "
            f"height/width = {height_to_width:g}; give the section explicitly"
        ) from None


def infer_inner_section(
    area: float, second_moment_of_area: float, outer: Section, clearance: float
) -> BoxSection:
    """Return the box with uniform walls that fits in ``outer`` with a clearance above and below.

    Args:
        area: area in m².
        second_moment_of_area: second moment about y in m⁴.
        outer: outer section.
        clearance: Δ in m, at the top and at the bottom.

    Raises:
        SectionError: no such box exists, or the outer section has inclined plates.
    """
    if len(outer.plates) != len(outer.faces):
        raise SectionError(
            "a box is inferred within a box alone, and the section around it has inclined plates; "
            "give the section explicitly"
        )
    high, wide = (outer.face(axis, 1).inside - outer.face(axis, -1).inside for axis in ("z", "y"))
    outside_height, widest = high - 2.0 * clearance, wide

    # For the wall thickness t, the height is the outside height − t, and the width A/2t − height.
    # The thickest wall is as thick as the box is wide. The thinnest wall gives the outside width
    # of a box that fills the outer section.
    thickest = area / (2.0 * max(outside_height, SMALLEST * high))
    total = outside_height + widest
    thinnest = 0.25 * (total - np.sqrt(max(total**2 - 4.0 * area, 0.0)))
    t = Polynomial([0.0, 1.0])
    h = outside_height - t
    defect = (area - 2.0 * t * h) * (3.0 * h**2 + t**2) + 2.0 * t * h * (h**2 + 3.0 * t**2)
    roots = (defect - 12.0 * second_moment_of_area).roots()
    real = np.sort(roots.real[np.abs(roots.imag) < _REAL * np.abs(roots)])
    walls = real[(real > thinnest) & (real < min(thickest, 0.5 * outside_height))]
    if walls.size == 0:
        raise SectionError(
            f"no uniform-wall box with A = {area:.6g} m² and J = {second_moment_of_area:.6g} m⁴ "
            f"closes a clearance of {clearance:g} m in a room of {high:.6g} m x {wide:.6g} m; give "
            "the section explicitly: pads then take up the difference to the stated clearance"
        )
    wall, height = float(walls[0]), float(outside_height - walls[0])
    return BoxSection(height, area / (2.0 * wall) - height, wall, wall)
