# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pages of the documentation: code, links, commands, reference."""

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import typer

import protractile as pt
from protractile.runs import cli
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import case_schema
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


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text("utf-8").split()) <= 800


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
