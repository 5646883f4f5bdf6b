# SPDX-License-Identifier: LGPL-3.0-or-later
"""Whether motions of a case can be compared from moment to moment."""

from __future__ import annotations

from runs.case.schema import Case


def regular(case: Case) -> bool:
    """Whether dry friction keeps motions comparable from moment to moment.

    It does under forces that are given, at each station; what contacts press does not.
    """
    return all(
        joint.tied or (joint.friction > 0.0 and min(joint.normal_forces, default=0.0) > 0.0)
        for joint in case.joints
    )
