# SPDX-License-Identifier: LGPL-3.0-or-later
"""The lower end of a luffing cylinder: it stays on the earth when the luffing angle changes."""

import tomllib
from collections.abc import Callable
from dataclasses import asdict
from math import cos, radians, sin
from pathlib import Path

import pytest

import protractile as pt
from protractile.geometry.cylinder import EarthPoint
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import combine
from protractile.runs.case.reading import convert_to_si
from protractile.runs.case.schema import Case
from protractile.runs.live.controls import Draft
from protractile.runs.sweep import points
from tests.runs.case_texts import read_case, refusal, table
from tests.runs.test_combinations import GROUND, LIFT

LEVEL = table("[[load_case]]", name="level", angle=10.0)
# The ground of the lift in earth axes: the pin is at x = 0, on the axis.
TURN = radians(45.0)
FRONT = GROUND[0] * cos(TURN) - GROUND[1] * sin(TURN)
BELOW = -GROUND[0] * sin(TURN) - GROUND[1] * cos(TURN)
EARTH = LIFT.replace(f"ground = {list(GROUND)}", f"ground = {{ front = {FRONT}, below = {BELOW} }}")


def by_load_case(case: Case, _: Path) -> Case:
    return combine(case, case.load_cases[0])


def by_change(case: Case, _: Path) -> Case:
    return pt.change(case, **{"gravity.angle": 10.0})


def by_sweep(case: Case, path: Path) -> Case:
    vary = ["gravity.angle=10,20", "cylinder.stiffness=3e7,4e7"]
    return points.plan(str(path / "case.toml"), vary, None, None).points[0].case


def by_slider(case: Case, path: Path) -> Case:
    return Draft.load(str(path / "case.toml")).changed({"gravity.angle": 10.0})


@pytest.mark.parametrize("text", [LIFT, EARTH])
@pytest.mark.parametrize("way", [by_load_case, by_change, by_sweep, by_slider])
def test_the_ground_stays_at_another_angle(
    tmp_path: Path, way: Callable[[Case, Path], Case], text: str
) -> None:
    """Reference: analytic, the coordinates of a fixed point in turned axes; before, only load cases
    kept the point, and other changes turned it with the boom."""
    case = read_case(tmp_path, text + LEVEL)
    (before,) = build_boom(case).cylinders
    assert before.ground == pytest.approx(GROUND)
    (after,) = build_boom(way(case, tmp_path)).cylinders
    turn = radians(10.0)
    right = FRONT * cos(turn) - BELOW * sin(turn), -FRONT * sin(turn) - BELOW * cos(turn)
    assert after.ground == pytest.approx(right, rel=1e-12)


def test_the_force_follows_the_angle(tmp_path: Path) -> None:
    """Reference: another path, a case of its own at 10 degrees with the ground in its axes."""
    turn = radians(10.0)
    there = [FRONT * cos(turn) - BELOW * sin(turn), -FRONT * sin(turn) - BELOW * cos(turn)]
    own = LIFT.replace("angle = 45.0", "angle = 10.0").replace(f"{list(GROUND)}", f"{there}")

    def force(case: Case) -> float:
        frame = next(one for name, one in pt.check(case).frames.items() if "Cylinder" in name)
        return float(frame.iloc[0, -1])

    right = force(read_case(tmp_path, own))
    assert force(by_change(read_case(tmp_path, LIFT), tmp_path)) == pytest.approx(right, rel=1e-9)


def test_earth_axes_in_other_units_and_in_the_saved_case(tmp_path: Path) -> None:
    """Reference: analytic, thousandths, and the case that its own text gives."""
    case = read_case(tmp_path, EARTH)
    assert read_case(tmp_path, toml.dumps(case)) == case
    text = EARTH.replace("title", 'units = "mm-t-s"\ntitle', 1)
    text = text.replace(f"front = {FRONT}", f"front = {1e3 * FRONT}")
    text = text.replace(f"below = {BELOW}", f"below = {1e3 * BELOW}")
    (cylinder,) = convert_to_si(Case.model_validate(tomllib.loads(text))).cylinders
    assert isinstance(cylinder.ground, EarthPoint)
    assert asdict(cylinder.ground) == pytest.approx({"front": FRONT, "below": BELOW})


@pytest.mark.parametrize(
    ("ground", "message"),
    [
        ("{ front = 1.2 }", "{'front': 1.2}"),
        ("[1.2]", "[1.2]"),
        ("1.2", "1.2"),
        ("[1.2, nan]", "[1.2, nan]"),
    ],
)
def test_a_ground_that_is_no_point(tmp_path: Path, ground: str, message: str) -> None:
    what = "a list of two numbers, or a table of two such as { front = 0.7, below = 1.1 }"
    text = LIFT.replace(f"ground = {list(GROUND)}", f"ground = {ground}")
    assert refusal(tmp_path, text) == f"cylinder[1].ground: must be {what}, got {message}"


def test_earth_axes_need_a_foot_and_a_luffing_angle(tmp_path: Path) -> None:
    text = EARTH.replace('supports = [{ x = 0.0, kind = "hinged" }]', "")
    assert refusal(tmp_path, text) == (
        "cylinder[1].ground: no segment has a support, from whose pin front and below are "
        "measured; give one"
    )
    boom = build_boom(read_case(tmp_path, EARTH))
    jack = pt.Cylinder(0, x=2.4, ground=EarthPoint(1.0, 1.0), stiffness=1e7)  # type: ignore[arg-type]
    with pytest.raises(pt.BoomError) as error:
        pt.Boom(boom.segments, boom.joints, cylinders=(jack,))
    assert str(error.value) == (
        "cylinders[0].ground: a boom has no earth axes; give x and z in m of its own axes"
    )
