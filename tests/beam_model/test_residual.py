# SPDX-License-Identifier: LGPL-3.0-or-later
"""Springs for the compliance that a coarse model lacks."""

from dataclasses import replace

import numpy as np
import pytest

from beam_model.calibration import elastic_compliance, residual_compliance, with_springs
from tests.beam_model.test_section_fields import MODES, system


def test_springs_add_the_compliance_of_the_fine_model() -> None:
    """Reference: analytic, the static compliance of the fine model."""
    fine, coarse = system(), system(12)
    residual = residual_compliance(coarse, fine)
    sprung = with_springs(coarse, residual)
    assert np.linalg.norm(residual) > 5e-4 * np.linalg.norm(elastic_compliance(fine))
    np.testing.assert_allclose(elastic_compliance(sprung), elastic_compliance(fine), rtol=1e-10)
    # Nothing else feels them.
    assert not sprung.load[12:].any()
    assert not sprung.observers["tip"].row[12:].any()


def test_negative_residual_compliance_is_left_out() -> None:
    """Reference: analytic, D = g gᵀ − h hᵀ has the positive part g gᵀ for orthogonal g and h."""
    coarse = system(12)
    g, h = np.array([1.0, 1.0, 1.0]) * 1e-9, np.array([1.0, -1.0, 0.0]) * 1e-10
    residual = np.outer(g, g) - np.outer(h, h)
    equal = residual / np.sqrt(np.outer(np.diag(residual), np.diag(residual)))
    assert np.linalg.eigvalsh(equal)[0] < -1e-3
    sprung = with_springs(coarse, residual)
    assert sprung.num_modes == 13
    spring = np.concatenate([sprung.rows[:, 12], sprung.friction_rows[:, 12]]) / sprung.omega[12]
    # To the part of h in g: both are as large in the first two places.
    np.testing.assert_allclose(np.outer(spring, spring), np.outer(g, g), rtol=0.02)


def test_models_must_touch_in_the_same_places() -> None:
    fine = replace(system(), friction_rows=np.zeros((0, MODES)), frictions=())
    with pytest.raises(
        ValueError, match="both models must have the same contact rows, friction rows and dashpots"
    ):
        residual_compliance(system(12), fine)
