# SPDX-License-Identifier: LGPL-3.0-or-later
"""Comparison of a model with the measured channels of a case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.signal import argrelmin, correlate, correlation_lags

from protractile.geometry.arrays import Array
from protractile.geometry.typography import TO_PERCENT, number
from protractile.runs.case.schema import Case
from protractile.runs.measured.experiment import Experiment
from protractile.runs.measured.keys import Channel
from protractile.runs.measured.residuals import Features, Residuals, even, features_of
from protractile.runs.report.tables import Cell, Table

if TYPE_CHECKING:
    import pandas as pd

# Root mean square of the residuals up to which model and readings agree: the factor of an expanded
# uncertainty of 95 % (Guide to the Expression of Uncertainty in Measurement, 2008).
AGREES = 2.0
# Ratios of units that are often confused, besides 1000, by SI unit; ratio of sizes from which they
# count as equal.
_FACTORS, _NEAR = {"rad": 57.3, "m/s2": 9.81, "1": 1.0e6}, 0.7
# Mean square difference at another time over that without a time offset, below which the clock may
# be wrong; ratio up to which the differences at two times count as equal.
_BETTER, _ALIKE = 0.1, 4.0


class Agreement(NamedTuple):
    """Differences of the model from the readings of a channel, in SI units.

    Curves are compared up to the end of predictability.
    """

    channel: Channel
    until: float  #: end in s of the comparison of curves; infinite without an end
    bias: float  #: mean of model less reading
    rms: float  #: root mean square of the difference
    correlation: float  #: correlation of model and readings; NaN for a single value
    misfit: float  #: root mean square of the residuals, over their uncertainty
    #: features of ``readings`` and ``model`` over the whole record; none for a single value
    features: Mapping[str, Features]
    mistakes: Sequence[str]  #: sentences on a unit or a time offset that may be wrong

    @property
    def agrees(self) -> bool:
        """True if the model differs by no more than the uncertainty explains."""
        return self.misfit <= AGREES


@dataclass(frozen=True)
class Comparison:
    """A model of a case and its measured channels."""

    residuals: Residuals
    values: Array  #: values (num_unknowns,) of the unknowns of the residuals

    @cached_property
    def evaluated(self) -> list[tuple[Channel, Array]]:
        """The channels with their values (num_motions, num_times) by the model."""
        return self.residuals.experiment.evaluate(self.residuals.settings(self.values))

    @cached_property
    def agreements(self) -> list[Agreement]:
        """The differences of each channel."""
        parts, horizons = self.residuals.parts(self.evaluated), self.residuals.horizons
        found = []
        for (channel, (model, *_)), off, end in zip(self.evaluated, parts, horizons, strict=True):
            both = {"readings": channel.readings, "model": model}
            curves, correlation = np.array([*both.values()]), np.nan
            features, misfit = dict[str, Features](), float(np.sqrt(np.mean(off**2)))
            if channel.table is not None:
                described = features_of(channel, curves, self.residuals.cutoff)
                features = dict(zip(both, described, strict=True))
                curves = curves[:, channel.times <= end]
                correlation = float(np.corrcoef(curves)[0, 1])
            apart = curves[1] - curves[0]
            bias, rms = float(apart.mean()), float(np.sqrt(np.mean(apart**2)))
            mistakes = [*likely_mistakes(channel, curves)] if misfit > AGREES else []
            found.append(
                Agreement(channel, end, bias, rms, correlation, misfit, features, mistakes)
            )
        return found

    @property
    def agrees(self) -> bool:
        """True if the model agrees with all channels."""
        return all(agreement.agrees for agreement in self.agreements)

    @property
    def frame(self) -> pd.DataFrame:
        """The differences of all channels in SI units, with features of readings and model."""
        import pandas as pd

        rows = {
            of.channel.name: {
                "quantity": of.channel.quantity, "unit": of.channel.measures.unit,
                "until": of.until, "bias": of.bias, "rms": of.rms, "correlation": of.correlation,
                "misfit": of.misfit,
            } | {
                f"{name}_of_{source}": value
                for source, features in of.features.items()
                for name, value in features._asdict().items()
            }
            for of in self.agreements
        }  # fmt: skip
        return pd.DataFrame.from_dict(rows, orient="index").rename_axis("channel")

    @property
    def tables(self) -> list[Table]:
        """The tables of differences, and of the features of curves if there are any."""
        return [table for table in (self.table(), self.vibrations()) if table.rows]

    def table(self, title: str = "Model and readings") -> Table:
        """Return a table of the differences of all channels."""
        rows: list[tuple[Cell, ...]] = []
        for of in self.agreements:
            factor, unit = of.channel.measures.factor, of.channel.measures.shown_unit
            end = "" if np.isinf(of.until) else f"\nup to {number(of.until)} s"
            bias = None if of.channel.relative else factor * of.bias
            mark, name = "✓" if of.agrees else "✗", f"{of.channel.name}{end}"
            rows.append((name, unit, bias, factor * of.rms, of.correlation, of.misfit, mark))
        notes = [f"caution: {what}" for of in self.agreements for what in of.mistakes]
        notes.append(
            "Bias: mean of model less reading. Misfit: difference over its uncertainty, 1 if "
            f"the model is right; ✓ up to {AGREES:g}."
        )
        if np.isfinite(self.residuals.horizons).any():
            notes.append(
                "Impacts make the motion unpredictable: curves are compared up to the time in the "
                "first column, and the misfit is that of features of the whole motion."
            )
        heads = {"channel": "", "unit": "", "bias": ".3g", "RMS": ".3g"}
        heads |= {"corre-\nlation": ".3f", "misfit": ".2f", "agrees": ""}
        return Table.of_rows(title.lower().replace(" ", "-"), title, heads, rows, notes)

    def vibrations(self) -> Table:
        """Return a table of frequency, decay, peak and parts of the vibration of each channel."""
        rows: list[tuple[Cell, ...]] = []
        for agreement in self.agreements:
            quantity = agreement.channel.measures
            for source, of in agreement.features.items():
                sizes = (of.high - of.low, of.peak, of.slow, of.fast)
                name, decay = f"{agreement.channel.name} ({quantity.shown_unit})", of.decay
                shown = (quantity.factor * size for size in sizes)
                rows.append((name, source, of.frequency, TO_PERCENT * decay, *shown))
        heads = {"channel": "", "of": ""} | dict.fromkeys(
            ("frequency\nHz", "decay\n%", "80 %\nrange", "first\npeak", "slow", "fast"), ".3g"
        )
        notes = [
            "Decay: damping ratio by the heights of the peaks. Slow and fast: standard deviations "
            f"below and above {number(self.residuals.cutoff)} Hz."
        ]
        return Table.of_rows("vibrations", "Vibrations", heads, rows, notes)


def likely_mistakes(channel: Channel, both: Array) -> Iterator[str]:
    """Yield sentences on a unit or a time offset that may be wrong.

    Args:
        channel: a channel.
        both: readings and model (2, num_times) at its first times; (2, 1) of a single value.
    """
    name, single, unit = channel.name, channel.table is None, channel.measures.unit
    read, computed = np.abs(both[:, 0]) if single else np.ptp(both, axis=1)
    ratio = float(read / computed) if read * computed > 0.0 else 1.0
    for factor in {1.0e3, _FACTORS.get(unit, 1.0e3)}:
        if _NEAR * factor < max(ratio, 1.0 / ratio) < factor / _NEAR:
            yield (
                f"{name}: the readings have {number(ratio)} times the size of the model; their "
                f"unit is {unit} unless the heading of the column gives another"
            )
    if single:
        return
    time, curves = even(channel.times[: both.shape[1]], both)
    readings, model = curves
    ones, lags = np.ones(time.size), correlation_lags(time.size, time.size)
    # Mean square differences over the common times, of at least half the record.
    squares = correlate(model**2, ones) + correlate(ones, readings**2)
    off = (squares - 2.0 * correlate(model, readings)) / correlate(ones, ones)
    off = np.where(2 * np.abs(lags) <= time.size, off, np.inf)
    # A model with another frequency fits about as well some periods later.
    least = np.intersect1d(argrelmin(off)[0], np.flatnonzero(off <= _ALIKE * off.min()))
    near = least[np.abs(lags[least]).argmin()] if least.size else off.argmin()
    lag = float(lags[near] * (time[1] - time[0]))
    if off[near] < _BETTER * off[lags == 0][0]:
        yield (
            f"{name}: the readings fit the model {number(abs(lag))} s "
            f"{'later' if lag > 0.0 else 'earlier'}; give time_offset = "
            f"{channel.time_offset + lag:.4g}, or identify measured.time_offset"
        )


def compare(case: Case, model: str | None = None, file: str = "case") -> Comparison:
    """Return the comparison of a model of a case with its measured channels.

    >>> import tomllib
    >>> tables = tomllib.loads((pt.CASES / "paper.toml").read_text())
    >>> hammer = {"name": "hammer", "quantity": "frequency", "value": 2.0, "uncertainty": 0.05}
    >>> comparison = compare(pt.load_case({**tables, "measured": [hammer]}), "kantorovich-5")
    >>> comparison.agrees, comparison.frame.loc["hammer", "bias"].round(2)
    (False, 0.34)

    Args:
        case: a checked case with ``measured``.
        model: name of a beam; the last beam with play unless given.
        file: name of the case in messages.

    Raises:
        BadInput: the case has no measured channel or no beam.
        NumericsError: the model cannot be computed.
    """
    none = np.zeros(0)
    residuals = Residuals.of(Experiment(case, file, model), (), none)
    return Comparison(residuals.with_shared_errors(none), none)
