# SPDX-License-Identifier: LGPL-3.0-or-later
"""Parser of ``--vary KEY=VALUES``.

KEY is a path in the case file, such as ``joint[1].play``, ``segment[2].span[2]`` or
``payload.mass``; indices start at 1. A path without an index, ``joint.play``, means all tables of
this name. VALUES are START:STOP:COUNT, evenly spaced, or a list such as 0.0,0.005,0.014.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from protractile.geometry.fields import is_number
from protractile.geometry.units import scale
from protractile.runs.case.amounts import innermost
from protractile.runs.case.limits import Steps, key_of, leaves, units_of
from protractile.runs.case.schema import Case
from protractile.runs.process.bad_input import BadInput

# A case as nested dictionaries and lists.
Tables = dict[str, Any]

# Tables without effect on sweeps, with the reason.
_NO_RUN = dict.fromkeys(("limits", "load_case", "combination", "spectrum"), "no run depends on it")
UNUSED = {"ensemble": "a sweep runs no ensembles", **_NO_RUN}

# Keys of histories and measured curves.
_CURVES = {"table", "force_table"}

# Maximum number of points: more would take weeks.
MOST_POINTS = 10_000

# Digits to which evenly spaced values are rounded, so that a finer sweep has the same values.
_DIGITS = 12

_STEP = re.compile(r"([^\[\]]+?)(?:\[([0-9]{1,9})\])?")
_WHOLE = re.compile(r"[0-9]{1,9}")
_REMEDY = "give KEY=START:STOP:COUNT or KEY=A,B,..."


@dataclass(frozen=True, slots=True)
class Place:
    """Location of a number in a case, as a path of keys and indices."""

    steps: Steps  #: keys and indices of the path
    size: Fraction = Fraction(1)  #: size of the number's unit in SI units

    @property
    def name(self) -> str:
        """The path as text for messages, with indices from 1."""
        return key_of(self.steps)

    def put(self, tables: Tables, value: Any) -> None:
        """Set the number in ``tables``, and create missing tables on its path."""
        here: Any = tables
        for step in self.steps[:-1]:
            here = here.setdefault(step, {}) if isinstance(step, str) else here[step]
        if isinstance(value, float):
            value = scale(value, self.size)
        # An integer is valid for keys of integers and of other numbers.
        whole = isinstance(value, float) and value.is_integer()
        here[self.steps[-1]] = int(value) if whole else value

    @property
    def shapes_sections(self) -> bool:
        """True if sections depend on the number; a play does not count."""
        if self.steps[0] == "segment":
            return self.steps[2:] == ("material", "density") or self.steps[2] in {
                "mass_per_length", "second_moment_of_area", "height_to_width", "section",
                "head_section",
            }  # fmt: skip
        return self.steps == ("material", "density")


@dataclass(frozen=True, slots=True)
class Variation:
    """One option ``--vary``: a key of the case, and its values."""

    key: str  #: key as the user gave it
    values: tuple[float, ...]  #: values, ascending, in the unit of the case
    places: tuple[Place, ...]  #: places of the numbers to which the key refers

    @property
    def shapes_sections(self) -> bool:
        """True if sections depend on the key; a play does not count."""
        return any(place.shapes_sections for place in self.places)


def parse(texts: Sequence[str], tables: Tables, file: str) -> list[Variation]:
    """Read all options KEY=VALUES for the tables of a case.

    Raises:
        BadInput: an option is invalid, or its key is not in the case.
    """
    variations: list[Variation] = []
    for text in texts:
        key, equals, numbers = (part.strip() for part in text.partition("="))
        option = f"--vary {key}"
        if not (key and equals):
            raise BadInput(file, f"--vary {text}", f"not understood; {_REMEDY}")
        if key in [variation.key for variation in variations]:
            raise BadInput(file, option, "given twice; give all its values at once")
        if (unused := UNUSED.get(key.split(".")[0].split("[")[0])) is not None:
            raise BadInput(file, option, f"{unused}; leave it out")
        try:
            variations.append(Variation(key, _values(numbers), find(key, tables)))
        except InvalidVariation as reason:
            raise BadInput(file, option, str(reason)) from None
    num_points = math.prod(len(variation.values) for variation in variations)
    if num_points > MOST_POINTS:
        raise BadInput(
            file, "--vary", f"{num_points} points are too many; at most {MOST_POINTS} are run"
        )
    return variations


def numbers(tables: Tables) -> Iterator[tuple[Place, float]]:
    """Yield all numbers in nested tables and lists with their places, except tabulated curves."""
    for steps, value in leaves(tables):
        if is_number(value) and _CURVES.isdisjoint(steps):
            yield Place(steps), value


def unit_of(place: Place, case: Case) -> str:
    """Return the SI unit of a number of a case; empty if dimensionless."""
    units = units_of(*innermost(place.steps, case))
    return units[0] if len(units) == 1 and units[0] != "1" else ""


def with_size(place: Place, case: Case) -> Place:
    """Return the place of a number with the size of the number's unit in a case."""
    return replace(place, size=case.system.size(unit_of(place, case) or "1"))


class InvalidVariation(Exception):
    """Error for a key that is not in the case, or for invalid values."""


def find(key: str, tables: Tables) -> tuple[Place, ...]:
    """Return the places of the numbers to which a key refers.

    Raises:
        InvalidVariation: the case has no such number.
    """
    steps = [_STEP.fullmatch(step) for step in key.split(".")]
    path = [(step[1], step[2] and int(step[2])) for step in steps if step is not None]
    if len(path) < len(steps):
        raise InvalidVariation("not understood; give a key such as joint[1].play")
    return tuple(_places(tables, path, Place(())))


def _places(
    here: Any, path: Sequence[tuple[str, int | str | None]], parent: Place
) -> Iterator[Place]:
    """Yield the places of all numbers at a path, also of keys that the case leaves out."""
    if not path:
        yield parent
        return
    (name, number), rest = path[0], path[1:]
    if not isinstance(here, Mapping):
        raise InvalidVariation(f"{parent.name} is not a table; end the key there")
    value = here.get(name)
    place = Place((*parent.steps, name))
    if value is None:
        # The schema decides whether the key is valid.
        yield from _places({}, rest, place)
        return
    tables = isinstance(value, list) and (not value or isinstance(value[0], Mapping))
    if tables and not value:
        raise InvalidVariation(f"the case has no {place.name}; there is nothing to vary")
    if isinstance(number, int):
        if not isinstance(value, list):
            raise InvalidVariation(f"{place.name} is not a list; leave out [{number}]")
        if not 1 <= number <= len(value):
            raise InvalidVariation(
                f"the case has no {place.name}[{number}], its last one is "
                f"{place.name}[{len(value)}]"
            )
        indices = [number - 1]
    elif tables and rest:
        indices = list(range(len(value)))
    else:
        yield from _places(value, rest, place)
        return
    for i in indices:
        yield from _places(value[i], rest, Place((*place.steps, i)))


def _values(text: str) -> tuple[float, ...]:
    parts = [part.strip() for part in text.split(":")]
    if len(parts) == 3 and not _WHOLE.fullmatch(parts[2]):
        raise InvalidVariation(f"COUNT must be a whole number, got {parts[2]!r}; {_REMEDY}")
    if len(parts) == 3:
        start, stop, count = _number(parts[0]), _number(parts[1]), int(parts[2])
        if not 2 <= count <= MOST_POINTS:
            raise InvalidVariation(f"COUNT must be from 2 to {MOST_POINTS}, got {count}")
        numbers = [float(f"{x:.{_DIGITS}g}") for x in np.linspace(start, stop, count)]
    elif len(parts) == 1:
        numbers = [_number(part) for part in text.split(",")]
    else:
        raise InvalidVariation(f"{text!r} is not understood; {_REMEDY}")
    if len(numbers) == 1:
        raise InvalidVariation("there is only one value; give two or more")
    if len(set(numbers)) < len(numbers):
        raise InvalidVariation(f"a value is given twice in {text!r}; give each once")
    return tuple(sorted(numbers))


def _number(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise InvalidVariation(f"must be finite numbers, got {text.strip()!r}; {_REMEDY}")
    return number
