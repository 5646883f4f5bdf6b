# SPDX-License-Identifier: LGPL-3.0-or-later
"""A record is what was written, to the last bit, and nothing else."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pytest
import xarray as xr

from dynamics.contact import PowerContact
from dynamics.gap_system import Observer
from geometry.boom import Boom
from runs.folder.records import pack, unpack


def joined(thing: Any) -> dict[str, memoryview]:
    """The files of a record as they are read from a disk."""
    return {name: memoryview(bytearray(b"".join(parts))) for name, parts in pack(thing).items()}


def test_a_boom_comes_back(paper_boom: Boom) -> None:
    assert unpack(joined(paper_boom), Boom) == paper_boom


@pytest.mark.parametrize(
    "array",
    [
        np.array([0.1, -0.0, np.nan, np.inf, 5e-324]),
        np.arange(6, dtype=np.float32).reshape(2, 3),
        np.asfortranarray(np.arange(6.0).reshape(2, 3)),
        np.arange(24.0).reshape(2, 3, 4)[:, ::2],
        np.zeros((0, 3)),
        np.array(1.5),
        np.array(["bottom", "Größe"]),
        np.array([True, False]),
        np.arange(3, dtype=">i4"),
        np.array([1j]),
    ],
)
def test_an_array_comes_back_with_its_order_in_memory(array: npt.NDArray[Any]) -> None:
    """Sums over another order would have other round-off."""
    again = unpack(joined(array), np.ndarray)
    assert (again.dtype, again.shape) == (array.dtype, array.shape)
    assert again.tobytes() == array.tobytes()
    assert again.flags.writeable
    if array.size and array.flags.contiguous:
        assert again.strides == array.strides


def test_numbers_texts_and_what_they_are_in(paper_law: PowerContact) -> None:
    thing = {
        "numbers": (1, 0.1, -0.0, float("inf"), 10**30, True, None),
        "texts": ["µ", "\n", ""],
        (1, "key"): {},
        "laws": [paper_law, paper_law.upper()],
    }
    again = unpack(joined(thing), dict)
    assert again == thing
    assert str(again) == str(thing)


def test_datasets_and_named_tuples() -> None:
    data = xr.Dataset(
        {"tip": (("model", "time"), np.arange(6.0).reshape(2, 3), {"units": "m"})},
        coords={"model": ["a", "bc"], "kind": ("model", ["beam", "shell"])},
        attrs={"step": 1.0e-3, "steps": 3},
    ).assign(time=("time", np.arange(3.0), {"units": "s"}))
    again, observer = unpack(joined((data, Observer(np.ones(2), "rad"))), tuple)
    assert again.identical(data)
    assert list(again.variables) == list(data.variables) == ["tip", "model", "kind", "time"]
    assert bytes(again.to_netcdf(engine="scipy")) == bytes(data.to_netcdf(engine="scipy"))
    assert isinstance(observer, Observer)
    assert observer.unit == "rad"


class Stranger(NamedTuple):
    path: Path


@pytest.mark.parametrize("thing", [Path("a"), np.array([None]), len, {1}, Stranger(Path("a"))])
def test_what_is_no_data_is_not_kept(thing: object) -> None:
    with pytest.raises(TypeError, match="cannot be kept: it is no data"):
        pack(thing)


@pytest.mark.parametrize(
    "text",
    [
        '{"record": ["os", "system"], "parts": {"command": "false"}}',
        '{"record": ["pathlib", "Path"], "parts": {}}',
        '{"record": ["runs.folder.records", "Path"], "parts": {}}',
        '{"record": ["runs.folder.cache", "json"], "parts": {}}',
        '{"record": ["tests.runs.test_records", "Stranger"], "parts": {"path": ""}}',
        '{"record": ["dynamics.contact", "PowerContact"], "parts": {"stiffness": -1.0}}',
        '{"record": ["dynamics.contact", "restitution_damping"], "parts": {}}',
        '{"array": ["|O", [1], 0, "C"]}',
        '{"array": ["<f8", [3], 0, "C"]}',
        '{"array": ["<f8", [-1], 0, "C"]}',
        '{"array": ["<f8", [1], -8, "C"]}',
        '{"unknown": []}',
        "not JSON",
        "5",
    ],
)
def test_what_is_no_record_is_refused(text: str) -> None:
    files = {
        "record.json": memoryview(text.encode()),
        "numbers.bin": memoryview(bytearray(16)),
    }
    with pytest.raises((ValueError, TypeError)):
        unpack(files, PowerContact)


def test_a_pickle_is_not_run() -> None:
    class Harm:
        def __reduce__(self) -> tuple[Any, ...]:
            return pytest.fail, ("a pickle was run",)

    files = {name: memoryview(pickle.dumps(Harm())) for name in joined(1)}
    with pytest.raises(ValueError, match="codec can't decode"):
        unpack(files, int)


def test_a_record_of_another_class_is_refused(paper_law: PowerContact) -> None:
    with pytest.raises(ValueError, match="the record is no Boom"):
        unpack(joined(paper_law), Boom)


def test_the_json_says_what_the_numbers_are() -> None:
    files = joined([np.arange(2.0), np.arange(2)])
    assert json.loads(bytes(files["record.json"])) == {
        "list": [{"array": ["<f8", [2], 0, "C"]}, {"array": ["<i8", [2], 64, "C"]}]
    }
    assert (
        bytes(files["numbers.bin"]) == np.arange(2.0).tobytes() + bytes(48) + np.arange(2).tobytes()
    )
