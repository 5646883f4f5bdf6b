# SPDX-License-Identifier: LGPL-3.0-or-later
"""What cases of several tests say alike, and how they are read and refused."""

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
