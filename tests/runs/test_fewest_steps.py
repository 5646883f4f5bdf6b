# SPDX-License-Identifier: LGPL-3.0-or-later
"""How few steps keep the slow motion's peaks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dynamics.gap_system import GapSystem
from dynamics.integrator import AdaptiveStep
from dynamics.motion import Motion
from dynamics.predictability.low_pass import SlowPeaks, slow_peaks
from runs import CASES
from runs.case import reading as case_file
from runs.case.build import build_boom
from runs.pipeline.members import PEAKS, slow_below, steps_for_peaks
from runs.pipeline.models import build

PAPER = CASES / "paper.toml"
STEP = 1.0e-3


@pytest.fixture(scope="module")
def five_terms() -> tuple[GapSystem, float]:
    """The five-term series, and the cut-off of its slow motion in Hz."""
    case = case_file.load(str(PAPER))
    boom = build_boom(case)
    model = next(model for model in case.models if model.name == "kantorovich-5")
    assert model.kind == "kantorovich"
    cutoff = slow_below(boom, case.time)
    assert cutoff is not None
    return build(case, boom, model).system, cutoff


def peaks_of(system: GapSystem, cutoff: float, spread: float) -> SlowPeaks:
    """Slow peaks of one run as those of an ensemble."""
    run = AdaptiveStep()(Motion(system, 4.0, STEP))
    times, heights = slow_peaks(np.asarray(run.data["tip"].values), run.time, cutoff)
    period = float(np.diff(times).mean())
    return SlowPeaks(
        times, np.full(times.size, spread), heights, spread * heights, period, period_spread=0.0
    )


def test_counts_the_fewest_of_the_trials_that_hold(five_terms: tuple[GapSystem, float]) -> None:
    """Reference: by hand. Slow peaks scatter by some percent from the second on."""
    system, cutoff = five_terms
    found = steps_for_peaks(Motion(system, 4.0, STEP), peaks_of(system, cutoff, 0.03), cutoff)
    assert found is not None
    sizes = [trial.step for trial in found.trials]
    assert sizes == pytest.approx([STEP * 2.0**i for i in range(-4, len(sizes) - 4)])
    assert sizes[-1] < 0.25 / cutoff <= 2.0 * sizes[-1]
    steps = [trial.steps for trial in found.trials]
    assert steps == [pytest.approx(found.duration / size, abs=16.0) for size in sizes]
    assert max(trial.energy_residual for trial in found.trials) < 1e-9
    holding = [trial.steps for trial in found.trials if trial.holds]
    assert found.fewest == min(holding)
    # Which of the long steps hold is chance, another one on another machine.
    assert found.fewest <= steps[0]


def test_peaks_that_no_run_has_are_kept_by_none(five_terms: tuple[GapSystem, float]) -> None:
    system, cutoff = five_terms
    peaks = peaks_of(system, cutoff, 0.0)
    peaks = replace(peaks, heights=1.05 * peaks.heights)
    found = steps_for_peaks(Motion(system, 4.0, STEP), peaks, cutoff)
    assert found is not None
    assert found.fewest is None


def test_too_few_peaks_are_not_asked_for(five_terms: tuple[GapSystem, float]) -> None:
    system, cutoff = five_terms
    two = SlowPeaks(*np.ones((4, PEAKS - 1)), period=1.0, period_spread=0.0)
    assert steps_for_peaks(Motion(system, 4.0, STEP), two, cutoff) is None
