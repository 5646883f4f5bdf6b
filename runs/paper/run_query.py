# SPDX-License-Identifier: LGPL-3.0-or-later
"""Queries of a run for the rules, and differences between models."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from protractile.analysis.low_pass import slow_peaks
from protractile.geometry.arrays import Array, Mask
from protractile.runs.case.kinds.kantorovich import Kantorovich
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.schema import Case, Model
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.summary import ModelSummary

# A peak that some models lack counts only if the run lasts this number of periods after it.
NEXT_PEAK = 1.5

_Value = TypeVar("_Value")


class MissingData(Exception):
    """Error if the run lacks data that a rule needs."""


@dataclass(frozen=True, slots=True)
class RunQuery:
    """Queries of a run. Methods raise :class:`MissingData` if the data are missing."""

    results: Results  #: results of the run

    @property
    def case(self) -> Case:
        """The case of the run."""
        return self.results.case

    @property
    def time(self) -> Array:
        """The output times (num_times,) in s."""
        return np.asarray(self.results.trajectories["time"].values, dtype=float)

    def check_ran(self, model: Model) -> None:
        """Check that a model did not fail."""
        why = self.results.summary.failures.get(model.name)
        if why is not None:
            raise MissingData(f"{model.name!r} failed: {why}.")
        if model.name not in self.results.trajectories["model"].values:
            raise MissingData(f"{model.name!r} did not run.")

    def curve(self, model: Model, place: str = "tip") -> Array:
        """Return the deflection (num_times,) in m of a model at a place, ``tip`` or ``head``."""
        self.check_ran(model)
        if place not in self.results.trajectories:
            raise MissingData(f"No {place} in this run.")
        of_model = self.results.trajectories[place].sel(model=model.name)
        deflection = np.asarray(of_model.values, dtype=float)
        if not np.isfinite(deflection).all():
            raise MissingData(f"The {place} of {model.name!r} is not finite.")
        return deflection

    def members(self, *models: Model) -> Array:
        """Return the tip deflections (num_models, num_members, num_times) in m of ensembles."""
        for model in models:
            self.curve(model)
        if self.results.ensembles is None:
            raise MissingData("One run is a sample of a chaotic motion; it takes [ensemble].")
        tips = self.results.ensembles["tip"].sel(model=[model.name for model in models])
        return np.asarray(tips.transpose("model", "member", "time").values, dtype=float)

    def summary_of(self, model: Model) -> ModelSummary:
        """Return the summary of a model."""
        self.check_ran(model)
        return self.results.summary.models[model.name]

    def horizon(self, model: Model, share: float) -> float | None:
        """Return the time in s when members first differ by a share of the range; None if never."""
        return _require(model, "ensemble", self.summary_of(model).ensemble).horizon(share)

    def first_contact(self, model: Model) -> float:
        """Return the time of the first contact in s."""
        return _require(model, "first contact", self.summary_of(model).first_contact)

    def peak_time(self, model: Model) -> float:
        """Return the time of the first peak of the tip in s."""
        return _require(model, "first peak", self.summary_of(model).first_peak["tip"].time)

    def peak_height(self, model: Model) -> float:
        """Return the height of the first peak of the tip in m."""
        return _require(model, "first peak", self.summary_of(model).first_peak["tip"].height)

    def fewest_steps(self, model: Model) -> int:
        """Return the fewest steps of the trials that keep the first peaks of the slow motion."""
        steps = self.summary_of(model).steps_for_peaks
        return _require(model, "steps for peaks", steps.fewest if steps else None)

    def slow_below(self) -> float:
        """Return the frequency in Hz below which the motion counts as slow."""
        ensemble = self.results.summary.ensemble
        if ensemble is None or ensemble.slow_below is None:
            raise MissingData("The run is too coarsely reported for a slow motion.")
        return ensemble.slow_below

    def one(self, what: str, fits: Callable[[Model], bool]) -> Model:
        """Return a model that satisfies a condition: the one named ``what`` or else the first."""
        models = sorted(filter(fits, self.case.models), key=lambda model: model.name != what)
        if not models:
            raise MissingData(f"The case has no model like {what!r}.")
        return models[0]

    def four_terms(self) -> Model:
        """Return the series with a rigid inner segment."""
        return self.one("kantorovich-4", lambda model: terms(model) == (2, 2))

    def five_terms(self) -> Model:
        """Return the series with an additional function for bending of the inner segment."""
        four = self.four_terms()
        return self.one(
            "kantorovich-5",
            lambda model: (
                terms(model) == (2, 3)
                and options(model, "terms", "step") == options(four, "terms", "step")
            ),
        )

    def beam_elements(self) -> Model:
        """Return the beam elements with play by the theory of the paper, Euler and Bernoulli's."""
        return self.one(
            "beam-fe",
            lambda model: not model.bonded and getattr(model, "theory", None) == "euler-bernoulli",
        )

    def shell(self) -> Model:
        """Return the shell model of the case."""
        return self.one("shell", lambda model: model.meshed)

    def bonded(self) -> Model:
        """Return the model without play."""
        return self.one("beam-fe-bonded", lambda model: model.bonded)

    def with_play(self) -> list[Model]:
        """Return all models with play, at least two."""
        models = [model for model in self.case.models if not model.bonded]
        if len(models) < 2:
            raise MissingData("It takes two models with play to compare.")
        return models

    def check_friction(self, *, present: bool) -> None:
        """Check that the case has friction if ``present``, else that it has none."""
        if any(joint.friction > 0.0 for joint in self.case.joints) == present:
            return
        has, takes = ("no ", "with friction") if present else ("", "without")
        raise MissingData(f"This case has {has}friction; it takes the case {takes}.")

    def last_until(self, end: float) -> None:
        """Check that the run lasts until ``end`` in s."""
        if self.time[-1] < end * (1.0 - 1e-9):
            raise MissingData(f"The run ends at {self.time[-1]:g} s; it takes {end:g} s.")


def _require(model: Model, what: str, value: _Value | None) -> _Value:
    if value is None:
        raise MissingData(f"{model.name!r} has no {what}.")
    return value


def terms(model: Model) -> tuple[int, ...]:
    """Return the number of functions in each segment of a series; empty for other models."""
    return next((series.terms for series in select_kind(Kantorovich, [model])), ())


def options(model: Model, *ignored: str) -> dict[str, Any]:
    """Return the keys of a model and their values, without ``name`` and the ignored keys."""
    return model.model_dump(exclude={"name", *ignored})


def final_differences(first: Array, second: Array, last: Mask) -> Array:
    """Return the largest differences (num_members,) at the last times, divided by the larger range.

    Curves are (num_members, num_times), and ``last`` is the mask (num_times,) of the last times.
    """
    scale = np.maximum(np.ptp(first, axis=1), np.ptp(second, axis=1))
    return np.asarray(np.abs(first - second)[:, last].max(axis=1) / scale)


def peak_distances(curves: Array, time: Array, cutoff: float) -> tuple[Array, Array]:
    """Return the distances between corresponding peaks of the slow motions of several models.

    The k-th peaks of all models correspond. Their distance is the larger of two fractions: the
    span of their times over the mean period, and the span of their heights over the highest. It is
    infinite if a model lacks the peak although the run lasts long enough.

    Args:
        curves: deflections (num_models, num_times) of one member of each model.
        time: evenly spaced times (num_times,) in s.
        cutoff: cut-off of the slow motion in Hz.

    Returns:
        Times (num_peaks,) in s of the earliest of corresponding peaks, and distances (num_peaks,);
        peaks that only some models have are included.
    """
    peaks = [slow_peaks(curve, time, cutoff) for curve in curves]
    intervals = [np.diff(times) for times, _ in peaks if times.size > 1]
    period = float(np.concatenate(intervals).mean()) if intervals else np.inf
    t, h = np.full((2, len(peaks), max(times.size for times, _ in peaks)), np.nan)
    for model, (times, heights) in enumerate(peaks):
        t[model, : times.size], h[model, : times.size] = times, heights
    first = np.nanmin(t, axis=0)
    in_all = np.isfinite(t).all(axis=0)
    time_spans = np.ptp(t, axis=0) / period
    height_spans = np.ptp(h, axis=0) / np.nanmax(np.abs(h), axis=0)
    distances = np.where(in_all, np.maximum(time_spans, height_spans), np.inf)
    counts = in_all | (first < time[-1] - NEXT_PEAK * period)
    return first[counts], distances[counts]
