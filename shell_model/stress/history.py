# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stress maxima of a run: near stations and supports at every output time, and overall.

At a line force, for example beside a web, the stress of the nearest triangles increases with mesh
refinement. It gives position and time of the maximum, but is no design stress. A patch stress, the
mean over a part of a wall of fixed size, converges.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from protractile.geometry.arrays import Array, Indices
from protractile.shell_model.stress.stresses import (
    Face,
    Modes,
    ShellStress,
    Stress,
)

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, slots=True)
class LargestPatch:
    """Largest patch stress in Pa, with time in s, segment, and x in m of the centre of the band."""

    von_mises: float
    time: float
    segment: str
    x: float


@dataclass(frozen=True, slots=True)
class StressSummary:
    """Largest stress of a run.

    Args:
        von_mises: largest stress of a triangle in Pa.
        time: time of this stress in s.
        segment, wall, face: location of this stress.
        x, y, z: centroid of the triangle in m.
        band: half-width in m of the bands around places.
        patch: largest patch stress; None if no segment comes near a place.
    """

    von_mises: float
    time: float
    segment: str
    wall: str
    face: str
    x: float
    y: float
    z: float
    band: float
    patch: LargestPatch | None


# Half-length in m of the band at a place. A patch is a half of a wall within the band.
BAND = 0.25

# Faces of a wall. The stress of a triangle is the larger one of both faces.
_FACES: tuple[Face, ...] = ("outer", "inner")

# Number of output times of an interval for bounds of stresses, fraction of the largest motion above
# which motions are principal, round-off of bounds, and a negligible stress in Pa.
_INTERVAL, _REST, _ROUND_OFF, _TINY = 24, 1.0e-6, 1.0e-3, 1.0e-30

# Minimum number of output times at which stresses outside bands are evaluated.
INSTANTS = 400


class Largest(NamedTuple):
    """Largest von Mises stress in Pa, with the indices of its output time and triangle."""

    von_mises: float
    step: int
    triangle: int


def stress_near_places(
    shell: ShellStress, places: Sequence[float], names: Sequence[str]
) -> xr.Dataset:
    """Return the largest stresses of each segment in a band around each place, over time.

    Args:
        places: x in m.

    Returns:
        ``von_mises`` (time, segment, place) in Pa, the maximum over triangles and faces, and
        ``von_mises_patch``, the maximum over patches; NaN where a segment is absent.
    """
    import xarray as xr

    shape = (shell.time.size, len(names), len(places))
    largest, patched = (np.full(shape, np.nan, dtype=np.float32) for _ in range(2))
    for number in range(len(names)):
        for i, x in enumerate(places):
            band = shell.near(number, x, BAND)
            if band.size == 0:
                continue
            largest[:, number, i], _ = _peaks(shell, band)
            patches = _patches(shell, band)
            for part, stress in shell.over_time(band, means=patches):
                patched[part, number, i] = stress.largest().max(axis=1)
    dims = ("time", "segment", "place")
    return xr.Dataset(
        {
            "von_mises": (
                dims,
                largest,
                {"units": "Pa", "long_name": "largest von Mises stress near the place"},
            ),
            "von_mises_patch": (
                dims,
                patched,
                {"units": "Pa", "long_name": "largest mean of it over a patch"},
            ),
        },
        coords={
            "time": ("time", shell.time, {"units": "s"}),
            "segment": list(names),
            "place": ("place", np.array(places, dtype=float), {"units": "m"}),
        },
        attrs={"band": BAND},
    )


def summarise(shell: ShellStress, history: xr.Dataset) -> StressSummary:
    """Return the largest stresses of a triangle and of a patch in a run."""
    names = [str(name) for name in history["segment"].values]
    places = [float(x) for x in history["place"].values]
    worst = _largest(shell, history)
    number = int(shell.segment[worst.triangle])
    time = float(shell.time[worst.step])
    stress = shell.at(time)
    face = max(_FACES, key=lambda f: float(stress.von_mises(f)[worst.triangle]))
    x, y, z = (float(c) for c in shell.centroids[worst.triangle])
    patch = None
    patched = history["von_mises_patch"].values
    if np.isfinite(patched).any():
        step, segment, place = np.unravel_index(np.nanargmax(patched), patched.shape)
        patch = LargestPatch(
            float(patched[step, segment, place]),
            float(shell.time[step]),
            names[segment],
            places[place],
        )
    return StressSummary(
        von_mises=worst.von_mises,
        time=time,
        segment=names[number],
        wall=shell.wall_name(worst.triangle),
        face=face,
        x=x,
        y=y,
        z=z,
        band=BAND,
        patch=patch,
    )


def _largest(shell: ShellStress, history: xr.Dataset) -> Largest:
    """Return the largest stress in bands at all output times, and elsewhere at some of them."""
    bands = history["von_mises"].values
    stride = max(1, shell.time.size // INSTANTS)
    segments = np.unique(shell.segment)
    stresses = [
        _search(shell, np.flatnonzero(shell.segment == number), 0, stride) for number in segments
    ]
    if np.isfinite(bands).any():
        step, number, place = np.unravel_index(np.nanargmax(bands), bands.shape)
        band = shell.near(int(number), float(history["place"].values[place]), BAND)
        stresses.append(_search(shell, band, int(step), shell.time.size))
    return max(stresses)


def _search(shell: ShellStress, triangles: Indices, first: int, stride: int) -> Largest:
    """Return the largest stress of triangles at output times ``first``, ``first + stride``, …"""
    values, at = _peaks(shell, triangles, slice(first, None, stride))
    step = int(values.argmax())
    return Largest(float(values[step]), first + stride * step, int(at[step]))


def _peaks(
    shell: ShellStress, triangles: Indices, steps: slice = slice(None)
) -> tuple[Modes, Indices]:
    """Return the largest stress (num_steps,) in Pa at each step, and the triangle in which it is.

    All triangles belong to one segment. To save time, an upper bound of the stress in an interval
    of time is computed first. It is the sum of the von Mises stresses of three parts: axial forces,
    the principal motions of the segment, and the rest of its motion. A triangle is left out if
    other triangles exceed its bound at every step of each interval.
    """
    number = int(shell.segment[triangles[0]])
    modes = shell.modes[number].take(triangles - np.searchsorted(shell.segment, number), axis=1)
    # A unit of a coordinate causes no von Mises stress above the weight of the coordinate. The
    # factor 6 is 2 for the sum of membrane and bending stress, times 3 for the von Mises stress.
    weights = np.sqrt(6.0 * np.einsum("mtc,mtc->m", modes, modes, dtype=float)) + _TINY
    states = shell.states[number][steps] * weights
    # Principal motions need not be accurate, since the bound includes the rest of the motion.
    squares, directions = np.linalg.eigh(states.T @ states)
    motions = directions[:, squares > _REST**2 * squares[-1]].T
    parts = states @ motions.T
    rest = np.abs(states - parts @ motions).sum(axis=1, keepdims=True)
    principal = np.tensordot((motions / weights).astype(np.float32), modes, axes=1)
    axial = shell.axial[triangles, None] * np.eye(1, modes.shape[2], dtype=np.float32)
    stress = Stress(*np.split(np.concatenate([axial[None], principal]), 2, axis=2))
    norms = np.stack([stress.von_mises(face) for face in _FACES], axis=1)
    begins = np.arange(0, len(states), _INTERVAL)
    highest = np.maximum.reduceat(np.abs(np.hstack([rest, parts])), begins)
    bounds = norms[0] + np.tensordot(highest[:, 1:], norms[1:], axes=1)
    bounds = highest[:, :1] + bounds.max(axis=1)
    stressed = shell.largest(triangles[np.unique(bounds.argmax(axis=1))], steps).max(axis=1)
    least = np.minimum.reduceat(stressed, begins)[:, None]
    kept = triangles[(bounds >= (1.0 - _ROUND_OFF) * least).any(axis=0)]
    largest = shell.largest(kept, steps)
    return largest.max(axis=1), kept[largest.argmax(axis=1)]


def _patches(shell: ShellStress, band: Indices) -> Array:
    """Return weights by area (num_patches, num_triangles) of the patches in a band."""
    wall, places = shell.wall[band], shell.centroids[band, 1:]
    # A level wall is divided at its middle, a steep wall or a diaphragm at half its height.
    flat = np.abs(shell.outward[band, 2]) > np.sqrt(0.5)
    along = np.where(flat, *places.T)
    lowest, highest = (np.full(wall.max() + 1, end) for end in (np.inf, -np.inf))
    np.minimum.at(lowest, wall, along)
    np.maximum.at(highest, wall, along)
    patch = 2 * wall + (along > 0.5 * (lowest + highest)[wall])
    weights = np.equal.outer(np.unique(patch), patch) * shell.areas[band]
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))
