# SPDX-License-Identifier: LGPL-3.0-or-later
"""Two ranks give what one gives."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable

import numpy as np
import pytest

from shell_model.eigenmodes import natural_frequencies
from shell_model.segment_shell import SegmentShell

_ON_EACH_RANK = """
import json
from mpi4py import MPI
from shell_model.eigenmodes import natural_frequencies
from tests.shell_model.conftest import box_shell
comm = MPI.COMM_WORLD
found = natural_frequencies(box_shell(0.25, supports=(0.0, 2.0)), 12)
if comm.rank == 0:
    print(json.dumps({"ranks": comm.size, "frequencies": found.tolist()}))
"""


def test_two_ranks_give_the_serial_frequencies(
    two_ranks: Callable[..., subprocess.CompletedProcess[str]],
    box_shell: Callable[..., SegmentShell],
) -> None:
    """Reference: the serial run, to 1e-8."""
    done = two_ranks(_ON_EACH_RANK)
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout.strip().splitlines()[-1])
    assert answer["ranks"] == 2
    serial = natural_frequencies(box_shell(0.25, supports=(0.0, 2.0)), 12)
    assert np.array(answer["frequencies"]) == pytest.approx(serial, rel=1.0e-8)
