# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pages of the documentation, and the modules that generate parts of them."""

import re
import sys
import tomllib
from collections.abc import Callable
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="session")
def module_of_docs() -> Callable[[str], ModuleType]:
    """Return a function that imports docs/NAME.py."""

    def load(name: str) -> ModuleType:
        spec = spec_from_file_location(f"docs_{name}", DOCS / f"{name}.py")
        module = sys.modules[spec.name] = module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    return load


def toml_blocks(page: str) -> list[str]:
    """Return the TOML blocks of a page in docs/, in their order."""
    return re.findall(r"```toml\n(.*?)```", (DOCS / page).read_text("utf-8"), re.DOTALL)


@pytest.fixture(scope="session")
def lift() -> str:
    """Return the complete case of the tutorial."""
    return "\n".join(toml_blocks("tutorial.md"))


def merged(case: dict[str, Any], fragment: str) -> dict[str, Any]:
    """Return a case with some tables replaced by those of a fragment.

    A segment replaces the one with its name, a joint the one with its inner segment.
    """
    result = dict(case)
    for key, value in tomllib.loads(fragment).items():
        by = {"segment": "name", "joint": "inner"}.get(key)
        if by is not None:
            new = {entry[by]: entry for entry in value}
            value = [new.get(entry[by], entry) for entry in case[key]]
        result[key] = value
    return result
