# SPDX-License-Identifier: LGPL-3.0-or-later
"""Planned sweeps without runs, and their figures."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.report.figure_context import Figure
from protractile.runs.sweep import output
from protractile.runs.sweep.points import Plan, plan
from tests.runs.summaries import COARSE, FAST, Planned


@pytest.fixture(scope="session")
def tools() -> BuildContext:
    """Return what shells are built with, on one rank."""
    pytest.importorskip("dolfinx", reason="shells need FEniCSx")
    from mpi4py import MPI

    return BuildContext(MPI.COMM_SELF)


@pytest.fixture
def planned(here: Path) -> Planned:
    """Return a function that plans a sweep of the coarse case until after its first contact."""
    text = COARSE.read_text(encoding="utf-8").replace("duration = 0.6", "duration = 0.2")
    Path("case.toml").write_text(text, encoding="utf-8")

    def sweep_of(*texts: str, models: Sequence[str] | None = None) -> Plan:
        return plan("case.toml", texts, models or FAST, None)

    return sweep_of


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """Return the figures of written sweeps."""
    found: list[Figure] = []
    write = output.write_pictures

    def keep(figures: list[Figure], folder: Path) -> None:
        found.extend(figures)
        write(figures, folder)

    monkeypatch.setattr(output, "write_pictures", keep)
    return found
