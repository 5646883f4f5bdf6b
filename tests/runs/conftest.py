# SPDX-License-Identifier: LGPL-3.0-or-later
"""Planned sweeps without runs, and saved figures."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from matplotlib.figure import Figure as Sheet

from protractile.runs.sweep.points import Plan, plan
from tests.runs.sweeping import COARSE, FAST, Planned


@pytest.fixture
def planned(here: Path) -> Planned:
    """Return a function that plans a sweep of the coarse case until after its first contact."""
    text = COARSE.read_text(encoding="utf-8").replace("duration = 0.6", "duration = 0.2")
    Path("case.toml").write_text(text, encoding="utf-8")

    def sweep_of(*texts: str, models: Sequence[str] | None = None) -> Plan:
        return plan("case.toml", texts, models or FAST, None)

    return sweep_of


@pytest.fixture
def sheets(monkeypatch: pytest.MonkeyPatch) -> list[Sheet]:
    """Return the matplotlib figures of the saved files."""
    saved: list[Sheet] = []
    save = Sheet.savefig

    def keep(sheet: Sheet, path: Path) -> None:
        saved.append(sheet)
        save(sheet, path)

    monkeypatch.setattr(Sheet, "savefig", keep)
    return saved
