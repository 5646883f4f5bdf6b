# SPDX-License-Identifier: LGPL-3.0-or-later
"""Output of commands on streams of every kind, and the end of all ranks."""

import io
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protractile.runs import CASES
from protractile.runs.process import ending, terminal
from protractile.runs.process.terminal import LONGEST, message, shorten

ROOT = Path(__file__).parents[2]


def in_a_shell(line: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a command line in a shell; ``check`` refers to the coarse case."""
    line = line.replace("check", f"check {CASES / 'coarse.toml'}")
    return subprocess.run(
        ["bash", "-o", "pipefail", "-c", f"{sys.executable} -m protractile {line}"],
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_full_disk_is_one_line() -> None:
    answer = in_a_shell("check >/dev/full")
    assert (answer.returncode, answer.stderr) == (
        2,
        "protractile: output: file: cannot be used (No space left on device)\n",
    )


@pytest.mark.parametrize("line", ["check >&-", "check 2>&- >/dev/null", "schema | true"])
def test_closed_output_pipe_ends_without_an_error(line: str) -> None:
    """The reader of the long schema closes the pipe early."""
    answer = in_a_shell(line)
    assert (answer.returncode, answer.stderr) == (0, "")


def test_missing_terminal_letters_are_replaced() -> None:
    answer = in_a_shell("check", PYTHONIOENCODING="ascii")
    assert (answer.returncode, answer.stderr) == (0, "")
    assert "The paper's boom, coarse and short" in answer.stdout
    assert "\\u2212" in answer.stdout


@given(st.text(st.characters(), max_size=2000))
def test_a_message_is_one_short_printable_line(text: str) -> None:
    line = message(text)
    assert line.startswith("protractile: ")
    assert line.isprintable()
    assert len(line) < LONGEST


def test_controls_are_escaped() -> None:
    assert shorten("a\x1b[31mb\u202ec\udcff é") == "a\\x1b[31mb\\u202ec\\udcff é"


def test_the_middle_goes_and_both_ends_stay() -> None:
    """Reference: analytic, the name of a file at the end of a long path."""
    assert (
        shorten("/" + "long/" * 100 + "case.toml", 41)
        == "/long/long/long/lo ... ong/long/case.toml"
    )
    assert shorten("a" * 41, 41) == "a" * 41


def test_progress_shows_stage_and_remaining_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: by hand. After 40 % in 12 s, 18 s remain; nothing is printed again within 5 s."""
    every = 5.0
    monkeypatch.setattr(terminal, "EVERY", every)
    said: list[str] = []
    times: list[float] = [0.0]
    lines = terminal.ProgressLines(["beam", "shell"], "lift", said.append, lambda: times[-1])
    for now, model, stage, part in (
        (0.0, "beam", "build", 0.0),
        (0.1, "beam", "build", 1.0),
        (0.2, "shell", "reduction", 0.0),
        (12.2, "shell", "reduction", 0.4),
        (12.2 + 0.9 * every, "shell", "reduction", 0.5),
        (30.2, "shell", "reduction", 1.0),
        (40.0, "shell", "motion", 0.0),
        (50.0, "shell", "fields", 1.0),
        (60.0, "report", "pictures", 0.0),
    ):
        times.append(now)
        lines(model, stage, part)
    assert said == [
        "lift: shell (2 of 2): reduction 40 %, 18 s left",
        "lift: shell (2 of 2): reduction took 30 s",
        "lift: shell (2 of 2): motion started",
        "lift: shell (2 of 2): fields finished",
        "lift: report: pictures started",
    ]


def test_ranks_abort_after_their_line_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """The reader is late, so that an immediate abort would precede the reading of the line."""
    reader, writer = os.pipe()
    read: list[bytes] = []
    at_abort: list[list[bytes]] = []

    def read_late() -> None:
        time.sleep(0.1)
        read.append(os.read(reader, 100))

    comm = SimpleNamespace(size=2, rank=0, Abort=lambda code: at_abort.append(list(read)))
    with os.fdopen(writer, "w") as stderr, ThreadPoolExecutor(1) as pool:
        monkeypatch.setattr("sys.stderr", stderr)
        pool.submit(read_late)
        with pytest.raises(AssertionError, match="MPI_Abort returned"):
            ending.fail("protractile: no number is finite", 3, comm)
    os.close(reader)
    assert at_abort == [[b"protractile: no number is finite\n"]]


def test_ranks_abort_at_once_without_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    codes: list[int] = []
    comm = SimpleNamespace(size=2, rank=0, Abort=codes.append)
    monkeypatch.setattr("sys.stderr", io.StringIO())
    with pytest.raises(AssertionError, match="MPI_Abort returned"):
        ending.fail("protractile: no number is finite", 3, comm)
    assert codes == [3]
