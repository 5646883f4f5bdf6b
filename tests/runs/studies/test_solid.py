# SPDX-License-Identifier: LGPL-3.0-or-later
"""The shell's error against a solid, on coarse meshes of two thick walls."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the study needs DOLFINx")

from runs.studies.solid import (
    COMPLIANCES,
    FREQUENCIES,
    Comparison,
    Sizes,
    Values,
    order,
    slenderness_at,
    study,
)

TINY = Sizes(walls=(0.02, 0.04), triangles=(0.2, 0.1, 0.05), edges=(1, 2, 4), along=(0.1, 0.5))


def comparison(wall: float, error: float) -> Comparison:
    """One in which every quantity has the same error."""
    measured = FREQUENCIES + COMPLIANCES
    still = cast(Any, SimpleNamespace())
    return Comparison(
        wall,
        {what: Values([1.0 + error] * 3) for what in measured},
        {what: Values([1.0] * 3) for what in measured},
        (still, still),
    )


@pytest.mark.quick
def test_order_and_passed_limits_are_those_of_a_power_law() -> None:
    """Reference: analytic, errors of 3 (t/b)^1.5 of a box 0.3 m wide."""
    head = COMPLIANCES[0]
    found = [comparison(t, 3.0 * (t / 0.3) ** 1.5) for t in (0.005, 0.01, 0.02)]
    assert order(found, head) == pytest.approx(1.5, rel=1.0e-9)
    for limit in (0.01, 0.02, 0.05):
        at = (limit / 3.0) ** (2.0 / 3.0)
        assert slenderness_at(found, head, limit) == f"{at:.3f}"
    assert slenderness_at(found, head, 0.2) == "> 0.067"
    assert slenderness_at(found, head, 0.001) == "< 0.017"
    assert np.isnan(order([comparison(0.01, -0.01), comparison(0.02, 0.01)], head))


@pytest.mark.quick
def test_a_value_goes_on_to_its_limit_if_it_has_one() -> None:
    """Reference: analytic, 2 + 3 h² at h = 0.4, 0.2, 0.1; then values that do not settle."""
    settling = Values([2.0 + 3.0 * h**2 for h in (0.4, 0.2, 0.1)])
    assert settling.limit == pytest.approx(2.0, rel=1.0e-12)
    assert Values([2.0, 1.0, 1.5]).limit == 1.5
    assert Values([2.0, 1.9, 1.81]).limit == 1.81


def test_thick_walls_have_stiffer_corners_than_a_shell() -> None:
    """Reference: other code, elasticity in space.

    Every frequency of the shell is lower and every compliance higher than the solid's, the more so
    the thicker the walls; the blow differs by less.
    """
    told: list[str] = []
    found = study(told.append, TINY)
    assert told == ["the solid against formulas", "walls of 20 mm", "walls of 40 mm"]
    errors = {one["what"]: one["errors"] for one in found.data["quantities"]}
    for one in FREQUENCIES:
        assert -0.06 < errors[one.what][1] < -0.005
    for one in COMPLIANCES:
        assert errors[one.what][1] > 0.02
    along, head = errors[FREQUENCIES[3].what], errors[COMPLIANCES[0].what]
    assert head[1] == pytest.approx(0.028, abs=0.006)
    assert 1.5 < head[1] / head[0] < 4.0
    assert 1.5 < along[1] / along[0] < 4.0
    for values in found.data["blows"][1].values():
        assert values[0] == pytest.approx(values[1], rel=0.03)
    proofs = {proof.what: proof for proof in found.proofs}
    for what in ("mass", "stiffness against stretching", "stiffness against pure bending"):
        assert proofs[f"solid box: {what}"].holds
    rod = proofs["solid box: lowest frequency as a rod"]
    assert rod.holds
    euler = 0.5 * np.sqrt(2.1e11 / 7850.0) / 2.0
    assert rod.allowed < 0.5 * (euler / rod.reference - 1.0)  # less than what is tested
