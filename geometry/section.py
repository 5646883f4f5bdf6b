# SPDX-License-Identifier: LGPL-3.0-or-later
"""Protocol of thin-walled sections, their plates and faces.

A section consists of flat plates around a cell. Coordinates (y, z) are relative to its centroid;
y is lateral, z in the plane of bending. Other modules do not depend on the number of plates: meshes
and shells use plates, contacts use faces, beams use properties.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple, Protocol

import numpy as np

from protractile.geometry.arrays import Array, Mask

Direction = Literal["z", "y"]
Side = Literal[-1, 0, 1]
EACH_SIDE: tuple[Side, Side] = (1, -1)
Offset = tuple[float, float]

# Index of each direction in (x, y, z).
COMPONENT: Mapping[Direction, int] = {"y": 1, "z": 2}


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

    def __hash__(self) -> int:
        """Return a hash, by which results of equal sections are kept."""
        return object.__hash__(self)

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
    def buckling_widths(self) -> tuple[float, ...]:
        """The width of each plate in m for buckling, between midpoints of bends (EN 1993-1-3, 5.1).

        A bend of the mid-line radius R and the angle φ takes R (tan φ/2 − sin φ/2) of it.
        """
        return tuple(plate.length for plate in self.plates)

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

    def within_outline(self) -> Section:
        """Return the section whose outer surface is where the mid-lines of this one are.

        Raises:
            SectionError: the walls fill the cell.
        """

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
