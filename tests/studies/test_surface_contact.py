# SPDX-License-Identifier: LGPL-3.0-or-later
"""Surface contact of the paper's boom on a coarse mesh."""

from __future__ import annotations

import pytest

from studies.surface_contact import Sizes, study

pytestmark = pytest.mark.slow


TINY = Sizes(
    mesh=0.5, duration=0.3, peak=0.9, penalties=(1.0, 10.0), points=((8, 4),), pads=((0.1, 0.06),)
)


def test_a_surface_is_softer_than_webs_on_webs() -> None:
    """Reference: sense, and what is proven by hand.

    The outer flange gives way beside its web, so the tip goes higher than near webs; a stiffer
    penalty lowers it. Forces of known approaches are their integrals.
    """
    told: list[str] = []
    found = study(told.append, TINY)
    assert "contact surface, 8 x 4 points" in told
    assert all(proof.holds for proof in found.proofs)
    assert len(found.proofs) == 6
    rubbed = "first tip peak\nwith friction (mm)"
    peaks = {row["contact"]: row[rubbed] for row in found.data["surface"]}
    assert peaks["near webs"] == pytest.approx(177.5, rel=0.01)
    assert 1.05 * peaks["near webs"] < peaks["surface, 8 x 4 points"]
    assert 1.15 * peaks["near webs"] < peaks["pads of 0.1 m x 0.06 m"]
    softer, stiffer = (peaks[f"surface, 8 x 4 points, {part} of the penalty"] for part in (1, 10))
    assert softer == pytest.approx(peaks["surface, 8 x 4 points"], rel=1.0e-9)
    assert peaks["near webs"] < stiffer < softer
    near, across, pad = (
        row["both flanges together\nat 9 m (m/N)"] for row in found.data["flexibility"]
    )
    assert near < pad < across
