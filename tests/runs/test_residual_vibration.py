# SPDX-License-Identifier: LGPL-3.0-or-later
"""Residual vibration in telescoping, and admissible speeds."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure as Sheet

from dynamics.contact import PowerContact
from dynamics.drive.row_table import RowTable
from dynamics.drive.travel import Travel
from dynamics.excitation import Excitation, History, PiecewiseLinear, Ramp, SCurve, Sine
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem, Observer
from dynamics.integrator import simulate
from dynamics.trajectory import Trajectory
from protractile.cases import run_case
from runs import CASES
from runs.case.schema import Case
from runs.pipeline.residual_vibration import ResidualVibration, farthest_from_rest
from runs.report import theme
from runs.sweep.residual_vibration import (
    VibrationCurve,
    admissible_speed,
    describe,
    draw_vibration,
    vibration_curves,
)
from tests.runs.case_texts import edited, read_case

# No play and a load that ramps: no chaos, and swings that are no mere distance of the start.
DRAWN = (CASES / "drawn-out.toml").read_text(encoding="utf-8")
PLAYLESS = "play = 0.0"
LOAD = '[[load]]\nsegment = "inner"\nx = "head"\nmagnitude = 1000.0\nramp = 0.2\n\n[[model]]'


def case(folder: Path, drive: str, extension: str = "5.0") -> Case:
    changes = {
        "drive = { travel = 4.0, time = 5.0, least_overlap = 1.0 }": drive,
        "extension = 5.0": f"extension = {extension}",
        "play = 0.014": PLAYLESS,
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


def lifted(travel: float, time: float) -> GapSystem:
    """Return a mass on a spring of 1 N/m, with a spring of 3 N/m that a drive moves."""
    one = np.ones(1)
    table = RowTable.interpolate(lambda s: np.array([[1.0 - 0.5 * s]]), [0.0, 1.0])
    spring = PowerContact(3.0, exponent=1.0)
    system = GapSystem(one, one, one[None], [spring], np.array([0]), [0.0], {"tip": Observer(one)})
    return replace(system, travels=[Travel(SCurve(travel, time), table, (("rows", 0),), "")])


def test_fixed_boom_vibrates_with_its_initial_amplitude() -> None:
    """Reference: analytic. 1 N on springs of 1 + 3 N/m: 1/4 m about 1/4 m."""
    system = replace(lifted(0.0, 1.0), travels=())
    swing, _ = farthest_from_rest(system, simulate(system, 4.0))
    assert swing == pytest.approx(0.25, rel=1e-4)


def test_a_slow_drive_swings_about_the_rest_of_each_place() -> None:
    """Reference: analytic, from 1/4 to 1/(1 + 3/4) m; a sudden motion vibrates by all of it."""
    way = 1.0 / 1.75 - 0.25
    slow, fast = (
        farthest_from_rest(system, simulate(system, duration, position=[0.25]))[0]
        for system, duration in ((lifted(1.0, 60.0), 60.0), (lifted(1.0, 1e-3), 4.0))
    )
    assert slow < 0.01 * way
    assert fast == pytest.approx(way, rel=1e-3)


def of_follower(load: History) -> float:
    """Return the vibration in m of a tip that is always in equilibrium under a load of 2 N."""
    loads = [Excitation(np.full(1, 2.0), load)]
    system = replace(lifted(1.0, 10.0), excitations=loads)
    time = np.linspace(0.0, 10.0, 10001)
    row = 1.0 - 0.5 * SCurve(1.0, 10.0)(time)
    tip = (1.0 + 2.0 * load(time)) / (1.0 + 3.0 * row**2)
    data = xr.Dataset({"tip": ("time", tip)}, {"time": time})
    return farthest_from_rest(system, Trajectory(data, tip[:, None]))[0]


WAVE = PiecewiseLinear(np.arange(0.0, 10.0, 0.1).tolist(), [0.0, 1.0, 1.0, 0.0] * 25)


@pytest.mark.parametrize("load", [Sine(5.0), Ramp(0.2), WAVE])
def test_quasi_static_motion_has_no_residual_vibration(load: History) -> None:
    """Reference: analytic, F/(1 + 3 r²); the load moves the tip by at least 0.5 m."""
    assert of_follower(load) < 0.01 * 0.5


def test_fast_alternating_load_has_no_residual_vibration() -> None:
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
        answers = standing.summary.design
        first, last = (rest.tip for rest in answers.models["kantorovich-5"].static)
        rest = first + ramp * (last - first)
        assert level == pytest.approx(np.abs(data["tip"].values - rest).max(), rel=1e-3)


def test_boom_at_rest_has_no_residual_vibration(tmp_path: Path) -> None:
    """Reference: the boom at rest under constant loads. Fast telescoping causes vibration."""
    drawn = case(tmp_path, "drive = { travel = 4.0, time = 0.4 }")
    start = drawn.start.model_copy(update={"state": "equilibrium"})
    swing = swing_of(drawn.model_copy(update={"start": start, "loads": ()}))
    assert (swing.initial, swing.final) == (0.0, 0.0)
    assert swing.tip > 1.0e-3
    # Nor has one whose drive does not end, or that has none.
    assert swing_of(case(tmp_path, "drive = { travel = 4.0, time = 0.7 }")) is None
    assert swing_of(case(tmp_path, "")) is None


@pytest.mark.parametrize(
    ("level", "fastest"), [(4.0, 2.5), (6.0, 3.0), (1.0, None), (2.99, 2.0), (1.99, 1.0)]
)
def test_admissible_speed_is_at_the_crossing_of_lines(level: float, fastest: float | None) -> None:
    """Reference: by hand. Less than 1 % above the level does not count."""
    one = VibrationCurve(
        np.array([1.0, 2.0, 3.0]), np.array([2.0, 3.0, 5.0]), {"end": np.full(3, level)}
    )
    assert admissible_speed(one, "end") == pytest.approx(fastest)


def swept() -> xr.Dataset:
    """Return invented numbers of three points; the second failed, the last is slowest."""
    known = {
        "residual_vibration": [0.05, np.nan, 0.02],
        "drive_speed": [2.0, np.nan, 1.0],
        "residual_vibration_initial": [0.03, np.nan, 0.03],
        "residual_vibration_final": [0.06, np.nan, 0.06],
    }
    variables = {name: (("key", "model"), np.array([v]).T) for name, v in known.items()}
    return xr.Dataset(variables, coords={"key": [1.0, 1.5, 2.0], "model": ["beam"]})


FINAL = "that without telescoping, at the final extension (60 mm)"
LAST = ", the fastest speed with a result"


def test_a_chart_says_how_fast_it_may_be_drawn_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: by hand."""
    data = swept()
    assert list(describe("beam", vibration_curves(data)["beam"])) == [
        "beam: vibration within that without telescoping, at the initial extension (30 mm) up to "
        "1.33 m/s",
        f"beam: vibration within {FINAL} up to 2 m/s{LAST}",
    ]
    tight = data.assign(residual_vibration_initial=0.1 * data["residual_vibration_initial"])
    assert next(describe("beam", vibration_curves(tight)["beam"])) == (
        "beam: vibration of 20 mm at the slowest speed, 1 m/s, exceeds that without telescoping, "
        "at the initial extension (3 mm)"
    )
    # Of a speed whose standing boom has no motion the level is not known, and the others count.
    gap = xr.concat([swept(), swept().isel(key=[2]).assign_coords(key=[1.2])], "key")
    gap["residual_vibration_final"][-1], gap["drive_speed"][-1] = np.nan, 3.0
    assert list(describe("beam", vibration_curves(gap)["beam"]))[1] == (
        f"beam: vibration within {FINAL} up to 2 m/s{LAST}"
    )
    # Booms that are drawn to different places swing about as much as each does there, or less.
    elsewhere = data.assign(residual_vibration_initial=data["residual_vibration"] + 0.01)
    assert next(describe("beam", vibration_curves(elsewhere)["beam"])) == (
        "beam: vibration within that without telescoping, at the initial extension (30 to 60 mm) "
        f"up to 2 m/s{LAST}"
    )
    saved: list[Sheet] = []
    monkeypatch.setattr(Sheet, "savefig", lambda sheet, path: saved.append(sheet))
    draw_vibration(data, theme.strokes(["beam"], ()), tmp_path / "swing.png")
    curve, *levels = saved[0].axes[0].get_lines()
    np.testing.assert_allclose(curve.get_xydata(), [[1.0, 20.0], [2.0, 50.0]])
    assert [line.get_ydata()[0] for line in levels] == [30.0, 60.0]
    # Without speeds there is no chart.
    data = swept().isel(key=[0])
    draw_vibration(data, theme.strokes(["beam"], ()), tmp_path / "swing.png")
    assert not list(tmp_path.iterdir())
