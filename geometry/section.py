# SPDX-License-Identifier: LGPL-3.0-or-later
"""Thin-walled single-cell box sections, and their inference from what a beam model knows.

A beam model gives a section's area and second moment of area; a shell model needs its
plates. With a uniform wall a box has three numbers (height, width, wall), so one more is
needed: the height-to-width ratio for the outermost segment, the room inside the next
larger section for every other one.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from scipy.optimize import brentq

# No inner box is lower than this part of the outer one.
SMALLEST = 1.0e-6


class SectionError(ValueError):
    """No box section satisfies what is asked of it."""


@dataclass(frozen=True, slots=True)
class BoxSection:
    """Rectangular box, described by the mid-lines and thicknesses of its four walls.

    Args:
        height: distance of the flange mid-lines (along z) in m.
        width: distance of the web mid-lines (along y) in m.
        flange: thickness of the two flanges (z = ±height/2) in m.
        web: thickness of the two webs (y = ±width/2) in m.

    Raises:
        SectionError: a dimension is not positive and finite, or the walls fill the box.
    """

    height: float
    width: float
    flange: float
    web: float

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (np.isfinite(value) and value > 0.0):
                raise SectionError(f"{field.name} must be a positive number of m, got {value}")
        if self.flange >= self.height or self.web >= self.width:
            raise SectionError(
                f"walls of {self.flange} m (flange) and {self.web} m (web) leave no room in a box "
                f"of {self.height} m x {self.width} m; the walls must be thinner"
            )

    @property
    def area(self) -> float:
        """Cross-sectional area in m²."""
        return 2.0 * (self.height * self.web + self.width * self.flange)

    @property
    def second_moment_of_area(self) -> float:
        """Second moment about y (bending in the plane x-z) in m⁴."""
        return _hollow_rectangle(self.width, self.height, self.web, self.flange)

    @property
    def lateral_second_moment_of_area(self) -> float:
        """Second moment about z (bending in the plane x-y) in m⁴."""
        return _hollow_rectangle(self.height, self.width, self.flange, self.web)

    @property
    def polar_second_moment_of_area(self) -> float:
        """Second moment about the axis (density times it is the polar inertia) in m⁴."""
        return self.second_moment_of_area + self.lateral_second_moment_of_area

    @property
    def torsion_constant(self) -> float:
        """Bredt's second formula, 4 A² / ∮ ds/t, in m⁴ (Bredt 1896)."""
        enclosed = self.height * self.width
        return 4.0 * enclosed**2 / (2.0 * self.height / self.web + 2.0 * self.width / self.flange)

    @property
    def shear_area(self) -> float:
        """Area that carries a shear force along z: the two webs, in m²."""
        return 2.0 * self.height * self.web

    @property
    def lateral_shear_area(self) -> float:
        """Area that carries a shear force along y: the two flanges, in m²."""
        return 2.0 * self.width * self.flange

    def turned(self) -> BoxSection:
        """The box lying on its side, y and z exchanged."""
        return BoxSection(self.width, self.height, self.web, self.flange)

    def mass_per_length(self, density: float) -> float:
        """Mass of a unit of length in kg/m, for a density in kg/m³."""
        return density * self.area

    def clear_height_around(self, inner: BoxSection) -> float:
        """Height between this section's inner faces less ``inner``'s outer height, in m."""
        return (self.height - self.flange) - (inner.height + inner.flange)

    def clear_width_around(self, inner: BoxSection) -> float:
        """Width between this section's inner faces less ``inner``'s outer width, in m."""
        return (self.width - self.web) - (inner.width + inner.web)


def _hollow_rectangle(width: float, height: float, web: float, flange: float) -> float:
    """Second moment of a hollow rectangle about the axis parallel to its width, in m⁴."""
    outside = (width + web) * (height + flange) ** 3
    inside = (width - web) * (height - flange) ** 3
    return (outside - inside) / 12.0


def infer_outer_section(
    area: float, second_moment_of_area: float, height_to_width: float
) -> BoxSection:
    """The uniform-wall box with a given area, second moment and height-to-width ratio.

    Args:
        area: m².
        second_moment_of_area: m⁴, about y.
        height_to_width: mid-line height over mid-line width.

    Raises:
        SectionError: no wall thickness gives these numbers.
    """

    def box(height: float) -> BoxSection:
        width = height / height_to_width
        wall = area / (2.0 * (height + width))
        return BoxSection(height, width, wall, wall)

    # Thin-walled estimate of the height: J/A = h² (1 + 3/r) / (12 (1 + 1/r)).
    shape = (1.0 + 3.0 / height_to_width) / (12.0 * (1.0 + 1.0 / height_to_width))
    estimate = float(np.sqrt(second_moment_of_area / area / shape))
    try:
        height = brentq(
            lambda h: box(h).second_moment_of_area - second_moment_of_area,
            0.7 * estimate,
            1.3 * estimate,
            xtol=1e-15 * estimate,
            rtol=1e-14,
        )
    except ValueError:
        raise SectionError(
            f"no uniform-wall box has A = {area:.6g} m², J = {second_moment_of_area:.6g} m⁴ and "
            f"height/width = {height_to_width:g}; give the section explicitly"
        ) from None
    return box(height)


def infer_inner_section(
    area: float, second_moment_of_area: float, outer: BoxSection, clearance: float
) -> BoxSection:
    """The uniform-wall box that fills ``outer`` up to the clearance above and below.

    Args:
        area: m².
        second_moment_of_area: m⁴, about y.
        outer: the section around it.
        clearance: Δ in m, at the top and at the bottom.

    Raises:
        SectionError: no such box exists, or it is too wide; the way out is an explicit
            section with pads that leave the stated clearance.
    """
    outside_height = outer.height - outer.flange - 2.0 * clearance
    widest = outer.width - outer.web

    def box(wall: float) -> BoxSection:
        height = outside_height - wall
        return BoxSection(height, area / (2.0 * wall) - height, wall, wall)

    def defect(wall: float) -> float:
        return box(wall).second_moment_of_area - second_moment_of_area

    # With height = H − t and width = A/2t − height, the wall is thickest where the width is
    # down to the wall itself, and thinnest where width + t fills the outer section.
    thickest = area / (2.0 * max(outside_height, SMALLEST * outer.height))
    total = outside_height + widest
    thinnest = 0.25 * (total - np.sqrt(max(total**2 - 4.0 * area, 0.0)))
    walls = np.linspace(thinnest, thickest, 401)[:-1]
    try:
        signs = np.sign([defect(wall) for wall in walls])
    except SectionError:  # no room at all
        signs = np.zeros(0)
    crossing = np.flatnonzero(signs[:-1] != signs[1:])
    if crossing.size == 0:
        raise SectionError(
            f"no uniform-wall box with A = {area:.6g} m² and J = {second_moment_of_area:.6g} m⁴ "
            f"closes a clearance of {clearance:g} m inside {outer.height:.6g} m x "
            f"{outer.width:.6g} m x {outer.flange:.6g} m; give the section explicitly: pads then "
            "take up the difference to the stated clearance"
        )
    first = crossing[0]
    wall = brentq(defect, walls[first], walls[first + 1], xtol=1e-15 * walls[first], rtol=1e-14)
    return box(float(wall))
