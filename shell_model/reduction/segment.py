# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reduction of a segment by a block rational Krylov basis of its loads and contact forces.

The basis spans (K + σ M)⁻¹ F and its moments for load vectors F and several shifts σ > 0 (Ruhe
1984; the static modes of Craig and Hurty are the case σ = 0 with one moment). So the response to
contact forces is accurate from statics to the frequencies of the shifts. It includes local
compliance, for which thousands of natural modes would be necessary. Rigid motions are separate, so
that their frequency is exactly zero. Each symmetry class has its own basis on one rank, so that
results are bitwise equal for any number of ranks (:mod:`.shell_model.reduction.symmetry`). Errors
are measured against the full model at frequencies between the shifts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, replace
from itertools import islice
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array
from protractile.shell_model.reduction.krylov import (
    ClassCoordinates,
    Coordinates,
    KrylovOptions,
    reduce_class,
)
from protractile.shell_model.reduction.mirror import SymmetryClass
from protractile.shell_model.reduction.symmetry import (
    Job,
    SymmetryReduction,
    first_half,
    share_jobs,
)


@dataclass(frozen=True, slots=True)
class ReducedSegment(Coordinates):
    """Coordinates of one segment."""

    frequency_limit: float  #: frequency in Hz up to which natural frequencies are accurate to 0.1 %


class SegmentInputs(NamedTuple):
    """Data of the reduction of a segment, on the rows of this rank."""

    symmetry: SymmetryReduction  #: symmetry reduction of the full model
    inputs: Array  #: load vectors (num_owned, num_inputs); they may be zero or dependent
    outputs: Array  #: output rows (num_owned, num_outputs), whose error is also measured
    probes: Array  #: load vectors (num_owned, num_probes) of probes


def reduce_segments(
    segments: Sequence[SegmentInputs],
    options: KrylovOptions,
    progress: Callable[[float], None] = lambda _: None,
    helper: Executor | None = None,
) -> list[ReducedSegment]:
    """Return segments reduced for their inputs and outputs. Collective.

    Args:
        segments: data of each segment.
        options: shifts and moments, or a tolerance.
        progress: callback that receives the completed fraction, 0 to 1.
        helper: second process, which reduces half of the symmetry classes.

    Raises:
        NumericsError: a compliance is not finite, all inputs of a segment are zero, or the
            tolerance is not met.
    """
    comm = segments[0].symmetry.shell.comm
    jobs = [
        segment.symmetry.jobs(segment.inputs, segment.outputs, segment.probes)
        for segment in segments
    ]
    classes = comm.bcast([[job.symmetry_class for job in some] for some in jobs])
    counts = comm.bcast([[job.num_forces for job in some] for some in jobs])
    if not all(any(some) for some in counts):
        raise NumericsError("nothing acts on a segment, and it has no motion: give it a load")
    owners = [segment for segment, some in zip(segments, counts, strict=True) for _ in some]
    # The maximum number of coordinates of a symmetry class is proportional to the number of its
    # forces.
    most = options.most
    class_options = [
        replace(options, most=most and most * count // sum(some))
        for some in counts
        for count in some
    ]
    every = [job for some in jobs for job in some]
    mine = range(comm.rank, len(owners), comm.size)
    here = first_half(every) if helper else len(mine)

    def reduce_here(number: int, job: Job) -> ClassCoordinates:
        done = mine.index(number)
        return reduce_class(
            owners[number].symmetry.cell,
            job,
            class_options[number],
            lambda part: progress((done + part) / here),
        )

    def reduce_there(number: int, job: Job) -> Future[ClassCoordinates]:
        assert helper is not None
        return helper.submit(reduce_class, owners[number].symmetry.cell, job, class_options[number])

    results = share_jobs(comm, every, reduce_here, reduce_there if helper else None)
    return [
        _join(segment.symmetry, some, list(islice(results, len(some))))
        for segment, some in zip(segments, classes, strict=True)
    ]


def _join(
    symmetry: SymmetryReduction,
    classes: Sequence[SymmetryClass],
    results: Sequence[tuple[int, ClassCoordinates | None]],
) -> ReducedSegment:
    """Return the coordinates of a segment from those of its symmetry classes. Collective.

    ``results`` has the rank of each class, and the coordinates of the class on that rank.
    """
    comm = symmetry.shell.comm
    parts = [
        comm.bcast(None if result is None else replace(result, shapes=np.empty(0)), root)
        for root, result in results
    ]
    omega2 = np.concatenate([part.omega2 for part in parts])
    accurate = np.concatenate([part.accurate for part in parts])
    order = np.argsort(omega2, kind="stable")
    # The shapes of a class are inserted at once, since a second array of all shapes would be large.
    shapes = np.empty((symmetry.shell.free.size, omega2.size), order="F")
    places = np.split(np.argsort(order), np.cumsum([part.omega2.size for part in parts])[:-1])
    for symmetry_class, (root, result), columns in zip(classes, results, places, strict=True):
        on_cell = None if result is None else result.shapes
        shapes[:, columns] = symmetry.expand(on_cell, symmetry_class, root)
    # The limit is the last frequency before the first inaccurate one.
    accurate = accurate[order]
    first_inaccurate = accurate.size if accurate.all() else int(np.argmin(accurate))
    limit = (
        np.sqrt(omega2[order][first_inaccurate - 1]) / (2.0 * np.pi) if first_inaccurate else 0.0
    )
    return ReducedSegment(
        omega2=omega2[order],
        shapes=shapes,
        compliance_error=max(part.compliance_error for part in parts),
        output_error=max(part.output_error for part in parts),
        lost_compliance=np.sum([part.lost_compliance for part in parts], axis=0),
        frequency_limit=float(limit),
        geometric=block_diag(*(part.geometric for part in parts))[np.ix_(order, order)],
        coarser=block_diag(*(part.coarser for part in parts))[order],
        probe_compliance=np.sum([part.probe_compliance for part in parts], axis=0),
    )
