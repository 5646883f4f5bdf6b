# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pages of the manual: links, commands, and the mistakes that they name."""

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import typer

import protractile as pt
from protractile.runs import CASES, cli
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import load_checked
from protractile.runs.case.schema import case_schema
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.rules import OF_INPUTS, cautions
from protractile.runs.check import check_case
from protractile.runs.process.bad_input import BadInput
from studies.convergence import STUDIES
from tests.docs.conftest import DOCS, merged, toml_blocks
from tests.runs.case_texts import read_case, table

ROOT = DOCS.parent
PACKAGES = "dynamics", "geometry", "beam_model", "shell_model", "analysis", "runs", "studies"
GUIDES = sorted(path.name for path in (DOCS / "how-to").glob("*.md"))
PAGES = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
PAGES = [page for page in PAGES if not {"api", "generated"} & {*page.relative_to(ROOT).parts}]
FRAGMENTS = [(guide, n) for guide in GUIDES for n in range(len(toml_blocks(f"how-to/{guide}")))]


@pytest.mark.parametrize(("guide", "nth"), FRAGMENTS)
def test_a_fragment_makes_a_boom(guide: str, nth: int, lift: str, tmp_path: Path) -> None:
    """A fragment of a guide, in place of the tutorial's tables, makes a case."""
    case = merged(tomllib.loads(lift), toml_blocks(f"how-to/{guide}")[nth])
    assert build_boom(read_case(tmp_path, table("", **case))).segments[0].name == "base"


def names_of(page: str, **names: Any) -> dict[str, Any]:
    """Run the code of a page as it stands, and return its names."""
    for code in (DOCS / page).read_text("utf-8").split("```python\n")[1:]:
        exec(code.split("```")[0], names)
    return names


@pytest.mark.slow
def test_code_of_the_guides_runs(here: Path) -> None:
    names = names_of("how-to/notebooks.md", pt=pt)
    assert names["loaded"].summary == names["results"].summary
    assert 0.0 < names_of("api.md")["difference"].largest < 0.2


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_to_files_and_headings(page: Path) -> None:
    text = page.read_text("utf-8")
    for link in re.findall(r"\]\(([^)\s]+)\)", text):
        if link.startswith(("http", "#")):
            continue
        target, _, heading = link.partition("#")
        path = (page.parent / target).resolve()
        assert path.exists(), link
        if heading:
            titles = re.findall(r"^#+ (.*)$", path.read_text("utf-8"), re.MULTILINE)
            slugs = {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}
            assert heading in slugs, link


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_commands_in_the_pages_have_known_options(page: Path) -> None:
    """Reference: typer's list of commands and options."""
    commands = typer.main.get_command(cli.app).commands
    text = page.read_text("utf-8").replace("\\\n", " ")
    for line in re.findall(r"^    (?:\S+ )*?(?:\.venv/bin/)?protractile (.*)$", text, re.MULTILINE):
        if re.match(r"[a-z]+ ", line) is None:
            continue
        name, *words = re.sub(r"  #.*", "", line).split()
        options = {option for parameter in commands[name].params for option in parameter.opts}
        assert {word for word in words if word.startswith("--")} <= options, line


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CONTRIBUTING.md"], ids=lambda page: page.name)
def test_files_and_studies_exist(page: Path) -> None:
    """A page names files and studies that exist."""
    text = page.read_text("utf-8")
    rooms = "|".join([*PACKAGES, "protractile", "tests", "docs", "examples"])
    files = re.findall(rf"`((?:{rooms})/(?!out/)[a-z0-9_/.-]+\.(?:py|md|toml|csv))`", text)
    assert [name for name in files if not (ROOT / name).exists()] == []
    studies = re.findall(r"-m\s+studies\.convergence ([a-z_]+(?: [a-z_]+)*)`", text)
    assert {name for names in studies for name in names.split()} <= {*STUDIES}


def test_names_of_the_recipes_exist() -> None:
    """Reference: the words of the code."""
    recipes = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    names = set(re.findall(r"`(?:\w+\.)*(\w*[A-Z_]\w*)(?:\(\w+\))?`", recipes))
    code = [path.read_text("utf-8") for room in PACKAGES for path in (ROOT / room).rglob("*.py")]
    assert len(names) > 40
    assert names - {"Makefile"} <= {word for text in code for word in re.findall(r"\w+", text)}


Modules = Callable[[str], ModuleType]


@pytest.fixture(scope="module")
def reference(module_of_docs: Modules) -> ModuleType:
    return module_of_docs("reference")


def test_each_key_of_the_schema_has_its_row(reference: ModuleType) -> None:
    """Reference: the schema."""
    schema = case_schema()
    sections = dict(re.findall(r"^\((.*?)\)=\n((?:(?!^\().*\n?)*)", reference.case_tables(), re.M))
    tables = {"Case": schema} | schema["$defs"]
    assert sections.keys() == {name.lower() for name in tables}
    for name, one in tables.items():
        rows = re.findall(r"^\| `(\w+)` \|", sections[name.lower()], re.M)
        assert rows == [*one["properties"]]


def test_the_page_names_each_table() -> None:
    """Reference: the schema; lists of tables have double brackets."""
    page = (DOCS / "case-file.md").read_text("utf-8")
    for key, entry in case_schema()["properties"].items():
        if "$ref" in str(entry):
            listed = "'array'" in str(entry)
            assert (f"`[[{key}]]`" if listed else f"`[{key}]`") in page


def test_each_option_of_the_command_line_has_its_row(reference: ModuleType) -> None:
    """Reference: typer's own list."""
    page = reference.commands()
    for name, command in typer.main.get_command(cli.app).commands.items():
        section = page.split(f"### `protractile {name}")[1].split("\n### ")[0]
        for parameter in command.params:
            if parameter.param_type_name == "option":
                assert f"\n| `{parameter.opts[0]}" in section


def test_drawings_show_keys_of_the_schema(module_of_docs: Modules, tmp_path: Path) -> None:
    """Reference: the schema; the folder of the docs has the same drawings."""
    tables = [case_schema(), *case_schema()["$defs"].values()]
    keys = {key for table in tables for key in table["properties"]}
    assert module_of_docs("drawings").draw(tmp_path) <= keys
    drawings = {path.name for path in tmp_path.iterdir()}
    assert drawings == {path.name for path in (DOCS / "drawings").iterdir()}


CASE = "".join(toml_blocks("tutorial.md")[:2])
CRANE = (CASES / "crane.toml").read_text("utf-8")
ARM = (CASES / "inspection-arm.toml").read_text("utf-8").partition("# Combinations after")[0]
ARM = ARM.replace("gust.csv", str(CASES / "gust.csv"))


def with_load(keys: str) -> tuple[str, str]:
    """Return the replacement that adds a load of the fly to the lift."""
    return "[damping]", f'[[load]]\nsegment = "fly"\n{keys}\n[damping]'


# Each mistake with the text of the case and its replacement.
LIFT_MISTAKES = {
    "fly larger than base": ("height = 0.256, width = 0.180", "height = 0.356, width = 0.280"),
    "angle negative": ("angle = 45.0", "angle = -45.0"),
    "pad pressure in MPa": ("allowable_pressure = 2e7", "allowable_pressure = 20"),
    "extension meant as overlap": ("extension = 4.8", "extension = 1.2"),
    "load sign": ("magnitude = -1595.0", "magnitude = 1595.0"),
    "load in kN": ("magnitude = -1595.0", "magnitude = -1.595"),
    "payload in N": ("mass = 150.0", "mass = 1471.0"),
    "damping 10x": ("modal = 0.01", "modal = 0.2"),
    "cylinder stiffness in N/mm": ("stiffness = 3e7", "stiffness = 3e4"),
    "cylinder on fly": ('segment = "base"\nx = 2.4', 'segment = "fly"\nx = 8.0'),
    "duration in ms": ("duration = 5.0", "duration = 5000"),
    "tail and head of load": ('x = "head"\nmagnitude', 'x = "tail"\nmagnitude'),
    "cage also as a force across": with_load('x = "head"\nmagnitude = -1040.0'),
    "cage also as a force with g of 10": with_load('x = "head"\nmagnitude = -1500.0'),
    "cage also as a mass near the head": (
        "section = { height = 0.256",
        "masses = [{ x = { head = 0.05 }, mass = 150 }]\nsection = { height = 0.256",
    ),
    "weight of fly at its middle": with_load("x = 8.3\nmagnitude = -1778.0"),
    "load twice, other form of x": with_load("x = 11.3\nmagnitude = -1595.0\nramp = 0.1"),
    "E a tenth": ("youngs_modulus = 2.1e11", "youngs_modulus = 2.1e10"),
    "walls a tenth": ("flange = 0.006, web = 0.005", "flange = 0.0006, web = 0.0005"),
    "angle forgotten": ("angle = 45.0", "acceleration = 9.81"),
    "flange and web swapped": ("flange = 0.006, web = 0.005", "flange = 0.005, web = 0.006"),
    "play in mm": ("play = 0.003", "play = 3.0"),
    "payload in t": ("mass = 150.0", "mass = 0.15"),
    "foot clamped": ('kind = "hinged"', 'kind = "clamped"'),
}
CRANE_MISTAKES = {
    "load also in the payload": ("mass = 350.0", "mass = 5350.0"),
    "angle from the vertical": ("angle = 60.0", "angle = 30.0"),
    "contact stiffness in N/mm": ("stiffness = 3e9", "stiffness = 3e6"),
    "collar length in mm": ("head = 0.5", "head = 500"),
    "third in base": ('outer = "second"\ninner = "third"', 'outer = "base"\ninner = "third"'),
}
ARM_MISTAKES = {
    "E of steel": ("youngs_modulus = 7.0e10", "youngs_modulus = 2.1e11"),
    "density of steel": ("density = 2700.0", "density = 7850.0"),
    "pad modulus in MPa": ("modulus = 4e8", "modulus = 400"),
    "lateral play in mm": ("lateral_play = 0.004", "lateral_play = 4"),
    "lateral play forgotten": ("lateral_play = 0.004\n", ""),
    "detail category in Pa": ("detail_category = 23.0", "detail_category = 23e6"),
}
# No program can find this: the number is possible.
UNNOTICED = {"extension meant as overlap"}


def find_cautions(path: Path) -> list[str] | None:
    """Return the cautions of ``check``, without numbers; None if it refuses the case."""
    try:
        found = load_checked(str(path))
    except BadInput:
        return None
    lines = cautions(Context(found.case, found.boom), OF_INPUTS)
    lines = lines or [line for line in check_case(found).lines if line.startswith("caution")]
    return [re.sub(r"\d", "", line) for line in lines]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("correct", "mistakes", "unnoticed"),
    [(CASE, LIFT_MISTAKES, UNNOTICED), (CRANE, CRANE_MISTAKES, set()), (ARM, ARM_MISTAKES, set())],
    ids=["lift", "crane", "arm"],
)
def test_natural_mistakes_are_noticed(
    tmp_path: Path, correct: str, mistakes: dict[str, tuple[str, str]], unnoticed: set[str]
) -> None:
    """Reference: by hand, mistakes of unit, sign and place that no other test makes."""
    path, missed = tmp_path / "boom.toml", set()
    path.write_text(correct, "utf-8")
    known = find_cautions(path)
    assert correct is not CASE or known == []
    for mistake, (text, replacement) in mistakes.items():
        assert text in correct, mistake
        path.write_text(correct.replace(text, replacement), "utf-8")
        found = find_cautions(path)
        if found is not None and set(found) <= set(known):
            missed.add(mistake)
    assert missed == unnoticed
