# SPDX-License-Identifier: LGPL-3.0-or-later
"""A run's folder, which takes the place of an earlier one when all its files are there."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from runs.case.messages import BadInput
from runs.case.user_files import check_left
from runs.folder.files import beside, real, write_whole
from runs.pipeline.results import FIELDS, SUMMARY, TRAJECTORIES, Results
from runs.pipeline.run import Run
from runs.pipeline.summary import Snapshots
from runs.report import snapshots
from runs.report.document import render
from runs.report.figure_context import Figure
from runs.report.figures import draw_in
from runs.report.tables import TextTable
from runs.report.trajectory_csv import write_csv
from runs.report.verdict import Verdict
from runs.report.viewer import VIEWER, viewer
from shell_model.pictures.opengl import RenderingUnavailable

REPORT = "report.html"
VERDICTS = "verdicts.json"
CALIBRATION = "calibration.json"
LATER = "they were not asked for; protractile snapshot draws them"


def prepare(out: str, file: str) -> Path:
    """The folder of a run, which may be an earlier run's.

    Args:
        out: the folder as the user gave it.
        file: the case file, for messages.

    Raises:
        BadInput: it cannot be made or replaced, holds something else, or its user is in it.
    """
    folder = Path(out)
    key = f"--out {out}"
    if folder.exists() and not folder.is_dir():
        raise BadInput(file, key, "is a file; give a folder")
    if real(folder).is_mount():
        raise BadInput(
            file, key, "is where a disk begins, and cannot be replaced; give a folder in it"
        )
    try:
        with beside(folder):
            names = [path.name for path in folder.glob("*") if not path.name.startswith(".")]
    except OSError as error:
        raise BadInput(
            file, key, f"cannot be written ({error.strerror}); give a folder that can"
        ) from None
    if names and TRAJECTORIES not in names:
        raise BadInput(
            file, key, "holds files that are not a run's; give a new folder or an earlier run's"
        )
    check_left(folder, file, key)
    return folder


def write(
    run: Run,
    verdicts: Sequence[Verdict],
    folder: Path,
    snapshots_now: bool = True,
) -> None:
    """Write everything that a run leaves.

    Args:
        run: a finished one.
        verdicts: those that its case asks for.
        folder: an empty one.
        snapshots_now: whether they are drawn; else whoever wants some asks for them later.
    """
    results = run.results
    results.save(folder)
    several = sum(model.meshed for model in results.case.models) > 1
    files = {name: folder / f"{f'{name}-' if several else ''}{FIELDS}" for name in run.shells}
    for name, path in files.items():
        run.shells[name].fields.to_netcdf(path, engine="scipy")
    pictured = [*files.values()] if snapshots_now else []
    later = LATER if files and not pictured else None
    results.summary.snapshots = Snapshots(written=[], skipped=later)
    try:
        with snapshots.drawing(results, pictured, folder / TRAJECTORIES, folder) as gather:
            write_csv(results.trajectories, folder / "trajectories.csv")
            for name, path in files.items():
                prefix = path.name.removesuffix(FIELDS)
                run.shells[name].write_files(folder, prefix)
            if turned := viewer(run):
                write_whole(folder / VIEWER, turned)
            figures = draw_in(results, folder)
            gather()
    except RenderingUnavailable as reason:
        results.summary.snapshots = Snapshots(written=[], skipped=str(reason))
    _write_pages(results, verdicts, folder, figures)


def write_report(
    results: Results,
    verdicts: Sequence[Verdict],
    folder: Path,
    surveyed: Sequence[TextTable] = (),
) -> None:
    """Write what is derived from the trajectories: summary, verdicts, figures, report.

    Args:
        results: of the folder.
        verdicts: those that its case asks for.
        folder: gets them.
        surveyed: what a survey of the case's readings has found.
    """
    _write_pages(results, verdicts, folder, draw_in(results, folder), surveyed)


def _write_pages(
    results: Results,
    verdicts: Sequence[Verdict],
    folder: Path,
    figures: Sequence[Figure],
    surveyed: Sequence[TextTable] = (),
) -> None:
    pictures = snapshots.describe(results, folder)
    there = VIEWER if (folder / VIEWER).is_file() else ""
    texts = {
        REPORT: render(results, verdicts, figures, pictures, surveyed, there),
        SUMMARY: str(results.summary),
    }
    if cards := {
        name: model.calibration.model_dump()
        for name, model in results.summary.models.items()
        if model.calibration is not None
    }:
        texts[CALIBRATION] = _json(cards)
    if verdicts:
        texts[VERDICTS] = _json([asdict(verdict) for verdict in verdicts])
    for name, text in texts.items():
        write_whole(folder / name, text)


def _json(data: Any) -> str:
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
