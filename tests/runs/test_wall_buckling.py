# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling of walls from the case to the report."""

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from protractile.analysis.plate_buckling import weakest_plates
from protractile.analysis.rows import FARTHEST
from protractile.analysis.wall_buckling import with_locations
from protractile.cases import change, run_case
from protractile.geometry.mesh import mesh_segment
from protractile.geometry.plating import add_thickness
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.reading import select
from protractile.runs.case.schema import BucklingTable
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.summary import Summary
from protractile.runs.report.result_tables import buckling_table
from protractile.runs.report.summary_table import summary_table
from protractile.shell_model.buckling import SegmentBuckling
from studies.wall_buckling import TUBE
from tests.runs.case_texts import shipped
from tests.shell_model.booms import box_segment


def run(name: str, duration: float) -> Results:
    """Return the results of a shipped case with a shell of few triangles, and a beam."""
    shell = Shell(name="shell", kind="shell", mesh_size=0.25, contact_tolerance="any")
    case = select(shipped(name), "", ["timoshenko"])
    more = {"models": (*case.models, shell), "buckling": BucklingTable(modes=2), "statements": ()}
    return run_case(change(case.model_copy(update=more), **{"time.duration": duration}))


def panels(results: Results, model: str) -> list[float]:
    """Return the lowest factor of each segment by panel formulas."""
    rows = results.rows.where(model=model, state=FARTHEST)
    return [row.value for row in weakest_plates(rows)]


@pytest.mark.slow
def test_a_run_has_factors_of_shell_and_panels() -> None:
    """Reference: other code, panel formulas, below the shell with its restrained folds."""
    results = run("coarse", 0.01)
    summary = Summary.model_validate_json(str(results.summary))
    shell, beam = (summary.design.models[name] for name in ("shell", "timoshenko"))
    assert [one.segment for one in shell.buckling] == ["outer", "inner"]
    assert not beam.buckling
    estimates = panels(results, "shell")
    for own, estimate in zip(shell.buckling, estimates, strict=True):
        assert own.factors[0] < own.factors[1]
        assert 0.5 * estimate < own.factors[0] < 1.5 * estimate
    assert panels(results, "timoshenko") == pytest.approx(estimates, rel=0.04)
    table = buckling_table(results)
    titles = [column.title for column in table.columns]
    assert titles[2:] == [
        *("factor, shell", "wall", "at x", "mesh error"),
        *("factor, panel\nformulas", "panel", "panel at x"),
    ]
    first = summary_table(results)
    row = first.columns[0].cells.index("Plate buckling factor, lowest (segment)")
    lowest = min((one.factors[0], one.segment) for one in shell.buckling)
    cells = {column.title: str(column.cells[row]) for column in first.columns[1:]}
    assert cells["shell"] == f"{lowest[0]:.3g} ({lowest[1]})"
    assert cells["timoshenko"].endswith(", panel formulas)")


@pytest.mark.slow
def test_buckling_of_a_telescoping_shell_is_at_the_farthest_tip() -> None:
    """Reference: other code, panel formulas of the same state, at the largest extension."""
    results = run("drawn-out", 0.05)
    shell = results.summary.design.models["shell"]
    for own, estimate in zip(shell.buckling, panels(results, "shell"), strict=True):
        assert estimate < own.factors[0] < 2.0 * estimate


def test_round_off_does_not_choose_between_mirrored_walls() -> None:
    """Reference: by hand, displacements of the left and the right web that differ by 1e-12."""
    segment = box_segment("box", 0.0, 2.0, TUBE)
    mesh = add_thickness(segment, mesh_segment(TUBE, {"start": 0.0, "end": 2.0}, 0.2))
    webs = np.isclose(np.abs(mesh.points[:, 1]), 0.2) & np.isclose(mesh.points[:, 2], 0.0)
    shape = np.where(webs, 1.0, 0.0)[:, None] * [0.0, 1.0, 0.0]
    shapes = np.array([shape * (1.0 + 1e-12 * way * mesh.points[:, 1:2]) for way in (-1, 1)])
    found = SegmentBuckling(np.array([2.0, 2.0]), np.zeros(2), mesh, shapes)
    (wall, other), (x, other_x) = (
        getattr(with_locations("box", found), key) for key in ("walls", "x")
    )
    assert wall == other
    assert x == other_x


def test_a_case_without_the_table_has_none() -> None:
    results = run_case(shipped("coarse"), models=["timoshenko"])
    assert not buckling_table(results).rows
    assert not results.rows.where(quantity="plate_buckling")
