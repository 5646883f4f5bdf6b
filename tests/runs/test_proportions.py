# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slips of the unit or of the sign are told, and cases that come with the project have none."""

from pathlib import Path

import pytest

from runs import CASES
from runs.case import reading as case_file
from runs.case.build import build_boom
from runs.pipeline.proportions import proportion_cautions
from tests.runs.case_texts import STEEL, box, joint, read_case

CASE = f"""
title = "An arm"
[time]
duration = 1.0
{STEEL}
[payload]
mass = 500.0
{box("arm", (0.0, 8.0), (0.4, 0.3, 0.008, 0.006), "load = -670.0")}
supports = [{{ x = 0.0, kind = "clamped" }}]
{box("fly", (7.0, 14.0), (0.36, 0.26, 0.006, 0.005), "load = -470.0")}
{joint("fly", "arm", 0.004, (7.0, 8.0), "stiffness = 1e8")}
[[model]]
name = "beam"
kind = "finite-element"
element_length = 0.5
[[model]]
name = "shell"
kind = "shell"
mesh_size = 0.1
"""


def slips_of(folder: Path, old: str, new: str) -> list[str]:
    """Of the case with something else in place of what it says."""
    assert CASE.count(old) == 1 or old == ""
    case = read_case(folder, CASE.replace(old, new) if old else CASE)
    return proportion_cautions(case, build_boom(case))


def test_an_arm_has_none(tmp_path: Path) -> None:
    assert slips_of(tmp_path, "", "") == []


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_cases_have_no_cautions(path: Path) -> None:
    case = case_file.load(str(path))
    assert proportion_cautions(case, build_boom(case)) == []


@pytest.mark.parametrize(
    ("old", "new", "slip"),
    [
        ("youngs_modulus = 2.1e11",
         "youngs_modulus = 7e8",
         "material.youngs_modulus: Young's modulus is 7e+08 Pa, usual is from 1e+09 up to 1e+12 "
         "Pa; if it is in kPa, give 7e+11 Pa"),
        ("density = 7850.0",
         "density = 7.85",
         "material.density: the density is 7.85 kg/m³, usual is from 500 up to 2.5e+04 kg/m³; "
         "if it is in t/m^3, give 7850 kg/m³"),
        ("height = 0.4, width = 0.3",
         "height = 4.0, width = 0.3",
         "segment[1].section: the height of 'arm' is 4 m, usual is from 0.016 up to 1.6 m; if "
         "it is in cm, give 0.04 m"),
        ("mass = 500.0",
         "mass = 0.5",
         "the payload of 0.5 kg is less than a fiftieth of the boom's 972.6 kg; check the "
         "units"),
        ("load = -470.0",
         "load = -4.7e6",
         "a load of 3.29e+07 N is more than a hundred times the boom's weight of 1.444e+04 N; "
         "check the units"),
        ("stiffness = 1e8",
         "stiffness = 1e4",
         "the compliance of the contacts of 'fly' in 'beam' is 0.0001 m/N, above that of the "
         "segment as a cantilever, 3.89e-06 m/N; check their stiffness"),
        ("mesh_size = 0.1",
         "mesh_size = 0.5",
         "the mesh size of 'shell', 0.5 m, is larger than a wall of 0.26 m"),
    ],
    ids=["modulus", "density", "height", "payload", "load", "contact", "mesh"],
)  # fmt: skip
def test_each_slip_is_told(tmp_path: Path, old: str, new: str, slip: str) -> None:
    assert f"caution: {slip}" in slips_of(tmp_path, old, new)


def test_folds_and_heads_are_walls_too(tmp_path: Path) -> None:
    """Reference: by hand, a chamfer of 50 mm is √2 · 50 mm wide; so at a taper's head alone."""
    box = "section = { height = 0.36, width = 0.26, flange = 0.006, web = 0.005 }"
    assert CASE.count(box) == 1
    fold = (
        "shape = 'octagon', height = 0.36, width = 0.26, top = 0.006, bottom = 0.006, web = 0.005"
    )
    narrow, wide = (f"{{ {fold}, chamfer = {chamfer} }}" for chamfer in (0.05, 0.075))
    caution = "caution: the mesh size of 'shell', 0.1 m, is larger than a wall of 0.0707 m"
    assert slips_of(tmp_path, box, f"section = {narrow}") == [caution]
    assert slips_of(tmp_path, box, f"section = {wide}") == []
    assert slips_of(tmp_path, box, f"section = {wide}\nhead_section = {narrow}") == [caution]


def test_weights_of_the_wrong_sign_are_told(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    text = CASE.replace("load = -", "load = ").replace("[payload]\nmass = 500.0\n", "")
    path.write_text(text, encoding="utf-8")
    case = case_file.load(str(path))
    assert proportion_cautions(case, build_boom(case)) == [
        "caution: the loads pull upwards, by 8650 N in all; those that pull down, as weights do, "
        "are negative"
    ]
