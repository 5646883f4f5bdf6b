# SPDX-License-Identifier: LGPL-3.0-or-later
"""Verification of the models: ``python -m studies.convergence``.

The studies cover benchmarks, meshes, steps and other models. The command prints their tables, and
writes a report and a page with all values and references.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from importlib import import_module
from itertools import chain
from pathlib import Path
from time import perf_counter

import numpy as np
from rich.console import Console

from protractile.geometry.typography import fixed, number
from protractile.runs.folder.files import write_atomically
from protractile.runs.process.terminal import show_notices
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.document import embed
from protractile.runs.report.figure_context import Figure
from protractile.runs.report.figures import write_pictures
from protractile.runs.report.pages import page
from protractile.runs.report.tables import Table, write
from studies.study import Plot, Study, Verification, wide_console


def figure(plot: Plot) -> Figure:
    """Return the figure of a plot of a study."""
    line_styles = theme.line_styles(list(plot.curves), [])
    curves = [
        # Many points are shown as a curve, few points also as markers.
        Curve(label, np.array(y), line_styles[label].color, line_styles[label].linestyle,
              at=np.array(x), marker="o" if len(x) <= 20 else "")
        for label, (x, y) in plot.curves.items()
    ]  # fmt: skip
    ends = np.concatenate([curve.at for curve in curves if curve.at is not None])
    logarithmic = [0] * plot.logarithmic
    chart = Chart(np.sort(ends)[[0, -1]], curves, [plot.y], along=plot.x,
                  logarithmic=logarithmic, decades=plot.logarithmic)  # fmt: skip
    return Figure(plot.name, plot.title, plot.caption, chart=chart, main=True)


INTRODUCTION = """\
<!-- SPDX-License-Identifier: LGPL-3.0-or-later -->
# Verification

Each row compares a value with a reference. The reference is a formula (*analytic*), a published
value (*external*), another model or method of this project or the limit of a refinement (*other
code*), or the value of an earlier release (*non-regression*). The order is the observed order of
convergence with the mesh size or the step. This command computes all values, draws their
convergence and writes this page to `runs/out/convergence/verification.md`:

    make convergence

`make test` compares the values that take seconds with the same references.
"""


def verification_table(study: Study) -> Table:
    """Return the table of the verifications of a study."""
    return Table.of_rows(
        f"verifications-{study.name}",
        study.title,
        ("what", "value", "reference", "error (%)", "allowed", "", "order", "kind", "source"),
        [_row(verification) for verification in study.verifications],
    )


def markdown(studies: Sequence[Study]) -> str:
    """Return the page of all studies that have verifications, as Markdown."""
    verified = [study for study in studies if study.verifications]
    return "\n".join([INTRODUCTION, *(verification_table(study).markdown() for study in verified)])


def _row(verification: Verification) -> tuple[str, ...]:
    unit = f" {verification.unit}" if verification.unit else ""
    # The number of digits shows the error.
    digits = 6 if verification.error < 1.0e-3 else 5
    return (
        verification.what,
        f"{number(verification.value, digits)}{unit}",
        f"{number(verification.reference, digits)}{unit}",
        number(100.0 * verification.error, 2),
        number(100.0 * verification.allowed, 2),
        "✓" if verification.holds else "✗",
        fixed(verification.order, 2),
        verification.kind,
        verification.source,
    )


OUT = Path("runs/out/convergence")
TITLE = "Verification and validation"

# Modules of studies in the order of the report.
STUDIES = (
    "benchmarks",
    "mesh",
    "contact_size",
    "working_load",
    "calibrated_beams",
    "rule_of_thumb",
    "direct",
    "solid",
    "stress",
    "surface_contact",
    "stiffeners",
    "step_tolerance",
    "damping",
    "stick_slip",
    "interpretations",
    "numerics_1997",
    "verdicts",
    "second_order",
    "large_deflections",
    "wall_buckling",
    "telescoping_column",
    "sections",
    "polygon_distortion",
    "taper",
    "design_results",
    "validation",
)


def run(name: str) -> tuple[Study, float]:
    """Run one study with printed progress; return the study and its time in s."""
    start = perf_counter()
    study: Study = import_module(f"studies.{name}").study(
        lambda what: print(f"{name}: {what} ...", flush=True)
    )
    return study, perf_counter() - start


def survey(names: Sequence[str], folder: Path, console: Console) -> list[Study]:
    """Run some of ``STUDIES`` in parallel, print their tables, and write them to a folder.

    The files are ``convergence.json`` and ``.md``, ``verification.md`` and ``report.html``.
    """
    studies = []
    # FEniCSx does not survive a fork, and the end of a process frees its memory.
    fresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(os.cpu_count(), fresh, show_notices, max_tasks_per_child=1) as pool:
        for study, seconds in pool.map(run, names):
            studies.append(study)
            for table in study.tables:
                table.show(console)
            console.print(f"{study.title}: {seconds:.0f} s\n")
    verified = [study for study in studies if study.verifications]
    for study in verified:
        verification_table(study).show(console)
    tables = [table for study in studies for table in study.tables]
    write(folder, "convergence", TITLE, {one.name: one.data for one in studies}, tables)
    write_atomically(folder / "verification.md", markdown(studies))
    _write_report(studies, folder)
    return studies


def main() -> None:
    """Run the studies on the command line, or all; return 1 if a verification does not hold."""
    show_notices()
    console = wide_console()
    names = sys.argv[1:] or STUDIES
    unknown = [name for name in names if name not in STUDIES]
    if unknown:
        print(f"protractile: {unknown[0]} is no study; give {', '.join(STUDIES)}", file=sys.stderr)
        sys.exit(2)
    try:
        studies = survey(names, OUT, console)
    except BrokenProcessPool:
        print("protractile: the system has killed a study; run fewer at a time", file=sys.stderr)
        sys.exit(3)
    console.print(f"written to {OUT}")
    failed = [
        verification
        for study in studies
        for verification in study.verifications
        if not verification.holds
    ]
    for verification in failed:
        print(f"protractile: not verified: {verification.what}", file=sys.stderr)
    sys.exit(1 if failed else 0)


def _write_report(studies: Sequence[Study], folder: Path) -> None:
    figures = {one.name: [*map(figure, one.plots)] for one in studies}
    everything = [*chain(*figures.values())]
    write_pictures(everything, folder)
    uris, plots = embed(everything, pictures=False)
    content = page(
        "convergence.html",
        uris,
        title=TITLE,
        studies=studies,
        figures=figures,
        verifications={one.name: verification_table(one) for one in studies if one.verifications},
        **plots,
    )
    write_atomically(folder / "report.html", content)


if __name__ == "__main__":
    main()
