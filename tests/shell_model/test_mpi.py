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

from protractile.dynamics.failure import NumericsError
from protractile.geometry.boom import Boom, Direction
from protractile.shell_model.boom_shell import ShellOptions, assemble_boom
from protractile.shell_model.buckling import ShellState, buckle_segments
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.reduction.symmetry import run_collectively
from studies.reference_models.single_segment import natural_frequencies
from studies.reference_models.unreduced import integrate_directly
from tests.conftest import ranks_in
from tests.shell_model.booms import HELD, LATERAL_LAW, LAW, boom_in_space, flat_boom
from tests.shell_model.conftest import box_shell
from tests.shell_model.test_stiffeners import short_box
from tests.shell_model.test_surface_contact import compliances
from tests.touching import touching

pytestmark = pytest.mark.slow

# Edge lengths of boxes of 0.3 m, in m.
SHORT_SIZES = 0.3, 0.1


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
    return {
        "frequencies": frequencies(comm), "spatial": spatial(comm), "rubbing": rubbing(comm),
        "pressed": compliances(comm), "moved": moved(comm), "accelerated": accelerated(comm),
        "buckled": buckled(comm), "dofs": [short_box(comm, size).num_dofs for size in SHORT_SIZES],
        "failed": failure(comm),
    }  # fmt: skip


def frequencies(comm: MPI.Comm) -> list[float]:
    """Return the frequencies of a supported box in Hz; :func:`box_shell` is on all ranks."""
    assert comm.size == MPI.COMM_WORLD.size
    return [float(f) for f in natural_frequencies(box_shell(0.5, supports=HELD), 12)]


def spatial(comm: MPI.Comm) -> dict[str, Any]:
    """Return the reduced boom in space."""
    boom = boom_in_space(friction=0.2, sideways=0.3)
    system = reduce_boom(touching(boom, LAW, LATERAL_LAW), ShellOptions(1.0), comm).system
    parts = {"omega2": system.omega2, "rows": system.rows, "load": system.load}
    return {name: part.tolist() for name, part in parts.items()}


def rubbing(comm: MPI.Comm) -> dict[str, Any]:
    """Return all numbers that determine the motion of the paper's friction case, coarse, and on
    rank 0 the stresses of the outer segment under its static load.
    """
    law = replace(LAW.law, stiffness=1.0e8, exponent=1.0).with_clearance(LAW.above)
    options = ShellOptions(1.0, krylov=KrylovOptions(shifts=(5.0, 300.0), moments=1))
    shell = reduce_boom(touching(flat_boom(friction=0.2), law), options, comm)
    system = shell.system
    parts = {
        "omega2": system.omega2,
        "rows": system.rows,
        "load": system.load,
        "friction_rows": system.friction_rows,
        "damping": system.damping,
        **{f"observer {name}": observer.row for name, observer in system.observers.items()},
    }
    if shell.fields is not None:
        own = shell.fields["coordinates_1"].values
        state = own @ system.load / (own @ system.omega2)
        parts["stresses"] = np.tensordot(state, shell.fields["stress_1"].values, axes=1)
    return {name: part.tolist() for name, part in parts.items()}


def moved(comm: MPI.Comm) -> dict[str, Any]:
    """Return the motion of the unreduced shell with friction."""
    law = replace(LAW.law, stiffness=1.0e9, exponent=1.0).with_clearance(LAW.above)
    full = assemble_boom(touching(flat_boom(friction=0.2), law), ShellOptions(1.0), comm)
    motion = integrate_directly(full, 0.04, 5.0e-4)
    return {"tip": motion.observed["tip"].tolist(), "residual": motion.energy_residual}


def buckled(comm: MPI.Comm) -> list[float]:
    """Return buckling factors of a box in bending, with supports at 0 and 2 m."""
    shell = box_shell(0.5, supports=HELD)
    along = comm.bcast(None if shell.mesh is None else shell.mesh.along)
    forces = np.outer(along - 10.0, [1.0e5, 0.0, 2.0e4])
    boom = Boom((shell.segment,), ())
    state = ShellState([forces], np.zeros(0), {})
    (found,) = buckle_segments(boom, [shell.mesh], state, ShellOptions(0.5), 2, comm)
    return [float(factor) for factor in found.factors]


def accelerated(comm: MPI.Comm) -> list[list[float]] | None:
    """Return the positions and inertia loads of the nodes of boxes, in order, on rank 0."""
    rows = []
    directions: tuple[Direction, ...] = ("y", "z")
    for shell in (short_box(comm, size) for size in SHORT_SIZES):
        loads = [f for d in directions for f in (shell.inertia(d, 1.0), shell.rotation_load(d))]
        first, _ = shell.owned
        for places, dofs in shell.plates.nodes:
            rows.append(np.hstack([places.round(9), *(load[dofs - first] for load in loads)]))
    gathered = comm.gather(np.concatenate(rows))
    return None if gathered is None else sorted(np.concatenate(gathered).tolist())


def failure(comm: MPI.Comm) -> list[str] | None:
    """Return the message of each rank after a failure of the second one."""

    def work() -> None:
        if comm.rank == 1:
            raise NumericsError("the second rank cannot")

    try:
        run_collectively(comm, work)
        told = ""
    except NumericsError as error:
        told = str(error)
    return comm.gather(told)


@pytest.fixture(scope="module")
def serial_motion() -> dict[str, Any]:
    """Return the results of one rank, which compiles for the others."""
    return moved(MPI.COMM_SELF)


@pytest.fixture(scope="module")
def two_ranks(
    tmp_path_factory: pytest.TempPathFactory, serial_motion: dict[str, Any]
) -> dict[str, Any]:
    """Return the results of two ranks."""
    done = ranks_in(tmp_path_factory.mktemp("two"))(2, _PROGRAM)
    assert done.returncode == 0, done.stderr
    told: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return told


def test_ranks_give_the_serial_frequencies(two_ranks: dict[str, Any]) -> None:
    """Reference: the serial run, to 1e-8. The first is the free slide along x."""
    found, serial = np.array(two_ranks["frequencies"]), frequencies(MPI.COMM_SELF)
    assert np.abs([found[0], serial[0]]) == pytest.approx([0.0, 0.0], abs=1.0e-3)
    assert found[1:] == pytest.approx(serial[1:], rel=1.0e-8)


def test_ranks_give_the_serial_coordinates(two_ranks: dict[str, Any]) -> None:
    """Reference: the serial run, mode by mode and sign by sign."""
    found, serial = (
        {name: np.array(part) for name, part in answer.items()}
        for answer in (two_ranks["spatial"], spatial(MPI.COMM_SELF))
    )
    assert np.sqrt(found["omega2"]) == pytest.approx(np.sqrt(serial["omega2"]), rel=1.0e-6)
    for name in ("rows", "load"):
        off = np.abs(found[name] - serial[name]).max()
        assert off < 1.0e-5 * np.abs(serial[name]).max()


def test_ranks_give_the_serial_motion(two_ranks: dict[str, Any]) -> None:
    """Reference: one rank, to the last bit of all that decides a motion, and of its stresses."""
    found, serial = two_ranks["rubbing"], rubbing(MPI.COMM_SELF)
    stresses, expected = (np.array(one.pop("stresses")) for one in (found, serial))
    assert np.count_nonzero(serial["friction_rows"]) > 0
    assert found == serial
    assert np.abs(expected).max() > 1.0e4
    assert (stresses == expected).all()


def test_ranks_give_the_serial_inertia_loads(two_ranks: dict[str, Any]) -> None:
    """Reference: one rank, to the last bit, also on edges of three walls."""
    assert two_ranks["accelerated"] == accelerated(MPI.COMM_SELF)


def test_ranks_find_the_same_points(two_ranks: dict[str, Any]) -> None:
    """Reference: the serial run."""
    assert two_ranks["pressed"] == pytest.approx(compliances(MPI.COMM_SELF), rel=1.0e-6)


def test_ranks_buckle_at_the_serial_factors(two_ranks: dict[str, Any]) -> None:
    """Reference: the serial run, to 1e-8."""
    serial = buckled(MPI.COMM_SELF)
    assert 0.0 < serial[0] < serial[1]
    assert two_ranks["buckled"] == pytest.approx(serial, rel=1.0e-8)


def test_ranks_give_the_serial_motion_of_all(
    two_ranks: dict[str, Any], serial_motion: dict[str, Any]
) -> None:
    """Reference: the serial run, to 1e-9 of the range."""
    found = two_ranks["moved"]
    tip = np.array(found["tip"])
    assert np.abs(tip - serial_motion["tip"]).max() < 1.0e-9 * np.ptp(tip)
    assert found["residual"] == pytest.approx(serial_motion["residual"], rel=1.0e-3)


def test_ranks_share_an_edge_of_three_walls(two_ranks: dict[str, Any]) -> None:
    """Reference: analytic, the dofs of vertices and edges, each once for any partition."""
    serial = [short_box(MPI.COMM_SELF, size).num_dofs for size in SHORT_SIZES]
    assert two_ranks["dofs"] == serial == [780, 2220]


def test_failure_on_one_rank_fails_all_ranks(two_ranks: dict[str, Any]) -> None:
    assert two_ranks["failed"] == ["the second rank cannot"] * 2


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


def test_next_process_completes_a_killed_compilation(tmp_path: Path) -> None:
    assert compile_form(tmp_path, True).returncode == -signal.SIGKILL
    assert list((tmp_path / "fenics" / "protractile").glob("*.c"))
    assert compile_form(tmp_path, False).stdout == "3.0\n"


def test_only_the_first_compilation_needs_a_compiler(tmp_path: Path) -> None:
    """Reference: by construction. The last line names the compiler and the packages."""
    missing = compile_form(tmp_path, False, CC="/no/cc").stderr.splitlines()[-1]
    assert "/no/cc" in missing
    assert missing.endswith(
        "; the forms of a shell are compiled once, which needs a C compiler and Python's headers: "
        "apt install gcc python3-dev, or dnf install gcc python3-devel: 'CC'"
    )
    assert compile_form(tmp_path, False).stdout == "3.0\n"
    assert compile_form(tmp_path, False, CC="/no/cc").stdout == "3.0\n"
