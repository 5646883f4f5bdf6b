# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slewing and luffing of a case: loads, axial forces, positions, messages for bad input."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp, trapezoid

from protractile.beam_model.lines import lines
from protractile.cases import change, run_case
from protractile.dynamics.frame_motion import FrameMotion
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import build_motion
from protractile.dynamics.motion_laws import SCurve, Stroke
from protractile.geometry.boom import Boom, Material, PointMass, Segment
from protractile.geometry.cylinder import Cylinder
from protractile.geometry.joint import Drive
from protractile.geometry.support import Support
from protractile.runs import CASES
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.motion_tables import HoistTable, LuffTable, SlewTable
from protractile.runs.case.motions import turning_changes, turning_loads
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context, State
from protractile.runs.cautions.response import swings, turning
from protractile.runs.pipeline.estimates import Preview
from protractile.runs.pipeline.models import axial_travels
from protractile.runs.pipeline.turning import drive_moments, shaper_lines, turning_lines
from protractile.runs.report.drive_tables import luffing_table
from tests.runs.case_texts import read_case, refused, shipped
from tests.runs.summaries import static_tip

ARM = (CASES / "inspection-arm.toml").read_text(encoding="utf-8")
SLEW = "[slew]\ntravel = 60.0\nspeed = 15.0\nramp = 1.0\n"
LUFF = "[luff]\ntravel = 10.0\ntime = 3.0\n"


def test_bar_turned_with_a_constant_acceleration() -> None:
    """Reference: analytic, −4 α̈ Σ (−1)ⁿ⁺¹ L (1 − cos ω t)/(λ ω)² under −m̄ x α̈."""
    length, mass, bending = LENGTH, MASS, 2.1e11 * SECOND_MOMENT
    system, _ = turning_beam(FrameMotion(luff=Stroke(60.0, 20.0, 0.8)))
    motion = FixedStep(1.0e-3)(build_motion(system, 0.8, 1.0e-3, at_rest=True))
    roots = np.array([1.8751040687, 4.6940911330, 7.8547574382, 10.9955407349, 14.1371683910])
    omega = roots**2 * np.sqrt(bending / mass) / length**2
    signs = (-1.0) ** np.arange(5)
    turn = np.deg2rad(20.0) / 0.8
    time = motion.time[:, None]
    series = 4.0 * turn * length * signs * (1.0 - np.cos(omega * time)) / (roots * omega) ** 2
    static = 11.0 * mass * turn * length**5 / (120.0 * bending)
    assert (4.0 * turn * length * signs / (roots * omega) ** 2).sum() == pytest.approx(
        static, rel=1e-5
    )
    assert motion.tip.values == pytest.approx(-series.sum(axis=1), abs=2e-4 * static)
    assert motion.energy_residual < 1e-12


def slewing_arm(tmp_path: Path, *tables: str, arm: str = ARM) -> Case:
    elements = f"[[model]]{arm.split('[[model]]')[2]}"
    return read_case(tmp_path, "\n".join([arm[: arm.index("[wind]")], *tables, elements]))


@pytest.mark.slow
def test_luffed_arm(tmp_path: Path) -> None:
    """Reference: the arm built at the angle. Its axial weight increases bending by 1.3 %."""
    luffed = slewing_arm(tmp_path, LUFF.replace("10.0", "50.0"))
    there = slewing_arm(tmp_path, arm=ARM.replace("angle = 0.0", "angle = 50.0"))
    assert static_tip(luffed, 3.0) == pytest.approx(static_tip(there, 0.0), rel=1e-3)


def test_inertia_loads_of_an_extending_segment_on_a_turning_boom() -> None:
    """Reference: by hand, −m a of a mass at its current position, minus −m a at the initial one."""
    frame = FrameMotion(slew=SCurve(90.0, 2.0), radius=1.0)
    drive = Drive(SCurve(3.0, 2.0), ("inner", "outer"))
    segments = build_boom(shipped("inspection-arm")).segments
    joint = replace(build_boom(shipped("inspection-arm")).joints[1], drive=drive)
    *_, mass = turning_loads(frame, segments, (joint,))
    time = np.array([0.7])
    place, speed = 1.0 + segments[2].end + drive.history(time), drive.history.rate(time, 1)
    turn, faster = (np.deg2rad(frame.slew.rate(time, order)) for order in (1, 2))
    push = mass.magnitude * mass.history(time)
    assert (mass.direction, mass.x) == ("y", segments[2].end)
    assert push == pytest.approx(-280.0 * (place * faster + 2.0 * turn * speed))


@pytest.mark.slow
def test_results_of_slewing_and_luffing(tmp_path: Path) -> None:
    """Reference: the energy balance; by hand, the numbers of the case and of a swinging load."""
    case = slewing_arm(tmp_path, SLEW, LUFF, "[damping]\nmodal = 0.02")
    results = run_case(change(case, **{"time.duration": 0.1, "time.step": 2e-4}))
    (summary,) = results.summary.models.values()
    assert summary.energy_residual < 1e-11
    lines = list(turning_lines(case))
    assert lines == [
        "Slews by 60 degrees from 0 to 5 s, at 15 degrees/s at most.",
        "Luffs by 10 degrees from 0 to 3 s, at 6.667 degrees/s at most.",
    ]
    # 15 of 360 degrees per second over 0.5 Hz; luffing stays below 5 %.
    boom = build_boom(case)
    (slew,) = turning(Context(case, boom, [State("in beam", frequencies=[0.5])]))
    assert slew.startswith("slew: the boom turns with 8.33 % of its first circular freq")
    # arctan of 0.8 m over 2 m; 0.39 m are just small.
    hung = HoistTable(mass=5000.0, stiffness=1.0e6, hanging=True, pendulum=2.0)
    aside = ("model", "time"), [[0.0, -0.8], [0.0, 0.39]]
    data = xr.Dataset({"swing_aside": aside}, {"model": ["far", "near"]})
    assert [*swings(Context(case.model_copy(update={"hoist": hung}), boom, data=data))] == [
        "hoist.pendulum: in far the load swings by 21.8 degrees; its model is for small angles"
    ]


@pytest.mark.slow
def test_shaper_proposed_by_check(tmp_path: Path) -> None:
    """Reference: without the shaper. A thousandth remains of a vibration without play."""
    slew = "[damping]\nmodal = 0.02\n[slew]\ntravel = 12.0\ntime = 1.5\n"
    plain = slewing_arm(tmp_path, slew)
    model = plain.models[0].model_copy(update={"bonded_joints": True})
    plain = change(
        plain.model_copy(update={"models": (model,)}),
        **{"time.duration": 3.6, "time.step": 2e-3, "time.output_step": 1e-2},
    )
    motion = Preview(CheckedCase(plain)).motion(model)
    (line,) = shaper_lines(plain, motion.system, motion.position)
    offered = re.fullmatch(
        r"slew: shaper = \[\[([\d.]+), ([\d.]+)\]\] would leave no vibration of these modes, "
        r"without play, and takes ([\d.]+) s longer\.",
        line,
    )
    frequency, damping, longer = map(float, offered.groups())
    vibrations = []
    for shaper, end in (((), 1.5), (((frequency, damping),), 1.5 + longer)):
        slewed = plain.slew.model_copy(update={"shaper": shaper})
        data = run_case(plain.model_copy(update={"slew": slewed})).trajectories.isel(model=0)
        sway = data["tip_lateral"].sel(time=slice(end, end + 1.5)).values
        vibrations.append(0.5 * np.ptp(sway))
    assert vibrations[1] < 0.01 * vibrations[0]


def test_moment_and_work_of_slewing(tmp_path: Path) -> None:
    """Reference: by hand, J ψ̈ and ½ J ψ̇² of a rigid boom, and 0 after the end."""
    case = slewing_arm(tmp_path, SLEW)
    boom, time = build_boom(case), np.linspace(0.0, 6.0, 6001)
    (moment, power) = drive_moments(case, boom, xr.Dataset(coords={"time": time}))["slew"]
    inertia = sum(
        segment.mass_per_length * (segment.end**3 - segment.start**3) / 3.0
        + sum(point.mass * point.x**2 for point in segment.all_masses)
        for segment in boom.segments
    )
    rate = np.deg2rad(15.0)
    work = np.cumsum(power) * 1e-3
    assert moment[500] == pytest.approx(inertia * rate, rel=1e-3)
    assert work[2000] == pytest.approx(0.5 * inertia * rate**2, rel=2e-3)
    assert work[-1] == pytest.approx(0.0, abs=2e-3 * work[2000])


def test_moments_of_a_swinging_load() -> None:
    """Reference: by hand. A load off the tip by s pulls it by W s/l horizontally: on the way of the
    slewing drive, and down about the foot. At rest at 60 degrees, 1 m in front of the axis.
    """
    weight, length = 5000.0 * 9.80665, 2.0
    hung = HoistTable(mass=5000.0, stiffness=1.0e6, hanging=True, pendulum=length)
    boom = build_boom(shipped("hoist"))
    turning = {
        "slew": SlewTable(travel=60.0, time=5.0, radius=1.0),
        "luff": LuffTable(travel=10.0, time=5.0),
    }
    case = shipped("hoist").model_copy(update={"hoist": hung, **turning})

    def moments(aside: float, out: float) -> list[float]:
        data = motion(rope_force=[weight] * 3, swing_aside=[aside] * 3, swing_out=[out] * 3)
        data["rope_force"].attrs["weight"] = weight
        return [float(moment[0]) for moment, _ in drive_moments(case, boom, data).values()]

    still, swung = np.array(moments(0.0, 0.0)), np.array(moments(0.3, 0.2))
    reach, up = 1.0 + 0.5 * boom.tip, np.sqrt(0.75) * boom.tip
    added = weight / length * np.array([-0.3 * reach, 0.2 * up])
    assert swung - still == pytest.approx(added, rel=1e-9)


def test_luffing_cylinder() -> None:
    """Reference: by hand, a right angle at the pin between a lug and a ground 3 m and 4 m away."""
    jack = Cylinder(0, 3.0, depth=0.5, ground=(0.0, -4.5), stiffness=1.0)
    foot = Support(0.0, "hinged", depth=0.5)
    assert (jack.length, jack.arm(foot)) == pytest.approx((5.0, 12.0 / 5.0))
    raised = jack.luffed(np.deg2rad(90.0), foot)
    assert (raised.length, raised.arm(foot)) == pytest.approx((7.0, 0.0), abs=1e-12)


@pytest.mark.slow
def test_table_of_luffing() -> None:
    """Reference: analytic, the cylinder's length by the cosine rule. Its lever arm is twice the
    area of the triangle of foot, lug and ground over this length.
    """
    case = shipped("crane")
    luff = LuffTable(travel=-5.0, time=1.0)
    update = {"luff": luff, "models": case.models[:1], "load_cases": (), "combinations": ()}
    results = run_case(change(case.model_copy(update=update), **{"time.duration": 0.1}))
    cells = {column.title: column.cells[0] for column in luffing_table(results).columns}
    lug, ground = np.hypot(4.2, 0.55), np.hypot(1.6, 1.7)
    opening = np.arctan2(1.7, 1.6) - np.arctan2(0.55, 4.2)
    data = results.trajectories.isel(model=0)
    turned = opening + np.deg2rad(luff.history("")(data["time"].values))
    length = np.sqrt(lug**2 + ground**2 - 2.0 * lug * ground * np.cos(turned))
    arms = lug * ground * np.sin(turned) / length
    forces = arms[0] / arms * data["cylinder_force"].values
    assert cells["at the end"] == pytest.approx(length[-1])
    found = cells["least force"], cells["largest force"]
    assert found == pytest.approx((forces.min(), forces.max()), rel=1e-6)


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        ("[slew]\ntravel = 60.0\nspeed = 15.0\n",
         "slew.ramp: missing; a speed reached at once takes an endless force; it is the time in s "
         "in which the drive reaches this speed, and in which it stops; at once unless given"),
        (LUFF.replace("10.0", "95.0"),
         "luff.travel: leads to 95 degrees; the angle must stay within ± 90"),
        (SLEW + "[hoist]\nmass = 100.0\nstiffness = 1e6\ntravel = 1.0\ntime = 1.0\n",
         "slew: the load of hoist lies on the ground; give hoist.hanging = true"),
        ('[slew]\nfile = "angles.csv"\n',
         "slew.file: 'angles.csv' has a unit in line 1, column 2 that is no unit of an angle; give "
         "deg or another unit of the kind"),
    ],
)  # fmt: skip
def test_bad_input(tmp_path: Path, tables: str, message: str) -> None:
    """Reference: exact words."""
    write_angles(tmp_path, "m")
    with refused(f"{tmp_path}/case.toml: {message}"):
        slewing_arm(tmp_path, tables)


def write_angles(folder: Path, unit: str) -> None:
    (folder / "angles.csv").write_text(f"t [s],psi [{unit}]\n0,0\n2,0.5\n", encoding="utf-8")


@pytest.mark.parametrize(("unit", "factor"), [("deg", 1.0), ("rad", 180.0 / np.pi)])
def test_unit_of_angles_in_a_file(tmp_path: Path, unit: str, factor: float) -> None:
    """Reference: analytic."""
    write_angles(tmp_path, unit)
    case = slewing_arm(tmp_path, '[slew]\nfile = "angles.csv"\n')
    assert case.slew.table == ((0.0, 0.0), (2.0, pytest.approx(0.5 * factor)))


TIME = np.array([0.0, 2.5, 5.0])


def motion(**variables: list[float]) -> xr.Dataset:
    found = {name: ("time", values) for name, values in variables.items()}
    return xr.Dataset(found, {"time": TIME})


LENGTH, MASS, SECOND_MOMENT = 10.0, 100.0, 1.0e-4
UNIT = np.sqrt(2.1e11 * SECOND_MOMENT / MASS) / LENGTH**2


def turning_beam(frame: FrameMotion, tip: float = 0.0) -> tuple[GapSystem, GapSystem]:
    """Return a clamped beam with a tip mass in kg in a frame, without and with axial forces."""
    beam = Segment(
        "beam", 0.0, LENGTH, Material(2.1e11, 0.3, 7850.0), MASS, SECOND_MOMENT, 0.0,
        supports=(Support(0.0, "clamped"),), masses=(PointMass(LENGTH, tip),) if tip else (),
    )  # fmt: skip
    changes = tuple(turning_changes(frame, (beam,), (), 0.0))
    loads = tuple(load for load in turning_loads(frame, (beam,), ()) if load.direction == "z")
    boom = Boom((beam,), (), loads, axial_changes=changes)
    model = BeamElements(boom, element_length=0.5, theory="euler-bernoulli", rotary_inertia=False)
    system = model.system()
    travels = axial_travels(system, boom, lines(boom, model.segments(boom)))
    return system, replace(system, travels=[*travels])


@pytest.mark.parametrize(
    ("speed", "flapping"), [(1.0, 3.6816), (2.0, 4.1373), (3.0, 4.7973), (6.0, 7.3604)]
)
@pytest.mark.parametrize("key", ["slew", "luff"])
def test_frequency_of_a_rotating_cantilever(key: str, speed: float, flapping: float) -> None:
    """Reference: published, Wright et al. (1982), in √(E J/m̄)/L²; f² less speed² in the plane."""
    rate = np.rad2deg(speed * UNIT)
    system, moving = turning_beam(FrameMotion(**{key: Stroke(20.0 * rate, rate, 1.0)}))
    found = np.sqrt(moving.at_time(10.0).in_own_modes().omega2.min()) / UNIT
    expected = flapping if key == "slew" else np.sqrt(flapping**2 - speed**2)
    assert found == pytest.approx(expected, rel=1e-3)
    assert abs(np.sqrt(system.omega2.min()) / UNIT - 3.5160) < 1e-3


@pytest.mark.slow
def test_luffing_beam_column() -> None:
    """Reference: other code, scipy's LSODA, three modes; the weight rises to P_crit/6."""
    frame = FrameMotion(luff=SCurve(80.0, 1.0), gravity=10.0)
    system, moving = turning_beam(frame, tip=2.0e4)
    motion = FixedStep(5.0e-4)(build_motion(moving, 2.0, 0.01, at_rest=False))
    assert motion.energy_residual < 1e-11
    x = np.linspace(0.0, LENGTH, 2001)
    # Polynomials of a clamped end, with their masses, stiffnesses and axial forces by quadrature.
    powers = np.arange(2, 7)[:, None]
    w, slope = (x / LENGTH) ** powers, powers * (x / LENGTH) ** (powers - 1) / LENGTH
    bent = powers * (powers - 1) * (x / LENGTH) ** (powers - 2) / LENGTH**2

    def integral(one: np.ndarray, other: np.ndarray) -> np.ndarray:
        return np.asarray(trapezoid(one[:, None] * other, x, axis=-1))

    mass = MASS * integral(w, w) + 2.0e4
    stiffness = 2.1e11 * SECOND_MOMENT * integral(bent, bent)
    beyond = MASS * (LENGTH - x) + 2.0e4, 0.5 * MASS * (LENGTH**2 - x**2) + 2.0e4 * LENGTH
    pressed = [integral(force * slope, slope) for force in beyond]
    first = MASS * trapezoid(w * x, x) + 2.0e4 * LENGTH
    even = MASS * trapezoid(w, x) + 2.0e4

    def rates(time: float, state: np.ndarray) -> np.ndarray:
        angle, speed, faster = (frame.luff_angle(np.array(time), order) for order in range(3))
        softer = 10.0 * np.sin(angle) * pressed[0] + speed**2 * (mass - pressed[1])
        load = -10.0 * np.cos(angle) * even - faster * first
        # The loads of the model leave out the weight at t = 0.
        load += 10.0 * even
        pull = load - (stiffness - softer) @ state[:5]
        return np.concatenate([state[5:], np.linalg.solve(mass, pull)])

    exact = solve_ivp(rates, (0.0, 2.0), np.zeros(10), "LSODA", motion.time, rtol=1e-5, atol=1e-7)
    tip = exact.y[:5].sum(axis=0)
    assert motion.tip.values == pytest.approx(tip, abs=2e-3 * np.abs(tip).max())
    plain = FixedStep(5.0e-4)(build_motion(system, 2.0, 0.01, at_rest=False))
    assert np.abs(plain.tip.values - tip).max() > 0.05 * np.abs(tip).max()
