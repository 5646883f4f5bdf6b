# SPDX-License-Identifier: LGPL-3.0-or-later
"""A record is what was written, to the last bit, and nothing else."""

import pickle
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt
import pytest
import xarray as xr

from dynamics.contact import PowerContact
from dynamics.gap_system import Observer
from geometry.boom import Boom
from runs.folder.records import read, write

Kind = TypeVar("Kind")


def again(thing: Any, kind: type[Kind]) -> Kind:
    """Return a record after writing and reading."""
    file = BytesIO()
    write(thing, file)
    file.seek(0)
    return read(file, kind)


def test_a_boom_comes_back(paper_boom: Boom) -> None:
    assert again(paper_boom, Boom) == paper_boom


@pytest.mark.parametrize(
    "array",
    [
        np.array([0.1, -0.0, np.nan, np.inf, 5e-324]), np.arange(6, dtype=np.float32).reshape(2, 3),
        np.asfortranarray(np.arange(6.0).reshape(2, 3)), np.arange(24.0).reshape(2, 3, 4)[:, ::2],
        np.zeros((0, 3)), np.array(1.5), np.array(["bottom", "Größe"]), np.array([True, False]),
        np.arange(3, dtype=">i4"), np.array([1j]),
    ],
)  # fmt: skip
def test_an_array_comes_back_with_its_order_in_memory(array: npt.NDArray[Any]) -> None:
    """Sums over another order would have other round-off."""
    found = again(array, np.ndarray)
    assert (found.dtype, found.shape) == (array.dtype, array.shape)
    assert found.tobytes() == array.tobytes()
    assert found.flags.writeable
    if array.size and array.flags.contiguous:
        assert found.strides == array.strides


def test_numbers_texts_and_containers_round_trip(paper_law: PowerContact) -> None:
    thing = {
        "numbers": (1, 0.1, -0.0, float("inf"), 10**30, True, None),
        "texts": ["µ", "\n", ""],
        (1, "key"): {},
        "laws": [paper_law, paper_law.one_sided(1)],
    }
    found = again(thing, dict)
    assert found == thing
    assert str(found) == str(thing)


def test_datasets_and_named_tuples() -> None:
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


class Stranger(NamedTuple):
    path: Path


@pytest.mark.parametrize("thing", [Path("a"), np.array([None]), len, {1}, Stranger(Path("a"))])
def test_objects_other_than_data_are_not_stored(thing: object) -> None:
    with pytest.raises(TypeError, match="cannot be kept: it is no data"):
        write(thing, BytesIO())


@pytest.mark.parametrize(
    "text",
    [
        '{"record": ["os", "system"], "parts": {"command": "false"}}',
        '{"record": ["pathlib", "Path"], "parts": {}}',
        '{"record": ["runs.folder.records", "Path"], "parts": {}}',
        '{"record": ["runs.folder.cache", "json"], "parts": {}}',
        '{"record": ["tests.runs.test_records", "Stranger"], "parts": {"path": ""}}',
        '{"record": ["dynamics.contact", "PowerContact"], "parts": {"stiffness": -1.0}}',
        '{"record": ["dynamics.contact", "restitution_damping"], "parts": {}}', '{"array": [3]}',
        '{"unknown": []}', "not JSON", "5",
    ],
)  # fmt: skip
def test_bad_records_are_refused(text: str) -> None:
    with pytest.raises((ValueError, TypeError)):
        read(BytesIO(f"{text}\n".encode()), PowerContact)


@pytest.mark.parametrize("record", [b"", b'{"array": [1]}\n'])
def test_a_pickle_is_not_run(record: bytes) -> None:
    class Harm:
        def __reduce__(self) -> tuple[Any, ...]:
            return pytest.fail, ("a pickle was run",)

    array = BytesIO()
    np.save(array, np.array([Harm()]), allow_pickle=True)
    with pytest.raises(ValueError, match=r"codec can't decode|Object arrays cannot be loaded"):
        read(BytesIO(record + (array.getvalue() if record else pickle.dumps(Harm()))), np.ndarray)


def test_a_record_of_another_class_is_refused(paper_law: PowerContact) -> None:
    with pytest.raises(ValueError, match="the record is no Boom"):
        again(paper_law, Boom)
