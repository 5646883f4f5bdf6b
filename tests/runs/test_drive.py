# SPDX-License-Identifier: LGPL-3.0-or-later
"""Drives of a case: checks, results, power, elastic drives, residual vibration in telescoping."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib import rc_context
from scipy.integrate import cumulative_trapezoid

from protractile.analysis.rows import EXTENDED, MOTION, REST
from protractile.cases import change, run_case
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import (
    Excitation,
    History,
    PiecewiseLinear,
    Ramp,
    Sine,
    resolving_times,
)
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import simulate
from protractile.dynamics.motion_laws import SCurve
from protractile.dynamics.trajectory import Trajectory
from protractile.dynamics.travel import RowTable, Travel
from protractile.runs import CASES
from protractile.runs.case.build import build_boom
from protractile.runs.case.motions import elastic_drives
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.response import lag
from protractile.runs.pipeline.residual_vibration import ResidualVibration, farthest_from_rest
from protractile.runs.report import theme
from protractile.runs.report.boom_drawing import boom_sheet
from protractile.runs.report.drive_tables import drive_table, stick_slip_table
from protractile.runs.report.figure_context import FigureContext
from protractile.runs.report.figures import figures_of
from protractile.runs.report.force_figures import drives
from protractile.runs.report.result_tables import record_tables, rest_tables
from protractile.runs.report.summary_table import summary_table
from tests.modal import modal_system
from tests.runs.case_texts import edited, read_case, refusal, shipped
from tests.runs.summaries import printed_check

DRAWN = (CASES / "drawn-out.toml").read_text(encoding="utf-8")
DRIVE = "drive = { travel = 4.0, time = 5.0, least_overlap = 1.0 }\n"
SHORT, FAST = ("duration = 7.0", "duration = 0.3"), ("time = 5.0", "time = 0.2")
drawn_out = partial(edited, DRAWN)
ROPE = "least_overlap = 1.0, stiffness = 2e5, dashpot = 500.0, static_friction = 0.3 }"
TABLE = "drive = { table = [[0.0, 0.0], [1.0, 2.0], [4.0, -1.0]] }\n"


@pytest.mark.parametrize(
    ("drive", "ways", "reach"),
    [
        (DRIVE, [0.0, 2.0, 4.0], (0.0, 4.0)),
        ("drive = { travel = -3.0, time = 2.0, start = 1.5 }\n", [0.0, -1.5, -3.0], (-3.0, 0.0)),
        ("drive = { travel = 4.0, speed = 1.0, ramp = 1.0 }\n", [0.0, 2.0, 4.0], (0.0, 4.0)),
        (TABLE, [0.0, 0.5, -1.0], (-1.0, 2.0)),
        ('drive = { file = "ways.csv" }\n', [0.0, 0.5, -1.0], (-1.0, 2.0)),
        ("drive = { travel = 1e-300, time = 5.0 }\n", None, None),
    ],
)
def test_a_drive_has_a_history(
    tmp_path: Path, drive: str, ways: list[float] | None, reach: tuple[float, float] | None
) -> None:
    """Reference: analytic, the extension at the start, in the middle and at the end."""
    (tmp_path / "ways.csv").write_text("t (ms);way (mm)\n0;0\n1000;2000\n4000;-1000\n")
    found = build_boom(read_case(tmp_path, drawn_out((DRIVE, drive)))).joints[0].drive
    assert (found is None) == (ways is None)
    if found is not None:
        assert found.history(np.array([0.0, 2.5, 6.0])) == pytest.approx(ways)
        assert found.reach == pytest.approx(reach)
        assert found.carriers == ("inner", "outer")


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        (DRIVE, "drive = { travel = 4.0 }\n",
         "joint[1].drive.time: missing; it is the duration of the travel in s, on a smooth "
         "S-curve, or give speed, table or file"),
        (DRIVE, "drive = { travel = 4.0, time = 5.0, speed = 1.0 }\n",
         "joint[1].drive.speed: time is given; leave one of them out"),
        (DRIVE, "drive = { travel = 4.0, time = 5.0, ramp = 1.0 }\n",
         "joint[1].drive.ramp: time is given; only a speed has a ramp"),
        (DRIVE, "drive = { travel = 4.0, time = 1e-9 }\n",
         "joint[1].drive.time: must be at least 1e-06 s, got 1e-09 s"),
        (DRIVE, "drive = { travel = 1e308, speed = 1e-300 }\n",
         "joint[1].drive.speed: never comes to 1e+308 m; give a larger one"),
        (DRIVE, TABLE.replace("table", "travel = 1.0, table"),
         "joint[1].drive.travel: table is given; leave one of them out"),
        (DRIVE, TABLE.replace("[0.0, 0.0]", "[0.0, 0.5]"),
         "joint[1].drive.table: must be 0 m at t = 0, where the boom is as it is given, got 0.5 m"),
        ('stations = ["tail", "head"]', "stations = [5.0, 10.0]",
         "joint[1].stations: 5 m does not tell on which segment the station moves as "
         "'inner' telescopes; give 'tail' or 'head', or a distance from one"),
        ('kind = "kantorovich"\nterms = [2, 3]\nbase = "as printed"',
         'kind = "shell"\ncontact_line = "surface"',
         "model[1]: the shell 'kantorovich-5' touches over the whole overlap, which changes as it "
         "telescopes; leave contact_line out, or joint[1].drive"),
        ('kind = "kantorovich"\nterms = [2, 3]\nbase = "as printed"',
         'kind = "shell"\nmodes = 40',
         "model[1]: the shell 'kantorovich-5' needs its own number of coordinates for all "
         "extensions; leave modes out, or joint[1].drive"),
        ('theory = "timoshenko"',
         'theory = "timoshenko"\ncalibrated_by = { name = "fine", kind = "shell" }',
         "model[3]: the springs of 'timoshenko' are valid at the initial extension, and cannot "
         "telescope; leave calibrated_by out, or joint[1].drive"),
        ('theory = "euler-bernoulli"', 'theory = "euler-bernoulli"\nbonded = true',
         "model[2]: 'beam-fe' is bonded, and cannot telescope; leave the model out, or "
         "joint[1].drive"),
        ("[[joint]]", "[[joint]]\nlocked_at = { tail = 2.0 }",
         "joint[1].locked_at: 7 m leaves the overlap as 'inner' telescopes by 4 m; make the travel "
         "shorter, or move the place"),
        (DRIVE, "locked_at = 4.0\ndrive = { travel = -3.0, time = 5.0 }\n",
         "joint[1].locked_at: 'inner' retracts by 3 m, past 4 m, where it is pushed; make "
         "the travel shorter, or move the place"),
        ("least_overlap = 1.0 }", "static_friction = 0.3 }",
         "joint[1].drive.static_friction: without a stiffness the drive is stiff, and its "
         "segment neither sticks nor slips; give stiffness, or leave static_friction out"),
        ("least_overlap = 1.0 }", ROPE.replace("0.3", "0.1"),
         "joint[1].drive.static_friction: must be at least the joint's friction of sliding, "
         "0.2, got 0.1"),
        ("least_overlap = 1.0 }", ROPE.replace("2e5", "1e12"),
         "joint[1].drive.stiffness: must be at most 2.17e+10 N/m for the 550.7 kg that it draws, "
         "got 1e+12 N/m; leave it out where the drive is stiff"),
        ("least_overlap = 1.0 }", ROPE.replace("500.0", "1e9"),
         "joint[1].drive.dashpot: must be at most 3.46e+06 N s/m for the 550.7 kg that it draws, "
         "got 1e+09 N s/m; leave it out where the drive is stiff"),
    ],
)  # fmt: skip
def test_slips_in_a_drive(tmp_path: Path, before: str, after: str, message: str) -> None:
    """Reference: exact message."""
    assert refusal(tmp_path, drawn_out((before, after))) == message


@pytest.mark.usefixtures("unprinted")
def test_run_reports_its_drive(tmp_path: Path) -> None:
    """Reference: analytic, the travels of the case, and the drive force from contact forces."""
    results = run_case(read_case(tmp_path, drawn_out(SHORT, FAST)), models=["kantorovich-5"])
    data = results.trajectories.sel(model="kantorovich-5")
    assert float(data["extension"][-1]) == pytest.approx(4.0)
    force, power = data["drive_friction"].values, data["drive_power"].values
    moving = np.diff(data["extension"], prepend=0.0) > 0.0
    rubbing = 0.2 * np.abs(data["contact_force"]).sum("station")
    assert force == pytest.approx(np.where(moving, rubbing, 0.0))
    assert force.max() > 100.0
    assert results.summary.models["kantorovich-5"].energy_residual < 1.0e-4
    cells = {column.heading: column.cells[0] for column in drive_table(results).columns}
    told = {
        "against friction:\nmean, kN": force[1:201].mean(), "at most\nkN": force.max(),
        "power, at most\nkW": power.max(), "work\nkJ": 1.0e-3 * power.sum(),
    }  # fmt: skip
    assert {heading: cells[heading] for heading in told} == pytest.approx(told, rel=1e-6)
    # With 1 m of overlap 14 mm of play turn by 14 mrad, which lifts the tip, 10 m on, by 133 mm;
    # the lever rule's forces press contacts of 1e9 N/m in by 2.2 and 2.8 µm.
    rows = results.rows.where(model="kantorovich-5", play=True)
    begun, ended, moved = (
        rows.where(state=state, quantity="tip")[0] for state in (REST, EXTENDED, MOTION)
    )
    assert (begun.time, ended.time) == pytest.approx((0.0, 0.2))
    turned, tilted, pressed = (
        [row.value for row in rows.where(state=EXTENDED, quantity=name)]
        for name in ("rotation", "rotation_tip", "contact_force")
    )
    assert turned == pytest.approx([0.014 + 4.956e-6], abs=1e-8)
    assert tilted == pytest.approx([-0.007 - 2.2e-6 + 0.14004956], abs=1e-7)
    assert pressed == pytest.approx([-2202.8, 2753.5], rel=1e-4)
    assert rows.at_rest(moved) == abs(ended.value)
    # What the report shows at rest is the boom where its tip is farthest.
    tilts, contacts, _ = rest_tables(results)
    assert [c.cells for c in tilts.columns[2:]] == [turned, tilted]
    assert contacts.columns[1].cells == pressed
    # Both stand for too short to swing farther than they start.
    table = summary_table(results)
    cells = dict(zip(table.columns[0].cells, table.columns[1].cells, strict=True))
    standing = ["(with drives at rest", f"{1e3 * begun.value:.1f}, {1e3 * ended.value:.1f})"]
    assert str(cells["Residual vibration of the tip, mm"]).splitlines()[1:] == standing
    swing = results.summary.design.models["kantorovich-5"].residual_vibration
    (table,) = record_tables(results)
    told = swing.tip, swing.time, swing.initial, swing.final
    assert [c.cells for c in table.columns] == [["kantorovich-5"], *([value] for value in told)]
    drawn = {figure.name: figure for figure in figures_of(results)}
    # By hand, the play's lever, and elements: 7 mm of bending.
    assert "tip at 140.4 mm in kantorovich-5" in str(drawn["at-rest"].title)
    assert drawn["drive"].title.startswith("Drive of inner: up to ")


def test_drive_works_against_axial_forces(tmp_path: Path) -> None:
    """Reference: analytic, half of 550.7 kg and a rope of 20 kN over 4 m, beside friction and
    bending.
    """
    text = drawn_out(SHORT, FAST, ("friction = 0.2 ", "locked_at = 1.0\nfriction = 0.2 "))
    pressed = "[gravity]\nacceleration = 10.0\nangle = 30.0\n[[axial]]\nforce = 2e4\n"
    data = run_case(read_case(tmp_path, text + pressed), models=["kantorovich-5"]).trajectories
    data = data.sel(model="kantorovich-5")
    work = float(data["drive_power"][1:].sum()) * 1.0e-3
    rubbed = float((data["drive_friction"][1:] * np.diff(data["extension"])).sum())
    along = work - rubbed - float(data["drive_work"][-1])
    assert along == pytest.approx(4.0 * (0.5 * 5507.0 + 2.0e4), rel=1e-6)


def test_drawing_shows_the_extension_of_a_segment() -> None:
    """Reference: the case. The inner segment of 10 m starts at 5 m and travels 4 m."""
    case = shipped("drawn-out")
    with rc_context(theme.RC):
        sheet = boom_sheet(case, build_boom(case))
    (dashed,) = [patch for patch in sheet.axes[1].patches if patch.get_linestyle() == "--"]
    x = dashed.get_xy()[:, 0]
    assert (x.min(), x.max()) == pytest.approx((9.0, 19.0))
    assert sheet.axes[1].get_xlim()[1] > 19.0
    assert "extended position" in [text.get_text() for text in sheet.legends[0].get_texts()]


def test_resolving_times_have_both_ends() -> None:
    """Reference: analytic. Kinks very near to a sampled time replace it."""
    kinks = (1.0e-9, 2.5 + 1.0e-9, 5.0 - 1.0e-9)
    times = resolving_times([PiecewiseLinear(kinks, (0.0, 1.0, 0.0))], 5.0)
    assert times[[0, 1, -2, -1]].tolist() == [0.0, kinks[0], kinks[2], 5.0]
    assert kinks[1] in times
    assert 2.5 not in times


def test_check_prints_drives() -> None:
    """Reference: the case; analytic, an S-curve's largest speed is twice its mean."""
    shown = printed_check(shipped("drawn-out"))
    line = "A drive extends 'inner' by 4 m from 0 to 5 s, at 1.6 m/s at most; the smallest overlap "
    assert f"{line}is 1 m.\n" in shown


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
