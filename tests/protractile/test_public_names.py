# SPDX-License-Identifier: LGPL-3.0-or-later
"""The public names are there, documented, and cost nothing until they are used."""

import doctest
import inspect
import subprocess
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import protractile as pt
from dynamics.gap_system import GapSystem
from dynamics.integrator import simulate

HEAVY = "dolfinx", "pyvista", "matplotlib", "numba", "numpy"
NAMES = dir(pt)
ROOT = Path(__file__).parents[2]
ROOMS = "geometry", "dynamics", "beam_model", "runs", "protractile"
EXPLAINED = sorted(
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for room in ROOMS
    for path in (ROOT / room).rglob("*.py")
    if ">>>" in path.read_text("utf-8")
)


def test_nothing_heavy_comes_with_the_import() -> None:
    told = f"import sys, protractile; print(sorted({set(HEAVY)} & set(sys.modules)))"
    answer = subprocess.run(
        [sys.executable, "-c", told], capture_output=True, text=True, check=True
    )
    assert answer.stdout.strip() == "[]"


def test_unknown_name_is_refused() -> None:
    with pytest.raises(AttributeError, match=r"^module 'protractile' has no attribute 'bom'$"):
        _ = pt.bom


@pytest.mark.parametrize("name", NAMES)
def test_every_name_is_documented(name: str) -> None:
    assert inspect.getdoc(getattr(pt, name))


def examples_of(thing: object) -> list[doctest.DocTest]:
    return [test for test in doctest.DocTestFinder().find(thing) if test.examples]


@pytest.fixture(scope="module")
def at_hand() -> dict[str, Any]:
    """Return the names for all examples: the packages, a ball as ``GapSystem``, a ``Boom``."""
    names: dict[str, Any] = {"np": np, "pt": pt, "replace": replace, "simulate": simulate}
    for described in (GapSystem, pt.Boom):
        example = examples_of(described)[0]
        example.globs |= names
        doctest.DocTestRunner().run(example, clear_globs=False)
        names |= {name: example.globs[name] for name in ("ball", "boom") if name in example.globs}
    return names


@pytest.mark.parametrize("name", EXPLAINED)
def test_examples_in_docstrings_hold(name: str, at_hand: dict[str, Any]) -> None:
    for example in examples_of(import_module(name)):
        example.globs |= at_hand
        assert doctest.DocTestRunner().run(example).failed == 0


def test_code_in_the_docs_runs() -> None:
    """The code of the page on Python runs as it stands."""
    names: dict[str, Any] = {}
    for code in (ROOT / "docs/api.md").read_text("utf-8").split("```python\n")[1:]:
        exec(code.split("```")[0], names)
    assert 0.0 < names["difference"].largest < 0.2
