# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results of shells on any number of ranks."""

from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI

from protractile.geometry.boom import Boom, Pad
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.buckling import ShellState, buckle_segments
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.segment.segment_shell import SegmentShell
from tests.shell_model.booms import HELD, LAW, flat_boom
from tests.shell_model.conftest import box_shell
from tests.shell_model.test_stiffeners import short_box
from tests.touching import touching


def everything(comm: MPI.Comm) -> dict[str, Any]:
    """Return the results of several ranks, computed in one start."""
    shells = [short_box(comm, size) for size in (0.3, 0.1)]
    return {
        "rubbing": rubbing(comm),
        "accelerated": accelerated(comm, shells),
        "buckled": buckled(comm),
        "dofs": [shell.num_dofs for shell in shells],
    }


def rubbing(comm: MPI.Comm) -> dict[str, Any]:
    """Return all that a coarse boom with friction and pads moves by, and on rank 0 its stresses."""
    law = replace(LAW.law, stiffness=1.0e8, exponent=1.0).with_clearance(LAW.above)
    options = ShellOptions(1.0, krylov=KrylovOptions(shifts=(5.0, 300.0), moments=1))
    boom = flat_boom(friction=0.2)
    boom = replace(boom, joints=(replace(boom.joints[0], pad=Pad(0.1, 0.06)),))
    shell = reduce_boom(touching(boom, law), options, comm)
    system = shell.system
    names = "omega2", "rows", "load", "friction_rows", "damping"
    parts = {name: getattr(system, name) for name in names}
    parts |= {f"observer {name}": observer.row for name, observer in system.observers.items()}
    if shell.fields is not None:
        own = shell.fields["coordinates_1"].values
        state = own @ system.load / (own @ system.omega2)
        parts["stresses"] = np.tensordot(state, shell.fields["stress_1"].values, axes=1)
    return {name: part.tolist() for name, part in parts.items()}


def buckled(comm: MPI.Comm) -> list[float]:
    """Return buckling factors of a box in bending, with supports at 0 and 2 m."""
    shell = box_shell(0.5, supports=HELD)  # on all ranks
    along = comm.bcast(None if shell.mesh is None else shell.mesh.along)
    forces = np.outer(along - 10.0, [1.0e5, 0.0, 2.0e4])
    boom = Boom((shell.segment,), ())
    state = ShellState([forces], np.zeros(0), {})
    (found,) = buckle_segments(boom, [shell.mesh], state, ShellOptions(0.5), 2, comm)
    return [float(factor) for factor in found.factors]


def accelerated(comm: MPI.Comm, shells: list[SegmentShell]) -> list[list[float]] | None:
    """Return the positions and inertia loads of the nodes of boxes, in order, on rank 0."""
    rows = []
    for shell in shells:
        loads = [f for d in ("y", "z") for f in (shell.inertia(d, 1.0), shell.rotation_load(d))]
        first, _ = shell.owned
        for places, dofs in shell.plates.nodes:
            rows.append(np.hstack([places.round(9), *(load[dofs - first] for load in loads)]))
    gathered = comm.gather(np.concatenate(rows))
    return None if gathered is None else sorted(np.concatenate(gathered).tolist())
