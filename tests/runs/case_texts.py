# SPDX-License-Identifier: LGPL-3.0-or-later
"""Common parts of case files for several tests, and their reading and refusal."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import pytest

from protractile.runs import CASES
from protractile.runs.case import reading
from protractile.runs.case.schema import Case
from protractile.runs.process.bad_input import BadInput

COARSE = (CASES / "coarse.toml").read_text(encoding="utf-8")
CONTACT = next(line for line in COARSE.splitlines() if line.startswith("contact = "))
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
        # Keys of other numbers have points.
        keys = {key: json.dumps(key) if "." in key else key for key in value}
        return f"{{ {', '.join(f'{keys[key]} = {as_toml(one)}' for key, one in value.items())} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(as_toml, value))}]"
    return json.dumps(value)


REST = table("[start]", state="equilibrium")
HINGED = 'supports = [{ x = 0.0, kind = "hinged" }]'
CLAMPED = 'supports = [{ x = 0.0, kind = "clamped" }]'


def elements(name: str, **keys: object) -> str:
    """Return a model of beam elements."""
    return table("[[model]]", name=name, kind="finite-element", **keys)


# Of the tutorial's boom: flanges that bend under pads away from the webs.
THIN = (
    ("flange = 0.006", "flange = 0.002"), ("flange = 0.005", "flange = 0.002"),
    ("thickness = 0.012", "thickness = 0.012, offset = 0.039"),
)  # fmt: skip
_SIZES = "height", "width", "flange", "web"


def box(
    name: str, place: float | tuple[float, float], section: tuple[float, ...], more: str = ""
) -> str:
    """Return a segment of a length or a span by height, width, flange and web, with more keys."""
    where = f"length = {place}" if isinstance(place, float) else f"span = {list(place)}"
    sizes = (f"{key} = {m}" for key, m in zip(_SIZES, section, strict=True))
    return f"""
[[segment]]
name = "{name}"
{where}
section = {{ {", ".join(sizes)} }}
{more}
"""


def joint(inner: str, outer: str, play: float, span: tuple[float, float], more: str = "") -> str:
    """Return a joint with stations at both ends of the overlap, by default of 1 GN/m."""
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


def edited(text: str, *edits: tuple[str, str]) -> str:
    """Return a text with others in place of the first ones of what it says."""
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def read_case(folder: Path, content: str | bytes) -> Case:
    """Return the case of a text, from a file in a folder."""
    path = folder / "case.toml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return reading.load(str(path))


def load_checked_text(folder: Path, content: str) -> reading.CheckedCase:
    """Return the checked case of a text, from a file in a folder."""
    path = folder / "case.toml"
    path.write_text(content, "utf-8")
    return reading.load_checked(str(path))


@contextmanager
def refused(line: str) -> Iterator[None]:
    """Expect a refusal with this exact line."""
    with pytest.raises(BadInput) as error:
        yield
    assert str(error.value) == line


def shipped(name: str) -> Case:
    """Return a case that comes with the project."""
    return reading.load(str(CASES / f"{name}.toml"))


def refusal(folder: Path, content: str | bytes) -> str:
    """Return the message of a refused case, after the name of its file."""
    with pytest.raises(BadInput) as refused:
        read_case(folder, content)
    return str(refused.value).removeprefix(f"{folder / 'case.toml'}: ")


# Input error: text of the case, its replacement, and the expected message.
Slip = tuple[str, str, str]


def replacing(text: str, slips: Mapping[str, str]) -> list[Slip]:
    """Return input errors: a text of the case, its replacement, and the expected message."""
    return [(text, slip, line) for slip, line in slips.items()]


def adding(text: str, slips: Mapping[str, str]) -> list[Slip]:
    """Return input errors by lines added below a text of the case."""
    return replacing(text, {f"{text}\n{slip}": line for slip, line in slips.items()})


def long_boom(segments: int = 8, loads: int = 40, combinations: int = 10) -> str:
    """Return a crane of many segments with pads, loads with histories, and combinations."""
    length, overlap = 6.0, 1.5
    text = f"""
title = "A long boom"
time = {{ duration = 1.0 }}
gravity = {{ angle = 40.0 }}
start = {{ state = "equilibrium" }}
payload = {{ mass = 150.0 }}
cylinder = [{{ segment = "s0", x = 2.4, depth = 0.4, ground = [0.7, -1.6], stiffness = 5e8 }}]
load_case = [{{ name = "light", payload = 100.0 }}]
{STEEL}yield_strength = 355e6
{elements("beam")}
"""
    pads = "pad = { length = 0.15, width = 0.05 }\nstiffness = 2e8"
    for i in range(segments):
        start, height = i * (length - overlap), 0.7 - 0.05 * i
        section = height, 0.7 * height, 0.008 - 0.0005 * i, 0.006 - 0.0003 * i
        text += box(f"s{i}", (start, start + length), section, "" if i else HINGED)
        if i:
            span = start + 0.1, start + overlap - 0.1
            text += joint(f"s{i}", f"s{i - 1}", 0.002, span, pads)
    for k in range(loads):
        i, row = k % segments, k // segments
        keys = {"x": i * (length - overlap) + 1.0 + 0.1 * row, "magnitude": -20.0 - k}
        text += table("[[load]]", segment=f"s{i}", ramp=0.1 + 0.02 * k, **keys)
    for k in range(combinations):
        factors = {"dead": 1.0 + 0.03 * k, "payload": 1.0 + 0.05 * k}
        text += table("[[combination]]", name=f"c{k}", factors=factors)
    return text


YOUNG, MASS, SECOND, LENGTH, LOAD = 2.0e11, 20.0, 1.0e-6, 4.0, 100.0

CANTILEVER = f"""
title = "Cantilever"
time = {{ duration = 0.2, output_step = 0.01 }}
material = {{ youngs_modulus = {YOUNG}, poissons_ratio = 0.3, density = 7850.0 }}
damping = {{ modal = 0.02 }}

[[segment]]
name = "beam"
length = {LENGTH}
supports = [{{ x = 0.0, kind = "clamped" }}]
mass_per_length = {MASS}
second_moment_of_area = {SECOND}
load = {LOAD}

[[model]]
name = "beam"
kind = "finite-element"
theory = "euler-bernoulli"
rotary_inertia = false
"""


def static_tip(length: float = LENGTH) -> float:
    """Return q L⁴/(8 E J) in m."""
    return LOAD * length**4 / (8.0 * YOUNG * SECOND)
