# SPDX-License-Identifier: LGPL-3.0-or-later
"""End of commands by Ctrl-C and SIGTERM, with one line and without remaining files."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from http.client import HTTPConnection
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from tests.system.run_folder import COARSE, ROOT
from tests.torture.kills import listens

pytestmark = pytest.mark.slow


RUN = "run", COARSE, "--models", "kantorovich-4,timoshenko", "--no-cache"
SWEEP = "sweep", COARSE, "--models", "kantorovich-4", "--vary", "joint.play=0.006:0.014:40"

# A second signal comes while the first one is being obeyed.
AGAIN = """
import signal, sys, time
from protractile.runs.process import ending

def clean():
    signal.raise_signal(signal.SIGTERM)
    print("clean", flush=True)
    print("late", file=sys.stderr, flush=True)

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
        env=os.environ | {"PYTHONPATH": str(ROOT), "TMPDIR": str(folder)},
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


def wait_for(process: subprocess.Popen[str], happens: Callable[[], object]) -> None:
    while not happens():
        assert process.poll() is None
        time.sleep(0.005)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_run_ends_in_one_line(tmp_path: Path, number: signal.Signals) -> None:
    """One while it imports, the other while it works."""
    process = command(tmp_path, *RUN)
    importing = number == signal.SIGTERM
    wait_for(process, lambda: listens(process) if importing else [*tmp_path.glob(".out.*")])
    os.killpg(process.pid, number)
    check_interrupted(process, number)
    assert list(tmp_path.iterdir()) == []


# The command, which prints every stage.
TELLING = """
from protractile.__main__ import main
from protractile.runs.process import terminal

terminal.EVERY = 0.0
main()
"""


def test_sigterm_ends_a_run_after_meshing(tmp_path: Path) -> None:
    """Reference: by construction. gmsh resets the handler of SIGTERM. MPI leaves no folder."""
    shell = "run", COARSE, "--models", "shell", "--mesh-size", "1", "--no-cache"
    process = start(tmp_path, "-c", TELLING, *shell, "--no-pictures", "--out", "out")
    wait_for(process, lambda: "shell (1 of 1): reduction" in process.stderr.readline())
    process.terminate()
    check_interrupted(process, signal.SIGTERM)
    assert list(tmp_path.iterdir()) == []


def test_a_sweep_ends_with_its_processes(tmp_path: Path) -> None:
    """Finished points remain. The output ends with the last process that can write to it."""
    process, points = command(tmp_path, *SWEEP), tmp_path / "out" / "points"
    wait_for(process, lambda: [*points.glob("*.record")])
    os.killpg(process.pid, signal.SIGINT)
    check_interrupted(process, signal.SIGINT)
    assert {*tmp_path.glob("*"), *tmp_path.glob("*/*")} == {points, points.parent}


def test_second_interrupt_ends_at_once_and_nothing_follows_its_line() -> None:
    """Reference: by construction. Another thread reports while the processes are ended."""
    process = start(ROOT, "-c", AGAIN)
    assert process.communicate(timeout=30) == ("clean\n", "protractile: interrupted\n")
    assert process.returncode == 128 + signal.SIGINT


CANCELLED = """
import sys, time
from protractile.runs.process import ending
from protractile.runs.process.workers import workers

ending.listen()
try:
    with workers(1) as pool:
        pool.submit(print, "works", flush=True).result()
        tasks = [pool.submit(time.sleep, 60.0) for _ in range(5)]
        assert tasks[-1].cancel()
        if len(sys.argv) > 1:
            raise ValueError
        print("waits", flush=True)
        time.sleep(60.0)
except ValueError:
    pass
"""


def test_processes_end_with_their_parent_and_a_cancelled_task_is_no_error() -> None:
    """Reference: by construction. The output ends with the last process that can write to it."""
    process = start(ROOT, "-c", CANCELLED)
    assert [process.stdout.readline() for _ in range(2)] == ["works\n", "waits\n"]
    process.terminate()
    assert process.communicate(timeout=30) == ("", "protractile: interrupted\n")
    assert process.returncode == 128 + signal.SIGTERM
    failing = start(ROOT, "-c", CANCELLED, "error")
    assert failing.communicate(timeout=30) == ("works\n", "")


def test_a_killed_live_page_ends_its_run(tmp_path: Path) -> None:
    """Reference: by construction. The run of a shell ends, and MPI leaves no folder."""
    process = start(tmp_path, "-m", "protractile", "live", COARSE, "--no-browser")
    page = urlsplit(process.stdout.readline().strip())
    connection = HTTPConnection(page.netloc, timeout=60)
    request = json.dumps({"values": {}, "large": True})
    connection.request("POST", f"{page.path}shell", request)
    answer = connection.getresponse()
    while not list(tmp_path.glob("protractile-live-*/.out.*")):
        assert "progress" in json.loads(answer.readline())
    threads = Path(f"/proc/{process.pid}/task").glob("*/children")
    children = [Path("/proc") / pid for one in threads for pid in one.read_text().split()]
    assert children
    process.kill()
    process.communicate()
    deadline = time.monotonic() + 30.0
    while any(child.exists() for child in children):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert [path.name for path in tmp_path.glob("ompi.*")] == []
