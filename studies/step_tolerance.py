# SPDX-License-Identifier: LGPL-3.0-or-later
"""True errors of the time step, compared with the tolerance that controls it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.trajectory import Trajectory
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.pipeline.models import initial_motion
from protractile.runs.report.tables import Table
from studies.motions import gap_system, model_of
from studies.study import Criterion, Piece, Progress, Verification, define_study

# Mesh size of the shell in m.
MESH_SIZE = 0.5


class Kind(NamedTuple):
    """Motion that the step controls.

    Args:
        file, model: case file, and name of its model.
        duration, step: duration in s, and step of the reference in s.
        at_rest: whether the boom starts at rest.
        tolerances: tolerances in descending order.
    """

    file: str
    model: str
    duration: float
    step: float
    at_rest: bool = False
    tolerances: Sequence[float] = (1.0e-2, 1.0e-3, 1.0e-4)


MOTIONS: Mapping[str, Kind] = {
    "series of 4 terms": Kind("paper-friction.toml", "kantorovich-4", 1.0, 2.0e-6),
    "series of 24 terms": Kind("paper-friction.toml", "kantorovich-24", 1.0, 2.0e-6),
    "elements": Kind("paper-friction.toml", "beam-fe", 1.0, 2.0e-6),
    # Vibrations of plates need a reference in much smaller steps for a tolerance of 1e-4.
    "coarse shell": Kind(
        "paper-friction.toml", "shell", 0.5, 5.0e-7, tolerances=(1.0e-2, 1.0e-3)
    ),
    "elements from rest": Kind("lift.toml", "timoshenko", 2.0, 2.0e-5, at_rest=True),
    # Steps of the least number per output interval, 1 ms, have an error of 2e-6.
    "telescoping elements": Kind(
        "crane-telescopes.toml", "timoshenko", 2.0, 4.0e-5, True, (1.0e-4, 1.0e-5, 1.0e-6)
    ),
}  # fmt: skip

NOTE = (
    "The error is the largest of all recorded deflections, as a fraction of the range of each. The "
    "estimate is the step_error of the run."
)


class Found(NamedTuple):
    """True error and estimate as fractions of the range, and number of steps."""

    error: float
    estimate: float
    steps: int


def motion_of(kind: Kind) -> Motion:
    """Return the first seconds of the motion of a model of a case."""
    case = case_file.load(str(CASES / kind.file))
    start = case.start.model_copy(update={"at_rest": kind.at_rest})
    case = case.model_copy(update={"start": start})
    model = model_of(case, kind.model)
    if model.meshed:
        model = model.model_copy(update={"mesh_size": MESH_SIZE})
    motion = initial_motion(gap_system(case, build_boom(case), model), case)
    return replace(motion, duration=kind.duration)


def true_error(motion: Motion, run: Trajectory, exact: Trajectory) -> float:
    """Return the largest difference of a deflection, as a fraction of its range."""
    errors = [
        np.abs(run.data[name] - exact.data[name]).max() / np.ptp(exact.data[name].values)
        for name, seen in motion.system.observers.items()
        if (seen.unit, seen.derivative) == ("m", 0)
    ]
    return float(max(errors))


def measure(kind: Kind) -> list[Found]:
    """Return errors and estimates of a motion for each tolerance."""
    motion = motion_of(kind)
    exact, found = FixedStep(kind.step)(motion), []
    for tolerance in kind.tolerances:
        run = AdaptiveStep(tolerance)(motion)
        attributes = run.data.attrs
        error = true_error(motion, run, exact)
        found.append(Found(error, attributes["step_error"], attributes["steps"]))
    return found


@define_study("step_tolerance", "Tolerance of the time step")
def study(progress: Progress) -> Iterator[Piece]:
    """Compare errors and tolerances of motions of all kinds of models."""
    criterion: Criterion
    rows, shares = [], []
    for name, kind in MOTIONS.items():
        progress(name)
        measured = measure(kind)
        for tolerance, found in zip(kind.tolerances, measured, strict=True):
            shares.append(found.error / found.estimate)
            rows.append(
                (name, 100.0 * tolerance, 100.0 * found.error, 100.0 * found.estimate, found.steps)
            )
            criterion = ("other code", f"fixed step of {1e6 * kind.step:g} µs", tolerance)
            what = f"error by the time step, {name}, tolerance of {tolerance:g}"
            yield Verification(what, found.error, 0.0, "", *criterion)
        falls = max(after.error / before.error for before, after in pairwise(measured))
        what = f"largest ratio of these errors, {name}, of a tolerance and ten times this tolerance"
        yield Verification(what, falls, 0.0, "", "other code", "error does not rise", 1.0)
    criterion = ("other code", "error at most the estimate", 1.0)
    yield Verification("largest ratio of error and estimate", max(shares), 0.0, "", *criterion)
    criterion = ("other code", "estimate at most five errors", 0.8)
    yield Verification("smallest ratio of error and estimate", min(shares), 1.0, "", *criterion)
    columns = {
        "motion": "", "tolerance\n%": ".3g", "error\n%": ".2g", "estimate\n%": ".2g", "steps": "",
    }  # fmt: skip
    yield Table.of_rows("step_tolerance", "Errors by the time step", columns, rows, (NOTE,))
