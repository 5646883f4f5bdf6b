# SPDX-License-Identifier: LGPL-3.0-or-later
"""The command that computes a load chart. It imports its libraries when it runs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from protractile.runs import options
from protractile.runs.process import ranks, terminal
from protractile.runs.process.terminal import Terminal, printable


def chart(
    case: options.CaseFile,
    out: Annotated[
        str | None,
        typer.Option(metavar="DIR", help="Output folder.  \\[default: runs/out/CASE-chart]"),
    ] = None,
    excel: Annotated[
        bool, typer.Option("--excel", help="Also write chart.xlsx, a workbook of the cells.")
    ] = False,
    shell: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Also prove the largest cell of each governing proof by a shell of the case.",
        ),
    ] = None,
    no_cache: Annotated[
        bool, typer.Option("--no-cache", help="Repeat configurations that are in the user's cache.")
    ] = False,
) -> int:
    """Compute the load chart of a crane: its capacity over radius and length, and what limits it.

    All cores compute configurations, under mpirun all ranks except the first. A chart that is
    interrupted continues with the configurations that are left.
    """
    from protractile.runs.case import reading
    from protractile.runs.case.kinds.model import BuildContext
    from protractile.runs.case.kinds.shell import Shell
    from protractile.runs.chart import output, run
    from protractile.runs.folder.cache import Cache
    from protractile.runs.pipeline import members
    from protractile.runs.process import workers
    from protractile.runs.process.bad_input import BadInput

    checked = reading.load(case)
    planned, shells = run.plan(checked, case), {one.name: one for one in checked.models}
    model = None if shell is None else shells.get(shell)
    if shell is not None and not isinstance(model, Shell):
        raise BadInput(case, "--shell", f"{shell!r} is not a shell of the case; leave it out")
    folder = Path(out or f"runs/out/{Path(case).stem}-chart")
    comm = ranks.launched_ranks(case)
    with ranks.end_all_ranks_on_error(comm):
        if comm is None or comm.rank == 0:
            output.prepare(folder, case)
        with members.rank_executor(comm, workers.workers) as pool:
            if pool is None:
                return 0
            with terminal.display() as report_progress:
                cache = None if no_cache else Cache.of_user()
                chart = run.solve_all(checked, planned, pool, cache, report_progress)
        output.write(chart, folder, excel)
        output.chart_table(chart).show(Terminal())
        print(printable(str(folder / output.PAGE)))
        if isinstance(model, Shell):
            single = ranks.single_rank(1)
            assert single is not None
            context = BuildContext(single, cache=None if no_cache else Cache.of_user())
            checks = [*run.utilisations_by_shell(chart, model, context)]
            output.shell_table(checks, model.name).show(Terminal())
    return 0


COMMANDS = (chart,)
