# SPDX-License-Identifier: LGPL-3.0-or-later
"""Places of a drawing: heights of pins, level cages, winches and forces of hands in earth axes."""

import re
from collections.abc import Callable
from dataclasses import asdict
from math import cos, hypot, radians, sin
from pathlib import Path

import pytest

import protractile as pt
from protractile.geometry.cylinder import EarthPoint
from protractile.geometry.load import Load, Moment, Torque
from protractile.geometry.place import Level
from protractile.runs.case import toml
from protractile.runs.case.amounts import convert_to_si
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import combine
from protractile.runs.case.schema import Case
from protractile.runs.live.controls import Draft
from protractile.runs.pipeline.combinations import combination_rows, combination_states
from protractile.runs.pipeline.proofs import proofs_of
from protractile.runs.sweep import points
from tests.runs.case_texts import as_toml, read_case, refusal, table
from tests.runs.test_combinations import GROUND, LIFT
from tests.runs.test_drawing_keys import AXIS, DRAWN, FACTORS, JACK, PEOPLE, UNEQUAL, G, same

ACROSS, ALONG = sin(radians(50.0)), cos(radians(50.0))
HEAD = table("[head]", ahead=0.8, below=0.5)
AT_TIP = {"segment": "fly", "x": "head", "group": "payload"}
HAND = table("[[load]]", magnitude=400.0, direction="behind", group="payload")
HAND_BY_HAND = (
    table("[[load]]", **AT_TIP, magnitude=-400.0 * ACROSS)
    + table("[[axial]]", force=-400.0 * ALONG, group="payload")
    + table("[[load]]", **AT_TIP, moment=True, magnitude=400.0 * (0.5 * ALONG - 0.8 * ACROSS))
)


def foot(depth: object) -> str:
    """Return the boom with the pin of its foot at a depth."""
    return UNEQUAL.replace('kind = "hinged"', f'kind = "hinged", depth = {as_toml(depth)}')


def at_angle(angle: float) -> str:
    """Return a head by hand, 0.2 m along and 0.1 m below, with a cage at (0.8, 0.5) m in front."""
    up, along = sin(radians(angle)), cos(radians(angle))
    ahead, below = 0.8 * along - 0.5 * up, 0.8 * up + 0.5 * along
    return table("[head]", ahead=0.2 + ahead, below=0.1 + below, mass=60.0)


WIND = {"speed": 20.0, "shape_factor": 1.4}
RAM = table(
    "[[pinned_mass]]", mass=90.0, centre=1.5,
    pins=[{"segment": "base", "x": 1.0}, {"segment": "fly", "x": {"tail": 0.5}}],
)  # fmt: skip
CAGE = table("[head]", ahead=0.2, below=0.1, mass=60.0, level={"front": 0.8, "below": 0.5})
LOW = table("[[load_case]]", name="low", angle=10.0, payload=230.0)
OUT, IN = "extension = 4.0", table("[telescoping]", retracted=0.2)
# Mass per length of the plates of the fly, by its outer and inner rectangles.
PLATES = 7850.0 * (0.256 * 0.186 - 0.244 * 0.174)
LEADS = {"front": -1.5 * ALONG, "below": 1.5 * ACROSS}


@pytest.mark.parametrize(
    ("drawn", "by_hand"),
    [
        (foot({"bottom": 0.1}) + JACK + LOW, foot(AXIS - 0.1) + JACK + LOW),
        (foot({"top": 0.08}) + JACK, foot(0.08 - (0.31 - AXIS)) + JACK),
        (UNEQUAL + JACK.replace("0.25", "{ bottom = -0.12 }"),
         UNEQUAL + JACK.replace("0.25", f"{AXIS + 0.12}")),
        (DRAWN + JACK + table("[head]", ahead=0.2, below={"bottom": 0.03}),
         DRAWN + JACK + table("[head]", ahead=0.2, below=0.128 - 0.03)),
        (DRAWN + JACK + table("[wind]", **WIND, load_area=0.8, load_shape_factor=1.2),
         DRAWN + JACK + table("[wind]", **WIND, load_area=0.96)),
        (DRAWN + JACK + HEAD + HAND, DRAWN + JACK + HEAD + HAND_BY_HAND),
        (DRAWN + JACK + HEAD + table("[[load]]", magnitude=-90.0, direction="z", group="payload"),
         DRAWN + JACK + HEAD + table("[[load]]", **AT_TIP, magnitude=-90.0)
         + table("[[load]]", **AT_TIP, moment=True, magnitude=-72.0)),
        (DRAWN + JACK + RAM,
         DRAWN.replace('name = "base"', 'name = "base"\nmasses = [{ x = 1.0, mass = 60.0 }]')
         .replace('name = "fly"', 'name = "fly"\nmasses = [{ x = 5.5, mass = 30.0 }]') + JACK),
        (DRAWN + JACK + CAGE, DRAWN + JACK + at_angle(50.0)),
        (DRAWN + JACK + CAGE + LOW, DRAWN + JACK + at_angle(10.0) + LOW),
        (DRAWN + JACK + table("[rope]", falls=2, ground=LEADS),
         DRAWN + JACK + table("[rope]", falls=2, winch=1.5)),
        (DRAWN + JACK + HEAD + table("[rope]", falls=2),
         DRAWN + JACK + HEAD + table("[rope]", falls=2, sheave={"ahead": 0.8, "below": 0.5})),
        (DRAWN.replace(OUT, "stroke = 3.8\nretracted = 0.2") + JACK, DRAWN + JACK),
        (DRAWN.replace(OUT, "stroke = 3.8") + JACK + IN, DRAWN + JACK),
        (DRAWN.replace("length = 5.0", "length = 6.3").replace(OUT, "stroke = 3.7") + JACK,
         DRAWN.replace("length = 5.0", "length = 6.3") + JACK),
        (DRAWN.replace('name = "fly"', 'name = "fly"\nadded_mass_per_length = 11.0') + JACK,
         DRAWN.replace('name = "fly"', f'name = "fly"\nmass_per_length = {PLATES + 11.0}') + JACK),
    ],
)  # fmt: skip
def test_a_drawing_says_what_was_computed_by_hand(tmp_path: Path, drawn: str, by_hand: str) -> None:
    """Reference: other input, the same boom with the numbers that were computed by hand."""
    more = ("" if LOW in drawn else PEOPLE) + FACTORS
    case = read_case(tmp_path, drawn + more)
    assert read_case(tmp_path, toml.dumps(case)) == case
    same(combination_rows(case), combination_rows(read_case(tmp_path, by_hand + more)))


@pytest.mark.parametrize(
    ("extension", "shares"),
    [(4.0, (60.0, 30.0)), (2.5, (45.0, 45.0)), (1.0, (0.0, 90.0)), (3.0, None)],
)
def test_a_mass_between_two_pins_follows_the_extension(
    tmp_path: Path, extension: float, shares: tuple[float, float] | None
) -> None:
    """Reference: analytic, the lever rule: its centre is 1.5 m from the first of two pins that are
    0.5 m further apart than the extension; half and half without its centre."""
    ram = RAM if shares else RAM.replace("centre = 1.5\n", "")
    out = table("[[load_case]]", name="out", extension={"fly": extension})
    case = read_case(tmp_path, DRAWN + JACK + ram + out)
    assert read_case(tmp_path, toml.dumps(case)) == case
    boom = build_boom(combine(case, case.load_cases[0]))
    found = [(one.x, one.mass) for segment in boom.segments for one in segment.masses]
    by_hand = zip((1.0, 1.5 + extension), shares or (45.0, 45.0), strict=True)
    places = [pair for pair in by_hand if pair[1]]
    assert [pair for pair in found if pair[1] != 150.0] == [
        pytest.approx(pair, rel=1e-12) for pair in places
    ]


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("1.5", "4.6", "centre: must not be above 4.5 m, the distance of the pins, got 4.6 m"),
        ('"fly"', '"tip"', "pins[2].segment: 'tip' is no segment; give 'base' or 'fly'"),
        ("x = 1.0", "x = 7.0",
         "pins[1].x: 7 m lies outside 'base'; it must be between 0 and 6 m"),
        (', { segment = "fly", x = { tail = 0.5 } }', "",
         "pins: must be a list of two pins, got [{'segment': 'base', 'x': 1.0}]"),
    ],
)  # fmt: skip
def test_a_mass_that_two_pins_do_not_carry(tmp_path: Path, old: str, new: str, line: str) -> None:
    assert old in RAM
    text = DRAWN + JACK + RAM.replace(old, new)
    assert refusal(tmp_path, text) == f"pinned_mass[1].{line}"


GUST = {
    "pressure": 125.0,
    "shape_factor": [1.4, 1.6],
    "load_area": 0.8,
    "table": [[0.0, 1.0], [1.0, 1.5]],
}


@pytest.mark.parametrize(
    ("storm", "whole"),
    [
        ({"pressure": 800.0}, {"pressure": 800.0, "direction": "behind"}),
        (800.0, {"pressure": 800.0}),
        ({"speed": 30.0, "direction": "front"}, {"speed": 30.0, "direction": "front"}),
        ({"direction": "front"}, {**GUST, "direction": "front"}),
        ({"ramp": 0.5}, {"pressure": 125.0, "ramp": 0.5}),
        ({"file": "gust.csv"}, {"pressure": 125.0, "table": [[0.0, 1.0], [1.0, 2.0]]}),
        ({"speed": 20.0, "file": "gust.csv"}, {"speed": 20.0, "table": [[0.0, 1.0], [1.0, 2.0]]}),
    ],
)
def test_the_wind_of_a_load_case_says_what_differs(
    tmp_path: Path, storm: object, whole: dict[str, object]
) -> None:
    """Reference: other input, the load case with all keys of its wind; a pressure or a speed comes
    without the gust, a direction with it."""
    (tmp_path / "gust.csv").write_text("0,1\n1,2\n", encoding="utf-8")
    shared = {key: GUST[key] for key in ("shape_factor", "load_area")}
    whole = shared | whole
    text, cases = DRAWN + JACK + table("[wind]", **GUST) + FACTORS, []
    for wind in (storm, whole):
        case = read_case(tmp_path, text + table("[[load_case]]", name="out", wind=wind))
        saved = read_case(tmp_path, toml.dumps(case))
        assert toml.dumps(saved) == toml.dumps(case)
        cases.append(combine(saved, saved.load_cases[0]))
    own, other = (case.wind for case in cases)
    assert own == other
    assert build_boom(cases[0]).loads == build_boom(cases[1]).loads
    stronger = pt.change(case, **{"wind.load_area": 1.6, "load_case[1].wind": storm})
    changed = combine(stronger, stronger.load_cases[0]).wind
    assert changed is not None
    assert changed.load_area == 1.6


@pytest.mark.parametrize(
    ("rope", "load", "factor", "blown"),
    [
        ("", {"payload": 230.0}, 1.0, True),
        ("", {"payload": 0.0}, 1.0, True),  # on the cage
        ("[rope]\nfalls = 2\n", {"payload": 230.0}, 1.0, True),
        ("[rope]\nfalls = 2\n", {"payload": 0.0}, 1.0, False),  # the hook alone
        ("[rope]\nfalls = 2\n", {"payload": 230.0}, 0.0, False),
    ],
)
def test_wind_on_the_load_needs_a_load(
    tmp_path: Path, rope: str, load: dict[str, float], factor: float, blown: bool
) -> None:
    """Reference: other input, the wind without the area of the load."""
    chassis = {"mass": 6e3, "centre": 0.0, "front": 1.5, "rear": 1.5, "side": 1.5}
    factors = {"dead": 1.0, "payload": factor, "wind": 1.2}
    more = JACK + rope + table("[chassis]", **chassis)
    more += table("[[load_case]]", name="storm", **load)
    more += table("[[combination]]", name="C", factors=factors, proofs=["tipping"])
    cases = [
        read_case(tmp_path, DRAWN + table("[wind]", **WIND, load_area=area) + more)
        for area in (3.0, 0.0)
    ]
    # Of the case itself there is only the cage, or the hook on the rope.
    own, calm = (build_boom(case).loads for case in cases)
    assert (own == calm) == bool(rope)
    states = [combination_states(case)[0] for case in cases]
    tips = [state.rows.where(quantity="tip")[0].value for state in states]
    moments = [next(proofs_of(state, state.combined.of)).value for state in states]
    if blown:
        assert tips[0] < tips[1] - 1e-3
        assert moments[0] > 1.01 * moments[1]
    else:
        assert (tips[0], moments[0]) == (tips[1], moments[1])


def test_a_hand_force_tips_at_the_height_of_the_head(tmp_path: Path) -> None:
    """Reference: analytic, force times height above the ground, but for the deflection of 2 ‰; the
    moment about the end of the boom is 3 % of it.
    """
    lines = {"front": 1.5, "rear": 1.5, "side": 1.5}
    chassis = table("[chassis]", mass=6e3, centre=0.0, foot_ahead=0.5, foot_above=1.0, **lines)
    factors = table("[[combination]]", name="A", factors={"dead": 1.0, "payload": 1.0})
    moments = []
    for load in ("", HAND):
        case = read_case(tmp_path, DRAWN + JACK + HEAD + chassis + load + factors)
        (state,) = combination_states(case)
        moments.append(next(iter(proofs_of(state, case, ["tipping"]))).value)
    height = 1.0 + 10.8 * ACROSS - 0.5 * ALONG
    assert moments[1] - moments[0] == pytest.approx(400.0 * height, rel=4e-3)


def test_a_hand_force_in_space_bends_and_twists(tmp_path: Path) -> None:
    """Reference: analytic, moment and torque of a force towards +y about the end of the boom."""
    text = DRAWN.replace("play = 0.003", "play = 0.003\nlateral_play = 0.003") + JACK + HEAD
    force = table("[[load]]", magnitude=400.0, direction="side", ramp=0.5)
    loads = build_boom(read_case(tmp_path, text + force)).loads[:3]
    assert [load.magnitude for load in loads] == pytest.approx([400.0, 320.0, 200.0], rel=1e-12)
    assert [type(load) for load in loads] == [Load, Moment, Torque]


def test_depths_need_a_section_in_the_units_of_the_case(tmp_path: Path) -> None:
    """Reference: by hand; exact words."""
    bare = "mass_per_length = 60.0\nsecond_moment_of_area = 1e-4"
    text = re.sub("section = .*", bare, DRAWN).replace('theory = "timoshenko"', "")
    message = "cylinder[1].depth: the segment has no section to measure it from; give it, or a"
    low = JACK.replace("0.25", "{ bottom = -0.12 }")
    assert refusal(tmp_path, text + low) == f"{message} depth in m"
    in_mm = read_case(tmp_path, DRAWN + low).model_copy(update={"units": "mm-t-s"})
    assert convert_to_si(in_mm).cylinders[0].depth == Level(bottom=-0.12e-3)


@pytest.mark.parametrize(("ahead", "above"), [(0.0, 0.0), (0.3, 0.4)])
@pytest.mark.parametrize(("angle", "mass"), [(50.0, 150.0), (10.0, 380.0)])
def test_the_lead_to_a_winch_that_does_not_luff(
    tmp_path: Path, angle: float, mass: float, ahead: float, above: float
) -> None:
    """Reference: analytic, the force from the sheave towards a fixed point at each angle, and its
    change with the deflection of the head by central differences."""
    sheave = {"ahead": ahead, "below": -above}
    rope = table("[rope]", falls=2, ground={"front": -1.2, "below": 0.3}, sheave=sheave)
    case = read_case(tmp_path, DRAWN + JACK + rope + LOW)
    assert read_case(tmp_path, toml.dumps(case)) == case
    up, along = sin(radians(angle)), cos(radians(angle))
    behind, high = 10.0 + ahead + 1.2 * along + 0.3 * up, 1.2 * up - 0.3 * along - above
    step = 1e-4

    def pull(y: float, z: float) -> list[float]:
        line = -behind, -y, high - z
        return [0.5 * mass * G * part / hypot(*line) for part in line]

    boom = build_boom(case if angle == 50.0 else combine(case, case.load_cases[0]))
    (lead,), force = boom.leads, pull(0.0, 0.0)
    assert lead.components == pytest.approx((force[0], force[2]), rel=1e-12)
    assert boom.loads[0].magnitude == pytest.approx(force[2], rel=1e-12)
    weight = mass * G * up
    assert boom.segments[-1].compression.ends[-1][1] == pytest.approx(weight - force[0], rel=1e-12)
    slope = (pull(0.0, -step)[2] - pull(0.0, step)[2]) / (2.0 * step)
    assert lead.stiffness("z") == pytest.approx(slope, rel=1e-8)
    assert lead.stiffness("y") == pytest.approx(-pull(step, 0.0)[1] / step, rel=1e-8)


WINCHES = {
    "on the boom": ({"winch": 1.5}, (-1.5, 0.0)),
    "on the ground": (
        {"ground": {"front": -1.2, "below": 0.3}},
        (-1.2 * ALONG - 0.3 * ACROSS, 1.2 * ACROSS - 0.3 * ALONG),
    ),
}


@pytest.mark.parametrize("head", ["", HEAD, table("[head]", mass=60.0)], ids=["", "fork", "mass"])
@pytest.mark.parametrize("place", [{}, {"below": -0.4}, {"ahead": 0.3, "below": {"top": -0.272}}])
@pytest.mark.parametrize("winch", WINCHES)
def test_rope_forces_turn_the_boom_about_its_foot(
    tmp_path: Path, winch: str, place: dict[str, object], head: str
) -> None:
    """Reference: analytic, moments about the foot of the lead at the sheave, 0.4 m above the axis
    or at the head, and of the weight of the payload, which hangs there unless the head has a place
    of its own. The head's own weight acts halfway."""
    keys, (x, z) = WINCHES[winch]
    texts = "", table("[rope]", falls=2, **keys, **{"sheave": place} if place else {})

    def moment(text: str) -> float:
        loads = build_boom(read_case(tmp_path, DRAWN + JACK + head + text)).loads
        return sum(
            load.magnitude if isinstance(load, Moment) else load.magnitude * load.x
            for load in loads
            if load.x is not None
        )

    sheave = 10.0 + float("ahead" in place) * 0.3, 0.4
    if not place:
        sheave = (10.8, -0.5) if head == HEAD else (10.0, 0.0)
    weight, line = 150.0 * G, (x - sheave[0], z - sheave[1])
    along, up = (0.5 * weight * part / hypot(*line) for part in line)
    expected = sheave[0] * up - sheave[1] * along
    if head != HEAD:
        weight += 0.5 * 60.0 * G * bool(head)
        # The boom is at 50 degrees: the weight has the parts g sin 50° along and g cos 50° across.
        expected += weight * (sheave[1] * ACROSS - (sheave[0] - 10.0) * ALONG)
    assert moment(texts[1]) - moment(texts[0]) == pytest.approx(expected, rel=1e-9)


LEVEL = table("[[load_case]]", name="level", angle=10.0)
# The ground of the lift in earth axes: the pin is at x = 0, on the axis.
TURN = radians(45.0)
FRONT = GROUND[0] * cos(TURN) - GROUND[1] * sin(TURN)
BELOW = -GROUND[0] * sin(TURN) - GROUND[1] * cos(TURN)
EARTH = LIFT.replace(f"ground = {list(GROUND)}", f"ground = {{ front = {FRONT}, below = {BELOW} }}")


WAYS: dict[str, Callable[[Case, str], Case]] = {
    "load case": lambda case, _: combine(case, case.load_cases[0]),
    "change": lambda case, _: pt.change(case, **{"gravity.angle": 10.0}),
    "sweep": lambda _, path: points.plan(path, ["gravity.angle=10,20"], None, None).points[0].case,
    "slider": lambda _, path: Draft.load(path).changed({"gravity.angle": 10.0}),
}


@pytest.mark.parametrize("text", [LIFT, EARTH], ids=["boom", "earth"])
@pytest.mark.parametrize("way", WAYS)
def test_the_ground_stays_at_another_angle(tmp_path: Path, way: str, text: str) -> None:
    """Reference: analytic, the coordinates of a fixed point in turned axes; before, only load cases
    kept the point, and other changes turned it with the boom.
    """
    case = read_case(tmp_path, text + LEVEL)
    (before,) = build_boom(case).cylinders
    assert before.ground == pytest.approx(GROUND)
    (after,) = build_boom(WAYS[way](case, str(tmp_path / "case.toml"))).cylinders
    turn = radians(10.0)
    right = FRONT * cos(turn) - BELOW * sin(turn), -FRONT * sin(turn) - BELOW * cos(turn)
    assert after.ground == pytest.approx(right, rel=1e-12)


def test_earth_axes_in_other_units_and_in_the_saved_case(tmp_path: Path) -> None:
    """Reference: analytic, thousandths, and the case that its own text gives."""
    case = read_case(tmp_path, EARTH)
    assert read_case(tmp_path, toml.dumps(case)) == case
    in_mm = case.model_copy(update={"units": "mm-t-s"})
    (cylinder,) = convert_to_si(in_mm).cylinders
    assert isinstance(cylinder.ground, EarthPoint)
    assert asdict(cylinder.ground) == pytest.approx({"front": 1e-3 * FRONT, "below": 1e-3 * BELOW})


@pytest.mark.parametrize("ground", ["[1.2]", "1.2", "[1.2, nan]"])
def test_a_ground_that_is_no_point(tmp_path: Path, ground: str) -> None:
    what = "a list of two numbers, or a table of two such as { front = 0.7, below = 1.1 }"
    text = LIFT.replace(f"ground = {list(GROUND)}", f"ground = {ground}")
    assert refusal(tmp_path, text) == f"cylinder[1].ground: must be {what}, got {ground}"


def test_earth_axes_need_a_foot_and_a_luffing_angle(tmp_path: Path) -> None:
    """Reference: exact words."""
    text = EARTH.replace('supports = [{ x = 0.0, kind = "hinged" }]', "")
    assert refusal(tmp_path, text) == (
        "cylinder[1].ground: no segment has a support, from whose pin front and below are "
        "measured; give one"
    )
    boom = build_boom(read_case(tmp_path, EARTH))
    jack = pt.Cylinder(0, x=2.4, ground=EarthPoint(1.0, 1.0), stiffness=1e7)  # type: ignore[arg-type]
    line = "cylinders[0].ground: a boom has no earth axes; give x and z in m of its own axes"
    with pytest.raises(pt.BoomError, match=f"^{re.escape(line)}$"):
        pt.Boom(boom.segments, boom.joints, cylinders=(jack,))
