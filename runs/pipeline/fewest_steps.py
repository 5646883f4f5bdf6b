# SPDX-License-Identifier: LGPL-3.0-or-later
"""The fewest time steps that keep the slow motion of a model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.integrator import FixedStep
from dynamics.motion import Motion
from dynamics.predictability.low_pass import SlowPeaks, slow_peaks
from dynamics.trajectory import Trajectory
from runs.pipeline.summary import StepsForPeaks, Trial

# As many peaks as the slow motion has before its spread is as large as the peaks' differences.
PEAKS = 3
# How near a peak must be: in time as a part of the period, in height as a part of itself, beyond
# the spread that an ensemble of fully resolved runs has by itself.
WITHIN = 0.01

# The first step is the output step over 2 to this power; the last one is below this part of a
# period at the cutoff, which the filter still sees.
_FINEST, _OF_PERIOD = -4, 0.25


def steps_for_peaks(motion: Motion, peaks: SlowPeaks, cutoff: float) -> StepsForPeaks | None:
    """Move in longer and longer steps; tell which keep the first slow peaks.

    Args:
        motion: from rest, of whose duration as much is taken as the peaks need.
        peaks: the ensemble's.
        cutoff: of the slow motion in Hz.

    Returns:
        None where there are not as many peaks.
    """
    if peaks.times.size < PEAKS:
        return None
    # The filter leans on what follows the last peak by half a period of its own.
    lasting = peaks.times[PEAKS - 1] + 1.0 / cutoff
    # Between outputs there is one step at least.
    steps = motion.output_step * 2.0 ** np.arange(_FINEST, 64)
    trials = []
    for step in steps[steps < _OF_PERIOD / cutoff]:
        output_step = max(step, motion.output_step)
        duration = output_step * round(lasting / output_step)
        trial = FixedStep(step)(replace(motion, duration=duration, output_step=output_step))
        trials.append(
            Trial(
                step=step,
                steps=trial.data.attrs["steps"],
                energy_residual=trial.energy_residual,
                holds=_holds(trial, peaks, cutoff),
            )
        )
    # One trial that misses is chance, as a member of the ensemble may.
    return StepsForPeaks(
        peaks=PEAKS,
        within=WITHIN,
        duration=lasting,
        fewest=min((trial.steps for trial in trials if trial.holds), default=None),
        trials=trials,
    )


def _holds(trajectory: Trajectory, peaks: SlowPeaks, cutoff: float) -> bool:
    """Whether the first slow peaks are where the ensemble has them."""
    times, heights = slow_peaks(trajectory.data["tip"].values, trajectory.time, cutoff)
    if times.size < PEAKS:
        return False
    first = slice(None, PEAKS)
    late = np.abs(times[first] - peaks.times[first])
    apart = np.abs(heights[first] - peaks.heights[first])
    in_time = WITHIN * peaks.period + peaks.time_spreads[first]
    in_height = WITHIN * np.abs(peaks.heights[first]) + peaks.height_spreads[first]
    return bool((late <= in_time).all() and (apart <= in_height).all())
