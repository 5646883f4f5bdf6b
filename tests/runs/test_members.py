# SPDX-License-Identifier: LGPL-3.0-or-later
"""Ensembles of a run, and buckling of walls by formulas for long panels."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from protractile.analysis.low_pass import SlowPeaks, slow_peaks
from protractile.analysis.model import AnalysisModel
from protractile.analysis.plate_buckling import (
    measure_plates,
    weakest_plates,
)
from protractile.analysis.rows import INITIAL, REST, Rows, extremes, static_rows
from protractile.analysis.states import States
from protractile.cases import change
from protractile.dynamics.integrator import AdaptiveStep
from protractile.dynamics.line import Line
from protractile.dynamics.motion import Motion
from protractile.geometry.boom import Boom
from protractile.geometry.box import BoxSection
from protractile.geometry.segment import Segment
from protractile.runs import CASES
from protractile.runs.case import reading
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case, EnsembleTable
from protractile.runs.cautions.context import Context, State
from protractile.runs.cautions.response import bulges
from protractile.runs.check import check_case
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.members import PEAKS, slow_cutoff, steps_for_peaks
from protractile.runs.pipeline.models import build
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import Run
from protractile.runs.pipeline.statics import boom_with_play
from protractile.runs.report.additions import Addition
from protractile.runs.report.figures import figures_of
from protractile.runs.report.output import write
from tests.booms import CLAMP
from tests.booms import STEEL as METAL
from tests.modal import modal_system
from tests.runs.case_texts import CLAMPED, STEEL, box, read_case, shipped
from tests.runs.summaries import finished

SERIES = ["kantorovich-4", "kantorovich-5"]
MODELS = [*SERIES, "beam-fe-bonded"]
STEP = 1.0e-3


@pytest.fixture(scope="module")
def case() -> Case:
    coarse = reading.select(shipped("coarse"), "", MODELS, None)
    table = EnsembleTable(members=5, relative=1e-6, seed=3, vary="load")
    return change(coarse.model_copy(update={"ensemble": table}), **{"time.duration": 3.0})


@pytest.fixture(scope="module")
def run(case: Case) -> Run:
    return finished(case)


@pytest.mark.usefixtures("unprinted")
def test_member_0_is_the_trajectory(run: Run, tmp_path: Path) -> None:
    """Reference: the run of the model, in single precision, with its names and units."""
    write(run, Addition(), tmp_path)
    results = Results.load(tmp_path)
    ensembles = run.results.ensembles
    xr.testing.assert_identical(results.ensembles.load(), ensembles)
    assert ensembles.attrs["case_hash"] == results.summary.case_hash
    assert results.case.ensemble == run.results.case.ensemble
    assert ensembles["model"].values.tolist() == SERIES
    for place in ("tip", "head"):
        own = run.results.trajectories[place].sel(model=SERIES)
        assert ensembles[place].attrs == own.attrs
        found = ensembles[place].sel(member=0)
        np.testing.assert_array_equal(found, own.astype(np.float32), strict=True)


def test_slow_is_below_the_closed_boom(case: Case) -> None:
    """Reference: other code, the lowest frequency of the bonded beam, 2.0852 Hz."""
    boom = build_boom(case)
    assert slow_cutoff(boom, case.time) == pytest.approx(0.8 * 2.0852, rel=1e-3)
    for update in ({"duration": 0.5}, {"output_step": 0.5}):
        assert slow_cutoff(boom, case.time.model_copy(update=update)) is None


def test_summary_has_horizons_and_slow_peaks(run: Run) -> None:
    """Reference: non-regression. After the first contact, members diverge within a second."""
    models = run.results.summary.models
    assert models["beam-fe-bonded"].ensemble is None
    four, five = (models[name].ensemble for name in SERIES)
    for ensemble in (four, five):
        assert 0.5 < (ensemble.horizon(0.01) or 0.0) < 1.5
        peaks = ensemble.slow_peaks
        assert 0.5 < peaks.time[0] < 0.6
        assert 0.14 < peaks.height[0] < 0.17
        assert peaks.height_spread[0] < peaks.height_spread[1] < 0.05
        assert 0.9 < (peaks.period or 0.0) < 1.2
    found = run.results.summary.comparisons
    assert (found.reference, [*found.ensembles]) == ("kantorovich-5", ["kantorovich-4"])
    level = found.ensembles["kantorovich-4"]
    until = min(ensemble.horizons["0.01"] for ensemble in (four, five))
    assert level.pointwise.until == pytest.approx(until, abs=2e-3)
    count = len(level.peaks.time)
    apart = np.subtract(four.slow_peaks.time[:count], five.slow_peaks.time[:count])
    np.testing.assert_allclose(level.peaks.time, apart, atol=1e-3)


def test_figures_have_bands_and_horizons(run: Run) -> None:
    """Reference: the ensembles themselves, 5 to 95 % of the members at each time, in mm."""
    figures = {figure.name: figure for figure in figures_of(run.results)}
    models = run.results.summary.models
    horizons = {t for name in SERIES for t in models[name].ensemble.horizons.values()}
    for place in ("tip", "head"):
        assert "5 to 95 % of the 5 members" in figures[place].caption
        chart = figures[place].chart
        bands = {curve.name: curve.band for curve in chart.curves if curve.band is not None}
        assert list(bands) == SERIES
        for name, band in bands.items():
            members = 1000.0 * run.results.ensembles[place].sel(model=name).values
            np.testing.assert_allclose(band, np.percentile(members, (5.0, 95.0), axis=0))
        assert {vertical.at for vertical in chart.verticals} == horizons - {None} != set()


def test_fewest_sufficient_steps_are_counted() -> None:
    """Reference: by hand. From the second one on, slow peaks scatter by several percent."""
    case = shipped("paper")
    boom = build_boom(case)
    (model,) = (model for model in case.models if model.name == "kantorovich-5")
    cutoff, system = slow_cutoff(boom, case.time), build(case, boom, model).system
    motion = Motion(system, 4.0, STEP)
    made = AdaptiveStep()(motion)
    times, heights = slow_peaks(np.asarray(made.data["tip"].values), made.time, cutoff)
    spread = np.full(times.size, 0.03)
    peaks = SlowPeaks(times, spread, heights, spread * heights, float(np.diff(times).mean()), 0.0)
    # Beside a dashpot of no strength every step is made on its own.
    single = replace(system, dashpots=np.zeros((1, system.num_modes)))
    found = steps_for_peaks(Motion(single, 4.0, STEP), peaks, cutoff)
    sizes = [trial.step for trial in found.trials]
    assert sizes == pytest.approx([STEP * 2.0**i for i in range(-4, len(sizes) - 4)])
    assert sizes[-1] < 0.25 / cutoff <= 2.0 * sizes[-1]
    steps = [trial.steps for trial in found.trials]
    assert steps == [pytest.approx(found.duration / size, abs=16.0) for size in sizes]
    assert max(trial.energy_residual for trial in found.trials) < 1e-9
    # Which of the long steps hold is chance, another one on another machine.
    assert found.fewest == min(trial.steps for trial in found.trials if trial.holds)
    higher = replace(peaks, height=1.05 * heights, height_spread=0.0 * heights)
    assert steps_for_peaks(motion, higher, cutoff).fewest is None
    too_few = SlowPeaks(*np.ones((4, PEAKS - 1)), period=1.0, period_spread=0.0)
    assert steps_for_peaks(motion, too_few, cutoff) is None


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
    """Reference: other code, the static shell of the arm with edges of 0.2 m."""
    checked = reading.load_checked(str(CASES / "inspection-arm.toml"))
    boom = boom_with_play(checked.case, checked.boom)
    rows = Rows(static_rows(static_states(checked.case, boom), "beam"))
    closed = rows.where(state=INITIAL, quantity="closed_play")
    assert [row.value for row in closed] == pytest.approx(
        [1.1985e-3, 1.8414e-3, 0.8242e-3, 1.3873e-3], rel=0.02
    )
    state = State("in the beam estimate", closed=closed)
    (caution,) = bulges(Context(checked.case, boom, [state]))
    assert "1.2 of 4 mm at x = 3.5 m, 1.8 of 4 mm at x = 4.5 m" in caution
