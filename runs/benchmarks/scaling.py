# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a shell costs by its size and by ranks: ``python -m runs.benchmarks.scaling``.

Every run has processes of its own, so that its peak memory is its own.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from rich.console import Console

from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem
from dynamics.motion import Motion
from dynamics.splitting import integrate
from runs import CASES
from runs.case import reading as case_file
from runs.case.build import build_boom, contact_laws
from runs.case.kinds.model import of_kind
from runs.case.kinds.shell import ShellTable
from runs.report.tables import TextTable, wide_console, write

SIZED = {"paper": "paper.toml", "friction": "paper-friction.toml"}
OUT = Path("runs/out/scaling")

# Goals: exponent of time against size, wall s of the default mesh's reduction and of ten seconds of
# its motion, wall s and GB of a million degrees of freedom a segment.
EXPONENT_GOAL = 1.2
DEFAULT_GOAL, MOTION_GOAL = 5.0, 1.5
MILLION_GOALS = 300.0, 8.0

STAGES = ("mesh", "assembly", "rows", "reduction", "fields", "mesh error")

# Of the motions in s: that of the goal, and one that keeps the energy of a shell.
STEPS = (1.0e-5, 2.5e-6)


@dataclass(frozen=True, slots=True)
class Sizes:
    """How much is measured.

    Args:
        meshes: edge lengths in m, falling; the last makes about a million degrees of freedom a
            segment.
        default: edge length in m of the motions.
        ranks: numbers of them on which the default mesh is reduced and moves; the last is that of
            the meshes.
        duration: of the motions in s.
    """

    meshes: Sequence[float] = (0.1, 0.06, 0.035, 0.018)
    default: float = 0.1
    ranks: Sequence[int] = (1, 2)
    duration: float = 10.0


def by_size(sizes: Sizes) -> tuple[TextTable, dict[str, Any]]:
    """Wall time and peak memory of each stage against the size of the paper's boom."""
    ranks = sizes.ranks[-1]
    runs = [_measured(ranks, "reduce", "friction", mesh) for mesh in sizes.meshes]
    dofs = [run["degrees_of_freedom"] for run in runs]
    # What starts up with the processes is there without any shell.
    exponents = {
        "seconds": _exponent(dofs, [run["total_seconds"] for run in runs]),
        "peak": _exponent(dofs, [run["peak"] - run["idle"] for run in runs]),
    }
    last = runs[-1]
    seconds, peak = MILLION_GOALS
    reached = exponents["seconds"] <= EXPONENT_GOAL
    table = TextTable(
        f"The paper's boom as shells, {ranks} ranks",
        ("mesh m", "dofs a segment", *(f"{stage} s" for stage in STAGES), "all s", "peak GB",
         "compliance error"),
        [
            (
                f"{mesh:g}",
                f"{run['degrees_of_freedom'] // 2}",
                *(f"{run['seconds'][stage]:.2f}" for stage in STAGES),
                f"{run['total_seconds']:.1f}",
                f"{run['peak']:.2f}",
                f"{run['errors']['contact_compliance']:.0e}",
            )
            for mesh, run in zip(sizes.meshes, runs, strict=True)
        ],
        (
            f"Wall time grows with the size to the power {exponents['seconds']:.2f} (goal "
            f"{EXPONENT_GOAL:g}, {'' if reached else 'not '}reached), peak memory beyond that of "
            f"idle processes to the power {exponents['peak']:.2f}. Peaks are sums over the ranks, "
            "of each rank's own largest resident set.",
            f"The largest takes {last['total_seconds']:.0f} s and {last['peak']:.1f} GB (goals "
            f"{seconds:g} s and {peak:g} GB).",
        ),
        name="scaling",
    )  # fmt: skip
    data = {"ranks": ranks, "runs": runs, "exponents": exponents, "exponent_goal": EXPONENT_GOAL}
    return table, data


def memory_by_stage(data: Mapping[str, Any]) -> TextTable:
    """Peak memory when each stage ends, of the runs of :func:`by_size`."""
    stages = ("mesh", "assembly", "reduction", "fields")
    return TextTable(
        "Peak memory when a stage ends, GB over all ranks",
        ("dofs a segment", "idle", *stages),
        [
            (
                f"{run['degrees_of_freedom'] // 2}",
                f"{run['idle']:.2f}",
                *(f"{run['peaks'][stage]:.2f}" for stage in stages),
            )
            for run in data["runs"]
        ],
        name="scaling-memory",
    )


def default_mesh(sizes: Sizes) -> tuple[TextTable, dict[str, Any]]:
    """The default mesh from plates to the gap system and its motion, by ranks."""
    runs = [
        _measured(ranks, "move", name, sizes.default, sizes.duration)
        for ranks in sizes.ranks
        for name in SIZED
    ]
    table = TextTable(
        f"Mesh of {sizes.default:g} m: from plates to the gap system",
        ("case", "ranks", *(f"{stage} s" for stage in STAGES), "all s", "modes"),
        [
            (
                run["case"],
                str(run["ranks"]),
                *(f"{run['seconds'][stage]:.2f}" for stage in STAGES),
                f"{run['total_seconds']:.2f}",
                str(run["modes"]),
            )
            for run in runs
        ],
        (f"Goal: {DEFAULT_GOAL:g} s on two cores.",),
        name="scaling-default",
    )
    return table, {"runs": runs, "goals": {"reduction": DEFAULT_GOAL, "motion": MOTION_GOAL}}


def motions(data: Mapping[str, Any], sizes: Sizes) -> TextTable:
    """The motions of the runs of :func:`default_mesh`."""
    return TextTable(
        f"{sizes.duration:g} s of motion",
        ("case", "ranks", "step s", "motion s", "in flight s", "ns a step", "contact changes",
         "energy residual"),
        [
            (
                run["case"],
                str(run["ranks"]),
                f"{motion['step']:g}",
                *_of_motion(motion, sizes.duration),
            )
            for run in data["runs"]
            for motion in run["motions"]
        ],
        (
            f"Goal: {MOTION_GOAL:g} s at a step of {STEPS[0]:g} s, at which contact with the light "
            "local modes of a shell is not stable: what counts is a step that keeps the energy. In "
            "flight: the same without contacts and friction, when many steps are made at once. The "
            "motion is one rank's work.",
        ),
        name="scaling-motion",
    )  # fmt: skip


def _of_motion(motion: Mapping[str, Any], duration: float) -> tuple[str, ...]:
    """The cells of one motion."""
    if motion["energy_residual"] is None:
        return "", f"{motion['flight']:.2f}", "", "", "not finite"
    return (
        f"{motion['seconds']:.2f}",
        f"{motion['flight']:.2f}",
        f"{1e9 * motion['seconds'] * motion['step'] / duration:.0f}",
        str(motion["contact_changes"]),
        f"{motion['energy_residual']:.0e}",
    )


def _exponent(sizes: Sequence[float], values: Sequence[float]) -> float:
    """p of the power law values ~ sizesᵖ that fits best."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0]) if len(sizes) > 1 else math.nan


def _measured(ranks: int, *what: object) -> dict[str, Any]:
    """What a run of its own processes tells."""
    launcher = [] if ranks == 1 else ["mpirun", "-n", str(ranks), "--oversubscribe"]
    if launcher and shutil.which("mpirun") is None:
        raise FileNotFoundError("several ranks take mpirun, which is not installed")
    done = subprocess.run(
        [*launcher, sys.executable, "-m", "runs.benchmarks.scaling", *map(str, what)],
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(done.stderr)
    told: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return told


def _run(what: str, name: str, size: str, duration: str = "0") -> None:
    """One run, in processes that are its own; rank 0 prints what it took."""
    from mpi4py import MPI

    from shell_model.boom_shell import ShellOptions, reduce_boom

    comm = MPI.COMM_WORLD
    case = case_file.load(str(CASES / SIZED[name]))
    boom = build_boom(case)
    model = of_kind(ShellTable, case.models)[0]
    options = ShellOptions(float(size), contact_line=model.contact_line)
    idle = comm.allreduce(_peak())
    peaks: dict[str, float] = {}

    def tell(stage: str, part: float) -> None:
        peaks[stage] = _peak()

    comm.barrier()
    start = perf_counter()
    reduced = reduce_boom(boom, contact_laws(case, model), options, comm, tell)
    comm.barrier()
    total = perf_counter() - start
    peaks["fields"] = _peak()
    every = comm.gather(peaks)
    if every is None:
        return
    summed = {stage: sum(one.get(stage, 0.0) for one in every) for stage in peaks}
    told: dict[str, Any] = {
        "case": name,
        "ranks": comm.size,
        "degrees_of_freedom": reduced.num_dofs,
        "modes": reduced.system.num_modes,
        "seconds": reduced.seconds,
        "total_seconds": total,
        "idle": idle,
        "peak": summed["fields"],
        "peaks": summed,
        "errors": reduced.errors,
    }
    if what == "move":
        told["motions"] = [_motion(reduced.system, float(duration), step) for step in STEPS]
    print(json.dumps(told))


def _motion(system: GapSystem, duration: float, step: float) -> dict[str, Any]:
    """What a motion takes, and what it leaves of the energy; None if it is not finite."""
    flying = replace(
        system,
        rows=system.rows[:0],
        laws=[],
        station_of_row=system.station_of_row[:0],
        friction_rows=system.friction_rows[:0],
        frictions=[],
    )
    told: dict[str, Any] = {"step": step, "contact_changes": "", "energy_residual": None}
    for kind, moving in (("seconds", system), ("flight", flying)):
        # The first output compiles.
        integrate(Motion(moving, 1.0e-3), step=step, energy_bound=math.inf)
        start = perf_counter()
        try:
            motion = integrate(Motion(moving, duration), step=step, energy_bound=math.inf)
        except NumericsError:
            told[kind] = None
            continue
        told[kind] = perf_counter() - start
        if kind == "seconds" and math.isfinite(motion.energy_residual):
            told["contact_changes"] = motion.data.attrs["contact_changes"]
            told["energy_residual"] = motion.energy_residual
    return told


def _peak() -> float:
    """This program's largest resident set so far, in GB."""
    # getrusage would tell the parent's as well, which was this process before it began.
    status = Path("/proc/self/status").read_text(encoding="ascii")
    (line,) = (line for line in status.splitlines() if line.startswith("VmHWM:"))
    return float(line.split()[1]) * 1024.0 / 1.0e9


def scaling(sizes: Sizes, folder: Path, console: Console) -> None:
    """Measure, print, and write ``scaling.json`` and ``scaling.md``."""
    default, of_default = default_mesh(sizes)
    tables = [default, motions(of_default, sizes)]
    for each in tables:
        each.show(console)
    table, of_sizes = by_size(sizes)
    tables += [table, memory_by_stage(of_sizes)]
    for each in tables[2:]:
        each.show(console)
    data = {"sizes": asdict(sizes), "default": of_default, "by_size": of_sizes}
    write(folder, "scaling", "What a shell costs", data, tables)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        _run(*sys.argv[1:])
    else:
        scaling(Sizes(), OUT, wide_console())
