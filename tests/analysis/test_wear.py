# SPDX-License-Identifier: LGPL-3.0-or-later
"""Wear of pads against its closed form."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray as xr

from protractile.analysis.fatigue import Life
from protractile.analysis.rows import Rows
from protractile.analysis.states import States
from protractile.analysis.wear import wear_rows
from protractile.cases import load_case, run_case
from protractile.runs.case.build import build_boom

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
