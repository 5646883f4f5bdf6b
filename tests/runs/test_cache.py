# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the cache keeps, and that it keeps it whole."""

import os
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import replace
from pathlib import Path
from threading import Event

import numpy as np
import pytest

from geometry.boom import Boom
from runs.folder.cache import Cache, key
from runs.process.terminal import shorten

ROOT = Path(__file__).parents[2]
# The file of the entry "a".
ENTRY = "a.record"


def test_an_entry_is_found_again(tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache")
    assert cache.load("a", dict) is None
    thing = {"array": np.arange(3.0)}
    cache.try_to_store("a", thing)
    thing["array"][0] = 1.0
    for _ in range(2):
        found = cache.load("a", dict)
        assert found is not None
        assert found.pop("array").tolist() == [0.0, 1.0, 2.0]
    assert cache.load("b", dict) is None


def test_an_interrupted_entry_leaves_nothing(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    with pytest.raises(TypeError):
        cache.store("a", [np.zeros(3), print])
    assert list(tmp_path.iterdir()) == []


def test_unsupported_type_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(NotADirectoryError) as caught:
        Cache(tmp_path / "file").store("a", "text")
    assert caught.value.filename == str(tmp_path / "file" / ENTRY)


def test_an_entry_is_kept_again(tmp_path: Path) -> None:
    cache = Cache(tmp_path)
    for text in ("first", "second"):
        cache.store("a", text)
        assert cache.load("a", str) == text
    assert [path.name for path in tmp_path.iterdir()] == [ENTRY]


def test_cache_evicts_the_least_recently_used_entry(tmp_path: Path) -> None:
    """Other files and the newest entry are kept, whatever their size."""
    cache = Cache(tmp_path)
    (tmp_path / "mine").write_text(200 * "x", encoding="utf-8")
    for name, used in (("a", 10.0), ("b", 20.0)):
        cache.store(name, 100 * "x")
        os.utime(tmp_path / f"{name}.record", (used, used))
    assert cache.load("a", str) is not None  # uses it
    cache.store("c", 100 * "x")
    cache.make_room(350)
    assert sorted(path.name for path in tmp_path.iterdir()) == [ENTRY, "c.record", "mine"]
    cache.make_room(10)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c.record", "mine"]


def test_cache_removes_files_of_a_killed_process(tmp_path: Path) -> None:
    program = (
        "import os; from pathlib import Path; from runs.folder.cache import Cache; "
        f"os.replace = lambda *_: os._exit(9); Cache(Path({str(tmp_path)!r})).store('a', 'first')"
    )
    killed = subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=False)
    assert killed.returncode == 9
    (left,) = tmp_path.iterdir()
    cache = Cache(tmp_path)
    assert cache.load("a", str) is None
    cache.store("a", "second")
    assert cache.load("a", str) == "second"
    assert not left.exists()


def test_every_flipped_bit_is_found(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    cache, entry = Cache(tmp_path), tmp_path / ENTRY
    cache.store("a", np.array(1.5))
    whole = entry.read_bytes()
    bits = range(8 * len(whole))
    for bit in bits:
        flipped = bytearray(whole)
        flipped[bit // 8] ^= 1 << bit % 8
        entry.write_bytes(flipped)
        assert cache.load("a", np.ndarray) is None
        assert list(tmp_path.iterdir()) == []
    message = f"{shorten(str(entry))}: is damaged; it is removed and computed again"
    assert [record.getMessage() for record in caplog.records] == [message for _ in bits]


def longer(entry: Path) -> None:
    with entry.open("a") as file:
        file.write("more")


def of_another_entry(entry: Path) -> None:
    Cache(entry.parent).store("b", "another")
    (entry.parent / "b.record").replace(entry)


@pytest.mark.parametrize(
    "become",
    [
        longer,
        of_another_entry,
        lambda entry: entry.write_text(""),
        lambda entry: os.truncate(entry, entry.stat().st_size - 1),
        lambda entry: Cache(entry.parent).store("a", ["no text"]),
    ],
)
def test_foreign_entry_is_removed(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, become: Callable[[Path], object]
) -> None:
    cache = Cache(tmp_path)
    cache.store("a", "first")
    become(tmp_path / ENTRY)
    assert cache.load("a", str) is None
    assert len(caplog.records) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir])
def test_cache_ignores_pipes_and_folders(tmp_path: Path, make: Callable[[Path], object]) -> None:
    """Opening a pipe would block until a process writes to it."""
    make(tmp_path / ENTRY)
    assert Cache(tmp_path).load("a", str) is None


def test_every_number_counts_to_its_last_bit(paper_boom: Boom) -> None:
    """Equal content has one key; a change of one unit in the last place has another."""
    segment = paper_boom.segments[0]
    same = replace(paper_boom, segments=(replace(segment), paper_boom.segments[1]))
    other = replace(segment, load=float(np.nextafter(segment.load, 0.0)))
    changed = replace(paper_boom, segments=(other, paper_boom.segments[1]))
    assert key(paper_boom, 0.1) == key(same, 0.1)
    assert len({key(paper_boom, 0.1), key(changed, 0.1), key(paper_boom, 0.2)}) == 3
    assert key(np.arange(3.0)) != key(np.arange(3)) != key(np.arange(3).reshape(3, 1))
    with pytest.raises(TypeError, match="builtin_function_or_method cannot be kept: it is no data"):
        key(print)


def test_where_it_lies(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "/caches")
    monkeypatch.delenv("PROTRACTILE_CACHE", raising=False)
    assert Cache.of_user() == Cache(Path("/caches/protractile"))
    monkeypatch.setenv("PROTRACTILE_CACHE", str(tmp_path))
    assert Cache.of_user() == Cache(tmp_path)


def test_no_cache_without_a_home_folder(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """As in a container whose user has a number alone."""
    for name in ("PROTRACTILE_CACHE", "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("os.getuid", lambda: 2**31 - 7)
    assert Cache.of_user() is None
    assert caplog.messages == [
        "there is no home folder, and results are not kept for later runs; give a folder "
        "in PROTRACTILE_CACHE, or --no-cache"
    ]


def test_threads_wait_for_an_entry_in_progress(tmp_path: Path) -> None:
    """Reference: by hand. Another entry, made meanwhile, neither waits nor lets them in."""
    cache, order = Cache(tmp_path), list[str]()
    held = Event()

    def second() -> None:
        held.wait()
        with cache.entry_lock(key("one")):
            order.append("second")

    with ThreadPoolExecutor(1) as pool:
        waiting = pool.submit(second)
        with cache.entry_lock(key("one")):
            held.set()
            with cache.entry_lock(key("other")):
                pass
            assert wait([waiting], timeout=0.3).not_done
            order.append("first")
        waiting.result()
    assert order == ["first", "second"]
