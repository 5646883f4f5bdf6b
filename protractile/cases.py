# SPDX-License-Identifier: LGPL-3.0-or-later
"""Functions to load, change and run cases in Python."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from runs.case import reading
from runs.case.messages import BadInput
from runs.case.schema import Case
from runs.folder.cache import Cache
from runs.pipeline.context import RunContext
from runs.pipeline.results import Results
from runs.pipeline.run import run_case as run_models
from runs.sweep.variation import Unplaced, find

# Name of a case without a file in messages.
_CASE = "case"


def load_case(path: str | Path) -> Case:
    """Read and check a case file.

    >>> import protractile as pt
    >>> case = pt.load_case(pt.CASES / "paper.toml")
    >>> [segment.name for segment in case.segments]
    ['outer', 'inner']

    Args:
        path: path of the file; those in ``CASES`` come with the program.

    Raises:
        BadInput: the file cannot be read, or its content is invalid.
    """
    return reading.load(str(path))


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
    tables = case.model_dump(mode="json", by_alias=True, exclude_none=True)
    for key, value in values.items():
        try:
            for place in find(key, tables):
                place.put(tables, value)
        except Unplaced as reason:
            raise BadInput(_CASE, key, str(reason)) from None
    try:
        changed = Case.model_validate(tables)
    except ValidationError as error:
        raise BadInput.from_validation(_CASE, error) from None
    reading.check(changed, _CASE)
    return changed


def run_case(case: Case, models: Sequence[str] | None = None) -> Results:
    """Run the models of a case in this process; write only to the user's cache of shells.

    >>> import protractile as pt
    >>> case = pt.load_case(pt.CASES / "coarse.toml")
    >>> results = pt.run_case(case, models=["kantorovich-4"])
    >>> results.trajectories["tip"].dims
    ('model', 'time')

    Args:
        case: case from :func:`load_case` or :func:`change`.
        models: names of the models; all unless given.

    Returns:
        The results. ``results.trajectories["tip"].plot.line(x="time")`` draws the tips; a model
        that cannot be computed is in ``summary.failures``, with the reason.

    Raises:
        BadInput: the case has no model with a given name.
        NumericsError: no model can be computed.
    """
    chosen = reading.select(case, _CASE, models)
    comm = None
    if any(model.needs_shell for model in chosen.models):
        from mpi4py import MPI

        comm = MPI.COMM_SELF
    run = run_models(chosen, _CASE, RunContext(comm, cache=Cache.of_user()))
    assert run is not None
    run.evaluate()
    return run.results
