# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling of booms of shells and of their walls, from the case to the report."""

import re
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
from tests.runs.case_texts import CLAMPED, STEEL, as_toml, edited, read_case, shipped, table
from tests.shell_model.booms import box_segment


def segment(name: str, more: str, *sizes: float) -> str:
    keys = dict(zip(("height", "width", "flat", "top", "bottom", "web"), sizes, strict=True))
    section = {"shape": "hexagon", **keys}
    return table("[[segment]]", name=name, length=8.7, section=section) + more


PAD = {"length": 0.25, "width": 0.07, "thickness": 0.020, "bears": "corner"}
# A hexagon whose plates bend under pads on their corners.
HEXAGON = f"""
title = "Hexagon on corner pads"
time = {{ duration = 1.0 }}
gravity = {{ angle = 0.0 }}
start = {{ state = "equilibrium" }}
payload = {{ mass = 6000.0 }}
axial = [{{ force = 200000.0 }}]
{STEEL}
{table("[[model]]", name="shell", kind="shell", mesh_size=0.3)}
{segment("outer", CLAMPED, 0.82, 0.58, 0.39, 0.008, 0.011, 0.007)}
{segment("inner", "", 0.74, 0.50, 0.32, 0.007, 0.009, 0.006)}
[[joint]]
outer = "outer"
inner = "inner"
extension = 7.1
stations = ["tail", "head"]
play = 0.004
pad = {as_toml(PAD)}
"""


# The same boom of thick boxes in space, under 1 MN.
BOXES = re.sub(
    r'"shape": "hexagon", |shape = "hexagon", |flat = .*, web = [0-9.]*',
    lambda found: "flange = 0.02, web = 0.02" if found[0].startswith("flat") else "",
    HEXAGON.replace("play = 0.004", "play = 0.004\nlateral_play = 0.004")
    .replace("200000.0", "1e6")
    .replace("mesh_size = 0.3", 'mesh_size = 0.3\ncontact_tolerance = "any"'),
)


def shell_of(folder: Path, text: str) -> BuiltModel:
    case = read_case(folder, text)
    return build(case, build_boom(case), case.models[0], BuildContext(MPI.COMM_WORLD))


def southwell(built: BuiltModel, tip: str, push: float = 0.0, time: float = 0.0) -> float:
    """Return the buckling factor at a time in s by Southwell's plot (1932) of a deflection.

    It grows with δ/P = δ/P_cr + constant near the critical force, δ being its growth from P = 0.
    ``push`` is a force along ``tip`` in N.
    """
    loaded, row = built.system.gather_loads(), built.system.observers[tip].row
    system, load = loaded.at_time(time), loaded.load_at(time) + push * row
    added = system.geometric_stiffness if system.geometric_stiffness.size else 0.0
    of_shell = np.pad(built.shell.geometric, (0, system.num_modes - len(built.shell.geometric)))
    parts = np.array([0.0, 0.9, 0.97]) * built.critical_factor
    pressed = (part * (of_shell + added) - of_shell for part in parts)
    tips = np.array(
        [row @ equilibrium(replace(system, geometric_stiffness=one), load) for one in pressed]
    )
    growth = tips[1:] - tips[0]
    return float(np.diff(growth)[0] / np.diff(growth / parts[1:])[0])


HOIST = "hoist = { mass = 8000.0, stiffness = 4e6, travel = 20.0, time = 0.5 }"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "tip", "push", "time", "off"),
    [
        # Of a hoist after lift-off, while the load hangs; the factor was that of a beam.
        (edited(HEXAGON, ("payload = { mass = 6000.0 }", HOIST), ("angle = 0.0", "angle = 60.0")),
         "tip", 0.0, 0.5, 0.01),
        # Contacts that no load presses are as compliant: rigid ones raise the factor by 2 %.
        (BOXES, "tip_lateral", 100.0, 0.0, 0.003),
    ],
    ids=["hoist", "not pressed"],
)  # fmt: skip
def test_the_factor_is_that_of_the_growth_of_the_tip(
    tmp_path: Path, text: str, tip: str, push: float, time: float, off: float
) -> None:
    """Reference: the shell's own tip under growing axial forces, and a lateral force."""
    built = shell_of(tmp_path, text)
    assert built.critical_factor == pytest.approx(southwell(built, tip, push, time), rel=off)


@pytest.mark.slow
@pytest.mark.parametrize("angle", [0.0, 90.0])
def test_pads_are_compliant_with_and_without_loads_across(tmp_path: Path, angle: float) -> None:
    """Reference: other view, the estimate of a beam whose sections distort; the shell with bonded
    joints, whose factor is about twice as large; with loads across, its growing tip.
    """
    text = HEXAGON.replace("angle = 0.0", f"angle = {angle}")
    built = shell_of(tmp_path, text)
    estimate = estimate_critical_factor(build_boom(read_case(tmp_path, text)))
    assert built.critical_factor == pytest.approx(estimate, rel=0.06)
    assert built.shell.critical_factor > 1.9 * built.critical_factor
    if angle == 0.0:
        assert built.critical_factor == pytest.approx(southwell(built, "tip"), rel=0.01)


def run(name: str, duration: float, modes: int) -> Results:
    """Return the results of a shipped case with a shell of few triangles, and a beam."""
    shell = Shell(name="shell", kind="shell", mesh_size=0.3, contact_tolerance="any")
    case = select(shipped(name), "", ["timoshenko"])
    more = {
        "models": (*case.models, shell),
        "buckling": BucklingTable(modes=modes),
        "statements": (),
    }
    return run_case(change(case.model_copy(update=more), **{"time.duration": duration}))


def panels(results: Results, model: str) -> list[float]:
    """Return the lowest factor of each segment by panel formulas."""
    rows = results.rows.where(model=model, state=FARTHEST)
    return [row.value for row in weakest_plates(rows)]


@pytest.mark.slow
def test_a_run_has_factors_of_shell_and_panels() -> None:
    """Reference: other code, panel formulas, below the shell with its restrained folds."""
    results = run("coarse", 0.01, 2)
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
    results = run("drawn-out", 0.05, 1)
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
    places = with_locations("box", found)
    for same in (places.walls, places.x):
        assert same[0] == same[1]


def test_a_case_without_the_table_has_none() -> None:
    results = run_case(shipped("coarse"), models=["timoshenko"])
    assert not buckling_table(results).rows
    assert not results.rows.where(quantity="plate_buckling")
