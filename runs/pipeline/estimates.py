# SPDX-License-Identifier: LGPL-3.0-or-later
"""Estimates of the memory and time of a run before it starts.

Estimates are never too low, and too high by a factor of at most about four. Beams are built and
their steps are exact; a shell is not meshed yet, and its steps are estimated by a beam. The
constants were measured on one core of an AMD EPYC (``python -m studies.cost.bench``, and
tests/runs/test_estimates.py for the memory).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dynamics.failure import NUMERICS
from dynamics.motion import MOST_STEPS, Motion
from runs.case.checked_case import CheckedCase
from runs.case.kinds.model import ModelTable
from runs.case.messages import BadInput
from runs.case.schema import Case, Model
from runs.pipeline.models import build_on, initial_motion

# Memory in bytes and time in s of runs that need no confirmation.
MAX_MEMORY, MAX_TIME = 4.0e9, 3600.0

# Memory in bytes of the libraries for a beam and for a shell, including just-in-time compilation.
_LIBRARIES, _SHELL_LIBRARIES = 1.3e9, 1.6e9

# Numbers of 8 bytes per output and model: fixed columns, per coordinate, per station.
_NUMBERS, _OF_COORDINATE, _OF_STATION = 160.0, 1.5, 12.0
# Time in s per output and model for files and figures.
_WRITING = 3.0e-5
# Numbers of 8 bytes per output and member of an ensemble, and per step of an output interval.
_OF_MEMBER, _OF_STEP = 22.0, 24.0

# Time in s per step, per coordinate of a step, and per coordinate and row of a step.
_STEP, _OF_MODE, _OF_ROW = 0.4e-6, 1.0e-8, 1.0e-9
# Steps per output interval, and repeated windows per window, with error control.
_SUBSTEPS, _AGAIN = 32.0, 2.0
# Number of motions that measure the horizons.
_HORIZONS = 24

# Number of points of a sweep that are estimated; the cost of the others is extrapolated.
_SAMPLE = 20


@dataclass(frozen=True, slots=True)
class Cost:
    """Approximate memory in bytes, and time in s on one core."""

    memory: float
    seconds: float

    def __str__(self) -> str:
        minutes = self.seconds / 60.0
        time = f"{max(minutes, 1.0):.0f} min" if minutes < 90.0 else f"{minutes / 60.0:.3g} h"
        return f"{self.memory / 1e9:.2g} GB and {time}"

    def __add__(self, other: Cost) -> Cost:
        return Cost(self.memory + other.memory, self.seconds + other.seconds)


@dataclass(frozen=True, slots=True)
class Preview:
    """Motions of the models of a case for estimates, each model built once as beams.

    Args:
        declared: case with its boom and models.
    """

    declared: CheckedCase
    _motions: list[tuple[ModelTable, Motion]] = field(default_factory=list, init=False, repr=False)

    def motion(self, model: Model, beam: ModelTable) -> Motion:
        """Return the motion of a model as the case defines it.

        Args:
            model: a model of the case.
            beam: the model itself, or the beam that stands for it.

        Raises:
            NumericsError: there is no equilibrium to start from.
        """
        for known, motion in self._motions:
            if known == beam:
                return motion
        case, joined = self.declared.case, self.declared.joined(model)
        motion = initial_motion(build_on(joined, case, beam).system, case)
        self._motions.append((beam, motion))
        return motion


def run_cost(case: Case) -> Cost:
    """Return the cost of a run of a checked case."""
    return preview_cost(Preview(CheckedCase(case)))


def preview_cost(preview: Preview) -> Cost:
    """Return the cost of a run; models that are already built as beams are used again."""
    case = preview.declared.case
    shell = any(model.needs_shell for model in case.models)
    total = Cost(_SHELL_LIBRARIES if shell else _LIBRARIES, 0.0)
    # Overflow is ignored here: the run detects it.
    with np.errstate(all="ignore"):
        for model in case.models:
            total += _of_model(preview, model)
    return total


def sweep_cost(cases: Sequence[Case]) -> Cost:
    """Return the cost of a sweep of checked cases on all cores."""
    at_a_time = min(len(cases), os.cpu_count() or 1)
    sample = [run_cost(case) for case in cases[:: -(-len(cases) // _SAMPLE)]]
    seconds = sum(cost.seconds for cost in sample) / len(sample) * len(cases)
    return Cost(at_a_time * max(cost.memory for cost in sample), seconds / at_a_time)


def refuse_large(cost: Cost, file: str) -> None:
    """Refuse a run or sweep that needs more memory or time than is allowed without confirmation.

    Raises:
        BadInput: the cost exceeds :data:`MAX_MEMORY` or :data:`MAX_TIME`.
    """
    if not (cost.memory <= MAX_MEMORY and cost.seconds <= MAX_TIME):
        raise BadInput(
            file,
            "--large",
            f"missing, and it may take {cost}; give it to start all the same, or ask for fewer "
            "outputs, members, points or steps, or for coarser meshes",
        )


def _of_model(preview: Preview, model: Model) -> Cost:
    case, stand_in = preview.declared.case, model.stand_in(preview.declared.boom)
    before = Cost(stand_in.memory, stand_in.seconds)
    try:
        motion = preview.motion(model, stand_in.beam)
    except NUMERICS:
        # The run meets the same error and reports it.
        return before
    system, time = motion.system, case.time
    outputs, coordinates = time.duration / time.output_step, stand_in.coordinates
    step = model.step or time.step
    steps = time.duration / step if step else min(_SUBSTEPS * outputs, MOST_STEPS)
    members = case.ensemble.members if case.ensemble is not None and system.laws else 0
    doubled = bool(system.frictions) and case.regular
    alone = 1.0 + 0.5 * doubled if step else _AGAIN
    motions = alone + members + (_HORIZONS if members else 0)
    rows = len(system.laws) + len(system.frictions) + len(system.dashpots)
    each = _STEP + coordinates * (_OF_MODE + _OF_ROW * rows)
    numbers = _NUMBERS + _OF_COORDINATE * coordinates + _OF_STATION * len(system.stations)
    of_interval = _OF_STEP + 2 * len(system.excitations) + len(system.travels)
    return before + Cost(
        8.0 * (outputs * (numbers + _OF_MEMBER * members) + steps / outputs * of_interval),
        outputs * _WRITING + motions * steps * each,
    )
