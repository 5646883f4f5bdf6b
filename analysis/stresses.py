# SPDX-License-Identifier: LGPL-3.0-or-later
"""Nominal stresses of outer fibres.

σ = N/A + M_y z/J + M_z y/J_z (Navier 1826). Section forces of a shell are integrals of its wall
stresses, so that beams and shells give the same nominal stress.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from operator import attrgetter

import numpy as np

from protractile.dynamics.line import Line, LineQuantity
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Segment
from protractile.geometry.section import Section


@dataclass(frozen=True, slots=True)
class Fibres:
    """Outer fibres of a segment, and their stresses under unit section forces."""

    x: Array  #: positions along the boom (num_places,) in m
    y: Array  #: lateral positions (num_fibres, num_places) in m
    z: Array  #: vertical positions (num_fibres, num_places) in m
    of_moment: Array  #: stress (num_fibres, num_places) in Pa for a vertical moment of 1 N·m
    of_lateral: Array  #: stress (num_fibres, num_places) in Pa for a lateral moment of 1 N·m
    of_normal: Array  #: stress (num_places,) in Pa for a normal force of 1 N
    strengths: Array  #: least yield strength (num_fibres,) in Pa of its plates; NaN if unknown

    @classmethod
    def of(cls, segment: Segment, line: Line) -> Fibres | None:
        """Return the fibres; None if the section is unknown or the line has no bending moment."""
        if segment.section is None or "moment" not in line.rows:
            return None
        spatial = "lateral_moment" in line.rows
        there = [segment.prismatic_at(x) for x in line.x.tolist()]
        y, z, strengths = _corners(segment, line.x, spatial)
        of_moment = z / _each(there, "second_moment_of_area")
        of_lateral = y / _each(there, "lateral.second_moment_of_area") if spatial else y
        of_normal = 1.0 / _each(there, "section.area")
        return cls(line.x, y, z, of_moment, of_lateral, of_normal, strengths)

    def stress(self, fibre: int, curves: Mapping[LineQuantity, Array]) -> Array:
        """Return the stress (..., num_places) in Pa of a fibre under section forces."""
        stress = self.of_moment[fibre] * curves["moment"] + self.of_normal * curves["normal"]
        if "lateral_moment" in curves:
            stress += self.of_lateral[fibre] * curves["lateral_moment"]
        return np.asarray(stress)


def _each(segments: Sequence[Segment], number: str) -> Array:
    return np.array([attrgetter(number)(segment) for segment in segments])


def _corners(segment: Segment, x: Array, spatial: bool) -> tuple[Array, Array, Array]:
    """Return y and z (num_fibres, num_places) in m of outer corners, and strengths of plates there.

    For a planar boom y is 0, and corners with the same z count once.
    """
    different = x.tolist() if segment.head_section is not None else [float(x[0])]
    corners = np.array([outer_corners(segment.section_at(place)) for place in different])
    points = np.broadcast_to(corners, (x.size, *corners.shape[1:]))
    y, z = np.moveaxis(points, 0, -1)
    plates = [segment.section_at(end).plates for end in segment.ends]
    known = np.array([[segment.strength(plate) or np.nan for plate in each] for each in plates])
    strengths = np.fmin.reduce([*known, *np.roll(known, 1, axis=1)])
    if spatial:
        return y, z, strengths
    _, heights, groups = np.unique(z[:, 0], return_index=True, return_inverse=True)
    least = [np.fmin.reduce(strengths[groups == k]) for k in range(heights.size)]
    return np.zeros_like(z[heights]), z[heights], np.array(least)


# Load cases and combinations have the same sections.
@lru_cache(maxsize=256)
def outer_corners(section: Section) -> tuple[Array, Array]:
    """Return y and z (num_corners,) in m of the outer corners of the plates, from the centroid.

    Along y and z, a corner lies half a thickness outside the intersection of two mid-lines. The
    thickness is that of the plate with the larger component of its normal in this direction.
    """
    places, beyond = [], []
    for before, after in zip(
        section.plates[-1:] + section.plates[:-1], section.plates, strict=True
    ):
        # The normal has the components of the tangent, exchanged.
        normals = [0.5 * plate.thickness * np.abs(plate.tangent[::-1]) for plate in (before, after)]
        places.append(after.start)
        beyond.append(np.maximum(*normals))
    y, z = (np.array(places) + np.sign(places) * np.array(beyond)).T
    return y, z
