# SPDX-License-Identifier: LGPL-3.0-or-later
"""Invented runs and sweeps, their summaries, printed tables and curves of the paper."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from rich.console import Console

from protractile.dynamics.equilibrium import equilibrium_at
from protractile.dynamics.trajectory import Trajectory
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case
from protractile.runs.cautions.rules import add_cautions
from protractile.runs.check import check_case
from protractile.runs.paper.rules import judge
from protractile.runs.paper.statements import STATEMENTS
from protractile.runs.paper.verdicts import Verdict
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.models import MotionPlan, build
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import Run, run_case
from protractile.runs.pipeline.summary import ModelSummary, StepsForPeaks, Summary
from protractile.runs.sweep import run as sweep
from protractile.runs.sweep.points import Plan
from protractile.runs.sweep.run import Outcome
from tests.runs.case_texts import shipped

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


PAPER = CASES / "paper.toml"
FIRST_CONTACT = 0.12
PERIOD = 1.1
# First tip peaks in m, of about the heights that the models have.
PEAKS = {
    "kantorovich-4": 0.169, "kantorovich-5": 0.171, "beam-fe": 0.184, "beam-fe-bonded": 0.019,
    "shell": 0.186,
}  # fmt: skip


def paper() -> Case:
    """Return the paper's case with these models, judged by all statements."""
    found = case_file.select(shipped("paper"), str(PAPER), list(PEAKS))
    return found.model_copy(update={"statements": tuple(STATEMENTS)})


def swing(height: float, duration: float = 10.0) -> np.ndarray:
    """Return a deflection that rises from rest and returns, at steps of 1 ms."""
    time = np.arange(round(duration * 1000) + 1) / 1000
    return height * 0.5 * (1.0 - np.cos(2.0 * np.pi * time / PERIOD))


def curves(duration: float = 10.0, **heights: float) -> dict[str, dict[str, np.ndarray]]:
    """Return tip and head of every model of the paper's case; heights by name, with _ for -.

    Up to the first contact, models with play are equal to ``kantorovich-5``. A head is a tenth of
    its tip, plus 0.3 of the difference of the model's own tip from it.
    """
    common, drawn = swing(0.171, duration), {}
    touching = np.arange(common.size) / 1000 > FIRST_CONTACT
    for name, peak in PEAKS.items():
        tip = swing(heights.get(name.replace("-", "_"), peak), duration)
        if name != "beam-fe-bonded":
            tip = common + touching * (tip - common)
        drawn[name] = {"tip": tip, "head": 0.1 * common + 0.3 * (tip - common)}
    return drawn


def verdicts(
    case: Case,
    motion: Mapping[str, Mapping[str, np.ndarray]],
    summary: Mapping[str, Mapping[str, Any]] | None = None,
    ensembles: xr.Dataset | None = None,
) -> dict[str, Verdict]:
    """Judge curves; ``summary`` replaces entries of the models' summaries."""
    places = ("tip", "head")
    data = xr.Dataset(
        {x: (("model", "time"), np.array([both[x] for both in motion.values()])) for x in places}
    )
    data = data.assign_coords(model=list(motion), time=np.arange(data.sizes["time"]) / 1000)
    horizons = {"horizons": {"0.01": 0.8, "0.2": 3.2}, "energy_residual": 1e-4, "slow_peaks": None}
    models = {}
    for name in motion:
        trajectory = Trajectory(data.sel(model=name), np.zeros((0, 0)))
        peaks = {place: trajectory.first_peak(place) for place in places}
        found = {"first_contact": FIRST_CONTACT, "first_peak": peaks, "energy_residual": 1.0e-4}
        own = (summary or {}).get(name, {})
        models[name] = model_summary(**found | {"ensemble": horizons} | dict(own))
    whole = summary_of(models, ensemble={"members": 32, "slow_below": 1.67})
    return {verdict.id: verdict for verdict in judge(Results(case, data, whole, ensembles))}


def verdict(
    key: str,
    motion: Mapping[str, Mapping[str, np.ndarray]] | None = None,
    summary: Mapping[str, Mapping[str, Any]] | None = None,
    tips: Mapping[str, np.ndarray] | None = None,
    case: Case | None = None,
) -> tuple[str, float | None, str]:
    """Judge one statement: the verdict, the number and the reason; usual curves unless given."""
    ensembles = None if tips is None else members(tips)
    alone = (case or paper()).model_copy(update={"statements": (key,)})
    found = verdicts(alone, motion or curves(), summary, ensembles)[key]
    return found.verdict, found.measured, found.why


def members(tips: Mapping[str, np.ndarray]) -> xr.Dataset:
    """Return ensembles from the tips (num_members, num_times) of members, by model name."""
    time = np.arange(next(iter(tips.values())).shape[1]) / 1000
    return xr.Dataset(
        {"tip": (("model", "member", "time"), np.array(list(tips.values())))},
        coords={"model": list(tips), "time": time},
    )


def stratifying(drift: float, early: float = 0.0, count: int = 32) -> dict[str, np.ndarray]:
    """Return members of all models with play that vibrate alike for six seconds.

    Each model is later than the previous one by ``early`` in s, and from six seconds on by
    ``drift`` more.
    """
    time = np.arange(10_001) / 1000
    delays = early + drift * np.clip(time - 6.0, 0.0, 1.0)
    peaks = {name: peak for name, peak in PEAKS.items() if name != "beam-fe-bonded"}
    waves = {
        name: peak * 0.5 * (1.0 - np.cos(2.0 * np.pi * (time - i * delays) / PERIOD))
        for i, (name, peak) in enumerate(peaks.items())
    }
    return {name: np.tile(wave, (count, 1)) for name, wave in waves.items()}
