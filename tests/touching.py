# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms with contact laws, in space, and on a lowered pin with statics by hand."""

from collections.abc import Sequence
from dataclasses import replace
from math import cos, hypot, radians, sin
from typing import Any

import pytest

from protractile.dynamics.contact import ContactLaw, Gap
from protractile.dynamics.excitation import Step
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import (
    Boom,
    Cylinder,
    Direction,
    Load,
    Material,
    PointMass,
    Segment,
    Support,
)
from protractile.geometry.box import BoxSection
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


def in_space(segment: Segment) -> Segment:
    """Return a segment with the lateral bending and torsion of its plates, without load along y."""
    same = Segment.of_section("", 0.0, 1.0, segment.material, segment.section)
    return replace(segment, lateral=same.lateral)


GRAVITY = 9.80665
LENGTH, DEPTH = 10.0, 0.35
BOX = BoxSection(height=0.6, width=0.4, flange=0.03, web=0.03)
# 80 kg/m, and ten times as stiff as steel: deflections change moments by less than 0.03 %.
LIGHT = Material(youngs_modulus=2.1e12, poissons_ratio=0.3, density=80.0 / 0.06)
CYLINDER = Cylinder(0, x=2.6, depth=0.3, ground=(0.9, -1.3), stiffness=1.0e9)
# Of the line from (0.9, −1.3) to (2.6, −0.3) m, about (0, −0.35) m.
ARM = (2.6 * 1.0 - 0.05 * 1.7) / hypot(1.7, 1.0)


def raised() -> tuple[Boom, float]:
    """Return a boom at 50° under 80 kg/m, 400 kg at the tip and 3 kN at 8 m, and its cylinder force
    in N.

    The weights compress the boom 0.35 m above the pin, which reduces the cylinder force.
    """
    across, along = GRAVITY * cos(radians(50.0)), GRAVITY * sin(radians(50.0))
    segment = _segment(load=-80.0 * across, masses=(PointMass(LENGTH, 400.0),))
    loads = (
        Load(0, "z", -400.0 * across, LENGTH, Step()),
        Load(0, "z", -3.0e3, 8.0, Step()),
    )
    moment = (800.0 * 5.0 + 400.0 * 10.0) * across + 3.0e3 * 8.0
    force = (moment - 1200.0 * along * DEPTH) / ARM
    assert force == pytest.approx(55.89e3, rel=1e-4)
    return _boom(*with_compression([segment], [], [], along), *loads), force


def level() -> tuple[Boom, float]:
    """Return a level boom under 10 kN at the tip, 50 kN along, and its cylinder force in N."""
    pressed = with_compression([_segment()], [], [Thrust(0, LENGTH, 50.0e3)])
    force = (10.0e3 * LENGTH - 50.0e3 * DEPTH) / ARM
    assert force == pytest.approx(64.7e3, rel=1e-4)
    return _boom(*pressed, Load(0, "z", -10.0e3, LENGTH, Step())), force


def _segment(load: float = 0.0, masses: tuple[PointMass, ...] = ()) -> Segment:
    pin = Support(0.0, "hinged", depth=DEPTH)
    return Segment.of_section(
        "boom", 0.0, LENGTH, LIGHT, BOX, load=load, masses=masses, supports=(pin,)
    )


def _boom(segment: Segment, *loads: Load) -> Boom:
    return Boom((segment,), (), loads, cylinders=(CYLINDER,))
