# SPDX-License-Identifier: LGPL-3.0-or-later
"""The public names are there, documented, and cost nothing until they are used."""

from __future__ import annotations

import ast
import doctest
import inspect
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import protractile as pt

HEAVY = "dolfinx", "pyvista", "matplotlib", "numba", "numpy"
# Those that need FEniCSx.
SHELLS = {"ReducedShell", "ShellOptions", "reduce_boom"}
NAMES = sorted(set(dir(pt)) - SHELLS)
README = Path(__file__).parents[2] / "README.md"


# What is data, raised, or a form that others fill.
WITHOUT = {
    "BadInput", "BoomError", "CASES", "Case", "ContactLaw", "ENERGIES", "History", "Integrator",
    "NumericsError", "Section", "tied_system", "with_ratio",
}  # fmt: skip


def examples_of(name: str) -> list[doctest.DocTest]:
    thing = getattr(pt, name)
    documented = inspect.isclass(thing) or inspect.isfunction(thing)
    found = doctest.DocTestFinder(recurse=False).find(thing, name) if documented else []
    return [test for test in found if test.examples]


def test_nothing_heavy_comes_with_the_import() -> None:
    told = f"import sys, protractile; print(sorted({set(HEAVY)} & set(sys.modules)))"
    answer = subprocess.run(
        [sys.executable, "-c", told], capture_output=True, text=True, check=True
    )
    assert answer.stdout.strip() == "[]"


def test_types_and_names_are_one_list() -> None:
    """What type checkers see is what is imported."""
    (block,) = (
        node for node in ast.parse(Path(pt.__file__).read_text("utf-8")).body
        if isinstance(node, ast.If)
    )  # fmt: skip
    typed = {
        alias.name: node.module
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert typed == pt._HOMES


def test_a_name_that_is_none() -> None:
    with pytest.raises(AttributeError, match=r"^module 'protractile' has no attribute 'bom'$"):
        _ = pt.bom


@pytest.mark.parametrize("name", NAMES)
def test_every_name_is_documented(name: str) -> None:
    assert inspect.getdoc(getattr(pt, name))


@pytest.fixture(scope="module")
def at_hand() -> dict[str, Any]:
    """What every example may use: the packages, the ball of ``GapSystem``, the boom of ``Boom``."""
    names: dict[str, Any] = {"np": np, "pt": pt, "replace": replace}
    for name in ("GapSystem", "Boom"):
        (example,) = examples_of(name)
        example.globs = names
        doctest.DocTestRunner().run(example, clear_globs=False)
    return names


@pytest.mark.parametrize("name", sorted(set(NAMES) - WITHOUT))
def test_examples_in_docstrings_hold(name: str, at_hand: dict[str, Any]) -> None:
    (example,) = examples_of(name)
    example.globs = dict(at_hand)
    assert doctest.DocTestRunner().run(example).failed == 0


def test_the_readme_runs() -> None:
    """What stands under "In Python" runs as it stands."""
    section = README.read_text("utf-8").split("## In Python\n")[1].split("\n## ")[0]
    code = section.split("```python\n")[1].split("```")[0]
    names: dict[str, object] = {}
    exec(code, names)
    assert names["summary"]
    assert names["motion"].first_contact == pytest.approx(0.3193, abs=1e-4)
