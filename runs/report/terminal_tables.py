# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of runs and of proofs in the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from rich.console import Console

from protractile.analysis.rows import INITIAL, MOTION, REST, Rows
from protractile.geometry.typography import number, percent
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.response import deflections
from protractile.runs.cautions.rules import cautions
from protractile.runs.pipeline.combinations import combination_states
from protractile.runs.pipeline.combined_shells import shell_states
from protractile.runs.pipeline.pad_walls import rigid_wall_note
from protractile.runs.pipeline.proofs import prove
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
from protractile.runs.report.model_tables import model_table
from protractile.runs.report.proof_tables import (
    KINDS,
    governing_proof,
    holds,
    proof_table,
    proof_text,
    tally,
)
from protractile.runs.report.result_tables import record_tables
from protractile.runs.report.static_tables import combination_tables
from protractile.runs.report.summary_table import (
    limit_faults,
    limit_table,
    play_effect,
    utilisation_verdict,
    utilisations,
)
from protractile.runs.report.tables import Column, Table, print_text

# Terminal headings of columns of the table of models, by their headings in the report.
SHOWN = {
    "model": "model",
    "degrees of freedom": "dofs",
    "first contact\ns": "first\ncontact\ns",
    "first tip peak\ns": "first\ntip peak\ns",
    "first tip peak\nmm": "peak\nmm",
    "energy residual\n/ largest work": "energy\nresidual",
    "computing time\ns": "time\ns",
}


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


def print_brief(runs: Mapping[str, Results], judged: Mapping[str, Addition]) -> int:
    """Print output of the client, models of the first run, missed limits; return the exit status.

    Runs, and the additions of the client, have the names of their folders as keys.
    """
    console, results = Terminal(), next(iter(runs.values()))
    status = show(judged, console)
    shown_models(results).show(console)
    for file, other in runs.items():
        for fault in limit_faults(other):
            status = 1
            say(message(f"{shorten(file)}: {fault}"))
    return status


def print_first_results(results: Results) -> None:
    """Print the results of the models that have finished while the run goes on."""
    table, models = result_table(results), len(results.case.models)
    title = f"Results so far, {len(results.summary.models)} of {models} models"
    replace(table, title=title, notes=()).show(Terminal())


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
    shown_models(results).show(console)
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


def shown_models(results: Results) -> Table:
    """Return the table of models with the columns that fit a terminal."""
    columns = model_table(results).columns
    kept = [Column(SHOWN[of.heading], of.text) for of in columns if of.heading in SHOWN]
    return Table(f"Models: {results.case.title}", kept)


def print_results(results: Results, console: Console) -> None:
    """Print the governing results of each model and the utilisations of the first main model."""
    if not results.summary.design.models:
        return
    tables = result_table(results), lateral_table(results), limit_table(results)
    largest = [*combination_tables(results.rows, results.case)][:1]
    for table in (*filter(None, tables), *record_tables(results), *largest):
        table.show(console)
    for line in filter(None, (play_effect(results), utilisation_verdict(results))):
        print_text(console, f"{results.main_models[0]}: {line[0].lower()}{line[1:]}")


def result_table(results: Results) -> Table:
    """Return the table of governing design results, with a row for each model."""
    names = [name for name in results.summary.models if name in results.summary.design.models]
    of_models = [results.rows.where(model=name, play=True) for name in names]
    static, highest, dynamic = _tips(of_models, "tip")
    moved = [rows.where(state=MOTION) for rows in of_models]
    peaks = [rows.where(quantity="tip").largest for rows in moved]
    modes = [rows.where(state=INITIAL, quantity="frequency") for rows in of_models]
    used = [utilisations(rows) for rows in of_models]
    padded = any("pad_pressure" in of_model for of_model in used)
    carried = [rows.where(quantity="pad_force" if padded else "contact_force") for rows in moved]
    governing = [Rows(of_model.values()).governing for of_model in used]
    shares = [row.utilisation if row else None for row in governing]
    columns = [
        Column("model", names),
        Column("static tip\nt = 0", static, ".1f", "mm"),
        Column("static tip\nmax. load", highest, ".1f", "mm"),
        Column("dynamic\ntip", dynamic, ".1f", "mm"),
        Column("φ", [peak and results.rows.dynamic_factor(peak) for peak in peaks], ".3g"),
        Column("first\nmode", [mode[0].value if mode else None for mode in modes], ".3g", "Hz"),
        Column(
            "one pad" if padded else "contact\nforce",
            [row and abs(row.value) for row in (rows.largest for rows in carried)],
            ".3g",
            "kN",
        ),
        Column("used", shares, ".3g", "%"),
        Column("by", [row.of.short if row and row.utilisation else None for row in governing]),
    ]
    columns = [column for column in columns if any(cell is not None for cell in column.cells)]
    models = [model for model in results.completed_models if model.name in names]
    notes = [
        "φ: maximum in motion over the static value under the maximum load."
        + " One pad: largest force of one pad of a pair." * padded
        + " Used: part of the governing strength." * any(shares),
        *filter(None, [rigid_wall_note(models, results.boom)]),
    ]
    return Table(f"Results: {results.case.title}", columns, notes)


def lateral_table(results: Results) -> Table | None:
    """Return the table of lateral tip deflections; None for a flat boom."""
    if not results.boom.spatial:
        return None
    names = [*results.summary.design.models]
    of_models = [results.rows.where(model=name, play=True) for name in names]
    headings = "static, t = 0", "static, max. load", "dynamic"
    tips = _tips(of_models, "tip_lateral")
    columns = [
        Column(heading, cells, ".1f", "mm") for heading, cells in zip(headings, tips, strict=True)
    ]
    return Table("Lateral tip deflection", [Column("model", names), *columns])


def _tips(of_models: Sequence[Rows], quantity: str) -> list[list[float | None]]:
    """Return the deflections of the tip at t = 0, under extreme loads and in motion."""
    return [
        [row and row.value for row in (rows.where(**labels).largest for rows in of_models)]
        for labels in ({"state": state, "quantity": quantity} for state in (INITIAL, REST, MOTION))
    ]


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
    proofs = prove(case, states)
    print_text(console, case.title)
    name = "" if shell is None else shell[0].name
    rows = Rows(row for state in states for row in state.rows)
    for table in combination_tables(rows, case, name):
        table.show(console)
    proof_table(proofs, case).show(console)
    failed = [row for row in proofs.rows if not holds(row)]
    for line in cautions(Context(case, build_boom(case), combined=rows), [deflections]):
        print_text(console, line)
    # The lines on stderr begin with the governing proof.
    print_text(console, f"{tally(proofs)}." if failed else governing_proof(proofs, case.system))
    for row in failed:
        text = proof_text(row, proofs, case.system)
        say(message(f"{shorten(file)}: {text}. Remedy: {KINDS[row.quantity].remedy}"))
    return 1 if failed else 0
