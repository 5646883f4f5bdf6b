# SPDX-License-Identifier: LGPL-3.0-or-later
"""Numbers of a case as text with their units."""

import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from protractile.cases import load_case
from protractile.runs import CASES
from protractile.runs.case.amounts import innermost, read_amounts
from protractile.runs.case.inherited import with_inherited_keys
from protractile.runs.case.limits import Steps, leaves, units_of
from protractile.runs.case.reading import load_spreads
from protractile.runs.case.schema import Case, case_schema
from tests.runs.case_texts import HINGED, read_case, refusal, table
from tests.runs.test_drawing_keys import DRAWN, FACTORS, JACK, PEOPLE
from tests.runs.test_drawing_places import CAGE, RAM

MORE = (
    table("[wind]", pressure=125.0, direction=180.0, shape_factor=1.4, load_area=0.8)
    + table("[[load_case]]", name="storm", wind=800.0, extension={"fly": 3.0}, angle=30.0)
    + table("[[load]]", segment="fly", x="head", magnitude=350.0, moment=True)
    + table("[[load]]", segment="fly", magnitude=-12.0, table=[[0.0, 0.0], [0.5, 1.0]])
    + table("[[stop]]", segment="fly", x=9.0, play=0.2, stiffness=3e9, exponent=2.0)
    + table("[[model]]", name="soft", kind="rigid", contact={"stiffness": 5e6, "exponent": 1.0})
    + table("[start.velocity]", fly=0.1, base={"turn": 0.02})
)


def with_units(text: str, units: str) -> dict[str, Any]:
    """Return the tables of a case in SI units with all numbers as text, in other units."""
    tables = with_inherited_keys(tomllib.loads(text), "case")
    case = Case.model_validate(tables)
    given: list[tuple[Steps, str]] = []
    for steps, value in leaves(tables):
        if isinstance(value, float):
            table_of, name = innermost(steps, case)
            of = units_of(table_of, name)
            column = steps[-1] if len(of) > 1 else 0
            unit = of[column if isinstance(column, int) else 0]
            if unit != "1":
                given.append((steps, f"{value!r} {unit}"))
    for steps, text_of in given:
        here: Any = tables
        for step in steps[:-1]:
            here = here[step]
        here[steps[-1]] = text_of
    assert len(given) > 40
    return tables | {"units": units}


@pytest.mark.parametrize("units", ["SI", "mm-t-s"])
@pytest.mark.parametrize(
    "text",
    [
        DRAWN.replace(HINGED, f"{HINGED[:-1]}, 1.5]") + JACK + PEOPLE + FACTORS + CAGE + RAM + MORE,
        (CASES / "crane-proof.toml").read_text(encoding="utf-8"),
    ],
)
def test_every_number_may_have_its_unit(text: str, units: str) -> None:
    """Reference: other input, the same case with numbers in SI units."""
    tables = with_units(text, units)
    jsonschema.validate(tables, case_schema())
    shown = None if units == "SI" else units
    expected = load_case(tomllib.loads(text)).model_copy(update={"shown_units": shown})
    assert load_case(tables) == expected


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("150 kg", 0.15), ("0.28t", 0.28), ("200 bar", 20.0), ("800 Pa", 8e-4), ("5 %", 0.05),
        ("7850 kg/m³", 7.85e-9), ("2.1e5 N/mm²", 2.1e5), ("3 kN/mm", 3e3), ("30°", 30.0),
        ("72 km/h", 20000.0),
        ("7.2 m", 7200.0), ("-1.5 kNm", -1.5e6), ("9.81 m/s^2", 9810.0), (" 40 kN ", 4e4),
    ],
)  # fmt: skip
def test_a_text_is_a_number_in_the_units_of_the_case(text: str, number: float) -> None:
    """Reference: analytic, powers of ten."""
    plain, _ = read_amounts({"units": "mm-t-s", "load": [{"magnitude": text}]}, "case")
    assert plain["load"][0]["magnitude"] == number


def test_names_stay_as_they_are() -> None:
    """Reference: the same tables, with names that look like amounts."""
    tables = {
        "title": "40 t",
        "segment": [{"name": "12 m", "supports": ["tail"]}],
        "load": [{"segment": "12 m", "direction": "side"}],
    }
    assert read_amounts(tables, "case") == (tables, [])


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (table("[head]", ahead="300 kg"),
         "head.ahead: must be a length, such as in m, got '300 kg'"),
        (table("[[load]]", segment="fly", x="head", magnitude="5 kN/m"),
         "load[1].magnitude: must be a force, such as in N, got '5 kN/m'"),
        (table("[luff]", travel="0.1 rad", time="9 s"),
         "luff.travel: must be an angle, such as in deg, got '0.1 rad'"),
        (table("[damping]", modal="0.5 deg"),
         "damping.modal: must be in % or another unit of the kind, got '0.5 deg'"),
        (table("[head]", ahead="300 furlong"),
         "head.ahead: must have a known unit such as mm, kg, kN or MPa, got '300 furlong'"),
        *(
            (table("[head]", ahead=text),
             f"head.ahead: must have a known unit such as mm, kg, kN or MPa, got '{text}'")
            for text in ("1.2.3 m", "3 m^60 m^60", "3 GPa^30.5 GPa^30.5", "3 m/")
        ),
        *(
            (table("[head]", mass=text),
             f"head.mass: must be one number with one unit, got '{text}'")
            for text in ("2 x 100 kg", "2*100 kg", "9.4 kg + 0.25 kg", "9.4 kg 0.25 kg")
        ),
        (table("[head]", ahead="0,3 m"), "head.ahead: must be a number, got '0,3 m'"),
        (table("[head]", mass="-3 kPa"),
         "head.mass: must be a mass, such as in kg, got '-3 kPa'"),
        (table("[damping]", modal="3 kg"),
         "damping.modal: must be in % or another unit of the kind, got '3 kg'"),
        (table("[head]", mass="900"),
         "head.mass: has no unit; give one, or the number without quotes, got '900'"),
        (table("[head]", mass="-3 kg"), "head.mass: must be a number not less than 0, got -3.0"),
        (table("[[stop]]", segment="fly", x=9.0, play=0.2, stiffness="3e9 N/m^2"),
         "stop[1].stiffness: must be in N/m or another unit of the kind, got '3e9 N/m^2'"),
        (table("[head]", mass="1e999 kg"),
         "units: a number is too large for SI units; look for one that is out of proportion"),
    ],
)  # fmt: skip
def test_other_units_are_refused(tmp_path: Path, text: str, line: str) -> None:
    assert refusal(tmp_path, DRAWN + JACK + text) == line


@pytest.mark.parametrize(
    ("place", "line"),
    [
        ("{ tail = -180 }", "the distance from the tail must not be negative, got -180"),
        ("'near'", "must be a number of mm, 'tail', 'head' or a distance in mm from one of them "
         "such as { tail = 200 }, got 'near'"),
        ("'2 %'", "must be a length, such as in mm, got '2 %'"),
    ],
)  # fmt: skip
def test_messages_have_the_units_of_the_case(tmp_path: Path, place: str, line: str) -> None:
    """Reference: exact words."""
    text = "units = 'mm-t-s'" + DRAWN.replace("x = 0.0", f"x = {place}", 1) + JACK
    assert refusal(tmp_path, text) == f"segment[1].supports[1].x: {line}"


def test_distributions_have_units(tmp_path: Path) -> None:
    """Reference: analytic, t in mm-t-s."""
    text = DRAWN.replace("mass = 150.0", 'mass = { mean = "150 kg", sd = "0.002 t" }') + JACK
    assert read_case(tmp_path, text).payload == read_case(tmp_path, DRAWN + JACK).payload
    read_case(tmp_path, text)
    (spread,) = load_spreads(str(tmp_path / "case.toml"))
    assert (spread.steps, spread.mean, spread.sd) == (("payload", "mass"), 150.0, 2.0)
