# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cost of the time step and of ensembles: ``python -m studies.cost.bench``.

One process measures all times. Compared methods take turns, so that other programs on the machine
slow all of them alike.
"""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from rich.console import Console

from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import AdaptiveStep, FixedStep, Integrator
from protractile.dynamics.motion import Motion
from protractile.dynamics.predictability import integrate_ensemble
from protractile.geometry.arrays import Array
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.process.terminal import show_notices
from protractile.runs.report.tables import Table
from studies.cost import scaling
from studies.cost.generic_solvers import (
    TOLERANCES,
    compiled_rates,
    generic,
    match_tolerance,
)
from studies.cost.other_programs import PROBLEMS, other_programs
from studies.cost.telescoping import MODELS, telescoping
from studies.cost.timing import NOISE, time_in_turns, write_tables
from studies.motions import OUTPUT_STEP, friction_case, gap_system, model_of
from studies.study import wide_console

PAPER = CASES / "paper.toml"
OUT = Path("runs/out/bench")

# Goal for the wall time in s of the ensemble of series.
ENSEMBLE_GOAL = 10.0

# Steps in s, and the solvers that are compared at the same error or less.
LEVELS = (
    (1.0e-3, ("LSODA", "DOP853", "odeint")),
    (1.0e-4, ("LSODA", "DOP853", "Radau", "odeint")),
    (1.0e-5, ("LSODA", "DOP853", "odeint")),
    (1.0e-6, ("LSODA", "DOP853", "odeint")),
)

# Relative change of the members' loads.
CHANGE = 1.0e-9

# The step of an ensemble in s.
MEMBERS_STEP = 1.0e-4


class Sizes(NamedTuple):
    """Parameters of the measurements."""

    duration: float = 10.0  #: durations of ensembles and of telescoping booms in s
    #: Models with friction, their motion in s, its steps in s and the step of the converged one.
    models: Sequence[str] = ("kantorovich-5", "beam-fe", "timoshenko", "shell")
    regular: float = 5.0
    steps: Sequence[float] = (1.0e-3, 2.0e-4, 1.0e-4, 5.0e-5, 2.0e-5, 1.0e-5)
    converged: float = 2.5e-6
    early: float = (
        0.4  #: duration of the series without friction in s, before its motion is chaotic
    )
    #: Steps in s, and the solvers that each is compared with.
    levels: Sequence[tuple[float, Sequence[str]]] = LEVELS
    most: int = 3  #: repetitions of short runs
    #: Wall seconds of all repetitions of one run, beyond which there are no more.
    budget: float = 6.0
    members: int = 256  #: members of the ensemble of series
    shell_members: int = 32  #: members of the ensemble of shells, 0 for none
    telescoping: Sequence[str] = MODELS  #: models that telescope
    problems: Sequence[str] = tuple(PROBLEMS)  #: motions in other programs


class Method(NamedTuple):
    """Integration method for the series: name in the table, and function that integrates."""

    solver: str
    tolerance: str  #: relative tolerance, or step, as text
    error: float  #: error of the tip as a fraction of its range
    run: Callable[[], object]


def five_terms(case: Case) -> GapSystem:
    """Return the five-term series of a case."""
    return gap_system(case, build_boom(case), model_of(case, "kantorovich-5"))


def off(tip: Array, exact: Array) -> float:
    """Return the largest error of a tip deflection (num_times,), as a fraction of the range."""
    return float(np.abs(tip - exact).max() / np.ptp(exact))


def errors(sizes: Sizes) -> Table:
    """Return the table of errors and costs for several steps, of models with regular motion."""
    case, rows = friction_case(), []
    boom = build_boom(case)
    for name in sizes.models:
        if name == "shell" and not find_spec("dolfinx"):
            continue
        motion = Motion(gap_system(case, boom, model_of(case, name)), sizes.regular, OUTPUT_STEP)
        finest = FixedStep(sizes.converged)(motion)
        exact, (_, peak) = np.asarray(finest.data["tip"].values), finest.first_peak()
        ways: list[FixedStep | AdaptiveStep] = [*map(FixedStep, sizes.steps), AdaptiveStep()]
        seconds = time_in_turns([partial(way, motion) for way in ways], sizes.most, sizes.budget)
        for way, taken in zip(ways, seconds, strict=True):
            begin = process_time()
            run = way(motion)
            cpu = process_time() - begin
            attributes, tip = run.data.attrs, np.asarray(run.data["tip"].values)
            asked = f"{way.step:g} s" if isinstance(way, FixedStep) else f"to {way.tolerance:g}"
            rows.append(
                (name, motion.system.num_modes, asked, attributes["steps"],
                 100.0 * off(tip, exact), 100.0 * abs(run.first_peak()[1] / peak - 1.0),
                 run.energy_residual, taken, cpu)
            )  # fmt: skip
    columns = {
        "model": "", "modes": ".0f", "step": "", "steps": ".0f", "tip off (% of range)": ".2g",
        "first peak off (%)": ".1g", "energy residual": ".1g", "wall s": "", "CPU s": ".2g",
    }  # fmt: skip
    return Table.of_rows(
        "errors",
        f"The time step, {sizes.regular:g} s of the paper's boom with friction",
        columns,
        rows,
        (
            f"Off the motion in steps of {sizes.converged:g} s. To a tolerance, whole motions are "
            "compared until half the steps change each recorded deflection by less.",
        ),
    )


def compare(case: Case, sizes: Sizes) -> Table:
    """Return the table that compares the time step with generic solvers of at most its error."""
    system = five_terms(case)
    motion, row = Motion(system, sizes.early, OUTPUT_STEP), system.observers["tip"].row
    rates, rows, failed = compiled_rates(system), [], []

    def solved(name: str, tolerance: float) -> Array:
        states = generic(name, rates, 2 * system.num_modes, sizes.early, tolerance)
        return np.asarray(states[:, : system.num_modes] @ row)

    def error(name: str, tolerance: float) -> float:
        return off(solved(name, tolerance), exact)

    exact = solved("DOP853", float(TOLERANCES[-1]))
    for step, solvers in sizes.levels:
        ours = partial(FixedStep(step), motion)
        target = off(np.asarray(ours().data["tip"].values), exact)
        methods = [Method("time step", f"{step:g} s", target, ours)]
        for name in solvers:
            loosest, least = match_tolerance(partial(error, name), target)
            if loosest is None:
                failed.append(f"{name} errs more than a step of {step:g} s, by {least:.1e}.")
                continue
            run = partial(solved, name, loosest)
            methods.append(Method(name, f"{loosest:.1e}", least, run))
        seconds = time_in_turns([method.run for method in methods], sizes.most, sizes.budget)
        for method, taken in zip(methods, seconds, strict=True):
            ratios = [theirs / mine for theirs, mine in zip(taken, seconds[0], strict=False)]
            rows.append((*method[:-1], taken, ratios))
    columns = {
        "solver": "", "tolerance": "", "tip off (of range)": ".1e",
        "wall s": "", "over the time step": "",
    }  # fmt: skip
    return Table.of_rows(
        "solvers",
        f"Five-term series without friction, {sizes.early:g} s, at equal error of the tip",
        columns,
        rows,
        [
            *failed,
            "The time step also labels its outputs and their energies; the others leave states by "
            "a compiled right-hand side, with absolute tolerances of a thousandth.",
        ],
    )


def ensembles(case: Case, sizes: Sizes) -> Table:
    """Return the table of the cost of ensembles for several numbers of threads."""
    cores = len(os.sched_getaffinity(0))

    def run(whole: GapSystem, count: int, integrator: Integrator, threads: int) -> None:
        motion = Motion(whole, sizes.duration, OUTPUT_STEP)
        with ThreadPoolExecutor(threads) as pool:
            integrate_ensemble(
                motion, count, CHANGE, 0, "load", integrator=integrator, executor=pool
            )

    fixed, members, series = FixedStep(MEMBERS_STEP), sizes.members, five_terms(case)
    name, of_shells = f"{members} five-term series", f"{sizes.shell_members} shells"
    what = [
        *((name, n, partial(run, series, members, fixed, n)) for n in sorted({1, cores})),
        (f"{name}, to a tolerance", cores, partial(run, series, members, AdaptiveStep(), cores)),
    ]
    if sizes.shell_members and find_spec("dolfinx"):
        shell = gap_system(case, build_boom(case), model_of(case, "shell"))
        what.append((of_shells, cores, partial(run, shell, sizes.shell_members, fixed, cores)))
    seconds = time_in_turns([made for _, _, made in what], sizes.most, sizes.budget)
    fastest = min(median(taken) for taken in seconds[: len({1, cores})])
    goal = "reached" if fastest <= ENSEMBLE_GOAL else "not reached"
    return Table.of_rows(
        "ensembles",
        f"Ensembles, {sizes.duration:g} s in steps of {MEMBERS_STEP:g} s, loads within {CHANGE:g}",
        {"ensemble": "", "threads": ".0f", "repetitions": ".0f", "wall s": ""},
        [
            (name, threads, len(taken), taken)
            for (name, threads, _), taken in zip(what, seconds, strict=True)
        ],
        (f"The goal of {ENSEMBLE_GOAL:g} s for the series is {goal}.", NOISE),
    )


def bench(sizes: Sizes, folder: Path, console: Console) -> None:
    """Measure all costs, print the tables, and write ``bench.json`` and ``bench.md``."""
    case = case_file.load(str(PAPER))
    parts: list[Callable[[], Table]] = [
        partial(errors, sizes),
        partial(compare, case, sizes),
        partial(ensembles, case, sizes),
        partial(telescoping, sizes.telescoping, sizes.duration),
        partial(other_programs, sizes.most, sizes.budget, sizes.problems),
    ]
    machine = {"cores": len(os.sched_getaffinity(0)), "python": platform.python_version()}
    data: dict[str, Any] = {"sizes": sizes._asdict(), "machine": machine}
    write_tables(
        folder, "bench", "What the time step costs", data, (part() for part in parts), console
    )


if __name__ == "__main__":
    show_notices()
    shown_on = wide_console()
    bench(Sizes(), OUT, shown_on)
    scaling.scaling(scaling.Sizes(), scaling.OUT, shown_on)
