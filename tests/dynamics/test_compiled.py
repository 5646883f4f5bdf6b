# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compilation of the time loops, its announcement, and equal bits of compiled and cached loops."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.kernels import march
from protractile.dynamics.motion import Motion
from protractile.runs.pipeline.models import MotionPlan
from tests import rubbing
from tests.modal import oscillator

ROOT = Path(__file__).parents[2]
PROGRAM = """
from numba import config
import protractile.dynamics.kernels.modal_flow
print(config.CACHE_DIR)
"""
PLACE = """
from protractile.dynamics.kernels.march import march
print(march.stats.cache_path)
"""


def test_installations_with_equal_sources_share_their_loops(tmp_path: Path) -> None:
    """Reference: by construction; the last installation differs in a formula that loops inline."""
    folders = []
    for number in range(3):
        place = tmp_path / str(number) / "protractile"
        shutil.copytree(ROOT / "dynamics", place / "dynamics")
        (place / "__init__.py").touch()
        if number == 2:
            with (place / "dynamics" / "contact.py").open("a", encoding="utf-8") as source:
                source.write("# another formula\n")
        environment = {"NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(place.parent)}
        answer = subprocess.run(
            [sys.executable, "-c", PLACE],
            cwd=tmp_path,
            env=os.environ | environment,
            capture_output=True,
            check=True,
            text=True,
        )
        folders.append(Path(answer.stdout.strip()))
    assert folders[0] == folders[1] != folders[2]
    assert {folder.parent for folder in folders} == {tmp_path}


def test_a_read_only_home_and_installation(tmp_path: Path) -> None:
    """A file in place of a folder prevents writing, also for root."""
    shutil.copytree(
        ROOT / "dynamics",
        tmp_path / "protractile" / "dynamics",
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    (tmp_path / "protractile" / "__init__.py").touch()
    for package in (tmp_path / "protractile").glob("**/__init__.py"):
        (package.parent / "__pycache__").touch()
    (tmp_path / "tmp").mkdir()
    (tmp_path / "home").touch()
    answer = subprocess.run(
        [sys.executable, "-B", "-c", PROGRAM],
        cwd=tmp_path,
        env={name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
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


def _rubbing(environment: dict[str, str]) -> str:
    """Return the motion with friction as printed by a separate process."""
    program = [sys.executable, "-m", "tests.rubbing"]
    return subprocess.run(
        program, cwd=ROOT, env=os.environ | environment, capture_output=True, check=True, text=True
    ).stdout


@pytest.mark.slow
def test_compiled_and_cached_loops_give_equal_bits(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Reference: the same motion in a process with cached loops.

    Where a worker could have compiled the loops, and has not, they were compared when they were
    compiled: their folder bears the hash of their sources.
    """
    of_worker = rubbing.compiled_in(tmp_path_factory)
    of_workers = "PYTEST_XDIST_WORKER" in os.environ
    environment = {} if of_workers else {"NUMBA_CACHE_DIR": str(tmp_path)}
    if of_worker.exists():
        one = of_worker.read_text("utf-8")
    else:
        one = rubbing.motion_numbers() if of_workers else _rubbing(environment)
    assert len(one) > 1000
    assert one == _rubbing(environment)


def test_only_the_first_compilation_is_announced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Reference: by construction, numba's folder of the real loop without and with its file."""
    plan = MotionPlan(Motion(oscillator(), 1.0, 0.1), FixedStep(0.1), None)
    plan.integrator(plan.motion)
    (compiled, *_) = Path(march.march.stats.cache_path).glob("march.march-*.nbc")
    loop = SimpleNamespace(signatures=[], stats=SimpleNamespace(cache_path=str(tmp_path)))
    monkeypatch.setattr("protractile.dynamics.kernels.march.march", loop)
    plan.warm()
    assert caplog.messages == [
        f"compiling the time loop (half a minute), for later runs too, into {tmp_path}"
    ]
    (tmp_path / compiled.name).touch()
    plan.warm()
    assert len(caplog.messages) == 1
