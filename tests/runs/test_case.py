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

from protractile.dynamics.contact import PowerContact
from protractile.geometry.boom import Boom
from protractile.geometry.walls import free_room
from protractile.runs import CASES
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.reading import load, select
from protractile.runs.case.schema import Case, EnsembleTable, case_schema
from tests.runs.bad_edits import BAD_EDITS
from tests.runs.case_texts import COARSE, joint, read_case, refusal, refused, shipped, table
from tests.touching import contact_laws


def test_beam_elements_are_shear_flexible_unless_the_case_says_otherwise(tmp_path: Path) -> None:
    case = read_case(tmp_path, COARSE.replace('theory = "euler-bernoulli"\n', ""))
    theories = {model.theory for model in case.models if isinstance(model, BeamElements)}
    assert theories == {"timoshenko"}


def test_any_text_and_number_survives_writing(tmp_path: Path) -> None:
    """Reference: the original text with quotes and escapes, and numbers with all digits."""
    title = 'quote " back\\slash é ∆ 𝔅'
    case = shipped("paper").model_copy(update={"title": title})
    joint = replace(case.joints[0], stiffness=1.0e13 / 3.0, stiffness_below=0.0)
    case = case.model_copy(update={"joints": (joint,), "demand": ("S1", "S5")})
    assert read_case(tmp_path, toml.dumps(case)) == case


@pytest.mark.parametrize("name", ["Träger ß", "flèche 2", "Țeavă ẞ", "Žebrík", "Ống 2"])
def test_names_have_any_latin_letter(tmp_path: Path, name: str) -> None:
    """Reference: the letters of German, French, Romanian, Slovak and Vietnamese."""
    text = COARSE.replace('"inner"', f'"{name}"').replace('"beam-fe"', f'"{name}"')
    case = read_case(tmp_path, text)
    assert (case.segments[1].name, case.models[2].name) == (name, name)
    assert case.joints[0].inner == name


def test_the_paper_case_is_the_paper(paper_boom: Boom) -> None:
    """Reference: external, the data of the paper, which gives no sections."""
    case = shipped("paper")
    boom = build_boom(case)
    own, paper = ([replace(s, section=None) for s in b.segments] for b in (boom, paper_boom))
    assert own == paper
    law = PowerContact(1e13, 2.0)
    assert boom.joints == (replace(paper_boom.joints[0], contact=law),)


def test_a_given_section_makes_mass_stiffness_and_rotary_inertia(tmp_path: Path) -> None:
    """Reference: analytic, a thin box: A = 2(h + b)t, J ≈ A h²/12 (1 + 3/r)/(1 + 1/r)."""
    given = "section = { height = 0.6, width = 0.4, flange = 0.001, web = 0.001 }"
    text = COARSE.replace("mass_per_length = 83.16\n", given + "\n")
    for line in ("second_moment_of_area = 3.7986e-4\n", "rotary_inertia = 3.48\n"):
        text = text.replace(line, "")
    text = text.replace("height_to_width = 1.5\n", "")
    # The inner section that would fill this room does not exist; beams do without.
    text = text[: text.index('[[model]]\nname = "timoshenko"')]
    outer, _ = build_boom(read_case(tmp_path, text)).segments
    assert outer.mass_per_length == pytest.approx(7850.0 * 2.0 * 1.0 * 0.001, rel=1e-12)
    thin = 0.002 * 0.6**2 / 12.0 * (1.0 + 3.0 / 1.5) / (1.0 + 1.0 / 1.5)
    assert outer.second_moment_of_area == pytest.approx(thin, rel=1e-4)
    assert outer.rotary_inertia == 7850.0 * outer.second_moment_of_area


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
    laws = {model.name: contact_laws(case, model)[0] for model in case.models}
    assert laws["kantorovich-4"] == PowerContact(1e13, 2.0).with_clearance(7.0e-3)
    assert laws["beam-fe"] == PowerContact(1e9, 1.0).with_clearance(7.0e-3)


def test_a_beam_s_case_does_without_sections(tmp_path: Path) -> None:
    text = COARSE.replace("height_to_width = 1.5\n", "")
    text = text[: text.index('[[model]]\nname = "timoshenko"')]
    boom = build_boom(read_case(tmp_path, text))
    assert [segment.section for segment in boom.segments] == [None, None]


def test_selection_keeps_the_order_and_meshes_the_shells_anew() -> None:
    case = select(shipped("coarse"), "coarse.toml", ["shell", "beam-fe"], 0.5)
    assert [model.name for model in case.models] == ["beam-fe", "shell"]
    assert case.models[1].model_dump()["mesh_size"] == 0.5
    assert case.models[1].model_dump()["contact_tolerance"] == "any"


def test_selection_changes_the_members_of_ensembles() -> None:
    coarse = shipped("coarse")
    assert coarse.ensemble is None
    some = select(coarse, "coarse.toml", members=7).ensemble
    assert (some.members, some.relative, some.seed, some.vary) == (7, 1e-9, 1, "load")
    paper = shipped("paper")
    assert paper.ensemble == EnsembleTable(members=32, relative=1e-9, seed=1, vary="load")
    changed = select(paper, "paper.toml", members=3).ensemble
    assert changed.model_dump() == {**paper.ensemble.model_dump(), "members": 3}
    assert select(paper, "paper.toml", members=0).ensemble is None


def test_every_key_is_described_and_no_other_is_allowed() -> None:
    schema = Case.model_json_schema()
    for one in [schema, *schema["$defs"].values()]:
        assert one["additionalProperties"] is False
        for key, rule in one["properties"].items():
            assert rule.get("description"), f"{one['title']}.{key}"


@pytest.mark.parametrize(("good", "bad", "line"), BAD_EDITS, ids=[line for *_, line in BAD_EDITS])
def test_refuses_a_bad_case_with_one_exact_line(
    tmp_path: Path, good: str, bad: str, line: str
) -> None:
    assert good in COARSE
    assert refusal(tmp_path, COARSE.replace(good, bad, 1)) == line


BODY = COARSE[: COARSE.index("[[model]]")]


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (BODY, "model: missing; it is the models to run, one [[model]] each"),
        ("model = []\n" + BODY, "model: empty; give at least one"),
        ("model = [3]\n" + BODY, "model[1]: must be a table, got 3"),
        ("", "title: missing; it is the heading of the report"),
        (b'title = "a"\nx = "\xff"', "line 2: not UTF-8; save the file in this encoding"),
        (COARSE.replace("7850.0", "[" * 5000),
         "file: not TOML: nested too deeply; a case has three levels at most"),
        ('x = """',
         "file: not TOML: Unterminated string (at end of document); see https://toml.io"),
    ],
)  # fmt: skip
def test_refuses_a_bad_file_with_one_exact_line(
    tmp_path: Path, content: str | bytes, line: str
) -> None:
    assert refusal(tmp_path, content) == line


@pytest.mark.parametrize(
    ("path", "line"),
    [
        ("nowhere.toml", "file: does not exist; give the path of a case file"),
        (".", "file: is a directory; give the path of a case file"),
        ("./../nowhere.toml", "file: does not exist; give the path of a case file"),
    ],
)
@pytest.mark.usefixtures("here")
def test_unreadable_file_is_named_as_given(path: str, line: str) -> None:
    with refused(f"{path}: {line}"):
        load(path)


def test_a_byte_order_mark_is_no_fault(tmp_path: Path) -> None:
    assert read_case(tmp_path, COARSE.encode("utf-8-sig")).time.duration == 0.6


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


@pytest.mark.parametrize(("modes", "chosen"), [("auto", "auto"), ("12", 12)])
def test_chooses_the_coordinates_of_the_shells(modes: str, chosen: object) -> None:
    case = select(shipped("coarse"), "coarse.toml", modes=modes)
    assert [m.modes for m in case.models if isinstance(m, Shell)] == [chosen]


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
def test_shipped_cases_are_valid_and_read_back_as_themselves(path: Path) -> None:
    case = load(str(path))
    written = toml.dumps(case)
    assert faults(data(path.read_text(encoding="utf-8"))) == faults(data(written)) == []
    assert Case.model_validate(tomllib.loads(written)) == case


def test_it_accepts_keys_in_all_their_forms() -> None:
    case = data(COARSE)
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
        ("segment.0.supports.0", {"y": 1.0}), ("segment.0.mass_per_length", -83.16),
        ("segment.0.collars", [{"span": [1.0, 2.0], "thickness": 0.0}]), ("joint.0.stations", []),
        ("joint.0.stations.0", "tip"), ("joint.0.friction", -0.2), ("model.5.modes", 0),
        ("model.5.modes", "many"), ("model.0.kind", "plate"), ("gravity", {"angle": 100.0}),
        ("damping", {"modal": 2.0}), ("combination", [{"name": "A", "factors": {"dead": [-1.0]}}]),
    ],
)  # fmt: skip
def test_it_refuses_a_slip(place: str, value: object) -> None:
    case = data(COARSE)
    here: Any = case
    *steps, key = (int(step) if step.isdigit() else step for step in place.split("."))
    for step in steps:
        here = here[step]
    here[key] = value
    (fault,) = faults(case)
    expected = re.sub(r"\.(\d+)", r"[\1]", f"$.{place}")
    assert fault.startswith(expected) or expected.startswith(fault)
