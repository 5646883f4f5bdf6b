# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static states of the shipped crane, arm and lift, compared with calculations by hand."""

from dataclasses import replace
from math import isclose

import numpy as np
import pytest

from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.statics import Elements, StaticState, static_state
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Joint, Segment
from protractile.geometry.load import PartialLoad
from protractile.runs import CASES
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.statics import cylinder_force, reaction_rows
from tests.runs.case_texts import shipped

GRAVITY = 9.80665


# Pieces of a segment, at whose middles its weight and its bending count.
PIECES = 2000


def middles(segment: Segment) -> Array:
    return segment.start + segment.length * (np.arange(PIECES) + 0.5) / PIECES


def beyond(pushed: Array, x: Array) -> tuple[Array, Array]:
    """Return moment and shear force at x of forces (num_forces, 3): place, force up, moment."""
    at, force, moment = pushed.T
    far = at > x[:, None]
    return (far * (force * (at - x[:, None]) + moment)).sum(axis=1), (far * force).sum(axis=1)


def midpoints(joint: Joint) -> tuple[float, float]:
    """Return x in m of the midpoints of pads at both ends of the overlap, or of the stations."""
    (first, last), half = joint.stations, 0.5 * joint.pad.length if joint.pad else 0.0
    return first + half, last - half


def by_hand(boom: Boom, weight: float, tip: float) -> tuple[list[Array], list[float]]:
    """Apply the lever rule from the tip to the base; return forces on segments and of cylinders.

    Args:
        boom: level boom; each segment has two supports or stations, or a clamp.
        weight: weight in m/s², downwards.
        tip: upward force at the tip in N.
    """
    pushed = []
    for one in boom.segments:
        piece = -weight * one.mass_per_length * one.length / PIECES
        points = [(mass.x, -weight * mass.mass, 0.0) for mass in one.all_masses]
        pushed.append(np.array([*((x, piece, 0.0) for x in middles(one)), *points]))
    pushed[-1] = np.vstack([pushed[-1], (boom.tip, tip, 0.0)])
    for joint in reversed(boom.joints):
        inner, (first, last) = pushed[joint.inner], midpoints(joint)
        head = -(inner[:, 1] @ (inner[:, 0] - first)) / (last - first)
        tail = -inner[:, 1].sum() - head
        pressed = np.array([(first, tail, 0.0), (last, head, 0.0)])
        pushed[joint.inner] = np.vstack([inner, pressed])
        pushed[joint.outer] = np.vstack([pushed[joint.outer], pressed * (1.0, -1.0, 1.0)])
    presses = []
    for jack in boom.cylinders:
        base, (along, up) = pushed[jack.segment], jack.direction
        press = -(base[:, 1] @ base[:, 0]) / (up * jack.x + along * jack.depth)
        lug = jack.x, up * press, along * jack.depth * press
        pushed[jack.segment] = np.vstack([base, lug])
        presses.append(press)
    return pushed, presses


def tip_by_hand(boom: Boom, stiffness: list[float]) -> float:
    """Return the tip deflection in m under the weights by the unit-load method."""
    (real, presses), (unit, ones) = by_hand(boom, GRAVITY, 0.0), by_hand(boom, 0.0, 1.0)
    found = 0.0
    for segment, own, virtual in zip(boom.segments, real, unit, strict=True):
        shear = segment.material.shear_modulus * segment.section.shear_area
        x = middles(segment)
        (moment, force), (of_one, with_one) = beyond(own, x), beyond(virtual, x)
        bent = moment @ of_one / segment.bending_stiffness + force @ with_one / shear
        found += bent * segment.length / PIECES
    for joint, k in zip(boom.joints, stiffness, strict=True):
        for x in midpoints(joint):
            force, with_one = (force_at(one[joint.inner], x) for one in (real, unit))
            # The inner segment gives way against what pushes it, by the clearance and by F/k.
            found += with_one * (np.sign(force) * 0.5 * joint.play + force / k)
    for jack, press, one in zip(boom.cylinders, presses, ones, strict=True):
        found += press * one / jack.stiffness
    return found


def force_at(pushed: Array, x: float) -> float:
    """Return the last force at x in N, that of a pad."""
    return float(pushed[np.isclose(pushed[:, 0], x)][-1, 1])


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
    # The lead of a rope points to its winch at the foot.
    tip = float(modes.displacement(len(boom.segments) - 1, boom.tip, "z") @ rest.position)
    return found - sum(lead.force for lead in boom.leads) * tip


AXIAL = "axial_reaction"


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
    at_pin, at_lug = (
        {row.quantity: row.value for row in reaction_rows(rest) if row.place == place}
        for place in (f"at {foot.x:g} m", f"lug at {jack.x:g} m")
    )
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
    for wind in (load for load in boom.loads if isinstance(load, PartialLoad)):
        turning -= wind.resultant(0.0) * (0.5 * sum(wind.span) - foot.x)
    along = sum(mass for mass, _ in masses) * GRAVITY * np.sin(angle)
    along += sum(axial.force for axial in (*case.axial, *boom.leads))
    turning -= along * foot.depth + second_order(boom, rest)
    force = cylinder_force(rest, 1)
    assert force * jack.arm(foot) == pytest.approx(turning, rel=1e-3)
    assert at_pin[AXIAL] + at_lug[AXIAL] == pytest.approx(along, rel=1e-9)
    assert at_pin.get("support_moment", 0.0) == pytest.approx(
        at_pin[AXIAL] * foot.depth, rel=1e-6, abs=1.0
    )
    assert at_lug["support_moment"] == pytest.approx(at_lug[AXIAL] * jack.depth, rel=1e-6)
    assert at_lug[AXIAL] == pytest.approx(force * jack.direction[0], rel=1e-9)


@pytest.mark.parametrize("name", ["crane", "inspection-arm", "lift"])
def test_booms_have_the_deflections_of_statics_by_hand(name: str) -> None:
    """Reference: analytic, lever rule and unit loads, with play's rotations, within 0.1 %."""
    case = level(name)
    boom = build_boom(case)
    rest, stiffness = rest_of(case, boom)
    pushed, _ = by_hand(boom, GRAVITY, 0.0)
    contacts = {(joint.inner, x) for joint in boom.joints for x in midpoints(joint)}
    for reaction in rest.reactions:
        if reaction[:2] in contacts:
            expected = force_at(pushed[reaction.segment], reaction.x)
            assert reaction.force == pytest.approx(expected, rel=1e-3)
    pads = [x for joint in boom.joints for x in midpoints(joint)]
    ground = sum(
        one.force
        for one in rest.reactions
        if one.segment == 0 and not any(isclose(one.x, x) for x in pads)
    )
    assert ground == pytest.approx(GRAVITY * sum(s.mass for s in boom.segments), rel=1e-3)
    assert rest.tip == pytest.approx(tip_by_hand(boom, stiffness), rel=1e-3)
