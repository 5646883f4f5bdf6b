# SPDX-License-Identifier: LGPL-3.0-or-later
"""The stress along x in the outer fibres of a segment, of its section forces.

σ = N/A + M z/J + M_y y/J_y, as beams have it (Navier 1826); of a shell with the integrals of its
walls' stresses, so that both are the nominal stress of the same section.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter

import numpy as np

from dynamics.line import Line
from geometry.arrays import Array
from geometry.boom import Segment
from geometry.section import Section
from runs.pipeline.at_rest import normal_force


@dataclass(frozen=True, slots=True)
class Fibres:
    """The outer fibres of a segment.

    Args:
        x: (num_places,) in m.
        y, z: (num_fibres, num_places) in m.
        rows: (num_fibres, num_places, num_modes) that read the stress of bending in Pa.
        axial: (num_places,) what the normal force adds in Pa.
    """

    x: Array
    y: Array
    z: Array
    rows: Array
    axial: Array

    @classmethod
    def of(cls, segment: Segment, line: Line) -> Fibres | None:
        """None where the section is not known or the segment does not bend."""
        if segment.section is None or "moment" not in line.rows:
            return None
        spatial = "lateral_moment" in line.rows
        there = [segment.local(x) for x in line.x.tolist()]
        y, z = _corners(segment, line.x, spatial)
        rows = (z / _each(there, "second_moment_of_area"))[..., None] * line.rows["moment"]
        if spatial:
            share = y / _each(there, "lateral.second_moment_of_area")
            rows += share[..., None] * line.rows["lateral_moment"]
        axial = normal_force(segment.compression, line.x) / _each(there, "section.area")
        return cls(line.x, y, z, rows, axial)

    def stress(self, fibre: int, states: Array) -> Array:
        """(..., num_places) in Pa of modal coordinates (..., num_modes)."""
        return np.asarray(states @ self.rows[fibre].T + self.axial)


def _each(segments: Sequence[Segment], number: str) -> Array:
    return np.array([attrgetter(number)(segment) for segment in segments])


def _corners(segment: Segment, x: Array, spatial: bool) -> tuple[Array, Array]:
    """(num_fibres, num_places) y and z in m; of a flat boom those that differ in z, at y = 0."""
    found = np.array([outer_corners(segment.section_at(place)) for place in x.tolist()])
    y, z = np.moveaxis(found, 0, -1)
    if spatial:
        return y, z
    _, different = np.unique(z[:, 0], return_index=True)
    return np.zeros_like(z[different]), z[different]


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
