# SPDX-License-Identifier: LGPL-3.0-or-later
"""The shell's error against a solid, on coarse meshes of thick walls."""

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the study needs DOLFINx")

from studies.refined import Refined
from studies.solid import (
    COMPLIANCES,
    EVERY,
    FREQUENCIES,
    Comparison,
    Sizes,
    compare,
    error_table,
    order,
    refinements,
    shell_proofs,
    slenderness_at,
    solid_proofs,
)

TINY = Sizes(
    walls=(0.04,), triangles=(0.2, 0.1, 0.05), splits=(1, 2, 4), along=(0.1, 0.5), around=0.3
)


def comparison(wall: float, error: float) -> Comparison:
    """One in which every quantity has the same error."""
    return Comparison(
        wall,
        *(
            {what: Refined(what.what, what.unit, [4.0, 2.0, 1.0], [value] * 3) for what in EVERY}
            for value in (1.0 + error, 1.0)
        ),
    )


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


@pytest.mark.slow
def test_thick_walls_have_stiffer_corners_than_a_shell() -> None:
    """Reference: other code, elasticity in space.

    Every frequency of the shell is lower and every compliance higher than the solid's.
    """
    told: list[str] = []
    (found,) = compare(TINY, told.append)
    assert told == ["walls of 40 mm"]
    for frequency in FREQUENCIES:
        assert -0.06 < found.error(frequency) < -0.005
    for compliance in COMPLIANCES:
        assert found.error(compliance) > 0.02
    assert found.error(COMPLIANCES[0]) == pytest.approx(0.027, abs=0.006)
    assert found.slenderness(COMPLIANCES[0]) == pytest.approx(0.04 / 0.30)


@pytest.mark.slow
def test_the_solid_stands_by_itself() -> None:
    """Reference: analytic. The rod's lateral inertia is twice what its frequency may err by."""
    proofs = {proof.what: proof for proof in solid_proofs()}
    assert all(proof.holds for proof in proofs.values())
    rod = proofs["solid box: lowest frequency as a rod"]
    without = 0.5 * np.sqrt(2.1e11 / 7850.0) / 2.0
    assert rod.allowed < 0.5 * (without / rod.reference - 1.0)


def test_tables_and_proofs_have_every_quantity() -> None:
    found = [comparison(0.005, 0.004), comparison(0.01, -0.02)]
    errors = error_table(found)
    assert [row[0] for row in errors.rows] == [one.what for one in EVERY]
    assert errors.rows[0][1:3] == ("0.40", "−2.00")
    assert len(refinements(found).data) == 4 * len(EVERY)
    proofs = list(shell_proofs(found[0]))
    assert all(proof.holds for proof in proofs)
    assert [proof.error for proof in proofs] == pytest.approx([0.004] * len(EVERY))
