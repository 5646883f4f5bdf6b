# SPDX-License-Identifier: LGPL-3.0-or-later
"""Valid cases with drawn numbers: two boxes with tables of every kind, shipped cases varied."""

import re
from random import Random

# Tables with numbers drawn between the two in angle brackets; each "; " is a new line.
_LINES = """
[payload]; mass = <10 500>
[damping]; mass = <0 1>
[damping]; stiffness = <1e-6 1e-3>
[damping]; modal = <0.001 0.1>
[start]; velocity = { FLY = <-0.1 0.1> }
[start]; velocity = { FLY = { turn = <-0.01 0.01>, x = "tail" } }
[[base]]; acceleration = <-1 1>; ramp = <0.01 0.1>
[[load]]; segment = "FLY"; x = { head = <0 0.1> }; magnitude = <-900 -1>; frequency = <0.1 9>
[[load]]; segment = "FLY"; x = "head"; magnitude = <-900 -1>; moment = true
[[load]]; segment = "BASE"; from = <0.1 1>; to = <1.1 3>; magnitude = <-90 -1>
[[load]]; segment = "FLY"; x = "head"; magnitude = -100.0; table = [[0.0, <0 1>], [<0.1 1>, 1.0]]
[[load]]; segment = "FLY"; x = "head"; magnitude = <-900 -1>; released = true
[[stop]]; segment = "FLY"; x = { head = 0.5 }; play = <0.01 0.1>; stiffness = <1e6 1e8>
[[cylinder]]; segment = "BASE"; x = <1 2>; depth = <0.1 0.3>; ground = [<0.3 0.6>, <-1.5 -0.8>]; \
stiffness = <1e7 1e8>; capacity = <1e5 1e6>; pin = { diameter = <0.03 0.1>, strength = 8e8 }
[[pinned_mass]]; mass = "<10 300> kg"; centre = <0 0.3>; \
pins = [{ segment = "BASE", x = <0.3 1> }, { segment = "FLY", x = "tail" }]
[gravity]; acceleration = 9.81; angle = <0 70>
[[axial]]; force = <1 5000>
[rope]; falls = 2; winch = <0 3>; [payload]; mass = <10 500>
[wind]; pressure = <0 500>; shape_factor = <0.5 2>
[[axial]]; force = <1 5000>; segment = "FLY"
[[observe]]; name = "seat"; segment = "FLY"; x = { head = <0 1> }; quantity = "velocity"
[ensemble]; members = 3; relative = <1e-6 1e-2>; seed = 1
[[model]]; name = "more"; kind = "rigid"; contact = { force_table = [[0.001, <1e5 1e6>]] }
[[model]]; name = "more"; kind = "shell"; contact_tolerance = <0.01 0.1>
[[model]]; name = "more"; kind = "finite-element"; element_length = <0.3 1>; \
calibrated_by = { name = "by", kind = "shell", mesh_size = <0.1 0.2> }
[hoist]; mass = <50 1500>; falls = 2; area = 1.1e-4; modulus = 1e11; length = <5 20>; \
travel = <0.1 1>; speed = <0.05 0.3>; ramp = <0.1 0.3>
[hoist]; mass = <50 1500>; stiffness = <1e5 1e7>; hanging = true; pendulum = <1 9>
[hoist]; mass = <50 1500>; stiffness = <1e5 1e7>; hanging = true; dropped = true
[slew]; travel = <5 90>; speed = <1 9>; ramp = <0.3 2>; radius = <-2 2>
[slew]; table = [[0.0, 0.0], [<1 2>, <-20 20>]]; shaper = [[<0.2 2>, <0 0.1>]]
[luff]; travel = <-10 10>; time = <1 9>; start = <0 1>
[[load_case]]; name = "one"; angle = <0 70>; payload = <1 300>; load = []; [[load_case]]; \
name = "two"; extension = { FLY = <1.5 3> }; [[combination]]; name = "A"; \
factors = { dead = [<1 1.3>, 1.1], payload = <1 1.5>, dynamic = 0.0, wind = 0.0 }; \
resistance = { material = <1 1.2>, stability = 1.1, pin = 1.25 }; [[spectrum]]; name = "lifts"; \
load_cases = ["one", "two"]; repeats = 20000
[life]; detail_category = <36 160>; partial_factor = <1 1.35>; repeats = 20000
[limits]; tip_at_rest = <0.01 3>; stress = <5e7 5e8>; first_frequency = <0.1 5>
[buckling]; modes = 1; curve = [[<0 0.5>, 1.0], [2.0, <0.1 0.3>]]
"""
TABLES = [line.replace("; ", "\n") for line in _LINES.strip().splitlines()]
# Two boxes, quick to compute.
_SMALL = """title = "Two boxes"
[time]; duration = 0.02; output_step = 1e-3
[start]; state = "equilibrium"
[gravity]; angle = <0 70>
[material]; youngs_modulus = <7e10 2.1e11>; poissons_ratio = 0.3; \
density = { mean = <2700 7850>, sd = 50.0 }; yield_strength = <2e8 7e8>
[damping]; modal = <0.005 0.05>
[[segment]]; name = "base"; length = <4 5>; supports = [{ x = 0.0, kind = "KIND" }]; \
section = { height = <0.33 0.4>, width = <0.24 0.3>, flange = <0.006 0.012>, web = <0.005 0.01> }
[[segment]]; name = "fly"; length = <3.8 4.5>; \
section = { height = <0.25 0.28>, width = <0.17 0.2>, flange = <0.005 0.01>, web = <0.004 0.009> }
[[joint]]; outer = "base"; inner = "fly"; extension = <2.5 3.4>; stations = ["tail", "head"]; \
play = <0.001 0.005>; lateral_play = <0.001 0.005>; detail_category = 50.0; \
pad = { length = <0.1 0.2>, width = <0.04 0.06>, thickness = 0.012, modulus = <5e8 5e9> }
[[model]]; name = "beam"; kind = "finite-element"; element_length = <0.5 1>
[[model]]; name = "series"; kind = "kantorovich"; terms = [4, 4]; base = "complete"
""".replace("; ", "\n")
_CYLINDER = next(table for table in TABLES if table.startswith("[[cylinder]]"))


def small(random: Random) -> str:
    """Return a case of two boxes with usual numbers, and a few tables more."""
    kind = random.choice(("clamped", "hinged"))
    text = fill(_SMALL.replace("KIND", kind), random)
    if kind == "hinged":
        text = with_table(text, _CYLINDER, random)
    for table in random.sample(TABLES, random.choice((0, 1, 1, 2, 3))):
        text = with_table(text, table, random)
    return text


def varied(text: str, random: Random) -> str:
    """Return a case file with a few numbers raised by up to 3 %, which usually remains valid."""
    for _ in range(random.choice((1, 2, 4))):
        number = random.choice(list(re.finditer(r"(?<==)( *\[*)(\d+\.\d+)\b", text)) or [None])
        if number is not None:
            other = f"{float(number[2]) * random.uniform(1.0, 1.03):.6g}"
            text = text[: number.start(2)] + other + text[number.end(2) :]
    return text


def fill(template: str, random: Random) -> str:
    """Return a template with a number in place of each pair of limits."""
    return re.sub(
        r"<(\S+) (\S+)>",
        lambda ends: f"{random.uniform(float(ends[1]), float(ends[2])):.4g}",
        template,
    )


def with_table(text: str, table: str, random: Random) -> str:
    """Return a case file with a filled table, which replaces one that may not be repeated."""
    segments = re.findall(r'\[\[segment\]\]\nname = "(.+)"', text) or ["base", "fly"]
    table = fill(table, random).replace("BASE", segments[0]).replace("FLY", segments[-1])
    heading = re.escape(table.splitlines()[0])
    if not heading.startswith(r"\[\["):
        text = re.sub(rf"(?ms)^{heading}.*?(?=^\[)", "", text)
    return text.replace("[[model]]", f"{table}\n\n[[model]]", 1)
