# SPDX-License-Identifier: LGPL-3.0-or-later
"""From a case to results: every model becomes a gap system, moves, and is summed up."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property, partial
from time import perf_counter

import numpy as np
import xarray as xr

from dynamics.failure import NUMERICS, NumericsError
from dynamics.gap_system import GapSystem
from dynamics.trajectory import Trajectory
from geometry.boom import Boom
from runs.case import toml
from runs.case.build import build_boom
from runs.case.kinds.model import Built, Workshop
from runs.case.schema import Case, Model
from runs.folder.versions import versions
from runs.pipeline import members
from runs.pipeline.answering import of_model, of_run
from runs.pipeline.answers import ModelAnswers
from runs.pipeline.beam_output import BeamOutput
from runs.pipeline.card import card
from runs.pipeline.comparisons import compare_models
from runs.pipeline.fewest_steps import steps_for_peaks
from runs.pipeline.finished import Finished, finished
from runs.pipeline.means import Means, Progress
from runs.pipeline.models import build
from runs.pipeline.motion import Plan
from runs.pipeline.proportions import static_tip
from runs.pipeline.results import CONVENTIONS, Results, label
from runs.pipeline.shell_output import ShellOutput
from runs.pipeline.summary import Ensembles, ModelSummary, Peak, Summary, check_finite


class Stages:
    """The stages of one model, how far each is, and the wall time of those that are done in s."""

    def __init__(self, model: str, progress: Progress) -> None:
        self.tell = partial(progress, model)
        self.seconds: dict[str, float] = {}
        self.begin = perf_counter()

    @contextmanager
    def stage(self, name: str) -> Iterator[Callable[[float], None]]:
        """Tells the part of a stage that is done."""
        begin = perf_counter()
        self.tell(name, 0.0)
        yield partial(self.tell, name)
        self.tell(name, 1.0)
        self.seconds[name] = perf_counter() - begin


@dataclass(frozen=True, slots=True)
class Ran:
    """A model as it was built, its motion, what a shell leaves, and how long all that took."""

    model: Model
    built: Built
    moved: Finished
    shell: ShellOutput | None
    stages: Stages


@dataclass(frozen=True)
class Run:
    """Results, and by their names the models that have moved."""

    results: Results
    ran: dict[str, Ran]

    @property
    def shells(self) -> dict[str, ShellOutput]:
        """What each shell leaves."""
        return {name: one.shell for name, one in self.ran.items() if one.shell is not None}

    @cached_property
    def beams(self) -> dict[str, BeamOutput]:
        """What each beam leaves."""
        boom = self.results.boom
        return {
            name: BeamOutput.of(one.model.lines(boom, one.built), one.moved.trajectory)
            for name, one in self.ran.items()
            if one.shell is None
        }

    def answer(self) -> None:
        """Put what a designer asks, answered, and what the results are not worth, into the summary.

        A model that has moved and cannot be answered for is in ``failures``, too.

        Raises:
            NumericsError: what models share, such as their comparisons, is not finite.
        """
        case, boom, summary = self.results.case, self.results.boom, self.results.summary
        answers = {}
        for name, ran in self.ran.items():
            own = summary.models[name]
            with ran.stages.stage("answers"), np.errstate(all="ignore"):
                try:
                    answers[name] = of_model(
                        boom, case, ran.model, ran.built, ran.moved.trajectory, ran.shell
                    )
                    check_finite(answers[name])
                except NUMERICS as error:
                    summary.failures[name], answers[name] = _reason(error), ModelAnswers()
            own.seconds = ran.stages.seconds
            own.wall_time = (own.wall_time or 0.0) + own.seconds["answers"]
        summary.answers = of_run(boom, case, summary, answers)
        self.results.conclude()
        check_finite(summary)


def run_case(case: Case, file: str, means: Means) -> Run | None:
    """Run all models of a case; answers are left to :meth:`Run.answer`. Collective.

    None but on rank 0. A model that cannot be computed is in the summary's ``failures``, by its
    name, with the reason.

    Args:
        case: a checked one.
        file: how messages call it.
        means: of the run.

    Raises:
        NumericsError: no model can be computed, or a shell that several ranks share.
    """
    boom = build_boom(case)
    cutoff = None if case.ensemble is None else members.slow_below(boom, case.time)

    def run_model(model: Model) -> Ran | None:
        # What overflows is found where it matters, and said there.
        with np.errstate(all="ignore"):
            return _run_model(boom, model, case, cutoff, means)

    ran: dict[str, Ran] = {}
    failures: dict[str, str] = {}
    first_failure = None
    runs = (_beams_beside_shells if means.alone else _one_by_one)(case.models, run_model)
    for number, model in enumerate(case.models, start=1):
        try:
            outcome = runs[model.name]()
            if outcome is not None:
                check_finite(outcome.moved.summary)
        except NUMERICS as error:
            failures[model.name] = why = _reason(error)
            first_failure = first_failure or NumericsError(f"{file}: model[{number}]: {why}")
            continue
        except _SharedFailure as error:
            raise NumericsError(f"{file}: model[{number}]: {error}") from error
        if outcome is not None:
            ran[model.name] = outcome
    if not means.first_rank:
        return None
    if first_failure is not None and not ran:
        raise first_failure
    moved = {name: one.moved for name, one in ran.items()}
    return Run(_results(boom, case, cutoff, moved, failures), ran)


def _results(
    boom: Boom,
    case: Case,
    cutoff: float | None,
    moved: Mapping[str, Finished],
    failures: dict[str, str],
) -> Results:
    """What the motions of a case leave, summed up."""
    summary = Summary(
        title=case.title,
        case_hash=toml.digest(case),
        versions=versions(),
        models={name: one.summary for name, one in moved.items()},
        failures=failures,
    )
    # Every file says which case it is of, so that a folder cannot mix two runs unnoticed.
    trajectories = {name: one.trajectory for name, one in moved.items()}
    data = label(boom, trajectories).assign_attrs(case_hash=summary.case_hash)
    ensembles = _ensembles(data, moved)
    if case.ensemble is not None and ensembles is not None:
        summary.ensemble = Ensembles(**case.ensemble.model_dump(), slow_below=cutoff)
    summary.comparisons = compare_models(case, data, ensembles, cutoff)
    return Results(case, data, summary, ensembles)


def _ensembles(data: xr.Dataset, moved: Mapping[str, Finished]) -> xr.Dataset | None:
    """Those of all models, with the attributes of the trajectories."""
    found = members.gather(
        {name: one.ensemble for name, one in moved.items() if one.ensemble is not None}
    )
    if found is None:
        return None
    for name, values in found.data_vars.items():
        values.attrs.update(data[name].attrs)
    return found.assign_attrs(Conventions=CONVENTIONS, case_hash=data.attrs["case_hash"])


# Gives what a model leaves, or raises what has kept it from that.
_Outcome = Callable[[], "Ran | None"]


def _one_by_one(
    models: Sequence[Model], run: Callable[[Model], Ran | None]
) -> Mapping[str, _Outcome]:
    """When asked for, by the model's name."""
    return {model.name: partial(run, model) for model in models}


def _beams_beside_shells(
    models: Sequence[Model], run: Callable[[Model], Ran | None]
) -> Mapping[str, _Outcome]:
    """Of all, beams while shells are made: their compiled loops do not hold the interpreter."""
    shells = [model for model in models if model.needs_shell]
    if not shells:
        return _one_by_one(models, run)
    with ThreadPoolExecutor(1) as thread:
        moving = {m.name: thread.submit(run, m).result for m in models if not m.needs_shell}
        try:
            made = {model.name: _ended(run, model).result for model in shells}
        except BaseException:
            # Whoever interrupts does not wait for all beams.
            thread.shutdown(cancel_futures=True)
            raise
    return moving | made


def _ended(run: Callable[[Model], Ran | None], model: Model) -> Future[Ran | None]:
    ended: Future[Ran | None] = Future()
    try:
        ended.set_result(run(model))
    except Exception as error:
        ended.set_exception(error)
    return ended


class _SharedFailure(Exception):
    """Of one of several ranks, for which the others may wait in the middle of their own work."""


def _reason(error: Exception) -> str:
    """Why a model has failed."""
    if isinstance(error, NumericsError):
        return str(error)
    return (
        f"cannot be computed ({error}); look for a number of the case that is out of proportion, "
        "in another unit say"
    )


def _run_model(
    boom: Boom,
    model: Model,
    case: Case,
    cutoff: float | None,
    means: Means,
) -> Ran | None:
    """What a model leaves, on rank 0; None elsewhere."""
    comm, stages = means.comm, Stages(model.name, means.progress)
    if model.needs_shell or means.first_rank:
        tools = None if comm is None else Workshop(comm, stages.tell, means.cache)
        try:
            built = build(case, boom, model, tools)
        except NUMERICS as error:
            if means.alone or not model.needs_shell:
                raise
            raise _SharedFailure(_reason(error)) from error
        stages.seconds |= built.seconds
    with members.workers(comm if case.ensemble else None) as executor:
        if not means.first_rank:
            return None
        alone = case.unjudged().model_copy(update={"models": (model,), "title": ""})
        system = built.system
        content = toml.digest(alone), system.omega2, system.load, system.rows, cutoff
        moving = Stages(model.name, means.progress)
        moved = finished(
            means.kept, content, lambda: _move(built, model, case, cutoff, executor, moving)
        )
    summary, reduced = moved.summary, built.shell
    if boom.compressed:
        summary.critical_factor = built.critical_factor
    if built.calibration is not None:
        summary.calibration = card(boom, system, built.calibration)
    # Those of a motion that is kept are what it has taken.
    stages.seconds |= summary.seconds
    shell = None
    if reduced is not None:
        summary.reduction_errors = dict(reduced.errors)
        summary.local_compliance = list(reduced.local_compliance)
        summary.mesh_error = reduced.mesh_error
        with stages.stage("stress"):
            shell = ShellOutput.of(boom, model.name, reduced, moved.trajectory)
        summary.stress = shell.largest
    summary.seconds, summary.wall_time = stages.seconds, perf_counter() - stages.begin
    return Ran(model, built, moved, shell, stages)


def _move(
    built: Built,
    model: Model,
    case: Case,
    cutoff: float | None,
    executor: Executor | None,
    stages: Stages,
) -> Finished:
    """Move a model; measure its step error, its ensemble and its horizons."""
    plan = Plan.of(built.system, case, model)
    motion, system = plan.motion, plan.motion.system
    plan.warm()
    with stages.stage("motion") as told:
        trajectory = plan.trajectory(told)
    summary = _summary(model, system, trajectory, built.num_dofs)
    if stick_slip := trajectory.data.attrs.get("stick_slip"):
        summary.stick_slip = stick_slip
    if summary.step_error is None and system.frictions and case.regular:
        with stages.stage("twice the step") as told:
            summary.step_error = plan.step_error(trajectory, told)
    ensemble = None
    if case.ensemble is not None and system.laws:
        with stages.stage("ensemble") as told:
            ensemble = plan.ensemble(case.ensemble, trajectory, executor, told)
        peaks = members.common_peaks(ensemble, cutoff)
        summary.ensemble = members.sum_up(ensemble, peaks)
        with stages.stage("horizons") as told:
            summary.horizons = plan.horizons(case.ensemble, trajectory, executor, told)
        if cutoff is not None and peaks is not None and motion.from_rest:
            with stages.stage("step counts"):
                summary.steps_for_peaks = steps_for_peaks(motion, peaks, cutoff)
    summary.seconds = stages.seconds
    return Finished(trajectory, summary, ensemble)


def _summary(
    model: Model,
    system: GapSystem,
    trajectory: Trajectory,
    num_dofs: int,
) -> ModelSummary:
    attributes = trajectory.data.attrs
    peaks = np.abs(trajectory.data["contact_force_peak"].values)
    return ModelSummary(
        kind=model.kind,
        degrees_of_freedom=num_dofs,
        modes=system.num_modes,
        frequencies=system.frequencies[:6].tolist(),
        seconds={},
        step=attributes["step"],
        steps=attributes["steps"],
        first_contact=trajectory.first_contact,
        contact_changes=attributes["contact_changes"],
        energy_residual=attributes["energy_residual"],
        first_peak={
            name: Peak(*trajectory.first_peak(name))
            for name in ("tip", "head", "tip_lateral")
            if name in trajectory.data
        },
        peak_contact_force=float(peaks.max()) if peaks.size else None,
        step_error=attributes["step_error"],
        resolving_step=attributes["resolving_step"],
        static_tip=static_tip(system),
    )
