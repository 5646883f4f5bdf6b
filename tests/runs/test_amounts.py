# SPDX-License-Identifier: LGPL-3.0-or-later
"""Amounts with units, and keys that tables inherit."""

import tomllib
from operator import add
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
from tests.runs.case_texts import HINGED, box, elements, read_case, refusal, table
from tests.runs.summaries import printed_check
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


PAD = {"length": 0.12, "width": 0.05, "thickness": "12 mm"}
ENDS = {"stations": ["tail", "head"], "play": 0.003}
SIDES = [{"side": side, **PAD} for side in ("above", "below")]
TIP = box("tip", 5.0, (0.20, 0.14, 0.006, 0.006))
BOOM = f"{DRAWN[: DRAWN.index('[[joint]]')]}{TIP}{JACK}"
FLY, LAST = {"outer": "base", "inner": "fly"}, {"outer": "fly", "inner": "tip"}
OWN_FACTORS = {"dead": [1.22, 1.1], "payload": 1.34, "wind": 0.0}
FIRST = {"name": "A", "factors": OWN_FACTORS, "resistance": {"material": 1.1, "pin": 1.25}}
LOW = {"name": "low", "angle": 10.0, "payload": 230.0, "wind": {"pressure": 800.0}}
WIND = table("[wind]", pressure=125.0, shape_factor=1.4)


@pytest.mark.parametrize(
    ("short", "long"),
    [
        (
            table("[joints]", **ENDS, stroke=4.0, pad=PAD)
            + table("[[joint]]", **FLY, extension=3.5)
            + table("[[joint]]", **LAST, play=0.002, pad={"width": 0.04}),
            table("[[joint]]", **FLY, **ENDS, extension=3.5, pad=PAD)
            + table("[[joint]]", **LAST, **ENDS | {"play": 0.002}, stroke=4.0,
                    pad=PAD | {"width": 0.04}),
        ),
        (
            table("[joints]", **ENDS, extension=4.0, pad=PAD)
            + table("[[joint]]", **FLY) + table("[[joint]]", **LAST, pads=SIDES),
            table("[[joint]]", **FLY, **ENDS, extension=4.0, pad=PAD)
            + table("[[joint]]", **LAST, **ENDS, extension=4.0, pads=SIDES),
        ),
    ],
)  # fmt: skip
def test_joints_have_the_keys_that_they_leave_out(tmp_path: Path, short: str, long: str) -> None:
    """Reference: other input, each joint with all of its keys."""
    text = BOOM + elements("second", theory="timoshenko")
    jsonschema.validate(tomllib.loads(text + short), case_schema())
    assert read_case(tmp_path, text + short) == read_case(tmp_path, text + long)


def test_segments_have_the_keys_that_they_leave_out(tmp_path: Path) -> None:
    """Reference: other input, each segment with all of its keys."""
    text = BOOM + table("[[joint]]", **FLY, **ENDS, extension=4.0, pad=PAD)
    text += table("[[joint]]", **LAST, **ENDS, extension=4.0, pad=PAD)
    steel: dict[str, object] = {"youngs_modulus": 2.1e11, "poissons_ratio": 0.3, "density": 7850.0}
    common = {"added_mass_per_length": 6.0, "material": steel}
    own = [{"added_mass_per_length": "14 kg/m"}, {"material": {"yield_strength": 9e8}}, {}]
    whole = [common | own[0], common | {"material": steel | own[1]["material"]}, common]
    first, *others = text.split("[[segment]]")
    cases = []
    for several, more in ((own, table("[segments]", **common, span=[0.0, 9.0])), (whole, "")):
        parts = (table("[[segment]]", **keys) for keys in several)
        edited = first + "".join(map(add, parts, others)) + more
        jsonschema.validate(tomllib.loads(edited), case_schema())
        cases.append(read_case(tmp_path, edited))
    assert cases[0] == cases[1]


def test_a_table_based_on_another_has_its_other_keys(tmp_path: Path) -> None:
    """Reference: other input, each load case and combination with all of its keys."""
    high, still = {"name": "high", "angle": 60.0}, {"name": "still", "wind": 0.0}
    second = {"name": "B", "factors": {"payload": 1.22, "wind": 1.16}}
    third = {"name": "C", "load_cases": ["high"], "resistance": {"pin": 1.0}}
    based = [
        ("load_case", [LOW, {**high, "based_on": "low"}, {**still, "based_on": "high"}]),
        ("combination", [FIRST, {**second, "based_on": "A"}, {**third, "based_on": "B"}]),
    ]
    factors = OWN_FACTORS | second["factors"]
    whole = [
        ("load_case", [LOW, LOW | high, LOW | high | still]),
        (
            "combination",
            [
                FIRST,
                FIRST | second | {"factors": factors},
                FIRST | third | {"factors": factors, "resistance": {"material": 1.1, "pin": 1.0}},
            ],
        ),
    ]
    cases = []
    for several in (based, whole):
        text = "".join(table(f"[[{key}]]", **one) for key, tables in several for one in tables)
        jsonschema.validate(tomllib.loads(DRAWN + JACK + WIND + text), case_schema())
        cases.append(read_case(tmp_path, DRAWN + JACK + WIND + text))
    assert cases[0] == cases[1]
    assert cases[0].combinations[2].resistance.pin == 1.0


def test_each_joint_has_its_own_scatter(tmp_path: Path) -> None:
    """Reference: analytic, one distribution for each of two joints."""
    joints = table("[joints]", **ENDS | {"play": {"mean": 0.003, "sd": 0.0004}}, pad=PAD)
    text = BOOM + joints + "".join(table("[[joint]]", **one, extension=4.0) for one in (FLY, LAST))
    assert [joint.play for joint in read_case(tmp_path, text).joints] == [0.003] * 2
    places = [spread.steps for spread in load_spreads(str(tmp_path / "case.toml"))]
    assert places == [("joint", 0, "play"), ("joint", 1, "play")]


def test_statics_need_neither_duration_nor_model(tmp_path: Path) -> None:
    """Reference: other input, 2 s and a Timoshenko beam."""
    model = elements("beam", theory="timoshenko")
    text = (DRAWN + JACK + PEOPLE).replace(model, "").replace("time = { duration = 1.0 }\n", "")
    case = read_case(tmp_path, text)
    jsonschema.validate(tomllib.loads(text), case_schema())
    expected = text + table("[time]", duration=2.0) + elements("timoshenko", theory="timoshenko")
    assert case == read_case(tmp_path, expected)
    assert "Largest results" in printed_check(case)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (table("[[combination]]", **FIRST, based_on="B"),
         "combination[1].based_on: must be the name of a combination before it, got 'B'"),
        (PEOPLE + table("[[load_case]]", name="low", based_on=["people"]),
         "load_case[2].based_on: must be the name of a load_case before it, got ['people']"),
        (table("[joints]", colour=1), "joint[1].colour: unknown key; known ones are "),
        (table("[segments]", colour=1), "segment[1].colour: unknown key; the nearest"),
        (table("[[joints]]", play=1.0), "joints: unknown key; the nearest known one is joint"),
    ],
)  # fmt: skip
def test_unknown_names_and_keys_are_refused(tmp_path: Path, text: str, line: str) -> None:
    assert refusal(tmp_path, DRAWN + JACK + text).startswith(line)


def test_a_history_needs_a_duration(tmp_path: Path) -> None:
    """Reference: exact words."""
    text = (DRAWN + JACK).replace("time = { duration = 1.0 }\n", "")
    for more, key in (
        (WIND + "ramp = 3.0\n", "wind"),
        (table("[luff]", travel=5.0, time=9.0), "luff"),
    ):
        assert refusal(tmp_path, text + more) == (
            f"time.duration: missing, and {key} changes over time; it is the simulated time in s, "
            "from t = 0; 2 s unless given, if nothing changes over time"
        )
