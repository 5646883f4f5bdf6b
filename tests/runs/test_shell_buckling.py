# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling of booms of shells and of their walls, from the case to the report."""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.analysis.plate_buckling import weakest_plates
from protractile.analysis.rows import FARTHEST
from protractile.analysis.wall_buckling import with_locations
from protractile.beam_model.static_model import estimate_critical_factor
from protractile.cases import change, run_case
from protractile.dynamics.equilibrium import equilibrium
from protractile.geometry.boom import Boom
from protractile.geometry.mesh import mesh_segment
from protractile.geometry.plating import add_thickness
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext, BuiltModel
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.reading import select
from protractile.runs.case.schema import BucklingTable
from protractile.runs.pipeline.models import build
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.summary import Summary
from protractile.runs.report.result_tables import buckling_table
from protractile.runs.report.summary_table import summary_table
from protractile.shell_model.buckling import SegmentBuckling
from studies.wall_buckling import TUBE
from tests.runs.case_texts import read_case, shipped
from tests.shell_model.booms import box_segment

# A hexagon whose plates bend under pads on their corners.
HEXAGON = """
title = "Hexagon on corner pads"
time = { duration = 1.0 }
material = { youngs_modulus = 2.1e11, poissons_ratio = 0.3, density = 7850.0 }
gravity = { angle = 0.0 }
start = { state = "equilibrium" }
payload = { mass = 6000.0 }
axial = [{ force = 200000.0 }]

[[model]]
name = "shell"
kind = "shell"
mesh_size = 0.3

[[segment]]
name = "outer"
length = 8.7
supports = [{ x = 0.0, kind = "clamped" }]
[segment.section]
shape = "hexagon"
height = 0.82
width = 0.58
flat = 0.39
top = 0.008
bottom = 0.011
web = 0.007

[[segment]]
name = "inner"
length = 8.7
[segment.section]
shape = "hexagon"
height = 0.74
width = 0.50
flat = 0.32
top = 0.007
bottom = 0.009
web = 0.006

[[joint]]
outer = "outer"
inner = "inner"
extension = 7.1
stations = ["tail", "head"]
play = 0.004
pad = { length = 0.25, width = 0.07, thickness = 0.020, bears = "corner" }
"""


# The same boom of thick boxes in space, under 1 MN.
BOXES = re.sub(
    r"shape = .*\n(height.*\nwidth.*\n)flat.*\ntop.*\nbottom.*\nweb.*",
    r"\1flange = 0.02\nweb = 0.02",
    HEXAGON.replace("play = 0.004", "play = 0.004\nlateral_play = 0.004")
    .replace("200000.0", "1e6")
    .replace("mesh_size = 0.3", 'mesh_size = 0.3\ncontact_tolerance = "any"'),
)


def shell_of(folder: Path, text: str) -> BuiltModel:
    case = read_case(folder, text)
    return build(case, build_boom(case), case.models[0], BuildContext(MPI.COMM_WORLD))


def boom_of(folder: Path, text: str) -> Boom:
    return build_boom(read_case(folder, text))


def southwell(built: BuiltModel, tip: str, push: float = 0.0, time: float = 0.0) -> float:
    """Return the buckling factor at a time in s by Southwell's plot (1932) of a deflection.

    It grows with δ/P = δ/P_cr + constant near the critical force, δ being its growth from P = 0.
    ``push`` is a force along ``tip`` in N.
    """
    assert built.shell is not None
    assert built.critical_factor is not None
    loaded, row = built.system.gather_loads(), built.system.observers[tip].row
    system, load = loaded.at_time(time), loaded.load_at(time) + push * row
    added = system.geometric_stiffness if system.geometric_stiffness.size else 0.0
    of_shell = np.pad(built.shell.geometric, (0, system.num_modes - len(built.shell.geometric)))
    parts = np.array([0.0, 0.9, 0.97]) * built.critical_factor
    tips: Sequence[float] = [
        float(
            row
            @ equilibrium(
                replace(system, geometric_stiffness=part * (of_shell + added) - of_shell), load
            )
        )
        for part in parts
    ]
    growth = np.array(tips[1:]) - tips[0]
    return float(np.diff(growth)[0] / np.diff(growth / parts[1:])[0])


@pytest.mark.slow
def test_the_factor_is_that_of_the_growth_of_the_tip(tmp_path: Path) -> None:
    """Reference: the shell's own tip under growing axial forces.

    With bonded joints the factor is twice as large, as that of a beam.
    """
    built = shell_of(tmp_path, HEXAGON)
    assert built.critical_factor == pytest.approx(southwell(built, "tip"), rel=0.01)
    assert built.shell is not None
    assert built.shell.critical_factor is not None
    assert built.critical_factor is not None
    assert built.shell.critical_factor > 1.9 * built.critical_factor
    # The estimate of check and prove, of a beam whose sections distort.
    assert estimate_critical_factor(boom_of(tmp_path, HEXAGON)) == pytest.approx(
        built.critical_factor, rel=0.06
    )


@pytest.mark.slow
def test_the_factor_of_a_hoist_is_that_after_lift_off(tmp_path: Path) -> None:
    """Reference: the shell's own tip under growing axial forces, while the load hangs.

    The factor was 5.46, that of a beam.
    """
    hoist = "hoist = { mass = 8000.0, stiffness = 4e6, travel = 20.0, time = 0.5 }"
    text = HEXAGON.replace("payload = { mass = 6000.0 }", hoist)
    built = shell_of(tmp_path, text.replace("angle = 0.0", "angle = 60.0"))
    assert built.critical_factor == pytest.approx(5.35, rel=1e-3)
    assert built.critical_factor == pytest.approx(southwell(built, "tip", time=0.5), rel=0.01)


@pytest.mark.slow
def test_pads_of_a_column_without_loads_across_it_are_compliant(tmp_path: Path) -> None:
    """Reference: other view, the estimate of a beam; and the shell with bonded joints.

    No load presses the pads. With bonded joints the factor is more than twice as large.
    """
    text = HEXAGON.replace("angle = 0.0", "angle = 90.0")
    built = shell_of(tmp_path, text)
    assert built.critical_factor == pytest.approx(
        estimate_critical_factor(boom_of(tmp_path, text)), rel=0.06
    )
    assert built.shell is not None
    assert built.shell.critical_factor is not None
    assert built.critical_factor is not None
    assert built.shell.critical_factor > 1.9 * built.critical_factor


@pytest.mark.slow
def test_contacts_that_no_load_presses_are_as_compliant(tmp_path: Path) -> None:
    """Reference: the shell's own lateral tip under growing axial forces and a lateral force.

    With rigid lateral contacts the factor is 2 % larger.
    """
    built = shell_of(tmp_path, BOXES)
    expected = southwell(built, "tip_lateral", 100.0)
    assert built.critical_factor == pytest.approx(expected, rel=0.003)


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
