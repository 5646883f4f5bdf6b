# SPDX-License-Identifier: LGPL-3.0-or-later
"""The command line.

Exit status: 0 for success, 1 if a demand or a limit of the case is not met, 2 for bad input, 3 for
a numerical failure.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer

# Each command imports its own libraries, since all libraries together take seconds to load.
from protractile.runs import clients, options
from protractile.runs.process import ending, ranks, terminal
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.terminal import Terminal, printable

app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
)

# Commands that one rank executes; the other commands share their work among ranks.
_OF_ONE_RANK = ("report", "snapshot", "check", "new", "schema")


def _print_version(requested: bool) -> None:
    if requested:
        from protractile.runs.folder.versions import installed_version

        print(f"protractile {installed_version('protractile') or '(not installed)'}")
        raise typer.Exit


@app.callback()
def protractile(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version and exit."
        ),
    ] = False,
) -> None:
    """Simulate vibrations of telescopic booms with play between their segments."""
    if context.invoked_subcommand in _OF_ONE_RANK and ending.launched_rank():
        raise typer.Exit


@app.command()
def run(
    case: options.CaseFile,
    out: Annotated[
        str | None, typer.Option(metavar="DIR", help="Output folder.  \\[default: runs/out/CASE]")
    ] = None,
    models: options.ModelNames = None,
    mesh_size: options.MeshSize = None,
    modes: options.Modes = None,
    members: Annotated[
        int | None, typer.Option(metavar="N", help="Runs in each model's ensemble, 0 for none.")
    ] = None,
    no_cache: options.NoCache = False,
    large: options.Large = False,
    no_pictures: Annotated[bool, typer.Option("--no-pictures", help="Draw no snapshots.")] = False,
) -> int:
    """Run the models of a case, compare them, and write the results to a folder."""
    from protractile.runs.case import reading

    effective = reading.select(
        reading.load(case), case, options.split_names(models), mesh_size, members, modes
    )
    # These imports are slow, and follow the check of the case, so that its errors appear at once.
    from protractile.runs.process import workers
    from protractile.runs.report import opengl

    with workers.helper(opengl.silence_stderr) as helper:
        if helper and not ending.launched_rank() and effective.first_shell:
            # The helper imports FEniCSx while this process imports other modules.
            helper.submit(import_module, "protractile.shell_model.reduced_shell")
        from protractile.runs.cautions.rules import add_cautions
        from protractile.runs.folder.cache import Cache
        from protractile.runs.folder.files import atomic_folder
        from protractile.runs.pipeline import estimates
        from protractile.runs.pipeline.model_run import RunContext
        from protractile.runs.pipeline.results import prepare
        from protractile.runs.pipeline.run import run_case
        from protractile.runs.report.additions import judge
        from protractile.runs.report.terminal_tables import (
            print_failures,
            print_first_results,
            print_runs,
        )

        if not large:
            estimates.refuse_large(estimates.run_cost(effective), case)
        cache = None if no_cache else Cache.of_user()
        comm = ranks.enter_mpi(effective.first_shell, case)
        if comm is None and effective.ensemble is not None:
            comm = ranks.launched_ranks(case)
        with ranks.end_all_ranks_on_error(comm):
            if ending.launched_rank() if comm is None else comm.rank:
                if comm is not None:
                    run_case(effective, case, RunContext(comm, cache=cache))
                return 0
            folder = prepare(out or f"runs/out/{Path(case).stem}", case)
            with (
                atomic_folder(folder) as part,
                terminal.display(
                    [model.name for model in effective.models], Path(case).stem
                ) as report_progress,
            ):
                pictures = "protractile.runs.report.snapshots", "pyvista.plotting"
                writers = ("protractile.runs.report.output",)
                tools = cache, cache, helper, () if no_pictures else pictures, writers
                context = RunContext(comm, report_progress, *tools)
                finished = run_case(effective, case, context, print_first_results)
                assert finished is not None
                # The libraries of figures take half a second, for which no number waits.
                from protractile.runs.report import output

                with output.write_in_two_steps(finished, part, not no_pictures, helper) as write:
                    finished.evaluate()
                    add_cautions(finished.results)
                    judged = judge(finished.results)
                    report_progress("report", "pictures and figures", 0.0)
                    write(judged)
                report_progress("report", "pictures and figures", 1.0)
    print(printable(str(folder / output.REPORT)))
    status = print_runs({case: finished.results}, {case: judged})
    return print_failures(case, finished.results) or status


@app.command()
def report(
    folders: Annotated[list[str], typer.Argument(metavar="DIR...", help="The folders of runs.")],
    excel: Annotated[
        bool,
        typer.Option("--excel", help="Also write results.xlsx, a workbook of design results."),
    ] = False,
    figures: Annotated[
        bool,
        typer.Option("--figures", help="Also write all figures as PNG, and show them on paper."),
    ] = False,
    brief: Annotated[
        bool,
        typer.Option(
            "--brief", help="Render nothing; print the models of the first run, and paths."
        ),
    ] = False,
) -> int:
    """Render the reports of runs again from their data, and print their tables."""
    runs, judged = {}, {}
    if brief:
        from protractile.runs.pipeline.results import Results
        from protractile.runs.report.additions import judge
        from protractile.runs.report.terminal_tables import print_brief

        for folder in folders:
            runs[folder] = Results.load(folder)
            judged[folder] = judge(runs[folder])
        status = print_brief(runs, judged)
        print(printable(f"Reports: {' '.join(f'{folder}/report.html' for folder in folders)}"))
        return status
    from protractile.runs.report.output import rerender_report
    from protractile.runs.report.terminal_tables import print_runs

    for folder in folders:
        option = "--excel" if excel else None
        with rerender_report(folder, option, figures) as (results, addition, _):
            runs[folder], judged[folder] = results, addition
    return print_runs(runs, judged)


@app.command()
def snapshot(
    folder: options.Folder,
    time: Annotated[
        list[float] | None, typer.Option(metavar="T", help="Time in s; may be repeated.")
    ] = None,
) -> int:
    """Render the deformed shells of a run, and add the pictures to its report."""
    from protractile.runs.pipeline.results import TRAJECTORIES
    from protractile.runs.report import snapshots
    from protractile.runs.report.opengl import RenderingUnavailable
    from protractile.runs.report.output import rerender_report

    with rerender_report(folder) as (results, _, part):
        last = results.case.time.duration
        for t in time or []:
            if not 0.0 <= t <= last:
                raise BadInput(folder, "--time", f"must be between 0 and {last:g} s, got {t:g}")
        shells = snapshots.shell_files(Path(folder))
        try:
            times = sorted(set(time)) if time else None
            motion = Path(folder) / TRAJECTORIES
            with snapshots.start_rendering(
                results, shells, motion, part, times, every_view=True
            ) as gather:
                names_of_pictures = gather()
        except RenderingUnavailable as reason:
            raise BadInput(folder, snapshots.SNAPSHOTS, f"cannot be made: {reason}") from None
    for name in names_of_pictures:
        print(printable(str(Path(folder) / snapshots.SNAPSHOTS / name)))
    return 0


@app.command()
def sweep(
    case: options.CaseFile,
    vary: options.Vary = [],  # noqa: B006 # typer takes the default of a repeated option as a list
    out: options.SweepFolder = None,
    models: options.ModelNames = None,
    mesh_size: options.MeshSize = None,
    no_cache: options.NoCache = False,
    large: options.Large = False,
    against: options.Against = None,
    until: options.Until = None,
    sensitivity: options.Sensitivity = False,
    samples: options.Samples = None,
) -> int:
    """Run a parameter study of a case, and chart the results of its models.

    Finished points stay in the folder and are not run again. Sections are inferred with the play of
    the case file, not with a varied play. Under mpirun all ranks except the first run points;
    otherwise all cores run them. Ensembles are not run.
    """
    from protractile.runs.folder.cache import Cache
    from protractile.runs.pipeline import estimates, members
    from protractile.runs.process import workers
    from protractile.runs.sweep import output as charts
    from protractile.runs.sweep import points, sampling, search
    from protractile.runs.sweep import run as sweep_runs

    other_options = ["--sensitivity"] * sensitivity + [sampling.OPTION] * (samples is not None)
    if len(other_options) + bool(vary) != 1:
        what = f"does not go with {' and '.join(other_options)}" if other_options else "missing"
        raise BadInput(case, "--vary", f"{what}; give one of --vary, --sensitivity and --samples")

    names = options.split_names(models)
    plan_of = partial(points.plan, case, models=names, mesh_size=mesh_size, reference=against)
    conclude: Callable[..., None] = charts.conclude
    if sensitivity:
        plan, changed_numbers = sampling.plan_changes(case, names, mesh_size)
        conclude = partial(sampling.conclude_changes, changed_numbers)
    elif samples is not None:
        plan, samples_table = sampling.plan_samples(case, names, mesh_size, samples)
        conclude = partial(sampling.conclude_samples, samples_table)
    else:
        plan = plan_of(vary)
    bound = None if until is None else search.parse_bound(until, plan)
    if not large:
        estimates.refuse_large(estimates.sweep_cost([point.case for point in plan.points]), case)
    comm = ranks.enter_mpi(plan.points[0].case.first_shell, case) or ranks.launched_ranks(case)
    with ranks.end_all_ranks_on_error(comm):
        folder = Path(out or f"runs/out/{Path(case).stem}-sweep")
        if comm is None or comm.rank == 0:
            sweep_runs.prepare(folder, case)
        with members.rank_executor(comm, workers.workers) as pool:
            if pool is None:
                return 0
            with terminal.display() as report_progress:
                cache = None if no_cache else Cache.of_user()
                tools = folder, pool, report_progress, cache
                plan, outcomes = search.run_until(plan, bound, plan_of, *tools)
        conclude(plan, outcomes, folder, Terminal())
        if bound is not None:
            search.print_bracket(plan, outcomes, bound, Terminal())
        return sweep_runs.print_failures(plan, outcomes)


@app.command()
def frequencies(
    case: options.CaseFile,
    vary: options.Vary,
    out: options.SweepFolder = None,
    models: options.ModelNames = None,
    mesh_size: options.MeshSize = None,
    no_cache: options.NoCache = False,
    large: options.Large = False,
) -> int:
    """Compute the first natural frequencies over the values of keys.

    The joints are once in contact where they touch at rest under the loads, and once bonded.
    """
    from protractile.runs.folder.cache import Cache
    from protractile.runs.pipeline import estimates
    from protractile.runs.sweep import frequencies as measured
    from protractile.runs.sweep import points
    from protractile.runs.sweep import run as sweep_runs

    plan = points.plan(case, vary, options.split_names(models), mesh_size)
    cases = [point.case for point in plan.points]
    if not large:
        estimates.refuse_large(estimates.frequencies_cost(cases), case)
    comm = ranks.enter_mpi(cases[0].first_shell, case)
    cache = None if no_cache else Cache.of_user()
    with ranks.end_all_ranks_on_error(comm):
        if ending.launched_rank() if comm is None else comm.rank:
            if comm is not None:
                measured.measure(cases, comm, cache)
            return 0
        folder = Path(out or f"runs/out/{Path(case).stem}-sweep")
        sweep_runs.prepare(folder, case)
        with terminal.display() as report_progress:
            data = measured.gather(plan, measured.measure(cases, comm, cache, report_progress))
        measured.write(data, folder)
        print(printable(str(folder / f"{measured.NAME}.csv")))
        measured.table(data).show(Terminal())
    return 0


@app.command()
def check(
    case: options.CaseFile,
    picture: options.Picture = None,
    large: options.Large = False,
    whole: Annotated[
        bool,
        typer.Option("--all", help="Also print segments, joints, masses, loads and modes."),
    ] = False,
) -> int:
    """Check a case file, and print cautions, static results, stresses and first frequency."""
    from protractile.runs.case.reading import load_checked
    from protractile.runs.check import check_case
    from protractile.runs.pipeline import estimates

    checked = load_checked(case)
    if not large:
        estimates.refuse_large(estimates.states_cost(checked.case, proofs=False), case)
    if picture is not None:
        import_module("protractile.runs.report.boom_drawing").save_drawing(
            checked.case, case, picture
        )
    with terminal.display() as report_progress:
        result = check_case(checked, report_progress)
    result.show(Terminal(), whole)
    if not whole:
        print("Segments, joints, masses, loads, reactions and modes: protractile check --all")
    return 0


@app.command()
def prove(
    case: options.CaseFile,
    shell: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="A shell of the case, in place of beam elements."),
    ] = None,
    no_cache: options.NoCache = False,
    large: options.Large = False,
) -> int:
    """Prove strength, stability, deflection and fatigue for all combinations of a case.

    The exit status is 1 where a proof fails.
    """
    from protractile.runs.case.kinds.shell import Shell
    from protractile.runs.case.reading import load
    from protractile.runs.pipeline import estimates
    from protractile.runs.report.terminal_tables import print_proofs

    checked = load(case)
    if not large:
        estimates.refuse_large(estimates.states_cost(checked, proofs=True), case)
    if shell is None:
        if ending.launched_rank():
            return 0
        with terminal.display() as report_progress:
            return print_proofs(checked, case, Terminal(), progress=report_progress)
    shells = {model.name: model for model in checked.models if isinstance(model, Shell)}
    if shell not in shells:
        what = f"{shell!r} is not a shell of the case; leave it out for beam elements"
        raise BadInput(case, "--shell", what)
    comm = ranks.enter_mpi(checked.first_shell, case)
    assert comm is not None
    from protractile.runs.case.kinds.model import BuildContext
    from protractile.runs.folder.cache import Cache

    with ranks.end_all_ranks_on_error(comm), terminal.display([shell]) as report_progress:
        stages = partial(report_progress, shell)
        context = BuildContext(comm, stages, None if no_cache else Cache.of_user())
        return print_proofs(checked, case, Terminal(), (shells[shell], context))


for client in clients.modules("commands"):
    for command in client.COMMANDS:
        app.command()(command)


@app.command()
def new(case: options.CaseFile, standard: options.OfStandard, kind: options.OfKind) -> int:
    """Write a case file to start from, with load combinations to be checked in your edition."""
    from protractile.runs.case.starting_points import write_case

    write_case(case, standard, kind)
    print(f"{printable(case)}: change its numbers, then protractile check and prove it.")
    return 0


@app.command()
def schema() -> int:
    """Print the JSON Schema of a case file."""
    from protractile.runs.case.schema import case_schema

    # The text is longer than the buffer, so that a closed pipe raises its error here.
    with suppress(BrokenPipeError):
        print(json.dumps(case_schema(), indent=1))
    return 0


def main(arguments: Sequence[str] | None = None) -> None:
    """Run a command and exit. Print an error that the user can correct as one line on stderr."""
    terminal.prepare()
    terminal.show_notices()
    if ending.launched_rank():
        # Help, progress and results are those of the first rank.
        sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115 # for the whole process
    # Figures go into files, whatever backend the environment selects.
    os.environ["MPLBACKEND"] = "agg"
    command = typer.main.get_command(app)
    try:
        with terminal.flush_output():
            status = command.main(arguments, prog_name="protractile", standalone_mode=False)
    except Exception as error:
        explanation = ranks.explain(error)
        if explanation is None:
            raise
        ending.fail(*explanation, None)
    sys.exit(status or 0)
