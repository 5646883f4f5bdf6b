# SPDX-License-Identifier: LGPL-3.0-or-later
"""Every model of a run held against one of them, as numbers for the summary.

Where ensembles are known, at three levels, each with what it can decide. Where segments rub, from
the beginning to the end: friction takes what impacts would otherwise let grow.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import xarray as xr

from dynamics.predictability.comparison import Distributions, PeakDifferences, compare
from dynamics.trajectory import Pointwise
from runs.case.schema import Case, Model
from runs.pipeline.summary import Comparisons, Levels, Whole

# Differences over a whole run are told until here, too, in s.
HALFWAY = 5.0
# What each level can and cannot decide, in the words of those who measure.
DECIDES: Mapping[str, str] = {
    "pointwise": Pointwise.decides,
    "peaks": PeakDifferences.decides,
    "distributions": Distributions.decides,
}


def reference_of(models: Iterable[Model]) -> str | None:
    """The model that the others are held against: the last shell, else the last with play."""
    with_play = [model for model in models if not model.play_free]
    shells = [model for model in with_play if model.meshed]
    candidates = shells or with_play
    return candidates[-1].name if candidates else None


def leading(case: Case, models: Sequence[str]) -> set[str]:
    """Those that are read first: the last shell, the last beam with play, the first without.

    All of up to three, and of kinds that a run lacks the last one with play.
    """
    if len(models) <= 3:
        return set(models)
    ran = [model for model in case.models if model.name in models]
    loose = [model for model in ran if not model.play_free]
    shells = [model.name for model in loose if model.meshed]
    beams = [model.name for model in loose if not model.meshed]
    tied = [model.name for model in ran if model.play_free]
    return {*shells[-1:], *beams[-1:], *tied[:1]}


def compare_models(
    case: Case,
    trajectories: xr.Dataset,
    ensembles: xr.Dataset | None,
    cutoff: float | None,
) -> Comparisons | None:
    """What the summary says of the models' differences; None where there is nothing to compare.

    Args:
        case: which model is which.
        trajectories: dims ``model``, ``time``; ``tip`` in m.
        ensembles: dims ``model``, ``member``, ``time``; ``tip`` in m.
        cutoff: of the slow motion in Hz.
    """
    ran = trajectories["model"].values
    reference = reference_of(model for model in case.models if model.name in ran)
    if reference is None:
        return None
    found = Comparisons(reference=reference)
    if ensembles is not None and cutoff is not None:
        one, *others = (
            ensembles.sel(model=name).astype(float)
            for name in (reference, *_others(ensembles, reference))
        )
        found.ensembles = {
            str(other["model"].item()): Levels.model_validate(compare(one, other, cutoff))
            for other in others
        }
    if case.regular:
        found.whole = {
            name: _whole(trajectories, reference, name) for name in _others(trajectories, reference)
        }
    return found if found.ensembles or found.whole else None


def _others(data: xr.Dataset, reference: str) -> list[str]:
    return [str(name) for name in data["model"].values if name != reference]


def _whole(trajectories: xr.Dataset, reference: str, name: str) -> Whole:
    """Pointwise differences of two tips until the middle and until the end."""
    time = trajectories["time"].values
    one, other = (trajectories["tip"].sel(model=model).values for model in (reference, name))
    ends = [end for end in (HALFWAY, float(time[-1])) if end <= time[-1]]
    found = [Pointwise.of(one, other, time, end) for end in dict.fromkeys(ends)]
    return Whole(
        until=[part.until for part in found],
        largest=[part.largest for part in found],
        rms=[part.rms for part in found],
    )
