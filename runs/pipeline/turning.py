# SPDX-License-Identifier: LGPL-3.0-or-later
"""Descriptions of slewing and luffing, and the limits of their loads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from dynamics.excitation import MotionLaw
from runs.case.drive import resolving_times
from runs.case.schema import Case

if TYPE_CHECKING:
    import xarray as xr

# Part of the first circular frequency beyond which Coriolis forces of the boom matter.
_SLOW = 0.05

# Swing over the length of a pendulum beyond which its angle is not small.
_SMALL = 0.2


def _laws(case: Case) -> Iterator[tuple[str, str, MotionLaw]]:
    for key, verb, table in (("slew", "Slews", case.slew), ("luff", "Luffs", case.luff)):
        if table is not None:
            yield key, verb, table.history(key)


def pendulum_frequency(case: Case) -> float:
    """Return √(g/l)/2π of the hanging load in Hz; 0 if it does not swing."""
    if case.gravity is None or case.hoist is None or case.hoist.pendulum is None:
        return 0.0
    return float(np.sqrt(case.gravity.acceleration / case.hoist.pendulum) / (2.0 * np.pi))


def fastest_turn(law: MotionLaw) -> float:
    """Return the largest speed of an angle in degrees per second."""
    return float(np.abs(law.rate(resolving_times([law], max(law.kinks)), 1)).max())


def turning_lines(case: Case) -> Iterator[str]:
    """Yield a sentence on the angle, time and speed of slewing and of luffing."""
    for _, verb, law in _laws(case):
        kinks = law.kinks
        yield (
            f"{verb} by {float(law(np.array(max(kinks)))):g} degrees from {max(0.0, min(kinks)):g} "
            f"to {max(kinks):g} s, at {fastest_turn(law):.4g} degrees/s at most."
        )


def swing_cautions(case: Case, data: xr.Dataset) -> Iterator[str]:
    """Yield a caution for each model whose hanging load swings by a large angle."""
    for name in ("swing_out", "swing_aside"):
        if name not in data:
            continue
        length = case.hoist.pendulum if case.hoist and case.hoist.pendulum else np.inf
        swings = np.abs(data[name].values).max(axis=1) / length
        for model, swing in zip(data["model"].values, swings, strict=True):
            if swing > _SMALL:
                yield (
                    f"caution: hoist.pendulum: in {model} the load swings by "
                    f"{np.rad2deg(np.arctan(swing)):.3g} degrees; it moves as for small angles"
                )


def turning_cautions(where: str, frequency: float, case: Case) -> Iterator[str]:
    """Yield a caution where the frame turns so fast that Coriolis forces on the boom matter.

    Args:
        where: source of the frequency, for example ``in MODEL``.
        frequency: first frequency in Hz, with closed contacts.
        case: a checked case.
    """
    for key, _, law in _laws(case):
        part = np.deg2rad(fastest_turn(law)) / (2.0 * np.pi * frequency)
        if part > _SLOW:
            yield (
                f"caution: {key}: the boom turns with {100.0 * part:.3g} % of its first circular "
                f"frequency {where}; beyond 5 % the Coriolis forces of its vibration, which are "
                "left out, matter"
            )
