# SPDX-License-Identifier: LGPL-3.0-or-later
"""The study of stresses on three coarse meshes."""

from __future__ import annotations

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from runs.case.build import build_boom
from studies.motions import friction_case
from studies.stress import Sizes, contact_forces, study

TINY = Sizes(meshes=(0.2, 0.1, 0.05), default=0.1, places=(14.0,))


def test_contact_forces_hold_the_segment() -> None:
    """Reference: analytic. 550.7 N of lift at 14 m on levers of 4 and 5 m."""
    forces = contact_forces(build_boom(friction_case()))
    assert {x: side for x, (side, _) in forces.items()} == {9.0: -1, 10.0: 1}
    assert forces[10.0][1] == pytest.approx(5.0 * 550.7)
    assert forces[9.0][1] == pytest.approx(4.0 * 550.7)


@pytest.mark.slow
def test_the_contact_has_no_stress_of_its_own_and_a_patch_has() -> None:
    """Reference: analytic away from contacts; near them the refinement itself. Half the mesh
    would double the stress of the nearest triangle beside a force at a point; beside one along a
    length it still grows.
    """
    found = study(lambda what: None, TINY)
    assert all(proof.holds for proof in found.proofs)
    beam = next(proof for proof in found.proofs if "top at 14 m" in proof.what)
    assert beam.error < 2.0e-3
    near = {what: values for what, (_, values) in found.plots[0].curves.items()}
    for x in (9, 10):
        triangle, patch = near[f"largest triangle at {x} m"], near[f"largest patch at {x} m"]
        assert 1.2 < triangle[2] / triangle[1] < 1.7
        assert patch[2] == pytest.approx(patch[1], rel=0.03)
