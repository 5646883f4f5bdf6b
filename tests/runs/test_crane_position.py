# SPDX-License-Identifier: LGPL-3.0-or-later
"""Positions of a crane and its load beside the pictures of its boom."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from runs import CASES
from runs.case.build import build_boom
from runs.case.hoist import HoistTable
from runs.case.reading import load
from runs.case.turning import LuffTable
from runs.report.crane_position import CranePosition

TIME = np.array([0.0, 2.5, 5.0])


def motion(**variables: list[float]) -> xr.Dataset:
    """Return a trajectory with given variables of the load."""
    found = {name: ("time", values) for name, values in variables.items()}
    return xr.Dataset(found, {"time": TIME})


def test_slewing_crane_with_load() -> None:
    """Reference: by hand. The boom turns by 15 degrees at a radius of 8.1 m cos 30°."""
    case = load(str(CASES / "slew.toml"))
    boom = build_boom(case)
    data = motion(rope_force=[1.2e4] * 3, swing_out=[0.0, 0.0, 0.1], swing_aside=[0.0, 0.0, 0.6])
    position = CranePosition.of(case, boom, data)
    assert position is not None
    assert position.load is not None
    out, turned = boom.tip * np.cos(np.pi / 6.0), np.deg2rad(15.0)
    along, aside = np.array([np.cos(turned), np.sin(turned)]), [-np.sin(turned), np.cos(turned)]
    np.testing.assert_allclose(position.boom[:, 0], 0.0, atol=1e-12)
    np.testing.assert_allclose(position.boom[-1, 1], out * along)
    np.testing.assert_allclose(position.load[0], [out, 0.0])
    np.testing.assert_allclose(position.load[-1], (out + 0.1) * along + np.multiply(0.6, aside))


def test_luffing_and_hoisting_crane() -> None:
    """Reference: by hand. The tip rises on a circle, the load from 35 m below its first place."""
    case = load(str(CASES / "hoist.toml"))
    luff = LuffTable(travel=10.0, time=5.0)
    case = case.model_copy(update={"luff": luff})
    boom = build_boom(case.model_copy(update={"luff": None}))
    position = CranePosition.of(
        case, boom, motion(rope_force=[0.0] * 3, load_height=[0.0, 0.1, 0.4])
    )
    assert position is not None
    assert position.load is not None
    start, end = (boom.tip * np.array([np.cos(a), np.sin(a)]) for a in np.deg2rad([60.0, 70.0]))
    np.testing.assert_allclose(position.boom[0, 1], start)
    np.testing.assert_allclose(position.boom[-1, 1], end)
    np.testing.assert_allclose(position.load[-1], [end[0], start[1] - 35.0 + 0.4])
    axes = Figure().add_subplot()
    position.prepare(axes)
    *_, rope, mark = position.draw(axes, 5.1)
    np.testing.assert_allclose(rope.get_xydata()[0], end)
    np.testing.assert_allclose(mark.get_xydata()[0], position.load[-1])


def test_other_booms_have_no_position() -> None:
    """Reference: by definition. A load that is dropped is no longer on the rope."""
    case = load(str(CASES / "hoist.toml"))
    boom, data = build_boom(case), motion()
    hung = HoistTable(mass=5000.0, stiffness=1.0e6, hanging=True, dropped=True)
    dropped = CranePosition.of(case.model_copy(update={"hoist": hung}), boom, data)
    assert dropped is not None
    assert dropped.load is None
    assert CranePosition.of(case.model_copy(update={"hoist": None}), boom, data) is None
