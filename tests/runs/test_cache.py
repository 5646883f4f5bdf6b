# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the cache keeps, and that it keeps it whole."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from geometry.boom import Boom
from runs.cache import Cache, default_folder, key, sources

pytestmark = pytest.mark.quick


def fill(cache: Cache, name: str, text: str) -> None:
    with cache.fill(name) as folder:
        (folder / "text").write_text(text)


def test_an_entry_is_found_again(tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache")
    assert cache.find("a") is None
    fill(cache, "a", "first")
    entry = cache.find("a")
    assert entry is not None
    assert (entry / "text").read_text() == "first"
    cache.drop("a")
    assert cache.find("a") is None


def test_an_interrupted_entry_leaves_nothing(tmp_path: Path) -> None:
    cache = Cache(tmp_path)

    def interrupted() -> None:
        with cache.fill("a") as folder:
            (folder / "text").write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []


def test_of_two_that_fill_the_same_entry_the_first_stays(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    with cache.fill("a") as slow:
        (slow / "text").write_text("second")
        fill(cache, "a", "first")
    entry = cache.find("a")
    assert entry is not None
    assert (entry / "text").read_text() == "first"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_the_least_recently_used_goes(tmp_path: Path) -> None:
    cache = Cache(tmp_path, room=250)
    for name, used in (("a", 10.0), ("b", 20.0)):
        fill(cache, name, 100 * "x")
        os.utime(tmp_path / name, (used, used))
    assert cache.find("a") is not None  # uses it
    fill(cache, "c", 100 * "x")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "c"]


def test_one_entry_may_be_larger_than_the_room(tmp_path: Path) -> None:
    cache = Cache(tmp_path, room=10)
    fill(cache, "a", 100 * "x")
    assert cache.find("a") is not None


def test_every_number_counts_to_its_last_bit(paper_boom: Boom) -> None:
    """Equal content has one key; a change of one unit in the last place has another."""
    segment = paper_boom.segments[0]
    same = replace(paper_boom, segments=(replace(segment), paper_boom.segments[1]))
    other = replace(segment, load=float(np.nextafter(segment.load, 0.0)))
    changed = replace(paper_boom, segments=(other, paper_boom.segments[1]))
    assert key(paper_boom, 0.1) == key(same, 0.1)
    assert len({key(paper_boom, 0.1), key(changed, 0.1), key(paper_boom, 0.2)}) == 3
    assert key(np.arange(3.0)) != key(np.arange(3)) != key(np.arange(3).reshape(3, 1))
    with pytest.raises(TypeError, match="function has no content to tell it by"):
        key(fill)


def test_sources_count(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("x = 1\n")
    before = sources(tmp_path)
    (tmp_path / "a.txt").write_text("no source")
    assert sources(tmp_path) == before
    (tmp_path / "a.py").write_text("x = 2\n")
    assert sources(tmp_path) != before


def test_where_it_lies(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "/caches")
    monkeypatch.delenv("PROTRACTILE_CACHE", raising=False)
    assert default_folder() == Path("/caches/protractile")
    monkeypatch.setenv("PROTRACTILE_CACHE", str(tmp_path))
    assert default_folder() == tmp_path
