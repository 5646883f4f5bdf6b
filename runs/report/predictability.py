# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of the predictability of motions, and of the comparison of models."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from protractile.analysis.comparison import Comparison, PeakDifferences
from protractile.analysis.low_pass import SlowPeaks
from protractile.dynamics.predictability import SHARES
from protractile.geometry.typography import (
    NONE,
    TO_MILLI,
    fixed,
    number,
    percent,
    scientific,
    with_minus_signs,
)
from protractile.runs.pipeline.model_quality import SCOPES
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.summary import Ensembles, ModelSummary, Predictability, WholeRun
from protractile.runs.report.model_tables import horizon_column
from protractile.runs.report.tables import Column, Table

# Text in tables for each kind of limit.
LIMITS = {"physics": "the motion", "step": "the step", "nothing": "nothing in the run"}
# Number format and unit of times.
_TIME = ".2f", "s"
VARIED_DATA = {"load": "loads", "clearance": "clearances", "velocity": "initial velocities"}


def predictability_tables(results: Results) -> list[Table]:
    """Return the tables of the ensembles of a run; empty without ensembles."""
    models, ensembles = results.summary.models, results.summary.ensemble
    sampled = {name: model for name, model in models.items() if model.ensemble}
    measured = {name: model.horizons for name, model in models.items() if model.horizons}
    peaks = {
        name: slow_peaks for name, model in sampled.items() if (slow_peaks := _slow_peaks(model))
    }
    tables = []
    if ensembles is not None and sampled:
        tables.append(_horizon_table(ensembles, sampled, results.case.time.duration))
    if measured:
        tables.append(_growth_table(measured))
    if peaks:
        columns = _peak_columns({name: _heights(slow_peaks) for name, slow_peaks in peaks.items()})
        note = (
            "Mean of an ensemble's members ± half the distance between its extremes. A column "
            "ends with the last peak that all members have."
        )
        tables.append(Table("Slow peaks", columns, [note], "slow-peaks"))
    return tables


def comparison_tables(results: Results) -> list[Table]:
    """Return the tables of differences from the reference; empty without comparisons."""
    compared = results.summary.comparisons
    tables: list[Table] = []
    if compared is not None and compared.ensembles:
        tables += _level_tables(compared.reference, compared.ensembles)
    if compared is not None and compared.whole:
        tables.append(_whole_table(compared.reference, compared.whole))
    return tables


def _slow_peaks(model: ModelSummary) -> SlowPeaks | None:
    return model.ensemble.slow_peaks if model.ensemble else None


def _horizon_table(
    ensembles: Ensembles, sampled: Mapping[str, ModelSummary], duration: float
) -> Table:
    models = list(sampled.values())
    peaks = [_slow_peaks(model) for model in models]
    periods = [_spread(peak.period, peak.period_spread, 3) if peak else None for peak in peaks]
    columns = (
        Column("model", list(sampled)),
        *(horizon_column(models, share, duration) for share in SHARES),
        Column(
            "common slow peaks",
            [len(slow_peaks.time) if slow_peaks else None for slow_peaks in peaks],
        ),
        Column("period", periods, unit="s"),
    )
    notes = [
        f"Ensembles of {ensembles.members} members, {VARIED_DATA[ensembles.vary]} changed by up to "
        f"{scientific(ensembles.relative)} of their values. Horizon: time at which the members "
        "differ by this fraction of the tip's range."
    ]
    if ensembles.slow_below is not None:
        notes.append(
            f"Slow peaks are peaks of the motion below {number(ensembles.slow_below)} Hz. All "
            "members have the common peaks."
        )
    return Table("Horizons", columns, notes, "horizons")


def _growth_table(measured: Mapping[str, Predictability]) -> Table:
    rows = [
        (name, horizons, i)
        for name, horizons in measured.items()
        for i in range(len(horizons.shares))
    ]
    sizes = next(iter(measured.values())).relatives
    times = [[horizons.times[k][i] for _, horizons, i in rows] for k in range(len(sizes))]
    columns = (
        Column("model", [name for name, _, _ in rows]),
        Column("part of the range", [percent(horizons.shares[i]) for _, horizons, i in rows]),
        *(
            Column(f"change {scientific(size)}", of_size, *_TIME)
            for size, of_size in zip(sizes, times, strict=True)
        ),
        Column("finer step", [horizons.of_step[i] for _, horizons, i in rows], *_TIME),
        Column("growth", [horizons.rate[i] for _, horizons, i in rows], ".2g", "1/s"),
        Column("limited by", [LIMITS[horizons.limits[i]] for _, horizons, i in rows]),
    )
    notes = (
        "Time at which runs differ by this fraction of the tip's range, for relative changes of "
        "the data. Differences grow as exp(growth · time): data a thousand times better extend "
        "the horizon by 6.9 / growth.",
        "Finer step: time for a run with half the step. If it is earlier than for the largest "
        "change, a finer step would help; if it is later, the motion itself is the limit.",
    )
    return Table("Growth of differences", columns, notes, "growth")


def _peak_columns(peaks: Mapping[str, Sequence[str]]) -> list[Column]:
    """Return a column for each model with a row for each peak."""
    most = max(map(len, peaks.values()))
    numbers = [str(i) for i in range(1, most + 1)]
    return [Column("peak", numbers), *(Column(*column) for column in peaks.items())]


def _heights(slow_peaks: SlowPeaks) -> list[str]:
    """Return time and height of each peak as text."""
    times = map(partial(_spread, decimals=3), slow_peaks.time, slow_peaks.time_spread)
    heights = map(
        partial(_spread, decimals=2, factor=TO_MILLI), slow_peaks.height, slow_peaks.height_spread
    )
    return [f"{time} s\n{height} mm" for time, height in zip(times, heights, strict=True)]


def _differences(differences: PeakDifferences) -> list[str]:
    """Return the differences of each peak from the reference, in time and height, as text."""
    signed_milli = partial(_spread, factor=TO_MILLI, sign="+")
    times = map(partial(signed_milli, decimals=0), differences.time, differences.time_spread)
    heights = map(partial(signed_milli, decimals=2), differences.height, differences.height_spread)
    marks = ("" if explained else " *" for explained in differences.explained)
    rows = zip(times, heights, marks, strict=True)
    return [f"{time} ms\n{height} mm{mark}" for time, height, mark in rows]


def _level_tables(reference: str, levels: Mapping[str, Comparison]) -> list[Table]:
    """Return the tables of comparisons by instants, by peaks, and by distributions."""
    points = [level.pointwise for level in levels.values()]
    spreads = [level.distributions for level in levels.values()]
    models = Column("model", list(levels))
    pointwise = (
        models,
        Column("until", [difference.until for difference in points], *_TIME),
        Column(
            "largest difference",
            [difference.largest for difference in points],
            ".2f",
            "% of the range",
        ),
        Column("rms", [difference.rms for difference in points], ".2f", "% of the range"),
    )
    peaks = _peak_columns({name: _differences(level.peaks) for name, level in levels.items()})
    distributions = (
        models,
        Column("from", [difference.since for difference in spreads], *_TIME),
        Column("range", [_both(difference.range) for difference in spreads], unit="mm"),
        Column("mean", [_both(difference.mean) for difference in spreads], unit="mm"),
        Column(
            "standard deviation", [_both(difference.deviation) for difference in spreads], unit="mm"
        ),
        Column(
            "Kolmogorov–Smirnov\ndistance", [difference.distance for difference in spreads], ".3f"
        ),
    )
    later = (
        f"Slow peak of each model less the peak of {reference}, ± the sum of both spreads. *: the "
        "difference in time or in height exceeds this sum."
    )
    every = f"All values of all members after the horizons: the model / {reference}."
    of = f"against {reference}"
    return [
        Table(f"Tip {of}, pointwise", pointwise, [SCOPES["pointwise"]], "pointwise"),
        Table(f"Slow peaks {of}", peaks, [later, SCOPES["peaks"]], "peaks-against"),
        Table(
            f"Distribution of the tip {of}",
            distributions,
            [every, SCOPES["distributions"]],
            "distributions",
        ),
    ]


def _both(values: Sequence[float]) -> str:
    """Return the values of the model and of the reference in mm, separated by a slash."""
    if not np.isfinite(values).any():
        return NONE
    return " / ".join(fixed(value, 1, TO_MILLI) for value in reversed(values))


def _whole_table(reference: str, whole: Mapping[str, WholeRun]) -> Table:
    columns = [Column("model", list(whole))]
    for i, end in enumerate(next(iter(whole.values())).until):
        largest = [differences.largest[i] for differences in whole.values()]
        rms = [differences.rms[i] for differences in whole.values()]
        columns += [
            Column(f"largest difference\nto {end:g} s", largest, ".2f", "%"),
            Column(f"rms\nto {end:g} s", rms, ".2f", "%"),
        ]
    notes = (
        "Fractions of the larger range of both within this time. Differences well above the step "
        "error in the table of steps are due to the models.",
    )
    return Table(f"Tip against {reference}, over the whole run", columns, notes, "whole")


def _spread(
    value: float | None, spread: float | None, decimals: int, factor: float = 1.0, sign: str = ""
) -> str:
    """Return a mean and its spread as text, ``1.058 ± 0.031``; a dash without a value."""
    if value is None or spread is None:
        return NONE
    return (
        with_minus_signs(f"{factor * value:{sign}.{decimals}f}")
        + f" ± {fixed(spread, decimals, factor)}"
    )
