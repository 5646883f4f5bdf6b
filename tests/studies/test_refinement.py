# SPDX-License-Identifier: LGPL-3.0-or-later
"""Refinements of a regular motion, the orders that they show, and a closed form of loads."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from dynamics.excitation import PiecewiseLinear
from runs.case.schema import Case
from studies.histories import response
from studies.model_ladder import LADDER
from studies.motions import friction_case, lasting, model_of
from studies.refinement import orders, refine, with_step


@pytest.fixture
def case() -> Case:
    """Return the first contact of the paper's example with friction."""
    return lasting(friction_case(), 0.6)


def test_orders_are_those_of_a_power_law() -> None:
    """Reference: analytic, errors of 3 h²."""
    sizes = np.array([0.4, 0.2, 0.1, 0.05])
    assert orders(sizes, np.abs(np.diff(3.0 * sizes**2))) == pytest.approx([2.0, 2.0])


def test_a_finer_step_settles_with_its_order(case: Case) -> None:
    """Reference: analytic. The time step is of second order but where a joint begins to stick or
    to slip within a step, of the first there.
    """
    model = model_of(case, "kantorovich-5-linear")
    rows = refine(case, "step", model, [3.2e-4, 2e-5, 1.25e-6], with_step)
    names, _, apart, found, _ = zip(*rows, strict=True)
    assert set(names) == {"step"}
    assert apart[0] < 0.05
    assert (found[0], found[-1], apart[-1]) == (None, None, None)
    assert 0.7 < found[1] < 2.4


def test_the_ladder_has_its_models(case: Case) -> None:
    names = [model.name for model in case.models]
    assert [name for _, name in LADDER] == names


@pytest.mark.parametrize("omega", [0.0, 3.0])
def test_the_closed_form_is_duhamel_s_integral(omega: float) -> None:
    """Reference: other code, scipy's quadrature of ∫ g(s) sin(ω (t − s))/ω ds."""
    table = PiecewiseLinear((0.2, 0.5, 1.1), (0.4, -1.0, 2.0))
    (found,) = response(omega, table, np.array([1.7]))
    expected, _ = quad(
        lambda s: float(table(np.array(s))) * (1.7 - s) * np.sinc(omega * (1.7 - s) / np.pi),
        0.0,
        1.7,
        points=[0.2, 0.5, 1.1],
    )
    assert found == pytest.approx(expected, rel=1e-10)
