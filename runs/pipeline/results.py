# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results of a run: labelled trajectories of all models, and their summary."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import ValidationError

from protractile.analysis.curves import Curves
from protractile.analysis.quantities import MEASURED, declared_quantities, records
from protractile.analysis.rows import MOTION, Rows
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.boom import Boom
from protractile.geometry.ground import forces
from protractile.geometry.observation import KINDS
from protractile.geometry.typography import NONE, number
from protractile.runs.case import reading as case_file
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case, Model
from protractile.runs.case.user_files import check_not_working_folder, check_regular
from protractile.runs.folder.files import (
    MANIFEST,
    atomic_folder,
    atomic_path,
    find_damaged_file,
    resolve_path,
    scratch_folder,
    write_atomically,
)
from protractile.runs.pipeline.combinations import limit_in_combinations
from protractile.runs.pipeline.design_results import ModelDesignResults
from protractile.runs.pipeline.model_quality import main_models, reference_of
from protractile.runs.pipeline.proofs import Proofs
from protractile.runs.pipeline.quantities import (
    QUANTITIES,
    RECORD_CLASSES,
    LimitCheck,
    Quantities,
    case_limits,
    decay_time,
    settling_time,
)
from protractile.runs.pipeline.summary import Summary
from protractile.runs.process.bad_input import BadInput

TRAJECTORIES = "trajectories.nc"
ROWS = "results.csv"
CURVES = "curves.nc"
SUMMARY = "summary.json"
CASE = "case.toml"
FIELDS = "fields.nc"
ENSEMBLES = "ensembles.nc"

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

# Attributes of the conventions for climate and forecast data (CF) that apply to a boom.
CONVENTIONS = "CF-1.8"


@dataclass(repr=False)
class Results:
    """Results of one run.

    >>> case = pt.load_case(pt.CASES / "coarse.toml")
    >>> results = pt.run_case(case, models=["kantorovich-4"])
    >>> list(results.summary.models)
    ['kantorovich-4']

    Args:
        case: the case of the run, with all defaults.
        trajectories: dimensions ``model`` (names, in the order of the case), ``time`` in s,
            ``station`` in m with its ``direction`` and name ``place``; deflections ``tip``,
            ``head``, ``tail`` in m (``head-2`` and so forth from the second joint on),
            ``contact_force``, ``contact_force_peak`` and ``friction_force`` in N, ``gap`` in m,
            energies in J; NaN if a model has no value.
        summary: the content of ``summary.json``.
        ensembles: dimensions ``model`` (models with play), ``member`` (the first one unchanged),
            ``time``; ``tip``, ``head`` in m. None if the case has no ensembles.
        rows: extremes of all quantities of all models, combinations and proofs.
        curves: static diagrams, envelopes and mode shapes along the segments.
    """

    case: Case
    trajectories: xr.Dataset
    summary: Summary
    ensembles: xr.Dataset | None = None
    rows: Rows = field(default_factory=Rows)
    curves: Curves = field(default_factory=Curves)

    @classmethod
    def load(cls, folder: Path | str) -> Results:
        """Read a run's folder.

        Raises:
            BadInput: the folder is not the folder of a run, or is incomplete.
        """
        folder = Path(folder)
        if not folder.is_dir():
            what = "is a file" if folder.exists() else "does not exist"
            raise BadInput(str(folder), "folder", f"{what}; give the folder of a run")
        if name := find_damaged_file(folder):
            found = "" if name == MANIFEST else f", its SHA-256 differs from {MANIFEST}"
            what = f"is damaged{found}; remove it, or run the case again"
            raise BadInput(str(folder), name, what)
        trajectories = _read(folder / TRAJECTORIES, read_netcdf)
        if "station" not in trajectories.dims:
            trajectories = trajectories.assign_coords(station=("station", np.zeros(0)))
        summary = _read(folder / SUMMARY, Summary.load)
        rows = _read(folder / ROWS, Rows.load)
        curves, mark_of_curves = _read(folder / CURVES, _marked_curves)
        ensembles = _read(folder / ENSEMBLES, read_netcdf) if summary.ensemble else None
        if not (folder / CASE).is_file():
            raise BadInput(str(folder), CASE, "missing; give the folder of a run that has finished")
        case = case_file.load(str(folder / CASE))
        expected = toml.digest(case)
        if expected != summary.case_hash == sha256((folder / CASE).read_bytes()).hexdigest():
            what = "was written by another version with other keys; run the case again"
            raise BadInput(str(folder), CASE, what)
        marks = {TRAJECTORIES: trajectories.attrs.get("case_hash"), SUMMARY: summary.case_hash}
        marks[CURVES] = mark_of_curves
        if ensembles is not None:
            marks[ENSEMBLES] = ensembles.attrs.get("case_hash")
        for name, mark in marks.items():
            if mark != expected:
                what = f"is not of the case in {CASE}; run the case again"
                raise BadInput(str(folder), name, what)
        return cls(case, trajectories, summary, ensembles, rows, curves)

    def save(self, folder: Path | str) -> None:
        """Write a folder for :meth:`load` and ``report``; it replaces the folder of an earlier run.

        Raises:
            BadInput: the folder cannot be written, contains other files, or is the current one.
        """
        with atomic_folder(prepare(str(folder), self.case.title)) as part:
            self.write(part)

    def write(self, folder: Path) -> None:
        """Write the files of :meth:`save` into an empty folder."""
        # netCDF 3 has no empty dimensions, such as the stations of a boom without joints.
        empty = [name for name, size in self.trajectories.sizes.items() if size == 0]
        self.trajectories.drop_dims(empty).to_netcdf(folder / TRAJECTORIES, engine="scipy")
        if self.ensembles is not None:
            self.ensembles.to_netcdf(folder / ENSEMBLES, engine="scipy")
        write_atomically(folder / CASE, toml.dumps(self.case))
        self.write_results(folder)

    def write_results(self, folder: Path) -> None:
        """Write rows, curves and summary, in place of earlier ones."""
        with atomic_path(folder / ROWS) as rows, atomic_path(folder / CURVES) as curves:
            self.rows.save(rows)
            attributes = {"Conventions": CONVENTIONS, "case_hash": self.summary.case_hash}
            self.curves.dataset.assign_attrs(attributes).to_netcdf(curves, engine="scipy")
        write_atomically(folder / SUMMARY, str(self.summary))

    @property
    def completed_models(self) -> list[Model]:
        """The models with results, which on the live page may be without a motion."""
        names = {*self.summary.models, *self.summary.design.models}
        return [model for model in self.case.models if model.name in names]

    @cached_property
    def boom(self) -> Boom:
        """The boom of the case."""
        return build_boom(self.case)

    @cached_property
    def reference(self) -> str | None:
        """The name of the reference model, with which the others are compared."""
        return reference_of(self.completed_models)

    @property
    def proofs(self) -> Proofs:
        """The proofs of the combinations; empty without combinations."""
        return Proofs.among(self.rows, self.summary.design.proof_notes, self.case)

    @cached_property
    def main_models(self) -> list[str]:
        """The names of the main models, starting with the reference."""
        names = [model.name for model in self.completed_models]
        first = main_models(self.case, names)
        return sorted(first, key=lambda name: (name != self.reference, names.index(name)))

    @property
    def quantities(self) -> pd.DataFrame:
        """A table with a row for each quantity of sweeps: its SI unit and a column per model."""
        import pandas as pd

        columns: dict[str, list[Any]] = {"unit": [quantity.unit for quantity in QUANTITIES]}
        for name in self.summary.models:
            quantities = self.measure(name)
            columns[name] = [quantities.get(quantity.name) for quantity in QUANTITIES]
        frame = pd.DataFrame(columns, index=[quantity.name for quantity in QUANTITIES])
        return frame.dropna(how="all", subset=[*self.summary.models])

    def measure(self, model: str) -> Quantities:
        """Return the quantities of one model of a run.

        The static tip is the deflection under the largest loads, at any extension; the tip is the
        largest deflection of the motion. The amplitude of the tip is half the distance between its
        highest and lowest position. The dynamic factor is the largest deflection over the largest
        static one. The contact force is the largest mean over an output interval at any station,
        since the peak of an impact is too short to load a pad. The stress is the axial stress in an
        outer fibre; the wall stress of a shell is a mean over a patch. The pad pressure is the
        maximum over pads and time. The damage is the fatigue damage at the governing place. The
        decay time belongs to the first mode.
        :class:`.runs.pipeline.residual_vibration.ResidualVibration` defines the residual vibration,
        and :class:`.dynamics.stick_slip.StickSlip` defines force and slip of elastic drives.
        """
        time = np.asarray(self.trajectories["time"].values, dtype=float)
        tip = np.asarray(self.trajectories["tip"].sel(model=model).values, dtype=float)
        summary = self.summary.models[model]
        design = self.summary.design.models.get(model, ModelDesignResults())
        declaring = [*(getattr(design, name) for name in records(ModelDesignResults)), summary]
        rows = self.rows.where(model=model, play=True)
        moved = rows.where(state=MOTION)
        largest = {name: moved.where(quantity=name).largest for name in MEASURED}
        deflection = largest["tip"]
        frequency = next((row.value for row in rows.where(quantity="frequency")), None)
        return (
            {name: row and abs(row.value) for name, row in largest.items()}
            | {
                "tip_at_rest": deflection and rows.at_rest(deflection),
                "tip_amplitude": float(0.5 * np.ptp(tip)),
                "dynamic_factor": deflection and rows.dynamic_factor(deflection),
                "first_frequency": frequency,
                "decay_time": decay_time(self.case.damping.modal, frequency),
                "mass": self.boom.mass,
                "drive_force": max(
                    (drive.peak for drive in summary.stick_slip.values()), default=None
                ),
                "drive_slip": max(
                    (drive.slip for drive in summary.stick_slip.values()), default=None
                ),
                "settling_time": settling_time(time, tip),
            }
            | {
                quantity.name: getattr(record, field, None)
                for record, kind in zip(declaring, RECORD_CLASSES, strict=True)
                for field, quantity in declared_quantities(kind).items()
                if quantity.name
            }
        )

    def check_limits(self) -> Iterator[LimitCheck]:
        """Yield the limits of the case with values of the main models and of combinations."""
        limits = case_limits(self.case, self.boom)
        quantities = {name: self.measure(name) for name in self.main_models if limits}
        for limit in limits:
            numbers = {name: quantity[limit.quantity.name] for name, quantity in quantities.items()}
            values = {name: value for name, value in numbers.items() if value is not None}
            yield LimitCheck(limit, values, limit_in_combinations(limit, self.rows, self.case))

    def __repr__(self) -> str:
        return f"Results of {self.case.title!r}: {', '.join(self.summary.models)}"

    def _repr_html_(self) -> str:
        frame = self.quantities.drop(columns="unit").astype(float)
        shown = [quantity for quantity in QUANTITIES if quantity.name in frame.index]
        frame = frame.mul([quantity.factor for quantity in shown], axis=0)
        frame.index = [f"{quantity.title}, {quantity.shown_unit}" for quantity in shown]
        table = frame.to_html(float_format=lambda value: number(value, 4), na_rep=NONE, border=0)
        return f"<p><b>{escape(self.case.title)}</b></p>{table}"


def prepare(out: str, file: str, mark: str = TRAJECTORIES) -> Path:
    """Return the path of the folder for a run, which may contain an earlier run.

    ``out`` is the folder as the user gave it, ``file`` the case file for messages, ``mark`` a file
    by which an earlier run is known.

    Raises:
        BadInput: the folder cannot be created or replaced, contains other files, or is the current
            directory.
    """
    folder = Path(out)
    key = f"--out {out}"
    if folder.exists() and not folder.is_dir():
        raise BadInput(file, key, "is a file; give a folder")
    if resolve_path(folder).is_mount():
        raise BadInput(file, key, "is a mount point and cannot be replaced; give a folder in it")
    try:
        with scratch_folder(folder):
            names = {path.name for path in folder.glob("*")}
    except OSError as error:
        raise BadInput(
            file, key, f"cannot be written ({error.strerror}); give a folder that can"
        ) from None
    if names and not {MANIFEST, mark} <= names:
        raise BadInput(
            file, key, "contains other files; give a new folder or one of an earlier run"
        )
    check_not_working_folder(folder, file, key)
    return folder


def read_fields(path: Path) -> xr.Dataset:
    """Read a file of the fields of a shell, and check that pictures can be made from it.

    Raises:
        BadInput: the file is damaged, or written by another version.
    """
    fields: xr.Dataset = _read(path, _whole_fields)
    return fields


def read_netcdf(path: Path) -> xr.Dataset:
    """Read a whole netCDF file into memory."""
    import xarray as xr

    return xr.load_dataset(path, engine="scipy")


def label(boom: Boom, trajectories: Mapping[str, Trajectory]) -> xr.Dataset:
    """Return the trajectories of all models in one dataset with named dimensions.

    The stations of the boom become the dimension ``station``. All trajectories, which are given by
    model name, have the same times.
    """
    import xarray as xr

    everything = [trajectory.data for trajectory in trajectories.values()]
    time = everything[0]["time"]
    units = {
        str(name): (variable.dims, variable.attrs)
        for data in everything
        for name, variable in data.data_vars.items()
    }
    titles = {
        place.name: {
            "long_name": f"{place.kind.title} of {boom.segments[place.segment].name!r} "
            f"at x = {place.x:g} m"
        }
        for place in boom.all_observations(list(KINDS))
    } | {name: {"long_name": title} for name, title in forces(boom).items()}
    lengths = {"time": time.size, "station": len(boom.stations)}
    variables = {}
    for name, (dims, attributes) in units.items():
        values = np.full((len(everything), *(lengths[str(dim)] for dim in dims)), np.nan)
        for i, data in enumerate(everything):
            # A model without play has no stations.
            if name in data and data[name].shape == values.shape[1:]:
                values[i] = data[name].values
        variables[name] = (("model", *dims), values, titles.get(name, {}) | attributes)
    return xr.Dataset(
        variables,
        coords={
            "model": ("model", list(trajectories), {"long_name": "name of the model"}),
            "time": time,
            "station": (
                "station",
                np.array([station.x for station in boom.stations], dtype=float),
                {"units": "m", "long_name": "x of the station"},
            ),
            "direction": (
                "station",
                np.array([station.direction for station in boom.stations], dtype="U1"),
                {"long_name": "direction in which the station touches"},
            ),
            "place": (
                "station",
                np.array([station.name for station in boom.stations], dtype=str),
                {"long_name": "name of the station, each its own"},
            ),
        },
        attrs={"Conventions": CONVENTIONS},
    )


def _read(path: Path, how: Callable[[Path], Any]) -> Any:
    """Read a file of a run with the function ``how``.

    Raises:
        BadInput: the file is missing, damaged, or written by another version.
    """
    try:
        check_regular(path)
        return how(path)
    except FileNotFoundError:
        what = "missing; give the folder of a run that has finished"
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        where = "".join(f"{step}: " for step in fault["loc"])
        what = f"{where}{fault['msg']}; is damaged or of another version; run the case again"
    except (OSError, ValueError, TypeError, KeyError) as error:
        what = f"cannot be understood ({error}); run the case again"
    raise BadInput(str(path.parent), path.name, what)


def _marked_curves(path: Path) -> tuple[Curves, str | None]:
    dataset = read_netcdf(path)
    return Curves.of(dataset), dataset.attrs.get("case_hash")


def _whole_fields(path: Path) -> xr.Dataset:
    fields = read_netcdf(path)
    numbers = range(1, int(fields["segment"].max()) + 2)
    of_each = {f"{what}_{k}" for what in ("plate", "stress", "coordinates") for k in numbers}
    common = {"points", "triangles", "thickness", "wall", "modes", "state"}
    if missing := (common | of_each) - fields.variables.keys():
        raise KeyError(*sorted(missing))
    return fields.assign_attrs(model=fields.attrs["model"])
