# SPDX-License-Identifier: LGPL-3.0-or-later
"""Content of an installation, and equal versions in all files."""

import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def read(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def test_wheel_contains_one_package() -> None:
    setuptools = pytest.importorskip("setuptools", reason="setuptools finds what a wheel brings")
    options = PYPROJECT["tool"]["setuptools"]["packages"]["find"]
    assert options.pop("namespaces") is False
    found = setuptools.find_packages(str(ROOT), **options)
    assert {name.split(".")[0] for name in found} == {"protractile"}
    assert {"protractile.runs.report", "protractile.shell_model.contact"} <= {*found}


def test_version_equals_changelog_and_citation() -> None:
    version = re.sub(r"\.dev\d+$", "", PYPROJECT["project"]["version"])
    newest = re.search(r"^## \[(.+?)\]", read("CHANGELOG.md"), re.MULTILINE)
    cited = re.search(r"^version: (.+)$", read("CITATION.cff"), re.MULTILINE)
    assert newest[1] == cited[1] == version
