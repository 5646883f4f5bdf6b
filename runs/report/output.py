# SPDX-License-Identifier: LGPL-3.0-or-later
"""A run's folder, which takes the place of an earlier one when all its files are there."""

from __future__ import annotations

import csv
import json
import shutil
from collections.abc import Sequence
from dataclasses import asdict
from hashlib import sha256
from importlib.util import find_spec
from io import StringIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import xarray as xr

from runs.case import toml
from runs.case.messages import BadInput
from runs.case.user_files import check_left
from runs.folder.files import beside, whole
from runs.folder.versions import program
from runs.pipeline.comparisons import leading
from runs.pipeline.results import (
    CASE,
    CONVENTIONS,
    ENSEMBLES,
    FIELDS,
    SUMMARY,
    TRAJECTORIES,
    Results,
)
from runs.pipeline.run import Run
from runs.pipeline.shell_output import ShellOutput
from runs.pipeline.summary import Snapshots
from runs.report import snapshots
from runs.report.document import render
from runs.report.extruded import of_beam
from runs.report.figure_context import Figure
from runs.report.figures import draw
from runs.report.moving_surface import MOST_POINTS, MovingSurface
from runs.report.tables import TextTable
from runs.report.verdict import Verdict
from runs.report.viewer import VIEWER, viewer
from shell_model.pictures.field_series import series_times, write_field_series
from shell_model.pictures.opengl import RenderingUnavailable

REPORT = "report.html"
VERDICTS = "verdicts.json"
CALIBRATION = "calibration.json"
STRESSES = "stress.nc"
SERIES = "fields"
FIGURES = "figures"
DRAWN_OF = ".drawn-of"
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
    if folder.resolve().is_mount():
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
    mesh_folder: Path,
    snapshots_now: bool = True,
) -> None:
    """Write everything that a run leaves.

    Args:
        run: a finished one.
        verdicts: those that its case asks for.
        folder: an empty one.
        mesh_folder: where the run has put gmsh's files, ``MODEL/SEGMENT.msh``.
        snapshots_now: whether they are drawn; else whoever wants some asks for them later.
    """
    results = run.results
    # netCDF 3 has no empty dimension: a boom without joints leaves out its stations.
    empty = [name for name, size in results.trajectories.sizes.items() if size == 0]
    results.trajectories.drop_dims(empty).to_netcdf(folder / TRAJECTORIES, engine="scipy")
    if results.ensembles is not None:
        results.ensembles.to_netcdf(folder / ENSEMBLES, engine="scipy")
    _write_text(folder / CASE, toml.dumps(results.case))
    several = sum(model.meshed for model in results.case.models) > 1
    files = {name: folder / f"{f'{name}-' if several else ''}{FIELDS}" for name in run.shells}
    for name, path in files.items():
        run.shells[name].fields.to_netcdf(path, engine="scipy")
    pictured = [*files.values()] if snapshots_now else []
    later = LATER if files and not pictured else None
    results.summary.snapshots = Snapshots(written=[], skipped=later)
    try:
        with snapshots.drawing(results, pictured, folder / TRAJECTORIES, folder) as gather:
            _write_csv(results.trajectories, folder / "trajectories.csv")
            for name, path in files.items():
                prefix = path.name.removesuffix(FIELDS)
                _write_shell(run.shells[name], name, folder, prefix, mesh_folder)
            surface = _surface(run) if find_spec("plotly") else None
            if surface is not None:
                surface = surface.drawn_out(results.boom)
                _write_text(folder / VIEWER, viewer(results.case, surface))
            figures = _draw_figures(results, folder)
            gather()
    except RenderingUnavailable as reason:
        results.summary.snapshots = Snapshots(written=[], skipped=str(reason))
    _write_pages(results, verdicts, folder, figures)


def _write_shell(
    shell: ShellOutput, name: str, folder: Path, prefix: str, mesh_folder: Path
) -> None:
    """Stresses, series and meshes of a shell whose files' names begin with a prefix."""
    shell.stresses.assign_attrs(Conventions=CONVENTIONS).to_netcdf(
        folder / f"{prefix}{STRESSES}", engine="scipy"
    )
    # Of names joined by a hyphen two may be the same.
    meshes, series = folder / "mesh" / prefix.removesuffix("-"), folder / SERIES
    for place in (meshes, series):
        place.mkdir(parents=True, exist_ok=True)
    write_field_series(shell.fields, series, series_times(shell.fields))
    if (modes := shell.modes) is not None:
        of_modes = modes.assign_attrs(model=f"{name}-modes")
        write_field_series(of_modes, series, modes["time"].values.tolist())
    for segment, mesh in shell.meshes.items():
        mesh.write(meshes / f"{segment}.vtu")
        gmsh_file = mesh_folder / name / f"{segment}.msh"
        shutil.copyfile(gmsh_file, meshes / f"{segment}.msh")


def _surface(run: Run) -> MovingSurface | None:
    """The first shell in motion, or the beam that is read first; none of a finer mesh."""
    results = run.results
    for name, shell in run.shells.items():
        if shell.fields.sizes["point"] > MOST_POINTS:
            return None
        return MovingSurface.of_shell(shell.fields, results.trajectories.sel(model=name))
    first = leading(results.case, list(run.beams))
    with_play = [m.name for m in results.ran if m.name in first and not m.play_free]
    name = [*first, *with_play][-1]
    return of_beam(results.boom, name, run.beams[name])


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
    _write_pages(results, verdicts, folder, _draw_figures(results, folder), surveyed)


def _draw_figures(results: Results, folder: Path) -> list[Figure]:
    """Those that a run has the numbers for, in place of all earlier ones of anything else."""
    figures, known = folder / FIGURES, folder / DRAWN_OF
    drawn_of = _drawn_of(results, folder)
    figures.mkdir(exist_ok=True)
    if not known.is_file() or known.read_text(encoding="utf-8") != drawn_of:
        shutil.rmtree(figures)
        figures.mkdir()
    drawn = draw(results, figures)
    for earlier in set(figures.iterdir()) - {figure.path for figure in drawn}:
        earlier.unlink()
    _write_text(known, drawn_of)
    return drawn


def _drawn_of(results: Results, folder: Path) -> str:
    """SHA-256 of all that decides what figures look like: data and this program."""
    bare = results.summary.model_copy(update={"snapshots": Snapshots(written=[], skipped=None)})
    digest = sha256(json.dumps([str(bare), program(), matplotlib.__version__]).encode())
    for path in (folder / name for name in (CASE, TRAJECTORIES, ENSEMBLES)):
        digest.update(path.read_bytes() if path.is_file() else b"")
    return digest.hexdigest()


def _write_pages(
    results: Results,
    verdicts: Sequence[Verdict],
    folder: Path,
    figures: Sequence[Figure],
    surveyed: Sequence[TextTable] = (),
) -> None:
    _write_text(folder / SUMMARY, str(results.summary))
    if cards := {
        name: model.calibration.model_dump()
        for name, model in results.summary.models.items()
        if model.calibration is not None
    }:
        _write_text(folder / CALIBRATION, _json(cards))
    if verdicts:
        _write_text(folder / VERDICTS, _json([asdict(verdict) for verdict in verdicts]))
    pictures = snapshots.describe(results, folder)
    there = VIEWER if (folder / VIEWER).is_file() else ""
    _write_text(folder / REPORT, render(results, verdicts, figures, pictures, surveyed, there))


def _write_text(path: Path, text: str) -> None:
    with whole(path) as part:
        part.write_text(text, encoding="utf-8")


def _json(data: Any) -> str:
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _write_csv(trajectories: xr.Dataset, path: Path) -> None:
    """One line for each model and time; a station's columns are headed ``NAME@X``.

    X is the station's ``place``.
    """
    columns = {}
    places = trajectories["place"].values if "place" in trajectories.coords else ()
    for name, variable in trajectories.data_vars.items():
        if "station" in variable.dims:
            of_stations = variable.drop_vars(["station", "direction", "place"])
            for place, values in zip(places, of_stations.transpose("station", ...), strict=True):
                columns[f"{name}@{place}"] = values
        else:
            columns[str(name)] = variable
    values = xr.Dataset(columns).to_array().transpose("model", "time", "variable").values
    time = trajectories["time"].values
    line = ",%.9g" * (1 + len(columns)) + "\r\n"
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["model", "time", *columns])
        for name, rows in zip(trajectories["model"].values, values, strict=True):
            # A writer's own way with numbers takes four times as long.
            begin = StringIO()
            csv.writer(begin, lineterminator="").writerow([name])
            numbers = np.column_stack([time, rows]).tolist()
            lines = [(line % tuple(row)).replace("nan", "") for row in numbers]
            file.writelines(f"{begin.getvalue()}{text}" for text in lines)
