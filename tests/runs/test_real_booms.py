# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static states of shipped booms, and cautions: values out of usual ranges, walls that bend."""

import re
from dataclasses import replace
from math import cos, radians
from pathlib import Path

import numpy as np
import pytest

from protractile.analysis.model import AnalysisModel
from protractile.analysis.plate_buckling import measure_plates, weakest_plates
from protractile.analysis.rows import INITIAL, REST, Rows, extremes, static_rows
from protractile.analysis.states import States
from protractile.beam_model.statics import static_state
from protractile.dynamics.line import Line
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Joint, Segment
from protractile.geometry.box import BoxSection
from protractile.runs import CASES
from protractile.runs.case import reading
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import CheckedCase
from protractile.runs.cautions import rules
from protractile.runs.cautions.context import Context, State
from protractile.runs.cautions.response import bulges
from protractile.runs.check import check_case
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.statics import boom_with_play
from protractile.runs.process.bad_input import BadInput
from tests.booms import CLAMP
from tests.booms import STEEL as METAL
from tests.modal import modal_system
from tests.runs.case_texts import (
    CLAMPED,
    HINGED,
    STEEL,
    box,
    edited,
    elements,
    load_checked_text,
    read_case,
    refusal,
    shipped,
    table,
)

GRAVITY = 9.80665


# Pieces of a segment, at whose middles its weight and its bending count.
PIECES = 2000


def middles(segment: Segment) -> Array:
    return segment.start + segment.length * (np.arange(PIECES) + 0.5) / PIECES


def beyond(pushed: Array, x: Array) -> tuple[Array, Array]:
    """Return moment and shear force at x of forces (num_forces, 3): place, force up, moment."""
    at, force, moment = pushed.T
    far = at > x[:, None]
    return (far * (force * (at - x[:, None]) + moment)).sum(axis=1), (far * force).sum(axis=1)


def midpoints(joint: Joint) -> tuple[float, float]:
    """Return x in m of the midpoints of pads at both ends of the overlap, or of the stations."""
    (first, last), half = joint.stations, 0.5 * joint.pad.length if joint.pad else 0.0
    return first + half, last - half


def by_hand(boom: Boom, weight: float, tip: float) -> tuple[list[Array], list[float]]:
    """Apply the lever rule from the tip to the base; return forces on segments and of cylinders.

    Args:
        boom: level boom; each segment has two supports or stations, or a clamp.
        weight: weight in m/s², downwards.
        tip: upward force at the tip in N.
    """
    pushed = []
    for one in boom.segments:
        masses = [(x, one.mass_per_length * one.length / PIECES) for x in middles(one)]
        masses += [(mass.x, mass.mass) for mass in one.all_masses]
        pushed.append(np.array([(x, -weight * mass, 0.0) for x, mass in masses]))
    pushed[-1] = np.vstack([pushed[-1], (boom.tip, tip, 0.0)])
    for joint in reversed(boom.joints):
        inner, (first, last) = pushed[joint.inner], midpoints(joint)
        head = -(inner[:, 1] @ (inner[:, 0] - first)) / (last - first)
        tail = -inner[:, 1].sum() - head
        pressed = np.array([(first, tail, 0.0), (last, head, 0.0)])
        pushed[joint.inner] = np.vstack([inner, pressed])
        pushed[joint.outer] = np.vstack([pushed[joint.outer], pressed * (1.0, -1.0, 1.0)])
    presses = []
    for jack in boom.cylinders:
        base, (along, up) = pushed[jack.segment], jack.direction
        press = -(base[:, 1] @ base[:, 0]) / (up * jack.x + along * jack.depth)
        lug = jack.x, up * press, along * jack.depth * press
        pushed[jack.segment] = np.vstack([base, lug])
        presses.append(press)
    return pushed, presses


def tip_by_hand(boom: Boom, stiffness: list[float]) -> float:
    """Return the tip deflection in m under the weights by the unit-load method."""
    (real, presses), (unit, ones) = by_hand(boom, GRAVITY, 0.0), by_hand(boom, 0.0, 1.0)
    found = 0.0
    for segment, own, virtual in zip(boom.segments, real, unit, strict=True):
        shear = segment.material.shear_modulus * segment.section.shear_area
        x = middles(segment)
        (moment, force), (of_one, with_one) = beyond(own, x), beyond(virtual, x)
        bent = moment @ of_one / segment.bending_stiffness + force @ with_one / shear
        found += bent * segment.length / PIECES
    for joint, k in zip(boom.joints, stiffness, strict=True):
        for x in midpoints(joint):
            force, with_one = (force_at(one[joint.inner], x) for one in (real, unit))
            # The inner segment gives way against what pushes it, by the clearance and by F/k.
            found += with_one * (np.sign(force) * 0.5 * joint.play + force / k)
    for jack, press, one in zip(boom.cylinders, presses, ones, strict=True):
        found += press * one / jack.stiffness
    return found


def force_at(pushed: Array, x: float) -> float:
    """Return the last force at x in N, that of a pad."""
    return float(pushed[np.isclose(pushed[:, 0], x)][-1, 1])


@pytest.mark.parametrize("name", ["crane", "inspection-arm"])
def test_booms_have_the_deflections_of_statics_by_hand(name: str) -> None:
    """Reference: analytic, lever rule and unit loads, with play's rotations, within 0.1 %.

    The booms are level under their weights; only cylinders give axial forces.
    """
    case = shipped(name)
    gravity = case.gravity.model_copy(update={"angle": 0.0})
    case = case.model_copy(update={"gravity": gravity, "axial": (), "loads": ()})
    boom = build_boom(case)
    model = next(model for model in case.models if not model.bonded)
    touching = model.model_boom(boom).boom
    rest = static_state(touching, walls=0.0)
    pushed, _ = by_hand(boom, GRAVITY, 0.0)
    forces = {(one.segment, round(one.x, 9)): one.force for one in rest.reactions}
    for inner, x in ((joint.inner, x) for joint in boom.joints for x in midpoints(joint)):
        expected = force_at(pushed[inner], x)
        assert forces[inner, round(x, 9)] == pytest.approx(expected, rel=1e-3)
    stiffness = [joint.contact.terms[0].stiffness for joint in touching.joints]
    assert rest.tip == pytest.approx(tip_by_hand(boom, stiffness), rel=1e-3)


PUSH = """[[base]]
acceleration = 0.5
group = "wind"
table = [[0.0, 0.0], [1.0, 0.5]]

"""
PIN = {"diameter": 0.04, "strength": 8e8}
JACK = {"x": 2.4, "depth": 0.25, "ground": [0.7, -1.1], "pin": PIN}
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
{table("[[cylinder]]", segment="base", stiffness=3e7, capacity=2e5, **JACK)}
[[load_case]]
name = "a"
load = [{{ segment = "fly", magnitude = -30.0, group = "wind" }}]
[[combination]]
name = "Z1"
factors = {{ dead = [1.2, 1.0], payload = 1.3, wind = 1.1 }}
resistance = {{ material = 1.1 }}
{elements("beam", theory="timoshenko")}
"""
# Half the weight in N of the plates.
LOW = 9.80665 * 7850.0 * (6.5 * (0.22 * 0.006 + 0.3 * 0.005) + 6.0 * (0.18 * 0.005 + 0.256 * 0.004))


def told(folder: Path, text: str) -> list[str]:
    """Return the message of a refused case, or the cautions of another one."""
    try:
        checked = load_checked_text(folder, text)
    except BadInput as refused:
        return [str(refused).removeprefix(f"{folder / 'case.toml'}: ")]
    return rules.cautions(Context(checked.case, checked.boom), rules.OF_INPUTS)


HOISTED = (CASES / "hoist.toml").read_text("utf-8").replace("ramp = 0.2", "ramp = 0.0")


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        *((old, f"{old.split()[0]} = {new}", f"hoist.{old.split()[0]}: the ") for old, new in (
            ("travel = 1.2", "1e6"), ("speed = 0.2", "1e6"), ("modulus = 1.0e11", "1e-6"),
            ("length = 35.0", "1e6"),
        )),
        ("material = 1.1", "material = 1e-9", "combination[1].resistance.material: the "),
        ("partial_factor = 1.15", "partial_factor = 1e-9", "life.partial_factor: the partial "),
        ("diameter = 0.04", "diameter = 40.0",
         "cylinder[1].pin.diameter: the diameter of the pin is 40 m, usual is from 0.003 up to 0.5 "
         "m; if it is in mm, give 0.04 m"),
        ("ground = [0.7, -1.1]", "ground = { front = 0.0012, below = 0.0003 }",
         "cylinder[1].ground: the distance from the foot pin to the ground of cylinder 1 is "
         "0.0012369 m, "),
        ("strength = 800000000.0", "strength = 800.0", "cylinder[1].pin.strength: the strength of"),
        # Of the weight of the boom without payload.
        ("capacity = 200000.0", "capacity = 1e30",
         f"cylinder[1].capacity: the capacity of the cylinder is 1e+30 N, usual is from {LOW:.3g} "
         f"up to {2e3 * LOW:.3g} N; check the number and its unit"),
        ("allowable_pressure = 20000000.0", "allowable_pressure = 1e30",
         "joint[1].pad.allowable_pressure: the allowable pressure of the pad is 1e+30 Pa, "),
        ("resistance = { material = 1.1 }", "proofs = []",
         "combination[1].proofs: empty; give at least one"),
        ("play = 0.003", "play = 4.0",
         "joint[1].play: 'fly' does not fit in 'base': 0.033 m of height and 0.031 m of width are "
         "free, and a play of 4 m is asked for; make the inner section or the play smaller; if it "
         "is in mm, give 0.004 m"),
        ("capacity = 200000.0", "capacity = 2000.0", "caution: cylinder[1].capacity: the capacity"),
        ("stiffness = 30000000.0", "stiffness = 30000.0", "caution: cylinder[1].stiffness: the"),
        ('name = "a"', 'name = "a"\npayload = 1e6', "caution: load_case[1].payload: the payload"),
        ("dead = [1.2, 1.0], payload = 1.3, wind = 1.1", "dead = 0.0, payload = 0.0, wind = 0.0",
         "caution: combination[1].factors: all are 0, so that no load acts"),
        ("magnitude = -30.0", "magnitude = -110000.0",
         "caution: load_case[1].load[1].magnitude: -110000 N/m is "),
        ("[[joint]]", PUSH + "[[joint]]",
         "caution: base[1]: its table ends at 1 s with 100 % of its peak, which acts until the "),
        ("density = 7850.0", "density = 7850.0\nyield_by_thickness = [[0.005, 3.55e8]]",
         "caution: segment[1].section: a plate of 6 mm is thicker than the last pair of "
         "yield_by_thickness, 5 mm, and takes its strength; add a pair"),
        ("flange = 0.006, web = 0.005", "flange = 0.005, web = 0.006",
         "caution: segment[1].section: the flanges of 0.005 m are thinner than the webs of 0.006"),
        ("gravity = { angle = 45.0 }", "gravity = { acceleration = 9.81 }",
         "caution: gravity.angle: missing, so that the boom on its cylinder is horizontal; "),
    ],
)  # fmt: skip
def test_values_without_sense_are_told(tmp_path: Path, old: str, new: str, line: str) -> None:
    """Reference: exact words; the weight of the boom by its plates."""
    text = HOISTED if line.startswith("hoist") else LIFT
    (found,) = told(tmp_path, edited(text, (old, new)))
    assert found.startswith(line)


def test_a_hoist_needs_its_rope_and_its_load_once(tmp_path: Path) -> None:
    """Reference: by hand, 5 t weigh 24517 N across the boom at 60 degrees."""
    text = re.sub(r"(?ms)^\[rope\].*?(?=^\[)", "", HOISTED)
    text = re.sub(r"(?ms)^\[payload\].*?mass = [0-9.]+", "[payload]\nmass = 5000.0", text)
    force = -5000.0 * 9.80665 * cos(radians(60.0))
    load = table("[[load]]", segment="fly", x="head", magnitude=force, ramp=0.1)
    found = told(tmp_path, text + load)
    assert {
        "payload.mass: the 5000 kg at the tip are also the load of [hoist]",
        "rope: missing",
        f"load[1].magnitude: if {force:g} N at the tip is the weight of the load of [hoist]",
    } <= {line.removeprefix("caution: ").partition(",")[0] for line in found}


def test_a_boom_that_buckles_names_the_likely_unit(tmp_path: Path) -> None:
    """Reference: exact words; a stiffness in N/mm, and a payload of ten times the boom.

    The correct lift has no caution.
    """
    assert told(tmp_path, LIFT) == []
    slips = ("mass = 150.0", "mass = 5000.0"), ("stiffness = 30000000.0", "stiffness = 30000.0")
    found = refusal(tmp_path, edited(LIFT, *slips))
    assert found.startswith("model[1]: the boom of 'beam' buckles under ")
    assert found.endswith("; if it is in N/mm, give 3e+07 N/m")


BUCKLING = np.pi**2 * 2.1e11 / (12.0 * 0.91)
TUBE = BoxSection(height=0.5, width=0.4, flange=0.006, web=0.008)
OF_FLANGE, OF_WEB = BUCKLING * (0.006 / 0.4) ** 2, BUCKLING * (0.008 / 0.5) ** 2


@pytest.mark.parametrize(
    ("curves", "wall", "x", "factor"),
    [
        ({"moment": [0.0, 1e5]}, "bottom", 2.0,
         4.0 * OF_FLANGE / (1e5 * 0.25 / TUBE.second_moment_of_area)),
        ({"normal": [-0.5e6, -1e6]}, "bottom", 2.0, 4.0 * OF_FLANGE * TUBE.area / 1e6),
        # A positive moment presses the fibres with y < 0, on the left.
        ({"lateral_moment": [0.0, 1e5]}, "left", 2.0,
         4.0 * OF_WEB / (1e5 * 0.2 / TUBE.lateral_second_moment_of_area)),
        ({"torque": [1e5, 1e4]}, "bottom", 0.0,
         5.34 * OF_FLANGE / (1e5 / (2.0 * 0.2 * 0.006))),
    ],
)  # fmt: skip
def test_the_weakest_wall_of_a_segment(
    curves: dict[str, list[float]], wall: str, x: float, factor: float
) -> None:
    """Reference: analytic. Moments and axial forces compress walls, torque shears them."""
    segment = Segment.of_section("outer", 0.0, 2.0, METAL, TUBE, supports=(CLAMP,))
    given = {key: [0.0, 0.0] for key in ("deflection", "moment", "normal")} | curves
    # One coordinate of value 1 has these section forces.
    line = Line(np.array([0.0, 2.0]), {k: np.array(v)[:, None] for k, v in given.items()}, True)
    model = AnalysisModel(Boom((segment,), ()), modal_system([1.0], [0.0]), [line])
    rest = States(model, np.zeros(1), np.ones((1, 1)))
    (row,) = weakest_plates(Rows(extremes(measure_plates(rest), "beam", REST)))
    assert (row.place, row.x, row.value) == (wall, x, pytest.approx(factor))


def test_check_names_buckling_walls(tmp_path: Path) -> None:
    """Reference: analytic, the bottom flange of a cantilever under a load at its tip."""
    section = BoxSection(height=0.4, width=0.3, flange=0.003, web=0.008)
    unit = BUCKLING * (0.003 / 0.3) ** 2
    stress = 2.0e5 * 6.0 * 0.2 / section.second_moment_of_area
    text = f"""
title = "Thin"
time = {{ duration = 1.0 }}
model = [{{ name = "beam", kind = "finite-element" }}]
load = [{{ segment = "arm", x = "head", magnitude = -2e5 }}]
{STEEL}{box("arm", 6.0, (0.4, 0.3, 0.003, 0.008), CLAMPED)}
"""
    found = check_case(CheckedCase(read_case(tmp_path, text)))
    (table,) = (one for one in found.tables if one.title == "Buckling of walls, estimate")
    assert table.rows == [("arm", "bottom", "0", f"{4.0 * unit / stress:.3g}")]
    (caution,) = (line for line in found.lines if "panel formulas" in line)
    assert caution.startswith("caution: the wall 'bottom' of 'arm' buckles at")


def test_check_names_plays_closed_by_walls() -> None:
    """Reference: other code, corners of the static shell of the arm at t = 0."""
    checked = reading.load_checked(str(CASES / "inspection-arm.toml"))
    boom = boom_with_play(checked.case, checked.boom)
    rows = Rows(static_rows(static_states(checked.case, boom), "beam"))
    closed = rows.where(state=INITIAL, quantity="closed_play")
    assert [row.value for row in closed] == pytest.approx(
        [1.9203e-3, 2.8462e-3, 1.2405e-3, 2.0487e-3], rel=0.02
    )
    state = State("in the beam estimate", closed=closed)
    (caution,) = bulges(Context(checked.case, boom, [state]))
    assert "1.9 of 4 mm at x = 3.5 m, 2.8 of 4 mm at x = 4.5 m" in caution


def test_walls_that_close_a_play_press_pads_on_both_sides() -> None:
    """Reference: by hand; across a symmetric boom a pad on each side is pressed alike."""
    case = shipped("inspection-arm")
    assert case.payload is not None
    joints = tuple(replace(joint, lateral_play=0.001) for joint in case.joints)
    for factor in (1.0, 10.0):
        payload = case.payload.model_copy(update={"mass": factor * case.payload.mass})
        changed = case.model_copy(update={"wind": None, "joints": joints, "payload": payload})
        boom = boom_with_play(changed, build_boom(changed))
        rows = Rows(static_rows(static_states(changed, boom), "beam")).where(state=REST)
        closed = rows.where(quantity="closed_play")
        pressed = [
            row.value for row in rows.where(quantity="penetration") if "lateral" in row.place
        ]
        assert [row.value for row in closed] == pytest.approx(
            [0.001 + 2.0 * depth for depth in pressed], rel=1e-9
        )
        (caution,) = bulges(Context(changed, boom, [State("in the beam estimate", closed=closed)]))
        assert "all of it at x = 3.5 m, x = 4.5 m, x = 6.9 m, x = 7.8 m, where pads on " in caution
