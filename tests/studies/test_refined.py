# SPDX-License-Identifier: LGPL-3.0-or-later
"""Order, limit and index of three grids; closed forms and models of other studies."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from scipy.integrate import quad

from dynamics.excitation import PiecewiseLinear
from studies.histories import response
from studies.refined import Reference, Refined, refined_table


def refined(values: Sequence[float], ratio: float = 2.0) -> Refined:
    sizes = [ratio ** (len(values) - i) for i in range(len(values))]
    return Refined("pressure", "", sizes, values)


def test_the_published_example() -> None:
    """Reference: external, NPARC Alliance's tutorial on spatial convergence: pressure recoveries
    0.96178, 0.96854, 0.97050 on grids that halve.
    """
    found = refined([0.96178, 0.96854, 0.97050])
    assert found.order == pytest.approx(1.7862, abs=1.0e-4)
    assert found.limit == found.best == pytest.approx(0.97130, abs=1.0e-5)
    assert 100.0 * found.index == pytest.approx(0.1031, abs=1.0e-4)


def test_a_power_law_is_told_exactly() -> None:
    """Reference: analytic, 2 + 3 h^1.5 at h = 0.9, 0.3, 0.1."""
    found = refined([2.0 + 3.0 * h**1.5 for h in (2.7, 0.9, 0.3, 0.1)], ratio=3.0)
    assert found.order == pytest.approx(1.5, rel=1.0e-12)
    assert found.limit == pytest.approx(2.0, rel=1.0e-12)
    assert found.index == pytest.approx(1.25 * 3.0 * 0.1**1.5 / (2.0 + 3.0 * 0.1**1.5))
    coarse = found.against_limit("p", found.sizes[0], "finest", 0.01)
    assert (coarse.value, coarse.reference, coarse.order) == (
        found.values[0], found.limit, found.order,
    )  # fmt: skip
    assert coarse.source.startswith("limit of its refinement")


@pytest.mark.parametrize("values", [(1.0, 2.0, 1.5), (1.0, 1.1, 1.3), (1.0, 1.0, 1.0), (1.0, 1.1)])
def test_no_order_without_convergence(values: tuple[float, ...]) -> None:
    """Values that go back and forth, part, or stand still have no order, and so no limit."""
    found = refined(values)
    assert math.isnan(found.order)
    assert math.isnan(found.limit)
    assert math.isnan(found.index)
    assert found.best == values[-1]
    assert found.against_limit("p", found.sizes[0], "finest", 0.01).source == "finest"
    with pytest.raises(ValueError, match=r"^p: the finest mesh would be held against itself$"):
        found.against_limit("p", found.sizes[-1], "finest", 0.01)


def test_a_slow_order_leads_nowhere() -> None:
    """Reference: analytic, steps that fall to nine tenths are of order 0.15."""
    found = refined([2.0, 1.9, 1.81])
    assert found.order == pytest.approx(0.152, abs=1.0e-3)
    assert found.best == 1.81


def test_the_finest_is_held_against_its_reference() -> None:
    short = Refined("p", "m", [2.0, 1.0], [1.2, 1.1], Reference(1.0, "external", "known", 0.2))
    assert short.errors == pytest.approx([0.2, 0.1])
    assert short.proof.holds
    assert short.proof.order is None
    long = Refined("q", "", [4.0, 2.0, 1.0], [1.4, 1.2, 1.1])
    first, second = refined_table("t", "T", [short, long], "h = {:g}").data
    assert (first["quantity"], first["h = 4"], first["h = 2"]) == ("p (m)", None, 1.2)
    assert (second["h = 4"], second["order"]) == (1.4, pytest.approx(1.0))


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
