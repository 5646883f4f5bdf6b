# SPDX-License-Identifier: LGPL-3.0-or-later
"""What can be known of a run's motion, and how its models compare, as tables."""

from __future__ import annotations

from collections.abc import Mapping

from dynamics.predictability.horizon import SHARES
from runs.pipeline.comparisons import DECIDES
from runs.pipeline.results import Results
from runs.pipeline.summary import CommonPeaks, Growth, Levels, ModelSummary, PeaksLevel, Whole
from runs.report.model_tables import horizon
from runs.report.tables import TextTable
from runs.report.theme import NONE, fixed, number, scientific, signed

MILLI = 1.0e3
PERCENT = 100.0

# What a table says of ``limits``.
LIMITS = {
    "physics": "the motion",
    "step": "the step",
    "nothing": "nothing in the run",
}
VARIED = {"load": "loads", "clearance": "clearances", "velocity": "initial velocities"}


def known_tables(results: Results) -> list[TextTable]:
    """What each model's ensembles tell; empty without any."""
    models = results.summary.models
    sampled = {name: model for name, model in models.items() if model.ensemble}
    measured = {name: model.horizons for name, model in models.items() if model.horizons}
    peaks = {
        name: model.ensemble.slow_peaks
        for name, model in models.items()
        if model.ensemble and model.ensemble.slow_peaks
    }
    tables = []
    if sampled:
        tables.append(_horizon_table(results, sampled))
    if measured:
        tables.append(_growth_table(measured))
    if peaks:
        tables.append(_peak_table(peaks))
    return tables


def compared_tables(results: Results) -> list[TextTable]:
    """How the models differ from the reference; empty where nothing is compared."""
    comparisons = results.summary.comparisons
    if comparisons is None:
        return []
    reference = comparisons.reference
    tables = []
    if levels := comparisons.ensembles:
        tables += [
            _pointwise_table(reference, levels),
            _difference_table(reference, levels),
            _distribution_table(reference, levels),
        ]
    if whole := comparisons.whole:
        tables.append(_whole_table(reference, whole))
    return tables


def _horizon_table(results: Results, sampled: Mapping[str, ModelSummary]) -> TextTable:
    duration = results.case.time.duration
    rows = []
    for name, model in sampled.items():
        horizons = [horizon(model, share, duration) for share in SHARES]
        peaks = model.ensemble.slow_peaks if model.ensemble else None
        slow = (NONE, NONE)
        if peaks is not None:
            period = _spread(peaks.period, peaks.period_spread, 3)
            slow = (str(len(peaks.time)), period)
        rows.append((name, *horizons, *slow))
    headings = (
        "model",
        *(f"horizon {PERCENT * share:g} %\ns" for share in SHARES),
        "common slow peaks",
        "period\ns",
    )
    asked = results.summary.ensemble
    assert asked is not None
    notes = [
        f"Ensembles of {asked.members} members, {VARIED[asked.vary]} changed by up to "
        f"{scientific(asked.relative)} of themselves. Horizon: when the members are that part "
        "of the tip's range around one another."
    ]
    if asked.slow_below is not None:
        notes.append(
            f"Slow peaks are those of the motion below {number(asked.slow_below)} Hz; common "
            "ones are those that all members have."
        )
    return TextTable("Horizons", headings, rows, notes, "horizons", ("S2", "S3"))


def _growth_table(measured: Mapping[str, Growth]) -> TextTable:
    sizes = next(iter(measured.values())).relatives
    rows = [
        (
            name,
            f"{PERCENT * share:g} %",
            *(fixed(times[i], 2) for times in found.times),
            fixed(found.of_step[i], 2),
            number(found.rate[i], 2),
            LIMITS[found.limits[i]],
        )
        for name, found in measured.items()
        for i, share in enumerate(found.shares)
    ]
    headings = (
        "model",
        "part of the range",
        *(f"change {scientific(size)}\ns" for size in sizes),
        "finer step\ns",
        "growth\n1/s",
        "limited by",
    )
    notes = (
        "When runs whose data differ by so much of themselves are that part of the tip's range "
        "apart. They part like exp(growth · time): data a thousand times better buy "
        "6.9 / growth.",
        "Finer step: when a run with half the step, or a hundredth of the tolerance, is as far "
        "from the run. Earlier than for the largest of these changes, the step is the limit and a "
        "finer one would help; later, the motion itself is: data are not known as well as that.",
    )
    return TextTable("What better data would buy", headings, rows, notes, "growth")


def _peak_table(peaks: Mapping[str, CommonPeaks]) -> TextTable:
    def cell(found: CommonPeaks, i: int) -> str:
        if i >= len(found.time):
            return NONE
        time = _spread(found.time[i], found.time_spread[i], 3)
        height = _spread(found.height[i], found.height_spread[i], 2, MILLI)
        return f"{time} s\n{height} mm"

    most = max(len(found.time) for found in peaks.values())
    rows = [(str(i + 1), *(cell(found, i) for found in peaks.values())) for i in range(most)]
    notes = (
        "Mean of an ensemble's members ± half the distance between its extremes. A column ends "
        "where not all members have the next peak.",
    )
    return TextTable("Slow peaks", ("peak", *peaks), rows, notes, "slow-peaks", ("S2", "S3"))


def _pointwise_table(reference: str, levels: Mapping[str, Levels]) -> TextTable:
    rows = []
    for name, level in levels.items():
        found = level.pointwise
        shares = (fixed(part, 2, PERCENT) for part in (found.largest, found.rms))
        rows.append((name, fixed(found.until, 2), *shares))
    return TextTable(
        f"Tip against {reference}, from moment to moment",
        ("model", "until\ns", "largest difference\n% of the range", "rms\n% of the range"),
        rows,
        (DECIDES["pointwise"],),
        "pointwise",
        ("S4",),
    )


def _difference_table(reference: str, levels: Mapping[str, Levels]) -> TextTable:
    def cell(found: PeaksLevel, i: int) -> str:
        if i >= len(found.time):
            return NONE
        time = _spread(found.time[i], found.time_spread[i], 0, MILLI, "+")
        height = _spread(found.height[i], found.height_spread[i], 2, MILLI, "+")
        mark = "" if found.explained[i] else " *"
        return f"{time} ms\n{height} mm{mark}"

    peaks = {name: level.peaks for name, level in levels.items()}
    most = max(len(found.time) for found in peaks.values())
    rows = [(str(i + 1), *(cell(found, i) for found in peaks.values())) for i in range(most)]
    notes = (
        f"Each model's slow peak less that of {reference}, ± both spreads together. * beyond them "
        "in time or in height.",
        DECIDES["peaks"],
    )
    title = f"Slow peaks against {reference}"
    return TextTable(title, ("peak", *peaks), rows, notes, "peaks-against", ("S3",))


def _distribution_table(reference: str, levels: Mapping[str, Levels]) -> TextTable:
    rows = []
    for name, level in levels.items():
        found = level.distributions
        pairs = (
            " / ".join(fixed(value, 1, MILLI) for value in reversed(both))
            for both in (found.range, found.mean, found.deviation)
        )
        rows.append((name, fixed(found.since, 2), *pairs, fixed(found.distance, 3)))
    headings = (
        "model", "from\ns", "range\nmm", "mean\nmm", "standard deviation\nmm",
        "Kolmogorov–Smirnov\ndistance",
    )  # fmt: skip
    notes = (
        f"All values of all members after the horizons: the model's / that of {reference}.",
        DECIDES["distributions"],
    )
    title = f"Distribution of the tip against {reference}"
    return TextTable(title, headings, rows, notes, "distributions")


def _whole_table(reference: str, whole: Mapping[str, Whole]) -> TextTable:
    ends = next(iter(whole.values())).until
    rows = [
        (
            name,
            *(
                fixed(parts[i], 2, PERCENT)
                for i in range(len(ends))
                for parts in (found.largest, found.rms)
            ),
        )
        for name, found in whole.items()
    ]
    headings = [
        f"{what}\nto {end:g} s, %" for end in ends for what in ("largest difference", "rms")
    ]
    notes = (
        "Parts of the larger range of both within that time. What is well above the change by half "
        "the step, in the table of steps, is the models' own.",
    )
    title = f"Tip against {reference}, over the whole run"
    return TextTable(title, ("model", *headings), rows, notes, "whole", ("S7",))


def _spread(
    value: float | None, spread: float | None, decimals: int, factor: float = 1.0, sign: str = ""
) -> str:
    """``1.058 ± 0.031``; ``NONE`` where there is no value."""
    if value is None or spread is None:
        return NONE
    return signed(f"{factor * value:{sign}.{decimals}f}") + f" ± {fixed(spread, decimals, factor)}"
