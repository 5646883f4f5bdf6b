# SPDX-License-Identifier: LGPL-3.0-or-later
"""Walls of flat plates once around a cell: material, room inside, places along x."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geometry.arrays import Array
from geometry.section import Plate, Section
from geometry.segment import Segment

# Sine of the angle below which plates meet butt to butt. A mitre would be long where their
# thicknesses differ.
_STRAIGHT = 0.1

# Fraction of a normal's length below which a plate does not limit the travel.
_ASIDE = 1.0e-9


def normals(plates: Sequence[Plate]) -> Array:
    """Return (num_plates, 2) outward unit vectors of plates that go around anticlockwise."""
    tangents = np.array([plate.tangent for plate in plates])
    return np.column_stack([tangents[:, 1], -tangents[:, 0]])


def trapezoids(plates: Sequence[Plate]) -> Array:
    """Return (num_plates, 4, 2) corners in m of each plate with its thickness, anticlockwise.

    The outer edge first. Neighbours meet where their surfaces do, so that corners are filled and
    the outermost edges are the section's outside, the innermost ones its hole.
    """
    start, end = (np.array([getattr(plate, at) for plate in plates]) for at in ("start", "end"))
    normal, half = normals(plates), 0.5 * np.array([plate.thickness for plate in plates])
    before, half_before = np.roll(normal, 1, axis=0), np.roll(half, 1)
    sine = before[:, 0] * normal[:, 1] - before[:, 1] * normal[:, 0]
    mitred = np.abs(sine) > _STRAIGHT
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
    return np.stack([start + first, end + last, end - last, start - first], axis=1)


def free_room(outer: Section, inner: Section, play: float = 0.0) -> tuple[float, float]:
    """Return the distances in m that a section can move within another one along z, then along y.

    Both must be convex. Less than 0 where it does not fit.

    Args:
        outer: the section around.
        inner: the section within, wherever it is along z.
        play: play in m, along z; wherever in it the inner section is, it can move so far along y.
    """
    reach = trapezoids(inner.plates)[:, :2].reshape(-1, 2)
    normal = normals(outer.plates)
    starts = np.array([plate.start for plate in outer.plates])
    walls = np.array([plate.thickness for plate in outer.plates])
    clear = (normal * starts).sum(axis=1) - 0.5 * walls - (normal @ reach.T).max(axis=1)
    low, high = _travel(normal[:, 1], clear)
    pressed = 0.5 * (low + high) + np.array([-0.5, 0.5]) * play
    widths = (_travel(normal[:, 0], clear - normal[:, 1] * place) for place in pressed)
    return high - low, min(right - left for left, right in widths)


def _travel(slope: Array, clear: Array) -> tuple[float, float]:
    """Return the lowest and the highest shift in m that leave room to every plate.

    Args:
        slope: (num_plates,) reduction of the room per unit of shift.
        clear: (num_plates,) room in m at a shift of 0.
    """
    ahead, behind = slope > _ASIDE, slope < -_ASIDE
    return float((clear[behind] / slope[behind]).max()), float((clear[ahead] / slope[ahead]).min())


# Fraction of the height: above the distance of walls, flat between mesh lines, from the section;
# below any edge.
_OFF_TAPER = 1.0e-4


class WallsAlong:
    """Mid-lines at each of many places.

    Args:
        segment: whose plates are known.
        x: (num_places,) in m.

    Attributes:
        near: places closer than this (m) to a mid-line are on it.
    """

    def __init__(self, segment: Segment, x: Array) -> None:
        self.near, sections, at = segment.widest.near, [segment.widest], np.zeros(x.size, dtype=int)
        if segment.head_section is not None:
            self.near = _OFF_TAPER * min(segment.section_at(e).size("z") for e in segment.ends)
            places, at = np.unique(x, return_inverse=True)
            sections = [segment.section_at(place) for place in places.tolist()]
        self._at = at
        self._starts = np.array([[plate.start for plate in one.plates] for one in sections])

    def starts(self, plate: int) -> Array:
        """Return (num_places, 2) the starts of a plate in m."""
        return np.asarray(self._starts[self._at, plate])

    def distance(self, plate: int, places: Array) -> Array:
        """Return (num_places,) distances of places (num_places, 2), one at each x, from a plate."""
        start, end = self.starts(plate), self.starts((plate + 1) % self._starts.shape[1])
        length = np.linalg.norm(end - start, axis=1)
        tangent = (end - start) / length[:, None]
        arms = places - start
        along = (arms * tangent).sum(axis=1)
        beyond = np.maximum(np.maximum(-along, along - length), 0.0)
        across = arms[:, 0] * tangent[:, 1] - arms[:, 1] * tangent[:, 0]
        return np.asarray(np.hypot(beyond, across))
