# SPDX-License-Identifier: LGPL-3.0-or-later
"""First natural frequencies of a boom over case parameters.

A boom with play is nonlinear and has no natural frequencies. These are the frequencies with the
contacts that are closed at rest under the loads (:func:`.dynamics.damping.closed_contact_modes`),
and with bonded joints.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from protractile.analysis.equilibria import vibrating_system
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.geometry.arrays import Array
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext, ModelBoom
from protractile.runs.case.schema import Case, Model
from protractile.runs.folder.cache import Cache
from protractile.runs.folder.files import atomic_path, folder_lock, modified_folder
from protractile.runs.pipeline.models import build_on
from protractile.runs.pipeline.results import CONVENTIONS
from protractile.runs.process.terminal import Progress, ignore_progress
from protractile.runs.report.tables import Column, Table
from protractile.runs.sweep.points import Plan

if TYPE_CHECKING:
    from mpi4py import MPI

NAME = "frequencies"
MODES = 3
JOINTS = ("in contact", "bonded")


def first_frequencies(
    case: Case, model: Model, comm: MPI.Intracomm | None, cache: Cache | None
) -> Array:
    """Return frequencies (2, MODES) in Hz with joints in contact and with bonded joints.

    Missing values are NaN, as of a bonded model with joints in contact. All ranks must call it.
    """
    boom = build_boom(case)
    with_play = model.model_boom(boom)
    frequencies = np.full((len(JOINTS), MODES), np.nan)
    for row, booms in enumerate((with_play, ModelBoom(boom.bonded))):
        if row == 0 and model.bonded:
            continue
        context = None if comm is None else BuildContext(comm, cache=cache)
        try:
            with np.errstate(all="ignore"):
                system = build_on(booms, case, model, context).system.gather_loads()
                state = vibrating_system(system, case.time.duration) or (system,)
                omega = closed_contact_modes(*state)[0][:MODES]
        except NUMERICAL_ERRORS:
            continue
        frequencies[row, : omega.size] = omega / (2.0 * np.pi)
    return frequencies


def measure(
    cases: Sequence[Case],
    comm: MPI.Intracomm | None,
    cache: Cache | None,
    progress: Progress = ignore_progress,
) -> Array:
    """Return the first frequencies (num_cases, num_models, 2, MODES) in Hz, on all ranks."""
    frequencies = []
    for case in cases:
        frequencies.append([first_frequencies(case, model, comm, cache) for model in case.models])
        progress(NAME, f"{len(cases)} points", len(frequencies) / len(cases))
    return np.array(frequencies)


def gather(plan: Plan, frequencies: Array) -> xr.Dataset:
    """Return the first frequencies of all points as a dataset.

    The dimensions are the varied keys, in the units of the case, ``model``, ``joints``, ``mode``.
    """
    values = frequencies.reshape(*plan.shape, *frequencies.shape[1:])
    attributes = {"units": "Hz", "long_name": "natural frequency"}
    return xr.Dataset(
        {"frequency": ([*plan.coordinates, "joints", "mode"], values, attributes)},
        coords=plan.coordinates | {"joints": list(JOINTS), "mode": np.arange(1, MODES + 1)},
        attrs={"Conventions": CONVENTIONS, "title": plan.title},
    )


def table(data: xr.Dataset) -> Table:
    """Return the table of the first frequencies of each model at each point."""
    stacked = data["frequency"].stack(
        row=[dim for dim in data.dims if dim not in ("joints", "mode")]
    )
    rows = stacked["row"].to_index().to_frame()
    columns = [Column("model", [str(name) for name in rows.pop("model")])]
    for key in rows:
        columns.append(Column(str(key).replace(".", ".\n"), [f"{x:g}" for x in rows[key]]))
    for joints in JOINTS:
        for mode in data["mode"].values:
            of_mode = stacked.sel(joints=joints, mode=mode).values
            cells = [float(f) if np.isfinite(f) else None for f in of_mode]
            columns.append(Column(f"{joints}\nmode {mode}", cells, ".4g"))
    return Table("First frequencies of the boom in Hz", columns, name=NAME)


def write(data: xr.Dataset, folder: Path) -> None:
    """Write the dataset as NetCDF and CSV to the folder of a sweep."""
    with (
        folder_lock(folder),
        modified_folder(folder) as part,
        atomic_path(part / f"{NAME}.nc") as netcdf,
        atomic_path(part / f"{NAME}.csv") as lines,
    ):
        data.to_netcdf(netcdf, engine="scipy")
        frame = data.to_dataframe().reset_index()
        frame.to_csv(lines, index=False, float_format="%.9g", lineterminator="\r\n")
