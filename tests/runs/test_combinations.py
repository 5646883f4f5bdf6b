# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static results under the largest loads, in load cases and combinations, and of motions."""

from math import cos, hypot, radians, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

import protractile as pt
from protractile.analysis.measure import measure_boom
from protractile.analysis.model import section_forces
from protractile.analysis.rows import COMBINATION, FARTHEST, Row, Rows, extremes, static_rows
from protractile.analysis.states import States
from protractile.analysis.stresses import Fibres, outer_corners
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.lines import lines
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.statics import static_state
from protractile.runs.case.amounts import convert_to_si
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import CheckedCase
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.response import utilisations
from protractile.runs.check import check_case
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.combinations import combination_rows
from protractile.runs.pipeline.pad_walls import largest_tip, wall_part
from protractile.runs.pipeline.statics import boom_with_play, reaction_rows, statics
from protractile.runs.report.load_table import load_table
from protractile.runs.report.static_tables import combination_tables, row_name
from studies.reference_models.statics import static_response
from tests.booms import cantilever, force
from tests.runs.case_texts import CLAMPED, HINGED, box, elements, joint, read_case, refusal, table
from tests.runs.case_texts import STEEL as STEEL_TABLE
from tests.runs.summaries import finished, printed_check

G = 9.80665
# A stiff lift of two boxes, so that deflections hardly change lever arms.
HEIGHT, WIDTH, WALL = 0.30, 0.22, 0.006
CAGE, PEOPLE, WIND = 150.0, 230.0, 900.0
LUG, DEPTH, GROUND = 2.4, 0.25, (0.7, -1.1)
ENDS = {"stations": ["tail", "head"]}
PAD = {"length": 0.1, "width": 0.05, "thickness": 0.012, "bears": "corner"}
LIFT = f"""
title = "A lift of two boxes"
time = {{ duration = 1.0 }}
gravity = {{ angle = 45.0 }}
payload = {{ mass = {CAGE}, group = "dead" }}
cylinder = [
  {{ segment = "base", x = {LUG}, depth = {DEPTH}, ground = {list(GROUND)}, stiffness = 3e7 }},
]
material = {{ youngs_modulus = 9e11, poissons_ratio = 0.3, density = 7850.0 }}
model = [{{ name = "beam", kind = "finite-element", theory = "timoshenko" }}]
load = [{{ segment = "fly", x = "head", magnitude = -1595.0, ramp = 0.1 }}]
{box("base", 6.0, (HEIGHT, WIDTH, WALL, WALL), HINGED)}
{box("fly", 5.0, (0.25, 0.18, WALL, WALL))}
{table("[[joint]]", outer="base", inner="fly", extension=4.0, **ENDS, play=0.003, pad=PAD)}
"""
CASES = table("[[load_case]]", name="raised", payload=PEOPLE, load=[]) + table(
    "[[load_case]]", name="level", angle=0.0, extension={"fly": 2.0}, payload=PEOPLE,
    load=[{"segment": "fly", "x": "head", "magnitude": -WIND, "group": "wind"}],
)  # fmt: skip
FACTORS = table(
    "[[combination]]", name="A", factors={"dead": [1.2, 1.1], "payload": 1.34, "wind": 0.0}
) + table(
    "[[combination]]", name="B", load_cases=["level"],
    factors={"dead": 0.0, "payload": 1.1, "wind": 1.22},
)  # fmt: skip


def results(folder: Path, text: str) -> dict[str, dict[tuple[str, str, str], Row]]:
    """Return the rows of each combination by quantity, part and place."""
    found: dict[str, dict[tuple[str, str, str], Row]] = {}
    for row in combination_rows(read_case(folder, text)):
        found.setdefault(row.state.removeprefix(COMBINATION), {})[row.key] = row
    return found


TIP, CYLINDER = ("tip", "tip", ""), ("cylinder_force", "cylinder", "")


def ground_at_45() -> tuple[float, float]:
    """Return x and z of the ground end of the cylinder in upright axes."""
    return (GROUND[0] - GROUND[1]) * sqrt(0.5), (GROUND[0] + GROUND[1]) * sqrt(0.5)


def by_hand(angle: float, extension: float, dead: float, people: float, wind: float) -> float:
    """Return the force of the cylinder in N, from moments about the pin, in upright axes."""
    turn = radians(angle)
    moment = wind * (6.0 + extension)
    for height, width, length, start in (
        (HEIGHT, WIDTH, 6.0, 0.0), (0.25, 0.18, 5.0, 1.0 + extension),
    ):  # fmt: skip
        mass = 7850.0 * 2.0 * WALL * (height + width) * length
        moment += dead * mass * G * (start + 0.5 * length) * cos(turn)
    moment += (dead * CAGE + people * PEOPLE) * G * (6.0 + extension) * cos(turn)
    # The ground end stays where it is at 45 degrees; the lug moves with the boom.
    x0, z0 = ground_at_45()
    x1, z1 = LUG * cos(turn) + DEPTH * sin(turn), LUG * sin(turn) - DEPTH * cos(turn)
    arm = (x1 * (z1 - z0) - z1 * (x1 - x0)) / hypot(x1 - x0, z1 - z0)
    return moment / arm


def test_cylinder_pads_and_foot_of_a_lift_in_combinations(tmp_path: Path) -> None:
    """Reference: analytic, moments about the pin, with wall areas of mid-lines."""
    found = results(tmp_path, LIFT + CASES + FACTORS)
    assert [*found] == ["A, raised", "A, level", "B, level"]
    for name, numbers in (
        ("A, raised", (45.0, 4.0, 1.32, 1.34, 0.0)),
        ("A, level", (0.0, 2.0, 1.32, 1.34, 0.0)),
        ("B, level", (0.0, 2.0, 0.0, 1.1, 1.22 * WIND)),
    ):
        # Deflections change lever arms at 45 degrees by less than 0.5 %.
        force = found[name][CYLINDER].value
        assert force == pytest.approx(by_hand(*numbers), rel=5e-3 if "raised" in name else 1e-4)
    # The lever rule on the level fly between the centres of its pads, two of 0.1 m x 0.05 m.
    level = found["B, level"]
    tip = 1.1 * PEOPLE * G + 1.22 * WIND
    for place, lever in (("station 1, above", 2.05), ("station 2, below", 4.95)):
        pressure = 0.5 * tip * lever / 2.9 / 0.005
        assert level["pad_pressure", "fly", place].value == pytest.approx(pressure, rel=1e-4)
    # The pin takes what the cylinder pushes, less the loads at the tip.
    x0, z0 = ground_at_45()
    across, along = -DEPTH - z0, LUG - x0
    push = by_hand(0.0, 2.0, 0.0, 1.1, 1.22 * WIND) / hypot(across, along)
    foot = level["foot_reaction", "base", "at 0 m"]
    assert foot.value == pytest.approx(hypot(push * across - tip, push * along), rel=1e-4)


def test_load_cases_alone_have_unit_factors(tmp_path: Path) -> None:
    """Reference: a separate case of the same boom."""
    found = results(tmp_path, LIFT + CASES)
    assert [*found] == ["raised", "level"]
    alone = LIFT.replace("-1595.0", "0.0").replace(f"mass = {CAGE}", f"mass = {CAGE + PEOPLE}")
    other = results(tmp_path, alone + '[[load_case]]\nname = "same"\n')["same"]
    for key, one in found["raised"].items():
        assert one.value == pytest.approx(other[key].value, rel=1e-12)


def test_without_gravity_the_payload_alone_weighs(tmp_path: Path) -> None:
    """Reference: analytic, the force at the tip."""
    text = LIFT.replace("gravity = { angle = 45.0 }\n", "") + FACTORS.replace("0.0, p", "1.0, p")
    text = text.replace('load_cases = ["level"]\n', "").replace('group = "dead"', 'group = "test"')
    text = text.replace("wind = 1.22", "test = 3.0").replace("wind = 0.0", "test = 2.0")
    found = results(tmp_path, text)
    arm = LUG * (-DEPTH - GROUND[1]) + DEPTH * (LUG - GROUND[0])
    arm /= hypot(LUG - GROUND[0], -DEPTH - GROUND[1])
    for name, payload, test in (("A", 1.34, 2.0), ("B", 1.1, 3.0)):
        force = 10.0 * (test * CAGE * G + payload * 1595.0) / arm
        assert found[name][CYLINDER].value == pytest.approx(force, rel=1e-3)


def test_load_cases_in_millimetres_and_from_files(tmp_path: Path) -> None:
    """Reference: non-regression, the same case in SI units. The file has the constant load."""
    (tmp_path / "wind.csv").write_text("0,1\n1,1\n", encoding="utf-8")
    text = LIFT + CASES
    filed = text.replace('group = "wind"', 'group = "wind", file = "wind.csv"')
    own, other = (results(tmp_path, each)["level"][TIP].value for each in (filed, text))
    assert own == pytest.approx(other, rel=1e-12)
    case = read_case(tmp_path, text).model_copy(update={"units": "mm-t-s"})
    level = convert_to_si(case).load_cases[1]
    assert (level.extension, level.payload) == ({"fly": 0.002}, 1.0e3 * PEOPLE)


def test_check_marks_the_governing_combination(tmp_path: Path) -> None:
    case = read_case(tmp_path, LIFT + CASES + FACTORS)
    found = combination_rows(case)
    first, envelope = combination_tables(found, case)
    lowest = min(found.where(quantity="tip"), key=lambda row: row.value)
    marked = dict(zip(first.columns[0].cells, first.columns[1].text, strict=True))
    governing = lowest.state.removeprefix(COMBINATION)
    assert [name for name, tip in marked.items() if "*" in tip] == [governing]
    cells = {row[0]: row[1:] for row in envelope.rows}
    assert cells["tip"][2] == governing
    of_pads = found.where(quantity="pad_pressure")
    named = {(row.state.removeprefix(COMBINATION), row_name(row, case.system)) for row in of_pads}
    pads = [name for name in cells if name.startswith("pad, fly at ")]
    assert len(pads) == 2
    assert all((cells[name][2], name) in named for name in pads)
    assert envelope.notes == [
        "Pads and contacts move with the extension; x is given for the governing combination."
    ]
    text = printed_check(case, 80)
    assert "Largest results of each combination" in text
    assert max(map(len, text.splitlines())) <= 80


OF_GROUP = "is of this group; give its factor, 0 where it does not act"
BAD = {
    f"combination[2].factors.dead: missing, and the weight of the boom {OF_GROUP}":
        ("dead = 0.0, ", ""),
    f"combination[2].factors.payload: missing, and the payload of 'level' {OF_GROUP}":
        ("payload = 1.1, ", ""),
    f"combination[2].factors.wind: missing, and load[1] {OF_GROUP}": (", wind = 1.22", ""),
    "combination[2].load_cases: 'low' is no load case; give 'raised' or 'level'":
        ('["level"]', '["low"]'),
    "load_case[2].extension.mid: no joint has 'mid' as inner segment; give 'fly'":
        ("fly = 2.0", "mid = 2.0"),
    "load_case[2].joint[1].extension: must be at least 0 m and below 5 m, so that 'fly' begins in "
    "'base', got 9 m": ("fly = 2.0", "fly = 9.0"),
    "load_case[2].angle: the case has no table gravity, whose angle it replaces":
        ("gravity = { angle = 45.0 }\n", ""),
}  # fmt: skip


@pytest.mark.parametrize("line", BAD)
def test_bad_combinations(tmp_path: Path, line: str) -> None:
    """Reference: exact words."""
    assert refusal(tmp_path, (LIFT + CASES + FACTORS).replace(*BAD[line])) == line


# Depth of outer fibres and second moment of area of the boxes below.
ARM, FLY = (0.40, 0.30, 0.008, 0.006), (0.36, 0.26, 0.006, 0.005)
OF_PADS = "pad = { length = 0.2, width = 0.05, allowable_pressure = 1e6 }"
RAMP = '[[load]]\nsegment = "fly"\nx = "head"\nmagnitude = -2000.0\nramp = 0.1\n'
STEP = RAMP.replace("ramp = 0.1\n", "")
SINE = '[[load]]\nsegment = "arm"\nx = 6.0\nmagnitude = 500.0\nfrequency = 2.0\n'


def boom_of(loads: str, of_joint: str = OF_PADS) -> str:
    return (
        f'title = "Two boxes"\n[time]\nduration = 1.0\n{STEEL_TABLE}yield_strength = 3e8\n'
        + box("arm", (0.0, 8.0), ARM, CLAMPED)
        + box("fly", (6.0, 14.0), FLY)
        + joint("fly", "arm", 0.004, (6.0, 8.0), of_joint)
        + loads
        + elements("beam", theory="timoshenko")
    )


def states_of(case: pt.Case) -> States:
    return static_states(case, boom_with_play(case, build_boom(case)))


def test_largest_values_of_a_sine_and_a_ramp(tmp_path: Path) -> None:
    """Reference: analytic, the sum at three quarters of the sine's period, also as a limit."""
    inertia = build_boom(read_case(tmp_path, boom_of(RAMP))).segments[0].second_moment_of_area
    rows = Rows(static_rows(states_of(read_case(tmp_path, boom_of(RAMP + SINE))), "beam"))
    (arm,) = rows.where(state="rest", quantity="stress", part="arm")
    assert arm.time == pytest.approx(0.375)
    moment = 2000.0 * 14.0 + 500.0 * 6.0
    assert abs(arm.value) == pytest.approx(moment * 0.204 / inertia, rel=1e-6)
    limits = "[limits]\nstress = 2e7\npad_pressure = 2e6\nwall_stress = 2e8\n"
    case = read_case(tmp_path, boom_of(RAMP) + limits)
    stress = f"{1e-6 * 2000.0 * 14.0 * 0.204 / inertia:.4g} MPa"
    pressure = f"{1e-6 * 2000.0 * (14.0 - 6.1) / 1.8 / 0.02:.4g} MPa"
    assert [line for line in check_case(CheckedCase(case)).lines if "imit " in line] == [
        "caution: the limit bending stress ≤ 20 MPa is exceeded: the static bending stress "
        f"(maximum load) is {stress}",
        "Limit local plate stress ≤ 200 MPa: a run decides.",
        f"Limit pad pressure ≤ 2 MPa: the static pad pressure (maximum load) is {pressure}, and "
        "the motion adds to it; a run decides.",
    ]


def test_overloads_are_cautions(tmp_path: Path) -> None:
    """Reference: exact messages, with pressures above 0.1 MPa by the lever rule."""
    case = read_case(tmp_path, boom_of(STEP, OF_PADS.replace("1e6", "1e5")))
    rows = Rows(static_rows(states_of(case), "beam"))
    start, end = (
        "static utilisation under the loads at t = 0 s: ",
        ": exceeds the allowable pressure",
    )
    assert [*utilisations(Context(case, build_boom(case), rows=rows))] == [
        f"{start}339 % by pad pressure (fly, x = 6 m){end}",
        f"{start}439 % by pad pressure (fly, x = 8 m){end}",
    ]


def test_a_joint_rotates_by_its_play_and_by_walls(tmp_path: Path) -> None:
    """Reference: by hand, 4 mm of play over 1.8 m between the centres of pads, and the share of
    walls in the tip, which :func:`wall_part` computes by rigid walls.
    """
    case = read_case(tmp_path, boom_of(RAMP))
    beam = states_of(case)
    found = Rows(extremes(measure_boom(beam.farthest), "beam", FARTHEST))
    (tilted,), (tip,) = (found.where(quantity=name) for name in ("rotation_tip", "tip"))
    part = wall_part(case, beam)
    assert part is not None
    play, walls = 0.002 - 0.004 / 1.8 * (14.0 - 6.1), part * tip.value
    assert walls < -0.002
    assert tilted.value == pytest.approx(play + walls, abs=1e-4)


def test_pads_on_corners_bend_no_wall(tmp_path: Path) -> None:
    """Reference: analytic, the static tip with rigid walls."""
    for bears in ("wall", "corner"):
        case = read_case(tmp_path, boom_of(RAMP, OF_PADS.replace("}", f', bears = "{bears}" }}')))
        boom = boom_with_play(case, build_boom(case))
        time, tip = largest_tip(static_states(case, boom))
        rigid = static_state(boom, walls=0.0, time=time).tip
        assert (tip == pytest.approx(rigid, rel=1e-6)) == (bears == "corner")
        shown = " ".join(printed_check(case).split())
        # The walls that may buckle are a table of their own.
        assert ("walls under pads" in shown or "rigid walls" in shown) == (bears == "wall")


@pytest.mark.slow
def test_a_joint_of_a_shell_rotates_by_walls(tmp_path: Path) -> None:
    """Reference: other code path, the difference of the tips if pads bear beside the middle of the
    flange or on the corners.
    """
    pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")
    keys = {"kind": "shell", "mesh_size": 0.4, "contact_tolerance": "any"}
    shell, found = table("[[model]]", name="shell", **keys), {}
    for bears in ("offset = 0.05", 'bears = "corner"'):
        text = boom_of(STEP, OF_PADS.replace("}", f", {bears} }}")) + shell
        rows = pt.run_case(read_case(tmp_path, text), ["shell"]).rows
        for name in ("tip", "rotation_tip"):
            (row,) = rows.where(state="initial", play=True, quantity=name)
            found.setdefault(name, []).append(row.value)
    tips, rotated = (np.array(values) for values in found.values())
    assert tips[0] < 1.1 * tips[1]
    assert rotated[0] - rotated[1] == pytest.approx(tips[0] - tips[1], rel=0.03)


def test_statics_include_a_released_load_up_to_its_release(tmp_path: Path) -> None:
    """Reference: other input, the same load by a table that falls to 0 after t = 0."""
    ways = ("released = true\n", "table = [[0.0, 1.0], [1e-3, 0.0]]\n")
    cases = [read_case(tmp_path, boom_of(STEP.replace("2000", "500") + STEP + way)) for way in ways]
    released, fallen = (static_rows(states_of(case), "beam") for case in cases)
    for one, other in zip(released, fallen, strict=True):
        assert (one.state, one.key, one.time) == (other.state, other.key, other.time)
        assert one.value == pytest.approx(other.value, rel=1e-9, abs=1e-9)
    static = statics(cases[0], build_boom(cases[0]))
    assert static is not None
    rows = Rows(reaction_rows(static.with_play)).where(quantity="reaction")
    forces = [row.value for row in rows if not row.place.startswith("contact")]
    assert sum(forces) == pytest.approx(2500.0, rel=1e-6)


def test_loads_are_listed_with_their_largest_values(tmp_path: Path) -> None:
    """Reference: the numbers of the case, and the weight of its masses by hand."""
    loads = (
        RAMP + SINE + '[[load]]\nsegment = "fly"\nfrom = 7.0\nto = 9.0\nmagnitude = -100.0\n'
        "table = [[0.0, 0.0], [0.5, -2.0], [1.5, 9.0]]\n"
        '[[load]]\nsegment = "fly"\nx = 9.0\nmagnitude = 50.0\nmoment = true\nreleased = true\n'
        "[payload]\nmass = 100.0\n[gravity]\nangle = 30.0\n"
        "[[base]]\nacceleration = 0.5\nramp = 2.0\n[[axial]]\nforce = 3e3\n"
    )
    case = read_case(tmp_path, boom_of(loads).replace("supports", "load = -20.0\nsupports"))
    boom = build_boom(case)
    mass = (
        7850.0 * 8.0 * (2.0 * (0.30 * 0.008 + 0.40 * 0.006 + 0.26 * 0.006 + 0.36 * 0.005)) + 100.0
    )
    weight = 9.80665 * mass
    assert load_table(case, boom).rows == [
        ("gravity", "all masses", "z", "constant", f"−{weight * 0.75**0.5:.0f} N", ""),
        ("gravity", "all masses", "to the base", "constant", f"{0.5 * weight:.0f} N", ""),
        ("segment[1].load", "arm", "z", "constant", "−20 N/m", ""),
        ("load[1]", "fly at 14 m", "z", "ramp of 0.1 s", "−2000 N", "0.1"),
        ("load[2]", "arm at 6 m", "z", "sine of 2 Hz", "500 N", "0.125"),
        ("load[3]", "fly, 7–9 m", "z", "3 values", "−350 N/m", "1"),
        ("load[4]", "fly at 9 m", "z, moment", "until t = 0", "50 N m", ""),
        ("base[1]", "all masses", "z", "ramp of 2 s", "0.25 m/s²", "1"),
        ("axial[1]", "fly at 14 m", "to the base", "constant", "3000 N", ""),
    ]


CASE = f"""
title = "A cantilever, loaded suddenly"
time = {{ duration = 0.5, output_step = 1e-3 }}
{STEEL_TABLE}
yield_strength = 3e8
{box("arm", (0.0, 10.0), ARM, CLAMPED)}
load = -1000.0
"""


def test_sudden_load_doubles_the_static_results(tmp_path: Path) -> None:
    """Reference: analytic. One coordinate: twice the static result after half a period."""
    series = table("[[model]]", name="one", kind="kantorovich", terms=[1], base="complete")
    found = finished(read_case(tmp_path, CASE + series)).results
    frequency = found.rows.where(state="initial", quantity="frequency")[0].value
    peaks = found.rows.where(state="motion", quantity=["tip", "bending_moment", "stress"])
    assert len(peaks) == 3
    for peak in peaks:
        assert found.rows.dynamic_factor(peak) == pytest.approx(2.0, rel=2e-4)
        assert peak.time * frequency % 1.0 == pytest.approx(0.5, abs=0.01)
    low, high = (
        found.curves.where(state=state)[0].values["deflection"] for state in ("minimum", "maximum")
    )
    (tip,) = found.rows.where(state="rest", quantity="tip")
    assert low[-1] == pytest.approx(2.0 * tip.value, rel=2e-4)
    assert high[-1] == pytest.approx(0.0, abs=1e-12)
    (fibre,) = (peak for peak in peaks if peak.quantity == "stress")
    assert (fibre.x, abs(fibre.z or 0.0)) == (0.0, pytest.approx(0.204))
    assert fibre.utilisation == pytest.approx(abs(fibre.value) / 3e8)


def test_outer_corners_lie_on_the_outer_surfaces() -> None:
    """Reference: by hand, half a thickness beyond the mid-lines, at most so for a hexagon."""
    y, z = outer_corners(pt.BoxSection(height=0.4, width=0.3, flange=0.008, web=0.006))
    np.testing.assert_allclose(np.abs(y), 0.153)
    np.testing.assert_allclose(np.abs(z), 0.204)
    six = pt.hexagon(0.4, 0.3, flat=0.2, top=0.006, bottom=0.006, web=0.006)
    y, z = outer_corners(six)
    assert np.abs(z).max() == pytest.approx(0.203)
    assert 0.15 < np.abs(y).max() < 0.153


def test_fibres_of_a_taper_are_those_of_the_local_section() -> None:
    """Reference: by hand, −P/A and M z/J of boxes of 0.4, 0.3 and 0.2 m under 10 kN and 1 N."""
    tail, head = (pt.BoxSection(height, 0.2, 0.01, 0.008) for height in (0.4, 0.2))
    boom = cantilever(force("arm", 8.0, -1.0), thrust=1e4, section=tail, head_section=head)
    models = finite_element_segments(boom, 0.5, "euler-bernoulli", rotary_inertia=False)
    system = gap_system(boom, models).gather_loads()
    (line,) = lines(boom, models)
    fibres = Fibres.of(boom.segments[0], line)
    forces = section_forces(boom, 0, line, static_response(system, system.load), np.zeros(()))
    for x, height in ((4.0, 0.3), (2.0, 0.35)):
        box, at = pt.BoxSection(height, 0.2, 0.01, 0.008), int(np.argmax(line.x == x))
        assert fibres.of_normal[at] == pytest.approx(1.0 / box.area, rel=1e-12)
        top = int(fibres.z[:, at].argmax())
        assert fibres.z[top, at] == pytest.approx(0.5 * height + 0.005, rel=1e-12)
        bending = (8.0 - x) * (0.5 * height + 0.005) / box.second_moment_of_area
        # Second order adds to the moment of the load.
        found = fibres.stress(top, forces)[at] + 1e4 / box.area
        assert found == pytest.approx(bending, rel=0.02)
