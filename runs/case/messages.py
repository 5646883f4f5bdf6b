# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is wrong with the user's input, in one line that names the place and the remedy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from runs.case import contact, schema, segment
from runs.case.drive import DriveTable
from runs.case.kinds import KINDS
from runs.case.limits import NAME
from runs.case.sections import SHAPES
from runs.process.shown import shown

_TABLES: Mapping[str, type[BaseModel]] = {
    "time": schema.TimeTable,
    "ensemble": schema.EnsembleTable,
    "material": segment.MaterialTable,
    "supports": segment.SupportTable,
    "masses": segment.MassTable,
    "collars": segment.CollarTable,
    "diaphragms": segment.DiaphragmTable,
    "segment": segment.SegmentTable,
    "restitution": contact.RestitutionTable,
    "pad": contact.PadTable,
    "pads": contact.SlidePadTable,
    "drive": DriveTable,
    "joint": contact.JointTable,
    "contact": contact.ContactTable,
    "stop": schema.StopTable,
    "cylinder": schema.CylinderTable,
    "load": schema.LoadTable,
    "axial": schema.AxialTable,
    "payload": schema.PayloadTable,
    "gravity": schema.GravityTable,
    "base": schema.BaseTable,
    "observe": schema.ObserveTable,
    "start": schema.StartTable,
    "velocity": schema.VelocityTable,
    "damping": schema.DampingTable,
    "life": schema.LifeTable,
    **SHAPES,
    **KINDS,
}

# Keys of the case that are arrays of tables.
_ARRAYS = ("segment", "joint", "stop", "cylinder", "load", "axial", "base", "observe", "model")

# Names that a message lists of those that would be right.
MOST_CHOICES = 12

_TYPES = {
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "string_type": "a text",
    "finite_number": "a finite number",
}


class BadInput(Exception):
    """``file`` as the user gave it, ``key`` of the fault, and what is wrong and would be right."""

    def __init__(self, file: str, key: str, what: str) -> None:
        super().__init__(" ".join(f"{shown(file)}: {shown(key)}: {what}".split()))
        self.file = file
        self.key = key
        self.what = what

    @classmethod
    def from_validation(cls, file: str, error: ValidationError) -> BadInput:
        """The most telling of the schema's complaints.

        A misspelled key is both unknown and missing: the unknown one tells more.
        """
        faults = error.errors(include_url=False)
        first = next((f for f in faults if f["type"] == "extra_forbidden"), faults[0])
        return cls(file, *_explain(first["type"], first["loc"], first["input"], first.get("ctx")))


def first_fault(error: ValidationError) -> str:
    """Where and what the first fault is of a file that no user has written."""
    fault = error.errors(include_url=False)[0]
    return "".join(f"{step}: " for step in fault["loc"]) + fault["msg"]


def choices(known: Sequence[str]) -> str:
    """'a', 'b' or 'c'; the first few of many."""
    if len(known) > MOST_CHOICES:
        return f"{', '.join(repr(name) for name in known[:MOST_CHOICES])} or another of its kind"
    quoted = [repr(name) for name in known]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} or {quoted[-1]}"


def _explain(
    fault: str, location: tuple[int | str, ...], value: Any, context: Mapping[str, Any] | None
) -> tuple[str, str]:
    """The key, and what is wrong with it."""
    key = _key(location)
    limits = context or {}
    if fault == "missing" and isinstance(location[-1], int):
        return _key(location[:-1]), f"must be {_pair(location)}, got {_shown(value)}"
    if fault == "missing":
        return key, f"missing; it is {_field(location).description}"
    if fault == "union_tag_not_found":
        return f"{key}.kind", f"missing; give {_kinds()}"
    if fault == "extra_forbidden":
        return key, _unknown_key(location)
    if fault in _TYPES:
        what = f"must be {_TYPES[fault]}"
    elif fault == "union_tag_invalid" and location[0] == "model":
        return f"{key}.kind", f"must be {_kinds()}, got {_shown(value['kind'])}"
    elif fault == "union_tag_invalid":
        return (
            f"{key}.shape",
            f"must be {choices(list(SHAPES))}, got {_shown(value['shape'])}",
        )
    elif fault == "greater_than":
        what = f"must be a number greater than {limits['gt']:g}"
    elif fault == "greater_than_equal":
        what = f"must be a number not less than {limits['ge']:g}"
    elif fault == "less_than":
        what = f"must be a number less than {limits['lt']:g}"
    elif fault == "less_than_equal":
        what = f"must be a number not greater than {limits['le']:g}"
    elif fault == "modes":
        what = "must be a whole number above 0, or 'auto'"
    elif fault == "contact_tolerance":
        what = f"must be a number from {limits['least']} to below 1, or 'any'"
    elif fault == "place":
        what = (
            "must be a number of m, 'tail', 'head' or a distance in m from one of them such as "
            "{ tail = 0.2 }"
        )
    elif fault == "literal_error":
        what = f"must be {limits['expected']}"
    elif fault == "unsuitable":
        return key, str(limits["what"])
    elif fault == "too_short" and limits["min_length"] > 1:
        return key, f"too short; give {limits['min_length']} at least"
    elif fault == "too_short":
        return key, "empty; give at least one"
    elif fault == "too_long" and limits["max_length"] == 2:
        what = f"must be {_pair(location)}"
    elif fault == "too_long":
        return key, f"too many; give {limits['max_length']} at most"
    elif fault == "string_too_long":
        return key, f"too long; give {limits['max_length']} characters at most"
    elif fault == "string_pattern_mismatch" and limits["pattern"] == NAME:
        what = "must be made of letters, digits, blanks and . _ + -, starting with one of the first"
    elif fault == "string_pattern_mismatch":
        what = "must be a line of printable characters"
    elif fault == "tuple_type" and key in _ARRAYS:
        what = f"must be an array of tables, each headed [[{key}]]"
    elif fault == "tuple_type":
        what = "must be a list"
    elif fault.startswith(("model_", "dict_")):
        what = "must be a table"
    else:
        raise AssertionError(f"the schema has a rule without a message: {fault}")
    return key, f"{what}, got {_shown(value)}"


def _pair(location: Sequence[int | str]) -> str:
    names = any(str(step).endswith("columns") for step in location)
    return f"a list of two {'names' if names else 'numbers'}"


def _key(location: Sequence[int | str]) -> str:
    """``segment[2].span`` from the schema's path, which counts from zero and names kinds."""
    key = ""
    for step in _without_kind(location):
        key += f"[{step + 1}]" if isinstance(step, int) else f".{step}" if key else step
    return key


def _without_kind(location: Sequence[int | str]) -> list[int | str]:
    steps = list(location)
    if len(steps) > 2 and steps[0] == "model":
        del steps[2]
    for key in ("section", "head_section"):
        if key in steps[:-1]:
            del steps[steps.index(key) + 1]
    return steps


def _table(location: Sequence[int | str]) -> type[BaseModel]:
    """The table that holds the last step of a path."""
    names = [step for step in location[:-1] if isinstance(step, str)]
    if names[:2] == ["start", "velocity"]:
        # Behind it stands a segment's name.
        del names[2:]
    return _TABLES[names[-1]] if names else schema.Case


def _fields(table: type[BaseModel]) -> dict[str, FieldInfo]:
    return {field.alias or name: field for name, field in table.model_fields.items()}


def _field(location: Sequence[int | str]) -> FieldInfo:
    return _fields(_table(location))[str(location[-1])]


def _unknown_key(location: Sequence[int | str]) -> str:
    known = list(_fields(_table(location)))
    near = get_close_matches(shown(str(location[-1])), known, n=1)
    if near:
        return f"unknown key; the nearest known one is {near[0]}"
    return f"unknown key; known ones are {', '.join(known)}"


def _kinds() -> str:
    return choices(list(KINDS))


def _shown(value: Any) -> str:
    text = repr(value) if not isinstance(value, bool) else str(value).lower()
    return text if len(text) <= 60 else f"{text[:57]}..."
