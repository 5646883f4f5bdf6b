# SPDX-License-Identifier: LGPL-3.0-or-later
"""Elastic drives: cycles of stick-slip, and the effect of the lag on the motion of the boom.

A model moves the boom with the commanded extension. A second run uses the actual extension, which
lags behind the command; the difference is the error.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from dynamics.drive.stick_slip import DriveMotion, ElasticDrive, move_segment
from dynamics.excitation import PiecewiseLinear, SCurve, Stroke
from dynamics.trajectory import Trajectory
from geometry.arrays import Array
from geometry.typography import TO_MILLI, TO_PERCENT
from protractile.cases import change
from runs import CASES
from runs.case import reading
from runs.case.build import build_boom
from runs.case.schema import Case
from runs.pipeline.drives import critical_speed
from runs.pipeline.models import MotionPlan, build
from runs.report.tables import Table
from studies.study import Criterion, Piece, Progress, Verification, define_study

# Mass in kg, stiffness in N/m, sliding friction in N, and ratio of static to sliding friction.
MASS, STIFFNESS, FRICTION, STICKING = 500.0, 1.0e5, 1000.0, 1.5
SPEED = 0.05
RATIOS = (0.01, 0.1, 0.5)

# Stiffnesses in N/m of the drive of the paper's boom; damping ratio 0.5 %, static friction 0.3.
ROPES = (2.0e5, 1.0e6, 5.0e6)
GRAVITY = 9.80665

ROPE = ElasticDrive(MASS, STIFFNESS, sticking=STICKING)
CYCLE = "sticking until the spring is taut, slipping on a circle"


@define_study("stick_slip", "Elastic drives with stick and slip")
def study(progress: Progress) -> Iterator[Piece]:
    """Compare cycles, critical speeds and a stiff drive with closed forms, and measure the lag."""
    progress("a mass on a spring")
    yield from _cycle()
    yield from map(_critical, RATIOS)
    yield _stiff()
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


def _follow_drive(pulled: ElasticDrive, speed: float, time: Array) -> DriveMotion:
    way = Stroke(2.0 * speed * float(time[-1]), speed)
    return move_segment(pulled, way, time, np.full(time.size, FRICTION))


def _cycle() -> Iterator[Verification]:
    """Compare ten undamped cycles at constant speed with the closed form."""
    omega, slack = np.sqrt(STIFFNESS / MASS), (STICKING - 1.0) * FRICTION / STIFFNESS
    radius, first = np.hypot(slack, SPEED / omega), STICKING * FRICTION / STIFFNESS / SPEED
    slipping = 2.0 / omega * (np.pi - np.arctan(slack * omega / SPEED))
    period = 2.0 * slack / SPEED + slipping
    time = np.linspace(0.0, first + 9.99 * period, 40_001)
    found = _follow_drive(ROPE, SPEED, time)
    still = found.series["extension_speed"] == 0.0
    begins = time[1:][still[:-1] & ~still[1:]]
    told = found.results
    for what, value, reference, unit, allowed in (
        ("period", (begins[9] - begins[0]) / 9.0, period, "s", 1.0e-3),
        ("slip", told.slip, 2.0 * radius, "m", 1.0e-4),
        ("largest force", told.peak, FRICTION + STIFFNESS * radius, "N", 1.0e-4),
        ("largest speed", told.speed, SPEED + omega * radius, "m/s", 1.0e-4),
        ("largest acceleration", told.acceleration, omega**2 * radius, "m/s²", 1.0e-3),
        ("energy not accounted for", told.energy_residual, 0.0, "", 1.0e-10),
    ):
        criterion: Criterion = ("analytic", CYCLE, allowed)
        yield Verification(f"cycle: {what}", float(value), float(reference), unit, *criterion)


def _critical(ratio: float) -> Verification:
    """Compare the critical speed with bisection; below this speed the segment sticks again."""
    pulled = replace(ROPE, dashpot=2.0 * ratio * np.sqrt(STIFFNESS * MASS))
    expected = critical_speed(pulled, FRICTION)
    low, high = 0.5 * expected, 2.0 * expected
    while high - low > 1.0e-5 * expected:
        middle = 0.5 * (low + high)
        lasting = 5.0 * FRICTION / STIFFNESS / middle + 20.0 * np.pi * np.sqrt(MASS / STIFFNESS)
        sticks = _follow_drive(pulled, middle, np.linspace(0.0, lasting, 2001)).results.sticks
        low, high = (middle, high) if sticks else (low, middle)
    criterion: Criterion = ("analytic", "the swing that just comes back to it", 1.0e-4)
    return Verification(f"critical speed at ζ = {ratio:g}", high, expected, "m/s", *criterion)


def _stiff() -> Verification:
    """Compare the force of a drive of 1e9 N/m at a quarter of an S-curve with a closed form."""
    way, time = SCurve(travel=2.0, duration=4.0), np.linspace(0.0, 1.0, 1001)
    pulled = ElasticDrive(MASS, 1.0e9, dashpot=0.2 * np.sqrt(1.0e9 * MASS))
    found = move_segment(pulled, way, time, np.full(time.size, FRICTION))
    asked = FRICTION + MASS * 0.25 * np.pi
    criterion: Criterion = ("analytic", "friction and m s̈ of the drive", 1.0e-4)
    force = float(found.series["drive_force"][-1])
    return Verification("force of a stiff drive", force, float(asked), "N", *criterion)


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
