# SPDX-License-Identifier: LGPL-3.0-or-later
"""Timing of runs, and the benchmark of solvers."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.typography import repeated
from protractile.runs.case import reading as case_file
from studies.cost import other_programs, timing
from studies.cost.bench import (
    PAPER,
    Sizes,
    bench,
    five_terms,
)
from studies.cost.generic_solvers import (
    SOLVERS,
    array_rates,
    compiled_rates,
    generic,
)
from studies.cost.timing import MEASURABLE, time_in_turns
from tests.other_codes import INSTALLED


class Clock:
    """Clock that advances only during sleep, independent of the load of the machine."""

    def __init__(self) -> None:
        self.now = 0.0

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(timing, "perf_counter", lambda: made.now)
    return made


def test_runs_take_turns(clock: Clock) -> None:
    order: list[str] = []

    def slow(name: str) -> None:
        order.append(name)
        clock.sleep(1.1 * MEASURABLE)

    seconds = time_in_turns([partial(slow, "a"), partial(slow, "b")], 2, 10.0)
    assert order == ["a", "b", "a", "b"]
    assert [len(taken) for taken in seconds] == [2, 2]


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ((0.0151, 0.0156, 0.0165), "0.0156"), ((1.0, 1.24, 1.6), "1.2"),
        ((120.0, 134.0, 150.0), "130"), ((1.0, 4.0, 9.0), "~4"), ((0.2, 4.0, 90.0), "~4"),
        ((123.4,), "100"), ((1.0, 1.0), "1"), ((0.0, 0.0), "0"),
    ],
)  # fmt: skip
def test_digits_follow_the_noise(values: tuple[float, ...], text: str) -> None:
    """Reference: by hand. The last digit is the first digit of half the range."""
    assert repeated(values) == text


SIZES = Sizes(
    duration=0.2,
    models=("kantorovich-5",),
    regular=0.7,
    steps=(1e-3, 5e-4),
    converged=1e-5,
    early=0.2,
    levels=[(1e-3, ("LSODA", "odeint")), (1e-4, SOLVERS)],
    most=2,
    members=3,
    shell_members=0,
    telescoping=("kantorovich-5",),
    problems=(),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the smallest benchmark."""
    out = tmp_path_factory.mktemp("bench") / "out"
    bench(SIZES, out, Console(quiet=True))
    return out


@pytest.fixture(scope="module")
def data(folder: Path) -> Any:
    return json.loads((folder / "bench.json").read_text(encoding="utf-8"))


@pytest.mark.slow
def test_generic_solvers_err_no_more_than_the_time_step(data: Any) -> None:
    """Reference: other code, the time step at its level; at most a hundred times as accurate."""
    entries = iter(data["solvers"])
    for step, solvers in SIZES.levels:
        ours = next(entries)
        assert (ours["solver"], ours["tolerance"]) == ("time step", f"{step:g} s")
        target = ours["tip off (of range)"]
        for solver in solvers:
            entry = next(entries)
            assert entry["solver"] == solver
            assert 0.01 * target < entry["tip off (of range)"] <= target
            assert len(entry["wall s"]) == len(entry["over the time step"]) == 2
            assert min(entry["wall s"]) > 0.0


@pytest.mark.slow
def test_every_table_is_complete(folder: Path, data: Any) -> None:
    """Half the step has a smaller error; with friction the energy balance closes for all."""
    coarse, fine, chosen = data["errors"]
    assert [one["steps"] for one in (coarse, fine)] == [700, 1400]
    assert 0.0 < fine["tip off (% of range)"] < coarse["tip off (% of range)"] < 1.0
    assert chosen["tip off (% of range)"] < 0.1
    assert max(one["energy residual"] for one in data["errors"]) < 1e-11
    assert [cost["resisted by"] for cost in data["drawing"]] == ["nothing", "friction", "dashpots"]
    for cost in data["drawing"]:
        assert cost["times"] == pytest.approx(cost["drawn out s"] / cost["at rest s"])
    assert {entry["ensemble"] for entry in data["ensembles"]} == {
        "3 five-term series",
        "3 five-term series, to a tolerance",
    }
    text = (folder / "bench.md").read_text(encoding="utf-8")
    assert text.count("\n## ") == 5
    for name in ("time step", *SOLVERS):
        assert f"\n| {name} |" in text
    assert sorted(path.name for path in folder.iterdir()) == ["bench.json", "bench.md"]


@pytest.mark.slow
@INSTALLED
def test_exudyn_moves_telescoped_beams_alike() -> None:
    """Reference: other code, with an error of 0.4 % of the range at this step."""
    problem = replace(other_programs.telescoped_beams(), steps=[5.0e-5])
    ((_, off, _),) = problem.elsewhere()
    assert 1.0e-4 < off < 0.01


@pytest.mark.slow
def test_the_rates_are_those_of_the_series() -> None:
    """Reference: other code, the time step, to 1e-5 of the tip's range."""
    system = five_terms(case_file.load(str(PAPER)))
    ours = FixedStep(2e-6)(Motion(system, 0.2))
    for rates in (compiled_rates(system), array_rates(system)):
        states = generic("DOP853", rates, 10, 0.2, 1e-11)
        tip = states[:, :5] @ system.observers["tip"].row
        np.testing.assert_allclose(tip, ours.data["tip"].values, atol=1e-5 * np.ptp(tip), rtol=0.0)
    assert 0.05 < ours.first_contact < 0.19
