# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows and curves of results: selections, extremes, files."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from protractile.analysis.curves import Curve, Curves, histories
from protractile.analysis.measure import Measured
from protractile.analysis.quantities import MEASURED
from protractile.analysis.rows import EXTENDED, MOTION, REST, Row, Rows, extremes
from protractile.runs.pipeline.results import read_netcdf

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
TEXTS = st.text(st.characters(exclude_categories=["C"]), max_size=12)
ROWS = st.builds(
    Row,
    model=TEXTS,
    state=st.sampled_from([REST, MOTION, "combination a, b"]),
    play=st.booleans(),
    quantity=st.sampled_from([*MEASURED]),
    part=TEXTS,
    place=TEXTS,
    value=NUMBERS,
    x=st.none() | NUMBERS,
    y=st.none() | NUMBERS,
    z=st.none() | NUMBERS,
    time=st.none() | NUMBERS,
    limit=st.none() | st.floats(1e-3, 1e12),
)


@given(st.lists(ROWS, max_size=5))
def test_a_file_keeps_every_row_to_the_bit(
    tmp_path_factory: pytest.TempPathFactory, rows: list[Row]
) -> None:
    """Reference: by construction."""
    path = tmp_path_factory.mktemp("rows") / "results.csv"
    Rows(rows).save(path)
    assert Rows.load(path) == tuple(rows)


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: "",
        lambda text: text[: len(text) // 2],
        lambda text: text[:-5],
        lambda text: text + "beam\n",
        lambda text: text.replace("tip", "other"),
        lambda text: text.replace("True", "perhaps"),
        lambda text: text.replace("-1.0", "one"),
        lambda text: text + 200_000 * "x",
    ],
)
def test_a_damaged_file_is_an_error(damage: Callable[[str], str], tmp_path: Path) -> None:
    path = tmp_path / "results.csv"
    Rows(Row(name, REST, True, "tip", "tip", "", -1.0) for name in "abc").save(path)
    path.write_text(damage(path.read_text("utf-8")), "utf-8")
    with pytest.raises((ValueError, KeyError)):
        Rows.load(path)


def test_the_table_has_units_and_utilisations() -> None:
    """Reference: by hand, 50 of 200 MPa."""
    row = Row("beam", MOTION, True, "stress", "fly", "", -50e6, 1.0, limit=200e6)
    frame = Rows([row]).frame
    assert frame.loc[0, ["unit", "value", "utilisation"]].tolist() == ["Pa", -50e6, 0.25]
    assert Rows().frame.empty


def test_a_selection_takes_one_value_or_several() -> None:
    rows = Rows(
        Row(model, state, True, "tip", "tip", "", value)
        for model, state, value in (("a", REST, 1.0), ("a", MOTION, -3.0), ("b", REST, 2.0))
    )
    assert [row.value for row in rows.where(model="a")] == [1.0, -3.0]
    assert [row.value for row in rows.where(state=[REST, MOTION])] == [1.0, -3.0, 2.0]
    assert rows.where(model="c") == ()
    assert (rows.largest, Rows().largest) == (rows[1], None)


def test_the_largest_utilisation_governs() -> None:
    """Reference: by hand. Without limits the largest magnitude governs."""
    rows = [
        Row("beam", MOTION, True, "stress", part, "", value, limit=limit)
        for part, value, limit in (("a", 90e6, 300e6), ("b", -80e6, 100e6), ("c", 95e6, None))
    ]
    assert Rows(rows).governing == rows[1]
    assert Rows(row._replace(limit=None) for row in rows).governing == rows[2]._replace(limit=None)


@pytest.mark.parametrize(
    ("values", "value", "time"),
    [
        ([[0.0, 1.0], [-2.0, 0.5]], -2.0, 1.0),
        # Differences by round-off do not move the extreme.
        ([[0.0, 2.0], [-2.0 - 1e-12, 0.5]], 2.0, 0.0),
        ([[0.0, 0.0], [0.0, 0.0]], 0.0, 0.0),
    ],
)
def test_an_extreme_is_the_first_largest_magnitude(
    values: list[list[float]], value: float, time: float
) -> None:
    """Reference: by hand."""
    places = np.array([4.0, 5.0]), None, None
    measured = Measured(
        "stress", "arm", "", np.array(values), np.array([0.0, 1.0]), places, limit=10.0
    )
    (row,) = extremes([measured], "beam", REST)
    assert (row.value, row.time, row.y) == (value, time, None)
    assert row.utilisation == abs(value) / 10.0


def test_fibres_of_a_segment_are_one_row() -> None:
    """Reference: by hand. Of a buckling factor the smallest governs."""
    for quantity, expected in (("stress", -7.0), ("plate_buckling", 3.0)):
        measured = [
            Measured(quantity, "arm", "", np.array([[value]]), np.zeros(1))
            for value in (5.0, -7.0, 3.0)
        ]
        (row,) = extremes(measured, "beam", REST)
        assert row.value == expected
    assert [*extremes([Measured("tip", "tip", "", np.zeros((0, 1)), None)], "beam", REST)] == []


def test_static_values_of_other_places_and_models_are_not_its_own() -> None:
    """Reference: by hand."""
    moved = Row("a", MOTION, True, "reaction", "base", "at 0 m", -6.0)
    static = moved._replace(state=REST, value=2.0)
    rows = Rows(
        [
            moved,
            static,
            static._replace(state=EXTENDED, value=-3.0),
            static._replace(play=False, value=9.0),
            static._replace(place="at 1 m", value=9.0),
            static._replace(model="b", value=9.0),
            static._replace(state="initial", value=9.0),
        ]
    )
    assert rows.at_rest(moved) == 3.0
    assert rows.dynamic_factor(moved) == 2.0


def test_curves_of_any_length_are_one_dataset(tmp_path: Path) -> None:
    """Reference: by construction."""
    curves = Curves(
        [
            Curve("beam", REST, True, "arm", 0.5, np.arange(3.0), {"moment": np.ones(3)}),
            Curve("shell", "mode 1", True, "fly", np.nan, np.arange(2.0),
                  {"deflection": np.array([0.0, 1.0]), "twist": np.zeros(2)}),
        ]
    )  # fmt: skip
    curves.dataset.to_netcdf(tmp_path / "curves.nc", engine="scipy")
    read = Curves.of(read_netcdf(tmp_path / "curves.nc"))
    assert len(read) == 2
    for one, other in zip(curves, read, strict=True):
        assert one[:4] == other[:4]
        np.testing.assert_equal(one.time, other.time)
        np.testing.assert_array_equal(one.x, other.x)
        assert one.values.keys() == other.values.keys()
        for name, values in one.values.items():
            np.testing.assert_array_equal(values, other.values[name])
    (moment,) = read.where(model="beam", state=REST)
    assert moment.values["moment"].tolist() == [1.0, 1.0, 1.0]
    assert Curves.of(Curves().dataset) == ()
    for damaged in (curves.dataset.drop_vars("count"), curves.dataset.isel(point=slice(3))):
        with pytest.raises((ValueError, KeyError)):
            Curves.of(damaged)


def test_a_history_has_the_largest_stress_of_each_interval() -> None:
    """Reference: by hand, 80 intervals of two times; a segment beyond the place has none."""
    rise = np.arange(160.0)
    stresses = np.stack([rise, np.full(160, np.nan)], axis=1)[:, :, None]
    near = xr.Dataset(
        {
            name: (("time", "segment", "place"), stresses)
            for name in ("von_mises", "von_mises_patch")
        },
        coords={"time": 1e-3 * rise, "segment": ["arm", "fly"], "place": [2.0]},
    )
    (curve,) = histories(near, "shell")
    assert (curve.segment, curve.place, curve.state) == ("arm", 2.0, "history")
    np.testing.assert_array_equal(curve.values["von_mises"], rise[1::2])
    np.testing.assert_allclose(curve.x, 1e-3 * (rise[1::2] - 0.5))
    (read,) = Curves.of(Curves([curve]).dataset)
    assert read.place == 2.0
