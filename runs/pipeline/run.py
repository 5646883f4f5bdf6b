# SPDX-License-Identifier: LGPL-3.0-or-later
"""The run of a case: construction, integration and summary of every model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from threading import Lock

import numpy as np

from protractile.analysis.rows import Rows
from protractile.dynamics.failure import NUMERICAL_ERRORS, NumericsError
from protractile.geometry.boom import Boom
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case, Model
from protractile.runs.folder.versions import versions
from protractile.runs.pipeline import members
from protractile.runs.pipeline.design_results import DesignResults, ModelDesignResults
from protractile.runs.pipeline.evaluation import (
    Evaluation,
    evaluate_both,
    evaluate_model,
    evaluate_run,
)
from protractile.runs.pipeline.model_output import BeamOutput, ShellOutput
from protractile.runs.pipeline.model_quality import compare_models
from protractile.runs.pipeline.model_run import (
    CompletedMotion,
    ModelRun,
    RunContext,
    SharedFailure,
    failure_reason,
    run_model,
)
from protractile.runs.pipeline.results import CONVENTIONS, Results, label
from protractile.runs.pipeline.summary import Ensembles, Summary, check_finite


@dataclass(frozen=True)
class Run:
    """Results of a run, and its models with their motions by name."""

    results: Results
    model_runs: dict[str, ModelRun]
    #: results with play, by model; those of models that are left out are computed when needed
    found: dict[str, Evaluation] = field(default_factory=dict)

    @property
    def shells(self) -> dict[str, ShellOutput]:
        """The output of each shell, by name."""
        return {name: run.shell for name, run in self.model_runs.items() if run.shell is not None}

    @cached_property
    def beams(self) -> dict[str, BeamOutput]:
        """The output of each beam, by name."""
        boom = self.results.boom
        return {
            name: BeamOutput.of(run.model.lines(boom, run.built), run.motion.trajectory)
            for name, run in self.model_runs.items()
            if run.shell is None
        }

    def evaluate(self) -> None:
        """Add rows, curves and design results to the results.

        A model whose design results cannot be computed is added to ``failures``.

        Raises:
            NumericsError: a comparison of the models is not finite.
        """
        evaluate_run(self.results, self._evaluate_models(without_play=True))
        check_finite(self.results.summary)

    def evaluate_with_play(self) -> None:
        """Add rows and design results of the models with play to the results."""
        results, evaluations = self.results, self._evaluate_models(without_play=False)
        results.rows = Rows(row for evaluation in evaluations.values() for row in evaluation.rows)
        designs = {name: evaluation.design for name, evaluation in evaluations.items()}
        results.summary.design = DesignResults(designs)
        check_finite(results.summary)

    def _evaluate_models(self, without_play: bool) -> dict[str, Evaluation]:
        """Return the results of each model by name, with those ``without_play`` if requested."""
        case, boom, summary = self.results.case, self.results.boom, self.results.summary
        evaluations = {}
        for name, ran in self.model_runs.items():
            model_summary = summary.models[name]
            with ran.stages.stage("design results"), np.errstate(all="ignore"):
                try:
                    found = self.found.get(name) or evaluate_model(boom, case, ran)
                    if without_play:
                        found = evaluate_both(boom, case, ran, found)
                    check_finite([found.rows, found.design])
                    evaluations[name] = found
                except NUMERICAL_ERRORS as error:
                    summary.failures[name] = failure_reason(error)
                    evaluations[name] = Evaluation([], [], [], ModelDesignResults())
            seconds = ran.stages.seconds
            model_summary.seconds = seconds
            model_summary.wall_time = (model_summary.wall_time or 0.0) + seconds["design results"]
        return evaluations


def run_case(
    case: Case, file: str, context: RunContext, show: Callable[[Results], None] | None = None
) -> Run | None:
    """Run all models of a case; return None except on rank 0. Collective.

    After each model, ``show`` receives results of the models with play that have finished.

    :meth:`Run.evaluate` adds the design results. ``failures`` in the summary has the models that
    cannot be computed, with the reasons. ``file`` is the name of the case in messages.

    Raises:
        NumericsError: no model can be computed, or a shell fails that several ranks share.
    """
    boom = build_boom(case)
    cutoff = None if case.ensemble is None else members.slow_cutoff(boom, case.time)
    found: dict[str, Evaluation] = {}
    motions: dict[str, CompletedMotion] = {}
    lock = Lock()

    def attempt(model: Model) -> ModelRun | Exception | None:
        # Results are checked for overflow at the end.
        with np.errstate(all="ignore"):
            try:
                run = run_model(boom, model, case, cutoff, context)
                if run is not None:
                    check_finite(run.motion.summary)
                    if show is not None:
                        # If they cannot be computed, the evaluation of the run tells why.
                        with suppress(*NUMERICAL_ERRORS), run.stages.stage("design results"):
                            found[model.name] = evaluate_model(boom, case, run)
                        with lock:
                            motions[model.name] = run.motion
                            show(_first_results(boom, case, motions, found))
                return run
            except NUMERICAL_ERRORS as error:
                return error
            except SharedFailure as error:
                number = 1 + case.models.index(model)
                raise NumericsError(f"{file}: model[{number}]: {error}") from error

    outcomes = _attempt_all(case.models, attempt, context)
    if not context.first_rank:
        return None
    ran = {name: outcome for name, outcome in outcomes.items() if isinstance(outcome, ModelRun)}
    failures = {
        name: failure_reason(outcome)
        for name, outcome in outcomes.items()
        if isinstance(outcome, Exception)
    }
    for number, model in enumerate(case.models, start=1):
        if not ran and model.name in failures:
            raise NumericsError(f"{file}: model[{number}]: {failures[model.name]}")
    motions = {name: model_run.motion for name, model_run in ran.items()}
    return Run(_results(boom, case, cutoff, motions, failures), ran, found)


def _first_results(
    boom: Boom,
    case: Case,
    motions: Mapping[str, CompletedMotion],
    found: Mapping[str, Evaluation],
) -> Results:
    """Return the results with play of the models that have finished, in the order of the case."""
    names = [model.name for model in case.models if model.name in {*motions} & {*found}]
    summary = Summary(
        title=case.title,
        case_hash="",
        versions={},
        models={name: motions[name].summary for name in names},
        failures={},
        design=DesignResults({name: found[name].design for name in names}),
    )
    data = label(boom, {name: motions[name].trajectory for name in names})
    rows = Rows(row for name in names for row in found[name].rows)
    return Results(case, data, summary, rows=rows)


def _results(
    boom: Boom,
    case: Case,
    cutoff: float | None,
    motions: Mapping[str, CompletedMotion],
    failures: dict[str, str],
) -> Results:
    """Return the results of a run from the motions of its models."""
    summary = Summary(
        title=case.title,
        case_hash=toml.digest(case),
        versions=versions(),
        models={name: motion.summary for name, motion in motions.items()},
        failures=failures,
    )
    # Every file has the hash of its case, so that files of another run are detected.
    trajectories = {name: motion.trajectory for name, motion in motions.items()}
    data = label(boom, trajectories).assign_attrs(case_hash=summary.case_hash)
    ensembles = members.gather_ensembles(
        {name: motion.ensemble for name, motion in motions.items() if motion.ensemble is not None}
    )
    if case.ensemble is not None and ensembles is not None:
        for name, values in ensembles.data_vars.items():
            values.attrs.update(data[name].attrs)
        ensembles.attrs |= {"Conventions": CONVENTIONS, "case_hash": summary.case_hash}
        summary.ensemble = Ensembles(**case.ensemble.model_dump(), slow_below=cutoff)
    summary.comparisons = compare_models(case, data, ensembles, cutoff)
    return Results(case, data, summary, ensembles)


def _attempt_all(
    models: Sequence[Model],
    attempt: Callable[[Model], ModelRun | Exception | None],
    context: RunContext,
) -> dict[str, ModelRun | Exception | None]:
    """Return the result or the failure of each model, in the order of the models.

    On a single rank a thread runs the beams while shells are built, since the compiled time loop
    releases the interpreter lock.
    """
    if not context.alone or not any(model.needs_shell for model in models):
        return {model.name: attempt(model) for model in models}
    with ThreadPoolExecutor(1) as thread:
        beams = {m.name: thread.submit(attempt, m) for m in models if not m.needs_shell}
        for name in context.writers:
            thread.submit(import_module, name)
        try:
            shell_runs = {model.name: attempt(model) for model in models if model.needs_shell}
        except BaseException:
            # After an interrupt, remaining beams are cancelled.
            thread.shutdown(cancel_futures=True)
            raise
        return {
            m.name: shell_runs[m.name] if m.needs_shell else beams[m.name].result() for m in models
        }
