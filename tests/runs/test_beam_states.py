# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static results under the largest loads, and the largest results of a motion."""

from pathlib import Path

import numpy as np
import pytest

from protractile.analysis.curves import HIGH, LOW
from protractile.analysis.measure import measure_boom
from protractile.analysis.model import section_forces
from protractile.analysis.rows import (
    FARTHEST,
    INITIAL,
    MOTION,
    REST,
    Row,
    Rows,
    extremes,
    static_rows,
)
from protractile.analysis.states import States
from protractile.analysis.stresses import Fibres, outer_corners
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.lines import lines
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.statics import static_state
from protractile.cases import run_case
from protractile.dynamics.excitation import Step
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, Load, Material, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.profiles import hexagon
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import CheckedCase, convert_to_si
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.response import deflections, utilisations
from protractile.runs.check import check_case
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.pad_walls import largest_tip, wall_part
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.statics import boom_with_play, reaction_rows, statics
from protractile.runs.report.load_table import load_table
from protractile.runs.report.static_tables import static_table
from studies.reference_models.statics import static_response
from tests.runs.case_texts import (
    CLAMPED,
    STEEL,
    box,
    elements,
    joint,
    read_case,
    shipped,
    table,
)
from tests.runs.summaries import finished, printed_check

# Depth of outer fibres and second moment of area of the boxes below.
ARM, FLY = (0.40, 0.30, 0.008, 0.006), (0.36, 0.26, 0.006, 0.005)
PAD = "pad = { length = 0.2, width = 0.05, allowable_pressure = 1e6 }"
RAMP = '[[load]]\nsegment = "fly"\nx = "head"\nmagnitude = -2000.0\nramp = 0.1\n'
SINE = '[[load]]\nsegment = "arm"\nx = 6.0\nmagnitude = 500.0\nfrequency = 2.0\n'


def boom_of(loads: str, of_joint: str = PAD) -> str:
    return (
        f'title = "Two boxes"\n[time]\nduration = 1.0\n{STEEL}yield_strength = 3e8\n'
        + box("arm", (0.0, 8.0), ARM, CLAMPED)
        + box("fly", (6.0, 14.0), FLY)
        + joint("fly", "arm", 0.004, (6.0, 8.0), of_joint)
        + loads
        + elements("beam", theory="timoshenko")
    )


def states_of(case: Case) -> States:
    return static_states(case, boom_with_play(case, build_boom(case)))


def rows_of(folder: Path, text: str) -> Rows:
    return Rows(static_rows(states_of(read_case(folder, text)), "beam"))


def largest(rows: Rows, quantity: str, part: str, place: str = "") -> Row:
    """Return the row of a result under the largest loads."""
    (row,) = rows.where(state=REST, quantity=quantity, part=part, place=place)
    return row


def test_stresses_and_pads_under_a_ramp(tmp_path: Path) -> None:
    """Reference: analytic, lever rule between the centres of pads, and M z/J of the boxes."""
    case = read_case(tmp_path, boom_of(RAMP))
    found = rows_of(tmp_path, boom_of(RAMP))
    table = static_table(case, build_boom(case), found)
    assert table.columns[0].cells == [
        "tip", "stress, arm at 0 m", "stress, fly at 7.9 m",
        "pad, fly at 6 m, above", "pad, fly at 8 m, below",
    ]  # fmt: skip
    for segment, sizes, lever in zip(
        build_boom(case).segments, (ARM, FLY), (14.0, 6.1), strict=True
    ):
        one = largest(found, "stress", segment.name)
        fibre = 0.5 * (sizes[0] + sizes[2])
        stress = 2000.0 * lever * fibre / segment.second_moment_of_area
        assert abs(one.value) == pytest.approx(stress, rel=1e-6)
        assert one.utilisation == pytest.approx(stress / 3e8, rel=1e-6)
        (initial,) = found.where(state=INITIAL, quantity="stress", part=segment.name)
        assert (initial.value, one.time) == (pytest.approx(0.0, abs=1.0), 0.1)
    for place, lever in (("station 1, above", 6.1), ("station 2, below", 7.9)):
        one = largest(found, "pad_pressure", "fly", place)
        # Two pads of 0.2 m x 0.05 m share the force of a side.
        pressure = 0.5 * 2000.0 * lever / 1.8 / 0.01
        assert one.value == pytest.approx(pressure, rel=1e-6)
        assert one.utilisation == pytest.approx(pressure / 1e6, rel=1e-6)


def test_largest_values_of_a_sine_and_a_ramp(tmp_path: Path) -> None:
    """Reference: analytic, the sine at a quarter of its period, and the sum at three quarters."""
    arm = largest(rows_of(tmp_path, boom_of(RAMP + SINE)), "stress", "arm")
    inertia = build_boom(read_case(tmp_path, boom_of(RAMP))).segments[0].second_moment_of_area
    assert arm.time == pytest.approx(0.375)
    moment = 2000.0 * 14.0 + 500.0 * 6.0
    assert abs(arm.value) == pytest.approx(moment * 0.204 / inertia, rel=1e-6)


def test_of_equal_extremes_the_first_counts() -> None:
    """Reference: analytic. Lateral loads after t = 0 change no vertical force of this arm."""
    case = shipped("inspection-arm")
    states = states_of(case)
    pads = Rows(static_rows(states, "beam")).where(state=REST, quantity="pad_pressure")
    upright = [row for row in pads if row.value and "lateral" not in row.place]
    assert states.time.size > 2
    assert [row.time for row in upright] == [0.0] * 4


def test_overloads_are_cautions(tmp_path: Path) -> None:
    """Reference: exact messages, with pressures above 0.1 MPa by the lever rule."""
    text = boom_of(RAMP.replace("ramp = 0.1\n", ""), PAD.replace("1e6", "1e5"))
    found = rows_of(tmp_path, text)
    far = largest(found, "tip", "tip")._replace(value=-2.38, time=0.25)
    case = read_case(tmp_path, text)
    rows = Rows([far, *(row for row in found if row.quantity != "tip")])
    context = Context(case, build_boom(case), rows=rows)
    assert [*deflections(context), *utilisations(context)] == [
        "under the loads at t = 0.25 s the tip rests at -2.38 m, 17 % of the boom's length: small "
        "displacements make it about 3.2 % too large, and moments about 1.9 %; check units and "
        "loads",
        "static utilisation under the loads at t = 0 s: 339 % by pad pressure (fly, "
        "x = 6 m): exceeds the allowable pressure",
        "static utilisation under the loads at t = 0 s: 439 % by pad pressure (fly, "
        "x = 8 m): exceeds the allowable pressure",
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
    tips = {}
    for bears in ("wall", "corner"):
        case = read_case(tmp_path, boom_of(RAMP, PAD.replace("}", f', bears = "{bears}" }}')))
        boom = boom_with_play(case, build_boom(case))
        time, tip = largest_tip(static_states(case, boom))
        tips[bears] = tip, static_state(boom, walls=0.0, time=time).tip
        shown = " ".join(printed_check(case).split())
        # The walls that may buckle are a table of their own.
        assert ("walls under pads" in shown or "rigid walls" in shown) == (bears == "wall")
    tip, rigid = tips["corner"]
    assert tip == pytest.approx(rigid, rel=1e-6)
    assert tips["wall"][0] < 1.01 * tips["wall"][1]


@pytest.mark.slow
def test_a_joint_of_a_shell_rotates_by_walls(tmp_path: Path) -> None:
    """Reference: other code path, the difference of the tips if pads bear beside the middle of the
    flange or on the corners.
    """
    pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")
    shell = (
        '[[model]]\nname = "shell"\nkind = "shell"\nmesh_size = 0.2\ncontact_tolerance = "any"\n'
    )
    tips, rotated = [], []
    for bears in ("offset = 0.05", 'bears = "corner"'):
        text = boom_of(RAMP.replace("ramp = 0.1\n", ""), PAD.replace("}", f", {bears} }}"))
        run = run_case(read_case(tmp_path, text + shell), ["shell"])
        at_start = run.rows.where(model="shell", state=INITIAL, play=True)
        (tip,), (tilted,) = (at_start.where(quantity=name) for name in ("tip", "rotation_tip"))
        tips.append(tip.value)
        rotated.append(tilted.value)
    assert tips[0] < 1.1 * tips[1]
    assert rotated[0] - rotated[1] == pytest.approx(tips[0] - tips[1], rel=0.03)


def test_statics_include_a_released_load_up_to_its_release(tmp_path: Path) -> None:
    """Reference: other input, the same load by a table that falls to 0 after t = 0; its weight."""
    weight = '[[load]]\nsegment = "fly"\nx = "head"\nmagnitude = -500.0\n'
    load = weight.replace("500", "1500")
    ways = ("released = true\n", "table = [[0.0, 1.0], [1e-3, 0.0]]\n")
    texts = [boom_of(weight + load + way) for way in ways]
    released, fallen = (rows_of(tmp_path, text) for text in texts)
    for one, other in zip(released, fallen, strict=True):
        assert (one.state, one.key, one.time) == (other.state, other.key, other.time)
        assert one.value == pytest.approx(other.value, rel=1e-9, abs=1e-9)
    case = read_case(tmp_path, texts[0])
    boom = build_boom(case)
    note = "Static results at t = 0 are those before the release."
    assert note in static_table(case, boom, released).notes
    static = statics(case, boom)
    assert static is not None
    forces = [
        row.value
        for row in reaction_rows(static.with_play)
        if row.quantity == "reaction" and not row.place.startswith("contact")
    ]
    assert sum(forces) == pytest.approx(2000.0, rel=1e-6)


def test_check_compares_limits_with_static_stresses_and_pads(tmp_path: Path) -> None:
    """Reference: by hand, 2000 N · 14 m at 0.204 m off the axis; the lever rule for a pad."""
    limits = "[limits]\nstress = 2e7\npad_pressure = 2e6\nwall_stress = 2e8\n"
    case = read_case(tmp_path, boom_of(RAMP) + limits)
    inertia = build_boom(case).segments[0].second_moment_of_area
    stress = f"{1e-6 * 2000.0 * 14.0 * 0.204 / inertia:.4g} MPa"
    pressure = f"{1e-6 * 2000.0 * (14.0 - 6.1) / 1.8 / 0.02:.4g} MPa"
    assert [line for line in check_case(CheckedCase(case)).lines if "imit " in line] == [
        "caution: the limit bending stress ≤ 20 MPa is exceeded: the static bending stress "
        f"(maximum load) is {stress}",
        "Limit local plate stress ≤ 200 MPa: a run decides.",
        f"Limit pad pressure ≤ 2 MPa: the static pad pressure (maximum load) is {pressure}, and "
        "the motion adds to it; a run decides.",
    ]


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
    # 100 kg times 9.80665 m/s² without the table gravity.
    case = read_case(tmp_path, boom_of("[payload]\nmass = 100.0\n"))
    row = ("payload", "fly at 14 m", "z", "constant", "−980.7 N", "")
    assert load_table(case, build_boom(case)).rows == [row]


def test_wind_and_head_load_the_tip_with_moments_and_torque(tmp_path: Path) -> None:
    """Reference: by hand: a wind from the side of 200 N, and a head of 60 kg, on a level boom."""
    drawn = (
        '[wind]\npressure = 100.0\nshape_factor = 1.0\nload_area = 2.0\ndirection = "side"\n'
        "[gravity]\nangle = 0.0\n[head]\nahead = 0.8\nbelow = 0.5\nmass = 60.0\n"
    )
    lateral = boom_of(drawn).replace("play = 0.004", "play = 0.004\nlateral_play = 0.004")
    case = read_case(tmp_path, lateral)
    rows = load_table(case, build_boom(case)).rows
    assert [row[2:5] for row in rows if row[1] == "fly at 14 m"] == [
        ("z, moment", "constant", "−235.4 N m"),
        ("y", "constant", "200 N"),
        ("y, moment", "constant", "160 N m"),
        ("torque", "constant", "100 N m"),
    ]


def test_tables_are_in_the_units_of_the_case(tmp_path: Path) -> None:
    """Reference: the same boom in SI units."""
    case = convert_to_si(
        read_case(tmp_path, boom_of(RAMP)).model_copy(update={"shown_units": "mm-t-s"})
    )
    boom = boom_with_play(case, build_boom(case))
    assert load_table(case, boom).rows == [
        ("load[1]", "fly at 14000 mm", "z", "ramp of 0.1 s", "−2 kN", "0.1")
    ]
    table = static_table(case, boom, Rows(static_rows(static_states(case, boom), "beam")))
    rows = {row[0]: row for row in table.rows}
    assert rows["pad, fly at 6000 mm, above"][1:] == ("0 MPa", "0.339 MPa", "0.1", "33.9")
    assert rows["tip"][2].endswith(" mm")


def test_statics_name_their_model_and_fit_a_terminal(tmp_path: Path) -> None:
    """Reference: exact text at 80 columns."""
    text = boom_of(RAMP + SINE)
    shown = printed_check(read_case(tmp_path, text), 80)
    assert max(map(len, shown.splitlines())) <= 80
    assert "time of   utilisation" in shown
    assert "Static results at t = 0 and under the maximum loads" in shown
    assert (
        "A separate Timoshenko beam, with elastic walls under pads, gives these\n"
        "estimates.\n"
        "Stresses are bending stresses, axial in outer fibres.\n"
        "Local plate stresses are not included; a run with a shell has them."
    ) in shown


CASE = f"""
title = "A cantilever, loaded suddenly"
time = {{ duration = 0.5, output_step = 1e-3 }}
{STEEL}
yield_strength = 3e8
{box("arm", (0.0, 10.0), ARM, CLAMPED)}
load = -1000.0
"""
BEAM = elements("one", theory="timoshenko", element_length=0.25)


def answers(model: str, folder: Path) -> Results:
    return finished(read_case(folder, CASE + model)).results


def test_sudden_load_doubles_the_static_results(tmp_path: Path) -> None:
    """Reference: analytic. One coordinate: twice the static result after half a period."""
    series = table("[[model]]", name="one", kind="kantorovich", terms=[1], base="complete")
    found = answers(series, tmp_path)
    frequency = found.rows.where(state=INITIAL, quantity="frequency")[0].value
    peaks = found.rows.where(state=MOTION, quantity=["tip", "bending_moment", "stress"])
    assert len(peaks) == 3
    for peak in peaks:
        assert found.rows.dynamic_factor(peak) == pytest.approx(2.0, rel=2e-4)
        assert peak.time * frequency % 1.0 == pytest.approx(0.5, abs=0.01)
    (low,), (high,) = (found.curves.where(state=state) for state in (LOW, HIGH))
    (tip,) = found.rows.where(state=REST, quantity="tip")
    np.testing.assert_allclose(low.values["deflection"][-1], 2.0 * tip.value, rtol=2e-4)
    assert high.values["deflection"][-1] == pytest.approx(0.0, abs=1e-12)


def test_stress_and_reactions_at_rest_are_those_of_hand(tmp_path: Path) -> None:
    """Reference: by hand. 1000 N/m on 10 m: 10 kN, 50 kN m, σ = M c/J with c = 0.204 m."""
    found = answers(BEAM, tmp_path).rows
    still = {row.quantity: abs(row.value) for row in found.where(state=REST)}
    assert still["reaction"] == pytest.approx(1e4, rel=1e-6)
    assert still["support_moment"] == pytest.approx(5e4, rel=1e-3)
    assert still["bending_moment"] == pytest.approx(5e4, rel=2e-4)
    box = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
    assert still["stress"] == pytest.approx(5e4 * 0.204 / box.second_moment_of_area, rel=2e-4)
    (fibre,) = found.where(state=MOTION, quantity="stress")
    assert (fibre.x, abs(fibre.z or 0.0)) == (0.0, pytest.approx(0.204))
    assert fibre.utilisation == pytest.approx(abs(fibre.value) / 3e8)
    assert not found.where(quantity="wall_stress")


def test_outer_corners_lie_on_the_outer_surfaces() -> None:
    """Reference: by hand, half a thickness beyond the mid-lines, at most so for a hexagon."""
    y, z = outer_corners(BoxSection(height=0.4, width=0.3, flange=0.008, web=0.006))
    np.testing.assert_allclose(np.abs(y), 0.153)
    np.testing.assert_allclose(np.abs(z), 0.204)
    six = hexagon(0.4, 0.3, flat=0.2, top=0.006, bottom=0.006, web=0.006)
    y, z = outer_corners(six)
    assert np.abs(z).max() == pytest.approx(0.203)
    assert 0.15 < np.abs(y).max() < 0.153


def test_fibres_of_a_taper_are_those_of_the_local_section() -> None:
    """Reference: by hand, −P/A and M z/J of boxes of 0.4, 0.3 and 0.2 m under 10 kN and 1 N."""
    tail, head = (BoxSection(height, 0.2, 0.01, 0.008) for height in (0.4, 0.2))
    steel = Material(2.1e11, 0.3, 7850.0)
    clamp = Support(0.0, "clamped")
    arm = Segment.of_section("arm", 0.0, 8.0, steel, tail, head_section=head, supports=(clamp,))
    (arm,) = with_compression([arm], [], [Thrust(0, 8.0, 1e4)])
    boom = Boom((arm,), (), (Load(0, "z", -1.0, 8.0, Step()),))
    models = finite_element_segments(boom, 0.5, "euler-bernoulli", rotary_inertia=False)
    system = gap_system(boom, models).gather_loads()
    (line,) = lines(boom, models)
    fibres = Fibres.of(arm, line)
    state = static_response(system, system.load)
    for x, height in ((4.0, 0.3), (2.0, 0.35)):
        box, at = BoxSection(height, 0.2, 0.01, 0.008), int(np.argmax(line.x == x))
        assert fibres.of_normal[at] == pytest.approx(1.0 / box.area, rel=1e-12)
        top = int(fibres.z[:, at].argmax())
        assert fibres.z[top, at] == pytest.approx(0.5 * height + 0.005, rel=1e-12)
        bending = (8.0 - x) * (0.5 * height + 0.005) / box.second_moment_of_area
        forces = section_forces(boom, 0, line, state, np.zeros(()))
        found = fibres.stress(top, forces)[at] + 1e4 / box.area
        # Second order adds to the moment of the load.
        assert found == pytest.approx(bending, rel=0.02)
