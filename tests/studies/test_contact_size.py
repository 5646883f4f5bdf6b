# SPDX-License-Identifier: LGPL-3.0-or-later
"""A corner and a pad on coarse meshes."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from studies.contact_size import Sizes, study

pytestmark = pytest.mark.slow


TINY = Sizes(
    meshes=(8.0, 4.0, 2.0),
    default=4.0,
    lengths=(0.1,),
    pads=((0.2, 0.06),),
    plate=(0.0125,),
    loads=(10.0,),
)


def test_pads_beside_the_webs_give_way_more() -> None:
    """Reference: other code, plate theory for the wall; a flange that bends is ten times softer
    than a corner, on any mesh, and the boom's first peak is higher for it.
    """
    told: list[str] = []
    found = study(told.append, TINY)
    corner, pad = "corner of 0.1 m", "pad of 0.2 m x 0.06 m"
    assert told == ["plates", "support", corner, pad]
    meshes = found.data["local-compliance"]
    local = np.array([[row[f"edges × {part:g}"] for part in TINY.meshes] for row in meshes])
    of_support, of_corner, of_pad = local[0], local[1:3], local[3:]
    assert of_support[-1] == pytest.approx(of_support[-2], rel=0.01)
    assert of_corner.shape == (2, 3)
    assert (np.diff(of_corner, axis=1) > 0.0).all()
    assert (of_pad > 10.0 * of_corner).all()
    peaks = [row["first tip peak\nload × 10 (mm)"] for row in found.data["contact-size"]]
    assert 350.0 < peaks[0] < 0.8 * peaks[1]
    plates = [proof for proof in found.proofs if "plate" in proof.what]
    assert len(plates) == 2
    assert all(proof.holds for proof in plates)
