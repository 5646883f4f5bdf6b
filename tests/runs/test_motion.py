# SPDX-License-Identifier: LGPL-3.0-or-later
"""Modes, time steps, damping, friction and ensembles of the motions of a case, and fatigue."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
import xarray as xr

from protractile.analysis.fatigue import count_stress_ranges
from protractile.analysis.low_pass import SlowPeaks, slow_peaks
from protractile.analysis.model import AnalysisModel
from protractile.analysis.modes import Mode, match_modes, modes
from protractile.analysis.rows import MOTION, REST, Row, Rows
from protractile.beam_model.component import SegmentModel
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segments
from protractile.beam_model.lines import lines
from protractile.beam_model.segment_model import gap_system
from protractile.cases import change, run_case
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.boom import Boom, Material, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import select
from protractile.runs.case.schema import Case, DampingTable, EnsembleTable
from protractile.runs.pipeline.members import PEAKS, slow_cutoff, steps_for_peaks
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.models import build
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import Run
from protractile.runs.pipeline.run import run_case as run_models
from protractile.runs.report.additions import Addition
from protractile.runs.report.figures import figures_of
from protractile.runs.report.output import write
from tests.runs.case_texts import (
    CLAMPED,
    COARSE,
    STEEL,
    box,
    elements,
    read_case,
    refusal,
    shipped,
    table,
)
from tests.runs.summaries import finished, motion_of
from tests.runs.test_actions import CANTILEVER


def short(name: str, model: str, values: Mapping[str, object] = {}, **more: object) -> Run:
    """Return the run of a model of a shipped case for 0.03 s."""
    case = change(select(shipped(name), "", [model]), **{"time.duration": 0.03}, **values, **more)
    return run_models(case, "", RunContext())


@pytest.mark.parametrize(
    ("run", "motions"),
    [
        (("coarse", "kantorovich-4"), 1),
        # At the extremes of the drive.
        (("drawn-out", "kantorovich-5", {"joint.drive.time": 0.02, "joint.play": 0.0}), 2),
    ],
)
def test_all_motions_of_a_model_take_the_step_of_the_case(
    run: Any, motions: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: the case. Motions include those without play."""
    found = short(*run, **{"time.step": 4.0e-5})
    move = Mock(side_effect=FixedStep.__call__)
    monkeypatch.setattr(FixedStep, "__call__", lambda *given: move(*given))
    found.evaluate()
    assert [call.args[0].step for call in move.call_args_list] == motions * [4.0e-5]


def test_bonded_rest_is_known_without_a_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: the same static state after a motion."""
    runs = [short("coarse", "kantorovich-4") for _ in range(2)]
    runs[0].evaluate()
    failing = Mock(side_effect=NumericsError("it does not converge"))
    monkeypatch.setattr(AdaptiveStep, "__call__", failing)
    runs[1].evaluate()
    whole, left = (run.results.rows.where(play=False) for run in runs)
    assert whole.where(state=MOTION)
    assert left == tuple(row for row in whole if row.state != MOTION)
    assert {"tip", "frequency"} <= {row.quantity for row in left}


@pytest.mark.parametrize(("at_rest", "factor"), [(2.0, 1.5), (1e-4, None)])
def test_factor_needs_a_static_value_of_some_size(at_rest: float, factor: float | None) -> None:
    """Reference: by hand; a torque of round-off at rest gives no factor of 30000."""
    moved = Row("beam", MOTION, True, "support_torque", "base", "at 0 m", -3.0)
    other = moved._replace(state=REST, place="at 2 m", value=5.0)
    rows = Rows([moved, moved._replace(state=REST, value=at_rest), other])
    assert rows.dynamic_factor(moved) == factor


@pytest.mark.parametrize("damping", [{"modal": 0.015}, {"stiffness": 3e-4}], ids=str)
@pytest.mark.parametrize("name", ["lift", "inspection-arm"])
def test_a_pressed_boom_keeps_its_ledger(name: str, damping: dict[str, float]) -> None:
    case = change(shipped(name), **{"time.duration": 0.5, "time.output_step": 0.01})
    run = motion_of(case.model_copy(update={"damping": DampingTable(**damping)}), 1)
    assert run.energy_residual < 1e-4
    loss = np.diff(run.data["damping_loss"].values)
    assert loss.min() >= 0.0
    assert loss.sum() > 0.0


@pytest.mark.parametrize("friction", [0.05, 0.15])
def test_arm_with_friction_moves_in_a_gust(friction: float) -> None:
    """Reference: analytic, the balance of energy; steps of half the length, to 1 % of the range."""
    joint = {"joint.friction": friction, "joint.lateral_play": 0.002}
    case = change(shipped("inspection-arm"), **joint, **{"time.duration": 1.6})
    beam = case.models[1]
    steps = {"coarse": 1e-3, "fine": 5e-4}
    models = (beam.model_copy(update={"name": one, "step": step}) for one, step in steps.items())
    nothing = dict.fromkeys(("load_cases", "combinations", "spectra"), ())
    results = run_case(case.model_copy(update=nothing | {"models": tuple(models)}))
    coarse, fine = (results.trajectories["tip_lateral"].sel(model=one).values for one in steps)
    assert float(np.abs(coarse - fine).max()) < 0.01 * float(np.ptp(fine))
    for model in results.summary.models.values():
        assert model.energy_residual < 1e-10


def test_results_are_shown_as_soon_as_each_model_has_finished() -> None:
    """Reference: the results of the whole run, which are the same numbers."""
    names = ["kantorovich-4", "kantorovich-5"]
    case = change(select(shipped("coarse"), "", names), **{"time.duration": 0.03})
    shown: list[Results] = []
    run = run_models(case, "", RunContext(), shown.append)
    assert [[*results.summary.models] for results in shown] == [names[:1], names]
    run.evaluate_with_play()
    assert [*shown[-1].rows] == [*run.results.rows]


@pytest.fixture(scope="module")
def arm(spatial_boom: Boom, steel: Material) -> Boom:
    """Return a cantilever of 10 m in space; the second segment is bonded to the first half."""
    box = BoxSection(height=0.30, width=0.20, flange=0.006, web=0.006)
    root = Segment.of_section("root", 0.0, 10.0, steel, box, supports=(Support(0.0, "clamped"),))
    # As light as none, and rigid beside it.
    sleeve = BoxSection(height=0.25, width=0.15, flange=0.001, web=0.001)
    light = Material(youngs_modulus=2.1e3, poissons_ratio=0.3, density=1e-6)
    dummy = Segment.of_section("dummy", 9.0, 10.0, light, sleeve)
    joint = replace(spatial_boom.joints[0], stations=(9.0, 10.0), bonded=True)
    return Boom((root, dummy), (joint,))


def found(boom: Boom, models: list[SegmentModel]) -> list[Mode]:
    system = gap_system(boom.bonded, models)
    return modes(AnalysisModel.of(boom, system, lines(boom, models)), np.zeros(system.num_modes))


@pytest.fixture(scope="module")
def elements_of_arm(arm: Boom) -> list[Mode]:
    return found(arm, finite_element_segments(arm, 0.5, "euler-bernoulli", rotary_inertia=False))


def test_modes_are_those_of_an_exact_beam(arm: Boom, elements_of_arm: list[Mode]) -> None:
    """Reference: analytic, (βL)² = 3.51602, 22.0345 and √(GJ/I) / 4L (Blevins 1979)."""
    root, lateral = arm.segments[0], arm.segments[0].lateral
    names = {(mode.motion, mode.number): mode for mode in elements_of_arm}
    for way, second_moment in (
        ("bending in z", root.second_moment_of_area),
        ("bending in y", lateral.second_moment_of_area),
    ):
        speed = np.sqrt(2.1e11 * second_moment / root.mass_per_length) / 100.0
        for number, root_of in ((1, 3.51602), (2, 22.0345)):
            mode = names[way, number]
            assert mode.frequency == pytest.approx(root_of * speed / (2.0 * np.pi), rel=1e-4)
            assert mode.share > 0.999
    twisting = root.material.shear_modulus * lateral.torsion_constant / lateral.polar_inertia
    assert names["twist", 1].frequency == pytest.approx(np.sqrt(twisting) / 40.0, rel=1e-3)


def test_modes_match_in_any_order(arm: Boom, elements_of_arm: list[Mode]) -> None:
    """Reference: other code, the complete series."""
    here, series = elements_of_arm, kantorovich_segments(arm, [12, 4], "complete", False)
    moved = found(arm, series)[::-1]
    for mode, match in zip(here, match_modes(arm, here, moved), strict=True):
        other = moved[match.number - 1]
        assert (other.motion, other.number) == (mode.motion, mode.number)
        assert match.alike > 0.999
        assert match.off == pytest.approx(0.0, abs=2e-3)
    sideways = [mode for mode in moved if mode.motion == "bending in y"]
    upright = [mode for mode in here if mode.motion == "bending in z"]
    assert match_modes(arm, upright, sideways) == [None] * len(upright)


RIGID = table("[[model]]", name="bodies", kind="rigid")


def test_rigid_segments_run_beside_the_others(tmp_path: Path) -> None:
    """Reference: analytic, free fall q/m of the inner segment across the clearance Δ."""
    case = read_case(tmp_path, COARSE.partition("[[model]]")[0] + RIGID)
    summary = run_case(case).summary.models["bodies"]
    assert (summary.kind, summary.degrees_of_freedom) == ("rigid", 2)
    assert summary.energy_residual < 1e-5
    # A uniform load on a free body turns it nowhere.
    assert summary.first_contact == pytest.approx(np.sqrt(2.0 * 7.0e-3 / 1.0), abs=1e-5)


def test_immovable_rigid_segments_are_refused(tmp_path: Path) -> None:
    assert refusal(tmp_path, CANTILEVER + RIGID) == (
        "model[1].kind: every segment is held, and no rigid one could move; give another kind, or "
        "elastic supports"
    )


@pytest.mark.parametrize("seed", range(5))
def test_a_repetition_adds_what_the_history_written_twice_adds(seed: int) -> None:
    """Reference: other code, rainflow cycles of the history twice in a row, less those of one."""
    rainflow = pytest.importorskip("rainflow", reason="the cycles are counted by it")
    stress = np.random.default_rng(seed).normal(0.0, 50e6, 100)
    added = Counter(dict(rainflow.count_cycles([*stress, *stress])))
    added.subtract(dict(rainflow.count_cycles(stress)))
    sizes, counts = count_stress_ranges(stress)
    cubes = sum(count * size**3 for size, count in added.items())
    assert counts @ sizes**3 == pytest.approx(cubes, rel=1e-9)


def test_damage_of_a_load_that_remains(tmp_path: Path) -> None:
    """Reference: by hand, a load that rises suddenly to 50 MPa.

    Full cycles of 110.6, 77.1, 56.3, 41.0 and 29.9 MPa, from each trough to the next peak of the
    decaying vibration, whose stress includes higher modes.
    """
    pytest.importorskip("rainflow", reason="the cycles are counted by it")
    text = f"""
title = "Load that remains"
time = {{ duration = 4.0, output_step = 0.002 }}
damping = {{ modal = 0.05 }}
life = {{ detail_category = 71.0, repeats = 20000 }}
load = [{{ segment = "a", x = "head", magnitude = -3852.45, ramp = 0.001 }}]
{STEEL}
{box("a", 4.0, (0.2, 0.15, 0.008, 0.006), CLAMPED)}
{elements("beam", theory="euler-bernoulli")}
"""
    results = run_case(read_case(tmp_path, text))
    (found,) = results.rows.where(quantity="damage")
    assert found.value == pytest.approx(0.0570, rel=0.005)


SERIES = ["kantorovich-4", "kantorovich-5"]
MODELS = [*SERIES, "beam-fe-bonded"]
STEP = 1.0e-3


@pytest.fixture(scope="module")
def case() -> Case:
    coarse = select(shipped("coarse"), "", MODELS, None)
    table = EnsembleTable(members=5, relative=1e-6, seed=3, vary="load")
    return change(
        coarse.model_copy(update={"ensemble": table}), **{"time.duration": 3.0, "time.step": 1.0e-4}
    )


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
