# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the integrators cost, and what a shell does: ``python -m runs.studies.cost.bench``.

Everything is measured in one process; methods that are compared take turns, so that what else
the machine does falls on all of them.
"""

from __future__ import annotations

import math
import os
import platform
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from dynamics.integrators.event_driven import TOLERANCE
from dynamics.integrators.integrator import Events, Integrator, by_splitting
from dynamics.integrators.splitting import integrate
from rich.console import Console

from dynamics.contact import PowerContact
from dynamics.gap_system import GapSystem
from dynamics.motion import Motion
from dynamics.predictability.ensemble import integrate_ensemble
from runs import CASES
from runs.case import reading as case_file
from runs.case.build import build_boom
from runs.case.schema import Case
from runs.pipeline.models import build
from runs.process import notices
from runs.report.numerals import repeated
from runs.report.tables import Table, wide_console
from runs.studies.cost import scaling
from runs.studies.cost.drawing import MODELS, drawing
from runs.studies.cost.generic_solvers import (
    METHODS,
    OUTPUT_STEP,
    array_rates,
    compiled_rates,
    generic,
    matched,
)
from runs.studies.cost.leaving import leaving
from runs.studies.cost.timing import NOISE, by_turns, leave
from runs.studies.motions import gap_system, model_of, shell_of

PAPER = CASES / "paper.toml"
OUT = Path("runs/out/bench")

# Goals: wall time of the best of solve_ivp over ours, and wall s of the ensemble of series.
RATIO_GOAL = 250.0
ENSEMBLE_GOAL = 10.0

# Tolerances of event-driven motion, the last as it comes, and solvers that are to leave no more
# energy. LSODA takes the least time of solve_ivp as long as it can; then DOP853 alone can.
LEVELS = (
    (1.0e-6, ("LSODA", "odeint")),
    (1.0e-8, ("LSODA", "Radau", "odeint")),
    (TOLERANCE, ("LSODA", "DOP853", "odeint")),
)

# What takes tens of seconds for a second of motion is measured over the first one alone.
SLOW = ("Radau",)

# The right-hand sides: as one writes it, and compiled with its data as constants.
NUMPY = "NumPy"
COMPILED = "compiled"

# Relative change of the members' loads.
CHANGE = 1.0e-9

# The step of the splitting that is timed, in s: below a hundredth of the highest mode's period.
STEP = 1.0e-6


@dataclass(frozen=True, slots=True)
class Sizes:
    """How much is measured."""

    duration: float = 10.0  #: of the motions in s
    slow_duration: float = 0.5  #: of those by ``SLOW`` solvers
    #: Tolerance of event-driven motion, and the solvers that it is compared with.
    levels: Sequence[tuple[float, Sequence[str]]] = LEVELS
    most: int = 3  #: repetitions of what is quick
    #: Wall seconds of all repetitions of one run, beyond which there are no more.
    budget: float = 6.0
    #: The tables of steps and series.
    modes: Sequence[int] = (5, 20, 80, 200)
    rows: Sequence[int] = (2, 4, 16)
    updates: int = 5_000_000  #: of one mode by one step, that are timed for an entry of the former
    members: int = 256  #: of the ensemble of series
    shell_members: int = 32  #: of the ensemble of shells, 0 for none
    #: Models of a run whose leaving is timed.
    left: Sequence[str] = ("series", "timoshenko", "shell")
    drawn: Sequence[str] = MODELS  #: models that are drawn out


@dataclass(frozen=True, slots=True)
class Method:
    """A way to move the series."""

    solver: str  #: what the table calls it
    rates: str  #: its right-hand side, where it needs one
    tolerance: str  #: relative tolerance, or step, as text
    duration: float  #: of the motion in s
    energy_residual: float  #: that it leaves
    run: Callable[[], object]  #: moves it once


def five_terms(case: Case) -> GapSystem:
    """The paper's five-term series."""
    return build(case, build_boom(case), model_of(case, "kantorovich-5")).system


def compare(case: Case, tolerance: float, solvers: Sequence[str], sizes: Sizes) -> Table:
    """Event-driven motion at a tolerance against generic solvers that leave no more energy."""
    system = five_terms(case)
    rates = {NUMPY: array_rates(system), COMPILED: compiled_rates(system)}
    stretch = {name: sizes.slow_duration if name in SLOW else sizes.duration for name in solvers}

    def own(solver: str, tolerance: str, integrator: Integrator, duration: float) -> Method:
        run = partial(integrator, Motion(system, duration, OUTPUT_STEP))
        return Method(solver, "", tolerance, duration, run().energy_residual, run)

    methods = [
        own("event-driven", f"{tolerance:.1e}", Events(tolerance), duration)
        for duration in sorted(set(stretch.values()), reverse=True)
    ]
    ours = {method.duration: number for number, method in enumerate(methods)}
    fixed = by_splitting(Motion(system, sizes.duration, OUTPUT_STEP))
    methods.append(own("splitting", f"step {fixed.step:.1e} s", fixed, sizes.duration))
    failed = []
    for name, duration in stretch.items():
        target = methods[ours[duration]].energy_residual
        loosest, residual = matched(name, system, rates[COMPILED], duration, target)
        if loosest is None:
            failed.append(f"{name} leaves more, {residual:.1e} at the best of the tolerances that "
                          "were tried.")  # fmt: skip
            continue
        for kind, side in rates.items():
            run = partial(generic, name, side, 2 * system.num_modes, duration, loosest)
            methods.append(Method(name, kind, f"{loosest:.1e}", duration, residual, run))
    seconds = by_turns([method.run for method in methods], sizes.most, sizes.budget)
    ratios = [
        [theirs / mine for theirs, mine in zip(taken, seconds[ours[of.duration]], strict=False)]
        for of, taken in zip(methods, seconds, strict=True)
    ]
    columns = {
        "solver": "", "right-hand side": "", "motion s": ".3g", "tolerance": "",
        "energy residual": ".2g", "wall s": "", "over event-driven": "",
    }  # fmt: skip
    return Table.of_rows(
        f"residual-{tolerance:.0e}",
        f"Five-term series, at the energy residual of event-driven motion at {tolerance:.0e}",
        columns,
        [
            (of.solver, of.rates, of.duration, of.tolerance, of.energy_residual, taken, ratio)
            for of, taken, ratio in zip(methods, seconds, ratios, strict=True)
        ],
        [
            *(_verdict(methods, ratios, kind) for kind in (NUMPY, COMPILED)),
            *failed,
            "Ours labels its outputs and their energies within that time; the others leave states. "
            "Their tolerances are matched with the compiled right-hand side, and their absolute "
            "ones are a thousandth.",
        ],
    )


def _verdict(methods: Sequence[Method], every: Sequence[Sequence[float]], kind: str) -> str:
    """What the fastest solvers take with one kind of right-hand side, over ours."""
    ratios = {
        of.solver: ratio for of, ratio in zip(methods, every, strict=True) if of.rates == kind
    }
    fastest = sorted(ratios.keys() & METHODS, key=lambda name: median(ratios[name]))
    how = "as one writes it in NumPy" if kind == NUMPY else "compiled by numba"
    if not fastest:
        return f"With the same right-hand side {how}, no method of solve_ivp leaves so little."
    best = ratios[fastest[0]]
    goal = "reached" if median(best) >= RATIO_GOAL else "not reached"
    fortran = repeated(ratios["odeint"]) if "odeint" in ratios else ""
    return (
        f"With the same right-hand side {how}, the best of solve_ivp is {fastest[0]} with "
        f"{repeated(best)} times the wall time: the goal of {RATIO_GOAL:g} is {goal}."
    ) + (f" odeint, whose loop is in Fortran: {fortran} times." if fortran else "")


def pressed_system(num_modes: int, num_rows: int) -> GapSystem:
    """A made-up system all of whose rows press all the time, which makes the dearest steps.

    Two rigid modes, the others 20 Hz apart up to a few kHz as those of a shell; 1000 kg, stops
    of 1e7 N/m without clearance at places along a bar, 10 kN.
    """
    order = np.arange(num_modes)
    place = (np.arange(num_rows) + 0.5) / num_rows
    rows = np.cos(np.pi * np.outer(place, order)) * np.sqrt(2.0 / 1000.0)
    return GapSystem(
        omega2=(2.0 * np.pi * 20.0 * np.maximum(order - 1, 0)) ** 2,
        load=1.0e4 * rows[0],
        rows=rows,
        laws=[PowerContact(1.0e7, 1.0, 0.0)] * num_rows,
        station_of_row=np.arange(num_rows),
        stations=place.tolist(),
        observers={},
    )


def steps(sizes: Sizes) -> Table:
    """What a step of the splitting costs, by modes and rows."""
    kinds = [(n, m) for n in sizes.modes for m in sizes.rows]
    made = {n: 10 * math.ceil(sizes.updates / (10 * n)) for n in sizes.modes}
    runs = [
        partial(
            integrate, Motion(pressed_system(n, m), STEP * made[n], STEP * made[n] / 10.0), STEP
        )
        for n, m in kinds
    ]
    seconds = dict(zip(kinds, by_turns(runs, sizes.most, sizes.budget), strict=True))
    return Table.of_rows(
        "steps",
        "Splitting, ns per step while every row presses",
        {"modes": ".0f", **{f"{m} rows": "" for m in sizes.rows}},
        [
            (n, *([1e9 * part / made[n] for part in seconds[n, m]] for m in sizes.rows))
            for n in sizes.modes
        ],
        ("Steps in flight are cheaper, and many are made at once.",),
    )


def ensembles(case: Case, sizes: Sizes) -> Table:
    """What ensembles cost, by threads."""
    system = five_terms(case)
    cores = len(os.sched_getaffinity(0))

    def run(whole: GapSystem, count: int, integrator: Integrator | None, threads: int) -> None:
        with ThreadPoolExecutor(threads) as pool:
            integrate_ensemble(
                Motion(whole, sizes.duration, OUTPUT_STEP),
                count,
                CHANGE,
                0,
                "load",
                integrator=integrator,
                executor=pool,
            )

    series = f"{sizes.members} five-term series"
    what = [
        (f"{series}, event-driven", n, partial(run, system, sizes.members, Events(), n))
        for n in sorted({1, cores})
    ]
    what.append((f"{series}, splitting", cores, partial(run, system, sizes.members, None, cores)))
    shell = _shell_system(case) if sizes.shell_members else None
    if shell is not None:
        name = f"{sizes.shell_members} shells of {shell.num_modes} modes, splitting"
        what.append((name, cores, partial(run, shell, sizes.shell_members, None, cores)))
    seconds = by_turns([run for _, _, run in what], sizes.most, sizes.budget)
    fastest = min(median(taken) for taken in seconds[: len({1, cores})])
    goal = "reached" if fastest <= ENSEMBLE_GOAL else "not reached"
    notes = [f"The goal of {ENSEMBLE_GOAL:g} s for the series is {goal}."]
    if sizes.shell_members and shell is None:
        notes.append("No shells: FEniCSx cannot be imported.")
    return Table.of_rows(
        "ensembles",
        f"Ensembles, {sizes.duration:g} s, loads within {CHANGE:g}",
        {"ensemble": "", "threads": ".0f", "repetitions": ".0f", "wall s": ""},
        [
            (name, threads, len(taken), taken)
            for (name, threads, _), taken in zip(what, seconds, strict=True)
        ],
        [*notes, NOISE],
    )


def _shell_system(case: Case) -> GapSystem | None:
    """The case's shell, reduced; None without FEniCSx."""
    try:
        return gap_system(case, build_boom(case), shell_of(case))
    except ImportError:
        return None


def bench(sizes: Sizes, folder: Path, console: Console) -> None:
    """Measure, print, and write ``bench.json`` and ``bench.md``."""
    case = case_file.load(str(PAPER))
    parts: list[Callable[[], Table]] = [
        *(partial(compare, case, *level, sizes) for level in sizes.levels),
        partial(steps, sizes),
        partial(ensembles, case, sizes),
        partial(leaving, sizes.left),
        partial(drawing, sizes.drawn, sizes.duration),
    ]
    machine = {"cores": len(os.sched_getaffinity(0)), "python": platform.python_version()}
    data: dict[str, Any] = {"sizes": asdict(sizes), "machine": machine}
    leave(folder, "bench", "What the integrators cost", data, (part() for part in parts), console)


if __name__ == "__main__":
    notices.show()
    shown_on = wide_console()
    bench(Sizes(), OUT, shown_on)
    scaling.scaling(scaling.Sizes(), scaling.OUT, shown_on)
