# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms of several segments, in a plane and in space: rows, pads, friction, bonded booms."""

from dataclasses import replace

import numpy as np
import pytest

import protractile as pt
from protractile.beam_model.component import SegmentModel
from protractile.beam_model.finite_element import finite_element_segment, finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segment
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Support
from protractile.geometry.load import Load
from protractile.geometry.observation import Observation
from studies.reference_models.statics import static_response
from tests.beam_model.exact import (
    STEEL,
    beam,
    beam_elements,
    beam_series,
    bonded_frequencies,
    frequencies,
)
from tests.touching import in_space, touching

LAW = PowerContact(stiffness=1.0e9, exponent=1.0).with_clearance(7.0e-3)
LATERAL_LAW = PowerContact(stiffness=3.0e8, exponent=1.0).with_clearance(5.0e-3)


def rest(system: GapSystem) -> dict[str, float]:
    """Observed deflections at rest under the load in m."""
    position = static_response(system, system.load)
    return {name: float(seen.row @ position) for name, seen in system.observers.items()}


def test_bonded_boom_has_the_exact_frequencies(paper_boom: Boom) -> None:
    """Reference: analytic, the determinant of the coupled spans. Order 4 in element length."""
    exact = bonded_frequencies(paper_boom, 110.0)
    assert exact.size == 5
    errors = [
        gap_system(paper_boom.bonded, beam_elements(paper_boom, length)).frequencies[:5] / exact
        - 1.0
        for length in (1.0, 0.5, 0.25)
    ]
    assert np.abs(errors[-1]).max() < 2e-6
    assert np.abs(errors[-2]).max() < 1e-4
    np.testing.assert_allclose(np.log2(errors[1][2:] / errors[2][2:]), 4.0, atol=0.1)


def test_bonded_series_converges_to_the_bonded_elements(paper_boom: Boom) -> None:
    """Reference: other code, Hermite elements, with twelve terms a segment."""
    beams = gap_system(paper_boom.bonded, beam_elements(paper_boom, 0.25))
    found = gap_system(paper_boom.bonded, beam_series(paper_boom, (12, 12), "complete"))
    np.testing.assert_allclose(found.frequencies[:4], beams.frequencies[:4], rtol=8e-4)
    assert rest(found) == pytest.approx(rest(beams), rel=7e-4, abs=0.0)


def test_a_boom_of_three_has_the_rows_of_each_joint(paper_boom: Boom) -> None:
    """Reference: by construction. Bonded segments deflect alike at the stations of their joint."""
    (outer, middle), (joint,) = paper_boom.segments, paper_boom.joints
    last = replace(middle, name="last", start=17.5, end=27.0, section=None)
    second = replace(joint, outer=1, inner=2, stations=(17.5, 19.0))
    boom = Boom((outer, middle, last), (joint, second))
    system = gap_system(touching(boom, [LAW, LATERAL_LAW]), beam_elements(boom, 0.5))
    assert list(system.laws) == [LAW, LAW, LATERAL_LAW, LATERAL_LAW]
    assert list(system.stations) == [9.0, 10.0, 17.5, 19.0]
    seen = [(k, x) for one in boom.joints for x in one.stations for k in (one.outer, one.inner)]
    bonded = replace(boom, observations=[Observation(f"{k} {x}", k, x) for k, x in seen]).bonded
    deflections = rest(gap_system(bonded, beam_elements(boom, 0.5)))
    found = [deflections[f"{k} {x}"] for k, x in seen]
    assert found[1::2] == pytest.approx(found[::2], rel=1e-6)
    assert found[::2] == sorted(found[::2])


def test_bonded_halves_have_the_frequencies_of_the_whole(paper_boom: Boom) -> None:
    """Reference: analytic. Equal motions of two halves, bonded at the stations, are the whole's."""
    (outer, inner), (joint,) = paper_boom.segments, paper_boom.joints
    half = replace(
        inner,
        section=None,
        mass_per_length=0.5 * inner.mass_per_length,
        second_moment_of_area=0.5 * inner.second_moment_of_area,
        load=0.5 * inner.load,
    )
    bond = replace(joint, outer=1, inner=2, bonded=True)
    boom = Boom((outer, half, replace(half, name="leaf")), (joint, bond))
    models = finite_element_segments(boom, 1.0, "euler-bernoulli", False)
    whole = gap_system(touching(paper_boom, LAW), beam_elements(paper_boom, 1.0))
    halves = gap_system(touching(boom, LAW), models)
    assert (list(halves.stations), len(halves.laws)) == ([9.0, 10.0], 2)
    bonded = gap_system(paper_boom.bonded, beam_elements(paper_boom, 1.0))
    # A bonded model of three ties the play away as well.
    for found, expected in ((halves, whole), (gap_system(boom.bonded, models), bonded)):
        for frequency in expected.frequencies:
            assert np.abs(found.frequencies - frequency).min() <= 1e-8 * frequency


SOFT = pt.Material(1.0e9, 0.3, 500.0)
FORCE, LENGTH, OVERLAP = 1000.0, 10.0, 1.5


@pytest.mark.parametrize("bonded", [True, False])
@pytest.mark.parametrize("past", [1e-4, 2e-3])
def test_a_station_near_the_end_of_a_segment(past: float, bonded: bool) -> None:
    """Reference: analytic, cantilever, moment of the overhang and slope; the stub bends as well.

    Before, the tip was 0.6 % too low with a bonded station 2 mm before the end.
    """
    boxes = pt.BoxSection(0.353, 0.353, 0.0075, 0.0075), pt.BoxSection(0.3, 0.3, 5e-4, 5e-4)
    wall = (pt.Support(0.0, "clamped"),)
    outer = pt.Segment.of_section("outer", 0.0, LENGTH, STEEL, boxes[0], supports=wall)
    start, end = LENGTH - OVERLAP, LENGTH + past
    stub = pt.Segment.of_section("stub", start, end, SOFT, boxes[1])
    law = None if bonded else pt.PowerContact(1.0e13, exponent=1.0)
    joint = pt.Joint("outer", "stub", (start, LENGTH), play=0.0, bonded=bonded, contact=law)
    load = Load(1, "z", -FORCE, end, pt.Step())
    boom = pt.Boom([outer, stub], [joint], [load])
    models = finite_element_segments(boom, 0.5, "euler-bernoulli", rotary_inertia=False)
    system = gap_system(boom, models)
    (held,) = system.excitations
    tip = system.observers["tip"].row @ equilibrium(system, system.load + held.load)
    stiffness, soft = (
        one.material.youngs_modulus * one.second_moment_of_area for one in (outer, stub)
    )
    moment = FORCE * past
    # The chord of the overlap turns by the moment of the overhang, which the stub resists.
    right = FORCE * LENGTH**3 / (3.0 * stiffness) + moment * LENGTH**2 / stiffness
    right += moment * past * OVERLAP / (3.0 * soft)
    assert -tip == pytest.approx(right, rel=1e-4)
    assert (system.omega2 >= 0.0).all()


def beams(boom: Boom) -> list[SegmentModel]:
    return finite_element_segments(boom, 1.0, "euler-bernoulli", True)


@pytest.mark.parametrize(
    ("supports", "numbers"),
    [
        ((Support(3.0),), (0.5, 1.5, 2.5)),
        ((), (1.0, 2.0, 3.0)),
        ((Support(3.0, stiffness=1e6), Support(8.0, "clamped")), (1.0, 2.0, 3.0)),
    ],
    ids=["held and free", "free", "held at both ends"],
)
def test_twisting_frequencies(supports: tuple[Support, ...], numbers: tuple[float, ...]) -> None:
    """Reference: analytic, ω = κ π/L √(G J_t / I), κ = ½, 3/2, …, and (κπh/L)²/24 above."""
    segment = in_space(beam(supports=supports))
    lateral = segment.lateral
    speed = np.sqrt(
        segment.material.shear_modulus * lateral.torsion_constant / lateral.polar_inertia
    )
    expected = np.array(numbers) * np.pi / 5.0 * speed
    series = kantorovich_segment(segment, 14, "complete", False).components["twist"]
    np.testing.assert_allclose(frequencies(series)[:3], expected, rtol=1e-9)
    errors = []
    for count in (20, 40):
        model = finite_element_segment(segment, 5.0 / count, (), "euler-bernoulli", False)
        errors.append(frequencies(model.components["twist"])[:3] / expected - 1.0)
    np.testing.assert_allclose(errors[1], (np.array(numbers) * np.pi / 40.0) ** 2 / 24.0, rtol=0.02)
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 2.0, atol=0.03)


def rigid_motion(system: GapSystem, suffix: str) -> Array:
    """Return the translation (num_modes,) of the inner segment by 1 m."""
    rigid = system.omega2 == 0.0
    names = [name + s for name in ("tip", "tail") for s in ("", "_lateral")]
    rows = np.array([system.observers[name].row[rigid] for name in names])
    motion = np.zeros(system.num_modes)
    # The smallest such motion does not roll.
    motion[rigid] = np.linalg.pinv(rows) @ [n.endswith("_lateral") == bool(suffix) for n in names]
    return motion


def test_pads_resist_roll(spatial_boom: Boom) -> None:
    """Reference: analytic, k b² θ²/8 at each station with half the law at ± b/2; laterally k h²."""
    system = gap_system(touching(spatial_boom, LAW, LATERAL_LAW), beams(spatial_boom))
    inner = spatial_boom.segments[1]
    roll = np.zeros(system.num_modes)
    up, aside = rigid_motion(system, ""), rigid_motion(system, "_lateral")
    # The one rigid motion that neither tip nor tail show: 1/√(I L) of twist in its mode.
    shown = np.abs(up) + np.abs(aside) > 1e-9
    hidden = (system.omega2 == 0.0) & ~shown
    assert hidden.sum() >= 1
    twist = np.flatnonzero(hidden)[-1]
    roll[twist] = np.sqrt(inner.lateral.polar_inertia * inner.length)

    def stored(motion: Array) -> float:
        gaps = system.rows @ motion
        return float(sum(law.energy(y) for law, y in zip(system.laws, gaps, strict=True)))

    theta = 2.0e-3
    for pressed, law, arm in (
        (8.0e-3 * up, LAW, inner.section.width),
        (-6.0e-3 * aside, LATERAL_LAW, inner.section.height),
    ):
        more = stored(pressed + theta * roll) - stored(pressed)
        assert more == pytest.approx(2.0 * law.law.stiffness * arm**2 * theta**2 / 8.0, rel=1e-6)
        # As much to the other side.
        assert stored(pressed - theta * roll) - stored(pressed) == pytest.approx(more, rel=1e-6)


def test_friction_rubs_in_the_plane_of_contact(paper_boom: Boom) -> None:
    """Reference: external, (28), and analytic, (10), (11): contact along z rubs along y."""
    (joint,) = paper_boom.joints
    joint = replace(joint, friction=0.2, normal_forces=(4500.0, 5000.0))
    boom = replace(paper_boom, joints=(joint,))
    system = gap_system(touching(boom, LAW), beams(boom))
    np.testing.assert_array_equal(system.friction_rows, system.rows)
    assert system.frictions == [DryFriction(0.2, 0, 4500.0), DryFriction(0.2, 1, 5000.0)]
    # In space the same forces are shared out to the pads.
    space = replace(
        boom,
        segments=tuple(in_space(segment) for segment in boom.segments),
        joints=(replace(joint, lateral_play=0.01),),
    )
    system = gap_system(touching(space, LAW, LATERAL_LAW), beams(space))
    shares = [(at, n) for at, n in enumerate((1125.0, 1250.0) * 2) for _ in "1234"]
    assert [(one.station, one.normal_force) for one in system.frictions] == shares
    up, aside = rigid_motion(system, ""), rigid_motion(system, "_lateral")
    free = replace(joint, normal_forces=(), lateral_play=0.01)
    space = touching(replace(space, joints=(free,)), LAW, LATERAL_LAW)
    system = gap_system(space, beams(space))
    for row, friction in zip(system.friction_rows, system.frictions, strict=True):
        (contact,) = friction.normal_rows
        assert friction.station == system.station_of_row[contact]
        along_z = [1.0, 0.0] if friction.station < 2 else [0.0, 1.0]
        pressed = system.rows[contact]
        assert [pressed @ up, pressed @ aside] == pytest.approx(along_z, abs=1e-9)
        assert [row @ aside, row @ up] == pytest.approx(along_z, abs=1e-9)
