# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms with slide pads, and the resultant force of a pad."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from dynamics.gap_system import GapSystem
from geometry.arrays import Array
from geometry.joint import PadSize
from runs.case.build import build_boom
from runs.case.schema import Case
from studies.study import Verification


def with_pads(case: Case, length: float, width: float) -> Case:
    """Return the case with pads of a length and a width in m at all joints."""
    pad = PadSize(length, width)
    joints = tuple(replace(joint, pad=pad) for joint in case.joints)
    return case.model_copy(update={"joints": joints})


def upper_rows(system: GapSystem) -> Array:
    """Return rows (num_stations, num_modes) of the mean approach at the top of each station.

    The contact stiffness of each point is its weight in the mean.
    """
    above = np.array(
        [sum(term.stiffness for term in law.terms if term.side > 0.0) for law in system.laws]
    )
    at = np.equal.outer(np.arange(len(system.stations)), system.station_of_row) * above
    return np.asarray(at @ system.rows / at.sum(axis=1, keepdims=True))


def pad_verifications(
    case: Case, size: tuple[float, float], system: GapSystem
) -> Iterator[Verification]:
    """Compare magnitude and position of a pad's resultant force with statics.

    The product of a pad's row and a rigid motion is the work of a unit force on the pad.

    Args:
        case: case with the pads.
        size: length and width of the pads in m.
        system: shell with the pads.
    """
    boom = build_boom(case)
    start, _ = boom.overlap(boom.joints[0])
    for what, tail, tip, expected, unit, source in (
        ("force of a uniformly pressed pad, over its law's", 1.0, 1.0, 1.0, "",
         "pressure times area"),
        ("its place along the boom, pad at the overlap's start", start, boom.tip,
         start + 0.5 * size[0], "m", "middle of the pad"),
    ):  # fmt: skip
        found = float(upper_rows(system)[0] @ rigid_motion(system, tail, tip))
        yield Verification(what, found, expected, unit, "analytic", source, 1.0e-6)


def rigid_motion(system: GapSystem, tail: float, tip: float) -> Array:
    """Return the rigid motion (num_modes,) of the inner segment that raises its ends, by m each."""
    free = np.flatnonzero(system.omega2 == 0.0)
    rows = np.array([system.observers[name].row[free] for name in ("tail", "tip")])
    state = np.zeros(system.num_modes)
    state[free] = np.linalg.lstsq(rows, np.array([tail, tip]), rcond=None)[0]
    return state
