# SPDX-License-Identifier: LGPL-3.0-or-later
"""Lift-off, rope force and swing of a hoisted load."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np

from dynamics.trajectory import Trajectory
from geometry.boom import Boom
from geometry.typography import TO_KILO
from runs.case.hoist import hanging_load
from runs.case.schema import Case
from runs.pipeline.metrics import Metric, Record

_metres = partial(Metric, unit="m", factor=1.0, shown_unit="m", form=".3g")


@dataclass(frozen=True, slots=True)
class Hoisting(Record):
    """Extreme values of a load on a rope.

    Args:
        lift_off: time in s at which the rope force first reaches the weight of a load on the
            ground; None if it does not, or if the load hangs at t = 0.
        force: largest force of all falls in N.
        factor: this force over the weight of the load.
        by_class: factor φ₂,min + β₂ v of the hoisting class; None without its constants.
        swing_out, swing_aside: largest distances in m of the load from the tip, in the plane of the
            boom and aside; None without a swing in this direction.
    """

    title = "Hoisting"
    notes = (
        "At lift-off the force of all falls reaches the weight of the load. φ₂ is their largest "
        "force over this weight. Swing is the largest distance of the load from the tip.",
    )

    lift_off: Annotated[
        float | None,
        Metric(
            "lift_off", "s", "lift-off", 1.0, "s", charted=False, heading="lift-off", form=".3f"
        ),
    ]
    force: Annotated[
        float,
        Metric(
            "rope_force", "N", "force of the rope", TO_KILO, "kN",
            heading="rope force,\nmaximum", form=".3g",
        ),
    ]  # fmt: skip
    factor: Annotated[
        float,
        Metric(
            "rope_factor", "1", "factor φ₂ of the rope", 1.0, "–", heading="factor φ₂", form=".3f"
        ),
    ]
    by_class: Annotated[
        float | None,
        Metric(
            "rope_factor_by_class", "1", "factor φ₂ of the hoisting class", 1.0, "–",
            heading="φ₂ of the\nclass", form=".3f",
        ),
    ]  # fmt: skip
    swing_out: Annotated[
        float | None,
        _metres("swing_out", title="swing in the plane of the boom", heading="swing\nin plane"),
    ]
    swing_aside: Annotated[
        float | None, _metres("swing_aside", title="swing aside", heading="swing\naside")
    ]


def hoisting(case: Case, boom: Boom, trajectory: Trajectory) -> Hoisting | None:
    """Return the extreme values of the hoisted load in a motion; None without a hoist."""
    load, data = hanging_load(case, boom), trajectory.data
    if case.hoist is None or load is None:
        return None
    raised = np.flatnonzero(data["rope_force"].values >= load.weight)
    force = float(data["rope_force_peak"].values.max())
    swings = (
        float(np.abs(data[name].values).max()) if name in data else None
        for name in ("swing_out", "swing_aside")
    )
    lift_off = float(trajectory.time[raised[0]]) if load.slack is not None and raised.size else None
    by_class = case.hoist.factor_by_class
    return Hoisting(lift_off, force, force / load.weight, by_class, *swings)
