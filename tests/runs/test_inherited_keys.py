# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys that tables take from [joints], [segments] or by based_on, and what a case may leave out."""

import tomllib
from operator import add
from pathlib import Path

import jsonschema
import pytest

from protractile.runs.case.reading import load_spreads
from protractile.runs.case.schema import case_schema
from tests.runs.case_texts import box, elements, read_case, refusal, table
from tests.runs.summaries import printed_check
from tests.runs.test_drawing_keys import DRAWN, JACK, PEOPLE

PAD = {"length": 0.12, "width": 0.05, "thickness": "12 mm"}
ENDS = {"stations": ["tail", "head"], "play": 0.003}
SIDES = [{"side": side, **PAD} for side in ("above", "below")]
TIP = box("tip", 5.0, (0.20, 0.14, 0.006, 0.006))
BOOM = f"{DRAWN[: DRAWN.index('[[joint]]')]}{TIP}{JACK}"
FLY, LAST = {"outer": "base", "inner": "fly"}, {"outer": "fly", "inner": "tip"}
FACTORS = {"dead": [1.22, 1.1], "payload": 1.34, "wind": 0.0}
FIRST = {"name": "A", "factors": FACTORS, "resistance": {"material": 1.1, "pin": 1.25}}
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
    factors = FACTORS | second["factors"]
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
