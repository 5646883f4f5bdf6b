# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stresses and wall forces of a reduced shell over time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from protractile.geometry.arrays import Array, Indices

if TYPE_CHECKING:
    import xarray as xr

    # Imported only for types, since gmsh takes long to load.
    from protractile.geometry.plating import PlatedMesh

Modes = npt.NDArray[np.float32]

Face = Literal["outer", "middle", "inner"]

# Stress components along x, along the coordinate s around the section, and in shear: membrane, then
# bending at the outer face.
COMPONENTS = (
    "membrane_x",
    "membrane_s",
    "membrane_xs",
    "bending_x",
    "bending_s",
    "bending_xs",
)

# Factor of the bending stress at each face.
FACES: dict[Face, float] = {"outer": 1.0, "middle": 0.0, "inner": -1.0}

# Tolerance in m for equal lengths.
SAME_LINE = 1.0e-6

# Tolerance in m² for areas.
_NEGLIGIBLE = 1.0e-300

# Number of values of a batch of times, which fits in the cache of the processor.
_AT_ONCE = 1_000_000

# Number of output times that are computed together.
_TOGETHER = 10


class Stress(NamedTuple):
    """Stresses at the centroids of triangles, in Pa."""

    membrane: npt.NDArray[np.float32]  #: σ_x, σ_s, τ_xs (..., 3) of the mid-surface
    #: stress (..., 3) of the outer face less that of the mid-surface; opposite for the inner face
    bending: npt.NDArray[np.float32]

    def at(self, face: Face) -> npt.NDArray[np.float32]:
        """Return σ_x, σ_s, τ_xs (..., 3) of a face in Pa."""
        return np.asarray(self.membrane + FACES[face] * self.bending)

    def von_mises(self, face: Face) -> npt.NDArray[np.float32]:
        """Return the von Mises stress (...) of a face, in Pa (Huber 1904, von Mises 1913)."""
        x, s, xs = np.moveaxis(self.at(face), -1, 0)
        return np.asarray(np.sqrt(x * x - x * s + s * s + 3.0 * xs * xs))

    def largest(self) -> npt.NDArray[np.float32]:
        """Return the larger of the von Mises stresses (...) of both faces in Pa."""
        return np.maximum(self.von_mises("outer"), self.von_mises("inner"))


@dataclass(frozen=True, slots=True)
class ShellStress:
    """Stresses of a shell in motion."""

    centroids: Array  #: centroids (num_triangles, 3) in m
    areas: Array  #: areas (num_triangles,) in m²
    thickness: Array  #: thicknesses (num_triangles,) in m
    spans: Array  #: smallest and largest x (num_triangles, 2) in m
    #: index (num_triangles,) of the segment of each triangle, ascending
    segment: npt.NDArray[np.int32]
    outward: Array  #: unit normals (num_triangles, 3) away from the axis
    #: index (num_triangles,) of the wall in its segment's ``plates``; larger indices are diaphragms
    wall: npt.NDArray[np.int32]
    plates: Sequence[Sequence[str]]  #: names of the plates of each segment
    #: stress components (num_own, num_own_triangles, 6) in Pa of each segment, for unit values of
    #: its coordinates
    modes: Sequence[Modes]
    states: Sequence[Modes]  #: coordinates (num_times, num_own) of each segment
    time: Array  #: times (num_times,) in s
    axial: npt.NDArray[np.float32]  #: constant stress (num_triangles,) of axial forces in Pa

    @classmethod
    def from_fields(cls, fields: xr.Dataset) -> ShellStress:
        """Return the stresses of the fields of a run, see :mod:`.shell_model.stress.fields`."""
        segment, state = fields["segment"].values, fields["state"].values
        numbers = range(1, int(segment.max()) + 2)
        coordinates = [fields[f"coordinates_{k}"].values for k in numbers]
        return cls(
            **_geometry(fields["points"].values, fields["triangles"].values),
            thickness=fields["thickness"].values,
            segment=segment,
            wall=fields["wall"].values,
            plates=[[str(name) for name in fields[f"plate_{k}"].values] for k in numbers],
            modes=[fields[f"stress_{k}"].values for k in numbers],
            states=[(state @ combination.T).astype(np.float32) for combination in coordinates],
            time=np.asarray(fields["time"].values, dtype=float),
            axial=np.asarray(fields["axial_stress"].values, dtype=np.float32)
            if "axial_stress" in fields
            else np.zeros(fields.sizes["triangle"], dtype=np.float32),
        )

    @classmethod
    def at_rest(cls, mesh: PlatedMesh, modes: Modes) -> ShellStress:
        """Return the stresses of one segment, from constant stress components ``modes`` in Pa."""
        return cls(
            **_geometry(mesh.points, mesh.triangles),
            thickness=mesh.thickness,
            segment=np.zeros(len(mesh.triangles), dtype=np.int32),
            wall=mesh.walls,
            plates=[mesh.plates],
            modes=[modes],
            states=[np.ones((1, 1), dtype=np.float32)],
            time=np.zeros(1),
            axial=np.zeros(len(mesh.triangles), dtype=np.float32),
        )

    def at(self, t: float) -> Stress:
        """Return the stress of all triangles at the output time nearest to ``t`` in s."""
        return next(self.instants([t]))

    def instants(self, times: Sequence[float]) -> Iterator[Stress]:
        """Yield the stress of all triangles at the output times nearest to ``times`` in s."""
        steps = [int(np.abs(self.time - t).argmin()) for t in times]
        # Modes exceed the cache of the processor, so that each is read once for several times.
        for begin in range(0, len(steps), _TOGETHER):
            some = steps[begin : begin + _TOGETHER]
            values = [
                np.tensordot(state[some], modes, axes=1)
                for state, modes in zip(self.states, self.modes, strict=True)
            ]
            together = np.concatenate(values, axis=1)
            together[..., 0] += self.axial
            yield from map(_stress, together)

    def over_time(
        self, triangles: Indices, steps: slice = slice(None), means: Array | None = None
    ) -> Iterator[tuple[slice, Stress]]:
        """Yield a slice of output times and the stresses of triangles at these times.

        Args:
            triangles: indices of triangles of one segment.
            steps: slice of output times; the yielded slices are relative to its start.
            means: weights (num_means, num_triangles) of means, which then replace the triangles.
        """
        (number,) = np.unique(self.segment[triangles])
        first = int(np.searchsorted(self.segment, number))
        states = self.states[number][steps]
        modes, axial = self.modes[number][:, triangles - first], self.axial[triangles]
        if means is not None:
            weights = means.astype(np.float32)
            modes, axial = np.einsum("pt,mtc->mpc", weights, modes), weights @ axial
        # Each component is contiguous in memory for fast sums over thousands of triangles.
        by_component = np.ascontiguousarray(modes.transpose(0, 2, 1))
        flat = by_component.reshape(len(modes), -1)
        piece = max(1, _AT_ONCE // max(1, flat.shape[1]))
        for begin in range(0, len(states), piece):
            part = slice(begin, min(begin + piece, len(states)))
            values = (states[part] @ flat).reshape(-1, *by_component.shape[1:])
            values[:, 0] += axial
            yield part, _stress(values.transpose(0, 2, 1))

    def largest(self, triangles: Indices, steps: slice = slice(None)) -> npt.NDArray[np.float32]:
        """Return the larger von Mises stress (num_times, num_triangles) of both faces in Pa."""
        return np.concatenate([s.largest() for _, s in self.over_time(triangles, steps)])

    def near(self, segment: int, x: float, reach: float) -> Indices:
        """Return the indices of a segment's triangles with centroids within ``reach`` in m of x."""
        close = np.abs(self.centroids[:, 0] - x) <= reach
        return np.flatnonzero(close & (self.segment == segment))

    def row(self, segment: int, x: float) -> Indices:
        """Return the indices of wall triangles between the two mesh lines that enclose x.

        Mesh lines are around the section; x is in m. If x is on a mesh line, it is the first one.
        """
        mine = (self.segment == segment) & (self.wall < len(self.plates[segment]))
        lines = lines_around(self.spans[mine])
        after = int(np.clip(np.searchsorted(lines, x + SAME_LINE, side="right"), 1, lines.size - 1))
        along = self.centroids[:, 0]
        return np.flatnonzero(mine & (along > lines[after - 1]) & (along < lines[after]))

    def wall_name(self, triangle: int) -> str:
        """Return the name of the wall or diaphragm of a triangle."""
        names, number = self.plates[self.segment[triangle]], int(self.wall[triangle])
        return names[number] if number < len(names) else f"diaphragm {number - len(names) + 1}"


def lines_around(spans: Array) -> Array:
    """Return the ascending x in m of mesh lines around the section, which no triangle crosses.

    ``spans`` (num_triangles, 2) has the smallest and the largest x of triangles in m.
    """
    first, last = np.sort(spans[:, 0]), np.sort(spans[:, 1])
    lines = np.unique(spans.round(6))
    started = np.searchsorted(first, lines - SAME_LINE)
    ended = np.searchsorted(last, lines + SAME_LINE)
    return np.asarray(lines[started == ended])


def _geometry(points: Array, triangles: Indices) -> dict[str, Array]:
    corners = points[triangles]
    along, centroids = corners[..., 0], corners.mean(axis=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    away = np.where((normals[:, 1:] * centroids[:, 1:]).sum(axis=1) < 0.0, -1.0, 1.0)
    return {
        "centroids": centroids,
        "outward": away[:, None] * normals / np.linalg.norm(normals, axis=1, keepdims=True),
        "areas": triangle_areas(points, triangles),
        "spans": np.stack([along.min(axis=1), along.max(axis=1)], axis=1),
    }


def triangle_areas(points: Array, triangles: Indices) -> Array:
    """Return the areas (num_triangles,) in m²."""
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return np.asarray(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))


def linear_stress_weights(part: Indices, reach: Array, strength: Array, place: Array) -> Array:
    """Return weights (num_triangles,) in m³ for the moment of linear stress within triangles.

    Args:
        part: index (num_triangles,) of the wall in its band.
        reach: extents (num_parts,) of the walls in m.
        strength: thickness times width (num_triangles,) in m².
        place: coordinates (num_triangles,) of the centroids in m.
    """
    whole = np.bincount(part, strength)
    about = place - (np.bincount(part, strength * place) / np.maximum(whole, _NEGLIGIBLE))[part]
    second = np.bincount(part, strength * about**2)[part]
    flat = reach[part] < SAME_LINE
    missing = whole[part] * reach[part] ** 2 / 12.0 - second
    return np.where(flat, 0.0, strength * about * missing / np.where(flat, 1.0, second))


def _stress(values: npt.NDArray[np.float32]) -> Stress:
    return Stress(values[..., :3], values[..., 3:])
