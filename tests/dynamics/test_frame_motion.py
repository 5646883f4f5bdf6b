# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slewing and luffing: accelerations of the turning frame, motion laws and their derivatives."""

from typing import Literal

import numpy as np
import pytest

from dynamics.arrays import Array
from dynamics.excitation import (
    HistorySum,
    MotionLaw,
    PiecewiseLinear,
    SCurve,
    Shaped,
    Spline,
    Stroke,
)
from dynamics.frame_motion import FrameAcceleration, FrameMotion

LAWS: list[MotionLaw] = [
    SCurve(30.0, 2.0, 0.3),
    Stroke(30.0, 12.0, 0.8, 0.2),
    HistorySum((SCurve(30.0, 2.0), Stroke(-10.0, 5.0, 1.0))),
    Spline((0.1, 0.9, 2.0, 2.6), (0.0, 3.0, -2.0, 7.0)),
    Shaped(Stroke(30.0, 12.0, 0.8, 0.2), 1.7, 0.1),
]
TIME = np.linspace(0.013, 3.013, 61)


@pytest.mark.parametrize("law", LAWS)
def test_rates(law: MotionLaw) -> None:
    """Reference: central differences."""
    h = 1.0e-4
    # Differences across a jump of the second derivative are no reference.
    time = TIME[np.abs(np.subtract.outer(TIME, np.array(law.kinks))).min(axis=1) > h]
    before, now, after = (law(time + shift) for shift in (-h, 0.0, h))
    assert law.rate(time, 1) == pytest.approx((after - before) / (2.0 * h), abs=1e-5)
    assert law.rate(time, 2) == pytest.approx((after - 2.0 * now + before) / h**2, abs=1e-4)


def test_rates_of_a_table() -> None:
    law = PiecewiseLinear((0.0, 1.0, 3.0), (0.0, 2.0, 1.0))
    assert law.rate(np.array([0.5, 2.0, 4.0]), 1).tolist() == [2.0, -0.5, 0.0]
    assert not law.rate(np.array([0.5, 2.0, 4.0]), 2).any()


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ((0.0,), "frequency must be finite and positive, got 0.0 Hz"),
        ((1.0, 1.0), "damping must be at least 0 and below 1, got 1.0"),
    ],
)
def test_numbers_of_no_shaper(numbers: tuple[float, ...], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Shaped(SCurve(1.0, 1.0), *numbers)


def position(frame: FrameMotion, time: Array, x: float, extension: MotionLaw) -> Array:
    """Return the place (3, ...) of a point of the boom in axes that stand still."""
    out, up = frame.position(time, x, extension)
    slew = frame.slew_angle(time)
    return np.array([out * np.cos(slew), out * np.sin(slew), up])


def test_accelerations() -> None:
    """Reference: second differences of the place in fixed axes, turned by both angles and
    extended."""
    frame = FrameMotion(LAWS[0], LAWS[1], 35.0, foot=0.5, radius=-1.2)
    extension, x, h = SCurve(2.0, 2.5), 9.0, 1.0e-4
    time = TIME[np.abs(np.subtract.outer(TIME, np.array(LAWS[1].kinks))).min(axis=1) > h]
    places = [position(frame, time + shift, x, extension) for shift in (-h, 0.0, h)]
    one, two, three = (places[2] - 2.0 * places[1] + places[0]) / h**2
    slew, luff = frame.slew_angle(time), frame.luff_angle(time)
    out = one * np.cos(slew) + two * np.sin(slew)
    sideways = two * np.cos(slew) - one * np.sin(slew)
    expected = [
        out * np.cos(luff) + three * np.sin(luff), sideways,
        three * np.cos(luff) - out * np.sin(luff),
    ]  # fmt: skip
    assert frame.accelerations(time, x, extension) == pytest.approx(np.array(expected), abs=1e-5)


def test_weight_components_while_luffing() -> None:
    """Reference: analytic, g cos α across and g sin α along the boom, less those at t = 0."""
    frame = FrameMotion(luff=SCurve(50.0, 1.0), angle=20.0, gravity=10.0)
    end = np.array([2.0])
    parts: tuple[tuple[Literal["x", "z"], np.ufunc], ...] = ("x", np.sin), ("z", np.cos)
    for direction, function in parts:
        change = 10.0 * (function(np.deg2rad(70.0)) - function(np.deg2rad(20.0)))
        history = FrameAcceleration(frame, direction, 3.0)
        assert history(end) == pytest.approx(change)
        assert not history(np.zeros(1)).any()
