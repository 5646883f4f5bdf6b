# SPDX-License-Identifier: LGPL-3.0-or-later
"""The gap system of each model of a case."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dynamics.damping import with_ratio
from dynamics.gap_system import GapSystem
from geometry.arrays import Array
from geometry.boom import Boom
from runs.case.build import joined
from runs.case.kinds.model import Built, Joined, ModelTable, Workshop
from runs.case.pulled import with_pulled
from runs.case.schema import Case, Model

if TYPE_CHECKING:
    from mpi4py import MPI

    from runs.folder.cache import Cache
    from shell_model.reduced_shell import ReducedShell


def build(case: Case, boom: Boom, model: Model, workshop: Workshop | None = None) -> Built:
    """A model of a case. Collective where it is meshed.

    Args:
        case: its joints have the contact laws.
        boom: of the case.
        model: one of the case's.
        workshop: for a meshed one.

    Raises:
        BoomError: the boom lacks what the model needs.
    """
    return build_on(joined(case, boom, model), case, model, workshop)


def build_on(
    joined: Joined, case: Case, model: ModelTable, workshop: Workshop | None = None
) -> Built:
    """A model on the boom of a case; arguments and errors as of :func:`build`."""
    built = model.build(joined, workshop)
    return replace(built, system=with_pulled(built.system, case, joined.boom))


def workshop(
    comm: MPI.Comm,
    tell: Callable[[str, float], None] = lambda *_: None,
    cache: Cache | None = None,
) -> Workshop:
    """What a meshed model is made with.

    Args:
        comm, tell: as in :class:`runs.case.kinds.model.Workshop`.
        cache: where the same shell may be already, and is kept; computed unless given.
    """
    from runs.folder.shell_cache import remembered

    def remember(content: Sequence[Any], compute: Callable[[], ReducedShell]) -> ReducedShell:
        if cache is None:
            return compute()
        return remembered(cache, content, comm, compute)

    return Workshop(comm, tell, remember)


def damped(system: GapSystem, case: Case, rest: Array | None = None) -> GapSystem:
    """A model's system with the damping of its case besides the segments' own.

    Rayleigh's is α + β ω² in the modes of the segments; a damping ratio is one of the boom's modes
    with its joints pressed as at ``rest`` (:func:`dynamics.damping.with_ratio`).
    """
    table = case.damping
    rates = system.damping + table.mass + table.stiffness * np.maximum(system.omega2, 0.0)
    system = replace(system, damping=rates)
    if table.modal == 0.0:
        return system
    return with_ratio(system, table.modal, rest)
