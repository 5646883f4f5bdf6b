# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reader of case files: checks beyond their schema, conversion to SI units, checked cases.

Each field of the schema declares its unit.
"""

from __future__ import annotations

import logging
import math
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from protractile.analysis.rows import BEAM
from protractile.dynamics.motion import MOST_OUTPUTS
from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.fields import describe, is_number
from protractile.geometry.typography import choices
from protractile.geometry.units import System
from protractile.runs import clients
from protractile.runs.case.amounts import check_amounts, convert_to_si, read_amounts, system_of
from protractile.runs.case.build import build_boom, check_ensemble_data, check_names
from protractile.runs.case.columns import FileColumn, read_pairs
from protractile.runs.case.combinations import check_combinations
from protractile.runs.case.contact import ContactTable, table_law
from protractile.runs.case.inherited import with_inherited_keys
from protractile.runs.case.kinds.model import ModelBoom
from protractile.runs.case.kinds.shell import check_mesh_size
from protractile.runs.case.limits import (
    MOST_MEMBERS,
    Steps,
    key_of,
    leaves,
    map_tables,
    units_of,
    walk_tables,
)
from protractile.runs.case.load_tables import HistoryTable, WindPressureTable
from protractile.runs.case.messages import translated_errors
from protractile.runs.case.motion_tables import TravelTable
from protractile.runs.case.sanity import check_ranges, usual_ranges
from protractile.runs.case.schema import Case, EnsembleTable, Model, TimeTable
from protractile.runs.case.user_files import read_text
from protractile.runs.process.bad_input import BadInput

_NOTICES = logging.getLogger("protractile")

# Maximum number of digits of an integer option: longer numbers are input errors.
_WHOLE = re.compile(r"[0-9]{1,9}")

# Pattern of a number with a decimal comma after an equals sign, which is an error.
_DECIMAL_COMMA = re.compile(r"=\s*([-+]?[0-9]+),([0-9]+)")

_TOO_MANY_DIGITS = "has more than 64 bits; give fewer digits, or a number as 1.0e20"


@dataclass(frozen=True)
class CheckedCase:
    """A checked case. Its boom is built once, on first use."""

    case: Case  #: a case with a valid boom
    _model_booms: dict[str, ModelBoom] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def boom(self) -> Boom:
        """The boom of the case, from :func:`.runs.case.build.build_boom`."""
        return build_boom(self.case)

    def model_boom(self, model: Model) -> ModelBoom:
        """Return the boom with the contact laws of one of the models of the case."""
        if model.name not in self._model_booms:
            self._model_booms[model.name] = model.model_boom(self.boom)
        return self._model_booms[model.name]


def load(path: str) -> Case:
    """Read and check a case file.

    Raises:
        BadInput: the file cannot be read, or its content is invalid.
    """
    return load_checked(path).case


def load_checked(path: str) -> CheckedCase:
    """Read and check a case file like :func:`load`, and return it with its boom."""
    return check_tables(_read(path), path)


def load_spreads(path: str) -> list[Spread]:
    """Return the normal distributions in a case file; errors are those of :func:`load`."""
    tables = with_inherited_keys(_read(path), path)
    return take_means(read_amounts(tables, path)[0], path)[1]


def check_tables(tables: Mapping[str, object], path: str) -> CheckedCase:
    """Check the tables of a case file, and return the case with its boom.

    Raises:
        BadInput: the content is invalid.
    """
    try:
        with translated_errors(path, system_of(tables)):
            plain, amounts = read_amounts(with_inherited_keys(tables, path), path)
            given = Case.model_validate(take_means(plain, path)[0])
            check_amounts(given, amounts, path)
            case = convert_to_si(_read_files(given, path))
    except OverflowError:
        what = "a number is too large for SI units; look for one that is out of proportion"
        raise BadInput(path, "units", what) from None
    return check(case, path)


def check(case: Case, path: str) -> CheckedCase:
    """Check a case beyond its schema, and return it with its boom.

    Raises:
        BadInput: the case is invalid.
    """
    checked = CheckedCase(case)
    try:
        with translated_errors(path):
            _check_time(case)
            _check_boom(checked)
            clients.check(case, checked.boom)
    except BadInput as fault:
        raise BadInput(fault.file, fault.key, case.system.convert(fault.what)) from None
    except ArithmeticError as error:
        raise BadInput(
            path, "segment", f"numbers out of proportion ({error.args[-1]}); give them in SI units"
        ) from None
    return checked


def select(
    case: Case,
    path: str,
    models: Sequence[str] | None = None,
    mesh_size: float | None = None,
    members: int | None = None,
    modes: str | None = None,
) -> Case:
    """Return the case with the selected models, mesh size, modes and ensemble members.

    Args:
        case: a checked case.
        path: path of the case file, for messages.
        models: names of the models; by default all.
        mesh_size: edge length of uniform meshes in m.
        members: number of members of each ensemble; 0 for none.
        modes: number of coordinates of each shell segment, or ``auto``.

    Raises:
        BadInput: a name is unknown, a mesh size or number of modes is invalid or not used, or an
            ensemble has a single member or no variation.
    """
    subset = case.models
    if models is not None:
        model_names = [model.name for model in case.models]
        if not models:
            raise BadInput(path, "--models", f"names no model; give {choices(model_names)}")
        for name in models:
            if name not in model_names:
                raise BadInput(
                    path,
                    "--models",
                    f"{name!r} is not a model of the case; give {choices(model_names)}",
                )
        subset = tuple(model for model in case.models if model.name in models)
    if mesh_size is not None:
        if not (np.isfinite(mesh_size) and mesh_size > 0.0):
            raise BadInput(
                path, "--mesh-size", f"must be a finite number of m above 0, got {mesh_size:g}"
            )
        with translated_errors(path):
            check_mesh_size("--mesh-size", mesh_size, build_boom(case))
        subset = _with_shells(
            subset, path, "--mesh-size", {"mesh_size": mesh_size, "contact_tolerance": "any"}
        )
    if modes is not None:
        if modes != "auto" and not (_WHOLE.fullmatch(modes) and int(modes) > 0):
            what = f"must be a whole number above 0, or auto, got {modes!r}"
            raise BadInput(path, "--modes", what)
        number = "auto" if modes == "auto" else int(modes)
        subset = _with_shells(subset, path, "--modes", {"modes": number})
    ensemble = case.ensemble
    if members is not None:
        if members == 1 or not 0 <= members <= MOST_MEMBERS:
            raise BadInput(
                path,
                "--members",
                f"must be from 2 to {MOST_MEMBERS}, or 0 for no ensembles, got {members}",
            )
        keys = {} if ensemble is None else ensemble.model_dump()
        ensemble = EnsembleTable(**keys | {"members": members}) if members else None
    selected = case.model_copy(update={"models": subset, "ensemble": ensemble})
    if members:
        with translated_errors(path):
            check_ensemble_data(selected, build_boom(selected))
    return selected


def _with_shells(
    models: Sequence[Model], path: str, option: str, update: Mapping[str, object]
) -> tuple[Model, ...]:
    """Return the models with keys of their shells changed by a command-line option."""
    if not any(model.needs_shell for model in models):
        raise BadInput(path, option, "no shell is to be run; leave it out")
    return tuple(model.with_shells(update) for model in models)


def _read(path: str) -> dict[str, object]:
    text = ""
    try:
        text = read_text(Path(path))
        tables = tomllib.loads(text)
        for steps, value in leaves(tables):
            # TOML requires integers of 64 bits; Python reads longer ones.
            if isinstance(value, int) and not -(2**63) <= value < 2**63:
                raise BadInput(path, key_of(steps), _TOO_MANY_DIGITS)
        _rename_keys(tables)
        return tables
    except FileNotFoundError:
        raise BadInput(path, "file", "does not exist; give the path of a case file") from None
    except IsADirectoryError:
        raise BadInput(path, "file", "is a directory; give the path of a case file") from None
    except (OSError, ValueError, RecursionError) as error:
        raise BadInput(path, *_unreadable(error, text)) from None


def _rename_keys(tables: Mapping[str, object]) -> None:
    """Replace the former key ``tied`` of joints and models by ``bonded``, with a notice."""
    for key in ("joint", "model"):
        value = tables.get(key)
        for table in value if isinstance(value, list) else ():
            if isinstance(table, dict) and "tied" in table:
                table.setdefault("bonded", table.pop("tied"))
                _NOTICES.warning("the key tied of [[%s]] is read as bonded, its new name", key)


def _read_files(case: Case, path: str) -> Case:
    """Return the case with the contents of CSV files in place of the names of the files."""
    system = System(case.units)

    def read(key: str, table: Any) -> dict[str, Any]:
        # A calibrating shell has no contact of its own.
        own_contact = isinstance(table, ContactTable) and ".calibrated_by" not in key
        if own_contact or hasattr(table, "file"):
            return _pairs_of_file(path, key, table, system)
        return {}

    whole: Case = map_tables(case, read)
    return whole


def _pairs_of_file(path: str, key: str, table: Any, system: System) -> dict[str, Any]:
    """Return the changed values of a table after reading its CSV file, if any."""
    prefix = "force_" if isinstance(table, ContactTable) else ""
    file_key, columns_key, table_key = (prefix + key for key in ("file", "columns", "table"))
    file, headings = getattr(table, file_key), getattr(table, columns_key)
    if file is None:
        if headings is not None:
            what = "there is no file whose columns these are; leave it out"
            raise BadInput(path, f"{key}.{columns_key}", what)
        return {}
    key_of_file = f"{key}.{file_key}"
    if getattr(table, table_key) is not None:
        raise BadInput(path, key_of_file, "table is given; leave one of them out")
    read = read_pairs(path, key_of_file, file, headings, _columns(table, system))
    changes = {file_key: None, columns_key: None, table_key: read.values}
    if isinstance(table, ContactTable):
        try:
            table_law(read.values)
        except ValueError as error:
            raise BadInput(path, key_of_file, str(error)) from None
    if isinstance(table, HistoryTable):
        if isinstance(table, WindPressureTable) and read.has_unit and table.speed is not None:
            raise BadInput(path, f"{key}.speed", "the file has pressures; leave speed out")
        # Values that are set are in the units of the case file; defaults would be in SI units.
        if read.has_unit or table.amount in table.model_fields_set:
            changes[table.amount] = getattr(table, table.amount)
        elif not isinstance(table, WindPressureTable):  # it may have a speed, or that of the case
            what = describe(type(table), table.amount)
            raise BadInput(path, f"{key}.{table.amount}", f"missing; it is {what}")
    return changes


def _columns(table: Any, system: System) -> tuple[FileColumn, FileColumn]:
    if isinstance(table, HistoryTable):
        (unit,) = units_of(table, table.amount)
        return FileColumn("time", system.unit("s")), FileColumn(
            "factor", system.unit(unit), factor=True
        )
    contact = isinstance(table, ContactTable)
    names = ("penetration", "force") if contact else ("time", table.curve)
    first, second = units_of(table, "force_table" if contact else "table")
    # Instruments leave readings out, histories do not.
    gaps = not (contact or isinstance(table, TravelTable))
    return FileColumn(names[0], system.unit(first)), FileColumn(
        names[1], system.unit(second), gaps=gaps
    )


def _unreadable(error: Exception, text: str) -> tuple[str, str]:
    """Return key and message for an existing file that cannot be read."""
    if isinstance(error, OSError):
        return "file", f"cannot be read ({error.strerror}); give a case file that can"
    if isinstance(error, UnicodeDecodeError):
        line = error.object[: error.start].count(b"\n") + 1
        return f"line {line}", "not UTF-8; save the file in this encoding"
    if isinstance(error, RecursionError):
        return "file", "not TOML: nested too deeply; a case has three levels at most"
    if not isinstance(error, tomllib.TOMLDecodeError):
        return "file", f"a whole number {_TOO_MANY_DIGITS}"
    what, _, place = str(error).rstrip(")").rpartition(" (at ")
    at_line, _, at_column = place.partition(", ")
    if not what or not at_line.startswith("line "):
        return "file", f"not TOML: {error}; see https://toml.io"
    number = int(at_line.removeprefix("line "))
    if comma := _DECIMAL_COMMA.search(text.split("\n")[number - 1]):
        whole, part = comma.groups()
        return at_line, f"not TOML: {whole},{part} has a decimal comma; give {whole}.{part}"
    return at_line, f"not TOML: {what} ({at_column}); see https://toml.io"


def _check_time(case: Case) -> None:
    time = case.time
    for where, table in () if "duration" in time.model_fields_set else walk_tables(case):
        moves = isinstance(table, HistoryTable) and table.description
        if moves or isinstance(table, TravelTable):
            what = f"missing, and {where} changes over time; it is "
            raise BoomError("time.duration", what + describe(TimeTable, "duration"))
    outputs = time.duration / time.output_step
    if outputs > MOST_OUTPUTS:
        raise BoomError(
            "time.output_step",
            f"{time.output_step:g} s makes {outputs:.3g} outputs of {time.duration:g} s; it must "
            f"be at least {time.duration / MOST_OUTPUTS:.3g} s",
        )
    if abs(outputs - round(outputs)) > 1e-6 * outputs or round(outputs) < 1:
        whole = max(1, round(outputs))
        raise BoomError(
            "time.duration",
            f"must be a whole number of output steps of {time.output_step:g} s, such as "
            f"{whole * time.output_step:g} s, got {time.duration:g} s",
        )


def _check_boom(checked: CheckedCase) -> None:
    case, boom = checked.case, checked.boom
    check_ranges(case, boom)
    check_names("model", [model.name for model in case.models])
    for number, model in enumerate(case.models, start=1):
        where = f"model[{number}]"
        if model.name == BEAM:
            raise BoomError(f"{where}.name", f"{BEAM!r} is a model in all results; give another")
        _check_step(f"{where}.step", model.step, case.time)
        try:
            model.check(where, checked.model_boom(model))
        except BoomError as error:
            # A wrong unit is a likely reason, for example of a boom that buckles.
            unusual = (usual for usual in usual_ranges(case, boom) if usual.unusual)
            hint = next((usual for usual in unusual if any(usual.likely_units(case.system))), None)
            what = "" if hint is None else f"; {hint.key}: {hint.text(case.system)}"
            raise BoomError(error.where, f"{error.what}{what}") from None
    _check_step("time.step", case.time.step, case.time)
    check_ensemble_data(case, boom)
    check_combinations(case)


def _check_step(where: str, step: float | None, time: TimeTable) -> None:
    if step is not None and step > time.output_step:
        raise BoomError(
            where, f"must not be above the output step of {time.output_step:g} s, got {step:g} s"
        )


class Spread(NamedTuple):
    """Normal distribution of one number of a case file, in the units of the file."""

    steps: Steps  #: path of keys and indices to the number
    mean: float  #: mean value, which runs and checks take
    sd: float  #: standard deviation


def take_means(tables: Mapping[str, object], file: str) -> tuple[dict[str, object], list[Spread]]:
    """Return the tables of a case file with means in place of distributions, and the distributions.

    Raises:
        BadInput: a mean is not a finite number, or a standard deviation is not a number above 0.
    """
    spreads: list[Spread] = []

    def replace_by_means(item: Any, steps: Steps) -> object:
        if isinstance(item, list):
            return [replace_by_means(value, (*steps, i)) for i, value in enumerate(item)]
        if not isinstance(item, Mapping):
            return item
        if item.keys() != {"mean", "sd"}:
            return {key: replace_by_means(value, (*steps, key)) for key, value in item.items()}
        mean, sd = item["mean"], item["sd"]
        finite = all(is_number(number) and math.isfinite(number) for number in (mean, sd))
        if not (finite and sd > 0.0):
            what = f"must have a finite mean and an sd above 0, got {mean!r} and {sd!r}"
            raise BadInput(file, key_of(steps), what)
        spreads.append(Spread(steps, float(mean), float(sd)))
        return mean

    return {key: replace_by_means(value, (key,)) for key, value in tables.items()}, spreads
