# SPDX-License-Identifier: LGPL-3.0-or-later
"""The card of a calibrated beam."""

import numpy as np
import pytest

from protractile.beam_model.calibration import Calibration, Stiffness
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.geometry.section import EACH_SIDE
from protractile.runs.case.build import build_boom
from protractile.runs.pipeline.model_run import calibration_card
from studies.motions import friction_case
from tests.touching import touching


def test_card_has_stiffness_and_springs() -> None:
    """Reference: analytic, 1/D of a diagonal residual compliance, and given factors."""
    boom = build_boom(friction_case())
    law = PowerContact(1.0e9, 1.0).with_clearance(0.007)
    system = gap_system(
        touching(boom, law, ()), finite_element_segments(boom, 2.0, "timoshenko", True), EACH_SIDE
    )
    assert len(system.laws) == 4
    residual = np.diag([2.0e-9, 4.0e-9, 5.0e-9, -1.0e-12, 1.0e-9, 1.0e-9])
    stiffness = [
        Stiffness((1.01 * one.bending_stiffness,), (0.9 * (one.shear_stiffness or 0.0),))
        for one in boom.segments
    ]
    told = calibration_card(boom, system, Calibration(stiffness, residual))
    assert [(spring.x, spring.side) for spring in told.springs] == [
        (9.0, "top"),
        (9.0, "bottom"),
        (10.0, "top"),
        (10.0, "bottom"),
    ]
    springs = [spring.stiffness for spring in told.springs]
    assert springs[:3] == pytest.approx([5.0e8, 2.5e8, 2.0e8], rel=1e-12)
    assert springs[3] is None
    for one in told.segments:
        assert one.bending_part == pytest.approx([1.01], rel=1e-12)
        assert one.shear_part == pytest.approx([0.9], rel=1e-12)
        assert one.torsion is None
