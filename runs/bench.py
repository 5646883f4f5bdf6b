# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the integrators cost: ``python -m runs.bench``.

Everything is measured in one process; methods that are compared take turns, so that what else
the machine does falls on all of them.
"""

from __future__ import annotations

import math
import os
import platform
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import partial
from importlib import import_module
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
from rich.console import Console

from beam_model.kantorovich import kantorovich_segment
from beam_model.segment_model import gap_system
from dynamics.contact import PowerContact
from dynamics.ensemble import integrate_ensemble, perturbations
from dynamics.event_driven import integrate_events
from dynamics.gap_system import GapSystem
from dynamics.splitting import integrate
from runs import case as case_file
from runs.build import build_boom, contact_laws
from runs.generic_solvers import (
    OUTPUT_STEP,
    SOLVERS,
    array_rates,
    compiled_rates,
    generic,
    matched,
)
from runs.schema import Case, KantorovichTable, ShellTable
from runs.tables import TextTable, write

PAPER = Path(__file__).parent / "cases" / "paper.toml"
OUT = Path("runs/out/bench")

# Goals: wall time of the best generic solver over ours, and wall s of the ensemble of series.
RATIO_GOAL = 250.0
ENSEMBLE_GOAL = 10.0

# A generic solver also with rates as one writes them in NumPy.
WITH_PLAIN_RATES = ("LSODA",)

# Relative change of the members' loads.
CHANGE = 1.0e-9

# The step that is timed, in s: a hundredth of the period of the highest mode or less.
STEP = 1.0e-6


NOISE = (
    "Medians. The last digit shown is the first that the spread, half the range of the "
    "repetitions, reaches; ~ where the noise exceeds one digit."
)


@dataclass(frozen=True, slots=True)
class Sizes:
    """How much is measured.

    Args:
        duration: of the motions in s.
        repetitions: of every measurement but those of the generic solvers' tolerances.
        modes, rows: the table of steps.
        updates: of one mode by one step, that are timed for an entry of it.
        members: of the ensemble of series.
        shell_members: of the ensemble of shells, 0 for none.
    """

    duration: float = 10.0
    repetitions: int = 5
    modes: Sequence[int] = (5, 20, 80, 200)
    rows: Sequence[int] = (2, 4, 16)
    updates: int = 40_000_000
    members: int = 256
    shell_members: int = 32


@dataclass(frozen=True, slots=True)
class Method:
    """A way to move the series.

    Args:
        name: what the table calls it.
        options: that it runs with, as text.
        energy_residual: that it leaves.
        run: moves it once.
    """

    name: str
    options: str
    energy_residual: float
    run: Callable[[], object]


def shown(values: Sequence[float]) -> str:
    """The median with the digits that the spread leaves, ``~`` before it if not one is left.

    The spread is half the range; its first digit is the last that is shown. A single value
    has no known spread and is shown with one digit.
    """
    middle = median(values)
    if middle == 0.0 or not math.isfinite(middle):
        return f"{middle:g}"
    spread = 0.5 * (max(values) - min(values))
    leading = math.floor(math.log10(abs(middle)))
    last = math.floor(math.log10(spread)) if spread > 0.0 else leading
    digits = max(1, min(leading - last + 1, 3)) if len(values) > 1 else 1
    place = leading - digits + 1
    text = f"{round(middle, -place):.{max(0, -place)}f}"
    return f"~{text}" if len(values) > 1 and last >= leading and spread > 0.0 else text


def by_turns(runs: Sequence[Callable[[], object]], repetitions: int) -> list[list[float]]:
    """Wall seconds of each run, (num_runs, repetitions), all once before any is repeated."""
    seconds: list[list[float]] = [[] for _ in runs]
    for _ in range(repetitions):
        for run, taken in zip(runs, seconds, strict=True):
            start = perf_counter()
            run()
            taken.append(perf_counter() - start)
    return seconds


def five_terms(case: Case) -> GapSystem:
    """The paper's five-term series."""
    boom = build_boom(case)
    model = next(m for m in case.models if m.name == "kantorovich-5")
    assert isinstance(model, KantorovichTable)
    segments = [
        kantorovich_segment(segment, terms, model.base, model.rotary_inertia)
        for segment, terms in zip(boom.segments, model.terms, strict=True)
    ]
    return gap_system(boom, segments, contact_laws(case, model))


def compare(case: Case, sizes: Sizes) -> tuple[TextTable, dict[str, Any]]:
    """Ours against generic solvers at equal energy residual."""
    system = five_terms(case)
    size = 2 * system.num_modes
    methods = []
    for own, integrator in (("event-driven", integrate_events), ("splitting", integrate)):
        move = partial(integrator, system, sizes.duration, OUTPUT_STEP)
        methods.append(Method(own, "default step", move().energy_residual, move))
    target = methods[0].energy_residual
    compiled, plain = compiled_rates(system), array_rates(system)
    for name in SOLVERS:
        relative, absolute, residual = matched(name, system, compiled, sizes.duration, target)
        options = f"rtol {relative:.1e}, atol {absolute:.1e}"
        for suffix, rates in (("", compiled), (", NumPy rates", plain)):
            if rates is compiled or name in WITH_PLAIN_RATES:
                run = partial(generic, name, rates, size, sizes.duration, relative, absolute)
                methods.append(Method(name + suffix, options, residual, run))
    seconds = by_turns([method.run for method in methods], sizes.repetitions)
    entries: list[dict[str, Any]] = [
        {
            "method": method.name,
            "options": method.options,
            "energy_residual": method.energy_residual,
            "seconds": taken,
            "ratios": [theirs / own for theirs, own in zip(taken, seconds[0], strict=True)],
        }
        for method, taken in zip(methods, seconds, strict=True)
    ]
    fastest = sorted(entries[2:], key=lambda entry: median(entry["ratios"]))
    best = fastest[0]
    best_in_python = next(entry for entry in fastest if entry["method"] != "odeint")
    goal = "reached" if median(best["ratios"]) >= RATIO_GOAL else "not reached"
    table = TextTable(
        f"Five-term series, {sizes.duration:g} s, at equal energy residual",
        ("method", "options", "energy residual", "wall s", "over event-driven"),
        [
            (
                entry["method"],
                entry["options"],
                f"{entry['energy_residual']:.1e}",
                shown(entry["seconds"]),
                shown(entry["ratios"]),
            )
            for entry in entries
        ],
        (
            f"Best generic solver: {best['method']}, {shown(best['ratios'])} times the wall time; "
            f"the goal of {RATIO_GOAL:g} is {goal}. Best of solve_ivp: {best_in_python['method']}, "
            f"{shown(best_in_python['ratios'])} times. Rates are compiled unless said otherwise.",
        ),
    )
    return table, {"methods": entries, "best": best["method"], "goal": RATIO_GOAL}


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


def steps(sizes: Sizes) -> tuple[TextTable, dict[str, Any]]:
    """What a step of the splitting costs, by modes and rows."""
    kinds = [(n, m) for n in sizes.modes for m in sizes.rows]
    made = {n: 10 * math.ceil(sizes.updates / (10 * n)) for n in sizes.modes}
    runs = [
        partial(integrate, pressed_system(n, m), STEP * made[n], STEP * made[n] / 10.0, STEP)
        for n, m in kinds
    ]
    seconds = by_turns(runs, sizes.repetitions)
    cost = {
        (n, m): [1e9 * part / made[n] for part in taken]
        for (n, m), taken in zip(kinds, seconds, strict=True)
    }
    table = TextTable(
        "Splitting, ns per step while every row presses",
        ("modes", *(f"{m} rows" for m in sizes.rows)),
        [(str(n), *(shown(cost[n, m]) for m in sizes.rows)) for n in sizes.modes],
        ("Steps in flight are cheaper, and many are made at once.",),
    )
    entries = [
        {"modes": n, "rows": m, "steps": made[n], "nanoseconds": cost[n, m]} for n, m in kinds
    ]
    return table, {"step": STEP, "costs": entries}


def ensembles(case: Case, sizes: Sizes) -> tuple[TextTable, dict[str, Any]]:
    """What ensembles cost, by threads."""
    system = five_terms(case)
    members = [
        replace(system, load=(1.0 + change) * system.load)
        for change in perturbations(sizes.members, CHANGE, 0)
    ]
    cores = len(os.sched_getaffinity(0))

    def by_events(threads: int) -> None:
        with ThreadPoolExecutor(threads) as pool:
            for _ in pool.map(
                lambda member: integrate_events(member, sizes.duration, OUTPUT_STEP), members
            ):
                pass

    def by_splitting(whole: GapSystem, count: int) -> None:
        integrate_ensemble(whole, count, CHANGE, 0, "load", sizes.duration, OUTPUT_STEP)

    series = f"{sizes.members} five-term series"
    what = [(f"{series}, event-driven", n, partial(by_events, n)) for n in sorted({1, cores})]
    what.append((f"{series}, splitting", cores, partial(by_splitting, system, sizes.members)))
    seconds = by_turns([run for _, _, run in what], sizes.repetitions)
    shell = _shell_system(case) if sizes.shell_members else None
    if shell is not None:
        run = partial(by_splitting, shell, sizes.shell_members)
        name = f"{sizes.shell_members} shells of {shell.num_modes} modes, splitting"
        what.append((name, cores, run))
        # Minutes each: the spread is not known, and one digit is shown.
        seconds += by_turns([run], 1)
    fastest = min(median(taken) for taken in seconds[:2])
    goal = "reached" if fastest <= ENSEMBLE_GOAL else "not reached"
    notes = [f"The goal of {ENSEMBLE_GOAL:g} s for the series is {goal}."]
    if sizes.shell_members and shell is None:
        notes.append("No shells: FEniCSx cannot be imported.")
    table = TextTable(
        f"Ensembles, {sizes.duration:g} s, loads within {CHANGE:g}",
        ("ensemble", "threads", "repetitions", "wall s"),
        [
            (name, str(threads), str(len(taken)), shown(taken))
            for (name, threads, _), taken in zip(what, seconds, strict=True)
        ],
        notes,
    )
    entries = [
        {"ensemble": name, "threads": threads, "seconds": taken}
        for (name, threads, _), taken in zip(what, seconds, strict=True)
    ]
    return table, {"goal": ENSEMBLE_GOAL, "ensembles": entries}


def _shell_system(case: Case) -> GapSystem | None:
    """The case's shell, reduced; None without one, or without FEniCSx."""
    models = [model for model in case.models if isinstance(model, ShellTable)]
    try:
        boom_shell = import_module("shell_model.boom_shell")
        mpi = import_module("mpi4py.MPI")
    except ImportError:
        return None
    if not models:
        return None
    boom = build_boom(case)
    options = boom_shell.ShellOptions(
        mesh_size=models[0].mesh_size, contact_line=models[0].contact_line
    )
    reduced = boom_shell.reduce_boom(boom, contact_laws(case, models[0]), options, mpi.COMM_SELF)
    system: GapSystem = reduced.system
    return system


def bench(sizes: Sizes, folder: Path, console: Console) -> None:
    """Measure, print, and write ``bench.json`` and ``bench.md``."""
    case = case_file.load(str(PAPER))
    data: dict[str, Any] = {
        "sizes": asdict(sizes),
        "machine": {"cores": len(os.sched_getaffinity(0)), "python": platform.python_version()},
    }
    tables = []
    parts: dict[str, Callable[[], tuple[TextTable, dict[str, Any]]]] = {
        "comparison": partial(compare, case, sizes),
        "steps": partial(steps, sizes),
        "ensembles": partial(ensembles, case, sizes),
    }
    for name, part in parts.items():
        table, data[name] = part()
        table.show(console)
        tables.append(table)
    console.print(NOISE)
    closing = replace(tables[-1], notes=(*tables[-1].notes, NOISE))
    write(folder, "bench", "What the integrators cost", data, [*tables[:-1], closing])


if __name__ == "__main__":
    bench(Sizes(), OUT, Console())
