# SPDX-License-Identifier: LGPL-3.0-or-later
"""Two points of the paper's boom on three coarse meshes."""

from __future__ import annotations

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from runs.studies.working_load import Point, Sizes, study

pytestmark = pytest.mark.slow


TINY = Sizes(
    meshes=(16.0, 8.0, 4.0),
    plays=(14.0e-3,),
    loads=(1.0, 10.0),
    pads=(),
    in_space=(Point(4.0e-3, 10.0),),
    duration=0.9,
    spatial_duration=0.3,
    peaks=1,
)


def test_a_mesh_errs_more_under_more_load() -> None:
    """Reference: other code, the finer mesh. Ten times the load goes deeper into the walls; one
    reduction serves both loads.
    """
    told: list[str] = []
    found = study(told.append, TINY)
    assert told == ["near webs", "in space"]
    light, heavy = found.data["points-near-webs"]
    assert (light["point"], heavy["point"]) == ("14 mm, load × 1", "14 mm, load × 10")
    change, force = "tip (% of range)", "largest pad force (kN)"
    assert 0.0 < light[change] < heavy[change] < 10.0
    assert heavy[force] > 3.0 * light[force]
    names = [proof.what for proof in found.proofs]
    assert names[1] == ("tip, part of its range, near webs, worst of 2 points (14 mm, load × 10)")
    assert found.proofs[1].value == pytest.approx(0.01 * heavy[change])
