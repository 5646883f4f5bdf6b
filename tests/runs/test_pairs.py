# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of pairs of a case: the first numbers rise, and those that reduce a strength fall."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest
from pydantic import AfterValidator

from protractile.geometry.fields import fields_of, names_of
from protractile.runs.case import messages
from protractile.runs.case.reading import load
from tests.runs.cantilever import CANTILEVER
from tests.runs.case_texts import COARSE, edited, refusal

# Pairs without an order: points around a section, and modes.
UNORDERED = {"corners", "shaper"}


def parts_of(annotation: Any) -> Iterator[Any]:
    """Yield all parts of a type, also the metadata of annotated types."""
    yield annotation
    for part in get_args(annotation):
        yield from parts_of(part)


def test_every_table_of_pairs_is_checked() -> None:
    """Reference: exhaustive, all keys of the schema whose values are pairs of numbers."""
    tables = [messages.schema.Case, *dict.fromkeys(messages._TABLES.values())]
    pairs, checked = set(), set()
    for table in tables:
        for key, name in names_of(table).items():
            field = fields_of(table)[name]
            found = [*field.metadata, *parts_of(field.annotation)]
            for part in found:
                inner = get_args(part)
                if len(inner) == 2 and inner[1] is ... and len(get_args(inner[0])) == 2:
                    both = get_args(inner[0])
                    if all(float in {*parts_of(one)} for one in both):
                        pairs.add(key)
            if any(
                isinstance(one, AfterValidator) and one.func.__qualname__.startswith("rising.")
                for one in found
            ):
                checked.add(key)
    assert {"curve", "table", "force_table", "yield_by_thickness"} <= pairs
    assert pairs - checked == UNORDERED


DENSITY = "density = 7850.0"
STRENGTHS = "yield_by_thickness = [[0.01, 3e8], [0.02, 4e8]]"
LOAD = "\n[[load]]\nsegment = 'beam'\nmagnitude = 1.0\ntable = "
LAW = "stiffness = 1e13\nexponent = 2.0\n"
DRIVE = "\n[slew]\ntable = "


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (f"{CANTILEVER}[buckling]\ncurve = [[2.0, 0.3], [0.0, 1.0]]",
         "buckling.curve: slendernesses must rise; entry 2 is below entry 1: sort them"),
        (f"{CANTILEVER}[buckling]\ncurve = [[0.0, 0.8], [1.0, 0.8], [2.0, 0.9]]",
         "buckling.curve: reduction factors must not rise; entry 3 is above entry 2"),
        # Its factor would hold for every slenderness.
        (f"{CANTILEVER}[buckling]\ncurve = [[0.0, 1.0]]",
         "buckling.curve: must have 2 pairs at least, got 1"),
        (edited(CANTILEVER, (DENSITY, f"{DENSITY}, {STRENGTHS}")),
         "material.yield_by_thickness: strengths must not rise; entry 2 is above entry 1"),
        (f"{CANTILEVER}{DRIVE}[[0.0, 0.0], [2.0, 9.0], [1.0, 5.0]]",
         "slew.table: times must rise; entry 3 is below entry 2: sort them"),
        (f"{CANTILEVER}{LOAD}[[0.0, 1.0], [0.0, 2.0]]",
         "load[1].table: times must rise; entry 2 repeats that of entry 1"),
        (edited(COARSE, (LAW, "force_table = [[2e-3, 9.0], [1e-3, 2.0]]\n")),
         "joint[1].force_table: depths must rise; entry 2 is below entry 1: sort them"),
    ],
)  # fmt: skip
def test_pairs_out_of_order_are_refused(tmp_path: Path, text: str, line: str) -> None:
    """Reference: exact words."""
    assert refusal(tmp_path, text) == line


def test_a_curve_may_stay_level(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    curve = "[[0.0, 1.0], [0.5, 1.0], [2.0, 0.3]]"
    path.write_text(f"{CANTILEVER}[buckling]\ncurve = {curve}", "utf-8")
    assert load(str(path)).buckling.curve == ((0.0, 1.0), (0.5, 1.0), (2.0, 0.3))
