# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cells of a load chart: the largest payload at a radius for which all proofs hold.

The tip hangs at the radius under the rated load, with factors 1: its deflection by play, plates
and bending moves it, so that the luffing angle follows from the payload. The payload is the root of
the governing utilisation = 1.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import acos, atan2, degrees, hypot
from typing import NamedTuple

import numpy as np

from protractile.analysis.proofs import governing
from protractile.analysis.rows import COMBINATION, Row, Rows
from protractile.analysis.states import States
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.geometry.boom import Boom
from protractile.geometry.cylinder import force_name
from protractile.geometry.typography import percent
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import combine
from protractile.runs.case.load_tables import LoadCaseTable
from protractile.runs.case.schema import Case
from protractile.runs.chart.keys import ChartTable
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.combinations import combination_states
from protractile.runs.pipeline.proofs import proofs_of
from protractile.runs.pipeline.statics import boom_with_play
from protractile.runs.pipeline.tipping import foot_of, hook_place

# Deviation of the radius in m at which the luffing angle is found, and most steps to find it.
_RADIUS, _STEPS = 1.0e-6, 30
# Reasons without a proof that limit a capacity.
LARGEST, OUT_OF_REACH, NO_EQUILIBRIUM = "largest payload", "out of reach", "no equilibrium"

# Relative error of a capacity, and the fraction of the largest payload that is tried first.
_ACCURACY, _FIRST = 2.0e-7, 0.02


class Configuration(NamedTuple):
    """Extensions of the joints of a boom."""

    extension: Mapping[str, float]  #: extension in m by inner segment
    length: float  #: length in m from the foot pin to the tip


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
    tip: float | None = None  #: tip deflection in m under the rated load
    droop: float | None = None  #: increase of the radius in m by the tip deflection
    cylinder_force: float | None = None  #: force of the first cylinder in N under the rated load
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


class NoCapacityError(Exception):
    """A boom that cannot carry a payload at a radius; its text is the reason."""


@dataclass
class Search:
    """Search for the capacity of a configuration at a radius in m."""

    case: Case  #: case with a chart
    configuration: Configuration  #: the configuration
    radius: float  #: horizontal distance in m of the loaded tip from the slewing axis
    #: load case and rated state by payload in kg
    points: dict[float, tuple[LoadCaseTable, States]] = field(default_factory=dict)
    _utilisations: dict[float, float] = field(default_factory=dict)
    _failures: dict[float, str] = field(default_factory=dict)

    def cell(self, first: float | None = None) -> Cell:
        """Return the cell; the search begins with the payload ``first`` in kg, if it is given."""
        chart = chart_of(self.case)
        try:
            if chart.payload is not None:
                return self._with_payload(chart.payload, "")
            empty = self._proofs(0.0)[0]
            if (empty.utilisation or 0.0) > 1.0:
                what = f"{empty.of.title} {percent(empty.utilisation or 0.0, 3)} without payload"
                raise NoCapacityError(what)
            self._root(first or _FIRST * chart.largest_payload)
            return self._largest()
        except NoCapacityError as error:
            return Cell(self.configuration, self.radius, reason=str(error))

    def _largest(self) -> Cell:
        """Return the cell of the largest payload that was tried and for which all proofs hold."""
        capacity = max(one for one, part in self._utilisations.items() if part <= 1.0 + _ACCURACY)
        larger = [one for one in self._utilisations if one > capacity]
        return self._with_payload(
            capacity, self._failures.get(min(larger), "") if larger else LARGEST
        )

    def _with_payload(self, capacity: float, reason: str) -> Cell:
        proofs: dict[str, Row] = {}
        for row in self._proofs(capacity):
            proofs.setdefault(row.quantity, row)
        table, states = self.points[capacity]
        assert table.angle is not None
        tip, name = _tip(states), force_name(1)
        radius, height = hook_place(self.case, states.boom, table.angle, tip)
        straight, _ = hook_place(self.case, states.boom, table.angle, 0.0)
        force = float(states.observed(name)[0]) if states.boom.cylinders else None
        return Cell(
            self.configuration, self.radius, capacity, reason, table.angle, height, tip,
            radius - straight, force, tuple(proofs.values()),
        )  # fmt: skip

    def _root(self, first: float) -> None:
        """Search the payload in kg at which the governing utilisation is 1."""
        from scipy.optimize import brentq

        largest = chart_of(self.case).largest_payload
        low, high = 0.0, min(first, largest)
        while self._excess(high) < 0.0:
            if high == largest:
                return
            # Utilisations are nearly linear in the payload.
            rise = (self._excess(high) - self._excess(0.0)) / high
            ahead = -1.05 * self._excess(0.0) / rise if rise > 0.0 else np.inf
            low, high = high, min(max(ahead, 1.1 * high), 8.0 * high, largest)
        accuracy = {"xtol": _ACCURACY * high, "rtol": _ACCURACY}
        brentq(self._excess, low, high, **accuracy)

    def _excess(self, payload: float) -> float:
        """Return the governing utilisation less 1; 1 if the boom cannot stand at the radius."""
        if payload not in self._utilisations:
            try:
                self._utilisations[payload] = self._proofs(payload)[0].utilisation or 0.0
            except NoCapacityError as error:
                self._utilisations[payload] = 2.0
                self._failures[payload] = str(error)
        return self._utilisations[payload] - 1.0

    def _proofs(self, payload: float) -> Rows:
        """Return the governing proofs with a payload in kg, the governing one first.

        Raises:
            NoCapacityError: the tip cannot stand at the radius, or there is no equilibrium.
        """
        case = combined_case(self.case, self.point(payload)[0])
        try:
            states = combination_states(case)
            return governing(row for state in states for row in proofs_of(state, case))
        except NUMERICAL_ERRORS:
            raise NoCapacityError(NO_EQUILIBRIUM) from None

    def point(self, payload: float) -> tuple[LoadCaseTable, States]:
        """Return the load case with a payload in kg and its rated state, with the tip in place.

        The fixed-point iteration over the tip deflection has secant steps.

        Raises:
            NoCapacityError: no luffing angle leads to the radius, or there is no equilibrium.
        """
        if payload in self.points:
            return self.points[payload]
        guesses = [_tip(states) for _, states in self.points.values()][-1:] or [0.0]
        found: list[float] = []
        for _ in range(_STEPS):
            table, states = self._rated(payload, guesses[-1])
            found.append(_tip(states))
            assert table.angle is not None
            reached, _ = hook_place(self.case, states.boom, table.angle, found[-1])
            if abs(reached - self.radius) < _RADIUS:
                self.points[payload] = table, states
                return table, states
            guesses.append(_secant(guesses, found))
        raise NoCapacityError(NO_EQUILIBRIUM)

    def _rated(self, payload: float, tip: float) -> tuple[LoadCaseTable, States]:
        """Return the load case whose tip would be at the radius with this deflection in m."""
        extension = self.configuration.extension
        table = load_case_of(self.case, payload, extension, self._angle(tip))
        rated = combine(self.case, table)
        try:
            with np.errstate(all="ignore"):
                return table, static_states(rated, boom_with_play(rated, build_boom(rated)))
        except NUMERICAL_ERRORS:
            raise NoCapacityError(NO_EQUILIBRIUM) from None

    def _angle(self, tip: float) -> float:
        """Return the luffing angle in degrees that leads to the radius with this deflection in m.

        Raises:
            NoCapacityError: the radius is out of reach.
        """
        chassis, length = self.case.chassis, self.configuration.length
        ratio = (self.radius - (chassis.foot_ahead if chassis else 0.0)) / hypot(length, tip)
        angle = degrees(acos(ratio) - atan2(tip, length)) if abs(ratio) <= 1.0 else -1.0
        least, most = chart_of(self.case).angles
        if not least <= angle <= most:
            raise NoCapacityError(OUT_OF_REACH)
        return angle


def solve(case: Case, configuration: Configuration) -> list[Cell]:
    """Return the cells of a configuration at all radii of the chart."""
    cells: list[Cell] = []
    capacity = None
    for radius in chart_of(case).radii:
        cells.append(Search(case, configuration, radius).cell(capacity))
        capacity = cells[-1].capacity or capacity
    return cells


def chart_of(case: Case) -> ChartTable:
    """Return the table of the chart of a case that has one."""
    chart: ChartTable | None = getattr(case, "chart")  # noqa: B009 # a key of a client
    assert chart is not None
    return chart


def load_case_of(
    case: Case, payload: float, extension: Mapping[str, float], angle: float
) -> LoadCaseTable:
    """Return the load case of the chart with a payload in kg, extensions in m and an angle."""
    name = chart_of(case).load_case
    (table,) = (one for one in case.load_cases if one.name == name)
    extended = {**table.extension, **extension}
    return table.model_copy(update={"payload": payload, "extension": extended, "angle": angle})


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
    chart, full = chart_of(case), boom.tip - foot_of(boom)
    most = {one.inner: one.extension for one in case.joints if one.extension is not None}
    lengths = {one.name: boom.segments[i].length for i, one in enumerate(case.segments)}
    least = {
        one.inner: max(0.0, lengths[one.inner] - lengths[one.outer])
        for one in case.joints
        if one.inner in most
    }
    strokes = {name: most[name] - least[name] for name in chart.order or most}
    for extension in chart.extensions or ([] if chart.lengths else [{}]):
        shorter = sum(most[name] - extension.get(name, most[name]) for name in most)
        yield Configuration(extension, full - shorter)
    retracted = full - sum(most[name] - least[name] for name in most)
    for number, length in enumerate(chart.lengths, start=1):
        left = length - retracted
        if not -_RADIUS <= left <= sum(strokes.values()) + _RADIUS:
            raise ValueError(
                f"chart.lengths[{number}]: must be from {retracted:g} m, with all segments "
                f"retracted, to {retracted + sum(strokes.values()):g} m, got {length:g} m"
            )
        extension = dict(least)
        for name, stroke in strokes.items():
            share = stroke * left / sum(strokes.values())
            if chart.order:
                share = min(stroke, max(0.0, left))
                left -= share
            extension[name] += share
        yield Configuration(extension, length)


def _tip(states: States) -> float:
    """Return the lowest tip deflection in m."""
    return float(states.observed("tip").min())


def _secant(guesses: list[float], found: list[float]) -> float:
    """Return the next guess of a fixed point, from the guesses and the values that they led to."""
    if len(found) < 2:
        return found[-1]
    changes = [value - guess for guess, value in zip(guesses[-2:], found[-2:], strict=True)]
    if changes[1] == changes[0]:
        return found[-1]
    return guesses[-1] - changes[1] * (guesses[-1] - guesses[-2]) / (changes[1] - changes[0])
