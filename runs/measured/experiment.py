# SPDX-License-Identifier: LGPL-3.0-or-later
"""An experiment: the measured channels of a case, and a beam that computes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from protractile.analysis.equilibria import equilibria, vibrating_state
from protractile.analysis.states import States
from protractile.analysis.stresses import Fibres
from protractile.dynamics.damping import closed_contact_damping
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.predictability import vary_motion
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import pads
from protractile.geometry.ground import force_name
from protractile.geometry.observation import KINDS
from protractile.geometry.place import at
from protractile.geometry.section import EACH_SIDE
from protractile.geometry.typography import choices
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.calibration import CalibratedTable
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.messages import translated_errors
from protractile.runs.case.schema import Case
from protractile.runs.folder.cache import Cache
from protractile.runs.measured.keys import Channel, Keys
from protractile.runs.pipeline.models import MotionPlan, build, build_on, complete_system
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.ranks import single_rank
from protractile.runs.sweep import points, variation
from protractile.runs.sweep.distances import varied_data

if TYPE_CHECKING:
    from protractile.beam_model.calibration import Calibration
    from protractile.dynamics.integrator import Integrator

#: numbers of the case by key, in the units of the case
Settings = Mapping[str, float]

# Start of the keys of channels.
_OWN = "measured"


@dataclass(frozen=True)
class Computed:
    """A model in the state of a measurement."""

    damped: GapSystem  #: its system with the damping of its motion
    rest: States  #: the equilibrium under the loads at t = 0; empty without one
    motions: Sequence[States]  #: its motion, and motions with slightly changed loads

    def read(self, channel: Channel) -> Array:
        """Return the values (num_motions, num_times) at the times of a channel, or a single one.

        NaN without an equilibrium, and for a mode that the model lacks.
        """
        if channel.table is not None:
            times = channel.times
            return np.array([np.interp(times, s.time, _observe(s, channel)) for s in self.motions])
        value, rested = np.full(1, np.nan), self.rest.time.size > 0
        if channel.quantity == "free_travel":
            value = np.array([free_travel(self.rest.boom)])
        elif rested and channel.quantity in ("frequency", "damping_ratio"):
            modes = self.modes[channel.quantity == "damping_ratio"]
            value = np.append(modes, value)[min(channel.number - 1, modes.size)].reshape(1)
        elif rested:
            value = _observe(self.rest, channel)
        return value[None]

    @property
    def modes(self) -> tuple[Array, Array]:
        """Frequencies in Hz and damping ratios of the modes with the contacts closed at rest."""
        rests = dict(zip(self.rest.time.tolist(), self.rest.positions, strict=True))
        return closed_contact_damping(self.damped, vibrating_state(self.damped, rests)[1])


def _observe(states: States, channel: Channel) -> Array:
    """Return the values (num_states,) of a channel in states of a model."""
    if channel.quantity == "strain":
        return _strain(states, channel)
    if channel.quantity == "cylinder_force":
        return states.observed(force_name(channel.number))
    return states.observed(channel.output.name if channel.placed else channel.quantity)


def _strain(states: States, channel: Channel) -> Array:
    """Return the strain (num_states,) in the middle of a side of the section (Navier 1826)."""
    number = [segment.name for segment in states.boom.segments].index(channel.segment or "")
    segment, line = states.boom.segments[number], states.model.lines[number]
    fibres = Fibres.of(segment, line)
    assert fibres is not None
    assert channel.x is not None
    across = fibres.z if channel.side in ("top", "bottom") else fibres.y
    heights = (1.0 if channel.side in ("top", "right") else -1.0) * across[:, 0]
    outer = np.flatnonzero(heights >= heights.max() - 1.0e-9 * np.ptp(heights))
    forces = states.section_forces(number)
    stress = np.mean([fibres.stress(int(fibre), forces) for fibre in outer], axis=0)
    x = at(channel.x, *segment.ends)
    at_x = np.array([np.interp(x, line.x, row) for row in stress])
    return at_x / segment.material.youngs_modulus


def free_travel(boom: Boom) -> float:
    """Return the travel of the tip in m between its contacts, of rigid segments.

    In each joint the inner segment moves and turns until contacts close. So its travel is the
    solution of a linear program with two unknowns, and the joints add up.
    """
    from scipy.optimize import linprog

    travel, contacts = 0.0, pads(boom)
    for joint in (joint for joint in boom.joints if not joint.bonded):
        sides = [
            (pad, side)
            for pad in contacts
            if pad.joint is joint and pad.station.direction == "z"
            for side in (EACH_SIDE if pad.side == 0 else (pad.side,))
        ]
        origin = joint.stations[0]
        rows = [[side, side * (pad.midpoint - origin)] for pad, side in sides]
        clearances = [pad.station.law.onset(side) - pad.shim for pad, side in sides]
        for sign in (1.0, -1.0):
            arm = sign * np.array([1.0, boom.tip - origin])
            end = linprog(arm, rows, clearances, bounds=(None, None))
            travel -= end.fun
    return travel


@dataclass
class Experiment:
    """The measured channels of a case, and a beam that computes them.

    Time steps are those of the first motion in each state, so that values depend smoothly on the
    numbers of the case. A beam that a shell calibrates keeps its calibration.
    """

    case: Case  #: checked case
    file: str  #: case file for messages
    model: str | None = None  #: name of a model; the last beam with play unless given
    #: keys of numbers that change; inferred plates stay unless one of them determines plates
    keys: Sequence[str] = ()
    #: relative changes of the loads of each computed motion
    perturbations: Sequence[float] = (0.0,)
    _steps: dict[frozenset[tuple[str, float]], Integrator] = field(default_factory=dict)

    @cached_property
    def channels(self) -> Sequence[Channel]:
        """The channels, without readings outside of the run."""
        assert isinstance(self.case, Keys)
        return [channel.until(self.case.time.duration) for channel in self.case.measured]

    @cached_property
    def _of_beam(self) -> Case:
        """The case with the beam alone, and an output for each channel.

        Raises:
            BadInput: the case has no channel, or no such beam.
        """
        if not self.channels:
            what = "missing; give a [[measured]] for each channel, with its readings"
            raise BadInput(self.file, "measured", what)
        beams = [model.name for model in self.case.models if not model.meshed]
        names = points.chosen_beam(self.case, None if self.model is None else [self.model])
        if not {*names} & {*beams}:
            wrong = f"{self.model!r} is not a beam of the case; give {choices(beams or ['a beam'])}"
            raise BadInput(self.file, "--model", wrong if self.model else "the case has no beam")
        outputs = (channel.output for channel in self.channels if channel.quantity in KINDS)
        return self.case.model_copy(
            update={
                "models": tuple(model for model in self.case.models if model.name in names),
                "observe": (*self.case.observe, *outputs),
                "measured": tuple(self.channels),
                "ensemble": None,
            }
        )

    @cached_property
    def whole(self) -> Case:
        """The case with the beam alone, and with plates as they are."""
        if any(place.shapes_sections for key in self.keys for place in self.places(key)):
            return self._of_beam
        return points.hold_plates(self._of_beam, points.infer_plates(self._of_beam))

    @cached_property
    def _tables(self) -> variation.Tables:
        return points.tables_of(self.whole)

    @property
    def _own(self) -> variation.Tables:
        """The numbers of channels that may be unknown."""
        return {_OWN: [channel.model_dump(include={"time_offset"}) for channel in self.channels]}

    def places(self, key: str) -> tuple[variation.Place, ...]:
        """Return the places of the numbers at a key.

        Raises:
            BadInput: the case has no such number.
        """
        tables = points.tables_of(self._of_beam) | self._own
        try:
            return tuple(
                variation.with_size(place, self._of_beam) for place in variation.find(key, tables)
            )
        except variation.InvalidVariation as reason:
            what = str(reason)
        except (LookupError, AttributeError):
            known = [place.name for place, _ in variation.numbers(tables)]
            near = get_close_matches(key, known) or known
            what = f"is not a number of the case; give {choices(near)}"
        raise BadInput(self.file, key, what)

    def number(self, key: str) -> tuple[float, str]:
        """Return the number at a key in the unit of the case, and this unit.

        Raises:
            BadInput: the case has no such number.
        """
        place = self.places(key)[0]
        known = {found.steps: value for found, value in variation.numbers(self._tables | self._own)}
        if place.steps not in known:
            what = "is not a number of the case; give it a value, from which the search starts"
            raise BadInput(self.file, key, what)
        unit, system = variation.unit_of(place, self._of_beam) or "1", self.case.system
        return system.of(known[place.steps], unit), system.label(unit)

    def variations(self, settings: Settings) -> list[tuple[variation.Variation, float]]:
        """Return the numbers of the boom with their places, without those of channels."""
        return [
            (variation.Variation(key, (value,), self.places(key)), value)
            for key, value in settings.items()
            if not key.startswith(_OWN)
        ]

    def changed(self, settings: Settings) -> Case:
        """Return the case with other numbers, also of channels.

        Raises:
            BadInput: a key is unknown, or a number exceeds its limits.
        """
        case = points.set_numbers(self.file, self.whole, self._tables, self.variations(settings))
        own = self._own
        for key in (key for key in settings if key.startswith(_OWN)):
            for place in self.places(key):
                place.put(own, settings[key])
        channels = (
            channel.model_copy(update=numbers_of_channel)
            for channel, numbers_of_channel in zip(self.channels, own[_OWN], strict=True)
        )
        return case.model_copy(update={"measured": tuple(channels)})

    def evaluate(self, settings: Settings) -> list[tuple[Channel, Array]]:
        """Return all channels with their values (num_motions, num_times), of single ones (1, 1).

        Those of relative channels have the mean of the readings.

        Raises:
            BadInput: a number or a place is invalid.
            NumericsError: the model cannot be computed.
        """
        case = self.changed(settings)
        assert isinstance(case, Keys)
        series = [channel for channel in case.measured if channel.table is not None]
        moving = {frozenset(channel.changes.items()) for channel in series}
        states: dict[frozenset[tuple[str, float]], Computed] = {}

        def read(channel: Channel, changes: Settings) -> Array:
            state = frozenset(changes.items())
            if state not in states:
                changed = self.changed({**settings, **changes}) if changes else case
                states[state] = self._compute(changed, state, state in moving)
            values = states[state].read(channel)
            # The zero with the smallest squares is the mean difference.
            off = (values - channel.readings).mean(axis=1, keepdims=True)
            return values - off if channel.relative else values

        with translated_errors(self.file), np.errstate(all="ignore"):
            found = [(channel, read(channel, channel.changes)) for channel in case.measured]
            return [
                (channel, values - read(channel, channel.since) if channel.since else values)
                for channel, values in found
            ]

    def first_frequency(self, settings: Settings) -> float:
        """Return the first natural frequency in Hz with the contacts that are closed at rest."""
        return float(self._compute(self.changed(settings), frozenset(), False).modes[0][0])

    @cached_property
    def _calibration(self) -> Calibration | None:
        """The calibration of the beam; None without a shell that calibrates it."""
        (model,), comm = self.whole.models, single_rank(self.whole.first_shell)
        if comm is None:
            return None
        context = BuildContext(comm, cache=Cache.of_user())
        return build(self.whole, build_boom(self.whole), model, context).calibration

    def _compute(self, case: Case, state: frozenset[tuple[str, float]], moves: bool) -> Computed:
        """Return the beam of a case in a state of measurement, with motions if it ``moves``."""
        (model,), boom = case.models, build_boom(case)
        if self._calibration is not None and isinstance(model, CalibratedTable):
            built = model.build_calibrated(model.model_boom(boom), self._calibration)
            system = complete_system(built.system, case, boom, built.lines)
            built = replace(built, system=system)
        else:
            built = build_on(model.model_boom(boom), case, model)
        loaded = model.analysis_model(boom, built)
        plan, motions = MotionPlan.of(built.system, case, model), []
        if moves and state not in self._steps:
            plan.warm()
            self._steps[state] = plan.integrator.like(plan.trajectory())
        for change in self.perturbations if moves else ():
            varied = vary_motion(plan.motion, varied_data(plan.motion), 1.0 + change)
            trajectory = self._steps[state](varied)
            if plan.load is not None:
                trajectory = plan.load.separate_rope(trajectory)
            motions.append(States.in_motion(loaded, trajectory))
        rest = States.of(loaded, equilibria(loaded.system))
        return Computed(plan.motion.system, rest, motions)
