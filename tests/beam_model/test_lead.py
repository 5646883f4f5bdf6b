# SPDX-License-Identifier: LGPL-3.0-or-later
"""The lead of a hoist rope follows the boom: buckling and second-order deflection of a pole."""

from math import pi

import numpy as np
import pytest
from scipy.optimize import brentq

from protractile.beam_model.boom_modes import critical_factor
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.geometry.axial import Lead, Thrust, with_compression
from protractile.geometry.boom import Boom, BoomError, Material, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.load import Load

STEEL = Material(2.1e11, 0.3, 7850.0)
BOX = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
LENGTH = 10.0
STIFFNESS = STEEL.youngs_modulus * BOX.second_moment_of_area


def pole(force: float, winch: float, load: float = 0.0, count: int = 1) -> Boom:
    """Return a clamped pole with the lead of a rope; ``winch`` is its distance behind the foot."""
    clamp = (Support(0.0, "clamped"),) if count == 1 else ()
    whole = Segment.of_section("pole", 0.0, LENGTH, STEEL, BOX, supports=clamp)
    segments = with_compression([whole], [], [Thrust(0, LENGTH, force)])
    lead = Lead(0, LENGTH, force, -winch)
    return Boom(segments, (), (Load(0, "z", load, LENGTH, Step()),), leads=(lead,))


@pytest.mark.parametrize("winch", [0.0, 1.5, 40.0])
def test_pole_with_a_guided_rope_buckles_at_the_force_of_the_closed_form(winch: float) -> None:
    """Reference: analytic, tan k L = −k c for a force through a point c behind the clamped foot.

    Without c it is k L = π: four times the force of a dead load.
    """
    root = pi
    if winch:
        root = brentq(lambda k: np.sin(k) + k * winch / LENGTH * np.cos(k), 0.5 * pi + 1e-9, pi)
    expected = STIFFNESS * (root / LENGTH) ** 2
    boom = pole(1000.0, winch)
    models = finite_element_segments(boom, 0.25, "euler-bernoulli", False)
    factor = critical_factor(boom, models)
    assert factor is not None
    assert 1000.0 * factor == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("winch", [0.0, 2.0])
def test_deflected_pole_is_in_equilibrium_with_the_rope_that_follows_it(winch: float) -> None:
    """Reference: analytic, an own beam-column with a follower pair.

    From E J w″ = S (w_L − w) − V (L − x) with V = S w_L/(L + c) − F, it is
    w_L = F (tan λ − λ)/(k S) / (1 − (L − tan λ/k)/(L + c)), λ = k L.
    """
    force, load = 0.6 * STIFFNESS * (pi / LENGTH) ** 2, 500.0
    k = np.sqrt(force / STIFFNESS)
    tangent = np.tan(k * LENGTH)
    # Flexibility of the tip to a transverse force under a dead axial force, Timoshenko and Gere.
    flexibility = (tangent - k * LENGTH) / (k * force)
    expected = load * flexibility / (1.0 + flexibility * force / (LENGTH + winch))
    boom = pole(force, winch, load)
    system = gap_system(boom, finite_element_segments(boom, 0.25, "euler-bernoulli", False))
    loaded = system.gather_loads().at_time(0.0)
    tip = float(system.observers["tip"].row @ equilibrium(loaded, loaded.load_at(0.0)))
    assert tip == pytest.approx(expected, rel=1e-4)


def test_the_rope_holds_nothing() -> None:
    with pytest.raises(BoomError) as caught:
        pole(1000.0, 0.0, count=0)
    assert str(caught.value).startswith("segments[0]: nothing holds 'pole'")
