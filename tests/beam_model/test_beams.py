# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beams by series and by elements, also tapered: supports, statics, frequencies."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from scipy.integrate import quad, quad_vec

from protractile.beam_model.boom_modes import critical_factor
from protractile.beam_model.component import Component, SegmentModel
from protractile.beam_model.elements import Theory
from protractile.beam_model.finite_element import finite_element_segment, finite_element_segments
from protractile.beam_model.kantorovich import (
    Base,
    kantorovich_bending,
    kantorovich_segments,
    rigid_segment,
)
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.geometry.arrays import Array
from protractile.geometry.axial import with_compression
from protractile.geometry.boom import Boom, BoomError, Diaphragm, PointMass, Segment, Stop, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.load import AngularAcceleration, Load
from protractile.geometry.observation import Observation
from protractile.runs.case.kinds.finite_element import BeamElements
from studies import taper
from studies.reference_models.statics import static_response
from tests.beam_model.exact import (
    CLAMPED_FREE,
    FREE_FREE,
    PINNED_FREE,
    PINNED_PINNED,
    STEEL,
    OverhangingBeam,
    angular_frequencies,
    beam,
    beam_elements,
    frequencies,
    roots,
)
from tests.touching import touching


def outside_of_span(model: Component, function: Array, x: Array) -> float:
    """Return the part of a function, sampled at x, outside the space of the model's functions."""
    functions = np.array([model.at(place) for place in x])
    functions /= np.abs(functions).max(axis=0)
    coefficients, *_ = np.linalg.lstsq(functions, function, rcond=None)
    return float(np.linalg.norm(functions @ coefficients - function) / np.linalg.norm(function))


@pytest.mark.parametrize("base", ["as printed", "pinned", "complete"])
@pytest.mark.parametrize("terms", [2, 5])
def test_functions_are_those_of_the_paper(paper_boom: Boom, base: Base, terms: int) -> None:
    """Reference: external, the paper's (29), (30) and (31); complete ones span all powers of x."""
    first = int(base == "as printed")
    x, y = np.linspace(0.0, 10.0, 61), np.linspace(0.0, 10.0, 61) - 10.0
    outer = [x**i * x * (x - 2.0) for i in range(first, first + terms + 1)]
    inner = [x**i * (y if i > 1 and base != "complete" else 1.0) for i in range(terms + 1)]
    for segment, printed in zip(paper_boom.segments, (outer, inner), strict=True):
        model = kantorovich_bending(segment, terms, base, rotary_inertia=False)
        places = segment.start + x
        assert model.load.shape == (terms,)
        assert max(outside_of_span(model, each, places) for each in printed[:-1]) < 1e-10
        assert outside_of_span(model, printed[-1], places) > 1e-5


THEORIES: tuple[Theory, ...] = ("euler-bernoulli", "timoshenko")


def elastic(
    segment: Segment, length: float, breaks: Sequence[float], theory: Theory, rotary_inertia: bool
) -> Component:
    """Return the deflection along z alone."""
    return finite_element_segment(segment, length, breaks, theory, rotary_inertia).components["z"]


def shear_stiffness(segment: Segment, theory: Theory) -> float:
    """G A of the webs in N."""
    if theory == "euler-bernoulli":
        return np.inf
    return 2.0 * segment.section.height * segment.section.web * 2.1e11 / 2.6


def test_a_node_beside_a_mass_changes_nothing() -> None:
    """Reference: another mesh, without the node at 1 mm from the mass."""
    segment = beam(masses=(PointMass(5.001, 20.0),))
    alone, beside = (elastic(segment, 0.3, x, "euler-bernoulli", False) for x in ((), (5.0,)))
    np.testing.assert_allclose(frequencies(beside)[:4], frequencies(alone)[:4], rtol=1e-5)


@pytest.mark.parametrize("rotary_inertia", [False, True])
def test_shear_flexible_frequencies_of_two_pinned_ends(rotary_inertia: bool) -> None:
    """Reference: analytic. With w = W sin kx and θ = Θ cos kx, Timoshenko's equations are
    GA k² W − GA k Θ = m̄ ω² W and (E J k² + GA) Θ − GA k W = I_p ω² Θ.
    """
    segment = beam(supports=(3.0, 8.0))
    shear = shear_stiffness(segment, "timoshenko")
    expected = []
    for k in np.array(PINNED_PINNED) / 5.0:
        pull = np.array(
            [[shear * k**2, -shear * k], [-shear * k, segment.bending_stiffness * k**2 + shear]]
        )
        # ω² is the inverse of the largest eigenvalue of K⁻¹M, which allows I_p = 0.
        mass = np.diag([segment.mass_per_length, segment.rotary_inertia * rotary_inertia])
        expected.append(1.0 / np.sqrt(np.linalg.eigvals(np.linalg.solve(pull, mass)).max()))
    assert expected[0] < 0.9 * angular_frequencies(segment, PINNED_PINNED)[0]
    errors = []
    for count in (10, 20, 40):
        model = elastic(segment, 5.0 / count, (), "timoshenko", rotary_inertia)
        errors.append(np.abs(frequencies(model)[:3] / expected - 1.0).max())
    # Elements short against the depth deflect in straight lines between their nodes: order two.
    assert errors[-1] < 2e-3
    assert np.log2(np.array(errors[:-1]) / np.array(errors[1:])) == pytest.approx(2.0, abs=0.15)


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize("length", [20.0, 0.4])
def test_statics_are_exact_at_nodes_of_any_mesh(theory: Theory, length: float) -> None:
    """Reference: analytic, an overhanging beam under its load, and forces at breaks and tip."""
    segment = beam(supports=(3.0, 4.2), load=-4000.0)
    forces = [(6.1, 3.0e4), (8.0, -1.0e4)]
    exact = OverhangingBeam(segment, forces, segment.load, shear_stiffness(segment, theory))
    model = elastic(segment, length, (6.1,), theory, False)
    load = model.load + sum(force * model.at(x) for x, force in forces)
    rest = np.linalg.solve(model.stiffness, load)
    for x in (6.1, 8.0):
        assert model.at(x) @ rest == pytest.approx(exact.deflection(x), rel=1e-8, abs=0.0)


@pytest.mark.parametrize("theory", THEORIES)
def test_requested_outputs_are_exact_under_a_uniform_load(theory: Theory) -> None:
    """Reference: analytic, a cantilever with L/h = 7.5, at places where no other node is."""
    segment = beam(end=7.5, supports=[Support(3.0, "clamped")], load=-4000.0)
    x = np.array([0.1, 2.25, 3.8])
    seen = [
        Observation(f"{what} {number}", 0, 3.0 + place, what)
        for what in ("deflection", "rotation")
        for number, place in enumerate(x.tolist())
    ]
    boom = Boom((segment,), (), observations=seen)
    system = gap_system(boom, finite_element_segments(boom, 4.5, theory, False)).gather_loads()
    rest = equilibrium(system, system.load)
    found = [system.observers[one.name].row @ rest for one in seen]
    bending, span = segment.load / (24.0 * segment.bending_stiffness), 4.5
    bent = bending * x**2 * (6.0 * span**2 - 4.0 * span * x + x**2)
    sheared = segment.load / shear_stiffness(segment, theory) * (span * x - 0.5 * x**2)
    turned = bending * (12.0 * span**2 * x - 12.0 * span * x**2 + 4.0 * x**3)
    assert found == pytest.approx([*bent + sheared, *turned], rel=1e-6)


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize("apart", [1.0e-4, 1.0e-7])
def test_places_too_near_for_element_share_node(theory: Theory, apart: float) -> None:
    """Reference: analytic, an overhanging beam under a force at one of two close positions."""
    segment = beam(supports=(3.0, 4.2), masses=(PointMass(8.0 - apart, 1.0),))
    exact = OverhangingBeam(segment, [(6.1 + apart, 3.0e4)], 0.0, shear_stiffness(segment, theory))
    model = elastic(segment, 0.5, (6.1, 6.1 + apart), theory, False)
    rest = np.linalg.solve(model.stiffness, 3.0e4 * model.at(6.1 + apart))
    for x in (6.1, 6.1 + apart, 8.0):
        assert model.at(x) @ rest == pytest.approx(exact.deflection(x), rel=2e-5, abs=0.0)


def test_shear_needs_a_section() -> None:
    message = (
        "segment: 'beam' has no box section, which a Timoshenko beam needs for its shear area; "
        "give height_to_width or section"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        elastic(beam(section=None), 0.5, (), "timoshenko", True)


# The same βL with the ends exchanged, and of free ends.
CLAMPED_PINNED, CLAMPED_CLAMPED = PINNED_FREE, FREE_FREE
Build = Callable[..., Component]


def elements(segment: Segment, rotary: bool = False) -> Component:
    return elastic(segment, 0.1, (), "euler-bernoulli", rotary)


def terms(segment: Segment, rotary: bool = False, base: Base = "complete") -> Component:
    return kantorovich_bending(segment, 16 if base == "complete" else 14, base, rotary)


KINDS = pytest.mark.parametrize("model_of", [elements, terms])
CLAMP, CLAMP_AT_END = Support(3.0, "clamped"), Support(8.0, "clamped")


@pytest.mark.parametrize(
    ("model_of", "supports", "numbers"),
    [
        *(
            (model_of, *held)
            for model_of in (elements, terms)
            for held in (
                ((), FREE_FREE),
                ((3.0, 8.0), PINNED_PINNED),
                ((CLAMP_AT_END,), CLAMPED_FREE),
                ((CLAMP, 8.0), CLAMPED_PINNED),
                ((CLAMP, CLAMP_AT_END), CLAMPED_CLAMPED),
            )
        ),
        (partial(terms, base="pinned"), (3.0, 8.0), PINNED_PINNED),
        (partial(terms, base="pinned"), (3.0,), PINNED_FREE),
        # As printed the base has no slope: a cantilever, without rigid mode.
        (partial(terms, base="as printed"), (3.0,), CLAMPED_FREE),
    ],
)
def test_rigid_supports(
    model_of: Build, supports: tuple[Support | float, ...], numbers: tuple[float, ...]
) -> None:
    """Reference: analytic βL."""
    segment = beam(supports=supports)
    expected = angular_frequencies(segment, numbers)
    np.testing.assert_allclose(frequencies(model_of(segment))[:3], expected, rtol=3e-6)


@KINDS
def test_rotary_inertia_of_two_pinned_ends(model_of: Build) -> None:
    """Reference: analytic, Rayleigh: ω² = (E J k⁴/m̄)/(1 + I_p k²/m̄)."""
    segment = beam(supports=(3.0, 8.0))
    k = np.array(PINNED_PINNED) / 5.0
    share = segment.rotary_inertia * k**2 / segment.mass_per_length
    assert share[0] > 0.01
    expected = angular_frequencies(segment, PINNED_PINNED) / np.sqrt(1.0 + share)
    np.testing.assert_allclose(frequencies(model_of(segment, True))[:3], expected, rtol=1e-5)


@KINDS
def test_viscous_damping_acts_as_mass_does(model_of: Build) -> None:
    """Reference: analytic, c in place of m̄."""
    segment = beam(viscous_damping=3.0)
    model = model_of(segment)
    expected = 3.0 / segment.mass_per_length * model.mass
    np.testing.assert_allclose(model.damping, expected, atol=1e-12 * expected.max())


@KINDS
def test_a_spring_or_a_mass_at_the_end_of_a_cantilever(model_of: Build) -> None:
    """Reference: analytic, 3 E J/L³ beside a spring, and under a mass that outweighs the beam."""
    clamp, mass = Support(3.0, "clamped"), 1.0e9
    segment = beam(supports=(clamp,), masses=(PointMass(8.0, mass),))
    own = 3.0 * segment.bending_stiffness / segment.length**3
    assert frequencies(model_of(segment))[0] == pytest.approx(np.sqrt(own / mass), rel=1e-6)
    held = model_of(beam(supports=(clamp, Support(8.0, stiffness=2.0e7))))
    row = held.at(8.0)
    given = row @ np.linalg.solve(held.stiffness, row)
    assert given == pytest.approx(1.0 / (own + 2.0e7), rel=1e-6)


@KINDS
@pytest.mark.parametrize("stiffness", [2.0e6, 4.0e8])
def test_frequencies_with_a_rotational_spring_at_the_hinge(
    model_of: Build, stiffness: float
) -> None:
    """Reference: analytic, between a pinned and a clamped end (Blevins 1979):
    (kL/EJ) (1 + cos βL cosh βL) = βL (sin βL cosh βL − cos βL sinh βL). On a soft spring the beam
    is nearly rigid with ω² = 3k/m̄L³; round-off of the highest mode changes it by up to 2e-5.
    """
    segment = beam(supports=(Support(3.0, rotation_stiffness=stiffness),))
    model = model_of(segment)
    share = stiffness * segment.length / segment.bending_stiffness

    def defect(number: float) -> float:
        turned = np.sin(number) - np.cos(number) * np.tanh(number)
        return float(share * (1.0 / np.cosh(number) + np.cos(number)) - number * turned)

    expected = angular_frequencies(segment, roots(defect, 0.05, 11.0)[:3])
    rtol = 3e-5 if stiffness < 1.0e7 else 1e-5
    np.testing.assert_allclose(frequencies(model)[:3], expected, rtol=rtol)


def test_a_stop_holds_tip_up(paper_boom: Boom, paper_law: PowerContact) -> None:
    """Reference: analytic. A stop below the tip pushes upwards, one above down or not."""
    stop = Stop(1, 19.0, 0.01, PowerContact(0.0, 1.0, stiffness_below=2.0e8))
    boom = replace(paper_boom, stops=(stop,))
    system = gap_system(touching(boom, paper_law), beam_elements(paper_boom, 0.5))
    assert list(system.stations) == [9.0, 10.0, 19.0]
    assert list(system.station_of_row) == [0, 1, 2]
    np.testing.assert_array_equal(system.rows[2], system.observers["tip"].row)
    law = system.laws[2]
    assert law.force(np.array([-6.0e-3, -4.0e-3, 6.0e-3])) == pytest.approx([-2.0e5, 0.0, 0.0])


ROOT = BoxSection(height=0.8, width=0.5, flange=0.02, web=0.012)
HEAD = BoxSection(height=0.3, width=0.35, flange=0.01, web=0.008)
LENGTH = BeamElements(name="beam", kind="finite-element").element_length


def arm(*supports: Support, added: float = 0.0) -> Segment:
    others = {"head_section": HEAD, "supports": supports or (Support(0.0, "clamped"),)}
    others["added_mass_per_length"] = added
    return Segment.of_section("arm", 0.0, 8.0, STEEL, ROOT, **others)


def default_elements(boom: Boom, theory: Theory) -> list[SegmentModel]:
    return finite_element_segments(boom, LENGTH, theory, rotary_inertia=False)


@pytest.mark.parametrize("theory", THEORIES)
def test_default_elements_are_near_the_cone(theory: Theory) -> None:
    """Reference: analytic, a cone's tip, frequency, buckling (Kirchhoff 1879, Dinnik 1929)."""
    boom = taper.arm(0.1 * taper.critical())
    plain = replace(boom, segments=taper.arm().segments)
    system = gap_system(plain, default_elements(plain, theory))
    (load,) = system.excitations
    tip = system.observers["tip"].row @ static_response(system, load.load)
    assert tip == pytest.approx(taper.tip(theory == "timoshenko"), rel=1e-4)
    if theory == "euler-bernoulli":
        assert system.frequencies[0] == pytest.approx(taper.frequency(), rel=1e-4)
        factor = critical_factor(boom, default_elements(boom, theory))
        assert factor == pytest.approx(10.0, rel=1e-4)


def local(x: float) -> BoxSection:
    """Return the section at x in m."""
    ends = ((box.height, box.width, box.flange, box.web) for box in (ROOT, HEAD))
    return BoxSection(*(a + x / 8.0 * (b - a) for a, b in zip(*ends, strict=True)))


@pytest.mark.parametrize("added", [0.0, 40.0])
def test_inertia_loads_are_those_of_the_plates(added: float) -> None:
    """Reference: analytic, ∫ ρ A x dx and ∫ ρ (A x² + J) dx of walls, a diaphragm at 6 m and
    hoses, in all models. On springs at both ends, that of the tip carries an eighth.
    """
    plate = 7850.0 * 0.03 * local(6.0).enclosed_area
    held = arm(Support(0.0, stiffness=1e6), Support(8.0, stiffness=1e6), added=added)
    segment = replace(held, diaphragms=(Diaphragm(6.0, 0.03),))
    felt = Load(0, "z", segment.mass_per_length, None, Step(), inertial=True)
    turned = AngularAcceleration(0, "z", 1.0, None, Step())

    def per_length(x: float) -> Array:
        walls = local(x)
        return 7850.0 * np.array([walls.area * x, walls.area * x**2 + walls.second_moment_of_area])

    moments = quad_vec(per_length, 0.0, 8.0)[0] + plate * np.array([6.0, 36.0])
    moments += added * np.array([8.0**2 / 2.0, 8.0**3 / 3.0])
    assert segment.mass_moment == pytest.approx(moments[0], rel=1e-12)
    for load, moment in zip((felt, turned), moments, strict=True):
        boom = Boom((segment,), (), (load,))
        for models in (
            finite_element_segments(boom, LENGTH, "timoshenko", rotary_inertia=True),
            kantorovich_segments(boom, [10], "complete", rotary_inertia=True),
            [rigid_segment(segment)],
        ):
            system = gap_system(boom, models)
            resting = static_response(system, system.excitations[0].load)
            # 1 m/s² or 1 rad/s² on a spring of 1e6 N/m.
            tip = system.observers["tip"].row @ resting
            assert tip == pytest.approx(1e-6 * moment / 8.0, rel=1e-5)


@pytest.mark.parametrize("added", [0.0, 40.0])
def test_axial_weights_follow_the_taper(added: float) -> None:
    """Reference: by hand. The foot carries the whole upright boom, the midpoint the upper half."""
    (pressed,) = with_compression([arm(added=added)], [], [], gravity=10.0)
    upper = 4.0 * (BoxSection(0.55, 0.425, 0.015, 0.01).area + HEAD.area) / 6.0
    upper += 4.0 * 4.0 * BoxSection(0.425, 0.3875, 0.0125, 0.009).area / 6.0
    places = pressed.compression(np.array([1e-12, 4.0]))
    assert places[0] == pytest.approx(10.0 * 8.0 * pressed.mass_per_length, rel=1e-9)
    assert places[1] == pytest.approx(10.0 * (7850.0 * upper + 4.0 * added), rel=1e-9)


def test_twist_follows_the_local_constant() -> None:
    """Reference: analytic, ∫ dx/(G J_t) under 1 N m at the free end, in series and elements."""
    soft, _ = quad(lambda x: 1.0 / (STEEL.shear_modulus * local(x).torsion_constant), 0.0, 8.0)
    swinging, _ = quad(
        lambda x: 7850.0 * local(x).polar_second_moment_of_area * (x / 8.0) ** 2, 0.0, 8.0
    )
    boom = Boom((arm(),), ())
    for models in (
        finite_element_segments(boom, 0.1, "timoshenko", rotary_inertia=True),
        kantorovich_segments(boom, [12], "complete", rotary_inertia=True),
    ):
        twist = models[0].components["twist"]
        row = twist.at(8.0)
        assert row @ np.linalg.solve(twist.stiffness, row) == pytest.approx(soft, rel=1e-5)
        # Of a twist from 0 to 1 along the arm.
        x = np.linspace(0.0, 8.0, 81)
        moved = np.linalg.pinv(np.array([twist.at(place) for place in x])) @ (x / 8.0)
        assert moved @ twist.mass @ moved == pytest.approx(swinging, rel=2e-4)
