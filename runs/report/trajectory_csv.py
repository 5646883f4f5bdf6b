# SPDX-License-Identifier: LGPL-3.0-or-later
"""The trajectories of a run for spreadsheets."""

from __future__ import annotations

import csv
from io import StringIO
from pathlib import Path

import numpy as np
import xarray as xr


def write_csv(trajectories: xr.Dataset, path: Path) -> None:
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
