# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motions of the paper's examples by numerical methods of 1997 and by this program.

The paper integrates beam elements by the modal technique in 4375 steps for 7 s, with contact and
friction forces on a few modes. It does not state the scheme, the number of modes, or whether
contact forces were iterated. This study computes all combinations.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import NamedTuple

import numpy as np

from protractile.dynamics.energy import ENERGIES
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.motion import Motion
from protractile.dynamics.predictability import perturbations, vary_motion
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.arrays import Array
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.paper.rules import CONFORMITY, DIVERGENCE
from protractile.runs.paper.run_query import peak_distances
from protractile.runs.pipeline.members import slow_cutoff
from protractile.runs.pipeline.models import MotionPlan
from studies.motions import gap_system, model_of, run_parallel
from studies.numerics_1997.schemes import CENTRAL, NEWMARK, WILSON, Scheme, integrate, lowest

SERIES = ("kantorovich-4", "kantorovich-5")
ELEMENTS, BONDED = "beam-fe", "beam-fe-bonded"

# The paper's step of 7 s / 4375 and two others in s.
STEPS = (3.2e-3, 1.6e-3, 0.8e-3)
PAPER_STEP = STEPS[1]
# Numbers of modes of both segments in the modal technique.
MODES = (6, 8, 10, 12, 14)
# Relative changes of the loads of ensemble members.
MEMBERS, RELATIVE, SEED = 4, 1.0e-9, 1


class Numerics(NamedTuple):
    """Numerical method of 1997: scheme, step, and either iterated or lagged contact forces."""

    scheme: Scheme  #: scheme of the steps
    iterated: bool  #: whether gaps and friction agree with the end of a step, or lag by one
    step: float  #: step in s

    def __str__(self) -> str:
        gaps = "iterated" if self.iterated else "lagged"
        return f"{self.scheme.name}, gaps {gaps}, {1e3 * self.step:g} ms"


def all_numerics() -> list[Numerics]:
    """Return all combinations of scheme, step, and iterated or lagged contact forces."""
    parts = product((NEWMARK, WILSON, CENTRAL), (True, False), STEPS)
    return [Numerics(*one) for one in parts]


class ModelRun(NamedTuple):
    """Run of one model."""

    time: Array  #: (num_times,) in s
    #: (num_times,) in m.
    tip: Array
    head: Array
    gained: Array  #: (num_times,) unaccounted energy in J, a loss if negative
    put_in: float  #: largest energy input of the loads in an accurate motion, in J
    unconverged: float = 0.0  #: part of the steps without convergence of friction and gaps

    @classmethod
    def of(cls, run: Trajectory, put_in: float = 0.0, unconverged: float = 0.0) -> ModelRun:
        """Return the run of a trajectory; without ``put_in``, the work of loads replaces it."""
        kinetic, strain, contact, work, *losses = (run.data[name].values for name in ENERGIES)
        present = kinetic + strain + contact + sum(losses)
        tip, head = (run.data[place].values for place in ("tip", "head"))
        scale = put_in or float(np.abs(work).max())
        return cls(run.time, tip, head, present - present[0] - work, scale, unconverged)

    @property
    def balance(self) -> Array:
        """The error (num_times,) of the energy balance, as a fraction of the input energy."""
        return self.gained / self.put_in

    def at(self, time: Array) -> ModelRun:
        """Return the run interpolated at times in s."""
        curves = self.tip, self.head, self.gained
        tip, head, gained = (np.interp(time, self.time, curve) for curve in curves)
        return ModelRun(time, tip, head, gained, self.put_in, self.unconverged)

    @property
    def first_peak(self) -> float:
        """The largest deflection of the tip in m in the first second."""
        return float(self.tip[self.time <= 1.0].max())

    @property
    def divergence_time(self) -> float:
        """The time in s at which the energy gain exceeds the input energy, or infinity."""
        gained = ~(self.balance < 1.0)
        return float(self.time[np.argmax(gained)]) if gained.any() else np.inf


@dataclass(frozen=True, slots=True)
class Sample:
    """Runs of the models with play by one numerical method, and of the model without play."""

    models: Sequence[ModelRun]  #: runs of ``SERIES`` and ``ELEMENTS``
    bonded: ModelRun  #: run of the elements without play, accurate by any method

    @property
    def elements(self) -> ModelRun:
        """The run of the finite elements with play."""
        return self.models[-1]

    def peaks(self, cutoff: float) -> tuple[float, float]:
        """Return the largest distance of slow peaks in the first six seconds, and later (S3).

        If the energy of a model diverges, the distances are infinite and NaN.
        """
        if min(one.divergence_time for one in self.models) < np.inf:
            return np.inf, np.nan
        tips = np.array([one.tip for one in self.models])
        time, apart = peak_distances(tips, self.elements.time, cutoff)
        early = time <= CONFORMITY
        return float(apart[early].max(initial=0.0)), float(apart[~early].max(initial=0.0))

    def conforms_then_diverges(self, cutoff: float) -> bool:
        """Return whether the sample reproduces S3."""
        early, late = self.peaks(cutoff)
        return early <= DIVERGENCE < late

    def tip_distances(self) -> tuple[float, float]:
        """Return the largest relative distance of two tips in the first six seconds, and later."""
        distance = _largest_difference([one.tip for one in self.models])
        early = self.elements.time <= CONFORMITY
        return float(distance[early].max()), float(distance[~early].max())

    def stratifies(self) -> bool:
        """Return whether the sample reproduces S7 by the rule for regular motions."""
        early, late = self.tip_distances()
        head = float(_largest_difference([one.head for one in self.models]).max())
        without = min(
            float(_largest_difference([one.tip, self.bonded.tip]).max()) for one in self.models
        )
        return early < DIVERGENCE < without and early < late < head


class Example(NamedTuple):
    """Example of the paper, with its models and with accurate motions of an ensemble."""

    case: Case  #: case of the example
    systems: Mapping[str, GapSystem]  #: systems of the models by name
    cutoff: float  #: cut-off of the slow motion in Hz
    accurate: Sequence[
        Sample
    ]  #: accurate motions by this program; a single one if friction makes the motion regular

    @classmethod
    def of(cls, case: Case, members: int) -> Example:
        """Return an example with accurate motions of several ensemble members."""
        boom = build_boom(case)
        names = (*SERIES, ELEMENTS, BONDED)
        systems = {name: gap_system(case, boom, model_of(case, name)) for name in names}
        cutoff = slow_cutoff(boom, case.time)
        assert cutoff is not None
        runs = run_parallel(
            # The same motion as in a run of the case.
            lambda one: ModelRun.of(one[1].integrator(vary_motion(one[1].motion, "load", one[0]))),
            [
                (factor, MotionPlan.of(systems[name], case, model_of(case, name)))
                for factor, name in product(factors(members), names)
            ],
        )
        accurate = [Sample(runs[i : i + 3], runs[i + 3]) for i in range(0, len(runs), len(names))]
        return cls(case, systems, cutoff, accurate)

    def samples(self, how: Numerics, modes: Sequence[int] = MODES) -> list[Sample]:
        """Return a sample for each number of modes of the elements and each member."""
        accurate = self.accurate[0].models
        series = [
            (self.systems[name], run.put_in) for name, run in zip(SERIES, accurate, strict=False)
        ]
        whole, put_in = self.systems[ELEMENTS], accurate[-1].put_in
        models = [*series, *((lowest(whole, few), put_in) for few in modes)]
        tasks = [(*model, factor) for model in models for factor in factors(MEMBERS)]
        runs = run_parallel(lambda one: _move(how, self.case.time.duration, *one), tasks)
        four, five, *others = (runs[i : i + MEMBERS] for i in range(0, len(runs), MEMBERS))
        bonded = self.accurate[0].bonded.at(four[0].time)
        return [
            Sample(played, bonded)
            for other in others
            for played in zip(four, five, other, strict=True)
        ]

    def with_accurate_series(self, samples: Sequence[Sample]) -> list[Sample]:
        """Return the samples with accurate motions of the series, as by a general solver."""
        members = [self.accurate[i % MEMBERS % len(self.accurate)] for i in range(len(samples))]
        return [
            replace(one, models=[*(run.at(one.elements.time) for run in series), one.elements])
            for one, accurate in zip(samples, members, strict=True)
            for series in [accurate.models[: len(SERIES)]]
        ]

    def tip_error(self, run: ModelRun) -> float:
        """Return the largest error of the elements' tip, as a fraction of the accurate range."""
        accurate = self.accurate[0].elements
        distance = np.abs(run.tip - np.interp(run.time, accurate.time, accurate.tip))
        return float(distance[run.time <= CONFORMITY].max() / np.ptp(accurate.tip))


def factors(members: int) -> Array:
    """Return the load factors (num_members,) of the ensemble."""
    return 1.0 + perturbations(members, RELATIVE, SEED)


def _move(
    how: Numerics, duration: float, system: GapSystem, put_in: float, factor: float
) -> ModelRun:
    motion = vary_motion(Motion(system, duration, how.step), "load", factor)
    run = integrate(motion, how.scheme, how.iterated)
    return ModelRun.of(run.trajectory, put_in, float(run.unconverged[: run.finite_steps].mean()))


def _largest_difference(curves: Sequence[Array]) -> Array:
    """Return the largest difference (num_times,) of any two tips, as a fraction of the range."""
    return np.asarray(np.ptp(np.array(curves), axis=0) / max(np.ptp(one) for one in curves))
