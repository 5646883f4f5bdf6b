# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows and curves of results: selections, extremes, files; statics and modes from Python; wear."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import protractile as pt
from protractile.analysis.curves import Curve, Curves, histories
from protractile.analysis.fatigue import Life
from protractile.analysis.measure import Measured
from protractile.analysis.quantities import MEASURED
from protractile.analysis.rows import EXTENDED, MOTION, REST, Row, Rows, extremes
from protractile.analysis.states import States
from protractile.analysis.wear import wear_rows
from protractile.cases import load_case, run_case
from protractile.runs.case.build import build_boom
from protractile.runs.pipeline.results import read_netcdf
from tests.booms import cantilever, force, telescope

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


def test_rows_are_selected_and_compared() -> None:
    """Reference: by hand, 50 of 200 MPa. The largest utilisation governs, without limits the
    largest magnitude. Static values are those of the same place and model.
    """
    row = Row("beam", MOTION, True, "stress", "fly", "", -50e6, 1.0, limit=200e6)
    frame = Rows([row]).frame
    assert frame.loc[0, ["unit", "value", "utilisation"]].tolist() == ["Pa", -50e6, 0.25]
    assert Rows().frame.empty
    tips = Rows(
        Row(model, state, True, "tip", "tip", "", value)
        for model, state, value in (("a", REST, 1.0), ("a", MOTION, -3.0), ("b", REST, 2.0))
    )
    assert [row.value for row in tips.where(model="a")] == [1.0, -3.0]
    assert [row.value for row in tips.where(state=[REST, MOTION])] == [1.0, -3.0, 2.0]
    assert tips.where(model="c") == ()
    assert (tips.largest, Rows().largest) == (tips[1], None)
    each = [
        row._replace(value=value, limit=limit)
        for value, limit in ((90e6, 300e6), (-80e6, 100e6), (95e6, None))
    ]
    assert Rows(each).governing == each[1]
    assert Rows(one._replace(limit=None) for one in each).governing == each[2]
    moved = Row("a", MOTION, True, "reaction", "base", "at 0 m", -6.0)
    static = moved._replace(state=REST, value=2.0)
    others = ({"play": False}, {"place": "at 1 m"}, {"model": "b"}, {"state": "initial"})
    rows = Rows(
        [moved, static, static._replace(state=EXTENDED, value=-3.0),
         *(static._replace(value=9.0, **other) for other in others)]
    )  # fmt: skip
    assert (rows.at_rest(moved), rows.dynamic_factor(moved)) == (3.0, 2.0)


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
    """Reference: by hand. Fibres of a segment are one row; the smallest buckling factor governs."""
    places = np.array([4.0, 5.0]), None, None
    measured = Measured(
        "stress", "arm", "", np.array(values), np.array([0.0, 1.0]), places, limit=10.0
    )
    (row,) = extremes([measured], "beam", REST)
    assert (row.value, row.time, row.y) == (value, time, None)
    assert row.utilisation == abs(value) / 10.0
    for quantity, expected in (("stress", -7.0), ("plate_buckling", 3.0)):
        fibres = [
            Measured(quantity, "arm", "", np.array([[stress]]), np.zeros(1))
            for stress in (5.0, -7.0, 3.0)
        ]
        (row,) = extremes(fibres, "beam", REST)
        assert row.value == expected
    assert [*extremes([Measured("tip", "tip", "", np.zeros((0, 1)), None)], "beam", REST)] == []


@pytest.mark.parametrize(
    ("push", "value", "limit"), [(50.0, 50.0, 100.0), (0.0, -80.0, None), (90.0, 90.0, 100.0)]
)
def test_a_pull_without_a_limit_hides_no_push(
    push: float, value: float, limit: float | None
) -> None:
    """Reference: by construction. A push of 0 N judges no cylinder that pulls."""
    both = [
        Measured("cylinder_force", "cylinder", "", np.array([[force]]), np.zeros(1), limit=most)
        for force, most in ((push, 100.0), (-80.0, None))
    ]
    for order in (both, both[::-1]):
        (row,) = extremes(order, "beam", REST)
        assert (row.value, row.limit) == (value, limit)


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


@pytest.mark.slow
def test_a_motion_is_evaluated_as_a_run_of_a_case() -> None:
    """Reference: other code path, the tip of the trajectory and the deflection at rest."""
    gust = force("fly", 14.0, -500.0, history=pt.Ramp(0.1))
    beam = pt.BeamElements(pt.with_weight(telescope(gust), angle=30.0), theory="timoshenko")
    motion = beam.simulate(0.3)
    rows, curves = beam.evaluate(motion)
    (moved,) = rows.where(quantity="tip", state="motion")
    tips = motion.data["tip"].values
    assert abs(moved.value) == np.abs(tips).max()
    assert moved.value == tips[np.isclose(motion.time, moved.time)][0]
    (rest,) = rows.where(quantity="tip", state=REST)
    assert rows.dynamic_factor(moved) == abs(moved.value) / abs(rest.value)
    names = {curve.state for curve in curves}
    assert {REST, "minimum", "maximum", "mode 1"} <= names


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"requested": ["yeild"]}, "'yeild' is no kind of proof by beams; give 'yield', 'plate'"),
        ({"requested": ["patch"]}, "'patch' is no kind of proof by beams"),
        ({"permitted_tip": 0.0}, "permitted_tip: must be a number above 0"),
        ({"resistance": pt.Resistance(pad=-1.0)}, "resistance.pad: must be a number above 0"),
    ],
)
def test_a_wrong_request_is_an_error(wrong: dict[str, Any], message: str) -> None:
    """An axial force is about 50 times the buckling force of a cantilever (Euler 1744)."""
    push = force("arm", 8.0, -5.0e3)
    with pytest.raises(pt.BoomError, match=message):
        pt.prove(cantilever(push), {"own": []}, **wrong)
    with pytest.raises(pt.NumericsError, match="far: the boom has no static equilibrium"):
        pt.prove(cantilever(push, thrust=1e8), {"far": []})


def test_plates_that_bend_leave_the_force_to_pads_at_corners() -> None:
    """Reference: by hand, E A/t of the pads at the corner, which carry the whole force.

    The pads away from the corners would have to bend the plates by more than those at the corners
    are pressed in. Shares as the pads are stiff would be 1 to 2.
    """
    pads = tuple(
        pt.SlidePad(
            side=side, length=length, width=0.03, thickness=0.02, modulus=2e9, bears="wall",
            offset=offset,
        )
        for side, length, offset in (
            ("above", 0.1, 0.0), ("below", 0.1, 0.0), ("below", 0.2, 0.04),
        )
    )  # fmt: skip
    padded = telescope(force("fly", 14.0, -1000.0), joint__pad=None, joint__pads=pads)
    rows = pt.statics(padded).rows.where(state=REST)
    whole, pressed, corner, beside = (
        rows.where(quantity=quantity, place=f"station 2{name}")[0].value
        for quantity, name in (
            ("contact_force", ""), ("penetration", ""),
            ("pad_force", ", below"), ("pad_force", ", below 2"),
        )
    )  # fmt: skip
    assert corner == pytest.approx(2e9 * 0.1 * 0.03 / 0.02 * pressed, rel=1e-6)
    assert [2.0 * corner, beside] == pytest.approx([abs(whole), 0.0], rel=1e-6)


CASE: dict[str, Any] = {
    "title": "Telescoping boom", "time": {"duration": 4.0, "output_step": 0.01},
    "material": {"youngs_modulus": 2.1e11, "poissons_ratio": 0.3, "density": 7850.0},
    "start": {"state": "equilibrium"}, "payload": {"mass": 200.0}, "damping": {"modal": 0.05},
    "segment": [
        {"name": "base", "length": 6.0, "supports": [{"x": 0.0, "kind": "clamped"}],
         "section": {"height": 0.3, "width": 0.2, "flange": 0.006, "web": 0.006}},
        {"name": "fly", "length": 5.0,
         "section": {"height": 0.25, "width": 0.15, "flange": 0.005, "web": 0.005}},
    ],
    "joint": [
        {"outer": "base", "inner": "fly", "extension": 2.0, "stations": ["tail", "head"],
         "play": 0.004, "pad": {"length": 0.1, "width": 0.05, "thickness": 0.02},
         "drive": {"travel": 1.5, "time": 3.0}}
    ],
    "life": {"wear": 2.0e-6, "repeats": 10000},
    "model": [
        {"name": "beam", "kind": "finite-element", "theory": "euler-bernoulli",
         "element_length": 1.0}
    ],
}  # fmt: skip


def test_wear_of_a_constant_force() -> None:
    """Reference: analytic. Depth N k (F/2) s/A of each of two pads, which is added to the play."""
    boom = build_boom(load_case(CASE))
    time, force, way = np.linspace(0.0, 1.0, 11), 3000.0, 1.5
    data = xr.Dataset(
        {
            "extension": ("time", way * time),
            "contact_force": (("time", "station"), np.tile([force, -2.0 * force], (11, 1))),
        }
    )
    states = cast(States, SimpleNamespace(boom=boom, recorded=data))
    rows = Rows(wear_rows(states, "beam", Life(repeats=10_000, wear=2.0e-6), 0.01))
    depth = 1.0e4 * 2.0e-15 * 0.5 * force * way / (0.1 * 0.05)
    assert [(row.place, row.value) for row in rows.where(quantity="wear")] == [
        ("station 1, above", pytest.approx(depth)),
        ("station 1, below", 0.0),
        ("station 2, above", 0.0),
        ("station 2, below", pytest.approx(2.0 * depth)),
    ]
    assert [row.value for row in rows.where(quantity="worn_play")] == [
        pytest.approx(0.004 + depth), pytest.approx(0.004 + 2.0 * depth),
    ]  # fmt: skip
    lives = [row.value for row in rows.where(quantity="wear_life")]
    assert lives == [pytest.approx(1.0e4 * 0.02 / depth), pytest.approx(0.5e4 * 0.02 / depth)]
    assert rows.governing is not None
    assert rows.governing.utilisation == pytest.approx(2.0 * depth / 0.02)
    # The tail rises by one depth, the head falls by two, and the tip turns about them. At the
    # largest extension the tail, which rides on the fly, is closer to the head.
    (tail, head), tip = boom.joints[0].stations, boom.tip + way
    fall = (2.0 + 3.0 * (tip - head) / (head - tail - way)) * depth
    (worn,) = rows.where(quantity="worn_tip")
    assert worn.value == pytest.approx(0.01 + fall)
    limited = Life(repeats=10_000, wear=2.0e-6, tip=0.05)
    *_, worn, life = wear_rows(states, "beam", limited, 0.01)
    assert (worn.limit, life.quantity) == (0.05, "wear_life")
    assert life.value == pytest.approx(1.0e4 * 0.04 / fall)
    # Without a coefficient or a drive nothing wears.
    assert [*wear_rows(states, "beam", Life())] == []
    fixed = SimpleNamespace(boom=boom, recorded=data.drop_vars("extension"))
    assert [*wear_rows(cast(States, fixed), "beam", Life(wear=1.0))] == []


def test_wear_of_a_run_is_that_of_its_statics() -> None:
    """Reference: analytic, lever of the payload and the weight of nothing else, slow telescoping.

    The head bears F (1 + a/l) and the tail F a/l, where the arm a grows and the overlap l shrinks
    by the extension; vibration about these means adds nothing, within 2 %.
    """
    results = run_case(load_case(CASE))
    rows = results.rows.where(model="beam", quantity="wear", state="motion")
    boom = results.boom
    (joint,) = boom.joints
    weight, pad = 200.0 * 9.80665, joint.pad
    assert pad is not None
    # Pads lie within the overlap: half a length from its ends. The integral of a/l over the way.
    arm, overlap, way = 2.0 + 0.05, 3.0 - 0.1, 1.5
    tail = weight * ((arm + overlap) * np.log(overlap / (overlap - way)) - way)
    head = tail + weight * way
    scale = 1.0e4 * 2.0e-15 / (2.0 * pad.area)
    worn = {row.place: row.value for row in rows if row.value}
    assert worn == {
        "station 1, above": pytest.approx(scale * tail, rel=0.02),
        "station 2, below": pytest.approx(scale * head, rel=0.02),
    }
