# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beam elements: exact statics at any mesh, frequencies of order four, rows that read anywhere."""

import re
from collections.abc import Sequence

import numpy as np
import pytest
from scipy.linalg import eigh

from protractile.beam_model.component import Component
from protractile.beam_model.finite_element import (
    Theory,
    finite_element_segment,
    finite_element_segments,
)
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.equilibrium import equilibrium
from protractile.geometry.boom import Boom, BoomError, PointMass, Segment, Support
from protractile.geometry.observation import Observation
from tests.beam_model.exact import (
    FREE_FREE,
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


def test_mass_beside_a_node_costs_no_digits() -> None:
    """Reference: other mesh, without the node at 1 mm from the mass. Rigid modes have ω = 0."""
    segment = beam(masses=(PointMass(5.001, 20.0),))
    alone, beside = (bending(segment, 0.3, x, "euler-bernoulli", False) for x in ((), (5.0,)))
    np.testing.assert_allclose(frequencies(beside)[:4], frequencies(alone)[:4], rtol=1e-5)
    squares = eigh(beside.stiffness, beside.mass, eigvals_only=True)
    np.testing.assert_allclose(squares[:2], 0.0, atol=1e-9 * squares[2])


@pytest.mark.parametrize(
    ("supports", "numbers"),
    [((), FREE_FREE), ((3.0, 8.0), PINNED_PINNED), ((3.0,), PINNED_FREE)],
    ids=["free-free", "pinned-pinned", "pinned-free"],
)
def test_frequencies_converge_at_order_four(
    supports: tuple[float, ...], numbers: tuple[float, ...]
) -> None:
    """Reference: analytic βL. Order of convergence and error."""
    segment = beam(supports=supports)
    expected = angular_frequencies(segment, numbers)
    errors = []
    for count in (8, 16, 32):
        model = bending(segment, 5.0 / count, (), "euler-bernoulli", False)
        assert model.rigid_modes == 2 - len(supports)
        errors.append(frequencies(model)[:3] / expected - 1.0)
    slopes = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert slopes[1] == pytest.approx(4.0, abs=0.1)
    assert 0.0 < errors[-1].max() < 1.0e-5
    assert errors[-1][0] < 5.0e-7


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
@pytest.mark.parametrize("length", [20.0, 1.3, 0.4])
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
@pytest.mark.parametrize("length", [4.5, 0.5])
@pytest.mark.parametrize("clamped", [True, False])
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
@pytest.mark.parametrize("apart", [1.0e-4, 1.0e-5, 1.0e-7])
def test_places_too_near_for_element_share_node(theory: Theory, apart: float) -> None:
    """Reference: analytic, an overhanging beam under a force at one of two close positions."""
    segment = beam(supports=(3.0, 4.2), masses=(PointMass(8.0 - apart, 1.0),))
    exact = OverhangingBeam(segment, [(6.1 + apart, 3.0e4)], 0.0, shear_stiffness(segment, theory))
    model = bending(segment, 0.5, (6.1, 6.1 + apart), theory, False)
    rest = np.linalg.solve(model.stiffness, 3.0e4 * model.at(6.1 + apart))
    for x in (6.1, 6.1 + apart, 8.0):
        assert model.at(x) @ rest == pytest.approx(exact.deflection(x), rel=2e-5, abs=0.0)


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize("rotary_inertia", [False, True])
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


@pytest.mark.parametrize(
    ("length", "breaks", "nodes"),
    [
        (10.0, (), 3),  # 3, 4, 8
        (1.0, (), 6),
        (0.3, (), 4 + 14 + 1),
        (0.1, (), 51),
        (10.0, (4.0, 8.0, 5.0 + 1e-12, 5.0), 4),
        (10.0, (2.9, 8.1), 3),  # places off the segment are not its own
    ],
)
def test_elements_are_no_longer_than_asked(
    length: float, breaks: tuple[float, ...], nodes: int
) -> None:
    model = bending(beam(supports=(4.0,)), length, breaks, "euler-bernoulli", True)
    assert len(model.load) == 2 * nodes - 1


def test_shear_needs_a_section() -> None:
    message = (
        "segment: 'beam' has no box section, which a Timoshenko beam needs for its shear area; "
        "give height_to_width or section"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        bending(beam(section=None), 0.5, (), "timoshenko", True)
