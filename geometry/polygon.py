# SPDX-License-Identifier: LGPL-3.0-or-later
"""Convex closed polygons of flat plates, each with its own thickness.

The shear flow q_s along the mid-line follows dq_s/dℓ = −t_w c·r (Jourawski 1856). Here ℓ is the
coordinate along the mid-line, t_w the wall thickness and r the position from the centroid. The
constant vector c follows from the shear force V = ∮ r rᵀ t_w dℓ c. The constant of integration
follows from zero twist, ∮ q_s/t_w dℓ = 0 (Bredt 1896). The solution is exact for flat plates, along
which q_s is quadratic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Real

import numpy as np

from protractile.geometry.arrays import Array, Indices
from protractile.geometry.box import OUTWARDS, BoxSection
from protractile.geometry.fields import format_value, is_positive
from protractile.geometry.section import (
    COMPONENT,
    Direction,
    Face,
    Offset,
    Plate,
    Section,
    SectionError,
)
from protractile.geometry.walls import half_turns, in_line, moments, trapezoids

# Fraction of a section's size below which two places are the same.
_SAME = 1.0e-9

# Largest coordinate in m, so that no product overflows.
_LARGEST = 1.0e6

# Limits of the angle at a corner in rad: below the first, the corner is concave; above the second,
# a plate folds back.
_LEAST_TURN, _MOST_TURN = -1.0e-9, np.radians(170.0)

# Gauss points and weights on a plate, exact for q_s².
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_ALONG, _PARTS = 0.5 * (1.0 + _POINTS), 0.5 * _WEIGHTS

# Fraction of the total force below which the shear force of a plate is round-off.
_NO_PART = 1.0e-12


@dataclass(frozen=True)
class PolygonSection(Section):
    """Closed section of flat plates, described by the corners of their mid-lines.

    Area, centroid and second moments include the thickness of plates, with mitred corners as in
    :class:`.geometry.box.BoxSection`, and with ring sectors in place of bent corners. So does the
    torsion constant. Plates reach to the sharp corners of their mid-lines, from which shear areas
    and forces of plates follow.

    >>> corners = ((-0.15, -0.3), (0.15, -0.3), (0.2, 0.3), (-0.2, 0.3))
    >>> trapezoid = pt.PolygonSection(corners, thicknesses=(0.01, 0.006, 0.008, 0.006))
    >>> print(f"{1e4 * trapezoid.area:.1f} cm²")
    134.2 cm²

    Args:
        corners: (y, z) in m of the corners in order, clockwise or anticlockwise, from any origin.
        thicknesses: thicknesses in m of the plates, each from a corner to the next; the last plate
            closes the cell.
        radii: radius of the mid-line in m of the bend at each corner, 0 at a sharp one; none unless
            given.

    Raises:
        SectionError: there are fewer than three corners, a size is invalid, a plate has no length,
            the polygon is not convex, walls fill the cell, or a bend does not fit.
    """

    corners: tuple[Offset, ...]
    thicknesses: tuple[float, ...]
    radii: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not self.radii:
            object.__setattr__(self, "radii", (0.0,) * len(self.corners))
        _check(self.corners, self.thicknesses, self.radii)

    @cached_property
    def plates(self) -> tuple[Plate, ...]:
        """The plates, anticlockwise from the lowest corner, or from the left one of two."""
        corners = self.upwards[0] - np.array(self.centroid)
        for axis in self.mirrors:
            # Meshes require that mirror images are exactly equal.
            image = _mirror(corners, axis)
            corners = 0.5 * (corners + image[_partners(corners, image)])
        return _plates(corners, self.upwards[1])

    @cached_property
    def _cut(self) -> Array:
        """The length (num_corners,) in m that half of a bend is shorter than its sharp corner."""
        half = half_turns(self.plates)
        return np.asarray(self.upwards[2] * (np.tan(half) - half))

    @cached_property
    def area(self) -> float:
        """The cross-sectional area in m²."""
        lengths = np.array([plate.length for plate in self.plates])
        return float((lengths - 2.0 * self._cut) @ self.upwards[1])

    @cached_property
    def second_moment_of_area(self) -> float:
        """The second moment about y (bending in the plane x-z) in m⁴."""
        return float(moments(self.plates, self.upwards[2])[3])

    @cached_property
    def lateral_second_moment_of_area(self) -> float:
        """The second moment about z (bending in the plane x-y) in m⁴."""
        return float(moments(self.plates, self.upwards[2])[2])

    @cached_property
    def torsion_constant(self) -> float:
        """The torsion constant in m⁴ (Bredt 1896)."""
        _, thicknesses, radii = self.upwards
        around = sum(plate.length / plate.thickness for plate in self.plates)
        around -= float((2.0 * self._cut / thicknesses).sum())
        return 4.0 * (self.enclosed_area - float(radii @ self._cut)) ** 2 / around

    @cached_property
    def buckling_widths(self) -> tuple[float, ...]:
        half = half_turns(self.plates)
        beyond = self.upwards[2] * (np.tan(half) - np.sin(half))
        both = (beyond + np.roll(beyond, -1)).tolist()
        return tuple(plate.length - part for plate, part in zip(self.plates, both, strict=True))

    @cached_property
    def shear_area(self) -> float:
        """The shear area in m² for a force along z, by the work of the shear flow."""
        return ShearFlow.from_plates(self.plates, "z").shear_area

    @cached_property
    def lateral_shear_area(self) -> float:
        """The shear area in m² for a force along y, by the work of the shear flow."""
        return ShearFlow.from_plates(self.plates, "y").shear_area

    @cached_property
    def centroid(self) -> Offset:
        """The centroid (y, z) in m in the coordinates of ``corners``."""
        corners, thicknesses, radii = self.upwards
        parts = moments(_plates(corners, thicknesses), radii)
        return float(parts[0]), float(parts[1])

    @cached_property
    def faces(self) -> tuple[Face, ...]:
        """The outermost plate of each direction and side, if exactly one plate is normal to it."""
        ends = np.array([(plate.start, plate.end) for plate in self.plates])
        faces = []
        for direction, side in OUTWARDS:
            outwards = side * ends[:, :, COMPONENT[direction] - 1]
            outermost = np.flatnonzero(outwards.min(axis=1) > outwards.max() - self.near)
            if len(outermost) == 1:
                faces.append(Face.from_plate(self.plates, int(outermost[0]), direction, side))
        return tuple(faces)

    @cached_property
    def mirrors(self) -> tuple[Direction, ...]:
        """The normals of the symmetry planes of corners and thicknesses."""
        corners, thicknesses, radii = self.upwards
        corners = corners - np.array(self.centroid)
        midpoints = 0.5 * (corners + np.roll(corners, -1, axis=0))
        sizes = np.concatenate([radii, thicknesses])
        directions: list[Direction] = []
        for axis in COMPONENT:
            places = np.vstack([corners, midpoints])
            partners = _partners(places, _mirror(places, axis))
            beside = np.linalg.norm(_mirror(places, axis)[partners] - places, axis=1)
            alike = (sizes[partners] == sizes).all()
            if beside.max() < _SAME * np.abs(corners).max() and alike:
                directions.append(axis)
        return tuple(directions)

    def shear_plates(self, direction: Direction) -> tuple[tuple[int, float], ...]:
        """Return (index, force in N along the tangent) of the plates, by the shear flow.

        A torque shifts the shear force from the shear centre to the axis.
        """
        flow = ShearFlow.from_plates(self.plates, direction)
        around = flow.moment / (flow.arms @ flow.lengths)
        forces = flow.forces - around * flow.lengths
        return tuple((n, force) for n, force in enumerate(forces.tolist()) if abs(force) > _NO_PART)

    def __str__(self) -> str:
        sizes = " x ".join(f"{1e3 * self.size(axis):.4g}" for axis in ("z", "y"))
        walls = " / ".join(dict.fromkeys(f"{1e3 * plate.thickness:.4g}" for plate in self.plates))
        bends = ", ".join(f"{1e3 * radius:.4g}" for radius in dict.fromkeys(self.radii) if radius)
        return f"{sizes} x {walls}, {len(self.plates)} plates{bends and f', R {bends}'}"

    def turned(self) -> PolygonSection:
        return replace(self, corners=tuple((z, y) for y, z in self.corners))

    def within_outline(self) -> PolygonSection:
        corners, walls, radii = self.upwards
        thickest = np.array([walls[line].max() for line in in_line(self.plates)])
        inner = trapezoids(_plates(corners, thickest))[:, 3]
        return _of_arrays(inner, walls, np.where(radii > 0.0, radii - 0.5 * walls, 0.0))

    @cached_property
    def upwards(self) -> tuple[Array, Array, Array]:
        """The corners (num_plates, 2), and thicknesses and radii (num_plates,) in m, as plates."""
        corners, thicknesses = np.array(self.corners), np.array(self.thicknesses)
        radii = np.array(self.radii)
        if _double_enclosed_area(corners) < 0.0:
            corners, thicknesses = corners[::-1], np.roll(thicknesses[::-1], -1)
            radii = radii[::-1]
        near = _SAME * float(np.ptp(corners, axis=0).max())
        low = np.flatnonzero(corners[:, 1] < corners[:, 1].min() + near)
        first = low[corners[low, 0].argmin()]
        walls, bends = (np.roll(each, -first) for each in (thicknesses, radii))
        return np.roll(corners, -first, axis=0), walls, bends


def _of_arrays(corners: Array, thicknesses: Array, radii: Array) -> PolygonSection:
    places = tuple((y, z) for y, z in corners.tolist())
    return PolygonSection(places, tuple(thicknesses.tolist()), tuple(radii.tolist()))


def bent(
    section: Section, radius: float, below: float = np.inf, inner: bool = False
) -> PolygonSection:
    """Return a section with bends at its sharp corners, except at welds of different thickness.

    >>> round(pt.bent(pt.hexagon(0.5, 0.4, 0.2, 0.006, 0.006, 0.006), radius=0.03).area, 7)
    0.0087302

    Args:
        section: section of flat plates.
        radius: radius in m, of the mid-line unless ``inner``.
        below: z in m of the corners of a polygon below which they are bent; all unless given.
        inner: whether the radius is that of the inner surface, of the bending tool.

    Raises:
        SectionError: no corner is bent, or as in :class:`PolygonSection`.
    """
    if not isinstance(section, PolygonSection):
        walls = tuple(plate.thickness for plate in section.plates)
        section = PolygonSection(tuple(plate.start for plate in section.plates), walls)
    corners, thicknesses, radii = section.upwards
    alike = thicknesses == np.roll(thicknesses, 1)
    bends = alike & (corners[:, 1] < below) & (radii == 0.0)
    if not bends.any():
        raise SectionError("no sharp corner has plates of one thickness; leave bend_radius out")
    middle = radius + 0.5 * inner * thicknesses
    return _of_arrays(corners, thicknesses, np.where(bends, middle, radii))


def closed_polygon(corners: Sequence[Offset], thicknesses: Sequence[float]) -> Section:
    """Return the section of a polygon. An upright rectangle becomes a :class:`BoxSection`.

    So both specifications of a box give the same shear area, the area of its webs.

    >>> corners = ((-0.15, -0.2), (0.15, -0.2), (0.15, 0.2), (-0.15, 0.2))
    >>> print(pt.closed_polygon(corners, thicknesses=(0.01, 0.006, 0.008, 0.006)))
    400 x 300 x 8 / 10 / 6 / 6

    Args:
        corners, thicknesses: as in :class:`PolygonSection`.

    Raises:
        SectionError: as in :class:`PolygonSection`.
    """
    for name, values in (("corners", corners), ("thicknesses", thicknesses)):
        if not isinstance(values, Sequence | np.ndarray):
            raise SectionError(f"{name} must be a sequence, got {format_value(values)}")
    section = PolygonSection(tuple(corners), tuple(thicknesses))
    if len(section.plates) != 4 or len(section.faces) != 4:
        # Tapers need corners in the order of plates.
        return _of_arrays(*section.upwards)
    bottom, right, top, left = (plate.thickness for plate in section.plates)
    return BoxSection(section.size("z"), section.size("y"), top, right, bottom, left)


def _check(corners: Sequence[Offset], thicknesses: Sequence[float], radii: Sequence[float]) -> None:
    if len(corners) < 3:
        raise SectionError(f"a closed polygon has three corners at least, got {len(corners)}")
    if len(thicknesses) != len(corners):
        raise SectionError(
            f"{len(corners)} corners have as many plates between them, got {len(thicknesses)} "
            "thicknesses; give one for each plate, the last one from the last corner to the first"
        )
    if not all(isinstance(corner, Sequence | np.ndarray) for corner in corners):
        raise SectionError(f"corners must be pairs of numbers, got {format_value(corners)}")
    for place in (number for corner in corners for number in corner):
        if not (isinstance(place, Real) and abs(place) < _LARGEST):
            raise SectionError(f"corners must be numbers of m below {_LARGEST:g}, got {place}")
    for thickness in thicknesses:
        if not (is_positive(thickness) and thickness < _LARGEST):
            raise SectionError(
                f"thicknesses must be numbers of m above 0 and below {_LARGEST:g}, got {thickness}"
            )
    places = np.array(corners)
    if _double_enclosed_area(places) < 0.0:
        places = places * [-1.0, 1.0]
    plates = _plates(places, np.array(thicknesses))
    for number, plate in enumerate(plates, start=1):
        if plate.length <= _SAME * sum(plate.length for plate in plates):
            raise SectionError(
                f"corners {number} and {number % len(corners) + 1} are one; give each once"
            )
    turns = 2.0 * half_turns(plates)
    for number, turn in enumerate(turns, start=1):
        if not _LEAST_TURN <= turn <= _MOST_TURN:
            how = "back" if abs(turn) > _MOST_TURN else "inwards"
            raise SectionError(
                f"corner {number} turns {how}; plates go once around, every corner outwards"
            )
    if turns.sum() > 3.0 * np.pi:
        raise SectionError("the plates go around more than once")
    for number, (inwards, plate) in enumerate(
        zip(trapezoids(plates), plates, strict=True), start=1
    ):
        if (inwards[2] - inwards[3]) @ plate.tangent <= 0.0:
            raise SectionError(
                f"plate {number} of {thicknesses[number - 1]} m and its neighbours leave no room "
                "in the polygon; they must be thinner"
            )
    _check_bends(radii, plates)


def _check_bends(radii: Sequence[float], plates: Sequence[Plate]) -> None:
    if len(radii) != len(plates):
        raise SectionError(f"{len(plates)} corners have as many radii, got {len(radii)}")
    for k, (radius, plate) in enumerate(zip(radii, plates, strict=True)):
        least = 0.5 * plate.thickness
        alike = plates[k - 1].thickness == plate.thickness
        if radius != 0.0 and not (is_positive(radius) and radius >= least and alike):
            raise SectionError(
                f"the mid-line of a bend must have a radius of at least {least:g} m, half of the "
                f"thickness on both of its sides, got {radius:g} m"
            )
    ends = np.array(radii) * np.tan(half_turns(plates))
    for plate, taken in zip(plates, ends + np.roll(ends, -1), strict=True):
        if taken > (1.0 + _SAME) * plate.length:
            raise SectionError(
                f"bends take {taken:g} m of a plate of {plate.length:g} m; their radius must be "
                "smaller"
            )


def _plates(corners: Array, thicknesses: Array) -> tuple[Plate, ...]:
    """Return the plates; their names have the side and a number from the bottom upwards."""
    names = _names(corners)
    ends: list[Offset] = [(y, z) for y, z in corners.tolist()]
    return tuple(
        Plate(name, start, end, thickness)
        for name, start, end, thickness in zip(
            names, ends, [*ends[1:], ends[0]], thicknesses.tolist(), strict=True
        )
    )


def _names(corners: Array) -> list[str]:
    """Return the names of plates: bottom, top, right or left, with a number if needed."""
    ends, low, high = np.roll(corners, -1, axis=0), corners[:, 1].min(), corners[:, 1].max()
    near = _SAME * (high - low)
    sides = []
    for (_, start), (_, end) in zip(corners, ends, strict=True):
        if max(start, end) < low + near:
            sides.append("bottom")
        elif min(start, end) > high - near:
            sides.append("top")
        else:
            sides.append("right" if end > start else "left")
    names = []
    for n, side in enumerate(sides):
        count, before = sides.count(side), sides[:n].count(side)
        upwards = count - before if side == "left" else before + 1
        names.append(side if count == 1 else f"{side}-{upwards}")
    return names


def _double_enclosed_area(corners: Array) -> float:
    """Return twice the area within corners (num_corners, 2), positive if anticlockwise."""
    after = np.roll(corners, -1, axis=0)
    return float(corners[:, 0] @ after[:, 1] - corners[:, 1] @ after[:, 0])


def _mirror(places: Array, axis: Direction) -> Array:
    return np.asarray(places * [-1.0 if axis == component else 1.0 for component in COMPONENT])


def _partners(places: Array, images: Array) -> Indices:
    """Return the index (num_places,) of the mirror image nearest to each place."""
    distances = np.linalg.norm(places[:, None] - images, axis=2)
    return np.asarray(distances.argmin(axis=1))


@dataclass(frozen=True, slots=True)
class ShearFlow:
    """Shear flow of a force of 1 N through the shear centre.

    Args:
        flow: q_s (num_plates, num_points) in N/m per N at the Gauss points of plates, positive
            along their tangents.
        lengths, thicknesses: lengths and thicknesses (num_plates,) of the plates in m.
        arms: lever arms (num_plates,) of the tangents about the axis in m.
    """

    flow: Array
    lengths: Array
    thicknesses: Array
    arms: Array

    @classmethod
    def from_plates(cls, plates: Sequence[Plate], direction: Direction) -> ShearFlow:
        """Return the shear flow of a force of 1 N along a direction.

        Args:
            plates: plates of a closed section in order, each from the end of the previous one.
        """
        start = np.array([plate.start for plate in plates])
        side = np.array([plate.end for plate in plates]) - start
        length, thickness = np.array([(plate.length, plate.thickness) for plate in plates]).T
        area, middle = length * thickness, start + 0.5 * side
        start = start - area @ middle / area.sum()
        half = start + 0.5 * side
        moments = (area * half.T) @ half + (area * side.T) @ side / 12.0
        slope = np.linalg.solve(moments, np.eye(2)[COMPONENT[direction] - 1])
        grown = np.outer(start @ slope, _ALONG) + np.outer(side @ slope, 0.5 * _ALONG**2)
        whole = area * (half @ slope)
        opened = (whole - np.cumsum(whole))[:, None] - area[:, None] * grown
        slip = length / thickness
        return cls(
            flow=opened - slip @ opened @ _PARTS / slip.sum(),
            lengths=length,
            thicknesses=thickness,
            arms=(middle[:, 0] * side[:, 1] - middle[:, 1] * side[:, 0]) / length,
        )

    @property
    def shear_area(self) -> float:
        """The shear area 1/∮ q_s²/t_w dℓ in m², which has equal strain energy (Pilkey 2002)."""
        return float(1.0 / (self.lengths / self.thicknesses @ self.flow**2 @ _PARTS))

    @property
    def forces(self) -> Array:
        """The force (num_plates,) of each plate along its tangent, in N per N of shear force."""
        return np.asarray(self.lengths * (self.flow @ _PARTS))

    @property
    def moment(self) -> float:
        """The moment about the axis in N·m per N: the lever arm in m of the shear force."""
        return float(self.arms @ self.forces)
