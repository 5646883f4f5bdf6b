# SPDX-License-Identifier: LGPL-3.0-or-later
"""Refinements of a regular motion, and the orders that they show."""

from __future__ import annotations

import numpy as np
import pytest

from runs.case.schema import Case
from runs.studies.model_ladder import LADDER
from runs.studies.motions import friction_case
from runs.studies.refinement import Refinement, refine, with_step


@pytest.fixture
def case() -> Case:
    """The first press of the paper's example with friction."""
    long = friction_case()
    time = long.time.model_copy(update={"duration": 0.6})
    return long.model_copy(update={"time": time})


def test_orders_are_those_of_a_power_law() -> None:
    """Reference: analytic, errors of 3 h²."""
    sizes = np.array([0.4, 0.2, 0.1, 0.05])
    errors = 3.0 * sizes**2
    found = Refinement("", sizes.tolist(), "m", np.abs(np.diff(errors)).tolist(), [0.1] * 4)
    assert found.orders == pytest.approx([2.0, 2.0])


def test_a_finer_step_settles_with_the_splitting_s_order(case: Case) -> None:
    """Reference: analytic. The splitting is of second order, with friction too."""
    model = next(model for model in case.models if model.name == "kantorovich-5-linear")
    found = refine(case, "step", model, [4e-5, 2e-5, 1e-5, 5e-6], "s", with_step)
    assert found.differences[0] < 1e-3
    assert np.mean(found.orders) == pytest.approx(2.0, abs=0.4)
    assert [row[0] for row in found.rows] == ["kantorovich-5-linear: step (s)"] * 4
    assert found.rows[-1][2] is None


def test_the_ladder_has_its_models(case: Case) -> None:
    names = [model.name for model in case.models]
    assert [name for _, name in LADDER] == names
