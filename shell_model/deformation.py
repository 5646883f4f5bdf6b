# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where a picture shows the points of a deformed shell.

Displacements of millimetres are invisible on a boom of many metres, so pictures magnify them.
They magnify the play alike, at the cost of the inner section's height: segments touch in the
picture when they touch in the run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int32]

# Walls are drawn with this part of the outer section's height; their thickness is not known here.
WALL_DRAWN = 0.03

# Lengths in m that are the same; a displacement, as a part of the largest one, that is none in
# single precision.
SAME_PLACE, AT_REST = 1.0e-6, 1.0e-6


class Overlap(NamedTuple):
    """Two segments that slide in one another.

    Args:
        outer, inner: their numbers.
        stations: where they touch, as positions in the trajectories.
        clearance: Δ in m.
    """

    outer: int
    inner: int
    stations: list[int]
    clearance: float


@dataclass(frozen=True, slots=True)
class MovingShell:
    """A reduced shell and its motion.

    Args:
        points: (num_points, 3) in m.
        triangles: (num_triangles, 3) point numbers.
        segment: (num_triangles,) of each triangle.
        overlaps: from the base to the tip.
        modes: (num_modes, num_points, 3) in 1/√kg.
        state: (time, mode) modal coordinates.
        motion: trajectories of this shell alone.
    """

    points: Array
    triangles: Indices
    segment: Indices
    overlaps: Sequence[Overlap]
    modes: npt.NDArray[np.float32]
    state: xr.DataArray
    motion: xr.Dataset

    @classmethod
    def of(cls, fields: xr.Dataset, motion: xr.Dataset) -> MovingShell:
        """From what a run has written.

        Args:
            fields: ``points``, ``triangles``, ``segment``, ``modes`` and ``state``.
            motion: dims ``time``, ``station``: ``tip`` and ``gap`` in m, ``contact_force`` and
                ``contact_force_peak`` in N; coordinate ``direction`` of the stations.
        """
        points, triangles = fields["points"].values, fields["triangles"].values
        segment = fields["segment"].values
        boxes = [points[np.unique(triangles[segment == k])] for k in range(segment.max() + 1)]
        return cls(
            points=points,
            triangles=triangles,
            segment=segment,
            overlaps=find_overlaps(boxes, motion),
            modes=fields["modes"].values,
            state=fields["state"].load(),
            motion=motion,
        )

    def displacement(self, t: float) -> Array:
        """(num_points, 3) in m, at the output time next to ``t`` (s)."""
        state = self.state.sel(time=t, method="nearest").values
        return np.asarray(np.tensordot(state, self.modes, axes=1), dtype=np.float64)

    def members(self, segment: int) -> Indices:
        """(num_members,) point numbers of a segment."""
        return np.asarray(np.unique(self.triangles[self.segment == segment]))

    def half_height(self, segment: int) -> float:
        """Distance of a segment's flanges from its axis in m."""
        return float(self.points[self.members(segment), 2].max())

    def supports(self) -> list[Array]:
        """(num_points, 3) each: the outlines that no mode moves across the boom."""
        across = np.abs(self.modes[..., 1:]).max(axis=(0, 2))
        held = self.points[across <= AT_REST * across.max()]
        return [held[np.abs(held[:, 0] - x) < SAME_PLACE] for x in np.unique(held[:, 0].round(6))]

    def flange_in_plane(self, segment: int, side: int) -> Indices:
        """(num_points,) the points of a flange in the plane of bending, from base to tip.

        Args:
            segment: which.
            side: 1 for the top, -1 for the bottom.
        """
        mine = self.members(segment)
        _, y, z = self.points[mine].T
        mine = mine[(np.abs(y) < SAME_PLACE) & (side * z > z.max() - SAME_PLACE)]
        return np.asarray(mine[self.points[mine, 0].argsort()])

    def wall(self, overlap: Overlap) -> float:
        """Thickness in m with which the walls of an overlap are drawn."""
        return 2.0 * WALL_DRAWN * self.half_height(overlap.outer)

    def drawn(self, moved: Array, scale: float, section: float = 1.0) -> Array:
        """(num_points, 3) places in m at which a picture shows the points.

        A section that is drawn larger also turns with its larger height.

        Args:
            moved: (num_points, 3) displacement in m.
            scale: of displacement and play.
            section: of the outermost section.
        """
        factor = self._section_factors(scale, section)
        x, y, z = self.points.T
        ux, uy, uz = scale * moved.T
        return np.stack([x + factor * ux, factor * y + uy, factor * z + uz], axis=1)

    def _section_factors(self, scale: float, section: float) -> Array:
        """(num_points,) of y and z; every inner segment makes room for the play around it."""
        factors = np.full(int(self.segment.max()) + 1, section)
        for overlap in sorted(self.overlaps, key=lambda o: -self.half_height(o.outer)):
            around = factors[overlap.outer] * self.half_height(overlap.outer)
            room = scale * overlap.clearance + section * self.wall(overlap)
            factors[overlap.inner] = (around - room) / self.half_height(overlap.inner)
        at_points = np.ones(len(self.points))
        at_points[self.triangles] = factors[self.segment][:, None]
        return at_points


def find_overlaps(boxes: Sequence[Array], motion: xr.Dataset) -> list[Overlap]:
    """Neighbours, each with the stations along z that are next to an end of their overlap.

    Segments touch at heads and tails, and the outer one of two is the higher one. What presses
    to the sides, or on the ground outside an overlap, is no part of it.

    Args:
        boxes: (num_points, 3) in m, one of each segment.
        motion: ``gap``, ``contact_force`` (time, station); ``direction`` (station).
    """
    stations = motion["station"].values
    if len(boxes) < 2 or stations.size == 0:
        return []
    begins = np.array([box[:, 0].min() for box in boxes])
    ends = np.array([box[:, 0].max() for box in boxes])
    limits = [np.maximum(begins[:-1], begins[1:]), np.minimum(ends[:-1], ends[1:])]
    pair = np.min([np.abs(stations[:, None] - limit) for limit in limits], axis=0).argmin(axis=1)
    between = (stations > limits[0][pair] - SAME_PLACE) & (stations < limits[1][pair] + SAME_PLACE)
    between &= motion["direction"].values == "z"
    overlaps = []
    for base in np.unique(pair[between]):
        outer, inner = sorted((base, base + 1), key=lambda k: -float(boxes[k][:, 2].max()))
        mine = np.flatnonzero(between & (pair == base))
        # A gap in contact is the clearance but for the penetration. Where nothing ever touches,
        # the distance of the mid-surfaces is the most that the clearance can be.
        clearance = float(boxes[outer][:, 2].max() - boxes[inner][:, 2].max())
        pressed = np.nan_to_num(motion["contact_force"].values[:, mine]) != 0.0
        if pressed.any():
            gap = np.abs(motion["gap"].values[:, mine][pressed])
            clearance = min(clearance, float(np.median(gap)))
        overlaps.append(Overlap(int(outer), int(inner), mine.tolist(), clearance))
    return overlaps


def round_scale(largest: float) -> float:
    """The largest of …, 1, 2, 5, 10, 20, … that is not above ``largest``."""
    decade = 10.0 ** np.floor(np.log10(largest))
    return float(decade * max(step for step in (1.0, 2.0, 5.0) if step * decade <= largest))
