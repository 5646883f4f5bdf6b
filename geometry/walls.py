# SPDX-License-Identifier: LGPL-3.0-or-later
"""Walls of flat plates around a cell: thick plates and clearances."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.section import COMPONENT, Direction, Plate, Section

# Sine of the angle between plates below which they have a butt joint instead of a mitre, which
# would be long between different thicknesses.
_STRAIGHT = 0.1

# Half of the angle between plates in rad below which they are in one straight line.
_IN_LINE = 1.0e-6

# Gauss points and weights along a bend, exact to round-off.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)

# Component of a normal below which a plate does not limit a shift.
_ALONG = 1.0e-9


def normals(plates: Sequence[Plate]) -> Array:
    """Return the outward unit normals (num_plates, 2) of plates in anticlockwise order."""
    tangents = np.array([plate.tangent for plate in plates])
    return np.column_stack([tangents[:, 1], -tangents[:, 0]])


def half_turns(plates: Sequence[Plate]) -> Array:
    """Return half of the angle (num_plates,) in rad by which mid-lines turn before each plate."""
    after = normals(plates)
    before = np.roll(after, 1, axis=0)
    sines = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.asarray(0.5 * np.arctan2(sines, (before * after).sum(axis=1)))


def trapezoids(plates: Sequence[Plate], radii: Array | float = 0.0) -> Array:
    """Return the corners (num_plates, 4, 2) in m of thick plates, anticlockwise, outer edge first.

    Neighbours are mitred, so that the trapezoids fill the wall. Plates end at their bends, which
    have the mid-line ``radii`` (num_plates,) in m at their starts.
    """
    start, end = (np.array([getattr(plate, at) for plate in plates]) for at in ("start", "end"))
    normal, half = normals(plates), 0.5 * np.array([plate.thickness for plate in plates])
    before, half_before = np.roll(normal, 1, axis=0), np.roll(half, 1)
    sine = before[:, 0] * normal[:, 1] - before[:, 1] * normal[:, 0]
    mitred = (np.abs(sine) > _STRAIGHT) & (radii == np.zeros(len(plates)))
    corner = np.column_stack(
        [
            half_before * normal[:, 1] - half * before[:, 1],
            half * before[:, 0] - half_before * normal[:, 0],
        ]
    ) / np.where(mitred, sine, 1.0)[:, None]  # fmt: skip
    first = np.where(mitred[:, None], corner, half[:, None] * normal)
    last = np.where(
        np.roll(mitred, -1)[:, None], np.roll(corner, -1, axis=0), half[:, None] * normal
    )
    cut, tangent = radii * np.tan(half_turns(plates)), normal[:, ::-1] * [-1.0, 1.0]
    start, end = start + cut[:, None] * tangent, end - np.roll(cut, -1)[:, None] * tangent
    return np.stack([start + first, end + last, end - last, start - first], axis=1)


def in_line(plates: Sequence[Plate]) -> list[list[int]]:
    """Return, for each plate, the plates that welds join to it in one straight line, in order."""
    welded = np.abs(half_turns(plates)) < _IN_LINE
    lines = []
    for first in range(len(plates)):
        last = first
        while welded[first % len(plates)]:
            first -= 1
        while welded[(last + 1) % len(plates)]:
            last += 1
        lines.append([number % len(plates) for number in range(first, last + 1)])
    return lines


# Load cases and combinations have the same sections.
@lru_cache(maxsize=256)
def outer_surfaces(section: Section, direction: Direction = "z") -> tuple[float, float]:
    """Return the smallest and the largest z or y in m of the outer surfaces of a section."""
    places = trapezoids(section.plates)[:, :2, COMPONENT[direction] - 1]
    return float(places.min()), float(places.max())


def moments(plates: Sequence[Plate], radii: Array) -> Array:
    """Return the centroid in m, and ∫ y² dA and ∫ z² dA in m⁴.

    Plates count by Green's theorem, and bends as ring sectors.

    Args:
        plates: plates in order, anticlockwise.
        radii: radius (num_plates,) in m of the mid-line at the start of each plate.
    """
    polygons = trapezoids(plates, radii)
    after = np.roll(polygons, -1, axis=1)
    cross = polygons[..., 0] * after[..., 1] - polygons[..., 1] * after[..., 0]
    area = 0.5 * cross.sum()
    first = ((polygons + after) * cross[..., None]).sum(axis=(0, 1)) / 6.0
    squares = polygons**2 + polygons * after + after**2
    second = (squares * cross[..., None]).sum(axis=(0, 1)) / 12.0
    for k, half in zip(np.flatnonzero(radii), half_turns(plates)[radii > 0.0], strict=True):
        # The sector ends at the plate, whose first edge points to its centre.
        radius, wall = radii[k], plates[k].thickness
        y, z = polygons[k, 0] - polygons[k, 3]
        angles = np.arctan2(z, y) + half * (_NODES - 1.0)
        unit = np.column_stack([np.cos(angles), np.sin(angles)])
        centre = 0.5 * (polygons[k, 0] + polygons[k, 3]) - radius * np.array([y, z]) / wall
        # Integrals of r, r² and r³ over the thickness.
        one, three = radius * wall, radius * wall * (radius**2 + 0.25 * wall**2)
        two, weights = wall * (radius**2 + wall**2 / 12.0), half * _WEIGHTS
        area += one * weights.sum()
        first += weights @ (one * centre + two * unit)
        second += weights @ (one * centre**2 + 2.0 * two * centre * unit + three * unit**2)
    return np.concatenate([first / area, second])


@lru_cache(maxsize=256)
def free_room(outer: Section, inner: Section, play: float = 0.0) -> tuple[float, float]:
    """Return the total clearances in m, along z and along y, of a section within another one.

    Both sections must be convex. If a clearance is negative, the inner section does not fit.

    Args:
        play: play along z in m; the clearance along y is the smallest one within this play.
    """
    reach = trapezoids(inner.plates)[:, :2].reshape(-1, 2)
    normal = normals(outer.plates)
    starts = np.array([plate.start for plate in outer.plates])
    walls = np.array([plate.thickness for plate in outer.plates])
    clear = (normal * starts).sum(axis=1) - 0.5 * walls - (normal @ reach.T).max(axis=1)
    low, high = _shift_range(normal[:, 1], clear)
    shifts = 0.5 * (low + high) + np.array([-0.5, 0.5]) * play
    widths = (_shift_range(normal[:, 0], clear - normal[:, 1] * shift) for shift in shifts)
    return high - low, min(right - left for left, right in widths)


def _shift_range(slope: Array, clear: Array) -> tuple[float, float]:
    """Return the lowest and the highest shift in m at which no plate interferes.

    Args:
        slope: reduction (num_plates,) of each plate's clearance per unit of shift.
        clear: clearance (num_plates,) in m at a shift of 0.
    """
    ahead, behind = slope > _ALONG, slope < -_ALONG
    return float((clear[behind] / slope[behind]).max()), float((clear[ahead] / slope[ahead]).min())
