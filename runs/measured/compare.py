# SPDX-License-Identifier: LGPL-3.0-or-later
"""Comparison of a model with the measured channels of a case."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.typography import TO_PERCENT, number
from protractile.runs.case.schema import Case
from protractile.runs.measured.experiment import Experiment
from protractile.runs.measured.keys import Channel
from protractile.runs.measured.residuals import Residuals, features_of
from protractile.runs.measured.signals import Features
from protractile.runs.report.tables import Cell, Table

if TYPE_CHECKING:
    import pandas as pd

# Root mean square of the residuals up to which model and readings agree: the factor of an expanded
# uncertainty of 95 % (Guide to the Expression of Uncertainty in Measurement, 2008).
AGREES = 2.0
# What features belong to.
_SOURCES = "readings", "model"


class Agreement(NamedTuple):
    """Differences of the model from the readings of a channel, in SI units.

    Curves are compared up to the end of predictability.
    """

    channel: str  #: name of the channel
    quantity: str  #: measured quantity
    unit: str  #: its SI unit
    until: float  #: end in s of the comparison of curves; infinite without an end
    bias: float  #: mean of model less reading
    rms: float  #: root mean square of the difference
    correlation: float  #: correlation of model and readings; NaN for a single value
    misfit: float  #: root mean square of the residuals, over their uncertainty
    #: features of readings and model over the whole record; none for a single value
    features: Sequence[Features]

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
        return [*self._agreements()]

    def _agreements(self) -> Iterator[Agreement]:
        parts, horizons = self.residuals.parts(self.evaluated), self.residuals.horizons
        for (channel, (model, *_)), off, end in zip(self.evaluated, parts, horizons, strict=True):
            readings, correlation, features = channel.readings, np.nan, list[Features]()
            compared = np.full(readings.size, True)
            if channel.table is not None:
                compared = channel.times <= end
                correlation = float(np.corrcoef(model[compared], readings[compared])[0, 1])
                both = np.array([readings, model])
                features = features_of(channel, both, self.residuals.cutoff)
            apart = (model - readings)[compared]
            yield Agreement(
                channel.name, channel.quantity, channel.measures.unit, end, float(apart.mean()),
                float(np.sqrt(np.mean(apart**2))), correlation,
                float(np.sqrt(np.mean(off**2))), features,
            )  # fmt: skip

    @property
    def agrees(self) -> bool:
        """True if the model agrees with all channels."""
        return all(agreement.agrees for agreement in self.agreements)

    @property
    def frame(self) -> pd.DataFrame:
        """The differences of all channels in SI units, with features of readings and model."""
        import pandas as pd

        rows = [
            agreement._replace(features=())._asdict()
            | {
                f"{name}_of_{source}": value
                for source, found in zip(_SOURCES, agreement.features, strict=False)
                for name, value in found._asdict().items()
            }
            for agreement in self.agreements
        ]
        return pd.DataFrame(rows).drop(columns="features").set_index("channel")

    def table(self, title: str = "Model and readings") -> Table:
        """Return a table of the differences of all channels."""
        rows: list[tuple[Cell, ...]] = []
        for agreement, (channel, _) in zip(self.agreements, self.evaluated, strict=True):
            factor, unit = channel.measures.factor, channel.measures.shown_unit
            end = "" if np.isinf(agreement.until) else f"\nup to {number(agreement.until)} s"
            rows.append(
                (
                    f"{agreement.channel}{end}",
                    unit,
                    None if channel.relative else factor * agreement.bias,
                    factor * agreement.rms,
                    None if np.isnan(agreement.correlation) else agreement.correlation,
                    agreement.misfit,
                    "✓" if agreement.agrees else "✗",
                )
            )
        notes = [
            "Bias: mean of model less reading. Misfit: difference over its uncertainty, 1 if "
            f"the model is right; ✓ up to {AGREES:g}."
        ]
        if np.isfinite(self.residuals.horizons).any():
            notes.append(
                "Impacts make the motion unpredictable: curves are compared up to the time in the "
                "first column, and the misfit is that of features of the whole motion."
            )
        heads = {"channel": "", "unit": "", "bias": ".3g", "RMS": ".3g"}
        heads |= {"corre-\nlation": ".3f", "misfit": ".2f", "agrees": ""}
        return Table.of_rows("measured", title, heads, rows, notes)

    def vibrations(self) -> Table:
        """Return a table of frequency, decay, peak and parts of the vibration of each channel."""
        rows: list[tuple[Cell, ...]] = []
        for agreement, (channel, _) in zip(self.agreements, self.evaluated, strict=True):
            factor, unit = channel.measures.factor, channel.measures.shown_unit
            for source, of in zip(_SOURCES, agreement.features, strict=False):
                sizes = (factor * size for size in (of.high - of.low, of.peak, of.slow, of.fast))
                rows.append(
                    (
                        f"{channel.name} ({unit})",
                        source,
                        of.frequency,
                        TO_PERCENT * of.decay,
                        *sizes,
                    )
                )
        heads = {"channel": "", "of": ""} | dict.fromkeys(
            ("frequency\nHz", "decay\n%", "80 %\nrange", "first\npeak", "slow", "fast"), ".3g"
        )
        notes = [
            "Decay: damping ratio by the heights of the peaks. Slow and fast: standard deviations "
            f"below and above {number(self.residuals.cutoff)} Hz."
        ]
        return Table.of_rows("vibrations", "Vibrations", heads, rows, notes)


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
        BadInput: the case has no measured channel or no beam, or a channel does not fit it.
        NumericsError: the model cannot be computed.
    """
    none = np.zeros(0)
    residuals = Residuals.of(Experiment(case, file, model), (), none)
    return Comparison(residuals.with_shared_errors(none), none)
