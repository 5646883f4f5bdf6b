# SPDX-License-Identifier: LGPL-3.0-or-later
"""Equal results on one rank and on several, and compilation of forms."""

import json
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="forms are compiled by FFCx")

from mpi4py import MPI

from protractile.geometry.boom import Boom, Pad
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.buckling import ShellState, buckle_segments
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.segment.segment_shell import SegmentShell
from tests.conftest import ranks_in
from tests.shell_model.booms import HELD, LAW, flat_boom
from tests.shell_model.conftest import box_shell
from tests.shell_model.test_stiffeners import short_box
from tests.touching import touching

pytestmark = pytest.mark.slow

# Prints the results on rank 0.
_PROGRAM = """
import json
from mpi4py import MPI
from tests.shell_model.test_mpi import everything
answer = everything(MPI.COMM_WORLD)
if MPI.COMM_WORLD.rank == 0:
    print(json.dumps(answer))
"""


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


def test_ranks_give_the_serial_results(tmp_path: Path) -> None:
    """Reference: one rank, to the last bit; buckling factors to 1e-8."""
    serial = everything(MPI.COMM_SELF)
    done = ranks_in(tmp_path)(2, _PROGRAM)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.strip().splitlines()[-1])
    assert found["rubbing"] == serial["rubbing"]
    assert np.count_nonzero(serial["rubbing"]["friction_rows"]) > 0
    assert np.abs(serial["rubbing"]["stresses"]).max() > 1.0e4
    assert found["accelerated"] == serial["accelerated"]
    assert 0.0 < serial["buckled"][0] < serial["buckled"][1]
    assert found["buckled"] == pytest.approx(serial["buckled"], rel=1.0e-8)
    # Analytic: the dofs of vertices and edges, each once for any partition.
    assert found["dofs"] == serial["dofs"] == [780, 2220]


ROOT = Path(__file__).parents[2]
COMPILE = """
import os, signal
import ffcx.codegeneration.jit as compiler
from mpi4py import MPI
from dolfinx import fem, mesh
import ufl
from protractile.shell_model import compat
domain = mesh.create_unit_interval(MPI.COMM_SELF, 2)
if {killed}:
    compiler._compile_objects = lambda *_, **__: os.kill(os.getpid(), signal.SIGKILL)
one = fem.Constant(domain, 3.0)
print(fem.assemble_scalar(fem.form(one * ufl.dx(domain=domain))))
"""


def compile_form(
    folder: Path, killed: bool, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Compile and evaluate a form. Reference: analytic, the integral of 3 over a unit."""
    outside = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_", "PMI"))}
    return subprocess.run(
        [sys.executable, "-c", COMPILE.format(killed=killed)],
        env=outside | {"PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(folder)} | environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_only_the_first_compilation_needs_a_compiler_even_if_one_was_killed(
    tmp_path: Path,
) -> None:
    """Reference: by construction. The last line names the compiler and the packages."""
    assert compile_form(tmp_path, True).returncode == -signal.SIGKILL
    assert list((tmp_path / "fenics" / "protractile").glob("*.c"))
    missing = compile_form(tmp_path, False, CC="/no/cc").stderr.splitlines()[-1]
    assert "/no/cc" in missing
    assert missing.endswith(
        "; the forms of a shell are compiled once, which needs a C compiler and Python's headers: "
        "apt install gcc python3-dev, or dnf install gcc python3-devel: 'CC'"
    )
    assert compile_form(tmp_path, False).stdout == "3.0\n"
    assert compile_form(tmp_path, False, CC="/no/cc").stdout == "3.0\n"
