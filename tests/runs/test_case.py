# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reading, writing and selecting cases, and their JSON schema."""

import json
import re
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import protractile as pt
from protractile.geometry.walls import free_room
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import load, load_checked, select
from protractile.runs.case.schema import Case, EnsembleTable, case_schema
from protractile.runs.case.usual_values import usual_of_tables
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.rules import OF_INPUTS, cautions
from tests.runs.bad_edits import BAD_EDITS
from tests.runs.case_texts import (
    CASES,
    COARSE,
    adding,
    edited,
    joint,
    read_case,
    refusal,
    refused,
    replacing,
    shipped,
    table,
)
from tests.runs.test_real_booms import HOISTED, LIFT, told
from tests.touching import contact_laws


def test_any_text_and_number_survives_writing(tmp_path: Path) -> None:
    """Reference: the original text with quotes and escapes, and numbers with all digits."""
    title = 'quote " back\\slash é ∆ 𝔅'
    case = shipped("paper").model_copy(update={"title": title})
    joint = replace(case.joints[0], stiffness=1.0e13 / 3.0, stiffness_below=0.0)
    case = case.model_copy(update={"joints": (joint,), "demand": ("S1", "S5")})
    assert read_case(tmp_path, toml.dumps(case)) == case


def test_names_have_any_latin_letter(tmp_path: Path) -> None:
    """Reference: letters of German, Romanian and Vietnamese; a byte-order mark is no fault."""
    name = "Träger ß ẞ Țeavă Ống 2"
    text = COARSE.replace('"inner"', f'"{name}"').replace('"beam-fe"', f'"{name}"')
    case = read_case(tmp_path, text.encode("utf-8-sig"))
    assert {case.segments[1].name, case.models[2].name, case.joints[0].inner} == {name}


def test_the_paper_case_is_the_paper(paper_boom: pt.Boom) -> None:
    """Reference: external, the data of the paper, which gives no sections."""
    case = shipped("paper")
    boom = build_boom(case)
    own, paper = ([replace(s, section=None) for s in b.segments] for b in (boom, paper_boom))
    assert own == paper
    law = pt.PowerContact(1e13, 2.0)
    assert boom.joints == (replace(paper_boom.joints[0], contact=law),)


def test_a_section_goes_inwards_through_all_joints(tmp_path: Path) -> None:
    """Reference: analytic, the clearances of three segments, with joints in any order."""
    text = COARSE.replace("span = [9.0, 19.0]", "span = [9.0, 19.0]\nsupports = []")
    beam = {"mass_per_length": 40.0, "second_moment_of_area": 1.40e-4}
    third = table("[[segment]]", name="third", span=[18.0, 26.0], **beam)
    # The joint of the innermost segment comes first.
    inmost = joint("third", "inner", 0.008, (18.0, 19.0), "stiffness = 1e13")
    text = text.replace("[[joint]]", f"{third}{inmost}[[joint]]")
    text = text.replace("terms = [2, 2]", "terms = [2, 2, 2]")
    text = text.replace("terms = [2, 3]", "terms = [2, 3, 3]")
    outer, inner, innermost = (s.section for s in build_boom(read_case(tmp_path, text)).segments)
    assert free_room(outer, inner)[0] == pytest.approx(0.014, rel=1e-9)
    assert free_room(inner, innermost)[0] == pytest.approx(0.008, rel=1e-9)


def test_a_model_s_own_contact_law_keeps_the_joint_s_clearance() -> None:
    case = shipped("coarse")
    for model, law in ((case.models[0], (1e13, 2.0)), (case.models[2], (1e9, 1.0))):
        assert contact_laws(case, model)[0] == pt.PowerContact(*law).with_clearance(7.0e-3)


def test_selection_changes_models_and_ensembles() -> None:
    coarse = shipped("coarse")
    case = select(coarse, "coarse.toml", ["shell", "beam-fe"], 0.5, modes="12")
    assert [model.name for model in case.models] == ["beam-fe", "shell"]
    chosen = case.models[1].model_dump()
    assert [chosen[key] for key in ("mesh_size", "contact_tolerance", "modes")] == [0.5, "any", 12]
    some = select(coarse, "coarse.toml", members=7).ensemble
    assert (some.members, some.relative, some.seed, some.vary) == (7, 1e-9, 1, "load")
    paper = shipped("paper")
    assert paper.ensemble == EnsembleTable(members=32, relative=1e-9, seed=1, vary="load")
    changed = select(paper, "paper.toml", members=3).ensemble
    assert changed.model_dump() == {**paper.ensemble.model_dump(), "members": 3}
    assert select(paper, "paper.toml", members=0).ensemble is None


def test_every_key_is_described_and_no_other_is_allowed() -> None:
    jsonschema.Draft202012Validator.check_schema(case_schema())
    schema = Case.model_json_schema()
    for definition in [schema, *schema["$defs"].values()]:
        assert definition["additionalProperties"] is False
        for key, rule in definition["properties"].items():
            assert rule.get("description"), f"{definition['title']}.{key}"


@pytest.mark.parametrize(("edits", "line"), BAD_EDITS, ids=[line for _, line in BAD_EDITS])
def test_a_bad_case_is_refused(tmp_path: Path, edits: list[tuple[str, str]], line: str) -> None:
    """Reference: exact words."""
    assert refusal(tmp_path, edited(COARSE, *edits)) == line


ACROSS = {
    "slew": "[slew]\ntravel = 60.0\ntime = 9.0",
    "limits.tip_lateral": "[limits]\ntip_lateral = 0.1",
    "load[1].direction": "[gravity]\n[[load]]\nmagnitude = 1.0\ndirection = 'side'",
    "head.beside": "[gravity]\n[head]\nbeside = 0.2",
    "wind.direction": "[gravity]\n[wind]\nspeed = 1.0\nshape_factor = 1.2\ndirection = 'side'",
    "segment[2].lateral_load": "lateral_load = 20.0",
    "base[1].direction": "[[base]]\nacceleration = 1.0\ndirection = 'y'",
    "start.velocity.outer.lateral_turn": "[start]\nvelocity = { outer = { lateral_turn = 1.0 } }",
}


@pytest.mark.parametrize(("key", "text"), ACROSS.items())
def test_nothing_acts_across_a_flat_boom(tmp_path: Path, key: str, text: str) -> None:
    """Reference: exact words."""
    what = "the boom is flat, and nothing moves along 'y'; give the joints lateral_play"
    assert (
        refusal(tmp_path, edited(COARSE, ("[[joint]]", f"{text}\n[[joint]]"))) == f"{key}: {what}"
    )


@pytest.mark.parametrize(
    ("heading", "keys"),
    [
        ("segment", {"length": 1.0}), ("model", {"kind": "rigid"}), ("load_case", {}),
        ("combination", {"factors": {}}), ("observe", {"segment": "inner", "x": 9.0}),
    ],
)  # fmt: skip
def test_names_are_unique(tmp_path: Path, heading: str, keys: dict[str, Any]) -> None:
    """Reference: exact words."""
    text = COARSE + 2 * table(f"[[{heading}]]", name="same", **keys)
    first = COARSE.count(f"[[{heading}]]") + 1
    assert refusal(tmp_path, text) == (
        f"{heading}[{first + 1}].name: 'same' is the name of {heading}[{first}] already; "
        "give each its own"
    )


@pytest.mark.parametrize(
    ("content", "line"),
    [
        ("model = [3]\n" + COARSE[: COARSE.index("[[model]]")], "model[1]: must be a table, got 3"),
        (b'title = "a"\nx = "\xff"', "line 2: not UTF-8; save the file in this encoding"),
        (COARSE.replace("7850.0", "[" * 5000),
         "file: not TOML: nested too deeply; a case has three levels at most"),
        ('x = """',
         "file: not TOML: Unterminated string (at end of document); see https://toml.io"),
    ],
)  # fmt: skip
def test_a_bad_file_is_refused(tmp_path: Path, content: str | bytes, line: str) -> None:
    """Reference: exact words."""
    assert refusal(tmp_path, content) == line


@pytest.mark.usefixtures("here")
def test_unreadable_file_is_named_as_given() -> None:
    for path, what in ((".", "is a directory"), ("./../nowhere.toml", "does not exist")):
        with refused(f"{path}: file: {what}; give the path of a case file"):
            load(path)


@pytest.mark.parametrize(
    ("asked", "line"),
    [
        ({"members": 1}, "--members: must be from 2 to 10000, or 0 for no ensembles, got 1"),
        ({"models": ["shell", "plate"]}, "--models: 'plate' is not a model of the case; give "
         "'kantorovich-4', 'kantorovich-5', 'beam-fe', 'timoshenko', 'beam-fe-bonded' or 'shell'"),
        ({"mesh_size": -1.0}, "--mesh-size: must be a finite number of m above 0, got -1"),
        ({"mesh_size": 1e-9},
         "--mesh-size: 1e-09 m makes more than 2e+07 triangles; it must be at least 0.00176 m"),
        ({"models": ["beam-fe"], "mesh_size": 0.5},
         "--mesh-size: no shell is to be run; leave it out"),
        ({"modes": "many"}, "--modes: must be a whole number above 0, or auto, got 'many'"),
        ({"models": ["beam-fe"], "modes": "auto"},
         "--modes: no shell is to be run; leave it out"),
    ],
)  # fmt: skip
def test_refuses_a_selection_with_one_exact_line(asked: dict[str, Any], line: str) -> None:
    with refused(f"coarse.toml: {line}"):
        select(shipped("coarse"), "coarse.toml", **asked)


VALIDATOR = jsonschema.Draft202012Validator(case_schema())


def faults(case: dict[str, Any]) -> list[str]:
    return [fault.json_path for fault in VALIDATOR.iter_errors(json.loads(json.dumps(case)))]


@pytest.mark.parametrize("path", sorted(pt.CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_cases_are_valid_and_read_back_as_themselves(path: Path) -> None:
    """They have no cautions."""
    checked = load_checked(str(path))
    case = checked.case
    assert cautions(Context(case, checked.boom), OF_INPUTS) == []
    written = toml.dumps(case)
    assert faults(tomllib.loads(path.read_text(encoding="utf-8"))) == []
    assert faults(tomllib.loads(written)) == []
    assert Case.model_validate(tomllib.loads(written)) == case


def test_the_schema_accepts_keys_in_all_their_forms() -> None:
    case = tomllib.loads(COARSE)
    outer, inner = case["segment"]
    outer["supports"] = [0, 1.5, {"x": 2.0, "kind": "clamped"}, "tail", {"x": {"tail": 2.0}}]
    inner["length"] = inner.pop("span")[1]
    case["joint"][0] |= {"extension": 9, "stations": ["tail", {"head": 0.2}, 10]}
    case["units"] = "N-mm"
    for modes in (3, "auto"):
        case["model"][-1]["modes"] = modes
        assert faults(case) == []


@pytest.mark.parametrize(
    ("place", "value"),
    [
        ("durration", 1.0), ("time.duration", "0.6"), ("time.duration", -1.0),
        ("title", "two\nlines"), ("segment.0.supports.0", True), ("segment.0.span", [0.0]),
        ("segment.0.supports.0", {"y": 1.0}), ("segment.0.collars", [{"span": [1.0, 2.0],
         "thickness": 0.0}]), ("joint.0.stations", []), ("joint.0.stations.0", "tip"),
        ("model.5.modes", 0), ("model.5.modes", "many"), ("model.0.kind", "plate"),
        ("gravity", {"angle": 100.0}),
    ],
)  # fmt: skip
def test_the_schema_refuses_a_slip(place: str, value: object) -> None:
    case = tomllib.loads(COARSE)
    here: Any = case
    *steps, key = (int(step) if step.isdigit() else step for step in place.split("."))
    for step in steps:
        here = here[step]
    here[key] = value
    (fault,) = faults(case)
    expected = re.sub(r"\.(\d+)", r"[\1]", f"$.{place}")
    assert fault.startswith(expected) or expected.startswith(fault)


# Keys without a range of their own, as TABLE.KEY or KEY, by reason.
EXEMPT = {
    "its place is checked on its segment": (
        "x", "from", "to", "span", "across", "stations", "locked_at", "supports", "Distance",
    ),
    "its range follows from its material and section (part_ranges)": (
        "youngs_modulus", "density", "yield_strength", "yield_strengths", "mass_per_length",
        "added_mass_per_length", "torsion_constant", "second_moment_of_area",
        "lateral_second_moment_of_area",
    ),
    "the sizes of the whole section have ranges (part_ranges)": (
        "SectionTable", "UnequalBoxTable", "PolygonTable", "HexagonTable", "OctagonTable", "UTable",
    ),
    "its range follows from the joint or the cylinder (sanity)": (
        "JointTable.play", "lateral_play", "extension", "JointTable.stroke",
        "JointTable.retracted", "ground", "EarthPoint",
    ),
    "its range follows from the boom (chart.run)": ("ChartTable",),
    "any angle": ("LoadTable.direction", "WindPressureTable.direction"),
    "a part of the play, which is checked": ("play_above", "lateral_play_right"),
    "its section is compared with it (part_ranges)": ("SegmentTable.length",),
    "loads are compared with the weight of the boom (cautions.loads)": (
        "load", "LoadCaseTable.wind",
    ),
    "the range of its table": ("velocity",),
    "the limit is that of the mesh or of the cost (check)": (
        "mesh_size", "element_length", "Shell.modes",
    ),
    "a reading is compared with the model (runs.measured)": ("Channel",),
    "its unit depends on the law of a joint, and its row on the mesh": ("surface_stiffness",),
}  # fmt: skip


def with_subclasses(part: type) -> set[str]:
    return {part.__name__}.union(*map(with_subclasses, part.__subclasses__()))


def test_each_number_of_the_schema_has_a_range() -> None:
    """Reference: the schema; an exemption that a range has made superfluous fails, too."""
    checked = load_checked(str(CASES / "lift.toml"))
    ranges = usual_of_tables(checked.case, checked.boom)
    ranged = {f"{name}.{key}" for part in ranges for name in with_subclasses(part)
              for key in ranges[part]}  # fmt: skip
    exempt = {key for keys in EXEMPT.values() for key in keys}
    schema = Case.model_json_schema()
    wrong, used = [], set()
    for name, definition in {"Case": schema, **schema["$defs"]}.items():
        for key, rule in definition["properties"].items():
            text = json.dumps(rule)
            number = '"number"' in text or '"integer"' in text
            if number and not ("inimum" in text and "aximum" in text):
                names = {key, name, f"{name}.{key}"} & exempt
                used |= names
                if (f"{name}.{key}" in ranged) == bool(names):
                    wrong.append(f"{name}.{key}")
    assert wrong == []
    assert used == exempt


STOP = "[[stop]]\nsegment = 'fly'\nx = 11.0\nplay = {}\nstiffness = {}\n[ensemble]"
SHAKEN = (
    edited(LIFT, ("wind = 1.1", "wind = 1.1, dynamic = 1.0")).replace(
        '"equilibrium"', '"equilibrium", velocity = { fly = 0.1 }'
    )
    + """
[[base]]
acceleration = 1.0
frequency = 2.0
[ensemble]
members = 3
[damping]
mass = 0.1
[limits]
tip = 0.2
"""
)


SENSELESS = [
    *replacing("tip = 0.2", {
        "tip = 50.0": "limits.tip", "stress = 235.0": "limits.stress",
        "pad_pressure = 20.0": "limits.pad_pressure", "decay_time = 1e-6": "limits.decay_time",
        "first_frequency = 1e6": "limits.first_frequency",
    }),
    ("members = 3", "members = 3\nrelative = 0.5", "ensemble.relative"),
    *replacing("frequency = 2.0", {
        "frequency = 1e9": "base[1].frequency", "half_sine = 1e-9": "base[1].half_sine",
        "ramp = 1e-12": "base[1].ramp",
        "table = [[0.0, 0.0], [1.0, 1e308]]": "base[1].acceleration",
    }),
    ("acceleration = 1.0", "acceleration = 9810.0", "base[1].acceleration"),
    ("magnitude = -30.0", "magnitude = -1e300", "load_case[1].load[1].magnitude"),
    ("mass = 0.1", "mass = 1e6", "damping.mass"),
    ("mass = 0.1", "stiffness = 50.0", "damping.stiffness"),
    ("fly = 0.1", "fly = 500.0", "start.velocity.fly.z"),
    ("fly = 0.1", "fly = { turn = 1e5 }", "start.velocity.fly.turn"),
    *adding("play = 0.003", {
        "friction = 0.1\nnormal_forces = [1e9, 1e9]": "joint[1].normal_forces",
        "dashpot = 1e12": "joint[1].dashpot",
        "restitution = { coefficient = 1e-3, speed = 0.1 }": "joint[1].restitution.coefficient",
        "restitution = { coefficient = 0.5, speed = 1e3 }": "joint[1].restitution.speed",
    }),
    ("length = 0.12", "length = 1e-6", "joint[1].pad.length"),
    ("width = 0.05", "width = 1e-6", "joint[1].pad.width"),
    ("thickness = 0.012", "thickness = 0.012, modulus = 1.9", "joint[1].pad.modulus"),
    ("stiffness = 30000000.0", "stiffness = 30000000.0\ndashpot = 1e15", "cylinder[1].dashpot"),
    ("depth = 0.25", "depth = 250.0", "cylinder[1].depth"),
    ("[ensemble]", STOP.format(50.0, 1e6), "stop[1].play"),
    ("[ensemble]", STOP.format(0.1, 1e30), "stop[1].stiffness"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "key"), SENSELESS)
def test_numbers_without_sense_are_told(tmp_path: Path, old: str, new: str, key: str) -> None:
    """Reference: the key; ``test_sanity`` has exact words."""
    assert told(tmp_path, SHAKEN) == []
    lines = [line.removeprefix("caution: ") for line in told(tmp_path, edited(SHAKEN, (old, new)))]
    assert any(re.match(rf"{re.escape(key)}: .* is .*, usual is ", line) for line in lines), lines


def test_metres_in_millimetres_are_cautioned(tmp_path: Path) -> None:
    """Reference: exact words of a hoist of 5 m, whose case is in mm."""
    text = re.sub(r"(?ms)^\[rope\].*?(?=^\[)", "", HOISTED)
    before, hoist = text.split("[hoist]")
    hoist = re.sub(r"(?m)^travel = .*", "travel = 0.005", hoist, count=1)
    what = "the length of hoisting is 5 mm, usual is from 79.8 up to 2e+05 mm; if it is in m, give"
    lines = told(tmp_path, f'shown_units = "mm-t-s"\n{before}[hoist]{hoist}')
    assert f"caution: hoist.travel: {what} 5000 mm" in lines
