# SPDX-License-Identifier: LGPL-3.0-or-later
"""Messages in the units of a case, and forces in kN in all of them."""

from pathlib import Path

import pytest

from protractile.geometry.units import System
from protractile.runs.check import check_case
from tests.runs.case_texts import edited, load_checked_text, refusal

IN_MM = """
title = "A lift in millimetres"
units = "mm-t-s"
time = { duration = 3.0 }
gravity = { angle = 30.0 }
start = { state = "equilibrium" }
payload = { mass = 1.0 }
material = { youngs_modulus = 2.1e5, poissons_ratio = 0.3, density = 7.85e-9 }
load = [{ segment = "fly", x = "head", magnitude = -5.0e6, moment = true }]
model = [{ name = "beam", kind = "finite-element" }]
[[segment]]
name = "base"
length = 5200.0
supports = [{ x = 0.0, kind = "hinged" }]
section = { height = 340.0, width = 230.0, flange = 12.0, web = 8.0 }
[[segment]]
name = "fly"
length = 5000.0
section = { height = 280.0, width = 180.0, flange = 12.0, web = 8.0 }
[[joint]]
outer = "base"
inner = "fly"
extension = 4000.0
stations = ["tail", "head"]
play = 2.0
pad = { length = 120.0, width = 50.0, thickness = 18.0 }
[[cylinder]]
segment = "base"
x = 1800.0
depth = 220.0
ground = [350.0, -900.0]
stiffness = 45000.0
"""


@pytest.mark.parametrize(
    ("message", "shown"),
    [
        ("must be below 4.8 m, got 4.9 m", "must be below 4800 mm, got 4900 mm"),
        ("-0.033 m of 150 kg at 2e8 Pa and 3 m/s",
         "-33 mm of 0.15 t at 200 MPa and 3000 mm/s"),
        ("at t = 0.5 s, of 20 N/m", "at t = 0.5 s, of 0.02 N/mm"),
        ("elements of x2 m and 5 mm", "elements of x2 m and 5 mm"),
    ],
)  # fmt: skip
def test_amounts_are_in_the_units_of_the_case(message: str, shown: str) -> None:
    """Reference: by hand."""
    assert System("mm-t-s").convert(message) == shown
    assert System().convert(message) == message


def test_a_refusal_is_in_the_units_of_the_case(tmp_path: Path) -> None:
    """Reference: by hand, free are 340 - 12 - 280 - 12 = 36 mm, 230 - 8 - 180 - 8 = 34 mm."""
    found = refusal(tmp_path, edited(IN_MM, ("play = 2.0", "play = 50.0")))
    assert found.startswith("joint[1].play: 'fly' does not fit in 'base': 36 mm of height ")
    assert "a play of 50 mm is asked for" in found


def test_forces_are_in_kilonewtons(tmp_path: Path) -> None:
    """Reference: the table of cylinders, whose forces are in kN."""
    tables = {table.title: table for table in check_case(load_checked_text(tmp_path, IN_MM)).tables}
    assert tables["Loads"].rows[2][4] == "−5 kN m"
    (rest,) = (table for title, table in tables.items() if title.startswith("Static results at"))
    rows = {row[0]: row for row in rest.rows}
    (own,) = tables["Cylinders at rest, t = 0"].rows
    assert rows["cylinder force"][1] == f"{float(own[-1]):.3g} kN"
