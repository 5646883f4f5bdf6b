# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cost of a shell for several sizes and ranks: ``python -m studies.cost.scaling``.

Every run has separate processes, so that peak memories are separate.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, NamedTuple

import numpy as np
from rich.console import Console

from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.process.ranks import launcher
from protractile.runs.process.terminal import show_notices
from protractile.runs.report.tables import Table
from studies.cost.timing import write_tables
from studies.study import wide_console

SIZED = {"paper": "paper.toml", "friction": "paper-friction.toml"}
OUT = Path("runs/out/scaling")

# Goals: exponent of time over size; wall times in s of the default mesh's reduction and of ten
# seconds of its motion; wall time in s and memory in GB of 1e6 degrees of freedom per segment.
EXPONENT_GOAL = 1.2
DEFAULT_GOAL, MOTION_GOAL = 5.0, 1.5
MILLION_GOALS = 300.0, 8.0

# Goal for the wall time in s of the buckling of a segment of 300,000 degrees of freedom.
BUCKLING_GOAL = 60.0

STAGES = ("mesh", "assembly", "rows", "reduction", "fields", "mesh error")

# Stages with reported memory peaks.
REMEMBERED = ("mesh", "assembly", "reduction", "fields")

# Durations of the motions in s; the goal applies to the last.
STEPS = (1.0e-4, 1.0e-5)


class Sizes(NamedTuple):
    """Parameters of the measurements."""

    #: Edge lengths in m, descending; the last gives about a million degrees of freedom per segment.
    meshes: Sequence[float] = (0.1, 0.06, 0.035, 0.018)
    #: Edge lengths in m of the coarser of the two meshes of a buckling analysis.
    buckling: Sequence[float] = (0.062, 0.036)
    default: float = 0.1  #: edge length in m of the motions
    #: Numbers of ranks on which the default mesh is reduced and moves; the last is that of the
    #: meshes.
    ranks: Sequence[int] = (1, 2)
    duration: float = 10.0  #: duration of the motions in s


def measure(sizes: Sizes) -> Iterator[Table]:
    """Measure the default mesh on several numbers of ranks, then finer meshes on all ranks."""
    runs = [
        _measure_run(ranks, "move", name, sizes.default, sizes.duration)
        for ranks in sizes.ranks
        for name in SIZED
    ]
    goal = f"Goal: {DEFAULT_GOAL:g} s on two cores."
    yield _stages("scaling-default", "The default mesh, from plates to the gap system", runs, goal)
    columns = {
        "case": "", "ranks": ".0f", "step s": ".2g", "motion s": ".2f",
        "ns a step": ".0f", "contact changes": ".0f", "energy residual": ".1g",
    }  # fmt: skip
    yield Table.of_rows(
        "scaling-motion",
        f"{sizes.duration:g} s of motion",
        columns,
        [(run["case"], run["ranks"], *motion) for run in runs for motion in run["motions"]],
        (f"Goal: {MOTION_GOAL:g} s at a step of {STEPS[-1]:g} s. The motion is one rank's work.",),
    )
    runs = [_measure_run(sizes.ranks[-1], "reduce", "friction", mesh) for mesh in sizes.meshes]
    note = "Peaks are sums over the ranks, of each rank's own largest resident set."
    yield _stages("scaling", "The paper's boom as shells, by size", runs, note)
    yield Table.of_rows(
        "scaling-memory",
        "Peak memory when a stage ends, GB over all ranks",
        {"dofs a segment": ".0f", "idle": ".2f", **dict.fromkeys(REMEMBERED, ".2f")},
        [(run["dofs"], run["idle"], *(run["peaks"][at] for at in REMEMBERED)) for run in runs],
    )
    yield _buckling(sizes)
    dofs, last, (seconds, peak) = [run["dofs"] for run in runs], runs[-1], MILLION_GOALS
    wall = _exponent(dofs, [run["total_seconds"] for run in runs])
    # The memory of processes at their start, without shells.
    memory = _exponent(dofs, [run["peaks"]["fields"] - run["idle"] for run in runs])
    yield Table.of_rows(
        "scaling-goals",
        "What growing takes",
        {"what": "", "measured": ".3g", "goal": ".3g"},
        [
            ("power of the size with which wall time grows", wall, EXPONENT_GOAL),
            ("the same of peak memory beyond idle processes", memory, None),
            ("wall s of the largest", last["total_seconds"], seconds),
            ("peak GB of the largest", last["peaks"]["fields"], peak),
        ],
    )


def _stages(name: str, title: str, runs: Sequence[Mapping[str, Any]], note: str) -> Table:
    """Return the table of the wall time of each stage of each run."""
    columns = {
        "case": "", "mesh m": ".2g", "ranks": ".0f", "dofs a segment": ".0f",
        **{f"{stage} s": ".2f" for stage in STAGES}, "all s": ".2f", "modes": ".0f",
        "peak GB": ".2f", "compliance error": ".1g",
    }  # fmt: skip
    return Table.of_rows(
        name,
        title,
        columns,
        [
            (run["case"], run["mesh"], run["ranks"], run["dofs"],
             *(run["seconds"][stage] for stage in STAGES), run["total_seconds"], run["modes"],
             run["peaks"]["fields"], run["errors"]["contact_compliance"])
            for run in runs
        ],
        (note,),
    )  # fmt: skip


def _buckling(sizes: Sizes) -> Table:
    """Return the table of cost and lowest buckling factor of a bent segment, by size and ranks."""
    rows = []
    for mesh in sizes.buckling:
        runs = [_measure_run(ranks, "buckle", mesh) for ranks in sizes.ranks]
        first = np.array(runs[0]["factors"])
        rows += [
            (run["dofs"], run["ranks"], run["wall"], run["cpu"], run["peak"], first[0],
             float(np.abs(run["factors"] / first - 1.0).max()))
            for run in runs
        ]  # fmt: skip
    columns = {
        "dofs": ".0f", "ranks": ".0f", "wall s": ".1f", "CPU s": ".1f", "GB a rank": ".2f",
        "lowest factor": ".6g", "factors off one rank": ".1g",
    }  # fmt: skip
    notes = (
        "Four factors of the paper's outer segment, on the mesh and on one with half its edge "
        f"length, which has the given dofs. Goal: {BUCKLING_GOAL:g} s for 300,000 on two cores.",
    )
    return Table.of_rows("scaling-buckling", "Buckling of a segment", columns, rows, notes)


def _exponent(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Return the exponent p of the best fit values ~ sizesᵖ."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0]) if len(sizes) > 1 else math.nan


def _measure_run(ranks: int, *what: object) -> dict[str, Any]:
    """Return the measurements of a run in separate processes."""
    start = [] if ranks == 1 else [launcher(), "-n", str(ranks)]
    if start and shutil.which(start[0]) is None:
        raise FileNotFoundError("several ranks take mpirun, which is not installed")
    done = subprocess.run(
        [*start, sys.executable, "-m", "studies.cost.scaling", *map(str, what)],
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(done.stderr)
    result: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return result


def _run(what: str, name: str, size: str, duration: str = "0") -> None:
    """Run once in separate processes; rank 0 prints the measurements."""
    from mpi4py import MPI

    from protractile.shell_model.boom_shell import ShellOptions
    from protractile.shell_model.reduced_shell import reduce_boom

    comm = MPI.COMM_WORLD
    case = case_file.load(str(CASES / SIZED[name]))
    boom = build_boom(case)
    model = select_kind(Shell, case.models)[0]
    options = ShellOptions(float(size), contact_line=model.contact_line)
    idle = comm.allreduce(_peak())
    peaks: dict[str, float] = {}

    def progress(stage: str, part: float) -> None:
        peaks[stage] = _peak()

    comm.barrier()
    start = perf_counter()
    reduced = reduce_boom(model.model_boom(boom).boom, options, comm, progress)
    comm.barrier()
    total = perf_counter() - start
    peaks["fields"] = _peak()
    every = comm.gather(peaks)
    if every is None:
        return
    summed = {stage: sum(one.get(stage, 0.0) for one in every) for stage in peaks}
    result: dict[str, Any] = {
        "case": name,
        "ranks": comm.size,
        "mesh": options.mesh_size,
        "dofs": reduced.num_dofs // 2,
        "modes": reduced.system.num_modes,
        "seconds": reduced.seconds,
        "total_seconds": total,
        "idle": idle,
        "peaks": summed,
        "errors": reduced.errors,
    }
    if what == "move":
        result["motions"] = [_motion(reduced.system, float(duration), step) for step in STEPS]
    print(json.dumps(result))


def _buckle(size: str) -> None:
    """Compute the buckling of the walls of a bent segment; rank 0 prints the results."""
    from mpi4py import MPI

    from protractile.geometry.boom import Boom
    from protractile.shell_model.boom_shell import ShellOptions, segment_mesh
    from protractile.shell_model.buckling import ShellState, buckle_segments

    comm = MPI.COMM_WORLD
    case = case_file.load(str(CASES / SIZED["paper"]))
    boom = Boom(build_boom(case).segments[:1], ())
    options, mesh, forces = ShellOptions(float(size)), None, None
    if comm.rank == 0:
        mesh = segment_mesh(boom, 0, options)
        x, _, z = mesh.points[mesh.triangles].mean(axis=1).T
        forces = np.outer((boom.segments[0].end - x) * z, [1.0e6, 0.0, 0.0])
    state = ShellState([comm.bcast(forces)], np.zeros(0), {})
    comm.barrier()
    start, begin = perf_counter(), process_time()
    (found,) = buckle_segments(boom, [mesh], state, options, 4, comm)
    seconds, cpu = perf_counter() - start, comm.gather(process_time() - begin)
    peaks = comm.gather(_peak())
    if found.mesh is not None and cpu is not None and peaks is not None:
        edges = np.sort(found.mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2))
        num_edges = len(np.unique(edges, axis=0))
        result = {
            "dofs": 3 * len(found.mesh.points) + 6 * num_edges,
            "ranks": comm.size,
            "wall": seconds,
            "cpu": sum(cpu),
            "peak": max(peaks),
            "factors": found.factors.tolist(),
        }
        print(json.dumps(result))


def _motion(system: GapSystem, duration: float, step: float) -> list[float]:
    """Return step in s, wall time in s, time per step in ns, contact changes, energy residual."""
    # The first output compiles the loop.
    FixedStep(step)(Motion(system, 1.0e-3))
    start = perf_counter()
    motion = FixedStep(step)(Motion(system, duration))
    seconds = perf_counter() - start
    changes = motion.data.attrs["contact_changes"]
    return [step, seconds, 1e9 * seconds * step / duration, changes, motion.energy_residual]


def _peak() -> float:
    """Return the largest resident memory of this process so far in GB."""
    # getrusage would include the memory of the parent before the fork.
    status = Path("/proc/self/status").read_text(encoding="ascii")
    (line,) = (line for line in status.splitlines() if line.startswith("VmHWM:"))
    return float(line.split()[1]) * 1024.0 / 1.0e9


def scaling(sizes: Sizes, folder: Path, console: Console) -> None:
    """Measure all costs, print the tables, and write ``scaling.json`` and ``scaling.md``."""
    data = {"sizes": sizes._asdict()}
    write_tables(folder, "scaling", "What a shell costs", data, measure(sizes), console)


if __name__ == "__main__":
    show_notices()
    if sys.argv[1:2] == ["buckle"]:
        _buckle(sys.argv[2])
    elif len(sys.argv) > 1:
        _run(*sys.argv[1:])
    else:
        scaling(Sizes(), OUT, wide_console())
