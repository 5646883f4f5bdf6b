# SPDX-License-Identifier: LGPL-3.0-or-later
"""The commands on measured channels. They import their libraries when they run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from protractile.runs import options
from protractile.runs.process import ending, ranks, terminal
from protractile.runs.process.terminal import Terminal, printable

if TYPE_CHECKING:
    from protractile.runs.report.tables import Table

Model = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="A beam of the case.  \\[default: the last one with play]"),
]


def compare(
    case: options.CaseFile,
    model: Model = None,
    out: Annotated[
        str | None,
        typer.Option(metavar="DIR", help="Output folder.  \\[default: runs/out/CASE-compared]"),
    ] = None,
) -> int:
    """Compare a beam of a case with its measured channels."""
    if ending.launched_rank():
        return 0
    from protractile.runs.case import reading
    from protractile.runs.folder.files import atomic_folder
    from protractile.runs.measured import compare as comparing
    from protractile.runs.measured import page
    from protractile.runs.pipeline.results import prepare

    checked = reading.load(case)
    ranks.enter_mpi(checked.first_shell, case)
    comparison = comparing.compare(checked, model, case)
    folder = prepare(out or f"runs/out/{Path(case).stem}-compared", case, page.CSV)
    with atomic_folder(folder) as part:
        page.write_comparison(comparison, part)
    _show(folder / page.REPORT, comparison.tables)
    return 0


def identify(
    case: options.CaseFile,
    unknown: Annotated[
        list[str],
        typer.Option(
            metavar="KEY=LOW:HIGH",
            help="A number of the case to identify, and its bounds: joint.play=0:0.03. May be "
            "repeated; also measured.time_offset.",
        ),
    ],
    model: Model = None,
    starts: Annotated[int, typer.Option(metavar="N", min=1, help="Number of searches.")] = 4,
    profile: Annotated[
        bool, typer.Option("--profile", help="Draw the profile likelihood of each unknown.")
    ] = False,
    samples: Annotated[
        int | None,
        typer.Option(
            metavar="N",
            help="Predict results of the identified beam: their scatter over N samples of the "
            "unknowns, a power of 2.",
        ),
    ] = None,
    out: Annotated[
        str | None,
        typer.Option(metavar="DIR", help="Output folder.  \\[default: runs/out/CASE-identified]"),
    ] = None,
) -> int:
    """Identify unknown numbers of a case from its measured channels, and predict their effect."""
    if ending.launched_rank():
        return 0
    from protractile.runs.case import reading
    from protractile.runs.folder.files import atomic_folder
    from protractile.runs.measured import identify as identifying
    from protractile.runs.measured import page
    from protractile.runs.pipeline.results import prepare
    from protractile.runs.sweep.sampling import check_count

    unknowns = dict(identifying.parse(text, case) for text in unknown)
    checked = reading.load(case)
    ranks.enter_mpi(checked.first_shell, case)
    folder = prepare(out or f"runs/out/{Path(case).stem}-identified", case, page.CSV)
    if samples is not None:
        check_count(samples, len(unknowns), case)
    with terminal.display() as report_progress:
        found = identifying.identify(
            checked, unknowns, model, starts=starts, file=case,
            progress=lambda part: report_progress("identify", f"{starts} searches", part),
        )  # fmt: skip
        with atomic_folder(folder) as part:
            page.write_identification(found, part, [*unknowns] if profile else ())
        if samples is not None:
            page.predict(found, samples, folder, report_progress)
    _show(folder / page.REPORT, found.tables)
    return 0


def _show(report: Path, tables: Sequence[Table]) -> None:
    """Print the path of a report and its tables."""
    print(printable(str(report)))
    for table in tables:
        table.show(Terminal())


COMMANDS = (compare, identify)
