# SPDX-License-Identifier: LGPL-3.0-or-later
"""Values out of usual ranges, and inputs forgotten, repeated or swapped, by exact words."""

import re
from math import cos, radians
from pathlib import Path

import pytest

from protractile.runs.cautions import rules
from protractile.runs.cautions.context import Context
from tests.runs.case_texts import (
    CASES,
    HINGED,
    STEEL,
    box,
    edited,
    elements,
    load_checked_text,
    refusal,
    table,
)

PUSH = """[[base]]
acceleration = 0.5
group = "wind"
table = [[0.0, 0.0], [1.0, 0.5]]

"""
PIN = {"diameter": 0.04, "strength": 8e8}
PAD = {"length": 0.12, "width": 0.05, "thickness": 0.012, "allowable_pressure": 2e7}
LIFT = f"""
title = "A lift that is proved"
time = {{ duration = 3.0 }}
gravity = {{ angle = 45.0 }}
start = {{ state = "equilibrium" }}
payload = {{ mass = 150.0 }}
life = {{ detail_category = 71.0, partial_factor = 1.15 }}
{STEEL}
{box("base", (0.0, 6.5), (0.300, 0.220, 0.006, 0.005), HINGED)}
{box("fly", (5.3, 11.3), (0.256, 0.180, 0.005, 0.004))}
{table("[[joint]]", outer="base", inner="fly", stations=["tail", "head"], play=0.003, pad=PAD)}
{
    table(
        "[[cylinder]]",
        segment="base",
        x=2.4,
        depth=0.25,
        ground=[0.7, -1.1],
        stiffness=3e7,
        capacity=2e5,
        pin=PIN,
    )
}
[[load_case]]
name = "a"
load = [{{ segment = "fly", magnitude = -30.0, group = "wind" }}]
[[combination]]
name = "Z1"
factors = {{ dead = [1.2, 1.0], payload = 1.3, wind = 1.1 }}
resistance = {{ material = 1.1 }}
{elements("beam", theory="timoshenko")}
"""
HOIST = re.sub(r"(?ms)^\[rope\].*?(?=^\[)", "", (CASES / "hoist.toml").read_text("utf-8"))


def cautions(folder: Path, text: str) -> list[str]:
    checked = load_checked_text(folder, text)
    return [
        line.removeprefix("caution: ")
        for line in rules.cautions(Context(checked.case, checked.boom), rules.OF_INPUTS)
    ]


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("material = 1.1", "material = 1e-9",
         "combination[1].resistance.material: the resistance factor is 1e-09, usual is from 1 up "
         "to 3; check the number and its unit"),
        ("partial_factor = 1.15", "partial_factor = 1e-9",
         "life.partial_factor: the partial factor of fatigue is 1e-09, usual is from 1 up to 2; "
         "check the number and its unit"),
        ("diameter = 0.04", "diameter = 40.0",
         "cylinder[1].pin.diameter: the diameter of the pin is 40 m, usual is from 0.003 up to 0.5 "
         "m; if it is in mm, give 0.04 m"),
        ("ground = [0.7, -1.1]", "ground = { front = 0.0012, below = 0.0003 }",
         "cylinder[1].ground: the distance from the foot pin to the ground of cylinder 1 is "
         "0.0012369 m, usual is from 0.226 up to 11.3 m; check the number and its unit"),
        ("strength = 800000000.0", "strength = 800.0",
         "cylinder[1].pin.strength: the strength of the pin is 800 Pa, usual is from 2e+08 up to "
         "2e+09 Pa; if it is in MPa, give 8e+08 Pa"),
        ("capacity = 200000.0", "capacity = 1e30",
         "cylinder[1].capacity: the capacity of the cylinder is 1e+30 N, usual is from {low} up to "
         "{high} N; check the number and its unit"),
        ("allowable_pressure = 20000000.0", "allowable_pressure = 1e30",
         "joint[1].pad.allowable_pressure: the allowable pressure of the pad is 1e+30 Pa, usual is "
         "from 1e+06 up to 3e+08 Pa; check the number and its unit"),
        ("resistance = { material = 1.1 }", "proofs = []",
         "combination[1].proofs: empty; give at least one"),
        ("play = 0.003", "play = 4.0",
         "joint[1].play: 'fly' does not fit in 'base': 0.033 m of height and 0.031 m of width are "
         "free, and a play of 4 m is asked for; make the inner section or the play smaller; if it "
         "is in mm, give 0.004 m"),
    ],
)  # fmt: skip
def test_senseless_values_are_refused(tmp_path: Path, old: str, new: str, line: str) -> None:
    """Reference: exact words; the weight of the boom without payload by its plates."""
    plates = 7850.0 * (
        6.5 * 2.0 * (0.22 * 0.006 + 0.3 * 0.005) + 6.0 * 2.0 * (0.18 * 0.005 + 0.256 * 0.004)
    )
    low, high = (f"{factor * 9.80665 * plates:.3g}" for factor in (0.5, 1e3))
    assert refusal(tmp_path, edited(LIFT, (old, new))) == line.format(low=low, high=high)


@pytest.mark.parametrize(
    ("old", "new", "start"),
    [
        # The boom weighs 4.2 kN.
        ("capacity = 200000.0", "capacity = 2000.0", "cylinder[1].capacity: the capacity of the "),
        ("stiffness = 30000000.0", "stiffness = 30000.0", "cylinder[1].stiffness: the stiffness "),
        ("allowable_pressure = 20000000.0", "allowable_pressure = 20.0",
         "joint[1].pad.allowable_pressure: the allowable pressure of the pad is 20 Pa, "),
        ('name = "a"', 'name = "a"\npayload = 1e6', "load_case[1].payload: the payload is 1e+06 "),
        ("material = 1.1", "material = 0.9", "combination[1].resistance.material: the resistance "),
        ("dead = [1.2, 1.0], payload = 1.3, wind = 1.1", "dead = 0.0, payload = 0.0, wind = 0.0",
         "combination[1].factors: all are 0, so that no load acts"),
        ("magnitude = -30.0", "magnitude = -110000.0",
         "load_case[1].load[1].magnitude: -110000 N/m is "),
        ("[[joint]]", PUSH + "[[joint]]",
         "base[1]: its table ends at 1 s with 100 % of its peak, which acts until the run ends; "),
        ("density = 7850.0", "density = 7850.0\nyield_by_thickness = [[0.005, 3.55e8]]",
         "segment[1].section: a plate of 6 mm is thicker than the last pair of "
         "yield_by_thickness, 5 mm, and takes its strength; add a pair"),
        ("flange = 0.006, web = 0.005", "flange = 0.005, web = 0.006",
         "segment[1].section: the flanges of 0.005 m are thinner than the webs of 0.006 m; "),
        ("gravity = { angle = 45.0 }", "gravity = { acceleration = 9.81 }",
         "gravity.angle: missing, so that the boom on its cylinder is horizontal; "),
    ],
)  # fmt: skip
def test_unusual_values_are_cautioned(tmp_path: Path, old: str, new: str, start: str) -> None:
    """Reference: exact words of the key; the correct lift has none."""
    assert cautions(tmp_path, LIFT) == []
    (found,) = cautions(tmp_path, edited(LIFT, (old, new)))
    assert found.startswith(start)


@pytest.mark.parametrize(
    ("key", "value"),
    [("travel", "1e6"), ("speed", "1e6"), ("modulus", "1e-6"), ("length", "1e6")],
)
def test_hoists_without_sense_are_refused(tmp_path: Path, key: str, value: str) -> None:
    given = HOIST.replace("ramp = 0.2", "ramp = 0.0")
    hoist = given.index("[hoist]")
    text = given[:hoist] + re.sub(rf"(?m)^{key} = .*", f"{key} = {value}", given[hoist:], count=1)
    assert refusal(tmp_path, text).startswith(f"hoist.{key}: the ")


def test_a_hoist_needs_its_rope_and_its_load_once(tmp_path: Path) -> None:
    """Reference: exact words."""
    text = re.sub(r"(?ms)^\[payload\].*?mass = [0-9.]+", "[payload]\nmass = 5000.0", HOIST)
    assert [line.partition(",")[0] for line in cautions(tmp_path, text)] == [
        "payload.mass: the 5000 kg at the tip are also the load of [hoist]",
        "rope: missing",
    ]


@pytest.mark.parametrize("angle", [0.0, 60.0])
def test_the_weight_on_the_rope_is_given_once(tmp_path: Path, angle: float) -> None:
    """Reference: exact words; 5 t weigh 49033 N, at 60 degrees 24517 N across the boom."""
    force = -5000.0 * 9.80665 * cos(radians(angle))
    load = table("[[load]]", segment="fly", x="head", magnitude=force, ramp=0.1)
    assert [line for line in cautions(tmp_path, HOIST + load) if line.startswith("load[")] == [
        f"load[1].magnitude: if {force:g} N at the tip is the weight of the load of [hoist], it "
        "acts already; leave it out"
    ]


def test_a_boom_that_buckles_names_the_likely_unit(tmp_path: Path) -> None:
    """Reference: exact words; a stiffness in N/mm, and a payload of ten times the boom."""
    old = "stiffness = 30000000.0"
    text = edited(LIFT, ("mass = 150.0", "mass = 5000.0"), (old, "stiffness = 30000.0"))
    found = refusal(tmp_path, text)
    assert found.startswith("model[1]: the boom of 'beam' buckles under ")
    assert found.endswith("; if it is in N/mm, give 3e+07 N/m")
