# SPDX-License-Identifier: LGPL-3.0-or-later
"""Time loops compile anywhere, and give the same bits whoever has compiled them."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAM = """
from numba import config
import dynamics.kernels.modal_flow
print(config.CACHE_DIR)
"""


def test_a_read_only_home_and_installation(tmp_path: Path) -> None:
    """A file where a folder should be stops root, too."""
    shutil.copytree(
        ROOT / "dynamics", tmp_path / "dynamics", ignore=shutil.ignore_patterns("__pycache__")
    )
    for package in (tmp_path / "dynamics").glob("**/__init__.py"):
        (package.parent / "__pycache__").touch()
    (tmp_path / "tmp").mkdir()
    (tmp_path / "home").touch()
    answer = subprocess.run(
        [sys.executable, "-B", "-c", PROGRAM],
        cwd=tmp_path,
        env=os.environ
        | {
            "HOME": str(tmp_path / "home"),
            "XDG_CACHE_HOME": str(tmp_path / "home"),
            "TMPDIR": str(tmp_path / "tmp"),
            "PYTHONPATH": str(tmp_path),
        },
        capture_output=True,
        text=True,
        check=False,
    )
    assert (answer.returncode, answer.stderr) == (0, "")
    assert Path(answer.stdout.strip()).parent == tmp_path / "tmp"
    assert list((tmp_path / "tmp").iterdir()) == []


RUBBING = """
import numpy as np
from dynamics.friction import DryFriction
from dynamics.gap_system import GapSystem, Observer
from dynamics.contact import PowerContact
from dynamics.motion import Motion
from dynamics.splitting import integrate

random = np.random.default_rng(3)
rows = random.normal(size=(2, 12))
system = GapSystem(
    omega2=np.linspace(0.0, 300.0, 12) ** 2,
    load=random.normal(size=12),
    rows=rows,
    laws=[PowerContact(1.0e6, 2.0, 1.0e-3)] * 2,
    station_of_row=np.array([0, 1]),
    stations=[0.0, 1.0],
    observers={"tip": Observer(rows[0])},
    friction_rows=random.normal(size=(2, 12)),
    frictions=[DryFriction(0.2, 0, 1.0), DryFriction(0.2, 1, 2.0)],
)
data = integrate(Motion(system, 0.5, 0.01), step=1.0e-4).data
print({name: values.values.tolist() for name, values in data.items()})
"""


@pytest.mark.slow
def test_who_compiles_gets_the_bits_of_those_who_do_not(tmp_path: Path) -> None:
    """Reference: the same program, which the second time finds all it compiled the first time."""
    program = [sys.executable, "-c", RUBBING]
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    one, other = (
        subprocess.run(program, cwd=ROOT, env=environment, capture_output=True, check=True).stdout
        for _ in range(2)
    )
    assert len(one) > 1000
    assert one == other
