# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of a drawing: wind, rope, head, outer sizes, and cylinders with their lower ends."""

import tomllib
from collections.abc import Callable
from dataclasses import asdict
from math import cos, pi, radians, sin
from pathlib import Path

import pytest

import protractile as pt
from protractile.analysis.rows import Rows
from protractile.cases import run_case
from protractile.geometry.boom import Boom
from protractile.geometry.cylinder import EarthPoint
from protractile.geometry.load import Moment
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.section import SectionError
from protractile.geometry.typography import amount
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import combine, combined_cases
from protractile.runs.case.reading import convert_to_si
from protractile.runs.case.schema import Case
from protractile.runs.case.sections import UTable
from protractile.runs.live.controls import Draft
from protractile.runs.pipeline.combinations import combination_rows
from protractile.runs.pipeline.statics import boom_with_play, cylinder_force, state_at_rest
from protractile.runs.sweep import points
from tests.runs.case_texts import (
    HINGED,
    REST,
    STEEL,
    box,
    elements,
    joint,
    read_case,
    refusal,
    table,
)
from tests.runs.summaries import printed_check
from tests.runs.test_combinations import GROUND, LIFT

G = 9.80665
CYLINDER = {"segment": "base", "x": 2.4, "depth": 0.25, "ground": [0.7, -1.1]}


def drawn_out(inner: str, outer: str) -> str:
    """Return a joint with an extension of 4 m."""
    text = joint(inner, outer, 0.003, (5.0, 6.0), "extension = 4.0")
    return text.replace("[5.0, 6.0]", '["tail", "head"]')


DRAWN = f"""
title = "A boom of two boxes"
time = {{ duration = 1.0 }}
gravity = {{ angle = 50.0 }}
payload = {{ mass = 150.0, group = "dead" }}
{REST}
{STEEL}
{box("base", 6.0, (0.30, 0.22, 0.006, 0.006), HINGED)}
{box("fly", 5.0, (0.25, 0.18, 0.006, 0.006))}
{drawn_out("fly", "base")}
{elements("beam", theory="timoshenko")}
"""
JACK = table("[[cylinder]]", **CYLINDER, stiffness=3e7)
LIMITED = table("[[cylinder]]", **CYLINDER, stiffness=3e7, open=2.0)
PEOPLE = table("[[load_case]]", name="people", payload=230.0)
FACTORS = table("[[combination]]", name="A", factors={"dead": 1.2, "payload": 1.34, "wind": 1.16})


def rows_of(folder: Path, text: str) -> Rows:
    return combination_rows(read_case(folder, DRAWN + JACK + text))


def same(own: Rows, other: Rows) -> None:
    """Assert that states have equal tips, stresses and cylinder forces."""
    for quantity in ("tip", "stress", "cylinder_force", "foot_reaction"):
        values, expected = (
            [row.value for row in rows.where(quantity=quantity)] for rows in (own, other)
        )
        assert values
        assert values == pytest.approx(expected, rel=1e-9)


def test_wind_is_the_line_load_of_each_exposed_part(tmp_path: Path) -> None:
    """Reference: other input, loads by hand of a wind from behind on box, fly and load."""
    wind = table("[wind]", speed=20.0, shape_factor=[1.4, 1.6], load_area=0.8)
    across, along = sin(radians(50.0)), cos(radians(50.0))
    base, fly = (250.0 * c * b * across**2 for c, b in ((1.4, 0.226), (1.6, 0.186)))
    by_hand = "".join(
        table("[[load]]", **keys, group="wind")
        for keys in (
            {"segment": "base", "magnitude": -base},
            {"segment": "fly", "magnitude": -fly, "from": 6.0},
            {"segment": "fly", "magnitude": -200.0 * across, "x": "head"},
        )
    ) + table("[[axial]]", force=-200.0 * along, group="wind")
    own = rows_of(tmp_path, wind + PEOPLE + FACTORS)
    same(own, rows_of(tmp_path, by_hand + PEOPLE + FACTORS))
    still = PEOPLE.replace("payload", "wind = 0.0\npayload")
    calm = rows_of(tmp_path, wind + still + FACTORS)
    assert calm.where(quantity="tip")[0].value > own.where(quantity="tip")[0].value
    same(calm, rows_of(tmp_path, PEOPLE + FACTORS))


def test_masses_on_the_hook_pull_the_rope_with_their_own_factors(tmp_path: Path) -> None:
    """Reference: analytic, weights times the factors of their groups over the falls."""
    case = read_case(
        tmp_path, DRAWN + JACK + table("[rope]", falls=4, winch=1.5) + PEOPLE + FACTORS
    )
    (combined,) = combined_cases(case)
    (lead,) = build_boom(combined.case).leads
    assert lead.force == pytest.approx(G * (1.2 * 150.0 + 1.34 * 230.0) / 4.0, rel=1e-12)
    assert (lead.x, lead.winch) == (10.0, -1.5)


def moments(boom: Boom) -> list[float]:
    return [load.magnitude for load in boom.loads if isinstance(load, Moment)]


def test_a_head_gives_the_moments_of_load_and_own_mass(tmp_path: Path) -> None:
    """Reference: analytic; in combinations, the same moments by [[load]]."""
    head = table("[head]", ahead=0.8, below=0.5, mass=60.0)
    lever = 0.8 * cos(radians(50.0)) + 0.5 * sin(radians(50.0))
    boom = build_boom(read_case(tmp_path, DRAWN + JACK + head))
    assert moments(boom) == pytest.approx([-150.0 * G * lever, -30.0 * G * lever], rel=1e-12)
    assert boom.segments[-1].masses[-1].mass == 60.0
    at_tip = {"segment": "fly", "x": "head", "moment": True}
    by_hand = "".join(
        table("[[load]]", **at_tip, magnitude=-mass * G * lever, group=group)
        for mass, group in ((180.0, "dead"), (230.0, "payload"))
    )
    heavier = '\nmasses = [{ x = "head", mass = 60.0 }]\n'
    text = DRAWN.replace("[[joint]]", heavier + "[[joint]]", 1)
    other = combination_rows(read_case(tmp_path, text + JACK + by_hand + PEOPLE + FACTORS))
    same(rows_of(tmp_path, head + PEOPLE + FACTORS), other)


@pytest.mark.slow
def test_shells_take_wind_rope_and_head_as_beams_do(tmp_path: Path) -> None:
    """Reference: other model, shear-flexible beams; each of the loads counts for far more."""
    loads = (
        table("[rope]", falls=1)
        + table("[wind]", pressure=1200.0, shape_factor=1.4)
        + table("[head]", ahead=1.2, below=0.9)
    )
    models = elements("beam-2", theory="timoshenko") + table(
        "[[model]]", name="shell", kind="shell", mesh_size=0.1
    )
    text = (DRAWN + JACK).replace("mass = 150.0", "mass = 900.0")
    text = text.replace("duration = 1.0", "duration = 0.05")
    tips: dict[str, dict[str, float]] = {}
    for name, more in (("bare", ""), ("loaded", loads)):
        results = run_case(read_case(tmp_path, text + more + models))
        tips[name] = {
            model: float(results.trajectories["tip"].values[k, 0])
            for k, model in enumerate(results.trajectories["model"].values.tolist())
        }
    for name in tips:
        assert tips[name]["shell"] == pytest.approx(tips[name]["beam"], rel=0.04)
    assert tips["loaded"]["beam"] < 1.2 * tips["bare"]["beam"]


@pytest.mark.parametrize(
    ("order", "fly_out", "tip_out"),
    [("in proportion", 2.1, 2.1), ("from the base", 4.0, 0.2), ("from the tip", 0.2, 4.0)],
)
def test_telescoping_by_a_fraction_of_the_stroke(
    tmp_path: Path, order: str, fly_out: float, tip_out: float
) -> None:
    """Reference: analytic, half of the strokes of 3.8 m between 0.2 and 4 m, in each order."""
    text = DRAWN + JACK + box("tip", 5.0, (0.20, 0.14, 0.006, 0.006)) + drawn_out("tip", "fly")
    text += table("[telescoping]", extension=0.5, order=order, retracted=0.2)
    _, fly, tip = build_boom(read_case(tmp_path, text)).segments
    assert (fly.end, tip.end) == pytest.approx((6.0 + fly_out, 6.0 + fly_out + tip_out), rel=1e-12)
    text += table("[[load_case]]", name="out", telescoped=1.0)
    text += table("[[load_case]]", name="in", telescoped=0.0)
    out, retracted = combined_cases(read_case(tmp_path, text))
    assert build_boom(out.case).tip == pytest.approx(14.0)
    assert build_boom(retracted.case).tip == pytest.approx(6.4)


def test_a_section_by_outer_sizes_is_that_of_its_mid_lines(tmp_path: Path) -> None:
    """Reference: other input, the mid-lines of the same box."""
    sizes = "height = 0.3, width = 0.22, "
    outside = DRAWN.replace(sizes, "outside = true, height = 0.306, width = 0.226, ")
    assert outside != DRAWN
    own, other = (build_boom(read_case(tmp_path, text + JACK)) for text in (DRAWN, outside))
    moments_of_area = [boom.segments[0].second_moment_of_area for boom in (own, other)]
    assert moments_of_area[0] == pytest.approx(moments_of_area[1], rel=1e-14)


def test_bends_of_a_drawing_have_the_radius_of_the_tool() -> None:
    """Reference: by hand, the mid-line is half a thickness from each surface."""
    sizes = {"height": 0.64, "width": 0.47, "top": 0.006, "bottom": 0.008, "web": 0.006}
    keys = {"shape": "U", "radius": 0.16, "facets": 2, "bend_radius": 0.024}
    for outside, (top, below) in ((True, (0.027, 0.156)), (False, (0.024, 0.16))):
        made = UTable.model_validate(sizes | keys | {"outside": outside}).section()
        assert isinstance(made, PolygonSection)
        # The last corner of each lower bend is the weld to the web.
        assert made.radii == pytest.approx((below,) * 3 + (0.0, top, top, 0.0, below))
    large = UTable.model_validate(sizes | keys | {"bend_radius": 0.3})
    with pytest.raises(SectionError, match=r"^bends take 0\.6 m of a plate of 0\.47 m;"):
        large.section()


def test_check_prints_the_height_of_the_axis(tmp_path: Path) -> None:
    """Reference: by hand, first moments of four plates with mitred corners."""
    outer = 'shape = "unequal box", height = 0.3, width = 0.22, top = 0.006, bottom = 0.014'
    text = DRAWN.replace("height = 0.3, width = 0.22, flange = 0.006", outer)
    assert text != DRAWN
    width, web, high = 0.22, 0.006, 0.31
    inner = (width - web) * (0.3 - 0.01), 0.014 + 0.145
    area, middle = (width + web) * high, 0.5 * high
    height = (area * middle - inner[0] * inner[1]) / (area - inner[0])
    line = "Height of the axis, through the centroid, above the outer surface of the bottom: base "
    assert f"{line}{height:.4g} m." in printed_check(read_case(tmp_path, text + JACK), 120)


def test_cylinder_by_its_drawing(tmp_path: Path) -> None:
    """Reference: exact words; the pressure of the printed force on the bore."""
    data = {"bore": 0.14, "rod": 0.1, "closed": 1.5, "open": 2.4, "pressure": 2.5e7}
    text = DRAWN + table("[[cylinder]]", **CYLINDER, **data)
    shown = printed_check(read_case(tmp_path, text), 120)
    assert "Cylinder 1 is extended by 0.4007 m of its stroke of 0.9 m." in shown
    case = read_case(tmp_path, text)
    force = cylinder_force(state_at_rest(case, boom_with_play(case, build_boom(case))), 1)
    pressure = amount(force / (0.25 * pi * 0.14**2), "Pa")
    assert f"Oil pressure of cylinder 1: {pressure}." in shown
    raised = text + table("[luff]", travel=35.0, time=20.0)
    message = "cylinder[1].open: 2.4 m, and from ground to lug it is "
    assert refusal(tmp_path, raised).startswith(message)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (table("[wind]", pressure=100.0, shape_factor=1.2, direction="side"),
         "wind.direction: the boom is flat, and nothing moves along 'y'; give the joints "
         "lateral_play"),
        (table("[wind]", pressure=100.0, shape_factor=[1.2, 1.3, 1.4]),
         "wind.shape_factor: must be one number, or one for each of 2 segments, got 3"),
        (table("[wind]", pressure=100.0, speed=10.0, shape_factor=1.2),
         "wind.speed: pressure is given; leave one of them out"),
        (table("[wind]", pressure=1.0, shape_factor=1.2, direction="left"),
         "wind.direction: must be 'behind', 'side' or 'front', or an angle in degrees, got 'left'"),
        (table("[[load_case]]", name="up", angle=88.0) + LIMITED,
         "load_case[1].cylinder[2].open: 2 m, and from ground to lug it is 2.734 m: the cylinder "
         "does not reach; change it, the ground or the luffing angle"),
        (table("[wind]", shape_factor=1.2),
         "wind.pressure: missing; it is the dynamic pressure in Pa; a factor, 1 unless given, if "
         "the heading of its file has such a unit"),
        (table("[wind]", pressure=100.0, shape_factor=1.2) + table("[luff]", travel=5.0, time=9.0),
         "wind: the wind acts on the boom as it stands at t = 0; leave wind or luff out"),
        (table("[head]", beside=0.2),
         "head.beside: the boom is flat, and nothing moves along 'y'; give the joints "
         "lateral_play"),
        (table("[head]", ahead=0.2) + table("[hoist]", mass=200.0, stiffness=1e6, hanging=True),
         "head: the load of hoist hangs at the end of the boom; leave ahead, below and beside "
         "out"),
        (table("[rope]", falls=2)
         + table("[hoist]", mass=200.0, stiffness=1e6, falls=2, hanging=True),
         "rope.falls: hoist.falls is given; leave one of them out"),
    ],
)  # fmt: skip
def test_contradictions_are_refused(tmp_path: Path, text: str, line: str) -> None:
    assert refusal(tmp_path, DRAWN + JACK + text) == line


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
