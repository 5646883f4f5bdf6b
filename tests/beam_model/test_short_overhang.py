# SPDX-License-Identifier: LGPL-3.0-or-later
"""Very short elements beside a station: round-off must not spoil the lowest modes."""

import numpy as np
import pytest

import protractile as pt
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.equilibrium import equilibrium
from protractile.geometry.load import Load

STEEL = pt.Material(2.1e11, 0.3, 7850.0)
SOFT = pt.Material(1.0e9, 0.3, 500.0)
FORCE, LENGTH, OVERLAP = 1000.0, 10.0, 1.5


@pytest.mark.parametrize("bonded", [True, False])
@pytest.mark.parametrize("past", [1e-4, 5e-4, 2e-3, 1e-2])
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
    assert np.isfinite(system.omega2).all()
    assert (system.omega2 >= 0.0).all()
