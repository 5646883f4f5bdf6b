# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tapered beams: frequencies, shear, mass, axial weights and twist against the cone."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from protractile.beam_model.boom_modes import critical_factor
from protractile.beam_model.component import SegmentModel
from protractile.beam_model.elements import Theory
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segments, rigid_segment
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.excitation import Step
from protractile.geometry.axial import with_compression
from protractile.geometry.boom import Boom, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.load import Load
from protractile.runs.case.kinds.finite_element import BeamElements
from studies import taper
from studies.reference_models.statics import static_response
from tests.beam_model.exact import STEEL
from tests.beam_model.test_beams import THEORIES

ROOT = BoxSection(height=0.8, width=0.5, flange=0.02, web=0.012)
HEAD = BoxSection(height=0.3, width=0.35, flange=0.01, web=0.008)
CLAMP = Support(0.0, "clamped")
LENGTH = BeamElements(name="beam", kind="finite-element").element_length


def arm(*supports: Support) -> Segment:
    others = {"head_section": HEAD, "supports": supports or (CLAMP,)}
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

    system = gap_system(boom, default_elements(boom, "timoshenko"))
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
    segment = arm(Support(0.0, stiffness=1e6), Support(8.0, stiffness=1e6))
    felt = Load(0, "z", segment.mass_per_length, None, Step(), inertial=True)
    boom = Boom((segment,), (), (felt,))
    for models in (
        default_elements(boom, "timoshenko"),
        kantorovich_segments(boom, [10], "complete", rotary_inertia=True),
        [rigid_segment(segment)],
    ):
        system = gap_system(boom, models)
        resting = static_response(system, system.excitations[0].load)
        # 1 m/s² on springs of 1e6 N/m: the tip's carries m g x_m/8.
        tip = system.observers["tip"].row @ resting
        assert tip == pytest.approx(1e-6 * mass * middle / 8.0, rel=1e-5)


def test_axial_weights_follow_the_taper() -> None:
    """Reference: by hand. The foot carries the whole upright boom, the midpoint the upper half."""
    (pressed,) = with_compression([arm()], [], [], gravity=10.0)
    upper = 4.0 * (BoxSection(0.55, 0.425, 0.015, 0.01).area + HEAD.area) / 6.0
    upper += 4.0 * 4.0 * BoxSection(0.425, 0.3875, 0.0125, 0.009).area / 6.0
    places = pressed.compression(np.array([1e-12, 4.0]))
    assert places[0] == pytest.approx(10.0 * 8.0 * pressed.mass_per_length, rel=1e-9)
    assert places[1] == pytest.approx(7850.0 * 10.0 * upper, rel=1e-9)


def test_twist_follows_the_local_constant() -> None:
    """Reference: analytic, ∫ dx/(G J_t) under 1 N m at the free end, in series and elements."""
    soft, _ = quad(lambda x: 1.0 / (STEEL.shear_modulus * local(x).torsion_constant), 0.0, 8.0)
    boom = Boom((arm(),), ())
    for models in (
        default_elements(boom, "timoshenko"),
        kantorovich_segments(boom, [12], "complete", rotary_inertia=True),
    ):
        twist = models[0].components["twist"]
        row = twist.at(8.0)
        # A linear element has the stiffness of its middle: 1e-4 of the whole.
        assert row @ np.linalg.solve(twist.stiffness, row) == pytest.approx(soft, rel=1e-5)
