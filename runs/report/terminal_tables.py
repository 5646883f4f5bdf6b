# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of runs and of proofs in the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Console

from protractile.geometry.typography import TO_PERCENT
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.combinations import combination_states, combination_tables
from protractile.runs.pipeline.combined_shells import shell_states
from protractile.runs.pipeline.pad_walls import rigid_wall_note
from protractile.runs.pipeline.proofs import proof_table, prove
from protractile.runs.pipeline.results import Results
from protractile.runs.process.terminal import (
    Progress,
    Terminal,
    ignore_progress,
    message,
    say,
    shorten,
)
from protractile.runs.report.additions import Addition, show
from protractile.runs.report.figure_context import farthest
from protractile.runs.report.formatting import number, percent
from protractile.runs.report.model_tables import model_table
from protractile.runs.report.result_tables import record_tables
from protractile.runs.report.summary_table import (
    governing_pads,
    largest_peak,
    limit_faults,
    limit_table,
    play_effect,
    utilisation_verdict,
)
from protractile.runs.report.tables import Cell, Column, Table, print_text

# Terminal headings of columns of the table of models, by their headings in the report.
SHOWN = {
    "model": "model",
    "degrees of freedom": "dofs",
    "first contact\ns": "first contact\ns",
    "first tip peak\ns": "first tip peak\ns",
    "first tip peak\nmm": "peak\nmm",
    "energy residual\n/ largest work": "energy residual\n/ largest work",
    "computing time\ns": "computing\ntime, s",
}

# Short name of the governing kind of utilisation.
_GOVERNING = {"plate": "plate", "outer fibre": "bending", "pad": "pad", "detail": "fatigue"}


def print_runs(runs: Mapping[str, Results], judged: Mapping[str, Addition]) -> int:
    """Print models, numerics, output of the client and results; return the exit status.

    Runs, and the additions of the client, have their names in messages as keys.
    """
    console = Terminal()
    for results in runs.values():
        print_models(results, console)
    status = show(judged, console)
    for file, results in runs.items():
        print_results(results, console)
        for fault in limit_faults(results):
            status = 1
            say(message(f"{shorten(file)}: {fault}"))
    return status


def print_failures(file: str, results: Results) -> int:
    """Print one line on the failed models of a run; return the status 3, or 0 without failures."""
    failures = results.summary.failures
    if not failures:
        return 0
    numbers = {model.name: i for i, model in enumerate(results.case.models, start=1)}
    first, *others = (f"model[{numbers[name]}]" for name in failures)
    too = f"{', '.join(others)} failed, too; first " if others else ""
    say(message(f"{shorten(file)}: {too}{first}: {next(iter(failures.values()))}"))
    return 3


def print_models(results: Results, console: Console) -> None:
    """Print the table of models, notes on accuracy, and cautions."""
    texts = {column.heading: column.text for column in model_table(results).columns}
    columns = [Column(SHOWN[one], texts[one]) for one in texts if one in SHOWN]
    Table(f"Models: {results.case.title}", columns).show(console)
    for name, model in results.summary.models.items():
        if errors := model.reduction_errors:
            print_text(
                console,
                f"{name}: {model.modes} generalised coordinates. Relative errors of the reduction: "
                f"local contact compliance {number(errors['contact_compliance'], 1)}, deflections "
                f"of tip and segment heads {number(errors['deflections'], 1)}. Mesh error of "
                "the local contact compliance: "
                f"{'unknown' if model.mesh_error is None else percent(model.mesh_error, 2)}.",
            )
    skipped = results.summary.snapshots.skipped
    missing = [] if skipped is None else [f"no snapshots: {skipped}"]
    for line in (*missing, *results.summary.cautions):
        print_text(console, line)


def print_results(results: Results, console: Console) -> None:
    """Print the governing results of each model and the utilisations of the first main model."""
    design = results.summary.design
    if not design.models:
        return
    tables = result_table(results), lateral_table(results), limit_table(results)
    largest = [*combination_tables(design.combinations, results.case)][:1]
    for table in (*filter(None, tables), *record_tables(results), *largest):
        table.show(console)
    for line in filter(None, (play_effect(results), utilisation_verdict(results))):
        print_text(console, f"{results.main_models[0]}: {line[0].lower()}{line[1:]}")


def result_table(results: Results) -> Table:
    """Return the table of governing design results, with a row for each model."""
    designs, pads = results.summary.design.models, governing_pads(results)
    names = [name for name in results.summary.models if name in designs]
    static = [[state.tip for state in designs[name].static] for name in names]
    highest = [max(tips, key=abs, default=None) for tips in static]
    peaks = [largest_peak(designs[name], "deflection") for name in names]
    modes = [designs[name].modes for name in names]
    forces: list[Cell] = [pads[name].force if name in pads else None for name in names]
    if not pads:
        contacts = [largest_peak(designs[name], "contact force") for name in names]
        forces = [one.largest if one else None for one in contacts]
    used = [results.summary.utilisations(name).values() for name in names]
    governing = [max(several, key=lambda one: one.value or 0.0, default=None) for several in used]
    shares = [
        f"{TO_PERCENT * one.value:.3g} {_GOVERNING[one.part]}" if one and one.value else None
        for one in governing
    ]
    tips = [farthest(results.trajectories["tip"].sel(model=name).values) for name in names]
    columns = [
        Column("model", names),
        Column("static tip\nt = 0", [tip[0] if tip else None for tip in static], ".1f", "mm"),
        Column("static tip\nmax. load", highest, ".1f", "mm"),
        Column("dynamic\ntip", tips, ".1f", "mm"),
        Column("φ", [one.factor if one else None for one in peaks], ".3g"),
        Column("first\nmode", [m[0].frequency if m else None for m in modes], ".3g", "Hz"),
        Column("one pad" if pads else "contact\nforce", forces, ".3g", "kN"),
        Column("utilisation", shares, "", "%"),
    ]
    columns = [one for one in columns if any(cell is not None for cell in one.cells)]
    models = [model for model in results.completed_models if model.name in names]
    notes = [
        "φ: maximum in motion over the static value under the maximum load."
        + " One pad: largest force of one pad of a pair." * bool(pads)
        + " Utilisation: of the governing strength." * any(shares),
        *filter(None, [rigid_wall_note(models, results.boom)]),
    ]
    return Table(f"Results: {results.case.title}", columns, notes)


def lateral_table(results: Results) -> Table | None:
    """Return the table of lateral tip deflections; None for a flat boom."""
    designs = results.summary.design.models
    if "tip_lateral" not in results.trajectories:
        return None
    names, moved = [*designs], results.trajectories["tip_lateral"]
    static_tips = [[state.tip_lateral or 0.0 for state in one.static] for one in designs.values()]
    dynamic = [farthest(moved.sel(model=name).values) for name in names]
    columns = [
        Column("model", names),
        Column("static, t = 0", [tips[0] if tips else None for tips in static_tips], ".1f", "mm"),
        Column(
            "static, max. load", [max(t, key=abs, default=None) for t in static_tips], ".1f", "mm"
        ),
        Column("dynamic", dynamic, ".1f", "mm"),
    ]
    return Table("Lateral tip deflection", columns)


def print_proofs(
    case: Case,
    file: str,
    console: Console,
    shell: tuple[Shell, BuildContext] | None = None,
    progress: Progress = ignore_progress,
) -> int:
    """Print the proofs of a checked case; return 1 if a proof fails, otherwise 0.

    Lines on proofs that fail go to stderr. With a shell and its build context, all ranks must call,
    and the shell replaces beam elements.

    Raises:
        NumericsError: a combination has no equilibrium.
    """
    if shell is None:
        states = combination_states(case, progress=progress)
    else:
        states = shell_states(case, *shell)
    if not states:
        # Only the first rank has the states of a shell.
        return 0
    results = prove(case, states)
    print_text(console, case.title)
    name = "" if shell is None else shell[0].name
    for table in combination_tables([one.result for one in states], case, name):
        table.show(console)
    proof_table(results, case).show(console)
    failed = [one for one in results.proofs if not one.holds]
    # The lines on stderr begin with the governing proof.
    print_text(console, f"{results.tally}." if failed else results.governing(case.system))
    for one in failed:
        say(message(f"{shorten(file)}: {one.text(case.system)}. Remedy: {one.remedy}"))
    return 1 if failed else 0
