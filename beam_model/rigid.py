# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments as rigid bodies with mass and inertia; only supports and contacts are elastic."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from beam_model.component import Component, Motion, SegmentModel
from beam_model.kantorovich import kantorovich_bending, kantorovich_twist
from geometry.boom import Segment


def rigid_segment(segment: Segment) -> SegmentModel:
    """Return a segment that moves, and in space rotates about its axis, without deformation.

    Its motions are the linear functions that rigid supports admit, possibly none. Springs of
    elastic supports and point masses act on them.
    """
    components: dict[Motion, Component] = {"z": _moving(segment)}
    if segment.lateral is not None:
        components["y"] = _moving(segment.turned())
        turns = segment.rigid_twists
        components["twist"] = kantorovich_twist(segment, turns) if turns else _held()
    return SegmentModel(components)


def freedom(segment: Segment) -> int:
    """Return the number of motions along z that rigid supports leave free in a rigid segment."""
    held = sum((s.stiffness is None) + (s.kind == "clamped") for s in segment.supports)
    return max(0, 2 - held)


def _moving(segment: Segment) -> Component:
    motions = freedom(segment)
    if motions == 0:
        return _held()
    straight = kantorovich_bending(segment, motions, "complete", rotary_inertia=True)
    return replace(straight, curvature=None)


def _held() -> Component:
    none, empty = np.zeros(0), np.zeros((0, 0))
    return Component(
        empty, empty, empty, none, none, lambda x: none, 0, lambda x: none, turning=none
    )
