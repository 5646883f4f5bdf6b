# SPDX-License-Identifier: LGPL-3.0-or-later
"""Workbook of the design results of a run, for Excel and LibreOffice."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from runs.case.messages import BadInput
from runs.folder.files import atomic_path
from runs.pipeline.results import Results
from runs.report.document import tables_by_part

WORKBOOK = "results.xlsx"

# Largest width of a column in characters, and number of rows above the headings of a sheet.
WIDEST, ABOVE = 60, 2


def write_workbook(results: Results, folder: Path, name: str, option: str) -> None:
    """Write a sheet of quantities in SI units, and a sheet for each table of the report.

    Args:
        results: results of a run.
        folder: folder of the file, which is written atomically.
        name: folder in messages, as the user gave it.
        option: option in messages, as the user gave it.

    Raises:
        BadInput: openpyxl is not installed.
    """
    quantities = results.quantities.rename_axis("quantity").reset_index()
    sheets: list[tuple[str, str, pd.DataFrame, Sequence[str]]] = [
        ("quantities", f"{results.case.title}: SI units", quantities, ())
    ]
    sheets += [
        (table.name, table.title, table.flat_frame, table.notes)
        for several in tables_by_part(results).values()
        for table in several
    ]
    try:
        with (
            atomic_path(folder / WORKBOOK) as path,
            pd.ExcelWriter(path, engine="openpyxl") as writer,
        ):
            for short, title, frame, notes in sheets:
                frame.to_excel(writer, sheet_name=short, index=False, startrow=ABOVE)
                sheet = writer.sheets[short]
                sheet["A1"] = title
                for row, note in enumerate(notes, start=ABOVE + len(frame) + 3):
                    sheet.cell(row, 1, note)
                for i, (heading, cells) in enumerate(frame.items()):
                    lengths = [len(str(cell)) for cell in (heading, *cells)]
                    letter = sheet.cell(1, i + 1).column_letter
                    sheet.column_dimensions[letter].width = min(2 + max(lengths), WIDEST)
    except ImportError:
        what = "openpyxl is missing, which writes workbooks; install it with pip"
        raise BadInput(name, option, what) from None
