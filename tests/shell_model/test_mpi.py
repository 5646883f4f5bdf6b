# SPDX-License-Identifier: LGPL-3.0-or-later
"""Several ranks give what one gives."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from dynamics.gap_system import GapSystem
from dynamics.motion import Motion
from dynamics.splitting import integrate
from geometry.arrays import Array
from shell_model.boom_shell import ShellOptions
from shell_model.reduced_shell import reduce_boom
from shell_model.reduction.segment import KrylovOptions
from shell_model.segment_shell import SegmentShell
from shell_model.verification.eigenmodes import natural_frequencies
from tests.shell_model.booms import HELD, LATERAL_LAW, LAW, boom_in_space, flat_boom

pytestmark = pytest.mark.slow


OnRanks = Callable[..., subprocess.CompletedProcess[str]]
TwoRanks = Callable[..., subprocess.CompletedProcess[str]]

_FREQUENCIES = """
import json
from mpi4py import MPI
from shell_model.verification.eigenmodes import natural_frequencies
from tests.shell_model.booms import HELD
from tests.shell_model.conftest import box_shell
comm = MPI.COMM_WORLD
found = natural_frequencies(box_shell(0.25, supports=HELD), 12)
if comm.rank == 0:
    print(json.dumps({"ranks": comm.size, "frequencies": found.tolist()}))
"""

_REDUCED = """
import json
from mpi4py import MPI
from shell_model.boom_shell import ShellOptions
from shell_model.reduced_shell import reduce_boom
from tests.shell_model.booms import LATERAL_LAW, LAW, boom_in_space
comm = MPI.COMM_WORLD
boom = boom_in_space(friction=0.2, sideways=0.3)
system = reduce_boom(boom, [LAW], ShellOptions(0.5), comm, lateral_laws=[LATERAL_LAW]).system
if comm.rank == 0:
    parts = {"omega2": system.omega2, "rows": system.rows, "load": system.load}
    print(json.dumps({name: part.tolist() for name, part in parts.items()}))
"""


_MOVED = """
import json, sys
from pathlib import Path
import numpy as np
from mpi4py import MPI
from tests.shell_model.test_mpi import friction_motion
tips, system = friction_motion(MPI.COMM_WORLD)
if MPI.COMM_WORLD.rank == 0:
    np.savez(sys.argv[1], tip=tips, omega2=system.omega2, rows=system.rows, load=system.load)
    print(json.dumps({"ranks": MPI.COMM_WORLD.size}))
"""


_FAILED = """
import json
from mpi4py import MPI
from dynamics.failure import NumericsError
from shell_model.reduction.agreement import together
comm = MPI.COMM_WORLD

def work():
    if comm.rank == 1:
        raise NumericsError("the second rank cannot")

try:
    together(comm, work)
    told = ""
except NumericsError as error:
    told = str(error)
told = comm.gather(told)
if comm.rank == 0:
    print(json.dumps({"told": told}))
"""


def friction_motion(comm: MPI.Comm) -> tuple[Array, GapSystem]:
    """The tip in m over the ten seconds of the paper's friction case, on a coarse mesh."""
    law = replace(LAW, stiffness=1.0e8, exponent=1.0)
    options = ShellOptions(0.5, krylov=KrylovOptions(shifts=(5.0, 300.0), moments=1))
    system = reduce_boom(flat_boom(friction=0.2), [law], options, comm).system
    if comm.rank != 0:
        return np.empty(0), system
    motion = integrate(Motion(system, 10.0, output_step=1.0e-2), step=2.0e-5)
    return np.asarray(motion.data["tip"].values), system


def _told(done: subprocess.CompletedProcess[str]) -> dict[str, Any]:
    assert done.returncode == 0, done.stderr
    told: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return told


def test_two_ranks_give_the_serial_frequencies(
    two_ranks: TwoRanks, box_shell: Callable[..., SegmentShell]
) -> None:
    """Reference: the serial run, to 1e-8. The first is the free slide along x."""
    answer = _told(two_ranks(_FREQUENCIES))
    assert answer["ranks"] == 2
    found = np.array(answer["frequencies"])
    serial = natural_frequencies(box_shell(0.25, supports=HELD), 12)
    assert np.abs([found[0], serial[0]]) == pytest.approx([0.0, 0.0], abs=1.0e-3)
    assert found[1:] == pytest.approx(serial[1:], rel=1.0e-8)


def test_two_ranks_give_the_serial_coordinates(two_ranks: TwoRanks) -> None:
    """Reference: the serial run, mode by mode and sign by sign. A basis that lets round-off
    grow differs by whole modes here, though its compliances do not.
    """
    answer = _told(two_ranks(_REDUCED))
    boom = boom_in_space(friction=0.2, sideways=0.3)
    options = ShellOptions(0.5)
    serial = reduce_boom(boom, [LAW], options, MPI.COMM_SELF, lateral_laws=[LATERAL_LAW]).system
    assert np.sqrt(answer["omega2"]) == pytest.approx(np.sqrt(serial.omega2), rel=1.0e-6)
    for name, part in (("rows", serial.rows), ("load", serial.load)):
        found = np.array(answer[name])
        assert np.abs(found - part).max() < 1.0e-5 * np.abs(part).max()


def test_ranks_give_the_serial_motion(on_ranks: OnRanks, tmp_path: Path) -> None:
    """Reference: one rank, to 1e-9 of the tip's range over ten seconds with friction.

    A relative change of 1e-15 in the coordinates grows to 1e-4 of the range in this motion, so they
    have to agree to the last bit, and do.
    """
    found = {}
    for ranks in (1, 2, 4):
        file = tmp_path / f"{ranks}.npz"
        assert _told(on_ranks(ranks, _MOVED, str(file)))["ranks"] == ranks
        found[ranks] = np.load(file)
    serial = found[1]
    assert np.ptp(serial["tip"]) > 0.1
    for ranks in (2, 4):
        assert np.abs(found[ranks]["tip"] - serial["tip"]).max() < 1.0e-9 * np.ptp(serial["tip"])
        for name in ("omega2", "rows", "load"):
            assert np.array_equal(found[ranks][name], serial[name])


def test_what_fails_on_one_rank_fails_on_all(two_ranks: TwoRanks) -> None:
    answer = _told(two_ranks(_FAILED))
    assert answer["told"] == ["the second rank cannot"] * 2
