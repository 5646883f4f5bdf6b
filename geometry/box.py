# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rectangular box, and its inference from beam properties.

Shells need plates, but beam data give only area and second moment. A box with uniform walls has
three parameters: height, width and thickness. The third condition is a given height-to-width ratio
for the outermost segment, and the clearance within the next larger section for all others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import MISSING, dataclass, fields, replace

import numpy as np
from numpy.polynomial import Polynomial

from protractile.geometry.fields import is_positive
from protractile.geometry.section import Direction, Face, Offset, Plate, Section, SectionError, Side

# Minimum height of an inferred inner box, as a fraction of the height inside the outer section.
SMALLEST = 1.0e-6

# Fraction of the modulus of a root below which its imaginary part is round-off.
_REAL = 1.0e-8

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

    def within_outline(self) -> BoxSection:
        flange, web = (0.5 * sum(pair) for pair in self._walls)
        return replace(self, height=self.height - flange, width=self.width - web)

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
