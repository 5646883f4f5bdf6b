# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slide pads of a case: stiffness, plays, forces, and walls that yield under them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from protractile.analysis.rows import MOTION
from protractile.analysis.rows import REST as AT_REST
from protractile.cases import run_case
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.contact_table import TableContact
from protractile.dynamics.motion import initial_state
from protractile.geometry.head import Head
from protractile.geometry.joint import Pad
from protractile.runs.case import toml
from protractile.runs.case.actions import STANDARD_GRAVITY
from protractile.runs.case.build import build_boom
from protractile.runs.case.contact import JointTable
from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.rules import cautions
from protractile.runs.check import check_case
from protractile.runs.pipeline.combinations import combination_rows
from protractile.runs.pipeline.models import MotionPlan, build
from protractile.runs.pipeline.results import Results
from protractile.runs.report.result_tables import pad_table
from protractile.runs.report.summary_table import summary_table
from protractile.runs.report.tables import Table
from tests.docs.conftest import toml_blocks
from tests.runs.case_texts import (
    CLAMPED,
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
from tests.runs.test_drawing_keys import DRAWN, FACTORS, JACK, PEOPLE
from tests.touching import contact_laws

LAW = "stiffness = 1e13\nexponent = 2.0\n"


def case_with(folder: Path, joint: str, play: float = 0.014) -> Case:
    text = COARSE[: COARSE.index("[[model]]")] + elements("beam", element_length=0.5)
    text = text.replace(COARSE[COARSE.index("statements") :].splitlines()[0] + "\n", "")
    text = text.replace("play = 0.014", f"play = {play}").replace(LAW, joint)
    text = text.replace("duration = 0.6", "duration = 0.3")
    return read_case(folder, text)


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


def pad_on(side: str, width: float, thickness: float, **others: float) -> str:
    more = "".join(f", {key} = {value}" for key, value in others.items())
    return f'{{ side = "{side}", length = 0.2, width = {width}, thickness = {thickness}{more} }}'


def several(*pads: str) -> str:
    return f"pads = [{', '.join(pads)}]\n"


def test_pads_share_as_they_are_stiff(tmp_path: Path) -> None:
    """Reference: by hand, E A/t = 1.9e9 · 0.01/0.02 and two thirds of it, and a shim of 2 mm."""
    softer = pad_on("below", 0.025, 0.03, modulus=3.8e9, offset=0.06, shim=0.002)
    below = pad_on("below", 0.05, 0.02), softer
    case = case_with(tmp_path, several(pad_on("above", 0.05, 0.02), *below))
    system = build(case, build_boom(case), case.models[0]).system
    tail = [law for law, k in zip(system.laws, system.station_of_row, strict=True) if k == 0]
    assert [law.terms[0].onset for law in tail] == pytest.approx([0.007, 0.007, 0.005])
    gaps = (0.008, -0.008, -0.008)
    pressed = [float(law.force(np.array(y))) for law, y in zip(tail, gaps, strict=True)]
    stiff = 2.0 * 1.9e9 * 0.01 / 0.02
    assert pressed == pytest.approx([stiff * 1e-3, -stiff * 1e-3, -stiff / 1.5 * 3e-3])


def columns(table: Table) -> dict[str, list[Any]]:
    return {column.heading: column.cells for column in table.columns}


def test_pressure_of_each_pad_stands_beside_its_strength(tmp_path: Path) -> None:
    """Reference: by hand, the largest force over both areas, at the head."""
    pads = [
        pad_on("above", 0.05, 0.02, allowable_pressure=1e3),
        pad_on("below", 0.03, 0.02, allowable_pressure=1e3),
        pad_on("below", 0.02, 0.02, offset=0.04),
    ]
    found = run_case(case_with(tmp_path, several(*pads)))
    told = columns(pad_table(found))
    assert told["side"] == ["above", "below", "below 2"] * 2
    assert told["at\nm"] == ["9"] * 3 + ["10"] * 3
    peaks = found.trajectories["contact_force_peak"].values[0]
    down, up = np.maximum(-peaks.min(axis=0), 0.0), np.maximum(peaks.max(axis=0), 0.0)
    pressures = np.reshape(told["pressure\nMPa"], (2, 3))
    expected = np.stack([up / 0.02, down / 0.02, down / 0.02], axis=1)
    np.testing.assert_allclose(pressures, expected, rtol=1e-6, atol=1.0)
    assert told["utilisation\n%"][:3] == [*map(pytest.approx, pressures[0, :2] / 1e3), None]
    summary = summary_table(found)
    (governing,) = (row[1] for row in summary.rows if row[0].startswith("Governing pad: force"))
    station, side = np.unravel_index(pressures[:, :2].argmax(), (2, 2))
    place = f"inner, x = {(9, 10)[station]} m, {('above', 'below')[side]}"
    assert governing.split("\n")[-2:] == ["beyond allowable", place]
    assert governing in summary.strong


def test_shimmed_pads_tell_the_force_of_their_side(tmp_path: Path) -> None:
    """Reference: by hand. Pads of stiffness k with shims s on both sides carry k (s ± y)."""
    sides = [pad_on(side, 0.05, 0.02, shim=0.1) for side in ("above", "below")]
    found = run_case(case_with(tmp_path, several(*sides)))
    peaks = found.trajectories["contact_force_peak"].values[0]
    rest = 2.0 * found.boom.joints[0].pads[0].stiffness * (0.1 - 0.007)
    told = 2.0 * np.reshape(columns(pad_table(found))["maximum force\nkN"], (2, 2))
    for own, both in zip(peaks.T, told, strict=True):
        # The harder side presses with the peak, the other with 2 k s less the peak.
        above = np.where(own > 0.0, own, 2.0 * rest + own).max()
        below = np.where(own < 0.0, -own, 2.0 * rest - own).max()
        assert both == pytest.approx([above, below], rel=1e-9)
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


def test_table_approximates_the_sampled_law(tmp_path: Path) -> None:
    """Reference: analytic, chords of p² lie above it by k (Δp)²/4 at most; the same by a file."""
    inline = f"force_table = {POINTS}"
    case = read_case(tmp_path, COARSE.replace(LAW, f"{inline}\n"))
    (law,) = contact_laws(case, case.models[0])
    power = PowerContact(1e13, 2.0).with_clearance(7.0e-3)
    y = np.concatenate([[-1.0], [1.0]]) * (7.0e-3 + np.linspace(0.0, 5.0e-4, 999)[:, None])
    above = np.abs(law.force(y)) - np.abs(power.force(y))
    assert -1e-6 < above.min() < 1e-6
    assert above.max() == pytest.approx(0.25 * 1e13 * (5.0e-6) ** 2, rel=1e-2)
    assert read_case(tmp_path, toml.dumps(case)) == case
    lines = "".join(f"{p!r}, {force!r}\n" for p, force in POINTS)
    (tmp_path / "pad.csv").write_text(f"# m, N\n{lines}", encoding="utf-8")
    file = 'force_file = "pad.csv"'
    assert read_case(tmp_path, COARSE.replace(LAW, f"{file}\n")) == case
    before, _, after = COARSE.partition("contact = {")
    own = read_case(tmp_path, f"{before}contact = {{ {file} }}{after.partition('}')[2]}")
    assert contact_laws(own, own.models[2]) == [law]
    lateral = {"lateral_play": 0.01, "lateral_stiffness": 1.0e9, "lateral_exponent": 1.5}
    both = JointTable("a", "b", (1.0,), 0.0, force_table=((1.0e-3, 2.0),), **lateral)
    assert both.law("y") == PowerContact(1.0e9, 1.5)
    assert both.law("z") == TableContact((1.0e-3,), (2.0,))


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ("exponent = 2.0", "joint[1].stiffness: missing; give pad, with the thickness from which "
         "it follows, or stiffness in N/m^n"),
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


def told_by_check(case: Case) -> list[str]:
    return [line.replace("−", "-") for line in check_case(CheckedCase(case)).lines]


def test_remedies_for_walls_under_pads_count_under_the_largest_loads() -> None:
    """Reference: other code, the shell of the lift at rest, −229.12 mm (−190.18 mm of its beam)."""
    lines = told_by_check(shipped("lift"))
    (tip,) = (line for line in lines if line.startswith("Static tip deflection"))
    assert float(tip.split(": ")[1].split()[0]) == pytest.approx(-229.12, rel=0.01)
    assert [line for line in lines if line.startswith(("Walls bend", "Remedies", "- "))] == [
        "Walls bend under pads, which moves the tip by -60.66 of -378.5 mm, 16 %, under the loads "
        "at t = 0.1 s (estimate from plates).",
        "Remedies, each with the static tip deflection that it gives under these loads (for local "
        "plate stresses, run a shell with the remedy):",
        "- -317.9 mm: pads that bear on the corners, bears = 'corner'",
        "- -333 mm: collars around both segments at each pad, as thick as the walls and one "
        "section height long (the boom can then not telescope)",
    ]


def test_sections_that_distort_have_their_share_and_remedies(tmp_path: Path) -> None:
    """Reference: other code, a shell of edges of 50 mm at −444.7 mm; by hand without, −265 mm."""
    pad = {"length": 0.25, "width": 0.07, "thickness": 0.02, "bears": "corner"}
    text = f"""title = "Hexagons"
time = {{ duration = 5.0 }}
gravity = {{ angle = 0.0 }}
{STEEL}{REST}{table("[payload]", mass=6000.0)}{elements("beam")}
"""
    for name, sizes, more in (
        ("outer", (0.82, 0.58, 0.39, 0.008, 0.011, 0.007), f"\n{CLAMPED}\n"),
        ("inner", (0.74, 0.50, 0.32, 0.007, 0.009, 0.006), ""),
    ):
        keys = ("height", "width", "flat", "top", "bottom", "web")
        section = {"shape": "hexagon", **dict(zip(keys, sizes, strict=True))}
        text += table("[[segment]]", name=name, length=8.7, section=section) + more
    text += table(
        "[[joint]]",
        outer="outer",
        inner="inner",
        extension=7.1,
        play=0.004,
        pad=pad,
        stations=["tail", "head"],
    )
    lines = told_by_check(read_case(tmp_path, text))
    tip = next(line for line in lines if line.startswith("Static tip deflection"))
    assert ", with the compliance of sections under pads: -443.7 mm; with bonded" in tip
    first = lines.index(
        "Sections distort under pads, which moves the tip by -178.7 of -443.7 mm, 40 %, under the "
        "loads at t = 0 s (estimate from a frame of plates)."
    )
    assert lines[first + 2].startswith("- -304.8 mm: collars around both segments at each pad")
    assert lines[first + 3] == "Sections under pads are rigid in 'beam'."


def test_pads_at_the_sides_have_a_thickness_of_their_own(tmp_path: Path) -> None:
    """Reference: other input, pads of four sides; exact words of refusals."""
    text = DRAWN[: DRAWN.index("[[joint]]")] + JACK + table("[wind]", pressure=200.0,
        shape_factor=1.4, direction="side") + PEOPLE + FACTORS  # fmt: skip
    size = {"length": 0.12, "width": 0.05}
    pads: list[dict[str, object]] = [
        {"side": side, **size, "thickness": thickness}
        for side, thickness in (("above", 0.02), ("below", 0.02), ("left", 0.015), ("right", 0.015))
    ]
    keys = {"outer": "base", "inner": "fly", "extension": 4.0, "stations": ["tail", "head"],
            "play": 0.002}  # fmt: skip
    pad = {"pad": size | {"thickness": 0.02, "lateral_thickness": 0.015}}
    found = []
    for more in (pad, {"pads": pads}):
        case = read_case(tmp_path, text + table("[[joint]]", **keys, lateral_play=0.002, **more))
        found.append([row.value for row in combination_rows(case)])
        (joint,) = build_boom(case).joints
        assert str(joint.law("y")) != str(joint.law("z"))
    assert found[0] == found[1]
    line = "lateral_thickness: needs pad.thickness in a boom with lateral_play; leave it out"
    of_pads = {"pads": [pads[0] | {"lateral_thickness": 0.01}, *pads[1:]], "lateral_play": 0.002}
    for name, more in (("pads[1]", of_pads), ("pad", pad)):
        flat = text.replace('direction = "side"', "")
        told = refusal(tmp_path, flat + table("[[joint]]", **keys, **more))
        assert told == f"joint[1].{name}.{line}"


def test_walls_under_pads_are_the_cause_of_a_large_deflection(tmp_path: Path) -> None:
    """Reference: exact words. A beam has rigid walls, so that its tip has another cause."""
    text = "".join(toml_blocks("tutorial.md")[:3])
    text = edited(text, *THIN, ("magnitude = -1595.0", "magnitude = -8500.0"))
    case = read_case(tmp_path, text)
    cause = "walls under pads cause most of it; change the pads"
    (caution,) = (line for line in told_by_check(case) if "the tip rests" in line)
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


def test_in_space_the_pad_that_carries_more_counts() -> None:
    """Reference: by hand, the torque of a payload beside the axis on pads at the corners.

    At each station pads at ±b/2 carry F/2 ± T/b, and both stations of a joint the whole torque, at
    rest and in the motion of a boom that stays at rest.
    """
    case, beside = shipped("inspection-arm"), 0.2
    assert case.payload is not None
    pad = Pad(0.12, 0.05, thickness=0.0125, modulus=4e8, bears="corner")
    changes = {
        "joints": tuple(replace(joint, lateral_play=0.02, pad=pad) for joint in case.joints),
        "head": Head(beside=beside),
        "models": (BeamElements(name="beam", element_length=0.5, theory="timoshenko"),),
        "time": case.time.model_copy(update={"duration": 0.05, "output_step": 0.01}),
        **dict.fromkeys(("load_cases", "combinations", "spectra"), ()),
        **dict.fromkeys(("wind", "limits")),
    }
    found = run_case(case.model_copy(update=changes))
    torque = case.payload.mass * STANDARD_GRAVITY * beside
    for state in (AT_REST, MOTION):
        rows = found.rows.where(state=state, play=True)
        for joint in found.boom.joints:
            inner = found.boom.segments[joint.inner]
            width = inner.section_at(inner.start).face("z", 1).width
            whole, larger = (
                sum(abs(row.value) for row in rows.where(quantity=name, part=inner.name))
                for name in ("contact_force", "pad_force")
            )
            assert 0.5 * width * (2.0 * larger - whole) == pytest.approx(torque, rel=1e-7)
