# SPDX-License-Identifier: LGPL-3.0-or-later
"""Standard output that is closed, full, left early or of few letters costs no more than a line."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from runs import CASES

COARSE = CASES / "coarse.toml"
ROOT = Path(__file__).parents[2]


def check(redirection: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """``protractile check`` of the coarse case in a shell, its output redirected."""
    return in_a_shell(f"check {COARSE} {redirection}", **environment)


def in_a_shell(line: str, **environment: str) -> subprocess.CompletedProcess[str]:
    command = f"{sys.executable} -m protractile {line}"
    return subprocess.run(
        ["bash", "-o", "pipefail", "-c", command],
        cwd=ROOT,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_a_full_disk_is_one_line() -> None:
    answer = check(">/dev/full")
    assert (answer.returncode, answer.stderr) == (
        2,
        "protractile: output: file: cannot be used (No space left on device)\n",
    )


@pytest.mark.parametrize("redirection", [">&-", "2>&- >/dev/null", "| head -n 1", "| true"])
def test_whom_nobody_hears_ends_in_peace(redirection: str) -> None:
    answer = check(redirection)
    assert (answer.returncode, answer.stderr) == (0, "")


def test_who_leaves_in_the_middle_of_a_long_text_does_so_in_peace() -> None:
    answer = in_a_shell("schema | true")
    assert (answer.returncode, answer.stderr) == (0, "")


def test_letters_that_the_terminal_lacks_are_spelled_out() -> None:
    answer = check("", PYTHONIOENCODING="ascii")
    assert (answer.returncode, answer.stderr) == (0, "")
    assert "The paper's boom, coarse and short" in answer.stdout
    assert "J (m\\u2074)" in answer.stdout
