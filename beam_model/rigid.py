# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments as rigid bodies with mass and inertia, on elastic supports and contacts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from beam_model.component import Component, Motion, SegmentModel
from beam_model.kantorovich import kantorovich_bending, kantorovich_twist
from geometry.boom import Segment


def rigid_segment(segment: Segment) -> SegmentModel:
    """Return the model of a segment that moves without deformation.

    It has the rigid motions that rigid supports admit, possibly none, with the stiffness of elastic
    supports and the inertia of point masses.
    """
    components: dict[Motion, Component] = {"z": _rigid_motion(segment)}
    if segment.lateral is not None:
        components["y"] = _rigid_motion(segment.turned())
        turns = segment.rigid_twists
        components["twist"] = kantorovich_twist(segment, turns) if turns else _no_motion()
    return SegmentModel(components)


def count_rigid_motions(segment: Segment) -> int:
    """Return the number of rigid motions along z that rigid supports admit."""
    held = sum((s.stiffness is None) + (s.kind == "clamped") for s in segment.supports)
    return max(0, 2 - held)


def _rigid_motion(segment: Segment) -> Component:
    motions = count_rigid_motions(segment)
    if motions == 0:
        return _no_motion()
    straight = kantorovich_bending(segment, motions, "complete", rotary_inertia=True)
    return replace(straight, curvature=None)


def _no_motion() -> Component:
    none, empty = np.zeros(0), np.zeros((0, 0))
    return Component(
        empty, empty, empty, none, none, lambda x: none, 0, lambda x: none, rotation_load=none
    )
