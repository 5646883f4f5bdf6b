# SPDX-License-Identifier: LGPL-3.0-or-later
"""The report shows the stresses of a summary: a figure over time, and what the walls carry."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from PIL import Image

from runs import CASES
from runs.case import reading as case_file
from runs.pipeline.results import Results
from runs.report import theme
from runs.report.figure_context import FigureContext
from runs.report.force_figures import stress_history
from runs.report.model_tables import wall_table
from tests.runs.summaries import model_summary, summary_of

COARSE = CASES / "coarse.toml"
STRESS: dict[str, Any] = {
    "von_mises": 9.16e7,
    "time": 0.5,
    "segment": "inner",
    "wall": "right",
    "face": "outer",
    "x": 9.03,
    "y": 0.1,
    "z": 0.0,
    "band": 0.25,
    "patch": {"von_mises": 3.1e7, "time": 0.4, "segment": "inner", "x": 9.0},
    "walls": [
        {
            "segment": "outer",
            "x": 2.0,
            "forces": {"top": {"axial": -12500.0, "shear": 3.0, "moment": 3060.0}},
        }
    ],
    "history": {
        "time": [0.15, 0.45],
        "places": [
            {"segment": s, "x": 9.0, "von_mises": [1e7, 9e7], "von_mises_patch": [5e6, 3.1e7]}
            for s in ("outer", "inner")
        ],
    },
}


def results(stress: dict[str, Any] | None) -> Results:
    """Return a run of the coarse case's shell, with or without stresses."""
    case = case_file.select(case_file.load(str(COARSE)), "", ["shell"], None)
    data = xr.Dataset(
        {"tip": (("model", "time"), np.zeros((1, 601)))},
        coords={"model": ["shell"], "time": np.arange(601) / 1000},
    )
    changes = {} if stress is None else {"stress": stress}
    return Results(case, data, summary_of({"shell": model_summary(**changes)}))


def test_stress_figure_states_maximum_and_limits(tmp_path: Path) -> None:
    with matplotlib.rc_context(theme.RC):
        (figure,) = stress_history(FigureContext(results(STRESS), tmp_path))
    assert figure.title == (
        "shell: von Mises stress over a patch up to 31 MPa, in a triangle up to 91.6 MPa"
    )
    assert "grows with mesh refinement" in figure.caption
    with Image.open(figure.path) as image:
        image.verify()


def test_stress_table_has_the_force_of_each_wall() -> None:
    table = wall_table(results(STRESS))
    assert table is not None
    assert table.rows == [("shell", "outer", "2", "top", "−12.50", "0.00", "3.06")]
    assert "91.6 MPa at x = 9.03 m in 'inner', outer face of the wall 'right'" in table.notes[0]


def test_without_a_shell_there_is_nothing(tmp_path: Path) -> None:
    assert wall_table(results(None)) is None
    assert stress_history(FigureContext(results(None), tmp_path)) == []


def test_the_largest_stress_stands_beside_the_yield_strength_where_it_is_known() -> None:
    """Reference: 91.6 MPa of 355 MPa."""
    plain = results(STRESS)
    material = plain.case.material
    assert material is not None
    steel = replace(material, yield_strength=355e6)
    known = replace(plain, case=plain.case.model_copy(update={"material": steel}))
    said = [table.notes[0] for found in (plain, known) if (table := wall_table(found))]
    assert "91.6 MPa at x" in said[0]
    assert "91.6 MPa (25.8 % of the yield strength) at x" in said[1]
