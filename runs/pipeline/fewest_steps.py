# SPDX-License-Identifier: LGPL-3.0-or-later
"""How few steps a model's slow motion needs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np

from dynamics.failure import NumericsError
from dynamics.integrators.event_driven import TOLERANCE, integrate_events, what_hinders
from dynamics.integrators.integrator import FEW_MODES
from dynamics.integrators.splitting import integrate
from dynamics.integrators.step import contact_step
from dynamics.motion import Motion
from dynamics.predictability.low_pass import SlowPeaks, slow_peaks
from dynamics.trajectory import Trajectory
from runs.pipeline.summary import StepsForPeaks, Trial

# As many peaks as the slow motion has before its spread is as large as the peaks' differences.
PEAKS = 3
# How near a peak must be: in time as a part of the period, in height as a part of itself, beyond
# the spread that an ensemble of fully resolved runs has by itself.
WITHIN = 0.01


def steps_for_peaks(motion: Motion, peaks: SlowPeaks, cutoff: float) -> StepsForPeaks | None:
    """Longer and longer steps, until the energy is lost, and which keep the first slow peaks.

    A step counts however many small ones it stands for: several made at once while nothing can
    touch, or one jump from contact to contact.

    Args:
        motion: from rest, of whose duration as much is taken as the peaks need.
        peaks: the ensemble's.
        cutoff: of the slow motion in Hz.

    Returns:
        None where there are not as many peaks.
    """
    if peaks.times.size < PEAKS:
        return None
    system, output_step = motion.system, motion.output_step
    # The filter leans on what follows the last peak by half a period of its own.
    duration = output_step * round((peaks.times[PEAKS - 1] + 1.0 / cutoff) / output_step)
    motion = replace(motion, duration=duration)
    trials: list[Trial] = []

    def note(integrator: str, trajectory: Trajectory) -> None:
        trials.append(
            Trial(
                integrator=integrator,
                step=trajectory.data.attrs["step"],
                steps=trajectory.data.attrs["steps"],
                energy_residual=trajectory.energy_residual,
                holds=_holds(trajectory, peaks, cutoff),
            )
        )

    # One trial that misses is chance, as a member of the ensemble may; the energy ends them.
    with suppress(NumericsError):
        for step in _coarser(contact_step(system, output_step), 2.0, output_step):
            note("splitting", integrate(motion, step))
    if system.num_modes <= FEW_MODES and what_hinders(system) is None:
        with suppress(NumericsError):
            for tolerance in _coarser(TOLERANCE, 10.0, 1.0):
                note("events", integrate_events(motion, tolerance))
    return StepsForPeaks(
        peaks=PEAKS,
        within=WITHIN,
        duration=duration,
        fewest=min((trial.steps for trial in trials if trial.holds), default=None),
        trials=trials,
    )


def _coarser(first: float, factor: float, last: float) -> Iterator[float]:
    while first <= last:
        yield first
        first *= factor


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
