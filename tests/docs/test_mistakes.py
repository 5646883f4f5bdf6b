# SPDX-License-Identifier: LGPL-3.0-or-later
"""Natural mistakes in the tutorial's lift are refused or cause a caution."""

import re
from io import StringIO
from pathlib import Path

from rich.console import Console

from runs.case.messages import BadInput
from runs.case.reading import load_checked
from runs.check import print_check
from runs.pipeline.proportions import proportion_cautions
from tests.docs.conftest import toml_blocks

CASE = "".join(toml_blocks("tutorial.md")[:2])
CYLINDER = re.findall(r"\[\[cylinder\]\]\n(?:.+\n)+", CASE)[0]

# Each mistake with the text of the case and its replacement.
MISTAKES = {
    "E in MPa": ("youngs_modulus = 2.1e11", "youngs_modulus = 2.1e5"),
    "density in t/m3": ("density = 7850.0", "density = 7.85"),
    "yield in MPa": ("yield_strength = 3.55e8", "yield_strength = 355"),
    "nu as percent": ("poissons_ratio = 0.3", "poissons_ratio = 30"),
    "height in mm": ("height = 0.300", "height = 300"),
    "flange in mm": ("flange = 0.006, web = 0.005", "flange = 6, web = 5"),
    "fly larger than base": ("height = 0.256, width = 0.180", "height = 0.356, width = 0.280"),
    "angle in rad": ("angle = 45.0", "angle = 0.785"),
    "angle negative": ("angle = 45.0", "angle = -45.0"),
    "play in mm": ("play = 0.003", "play = 3"),
    "pad thickness in mm": ("thickness = 0.012", "thickness = 12"),
    "pad length in mm": ("length = 0.12, width", "length = 120, width"),
    "pad pressure in MPa": ("allowable_pressure = 2e7", "allowable_pressure = 20"),
    "extension longer than fly": ("extension = 4.8", "extension = 6.8"),
    "extension meant as overlap": ("extension = 4.8", "extension = 1.2"),
    "load sign": ("magnitude = -1595.0", "magnitude = 1595.0"),
    "load in kg": ("magnitude = -1595.0", "magnitude = -230"),
    "load in kN": ("magnitude = -1595.0", "magnitude = -1.595"),
    "payload in N": ("mass = 150.0", "mass = 1471.0"),
    "payload in t": ("mass = 150.0", "mass = 0.150"),
    "ramp in ms": ("ramp = 0.1 ", "ramp = 100 "),
    "damping 10x": ("modal = 0.01", "modal = 0.2"),
    "cylinder stiffness in N/mm": ("stiffness = 3e7", "stiffness = 3e4"),
    "cylinder depth in mm": ("depth = 0.25", "depth = 250"),
    "ground above": ("ground = [0.7, -1.1]", "ground = [0.7, 1.1]"),
    "ground at lug": ("ground = [0.7, -1.1]", "ground = [2.4, -0.25]"),
    "cylinder forgotten": (CYLINDER, ""),
    "cylinder on fly": ('segment = "base"\nx = 2.4', 'segment = "fly"\nx = 8.0'),
    "gravity forgotten": ("gravity = { angle = 45.0 }", "# gravity = { angle = 45.0 }"),
    "stations swapped": ('["tail", "head"]', '["head", "tail"]'),
    "one station": ('["tail", "head"]', '["head"]'),
    "duration in ms": ("duration = 5.0", "duration = 5000"),
    "output step in ms": ("output_step = 2e-3", "output_step = 2"),
    "typo in key": ("yield_strength", "yeild_strength"),
    "typo in segment": ('inner = "fly"', 'inner = "flu"'),
    "outer and inner swapped": ('outer = "base"\ninner = "fly"', 'outer = "fly"\ninner = "base"'),
    "pad wider than flange": ("width = 0.05, thickness", "width = 0.12, thickness"),
    "load at x beyond tip": ('x = "head"\nmagnitude', "x = 15.0\nmagnitude"),
    "segment length in mm": ("length = 6.5", "length = 6500"),
    "tail and head of load": ('x = "head"\nmagnitude', 'x = "tail"\nmagnitude'),
}
# No program can find these: the numbers are possible.
UNNOTICED = {"extension meant as overlap", "load in kg"}


def is_noticed(path: Path) -> bool:
    """Return whether ``check`` refuses a case or prints a caution."""
    try:
        found = load_checked(str(path))
    except BadInput:
        return True
    if proportion_cautions(found.case, found.boom):
        return True
    text = StringIO()
    print_check(found, Console(file=text, width=200))
    return "caution" in text.getvalue()


def test_natural_mistakes_are_noticed(tmp_path: Path) -> None:
    """Reference: 40 mistakes of unit, sign, name and place in a correct case."""
    path = tmp_path / "lift.toml"
    path.write_text(CASE, "utf-8")
    assert not is_noticed(path)
    unnoticed = set()
    for mistake, (text, replacement) in MISTAKES.items():
        assert text in CASE, mistake
        path.write_text(CASE.replace(text, replacement), "utf-8")
        if not is_noticed(path):
            unnoticed.add(mistake)
    assert len(MISTAKES) == 40
    assert unnoticed == UNNOTICED
