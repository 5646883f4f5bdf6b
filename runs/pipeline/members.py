# SPDX-License-Identifier: LGPL-3.0-or-later
"""The ensembles of a run: one for each model with play, and what they say of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from concurrent.futures import Executor
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from beam_model.finite_element import finite_element_segments
from beam_model.segment_model import tied_system
from dynamics.predictability.horizon import SHARES, horizons_of
from dynamics.predictability.low_pass import CUTOFF_SHARE, SlowPeaks
from geometry.boom import Boom
from runs.case.schema import TimeTable
from runs.pipeline.summary import CommonPeaks, EnsembleSummary

if TYPE_CHECKING:
    from mpi4py import MPI

# Elements of the closed boom, whose lowest frequency they give to four digits.
ELEMENT_LENGTH = 0.5
# Deflections that are kept of every member.
PLACES = ("tip", "head")


@contextmanager
def workers(comm: MPI.Intracomm | None) -> Iterator[Executor | None]:
    """Who makes the runs of an ensemble: all ranks but the first, or None for our own threads.

    Collective. Other ranks than the first get None, once they have nothing to do any more.
    """
    if comm is None or comm.size == 1:
        yield None
        return
    from mpi4py.futures import MPICommExecutor

    with MPICommExecutor(comm, root=0) as ranks:
        yield ranks


def slow_below(boom: Boom, time: TimeTable) -> float | None:
    """Cut-off in Hz of the slow motion: part of the lowest elastic frequency without play.

    None where the run is too short for it, too coarsely reported, or about a boom that no model
    can compute either, as each of them will say.
    """
    try:
        with np.errstate(all="ignore"):
            segments = finite_element_segments(boom, ELEMENT_LENGTH, "euler-bernoulli", True)
            frequencies = tied_system(boom, segments).frequencies
    except (ArithmeticError, np.linalg.LinAlgError, ValueError):
        return None
    elastic = frequencies[frequencies > 0.0]
    if elastic.size == 0:
        return None
    cutoff = CUTOFF_SHARE * float(elastic[0])
    if not 2.0 * time.output_step < 1.0 / cutoff < time.duration:
        return None
    return cutoff


def common_peaks(ensemble: xr.Dataset, cutoff: float | None) -> SlowPeaks | None:
    """The tip's slow peaks that all members have; None without a cut-off in Hz."""
    if cutoff is None:
        return None
    return SlowPeaks.of(ensemble["tip"].values, ensemble["time"].values, cutoff)


def sum_up(ensemble: xr.Dataset, peaks: SlowPeaks | None) -> EnsembleSummary:
    """What the summary says of one model's ensemble.

    Args:
        ensemble: of :func:`dynamics.predictability.ensemble.integrate_ensemble`.
        peaks: its :func:`common_peaks`.
    """
    shares = zip(SHARES, horizons_of(ensemble), strict=True)
    return EnsembleSummary(
        horizons={f"{share:g}": time for share, time in shares},
        energy_residual=float(ensemble["energy_residual"].max()),
        slow_peaks=None if peaks is None else CommonPeaks.model_validate(peaks),
    )


def gather(ensembles: Mapping[str, xr.Dataset]) -> xr.Dataset | None:
    """Tip and head of all ensembles in one dataset, in single precision; None without any.

    Args:
        ensembles: by the model's name, of the same members and times.
    """
    if not ensembles:
        return None
    kept = [
        ensemble[[place for place in PLACES if place in ensemble]].astype(np.float32)
        for ensemble in ensembles.values()
    ]
    together = xr.concat(kept, xr.Variable("model", list(ensembles)), combine_attrs="override")
    return together.drop_vars("station", errors="ignore").assign_attrs(
        vary=kept[0].attrs["vary"], relative=kept[0].attrs["relative"], seed=kept[0].attrs["seed"]
    )
