# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slide pads of a case: stiffness, plays, forces, and walls that yield under them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from protractile.analysis.equilibria import equilibria
from protractile.analysis.measure import measure_boom
from protractile.analysis.model import AnalysisModel
from protractile.analysis.states import States
from protractile.cases import run_case
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.contact_table import TableContact
from protractile.dynamics.motion import initial_state
from protractile.runs import CASES
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.contact import JointTable
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.rules import cautions
from protractile.runs.check import check_case
from protractile.runs.pipeline.models import MotionPlan, build
from protractile.runs.pipeline.results import Results
from protractile.runs.report.result_tables import pad_table
from protractile.runs.report.summary_table import summary_table
from tests.docs.conftest import toml_blocks
from tests.runs.case_texts import (
    COARSE,
    REST,
    STEEL,
    THIN,
    edited,
    elements,
    read_case,
    refusal,
    shipped,
    table,
)
from tests.runs.summaries import model_summary, printed_check, summary_of
from tests.runs.test_statics import told
from tests.touching import contact_laws

LAW = "stiffness = 1e13\nexponent = 2.0\n"
PAD = "pad = { length = 0.2, width = 0.05, thickness = 0.02, allowable_pressure = 2e7 }\n"


def case_with(folder: Path, joint: str, play: float = 0.014) -> Case:
    text = COARSE[: COARSE.index("[[model]]")] + elements("beam", element_length=0.5)
    text = text.replace(COARSE[COARSE.index("statements") :].splitlines()[0] + "\n", "")
    text = text.replace("play = 0.014", f"play = {play}").replace(LAW, joint)
    return read_case(folder, text)


@pytest.mark.parametrize(("modulus", "stiffness"), [("", 1.9e9), (", modulus = 3.8e9", 3.8e9)])
def test_pads_are_as_stiff_as_they_are_thick(
    tmp_path: Path, modulus: str, stiffness: float
) -> None:
    """Reference: analytic, two pads of E A/t = 1.9e9 · 0.01/0.02 on a side."""
    case = case_with(tmp_path, PAD.replace("0.02,", f"0.02{modulus},"))
    (law,) = contact_laws(case, case.models[0])
    assert (law.above, law.law.exponent) == (7.0e-3, 1.0)
    assert law.law.stiffness == pytest.approx(stiffness)


def test_a_play_may_be_more_above_than_below(tmp_path: Path) -> None:
    """Reference: analytic, 4 mm of 14 mm above."""
    case = case_with(tmp_path, "stiffness = 1e9\nexponent = 1.0\nplay_above = 0.004\n")
    (law,) = contact_laws(case, case.models[0])
    y = np.array([-0.011, -0.0099, 0.0039, 0.005])
    assert law.force(y) == pytest.approx([-1.0e6, 0.0, 0.0, 1.0e6])
    assert "4 above, 10 below" in printed_check(case)


def test_shims_hold_the_boom_as_springs_do(tmp_path: Path) -> None:
    """Reference: analytic. With contact on both sides, a station is a spring of 2 k."""
    case = case_with(tmp_path, "stiffness = 1e7\nexponent = 1.0\ninterference = 0.02\n", play=0.0)
    model, boom = case.models[0], build_boom(case)
    system = build(case, boom, model).system
    motion = MotionPlan.of(system, case, model).trajectory(lambda part: None)
    springs = 2.0e7 * system.rows.T @ system.rows
    omega2, shapes = np.linalg.eigh(np.diag(system.omega2) + springs)
    load, tip = shapes.T @ system.load, system.observers["tip"].row @ shapes
    time = motion.data["time"].values[:, None]
    exact = (1.0 - np.cos(np.sqrt(omega2) * time)) / omega2 @ (load * tip)
    assert np.abs(motion.data["gap"].values).max() < 0.01
    np.testing.assert_allclose(motion.data["tip"].values, exact, atol=1e-4 * np.abs(exact).max())
    assert motion.energy_residual < 1e-5


def results(folder: Path, joint: str) -> Results:
    return run_case(case_with(folder, joint))


def test_pressure_stands_beside_the_pad_strength(tmp_path: Path) -> None:
    """Reference: by hand, half of the station's largest force over 0.01 m², against 20 MPa."""
    found = results(tmp_path, PAD)
    table = pad_table(found)
    peaks = np.abs(found.trajectories["contact_force_peak"].values[0]).max(axis=0)
    assert peaks.min() > 0.0
    assert [row[0:4] for row in table.rows] == [
        ("beam", "inner in outer", "9", "below"), ("beam", "inner in outer", "10", "above"),
    ]  # fmt: skip
    told = {column.heading: column.cells for column in table.columns}
    assert told["pressure\nMPa"] == pytest.approx((0.5 * peaks / 0.01).tolist())
    assert told["utilisation\n%"] == pytest.approx((0.5 * peaks / 0.01 / 2.0e7).tolist())
    # Corners bear no pressure.
    assert not pad_table(results(tmp_path, LAW)).rows


def test_summary_names_the_governing_pad(tmp_path: Path) -> None:
    """Reference: the table of all pads. A pad with a very small allowable pressure governs."""
    found = results(tmp_path, PAD.replace("2e7", "1e3"))
    table = summary_table(found)
    told = {row[0]: row[1] for row in table.rows}
    pads = pad_table(found)
    columns = {column.heading: column for column in pads.columns}
    most = int(np.argmax([float(p) for p in columns["pressure\nMPa"].cells]))
    force, pressure = (columns[name].text[most] for name in ("maximum force\nkN", "pressure\nMPa"))
    lines = told["Governing pad: force, pressure, utilisation"].split("\n")
    assert lines[0] == f"{force} kN"
    assert lines[1].startswith(f"{pressure} MPa, ")
    where = columns["at\nm"].cells[most]
    side = columns["side"].cells[most]
    assert lines[2:] == ["beyond allowable", f"inner, x = {where} m, {side}"]
    assert told["Governing pad: force, pressure, utilisation"] in table.strong
    assert not any(asked.startswith("Contact force") for asked in told)


@pytest.mark.parametrize("shim", [0.0, 2e-5, 1.0e-3])
def test_governing_pad_at_rest_is_named(tmp_path: Path, shim: float) -> None:
    """Reference: other code path, the rows of pad pairs, with 3/5 and 2/5 of a force."""
    below = [pad_on("below", 0.03, 0.02), pad_on("below", 0.02, 0.02, offset=0.04, shim=shim)]
    above = pad_on("above", 0.05, 0.02)
    case = case_with(tmp_path, several(above, *below))
    boom = build_boom(case)
    built = build(case, boom, case.models[0])
    loaded = AnalysisModel.of(boom, built.system, case.models[0].lines(boom, built))
    system, rests = loaded.system, equilibria(loaded.system)
    position = rests[0.0]
    measured = list(measure_boom(States.of(loaded, rests)))
    pads, forces = (
        [one for one in measured if one.quantity == name] for name in ("pad_force", "contact_force")
    )
    of_rows = [
        abs(law.force(y)) for law, y in zip(system.laws, system.rows @ position, strict=True)
    ]
    parts = []
    for k, force in enumerate(forces):
        pad = max(one.values.item() for one in pads if one.place.startswith(force.place))
        largest = max(f for f, at in zip(of_rows, system.station_of_row, strict=True) if at == k)
        assert pad == pytest.approx(0.5 * largest, rel=1e-9)
        parts.append(pad / abs(force.values.item()))
    expected = {0.0: 0.5 * 0.6, 1.0e-3: 0.5}.get(shim)
    assert expected is None or min(parts) == pytest.approx(expected)


def pad_on(side: str, width: float, thickness: float, **others: float) -> str:
    more = "".join(f", {key} = {value}" for key, value in others.items())
    return f'{{ side = "{side}", length = 0.2, width = {width}, thickness = {thickness}{more} }}'


def several(*pads: str) -> str:
    return f"pads = [{', '.join(pads)}]\n"


def test_pads_share_as_they_are_stiff(tmp_path: Path) -> None:
    """Reference: by hand, E A/t = 1.9e9 · 0.01/0.02 and a third of it, and a shim of 2 mm."""
    below = pad_on("below", 0.05, 0.02), pad_on("below", 0.025, 0.03, offset=0.06, shim=0.002)
    case = case_with(tmp_path, several(pad_on("above", 0.05, 0.02), *below))
    system = build(case, build_boom(case), case.models[0]).system
    tail = [law for law, k in zip(system.laws, system.station_of_row, strict=True) if k == 0]
    assert [law.terms[0].onset for law in tail] == pytest.approx([0.007, 0.007, 0.005])
    pressed = [float(law.force(np.array(0.008))) for law in tail[:1]]
    pressed += [float(law.force(np.array(-0.008))) for law in tail[1:]]
    stiff = 2.0 * 1.9e9 * 0.01 / 0.02
    assert pressed == pytest.approx([stiff * 1e-3, -stiff * 1e-3, -stiff / 3.0 * 3e-3])


def test_pressure_of_each_pad_is_reported(tmp_path: Path) -> None:
    """Reference: by hand, the largest force over both areas, at the head."""
    pads = [
        pad_on("above", 0.05, 0.02),
        pad_on("below", 0.03, 0.02, allowable_pressure=2e7),
        pad_on("below", 0.02, 0.02, offset=0.04),
    ]
    found = results(tmp_path, several(*pads))
    table = pad_table(found)
    told = {column.heading: column.cells for column in table.columns}
    assert told["side"] == ["above", "below", "below 2"] * 2
    peaks = found.trajectories["contact_force_peak"].values[0]
    down, up = -peaks.min(axis=0), peaks.max(axis=0)
    areas = np.array([0.02, 0.012, 0.008])
    for station in (0, 1):
        pressures = np.array(told["pressure\nMPa"][3 * station : 3 * station + 3])
        assert pressures[0] == pytest.approx(max(up[station], 0.0) / 0.02, rel=1e-6, abs=1.0)
        assert pressures[1] == pytest.approx(pressures[2], rel=1e-6, abs=1.0)
        assert pressures[1:] * areas[1:] @ np.ones(2) == pytest.approx(
            max(down[station], 0.0), rel=1e-6, abs=1.0
        )
    assert told["utilisation\n%"][1] == pytest.approx(told["pressure\nMPa"][1] / 2.0e7)
    assert told["utilisation\n%"][2] is None


def test_shimmed_pads_tell_the_force_of_their_side(tmp_path: Path) -> None:
    """Reference: by hand. Pads of stiffness k with shims s on both sides carry k (s ± y)."""
    sides = [pad_on(side, 0.05, 0.02, shim=0.1) for side in ("above", "below")]
    found = results(tmp_path, several(*sides))
    peaks = found.trajectories["contact_force_peak"].values[0]
    rest = 2.0 * found.boom.joints[0].pads[0].stiffness * (0.1 - 0.007)
    table = pad_table(found)
    forces = {column.heading: column.cells for column in table.columns}["maximum force\nkN"]
    for station, own in enumerate(peaks.T):
        # The harder side presses with the peak, the other with 2 k s less the peak.
        above = np.where(own > 0.0, own, 2.0 * rest + own).max()
        below = np.where(own < 0.0, -own, 2.0 * rest - own).max()
        told = 2.0 * np.array(forces[2 * station : 2 * station + 2])
        assert told == pytest.approx([above, below], rel=1e-9)
        assert rest < max(above, below) < 2.0 * rest


@pytest.mark.parametrize(("state", "lifted"), [("equilibrium", 0.001), ("rest", 0.0)])
def test_shims_lift_an_unloaded_boom(tmp_path: Path, state: str, lifted: float) -> None:
    """Reference: by hand. A play of 2 mm below and a shim of 3 mm give −1 mm, without bending."""
    pads = several(pad_on("above", 0.05, 0.02), pad_on("below", 0.05, 0.02, shim=0.003))
    case = case_with(tmp_path, pads, play=0.004)
    segments = tuple(s.model_copy(update={"load": 0.0}) for s in case.segments)
    begun = case.start.model_copy(update={"state": state})
    case = case.model_copy(update={"segments": segments, "start": begun})
    built = build(case, build_boom(case), case.models[0])
    system, position, _ = initial_state(built.system, begun.at_rest)
    np.testing.assert_allclose(system.rows @ position, lifted, atol=1e-8)


# Penetrations of up to 0.5 mm, by 5 µm.
DEPTHS = np.linspace(0.0, 5.0e-4, 101)[1:]
POINTS = [[float(p), float(1e13 * p**2)] for p in DEPTHS]


def table_case(folder: Path, law: str) -> Case:
    return read_case(folder, COARSE.replace(LAW, law))


def test_table_approximates_the_sampled_law(tmp_path: Path) -> None:
    """Reference: analytic, chords of p² lie above it by k (Δp)²/4 at most."""
    case = table_case(tmp_path, f"force_table = {POINTS}\n")
    (law,) = contact_laws(case, case.models[0])
    power = PowerContact(1e13, 2.0).with_clearance(7.0e-3)
    y = np.concatenate([[-1.0], [1.0]]) * (7.0e-3 + np.linspace(0.0, 5.0e-4, 999)[:, None])
    above = np.abs(law.force(y)) - np.abs(power.force(y))
    assert -1e-6 < above.min() < 1e-6
    assert above.max() == pytest.approx(0.25 * 1e13 * (5.0e-6) ** 2, rel=1e-2)
    assert read_case(tmp_path, toml.dumps(case)) == case


def test_a_file_and_a_model_s_own_table_are_the_same(tmp_path: Path) -> None:
    lines = "".join(f"{p!r}, {force!r}\n" for p, force in POINTS)
    (tmp_path / "pad.csv").write_text(f"# m, N\n{lines}", encoding="utf-8")
    inline = table_case(tmp_path, f"force_table = {POINTS}\n")
    assert table_case(tmp_path, 'force_file = "pad.csv"\n') == inline
    own = COARSE.partition("contact = {")
    model = 'contact = { force_file = "pad.csv" }'
    case = read_case(tmp_path, own[0] + model + own[2].partition("}")[2])
    (law,) = contact_laws(case, case.models[2])
    (same,) = contact_laws(inline, inline.models[2].model_copy(update={"contact": None}))
    assert law == same


def test_to_the_sides_a_stiffness_makes_a_power_law_beside_a_table() -> None:
    to_the_sides = {"lateral_play": 0.01, "lateral_stiffness": 1.0e9, "lateral_exponent": 1.5}
    table = ((1.0e-3, 2.0),)
    joint = JointTable("a", "b", stations=(1.0,), play=0.0, force_table=table, **to_the_sides)
    assert joint.law("y") == PowerContact(1.0e9, 1.5)
    assert joint.law("z") == TableContact((1.0e-3,), (2.0,))


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ("exponent = 2.0", "joint[1].stiffness: missing; it is the contact stiffness in N/m^n "
         "where the inner segment presses up"),
        ("force_table = [[1e-3, 2.0]]\nstiffness = 1e9",
         "joint[1].stiffness: force_table is given; leave one of them out"),
        ("force_table = [[1e-3, 2.0]]\nlateral_play = 0.01\nlateral_exponent = 2.0",
         "joint[1].lateral_exponent: force_table is given; leave one of them out"),
        ('force_table = [[1e-3, 2.0]]\nforce_file = "pulls.csv"',
         "joint[1].force_file: force_table is given; leave one of them out"),
        ("force_table = [[0.0, 0.0], [1e-3, 2.0]]",
         "joint[1].force_table: depths must be finite and rise from above 0"),
        ('force_file = "pulls.csv"',
         "joint[1].force_file: forces must be positive, and must not fall at the end"),
    ],
)  # fmt: skip
def test_bad_tables_are_refused(tmp_path: Path, law: str, message: str) -> None:
    (tmp_path / "pulls.csv").write_text("1e-3, 2\n2e-3, -1\n", encoding="utf-8")
    assert refusal(tmp_path, COARSE.replace(LAW, f"{law}\n")) == message


def test_walls_under_pads_lower_the_tip_as_in_the_shell() -> None:
    """Reference: other code, the shell of the lift at rest, −229.12 mm (−190.18 mm of its beam)."""
    lines = told(shipped("lift"))
    (tip,) = (line for line in lines if line.startswith("Static tip deflection"))
    assert float(tip.split(": ")[1].split()[0]) == pytest.approx(-229.12, rel=0.01)


def test_remedies_for_walls_under_pads_count_under_the_largest_loads() -> None:
    """Reference: the same loads from t = 0 on, without a ramp."""
    case = shipped("lift")
    share, *remedies = pad_wall_sentences(case)
    assert share == (
        "Walls bend under pads, which moves the tip by -60.66 of -378.5 mm, 16 %, under the loads "
        "at t = 0.1 s (estimate from plates)."
    )
    assert remedies == [
        "Remedies, each with the static tip deflection that it gives under these loads (for local "
        "plate stresses, run a shell with the remedy):",
        "- -317.9 mm: pads that bear on the corners, bears = 'corner'",
        "- -333 mm: collars around both segments at each pad, as thick as the walls and one "
        "section height long (the boom can then not telescope)",
    ]
    (load,) = case.loads
    sudden = case.model_copy(update={"loads": (load.model_copy(update={"ramp": None}),)})
    assert pad_wall_sentences(sudden) == [share.replace("0.1 s", "0 s"), *remedies]


def test_remedies_leave_out_collars_that_are_there(tmp_path: Path) -> None:
    """Reference: by construction. Collars of half a millimetre, along all segments."""
    text = (CASES / "lift.toml").read_text("utf-8")
    collars = 'collars = [{ span = ["tail", "head"], thickness = 5e-4 }]\nsection ='
    case = read_case(tmp_path, text.replace("section =", collars))
    remedies = " ".join(pad_wall_sentences(case))
    assert "bears = 'corner'" in remedies
    assert "collars" not in remedies


def test_walls_on_corners_have_no_share(tmp_path: Path) -> None:
    """Reference: by construction, pads on the corners of boxes; exact words without telescoping."""
    text = (CASES / "lift.toml").read_text("utf-8")
    case = read_case(tmp_path, text.replace("pad = {", 'pad = { bears = "corner",'))
    assert pad_wall_sentences(case) == []
    shown = check_case(CheckedCase(case))
    (notes,) = (one.notes for one in shown.tables if one.title.startswith("Extreme axial forces"))
    assert notes == ["Includes the cylinder forces at t = 0."]


def test_a_tip_that_rigid_sections_overestimate_by_half_causes_a_caution(tmp_path: Path) -> None:
    """Reference: other code, a shell of edges of 0.15 m under a lateral force of 3 kN: −26.0 mm.

    Rigid sections give −39.1 mm, 50 % more. Forces of lateral pads widen the section upwards,
    which closes the vertical play.
    """
    pad = {"length": 0.2, "width": 0.06, "thickness": 0.02, "bears": "corner"}
    sizes = ("shape", "height", "width", "chamfer", "top", "bottom", "web")
    outer = dict(zip(sizes, ("octagon", 0.56, 0.56, 0.15, 0.007, 0.007, 0.007), strict=True))
    inner = dict(zip(sizes, ("octagon", 0.50, 0.50, 0.135, 0.006, 0.006, 0.006), strict=True))
    clamp = [{"x": 0.0, "kind": "clamped"}]
    joint = {"outer": "outer", "inner": "inner", "extension": 6.2, "play": 0.003}
    load = {"segment": "inner", "x": "head"}
    text = "".join(
        (
            'title = "Mast"\n' + table("[time]", duration=5.0) + STEEL,
            table("[gravity]", angle=90.0) + REST + table("[payload]", mass=3000.0),
            table("[[axial]]", force=120000.0) + elements("beam"),
            table("[[segment]]", name="outer", length=7.5, supports=clamp, section=outer),
            table("[[segment]]", name="inner", length=7.5, section=inner),
            table("[[load]]", **load, direction="y", magnitude=3100.0),
            table("[[load]]", **load, magnitude=-2000.0),
            table("[[joint]]", **joint, lateral_play=0.003, pad=pad, stations=["tail", "head"]),
        )
    )
    lines = check_case(CheckedCase(read_case(tmp_path, text))).lines
    (line,) = (one for one in lines if "distort under pads" in one)
    assert line.startswith("caution: sections distort under pads, which moves the tip by 1")
    assert ", −5" in line


def test_sections_that_distort_have_their_share_and_remedies(tmp_path: Path) -> None:
    """Reference: other code, a shell of edges of 50 mm at −444.7 mm; by hand without, −265 mm."""
    pad = {"length": 0.25, "width": 0.07, "thickness": 0.02, "bears": "corner"}
    sizes = ("shape", "height", "width", "flat", "top", "bottom", "web")
    outer = dict(zip(sizes, ("hexagon", 0.82, 0.58, 0.39, 0.008, 0.011, 0.007), strict=True))
    inner = dict(zip(sizes, ("hexagon", 0.74, 0.50, 0.32, 0.007, 0.009, 0.006), strict=True))
    clamp = [{"x": 0.0, "kind": "clamped"}]
    text = "".join(
        (
            'title = "Hexagons"\n'
            + table("[time]", duration=5.0)
            + STEEL
            + table("[gravity]", angle=0.0)
            + REST,
            table("[payload]", mass=6000.0) + elements("beam"),
            table("[[segment]]", name="outer", length=8.7, supports=clamp, section=outer),
            table("[[segment]]", name="inner", length=8.7, section=inner),
            table("[[joint]]", outer="outer", inner="inner", extension=7.1, play=0.004, pad=pad)
            + 'stations = ["tail", "head"]',
        )
    )
    lines = [
        line.replace("−", "-") for line in check_case(CheckedCase(read_case(tmp_path, text))).lines
    ]
    tip = next(line for line in lines if line.startswith("Static tip deflection"))
    assert ", with the compliance of sections under pads: -443.7 mm; with bonded" in tip
    first = lines.index(
        "Sections distort under pads, which moves the tip by -178.7 of -443.7 mm, 40 %, under the "
        "loads at t = 0 s (estimate from a frame of plates)."
    )
    assert lines[first + 2] == (
        "- -304.8 mm: collars around both segments at each pad, as thick as the walls and one "
        "section height long (the boom can then not telescope)"
    )
    assert lines[first + 3] == "Sections under pads are rigid in 'beam'."


def test_walls_under_pads_are_the_cause_of_a_large_deflection(tmp_path: Path) -> None:
    """Reference: exact words. A beam has rigid walls, so that its tip has another cause."""
    text = "".join(toml_blocks("tutorial.md")[:3])
    text = edited(text, *THIN, ("magnitude = -1595.0", "magnitude = -8500.0"))
    case = read_case(tmp_path, text)
    cause = "walls under pads cause most of it; change the pads"
    lines = check_case(CheckedCase(case)).lines
    (caution,) = (line for line in lines if "the tip rests" in line)
    assert caution.endswith(f" %; {cause}")
    names = ["shell", "beam"]
    data = xr.Dataset(
        {"tip": (("model", "time"), np.full((2, 1), -2.0)), "time": [0.0], "model": names}
    )
    summary = summary_of({name: model_summary(static_tip=-1.7) for name in names})
    lines = cautions(Context.of_run(Results(case, data, summary)))
    assert [line.rpartition(" %; ")[2] for line in lines if " tip " in line] == 2 * [
        cause,
        "check units and loads",
    ]


def pad_wall_sentences(case: Case) -> list[str]:
    lines = check_case(CheckedCase(case)).lines
    found = [line for line in lines if line.startswith(("Walls bend", "Remedies", "- "))]
    return [line.replace("−", "-") for line in found]
