# SPDX-License-Identifier: LGPL-3.0-or-later
"""Parser of ``--vary KEY=VALUES``.

KEY is a path in the case file, such as ``joint[1].play``, ``segment[2].span[2]``,
``payload.mass``; indices start at 1. Without an index it means all tables: ``joint.play``. VALUES
are START:STOP:COUNT, evenly spaced, or a list 0.0,0.005,0.014.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from geometry.fields import is_number, names_of
from runs.case.limits import is_table, units_of
from runs.case.messages import BadInput
from runs.case.schema import PLAIN_NUMBER_KEYS, Case
from runs.case.units import scale

# A case file as plain tables and lists.
Tables = dict[str, Any]

# Tables that have no effect on runs of a sweep, with the reason.
_NO_RUN = dict.fromkeys(("limits", "load_case", "combination", "spectrum"), "no run depends on it")
UNUSED = {"ensemble": "a sweep runs no ensembles", **_NO_RUN}

# Keys of histories and measured curves.
_CURVES = {"table", "force_table"}

# Maximum number of points: more would take weeks.
MOST_POINTS = 10_000

# Digits of evenly spaced numbers. Rounding makes the points of a finer sweep contain them.
_DIGITS = 12

_STEP = re.compile(r"([^\[\]]+?)(?:\[([0-9]{1,9})\])?")
_WHOLE = re.compile(r"[0-9]{1,9}")
_REMEDY = "give KEY=START:STOP:COUNT or KEY=A,B,..."


@dataclass(frozen=True, slots=True)
class Place:
    """Location of a number in a case."""

    steps: tuple[str | int, ...]  #: keys and indices of the path
    size: Fraction = Fraction(1)  #: size in SI units of the unit of the case

    @property
    def name(self) -> str:
        """The name in messages, with indices from 1."""
        parts = (f".{step}" if isinstance(step, str) else f"[{step + 1}]" for step in self.steps)
        return "".join(parts).removeprefix(".")

    def put(self, tables: Tables, value: Any) -> None:
        """Set the number, and create missing tables on its path."""
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
        """True if the number determines a section; the play does not count."""
        if self.steps[0] == "segment":
            return self.steps[2:] == ("material", "density") or self.steps[2] in {
                "mass_per_length", "second_moment_of_area", "height_to_width", "section",
                "head_section",
            }  # fmt: skip
        return self.steps == ("material", "density")


@dataclass(frozen=True, slots=True)
class Variation:
    """One option ``--vary``."""

    key: str  #: key as the user gave it
    values: tuple[float, ...]  #: values, ascending, in the unit of the case
    places: tuple[Place, ...]  #: numbers that get the same value

    @property
    def shapes_sections(self) -> bool:
        """True if the key determines a section; the play does not count."""
        return any(place.shapes_sections for place in self.places)


def parse(texts: Sequence[str], tables: Tables, file: str) -> list[Variation]:
    """Read all ``--vary`` options.

    Args:
        texts: options KEY=VALUES.
        tables: case to which the keys refer.
        file: file of the case, for messages.

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
        except Unplaced as reason:
            raise BadInput(file, option, str(reason)) from None
    num_points = math.prod(len(variation.values) for variation in variations)
    if num_points > MOST_POINTS:
        raise BadInput(
            file, "--vary", f"{num_points} points are too many; at most {MOST_POINTS} are run"
        )
    return variations


def numbers(here: Any, steps: tuple[str | int, ...] = ()) -> Iterator[tuple[Place, float]]:
    """Yield the numbers of tables and lists with their places, except numbers of curves."""
    if isinstance(here, Mapping):
        for key, value in here.items():
            if key not in _CURVES:
                yield from numbers(value, (*steps, key))
    elif isinstance(here, list):
        for index, value in enumerate(here):
            yield from numbers(value, (*steps, index))
    elif is_number(here):
        yield Place(steps), here


def unit_of(place: Place, case: Case) -> str:
    """Return the SI unit of a number of a case; empty if dimensionless."""
    here: Any = case
    units: tuple[str, ...] = ()
    for step in place.steps:
        if is_table(here):
            name = names_of(type(here))[str(step)]
            units, here = units_of(here, name), getattr(here, name)
        else:
            here = here[step]
    if type(here) in PLAIN_NUMBER_KEYS:
        units = units_of(here, PLAIN_NUMBER_KEYS[type(here)])
    return units[0] if len(units) == 1 and units[0] != "1" else ""


class Unplaced(Exception):
    """Error for a key that is not in the case, or an option without values."""


def find(key: str, tables: Tables) -> tuple[Place, ...]:
    """Return the numbers of a case to which a key refers.

    Raises:
        Unplaced: the case has no such number.
    """
    steps = [_STEP.fullmatch(step) for step in key.split(".")]
    path = [(step[1], step[2] and int(step[2])) for step in steps if step is not None]
    if len(path) < len(steps):
        raise Unplaced("not understood; give a key such as joint[1].play")
    return tuple(_places(tables, path, Place(())))


def _places(
    here: Any, path: Sequence[tuple[str, int | str | None]], before: Place
) -> Iterator[Place]:
    """Yield all numbers at a path, including missing ones."""
    if not path:
        yield before
        return
    (name, number), rest = path[0], path[1:]
    if not isinstance(here, Mapping):
        raise Unplaced(f"{before.name} is not a table; end the key there")
    value = here.get(name)
    place = Place((*before.steps, name))
    if value is None:
        # The schema decides whether the key is valid.
        yield from _places({}, rest, place)
        return
    tables = isinstance(value, list) and (not value or isinstance(value[0], Mapping))
    if tables and not value:
        raise Unplaced(f"the case has no {place.name}; there is nothing to vary")
    if isinstance(number, int):
        if not isinstance(value, list):
            raise Unplaced(f"{place.name} is not a list; leave out [{number}]")
        if not 1 <= number <= len(value):
            raise Unplaced(
                f"the case has no {place.name}[{number}], its last one is "
                f"{place.name}[{len(value)}]"
            )
        chosen = [number - 1]
    elif tables and rest:
        chosen = list(range(len(value)))
    else:
        yield from _places(value, rest, place)
        return
    for i in chosen:
        yield from _places(value[i], rest, Place((*place.steps, i)))


def _values(text: str) -> tuple[float, ...]:
    parts = [part.strip() for part in text.split(":")]
    if len(parts) == 3 and not _WHOLE.fullmatch(parts[2]):
        raise Unplaced(f"COUNT must be a whole number, got {parts[2]!r}; {_REMEDY}")
    if len(parts) == 3:
        start, stop, count = _number(parts[0]), _number(parts[1]), int(parts[2])
        if not 2 <= count <= MOST_POINTS:
            raise Unplaced(f"COUNT must be from 2 to {MOST_POINTS}, got {count}")
        numbers = [float(f"{x:.{_DIGITS}g}") for x in np.linspace(start, stop, count)]
    elif len(parts) == 1:
        numbers = [_number(part) for part in text.split(",")]
    else:
        raise Unplaced(f"{text!r} is not understood; {_REMEDY}")
    if len(numbers) == 1:
        raise Unplaced("there is only one value; give two or more")
    if len(set(numbers)) < len(numbers):
        raise Unplaced(f"a value is given twice in {text!r}; give each once")
    return tuple(sorted(numbers))


def _number(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise Unplaced(f"must be finite numbers, got {text.strip()!r}; {_REMEDY}")
    return number
