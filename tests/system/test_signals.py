# SPDX-License-Identifier: LGPL-3.0-or-later
"""End of commands by Ctrl-C and SIGTERM, with one line and without remaining files."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.system.run_folder import COARSE, ROOT
from tests.torture.kills import listens

pytestmark = pytest.mark.slow


RUN = "run", COARSE, "--models", "kantorovich-4,timoshenko", "--no-cache"
SWEEP = "sweep", COARSE, "--models", "timoshenko", "--vary", "joint.play=0.006:0.014:8"

# A second signal comes while the first one is being obeyed.
AGAIN = """
import signal, time
from protractile.runs.process import ending

def clean():
    signal.raise_signal(signal.SIGTERM)
    print("clean", flush=True)

ending.listen()
with ending.when_interrupted(clean):
    signal.raise_signal(signal.SIGINT)
    time.sleep(60.0)
"""


def start(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    """Start Python in a process group of its own, like a terminal."""
    return subprocess.Popen(
        [sys.executable, *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # What runs in the background ignores Ctrl-C, and so would what it starts.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def check_interrupted(process: subprocess.Popen[str], number: signal.Signals) -> None:
    """Check the end of a command by a signal, with one line after those of its progress."""
    out, err = process.communicate(timeout=60)
    assert (out, err.splitlines()[-1]) == ("", "protractile: interrupted")
    assert err.count("protractile: ") == 1
    assert process.returncode == 128 + number


def command(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    return start(folder, "-m", "protractile", *arguments, "--out", "out")


def works(folder: Path) -> Callable[[subprocess.Popen[str]], bool]:
    """Return whether a folder is being written."""
    return lambda process: bool(list(folder.glob(".out.*")))


def has_a_point(folder: Path) -> Callable[[subprocess.Popen[str]], bool]:
    return lambda process: bool(list(folder.glob("out/points/*.record")))


def wait_until(happens: Callable[[subprocess.Popen[str]], bool], it: subprocess.Popen[str]) -> None:
    while not happens(it):
        assert it.poll() is None
        time.sleep(0.005)


@pytest.mark.parametrize(
    ("stage", "number"),
    [("importing", signal.SIGINT), ("importing", signal.SIGTERM), ("working", signal.SIGINT)],
)
def test_a_run_ends_in_one_line(tmp_path: Path, number: signal.Signals, stage: str) -> None:
    process = command(tmp_path, *RUN)
    wait_until(listens if stage == "importing" else works(tmp_path), process)
    os.killpg(process.pid, number)
    check_interrupted(process, number)
    assert list(tmp_path.iterdir()) == []


# The command, which prints every stage.
TELLING = """
from protractile.__main__ import main
from protractile.runs.process import terminal

if __name__ == "__main__":
    terminal.EVERY = 0.0
    main()
"""


def tells(stage: str) -> Callable[[subprocess.Popen[str]], bool]:
    """Return whether the next line of progress is of a stage."""
    return lambda process: stage in (process.stderr.readline() if process.stderr else "")


def test_sigterm_ends_a_run_after_meshing(tmp_path: Path) -> None:
    """Reference: by construction. gmsh resets the handler of SIGTERM."""
    shell = "run", COARSE, "--models", "shell", "--no-cache", "--no-pictures"
    process = start(tmp_path, "-c", TELLING, *shell, "--out", "out")
    wait_until(tells("shell (1 of 1): reduction"), process)
    process.terminate()
    check_interrupted(process, signal.SIGTERM)
    assert list(tmp_path.iterdir()) == []


def test_a_sweep_ends_with_its_processes(tmp_path: Path) -> None:
    """Finished points remain. The output ends with the last process that can write to it."""
    process = command(tmp_path, *SWEEP)
    wait_until(has_a_point(tmp_path), process)
    os.killpg(process.pid, signal.SIGINT)
    check_interrupted(process, signal.SIGINT)
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["points"]


def test_second_interrupt_ends_at_once() -> None:
    process = start(ROOT, "-c", AGAIN)
    assert process.communicate(timeout=30) == ("clean\n", "protractile: interrupted\n")
    assert process.returncode == 128 + signal.SIGINT


WORKERS = """
import time
from protractile.runs.process import ending
from protractile.runs.process.workers import workers

ending.listen()
with workers(2) as pool:
    pool.submit(print, "works", flush=True).result()
    pool.submit(time.sleep, 60.0).result()
"""


def test_processes_end_with_their_parent() -> None:
    """Reference: by construction. The output ends with the last process that can write to it."""
    process = start(ROOT, "-c", WORKERS)
    assert process.stdout.readline() == "works\n"
    process.terminate()
    assert process.communicate(timeout=30) == ("", "protractile: interrupted\n")
    assert process.returncode == 128 + signal.SIGTERM
