# SPDX-License-Identifier: LGPL-3.0-or-later
"""The last line of a rank reaches the launcher before the launcher has its own to say."""

from __future__ import annotations

import io
import os
import time
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import pytest

from runs.process import ranks


def test_aborts_when_its_line_has_been_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """The reader comes late: whoever asks for the end at once asks before the line is read."""
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
            ranks.fail("protractile: no number is finite", 3, comm)
    os.close(reader)
    assert at_abort == [[b"protractile: no number is finite\n"]]


def test_aborts_at_once_where_nothing_is_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    codes: list[int] = []
    comm = SimpleNamespace(size=2, rank=0, Abort=codes.append)
    monkeypatch.setattr("sys.stderr", io.StringIO())
    with pytest.raises(AssertionError, match="MPI_Abort returned"):
        ranks.fail("protractile: no number is finite", 3, comm)
    assert codes == [3]
