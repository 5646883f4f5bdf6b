# SPDX-License-Identifier: LGPL-3.0-or-later
"""Elastic drives of a case, residual vibration in telescoping."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import cumulative_trapezoid

from protractile.cases import change, run_case
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import Excitation, History, PiecewiseLinear, Ramp, Sine
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import simulate
from protractile.dynamics.motion_laws import SCurve
from protractile.dynamics.trajectory import Trajectory
from protractile.dynamics.travel import RowTable, Travel
from protractile.runs.case.build import build_boom
from protractile.runs.case.motions import elastic_drives
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.response import lag
from protractile.runs.pipeline.residual_vibration import ResidualVibration, farthest_from_rest
from protractile.runs.report.drive_tables import stick_slip_table
from protractile.runs.report.figure_context import FigureContext
from protractile.runs.report.force_figures import drives
from tests.modal import modal_system
from tests.runs.case_texts import edited, read_case, refusal, shipped
from tests.runs.summaries import printed_check
from tests.runs.test_drive import DRAWN, ROPE

# Without play, at rest under loads downwards, so that pads press all the time.
PRESSED = {"play = 0.014": "play = 0.0", "load = 55.07": "load = -540.0"}
RESTS = {"[[joint]]": '[start]\nstate = "equilibrium"\n\n[[joint]]'}


def drawn_by(folder: Path, rope: str, **others: str) -> Case:
    changes = {**PRESSED, **RESTS, "least_overlap = 1.0 }": rope, **others}
    return read_case(folder, edited(DRAWN, *changes.items()))


def test_no_stick_slip_without_friction(tmp_path: Path) -> None:
    edits = ("least_overlap = 1.0 }", ROPE), ("friction = 0.2 ", "# ")
    assert refusal(tmp_path, edited(DRAWN, *edits)) == (
        "joint[1].drive.static_friction: nothing rubs in the joint; give it friction, or leave "
        "static_friction out"
    )


def test_drive_moves_all_outboard_masses() -> None:
    """Reference: analytic, the masses beyond each joint of the crane; units mm, t and s."""
    crane = shipped("crane-telescopes")
    case = change(crane, **{"joint.drive.stiffness": 4e6, "joint[2].drive.static_friction": 0.15})
    boom = build_boom(case)
    beyond = [sum(one.mass for one in boom.segments[number:]) for number in (1, 2, 3)]
    found = elastic_drives(case, boom)
    assert [one.mass for one in found.values()] == pytest.approx(beyond)
    shared = [[mass for mass, _ in one.coupled_drives] for one in found.values()]
    assert shared == [
        pytest.approx([beyond[1], beyond[2]]),
        pytest.approx([beyond[1], beyond[2]]),
        pytest.approx([beyond[2], beyond[2]]),
    ]
    assert [one.sticking for one in found.values()] == pytest.approx([1.0, 1.5, 1.0])
    assert beyond[2] > 350.0


def test_drive_holds_the_axial_weight(tmp_path: Path) -> None:
    """Reference: analytic, m g sin θ of 550.7 kg."""
    along = {
        "[[joint]]": "[gravity]\nangle = 30.0\n\n[[joint]]",
        "least_overlap = 1.0 }": ROPE + "\nlocked_at = 'tail'",
    }
    case = read_case(tmp_path, edited(DRAWN, *along.items()))
    (pulled,) = elastic_drives(case, build_boom(case)).values()
    assert pulled.thrust == pytest.approx(0.5 * 550.7 * 9.80665)


@pytest.mark.parametrize(
    ("rope", "slow", "told"),
    [
        (ROPE, False,
         "The drive of 'inner' moves 550.7 kg, with a frequency of 3.03 Hz and a damping ratio of "
         "2.38 %; against the largest static friction of 9.72 kN it sticks and slips below 0.791 "
         "m/s.\n"),
        (ROPE, True,
         "caution: the drive of 'inner' sticks and slips during its whole travel: it moves at 0.2 "
         "m/s at most, and moves smoothly from 0.791 m/s on; increase the speed, the stiffness or "
         "the damping\n"),
        (ROPE.replace("dashpot = 500.0, ", ""), True,
         "0.2 m/s at most, and has no damping; give it a dashpot\n"),
    ],
)  # fmt: skip
def test_check_predicts_stick_slip(tmp_path: Path, rope: str, slow: bool, told: str) -> None:
    """Reference: by hand, pads of 27 and 21.6 kN, 550.7 kg on 200 kN/m; the formula's speed."""
    slower = {"time = 5.0": "time = 40.0", "duration = 7.0": "duration = 41.0"}
    shown = printed_check(drawn_by(tmp_path, rope, **(slower if slow else {})), 300)
    assert told in shown
    assert ("caution" in shown) == slow


@pytest.mark.slow
def test_run_reports_stick_slip(tmp_path: Path) -> None:
    """Reference: analytic, friction plus m Δṡ/Δt in slip; the extension is command less lag."""
    short = {"time = 5.0": "time = 1.2", "duration = 7.0": "duration = 1.3"}
    case = drawn_by(tmp_path, ROPE.replace("2e5", "2e6"), **short)
    results = run_case(case, models=["kantorovich-5"])
    data = results.trajectories.sel(model="kantorovich-5")
    own = results.summary.models["kantorovich-5"].stick_slip["drive_force"]
    speed, force = data["extension_speed"].values, np.abs(data["drive_force"])
    # In slip, drive force less friction accelerates 550.7 kg.
    friction = 0.2 * np.abs(data["contact_force"].values).sum(axis=1)
    slips = np.minimum(speed[1:], speed[:-1]) > 0.0
    left = (data["drive_force"].values - friction)[1:] - 550.7 * np.diff(speed) / np.diff(
        data["time"]
    )
    assert np.abs(left[slips]).max() < 1e-9 * friction.max()
    assert 300 < slips.sum() < 1250
    come = (data["extension"] - data["drive_lag"]).values
    assert come == pytest.approx(cumulative_trapezoid(speed, data["time"], initial=0.0), abs=1e-4)
    assert own.energy_residual < 1e-12
    assert own.sticks >= 1
    assert 0.98 * own.peak < float(force.max()) <= own.peak
    assert own.speed == pytest.approx(np.abs(speed).max(), rel=0.01)
    assert own.behind == float(data["drive_lag"][-1])
    moving = np.diff(data["extension"], prepend=0.0) != 0.0
    assert own.mean == pytest.approx(float(force[moving].mean()))
    assert [column.cells[0] for column in stick_slip_table(results).columns] == [
        "kantorovich-5", "inner", own.mean, own.peak, own.sticks, own.slip, own.behind, own.speed,
        own.acceleration,
    ]  # fmt: skip
    measured = results.measure("kantorovich-5")
    assert (measured["drive_force"], measured["drive_slip"]) == (own.peak, own.slip)
    _, figure = drives(FigureContext(results))
    assert figure.title.startswith(f"Drive of inner: sticks {own.sticks} times, slips by up to ")
    # 0.1 m of the remaining overlap of 1 m.
    shown = results.case.model_copy(update={"shown_units": "mm-t-s"})
    late = xr.Dataset({"drive_lag": ("time", [-0.1])})
    (line,) = lag(Context(shown, results.boom, data=late))
    assert line.startswith(
        "'inner' lags up to 100 mm behind its drive, more than 1 % of the 1000 mm of "
    )


LOAD = '[[load]]\nsegment = "inner"\nx = "head"\nmagnitude = 1000.0\nramp = 0.2\n\n[[model]]'


def case(folder: Path, drive: str, extension: str = "5.0") -> Case:
    """Return a case without play, and so without chaos, whose ramping load swings the boom."""
    changes = {
        "drive = { travel = 4.0, time = 5.0, least_overlap = 1.0 }": drive,
        "extension = 5.0": f"extension = {extension}",
        "play = 0.014": "play = 0.0",
        "stiffness = 1e9": "stiffness = 1e7",
        # A flat boom without a drive needs the forces.
        "friction = 0.2": "normal_forces = [0.0, 0.0]\nfriction = 0.2",
        "duration = 7.0": "duration = 0.6",
        "[[model]]": LOAD,
    }
    return read_case(folder, edited(DRAWN, *changes.items()))


def swing_of(case: Case) -> ResidualVibration | None:
    answers = run_case(case, models=["kantorovich-5"]).summary.design
    return answers.models["kantorovich-5"].residual_vibration


def lifted(travel: float, time: float, *loads: History) -> GapSystem:
    """Return a mass on a spring of 1 N/m, with a spring of 3 N/m that a drive moves."""
    table = RowTable.interpolate(lambda s: np.array([[1.0 - 0.5 * s]]), [0.0, 1.0])
    spring, travels = (
        PowerContact(3.0, 1.0),
        [Travel(SCurve(travel, time), table, (("rows", 0),), "")],
    )
    system = modal_system([1.0], [1.0], [[1.0]], [spring], tip=[1.0])
    excitations = [Excitation(np.full(1, 2.0), load) for load in loads]
    return replace(system, travels=travels if travel else (), excitations=excitations)


@pytest.mark.slow
def test_a_slow_drive_swings_about_the_rest_of_each_place() -> None:
    """Reference: analytic, 1 N on springs of 1 + 3 N/m: 1/4 m about 1/4 m without a motion.

    From 1/4 to 1/(1 + 3/4) m; a sudden motion vibrates by all of it.
    """
    fixed = lifted(0.0, 1.0)
    assert farthest_from_rest(fixed, simulate(fixed, 4.0))[0] == pytest.approx(0.25, rel=1e-4)
    way = 1.0 / 1.75 - 0.25
    slow, fast = (
        farthest_from_rest(system, simulate(system, duration, position=[0.25]))[0]
        for system, duration in ((lifted(1.0, 30.0), 30.0), (lifted(1.0, 1e-3), 4.0))
    )
    assert slow < 0.02 * way
    assert fast == pytest.approx(way, rel=1e-3)


def of_follower(load: History) -> float:
    """Return the vibration in m of a tip that is always in equilibrium under a load of 2 N."""
    time = np.linspace(0.0, 10.0, 10001)
    row = 1.0 - 0.5 * SCurve(1.0, 10.0)(time)
    tip = (1.0 + 2.0 * load(time)) / (1.0 + 3.0 * row**2)
    data = xr.Dataset({"tip": ("time", tip)}, {"time": time})
    return farthest_from_rest(lifted(1.0, 10.0, load), Trajectory(data, tip[:, None]))[0]


WAVE = PiecewiseLinear(np.arange(0.0, 10.0, 0.1).tolist(), [0.0, 1.0, 1.0, 0.0] * 25)


@pytest.mark.parametrize("load", [Sine(5.0), Ramp(0.2), WAVE])
def test_quasi_static_motion_has_no_residual_vibration(load: History) -> None:
    """Reference: analytic, F/(1 + 3 r²); the load moves the tip by at least 0.5 m."""
    assert of_follower(load) < 0.01 * 0.5


def test_too_many_reversals_are_an_error() -> None:
    """Reference: by hand. 5.5 Hz reverse 110 times in 10 s, with four equilibria each."""
    with pytest.raises(NumericsError, match=r"^loads and drives reverse 110 times, more than 100$"):
        of_follower(Sine(5.5))


@pytest.mark.slow
def test_levels_are_those_of_booms_without_a_drive(tmp_path: Path) -> None:
    """Reference: the boom built at the initial and at the final extension."""
    drawn = swing_of(case(tmp_path, "drive = { travel = 4.0, time = 0.4 }"))
    assert drawn.speed == pytest.approx(10.0)
    for extension, level in (("5.0", drawn.initial), ("9.0", drawn.final)):
        standing = run_case(case(tmp_path, "", extension), models=["kantorovich-5"])
        data = standing.trajectories.sel(model="kantorovich-5")
        ramp = np.minimum(data["time"].values / 0.2, 1.0)
        curves = standing.curves.where(state="rest", play=True, segment="inner")
        first, last = (curve.values["deflection"][-1] for curve in curves)
        rest = first + ramp * (last - first)
        assert level == pytest.approx(np.abs(data["tip"].values - rest).max(), rel=1e-3)
    # There is none without a drive, or if it does not end.
    assert swing_of(case(tmp_path, "")) is None
    assert swing_of(case(tmp_path, "drive = { travel = 4.0, time = 0.7 }")) is None
