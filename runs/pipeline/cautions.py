# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a run is not worth, a line each; in part that is known before anything moves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from geometry.axial import entry
from geometry.boom import Boom
from geometry.typography import TO_PERCENT
from runs.case.actions import series_notes
from runs.case.schema import Case
from runs.pipeline.drives import Slipping, lag_cautions, slip_cautions, slippings
from runs.pipeline.proportions import of_buckling, of_period, of_tip, slips

if TYPE_CHECKING:
    import xarray as xr

    from runs.pipeline.summary import ModelSummary, Summary

# Relative error of a reduction, or of a mesh, beyond which a run says so.
POOR = 0.01

# Part of the boom's length beyond which no displacement is small.
MOST = 0.1


def of_case(case: Case, boom: Boom, drives: Iterable[Slipping]) -> list[str]:
    """Before anything moves; ``drives`` those of a given stiffness."""
    return [*slips(case, boom), *slip_cautions(drives, case.system)]


def of_run(case: Case, boom: Boom, data: xr.Dataset, summary: Summary) -> list[str]:
    """Of models that have moved.

    Args:
        case: of the run.
        boom: of the case.
        data: the trajectories of its models.
        summary: of the run, with all that has failed.
    """
    models = summary.models
    return [
        *of_case(case, boom, slippings(case, boom)),
        *lag_cautions(boom, data, case.system),
        *(f"failed: {name}: {why}" for name, why in summary.failures.items()),
        *_bent(models, boom),
        *_short(summary, case),
        *_passed_by(models, boom),
        *_far(boom, data),
        *_poor(models),
        *_coarse(models),
        *series_notes(case),
    ]


def _bent(models: Mapping[str, ModelSummary], boom: Boom) -> Iterator[str]:
    for name, model in models.items():
        yield from of_buckling(name, model.critical_factor)
        yield from of_tip(f"in {name}", model.static_tip, boom)


def _short(summary: Summary, case: Case) -> list[str]:
    found = summary.answers.models.items()
    slowest = min(((mode.frequency, name) for name, one in found for mode in one.modes), default=())
    return of_period(f"in {slowest[1]}", slowest[0], case) if slowest else []


def _passed_by(models: Mapping[str, ModelSummary], boom: Boom) -> Iterator[str]:
    numbers = range(len(boom.joints))
    if any(entry(boom.segments, boom.joints, number) for number in numbers):
        for name in (name for name, model in models.items() if model.stress is not None):
            yield (
                f"caution: the walls of {name} bear the axial forces of the start: their stresses, "
                "and what part of the yield strength these are, lack what the forces add where "
                "drives take them; those of outer fibres have it"
            )


def _far(boom: Boom, data: xr.Dataset) -> Iterator[str]:
    largest = np.abs(data["tip"].values).max(axis=1)
    for name, move in zip(data["model"].values, largest, strict=True):
        if move > MOST * boom.length:
            yield (
                f"caution: in {name} the tip moves by {float(move):.3g} m, more than a tenth of "
                "the boom's length: small displacements do not hold; check units and loads"
            )


def _poor(models: Mapping[str, ModelSummary]) -> Iterator[str]:
    for name, model in models.items():
        if (error := model.reduction_errors.get("contact_compliance") or 0.0) > POOR:
            yield (
                f"caution: the {model.modes} coordinates of {name} err by {TO_PERCENT * error:.2g} "
                "% where the segments touch; allow more modes, or --modes auto"
            )


def _coarse(models: Mapping[str, ModelSummary]) -> Iterator[str]:
    for name, model in models.items():
        if (error := model.mesh_error or 0.0) > POOR:
            yield (
                f"caution: the mesh of {name} errs by {TO_PERCENT * error:.2g} % of what the walls "
                "give way where the segments touch; give a smaller mesh_size"
            )
