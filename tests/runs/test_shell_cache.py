# SPDX-License-Identifier: LGPL-3.0-or-later
"""A shell from the cache is the one that was computed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from runs import case as case_file
from runs.build import build_boom
from runs.cache import Cache
from runs.schema import Case, ShellTable
from runs.systems import reduce_shell
from shell_model.boom_shell import ReducedShell
from tests.runs.coarse_case import CASES


@pytest.fixture
def case() -> Case:
    return case_file.select(case_file.load(str(CASES / "coarse.toml")), "", ["shell"], 0.5)


def reduce(case: Case, cache: Cache | None, folder: Path) -> ReducedShell:
    model = case.models[0]
    assert isinstance(model, ShellTable)
    boom = build_boom(case)
    return reduce_shell(case, boom, model, MPI.COMM_SELF, folder, lambda *_: None, cache)


def test_a_second_run_skips_mesh_and_reduction(case: Case, tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache")
    first = reduce(case, cache, tmp_path / "first")
    second = reduce(case, cache, tmp_path / "second")
    assert set(first.seconds) == {
        *("mesh", "assembly", "rows", "reduction", "fields", "mesh error")
    }
    assert list(second.seconds) == ["cache"]
    for name in ("omega2", "load", "rows", "friction_rows"):
        assert np.array_equal(getattr(first.system, name), getattr(second.system, name))
    assert first.system.laws == second.system.laws
    assert first.errors == second.errors
    assert first.fields is not None
    assert first.fields.identical(second.fields)
    files = [sorted((tmp_path / name).glob("*.msh")) for name in ("first", "second")]
    assert [path.name for path in files[1]] == ["inner.msh", "outer.msh"]
    assert [path.read_bytes() for path in files[0]] == [path.read_bytes() for path in files[1]]


def test_another_mesh_is_another_entry(case: Case, tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache")
    reduce(case, cache, tmp_path / "first")
    other = reduce(case_file.select(case, "", None, 0.6), cache, tmp_path / "second")
    assert "reduction" in other.seconds
    assert len(list(cache.folder.iterdir())) == 2


def test_a_damaged_entry_is_made_again(case: Case, tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache")
    whole = reduce(case, cache, tmp_path / "first")
    (entry,) = cache.folder.iterdir()
    file = entry / "shell.pickle"
    file.write_bytes(file.read_bytes()[:1000])
    again = reduce(case, cache, tmp_path / "second")
    assert "reduction" in again.seconds
    assert np.array_equal(again.system.omega2, whole.system.omega2)
    assert list(reduce(case, cache, tmp_path / "third").seconds) == ["cache"]


def test_a_cache_that_cannot_be_written_costs_nothing_but_time(case: Case, tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file where the folder should be")
    found = reduce(case, Cache(tmp_path / "cache"), tmp_path / "first")
    assert found.system.num_modes > 0
