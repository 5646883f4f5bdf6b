# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cells of a load chart: the largest payload at a radius for which all proofs hold.

The tip hangs at the radius under the rated load, with factors 1: its deflection by play, plates
and bending moves it, so that the luffing angle follows from the payload. The payload is the root of
the governing utilisation = 1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any, NamedTuple

import numpy as np

from protractile.analysis.proofs import governing
from protractile.analysis.quantities import PROVED
from protractile.analysis.rows import COMBINATION, Row, Rows
from protractile.analysis.states import States
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.ground import force_name
from protractile.geometry.typography import percent
from protractile.runs.case.build import build_boom, telescoped_joints
from protractile.runs.case.combination_tables import (
    LoadCaseTable,
)
from protractile.runs.case.combinations import combine
from protractile.runs.case.load_tables import (
    TelescopingTable,
)
from protractile.runs.case.schema import Case
from protractile.runs.chart.keys import ChartTable, Keys
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.combinations import CombinationState, combination_states
from protractile.runs.pipeline.proofs import proofs_of
from protractile.runs.pipeline.statics import boom_with_play
from protractile.runs.pipeline.tipping import LuffedPoint, hook_point, luffed_point

# Deviation of the radius in m at which the luffing angle is found, most steps to find it, and most
# proofs that are followed to a capacity.
_RADIUS, _STEPS, _MOST_PROOFS = 2.0e-5, 30, 8
# Reasons without a proof that limit a capacity.
LARGEST, OUT_OF_REACH = "largest payload", "out of reach"
NO_EQUILIBRIUM, STROKE = "no equilibrium", "stroke of the cylinder"

# Largest distance of a governing utilisation below 1, the utilisation that is sought, smallest
# relative step of the payload towards it and towards the limit of reach, and the fraction of the
# largest payload that is tried first.
_ACCURACY, _AIM, _STEP, _REACH, _FIRST = 1.0e-6, 1.0 - 3.0e-7, 1.0e-7, 5.0e-4, 0.02


class Configuration(NamedTuple):
    """Extensions of the joints of a boom."""

    extension: Mapping[str, float]  #: extension in m by inner segment
    length: float  #: length in m from the foot pin to the tip, along the boom


@dataclass(frozen=True, slots=True)
class Cell:
    """Rated capacity of a boom at a radius."""

    configuration: Configuration  #: the configuration
    radius: float  #: horizontal distance in m of the loaded tip from the slewing axis
    #: capacity in kg, or the rated payload of the chart; None if there is none
    capacity: float | None = None
    reason: str = ""  #: why there is no larger capacity; empty if the governing proof limits it
    angle: float | None = None  #: luffing angle in degrees
    height: float | None = None  #: height of the tip in m
    tip: float | None = None  #: tip deflection in m under the rated load and the wind, factors 1
    droop: float | None = None  #: increase of the radius in m by the tip deflection
    #: largest force of the first cylinder in N under the rated load
    cylinder_force: float | None = None
    #: governing proof of each kind, the governing one first
    proofs: tuple[Row, ...] = ()

    @property
    def length(self) -> float:
        """The length in m from the foot pin to the tip."""
        return self.configuration.length

    @property
    def governing(self) -> Row | None:
        """The governing proof; None if another reason limits the capacity."""
        return None if self.reason else self.proofs[0]

    @property
    def combination(self) -> str:
        """The combination of the governing proof."""
        return "" if self.governing is None else self.governing.state.removeprefix(COMBINATION)


# Combination with its load case, and kind of a proof.
_Key = tuple[str, str]


def _key(row: Row) -> _Key:
    return row.state.removeprefix(COMBINATION), row.quantity


class NoCapacityError(Exception):
    """A boom that cannot carry a payload at a radius; its text is the reason."""


@dataclass
class Search:
    """Search for the capacity of a configuration at a radius in m, or at a luffing angle."""

    case: Case  #: case with a chart
    configuration: Configuration  #: the configuration
    #: horizontal distance in m of the loaded tip from the slewing axis; of the straight boom for a
    #: luffing angle
    radius: float
    angle: float | None = None  #: luffing angle in degrees; None if it follows from the radius
    #: load case and rated state by payload in kg
    points: dict[float, tuple[LoadCaseTable, States]] = field(default_factory=dict)
    #: states of a combination by payload in kg and name
    combined: dict[tuple[float, str], list[CombinationState]] = field(default_factory=dict)
    #: tip deflection in m by payload in kg, to begin with as expected
    tips: dict[float, float] = field(default_factory=dict)
    #: change of the tip deflection less its guess, over the change of the guess
    slope: float = -1.0

    @cached_property
    def boom(self) -> Boom:
        """The boom with the extensions of the case."""
        return build_boom(self.case)

    def cell(self, near: Cell | None = None) -> Cell:
        """Return the cell; the search begins at the capacity of a cell ``near``, if it is given."""
        chart = chart_of(self.case)
        try:
            if chart.payload is not None:
                return self._with_payload(chart.payload, "", self._proofs(chart.payload))
            first = _FIRST * chart.largest_payload
            if near is not None and near.capacity:
                # The moment of the payload and the deflection change less than the payload.
                first = min(near.capacity * near.radius / self.radius, chart.largest_payload)
                self.tips[first] = near.tip or 0.0
            followed = _key(self._proofs(0.0)[0]) if near is None else _key(near.proofs[0])
            for _ in range(_MOST_PROOFS):
                payload, reason = self._root(first, followed)
                found = self._proofs(payload)
                if (found[0].utilisation or 0.0) <= 1.0 + _ACCURACY:
                    return self._with_payload(payload, reason, found)
                first, followed = max(payload, 1.0), _key(found[0])
            raise NoCapacityError(NO_EQUILIBRIUM)
        except NoCapacityError as error:
            return Cell(self.configuration, self.radius, reason=str(error))

    def _with_payload(self, capacity: float, reason: str, found: Rows) -> Cell:
        proofs: dict[str, Row] = {}
        for row in found:
            proofs.setdefault(row.quantity, row)
        table, states = self.points[capacity]
        assert table.angle is not None
        tip, name = _tip(states), force_name(1)
        radius, height = hook_point(self.case, states.boom, tip).at(table.angle)
        straight, _ = hook_point(self.case, states.boom).at(table.angle)
        force = float(max(states.observed(name), key=abs)) if states.boom.cylinders else None
        return Cell(
            self.configuration, self.radius if self.angle is None else radius, capacity, reason,
            table.angle, height, tip, radius - straight, force, tuple(proofs.values()),
        )  # fmt: skip

    def _root(self, first: float, followed: _Key) -> tuple[float, str]:
        """Return the largest payload in kg for which one proof holds, and what else limits it.

        Raises:
            NoCapacityError: the proof does not hold without payload, or with any.
        """
        from scipy.optimize import brentq

        largest = chart_of(self.case).largest_payload
        tried, failures = set[float](), dict[float, str]()

        @cache
        def excess(payload: float) -> float:
            tried.add(payload)
            try:
                proofs = self._proofs(payload, followed)
                utilisation = max((row.utilisation or 0.0 for row in proofs), default=0.0)
                # On the safe side, a proof within the accuracy below 1 counts as the root.
                return 0.0 if -_ACCURACY <= utilisation - 1.0 <= 0.0 else utilisation - _AIM
            except NoCapacityError as error:
                failures[payload] = str(error)
                return 1.0

        # Brackets grow from the first payload, faster and faster. The payload causes two thirds of
        # a typical utilisation.
        low, high, factor = first, first, 1.0 / (1.0 + 2.0 * abs(excess(first)))
        while excess(low) > 0.0:
            if low == 0.0:
                what = f"{PROVED[followed[1]].title} {percent(1.0 + excess(0.0))} without payload"
                raise NoCapacityError(failures.get(0.0, what))
            low, high, factor = low * factor if low > 1.0 else 0.0, low, factor**2
        while excess(high) < 0.0:
            if high == largest:
                return largest, LARGEST
            low, high, factor = high, min(high / factor, largest), factor**2
        while high in failures and high - low > _REACH * high:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
        if high not in failures:
            brentq(excess, low, high, xtol=_STEP * high, rtol=_STEP)
        capacity = max(payload for payload in tried if excess(payload) <= 0.0)
        if not capacity:
            # The wind meets any load.
            raise NoCapacityError(f"{PROVED[followed[1]].title} with any payload")
        beyond = [payload for payload in tried if payload > capacity]
        return capacity, failures.get(min(beyond, default=0.0), "")

    def _proofs(self, payload: float, followed: _Key | None = None) -> Rows:
        """Return the governing proofs with a payload in kg, the governing one first.

        With ``followed``, only one kind of proof in one combination is computed.

        Raises:
            NoCapacityError: the tip cannot stand at the radius, or there is no equilibrium.
        """
        case = combined_case(self.case, self.point(payload)[0])
        rows, kinds = list[Row](), None if followed is None else [followed[1]]
        for combination in case.combinations:
            if followed is not None and not followed[0].startswith(f"{combination.name}, "):
                continue
            at, single = (payload, combination.name), {"combinations": (combination,)}
            try:
                if at not in self.combined:
                    self.combined[at] = combination_states(case.model_copy(update=single))
                rows += [
                    row for state in self.combined[at] for row in proofs_of(state, case, kinds)
                ]
            except NUMERICAL_ERRORS:
                raise NoCapacityError(NO_EQUILIBRIUM) from None
        return governing(rows)

    def point(self, payload: float) -> tuple[LoadCaseTable, States]:
        """Return the load case with a payload in kg and its rated state, with the tip in place.

        The fixed-point iteration over the tip deflection has secant steps.

        Raises:
            NoCapacityError: no luffing angle leads to the radius, or there is no equilibrium.
        """
        if payload in self.points:
            return self.points[payload]
        guess, last = self._expected(payload), None
        for _ in range(_STEPS):
            table, states = self._rated(payload, guess)
            assert table.angle is not None
            found = _tip(states)
            reached, _ = hook_point(self.case, states.boom, found).at(table.angle)
            if self.angle is not None or abs(reached - self.radius) < _RADIUS:
                self.points[payload], self.tips[payload] = (table, states), found
                return table, states
            if last is not None and guess != last[0]:
                self.slope = min(-0.5, max(-2.0, (found - guess - last[1]) / (guess - last[0])))
            last = guess, found - guess
            guess -= last[1] / self.slope
        raise NoCapacityError(NO_EQUILIBRIUM)

    def _expected(self, payload: float) -> float:
        """Return the tip deflection in m that the two nearest payloads let expect."""
        nearest = sorted(self.tips.items(), key=lambda known: abs(known[0] - payload))[:2]
        if len(nearest) < 2:
            return nearest[0][1] if nearest else 0.0
        (one, first), (other, second) = nearest
        return first + (second - first) * (payload - one) / (other - one)

    def _rated(self, payload: float, tip: float) -> tuple[LoadCaseTable, States]:
        """Return the load case whose tip would be at the radius with this deflection in m."""
        extension = self.configuration.extension
        table = load_case_of(self.case, payload, extension, self._angle(tip))
        rated = combine(self.case, table)
        try:
            boom = build_boom(rated)
        except BoomError:
            # The checked boom of the case differs only in the lengths of its cylinders.
            raise NoCapacityError(STROKE) from None
        try:
            with np.errstate(all="ignore"):
                return table, static_states(rated, boom_with_play(rated, boom))
        except NUMERICAL_ERRORS:
            raise NoCapacityError(NO_EQUILIBRIUM) from None

    def _angle(self, tip: float) -> float:
        """Return the luffing angle in degrees that leads to the radius with this deflection in m.

        Raises:
            NoCapacityError: the radius is out of reach.
        """
        if self.angle is not None:
            return self.angle
        angle = hook_of(self.case, self.boom, self.configuration, tip).angle(self.radius)
        least, most = chart_of(self.case).angles
        if angle is None or not least <= angle <= most:
            raise NoCapacityError(OUT_OF_REACH)
        return angle


def solve(case: Case, configuration: Configuration) -> list[Cell]:
    """Return the cells of a configuration at all radii or luffing angles of the chart."""
    chart = chart_of(case)
    searches = [Search(case, configuration, radius) for radius in chart.radii]
    for angle in chart.luffing:
        straight, _ = hook_of(case, build_boom(case), configuration).at(angle)
        searches.append(Search(case, configuration, straight, angle))
    cells: list[Cell] = []
    near = None
    for search in searches:
        cells.append(search.cell(near))
        near = cells[-1] if cells[-1].proofs else near
    return cells


def chart_of(case: Case) -> ChartTable:
    """Return the table of the chart of a case that has one."""
    assert isinstance(case, Keys)
    assert case.chart is not None
    return case.chart


def load_case_of(
    case: Case, payload: float, extension: Mapping[str, float], angle: float
) -> LoadCaseTable:
    """Return the load case of the chart with a payload in kg, extensions in m and an angle."""
    name = chart_of(case).load_case
    (table,) = (one for one in case.load_cases if one.name == name)
    changes: dict[str, Any] = {"payload": payload, "angle": angle}
    if extension:
        changes |= {"extension": {**table.extension, **extension}, "telescoped": None}
    return table.model_copy(update=changes)


def combined_case(case: Case, table: LoadCaseTable) -> Case:
    """Return the case with one load case, in the combinations of the chart."""
    names = chart_of(case).combinations
    combinations = tuple(
        one.model_copy(update={"load_cases": None})
        for one in case.combinations
        if (table.name in (one.load_cases or [table.name]) if names is None else one.name in names)
    )
    changes = {"load_cases": (table,), "combinations": combinations, "spectra": ()}
    return case.model_copy(update=changes)


def configurations(case: Case, boom: Boom) -> Iterator[Configuration]:
    """Yield the configurations of the chart; ``boom`` has the extensions of the case.

    Raises:
        ValueError: a length is not between that of the retracted boom and that of the case.
    """
    chart, length = chart_of(case), luffed_point(case, boom, boom.tip, 0.0).along
    shortest = length - sum(_extensions(case).values())
    extensions = [*chart.extensions, *(_telescoped(case, part) for part in chart.telescoped)]
    for extension in extensions or ([] if chart.lengths else [{}]):
        own = _extensions(combine(case, load_case_of(case, 0.0, extension, 0.0)))
        yield Configuration(extension, shortest + sum(own.values()))
    if not chart.lengths:
        return
    least, most = (shortest + sum(_telescoped(case, part).values()) for part in (0.0, 1.0))
    for number, length in enumerate(chart.lengths, start=1):
        if not least - _RADIUS <= length <= most + _RADIUS:
            raise ValueError(
                f"chart.lengths[{number}]: must be from {least:g} m, with all segments retracted, "
                f"to {most:g} m, got {length:g} m"
            )
        part = min(max(0.0, (length - least) / (most - least or 1.0)), 1.0)
        yield Configuration(_telescoped(case, part), length)


def hook_of(case: Case, boom: Boom, configuration: Configuration, tip: float = 0.0) -> LuffedPoint:
    """Return the place of the load of a configuration with a tip deflection in m.

    ``boom`` has the extensions of the case.
    """
    hook, end = hook_point(case, boom, tip), luffed_point(case, boom, boom.tip, 0.0)
    return hook._replace(along=hook.along + configuration.length - end.along)


def _telescoped(case: Case, part: float) -> dict[str, float]:
    """Return the extensions in m by inner segment at a fraction of the stroke."""
    table = (case.telescoping or TelescopingTable()).model_copy(update={"extension": part})
    return _extensions(case.model_copy(update={"telescoping": table}))


def _extensions(case: Case) -> dict[str, float]:
    """Return the extensions in m of a case by inner segment."""
    joints = telescoped_joints(case)
    return {one.inner: one.extension for one in joints if one.extension is not None}


def _tip(states: States) -> float:
    """Return the lowest tip deflection in m."""
    return float(states.observed("tip").min())
