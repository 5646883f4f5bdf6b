# SPDX-License-Identifier: LGPL-3.0-or-later
"""What cases of several tests say alike, and how they are read and refused."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from runs.case import reading
from runs.case.messages import BadInput
from runs.case.schema import Case

STEEL = """
[material]
youngs_modulus = 2.1e11
poissons_ratio = 0.3
density = 7850.0
"""


def table(heading: str, **keys: object) -> str:
    """Return a table of a case by its heading, such as ``[time]`` or ``[[model]]``."""
    lines = (f"{key} = {as_toml(value)}" for key, value in keys.items())
    return "\n".join(["", heading, *lines, ""])


def as_toml(value: object) -> str:
    """Return a value of a case file, its tables inline."""
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {as_toml(entry)}' for key, entry in value.items())} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(as_toml, value))}]"
    return json.dumps(value)


REST = table("[start]", state="equilibrium")
HINGED = 'supports = [{ x = 0.0, kind = "hinged" }]'
CLAMPED = 'supports = [{ x = 0.0, kind = "clamped" }]'


def elements(name: str, **keys: object) -> str:
    """Return a model of beam elements."""
    return table("[[model]]", name=name, kind="finite-element", **keys)


_SIZES = "height", "width", "flange", "web"


def box(name: str, span: tuple[float, float], section: tuple[float, ...], more: str = "") -> str:
    """Return a segment by height, width, flange and web in m, with further keys."""
    sizes = (f"{key} = {m}" for key, m in zip(_SIZES, section, strict=True))
    return f"""
[[segment]]
name = "{name}"
span = {list(span)}
section = {{ {", ".join(sizes)} }}
{more}
"""


def joint(inner: str, outer: str, play: float, span: tuple[float, float], more: str = "") -> str:
    """Of a segment in another, with stations at both ends of their overlap; 1 GN/m unless said."""
    stiffness = "" if "stiffness" in more else "stiffness = 1e9"
    return f"""
[[joint]]
outer = "{outer}"
inner = "{inner}"
stations = {list(span)}
play = {play}
exponent = 1.0
{stiffness}
{more}
"""


def read_case(folder: Path, text: str) -> Case:
    """Return the case of a text, from a file in a folder."""
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return reading.load(str(path))


@contextmanager
def refused(line: str) -> Iterator[None]:
    """Expect a refusal with this exact line."""
    with pytest.raises(BadInput) as error:
        yield
    assert str(error.value) == line


def refusal(folder: Path, text: str) -> str:
    """Why a case of a text is refused, behind the name of its file."""
    with pytest.raises(BadInput) as refused:
        read_case(folder, text)
    return str(refused.value).removeprefix(f"{folder / 'case.toml'}: ")
