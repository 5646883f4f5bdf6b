# SPDX-License-Identifier: LGPL-3.0-or-later
"""What fails on one rank fails on all, with one message."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from mpi4py import MPI
from petsc4py import PETSc

from dynamics.failure import NumericsError

Result = TypeVar("Result")


def together(comm: MPI.Comm, work: Callable[[], Result]) -> Result:
    """Each rank's result of its own work. Collective, but the work must not communicate.

    Raises:
        NumericsError: on every rank, if the work of any raises it, or its memory does not suffice.
    """
    results: list[Result] = []
    problem = ""
    try:
        results.append(work())
    except NumericsError as error:
        problem = str(error)
    except (MemoryError, PETSc.Error) as error:
        problem = f"the direct solver failed ({error}); give it more memory, or a coarser mesh"
    problems = [told for told in comm.allgather(problem) if told]
    if problems:
        raise NumericsError(problems[0])
    return results[0]
