# SPDX-License-Identifier: LGPL-3.0-or-later
"""Natural mistakes in a lift, a crane and an inspection arm are refused or cause a caution."""

import re
from pathlib import Path

import pytest

from protractile.runs import CASES
from protractile.runs.case.reading import load_checked
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.rules import OF_INPUTS, cautions
from protractile.runs.check import check_case
from protractile.runs.process.bad_input import BadInput
from tests.docs.conftest import toml_blocks

CASE = "".join(toml_blocks("tutorial.md")[:2])
CRANE = (CASES / "crane.toml").read_text("utf-8")
ARM = (CASES / "inspection-arm.toml").read_text("utf-8").partition("# Combinations after")[0]
ARM = ARM.replace("gust.csv", str(CASES / "gust.csv"))


def with_load(keys: str) -> tuple[str, str]:
    """Return the replacement that adds a load of the fly to the lift."""
    return "[damping]", f'[[load]]\nsegment = "fly"\n{keys}\n[damping]'


# Each mistake with the text of the case and its replacement.
LIFT_MISTAKES = {
    "fly larger than base": ("height = 0.256, width = 0.180", "height = 0.356, width = 0.280"),
    "angle negative": ("angle = 45.0", "angle = -45.0"),
    "pad pressure in MPa": ("allowable_pressure = 2e7", "allowable_pressure = 20"),
    "extension meant as overlap": ("extension = 4.8", "extension = 1.2"),
    "load sign": ("magnitude = -1595.0", "magnitude = 1595.0"),
    "load in kN": ("magnitude = -1595.0", "magnitude = -1.595"),
    "payload in N": ("mass = 150.0", "mass = 1471.0"),
    "damping 10x": ("modal = 0.01", "modal = 0.2"),
    "cylinder stiffness in N/mm": ("stiffness = 3e7", "stiffness = 3e4"),
    "cylinder on fly": ('segment = "base"\nx = 2.4', 'segment = "fly"\nx = 8.0'),
    "duration in ms": ("duration = 5.0", "duration = 5000"),
    "tail and head of load": ('x = "head"\nmagnitude', 'x = "tail"\nmagnitude'),
    "cage also as a force across": with_load('x = "head"\nmagnitude = -1040.0'),
    "cage also as a force with g of 10": with_load('x = "head"\nmagnitude = -1500.0'),
    "cage also as a mass near the head": (
        "section = { height = 0.256",
        "masses = [{ x = { head = 0.05 }, mass = 150 }]\nsection = { height = 0.256",
    ),
    "weight of fly at its middle": with_load("x = 8.3\nmagnitude = -1778.0"),
    "load twice, other form of x": with_load("x = 11.3\nmagnitude = -1595.0\nramp = 0.1"),
    "E a tenth": ("youngs_modulus = 2.1e11", "youngs_modulus = 2.1e10"),
    "walls a tenth": ("flange = 0.006, web = 0.005", "flange = 0.0006, web = 0.0005"),
    "angle forgotten": ("angle = 45.0", "acceleration = 9.81"),
    "flange and web swapped": ("flange = 0.006, web = 0.005", "flange = 0.005, web = 0.006"),
    "play in mm": ("play = 0.003", "play = 3.0"),
    "payload in t": ("mass = 150.0", "mass = 0.15"),
    "foot clamped": ('kind = "hinged"', 'kind = "clamped"'),
}
CRANE_MISTAKES = {
    "load also in the payload": ("mass = 350.0", "mass = 5350.0"),
    "angle from the vertical": ("angle = 60.0", "angle = 30.0"),
    "contact stiffness in N/mm": ("stiffness = 3e9", "stiffness = 3e6"),
    "collar length in mm": ("head = 0.5", "head = 500"),
    "third in base": ('outer = "second"\ninner = "third"', 'outer = "base"\ninner = "third"'),
}
ARM_MISTAKES = {
    "E of steel": ("youngs_modulus = 7.0e10", "youngs_modulus = 2.1e11"),
    "density of steel": ("density = 2700.0", "density = 7850.0"),
    "pad modulus in MPa": ("modulus = 8e8", "modulus = 800"),
    "lateral play in mm": ("lateral_play = 0.004", "lateral_play = 4"),
    "lateral play forgotten": ("lateral_play = 0.004\n", ""),
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
    lines = cautions(Context(found.case, found.boom), OF_INPUTS)
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
    """Reference: by hand, mistakes of unit, sign and place that no other test makes."""
    path, missed = tmp_path / "boom.toml", set()
    path.write_text(correct, "utf-8")
    known = find_cautions(path)
    for mistake, (text, replacement) in mistakes.items():
        assert text in correct, mistake
        path.write_text(correct.replace(text, replacement), "utf-8")
        found = find_cautions(path)
        if found is not None and set(found) <= set(known):
            missed.add(mistake)
    assert missed == unnoticed


def test_the_correct_lift_has_no_caution(tmp_path: Path) -> None:
    path = tmp_path / "lift.toml"
    path.write_text(CASE, "utf-8")
    assert find_cautions(path) == []
