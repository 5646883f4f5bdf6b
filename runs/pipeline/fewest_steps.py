# SPDX-License-Identifier: LGPL-3.0-or-later
"""How few steps a model's slow motion needs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np

from dynamics.event_driven import TOLERANCE, integrate_events, what_hinders
from dynamics.failure import NumericsError
from dynamics.integrators import FEW_MODES
from dynamics.motion import Motion
from dynamics.predictability.low_pass import slow_peaks
from dynamics.splitting import integrate
from dynamics.step import contact_step
from dynamics.trajectory import Trajectory

# As many peaks as the slow motion has before its spread is as large as the peaks' differences.
PEAKS = 3
# How near a peak must be: in time as a part of the period, in height as a part of itself, beyond
# the spread that an ensemble of fully resolved runs has by itself.
WITHIN = 0.01


def steps_for_peaks(
    motion: Motion, peaks: Mapping[str, Any], cutoff: float
) -> dict[str, Any] | None:
    """Longer and longer steps, until the energy is lost, and which keep the first slow peaks.

    A step counts however many small ones it stands for: several made at once while nothing can
    touch, or one jump from contact to contact.

    Args:
        motion: from rest, of whose duration as much is taken as the peaks need.
        peaks: the ensemble's, as :func:`runs.pipeline.members.sum_up` gives them.
        cutoff: of the slow motion in Hz.

    Returns:
        ``peaks``, ``within``, ``duration`` in s, ``fewest`` steps (None where no trial holds) and
        ``trials``, each with ``integrator``, ``step`` in s, ``steps``, ``energy_residual`` and
        whether it ``holds``; None where there are not as many peaks.
    """
    if len(peaks["time"]) < PEAKS:
        return None
    system, output_step = motion.system, motion.output_step
    # The filter leans on what follows the last peak by half a period of its own.
    duration = output_step * round((peaks["time"][PEAKS - 1] + 1.0 / cutoff) / output_step)
    motion = replace(motion, duration=duration)
    trials: list[dict[str, Any]] = []

    def note(integrator: str, trajectory: Trajectory) -> None:
        trials.append(
            {
                "integrator": integrator,
                "step": trajectory.data.attrs["step"],
                "steps": trajectory.data.attrs["steps"],
                "energy_residual": trajectory.energy_residual,
                "holds": _holds(trajectory, peaks, cutoff),
            }
        )

    # One trial that misses is chance, as a member of the ensemble may; the energy ends them.
    with suppress(NumericsError):
        for step in _coarser(contact_step(system, output_step), 2.0, output_step):
            note("splitting", integrate(motion, step))
    if system.num_modes <= FEW_MODES and what_hinders(system) is None:
        with suppress(NumericsError):
            for tolerance in _coarser(TOLERANCE, 10.0, 1.0):
                note("events", integrate_events(motion, tolerance))
    return {
        "peaks": PEAKS,
        "within": WITHIN,
        "duration": duration,
        "fewest": min((trial["steps"] for trial in trials if trial["holds"]), default=None),
        "trials": trials,
    }


def _coarser(first: float, factor: float, last: float) -> Iterator[float]:
    while first <= last:
        yield first
        first *= factor


def _holds(trajectory: Trajectory, peaks: Mapping[str, Any], cutoff: float) -> bool:
    """Whether the first slow peaks are where the ensemble has them."""
    times, heights = slow_peaks(trajectory.data["tip"].values, trajectory.time, cutoff)
    if times.size < PEAKS:
        return False
    first = slice(None, PEAKS)
    late = np.abs(times[first] - peaks["time"][first])
    apart = np.abs(heights[first] - peaks["height"][first])
    return bool(
        (late <= WITHIN * peaks["period"] + np.array(peaks["time_spread"][first])).all()
        and (
            apart
            <= WITHIN * np.abs(peaks["height"][first]) + np.array(peaks["height_spread"][first])
        ).all()
    )
