# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fragments, commands and links of the pages hold."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import typer

import protractile as pt
from runs import cli
from runs.case.build import build_boom
from runs.case.reading import load
from studies.convergence import STUDIES
from tests.docs.conftest import DOCS, merged, toml_blocks

ROOT = DOCS.parent
GUIDES = sorted(path.name for path in (DOCS / "how-to").glob("*.md"))
PAGES = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
PAGES = [page for page in PAGES if not {"api", "generated"} & {*page.relative_to(ROOT).parts}]
FRAGMENTS = [(guide, n) for guide in GUIDES for n in range(len(toml_blocks(f"how-to/{guide}")))]


def as_toml(table: dict[str, Any]) -> str:
    """Return a table of a case file as TOML, its tables inline."""

    def value(of: Any) -> str:
        if isinstance(of, dict):
            return "{ " + ", ".join(f'"{k}" = {value(v)}' for k, v in of.items()) + " }"
        if isinstance(of, list):
            return "[" + ", ".join(map(value, of)) + "]"
        return str(of).lower() if isinstance(of, bool) else repr(of)

    return "\n".join(f'"{key}" = {value(entry)}' for key, entry in table.items())


@pytest.mark.parametrize(("guide", "nth"), FRAGMENTS)
def test_a_fragment_makes_a_boom(guide: str, nth: int, lift: str, tmp_path: Path) -> None:
    """A fragment of a guide, in place of the tutorial's tables, makes a case."""
    case = merged(tomllib.loads(lift), toml_blocks(f"how-to/{guide}")[nth])
    path = tmp_path / "my-lift.toml"
    path.write_text(as_toml(case), "utf-8")
    assert build_boom(load(str(path))).segments[0].name == "base"


def test_code_of_the_guides_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"pt": pt}
    page = (DOCS / "how-to" / "notebooks.md").read_text("utf-8")
    for code in page.split("```python\n")[1:]:
        exec(code.split("```")[0], names)
    assert names["loaded"].summary == names["results"].summary


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
    rooms = "geometry|dynamics|beam_model|shell_model|runs|protractile|studies|tests|docs|examples"
    files = re.findall(rf"`((?:{rooms})/(?!out/)[a-z0-9_/.-]+\.(?:py|md|toml|csv))`", text)
    assert [name for name in files if not (ROOT / name).exists()] == []
    studies = re.findall(r"-m\s+studies\.convergence ([a-z_]+(?: [a-z_]+)*)`", text)
    assert {name for names in studies for name in names.split()} <= {*STUDIES}
