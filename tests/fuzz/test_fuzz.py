# SPDX-License-Identifier: LGPL-3.0-or-later
"""A sample of ``make fuzz``, and detection of breaches."""

import pytest

from tests.fuzz.contract import Ending
from tests.system.run_folder import python


@pytest.mark.slow
def test_a_sample_keeps_the_contract() -> None:
    """In a process of its own, which may fork."""
    answer = python("-m", "tests.fuzz", "10")
    assert (answer.returncode, answer.stderr) == (0, ""), answer.stdout
    assert answer.stdout.endswith("10 of 10 keep the contract\n")


@pytest.mark.parametrize(
    ("status", "err", "breach"),
    [
        (0, b"", ""),
        (2, b"protractile: a: b: c\n", ""),
        (0, b"report: pictures and figures took 5 s\nshell (1 of 2): motion 6 %, 12 s left\n", ""),
        (2, b"", "0 lines with exit status 2: b''"),
        (0, b"warning\n", "1 lines with exit status 0: b'warning\\n'"),
        (3, b"protractile: a\nb\n", "2 lines with exit status 3: b'protractile: a\\nb\\n'"),
        (2, b"a: b\n", "a line that is not protractile's: 'a: b'"),
        (2, b"protractile: \x1b[31m\n", "a line that cannot be read: 'protractile: \\x1b[31m'"),
        (70, b"Traceback", "exit status 70: b'Traceback'"),
        (-24, b"", "exit status -24: b''"),
    ],
)
def test_a_breach_is_reported(status: int, err: bytes, breach: str) -> None:
    assert Ending(status, err, 1.0, 1e9).breach() == breach
    assert Ending(status, err, 1.0, 5e9).breach()
