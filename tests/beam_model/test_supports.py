# SPDX-License-Identifier: LGPL-3.0-or-later
"""Supports of every kind, masses, loads and stops of beams."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model.component import Component
from protractile.beam_model.finite_element import finite_element_segment
from protractile.beam_model.kantorovich import kantorovich_bending
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.integrator import AdaptiveStep
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, PointMass, Segment, Stop, Support
from tests.beam_model.exact import (
    CLAMPED_FREE,
    FREE_FREE,
    PINNED_FREE,
    PINNED_PINNED,
    OverhangingBeam,
    angular_frequencies,
    beam,
    beam_elements,
    frequencies,
    roots,
)
from tests.touching import touching

# The same βL with the ends exchanged, and of free ends.
CLAMPED_PINNED, CLAMPED_CLAMPED = PINNED_FREE, FREE_FREE


def elements(segment: Segment, rotary: bool = False) -> Component:
    return finite_element_segment(segment, 0.1, (), "euler-bernoulli", rotary).components["z"]


def terms(segment: Segment, rotary: bool = False) -> Component:
    return kantorovich_bending(segment, 16, "complete", rotary)


KINDS = pytest.mark.parametrize("model_of", [elements, terms])


@KINDS
@pytest.mark.parametrize(
    ("supports", "numbers"),
    [
        ((), FREE_FREE),
        ((Support(3.0), Support(8.0)), PINNED_PINNED),
        ((Support(8.0, "clamped"),), CLAMPED_FREE),
        ((Support(3.0, "clamped"), Support(8.0)), CLAMPED_PINNED),
        ((Support(3.0, "clamped"), Support(8.0, "clamped")), CLAMPED_CLAMPED),
    ],
    ids=["free", "pinned", "clamped at the end", "clamped and pinned", "clamped at both ends"],
)
def test_rigid_supports(
    model_of: Callable[[Segment], Component],
    supports: tuple[Support, ...],
    numbers: tuple[float, ...],
) -> None:
    """Reference: analytic βL."""
    segment = beam(supports=supports)
    model = model_of(segment)
    assert model.rigid_modes == (0 if supports else 2)
    expected = angular_frequencies(segment, numbers)
    np.testing.assert_allclose(frequencies(model)[:3], expected, rtol=3e-6)


def tip_frequencies(segment: Segment, hold: Callable[[float], float]) -> Array:
    """Return ω of a cantilever with the dynamic stiffness ``hold(ω)`` in N/m at its end.

    It is −ω² M for a mass, k for a spring.

    1 + cos βL cosh βL = hold / (E J β³) · (cos βL sinh βL − sin βL cosh βL)
    """
    stiffness, length = segment.bending_stiffness, segment.length

    def omega(beta: float) -> float:
        return beta**2 * float(np.sqrt(stiffness / segment.mass_per_length))

    def defect(number: float) -> float:
        beta = number / length
        cosine, sine = np.cos(number), np.sin(number)
        # Both sides over cosh, which grows without bound.
        turned = cosine * np.tanh(number) - sine
        share = hold(omega(beta)) / (stiffness * beta**3)
        return float(1.0 / np.cosh(number) + cosine - share * turned)

    return np.array([omega(root / length) for root in roots(defect, 0.1, 12.0)])


@KINDS
def test_rotary_inertia_of_two_pinned_ends(model_of: Callable[[Segment, bool], Component]) -> None:
    """Reference: analytic, Rayleigh: ω² = (E J k⁴/m̄)/(1 + I_p k²/m̄)."""
    segment = beam(supports=(3.0, 8.0))
    k = np.array(PINNED_PINNED) / 5.0
    share = segment.rotary_inertia * k**2 / segment.mass_per_length
    assert share[0] > 0.01
    expected = angular_frequencies(segment, PINNED_PINNED) / np.sqrt(1.0 + share)
    np.testing.assert_allclose(frequencies(model_of(segment, True))[:3], expected, rtol=1e-5)


@KINDS
@pytest.mark.parametrize(("spring", "mass"), [(2.0e7, 0.0), (0.0, 900.0)], ids=["spring", "mass"])
def test_a_spring_or_a_mass_at_the_end_of_a_cantilever(
    model_of: Callable[[Segment], Component], spring: float, mass: float
) -> None:
    """Reference: analytic, the transcendental equation of a clamped beam on an end spring, of which
    −ω² M takes the place for a mass.
    """
    clamp, held = Support(3.0, "clamped"), Support(8.0, stiffness=spring or None)
    masses = (PointMass(8.0, mass),) if mass else ()
    segment = beam(supports=(clamp, held) if spring else (clamp,), masses=masses)
    expected = tip_frequencies(segment, lambda omega: spring - mass * omega**2)
    free, pinned = (
        angular_frequencies(segment, numbers)[0] for numbers in (CLAMPED_FREE, CLAMPED_PINNED)
    )
    assert expected[0] < 0.8 * (pinned if spring else free)
    assert (expected[0] > 1.2 * free) == (spring > 0.0)
    np.testing.assert_allclose(frequencies(model_of(segment))[:3], expected[:3], rtol=1e-6)


@KINDS
@pytest.mark.parametrize("stiffness", [2.0e6, 4.0e8])
def test_frequencies_with_a_rotational_spring_at_the_hinge(
    model_of: Callable[[Segment], Component], stiffness: float
) -> None:
    """Reference: analytic, between a pinned and a clamped end (Blevins 1979):
    (kL/EJ) (1 + cos βL cosh βL) = βL (sin βL cosh βL − cos βL sinh βL). On a soft spring the beam
    is nearly rigid with ω² = 3k/m̄L³; round-off of the highest mode changes it by up to 2e-5.
    """
    segment = beam(supports=(Support(3.0, rotation_stiffness=stiffness),))
    model = model_of(segment)
    assert model.rigid_modes == segment.rigid_modes == 0
    share = stiffness * segment.length / segment.bending_stiffness

    def defect(number: float) -> float:
        turned = np.sin(number) - np.cos(number) * np.tanh(number)
        return float(share * (1.0 / np.cosh(number) + np.cos(number)) - number * turned)

    expected = angular_frequencies(segment, roots(defect, 0.05, 11.0)[:3])
    rigid = np.sqrt(3.0 * stiffness / (segment.mass_per_length * segment.length**3))
    assert (abs(expected[0] / rigid - 1.0) < 0.01) == (stiffness < 1.0e7)
    rtol = 3e-5 if stiffness < 1.0e7 else 1e-5
    np.testing.assert_allclose(frequencies(model)[:3], expected, rtol=rtol)


@KINDS
def test_rest_on_two_springs(model_of: Callable[[Segment], Component]) -> None:
    """Reference: analytic, the beam on rigid supports, moved along with the compressed springs."""
    soft, hard = 2.0e6, 7.0e6
    segment = beam(supports=(Support(3.0, stiffness=soft), Support(6.0, stiffness=hard)))
    model = model_of(segment)
    assert model.rigid_modes == 0
    load = 1.0e4 * model.at(8.0)
    rest = np.linalg.solve(model.stiffness, load)
    bent = OverhangingBeam(beam(supports=(3.0, 6.0)), [(8.0, 1.0e4)], 0.0)
    at_soft, at_hard = -1.0e4 * 2.0 / 3.0 / soft, 1.0e4 * 5.0 / 3.0 / hard
    for x in (3.0, 4.5, 6.0, 8.0):
        given = at_soft + (at_hard - at_soft) * (x - 3.0) / 3.0
        # Twelve powers reach the kink over the inner support to four digits.
        assert model.at(x) @ rest == pytest.approx(bent.deflection(x) + given, rel=2e-4)


def test_complete_functions_converge_on_any_supports() -> None:
    """Reference: other code, Hermite elements; order 3 due to the reaction inside the span."""
    supports = (Support(3.0, "clamped"), Support(5.0), Support(8.0, stiffness=4.0e6))
    segment = beam(supports=supports)
    fine = frequencies(elements(segment))[:3]
    errors = []
    for count in (8, 24, 48):
        model = kantorovich_bending(segment, count, "complete", rotary_inertia=False)
        for x, order in ((3.0, 0), (3.0, 1), (5.0, 0)):
            assert np.abs(model.at(x, order)).max() < 1e-7 * np.abs(model.at(6.5)).max()
        errors.append((frequencies(model)[:3] / fine - 1.0).max())
    assert errors[0] < 7e-3
    assert errors[2] < 4e-5
    assert np.log2(errors[1] / errors[2]) == pytest.approx(3.0, abs=0.2)


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
    # The tip falls onto it and is thrown back: 55 kg/m by 1 m/s² in reverse.
    falling = replace(system, load=-system.load)
    run = AdaptiveStep()(Motion(falling, 0.3))
    assert run.data["tip"].min() < -5.0e-3
    assert run.data["tip"].min() > -6.0e-3
    assert run.data["contact_force"].sel(station=19.0).min() < -1.0e3
    assert run.data["contact_force"].sel(station=19.0).max() == 0.0
