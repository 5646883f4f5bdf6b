# SPDX-License-Identifier: LGPL-3.0-or-later
"""Identification of unknown numbers of a case from its measured channels."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from protractile.analysis.low_pass import AT_REST
from protractile.geometry.arrays import Array
from protractile.geometry.typography import number, percent
from protractile.runs.case import reading
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.measured.compare import AGREES, Comparison
from protractile.runs.measured.experiment import Experiment
from protractile.runs.measured.fit import STEP, Fit, fit, jacobian, profile, regress
from protractile.runs.measured.keys import Channel
from protractile.runs.measured.residuals import Residuals, Target
from protractile.runs.process.bad_input import BadInput
from protractile.runs.report.tables import Cell, Table

if TYPE_CHECKING:
    import pandas as pd

# Number of readings of a possible channel, and their uncertainty as a fraction of their range.
READINGS, UNCERTAINTY = 100, 0.01
# Uncertainty of a tape measure in m.
OF_TAPE = 1.0e-3
# Places of possible gauges as fractions of the length of a segment, and their names.
_PLACES = {"tail": 0.1, "middle": 0.5, "head": 0.9}
# Number of possible channels in the report, and largest ratio of errors with one of them.
MOST_ROWS, HELPS = 8, 0.9


def parse(text: str, file: str) -> tuple[str, tuple[float, float]]:
    """Return the key and the bounds of an option KEY=LOW:HIGH.

    Raises:
        BadInput: the option is invalid.
    """
    key, _, bounds = (part.strip() for part in text.partition("="))
    try:
        low, high = map(float, bounds.split(":"))
    except ValueError:
        what = "not understood; give KEY=LOW:HIGH, such as joint.play=0:0.03"
        raise BadInput(file, f"--unknown {text}", what) from None
    return key, (low, high)


@dataclass(frozen=True)
class Identification:
    """Unknown numbers of a case, identified from its measured channels."""

    keys: Sequence[str]  #: keys of the unknowns
    residuals: Residuals  #: residuals as a function of the unknowns
    start: Array  #: values (num_unknowns,) of the case
    found: Fit  #: values, errors and correlation of the unknowns

    @property
    def before(self) -> Comparison:
        """The comparison of the case as it was given."""
        return Comparison(self.residuals, self.start)

    @cached_property
    def after(self) -> Comparison:
        """The comparison of the identified case."""
        return Comparison(self.residuals, self.found.values)

    @property
    def case(self) -> Case:
        """The case with the identified numbers."""
        experiment = self.residuals.experiment
        own = {name: getattr(experiment.case, name) for name in ("models", "observe", "ensemble")}
        changed = experiment.changed(self.residuals.settings(self.found.values))
        return changed.model_copy(update=own)

    @property
    def frame(self) -> pd.DataFrame:
        """A row for each unknown in the units of the case: value, standard error, bounds, marks."""
        import pandas as pd

        columns = {
            "value": self.found.values, "error": self.found.errors, "before": self.start,
            "low": self.found.low, "high": self.found.high, "determined": self.found.determined,
        }  # fmt: skip
        return pd.DataFrame(columns, index=[*self.keys])

    @property
    def correlation(self) -> pd.DataFrame:
        """The correlation between the unknowns."""
        import pandas as pd

        return pd.DataFrame(self.found.correlation, [*self.keys], [*self.keys])

    def profile(self, key: str) -> tuple[Array, Array]:
        """Return values of an unknown, and the increase of χ²; 3.84 bounds the interval of 95 %.

        All other unknowns are fitted to each value.
        """
        return profile(self.residuals, self.found, self.keys.index(key))

    @cached_property
    def helpful(self) -> list[tuple[str, Array]]:
        """Channels that would help, and the errors that they leave as fractions of those without.

        The first ones help most.
        """
        experiment, span = self.residuals.experiment, self.found.high - self.found.low
        own, channels = experiment.case, experiment.channels
        possible = [*_possible_channels(own, any(channel.relative for channel in channels))]
        wider = own.model_copy(update={"measured": (*channels, *possible)})
        other = Experiment(wider, experiment.file, experiment.model, experiment.keys)

        def compute(u: Array) -> Array:
            values = self.found.low + span * u
            parts = other.evaluate(self.residuals.settings(values))[-len(possible) :]
            return np.concatenate([part[0] for _, part in parts])

        u = (self.found.values - self.found.low) / span
        sizes = [len(channel.table or (0,)) for channel in possible]
        ends = np.cumsum(sizes)[:-1]
        at, slopes = (np.split(part, ends) for part in (compute(u), jacobian(compute, u, STEP)))
        systematic = max(channel.systematic for channel in channels)
        alone = np.diag(self.found.covariance_with())
        tip = at[[channel.name for channel in possible].index("tip over time")]
        # At rest, records have the range of round-off.
        moving = np.ptp(tip) > AT_REST * np.abs(tip).max()
        helpful = []
        for channel, values, slope in zip(possible, at, slopes, strict=True):
            size = UNCERTAINTY * (np.abs(values).max() if channel.value == 0.0 else np.ptp(values))
            size = OF_TAPE if channel.value == 0.0 and channel.measures.unit == "m" else size
            if size > 0.0 and (moving or channel.value is not None):
                known = {"uncertainty": size, "systematic": systematic}
                sized = channel.model_copy(update=known)
                target = Target.of_readings(sized).with_shared_errors(sized, values[None])
                left = self.found.covariance_with(target.reduce(slope / size))
                helpful.append((channel.name, np.sqrt(np.diag(left) / alone)))
        helpful = [entry for entry in helpful if entry[1].min() < HELPS]
        return sorted(helpful, key=lambda entry: float(entry[1].min()))

    @property
    def tables(self) -> list[Table]:
        """The tables of unknowns, their correlation, the fit, and what else to measure."""
        several = [self.correlation_table()] if len(self.keys) > 1 else []
        further = [self.helpful_table()] if self.helpful else []
        return [self.table(), *several, self.after.table(), *further]

    @property
    def headings(self) -> Sequence[str]:
        """The last parts of the keys as headings, or the keys where these are not unique."""
        short = [key.rpartition(".")[2].replace("_", "\n") for key in self.keys]
        return short if len({*short}) == len(short) else self.keys

    def table(self) -> Table:
        """Return a table of the unknowns with their standard errors."""
        found, rows = self.found, list[tuple[Cell, ...]]()
        for k, key in enumerate(self.keys):
            marks = ["not determined by the readings"] * (not found.determined[k])
            marks += ["at its bound"] * bool(found.at_bound[k])
            error = found.errors[k] if found.determined[k] else None
            value = found.values[k]
            part = None if error is None or value == 0.0 else 100.0 * error / abs(value)
            unit = self.residuals.experiment.number(key)[1]
            rows.append((key, unit, self.start[k], value, error, part, "\n".join(marks)))
        notes = [
            f"{found.agreeing} of {found.starts.size} starts reach this minimum. The misfit of all "
            f"readings is {number(found.misfit)}, 1 for a right model."
        ]
        if found.misfit > 1.0:
            notes.append("The standard errors are already multiplied by this factor.")
        if found.misfit > AGREES:
            notes.append(
                "The model does not explain the readings: do not trust these numbers. Identify "
                "from the tip alone first, from more starts, or with further unknowns."
            )
        if not any(channel.systematic for channel in self.residuals.experiment.channels):
            notes.append(
                "The errors are those of independent readings: systematic says how far readings "
                "and model share an error."
            )
        for name, ratios in self.helpful[:1]:
            left = f"{percent(ratios.min(), 2)} of the error of {self.keys[int(ratios.argmin())]}"
            notes.append(f"One more channel, {name}, would leave {left}.")
        if not self.helpful:
            notes.append(f"No other channel would leave less than {percent(HELPS)} of an error.")
        heads = {"unknown": "", "unit": ""} | dict.fromkeys(("case", "identified"), ".4g")
        heads |= dict.fromkeys(("standard\nerror", "in %"), ".2g") | {"": ""}
        return Table.of_rows("unknowns", "Identified numbers", heads, rows, notes)

    def correlation_table(self) -> Table:
        """Return a table of the correlation between the unknowns."""
        rows = [(key, *row) for key, row in zip(self.keys, self.found.correlation, strict=True)]
        heads = {"": ""} | dict.fromkeys(self.headings, ".2f")
        return Table.of_rows("correlation", "Correlation of the unknowns", heads, rows)

    def helpful_table(self) -> Table:
        """Return a table of the channels that would determine the unknowns better."""
        rows: list[tuple[Cell, ...]] = [
            (name, *of.tolist()) for name, of in self.helpful[:MOST_ROWS]
        ]
        notes = [
            f"Standard error of each unknown with {READINGS} readings of one more channel over the "
            f"error without it. The uncertainty of a reading is {percent(UNCERTAINTY)} of the "
            "range, of a tape measure 1 mm."
        ]
        heads = {"one more channel": ""} | dict.fromkeys(self.headings, ".2f")
        return Table.of_rows("helpful", "What else to measure", heads, rows, notes)


def _possible_channels(case: Case, relative: bool) -> Iterator[Channel]:
    """Yield channels that could be measured: over time, ``relative`` or not, and single values."""
    times, boom = np.linspace(0.0, case.time.duration, READINGS).tolist(), build_boom(case)
    over_time: dict[str, Any] = {"table": [(time, 0.0) for time in times], "relative": relative}
    kinds: dict[str, dict[str, Any]] = {
        f"{quantity} at {place} of {segment.name}": over_time
        | {"quantity": quantity, "segment": segment.name,
           "x": segment.start + part * segment.length}
        for segment, (place, part) in product(boom.segments, _PLACES.items())
        for quantity in ("strain", "rotation", "acceleration")
        if (segment.section is not None if quantity == "strain" else place == "head")
    }  # fmt: skip
    for k in range(1, 1 + len(boom.cylinders)):
        kinds[f"force of cylinder {k}"] = over_time | {"quantity": "cylinder_force", "number": k}
    kinds["tip over time"] = over_time | {"quantity": "tip"}
    kinds["tip at rest"] = {"quantity": "tip", "value": 0.0}
    kinds["first frequency"] = {"quantity": "frequency", "value": 0.0}
    kinds["free travel"] = {"quantity": "free_travel", "value": 0.0}
    for name, keys in kinds.items():
        yield Channel.model_validate({"name": name, "uncertainty": 1.0, **keys})


def identify(
    case: Case,
    unknown: Mapping[str, tuple[float, float]],
    model: str | None = None,
    *,
    starts: int = 4,
    file: str = "case",
    progress: Callable[[float], None] = lambda part: None,
) -> Identification:
    """Identify unknown numbers of a case by bounded least squares from its measured channels.

    >>> import tomllib
    >>> tables = tomllib.loads((pt.CASES / "paper.toml").read_text())
    >>> hammer = {"name": "hammer", "quantity": "frequency", "value": 2.0, "uncertainty": 0.05}
    >>> case = pt.load_case({**tables, "measured": [hammer]})
    >>> unknown = {"segment[1].second_moment_of_area": (2.0e-4, 8.0e-4)}
    >>> found = identify(case, unknown, "kantorovich-5", starts=1)
    >>> found.frame[["value", "error"]].round(6).values
    array([[2.76e-04, 1.40e-05]])

    Args:
        case: a checked case with ``measured``.
        unknown: lower and upper bound by key, in the units of the case; also
            ``measured.time_offset``.
        model: name of a beam; the last beam with play unless given.
        starts: number of searches; the first one starts from the numbers of the case.
        file: name of the case in messages.
        progress: callback that receives the completed fraction, 0 to 1.

    Raises:
        BadInput: a key or a bound is invalid, or the channels do not fit the case.
        NumericsError: the model cannot be computed anywhere between the bounds.
    """
    for key, (least, most) in unknown.items():
        if not (np.isfinite([least, most]).all() and least < most):
            what = f"must have a lower bound below the upper one, got {least:g} and {most:g}"
            raise BadInput(file, f"--unknown {key}", what)
    keys = [*unknown]
    low, high = np.array([*unknown.values()], dtype=float).T
    experiment = Experiment(case, file, model, keys)
    start = np.array([experiment.number(key)[0] for key in keys])
    start = np.where(np.isfinite(start), np.clip(start, low, high), 0.5 * (low + high))
    for k, bound in product(range(len(keys)), (low, high)):
        values = np.where(np.arange(len(keys)) == k, bound, start)
        try:
            reading.check(experiment.changed(dict(zip(keys, values.tolist(), strict=True))), file)
        except BadInput as fault:
            what = f"{bound[k]:g} is not valid: {fault.what}"
            raise BadInput(file, f"--unknown {keys[k]}", what) from None
    first = Residuals.of(experiment, keys, start)
    # Features guide a single search on a chaotic motion; several searches tell its curves apart.
    first, windows = (first.of_curves, first.windows) if starts > 1 else (first, [])
    found = fit(first, low, high, start, starts, progress, first.step, windows)
    # Near the solution it is known what errors the readings share, and which motions are chaotic.
    residuals = Residuals.of(experiment, keys, found.values).with_shared_errors(found.values)
    if residuals.rough:
        again = regress(residuals, low, high, found.values, residuals.step)
    else:
        again = fit(residuals, low, high, found.values, 1, progress)
    return Identification(keys, residuals, start, replace(again, starts=found.starts))
