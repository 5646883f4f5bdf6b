# SPDX-License-Identifier: LGPL-3.0-or-later
"""The benchmark compares like with like and leaves whole tables; no time is asserted."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dynamics.integrators.event_driven import TOLERANCE, integrate_events
from rich.console import Console

from dynamics.motion import Motion
from runs.case import reading as case_file
from runs.report import figures
from runs.studies.cost.bench import (
    COMPILED,
    LEVELS,
    NUMPY,
    PAPER,
    Sizes,
    bench,
    five_terms,
    pressed_system,
)
from runs.studies.cost.generic_solvers import (
    SOLVERS,
    array_rates,
    compiled_rates,
    generic,
    matched,
    residual_of,
)

SIZES = Sizes(
    duration=0.2,
    slow_duration=0.15,
    levels=[(1e-3, ("LSODA", "odeint")), (1e-5, SOLVERS)],
    most=2,
    modes=(5, 7),
    rows=(2, 3),
    updates=200,
    members=3,
    shell_members=0,
    left=("series",),
    drawn=("kantorovich-5",),
)


LEVEL_NAMES = ("residual-1e-03", "residual-1e-05")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the smallest benchmark, whose runs leave one figure."""
    out = tmp_path_factory.mktemp("bench") / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(figures, "FIGURES", figures.FIGURES[-1:])
        bench(SIZES, out, Console(quiet=True))
    return out


@pytest.fixture(scope="module")
def data(folder: Path) -> Any:
    return json.loads((folder / "bench.json").read_text(encoding="utf-8"))


@pytest.mark.slow
def test_generic_solvers_leave_no_more_energy_than_ours(data: Any) -> None:
    """Reference: the event-driven run of the same table over the same time, kind: other code; and
    not so much less that the generic solvers did a hundred times the work.
    """
    for (_, solvers), level in zip(SIZES.levels, LEVEL_NAMES, strict=True):
        ours = {
            entry["motion s"]: entry["energy residual"]
            for entry in data[level]
            if entry["solver"] == "event-driven"
        }
        others = [entry for entry in data[level] if entry["right-hand side"]]
        pairs = {(entry["solver"], entry["right-hand side"]) for entry in others}
        assert pairs == {(name, kind) for name in solvers for kind in (NUMPY, COMPILED)}
        for entry in others:
            assert entry["motion s"] == (0.15 if entry["solver"] == "Radau" else 0.2)
            target = ours[entry["motion s"]]
            assert 0.01 * target < entry["energy residual"] <= target


@pytest.mark.slow
def test_the_levels_of_the_command() -> None:
    """Tighter and tighter, down to what event-driven motion leaves as it comes; every solver."""
    tolerances = [tolerance for tolerance, _ in LEVELS]
    assert tolerances == sorted(tolerances, reverse=True)
    assert tolerances[-1] == TOLERANCE
    assert {name for _, names in LEVELS for name in names} == set(SOLVERS)


@pytest.mark.slow
def test_a_solver_that_leaves_more_is_named() -> None:
    """Reference: analytic in kind, no double-precision run keeps the energy to 1e-20."""
    system = five_terms(case_file.load(str(PAPER)))
    tolerance, least = matched("odeint", system, compiled_rates(system), 0.05, 1e-20)
    assert tolerance is None
    assert 1e-17 < least < 1e-8


@pytest.mark.slow
def test_every_table_is_complete(folder: Path, data: Any) -> None:
    for level in LEVEL_NAMES:
        for entry in data[level]:
            assert len(entry["wall s"]) == len(entry["over event-driven"]) == 2
            assert min(entry["wall s"]) > 0.0
    assert [list(cost) for cost in data["steps"]] == [["modes", "2 rows", "3 rows"]] * 2
    assert [cost["modes"] for cost in data["steps"]] == [5, 7]
    assert [cost["what"] for cost in data["leaving"]] == ["without snapshots", "with snapshots"]
    assert min(cost["processor s"] for cost in data["leaving"]) > 0.0
    assert [cost["resisted by"] for cost in data["drawing"]] == ["nothing", "friction", "dashpots"]
    for cost in data["drawing"]:
        assert cost["times"] == pytest.approx(cost["drawn out s"] / cost["at rest s"])
    assert {entry["ensemble"] for entry in data["ensembles"]} == {
        "3 five-term series, event-driven",
        "3 five-term series, splitting",
    }
    text = (folder / "bench.md").read_text(encoding="utf-8")
    assert text.count("\n## ") == 6
    for how in ("as one writes it in NumPy", "compiled by numba"):
        assert text.count(f"With the same right-hand side {how}, the best of solve_ivp is ") == 2
    assert text.count("odeint, whose loop is in Fortran: ") == 4
    for name in ("event-driven", "splitting", *SOLVERS):
        assert f"\n| {name} |" in text
    assert sorted(path.name for path in folder.iterdir()) == ["bench.json", "bench.md"]


@pytest.mark.slow
def test_the_rates_are_those_of_the_series() -> None:
    """Reference: the event-driven motion at a second, kind: other code. By then the boom has
    touched; 1e-5 of the tip's range is far below what a wrong force would do.
    """
    system = five_terms(case_file.load(str(PAPER)))
    ours = integrate_events(Motion(system, 0.2))
    for rates in (compiled_rates(system), array_rates(system)):
        states = generic("DOP853", rates, 10, 0.2, 1e-11)
        tip = states[:, :5] @ system.observers["tip"].row
        np.testing.assert_allclose(tip, ours.data["tip"].values, atol=1e-5 * np.ptp(tip), rtol=0.0)
    assert 0.05 < ours.first_contact < 0.19


def test_a_lost_energy_is_seen() -> None:
    """Reference: half of every velocity is three quarters of the kinetic energy, analytic."""
    system = five_terms(case_file.load(str(PAPER)))
    states = generic("DOP853", compiled_rates(system), 10, 0.05, 1e-11)
    assert residual_of(system, states) < 1e-8
    slowed = np.hstack([states[:, :5], 0.5 * states[:, 5:]])
    assert residual_of(system, slowed) > 0.5


def test_all_rows_of_the_made_up_system_press() -> None:
    """Reference: no clearance, so only an exact zero is open; analytic."""
    system = pressed_system(7, 3)
    assert system.num_modes == 7
    assert np.flatnonzero(system.omega2 == 0.0).tolist() == [0, 1]
    assert all(law.clearance == 0.0 and law.below == law.stiffness for law in system.laws)
