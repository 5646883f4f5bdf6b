# SPDX-License-Identifier: LGPL-3.0-or-later
"""Load charts as tables, pictures and a page."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import floor, log10
from pathlib import Path
from typing import Any

from protractile.analysis.quantities import PROVED
from protractile.analysis.rows import COMBINATION, Row
from protractile.geometry.typography import NONE, fixed, join_words, number, percent
from protractile.runs.case.build import build_boom
from protractile.runs.case.user_files import check_not_working_folder
from protractile.runs.cautions.response import TOLD_DEFLECTION, deflection_error
from protractile.runs.chart.cells import (
    LARGEST,
    NO_EQUILIBRIUM,
    OUT_OF_REACH,
    STROKE,
    Cell,
    chart_of,
    combined_case,
    load_case_of,
)
from protractile.runs.chart.run import Chart
from protractile.runs.folder.files import atomic_folder
from protractile.runs.pipeline.proofs import cylinder_notes
from protractile.runs.process.bad_input import BadInput
from protractile.runs.report.proof_tables import holds
from protractile.runs.report.tables import Column, Table

CSV, PAGE, WORKBOOK = "chart.csv", "chart.html", "chart.xlsx"

# Letters of what governs a capacity: a proof, the largest payload that is tried, or the boom, which
# cannot stand at the radius with a larger one.
LETTERS = {
    "yield": "Y", "patch": "Y", "plate": "P", "buckling": "P", "column": "C", "pad": "D",
    "cylinder": "L", "pin": "N", "deflection": "W", "tipping": "T",
    LARGEST: "M", OUT_OF_REACH: "R", NO_EQUILIBRIUM: "E", STROKE: "S",
}  # fmt: skip

# Digits of a capacity in the chart.
_DIGITS = 3


def kind_of(cell: Cell) -> str:
    """Return the kind of the governing proof of a cell, or the other reason of its capacity."""
    return cell.reason or cell.proofs[0].quantity


def shown(cell: Cell) -> str:
    """Return the capacity in t, rounded down, with the letter of what governs."""
    if not cell.capacity:
        return NONE
    unit = 10.0 ** (floor(log10(cell.capacity)) - _DIGITS + 1)
    return f"{number(1.0e-3 * unit * floor(cell.capacity / unit))} {LETTERS[kind_of(cell)]}"


def utilisation(cell: Cell) -> str:
    """Return the governing utilisation in percent, with the letter of its proof."""
    if not cell.proofs:
        return NONE
    return f"{number(100.0 * (cell.proofs[0].utilisation or 0.0))} {LETTERS[kind_of(cell)]}"


def chart_table(chart: Chart) -> Table:
    """Return the table of capacities over radius and length."""
    keys = chart_of(chart.case)
    radius, angle = ("radius", keys.radii, "m"), ("luffing angle", keys.luffing, "deg")
    name, rows, unit = radius if keys.radii else angle
    columns, cell_text = [Column(name, rows, ".4g", unit)], text_of(chart)
    for cells in chart.cells:
        columns.append(Column(f"{number(cells[0].length)} m", [cell_text(cell) for cell in cells]))
    kinds = {kind_of(cell) for cells in chart.cells for cell in cells if cell.capacity}
    letters = {LETTERS[kind]: _name(kind) for kind in sorted(kinds)}
    what = "Capacities in t, rounded down"
    if keys.payload is not None:
        what = f"Governing utilisations in % with {number(keys.payload)} kg"
    governing = ", ".join(f"{letter} {name}" for letter, name in letters.items())
    notes = [f"{what}, over {name} and boom length. Governing: {governing}.", *_reasons(chart)]
    notes += [*_large_deflection(chart), *_not_proved(chart)]
    return Table("Load chart", columns, notes, "chart")


def text_of(chart: Chart) -> Callable[[Cell], str]:
    """Return the function that gives the text of a cell."""
    return shown if chart_of(chart.case).payload is None else utilisation


def _name(kind: str) -> str:
    return PROVED[kind].title if kind in PROVED else kind


def _reasons(chart: Chart) -> list[str]:
    """Return sentences on the cells without capacity, by reason."""
    places: dict[str, list[str]] = {}
    for cell in (cell for cells in chart.cells for cell in cells if not cell.capacity):
        place = f"{number(cell.length)} m at {number(cell.radius)} m"
        places.setdefault(cell.reason, []).append(place)
    if OUT_OF_REACH in places:
        places[OUT_OF_REACH] = ["where no other reason is given"]
    return [f"{NONE} {reason}: {', '.join(where)}." for reason, where in places.items()]


def _large_deflection(chart: Chart) -> Iterator[str]:
    """Yield a sentence on the largest deflection for its length, unless it is small."""
    deflected = [cell for cells in chart.cells for cell in cells if cell.tip]
    if deflected:
        worst = max(deflected, key=lambda cell: abs(cell.tip or 0.0) / cell.length)
        part = abs(worst.tip or 0.0) / worst.length
        if part > TOLD_DEFLECTION:
            yield (
                f"At {number(worst.length)} m and a radius of {number(worst.radius)} m the rated "
                f"load deflects the tip by {deflection_error(part)}."
            )


def _not_proved(chart: Chart) -> list[str]:
    """Return sentences on the proofs that do not limit the chart because data are missing."""
    case = combined_case(chart.case, load_case_of(chart.case, 0.0, {}, 0.0))
    requested = {kind for combination in case.combinations for kind in combination.proofs}
    proved = {row.quantity for cells in chart.cells for cell in cells for row in cell.proofs}
    missing = [PROVED[kind].title for kind in PROVED if kind in requested - proved]
    lines = [f"Not proved, for lack of data: {join_words(missing)}."] if missing and proved else []
    if "cylinder" in requested and proved:
        lines += cylinder_notes(build_boom(case))
    if case.chassis is not None and "tipping" not in requested:
        lines.append("Tipping is not proved: no combination of the chart lists `tipping`.")
    return lines


def proof_table(cell: Cell) -> Table:
    """Return the table of the governing proofs of a cell."""
    rows = [
        (
            row.of.title,
            ", ".join(filter(None, (row.part, row.place))),
            row.state.removeprefix(COMBINATION),
            percent(row.utilisation or 0.0, 4),
        )
        for row in cell.proofs
    ]
    about = (
        f"luffing angle {fixed(cell.angle or 0.0, 1)}°; the tip is {number(cell.height)} m high, "
        f"{number(-(cell.tip or 0.0))} m below the straight boom, which adds "
        f"{number(cell.droop)} m to the radius"
    )
    if cell.cylinder_force is not None:
        about += f"; the cylinder carries {number(1.0e-3 * cell.cylinder_force)} kN"
    title = f"{number(cell.length)} m at {number(cell.radius)} m: {number(cell.capacity, 5)} kg"
    headings = "proof", "place", "combination", "utilisation"
    return Table.of_rows(
        "cell", title, headings, rows, [f"Under the rated load and the wind: {about}."]
    )


def prepare(folder: Path, file: str) -> None:
    """Check that a folder can be that of a chart.

    Raises:
        BadInput: the folder contains other files, or is the current directory.
    """
    key = f"--out {folder}"
    if folder.exists() and not (folder / CSV).exists() and [*folder.glob("*")]:
        what = "contains other files; give a new folder or one of an earlier chart"
        raise BadInput(file, key, what)
    check_not_working_folder(folder, file, key)


def shell_table(checks: Sequence[tuple[Cell, Row]], shell: str) -> Table:
    """Return the table of governing proofs by beams, and by a shell with the same payload."""
    rows = [
        (
            row.of.title,
            f"{number(cell.length)} m at {number(cell.radius)} m",
            number(cell.capacity, 4),
            *(percent(one.utilisation or 0.0) for one in (cell.proofs[0], row)),
        )
        for cell, row in checks
    ]
    headings = "proof", "length, radius", "payload\nkg", "beams", shell
    return Table.of_rows("shell", f"Governing proofs by {shell}", headings, rows)


def write(chart: Chart, folder: Path, excel: bool) -> None:
    """Write ``chart.csv``, pictures and ``chart.html``, and if asked for ``chart.xlsx``.

    Raises:
        BadInput: openpyxl is not installed.
    """
    from protractile.runs.chart import figures
    from protractile.runs.report.document import embed
    from protractile.runs.report.figures import write_pictures
    from protractile.runs.report.pages import page

    with atomic_folder(folder) as part:
        chart.frame.to_csv(part / CSV, index=False, float_format="%.9g", lineterminator="\r\n")
        shown = figures.figures_of(chart)
        write_pictures(shown, part)
        uris, plots = embed(shown, pictures=True)
        if excel:
            try:
                chart.frame.to_excel(part / WORKBOOK, sheet_name="chart", index=False)
            except ImportError:
                what = "openpyxl is missing, which writes workbooks; install it with pip"
                raise BadInput("chart", "--excel", what) from None
        table = chart_table(chart)
        content: dict[str, Any] = {
            "title": chart.case.title,
            "table": table,
            "cells": [list(row) for row in zip(*chart.cells, strict=True)],
            "shown": text_of(chart),
            "color": lambda cell: figures.pale(kind_of(cell)),
            "failed": lambda cell: bool(cell.proofs) and not holds(cell.proofs[0]),
            "proofs": proof_table,
            "figures": shown,
            **plots,
        }
        text = page(Path(__file__).parent / "templates" / "chart.html", uris, **content)
        (part / PAGE).write_text(text, encoding="utf-8")
