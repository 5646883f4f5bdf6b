# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments with the lateral properties of their boxes."""

from dataclasses import replace

from protractile.geometry.boom import Segment


def in_space(segment: Segment) -> Segment:
    """Return a segment with the lateral bending and torsion of its plates, without load along y."""
    same = Segment.of_section("", 0.0, 1.0, segment.material, segment.section)
    return replace(segment, lateral=same.lateral)
