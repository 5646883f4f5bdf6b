# SPDX-License-Identifier: LGPL-3.0-or-later
"""The benchmark compares like with like and leaves whole tables; no time is asserted."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from dynamics.event_driven import integrate_events
from runs import case as case_file
from runs.bench import PAPER, Sizes, bench, by_turns, five_terms, pressed_system, shown
from runs.generic_solvers import SOLVERS, array_rates, compiled_rates, generic, residual_of

SIZES = Sizes(
    duration=0.2,
    repetitions=2,
    modes=(5, 7),
    rows=(2, 3),
    updates=200,
    members=3,
    shell_members=0,
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the smallest benchmark."""
    out = tmp_path_factory.mktemp("bench") / "out"
    bench(SIZES, out, Console(quiet=True))
    return out


@pytest.fixture(scope="module")
def data(folder: Path) -> Any:
    return json.loads((folder / "bench.json").read_text(encoding="utf-8"))


def test_generic_solvers_leave_no_more_energy_than_ours(data: Any) -> None:
    """Reference: the event-driven run of the same table, kind: other code; and not so much less
    that the generic solvers did a hundred times the work.
    """
    ours, *others = data["comparison"]["methods"]
    assert ours["method"] == "event-driven"
    generic_ones = [entry for entry in others if entry["method"] != "splitting"]
    assert {entry["method"].split(",")[0] for entry in generic_ones} == set(SOLVERS)
    for entry in generic_ones:
        assert 0.01 * ours["energy_residual"] < entry["energy_residual"]
        assert entry["energy_residual"] <= ours["energy_residual"]


def test_every_table_is_complete(folder: Path, data: Any) -> None:
    for entry in data["comparison"]["methods"]:
        assert len(entry["seconds"]) == len(entry["ratios"]) == 2
        assert min(entry["seconds"]) > 0.0
    costs = data["steps"]["costs"]
    assert [(c["modes"], c["rows"]) for c in costs] == [(5, 2), (5, 3), (7, 2), (7, 3)]
    ensembles = data["ensembles"]["ensembles"]
    assert {entry["ensemble"] for entry in ensembles} == {
        "3 five-term series, event-driven",
        "3 five-term series, splitting",
    }
    text = (folder / "bench.md").read_text(encoding="utf-8")
    assert text.count("\n## ") == 3
    for name in ("event-driven", "splitting", *SOLVERS):
        assert f"\n| {name} |" in text
    assert sorted(path.name for path in folder.iterdir()) == ["bench.json", "bench.md"]


def test_the_rates_are_those_of_the_series() -> None:
    """Reference: the event-driven motion at a second, kind: other code. By then the boom has
    touched; 1e-5 of the tip's range is far below what a wrong force would do.
    """
    system = five_terms(case_file.load(str(PAPER)))
    ours = integrate_events(system, 0.2, phase=0.02)
    for rates in (compiled_rates(system), array_rates(system)):
        states = generic("DOP853", rates, 10, 0.2, 1e-11, 1e-12)
        tip = states[:, :5] @ system.observers["tip"].row
        np.testing.assert_allclose(tip, ours.data["tip"].values, atol=1e-5 * np.ptp(tip), rtol=0.0)
    assert 0.05 < ours.first_contact < 0.19


@pytest.mark.quick
def test_a_lost_energy_is_seen() -> None:
    """Reference: half of every velocity is three quarters of the kinetic energy, analytic."""
    system = five_terms(case_file.load(str(PAPER)))
    states = generic("DOP853", compiled_rates(system), 10, 0.05, 1e-11, 1e-12)
    assert residual_of(system, states) < 1e-8
    slowed = np.hstack([states[:, :5], 0.5 * states[:, 5:]])
    assert residual_of(system, slowed) > 0.5


@pytest.mark.quick
def test_all_rows_of_the_made_up_system_press() -> None:
    """Reference: no clearance, so only an exact zero is open; analytic."""
    system = pressed_system(7, 3)
    assert system.num_modes == 7
    assert np.flatnonzero(system.omega2 == 0.0).tolist() == [0, 1]
    assert all(law.clearance == 0.0 and law.below == law.stiffness for law in system.laws)


@pytest.mark.quick
def test_runs_take_turns() -> None:
    order: list[str] = []
    seconds = by_turns([lambda: order.append("a"), lambda: order.append("b")], 2)
    assert order == ["a", "b", "a", "b"]
    assert [len(taken) for taken in seconds] == [2, 2]


@pytest.mark.quick
@pytest.mark.parametrize(
    ("values", "text"),
    [
        ((0.0151, 0.0156, 0.0165), "0.0156"),
        ((1.0, 1.24, 1.6), "1.2"),
        ((120.0, 134.0, 150.0), "130"),
        ((1.0, 4.0, 9.0), "~4"),
        ((0.2, 4.0, 90.0), "~4"),
        ((123.4,), "100"),
        ((1.0, 1.0), "1"),
        ((0.0, 0.0), "0"),
    ],
)
def test_digits_follow_the_noise(values: tuple[float, ...], text: str) -> None:
    """Reference: half the range by hand; its first digit is the last shown."""
    assert shown(values) == text
