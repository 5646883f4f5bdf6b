# SPDX-License-Identifier: LGPL-3.0-or-later
"""The JSON Schema that editors check case files against: right about good and bad ones."""

import copy
import json
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from runs import CASES
from runs.case import toml
from runs.case.reading import load
from runs.case.schema import case_schema

VALIDATOR = jsonschema.Draft202012Validator(case_schema())


def data(text: str) -> dict[str, Any]:
    """Return the content of a case file as an editor reads it."""
    read: dict[str, Any] = json.loads(json.dumps(tomllib.loads(text)))
    return read


def faults(case: dict[str, Any]) -> list[str]:
    return [fault.json_path for fault in VALIDATOR.iter_errors(case)]


def test_it_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(case_schema())
    assert case_schema()["$schema"] == "https://json-schema.org/draft/2020-12/schema"


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_schema_accepts_the_shipped_cases(path: Path) -> None:
    """As they are written, and as a run writes them again."""
    assert faults(data(path.read_text(encoding="utf-8"))) == []
    assert faults(data(toml.dumps(load(str(path))))) == []


def test_it_accepts_supports_and_modes_in_all_their_forms() -> None:
    case = data((CASES / "coarse.toml").read_text(encoding="utf-8"))
    case["segment"][0]["supports"] = [0, 1.5, {"x": 2.0, "kind": "clamped"}]
    for modes in (3, "auto"):
        case["model"][-1]["modes"] = modes
        assert faults(case) == []


def test_it_accepts_places_in_all_their_forms() -> None:
    case = data((CASES / "coarse.toml").read_text(encoding="utf-8"))
    case["segment"][1] |= {"length": 10.0}
    del case["segment"][1]["span"]
    case["segment"][0]["supports"] = ["tail", {"x": {"tail": 2.0}}]
    case["joint"][0] |= {"extension": 9, "stations": ["tail", {"head": 0.2}, 10]}
    case["units"] = "N-mm"
    assert faults(case) == []
    case["joint"][0]["stations"] = ["tip"]
    assert faults(case) == ["$.joint[0].stations[0]"]


@pytest.mark.parametrize(
    ("place", "value", "fault"),
    [
        (("durration",), 1.0, "$"), (("time", "duration"), "0.6", "$.time.duration"),
        (("time", "duration"), -1.0, "$.time.duration"), (("title",), "two\nlines", "$.title"),
        (("segment", 0, "supports"), [True], "$.segment[0].supports[0]"),
        (("segment", 0, "supports"), [{"y": 1.0}], "$.segment[0].supports[0]"),
        (("segment", 0, "span"), [0.0], "$.segment[0].span"),
        (("joint", 0, "stations"), [], "$.joint[0].stations"),
        (("joint", 0, "exponent"), 0.5, "$.joint[0].exponent"),
        (("model", 5, "modes"), 0, "$.model[5]"), (("model", 5, "modes"), "many", "$.model[5]"),
        (("model", 0, "kind"), "plate", "$.model[0]"),
    ],
)  # fmt: skip
def test_it_refuses_a_slip(place: tuple[str | int, ...], value: object, fault: str) -> None:
    case = copy.deepcopy(data((CASES / "coarse.toml").read_text(encoding="utf-8")))
    here: Any = case
    for step in place[:-1]:
        here = here[step]
    here[place[-1]] = value
    assert faults(case) == [fault]
