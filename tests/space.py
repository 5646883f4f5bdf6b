# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments with the lateral numbers of their boxes."""

from dataclasses import replace

from geometry.boom import Lateral, Segment


def in_space(segment: Segment) -> Segment:
    """Return a segment that bends along y and twists as its plates do, without load along y."""
    box, density = segment.section, segment.material.density
    lateral = Lateral(
        second_moment_of_area=box.lateral_second_moment_of_area,
        rotary_inertia=density * box.lateral_second_moment_of_area,
        torsion_constant=box.torsion_constant,
        polar_inertia=density * box.polar_second_moment_of_area,
    )
    return replace(segment, lateral=lateral)
