# SPDX-License-Identifier: LGPL-3.0-or-later
"""Comparison of models: levels of ensembles, references, the low-pass filter, and tables."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.stats import norm

from protractile.analysis.comparison import Distributions, compare
from protractile.analysis.low_pass import SlowPeaks, filter_low_pass, slow_peaks
from protractile.cases import change
from protractile.dynamics.trajectory import PointwiseDifferences
from protractile.runs.case import reading as case_file
from protractile.runs.case.schema import Case, StopTable
from protractile.runs.paper.run_query import final_differences, peak_distances
from protractile.runs.pipeline.model_quality import compare_models, reference_of
from protractile.runs.pipeline.results import Results
from protractile.runs.report.additions import Addition
from protractile.runs.report.document import render
from protractile.runs.report.model_tables import law_table, model_table, step_table
from protractile.runs.report.predictability import comparison_tables, predictability_tables
from tests.runs.case_texts import shipped
from tests.runs.summaries import (
    HORIZONS,
    PRESSED,
    members,
    model_summary,
    rubbing,
    steps_for_peaks,
    summary_of,
)

TIME = np.arange(10_001) * 1e-3
CUTOFF, SLOW = 1.7, 2.0


def swing(height: float = 1.0, delay: float | np.ndarray = 0.0) -> np.ndarray:
    """Return a vibration with peaks of ``height`` at 0.5, 1.5, … s plus ``delay``."""
    return height * 0.5 * (1.0 - np.cos(2.0 * np.pi * (TIME - delay)))


def ensemble(delay: float = 0.0, height: float = 1.0, growth: float = 0.0) -> xr.Dataset:
    """Return vibrations of period 1 s; phases of members differ by ±1e-4 exp(growth t) in s."""
    parting = np.linspace(-1e-4, 1e-4, 9)[:, None] * np.exp(growth * TIME)
    parting = np.clip(np.vstack([np.zeros(TIME.size), parting]), -0.2, 0.2)
    tip = swing(height, delay + parting)
    return xr.Dataset({"tip": (("member", "time"), tip)}, coords={"time": TIME})


def test_pointwise_differences_by_hand() -> None:
    """Reference: analytic. The difference 0.02 sin²(πt) up to 0.5 s is 1/51 of the larger range."""
    one, other = swing(), swing(1.02)
    other[501:] += 1.0  # too late to count
    found = PointwiseDifferences.from_curves(one, other, TIME, 0.5)
    assert found.largest == pytest.approx(0.02 / 1.02, rel=1e-6)
    assert found.rms == pytest.approx(0.02 / 1.02 * np.sqrt(3.0 / 8.0), rel=2e-3)
    curves = np.array([TIME, TIME]), np.array([1.25 * TIME, TIME])
    assert final_differences(*curves, TIME >= 9.0) == pytest.approx([2.5 / 12.5, 0.0])


def test_divergence_levels_of_two_models() -> None:
    """Reference: analytic, a spread of ½ |sin 2πt| sin(2π·1e-4·exp(t)) about the first members, and
    sin(0.05 π) by a delay of 50 ms.
    """

    def reached(share: float, delay: float) -> float:
        shift = 2.0 * np.pi * 1e-4 * np.exp(TIME)
        spread = 0.5 * np.abs(np.sin(2.0 * np.pi * (TIME - delay))) * np.sin(shift)
        return float(TIME[np.argmax(spread > share)])

    found = compare(ensemble(growth=1.0), ensemble(delay=0.05, growth=1.0), CUTOFF)
    assert found.pointwise.until == pytest.approx(reached(0.01, 0.0), abs=1.5e-3)
    assert found.pointwise.largest == pytest.approx(np.sin(0.05 * np.pi), rel=1e-2)
    np.testing.assert_allclose(found.peaks.time[1:5], 0.05, atol=2e-3)
    explained = found.peaks.explained
    # Both phases are uncertain by 1e-4 exp(t) s: the delay is explained from 5.5 s on.
    assert explained[:4] == [False] * 4
    assert all(explained[6:])
    assert found.distributions.since == pytest.approx(reached(0.2, 0.05), abs=1.5e-3)
    assert found.distributions.distance < 0.05
    with pytest.raises(ValueError, match=r"^the ensembles must have the same times$"):
        compare(ensemble(), ensemble().isel(time=slice(5000)), CUTOFF)


def test_predictable_models_differ_by_their_peaks_alone() -> None:
    """Reference: analytic, peaks a tenth higher and no spread."""
    found = compare(ensemble(), ensemble(height=1.1), CUTOFF)
    np.testing.assert_allclose(found.peaks.height[1:-1], 0.1, rtol=0.01)
    assert not any(found.peaks.explained)
    assert found.pointwise.until == TIME[-1]
    assert np.isnan([found.distributions.since, found.distributions.distance]).all()


def test_distance_of_shifted_distributions() -> None:
    """Reference: analytic. Normal distributions with a shift s have the distance 2 Φ(s/2) − 1."""
    generator = np.random.default_rng(0)
    values = generator.normal(size=(10, TIME.size))
    for shift in (0.0, 2.0):
        other = generator.normal(shift, 1.0, size=values.shape)
        found = Distributions.of(values, other, TIME, 1.0)
        assert found.distance == pytest.approx(2.0 * norm.cdf(0.5 * shift) - 1.0, abs=0.01)
        assert found.mean[1] - found.mean[0] == pytest.approx(shift, abs=0.02)
        assert found.deviation == pytest.approx((1.0, 1.0), abs=0.02)


@pytest.mark.parametrize(
    ("delay", "height", "expected"), [(0.1, 1.0, 0.1), (0.0, 0.8, 0.2), (-0.15, 0.9, 0.15)]
)
def test_distance_of_peaks(delay: float, height: float, expected: float) -> None:
    """Reference: analytic, the larger of the delay over the period and the difference in height."""
    # On a clock that is half as fast, periods are 2 s.
    curves = np.array([swing(), swing(height, delay)])
    first, apart = peak_distances(curves, 2.0 * TIME, 0.5 * CUTOFF)
    expected_times = 2.0 * np.arange(1, first.size - 1) + 1.0 + 2.0 * min(delay, 0.0)
    assert first[1:-1] == pytest.approx(expected_times, abs=6e-3)
    assert apart[1:-1] == pytest.approx(expected, abs=5e-3)


def test_missing_peaks_have_infinite_distance() -> None:
    """Reference: by construction, a motion that ends at 4 s, a late one, and one without peaks."""
    still = np.where(TIME > 4.0, 0.0, swing())
    first, apart = peak_distances(np.array([swing(), still]), TIME, CUTOFF)
    missed = np.isinf(apart)
    assert first[missed][:4] == pytest.approx([4.5, 5.5, 6.5, 7.5], abs=3e-3)
    assert (first[~missed] < 4.0).all()
    first, apart = peak_distances(np.array([swing(), swing(delay=0.6)]), TIME, CUTOFF)
    assert (first.size, np.isfinite(apart).all()) == (9, True)
    assert [x.size for x in peak_distances(np.array([TIME, TIME]), TIME, CUTOFF)] == [0, 0]


def test_known_peaks_under_a_ripple() -> None:
    """Reference: analytic, peaks at 0.5, 1.5, … s; a ripple of 7 Hz moves peaks by up to 70 ms."""
    ripple = 0.1 * np.cos(2.0 * np.pi * 7.0 * TIME + 1.0)
    times, heights = slow_peaks(swing() + ripple, TIME, CUTOFF)
    np.testing.assert_allclose(times[1:-1], np.arange(1, 9) + 0.5, atol=2e-3)
    # Next to the ends the mirrored signal has a part in it.
    np.testing.assert_allclose(times[[0, -1]], [0.5, 9.5], atol=1e-2)
    gain = 1.0 / (1.0 + (1.0 / CUTOFF) ** 8)
    np.testing.assert_allclose(heights[1:-1], 0.5 + 0.5 * gain, atol=2e-3)


def test_spreads_over_members_up_to_the_first_missing_peak() -> None:
    """Reference: analytic. Delays of −20 … 40 ms, heights of 0.9 … 1.1."""
    found = SlowPeaks.of(np.array([swing(), swing(0.9, 0.04), swing(1.1, -0.02)]), TIME, CUTOFF)
    assert found.time.size == 10
    inner = slice(1, -1)
    np.testing.assert_allclose(found.time[inner], np.arange(1, 9) + 0.5 + 0.02 / 3, atol=2e-3)
    np.testing.assert_allclose(found.time_spread[inner], 0.03, atol=2e-3)
    # A tenth of the heights, which the filter lowers by 0.7 %.
    np.testing.assert_allclose(found.height_spread[inner], 0.1, rtol=0.01)
    assert found.period == pytest.approx(1.0, abs=2e-3)
    assert found.period_spread < 4e-3
    lost = np.where((TIME > 4.0) & (TIME < 5.0), 0.0, swing())
    drifting = 0.5 * (1.0 - np.cos(2.0 * np.pi * TIME * 0.95))
    # The k-th peak drifts by (k − ½)·0.0526 s; half a period of the cut-off is 0.294 s.
    for other, peaks in ((lost, 4), (drifting, 6), (TIME, 0)):
        found = SlowPeaks.of(np.array([swing() if peaks else TIME, other]), TIME, CUTOFF)
        assert found.time.size == peaks
        assert np.isnan([found.period, found.period_spread]).all() == (peaks == 0)


@pytest.mark.parametrize(
    ("times", "cutoff", "message"),
    [
        (2000, 500.0, "cutoff must be between 0 and 500 Hz, got 500 Hz"),
        (500, 2.0, "the signal must be longer than the period of the cut-off, 0.5 s, got 0.499 s"),
    ],
)
def test_bad_signals_are_refused(times: int, cutoff: float, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        filter_low_pass(np.ones(times), 1e-3, cutoff)


SERIES = ["kantorovich-4", "kantorovich-5"]
MODELS = (*SERIES, "beam-fe-bonded")


def case_of(*names: str, friction: float = 0.0, pressed: tuple[float, ...] = PRESSED) -> Case:
    """Return the coarse case with some of its models, and friction in its joint."""
    return rubbing(case_file.select(shipped("coarse"), "", names), friction, pressed)


def trajectories(**tips: np.ndarray) -> xr.Dataset:
    return xr.Dataset(
        {"tip": (("model", "time"), np.array(list(tips.values())))},
        coords={"model": [name.replace("_", "-") for name in tips], "time": TIME},
    )


def test_the_reference_is_most_complicated_model() -> None:
    for other, expected in (("shell", "shell"), ("timoshenko", "timoshenko")):
        assert reference_of(case_of(*SERIES, other, "beam-fe-bonded").models) == expected
    assert reference_of(case_of("beam-fe-bonded").models) is None


def test_models_are_compared_with_the_reference() -> None:
    """Reference: analytic, half the height, 50 ms late; members apart by 1/4 period from 4 s on."""
    late = np.where(TIME < 4.0, 0.0, 0.25)
    low, high = (np.array([swing(k, x), swing(k, x + late)]) for k, x in ((0.5, 0.05), (1.0, 0.0)))
    data = trajectories(kantorovich_4=low[0], kantorovich_5=swing())
    ensembles = members({"kantorovich-4": low, "kantorovich-5": high})
    found = compare_models(case_of(*SERIES), data, ensembles, SLOW)
    assert (found.reference, found.whole) == ("kantorovich-5", {})
    (level,) = found.ensembles.values()
    assert level.pointwise.until == pytest.approx(4.0, abs=2e-3)
    assert level.pointwise.largest == pytest.approx(np.abs(low[0] - swing())[TIME <= 4.0].max())
    # The filter leans on the jump at 4 s: the first two peaks are far from it.
    assert level.peaks.time[:2] == pytest.approx([0.05, 0.05], abs=5e-3)
    assert level.peaks.height[:2] == pytest.approx([-0.5, -0.5], abs=1e-2)
    assert level.distributions.range == pytest.approx([1.0, 0.5], rel=1e-3)
    # All values of the half are below 0.5: half of the whole one's are.
    assert level.distributions.distance == pytest.approx(0.5, abs=0.02)
    # Without slow motion, or with one model, nothing is compared.
    assert compare_models(case_of(*SERIES), data, ensembles, None) is None
    alone = case_of("kantorovich-4", friction=0.2)
    assert compare_models(alone, data.isel(model=[0]), ensembles.isel(model=[0]), SLOW) is None


def test_with_friction_every_model_is_compared_to_the_end() -> None:
    """Reference: analytic, a tip too high by 0.1 up to 5 s, then by 0.3, for a range of 1."""
    above = swing() + np.where(TIME <= 5.0, 0.1, 0.3)
    data = trajectories(kantorovich_4=above, kantorovich_5=swing(), beam_fe_bonded=0.1 * swing())
    case = case_of(*MODELS, friction=0.2)
    found = compare_models(case, data, None, None).whole
    assert list(found) == ["kantorovich-4", "beam-fe-bonded"]
    whole = found["kantorovich-4"]
    assert whole.until == [5.0, 10.0]
    assert whole.largest == pytest.approx([0.1, 0.3 / 1.2], rel=1e-2)
    assert whole.rms == pytest.approx([0.1, np.sqrt(0.5 * (0.1**2 + 0.3**2)) / 1.2], rel=1e-2)
    # A short run is compared to its end alone.
    short = compare_models(case, data.sel(time=slice(None, 2.0)), None, None).whole
    assert short["kantorovich-4"].until == [2.0]


def test_only_friction_under_given_forces_is_regular() -> None:
    """Reference: physics. Friction by contact forces or none leaves motion chaotic; so do stops."""
    for friction, pressed in ((0.0, PRESSED), (0.2, ()), (0.2, (4500.0, 0.0))):
        assert not case_of(*SERIES, friction=friction, pressed=pressed).regular
    case = case_of(*SERIES, friction=0.2)
    stop = StopTable(segment="inner", x=14.0, play=0.1, stiffness=1e7)
    assert case.regular
    assert not case.model_copy(update={"stops": (stop,)}).regular


def results(comparisons: Any = None, friction: float = 0.0, **changes: Any) -> Results:
    """Return 10 s of two models with play and one without; ``changes`` apply to the first."""
    models = {name: model_summary() for name in MODELS} | {MODELS[0]: model_summary(**changes)}
    asked = {"members": 32, "relative": 1e-9, "seed": 1, "vary": "load", "slow_below": 1.67}
    summary = summary_of(models, ensemble=asked, comparisons=comparisons)
    case = change(case_of(*MODELS, friction=friction), **{"time.duration": 10.0})
    return Results(case, xr.Dataset(), summary)


ENSEMBLE = {
    "energy_residual": 1e-4,
    "horizons": {"0.01": 0.802, "0.2": None},
    "slow_peaks": {
        "time": [0.5469, 1.5906], "time_spread": [0.001, 0.022], "height": [0.1522, 0.14691],
        "height_spread": [0.00019, 0.0068], "period": 1.0437, "period_spread": 0.021,
    },
}  # fmt: skip
LEVELS = {
    "pointwise": {"until": 0.802, "largest": 0.1829, "rms": 0.0793},
    "peaks": {
        "time": [-0.026, 0.004], "time_spread": [0.001, 0.024], "height": [-0.01542, 0.001],
        "height_spread": [0.00023, 0.0075], "explained": [False, True],
    },
    "distributions": {
        "since": 4.643, "range": [0.1681, 0.1757], "mean": [0.0995, 0.0807],
        "deviation": [0.0478, 0.04], "distance": 0.199,
    },
}  # fmt: skip


def test_horizons_and_slow_peaks_are_the_summary_s() -> None:
    """Reference: the invented summary; a run without ensembles has no such tables."""
    assert predictability_tables(results()) == comparison_tables(results()) == []
    assert not any("horizon" in heading for heading in model_table(results()).headings)
    found = results(ensemble=ENSEMBLE, horizons=HORIZONS)
    horizons, growth, peaks = predictability_tables(found)
    assert horizons.rows == [("kantorovich-4", "0.80", "> 10", "2", "1.044 ± 0.021")]
    assert peaks.rows == [
        ("1", "0.547 ± 0.001 s\n152.20 ± 0.19 mm"),
        ("2", "1.591 ± 0.022 s\n146.91 ± 6.80 mm"),
    ]
    assert growth.rows == [
        ("kantorovich-4", "1 %", "1.50", "1.00", "1.20", "28", "the step"),
        ("kantorovich-4", "20 %", "6.00", "–", "–", "–", "the motion"),
    ]
    table = model_table(found)
    at = table.headings.index("horizon 1 %\ns")
    assert [row[at : at + 2] for row in table.rows] == [("0.80", "> 10"), ("–", "–"), ("–", "–")]


def test_missing_peaks_make_no_table() -> None:
    """Reference: by construction, ensembles without a slow peak or a distribution."""
    (horizons,) = predictability_tables(results(ensemble=ENSEMBLE | {"slow_peaks": None}))
    assert horizons.rows == [("kantorovich-4", "0.80", "> 10", "–", "–")]
    none: dict[str, Any] = {k: [] for k in ("time", "time_spread", "height", "height_spread")}
    unknown: dict[str, Any] = {key: [None, None] for key in ("range", "mean", "deviation")}
    unknown |= {"since": None, "distance": None}
    level = LEVELS | {"peaks": none | {"explained": []}, "distributions": unknown}
    nothing = ENSEMBLE | {"slow_peaks": none | {"period": None, "period_spread": None}}
    found = results({"reference": "shell", "ensembles": {MODELS[0]: level}}, ensemble=nothing)
    assert comparison_tables(found)[-1].rows == [("kantorovich-4", *5 * ["–"])]
    assert not re.findall("<h3>.*Slow peaks", render(found, Addition(), [], []))


def test_tables_of_differences_are_the_summary_s() -> None:
    """Reference: numbers by hand in mm, ms and %."""
    ensembles = {"kantorovich-4": LEVELS}
    tables = comparison_tables(results({"reference": "shell", "ensembles": ensembles}))
    assert all("against shell" in table.title for table in tables)
    assert [table.rows for table in tables] == [
        [("kantorovich-4", "0.80", "18.29", "7.93")],
        [("1", "−26 ± 1 ms\n−15.42 ± 0.23 mm *"), ("2", "+4 ± 24 ms\n+1.00 ± 7.50 mm")],
        [("kantorovich-4", "4.64", "175.7 / 168.1", "80.7 / 99.5", "40.0 / 47.8", "0.199")],
    ]
    whole = {"kantorovich-4": {"until": [5.0, 10.0], "largest": [0.1, 0.25], "rms": [0.05, 0.125]}}
    (table,) = comparison_tables(results({"reference": "shell", "whole": whole}, friction=0.2))
    assert table.headings[1:3] == ("largest difference\nto 5 s, %", "rms\nto 5 s, %")
    assert table.rows == [("kantorovich-4", "10.00", "5.00", "25.00", "12.50")]


def test_steps_and_contact_laws_are_those_of_the_models() -> None:
    """Reference: the summary, and the case; bonded joints have no law."""
    found = results(steps_for_peaks=steps_for_peaks(1500), step_error=0.0123)
    first, *others = step_table(found).rows
    cells = [cell.replace("\N{NO-BREAK SPACE}", "") for cell in first]
    assert cells[:4] + cells[-2:] == ["kantorovich-4", "4.2", "2380952", "2020", "1500", "1.2"]
    assert [row[-2:] for row in others] == 2 * [("–", "–")]
    assert law_table(found).rows == [
        (name, "inner in outer", "14.0", "k 1e+13, n 2", "168.9") for name in MODELS[:2]
    ]
    joints = tuple(replace(joint, bonded=True) for joint in found.case.joints)
    bonded = found.case.model_copy(update={"joints": joints})
    assert not law_table(replace(found, case=bonded)).rows
