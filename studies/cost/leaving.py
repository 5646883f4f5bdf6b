# SPDX-License-Identifier: LGPL-3.0-or-later
"""What it costs to leave a run: figures, tables, pages, files, and pictures of its shell."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage
from tempfile import TemporaryDirectory
from time import perf_counter

from runs import CASES
from runs.case import reading as case_file
from runs.folder.cache import Cache
from runs.pipeline.means import Means
from runs.pipeline.run import run_case
from runs.report import output
from runs.report.pages import Addition
from runs.report.tables import Table

CASE = CASES / "lift.toml"


def leaving(models: Sequence[str]) -> Table:
    """Wall and processor time of what comes after the motion, with snapshots and without.

    Args:
        models: of the lift; its shell is left out where there is no FEniCSx.
    """
    asked = [name for name in models if name != "shell" or find_spec("dolfinx")]
    case = case_file.select(case_file.load(str(CASE)), str(CASE), asked)
    comm = None
    if "shell" in asked:
        from mpi4py import MPI

        comm = MPI.COMM_SELF
    run = run_case(case, str(CASE), Means(comm, cache=Cache.of_user()))
    assert run is not None
    run.answer()
    rows = []
    with TemporaryDirectory() as folder:
        for what, drawn in (("without snapshots", False), ("with snapshots", True)):
            out = Path(folder) / what
            out.mkdir()
            begin, spent = perf_counter(), _processor_time()
            output.write(run, Addition(), out, drawn)
            rows.append((what, perf_counter() - begin, _processor_time() - spent))
    return Table.of_rows(
        "leaving",
        f"Leaving a run of the lift: {', '.join(asked)}",
        {"what": "", "wall s": ".1f", "processor s": ".1f"},
        rows,
        ("Snapshots are drawn by a process beside the one that does all else.",),
    )


def _processor_time() -> float:
    """Of this process and of those that it has ended, in s."""
    used = getrusage(RUSAGE_SELF), getrusage(RUSAGE_CHILDREN)
    return sum(each.ru_utime + each.ru_stime for each in used)
