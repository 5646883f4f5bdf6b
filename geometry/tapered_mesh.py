# SPDX-License-Identifier: LGPL-3.0-or-later
"""Meshes of segments that taper: those of a plain segment, moved to the section at each x."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geometry.arrays import Array, Indices
from geometry.plating import PlatedMesh
from geometry.section import Section
from geometry.segment import Segment

# Part of a mesh's extent below which a coordinate is 0, and two are one.
_ROUND_OFF = 1.0e-12


def tapered_mesh(segment: Segment, mesh: PlatedMesh) -> PlatedMesh:
    """Each point where it is in the section of its x, all walls flat from mesh line to mesh line.

    A section is a fan of triangles, from its middle to each plate: a point keeps its place in its
    triangle.

    Args:
        segment: tapers.
        mesh: of the plain segment that has its widest section everywhere.
    """
    number, first, last = _in_fan(segment.widest, mesh.points[:, 1:])
    points = mesh.points.copy()
    near = _ROUND_OFF * float(np.ptp(points[:, 0]))
    places, at = np.unique(np.round(points[:, 0] / near), return_inverse=True)
    for k, x in enumerate((near * places).tolist()):
        (here,) = np.nonzero(at == k)
        starts, middle = _fan(segment.section_at(x))
        ends = np.roll(starts, -1, axis=0)
        arms = (starts - middle)[number[here]], (ends - middle)[number[here]]
        points[here, 1:] = middle + first[here, None] * arms[0] + last[here, None] * arms[1]
    # What is held in a mirror's plane must lie in it to the last bit.
    points[np.abs(points) < near] = 0.0
    return replace(mesh, points=points)


def _fan(section: Section) -> tuple[Array, Array]:
    """(num_plates, 2) where plates begin, and (2,) the middle, in m."""
    return np.array([plate.start for plate in section.plates]), np.mean(section.bounds, axis=0)


def _in_fan(section: Section, places: Array) -> tuple[Indices, Array, Array]:
    """(num_places,) number of each one's triangle, its parts of the arms to the plate's ends."""
    starts, middle = _fan(section)
    arms = np.stack([starts, np.roll(starts, -1, axis=0)], axis=2) - middle[:, None]
    parts = np.einsum("kij,nj->nki", np.linalg.inv(arms), places - middle)
    number = parts.min(axis=2).argmax(axis=1)
    first, last = parts[np.arange(len(places)), number].T
    return number, first, last
