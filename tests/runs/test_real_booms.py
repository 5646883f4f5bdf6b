# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static states of the shipped crane, arm and lift, compared with calculations by hand."""

from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import isclose

import numpy as np
import pytest

from beam_model.boom_modes import BoomModes
from beam_model.statics import Elements, StaticState, static_state
from geometry.boom import Boom, Joint, Segment
from runs import CASES
from runs.case.build import build_boom
from runs.case.schema import Case
from runs.pipeline.statics import cylinder_force, reactions
from tests.runs.case_texts import shipped

GRAVITY = 9.80665


@dataclass
class Pushed:
    """A segment with forces up in N at x and in N/m, and moments in N·m towards a slope."""

    segment: Segment
    along: float
    forces: list[tuple[float, float]] = field(default_factory=list)
    moments: list[tuple[float, float]] = field(default_factory=list)

    def turn(self, x: float) -> float:
        middle = 0.5 * (self.segment.start + self.segment.end)
        pushed = sum(f * (at - x) for at, f in self.forces) + sum(m for _, m in self.moments)
        return pushed + self.along * self.segment.length * (middle - x)

    @property
    def total(self) -> float:
        return self.along * self.segment.length + sum(f for _, f in self.forces)

    def beyond(self, x: float) -> tuple[float, float]:
        """Return the moment and shear force of the part beyond x on the cross-section at x."""
        rest = self.segment.end - x
        far = [(at, f) for at, f in self.forces if at > x]
        moment = sum(f * (at - x) for at, f in far) + sum(m for at, m in self.moments if at > x)
        return moment + 0.5 * self.along * rest**2, self.along * rest + sum(f for _, f in far)


def midpoints(joint: Joint) -> tuple[float, float]:
    """Return x in m of the midpoints of pads at both ends of the overlap, or of the stations."""
    (first, last), half = joint.stations, 0.5 * joint.pad.length if joint.pad else 0.0
    return first + half, last - half


def by_hand(boom: Boom, weight: float, tip: float) -> tuple[list[Pushed], list[float]]:
    """Apply the lever rule from the tip to the base, and return segments and cylinder forces.

    Args:
        boom: level boom; each segment has two supports or stations, or a clamp.
        weight: weight in m/s², downwards.
        tip: upward force at the tip in N.
    """
    pushed = [Pushed(segment, -weight * segment.mass_per_length) for segment in boom.segments]
    for one in pushed:
        one.forces += [(mass.x, -weight * mass.mass) for mass in one.segment.all_masses]
    pushed[-1].forces.append((boom.tip, tip))
    for joint in reversed(boom.joints):
        inner, (first, last) = pushed[joint.inner], midpoints(joint)
        head = -inner.turn(first) / (last - first)
        tail = -inner.total - head
        inner.forces += [(first, tail), (last, head)]
        pushed[joint.outer].forces += [(first, -tail), (last, -head)]
    presses = []
    for jack in boom.cylinders:
        base, (along, up) = pushed[jack.segment], jack.direction
        press = -base.turn(0.0) / (up * jack.x + along * jack.depth)
        base.forces.append((jack.x, up * press))
        base.moments.append((jack.x, along * jack.depth * press))
        presses.append(press)
    return pushed, presses


def tip_by_hand(boom: Boom, stiffness: list[float]) -> float:
    """Return the tip deflection in m under the weights by the unit-load method."""
    (real, presses), (unit, ones) = by_hand(boom, GRAVITY, 0.0), by_hand(boom, 0.0, 1.0)
    points, weights = np.polynomial.legendre.leggauss(3)
    found = 0.0
    for own, virtual in zip(real, unit, strict=True):
        segment = own.segment
        shear = segment.material.shear_modulus * segment.section.shear_area
        places = {segment.start, segment.end, *(x for x, _ in (*own.forces, *own.moments))}
        for a, b in pairwise(sorted(places)):
            for point, part in zip(points, weights, strict=True):
                x = 0.5 * (a + b + point * (b - a))
                (moment, force), (of_one, with_one) = own.beyond(x), virtual.beyond(x)
                bent = moment * of_one / segment.bending_stiffness + force * with_one / shear
                found += 0.5 * (b - a) * part * bent
    for joint, k in zip(boom.joints, stiffness, strict=True):
        inner, virtual = dict(real[joint.inner].forces), dict(unit[joint.inner].forces)
        for x in midpoints(joint):
            # The inner segment gives way against what pushes it, by the clearance and by F/k.
            way = np.sign(inner[x]) * 0.5 * joint.play + inner[x] / k
            found += virtual[x] * way
    for jack, press, one in zip(boom.cylinders, presses, ones, strict=True):
        found += press * one / jack.stiffness
    return found


def level(name: str) -> Case:
    """Return the level case under its weights; only cylinders give axial forces."""
    case = shipped(name)
    gravity = case.gravity.model_copy(update={"angle": 0.0})
    return case.model_copy(update={"gravity": gravity, "axial": (), "loads": ()})


def rest_of(case: Case, boom: Boom) -> tuple[StaticState, list[float]]:
    """Return the static state with rigid walls, and the contact stiffness of each joint along z."""
    model = next(model for model in case.models if not model.bonded)
    found = model.model_boom(boom)
    stiffness = [joint.contact.terms[0].stiffness for joint in found.boom.joints]
    return static_state(found.boom, walls=0.0), stiffness


# Those that ship with the depth of a lug, and may have one of their pin.
LUFFED = [path.stem for path in sorted(CASES.glob("*.toml")) if "depth =" in path.read_text()]


def second_order(boom: Boom, rest: StaticState) -> float:
    """Return ∫ P w′ dx of all segments in N·m, the moment of axial forces about the foot."""
    modes = BoomModes(boom, Elements(boom).segments)
    found = 0.0
    for number, segment in enumerate(boom.segments):
        x = np.linspace(segment.start, segment.end, 401)
        deflections = [modes.displacement(number, each, "z") @ rest.position for each in x.tolist()]
        found += float(segment.compression(0.5 * (x[1:] + x[:-1])) @ np.diff(deflections))
    return found


@pytest.mark.parametrize("lowered", [0.0, 0.3])
@pytest.mark.parametrize("name", LUFFED)
def test_moments_about_the_pin_are_in_balance(name: str, lowered: float) -> None:
    """Reference: analytic, moments of all forces about the pin, within 0.1 %."""
    case = shipped(name)
    base, *others = case.segments
    (pin,) = base.supports
    lower = replace(pin, depth=pin.depth + lowered)
    base = base.model_copy(update={"supports": (lower,)})
    case = case.model_copy(update={"segments": (base, *others)})
    boom = build_boom(case)
    (jack,), foot = boom.cylinders, boom.segments[0].foot
    assert foot.depth == lowered
    rest, _ = rest_of(case, boom)
    at_pin, at_lug = reactions(rest)
    angle = np.radians(case.gravity.angle)
    masses = [
        (mass, x)
        for segment in boom.segments
        for mass, x in (
            (segment.mass_per_length * segment.length, segment.mass_centre),
            *((point.mass, point.x) for point in segment.all_masses),
        )
    ]
    turning = sum(mass * (x - foot.x) for mass, x in masses) * GRAVITY * np.cos(angle)
    # At t = 0 a load that ramps is none yet.
    turning -= sum(load.magnitude for load in case.loads if load.ramp is None) * boom.tip
    along = sum(mass for mass, _ in masses) * GRAVITY * np.sin(angle)
    along += sum(axial.force or 0.0 for axial in case.axial)
    turning -= along * foot.depth + second_order(boom, rest)
    force = cylinder_force(rest, 1)
    assert force * jack.arm(foot) == pytest.approx(turning, rel=1e-3)
    assert at_pin.along + at_lug.along == pytest.approx(along, rel=1e-9)
    assert at_pin.moment == pytest.approx(at_pin.along * foot.depth, rel=1e-6, abs=1.0)
    assert at_lug.moment == pytest.approx(at_lug.along * jack.depth, rel=1e-6)
    assert at_lug.along == pytest.approx(force * jack.direction[0], rel=1e-9)


@pytest.mark.parametrize("name", ["crane", "inspection-arm", "lift"])
def test_booms_have_the_deflections_of_statics_by_hand(name: str) -> None:
    """Reference: analytic, lever rule and unit loads, with play's rotations, within 0.1 %."""
    case = level(name)
    boom = build_boom(case)
    rest, stiffness = rest_of(case, boom)
    pushed, _ = by_hand(boom, GRAVITY, 0.0)
    for reaction in rest.reactions:
        if reaction.segment > 0:
            forces = pushed[reaction.segment].forces
            (expected,) = (force for x, force in forces if isclose(x, reaction.x))
            assert reaction.force == pytest.approx(expected, rel=1e-3)
    pads = [x for joint in boom.joints for x in midpoints(joint)]
    ground = sum(
        one.force
        for one in rest.reactions
        if one.segment == 0 and not any(isclose(one.x, x) for x in pads)
    )
    assert ground == pytest.approx(GRAVITY * sum(s.mass for s in boom.segments), rel=1e-3)
    assert rest.tip == pytest.approx(tip_by_hand(boom, stiffness), rel=1e-3)
