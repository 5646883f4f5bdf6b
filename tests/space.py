# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments with the lateral numbers of their boxes."""

from dataclasses import replace

from geometry.boom import Segment


def in_space(segment: Segment) -> Segment:
    """Return a segment that bends along y and twists as its plates do, without load along y."""
    same = Segment.of_section("", 0.0, 1.0, segment.material, segment.section)
    return replace(segment, lateral=same.lateral)
