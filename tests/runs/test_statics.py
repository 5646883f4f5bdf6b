# SPDX-License-Identifier: LGPL-3.0-or-later
"""What ``check`` tells of the boom at rest."""

from dataclasses import replace
from math import sqrt
from pathlib import Path

import pytest

from geometry.fields import Distance
from runs import CASES
from runs.case import reading as case_file
from runs.case.build import build_boom
from runs.case.checked_case import CheckedCase
from runs.case.schema import Case, StopTable
from runs.check import check_case, print_check
from runs.pipeline.models import build
from tests.runs.case_texts import read_case
from tests.runs.summaries import printed


def told(case: Case) -> list[str]:
    shown = printed(print_check, CheckedCase(case), width=200)
    return [" ".join(line.replace("−", "-").split()) for line in shown.split("\n")]


def test_masses_forces_and_tips_are_those_of_hand() -> None:
    """Reference: by hand, the lever rule; without play other code, 9.916 mm of shear-flexible
    elements; the play lifts the tip by 7 + 14 · 9 mm beyond, and bends nothing.
    """
    lines = told(case_file.load(str(CASES / "coarse.toml")))
    assert "outer 831.6 0 5" in lines
    assert "all 1382 0 8.586" in lines
    rows = {tuple(line.split()[:2]): line.split()[2:] for line in lines}
    for place, expected in {
        ("outer", "0"): [4.552],
        ("outer", "2"): [-5.934],
        ("inner", "9"): [2.203, 0.0148],
        ("inner", "10"): [-2.7535, 0.0166],
    }.items():
        assert [float(value) for value in rows[place]] == pytest.approx(expected, rel=1e-3)
    # 15 and 17 µm of contact turn the segment, too.
    tips = "Static tip deflection (t = 0) in the beam estimate: 143.2 mm; without play 9.916 mm."
    assert tips in lines
    # What 2.2 and 2.8 kN press contacts of 1e13 N/m² in is in it.
    tilt = "Play rotates 'inner' by 14.03 mrad in 'outer', which moves the tip by 133.3 mm."
    assert tilt in lines


def test_unequal_plays_are_not_pressed_in() -> None:
    """Reference: by hand, √(F/k) of 2.2 and 2.8 kN on 1e13 N/m², whatever the play above."""
    case = case_file.load(str(CASES / "coarse.toml"))
    (joint,) = case.joints
    joint = replace(joint, play_above=0.001)
    lines = told(case.model_copy(update={"joints": (joint,)}))
    rows = {tuple(line.split()[:2]): line.split()[2:] for line in lines}
    assert [float(value) for value in rows["inner", "9"]] == pytest.approx(
        [2.203, 0.0148], rel=2e-3
    )
    assert [float(value) for value in rows["inner", "10"]] == pytest.approx(
        [-2.7535, 0.0166], rel=2e-3
    )


def test_a_boom_without_play_has_no_tilt_and_its_stops_are_its_own() -> None:
    """Reference: by hand. The tip of 9.916 mm presses a stop of 10 N/m, 5 mm above, by 4.916 mm."""
    case = case_file.load(str(CASES / "coarse.toml"))
    bonded = tuple(model for model in case.models if model.bonded)
    stop = StopTable("inner", Distance(head=0.0), play=0.01, stiffness=10.0)
    lines = told(case.model_copy(update={"models": bonded, "stops": (stop,)}))
    assert not any("nan" in line or line.startswith("Play rotates") for line in lines)
    rows = {tuple(line.split()[:2]): line.split()[2:] for line in lines}
    force, *power, depth = rows["inner", "19"]
    assert power == ["×", "10⁻⁵"]
    assert (float(force), float(depth)) == pytest.approx((-4.916, 4.92), rel=2e-3)
    assert len(rows["inner", "9"]) == len(rows["inner", "10"]) == 1


STIFFENED = """
title = "An arm with a doubler and a lid"
time = { duration = 1.0 }
gravity = { acceleration = 10.0, angle = 45.0 }
material = { youngs_modulus = 2.1e11, poissons_ratio = 0.3, density = 8000.0 }
model = [{ name = "series", kind = "kantorovich", terms = [3], base = "complete" }]

[[segment]]
name = "arm"
length = 6.0
supports = [{ x = 0.0, kind = "clamped" }]
section = { height = 0.3, width = 0.2, flange = 0.006, web = 0.005 }
collars = [{ span = [{ head = 1.0 }, "head"], thickness = 0.02 }]
diaphragms = [{ x = "head", thickness = 0.05 }]
"""


def test_stiffeners_weigh_across_as_along(tmp_path: Path) -> None:
    """Reference: by hand, plates times density; under 45° as much across as along."""
    case = read_case(tmp_path, STIFFENED)
    plain = 2.0 * (0.2 * 0.006 + 0.3 * 0.005) * 6.0 * 8000.0
    collar, lid = 1.0 * 0.02 * 8000.0, 0.2 * 0.3 * 0.05 * 8000.0
    weight = (plain + collar + lid) * 10.0 * sqrt(0.5)
    moment = (plain * 3.0 + collar * 5.5 + lid * 6.0) * 10.0 * sqrt(0.5)
    lines = told(case)
    (row,) = (line.split() for line in lines if line.startswith("arm 0 "))
    assert [float(cell) for cell in row[2:]] == pytest.approx(
        [weight / 1e3, weight / 1e3, moment / 1e3], rel=1e-3
    )


def test_series_weigh_and_swing_with_stiffeners_as_elements_do(tmp_path: Path) -> None:
    """Reference: other code, elements, which have nodes where stiffeners are."""
    elements = (
        ', { name = "fe", kind = "finite-element", theory = "euler-bernoulli", '
        "rotary_inertia = false }]"
    )
    text = STIFFENED.replace("}]", "}" + elements, 1).replace("[3]", "[12]")
    case = read_case(tmp_path, text)
    boom = build_boom(case)
    series, beam = (build(case, boom, model).system.gather_loads() for model in case.models)
    tips = [
        float(system.observers["tip"].row @ system.static_response(system.load))
        for system in (series, beam)
    ]
    assert tips[0] == pytest.approx(tips[1], rel=1e-4)
    assert series.frequencies[:2] == pytest.approx(beam.frequencies[:2], rel=1e-3)


def test_a_boom_without_rest_says_so() -> None:
    """The square of its load is no number of any machine."""
    case = case_file.load(str(CASES / "coarse.toml"))
    segments = tuple(s.model_copy(update={"load": 1.0e300}) for s in case.segments)
    lines = told(case.model_copy(update={"segments": segments}))
    assert "No rest under the loads of t = 0 is found." in lines


def test_walls_under_pads_lower_the_tip_as_in_the_shell() -> None:
    """Reference: other code, the shell of the lift at rest, −229.12 mm (−190.18 mm of its beam)."""
    lines = told(case_file.load(str(CASES / "lift.toml")))
    (tip,) = (line for line in lines if line.startswith("Static tip deflection"))
    assert float(tip.split(": ")[1].split()[0]) == pytest.approx(-229.12, rel=0.01)


def test_remedies_for_walls_under_pads_count_under_the_largest_loads() -> None:
    """Reference: the same loads from t = 0 on, without the ramp."""
    case = case_file.load(str(CASES / "lift.toml"))
    share, remedies = pad_wall_sentences(case)
    assert share == (
        "Walls bend under pads, which moves the tip by -60.64 of -378.5 mm, 16 %, under the loads "
        "of t = 0.1 s (estimate from plates)."
    )
    assert remedies == (
        "Remedies, with the deflection of the tip under these loads: pads that bear on the corners "
        "(-317.9 mm); walls twice as thick by collars at the pads (-333 mm); pads half as wide, at "
        "twice the pressure (-347.8 mm)."
    )
    (load,) = case.loads
    sudden = case.model_copy(update={"loads": (load.model_copy(update={"ramp": None}),)})
    assert pad_wall_sentences(sudden) == [share.replace("0.1 s", "0 s"), remedies]


def pad_wall_sentences(case: Case) -> list[str]:
    """Return the sentences of ``check`` on walls under pads."""
    lines = check_case(CheckedCase(case)).lines
    found = [line for line in lines if line.startswith(("Walls bend", "Remedies"))]
    return [line.replace("−", "-") for line in found]
