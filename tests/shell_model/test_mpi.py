# SPDX-License-Identifier: LGPL-3.0-or-later
"""Two ranks give what one gives."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable

import numpy as np
import pytest
from mpi4py import MPI

from shell_model.boom_shell import ShellOptions, reduce_boom
from shell_model.eigenmodes import natural_frequencies
from shell_model.segment_shell import SegmentShell
from tests.shell_model.booms import HELD, LATERAL_LAW, LAW, boom_in_space

TwoRanks = Callable[..., subprocess.CompletedProcess[str]]

_FREQUENCIES = """
import json
from mpi4py import MPI
from shell_model.eigenmodes import natural_frequencies
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
from shell_model.boom_shell import ShellOptions, reduce_boom
from tests.shell_model.booms import LATERAL_LAW, LAW, boom_in_space
comm = MPI.COMM_WORLD
boom = boom_in_space(friction=0.2, sideways=0.3)
system = reduce_boom(boom, [LAW], ShellOptions(0.5), comm, lateral_laws=[LATERAL_LAW]).system
if comm.rank == 0:
    parts = {"omega2": system.omega2, "rows": system.rows, "load": system.load}
    print(json.dumps({name: part.tolist() for name, part in parts.items()}))
"""


def _answer(done: subprocess.CompletedProcess[str]) -> dict[str, list[float]]:
    assert done.returncode == 0, done.stderr
    answer: dict[str, list[float]] = json.loads(done.stdout.strip().splitlines()[-1])
    return answer


def test_two_ranks_give_the_serial_frequencies(
    two_ranks: TwoRanks, box_shell: Callable[..., SegmentShell]
) -> None:
    """Reference: the serial run, to 1e-8. The first is the free slide along x."""
    answer = _answer(two_ranks(_FREQUENCIES))
    assert answer["ranks"] == 2
    found = np.array(answer["frequencies"])
    serial = natural_frequencies(box_shell(0.25, supports=HELD), 12)
    assert np.abs([found[0], serial[0]]) == pytest.approx([0.0, 0.0], abs=1.0e-3)
    assert found[1:] == pytest.approx(serial[1:], rel=1.0e-8)


def test_two_ranks_give_the_serial_coordinates(two_ranks: TwoRanks) -> None:
    """Reference: the serial run, mode by mode and sign by sign. A basis that lets round-off
    grow differs by whole modes here, though its compliances do not.
    """
    answer = _answer(two_ranks(_REDUCED))
    boom = boom_in_space(friction=0.2, sideways=0.3)
    options = ShellOptions(0.5)
    serial = reduce_boom(boom, [LAW], options, MPI.COMM_SELF, lateral_laws=[LATERAL_LAW]).system
    assert np.sqrt(answer["omega2"]) == pytest.approx(np.sqrt(serial.omega2), rel=1.0e-6)
    for name, part in (("rows", serial.rows), ("load", serial.load)):
        found = np.array(answer[name])
        assert np.abs(found - part).max() < 1.0e-5 * np.abs(part).max()
