# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beams calibrated by the compliances of a shell or of another beam."""

from dataclasses import replace

import numpy as np
import pytest

from beam_model.calibration import effective_stiffness, with_stiffness
from beam_model.finite_element import finite_element_segment
from geometry.boom import Material, Segment, Support
from geometry.probe_responses import PROBE_FREQUENCY, ProbedMotion, ProbeResponses
from geometry.section import BoxSection

STEEL = Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
BOX = BoxSection(height=0.4, width=0.3, flange=0.008, web=0.006)
PLACES = (0.0, 1.0, 10.0)


def box(*supports: Support) -> Segment:
    return Segment.of_section("box", 0.0, 10.0, STEEL, BOX, supports=supports)


def probed(segment: Segment) -> ProbeResponses:
    """Return a beam's own responses, with finer elements."""
    found: dict[ProbedMotion, np.ndarray[tuple[int, int], np.dtype[np.float64]]] = {}
    model = finite_element_segment(segment, 0.2, PLACES, "timoshenko", True)
    for motion, component in model.components.items():
        rows = [component.at(x) for x in PLACES]
        if motion != "twist":
            rows += [component.rotation_at(x) for x in (PLACES[0], PLACES[-1])]
        sigma = (2.0 * np.pi * PROBE_FREQUENCY) ** 2
        probes = np.array(rows)
        solved = np.linalg.solve(component.stiffness + sigma * component.mass, probes.T)
        found[motion] = probes @ solved
    return ProbeResponses(PLACES, found)


@pytest.mark.parametrize(
    "supports", [(), (Support(0.0), Support(1.0)), (Support(0.0, "clamped"),), (Support(0.0),)]
)
def test_a_beam_finds_its_own_stiffness(supports: tuple[Support, ...]) -> None:
    """Reference: analytic, the stiffness of the beam that answers; off by 3 % each."""
    segment = box(*supports)
    lateral = segment.lateral
    assert lateral is not None
    assert segment.shear_stiffness is not None
    sideways = segment.turned().shear_stiffness
    assert sideways is not None
    true = replace(
        segment,
        second_moment_of_area=1.03 * segment.second_moment_of_area,
        shear_stiffnesses=(0.8 * segment.shear_stiffness, 1.2 * sideways),
        lateral=replace(
            lateral,
            second_moment_of_area=0.97 * lateral.second_moment_of_area,
            torsion_constant=0.9 * lateral.torsion_constant,
        ),
    )
    found = effective_stiffness(segment, probed(true))
    # What weighs so that the stiffness stays near the plates' moves it by less than this.
    assert found.bending == pytest.approx(
        (true.bending_stiffness, true.turned().bending_stiffness), rel=2e-4
    )
    assert found.shear == pytest.approx(true.shear_stiffnesses, rel=5e-3)
    assert found.torsion == pytest.approx(
        0.9 * STEEL.shear_modulus * lateral.torsion_constant, rel=2e-4
    )
    taken = with_stiffness(segment, found)
    assert taken.bending_stiffness == pytest.approx(found.bending[0], rel=1e-12)
    assert taken.turned().shear_stiffness == pytest.approx(found.shear[1], rel=1e-12)
