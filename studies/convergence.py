# SPDX-License-Identifier: LGPL-3.0-or-later
"""What proves the models: ``python -m studies.convergence``.

Studies of benchmarks, meshes, steps and other models; each prints its tables when it is done, and
all together leave a report, and a page of every value beside its reference.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from importlib import import_module
from pathlib import Path
from time import perf_counter

from rich.console import Console

from runs.folder.files import whole_folder, write_whole
from runs.process.terminal import show_notices
from runs.report.pages import page
from runs.report.tables import wide_console, write
from studies import plots, verification
from studies.study import Study

OUT = Path("runs/out/convergence")
TITLE = "What proves the models"

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
    "damping",
    "refinement",
    "model_ladder",
    "histories",
    "stick_slip",
    "as_computed_then",
    "supports",
    "second_order",
    "drawn_column",
    "sections",
    "taper",
    "answers",
)


def run(name: str) -> tuple[Study, float]:
    """One study, and the seconds that it takes; it tells of its steps on stdout."""
    start = perf_counter()
    study: Study = import_module(f"studies.{name}").study(partial(_tell, name))
    return study, perf_counter() - start


def survey(names: Sequence[str], folder: Path, console: Console) -> list[Study]:
    """Run studies side by side, print their tables, and write them to a folder.

    Args:
        names: of ``STUDIES``.
        folder: gets ``convergence.json`` and ``.md``, ``verification.md``, ``report.html``.
        console: for the tables.
    """
    found: dict[str, Study] = {}
    # FEniCSx does not outlive a fork, and a study's memory ends with its process.
    fresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(os.cpu_count(), fresh, show_notices, max_tasks_per_child=1) as pool:
        running = {pool.submit(run, name): name for name in names}
        for done in as_completed(running):
            study, seconds = done.result()
            found[running[done]] = study
            for table in study.tables:
                table.show(console)
            console.print(f"{study.title}: {seconds:.0f} s\n")
    studies = [found[name] for name in names]
    proving = [study for study in studies if study.proofs]
    for study in proving:
        verification.table(study).show(console)
    tables = [table for study in studies for table in study.tables]
    write(folder, "convergence", TITLE, {one.name: one.data for one in studies}, tables)
    write_whole(folder / "verification.md", verification.markdown(studies))
    _write_report(studies, folder)
    return studies


def main() -> None:
    """Run the studies that are named on the command line, or all; 1 if a proof does not hold."""
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
    failed = [proof for study in studies for proof in study.proofs if not proof.holds]
    for proof in failed:
        print(f"protractile: not proven: {proof.what}", file=sys.stderr)
    sys.exit(1 if failed else 0)


def _write_report(studies: Sequence[Study], folder: Path) -> None:
    with whole_folder(folder / "figures") as pictures:
        drawn = {one.name: [plots.draw(plot, pictures) for plot in one.plots] for one in studies}
        content = page(
            "convergence.html",
            title=TITLE,
            studies=studies,
            figures=drawn,
            proofs={one.name: verification.table(one) for one in studies if one.proofs},
        )
    write_whole(folder / "report.html", content)


def _tell(study: str, what: str) -> None:
    print(f"{study}: {what} ...", flush=True)


if __name__ == "__main__":
    main()
