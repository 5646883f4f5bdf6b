# SPDX-License-Identifier: LGPL-3.0-or-later
"""Load charts: capacities of rigid booms by hand, agreement with proofs, errors."""

from __future__ import annotations

from dataclasses import replace
from math import acos, atan2, cos, degrees, hypot, pi, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import protractile as pt
from protractile.geometry.arrays import Array
from protractile.geometry.chassis import Chassis, CraneForce
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.chart import output, run
from protractile.runs.chart.cells import LARGEST, OUT_OF_REACH, Cell, Configuration, Search, solve
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.combinations import combination_states
from protractile.runs.pipeline.proofs import proofs_of
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.ranks import single_rank
from studies.reference_models.elastica import Rod, Telescope
from tests.runs.case_texts import refused

# Gravity in m/s², so small that the boom stays straight.
G = 1.0e-4
# Mass of the boom in kg/m, lengths of its segments in m, and places of its cylinder in m.
MASS, LENGTHS, LUG, FRONT, BELOW = 50.0, (8.0, 8.0), 3.0, 1.5, 1.2
CAPACITY, PIN = 9.0, {"diameter": 0.00016, "strength": 4.0e8}
DEAD, PAYLOAD = 1.2, 1.5
CHASSIS = {
    "mass": 12000.0, "centre": 0.3, "counterweight": 2000.0, "behind": 2.0, "front": 2.5,
    "rear": 2.2, "side": 2.4, "foot_ahead": -0.8, "foot_above": 1.5,
}  # fmt: skip
BASE = {
    "name": "base",
    "length": LENGTHS[0],
    "supports": [{"x": 0.0, "kind": "hinged", "pin": PIN}],
}
BARE = {"mass_per_length": MASS, "second_moment_of_area": 2.0e-3}
JOINT = {
    "outer": "base", "inner": "fly", "extension": 6.0, "stations": ["tail", "head"],
    "bonded": True, "play": 0.0, "stiffness": 1.0e12, "exponent": 1.0,
}  # fmt: skip
GROUND = {"front": FRONT, "below": BELOW}


def rigid(*proofs: str, **chart: Any) -> dict[str, Any]:
    """Return a rigid boom of two bonded segments on a cylinder, and its chart by proofs."""
    factors = {"dead": DEAD, "payload": PAYLOAD}
    asked = {"load_case": "lift", "radii": [4.0, 6.0, 9.0], "lengths": [9.0, 14.0]}
    return {
        "title": "rigid",
        "time": {"duration": 1.0},
        "start": {"state": "equilibrium"},
        "gravity": {"angle": 45.0, "acceleration": G},
        "material": {"youngs_modulus": 2.1e11, "poissons_ratio": 0.3, "density": 7850.0},
        "segment": [BASE | BARE, {"name": "fly", "length": LENGTHS[1]} | BARE],
        "cylinder": [{"segment": "base", "x": LUG, "ground": GROUND, "stiffness": 5.0e9}],
        "joint": [JOINT],
        "load_case": [{"name": "lift"}],
        "combination": [{"name": "A", "factors": factors, "proofs": proofs or ("cylinder",)}],
        "chart": asked | chart,
        "model": [{"name": "beam", "kind": "finite-element", "theory": "euler-bernoulli"}],
    }


def deep(tables: dict[str, Any], depth: float) -> dict[str, Any]:
    """Return the tables with the foot pin at a depth in m below the axis."""
    base, *others = tables["segment"]
    foot = base["supports"][0] | {"depth": depth}
    return tables | {"segment": [base | {"supports": [foot]}, *others]}


def of_three(**chart: Any) -> dict[str, Any]:
    """Return the tables with a third segment."""
    tables = rigid(radii=[4.0], **chart)
    tables["segment"].append(tables["segment"][1] | {"name": "tip"})
    tables["joint"].append(JOINT | {"outer": "fly", "inner": "tip", "extension": 3.0})
    return tables


def planned(tables: dict[str, Any]) -> list[Configuration]:
    return run.plan(pt.load_case(tables), "case")


def cells(tables: dict[str, Any], capacity: float = CAPACITY) -> list[Cell]:
    """Return all cells of the chart of a case."""
    case = weak(pt.load_case(tables), capacity)
    return [cell for one in run.plan(case, "case") for cell in solve(case, one)]


def weak(case: pt.Case, capacity: float = CAPACITY) -> pt.Case:
    """Return a case with cylinders of a capacity in N, so small that case files refuse it."""
    jacks = tuple(replace(cylinder, capacity=capacity) for cylinder in case.cylinders)
    return case.model_copy(update={"cylinders": jacks})


def moment_of_boom(length: float) -> float:
    """Return the moment of the boom's mass in kg·m about the foot, if it lies."""
    return MASS * (LENGTHS[0] ** 2 / 2.0 + LENGTHS[1] * (length - LENGTHS[1] / 2.0))


def push(cell: Cell, payload: float) -> tuple[float, float, float]:
    """Return the force of the cylinder in N, and its direction, from moments about the foot."""
    turn = acos(cell.radius / cell.length)
    lug = LUG * cos(turn) - FRONT, LUG * sin(turn) + BELOW
    x, z = lug[0] / hypot(*lug), lug[1] / hypot(*lug)
    moment = DEAD * moment_of_boom(cell.length) * cos(turn) + PAYLOAD * payload * cell.radius
    return G * moment / (LUG * cos(turn) * z - LUG * sin(turn) * x), x, z


def test_capacity_by_the_cylinder() -> None:
    """Reference: analytic, moments of a rigid boom about its foot pin."""
    found = cells(rigid())
    assert len(found) == 6
    for cell in found:
        assert push(cell, cell.capacity or 0.0)[0] == pytest.approx(CAPACITY, rel=1.0e-6)
        assert cell.governing is not None
        assert cell.governing.quantity == "cylinder"
        assert cell.angle == pytest.approx(degrees(acos(cell.radius / cell.length)), abs=1.0e-4)
    for cell in cells(rigid(payload=5000.0)):
        utilisation = push(cell, 5000.0)[0] / CAPACITY
        assert cell.proofs[0].utilisation == pytest.approx(utilisation, rel=1.0e-6)


def test_capacity_by_the_pin() -> None:
    """Reference: analytic, equilibrium of a rigid boom; resistance 0.6 n A f_up."""
    resistance = 0.3 * pi * PIN["diameter"] ** 2 * PIN["strength"]
    for cell in cells(rigid("pin")):
        assert cell.capacity is not None
        force, x, z = push(cell, cell.capacity)
        weight = G * (DEAD * MASS * sum(LENGTHS) + PAYLOAD * cell.capacity)
        assert hypot(force * x, force * z - weight) == pytest.approx(resistance, rel=1.0e-6)


@pytest.mark.parametrize("depth", [0.0, 0.6])
def test_capacity_by_tipping(depth: float) -> None:
    """Reference: analytic, moments about the nearest tipping line."""
    found = cells(deep(rigid("tipping") | {"chassis": CHASSIS}, depth))
    assert [cell.reason for cell in found] == ["", "", OUT_OF_REACH, "", "", ""]
    mass, (ahead, behind) = MASS * sum(LENGTHS), (CHASSIS["foot_ahead"], CHASSIS["behind"])
    for cell in (cell for cell in found if not cell.reason):
        turn = acos((cell.radius - ahead) / hypot(cell.length, depth)) - atan2(depth, cell.length)
        axis, capacities = ahead - depth * sin(turn), {}
        for name, side in (("front", 1.0), ("rear", -1.0), ("side", 0.0)):
            line = CHASSIS[name]
            boom = axis + moment_of_boom(cell.length) / mass * cos(turn) - line
            resisting = CHASSIS["mass"] * (line - side * CHASSIS["centre"])
            resisting += CHASSIS["counterweight"] * (line + behind)
            capacities[name] = (resisting - DEAD * mass * boom) / (PAYLOAD * (cell.radius - line))
        name = min(capacities, key=lambda key: capacities[key])
        assert cell.capacity == pytest.approx(capacities[name], rel=1.0e-6)
        assert cell.governing is not None
        assert cell.governing.place == f"{name} line"


def test_the_capacity_agrees_with_the_proofs_of_its_case() -> None:
    """Reference: the definition of a capacity, for a flexible boom with play."""
    tables = flexible()
    found = cells(tables, 9.0e5)
    capacities = [cell.capacity for cell in found]
    assert capacities == sorted(capacities, reverse=True)
    for cell in found:
        lifted = tables | {"gravity": {"angle": cell.angle, "acceleration": 9.81}}
        lifted["load_case"] = [{"name": "lift", "payload": cell.capacity}]
        (state,) = combination_states(pt.load_case(lifted))
        rows = proofs_of(state, state.combined.case)
        assert max(row.utilisation or 0.0 for row in rows) == pytest.approx(1.0, abs=1.0e-3)


def flexible(*proofs: str) -> dict[str, Any]:
    """Return a flexible boom of boxes with play, and its chart of one length."""
    tables = rigid(*proofs or ("yield",), radii=[5.0, 7.0, 10.0], lengths=[14.0])
    tables["material"]["yield_strength"] = 3.55e8
    plates = {"flange": 0.006, "web": 0.006}
    base, fly = ({"section": {"height": h, "width": 0.7 * h} | plates} for h in (0.4, 0.35))
    tables["segment"] = [BASE | base, {"name": "fly", "length": LENGTHS[1]} | fly]
    tables["gravity"]["acceleration"] = 9.81
    tables["cylinder"][0] |= {"stiffness": 5.0e7, "capacity": 9.0e5}
    tables["joint"] = [JOINT | {"bonded": False, "play": 0.004, "stiffness": 1.0e9}]
    return tables


# The fly is 0.356 m high.
HEAD = {"ahead": 0.5, "below": {"bottom": 0.078}, "level": {"front": 0.4, "below": 0.6}}


@pytest.mark.parametrize("foot", [0.78, -0.2])
@pytest.mark.parametrize(
    ("others", "pin", "off"),
    [
        ({}, (0.0, 0.0), (0.0, 0.0)),
        ({"chassis": CHASSIS, "head": HEAD}, (0.5, 0.1), (0.4 - 0.8, 1.5 - 0.6)),
    ],
)
def test_the_load_hangs_at_the_radius(
    others: dict[str, Any], pin: tuple[float, float], off: tuple[float, float], foot: float
) -> None:
    """Reference: analytic, rotation of the straight boom and its deflection. The pin of the head is
    ahead of and below the tip, the foot pin below the axis; the foot and the load off the pin of
    the head do not turn.
    """
    for cell in cells(deep(flexible() | others, foot), 9.0e5):
        assert cell.tip is not None
        assert cell.angle is not None
        assert cell.tip < -0.02
        x, z = cos(radians(cell.angle)), sin(radians(cell.angle))
        length, lowered = cell.length + pin[0], pin[1] - cell.tip - foot
        loaded = length * x + lowered * z + off[0], length * z - lowered * x + off[1]
        assert loaded == pytest.approx((cell.radius, cell.height), abs=1.0e-5)
        assert cell.droop == pytest.approx(-cell.tip * z, abs=1.0e-5)


def test_the_proved_tip_deflection_is_that_of_its_combination() -> None:
    """Reference: the limit, which the combination without wind meets at the capacity."""
    limit = 0.08
    tables = flexible("deflection") | {"limits": {"tip_at_rest": limit}}
    tables |= {"wind": {"pressure": 200.0, "shape_factor": 1.5, "direction": "front"}}
    tables["combination"][0]["factors"] = {"dead": 1.0, "payload": 1.0, "wind": 0.0}
    case = pt.load_case(tables)
    (several,) = (solve(case, one) for one in run.plan(case, "case"))
    frame = run.Chart(case, [several]).frame
    assert frame["proved tip deflection, m"].values == pytest.approx(limit, rel=1.0e-5)
    assert (abs(frame["tip deflection, m"].values + limit) > 0.001).all()


def test_rows_by_luffing_angle_have_the_capacities_at_their_radii() -> None:
    """Reference: the cells by radius, at the radii of the loaded tip."""
    tables = flexible()
    by_angle = tables["chart"] | {"radii": [], "luffing": [30.0, 60.0]}
    case = pt.load_case(tables | {"chart": by_angle})
    (configuration,) = run.plan(case, "case")
    for cell, angle in zip(solve(case, configuration), (30.0, 60.0), strict=True):
        same = Search(pt.load_case(tables), configuration, cell.radius).cell()
        assert cell.angle == angle
        assert same.capacity == pytest.approx(cell.capacity, rel=1.0e-5)
        assert same.angle == pytest.approx(angle, abs=1.0e-3)


@pytest.mark.parametrize("radius", [6.0, 10.0])
def test_the_drooped_radius_is_near_that_of_elasticas(radius: float) -> None:
    """Reference: analytic, two elasticas with play; small deflections miss (w/L)² of the radius."""
    tables = rigid(radii=[radius], lengths=[14.0])
    del tables["cylinder"]
    tables["gravity"]["acceleration"] = 9.81
    tables["joint"] = [JOINT | {"bonded": False, "play": 0.01, "stiffness": 1.0e10}]
    soft = {"mass_per_length": MASS, "second_moment_of_area": 2.0e-5}
    base = BASE | soft | {"supports": [{"x": 0.0, "kind": "clamped"}]}
    case = pt.load_case(tables | {"segment": [base, tables["segment"][1] | soft]})
    (configuration,) = run.plan(case, "case")
    table, states = Search(case, configuration, radius).point(1000.0)
    assert table.angle is not None
    rods = (Rod(length, 2.1e11 * 2.0e-5, MASS * 9.81) for length in LENGTHS)
    exact = Telescope(*rods, 2.0, 0.01, 1000.0 * 9.81, radians(table.angle)).rest()
    ratio = abs(exact.tip) / 14.0
    assert 0.05 < ratio < 0.2
    assert 0.3 * ratio**2 < radius / exact.radius - 1.0 < 0.9 * ratio**2
    assert states.observed("tip").min() == pytest.approx(exact.tip, rel=2.0 * ratio**2)


def test_cells_without_a_governing_proof() -> None:
    """Reference: by construction, reach, lift and weight of the boom."""
    tables = rigid(largest_payload=10.0, angles=[0.0, 60.0])
    found = cells(tables)
    assert [cell.reason for cell in found] == [
        OUT_OF_REACH, LARGEST, LARGEST, OUT_OF_REACH, OUT_OF_REACH, LARGEST,
    ]  # fmt: skip
    assert [cell.capacity for cell in found] == [None, 10.0, 10.0, None, None, 10.0]
    heavy = cells(tables, capacity=0.1)[1]
    assert heavy.capacity is None
    assert heavy.reason.startswith("cylinder force ")
    assert heavy.reason.endswith("% without payload")
    windy = flexible("cylinder") | {
        "wind": {"pressure": 1e3, "shape_factor": 1.0, "load_area": 90.0}
    }
    windy["combination"][0]["factors"]["wind"] = 1.0
    windy["chart"]["radii"] = [7.0]
    assert {cell.reason for cell in cells(windy, 4.0e5)} == {"cylinder force with any payload"}
    # Its radius is that of the straight boom.
    lying = rigid(radii=[], luffing=[60.0], lengths=[14.0]) | {"chassis": CHASSIS}
    (heavy,) = cells(deep(lying, 0.6), capacity=0.1)
    radius = 14.0 * 0.5 - 0.6 * sin(pi / 3.0) - 0.8
    assert (heavy.capacity, heavy.radius) == (None, pytest.approx(radius))


def test_the_cylinder_force_is_that_under_the_whole_load() -> None:
    """Reference: other input, the load without its ramp."""
    load = {"segment": "fly", "x": "head", "magnitude": -0.5}
    forces = []
    for history in ({}, {"ramp": 0.5}):
        tables = rigid(radii=[6.0], lengths=[9.0])
        tables["load_case"] = [{"name": "lift", "load": [load | history]}]
        (cell,) = cells(tables)
        forces.append(cell.cylinder_force)
    assert forces[0] == pytest.approx(forces[1], rel=1e-6)


def test_configurations() -> None:
    """Reference: by construction, in proportion."""
    shared = [one.extension for one in planned(of_three(lengths=[8.0, 11.0, 17.0]))]
    assert [one["fly"] for one in shared] == pytest.approx([0.0, 2.0, 6.0])
    assert [one["tip"] for one in shared] == pytest.approx([0.0, 1.0, 3.0])
    given = of_three(lengths=[], extensions=[{"fly": 4.0}, {}])
    assert [one.length for one in planned(given)] == pytest.approx([15.0, 17.0])


def test_configurations_follow_the_table_telescoping() -> None:
    """Reference: by construction, strokes of 5.5 and 2.5 m from 0.5 m on, from the tip."""
    order = {"extension": 0.25, "order": "from the tip", "retracted": 0.5}
    tables = of_three(lengths=[9.0, 13.0, 17.0]) | {"telescoping": order}
    found = planned(tables)
    assert [one.extension["tip"] for one in found] == pytest.approx([0.5, 3.0, 3.0])
    assert [one.extension["fly"] for one in found] == pytest.approx([0.5, 2.0, 6.0])
    with pytest.raises(BadInput, match=r"lengths\[1\]: must be from 9 m, with all segments retr"):
        planned(tables | {"chart": tables["chart"] | {"lengths": [8.5]}})
    named = [{"fly": 0.5, "tip": 0.5}, {"fly": 1.5, "tip": 3.0}, {"fly": 6.0, "tip": 3.0}]
    tables["chart"] |= {"lengths": [], "extensions": named}
    parts = tables["chart"] | {"extensions": [], "telescoped": [0.0, "43.75 %", 1.0]}
    assert planned(tables | {"chart": parts}) == planned(tables)
    tables["chart"] |= {"extensions": [{"tip": 1.0}, {}]}
    tables["load_case"][0]["telescoped"] = 0.5
    lengths = [one.length for one in planned(tables)]
    assert lengths == pytest.approx([8.0 + 6.0 + 1.0, 9.0 + 4.0])


LIFT = {"load_case": "lift", "radii": [4.0]}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"chart": LIFT | {"load_case": "x"}},
         "chart.load_case: 'x' is no load case; give 'lift'"),
        ({"chart": {"load_case": "lift"}},
         "chart.radii: give radii, or luffing, the angles in their place"),
        ({"chart": LIFT | {"radii": [15.0]}},
         "chart.radii[1]: must be at most 14 m, the reach of the longest boom, got 15 m"),
        ({"chart": LIFT | {"lengths": [15.0]}},
         "chart.lengths[1]: must be from 8 m, with all segments retracted, to 14 m, got 15 m"),
        ({"chart": LIFT | {"extensions": [{"base": 1.0}]}},
         "chart.extensions[1]: 'base' extends in no joint; give 'fly'"),
        ({"chart": LIFT | {"telescoped": [0.5], "lengths": [9.0]}},
         "chart.lengths: telescoped is given; leave one of them out"),
        ({"chart": LIFT | {"combinations": ["B"]}},
         "chart.combinations: 'B' is no combination; give 'A'"),
        ({"combination": []},
         "chart.combinations: no combination has the payload of 'lift'; "
         "its proofs limit the chart"),
        ({"combination": rigid("tipping")["combination"]},
         "combination[1].proofs: tipping needs the tipping lines of a chassis; give [chassis]"),
        ({"gravity": None}, "gravity: missing; the payload of a chart weighs by it"),
        ({"chart": None}, "chart: missing; give its load_case and radii"),
    ],
)  # fmt: skip
def test_bad_charts(changes: dict[str, Any], message: str) -> None:
    """Reference: exact words."""
    with refused(f"case: {message}"):
        planned({key: value for key, value in (rigid() | changes).items() if value is not None})


def test_outrigger_forces() -> None:
    """Reference: analytic, a rigid plate on four springs, of which one may lift, in a full turn."""
    chassis = Chassis(**CHASSIS)
    corners = np.array([[x, y] for x in (2.5, -2.2) for y in (2.4, -2.4)])
    for load in (0.02, 0.3):
        weights = [CraneForce(load, 4.0), CraneForce(0.03, 1.0, 0.005, 8.0)]
        radius = sum(one.overturning(0.0) for one in weights) - 2000.0 * G * 2.0
        down = sum(one.down for one in weights) + (12000.0 + 2000.0) * G
        largest = np.zeros(4)
        for turn in np.linspace(0.0, 2.0 * np.pi, 3601):
            moment = radius * np.array([np.cos(turn), np.sin(turn)]) + [12000.0 * G * 0.3, 0]
            largest = np.maximum(largest, plate(corners, np.array([down, *moment])))
        found = dict(chassis.outrigger_forces(weights, G))
        expected = {"front": largest[:2].max(), "rear": largest[2:].max()}
        assert {key: found[key] for key in expected} == pytest.approx(expected, rel=1.0e-5)


def plate(corners: Array, resultant: Array) -> Array:
    """Return the forces of equal springs under a rigid plate; a spring that would pull lifts."""
    held = np.ones(4, dtype=bool)
    while True:
        shape = np.vstack([np.ones(4), corners.T])[:, held]
        forces = np.zeros(4)
        forces[held] = shape.T @ np.linalg.solve(shape @ shape.T, resultant)
        if (forces >= -1.0e-9).all():
            return forces
        held[forces.argmin()] = False


def test_table_page_and_files(tmp_path: Path) -> None:
    """Reference: by construction, the governing letters, and the anchors of cells."""
    case = weak(pt.load_case(rigid(largest_payload=20000.0)))
    chart, again = (
        run.solve_all(case, run.plan(case, "case"), None, Cache(tmp_path / "cache")) for _ in "12"
    )
    assert again.cells == chart.cells
    output.write(chart, tmp_path / "chart", False)
    names = {path.name for path in (tmp_path / "chart").rglob("*")}
    assert {"chart.csv", "chart.html", "over-radius.png", "range.png"} <= names
    text = (tmp_path / "chart" / "chart.html").read_text("utf-8")
    assert text.count('<section class="cell"') == 6
    assert 'href="#cell-1-1"' in text
    table = output.chart_table(chart)
    assert table.headings == ("radius\nm", "9 m", "14 m")
    assert {row[1][-1] for row in table.rows} <= {"L", "M"}
    assert table.notes[1:] == []
    jack = replace(case.cylinders[0], capacity=None, bore=0.2, rod=0.1)
    bare = case.model_copy(update={"cylinders": (jack,)})
    notes = output.chart_table(run.Chart(bare, chart.cells)).notes
    assert notes[1].startswith("Oil pressure of the cylinder is not proved: it has no `pressure`.")
    far = replace(chart.cells[1][0], tip=-1.4)
    assert (
        "At 14 m and a radius of 4 m the rated load deflects the tip by 10 % of the boom's length: "
        "small displacements make it about 1.1 % too large, and moments about 0.65 %."
    ) in output.chart_table(run.Chart(case, [chart.cells[0], [far]])).notes


@pytest.mark.slow
def test_a_shell_agrees_at_the_capacity_of_beams() -> None:
    """Reference: other code, a shell of the flexible boom."""
    tables = flexible("cylinder")
    tables["chart"]["radii"] = [10.0]
    tables["model"].append({"name": "shell", "kind": "shell", "mesh_size": 0.4})
    case = weak(pt.load_case(tables), 2.0e5)
    context = BuildContext(single_rank(1))
    for cell in run.chart(case).cells[0]:
        one = run.Chart(case, [[cell]])
        ((_, row),) = run.utilisations_by_shell(one, case.models[1], context)
        assert row.utilisation == pytest.approx(1.0, abs=5.0e-3)
