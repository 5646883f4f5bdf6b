# SPDX-License-Identifier: LGPL-3.0-or-later
"""Predictability of the motion of a model: ensemble, horizons, and required number of steps."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from protractile.analysis.low_pass import CUTOFF_SHARE, SlowPeaks, slow_peaks
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.boom import Boom
from protractile.runs.case.schema import TimeTable
from protractile.runs.pipeline.summary import StepsForPeaks, Trial

if TYPE_CHECKING:
    from mpi4py import MPI

# Length of beam elements in m that gives the first frequency to four digits.
ELEMENT_LENGTH = 0.5
# Outputs that are stored for every member.
PLACES = ("tip", "head")
# Number of compared peaks. At later peaks the spread of the ensemble exceeds the differences.
PEAKS = 3
# Permitted difference of a peak from the ensemble mean, in addition to the spread. The time of a
# peak may differ by this fraction of the period, its height by this fraction of itself.
PEAK_TOLERANCE = 0.01

# The shortest trial step is the output step times 2 to this power. The longest is below this
# fraction of the period of the cut-off, so that the filter can resolve the slow motion.
_FIRST_POWER, _MAX_STEP_SHARE = -4, 0.25


def rank_executor(
    comm: MPI.Intracomm | None, alone: Callable[[], AbstractContextManager[Any]] = nullcontext
) -> AbstractContextManager[Executor | None]:
    """Return an executor for the first rank, which all other ranks work for. Collective.

    A single rank gets the executor of ``alone``, by default None. Other ranks get None after their
    work.
    """
    if comm is None or comm.size == 1:
        return alone()
    from mpi4py.futures import MPICommExecutor

    executor: AbstractContextManager[Executor | None] = MPICommExecutor(comm, root=0)
    return executor


def slow_cutoff(boom: Boom, time: TimeTable) -> float | None:
    """Return the low-pass cut-off in Hz, a fraction of the first frequency without play.

    The result is None if the run is too short, its output too coarse, or this frequency is missing.
    """
    try:
        with np.errstate(all="ignore"):
            segments = finite_element_segments(boom, ELEMENT_LENGTH, "euler-bernoulli", True)
            frequencies = gap_system(boom.bonded, segments).frequencies
    except (ArithmeticError, np.linalg.LinAlgError, ValueError):
        return None
    elastic = frequencies[frequencies > 0.0]
    if elastic.size == 0:
        return None
    cutoff = CUTOFF_SHARE * float(elastic[0])
    if not 2.0 * time.output_step < 1.0 / cutoff < time.duration:
        return None
    return cutoff


def gather_ensembles(ensembles: Mapping[str, xr.Dataset]) -> xr.Dataset | None:
    """Return tip and head deflections of all ensembles in single precision; None without ensembles.

    All ensembles, which are given by model name, have the same members and times.
    """
    if not ensembles:
        return None
    kept = [
        ensemble[[place for place in PLACES if place in ensemble]].astype(np.float32)
        for ensemble in ensembles.values()
    ]
    together = xr.concat(kept, xr.Variable("model", list(ensembles)), combine_attrs="override")
    return together.drop_vars("station", errors="ignore")


def steps_for_peaks(motion: Motion, peaks: SlowPeaks, cutoff: float) -> StepsForPeaks | None:
    """Return motions with longer and longer time steps, and the fewest steps that keep the peaks.

    Args:
        motion: motion of the model, which is integrated up to the last compared peak.
        peaks: peaks of the slow motion of the ensemble.
        cutoff: cut-off of the slow motion in Hz.

    Returns:
        The trials; None if the ensemble has too few peaks.
    """
    if peaks.time.size < PEAKS:
        return None
    # The motion ends one period of the cut-off after the last peak: the filter is inexact there.
    lasting = peaks.time[PEAKS - 1] + 1.0 / cutoff
    # Every output interval has at least one step.
    steps = motion.output_step * 2.0 ** np.arange(_FIRST_POWER, 64)
    trials = []
    for step in steps[steps < _MAX_STEP_SHARE / cutoff]:
        output_step = max(step, motion.output_step)
        duration = output_step * round(lasting / output_step)
        trial = FixedStep(step)(replace(motion, duration=duration, output_step=output_step))
        trials.append(
            Trial(
                step=step,
                steps=trial.data.attrs["steps"],
                energy_residual=trial.energy_residual,
                holds=_peaks_agree(trial, peaks, cutoff),
            )
        )
    # A single trial may fail by chance.
    return StepsForPeaks(
        peaks=PEAKS,
        within=PEAK_TOLERANCE,
        duration=lasting,
        fewest=min((trial.steps for trial in trials if trial.holds), default=None),
        trials=trials,
    )


def _peaks_agree(trajectory: Trajectory, peaks: SlowPeaks, cutoff: float) -> bool:
    """Return True if the first slow peaks agree with the peaks of the ensemble."""
    times, heights = slow_peaks(trajectory.data["tip"].values, trajectory.time, cutoff)
    if times.size < PEAKS:
        return False
    first = slice(None, PEAKS)
    late = np.abs(times[first] - peaks.time[first])
    apart = np.abs(heights[first] - peaks.height[first])
    in_time = PEAK_TOLERANCE * peaks.period + peaks.time_spread[first]
    in_height = PEAK_TOLERANCE * np.abs(peaks.height[first]) + peaks.height_spread[first]
    return bool((late <= in_time).all() and (apart <= in_height).all())
