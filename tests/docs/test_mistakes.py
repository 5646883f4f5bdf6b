# SPDX-License-Identifier: LGPL-3.0-or-later
"""Natural mistakes in a lift, a crane and an inspection arm are refused or cause a caution."""

import re
from pathlib import Path

import pytest

from runs import CASES
from runs.case.messages import BadInput
from runs.case.reading import load_checked
from runs.check import check_case
from runs.pipeline.proportions import proportion_cautions
from tests.docs.conftest import toml_blocks

CASE = "".join(toml_blocks("tutorial.md")[:2])
CYLINDER = re.findall(r"\[\[cylinder\]\]\n(?:.+\n)+", CASE)[0]
CRANE = (CASES / "crane.toml").read_text("utf-8")
FLY_JOINT = re.findall(r'\[\[joint\]\]\nouter = "third"\n(?:.+\n)+', CRANE)[0]
ARM = (CASES / "inspection-arm.toml").read_text("utf-8").partition("# Combinations after")[0]
ARM = ARM.replace("gust.csv", str(CASES / "gust.csv"))


def with_table(text: str) -> tuple[str, str]:
    """Return the replacement that adds a table to the lift."""
    return "[damping]", f"{text}\n[damping]"


# Each mistake with the text of the case and its replacement.
LIFT_MISTAKES = {
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
    "pads thicker than the gap": ("thickness = 0.012", "thickness = 0.05"),
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
    "gravity twice": ("angle = 45.0 }", "angle = 45.0, acceleration = 19.62 }"),
    "gravity in mm/s2": ("angle = 45.0 }", "angle = 45.0, acceleration = 9810.0 }"),
    "cage also as a force across": with_table(
        '[[load]]\nsegment = "fly"\nx = "head"\nmagnitude = -1040.0'
    ),
    "cage also as a force": with_table(
        '[[load]]\nsegment = "fly"\nx = "head"\nmagnitude = -1471.5'
    ),
    "cage also as a force with g of 10": with_table(
        '[[load]]\nsegment = "fly"\nx = "head"\nmagnitude = -1500.0'
    ),
    "cage also as a mass": (
        "section = { height = 0.256",
        'masses = [{ x = "head", mass = 150 }]\nsection = { height = 0.256',
    ),
    "cage also as a mass near the head": (
        "section = { height = 0.256",
        "masses = [{ x = { head = 0.05 }, mass = 150 }]\nsection = { height = 0.256",
    ),
    "cage also along the boom": with_table('[[axial]]\nsegment = "fly"\nforce = 1040.0'),
    "weight of base as a load": with_table('[[load]]\nsegment = "base"\nmagnitude = -434.1'),
    "weight of fly across as a load": with_table('[[load]]\nsegment = "fly"\nmagnitude = -209.5'),
    "weight of fly at its middle": with_table(
        '[[load]]\nsegment = "fly"\nx = 8.3\nmagnitude = -1778.0'
    ),
    "weight of fly as its load": ('name = "fly"\n', 'name = "fly"\nload = -296.0\n'),
    "load twice, other form of x": with_table(
        '[[load]]\nsegment = "fly"\nx = 11.3\nmagnitude = -1595.0\nramp = 0.1'
    ),
    "load without x": ('x = "head"\nmagnitude', "magnitude"),
    "load in mN": ("magnitude = -1595.0", "magnitude = -1595000.0"),
    "load to the side of a flat boom": ("magnitude = -1595.0", 'direction = "y"\nmagnitude = 1.0'),
    "density missing": (", density = 7850.0", ""),
    "E missing": ("youngs_modulus = 2.1e11, ", ""),
    "E in GPa": ("youngs_modulus = 2.1e11", "youngs_modulus = 210.0"),
    "E ten times": ("youngs_modulus = 2.1e11", "youngs_modulus = 2.1e12"),
    "E a tenth": ("youngs_modulus = 2.1e11", "youngs_modulus = 2.1e10"),
    "yield in kPa": ("yield_strength = 3.55e8", "yield_strength = 3.55e5"),
    "play negative": ("play = 0.003", "play = -0.003"),
    "play in cm": ("play = 0.003", "play = 0.3"),
    "play ten times": ("play = 0.003", "play = 0.03"),
    "decimal comma": ("play = 0.003", "play = 0,003"),
    "friction in percent": ("play = 0.003", "play = 0.003\nfriction = 15"),
    "name twice": ('name = "fly"', 'name = "base"'),
    "pad longer than the overlap": ("pad = { length = 0.12", "pad = { length = 1.5"),
    "pad width in mm": ("width = 0.05, thickness", "width = 50, thickness"),
    "walls in cm": ("flange = 0.006, web = 0.005", "flange = 0.6, web = 0.5"),
    "walls ten times": ("flange = 0.006, web = 0.005", "flange = 0.06, web = 0.05"),
    "walls a tenth": ("flange = 0.006, web = 0.005", "flange = 0.0006, web = 0.0005"),
    "height and width swapped": ("height = 0.300, width = 0.220", "height = 0.220, width = 0.300"),
    "extension in mm": ("extension = 4.8", "extension = 4800"),
    "extension of the whole length": ("extension = 4.8", "extension = 6.0"),
    "angle of 450": ("angle = 45.0", "angle = 450"),
    "cylinder beyond the base": ("x = 2.4", "x = 24.0"),
    "cylinder stiffness in kN/mm": ("stiffness = 3e7", "stiffness = 30"),
    "x and z of the ground swapped": ("ground = [0.7, -1.1]", "ground = [-1.1, 0.7]"),
    "ground farther out than the lug": ("ground = [0.7, -1.1]", "ground = [4.1, -1.1]"),
    "foot clamped": ('kind = "hinged"', 'kind = "clamped"'),
    "foot at the head": ("supports = [{ x = 0.0,", "supports = [{ x = 6.5,"),
    "damping in percent": ("modal = 0.01", "modal = 1.0"),
    "SI numbers in mm, t and s": ("title = ", 'units = "mm-t-s"\ntitle = '),
    "units in inches": ("title = ", 'units = "inch"\ntitle = '),
    "payload of 230 kg in N": ("mass = 150.0", "mass = 2256.0"),
    "typo in the state": ('state = "equilibrium"', 'state = "equilibrum"'),
    "start forgotten": ("start = {", "# start = {"),
    "run shorter than a period": ("duration = 5.0", "duration = 0.05"),
    "typo in the theory": ('theory = "timoshenko"', 'theory = "timoschenko"'),
    "segment without a joint": (
        "[[joint]]",
        '[[segment]]\nname = "tip"\nlength = 5.0\n'
        "section = { height = 0.2, width = 0.14, flange = 0.004, web = 0.003 }\n\n[[joint]]",
    ),
}
CRANE_MISTAKES = {
    "flat wider than the box": ("width = 0.68, flat = 0.46", "width = 0.68, flat = 0.76"),
    "rope in kN": ("force = 54700.0", "force = 54.7"),
    "rope in t": ("force = 54700.0", "force = 5.0"),
    "rope in mN": ("force = 54700.0", "force = 54700000.0"),
    "rope pulls to the tip": ("force = 54700.0", "force = -54700.0"),
    "load in kN": ("magnitude = -24517.0", "magnitude = -24.5"),
    "load upwards": ("magnitude = -24517.0", "magnitude = 24517.0"),
    "load also in the payload": ("mass = 350.0", "mass = 5350.0"),
    "load also as the payload": ("mass = 350.0", "mass = 5000.0"),
    "payload in t": ("mass = 350.0", "mass = 0.35"),
    "angle in rad": ("angle = 60.0", "angle = 1.047"),
    "angle from the vertical": ("angle = 60.0", "angle = 30.0"),
    "contact stiffness in N/mm": ("stiffness = 3e9", "stiffness = 3e6"),
    "exponent ten times": ("exponent = 1.0", "exponent = 10.0"),
    "contact length in mm": ("contact_length = 0.3", "contact_length = 300.0"),
    "contact longer than the overlap": ("contact_length = 0.3", "contact_length = 3.0"),
    "collar thickness in mm": ("thickness = 0.010", "thickness = 10"),
    "collar length in mm": ("head = 0.5", "head = 500"),
    "extension of more than the length": ("extension = 9.4", "extension = 12.0"),
    "play in mm": ("play = 0.005", "play = 5"),
    "play in km": ("play = 0.005", "play = 5e-6"),
    "plate in mm": ("top = 0.008", "top = 8"),
    "outer and inner swapped": (
        'outer = "base"\ninner = "second"',
        'outer = "second"\ninner = "base"',
    ),
    "third in base": ('outer = "second"\ninner = "third"', 'outer = "base"\ninner = "third"'),
    "joint forgotten": (FLY_JOINT, ""),
    "yield in MPa": ("yield_strength = 6.9e8", "yield_strength = 690"),
    "mesh in mm": ("mesh_size = 0.2", "mesh_size = 200"),
    "cylinder on the upper side": ("ground = [1.6, -1.7]", "ground = [1.6, 1.7]"),
    "depth negative": ("depth = 0.55", "depth = -0.55"),
    "length in dm": ('name = "third"\nlength = 11.7', 'name = "third"\nlength = 117'),
}
ARM_MISTAKES = {
    "E of steel": ("youngs_modulus = 7.0e10", "youngs_modulus = 2.1e11"),
    "density of steel": ("density = 2700.0", "density = 7850.0"),
    "density in g/cm3": ("density = 2700.0", "density = 2.7"),
    "pad modulus in MPa": ("modulus = 8e8", "modulus = 800"),
    "pad thickness ten times": ("thickness = 0.025", "thickness = 0.25"),
    "pad pressure in MPa": ("allowable_pressure = 1e7", "allowable_pressure = 10"),
    "lateral play in mm": ("lateral_play = 0.004", "lateral_play = 4"),
    "lateral play forgotten": ("lateral_play = 0.004\n", ""),
    "gust in kN": ("magnitude = 0.35", "magnitude = 0.00035"),
    "gust in N": ("magnitude = 0.35", "magnitude = 350.0"),
    "gust along x": ('direction = "y"', 'direction = "x"'),
    "file misspelt": ("gust.csv", "gusts.csv"),
    "file with another suffix": ("gust.csv", "gust.xlsx"),
    "payload in kN": ("mass = 280.0", "mass = 2.8"),
    "payload in N": ("mass = 280.0", "mass = 2746.0"),
    "tolerance in percent": ('kind = "shell"\n', 'kind = "shell"\ntolerance = 5\n'),
    "root hinged": ('kind = "clamped"', 'kind = "hinged"'),
    "middle as large as root": ("height = 0.29, width = 0.21", "height = 0.34, width = 0.26"),
    "detail category in Pa": ("detail_category = 23.0", "detail_category = 23e6"),
}
# No program can find this: the number is possible.
UNNOTICED = {"extension meant as overlap"}


def find_cautions(path: Path) -> list[str] | None:
    """Return the cautions of ``check``, without numbers; None if it refuses the case."""
    try:
        found = load_checked(str(path))
    except BadInput:
        return None
    lines = proportion_cautions(found.case, found.boom)
    lines = lines or [line for line in check_case(found).lines if line.startswith("caution")]
    return [re.sub(r"\d", "", line) for line in lines]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("correct", "mistakes", "unnoticed"),
    [(CASE, LIFT_MISTAKES, UNNOTICED), (CRANE, CRANE_MISTAKES, set()), (ARM, ARM_MISTAKES, set())],
    ids=["lift", "crane", "arm"],
)
def test_natural_mistakes_are_noticed(
    tmp_path: Path, correct: str, mistakes: dict[str, tuple[str, str]], unnoticed: set[str]
) -> None:
    """Reference: by hand, 142 mistakes of unit, sign, name and place in correct cases."""
    path, missed = tmp_path / "boom.toml", set()
    path.write_text(correct, "utf-8")
    known = find_cautions(path)
    for mistake, (text, replacement) in mistakes.items():
        assert text in correct, mistake
        path.write_text(correct.replace(text, replacement), "utf-8")
        cautions = find_cautions(path)
        if cautions is not None and set(cautions) <= set(known):
            missed.add(mistake)
    assert missed == unnoticed


def test_the_correct_lift_has_no_caution(tmp_path: Path) -> None:
    path = tmp_path / "lift.toml"
    path.write_text(CASE, "utf-8")
    assert find_cautions(path) == []
