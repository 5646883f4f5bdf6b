# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cautions for numbers out of proportion, and refusals of impossible ones."""

import re
from pathlib import Path

import pytest

from protractile.runs.case.build import build_boom
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.rules import OF_INPUTS, cautions
from tests.runs.case_texts import (
    CLAMPED,
    HINGED,
    STEEL,
    box,
    edited,
    elements,
    read_case,
    refusal,
    table,
)
from tests.runs.summaries import printed_check

PAD = {"length": 0.12, "width": 0.05, "thickness": 0.012}
LIFT = f"""
title = "A lift"
time = {{ duration = 3.0 }}
gravity = {{ angle = 45.0 }}
start = {{ state = "equilibrium" }}
payload = {{ mass = 300.0 }}
load = [{{ segment = "fly", x = "head", magnitude = -1595.0, ramp = 0.1 }}]
cylinder = [{{ segment = "base", x = 2.4, depth = 0.25, ground = [0.7, -1.1], stiffness = 3e7 }}]
{STEEL}
{box("base", (0.0, 6.5), (0.300, 0.220, 0.006, 0.005), HINGED)}
{box("fly", (5.3, 11.3), (0.256, 0.180, 0.005, 0.004))}
{table("[[joint]]", outer="base", inner="fly", stations=["tail", "head"], play=0.003, pad=PAD)}
{elements("beam", theory="euler-bernoulli")}
"""
PLAY = "play = 0.003\npad = { length = 0.12, width = 0.05, thickness = 0.012 }\n"
SMALL = {"length": 0.01, "width": 0.004, "thickness": 0.0005}
SHIMMED = """play = 0.003
pads = [{ side = "above", length = 0.12, width = 0.05, thickness = 0.012 },
        { side = "below", length = 0.12, width = 0.05, thickness = 0.012, shim = 0.5 }]
"""
BESIDE = "play = 0.003\nlateral_play = 0.003\n" + "".join(
    table("[[joint.pads]]", side=side, length=0.12, width=0.05, thickness=thickness)
    for side, thickness in {"above": 0.012, "below": 0.012, "left": 0.016, "right": 0.015}.items()
)
SHELL = table("[[model]]", name="shell", kind="shell", mesh_size=0.05)
LOAD = '{ segment = "fly", x = "head", magnitude = -1595.0, ramp = 0.1 }'


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("2.1e11", "2.1e5",
         "material.youngs_modulus: Young's modulus is 2.1e+05 Pa, usual is from 1e+09 up to 1e+12 "
         "Pa; if it is in MPa, give 2.1e+11 Pa"),
        ("title", 'units = "N-mm"\ntitle', "material.youngs_modulus: … Pa, give 2.1e+05 MPa"),
        ("7850.0", "7850.0\nyield_strength = 355.0", "material.yield_strength: … 3.55e+08 Pa"),
        ("height = 0.3, width = 0.22, flange = 0.006, web = 0.005",
         "height = 300.0, width = 220.0, flange = 6.0, web = 5.0",
         "segment[1].section: the height of 'base' is 300 m, … if it is in mm, give 0.3 m"),
        ("flange = 0.005", "flange = 1e-9",
         "segment[2].section: the thickness of the bottom of 'fly' is 1e-09 m, … usual is from "
         "0.00018 m; check the number and its unit"),
        ("0.004 }", "0.004 }\nsecond_moment_of_area = 0.35",
         "segment[2].second_moment_of_area: the second moment of area beside the plates of 'fly' "),
        ("section = { height = 0.256, width = 0.18, flange = 0.005, web = 0.004 }",
         "mass_per_length = 32.0\nsecond_moment_of_area = 4069.0",
         "segment[2].second_moment_of_area: … if it is in cm^4, give 4.069e-05 m⁴"),
        ("thickness = 0.012", "thickness = 12.0", "joint[1].pad.thickness: … mm, give 0.012 m"),
        (PLAY, SHIMMED, "joint[1].pads[2].shim: … mm, give 0.0005 m"),
        (PLAY, f"{PLAY}friction = 1e30\nnormal_forces = [1e3, 1e3]\n", "joint[1].friction: "),
        (PLAY, f"{PLAY}drive = {{ travel = -4.0, time = 1e-6 }}\n",
         "joint[1].drive: the largest speed at which 'fly' moves is 8e+06 m/s, "),
        (PLAY, "play = 0.003\nstiffness = 1e8\ndrive = { travel = 1.199999999, time = 9.0 }\n",
         "joint[1].drive: the overlap of 'fly' that the drive leaves is 1e-09 m, "),
        ("[0.7, -1.1]", "[0.7, -700.0]",
         "cylinder[1].ground: the length of cylinder 1 is 699.75 m, … mm, give 0.69975 m"),
        ("[[model]]", "[[axial]]\nforce = -1e12\n[[model]]", "axial[1].force: "),
        ("[[model]]", "[life]\ndetail_category = 7.1e7\n[[model]]", "life.detail_category: "),
    ],
)  # fmt: skip
def test_impossible_numbers_are_refused(tmp_path: Path, old: str, new: str, line: str) -> None:
    """Reference: exact words around an omission."""
    start, _, end = line.partition(" … ")
    found = refusal(tmp_path, edited(LIFT, (old, new)))
    assert (found[: len(start)], found[-len(end) :] if end else "") == (start, end)


def cautions_of(folder: Path, text: str) -> list[str]:
    case = read_case(folder, text)
    return cautions(Context(case, build_boom(case)), OF_INPUTS)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("thickness = 0.012", "thickness = 0.2",
         "joint[1].pad.thickness: … in cm, give 0.002 m\njoint[1].pad.thickness: pads of 200 mm "
         "above and 200 mm below and the play of 3 mm need 403 mm, and between … "),
        ("thickness = 0.012", "thickness = 0.016",
         "joint[1].pad.thickness: pads of 16 mm above and 16 mm below and the play of 3 mm need 35 "
         "mm, and between 'base' and 'fly' are 33 mm, both sides together; … "),
        (PLAY, BESIDE,
         "joint[1].pads: pads of 16 mm left and 15 mm right and the play of 3 mm need 34 mm, and "
         "between 'base' and 'fly' are 31 mm, … "),
        (PLAY, f"{PLAY}normal_forces = [1e3, 1e3]\n", "joint[1].normal_forces: they have no … "),
        ("angle = 45.0", "angle = 0.785",
         "gravity.angle: 0.785 degrees is nearly level; if it is in radians, give 44.98"),
        ("gravity = { angle = 45.0 }", "",
         "gravity: missing, so that the payload of 300 kg weighs and the 469 kg of the boom … "),
        ("ramp = 0.1", "ramp = 100.0", "load[1].ramp: the run of 3 s ends at 3 % of the ramp … "),
        ("-1595.0", "-300.0",
         "load[1].magnitude: -300 N at the tip is a tenth of … kg, give -2942 N"),
        ("-1595.0", "-230.0", "load[1].magnitude: -230 N at the tip is 3 % … weight, -1595 N"),
        ("-1595.0", "-2942.0",
         "load[1].magnitude: if -2942 N at the tip is the weight of the payload, it acts … "),
        (LOAD, f"{LOAD}, {LOAD}", "load[2]: repeats load[1]; leave one of them out"),
        ("mass = 300.0", "mass = 3.0",
         "the payload of 3 kg is less than a fiftieth of the boom's 472 kg; check the units"),
        ("0.004 }", "0.004 }\nload = -4.7e6", "a load of 28200 kN is more … weight of 7.54 kN; "
         "check the units"),
        (PLAY, "play = 0.003\nstiffness = 1e4\n",
         "the compliance of the contacts of 'fly' in 'beam' is 0.000103 m/N, above 8.43e-06 … "),
        (PLAY, "play = 0.003\nforce_table = [[0.001, 100.0], [0.002, 100.0]]\n",
         "the contacts of 'fly' in 'beam' do not become stiffer at 2.36e+03 N, … "),
        ("[[model]]", SHELL.replace("0.05", "0.5") + "[[model]]",
         "the mesh size of 'shell', 0.5 m, is larger than a wall of 0.18 m"),
        ("angle = 45.0", "angle = 45.0, acceleration = 19.62", "gravity.acceleration: … "),
        (LOAD, f'{LOAD}, {{ segment = "fly", magnitude = -209.5 }}',
         "load[2].magnitude: -1257 N in all is the weight of 'fly', … "),
        ("0.004 }", "0.004 }\nmasses = [{ x = 'head', mass = 300.0 }]",
         "segment[2].masses: the 300 kg of the payload are repeated at the tip; … "),
        ('x = "head", magnitude', "magnitude",
         "load[1]: -1595 N/m along the whole of 'fly' makes 9.57 kN, 5.4 times its weight; … x"),
        ("[0.7, -1.1]", "[4.1, -1.1]", "cylinder[1].ground: the lower end at x = 4.1 m is … "),
        ("supports = [{ x = 0.0", "supports = [{ x = 3.0", "cylinder[1].x: the foot at x = 3 m … "),
        ("depth = 0.25", "depth = -0.25", "cylinder[1].depth: -0.25 m puts the lug above the … "),
        # A cylinder above the boom, which pulls.
        ("depth = 0.25, ground = [0.7, -1.1]", "depth = -0.25, ground = [0.7, 1.1]", ""),
        ('state = "equilibrium"', 'state = "rest"', "start.state: the boom starts straight and … "),
        ("play = 0.003", "play = 0.03", "joint[1].play: … 0.018 m; if it is in cm, give 0.0003 m\n"
         "joint[1].pad.thickness: pads … "),
        ("payload", "axial = [{ force = -100.0 }]\npayload", "axial[1].force: -100 N pulls the … "),
        ("payload", "axial = [{ force = 1.0 }]\npayload", "axial[1].force: 1 N is less than … "),
        ("payload", "axial = [{ force = 2080.0 }]\npayload",
         "axial[1].force: 2080 N is the weight of the payload along the boom, … "),
        ("0.004 }", "0.004 }\nload = -296.3", "segment[2].load: -296.3 N/m is the weight of … "),
        ("-1595.0", "15950.0", "the loads pull upwards, by 10.6 kN in all; … negative"),
        ("-1595.0", "4500.0",
         "the loads lift the boom: about its base they turn it up by 10.4 kN m more … negative"),
    ],
)  # fmt: skip
def test_unusual_numbers_give_cautions(tmp_path: Path, old: str, new: str, line: str) -> None:
    """Reference: exact words around an omission, of the only cautions."""
    found = cautions_of(tmp_path, edited(LIFT, (old, new)))
    parts = [one.partition(" … ") for one in line.splitlines()]
    shown = [
        (one.removeprefix("caution: ")[: len(start)], one[len(one) - len(end) :])
        for one, (start, _, end) in zip(found, parts, strict=True)
    ]
    assert shown == [(start, end) for start, _, end in parts]


STILL = 'start = { state = "equilibrium" }\n'
PUSH = f"load = [{LOAD}]\n"
DRIVE = f"{PLAY}drive = {{ travel = -0.1, speed = 0.1 }}\n"


@pytest.mark.parametrize(
    ("edits", "rests"),
    [
        ({PUSH: ""}, True),
        ({PUSH: "axial = [{ force = 1e4 }]\n"}, True),
        ({}, False),
        ({PUSH: "base = [{ direction = 'z', acceleration = 1.0, ramp = 0.1 }]\n"}, False),
        ({f"{STILL}{PUSH}": "start.velocity = { fly = 0.1 }\n"}, False),
        ({PUSH: "", PLAY: DRIVE}, False),
    ],
    ids=["nothing", "along", "load", "base", "velocity", "drive"],
)
def test_a_boom_that_nothing_loads_gives_a_caution(
    tmp_path: Path, edits: dict[str, str], rests: bool
) -> None:
    """Reference: analytic. A straight boom without a force across its axis stays straight."""
    weights = {"gravity = { angle = 45.0 }\n": "", "payload = { mass = 300.0 }\n": ""}
    found = cautions_of(tmp_path, edited(LIFT, *weights.items(), *edits.items()))
    start = "caution: load: nothing loads the boom across its axis or moves it, so that it stays"
    assert any(line.startswith(start) for line in found) == rests


def test_run_shorter_than_a_period_gives_a_caution(tmp_path: Path) -> None:
    """Reference: the frequency in the line above."""
    shown = printed_check(read_case(tmp_path, edited(LIFT, ("duration = 3.0", "duration = 0.2"))))
    assert "the run of 0.2 s is shorter than one period in the beam estimate, 0.605 s; " in shown
    (frequency,) = re.findall(r"joints in contact, in the beam estimate[^:]*: ([0-9.]+) Hz", shown)
    assert 1.0 / float(frequency) == pytest.approx(0.605, rel=1e-3)


LABORATORY = f"""
title = "A boom on a table"
time = {{ duration = 2.0 }}
gravity = {{ angle = 10.0 }}
payload = {{ mass = 0.2 }}
{table("[material]", youngs_modulus=7e10, poissons_ratio=0.33, density=2700.0, yield_strength=2e8)}
{box("outer", (0.0, 0.6), (0.020, 0.015, 0.0012, 0.001), CLAMPED)}
{box("inner", (0.5, 1.0), (0.0165, 0.0125, 0.001, 0.001))}
{table("[[joint]]", outer="outer", inner="inner", stations=[0.5, 0.6], play=0.0002, pad=SMALL)}
{elements("beam", element_length=0.05)}
"""


def test_a_usual_small_boom_has_no_cautions(tmp_path: Path) -> None:
    """Reference: a boom of 1 m in a laboratory."""
    assert "caution" not in printed_check(read_case(tmp_path, LABORATORY))


@pytest.mark.slow
def test_folds_at_a_head_are_walls_too(tmp_path: Path) -> None:
    """Reference: by hand. A chamfer of 30 mm is √2 · 30 mm wide."""
    octagon = (
        "shape = 'octagon', height = 0.256, width = 0.18, top = 0.005, bottom = 0.005, web = 0.004"
    )
    wide, narrow = (f"{{ {octagon}, chamfer = {chamfer} }}" for chamfer in (0.06, 0.03))
    box = "section = { height = 0.256, width = 0.18, flange = 0.005, web = 0.004 }"
    both = f"section = {wide}\nhead_section = {narrow}"
    text = edited(LIFT, (box, both), ("width = 0.05, t", "width = 0.02, t"))
    assert [line for line in cautions_of(tmp_path, text + SHELL) if "mesh" in line] == [
        "caution: the mesh size of 'shell', 0.05 m, is larger than a wall of 0.0424 m"
    ]
