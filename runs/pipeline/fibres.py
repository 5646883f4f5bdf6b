# SPDX-License-Identifier: LGPL-3.0-or-later
"""The stress along x in the outer fibres of a segment, of its section forces.

σ = N/A + M z/J + M_y y/J_y, as beams have it (Navier 1826); of a shell with the integrals of its
walls' stresses, so that both are the nominal stress of the same section.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from dynamics.line import Line, Quantity
from geometry.arrays import Array
from geometry.boom import Segment
from geometry.section import Section


@dataclass(frozen=True, slots=True)
class Fibres:
    """The outer fibres of a segment.

    Args:
        x: (num_places,) in m.
        y, z: (num_fibres, num_places) in m.
        of_moment, of_lateral: (num_fibres, num_places) the stress of a moment of 1 N·m, along z and
            along y, in Pa.
        of_normal: (num_places,) of a normal force of 1 N, in Pa.
    """

    x: Array
    y: Array
    z: Array
    of_moment: Array
    of_lateral: Array
    of_normal: Array

    @classmethod
    def of(cls, segment: Segment, line: Line) -> Fibres | None:
        """None where the section is not known or the segment does not bend."""
        if segment.section is None or "moment" not in line.rows:
            return None
        spatial = "lateral_moment" in line.rows
        there = [segment.local(x) for x in line.x.tolist()]
        y, z = _corners(segment, line.x, spatial)
        of_moment = z / _each(there, "second_moment_of_area")
        of_lateral = y / _each(there, "lateral.second_moment_of_area") if spatial else y
        return cls(line.x, y, z, of_moment, of_lateral, 1.0 / _each(there, "section.area"))

    def stress(self, fibre: int, curves: Mapping[Quantity, Array]) -> Array:
        """(..., num_places) in Pa of section forces (..., num_places)."""
        stress = self.of_moment[fibre] * curves["moment"] + self.of_normal * curves["normal"]
        if "lateral_moment" in curves:
            stress += self.of_lateral[fibre] * curves["lateral_moment"]
        return np.asarray(stress)


def _each(segments: Sequence[Segment], number: str) -> Array:
    return np.array([attrgetter(number)(segment) for segment in segments])


def _corners(segment: Segment, x: Array, spatial: bool) -> tuple[Array, Array]:
    """(num_fibres, num_places) y and z in m; of a flat boom those that differ in z, at y = 0."""
    different = x.tolist() if segment.head_section is not None else [float(x[0])]
    corners = np.array([outer_corners(segment.section_at(place)) for place in different])
    found = np.broadcast_to(corners, (x.size, *corners.shape[1:]))
    y, z = np.moveaxis(found, 0, -1)
    if spatial:
        return y, z
    _, heights = np.unique(z[:, 0], return_index=True)
    return np.zeros_like(z[heights]), z[heights]


def outer_corners(section: Section) -> tuple[Array, Array]:
    """y and z (num_corners,) in m of the corners of the plates' outer surfaces, from the centroid.

    Of plates that meet, those of the surface whose normal is nearer to the direction count.
    """
    places, beyond = [], []
    for before, after in zip(
        section.plates[-1:] + section.plates[:-1], section.plates, strict=True
    ):
        # A normal has the components of the tangent, exchanged.
        normals = [0.5 * plate.thickness * np.abs(plate.tangent[::-1]) for plate in (before, after)]
        places.append(after.start)
        beyond.append(np.maximum(*normals))
    y, z = (np.array(places) + np.sign(places) * np.array(beyond)).T
    return y, z
