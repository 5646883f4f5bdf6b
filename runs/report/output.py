# SPDX-License-Identifier: LGPL-3.0-or-later
"""Writer of the files of a run, and of its workbook for Excel and LibreOffice."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path

import pandas as pd
import xarray as xr

from protractile.runs.case.user_files import check_not_working_folder
from protractile.runs.folder.files import (
    atomic_path,
    folder_lock,
    modified_folder,
    write_atomically,
)
from protractile.runs.pipeline.results import FIELDS, TRAJECTORIES, Results
from protractile.runs.pipeline.run import Run
from protractile.runs.pipeline.summary import Snapshots
from protractile.runs.process.bad_input import BadInput
from protractile.runs.report import snapshots
from protractile.runs.report.additions import Addition, judge
from protractile.runs.report.document import render, tables_by_part
from protractile.runs.report.figures import FOLDER, figures_of, write_pictures
from protractile.runs.report.opengl import RenderingUnavailable
from protractile.runs.report.tables import as_json
from protractile.runs.report.viewer import VIEWER, viewer

REPORT = "report.html"
CALIBRATION = "calibration.json"
WORKBOOK = "results.xlsx"
LATER = "not requested; protractile snapshot draws them"
# Largest width of a column of the workbook in characters, and number of rows above its headings.
WIDEST, ABOVE = 60, 2


@contextmanager
def rerender_report(
    folder: str, excel: str | None = None, pictures: bool = False
) -> Iterator[tuple[Results, Addition, Path]]:
    """Yield results, additions of the client, and a copy of the folder of a run.

    Afterwards the report is rendered in the copy, and the copy replaces the folder. With ``excel``,
    the name of the option in messages, a workbook is written, too; with ``pictures``, all figures
    as PNG files.
    """
    path = Path(folder)
    with folder_lock(path):
        results = Results.load(path)
        check_not_working_folder(path, folder, "folder")
        addition_of_client = judge(results)
        with modified_folder(path) as part:
            yield results, addition_of_client, part
            write_report(results, addition_of_client, part, pictures)
            if excel is not None:
                write_workbook(results, part, folder, excel)


@contextmanager
def write_in_two_steps(
    run: Run, folder: Path, snapshots_now: bool = True, helper: Executor | None = None
) -> Iterator[Callable[[Addition], None]]:
    """Write the motion of a run, and yield a function that writes all other files.

    The folder must be empty. While the caller evaluates the run, another process draws snapshots,
    unless ``snapshots_now`` is False: the helper, or else a new one.
    """
    results = run.results
    results.write(folder)
    several = sum(model.meshed for model in results.case.models) > 1
    files = {name: folder / f"{f'{name}-' if several else ''}{FIELDS}" for name in run.shells}
    for name, path in files.items():
        run.shells[name].fields.to_netcdf(path, engine="scipy")
    picture_files = [*files.values()] if snapshots_now else []
    later = LATER if files and not picture_files else None
    results.summary.snapshots = Snapshots(written={}, skipped=later)
    motion = folder / TRAJECTORIES
    with snapshots.start_rendering(results, picture_files, motion, folder, helper=helper) as gather:

        def write_others(addition: Addition) -> None:
            write_csv(results.trajectories, folder / "trajectories.csv")
            for name, path in files.items():
                prefix = path.name.removesuffix(FIELDS)
                run.shells[name].write_files(folder, prefix)
            if viewer_page := viewer(run):
                write_atomically(folder / VIEWER, viewer_page)
            try:
                gather()
            except RenderingUnavailable as reason:
                results.summary.snapshots = Snapshots(written={}, skipped=str(reason))
            write_report(results, addition, folder)

        yield write_others


def write(run: Run, addition: Addition, folder: Path) -> None:
    """Write all files of an evaluated run to an empty folder."""
    with write_in_two_steps(run, folder) as write_others:
        write_others(addition)


def write_report(
    results: Results, addition: Addition, folder: Path, pictures: bool = False
) -> None:
    """Write results, tables and report.

    With ``pictures``, or if the folder has PNG files of figures, these files are written, and the
    report has a picture of each figure for paper and for readers without JavaScript.
    """
    figures = figures_of(results)
    if pictures := pictures or (folder / FOLDER).is_dir():
        write_pictures(figures, folder)
    stills = snapshots.describe(results, folder)
    viewer_file = VIEWER if (folder / VIEWER).is_file() else ""
    texts = {
        REPORT: render(results, addition, figures, stills, viewer_file, pictures),
        **addition.files,
    }
    if cards := {
        name: model.calibration.model_dump()
        for name, model in results.summary.models.items()
        if model.calibration is not None
    }:
        texts[CALIBRATION] = as_json(cards)
    results.write_results(folder)
    for name, text in texts.items():
        write_atomically(folder / name, text)


def write_csv(trajectories: xr.Dataset, path: Path) -> None:
    """Write trajectories as CSV, a line per model and time; station columns are ``NAME@PLACE``."""
    places = trajectories["place"].values if "place" in trajectories.coords else ()
    columns: dict[str, xr.DataArray] = {}
    for name, variable in trajectories.reset_coords(drop=True).data_vars.items():
        if "station" in variable.dims:
            for i, place in enumerate(places):
                columns[f"{name}@{place}"] = variable.isel(station=i, drop=True)
        else:
            columns[str(name)] = variable
    frame = xr.Dataset(columns).to_dataframe(["model", "time"])
    line = ",%.9g" * (1 + len(columns)) + "\r\n"
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerow(["model", "time", *columns])
        names = csv.writer(file, lineterminator="")
        # pandas formats numbers three times as slowly, csv.writer twice as slowly.
        for (name, time), row in zip(frame.index, frame.to_numpy().tolist(), strict=True):
            names.writerow([name])
            file.write((line % (time, *row)).replace("nan", ""))


def write_workbook(results: Results, folder: Path, name: str, option: str) -> None:
    """Write a sheet of quantities in SI units, and a sheet for each table of the report.

    The file is written atomically. ``name`` is the folder and ``option`` the option as the user
    gave them, for messages.

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
                for cell in (cell for row in sheet.iter_rows() for cell in row):
                    # A text that begins with "=" is no formula.
                    if isinstance(cell.value, str):
                        cell.data_type = "s"
                for i, (heading, cells) in enumerate(frame.items()):
                    lengths = [len(str(cell)) for cell in (heading, *cells)]
                    letter = sheet.cell(1, i + 1).column_letter
                    sheet.column_dimensions[letter].width = min(2 + max(lengths), WIDEST)
    except ImportError:
        what = "openpyxl is missing, which writes workbooks; install it with pip"
        raise BadInput(name, option, what) from None
