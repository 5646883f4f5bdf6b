# SPDX-License-Identifier: LGPL-3.0-or-later
"""An experiment: the measured channels of a case, and a beam that computes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, cast

import numpy as np

from protractile.analysis.equilibria import equilibria
from protractile.analysis.states import States
from protractile.dynamics.predictability import vary_motion
from protractile.geometry.arrays import Array
from protractile.geometry.fields import BoomError
from protractile.geometry.observation import KINDS, Recorded
from protractile.geometry.typography import choices
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.calibration import CalibratedTable
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.messages import translated_errors
from protractile.runs.case.schema import Case, ObserveTable
from protractile.runs.folder.cache import Cache
from protractile.runs.measured.computed import Computed, output_of
from protractile.runs.measured.keys import Channel, Keys
from protractile.runs.pipeline.models import MotionPlan, build, build_on, complete_system
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.ranks import single_rank
from protractile.runs.sweep.distances import varied_data
from protractile.runs.sweep.points import (
    chosen_beam,
    hold_plates,
    infer_plates,
    set_numbers,
    tables_of,
)
from protractile.runs.sweep.variation import (
    InvalidVariation,
    Place,
    Tables,
    Variation,
    find,
    numbers,
    unit_of,
    with_size,
)

if TYPE_CHECKING:
    from protractile.beam_model.calibration import Calibration
    from protractile.dynamics.integrator import Integrator

#: numbers of the case by key, in the units of the case
Settings = Mapping[str, float]

# Start of the keys of channels.
_OWN = "measured"


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
        """The channels, without readings outside of the run.

        Raises:
            BadInput: there is none, or one has no two readings within the run.
        """
        assert isinstance(self.case, Keys)
        channels, end = [], self.case.time.duration
        for number, channel in enumerate(self.case.measured, start=1):
            inside = [0.0 <= time <= end for time in channel.times.tolist()]
            if channel.table is not None and sum(inside) < 2:
                what = f"has no two readings from 0 to {end:g} s of the run"
                raise BadInput(self.file, f"measured[{number}].time_offset", what)
            pairs = zip(channel.table or (), inside, strict=True)
            table = tuple(pair for pair, kept in pairs if kept) or None
            channels.append(channel.model_copy(update={"table": table}))
        if not channels:
            what = "missing; give a [[measured]] for each channel, with its readings"
            raise BadInput(self.file, "measured", what)
        return channels

    @cached_property
    def _of_beam(self) -> Case:
        """The case with the beam alone, and an output for each channel.

        Raises:
            BadInput: the case has no such beam, or the place of a channel is outside its segment.
        """
        beams = [model.name for model in self.case.models if not model.meshed]
        names = chosen_beam(self.case, None if self.model is None else [self.model])
        if not {*names} & {*beams}:
            wrong = f"{self.model!r} is not a beam of the case; give {choices(beams or ['a beam'])}"
            raise BadInput(self.file, "--model", wrong if self.model else "the case has no beam")
        numbered = enumerate(self.channels, start=1)
        outputs = {n: _output(channel) for n, channel in numbered if channel.quantity in KINDS}
        case = self.case.model_copy(
            update={
                "models": tuple(model for model in self.case.models if model.name in names),
                "observe": (*self.case.observe, *outputs.values()),
                "measured": tuple(self.channels),
                "ensemble": None,
            }
        )
        for number, output in outputs.items():
            try:
                build_boom(self.case.model_copy(update={"observe": (output,)}))
            except BoomError as error:
                key = f"measured[{number}].{error.where.rpartition('.')[2]}"
                raise BadInput(self.file, key, self.case.system.convert(error.what)) from None
        return case

    @cached_property
    def whole(self) -> Case:
        """The case with the beam alone, and with plates as they are."""
        if any(place.shapes_sections for key in self.keys for place in self.places(key)):
            return self._of_beam
        return hold_plates(self._of_beam, infer_plates(self._of_beam))

    @cached_property
    def _tables(self) -> Tables:
        return tables_of(self.whole)

    @property
    def _own(self) -> Tables:
        """The numbers of channels that may be unknown."""
        return {_OWN: [channel.model_dump(include={"time_offset"}) for channel in self.channels]}

    def places(self, key: str) -> tuple[Place, ...]:
        """Return the places of the numbers at a key.

        Raises:
            BadInput: the case has no such number.
        """
        try:
            places = find(key, tables_of(self._of_beam) | self._own)
            return tuple(with_size(place, self._of_beam) for place in places)
        except InvalidVariation as reason:
            raise BadInput(self.file, key, str(reason)) from None
        except (LookupError, AttributeError):
            what = "is not a number of the case; give a key such as joint[1].play"
            raise BadInput(self.file, key, what) from None

    def number(self, key: str) -> tuple[float, str]:
        """Return the number at a key in the unit of the case, and this unit.

        Raises:
            BadInput: the case has no such number.
        """
        place = self.places(key)[0]
        known = {found.steps: value for found, value in numbers(self._tables | self._own)}
        if place.steps not in known:
            what = "is not a number of the case; give it a value, from which the search starts"
            raise BadInput(self.file, key, what)
        unit, system = unit_of(place, self._of_beam) or "1", self.case.system
        return system.of(known[place.steps], unit), system.label(unit)

    def variations(self, settings: Settings) -> list[tuple[Variation, float]]:
        """Return the numbers of the boom with their places, without those of channels."""
        return [
            (Variation(key, (value,), self.places(key)), value)
            for key, value in settings.items()
            if not key.startswith(_OWN)
        ]

    def changed(self, settings: Settings) -> Case:
        """Return the case with other numbers, also of channels.

        Raises:
            BadInput: a key is unknown, or a number exceeds its limits.
        """
        case = set_numbers(self.file, self.whole, self._tables, self.variations(settings))
        own = self._own
        for key in (key for key in settings if key.startswith(_OWN)):
            for place in self.places(key):
                place.put(own, settings[key])
        channels = (
            channel.model_copy(update=numbers_of_channel)
            for channel, numbers_of_channel in zip(self.channels, own[_OWN], strict=True)
        )
        return case.model_copy(update={"measured": tuple(channels)})

    def check(self, settings: Settings) -> None:
        """Check the case with other numbers.

        Raises:
            BadInput: it is not valid.
        """
        case_file.check(self.changed(settings), self.file)

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


def _output(channel: Channel) -> ObserveTable:
    """Return the output of a channel of a place."""
    kind = cast(Recorded, channel.quantity)
    assert channel.x is not None
    return ObserveTable(output_of(channel), channel.segment, channel.x, kind)
