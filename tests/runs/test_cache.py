# SPDX-License-Identifier: LGPL-3.0-or-later
"""The cache and its records."""

import os
import pickle
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt
import pytest
import xarray as xr

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.gap_system import Observer
from protractile.geometry.boom import Boom
from protractile.runs.folder.cache import Cache, key, read_record, write_record
from protractile.runs.process.terminal import shorten
from tests.system.run_folder import python

# The file of the entry "a".
ENTRY = "a.record"


def test_the_cache_keeps_what_was_used_last(tmp_path: Path) -> None:
    """Reference: by construction. Entries are found as they were stored; the oldest use goes."""
    cache = Cache(tmp_path / "cache")
    assert cache.load("a", dict) is None
    for number in (1.0, 2.0):
        thing = {"array": np.full(2, number)}
        cache.try_to_store("a", thing)
        thing["array"][0] = 0.0
        for _ in range(2):
            assert cache.load("a", dict).pop("array").tolist() == [number, number]
    assert cache.load("b", dict) is None
    assert [path.name for path in cache.folder.iterdir()] == [ENTRY]
    (cache.folder / "mine").write_text(200 * "x", encoding="utf-8")
    for name, used in (("a", 10.0), ("b", 20.0)):
        cache.store(name, 100 * "x")
        os.utime(cache.folder / f"{name}.record", (used, used))
    assert cache.load("a", str) is not None  # uses it
    cache.store("c", 100 * "x")
    for room, left in ((350, [ENTRY, "c.record", "mine"]), (10, ["c.record", "mine"])):
        cache.make_room(room)
        assert sorted(path.name for path in cache.folder.iterdir()) == left


def test_cache_removes_files_of_a_killed_process(tmp_path: Path) -> None:
    program = (
        "import os; from pathlib import Path; from protractile.runs.folder.cache import Cache; "
        f"os.replace = lambda *_: os._exit(9); Cache(Path({str(tmp_path)!r})).store('a', 'first')"
    )
    assert python("-c", program).returncode == 9
    (left,) = tmp_path.iterdir()
    Cache(tmp_path).store("a", "second")
    assert Cache(tmp_path).load("a", str) == "second"
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
    # So are an entry of another type, a longer one, and one of another key.
    cache.store("b", "another")
    for spoil in (
        lambda: cache.store("a", ["no text"]),
        lambda: entry.write_bytes(whole + b"more"),
        lambda: (tmp_path / "b.record").rename(entry),
    ):
        spoil()
        assert cache.load("a", str) is None
        assert not entry.exists()


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir])
def test_pipes_and_folders_are_no_entries(tmp_path: Path, make: Callable[[Path], object]) -> None:
    """Reference: by construction. Opening a pipe to write would wait for a reader for ever."""
    names = {ENTRY, ".lock", "foreign.record"}
    for name in names:
        make(tmp_path / name)
    os.utime(tmp_path / "foreign.record", (1.0, 1.0))
    cache = Cache(tmp_path)
    assert cache.load("a", str) is None
    with cache.entry_lock("a" * 64):
        cache.store("b", "first")
    assert cache.load("b", str) == "first"
    cache.make_room(0)
    assert names <= {path.name for path in tmp_path.iterdir()}


def test_every_number_counts_to_its_last_bit(paper_boom: Boom) -> None:
    segment = paper_boom.segments[0]
    same = replace(paper_boom, segments=(replace(segment), paper_boom.segments[1]))
    other = replace(segment, load=float(np.nextafter(segment.load, 0.0)))
    changed = replace(paper_boom, segments=(other, paper_boom.segments[1]))
    assert key(paper_boom, 0.1) == key(same, 0.1)
    assert len({key(paper_boom, 0.1), key(changed, 0.1), key(paper_boom, 0.2)}) == 3
    assert key(np.arange(3.0)) != key(np.arange(3)) != key(np.arange(3).reshape(3, 1))


def test_where_it_lies(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Reference: the XDG base directories; in a container the user has a number but no name."""
    monkeypatch.setenv("XDG_CACHE_HOME", "/caches")
    monkeypatch.delenv("PROTRACTILE_CACHE", raising=False)
    assert Cache.of_user() == Cache(Path("/caches/protractile"))
    monkeypatch.setenv("PROTRACTILE_CACHE", str(tmp_path))
    assert Cache.of_user() == Cache(tmp_path)
    for name in ("PROTRACTILE_CACHE", "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("os.getuid", lambda: 2**31 - 7)
    assert Cache.of_user() is None
    line = "there is no home folder, and results are not kept for later runs; give a folder in "
    assert caplog.messages == [f"{line}PROTRACTILE_CACHE, or --no-cache"]


def test_threads_wait_for_an_entry_in_progress(tmp_path: Path) -> None:
    """Reference: by hand. An entry with another key does not wait and does not release them."""
    cache, order = Cache(tmp_path), list[str]()

    def second() -> None:
        with cache.entry_lock(key("one")):
            order.append("second")

    with ThreadPoolExecutor(1) as pool:
        with cache.entry_lock(key("one")):
            waiting = pool.submit(second)
            with cache.entry_lock(key("other")):
                pass
            assert wait([waiting], timeout=0.3).not_done
            order.append("first")
        waiting.result()
    assert order == ["first", "second"]


Kind = TypeVar("Kind")


def again(thing: Any, kind: type[Kind]) -> Kind:
    file = BytesIO()
    write_record(thing, file)
    file.seek(0)
    return read_record(file, kind)


@pytest.mark.parametrize(
    "array",
    [
        np.array([0.1, -0.0, np.nan, np.inf, 5e-324]), np.arange(6, dtype=np.float32).reshape(2, 3),
        np.asfortranarray(np.arange(6.0).reshape(2, 3)), np.arange(24.0).reshape(2, 3, 4)[:, ::2],
        np.zeros((0, 3)), np.array(1.5), np.array(["bottom", "Größe"]), np.array([True, False]),
    ],
)  # fmt: skip
def test_an_array_comes_back_with_its_order_in_memory(array: npt.NDArray[Any]) -> None:
    """Another order would change the round-off of sums."""
    found = again(array, np.ndarray)
    assert (found.dtype, found.shape) == (array.dtype, array.shape)
    assert found.tobytes() == array.tobytes()
    assert found.flags.writeable
    if array.size and array.flags.contiguous:
        assert found.strides == array.strides


def test_data_come_back(paper_boom: Boom, paper_law: PowerContact) -> None:
    thing = {
        "numbers": (1, 0.1, -0.0, float("inf"), 10**30, True, None),
        "texts": ["µ", "\n", ""],
        (1, "key"): {},
        "boom": paper_boom,
        "laws": [paper_law, paper_law.one_sided(1)],
    }
    found = again(thing, dict)
    assert found == thing
    assert str(found) == str(thing)
    with pytest.raises(ValueError, match="the record is no Boom"):
        again(paper_law, Boom)
    data = xr.Dataset(
        {"tip": (("model", "time"), np.arange(6.0).reshape(2, 3), {"units": "m"})},
        coords={"model": ["a", "bc"], "kind": ("model", ["beam", "shell"])},
        attrs={"step": 1.0e-3, "steps": 3},
    ).assign(time=("time", np.arange(3.0), {"units": "s"}))
    found, observer = again((data, Observer(np.ones(2), "rad")), tuple)
    assert found.identical(data)
    assert list(found.variables) == list(data.variables) == ["tip", "model", "kind", "time"]
    assert bytes(found.to_netcdf(engine="scipy")) == bytes(data.to_netcdf(engine="scipy"))
    assert isinstance(observer, Observer)
    assert observer.unit == "rad"


@pytest.mark.parametrize("thing", [Path("a"), np.array([None]), len, {1}])
def test_objects_other_than_data_are_not_stored(thing: object) -> None:
    with pytest.raises(TypeError, match="cannot be kept: it is no data"):
        write_record(thing, BytesIO())


LAWS = PowerContact.__module__


@pytest.mark.parametrize(
    "text",
    [
        '{"record": ["os", "system"], "parts": {"command": "false"}}',
        '{"record": ["pathlib", "Path"], "parts": {}}',
        '{"record": ["protractile.runs.folder.cache", "Path"], "parts": {}}',
        '{"record": ["protractile.runs.folder.cache", "json"], "parts": {}}',
        f'{{"record": ["{LAWS}", "PowerContact"], "parts": {{"stiffness": -1.0}}}}',
        f'{{"record": ["{LAWS}", "restitution_damping"], "parts": {{}}}}', '{"array": [3]}',
        '{"unknown": []}', "not JSON", "5",
    ],
)  # fmt: skip
def test_bad_records_are_refused(text: str) -> None:
    with pytest.raises((ValueError, TypeError)):
        read_record(BytesIO(f"{text}\n".encode()), PowerContact)


@pytest.mark.parametrize("record", [b"", b'{"array": [1]}\n'])
def test_a_pickle_is_not_run(record: bytes) -> None:
    class Harm:
        def __reduce__(self) -> tuple[Any, ...]:
            return pytest.fail, ("a pickle was run",)

    array = BytesIO()
    np.save(array, np.array([Harm()]), allow_pickle=True)
    with pytest.raises(ValueError, match=r"codec can't decode|Object arrays cannot be loaded"):
        read_record(
            BytesIO(record + (array.getvalue() if record else pickle.dumps(Harm()))), np.ndarray
        )
