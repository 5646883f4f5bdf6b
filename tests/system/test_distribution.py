# SPDX-License-Identifier: LGPL-3.0-or-later
"""Content of an installation, and equal versions in all files."""

import os
import re
import subprocess
import sys
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


@pytest.mark.parametrize(("compiler", "status"), [("/no/cc", 2), (sys.executable, 0)])
def test_make_names_what_pip_cannot_install(compiler: str, status: int) -> None:
    """Reference: by construction. Any program stands for a compiler."""
    command = ["make", "--no-print-directory", "packages-pip", f"PYTHON={sys.executable}"]
    made = subprocess.run(
        command, cwd=ROOT, env=os.environ | {"CC": compiler}, capture_output=True, text=True
    )
    assert made.returncode == status
    if status:
        assert made.stderr.splitlines()[0] == (
            f"no venv, C compiler or headers of {sys.executable}; install them "
            "(apt install gcc python3-dev python3-venv, or dnf install gcc python3-devel)"
        )
