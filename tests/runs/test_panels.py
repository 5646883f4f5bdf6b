# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling of walls by formulas for long panels, and lateral play closed by bulging walls."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from protractile.analysis.equilibria import equilibria
from protractile.analysis.measure import measure_boom
from protractile.analysis.model import AnalysisModel
from protractile.analysis.plate_buckling import (
    measure_plates,
    weakest_plates,
)
from protractile.analysis.rows import INITIAL, REST, Rows, extremes, static_rows
from protractile.analysis.states import States
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import Line
from protractile.geometry.boom import Boom, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.material import Material
from protractile.geometry.segment import Segment
from protractile.runs import CASES
from protractile.runs.case import reading
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import CheckedCase
from protractile.runs.cautions.context import Context, State
from protractile.runs.cautions.response import bulges
from protractile.runs.check import check_case
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.models import build
from protractile.runs.pipeline.statics import boom_with_play
from tests.modal import modal_system
from tests.runs import case_texts
from tests.runs.case_texts import read_case, shipped

STEEL = Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)


def test_the_weakest_wall_of_a_segment() -> None:
    """Reference: analytic. Moments compress the bottom flange; torque shears all walls, and axial
    forces compress them.
    """
    box = BoxSection(height=0.5, width=0.4, flange=0.006, web=0.008)
    segment = Segment.of_section("outer", 0.0, 2.0, STEEL, box, supports=(Support(0.0, "clamped"),))

    def weakest(normal: float = 0.0, **curves: list[float]) -> tuple[str, float, float]:
        nothing = {"deflection": [0.0, 0.0], "moment": [0.0, 0.0]}
        values = nothing | {"normal": [0.5 * normal, normal]} | curves
        # One coordinate of value 1 has these section forces.
        line = Line(
            np.array([0.0, 2.0]), {k: np.array(v)[:, None] for k, v in values.items()}, True
        )
        model = AnalysisModel(Boom((segment,), ()), modal_system([1.0], [0.0]), [line])
        rest = States(model, np.zeros(1), np.ones((1, 1)))
        (row,) = weakest_plates(Rows(extremes(measure_plates(rest), "beam", REST)))
        return row.place, row.x, row.value

    flange = np.pi**2 * 2.1e11 / (12.0 * 0.91) * (0.006 / 0.4) ** 2
    stress = 1.0e5 * 0.25 / box.second_moment_of_area
    assert weakest(moment=[0.0, 1.0e5]) == ("bottom", 2.0, pytest.approx(4.0 * flange / stress))
    pressed = pytest.approx(4.0 * flange * box.area / 1.0e6)
    assert weakest(-1.0e6) == ("bottom", 2.0, pressed)
    # A positive moment presses the fibres with y < 0, on the left.
    web = np.pi**2 * 2.1e11 / (12.0 * 0.91) * (0.008 / 0.5) ** 2
    stress = 1.0e5 * 0.2 / box.lateral_second_moment_of_area
    found = weakest(lateral_moment=[0.0, 1.0e5])
    assert found == ("left", 2.0, pytest.approx(4.0 * web / stress))
    shear = 1.0e5 / (2.0 * 0.2 * 0.006)
    wall, x, factor = weakest(torque=[1.0e5, 1.0e4])
    assert (wall, x) == ("bottom", 0.0)
    assert factor == pytest.approx(5.34 * flange / shear)


def test_check_names_buckling_walls(tmp_path: Path) -> None:
    """Reference: analytic, the bottom flange of a cantilever under a load at its tip."""
    box = BoxSection(height=0.4, width=0.3, flange=0.003, web=0.008)
    unit = np.pi**2 * 2.1e11 / (12.0 * 0.91) * (0.003 / 0.3) ** 2
    stress = 2.0e5 * 6.0 * 0.2 / box.second_moment_of_area
    sheared = 2.0e5 / (2.0 * 0.4 * 0.008)
    case = read_case(
        tmp_path,
        f"""
title = "Thin"
time = {{ duration = 1.0 }}
model = [{{ name = "beam", kind = "finite-element" }}]
load = [{{ segment = "arm", x = "head", magnitude = -2e5 }}]
{case_texts.STEEL}{case_texts.box("arm", 6.0, (0.4, 0.3, 0.003, 0.008), case_texts.CLAMPED)}
""",
    )
    found = check_case(CheckedCase(case))
    (table,) = (one for one in found.tables if one.title == "Buckling of walls, estimate")
    assert table.rows == [("arm", "bottom", "0", f"{4.0 * unit / stress:.3g}")]
    assert sheared < 0.1 * 5.34 * unit * (8.0 / 3.0) ** 2
    (caution,) = (line for line in found.lines if "panel formulas" in line)
    assert caution.startswith("caution: the wall 'bottom' of 'arm' buckles at")


def test_bulging_walls_give_a_caution() -> None:
    """Reference: by hand, right walls moved by a part of the play. Beams do not bulge."""
    case = shipped("spatial")
    boom, model = build_boom(case), next(m for m in case.models if m.name == "timoshenko")
    built = build(case, boom, model)
    loaded = AnalysisModel.of(boom, built.system, model.lines(boom, built))
    system, rests = loaded.system, equilibria(loaded.system)
    position, play = rests[0.0], boom.joints[0].lateral_play

    def closed(of: GapSystem) -> Rows:
        states = States.of(replace(loaded, system=of), rests)
        rows = Rows(extremes(measure_boom(states), "shell", INITIAL))
        return rows.where(quantity="closed_play")

    assert [row.value for row in closed(system)] == pytest.approx([0.0, 0.0], abs=1e-12)
    rows = system.rows.copy()
    for part, name in ((0.05, "9y"), (0.3, "10y")):
        station = next(one.index for one in boom.stations if one.name == name)
        right = [
            row
            for row in np.flatnonzero(system.station_of_row == station)
            if system.laws[row].one_sided(1) is not None
        ]
        rows[right] += part * play * position / (position @ position)
    bulging = closed(replace(system, rows=rows))
    assert [row.value / play for row in bulging] == pytest.approx([0.05, 0.3])
    assert [row.limit for row in bulging] == [play, play]

    told = [
        "in shell, static pad forces make walls bulge, which reduces the lateral play: by "
        f"{300.0 * play:.2g} of {1000.0 * play:g} mm at x = 10 m; beams with rigid walls do not "
        "show this"
    ]
    assert [*bulges(Context(case, boom, [State("in shell", closed=bulging)]))] == told


def test_check_names_plays_closed_by_walls() -> None:
    """Reference: other code, the static shell of the arm with edges of 0.2 m."""
    checked = reading.load_checked(str(CASES / "inspection-arm.toml"))
    boom = boom_with_play(checked.case, checked.boom)
    rows = Rows(static_rows(static_states(checked.case, boom), "beam"))
    closed = rows.where(state=INITIAL, quantity="closed_play")
    assert [row.value for row in closed] == pytest.approx(
        [1.1985e-3, 1.8414e-3, 0.8242e-3, 1.3873e-3], rel=0.02
    )
    state = State("in the beam estimate", closed=closed)
    (caution,) = bulges(Context(checked.case, boom, [state]))
    assert "1.2 of 4 mm at x = 3.5 m, 1.8 of 4 mm at x = 4.5 m" in caution
