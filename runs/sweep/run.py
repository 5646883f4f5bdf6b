# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs of the points of a sweep on all cores or ranks, with a cache of finished points.

The cache is in the folder of the sweep. The key of a point is the hash of its case, of the program
and of the libraries. A later sweep in this folder does not repeat finished points.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, field
from pathlib import Path

from protractile.dynamics.failure import NumericsError
from protractile.runs.case import toml
from protractile.runs.case.schema import Case
from protractile.runs.case.user_files import check_not_working_folder
from protractile.runs.folder.cache import Cache, key
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.quantities import Quantities
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import run_case
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.ending import when_interrupted
from protractile.runs.process.ranks import single_rank
from protractile.runs.process.terminal import Progress, message, say, shorten
from protractile.runs.process.workers import end
from protractile.runs.sweep.distances import Features, comparison_end
from protractile.runs.sweep.points import Plan

POINTS = "points"


@dataclass(frozen=True, slots=True)
class Outcome:
    """Results at a point of a sweep, by model name."""

    models: dict[str, Quantities]  #: quantities of the completed models
    failures: dict[str, str]  #: reasons why other models failed
    #: Differences from the reference model; empty without a reference.
    differences: dict[str, Quantities] = field(default_factory=dict)
    until: float | None = None  #: time in s up to which tips are compared, if they are


def prepare(folder: Path, file: str) -> None:
    """Create the folder of a sweep, or check that an existing folder belongs to a sweep.

    Raises:
        BadInput: the folder contains other files, or is the current directory.
        OSError: the folder cannot be created.
    """
    key = f"--out {folder}"
    if folder.is_dir() and not (folder / POINTS).is_dir() and any(folder.iterdir()):
        raise BadInput(
            file, key, "contains other files; give a new folder or one of an earlier sweep"
        )
    check_not_working_folder(folder, file, key)
    (folder / POINTS).mkdir(parents=True, exist_ok=True)


def run_points(
    plan: Plan,
    folder: Path,
    pool: Executor,
    progress: Progress,
    cache: Cache | None = None,
) -> list[Outcome]:
    """Run the points that are not in the cache of the folder, and return the outcomes of all.

    ``cache`` is that of reduced shells.

    Raises:
        MemoryError: the system killed a process.
    """
    points, reference = plan.points, plan.reference
    point_cache = Cache(folder / POINTS)
    names = [key(toml.digest(point.case), reference) for point in points]
    outcomes = [point_cache.load(name, Outcome) for name in names]
    stage = f"{len(points)} points"
    futures = {
        pool.submit(run_point, point.case, cache, reference): i
        for i, point in enumerate(points)
        if outcomes[i] is None
    }
    finished = len(points) - len(futures)
    progress("sweep", stage, finished / len(points))
    try:
        # An interrupt ends the processes, whose results are not needed.
        with when_interrupted(end):
            for future in as_completed(futures):
                i = futures[future]
                outcomes[i] = outcome = future.result()
                point_cache.store(names[i], outcome)
                finished += 1
                progress("sweep", stage, finished / len(points))
    except BrokenProcessPool:
        raise MemoryError("the system has killed a process of the sweep") from None
    finally:
        for future in futures:
            future.cancel()
    return [outcome for outcome in outcomes if outcome is not None]


def run_point(case: Case, cache: Cache | None = None, reference: str | None = None) -> Outcome:
    """Run each model of a case by itself, and return the results and the reasons of failures."""
    models: dict[str, Quantities] = {}
    failures: dict[str, str] = {}
    runs: dict[str, Results] = {}
    comm = single_rank(case.first_shell)
    for model in case.models:
        case_of_model = case.model_copy(update={"models": (model,)})
        try:
            finished = run_case(case_of_model, "", RunContext(comm, cache=cache))
        except NumericsError as error:
            # The line that is printed names the file, the point and the model itself.
            failures[model.name] = str(error).removeprefix(": model[1]: ")
            continue
        assert finished is not None
        finished.evaluate_with_play()
        # Design results may fail after a successful motion.
        failures.update(finished.results.summary.failures)
        models[model.name] = finished.results.measure(model.name)
        if reference is not None:
            runs[model.name] = finished.results
    if reference not in runs:
        return Outcome(models, failures)
    (reference_model,) = (model for model in case.models if model.name == reference)
    until = comparison_end(case, reference_model, runs[reference], comm, cache)
    features = {
        name: Features.of(results, name, models[name]["stress"], until)
        for name, results in runs.items()
    }
    reference_features = features.pop(reference)
    differences = {
        name: feature.distances_from(reference_features) for name, feature in features.items()
    }
    return Outcome(models, failures, differences, until)


def print_failures(plan: Plan, outcomes: Sequence[Outcome]) -> int:
    """Print a line for each failed model; return 3 if all models of all points failed, else 0."""
    for point, outcome in zip(plan.points, outcomes, strict=True):
        for model, why in outcome.failures.items():
            say(message(f"{shorten(plan.file)}: --vary {point.label}: {model}: {why}"))
    return 0 if any(outcome.models for outcome in outcomes) else 3
