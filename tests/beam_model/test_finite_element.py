# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beam elements, also tapered: exact statics at any mesh, frequencies of order four, rows."""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import eigh

from protractile.beam_model.boom_modes import critical_factor
from protractile.beam_model.component import Component, SegmentModel
from protractile.beam_model.elements import Theory
from protractile.beam_model.finite_element import (
    finite_element_segment,
    finite_element_segments,
)
from protractile.beam_model.kantorovich import kantorovich_segments, rigid_segment
from protractile.beam_model.lines import lines
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.geometry.axial import with_compression
from protractile.geometry.boom import Boom, BoomError, Material, PointMass, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.load import Load
from protractile.geometry.observation import Observation
from protractile.runs.case.kinds.finite_element import BeamElements
from studies import taper
from studies.reference_models.statics import static_response
from tests.beam_model.exact import (
    PINNED_FREE,
    PINNED_PINNED,
    OverhangingBeam,
    angular_frequencies,
    beam,
    frequencies,
)

THEORIES: tuple[Theory, ...] = ("euler-bernoulli", "timoshenko")


def bending(
    segment: Segment, length: float, breaks: Sequence[float], theory: Theory, rotary_inertia: bool
) -> Component:
    """Return the deflection along z alone."""
    return finite_element_segment(segment, length, breaks, theory, rotary_inertia).components["z"]


def shear_stiffness(segment: Segment, theory: Theory) -> float:
    """G A of the webs in N."""
    if theory == "euler-bernoulli":
        return np.inf
    return 2.0 * segment.section.height * segment.section.web * 2.1e11 / 2.6


def test_frequencies_converge_at_order_four() -> None:
    """Reference: analytic βL, and another mesh without the node at 1 mm from a mass. Rigid modes
    have ω = 0.
    """
    segment = beam(supports=(3.0,))
    expected = angular_frequencies(segment, PINNED_FREE)
    errors = np.array([
        frequencies(bending(segment, 5.0 / count, (), "euler-bernoulli", False))[:3] / expected - 1
        for count in (8, 16, 32)
    ])  # fmt: skip
    assert np.log2(errors[1] / errors[2]) == pytest.approx(4.0, abs=0.1)
    assert 0.0 < errors[-1].max() < 1.0e-5
    segment = beam(masses=(PointMass(5.001, 20.0),))
    alone, beside = (bending(segment, 0.3, x, "euler-bernoulli", False) for x in ((), (5.0,)))
    np.testing.assert_allclose(frequencies(beside)[:4], frequencies(alone)[:4], rtol=1e-5)
    squares = eigh(beside.stiffness, beside.mass, eigvals_only=True)
    np.testing.assert_allclose(squares[:2], 0.0, atol=1e-9 * squares[2])


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
        model = bending(segment, 5.0 / count, (), "timoshenko", rotary_inertia)
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
    model = bending(segment, length, (6.1,), theory, False)
    load = model.load + sum(force * model.at(x) for x, force in forces)
    rest = np.linalg.solve(model.stiffness, load)
    for x in (6.1, 8.0):
        assert model.at(x) @ rest == pytest.approx(exact.deflection(x), rel=1e-8, abs=0.0)
    for support in segment.supports:
        assert not model.at(support.x).any()


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize(("clamped", "length"), [(True, 4.5), (False, 0.5)])
def test_requested_outputs_are_exact_under_a_uniform_load(
    clamped: bool, length: float, theory: Theory
) -> None:
    """Reference: analytic, a cantilever and a beam on two supports with L/h = 7.5. The outputs are
    where no other node is.
    """
    supports = [Support(3.0, "clamped")] if clamped else [Support(3.0), Support(7.5)]
    segment = beam(end=7.5, supports=supports, load=-4000.0)
    places = {f"at-{x:g}": x for x in (3.1, 5.25, 6.8)}
    seen = [
        Observation(name, 0, x, what)
        for place, x in places.items()
        for name, what in ((place, "deflection"), (f"{place}-turn", "rotation"))
    ]
    boom = Boom((segment,), (), observations=seen)
    system = gap_system(boom, finite_element_segments(boom, length, theory, False)).gather_loads()
    rest = equilibrium(system, system.load)
    found = {name: seen.row @ rest for name, seen in system.observers.items()}
    shear, span, load = shear_stiffness(segment, theory), 4.5, segment.load
    for name, place in places.items():
        x = place - 3.0
        if clamped:
            bent, sheared = x**2 * (6.0 * span**2 - 4.0 * span * x + x**2), span * x - 0.5 * x**2
            turned = 12.0 * span**2 * x - 12.0 * span * x**2 + 4.0 * x**3
        else:
            bent, sheared = x * (span**3 - 2.0 * span * x**2 + x**3), 0.5 * x * (span - x)
            turned = span**3 - 6.0 * span * x**2 + 4.0 * x**3
        bending = load / (24.0 * segment.bending_stiffness)
        assert found[name] == pytest.approx(bending * bent + load / shear * sheared, rel=1e-6)
        assert found[f"{name}-turn"] == pytest.approx(bending * turned, rel=1e-6)


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize("apart", [1.0e-4, 1.0e-7])
def test_places_too_near_for_element_share_node(theory: Theory, apart: float) -> None:
    """Reference: analytic, an overhanging beam under a force at one of two close positions."""
    segment = beam(supports=(3.0, 4.2), masses=(PointMass(8.0 - apart, 1.0),))
    exact = OverhangingBeam(segment, [(6.1 + apart, 3.0e4)], 0.0, shear_stiffness(segment, theory))
    model = bending(segment, 0.5, (6.1, 6.1 + apart), theory, False)
    rest = np.linalg.solve(model.stiffness, 3.0e4 * model.at(6.1 + apart))
    for x in (6.1, 6.1 + apart, 8.0):
        assert model.at(x) @ rest == pytest.approx(exact.deflection(x), rel=2e-5, abs=0.0)


@pytest.mark.parametrize(("theory", "rotary_inertia"), [(THEORIES[0], True), (THEORIES[1], False)])
def test_rigid_motions(theory: Theory, rotary_inertia: bool) -> None:
    """Reference: analytic. Rigid motions have no strain, the mass m̄ L and the inertia
    m̄ L³/12 + I_p L about the midpoint.
    """
    segment = beam(load=7.0, viscous_damping=3.0)
    model = bending(segment, 0.9, (), theory, rotary_inertia)
    nodes = np.linspace(3.0, 8.0, len(model.load) // 2)
    lift, turn = np.zeros(len(model.load)), np.zeros(len(model.load))
    lift[::2], turn[::2], turn[1::2] = 1.0, nodes - 5.5, 1.0
    for motion in (lift, turn):
        assert np.abs(model.stiffness @ motion).max() < 1e-9 * np.abs(model.stiffness).max()
    mass = segment.mass_per_length * 5.0
    spin = mass * 25.0 / 12.0 + 5.0 * segment.rotary_inertia * rotary_inertia
    assert lift @ model.mass @ lift == pytest.approx(mass, rel=1e-12)
    assert turn @ model.mass @ turn == pytest.approx(spin, rel=1e-12)
    assert abs(lift @ model.mass @ turn) < 1e-9 * mass
    assert lift @ model.damping @ lift == pytest.approx(15.0, rel=1e-12)
    assert lift @ model.load == pytest.approx(35.0, rel=1e-12)
    assert abs(turn @ model.load) < 1e-9
    assert model.at(4.321) @ turn == pytest.approx(4.321 - 5.5, rel=1e-12)


def test_shear_needs_a_section() -> None:
    message = (
        "segment: 'beam' has no box section, which a Timoshenko beam needs for its shear area; "
        "give height_to_width or section"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        bending(beam(section=None), 0.5, (), "timoshenko", True)


STEEL = Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
ROOT = BoxSection(height=0.8, width=0.5, flange=0.02, web=0.012)
HEAD = BoxSection(height=0.3, width=0.35, flange=0.01, web=0.008)
CLAMP = Support(0.0, "clamped")
LENGTH = BeamElements(name="beam", kind="finite-element").element_length


def arm(start: float = 0.0, supports: tuple[Support, ...] = (CLAMP,)) -> Segment:
    others = {"head_section": HEAD, "supports": supports}
    return Segment.of_section("arm", start, start + 8.0, STEEL, ROOT, **others)


def elements(boom: Boom, theory: Theory) -> list[SegmentModel]:
    return finite_element_segments(boom, LENGTH, theory, rotary_inertia=False)


@pytest.mark.parametrize("theory", THEORIES)
def test_default_elements_are_near_the_cone(theory: Theory) -> None:
    """Reference: analytic, a cone's tip, frequency, buckling (Kirchhoff 1879, Dinnik 1929)."""
    boom = taper.arm(0.1 * taper.critical())
    plain = replace(boom, segments=taper.arm().segments)
    system = gap_system(plain, elements(plain, theory))
    (load,) = system.excitations
    tip = system.observers["tip"].row @ static_response(system, load.load)
    assert tip == pytest.approx(taper.tip(theory == "timoshenko"), rel=1e-4)
    if theory == "euler-bernoulli":
        assert system.frequencies[0] == pytest.approx(taper.frequency(), rel=1e-4)
        factor = critical_factor(boom, elements(boom, theory))
        assert factor == pytest.approx(10.0, rel=1e-4)


@pytest.mark.parametrize("direction", ["z", "y"])
def test_a_deep_arm_shears_as_it_should(direction: str) -> None:
    """Reference: analytic, ∫ s²/(E J) + 1/(G A_s) dx by quadrature. Shear contributes 3 %."""
    boom = Boom((arm(),), (), (Load(0, "z", 1.0, 8.0, Step()),))
    segment = boom.segments[0]
    if direction == "y":
        boom = replace(boom, segments=(segment.turned(),))

    def flexibility(x: float) -> float:
        here = local(x).turned() if direction == "y" else local(x)
        bent = (8.0 - x) ** 2 / (STEEL.youngs_modulus * here.second_moment_of_area)
        return bent + 1.0 / (STEEL.shear_modulus * here.shear_area)

    system = gap_system(boom, elements(boom, "timoshenko"))
    (load,) = system.excitations
    tip = system.observers["tip"].row @ static_response(system, load.load)
    assert tip == pytest.approx(quad(flexibility, 0.0, 8.0)[0], rel=1e-4)


def local(x: float) -> BoxSection:
    """Return the section at x in m."""
    ends = ((box.height, box.width, box.flange, box.web) for box in (ROOT, HEAD))
    return BoxSection(*(a + x / 8.0 * (b - a) for a, b in zip(*ends, strict=True)))


def test_mass_equals_the_mass_of_the_plates() -> None:
    """Reference: by hand, ∫ A dx = 8 (A_0 + 4 A_m + A_1)/6 and its centroid, in all models."""
    sections = [ROOT, BoxSection(0.55, 0.425, 0.015, 0.01), HEAD]
    areas = [section.area for section in sections]
    mass = 7850.0 * 8.0 * (areas[0] + 4.0 * areas[1] + areas[2]) / 6.0
    middle = 8.0 * (2.0 * areas[1] + areas[2]) / (areas[0] + 4.0 * areas[1] + areas[2])
    segment = arm(supports=(Support(0.0, stiffness=1e6), Support(8.0, stiffness=1e6)))
    assert segment.mass_per_length * 8.0 == pytest.approx(mass, rel=1e-12)
    assert segment.mass_centre == pytest.approx(middle, rel=1e-12)
    felt = Load(0, "z", segment.mass_per_length, None, Step(), inertial=True)
    boom = Boom((segment,), (), (felt,))
    for models in (
        elements(boom, "timoshenko"),
        kantorovich_segments(boom, [10], "complete", rotary_inertia=True),
        [rigid_segment(segment)],
    ):
        system = gap_system(boom, models)
        resting = static_response(system, system.excitations[0].load)
        ends = [system.observers[name].row @ resting for name in system.observers]
        # 1 m/s² on springs of 1e6 N/m: the tip's carries m g x_m/8.
        assert ends[0] == pytest.approx(1e-6 * mass * middle / 8.0, rel=1e-5)


def test_axial_weights_follow_the_taper() -> None:
    """Reference: by hand. The foot carries the whole upright boom, the midpoint the upper half."""
    (pressed,) = with_compression([arm()], [], [], gravity=10.0)
    upper = 4.0 * (BoxSection(0.55, 0.425, 0.015, 0.01).area + HEAD.area) / 6.0
    upper += 4.0 * 4.0 * BoxSection(0.425, 0.3875, 0.0125, 0.009).area / 6.0
    places = pressed.compression(np.array([1e-12, 4.0]))
    assert places[0] == pytest.approx(10.0 * 8.0 * pressed.mass_per_length, rel=1e-9)
    assert places[1] == pytest.approx(7850.0 * 10.0 * upper, rel=1e-9)


@pytest.mark.parametrize("kind", ["timoshenko", "series"])
def test_section_forces_are_those_of_statics(kind: str) -> None:
    """Reference: by hand. Under −1000 N at the tip, M = 1000 s, V = −1000 N in any section."""
    boom = Boom((arm(),), (), (Load(0, "z", -1000.0, 8.0, Step()),))
    models = (
        elements(boom, "timoshenko")
        if kind == "timoshenko"
        else kantorovich_segments(boom, [16], "complete", rotary_inertia=False)
    )
    system = gap_system(boom, models).gather_loads()
    (line,) = lines(boom, models)
    found = line.read(equilibrium(system, system.load))
    np.testing.assert_allclose(found["moment"], 1000.0 * (8.0 - line.x), atol=8.0)
    np.testing.assert_allclose(found["shear"], -1000.0, rtol=5e-3)


def test_twist_follows_the_local_constant() -> None:
    """Reference: analytic, ∫ dx/(G J_t) under 1 N m at the free end, in series and elements."""
    soft, _ = quad(lambda x: 1.0 / (STEEL.shear_modulus * local(x).torsion_constant), 0.0, 8.0)
    boom = Boom((arm(),), ())
    for models in (
        elements(boom, "timoshenko"),
        kantorovich_segments(boom, [12], "complete", rotary_inertia=True),
    ):
        twist = models[0].components["twist"]
        row = twist.at(8.0)
        # A linear element has the stiffness of its middle: 1e-4 of the whole.
        assert row @ np.linalg.solve(twist.stiffness, row) == pytest.approx(soft, rel=1e-5)
