# SPDX-License-Identifier: LGPL-3.0-or-later
"""A shell from the cache is the one that was computed."""

import os
from dataclasses import replace
from pathlib import Path
from time import sleep

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.dynamics.excitation import Ramp
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.load_tables import LoadTable
from protractile.runs.case.schema import Case
from protractile.runs.case.sections import SectionTable
from protractile.runs.folder.cache import Cache, load_or_compute
from protractile.runs.pipeline.models import build
from protractile.runs.process.terminal import shorten
from protractile.shell_model.reduced_shell import ReducedShell, reduce_boom
from tests.runs.case_texts import shipped

pytestmark = pytest.mark.slow

SIZES = "height", "width", "flange", "web"


@pytest.fixture
def case() -> Case:
    return case_file.select(shipped("coarse"), "", ["shell"], 1.0)


def reduce(case: Case, cache: Cache | None) -> ReducedShell:
    tools = BuildContext(MPI.COMM_SELF, cache=cache)
    return build(case, build_boom(case), case.models[0], tools).shell


def entries(cache: Cache) -> list[Path]:
    return list(cache.folder.glob("*.record"))


def test_a_second_run_skips_mesh_and_reduction_of_the_same_mesh(case: Case, tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache")
    first = reduce(case, cache)
    second = reduce(case, cache)
    assert {*first.seconds} == {"mesh", "assembly", "rows", "reduction", "fields", "mesh error"}
    assert list(second.seconds) == ["cache"]
    for name in ("omega2", "load", "rows", "friction_rows"):
        assert np.array_equal(getattr(first.system, name), getattr(second.system, name))
    assert first.system.laws == second.system.laws
    assert first.errors == second.errors
    assert first.fields.identical(second.fields)
    for made, kept in zip(first.meshes, second.meshes, strict=True):
        assert made.plates == kept.plates
        for name in ("points", "triangles", "walls", "thickness"):
            assert np.array_equal(getattr(made, name), getattr(kept, name))
    assert "reduction" in reduce(case_file.select(case, "", None, 0.6), cache).seconds
    assert len(entries(cache)) == 2


def varied(case: Case, play: float, times: float, ramp: float) -> Case:
    """Return the case with another play, multiplied loads, and a gust that rises in ``ramp`` s."""
    gust = LoadTable(segment="inner", x="head", magnitude=-50.0 * times, ramp=ramp)
    joints = tuple(replace(joint, play=play) for joint in case.joints)
    sections = [segment.section for segment in build_boom(case).segments]
    segments = tuple(
        segment.model_copy(
            update={
                "load": times * segment.load,
                "height_to_width": None,
                "section": section
                and SectionTable(**{name: getattr(section, name) for name in SIZES}),
            }
        )
        for segment, section in zip(case.segments, sections, strict=True)
    )
    return case.model_copy(update={"joints": joints, "segments": segments, "loads": (gust,)})


def test_another_play_and_load_are_the_same_entry(case: Case, tmp_path: Path) -> None:
    """Reference: other code path, the boom reduced with its own play and loads."""
    cache = Cache(tmp_path / "cache")
    reduce(varied(case, 0.014, 1.0, 0.5), cache)
    other = varied(case, 0.004, -3.0, 0.1)
    found = reduce(other, cache).system
    assert len(entries(cache)) == 1
    boom, (model,) = build_boom(other), other.models
    contacts = model.model_boom(boom)
    own = reduce_boom(contacts.boom, model.options(), MPI.COMM_SELF).system
    assert found.laws == own.laws
    assert [x.history for x in found.excitations] == [Ramp(0.1)]
    for mine, theirs in (
        (found.load, own.load),
        (found.excitations[0].load, own.excitations[0].load),
    ):
        moved = found.rows / (found.omega2 + 1.0e4) @ mine
        expected = own.rows / (own.omega2 + 1.0e4) @ theirs
        assert np.abs(moved - expected).max() < 1e-9 * np.abs(expected).max()


def test_of_two_at_a_time_one_reduces(case: Case, tmp_path: Path) -> None:
    """Reference: by construction. Another process has the lock, and stores the shell meanwhile."""
    cache = Cache(tmp_path / "cache")
    shell = reduce(case, None)
    other = os.fork()
    if other == 0:
        try:
            load_or_compute(cache, ("the same",), MPI.COMM_SELF, lambda: sleep(0.5) or shell)
        finally:
            os._exit(0)
    while not (cache.folder / ".lock").exists():
        sleep(0.01)
    sleep(0.1)
    found = load_or_compute(
        cache, ("the same",), MPI.COMM_SELF, lambda: pytest.fail("reduced again")
    )
    os.waitpid(other, 0)
    assert np.array_equal(found.system.omega2, shell.system.omega2)
    assert len(entries(cache)) == 1


def test_unwritable_cache_gives_one_line(
    case: Case, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = tmp_path / "cache"
    folder.write_text("a file where the folder should be")
    found = reduce(case, Cache(folder))
    assert found.system.num_modes > 0
    assert [record.getMessage() for record in caplog.records] == [
        f"{shorten(str(folder))}: the cache cannot be written (Not a directory), and results "
        "are not kept for later runs; give another folder in PROTRACTILE_CACHE, or "
        "--no-cache"
    ]
