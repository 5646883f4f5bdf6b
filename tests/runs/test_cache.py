# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the cache keeps, and that it keeps it whole."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from shutil import rmtree
from typing import cast

import numpy as np
import pytest

from geometry.boom import Boom
from runs.folder.cache import Cache, key
from runs.process.shown import shown

TEXT = "text"
ROOT = Path(__file__).parents[2]


def keep(cache: Cache, name: str, text: str) -> None:
    cache.keep(name, {TEXT: [text.encode()]})


def load(cache: Cache, name: str) -> str | None:
    return cache.load(name, lambda files: bytes(files[TEXT]).decode())


def test_an_entry_is_found_again(tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache")
    assert load(cache, "a") is None
    keep(cache, "a", "first")
    assert load(cache, "a") == "first"
    assert load(cache, "b") is None


def test_an_interrupted_entry_leaves_nothing(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    with pytest.raises(TypeError):
        cache.keep("a", {"first": [b"whole"], "second": cast("list[bytes]", ["no bytes"])})
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_kept_is_told_by_its_name(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(NotADirectoryError) as caught:
        keep(Cache(tmp_path / "file"), "a", "text")
    assert caught.value.filename == str(tmp_path / "file" / "a")


def test_of_two_that_keep_the_same_the_first_stays(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    keep(cache, "a", "first")
    keep(cache, "a", "second")
    assert load(cache, "a") == "first"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_the_least_recently_used_goes(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    for name, used in (("a", 10.0), ("b", 20.0)):
        keep(cache, name, 100 * "x")
        os.utime(tmp_path / name, (used, used))
    assert load(cache, "a") is not None  # uses it
    keep(cache, "c", 100 * "x")
    cache.make_room(500)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "c"]


def test_what_a_killed_process_has_left_goes(tmp_path: Path) -> None:
    program = (
        "import os; from pathlib import Path; from runs.folder.cache import Cache; "
        "Path.rename = lambda *_: os._exit(9); "
        f"Cache(Path({str(tmp_path)!r})).keep('a', {{'text': [b'first']}})"
    )
    killed = subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=False)
    assert killed.returncode == 9
    (left,) = tmp_path.iterdir()
    cache = Cache(tmp_path)
    assert load(cache, "a") is None
    keep(cache, "a", "second")
    assert load(cache, "a") == "second"
    assert not left.exists()


def test_one_entry_may_be_larger_than_the_room(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    keep(cache, "a", 100 * "x")
    cache.make_room(10)
    assert load(cache, "a") is not None


@pytest.mark.parametrize("file", [TEXT, "SHA256SUMS"])
def test_every_flipped_bit_is_found(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, file: str
) -> None:
    cache = Cache(tmp_path)
    keep(cache, "a", "1.5")
    whole = (tmp_path / "a" / file).read_bytes()
    bits = range(8 * len(whole))
    for bit in bits:
        damaged = bytearray(whole)
        damaged[bit // 8] ^= 1 << bit % 8
        (tmp_path / "a" / file).write_bytes(damaged)
        assert load(cache, "a") is None
        assert list(tmp_path.iterdir()) == []
        keep(cache, "a", "1.5")
    message = (
        f"{shown(str(tmp_path / 'a'))}: is not as it was kept; it is dropped, and computed again"
    )
    assert [record.getMessage() for record in caplog.records] == [message for _ in bits]


def longer(entry: Path) -> None:
    with (entry / TEXT).open("a") as file:
        file.write("more")


def of_another_entry(entry: Path) -> None:
    cache = Cache(entry.parent)
    keep(cache, "b", "another")
    rmtree(entry)
    (entry.parent / "b").rename(entry)


def a_file(entry: Path) -> None:
    rmtree(entry)
    entry.write_text("file")


def no_text(entry: Path) -> None:
    rmtree(entry)
    Cache(entry.parent).keep(entry.name, {TEXT: [b"\xff"]})


@pytest.mark.parametrize(
    "become",
    [
        longer,
        of_another_entry,
        a_file,
        no_text,
        lambda entry: (entry / TEXT).unlink(),
        lambda entry: (entry / "more").touch(),
        lambda entry: os.mkfifo(entry / "pipe"),
        lambda entry: [path.unlink() for path in entry.iterdir()],
    ],
)
def test_what_was_not_kept_there_is_dropped(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, become: Callable[[Path], object]
) -> None:
    cache = Cache(tmp_path)
    keep(cache, "a", "first")
    become(tmp_path / "a")
    assert load(cache, "a") is None
    assert len(caplog.records) == 1
    assert list(tmp_path.iterdir()) == []
    keep(cache, "a", "second")
    assert load(cache, "a") == "second"


def test_every_number_counts_to_its_last_bit(paper_boom: Boom) -> None:
    """Equal content has one key; a change of one unit in the last place has another."""
    segment = paper_boom.segments[0]
    same = replace(paper_boom, segments=(replace(segment), paper_boom.segments[1]))
    other = replace(segment, load=float(np.nextafter(segment.load, 0.0)))
    changed = replace(paper_boom, segments=(other, paper_boom.segments[1]))
    assert key(paper_boom, 0.1) == key(same, 0.1)
    assert len({key(paper_boom, 0.1), key(changed, 0.1), key(paper_boom, 0.2)}) == 3
    assert key(np.arange(3.0)) != key(np.arange(3)) != key(np.arange(3).reshape(3, 1))
    with pytest.raises(TypeError, match="function cannot be kept: it is no data"):
        key(keep)


def test_where_it_lies(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "/caches")
    monkeypatch.delenv("PROTRACTILE_CACHE", raising=False)
    assert Cache.of_user() == Cache(Path("/caches/protractile"))
    monkeypatch.setenv("PROTRACTILE_CACHE", str(tmp_path))
    assert Cache.of_user() == Cache(tmp_path)


def test_who_has_no_home_has_no_cache(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """As in a container whose user has a number alone."""
    for name in ("PROTRACTILE_CACHE", "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("os.getuid", lambda: 2**31 - 7)
    assert Cache.of_user() is None
    assert caplog.messages == [
        "there is no home folder, and what is computed is not kept for later runs; give a folder "
        "in PROTRACTILE_CACHE, or --no-cache"
    ]
