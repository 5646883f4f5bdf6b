# SPDX-License-Identifier: LGPL-3.0-or-later
"""Functions to load, change and run cases in Python."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from numbers import Real
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import xarray as xr

from protractile.geometry.fields import format_value
from protractile.runs.case import reading
from protractile.runs.case.build import hold_ground
from protractile.runs.case.messages import translated_errors
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case
from protractile.runs.cautions.rules import add_cautions
from protractile.runs.folder.cache import Cache
from protractile.runs.folder.files import atomic_folder
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.results import Results, prepare
from protractile.runs.pipeline.run import run_case as run_models
from protractile.runs.process import workers
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.ranks import single_rank
from protractile.runs.process.terminal import ignore_progress
from protractile.runs.report.additions import judge
from protractile.runs.sweep import points
from protractile.runs.sweep.variation import InvalidVariation, find

if TYPE_CHECKING:
    import pandas as pd

    from protractile.runs.check import Check

# Name of a case without a file in messages.
_CASE = "case"


def load_case(source: str | Path | Mapping[str, Any]) -> Case:
    """Return the checked case of a case file, or of a dictionary with the tables of a case.

    >>> import protractile as pt
    >>> case = pt.load_case(pt.CASES / "paper.toml")
    >>> [segment.name for segment in case.segments]
    ['outer', 'inner']

    Args:
        source: path of a case file, for example in the folder ``CASES`` of the program; or a
            dictionary, in which paths of CSV files are relative to the current folder.

    Raises:
        BadInput: the file cannot be read, or its content is invalid.
    """
    if isinstance(source, Mapping):
        return reading.check_tables(source, _CASE).case
    if not isinstance(source, str | Path):
        what = f"must be a path or a dictionary, got {format_value(source)}"
        raise BadInput(_CASE, "source", what)
    return reading.load(str(source))


def check(case: Case) -> Check:
    """Return the output of ``protractile check``: tables, static state, stresses, cautions.

    A notebook shows the tables, ``print`` the text; ``frames`` are the tables for pandas.

    >>> import protractile as pt
    >>> result = pt.check(pt.load_case(pt.CASES / "paper.toml"))
    >>> [round(mass) for mass in result.frames["Masses"]["own mass, kg"]]
    [832, 551, 1382]
    """
    from protractile.runs.check import check_case

    return check_case(CheckedCase(_checked(case)))


def change(case: Case, **values: Any) -> Case:
    """Return the case with some values changed, checked like a case file.

    >>> import protractile as pt
    >>> case = pt.load_case(pt.CASES / "paper.toml")
    >>> case = pt.change(case, **{"joint.play": 0.02, "time.duration": 1.0})
    >>> case.joints[0].play, case.time.duration
    (0.02, 1.0)

    Args:
        case: the original case, which is not changed.
        values: new values by key, as in ``protractile sweep --vary``: ``joint[1].play``, or
            ``joint.play`` for all joints.

    Raises:
        BadInput: a key is unknown or a value is invalid.
    """
    tables = _checked(case).model_dump(mode="json", by_alias=True, exclude_none=True)
    for key, value in values.items():
        if isinstance(value, float) and not math.isfinite(value):
            raise BadInput(_CASE, key, f"must be a finite number, got {value}")
        try:
            for place in find(key, tables):
                place.put(tables, value)
        except InvalidVariation as reason:
            raise BadInput(_CASE, key, str(reason)) from None
    with translated_errors(_CASE):
        changed = hold_ground(Case.model_validate(tables), case)
    reading.check(changed, _CASE)
    return changed


def run_case(
    case: Case, models: Sequence[str] | None = None, folder: str | Path | None = None
) -> Results:
    """Run the models of a case in this process, and return the results.

    >>> import protractile as pt
    >>> case = pt.load_case(pt.CASES / "coarse.toml")
    >>> results = pt.run_case(case, models=["kantorovich-4"])
    >>> results.trajectories["tip"].dims
    ('model', 'time')

    Args:
        case: case from :func:`load_case` or :func:`change`.
        models: names of the models; all unless given.
        folder: folder for all files of the run, as ``protractile run`` writes them; without one,
            only the user's cache of shells is written.

    Returns:
        The results. ``results.trajectories["tip"].plot.line(x="time")`` draws the tips; a model
        that cannot be computed is in ``summary.failures``, with the reason.

    Raises:
        BadInput: the case has no model with a given name, or the folder contains other files.
        NumericsError: no model can be computed.
    """
    chosen = reading.select(_checked(case), _CASE, _names(models))
    path = None if folder is None else prepare(str(folder), _CASE)
    comm = single_rank(chosen.first_shell)
    run = run_models(chosen, _CASE, RunContext(comm, cache=Cache.of_user()))
    assert run is not None
    run.evaluate()
    add_cautions(run.results)
    if path is not None:
        from protractile.runs.report.output import write

        with atomic_folder(path) as part:
            write(run, judge(run.results), part)
    return run.results


def report(folder: str | Path, *, excel: bool = False, figures: bool = False) -> Results:
    """Render the report of a run again from the data of the run, as ``protractile report``.

    Args:
        folder: folder of a run, or of :meth:`Results.save`, for ``report.html``.
        excel: whether the folder also receives ``results.xlsx``, a workbook of the design results.
        figures: whether the folder also receives all figures as PNG files.

    Returns:
        The results of the run.

    Raises:
        BadInput: the folder is not that of a run, or openpyxl is missing for the workbook.
    """
    from protractile.runs.report.output import rerender_report

    option = "excel" if excel else None
    with rerender_report(str(folder), option, figures) as (results, _, _):
        return results


def tables(results: Results) -> dict[str, pd.DataFrame]:
    """Return the tables of a report by their names, with numbers in displayed units.

    :attr:`Results.quantities` has the main numbers in SI units.
    """
    from protractile.runs.report.document import tables_by_part

    if not isinstance(results, Results):
        raise BadInput("results", "results", f"must be Results, got {format_value(results)}")
    of_parts = tables_by_part(results).values()
    return {table.name: table.flat_frame for several in of_parts for table in several}


def sweep(
    case: Case,
    vary: Mapping[str, Sequence[float]],
    models: Sequence[str] | None = None,
    *,
    against: str | None = None,
    until: str | None = None,
    folder: str | Path | None = None,
) -> xr.Dataset:
    """Run a case for several values of its keys on all cores, as ``protractile sweep``.

    In a script, call the function below ``if __name__ == "__main__":``, since other processes
    import the script.

    Args:
        case: case from :func:`load_case` or :func:`change`.
        vary: values by key, in the units of the case; all combinations are run.
        models: names of the models; all unless given.
        against: name of the model with which the others are compared.
        until: bound of a quantity, such as ``"tip<0.9"``; bisection finds the value of the key, of
            which there must be one, at this bound.
        folder: folder for the files of the sweep; finished points in it are not run again.

    Returns:
        The quantities of :attr:`Results.quantities` in SI units; dims: the keys and ``model``.
        ``failed`` is 1 if a model could not be computed.

    Raises:
        BadInput: a key, a value, a model or the bound is invalid.
    """
    from protractile.runs.sweep import output, search
    from protractile.runs.sweep.run import prepare as prepare_sweep

    plan_of = partial(
        points.plan, _CASE, models=_names(models), mesh_size=None, reference=against,
        whole=_checked(case),
    )  # fmt: skip
    plan = plan_of(_options(vary))
    bound = None if until is None else search.parse_bound(until, plan)
    with TemporaryDirectory() as temporary, workers.workers(None) as pool:
        path = Path(folder or temporary)
        prepare_sweep(path, _CASE)
        tools = path, pool, ignore_progress, Cache.of_user()
        plan, outcomes = search.run_until(plan, bound, plan_of, *tools)
        return output.write(plan, outcomes, path) if folder else output.gather(plan, outcomes)


def frequencies(
    case: Case,
    vary: Mapping[str, Sequence[float]] | None = None,
    models: Sequence[str] | None = None,
) -> xr.Dataset:
    """Return the first natural frequencies of a case, or of variants with other values of keys.

    >>> import protractile as pt
    >>> case = pt.load_case(pt.CASES / "paper.toml")
    >>> data = pt.frequencies(case, models=["kantorovich-5"])
    >>> data["frequency"].sel(joints="bonded", mode=1).values.round(3)
    array([2.361])

    Args:
        case, vary, models: as in :func:`sweep`.

    Returns:
        ``frequency`` in Hz; dims: the keys, ``model``, ``joints`` (``"in contact"``, ``"bonded"``),
        ``mode``; NaN if a model has none.

    Raises:
        BadInput: a key, a value or a model is invalid.
    """
    from protractile.runs.sweep import frequencies

    plan = points.plan(_CASE, _options(vary or {}), _names(models), None, whole=_checked(case))
    cases = [point.case for point in plan.points]
    results = frequencies.measure(cases, single_rank(cases[0].first_shell), Cache.of_user())
    return frequencies.gather(plan, results)


def _checked(case: Case) -> Case:
    """Return a case.

    Raises:
        BadInput: it is another object.
    """
    if not isinstance(case, Case):
        what = f"must be a Case, such as load_case returns, got {format_value(case)}"
        raise BadInput(_CASE, "case", what)
    return case


def _names(models: Sequence[str] | None) -> Sequence[str] | None:
    """Return the names of models.

    Raises:
        BadInput: they are no list of names.
    """
    several = isinstance(models, list | tuple) and all(isinstance(name, str) for name in models)
    if models is not None and not several:
        what = f"must be a list of names, got {format_value(models)}"
        raise BadInput(_CASE, "models", what)
    return models


def _options(vary: Mapping[str, Sequence[float]]) -> list[str]:
    """Return ``vary`` as options of the command line, without loss of digits.

    Raises:
        BadInput: the values of a key are no list of numbers.
    """
    if not isinstance(vary, Mapping):
        what = f"must be a dictionary of keys and lists of numbers, got {format_value(vary)}"
        raise BadInput(_CASE, "vary", what)
    options = []
    for key, values in vary.items():
        listed = isinstance(values, Iterable) and not isinstance(values, str)
        if not (listed and all(isinstance(value, Real) for value in values)):
            raise BadInput(_CASE, key, f"must be a list of numbers, got {values!r}")
        options.append(f"{key}={','.join(repr(float(value)) for value in values)}")
    return options
