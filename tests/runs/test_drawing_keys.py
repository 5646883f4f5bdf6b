# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of a drawing: wind, rope, head, outer sizes, and cylinders."""

from math import cos, pi, radians, sin
from pathlib import Path

import pytest

from protractile.analysis.plate_buckling import measure_plates, plate_stresses, reduced_stress
from protractile.analysis.rows import Rows
from protractile.geometry.cylinder import Cylinder
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.section import SectionError
from protractile.geometry.typography import amount
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import combined_cases
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.sections import UTable
from protractile.runs.pipeline.combinations import (
    combination_rows,
    combination_states,
    limited_tips,
)
from protractile.runs.pipeline.proofs import proofs_of
from protractile.runs.pipeline.statics import boom_with_play, cylinder_force, state_at_rest
from tests.runs.case_texts import (
    HINGED,
    REST,
    STEEL,
    box,
    edited,
    elements,
    joint,
    read_case,
    refusal,
    table,
)
from tests.runs.summaries import printed_check, static_tip

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
# Its base of plates 6 and 14 mm thick; first moments of its rectangles about the bottom.
SIZES = 'shape = "unequal box", height = 0.3, width = 0.22, top = 0.006, bottom = 0.014'
UNEQUAL = edited(DRAWN, ("height = 0.3, width = 0.22, flange = 0.006", SIZES))
_OUTER, _INNER = 0.226 * 0.31, 0.214 * 0.29
AXIS = (_OUTER * 0.155 - _INNER * (0.014 + 0.145)) / (_OUTER - _INNER)
JACK = table("[[cylinder]]", **CYLINDER, stiffness=3e7)
LIMITED = table("[[cylinder]]", **CYLINDER, stiffness=3e7, open=2.0)
LUFF, WINCH = table("[luff]", travel=5.0, time=9.0), {"front": -1.0, "below": 0.0}
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
    loads = (
        {"segment": "base", "magnitude": -base},
        {"segment": "fly", "magnitude": -fly, "from": 6.0},
        {"segment": "fly", "magnitude": -200.0 * across, "x": "head"},
    )
    by_hand = "".join(table("[[load]]", **keys, group="wind") for keys in loads)
    by_hand += table("[[axial]]", force=-200.0 * along, group="wind")
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


def test_a_head_gives_the_moments_of_load_and_own_mass(tmp_path: Path) -> None:
    """Reference: other input, the same moments by [[load]], and its mass by the segment."""
    head = table("[head]", ahead=0.8, below=0.5, mass=60.0)
    lever = 0.8 * cos(radians(50.0)) + 0.5 * sin(radians(50.0))
    at_tip = {"segment": "fly", "x": "head", "moment": True}
    by_hand = "".join(
        table("[[load]]", **at_tip, magnitude=-mass * G * lever, group=group)
        for mass, group in ((180.0, "dead"), (230.0, "payload"))
    )
    heavier = '\nmasses = [{ x = "head", mass = 60.0 }]\n[[joint]]'
    text = DRAWN.replace("[[joint]]", heavier, 1) + JACK
    other = combination_rows(read_case(tmp_path, text + by_hand + PEOPLE + FACTORS))
    same(rows_of(tmp_path, head + PEOPLE + FACTORS), other)


@pytest.mark.slow
def test_shells_take_wind_rope_and_head_as_beams_do(tmp_path: Path, tools: BuildContext) -> None:
    """Reference: other model, shear-flexible beams; each of the loads counts for far more."""
    loads = (
        table("[rope]", falls=1)
        + table("[wind]", pressure=1200.0, shape_factor=1.4)
        + table("[head]", ahead=1.2, below=0.9)
    )
    shell = table("[[model]]", name="shell", kind="shell", mesh_size=0.3)
    text = (DRAWN + JACK).replace("mass = 150.0", "mass = 900.0") + shell
    tips = []
    for more in ("", loads):
        case = read_case(tmp_path, text + more)
        beam, shell_tip = (
            static_tip(case.model_copy(update={"models": (model,)}), tools=tools)
            for model in case.models
        )
        assert shell_tip == pytest.approx(beam, rel=0.04)
        tips.append(beam)
    assert tips[1] < 1.2 * tips[0]


@pytest.mark.parametrize(
    ("order", "fly_out", "tip_out"),
    [("in proportion", 2.1, 2.1), ("from the base", 4.0, 0.2), ("from the tip", 0.2, 4.0)],
)
def test_telescoping_by_a_fraction_of_the_stroke(
    tmp_path: Path, order: str, fly_out: float, tip_out: float
) -> None:
    """Reference: analytic, half of the strokes of 3.8 m between 0.2 and 4 m, in each order."""
    text = DRAWN + JACK + box("tip", 5.0, (0.20, 0.14, 0.006, 0.006)) + drawn_out("tip", "fly")
    text = text.replace("extension = 4.0", "stroke = 3.8", 1)
    text += table("[telescoping]", extension=0.5, order=order, retracted=0.2)
    text += table("[[load_case]]", name="out", telescoped=1.0)
    text += table("[[load_case]]", name="in", telescoped=0.0)
    text += table("[[load_case]]", name="named", extension={"tip": 1.0})
    case = read_case(tmp_path, text)
    ends = [segment.end for segment in build_boom(case).segments[1:]]
    assert ends == pytest.approx([6.0 + fly_out, 6.0 + fly_out + tip_out], rel=1e-12)
    tips = [build_boom(combined.case).tip for combined in combined_cases(case)]
    assert tips == pytest.approx([14.0, 6.4, 11.0])


def test_a_section_by_outer_sizes_is_that_of_its_mid_lines(tmp_path: Path) -> None:
    """Reference: other input, the mid-lines of the same box."""
    sizes = "height = 0.3, width = 0.22, ", "outside = true, height = 0.306, width = 0.226, "
    own, other = (
        build_boom(read_case(tmp_path, text + JACK)).segments[0].second_moment_of_area
        for text in (DRAWN, edited(DRAWN, sizes))
    )
    assert own == pytest.approx(other, rel=1e-14)


SHELLS = {"shape": "U", "top": 0.006, "bottom": 0.008, "web": 0.006, "facets": 2}


def test_bends_of_a_drawing_have_the_radius_of_the_tool() -> None:
    """Reference: by hand, the mid-line is half a thickness from each surface."""
    keys = {"height": 0.64, "width": 0.47, "radius": 0.16, "bend_radius": 0.024}
    for outside, (top, below) in ((True, (0.027, 0.156)), (False, (0.024, 0.16))):
        made = UTable.model_validate(SHELLS | keys | {"outside": outside}).section()
        assert isinstance(made, PolygonSection)
        # The last corner of each lower bend is the weld to the web.
        assert made.radii == pytest.approx((below,) * 3 + (0.0, top, top, 0.0, below))


def test_half_shells_of_two_thicknesses() -> None:
    """Reference: analytic, plates and quarter rings; by outer sizes, the mid-lines by hand."""
    h, b, r, weld, lower, upper = 0.6, 0.4, 0.15, 0.28, 0.008, 0.006
    sizes = {"height": h, "width": b, "radius": r, "weld": weld}
    made = UTable.model_validate(SHELLS | sizes).section()
    below, above = b - 2.0 * r + pi * r + 2.0 * (weld - r), b + 2.0 * (h - weld)
    assert made.area == pytest.approx(lower * below + upper * above, rel=1e-12)
    around = below / lower + above / upper
    cell = b * h - (2.0 - 0.5 * pi) * r**2
    assert made.torsion_constant == pytest.approx(4.0 * cell**2 / around, rel=1e-12)
    outer = {"height": h + 0.007, "width": b + lower, "radius": r + 0.004, "weld": weld + 0.004}
    drawn = UTable.model_validate(SHELLS | outer | {"outside": True}).section()
    for name in ("area", "second_moment_of_area", "lateral_second_moment_of_area", "shear_area"):
        assert getattr(drawn, name) == pytest.approx(getattr(made, name), rel=1e-12)
    with pytest.raises(SectionError, match=r"^weld must be above the bends, 0.15 m, and below "):
        UTable.model_validate(SHELLS | sizes | {"weld": 0.1}).section()


def test_a_weld_within_a_plate_holds_no_buckle(tmp_path: Path) -> None:
    """Reference: other input, the same box whose webs have no welds; each half would be stiffer."""
    corners = [[-0.11, 0.0], [0.11, 0.0], [0.11, 0.3], [-0.11, 0.3]]
    of_webs = [*corners[:2], [0.11, 0.15], *corners[2:], [-0.11, 0.15]]
    found = []
    for places in (corners, of_webs):
        keys = f'shape = "polygon", corners = {places}, thicknesses = {[0.006] * len(places)}'
        box = "height = 0.3, width = 0.22, flange = 0.006, web = 0.006"
        text = edited(DRAWN, (box, keys), ("7850.0", "7850.0\nyield_strength = 3.55e8"))
        (state,) = combination_states(read_case(tmp_path, text + JACK + PEOPLE + FACTORS))
        (base,) = (each for each in plate_stresses(state.states) if each.segment.name == "base")
        webs = [plate.name.startswith("right") for plate in base.plates]
        factors = [each for each in measure_plates(state.states) if each.part == "base"]
        lowest = min(each.values.min() for each in factors if each.place.startswith("right"))
        found.append([float(reduced_stress(base)[webs].max()), lowest])
    # The mean shear stresses of both halves are not quite that of the web.
    assert found[1] == pytest.approx(found[0], rel=1e-3)


def test_check_prints_the_height_of_the_axis(tmp_path: Path) -> None:
    """Reference: by hand, first moments of the outer and the inner rectangle."""
    case = read_case(tmp_path, UNEQUAL + JACK)
    line = "Height of the axis, through the centroid, above the outer surface of the bottom: base "
    assert f"{line}{AXIS:.4g} m." in printed_check(case, 120)


def test_cylinder_by_its_drawing(tmp_path: Path) -> None:
    """Reference: the extension by hand; the pressure of the printed force on the bore."""
    data = {"bore": 0.14, "rod": 0.1, "closed": 1.5, "open": 2.4, "pressure": 2.5e7}
    text = DRAWN + table("[[cylinder]]", **CYLINDER, **data)
    shown = printed_check(read_case(tmp_path, text), 120)
    assert "Cylinder 1 is extended by 0.4007 m of its stroke of 0.9 m." in shown
    case = read_case(tmp_path, text)
    force = cylinder_force(state_at_rest(case, boom_with_play(case, build_boom(case))), 1)
    pressure = amount(force / (0.25 * pi * 0.14**2), "Pa")
    assert f"Oil pressure of cylinder 1: {pressure}." in shown
    # Lifted by its tip, the boom pulls: by hand, the oil is on the ring about the rod.
    up = table("[[load]]", segment="fly", x="head", magnitude=9e4)
    rows = combination_rows(read_case(tmp_path, text + up + PEOPLE + FACTORS))
    row = next(row for row in rows if row.quantity == "cylinder_force")
    assert row.value < 0.0
    assert row.limit == pytest.approx(2.5e7 * 0.25 * pi * (0.14**2 - 0.1**2), rel=1e-12)
    ring = f"on the ring of bore less rod, {0.25 * pi * (0.14**2 - 0.1**2):.4g} m²"
    told = f"Cylinder pulls with {amount(-row.value, 'N')} {ring}, under the loads of 'A, people'."
    assert told in printed_check(read_case(tmp_path, text + up + PEOPLE + FACTORS), 200)
    bare = (text + up + PEOPLE + FACTORS).replace("pressure = 25000000.0\n", "")
    told += " The pull is not proved: it has no `pressure`."
    assert told in printed_check(read_case(tmp_path, bare), 250)
    raised = text + table("[luff]", travel=35.0, time=20.0)
    assert refusal(tmp_path, raised).startswith("cylinder[1].open: 2.4 m, and from ground to lug ")


def test_the_stroke_of_a_cylinder_replaces_its_open_length(tmp_path: Path) -> None:
    """Reference: other input, open = closed + stroke; exact words of refusals."""
    data = CYLINDER | {"bore": 0.14, "rod": 0.1, "closed": 1.5}
    up = table("[[load]]", segment="fly", x="head", magnitude=9e4)
    text = DRAWN + up + PEOPLE + FACTORS
    own, other = (
        combination_rows(read_case(tmp_path, text + table("[[cylinder]]", **data, **end)))
        for end in ({"stroke": 0.75}, {"open": 2.25})
    )
    assert own.where(quantity="cylinder_force")
    assert own == other
    for keys, line in (
        ({"open": 2.0}, "stroke: open is given; leave one of them out"),
        ({"stroke": 1.5}, "stroke: must be below 1.5 m, closed, as the rod goes into the closed "
         "cylinder, got 1.5 m"),
        ({"stroke": 0.3}, "stroke: 1.8 m, and from ground to lug it is 1.901 m: the cylinder does "
         "not reach; change it, the ground or the luffing angle"),
    ):  # fmt: skip
        text = DRAWN + table("[[cylinder]]", **data | {"stroke": 0.75} | keys)
        assert refusal(tmp_path, text) == f"cylinder[1].{line}"
    text = DRAWN + table("[[cylinder]]", **CYLINDER, stiffness=3e7, stroke=0.9)
    line = "cylinder[1].closed: missing; the stroke begins at this length"
    assert refusal(tmp_path, text) == line


def test_a_share_of_the_length_holds_at_each_extension(tmp_path: Path) -> None:
    """Reference: by hand, 2 % of the lengths from foot to tip; exact words of refusals."""
    text = DRAWN + JACK + PEOPLE + table("[[load_case]]", name="short", extension={"fly": 1.0})
    text += table("[[combination]]", name="A", factors={"dead": 9.0, "payload": 9.0},
                  proofs=["deflection"])  # fmt: skip
    limited = text + table("[limits]", tip_at_rest="2 %")
    case = read_case(tmp_path, limited)
    assert read_case(tmp_path, toml.dumps(case)) == case
    assert case.limits is not None
    assert case.limits.tip_at_rest == "2 %"
    expected = {"combination A, people": 0.2, "combination A, short": 0.14}
    found = {
        row.state: row.limit for state in combination_states(case) for row in proofs_of(state, case)
    }
    assert found == pytest.approx(expected)
    tips = limited_tips(combination_rows(case), case)
    assert {row.state: row.limit for row in tips} == pytest.approx(expected)
    for share, line in (
        ("-2 %", "must be a number greater than 0, got -0.02"),
        ("2", "has no unit; give one, or the number without quotes, got '2'"),
    ):
        refused = refusal(tmp_path, text + table("[limits]", tip_at_rest=share))
        assert refused == f"limits.tip_at_rest: {line}"


def test_a_cylinder_is_as_stiff_as_the_oil_on_the_side_that_carries(tmp_path: Path) -> None:
    """Reference: the sign of its force at rest on both sides of balance; stiffness by hand."""
    data = {"bore": 0.14, "rod": 0.1, "closed": 1.5, "open": 2.4}
    drawn = DRAWN.replace('kind = "hinged"', 'kind = "hinged", depth = 0.1')
    drawn += table("[[cylinder]]", **CYLINDER, **data) + table("[head]", ahead=0.4, below=0.3)
    drawn += table("[rope]", falls=2, winch=1.0) + table("[wind]", pressure=200.0, shape_factor=1.3)

    def lifted(force: float) -> tuple[Cylinder, float]:
        load = table("[[load]]", segment="fly", x="head", magnitude=force)
        case = read_case(tmp_path, drawn + load)
        boom = build_boom(case)
        state = state_at_rest(case, boom_with_play(case, boom))
        return boom.cylinders[0], cylinder_force(state, 1)

    (_, weight), (_, less) = lifted(0.0), lifted(1e3)
    balance = 1e3 * weight / (weight - less)
    rod, bore = (0.25 * pi * data[name] ** 2 for name in ("rod", "bore"))
    for part in (0.95, 1.05):
        jack, force = lifted(part * balance)
        pulls = part > 1.0
        assert (force < 0.0) == pulls
        column = (2.4 - jack.length) / (bore - rod) if pulls else (jack.length - 1.5) / bore
        compliance = column / 1.4e9 + 1.5 / (2.1e11 * rod)
        assert jack.axial_stiffness == pytest.approx(1.0 / compliance, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (table("[wind]", pressure=100.0, shape_factor=[1.2, 1.3, 1.4]),
         "wind.shape_factor: must be one number, or one for each of 2 segments, got 3"),
        (table("[wind]", pressure=100.0, speed=10.0, shape_factor=1.2),
         "wind.speed: pressure is given; leave one of them out"),
        (table("[wind]", speed=10.0, shape_factor=1.2, file="gust.csv"),
         "wind.speed: the file has pressures; leave speed out"),
        (table("[wind]", shape_factor=1.2),
         "wind.pressure: missing; it is the dynamic pressure in Pa; a factor, 1 unless given, if "
         "the heading of its file has such a unit"),
        (table("[wind]", pressure=1.0, shape_factor=1.2, direction="left"),
         "wind.direction: must be 'behind', 'side' or 'front', or an angle in degrees, got 'left'"),
        (table("[[load_case]]", name="up", angle=88.0) + LIMITED,
         "load_case[1].cylinder[2].open: 2 m, and from ground to lug it is 2.734 m: the cylinder "
         "does not reach; change it, the ground or the luffing angle"),
        (table("[[load_case]]", name="storm", wind={"pressure": 800.0}),
         "load_case[1].wind.shape_factor: missing; it is the shape factor (force coefficient) of "
         "all segments, or one for each segment"),
        (table("[wind]", pressure=100.0, shape_factor=1.2) + LUFF,
         "wind: the wind acts on the boom as it stands at t = 0; leave wind or luff out"),
        (table("[head]", ahead=0.2) + table("[hoist]", mass=200.0, stiffness=1e6, hanging=True),
         "head: the load of hoist hangs at the end of the boom; leave ahead, below and beside "
         "out"),
        (table("[[load]]", magnitude=1.0, direction="left"),
         "load[1].direction: must be 'z', 'y', 'behind', 'side' or 'front', or an angle in "
         "degrees, got 'left'"),
        (table("[[load]]", magnitude=1.0, direction="front", segment="fly"),
         "load[1].x: missing; it is the x in m of a point load; along the whole segment unless "
         "given"),
        (table("[[load]]", magnitude=1.0),
         "load[1].segment: missing; it is the name of the segment; unless given, a force of a "
         "direction acts where the payload hangs"),
        (table("[[load]]", magnitude=1.0, direction="z", moment=True),
         "load[1].moment: the load is a force at one place that stays; leave it out, or give "
         "segment"),
        (table("[rope]", falls=2, winch=1.0, ground=WINCH),
         "rope.winch: ground is given; leave one of them out"),
        (table("[rope]", falls=2, ground=WINCH) + LUFF,
         "rope.ground: the rope's lead across the boom is that at t = 0; leave luff or hoist out"),
        (table("[rope]", falls=2, sheave={"below": -0.3})
         + table("[hoist]", mass=200.0, stiffness=1e6, hanging=True),
         "rope.sheave: the load of hoist hangs at the end of the boom; leave ahead, below and "
         "beside out"),
        (table("[rope]", falls=2, sheave={"below": -0.3}) + table("[head]", mass=60.0)
         + table("[hoist]", mass=200.0, stiffness=1e6, hanging=True),
         "rope.sheave: the load of hoist hangs at the end of the boom; leave ahead, below and "
         "beside out"),
        (table("[rope]", falls=2, sheave={"beside": 0.3}),
         "rope.sheave.beside: unknown key; known ones are ahead, below"),
        (table("[head]", below={"left": 0.1}),
         "head.below: must be a number of m below the axis, or a distance in m from an outer "
         "surface such as { bottom = 0.2 }, got {'left': 0.1}"),
        (table("[rope]", falls=2)
         + table("[hoist]", mass=200.0, stiffness=1e6, falls=2, hanging=True),
         "rope.falls: hoist.falls is given; leave one of them out"),
    ],
)  # fmt: skip
def test_contradictions_are_refused(tmp_path: Path, text: str, line: str) -> None:
    (tmp_path / "gust.csv").write_text("t (s),q (Pa)\n0,100\n1,200\n", encoding="utf-8")
    assert refusal(tmp_path, DRAWN + JACK + text) == line
