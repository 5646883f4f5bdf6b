# SPDX-License-Identifier: LGPL-3.0-or-later
"""Lateral play that walls close as they bulge under vertical pads."""

from dataclasses import replace

import numpy as np
import pytest

from runs import CASES
from runs.case import reading
from runs.case.build import build_boom
from runs.pipeline.largest_loads import StaticBeam
from runs.pipeline.models import build
from runs.pipeline.static_results import StaticResult, bulge_cautions, positions, station_loads
from runs.pipeline.statics import boom_with_play


def test_bulging_walls_give_a_caution() -> None:
    """Reference: by hand, right walls that move by a part of the lateral play; beams close none."""
    case = reading.load(str(CASES / "spatial.toml"))
    boom, model = build_boom(case), next(m for m in case.models if m.name == "timoshenko")
    system = build(case, boom, model).system.gather_loads()
    position = positions(system)[0.0]
    plain = [*station_loads(boom, system, position)]
    assert [one.closed for one in plain] == pytest.approx([0.0] * 4, abs=1e-12)

    play = boom.joints[0].lateral_play
    assert play is not None
    rows = system.rows.copy()
    for part, name in ((0.05, "9y"), (0.3, "10y")):
        station = next(k for k, one in enumerate(plain) if one.place == name)
        right = [
            row
            for row in np.flatnonzero(system.station_of_row == station)
            if system.laws[row].one_sided(1) is not None
        ]
        rows[right] += part * play * position / (position @ position)
    bulging = [*station_loads(boom, replace(system, rows=rows), position)]
    assert [one.closed / play for one in bulging] == pytest.approx([0.0, 0.0, 0.05, 0.3])

    static = StaticResult(0.0, 0.0, 0.0, [], [], bulging, {})
    assert bulge_cautions("in shell", static, boom) == [
        f"caution: in shell walls bulge under vertical pads at rest and close lateral play: "
        f"{300.0 * play:.2g} of {1000.0 * play:g} mm at x = 10 m; beams with rigid walls do not "
        "show this"
    ]


def test_check_names_plays_closed_by_walls() -> None:
    """Reference: other code, the arm's shell at rest with edges of 0.2 m."""
    checked = reading.load_checked(str(CASES / "inspection-arm.toml"))
    boom = boom_with_play(checked.case, checked.boom)
    (rest, *_) = StaticBeam.of(checked.case, boom).rests
    closed = [one.closed for one in rest.stations if one.direction == "y"]
    assert closed == pytest.approx([1.1985e-3, 1.8414e-3, 0.8242e-3, 1.3873e-3], rel=0.02)
    (caution,) = bulge_cautions("in the beam estimate", rest, boom)
    assert "1.2 of 4 mm at x = 3.5 m, 1.8 of 4 mm at x = 4.5 m" in caution
