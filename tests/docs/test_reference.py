# SPDX-License-Identifier: LGPL-3.0-or-later
"""The reference lists every key and every option, and drawings show keys that exist."""

import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest
import typer

from runs import cli
from runs.case.schema import case_schema
from tests.docs.conftest import DOCS

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
    for name, table in tables.items():
        rows = re.findall(r"^\| `(\w+)` \|", sections[name.lower()], re.M)
        assert rows == [*table["properties"]]


def test_the_page_names_each_table() -> None:
    """Reference: the schema, whose lists of tables stand in double brackets."""
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
