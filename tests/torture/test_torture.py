# SPDX-License-Identifier: LGPL-3.0-or-later
"""A sample of each campaign; tests/system/test_signals.py ends sweeps and runs of shells."""

from collections.abc import Callable, Iterable
from pathlib import Path

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from tests.torture import full_disk, kills, shared_cache
from tests.torture.shared_cache import Row

pytestmark = pytest.mark.slow

BEAM = "--models", "beam-fe-bonded"


@pytest.mark.parametrize(
    ("rows", "count"),
    [
        (lambda folder: full_disk.rows(folder, 2), 6),
        (lambda folder: kills.rows(folder, 1, {"run": kills.COMMANDS["run"]}), 1),
        (lambda folder: [shared_cache.together(folder, 1, BEAM, "aa")], 1),
    ],
    ids=["full disk", "killed", "one folder"],
)
def test_nothing_is_lost(tmp_path: Path, rows: Callable[[Path], Iterable[Row]], count: int) -> None:
    """Reference: what an undisturbed command leaves."""
    found = list(rows(tmp_path))
    assert len(found) == count
    for name, tries, breaches, what in found:
        assert tries > 0
        assert breaches == 0, f"{name}: {what}"
