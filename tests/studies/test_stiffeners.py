# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stiffeners act where they are, and as formulas say where there is one."""

from __future__ import annotations

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from studies.stiffeners import Sizes, study

pytestmark = pytest.mark.slow


TINY = Sizes(mesh=0.3, collars=(0.010,), diaphragms=(0.008,), frequencies=2, plate_mesh=0.05)


def test_stiffeners_act_where_they_are() -> None:
    """Reference: analytic, for a plate in pure shear, for a ring, and for the masses; elsewhere
    that a stiffener stiffens its own end of its segment, and leaves the other station as it was.
    """
    told: list[str] = []
    found = study(told.append, TINY)
    assert [line.split(":")[0] for line in told[:6]] == ["outer"] * 2 + ["inner"] * 4
    for proof in found.proofs:
        assert proof.holds, (proof.what, proof.error)
    assert [proof.unit for proof in found.proofs] == ["N m", "m²/N", "m²/N"]

    outer, collared, inner, banded, closed, both = found.data["variants"]
    mass, more = "mass (kg)", "one flange more (nm/N)"
    perimeter, opening = 2.0 * (0.488874 + 0.325916), 0.463596 * 0.270571
    assert collared[mass] - outer[mass] == pytest.approx(
        7850.0 * perimeter * 0.3 * 0.01, rel=1.0e-4
    )
    assert closed[mass] - inner[mass] == pytest.approx(7850.0 * opening * 0.008, rel=1.0e-3)
    for stiff, plain, there, elsewhere in (
        (collared, outer, "10 m", "9 m"),
        (banded, inner, "9 m", "10 m"),
        (closed, inner, "9 m", "10 m"),
    ):
        assert stiff[f"{there}: {more}"] < 0.6 * plain[f"{there}: {more}"]
        together = f"{there}: both flanges (nm/N)"
        assert stiff[together] < plain[together]
        other = f"{elsewhere}: {more}"
        assert stiff[other] == pytest.approx(plain[other], rel=0.05)
    tail = [one[f"9 m: {more}"] for one in (banded, closed, both)]
    assert tail[2] < min(tail[:2])
    # The head's mass lowers what bends as a whole.
    assert collared["f1 (Hz)"] < outer["f1 (Hz)"]
    assert [len(rows) for rows in found.data.values()] == [6, 6]
