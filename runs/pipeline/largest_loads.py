# SPDX-License-Identifier: LGPL-3.0-or-later
"""Statics, stresses and utilisations of a boom at t = 0 and under its largest loads.

The model has beam elements and the compliance of walls under pads, at the initial extension.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import Literal, NamedTuple

import numpy as np

from protractile.analysis.equilibria import equilibria, instants
from protractile.analysis.model import AnalysisModel
from protractile.analysis.states import StaticResult, StationLoad, static_results, station_loads
from protractile.analysis.stresses import Utilisation, fibre_forces, largest_stresses
from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.lines import lines_of_modes
from protractile.beam_model.statics import Elements, loaded_system, static_theory
from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array
from protractile.geometry.axial import foot_thrust
from protractile.geometry.boom import Boom
from protractile.geometry.cylinder import forces
from protractile.geometry.units import System
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.load_table import release_note
from protractile.runs.pipeline.models import MotionPlan, build_on, complete_system
from protractile.runs.report.formatting import amount, without_round_off
from protractile.runs.report.tables import Column, Table

# Elements of the longest segment. The error of stresses under a uniform load is below 0.1 %.
_ELEMENTS = 20
# Fraction of the largest result of a unit that is displayed as 0.
_NEGLIGIBLE = 1.0e-4
# Difference of results, as a fraction, up to which the first one counts as the largest.
_ROUND_OFF = 1.0e-9


# Kinds of static results.
StaticKind = Literal[
    "tip", "lateral tip", "bending stress", "pad", "contact", "cylinder force", "foot reaction"
]


class StaticExtreme(NamedTuple):
    """A static result at t = 0, and its extreme value over the run."""

    kind: StaticKind  #: kind of the result
    part: str  #: part of the boom; empty if there is only one
    what: str  #: name of the result, with its location
    unit: str  #: SI unit
    initial: float  #: value at t = 0
    largest: float  #: value with the largest magnitude
    time: float  #: time of the loads of this value in s
    #: utilisation of a strength by the largest value; None without a strength
    utilisation: Utilisation | None = None

    @property
    def name(self) -> str:
        """The kind and the part, which identify the result."""
        return ", ".join(filter(None, (self.kind, self.part)))


@dataclass(frozen=True)
class BeamStates:
    """States of a boom without drives under the loads at several times, at rest or in motion."""

    model: AnalysisModel  #: the model of the boom
    time: Array  #: (num_states,) in s
    positions: Array  #: modal coordinates (num_states, num_modes)

    @property
    def boom(self) -> Boom:
        """The boom of the model."""
        return self.model.boom

    @cached_property
    def rests(self) -> list[StaticResult]:
        """The result of each state."""
        return static_results(self.model, self.time, self.positions)

    @property
    def farthest(self) -> StaticResult:
        """The result with the largest tip deflection."""
        step = int(np.abs(self.observed("tip")).argmax())
        at = slice(step, step + 1)
        return static_results(self.model, self.time[at], self.positions[at])[0]

    def observed(self, name: str) -> Array:
        """Return the values (num_states,) of an observer of the model."""
        return np.asarray(self.positions @ self.model.system.observers[name].row)

    def _station_loads(self) -> list[list[StationLoad]]:
        """Return the loads of all stations in each state."""
        boom, system = self.boom, self.model.system
        if not system.travels:
            return station_loads(boom, system, self.positions)
        states = zip(self.time.tolist(), self.positions, strict=True)
        return [station_loads(boom, system.at_time(at), one[None])[0] for at, one in states]

    @classmethod
    def of(cls, case: Case, boom: Boom) -> BeamStates:
        """Return the static states at t = 0 and under extreme loads.

        The boom has the contact laws of the first model with play, or is bonded.

        Raises:
            NumericsError: there is no equilibrium at t = 0.
        """
        boom = boom.without_drives
        modes = BoomModes(boom, Elements(boom, _ELEMENTS).segments)
        system = loaded_system(
            boom,
            modes,
            complete=lambda system, lines: complete_system(system, case, boom, lines),
        )
        # The coordinates of wall springs come after the coordinates of the segments.
        along = [line.extend(system.num_modes) for line in lines_of_modes(boom, modes)]
        return cls.at_rest(AnalysisModel.of(boom, system, along), case.time.duration)

    @classmethod
    def at_rest(cls, model: AnalysisModel, duration: float) -> BeamStates:
        """Return the static states of a model at t = 0 and under extreme loads.

        ``duration`` in s is that of the histories of the loads.

        Raises:
            NumericsError: the boom has no equilibrium at t = 0.
        """
        rests = equilibria(model.system, instants(model.system, duration))
        if not rests:
            raise NumericsError("the boom has no static equilibrium under the loads at t = 0")
        return cls(model, np.array([*rests]), np.array([*rests.values()]))

    @classmethod
    def in_motion(cls, case: Case) -> BeamStates:
        """Return the motion of the first beam-element model with play, or of a default beam.

        Raises:
            NumericsError: the motion cannot be computed.
        """
        beams = [one for one in select_kind(BeamElements, case.models) if not one.bonded]
        model = beams[0] if beams else BeamElements(name="beam")
        joints = tuple(replace(joint, drive=None) for joint in case.joints)
        case = case.model_copy(update={"joints": joints, "ensemble": None, "models": (model,)})
        joined = model.model_boom(build_boom(case))
        built = build_on(joined, case, model)
        trajectory = MotionPlan.of(built.system, case, model).trajectory()
        loaded = AnalysisModel.of(joined.boom, built.system, model.lines(joined.boom, built))
        return cls(loaded, trajectory.time, trajectory.states)

    def at_extremes(self) -> BeamStates:
        """Return the states of a motion with extreme tip, contacts, cylinders or stresses."""
        states, system = self.positions, self.model.system
        rows = [system.rows, *(one.row[None] for one in system.observers.values())]
        curves = [states @ np.vstack(rows).T]
        for _, fibres, carried in fibre_forces(self.model, states, self.time):
            stresses = (fibres.stress(fibre, carried) for fibre in range(len(fibres.z)))
            curves += [np.abs(one).max(axis=1, keepdims=True) for one in stresses]
        every = np.hstack(curves)
        steps = np.unique([0, *every.argmax(axis=0), *every.argmin(axis=0)])
        return BeamStates(self.model, self.time[steps], states[steps])

    def extremes(self, system: System) -> list[StaticExtreme]:
        """Return the extremes of tip, stresses, pads, contacts and cylinders.

        Names have positions in units of ``system``.
        """
        extremes = [self._extreme("tip", "", "tip", "m", self.observed("tip").tolist())]
        if self.boom.spatial:
            aside = self.observed("tip_lateral").tolist()
            extremes.append(self._extreme("lateral tip", "", "lateral tip", "m", aside))
        for segment, fibres, curves in fibre_forces(self.model, self.positions, self.time):
            forces_at_rest = {name: values[:1] for name, values in curves.items()}
            fibre, _ = largest_stresses(segment, fibres, curves, forces_at_rest, self.time)
            stress = abs(fibre.stress)
            used = Utilisation("outer fibre", segment.name, fibre.x, stress, fibre.utilisation)
            what = f"stress, {segment.name} at {system.text(fibre.x, 'm', 5)}"
            values = fibre.at_rest or 0.0, stress, fibre.time
            extremes.append(
                StaticExtreme("bending stress", segment.name, what, "Pa", *values, used)
            )
        extremes += self._at_stations(system)
        for name in forces(self.boom):
            part, what = name.partition("-")[2], name.replace("_", " ")
            of_states = self.observed(name).tolist()
            extremes.append(self._extreme("cylinder force", part, what, "N", of_states))
        return extremes

    def foot_extremes(self, system: System) -> Iterator[StaticExtreme]:
        """Yield the extremes of the resultant force on each foot."""
        for index, (segment, line) in enumerate(
            zip(self.boom.segments, self.model.lines, strict=True)
        ):
            if segment.foot is None or "shear" not in line.rows:
                continue
            x = segment.foot.x
            parts = [
                self.positions @ (line.one_sided_row(name, x, -1) - line.one_sided_row(name, x, 1))
                for name in ("shear", "lateral_shear", "normal")
                if name in line.rows
            ]
            boom = self.boom
            thrust = foot_thrust(boom.segments, boom.joints, index, self.time, boom.axial_changes)
            along = parts.pop() if "normal" in line.rows else np.zeros(self.time.size)
            whole = np.linalg.norm([*parts, thrust + along], axis=0)
            what = f"foot reaction at {system.text(x, 'm', 5)}"
            yield self._extreme("foot reaction", segment.name, what, "N", whole.tolist())

    def _extreme(
        self,
        kind: StaticKind,
        part: str,
        what: str,
        unit: str,
        values: Sequence[float],
        used: Sequence[Utilisation] = (),
    ) -> StaticExtreme:
        """Return the extreme of a result from its value in each state."""
        sizes = np.abs(values)
        step = int(np.argmax(sizes >= (1.0 - _ROUND_OFF) * sizes.max()))
        most = values[0], values[step], float(self.time[step])
        return StaticExtreme(kind, part, what, unit, *most, used[step] if used else None)

    def _at_stations(self, system: System) -> Iterator[StaticExtreme]:
        boom, states = self.boom, self._station_loads()
        for station, *loads in zip(boom.stations, *states, strict=True):
            lateral = ", lateral" if station.direction == "y" else ""
            where = f"{system.text(station.x, 'm', 5)}{lateral}"
            part, inner, place = where, "", f" at {where}"
            if station.joint is not None:
                inner = boom.segments[station.segment].name
                part = f"{inner}, station {station.place + 1}{lateral}"
                place = f", {inner}{place}"
            if loads[0].pressure is None:
                pushes = [load.force for load in loads]
                what = f"contact force{place}"
                yield self._extreme("contact", part, what, "N", pushes)
                continue
            pressures = [load.pressure or 0.0 for load in loads]
            used = [
                Utilisation("pad", inner, load.x, load.pressure or 0.0, load.utilisation)
                for load in loads
            ]
            yield self._extreme("pad", part, f"pad{place}", "Pa", pressures, used)


def static_table(case: Case, boom: Boom, extremes: Sequence[StaticExtreme]) -> Table:
    """Return the table of static extremes, in the units of the case."""
    used = [one.utilisation.value if one.utilisation else None for one in extremes]
    (extremes,) = without_negligible([extremes])
    vary = any(one.time > 0.0 for one in extremes)
    columns = [
        Column("", [one.what for one in extremes]),
        Column("t = 0", [amount(one.initial, one.unit) for one in extremes]),
    ]
    if vary:
        columns += [
            Column("maximum", [amount(one.largest, one.unit) for one in extremes]),
            Column("time of\nmaximum, s", [f"{one.time:.4g}" for one in extremes]),
        ]
    if any(used):
        columns.append(Column("utilisation", used, ".3g", "%"))
    more = [*filter(None, [release_note(case)])]
    more += ["Extensions are those at t = 0."] if boom.telescopes else []
    if any(joint.padded for joint in boom.joints):
        more.append("Local plate stresses are not included; a run with a shell has them.")
    title = "Static results at t = 0" + (" and under the maximum loads" if vary else "")
    kinds = "Stresses are bending stresses, axial in outer fibres."
    if any(one.kind == "contact" for one in extremes):
        kinds += " Contact forces act on the outer segment, upwards where positive."
    return Table(title, columns, [beam_note(boom), kinds, *more])


def without_negligible(groups: Sequence[Sequence[StaticExtreme]]) -> list[list[StaticExtreme]]:
    """Return groups of results, with 0 for values far below the largest one of their unit."""
    least: dict[str, float] = {}
    for one in chain.from_iterable(groups):
        least[one.unit] = max(_NEGLIGIBLE * abs(one.largest), least.get(one.unit, 0.0))

    def shown(one: StaticExtreme) -> StaticExtreme:
        initial, largest = without_round_off([one.initial, one.largest], least[one.unit])
        return one._replace(initial=initial, largest=largest)

    return [[shown(one) for one in group] for group in groups]


def beam_note(boom: Boom) -> str:
    """Return a sentence on the model of the statics."""
    theory = "Timoshenko" if static_theory(boom) == "timoshenko" else "Euler-Bernoulli"
    walls = f", with elastic {boom.yielding}," if boom.yielding else ""
    return f"A separate {theory} beam{walls} gives these estimates."
