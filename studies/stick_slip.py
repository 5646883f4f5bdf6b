# SPDX-License-Identifier: LGPL-3.0-or-later
"""Effect of the lag behind an elastic drive on the motion of the boom.

A model moves the boom with the commanded extension. A second run uses the actual extension, which
lags behind the command; the difference is the error.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from protractile.cases import change
from protractile.dynamics.excitation import PiecewiseLinear
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.typography import TO_MILLI, TO_PERCENT
from protractile.runs import CASES
from protractile.runs.case import reading
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.models import MotionPlan, build
from protractile.runs.report.tables import Table
from studies.study import Progress, define_study

# Stiffnesses in N/m of the drive of the paper's boom; damping ratio 0.5 %, static friction 0.3.
ROPES = (2.0e5, 1.0e6, 5.0e6)
GRAVITY = 9.80665


@define_study("stick_slip", "Elastic drives with stick and slip")
def study(progress: Progress) -> Iterator[Table]:
    """Measure the lag and its effect for several stiffnesses."""
    columns = {
        "stiffness\nN/m": ".3g", "sticks": "", "slips by\nmm": ".3g",
        "lags at most\n% of overlap": ".3g", "contact forces off\n% of the largest": ".2g",
        "tip off\n% of its range": ".2g",
    }  # fmt: skip
    notes = (
        "The paper's boom under its weight without play, drawn out by 4 m until 1 m of overlap are "
        "left in 20 s, five-term series, against the same motion along the way that it has gone.",
    )
    rows = []
    for stiffness in ROPES:
        progress(f"the paper's boom on {stiffness:g} N/m")
        rows.append(_one_way(stiffness))
    yield Table.of_rows("one-way", "Lag behind an elastic drive", columns, rows, notes)


def _one_way(stiffness: float) -> list[float]:
    """Return lag and errors of force and tip for a stiffness in N/m, as percentages."""
    case = _weighted_case(stiffness)
    boom = build_boom(case)
    plan = MotionPlan.of(build(case, boom, case.models[0]).system, case, case.models[0])
    asked = _move(plan)
    told, data = asked.data.attrs["stick_slip"]["drive_force"], asked.data
    gone = PiecewiseLinear(tuple(asked.time), tuple((data["extension"] - data["drive_lag"]).values))
    (travel,) = plan.motion.system.travels
    along = replace(plan.motion.system, travels=[replace(travel, history=gone, elastic=None)])
    felt = _move(replace(plan, motion=replace(plan.motion, system=along)))
    forces, tips = (
        [run.data[name].values for run in (asked, felt)] for name in ("contact_force", "tip")
    )
    lag = float(np.abs(data["drive_lag"]).max()) / boom.smallest_overlap(boom.joints[0])
    return [
        stiffness, told.sticks, TO_MILLI * told.slip, TO_PERCENT * lag,
        TO_PERCENT * float(np.abs(forces[0] - forces[1]).max() / np.abs(forces[1]).max()),
        TO_PERCENT * float(np.abs(tips[0] - tips[1]).max() / np.ptp(tips[1])),
    ]  # fmt: skip


def _move(plan: MotionPlan) -> Trajectory:
    return plan.trajectory(lambda _: None)


def _weighted_case(stiffness: float) -> Case:
    """Return the paper's boom under its weight; a rope telescopes it from rest."""
    case = reading.load(str(CASES / "drawn-out.toml"))
    masses = [one.mass_per_length or 0.0 for one in case.segments]
    rope = {
        "time": 20.0,
        "stiffness": stiffness,
        "dashpot": float(0.01 * np.sqrt(stiffness * 10.0 * masses[1])),
        "static_friction": 0.3,
    }
    changed: dict[str, Any] = {f"joint.drive.{key}": value for key, value in rope.items()}
    for number, mass in enumerate(masses, start=1):
        changed[f"segment[{number}].load"] = -GRAVITY * mass
    changed |= {"joint.play": 0.0, "start.state": "equilibrium", "time.duration": 21.0}
    return change(case, **changed).model_copy(update={"models": case.models[:1]})
