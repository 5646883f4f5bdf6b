# SPDX-License-Identifier: LGPL-3.0-or-later
"""Kantorovich series and rigid segments: spaces of the paper, conditioning, convergence."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.component import Component, natural_modes
from protractile.beam_model.finite_element import finite_element_segment
from protractile.beam_model.kantorovich import Base, kantorovich_bending, rigid_segment
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, PointMass, Support
from tests.beam_model.exact import (
    CLAMPED_FREE,
    FREE_FREE,
    PINNED_FREE,
    PINNED_PINNED,
    angular_frequencies,
    beam,
    frequencies,
)
from tests.touching import touching


def outside_of_span(model: Component, function: Array, x: Array) -> float:
    """Return the part of a function, sampled at x, outside the space of the model's functions."""
    functions = np.array([model.at(place) for place in x])
    functions /= np.abs(functions).max(axis=0)
    coefficients, *_ = np.linalg.lstsq(functions, function, rcond=None)
    return float(np.linalg.norm(functions @ coefficients - function) / np.linalg.norm(function))


@pytest.mark.parametrize(("base", "first"), [("as printed", 1), ("pinned", 0), ("complete", 0)])
@pytest.mark.parametrize("terms", [2, 5])
def test_outer_functions_are_those_of_the_paper(
    paper_boom: Boom, base: Base, first: int, terms: int
) -> None:
    """Reference: external source, (29). The functions span x^i (x − x0)(x − x1) alone."""
    outer = paper_boom.segments[0]
    model = kantorovich_bending(outer, terms, base, rotary_inertia=False)
    x = np.linspace(0.0, 10.0, 61)
    printed = [x**i * x * (x - 2.0) for i in range(first, first + terms)]
    assert model.load.shape == (terms,)
    assert max(outside_of_span(model, function, x) for function in printed) < 1e-10
    assert outside_of_span(model, x ** (first + terms) * x * (x - 2.0), x) > 1e-5


@pytest.mark.parametrize("base", ["as printed", "pinned", "complete"])
@pytest.mark.parametrize("terms", [1, 2, 3, 5])
def test_inner_functions_are_those_of_the_paper(paper_boom: Boom, base: Base, terms: int) -> None:
    """Reference: external source. The functions span (30) and (31), i = 1, 2, 3, …, alone; the
    complete ones span all powers of x below the number of terms.
    """
    inner = paper_boom.segments[1]
    model = kantorovich_bending(inner, terms, base, rotary_inertia=False)
    x = np.linspace(9.0, 19.0, 61)
    printed = [(x - 9.0) ** i for i in range(terms + 1)]
    if base != "complete":
        printed[2:] = [power * (x - 19.0) for power in printed[2:]]
    assert model.load.shape == (terms,)
    assert max(outside_of_span(model, function, x) for function in printed[:terms]) < 1e-10
    assert outside_of_span(model, printed[terms], x) > 1e-5


def test_printed_inner_functions_keep_the_tip_on_the_tangent_at_the_tail(paper_boom: Boom) -> None:
    """Reference: analytic, u(x4) = u(x2) + u'(x2) (x4 − x2) of each of (30), (31)."""
    model = kantorovich_bending(paper_boom.segments[1], 9, "as printed", rotary_inertia=False)
    tangent = model.at(9.0) + 10.0 * model.at(9.0, 1)
    assert np.abs(model.at(19.0) - tangent).max() < 1e-8


@pytest.mark.parametrize("terms", [3, 24, 60])
def test_complete_and_pinned_are_one_space_on_pinned_supports(paper_boom: Boom, terms: int) -> None:
    """Reference: analytic. Roots and supports give the same polynomials, by ascending degree."""
    outer = paper_boom.segments[0]
    pinned, complete = (
        frequencies(kantorovich_bending(outer, terms, base, rotary_inertia=False))[:3]
        for base in ("pinned", "complete")
    )
    np.testing.assert_allclose(complete, pinned, rtol=1e-7)


@pytest.mark.parametrize(
    ("base", "supports", "numbers"),
    [
        ("pinned", (3.0, 8.0), PINNED_PINNED),
        # The printed inner functions lack one (see above); the complete ones do not.
        ("complete", (), FREE_FREE),
        ("pinned", (3.0,), PINNED_FREE),
        # As printed the base has no slope: a cantilever, without rigid mode.
        ("as printed", (3.0,), CLAMPED_FREE),
    ],
)
def test_frequencies_of_plain_beams(
    base: Base, supports: tuple[float, ...], numbers: tuple[float, ...]
) -> None:
    """Reference: analytic βL."""
    segment = beam(supports=supports)
    model = kantorovich_bending(segment, 14, base, rotary_inertia=False)
    expected = angular_frequencies(segment, numbers)
    np.testing.assert_allclose(frequencies(model)[:3], expected, rtol=1e-6)


@pytest.mark.parametrize("base", ["as printed", "pinned", "complete"])
@pytest.mark.parametrize("number", [0, 1], ids=["outer", "inner"])
def test_modes_stay_orthonormal_with_many_terms(paper_boom: Boom, base: Base, number: int) -> None:
    """Reference: analytic. With twelve functions per segment, powers of x would lose all digits."""
    segment = paper_boom.segments[number]
    model = kantorovich_bending(segment, 12, base, rotary_inertia=False)
    modes = natural_modes(model.stiffness, model.mass, model.rigid_modes)
    unit = modes.shapes.T @ model.mass @ modes.shapes
    np.testing.assert_allclose(unit, np.eye(12), atol=1e-8)
    strain = modes.shapes.T @ model.stiffness @ modes.shapes
    # Relative to the modes of each entry: relative to the highest ω², the lowest would be free.
    omega = np.sqrt(modes.omega2)
    omega[: segment.rigid_modes] = omega[segment.rigid_modes]
    unit_strain = strain / np.outer(omega, omega)
    np.testing.assert_allclose(unit_strain, np.diag(modes.omega2 / omega**2), rtol=0.0, atol=1e-8)
    assert (modes.omega2[: segment.rigid_modes] == 0.0).all()
    assert (np.diff(modes.omega2[segment.rigid_modes :]) > 0.0).all()


@pytest.mark.parametrize("base", ["as printed", "pinned", "complete"])
@pytest.mark.parametrize("number", [0, 1], ids=["outer", "inner"])
def test_frequencies_fall_with_every_term(paper_boom: Boom, base: Base, number: int) -> None:
    """Reference: analytic, Rayleigh-Ritz in growing spaces."""
    segment = paper_boom.segments[number]
    before = np.zeros(0)
    for terms in range(3, 19):
        model = kantorovich_bending(segment, terms, base, rotary_inertia=False)
        now = frequencies(model)
        assert (now[: before.size] <= before * (1.0 + 1e-9)).all()
        assert (now[1 : 1 + before.size] >= before[: now.size - 1] * (1.0 - 1e-9)).all()
        before = now


def test_pinned_outer_series_converges_to_the_beam(paper_boom: Boom) -> None:
    """Reference: other code, Hermite elements, and E J w = P a² (l + a)/3 under a force P at x3.
    With 12 and 24 terms, frequencies are within 1e-3 and 1.5e-4, the compliance within 4e-4 and
    6e-5. With the functions as printed, errors are 2 to 5 %.
    """
    outer = paper_boom.segments[0]
    beam = finite_element_segment(outer, 0.125, (), "euler-bernoulli", False)
    fine = frequencies(beam.components["z"])[:4]
    compliance = 8.0**2 * (2.0 + 8.0) / (3.0 * outer.bending_stiffness)
    for terms, frequency_error, compliance_error in ((12, 1.0e-3, 4.5e-4), (24, 2.0e-4, 7.0e-5)):
        model = kantorovich_bending(outer, terms, "pinned", rotary_inertia=False)
        too_high = frequencies(model)[:4] / fine - 1.0
        assert (too_high > 0.0).all()
        assert too_high.max() < frequency_error
        row = model.at(10.0)
        too_stiff = 1.0 - row @ np.linalg.solve(model.stiffness, row) / compliance
        assert 0.0 < too_stiff < compliance_error


def test_load_is_the_work_of_a_uniform_force() -> None:
    """Reference: analytic, the work on x² (x − 2), and on 1 and x − x2 of the paper's spaces."""
    inner = kantorovich_bending(beam(load=11.0), 2, "as printed", rotary_inertia=False)
    for function, work in ((np.ones(2), 55.0), (np.array([0.0, 5.0]), 11.0 * 12.5)):
        ends = np.array([inner.at(x) for x in (3.0, 8.0)])
        assert np.linalg.solve(ends, function) @ inner.load == pytest.approx(work, rel=1e-12)
    segment = beam(load=11.0, supports=(3.0, 5.0))
    outer = kantorovich_bending(segment, 1, "as printed", rotary_inertia=False)
    # ∫₀⁵ x² (x − 2) dx = 5⁴/4 − 2·5³/3, and the function is 75 at x = 5.
    work = 11.0 * (5.0**4 / 4.0 - 2.0 * 5.0**3 / 3.0) / 75.0
    assert outer.load / outer.at(8.0) == pytest.approx(work, rel=1e-12)


LAW = PowerContact(stiffness=2.0e6, exponent=1.0).with_clearance(7.0e-3)


def rigid(boom: Boom, laws: list[PowerContact]) -> GapSystem:
    return gap_system(touching(boom, laws), [rigid_segment(segment) for segment in boom.segments])


@pytest.fixture
def inside(paper_boom: Boom) -> Boom:
    """Return an inner segment in a clamped outer one, with its midpoint between the stations."""
    outer, inner = paper_boom.segments
    return Boom(
        (
            replace(outer, supports=(Support(0.0, "clamped"),)),
            replace(inner, start=2.0, end=10.0, load=-540.0),
        ),
        (replace(paper_boom.joints[0], stations=(4.0, 8.0)),),
    )


def test_a_segment_falls_on_its_contacts_and_bounces(inside: Boom) -> None:
    """Reference: analytic, free fall through the clearance, then half a period on two springs."""
    system = rigid(inside, [LAW])
    assert system.num_modes == 2
    inner = inside.segments[1]
    mass, force = inner.mass_per_length * inner.length, -inner.load * inner.length
    gravity, omega = force / mass, np.sqrt(2.0 * LAW.law.stiffness / mass)
    fall = np.sqrt(2.0 * LAW.above / gravity)
    speed, sag = gravity * fall, force / (2.0 * LAW.law.stiffness)
    contact = 2.0 / omega * (np.pi - np.arctan(speed * omega / gravity))
    lowest = -LAW.above - sag - np.hypot(sag, speed / omega)
    period = 2.0 * fall + contact

    found = FixedStep(2.0e-6)(Motion(system, 4.0 * period, period / 40.0))
    tip = found.data["tip"].values
    assert tip[20::40] == pytest.approx([lowest] * 4, rel=1e-6)
    assert tip[::40] == pytest.approx(np.zeros(5), abs=1e-6 * LAW.above)
    assert found.data["tail"].values == pytest.approx(tip, abs=1e-12)
    assert found.data.attrs["energy_residual"] < 1e-7


def test_the_boom_rests_as_a_lever(paper_boom: Boom) -> None:
    """Reference: analytic, moments of the inner segment's weight about both stations."""
    outer, inner = paper_boom.segments
    held = replace(outer, supports=(Support(0.0), Support(2.0)))
    system = rigid(replace(paper_boom, segments=(held, inner)), [LAW])
    rest = equilibrium(system, system.load)
    forces = [law.force(row @ rest) for law, row in zip(system.laws, system.rows, strict=True)]
    weight, arm = inner.load * inner.length, 0.5 * (inner.start + inner.end)
    assert forces == pytest.approx([weight * (10.0 - arm), weight * (arm - 9.0)], rel=1e-9)
    assert system.observers["head"].row @ rest == 0.0


def test_a_body_swings_on_springs(paper_boom: Boom) -> None:
    """Reference: analytic, bounce and pitch of a symmetric bar with a mass in its middle."""
    stiffness = 3.0e5
    springs = tuple(Support(x, stiffness=stiffness) for x in (1.0, 9.0))
    bar = replace(paper_boom.segments[0], supports=springs, masses=(PointMass(5.0, 400.0),))
    mass = bar.mass_per_length * bar.length + 400.0
    inertia = bar.mass_per_length * bar.length**3 / 12.0 + bar.rotary_inertia * bar.length
    expected = np.sqrt([2.0 * stiffness / mass, 2.0 * stiffness * 4.0**2 / inertia])
    modes = BoomModes(Boom((bar,), ()), [rigid_segment(bar)])
    assert np.sqrt(np.sort(modes.omega2)) == pytest.approx(np.sort(expected), rel=1e-12)


def test_supports_leave_unheld_rigid_motions_free(paper_boom: Boom, spatial_boom: Boom) -> None:
    outer, inner = spatial_boom.segments
    sizes = {
        name: component.load.size for name, component in rigid_segment(inner).components.items()
    }
    assert sizes == {"z": 2, "y": 2, "twist": 1}
    clamped = rigid_segment(replace(outer, supports=(Support(0.0, "clamped"),)))
    assert [component.load.size for component in clamped.components.values()] == [0, 0, 0]
    hinged = rigid_segment(replace(paper_boom.segments[0], supports=(Support(2.0),)))
    row = hinged.components["z"].at(7.0) / hinged.components["z"].at(3.0)
    assert row == pytest.approx([5.0], rel=1e-12)
