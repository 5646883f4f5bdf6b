# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs and sweeps without files, and their summaries and printed tables."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from rich.console import Console

from protractile.dynamics.equilibrium import equilibrium_at
from protractile.dynamics.trajectory import Trajectory
from protractile.runs import CASES
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case
from protractile.runs.cautions.rules import add_cautions
from protractile.runs.check import check_case
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.models import MotionPlan, build
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import Run, run_case
from protractile.runs.pipeline.summary import ModelSummary, StepsForPeaks, Summary
from protractile.runs.sweep import run as sweep
from protractile.runs.sweep.points import Plan
from protractile.runs.sweep.run import Outcome

if TYPE_CHECKING:
    from mpi4py.MPI import Intracomm

PRESSED = 4500.0, 5000.0
_MODEL = {
    "kind": "kantorovich", "degrees_of_freedom": 4, "modes": 4, "frequencies": [1.0],
    "step": 4.2e-6, "steps": 2_380_952, "contact_changes": 2020, "first_contact": 0.11856,
    "first_peak": {"tip": [0.554, 0.16888]}, "peak_contact_force": 441_005.9,
    "energy_residual": 5.6e-5, "seconds": {"build": 0.1, "motion": 0.2},
}  # fmt: skip
# Measured horizons of a model.
HORIZONS = {
    "relatives": [1e-12, 1e-6], "shares": [0.01, 0.2], "times": [[1.5, 6.0], [1.0, None]],
    "of_step": [1.2, None], "rate": [27.63, None], "step_change": None,
    "limits": ["step", "physics"],
}  # fmt: skip


def model_summary(**changes: Any) -> ModelSummary:
    """Return the summary of a series, with given fields as in JSON."""
    return ModelSummary.model_validate(_MODEL | changes)


def steps_for_peaks(fewest: int | None) -> StepsForPeaks:
    """Return a result with three peaks that need this number of steps."""
    return StepsForPeaks(peaks=3, within=0.01, duration=4.0, fewest=fewest, trials=[])


def summary_of(models: Mapping[str, ModelSummary], **more: Any) -> Summary:
    """Return the summary of a run of these models."""
    plain = {"title": "A boom", "case_hash": "", "versions": {}, "failures": {}}
    return Summary.model_validate(plain | {"models": models} | more)


def changed(results: Results, model: str, **changes: Any) -> Results:
    """Return results with changed entries of a model in the summary."""
    summary = results.summary.model_copy(deep=True)
    for name, value in changes.items():
        setattr(summary.models[model], name, value)
    return replace(results, summary=summary)


def rubbing(case: Case, friction: float = 0.2, pressed: tuple[float, ...] = PRESSED) -> Case:
    """Return a case with friction in its joints under normal forces in N."""
    rubs = {"friction": friction, "normal_forces": pressed}
    joints = tuple(replace(joint, **rubs) for joint in case.joints)
    return case.model_copy(update={"joints": joints})


def printed(show: Callable[..., object], *given: Any, width: int = 160) -> str:
    """Return the text that a function prints to a console, its last argument, of a width."""
    console = Console(file=StringIO(), width=width)
    show(*given, console)
    assert isinstance(console.file, StringIO)
    return console.file.getvalue()


def printed_check(case: Case, width: int = 200) -> str:
    """Return the text that ``check`` prints of a case, to a console of a width."""
    return printed(partial(check_case(CheckedCase(case)).show, whole=True), width=width)


def finished(case: Case, context: RunContext | None = None) -> Run:
    """Return the run of a case with its design results and cautions."""
    run = run_case(case, "", context or RunContext())
    run.evaluate()
    add_cautions(run.results)
    return run


def answers_of(case: Case, comm: Intracomm | None = None) -> Results:
    """Return the results of a run of a case, as read from a folder."""
    with TemporaryDirectory() as folder:
        finished(case, RunContext(comm)).results.save(Path(folder) / "out")
        return Results.load(Path(folder) / "out")


def static_tip(case: Case, time: float = 0.0, tools: BuildContext | None = None) -> float:
    """Return the tip deflection in m of the case's first model at rest under loads at a time."""
    system = build(case, build_boom(case), case.models[0], tools).system.gather_loads()
    return float(system.observers["tip"].row @ equilibrium_at(system, time))


def motion_of(case: Case, number: int = 0) -> Trajectory:
    """Return the motion of one of a case's models, in the case's order."""
    model = case.models[number]
    return MotionPlan.of(build(case, build_boom(case), model).system, case, model).trajectory()


COARSE = CASES / "coarse.toml"
FAST = ["kantorovich-4", "beam-fe-bonded"]

Planned = Callable[..., Plan]


def run(planned: Plan, folder: Path = Path("out")) -> list[Outcome]:
    """Return all outcomes of a sweep, run in this process."""
    sweep.prepare(folder, planned.file)
    with ThreadPoolExecutor(1) as pool:
        return sweep.run_points(planned, folder, pool, lambda *_: None)
