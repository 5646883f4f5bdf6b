# SPDX-License-Identifier: LGPL-3.0-or-later
"""The study of the shell element on coarse meshes."""

from __future__ import annotations

import json

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from runs.studies.benchmarks import Sizes, study

pytestmark = pytest.mark.slow


TINY = Sizes(
    roof=(2, 4, 8),
    cylinder=(4, 8, 16),
    hemisphere=(4, 8, 16),
    twisted=(1, 2, 4),
    plate=(4, 8, 16),
    torsion=(1, 2),
    slenderness=8,
    box=0.5,
    frequencies=6,
)


def test_coarse_meshes_close_in() -> None:
    """Reference: external and analytic, as each row of the study names it."""
    found = study(lambda what: None, TINY)
    for plot in found.plots:
        for what, (_, errors) in plot.curves.items():
            assert errors[-1] < 0.5 * errors[0], what
    proofs = {proof.what: proof for proof in found.proofs}
    assert proofs["twisted, in plane, 4 edges"].error < 1.0e-3
    assert proofs["torsion constant, box 100 × 60 × 1 mm, 2 edges"].holds
    assert not proofs["hemisphere, 16 edges"].holds
    thin = proofs["thin plate, mode 1, 16 edges"]
    assert thin.order == pytest.approx(2.0, abs=0.3)
    exact = [proof for proof in found.proofs if "patch" in proof.what or "turned" in proof.what]
    assert len(exact) == 4
    assert all(proof.holds for proof in exact)
    spreads = [proof for proof in found.proofs if "drilling" in proof.what]
    assert len(spreads) == 3
    assert all(proof.error > 0.0 and proof.holds for proof in spreads)
    json.dumps(found.data, allow_nan=False)
    assert len(found.data["benchmarks"]) == 12
    assert len(found.data["drilling"]) == 15
