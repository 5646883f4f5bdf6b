# SPDX-License-Identifier: LGPL-3.0-or-later
"""Statics and modes of a boom from Python, without a case file."""

from typing import Any

import numpy as np
import pytest

import protractile as pt
from protractile.analysis.rows import REST
from tests.booms import cantilever, force, telescope

ARM = cantilever(force("arm", 8.0, -5.0e3))


def test_a_motion_is_evaluated_as_a_run_of_a_case() -> None:
    """Reference: other code path, the tip of the trajectory and the deflection at rest."""
    gust = force("fly", 14.0, -500.0, history=pt.Ramp(0.1))
    beam = pt.BeamElements(pt.with_weight(telescope(gust), angle=30.0), theory="timoshenko")
    motion = beam.simulate(0.3)
    rows, curves = beam.evaluate(motion)
    (moved,) = rows.where(quantity="tip", state="motion")
    tips = motion.data["tip"].values
    assert abs(moved.value) == np.abs(tips).max()
    assert moved.value == tips[np.isclose(motion.time, moved.time)][0]
    (rest,) = rows.where(quantity="tip", state=REST)
    assert rows.dynamic_factor(moved) == abs(moved.value) / abs(rest.value)
    names = {curve.state for curve in curves}
    assert {REST, "minimum", "maximum", "mode 1"} <= names


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"requested": ["yeild"]}, "'yeild' is no kind of proof by beams; give 'yield', 'plate'"),
        ({"requested": ["patch"]}, "'patch' is no kind of proof by beams"),
        ({"permitted_tip": 0.0}, "permitted_tip: must be a number above 0"),
        ({"resistance": pt.Resistance(pad=-1.0)}, "resistance.pad: must be a number above 0"),
    ],
)
def test_a_wrong_request_is_an_error(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(pt.BoomError, match=message):
        pt.prove(ARM, {"own": []}, **wrong)


def test_the_combination_without_an_equilibrium_is_named() -> None:
    """Reference: analytic, about 50 times the buckling force of a cantilever (Euler 1744)."""
    with pytest.raises(pt.NumericsError, match="far: the boom has no static equilibrium"):
        pt.prove(cantilever(*ARM.loads, thrust=1e8), {"far": []})


def test_plates_that_bend_leave_the_force_to_pads_at_corners() -> None:
    """Reference: by hand, E A/t of the pads at the corner, which carry the whole force.

    The pads away from the corners would have to bend the plates by more than those at the corners
    are pressed in. Shares as the pads are stiff would be 1 to 2.
    """
    pads = tuple(
        pt.SlidePad(
            side=side, length=length, width=0.03, thickness=0.02, modulus=2e9, bears="wall",
            offset=offset,
        )
        for side, length, offset in (
            ("above", 0.1, 0.0), ("below", 0.1, 0.0), ("below", 0.2, 0.04),
        )
    )  # fmt: skip
    padded = telescope(force("fly", 14.0, -1000.0), joint__pad=None, joint__pads=pads)
    rows = pt.statics(padded).rows.where(state=REST)
    whole, pressed, corner, beside = (
        rows.where(quantity=quantity, place=f"station 2{name}")[0].value
        for quantity, name in (
            ("contact_force", ""), ("penetration", ""),
            ("pad_force", ", below"), ("pad_force", ", below 2"),
        )
    )  # fmt: skip
    assert corner == pytest.approx(2e9 * 0.1 * 0.03 / 0.02 * pressed, rel=1e-6)
    assert [2.0 * corner, beside] == pytest.approx([abs(whole), 0.0], rel=1e-6)
