# SPDX-License-Identifier: LGPL-3.0-or-later
"""A sample of the campaign."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.torture import kills

pytestmark = pytest.mark.slow


def test_a_killed_run_costs_nothing(tmp_path: Path) -> None:
    for name, tries, breaches, what in kills.killed(tmp_path, 1, kills.COMMANDS[:1]):
        assert (tries, breaches) == (1, 0), f"{name}: {what}"


def test_sigterm_to_a_cold_shell_run_leaves_nothing(tmp_path: Path) -> None:
    name, tries, breaches, what = kills.terminated(tmp_path, 3)
    assert (tries, breaches) == (3, 0), f"{name}: {what}"
