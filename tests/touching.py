# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms with contact laws in their joints."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from protractile.dynamics.contact import ContactLaw, Gap
from protractile.geometry.boom import Boom, Direction
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case, Model

Laws = ContactLaw | Sequence[ContactLaw]


def touching(boom: Boom, laws: Laws, lateral_laws: Laws = ()) -> Boom:
    """Return the boom with a law in all joints, or one in each; a gap's law also has play."""
    changes: list[dict[str, Any]] = [{} for _ in boom.joints]
    for prefix, given in (("", laws), ("lateral_", lateral_laws if boom.spatial else ())):
        each = [given] * len(boom.joints) if isinstance(given, ContactLaw) else given
        for change, law in zip(changes, each, strict=False):
            change[f"{prefix}contact"] = law.law if isinstance(law, Gap) else law
            if isinstance(law, Gap):
                change[f"{prefix}play"] = law.above + law.below
    joints = (replace(one, **change) for one, change in zip(boom.joints, changes, strict=True))
    return replace(boom, joints=tuple(joints))


def contact_laws(case: Case, model: Model, direction: Direction = "z") -> list[Gap]:
    """Return the law of each joint of a case in a model."""
    return [joint.law(direction) for joint in model.model_boom(build_boom(case)).boom.joints]
