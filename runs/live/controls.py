# SPDX-License-Identifier: LGPL-3.0-or-later
"""Controls of the live page: the numbers of a case that a designer may change."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from protractile.geometry.boom import Boom
from protractile.geometry.fields import describe, fields_of, is_number
from protractile.geometry.fit import pad_room, room
from protractile.runs.case import reading
from protractile.runs.case.amounts import innermost
from protractile.runs.case.build import build_boom, hold_ground
from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.messages import translated_errors
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.sanity import usual_ranges
from protractile.runs.case.schema import Case
from protractile.runs.process.bad_input import BadInput
from protractile.runs.sweep.points import hold_plates, infer_plates
from protractile.runs.sweep.variation import Place, Tables, numbers, unit_of, with_size

# Name of the beam on the page, and number of its elements in the longest segment.
BEAM, ELEMENTS = "beam", 4

# Tolerance of the motion of the beam, which is only shown as a curve.
TOLERANCE = 1.0e-2

# Ends of a slider whose number has no limits, as multiples of the number.
_LEAST, _MOST = 0.5, 2.0

# Shortest pad of the slider, as a fraction of the length in the file.
_SHORTEST = 0.1

# Keys that designers change first, in this order, and their labels.
_FIRST = {
    r"gravity\.angle": "Luffing angle",
    r"payload\.mass": "Payload",
    r"hoist\.mass": "Hoisted mass",
    r"(hoist|slew|luff)\.speed": "Speed of {}",
    r"(hoist|slew|luff)\.time": "Duration of {}",
    r"load\[(\d+)\]\.magnitude": "Load {}, across the boom",
    r"load\[(\d+)\]\.ramp": "Rise time of load {}",
    r"joint\[\d+\]\.extension": "Extension, {owner}",
    r"joint\[\d+\]\.stroke": "Stroke, {owner}",
    r"joint\[\d+\]\.drive\.(time|speed)": "Telescoping {}, {owner}",
    r"joint\[\d+\]\.play": "Play, {owner}",
    r"joint\[\d+\]\.pad\.(length|offset)": "Pad {}, {owner}",
    r"segment\[\d+\]\.section\.(flange|web|top|bottom)": "Thickness of {}, {owner}",
    r"segment\[\d+\]\.section\.thickness": "Thickness, {owner}",
    r"limits\.(\w+)": "Limit of {}",
}

# Tables whose numbers the page does not change. The page has its own beam as model.
_EXCLUDED = ("model", "load_case", "combination", "spectrum", "measured")


@dataclass(frozen=True, slots=True)
class Control:
    """A slider and a number box for a number of a case, or for several equal numbers."""

    key: str  #: key in the case file, ``joint[1].play``, or ``joint.play`` for all joints
    keys: Sequence[str]  #: key of each of these numbers, such as ``joint[1].play``
    label: str  #: label of the control
    help: str  #: description of the key
    value: float  #: value in the unit
    unit: str  #: unit in the case's system; empty for dimensionless numbers
    range: tuple[float, float] | None  #: ends of the slider in the unit; None if they coincide


@dataclass(frozen=True)
class Draft:
    """Case with editable numbers. Plates inferred from the file stay as they are."""

    file: str  #: file of the case
    case: Case  #: checked case, with tables of sections for inferred plates
    boom: Boom  #: boom of the file

    @classmethod
    def load(cls, file: str) -> Draft:
        """Read a case file.

        Raises:
            BadInput: the file cannot be read, or its content is invalid.
        """
        case = reading.select(reading.load(file), file, members=0)
        return cls(file, hold_plates(case, infer_plates(case)), build_boom(case))

    def _label(self, keys: Sequence[str]) -> str:
        """Return the label of a control for numbers at these keys; the key itself by default."""
        segments, joints = self.boom.segments, self.boom.joints
        owners = {f"segment[{i}]": segment.name for i, segment in enumerate(segments, 1)}
        owners |= {f"joint[{i}]": segments[joint.inner].name for i, joint in enumerate(joints, 1)}
        owner = "all joints" if len(keys) > 1 else owners.get(keys[0].partition(".")[0])
        for pattern, label in _FIRST.items():
            if match := re.fullmatch(pattern, keys[0]):
                words = (group.replace("_", " ") for group in match.groups())
                return label.format(*words, owner=owner)
        return keys[0]

    @cached_property
    def _tables(self) -> Tables:
        return self.case.model_dump(mode="json", by_alias=True, exclude_none=True)

    @cached_property
    def _numbers(self) -> Mapping[str, tuple[Place, float]]:
        """The place and the value in SI units of each number that the page can edit, by key."""
        tables = {name: value for name, value in self._tables.items() if name not in _EXCLUDED}
        return {
            place.name: (with_size(place, self.case), float(value))
            for place, value in numbers(tables)
        }

    @property
    def keys(self) -> list[str]:
        """The keys of all numeric values of the case that the page can edit."""
        return list(self._numbers)

    def controls(self) -> list[Control]:
        """Return the controls, most important first. Numbers that all joints share have one."""
        keys_of_controls: dict[str, list[str]] = {}
        for pattern in _FIRST:
            keys = [key for key in self._numbers if re.fullmatch(pattern, key)]
            groups: dict[str, list[str]] = {}
            for key in keys:
                groups.setdefault(re.sub(r"^joint\[\d+\]", "joint", key), []).append(key)
            for common, several in groups.items():
                equal = len({self._numbers[key][1] for key in several}) == 1
                keys_of_controls |= {common: several} if equal else {key: [key] for key in several}
        return [self.control(key, several) for key, several in keys_of_controls.items()]

    def control(self, key: str, equal_keys: Sequence[str] = ()) -> Control:
        """Return the control of a key, or of several keys of equal numbers.

        Raises:
            BadInput: the case has no such number.
        """
        keys = equal_keys or [key]
        if keys[0] not in self._numbers:
            raise BadInput(self.file, key, "is not a number of the case; choose one of the list")
        place, value = self._numbers[keys[0]]
        table, name = innermost(place.steps, self.case)
        unit, system = unit_of(place, self.case), self.case.system
        ranges = [self._range(*self._numbers[control]) for control in keys]
        low, high = max(bounds[0] for bounds in ranges), min(bounds[1] for bounds in ranges)
        help_text = describe(type(table), name)
        in_unit = [system.of(number, unit or "1") for number in (value, low, high)]
        return Control(
            key,
            keys,
            self._label(keys),
            re.sub(rf"(?<=\bin ){re.escape(unit or '-')}\b", system.unit(unit), help_text),
            in_unit[0],
            system.label(unit),
            (in_unit[1], in_unit[2]) if low < high else None,
        )

    def _range(self, place: Place, value: float) -> tuple[float, float]:
        """Return the range of a number in SI units, within the limits of schema and checks."""
        table, name = innermost(place.steps, self.case)
        rules = fields_of(type(table))[name].metadata
        low = max((float(rule.ge) for rule in rules if hasattr(rule, "ge")), default=-math.inf)
        high = min((float(rule.le) for rule in rules if hasattr(rule, "le")), default=math.inf)
        if not (math.isfinite(low) and math.isfinite(high)):
            ends = sorted((_LEAST * value, _MOST * value))
            if place.steps[0] == "joint":
                ends = self._range_that_fits(place, value, *ends)
            low, high = max(low, ends[0]), min(high, ends[1])
        for usual in usual_ranges(self.case, self.boom):
            # The range of a joint's number is every value that fits the segments.
            if usual.key == place.name and usual.value == value and place.steps[0] != "joint":
                low, high = max(low, usual.least), min(high, usual.most)
                if value == 0.0 and math.isfinite(usual.most):
                    high = usual.most
        return low, high

    def _range_that_fits(self, place: Place, value: float, low: float, high: float) -> list[float]:
        """Return the values in a range at which the joint still fits its segments."""
        joint = self.boom.joints[int(place.steps[1])]
        outer, inner = (self.boom.segments[number] for number in (joint.outer, joint.inner))
        match place.steps[2:]:
            case ("extension",):
                # At the upper end the segments separate.
                return [low, value + self.boom.smallest_overlap(joint)]
            case ("play",) if outer.section is not None and inner.section is not None:
                return [0.0, room(joint, outer, inner)[0]]
            case ("pad", "length"):
                return [_SHORTEST * value, min(high, float(np.ptp(self.boom.overlap(joint))))]
            case ("pad", "offset") if joint.pad is not None:
                return [0.0, pad_room(joint, joint.pad, self.boom) - joint.pad.width]
        return [low, high]

    def changed(self, values: Mapping[str, float]) -> Case:
        """Return the case with other numbers in its units, by key, not checked beyond its schema.

        Raises:
            BadInput: a number exceeds the limits of its key.
        """
        tables = deepcopy(self._tables)
        for key, value in values.items():
            if key not in self._numbers or not is_number(value) or not math.isfinite(value):
                raise BadInput(self.file, key, f"must be a number of the case, got {value!r}")
            self._numbers[key][0].put(tables, float(value))
        with translated_errors(self.file):
            return hold_ground(Case.model_validate(tables), self.case)

    @property
    def shells(self) -> list[Shell]:
        """The shells of the case, or a default one."""
        return select_kind(Shell, self.case.models) or [Shell()]

    def beam(self, case: Case) -> CheckedCase:
        """Return the checked case with the beam of the page as its only model.

        Raises:
            BadInput: the case is invalid.
        """
        with_play = next((model for model in case.models if not model.bonded), case.models[0])
        plates = all(segment.section is not None for segment in self.boom.segments)
        beam = BeamElements(
            name=BEAM,
            element_length=max(segment.length for segment in self.boom.segments) / ELEMENTS,
            theory="timoshenko" if plates else "euler-bernoulli",
            contact=with_play.contact,
        )
        time = case.time.model_copy(update={"tolerance": max(case.time.tolerance, TOLERANCE)})
        # The check would build a boom for each load case.
        proofs = dict.fromkeys(("load_cases", "combinations", "spectra"), ())
        beam_case = case.model_copy(update={"models": (beam,), "time": time, **proofs})
        return reading.check(beam_case, self.file)
