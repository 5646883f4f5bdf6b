# SPDX-License-Identifier: LGPL-3.0-or-later
"""Quantities of each model for sweeps, and their comparison with the limits of a case."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import log, pi

import numpy as np

from protractile.analysis.quantities import MEASURED, Quantity, declared_quantities, records
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.runs.case.limits import LimitsTable, share_of
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.design_results import ModelDesignResults
from protractile.runs.pipeline.summary import ModelSummary
from protractile.runs.pipeline.tipping import foot_of

# Quantities in SI units by name; None if a model has no value.
Quantities = dict[str, float | None]

# Half-width of the settling band over the initial amplitude.
BAND = 0.05
# Last fraction of the run. It gives the final mean, and the tip must stay in the band during it.
FINAL = 0.2
# Relative motion of the tip that counts as round-off, for example in equilibrium.
ROUND_OFF = 1.0e-12
# Fraction of the initial vibration that remains after the decay time.
DECAYED_SHARE = 0.1

# Classes whose annotated fields are quantities, too.
RECORD_CLASSES: list[type] = [*records(ModelDesignResults).values(), ModelSummary]

# Measured, static, dynamic and accuracy quantities.
QUANTITIES = (
    *(
        shown
        for measured in MEASURED.values()
        if measured.swept
        for shown in (
            *(
                [replace(measured, name=f"{measured.name}_at_rest", title=measured.at_rest)]
                if measured.at_rest
                else []
            ),
            measured,
        )
    ),
    Quantity("tip_amplitude", "m", "tip amplitude", shown="mm"),
    Quantity("dynamic_factor", "1", "dynamic factor"),
    Quantity("first_frequency", "Hz", "first frequency"),
    Quantity("decay_time", "s", "decay time to 10 %"),
    Quantity("mass", "kg", "mass"),
    Quantity("settling_time", "s", "settling time"),
    Quantity("drive_force", "N", "largest force of an elastic drive", shown="kN"),
    Quantity("drive_slip", "m", "longest slip on a drive", shown="mm"),
    *(
        quantity
        for kind in RECORD_CLASSES
        for quantity in declared_quantities(kind).values()
        if quantity.name
    ),
)


def decay_time(ratio: float, frequency: float | None) -> float | None:
    """Return the time in s in which a vibration decays to 10 %; None without damping.

    The frequency is in Hz, and None if unknown.
    """
    return (
        log(1.0 / DECAYED_SHARE) / (2.0 * pi * ratio * frequency) if ratio and frequency else None
    )


def settling_time(time: Array, tip: Array) -> float | None:
    """Return the time in s after which the tip stays within ±5 % of its initial amplitude.

    The centre of the band is the mean over the last fifth of the run. The initial amplitude is the
    largest distance from the centre. The result is None if the tip leaves the band during the last
    fifth, which should be longer than the slowest oscillation. Times (num_times,) in s ascend; tip
    deflections are in m.
    """
    last = time >= time[-1] - FINAL * (time[-1] - time[0])
    off = np.abs(tip - tip[last].mean())
    outside = off > max(BAND * off.max(), ROUND_OFF * np.abs(tip).max())
    if outside[last].any():
        return None
    # A tip that never leaves the band settles immediately.
    return float(time[np.flatnonzero(outside)[-1] + 1]) if outside.any() else float(time[0])


@dataclass(frozen=True, slots=True)
class Limit:
    """Smallest or largest permitted value of a quantity."""

    quantity: Quantity
    permitted: float  #: permitted value in SI units
    least: bool = False  #: True for a smallest permitted value
    share: str = ""  #: the share of the boom's length that it is, such as ``2 %``

    def __str__(self) -> str:
        """Return quantity, relation and permitted value: ``tip deflection ≤ 900 mm``."""
        of_length = f" ({self.share} of the length)" if self.share else ""
        relation = "≥" if self.least else "≤"
        return f"{self.quantity.title} {relation} {self.format(self.permitted)}{of_length}"

    def format(self, value: float | None) -> str:
        """Return a value in SI units as text in the displayed unit; empty without a value."""
        unit = self.quantity.shown_unit
        return "" if value is None else f"{self.quantity.factor * value:.4g} {unit}"

    def is_met_by(self, value: float) -> bool:
        """Return True if a value in SI units is within the limit."""
        return value >= self.permitted if self.least else value <= self.permitted


@dataclass(frozen=True, slots=True)
class LimitCheck:
    """Limit, and the values of models and of combinations in SI units."""

    limit: Limit
    values: Mapping[str, float]  #: values of the models
    #: governing value in the combinations that demand the limit, with their name and the limit of
    #: their boom; None without them
    combined: tuple[str, float, Limit] | None = None

    @property
    def decisive(self) -> tuple[str, float, Limit] | None:
        """The first model with a value, the value and its limit; None if no model has one.

        If this is within the limit, but not the value of a combination, that is decisive.
        """
        first = next(((*value, self.limit) for value in self.values.items()), None)
        combined = self.combined
        if first and combined and self.limit.is_met_by(first[1]):
            return first if combined[2].is_met_by(combined[1]) else combined
        return first

    @property
    def holds(self) -> bool:
        """True if the decisive value is within the limit; False without a value."""
        return self.decisive is not None and self.decisive[2].is_met_by(self.decisive[1])


def tip_limit(case: Case, boom: Boom) -> float | None:
    """Return the largest permitted static tip deflection of a boom in m; None without a limit."""
    return None if case.limits is None else case.limits.tip_of(boom.tip - foot_of(boom).x)


def case_limits(case: Case, boom: Boom) -> list[Limit]:
    """Return the limits of a case for its boom."""
    values = {} if case.limits is None else case.limits.model_dump(exclude_none=True)
    shares = {name: value for name, value in values.items() if share_of(value) is not None}
    values |= {name: tip_limit(case, boom) for name in shares}
    least = LimitsTable.LEAST
    return [
        Limit(
            quantity, values[quantity.name], quantity.name in least, shares.get(quantity.name, "")
        )
        for quantity in QUANTITIES
        if quantity.name in values
    ]
