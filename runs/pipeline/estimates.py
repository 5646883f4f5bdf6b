# SPDX-License-Identifier: LGPL-3.0-or-later
"""Estimates of the memory and time of a run before it starts.

The memory is an upper bound, at most four times the true value. The time is right within a factor
of two on an idle AMD EPYC (tests/runs/test_estimates.py). For the estimate a beam replaces each
shell, so that nothing is meshed.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from protractile.dynamics.excitation import History, is_constant
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.dynamics.motion import MOST_STEPS, Motion
from protractile.runs.case.build import build_boom
from protractile.runs.case.combination_tables import (
    CombinationTable,
)
from protractile.runs.case.kinds.model import ModelTable
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case, Model
from protractile.runs.pipeline.models import build_on, initial_motion
from protractile.runs.process.bad_input import BadInput

# Memory in bytes and time in s of runs that need no confirmation.
MAX_MEMORY, MAX_TIME = 4.0e9, 3600.0

# Memory in bytes of the libraries of a beam and of a shell, with just-in-time compilation.
_LIBRARIES, _SHELL_LIBRARIES = 1.3e9, 1.6e9

# Numbers (of 8 bytes) per output time and model: constant part, per coordinate, per station.
_NUMBERS, _OF_COORDINATE, _OF_STATION = 160.0, 1.5, 12.0
# Time in s per output time and model for files and figures, and per drive for its results.
_WRITE_TIME, _OF_TRAVEL = 3.0e-5, 4.0e-4
# Numbers (of 8 bytes) per output time and member of an ensemble, and per step between two outputs.
_OF_MEMBER, _OF_STEP = 22.0, 24.0

# Time in s for the design results of a model, for the report of a run without and with shells, and
# for the figures of a segment.
_RESULTS, _REPORT, _SHELL_REPORT, _OF_SEGMENT = 1.0, 5.0, 12.0, 0.5
# Time in s of a step: constant part, per coordinate, per contact.
_STEP, _OF_MODE, _OF_ROW = 0.5e-6, 1.0e-8, 0.5e-6
# Steps with error control: number per output interval without impacts; with impacts, fraction of
# the largest number of steps, at the tolerance that follows; computed steps per accepted step.
_SUBSTEPS, _OF_MOST, _TOLERANCE, _REPEATED = 4.0, 0.5, 1.0e-3, 2.5
# Number of motions for the horizons of a model.
_HORIZONS = 24

# Time in s in which check and prove start, and number of states that check computes in addition.
_START, _OTHER_STATES = 2.0, 9
# Time in s of the states of a combination in a load case: per segment, per instant of extreme
# loads, and per product of both numbers.
_STATE, _OF_INSTANT, _OF_BOTH = 0.012, 1.0e-3, 2.5e-4
# Time in s of their proofs: per segment, per square of this number, and per product of both.
_PROOF, _OF_BUCKLING, _PROOF_OF_BOTH = 6.0e-3, 3.5e-3, 3.0e-4
# Memory in bytes of these states, per square of the number of segments.
_STATE_MEMORY = 1.5e5

# Number of points of a sweep whose cost is estimated; the others are extrapolated.
_SAMPLE = 20


@dataclass(frozen=True, slots=True)
class Cost:
    """Approximate memory in bytes, and time in s on one core."""

    memory: float
    seconds: float

    def __str__(self) -> str:
        minutes = self.seconds / 60.0
        time = f"{minutes:.0f} min" if minutes < 90.0 else f"{minutes / 60.0:.3g} h"
        if minutes < 1.5:
            time = f"{float(f'{self.seconds:.1g}'):g} s"
        return f"{self.memory / 1e9:.2g} GB and {time}"

    @property
    def large(self) -> bool:
        """True if the run needs a confirmation because of its memory or time."""
        return not (self.memory <= MAX_MEMORY and self.seconds <= MAX_TIME)

    def __add__(self, other: Cost) -> Cost:
        return Cost(self.memory + other.memory, self.seconds + other.seconds)


@dataclass(frozen=True, slots=True)
class Preview:
    """Motions of beams that replace the models of a case, to estimate the cost of a run."""

    checked: CheckedCase  #: the checked case; each beam is built once
    _motions: list[tuple[ModelTable, Motion]] = field(default_factory=list, init=False, repr=False)

    def motion(self, model: Model) -> Motion:
        """Return the motion, before integration, of the beam that replaces a model of the case.

        Raises:
            NumericsError: there is no equilibrium to start from.
        """
        beam = model.surrogate(self.checked.boom).beam
        for earlier_beam, motion in self._motions:
            if earlier_beam == beam:
                return motion
        case, model_boom = self.checked.case, self.checked.model_boom(model)
        motion = initial_motion(build_on(model_boom, case, beam).system, case)
        self._motions.append((beam, motion))
        return motion


def run_cost(case: Case, preview: Preview | None = None) -> Cost:
    """Return the cost of a run of a checked case, estimated from its preview."""
    report = (_SHELL_REPORT if case.first_shell else _REPORT) + _OF_SEGMENT * len(case.segments)
    states = _combined_time(case, proofs=True) if case.load_cases or case.combinations else 0.0
    return models_cost(preview or Preview(CheckedCase(case))) + Cost(0.0, report + states)


def models_cost(preview: Preview) -> Cost:
    """Return the cost of a run without its report."""
    case = preview.checked.case
    total = Cost(_SHELL_LIBRARIES if case.first_shell else _LIBRARIES, 0.0)
    # Overflow is ignored here: the run detects it.
    with np.errstate(all="ignore"):
        for model in case.models:
            total += _model_cost(preview, model)
    return total


def states_cost(case: Case, proofs: bool) -> Cost:
    """Return the cost of ``prove`` by beams if ``proofs``, else of ``check``."""
    memory = _LIBRARIES + _STATE_MEMORY * len(_combined(case)) * len(case.segments) ** 2
    others = 0.0 if proofs else _OTHER_STATES * _state_time(case, proofs)
    return Cost(memory, _START + others + _combined_time(case, proofs))


def _combined(case: Case) -> list[CombinationTable | None]:
    """Return the combination of each state; None without combinations."""
    names = [load_case.name for load_case in case.load_cases] or [""]
    combined: list[CombinationTable | None] = []
    for combination in case.combinations:
        used = names if combination.load_cases is None else {*names} & {*combination.load_cases}
        combined += [combination] * len(used)
    return combined or [None] * len(names)


def _state_time(case: Case, proofs: bool) -> float:
    """Return the time in s of the states of a combination in a load case, and of their proofs."""
    segments = len(case.segments)
    # An impulse or a released load changes at t = 0 only.
    histories = [load.history for load in build_boom(case).loads]
    instants = 1 + sum(
        isinstance(history, History) and not is_constant(history) for history in histories
    )
    time = _STATE * segments + _OF_INSTANT * instants + _OF_BOTH * instants * segments
    if proofs:
        time += _PROOF * segments + _OF_BUCKLING * segments**2
        time += _PROOF_OF_BOTH * instants * segments
    return time


def _combined_time(case: Case, proofs: bool) -> float:
    """Return the time in s of all combinations in their load cases, with their motions."""
    combined = _combined(case)
    time = len(combined) * _state_time(case, proofs)
    moving = (
        sum(combination is not None and combination.motion for combination in combined)
        if proofs
        else 0
    )
    if moving:
        preview, model = Preview(CheckedCase(case)), case.models[0]
        with suppress(*NUMERICAL_ERRORS):
            motion = preview.motion(model)
            modes = motion.system.num_modes
            time += moving * motion_cost(preview.checked, model, motion, modes).seconds
    return time


def sweep_cost(cases: Sequence[Case]) -> Cost:
    """Return the cost of a sweep of checked cases on all cores."""
    at_a_time = min(len(cases), os.cpu_count() or 1)
    chosen = cases[:: -(-len(cases) // _SAMPLE)]
    sample = [models_cost(Preview(CheckedCase(case))) for case in chosen]
    seconds = sum(cost.seconds for cost in sample) / len(sample) * len(cases)
    return Cost(at_a_time * max(cost.memory for cost in sample), seconds / at_a_time)


def frequencies_cost(cases: Sequence[Case]) -> Cost:
    """Return the cost of the frequencies of checked cases, which are computed one after the other.

    Each model is built with play and bonded.
    """
    costs = [
        Cost(surrogate.memory, 2.0 * surrogate.seconds)
        for case in cases
        for surrogate in (model.surrogate(build_boom(case)) for model in case.models)
    ]
    return Cost(_LIBRARIES + max(cost.memory for cost in costs), sum(c.seconds for c in costs))


def refuse_large(cost: Cost, file: str) -> None:
    """Refuse a run, a sweep or frequencies whose memory or time needs a confirmation.

    Raises:
        BadInput: the cost exceeds :data:`MAX_MEMORY` or :data:`MAX_TIME`.
    """
    if cost.large:
        raise BadInput(
            file,
            "--large",
            f"missing, and it may take {cost}; give it to start anyway, or ask for fewer "
            "outputs, members, points, states or steps, or for coarser meshes",
        )


def _model_cost(preview: Preview, model: Model) -> Cost:
    surrogate = model.surrogate(preview.checked.boom)
    before = Cost(surrogate.memory, _RESULTS + surrogate.seconds)
    try:
        motion = preview.motion(model)
    except NUMERICAL_ERRORS:
        # The run will fail with the same error and report it.
        return before
    return before + motion_cost(preview.checked, model, motion, surrogate.coordinates)


def motion_cost(checked: CheckedCase, model: Model, motion: Motion, coordinates: float) -> Cost:
    """Return the cost of the motions of a model with a number of coordinates, and of their files.

    ``motion`` is the motion of the model, or of the beam that replaces it.
    """
    case = checked.case
    system, time = motion.system, case.time
    outputs = time.duration / time.output_step
    step = model.step or time.step
    steps = time.duration / step if step else _SUBSTEPS * outputs
    # Only contacts of a planar boom that starts in equilibrium stay closed.
    if not step and system.laws and (checked.boom.spatial or not case.start.at_rest):
        steps = max(steps, _OF_MOST * MOST_STEPS * np.sqrt(_TOLERANCE / time.tolerance))
    members = case.ensemble.members if case.ensemble is not None and system.laws else 0
    doubled = bool(system.frictions) and case.regular
    alone = 1.0 + 0.5 * doubled if step else _REPEATED
    motions = alone + members + (_HORIZONS if members else 0)
    rows = len(system.laws) + len(system.frictions) + len(system.dashpots)
    each = _STEP + _OF_MODE * coordinates + _OF_ROW * rows
    numbers = _NUMBERS + _OF_COORDINATE * coordinates + _OF_STATION * len(system.stations)
    of_interval = _OF_STEP + 2 * len(system.excitations) + len(system.travels)
    return Cost(
        8.0 * (outputs * (numbers + _OF_MEMBER * members) + steps / outputs * of_interval),
        outputs * (_WRITE_TIME + _OF_TRAVEL * len(system.travels)) + motions * steps * each,
    )
