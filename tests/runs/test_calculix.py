# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells of booms at rest as decks for CalculiX."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import protractile as pt
from protractile.dynamics.equilibrium import equilibrium_at
from protractile.geometry.arrays import Array
from protractile.runs.case import reading
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.models import build
from studies.reference_models.statics import static_response

pytest.importorskip("dolfinx", reason="shells need FEniCSx")

from mpi4py import MPI

from protractile.runs.export.calculix import SpringRow, deck, write
from protractile.shell_model.boom_shell import ShellOptions, segment_mesh
from protractile.shell_model.buckling import buckling_modes
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.segment.segment_shell import assemble_segment
from studies.wall_buckling import BOXES, CALCULIX, COLUMN, LoadedBox
from tests.runs.case_texts import refused, shipped
from tests.shell_model.test_cylinder import column

INSTALLED = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX is missing: apt install calculix-ccx"
)


def readings(deck: Path) -> dict[str, float]:
    """Run a deck, and return the displacements of its output nodes, keyed by their comments."""
    subprocess.run(["ccx", deck.stem], cwd=deck.parent, check=True, capture_output=True)
    lines = deck.with_suffix(".dat").read_text("utf-8").splitlines()[3:]
    found = [float(line.split()[1]) for line in lines if line.strip()]
    names = [line[3:] for line in deck.read_text("utf-8").splitlines() if line.startswith("** ")]
    return dict(zip(names[1:], found, strict=True))


@INSTALLED
@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "size", "tolerance"),
    [
        # Between webs there is no bending of walls.
        ("coarse", None, 1e-4),
        # Pads on flanges, a cylinder, three segments; axial forces add 1.5 % to the tip.
        ("lift", 0.06, 0.01),
    ],
)
def test_a_boom_rests_in_calculix_as_here(
    tmp_path: Path, name: str, size: float | None, tolerance: float
) -> None:
    """Reference: other code, CalculiX's own elements, same mesh and contact state."""
    case = reading.select(shipped(name), "", ["shell"], size)
    deck, cache = tmp_path / "boom.inp", Cache(tmp_path / "cache")
    write(case, "", MPI.COMM_SELF, deck, cache)
    found = readings(deck)
    context = BuildContext(MPI.COMM_SELF, cache=cache)
    system = build(case, build_boom(case), case.models[0], context).system
    rest = equilibrium_at(system)
    tip = system.observers["tip"].row @ rest
    assert found["tip"] == pytest.approx(tip, rel=tolerance)
    gaps = system.rows @ rest
    for law, gap in zip(system.laws, gaps, strict=True):
        force, slope = (float(f(np.array([gap]))[0]) for f in (law.force, law.slope))
        if force != 0.0:
            # The program prints seven digits of the gap, which are 1e-3 of the smallest force.
            change = slope * (found[f"contact that presses with {force:.6g} N"] - gap)
            assert abs(change) < max(tolerance, 1e-3) * abs(force)
    if cylinders := build_boom(case).cylinders:
        (cylinder,) = cylinders
        expected = system.observers["cylinder_force"].row @ rest
        assert -cylinder.stiffness * found["cylinder_force"] == pytest.approx(expected, rel=1e-3)


@INSTALLED
@pytest.mark.slow
def test_axial_force_softens_a_boom_as_large_displacements_do_in_calculix(tmp_path: Path) -> None:
    """Reference: other code, CalculiX with NLGEOM, 40 % of Euler's force, which adds 64 %."""
    boom, options = column(0.4), ShellOptions(mesh_size=0.2)
    (arm,) = boom.segments
    shell = assemble_segment(MPI.COMM_SELF, arm, segment_mesh(boom, 0, options))
    end, (thrust,) = shell.outline(arm.end), arm.compression(np.array([arm.end - 1e-3]))
    load = shell.own_load(("z",)) - thrust * shell.row(end.mean_displacement(0))
    tip = SpringRow("tip", {0: shell.row(end.mean_deflection())})
    text = deck("column", [shell], [tip], [load])
    found = []
    for name, step in (("linear", "*STEP"), ("large", "*STEP, NLGEOM")):
        path = tmp_path / f"{name}.inp"
        path.write_text(text.replace("*STEP\n", f"{step}\n"), "utf-8")
        found.append(readings(path)["tip"])
    system = reduce_boom(boom, options, MPI.COMM_SELF).system
    ours = system.observers["tip"].row @ static_response(system, system.load)
    assert found[1] == pytest.approx(ours, rel=1e-3)
    assert found[1] / found[0] > 1.6


def factors(folder: Path, box: LoadedBox, n: int, count: int) -> tuple[list[float], Array]:
    """Return buckling factors of CalculiX and ours; n edges across a wall, factors from 1 to 10."""
    shell, load, forces = box.pressed(n)
    # With one factor more, the iteration of CalculiX does not miss one of two equal factors.
    text = deck(box.name, [shell], [], [load], f"*BUCKLE\n{count + 1}")
    (folder / "box.inp").write_text(text, "utf-8")
    subprocess.run(["ccx", "box"], cwd=folder, check=True, capture_output=True)
    found = re.findall(r"^ +\d+ +(\d\.\d+E[+-]\d+)$", (folder / "box.dat").read_text(), re.M)
    return sorted(map(float, found))[:count], buckling_modes(shell, forces, count).factors


@INSTALLED
@pytest.mark.slow
@pytest.mark.parametrize(
    ("box", "n", "tolerance"),
    [
        # A column, which bends in two directions at equal factors.
        (COLUMN._replace(compression=5.0e8), 2, 1e-4),
        # Walls of a tube, b/t = 100.
        (BOXES[0]._replace(length=0.6, compression=4.0e7), 16, 1e-3),
    ],
    ids=["column", "walls"],
)
def test_boxes_buckle_in_calculix_as_here(
    tmp_path: Path, box: LoadedBox, n: int, tolerance: float
) -> None:
    """Reference: other code, linear buckling by CalculiX on the same mesh."""
    found, ours = factors(tmp_path, box, n, 2)
    assert found == pytest.approx(ours, rel=tolerance)


@INSTALLED
@pytest.mark.slow
def test_documented_factor_of_calculix(tmp_path: Path) -> None:
    """Reference: non-regression, the factor that the study shows."""
    box = BOXES[0]._replace(compression=4.0e7)
    (found, _), _ = factors(tmp_path, box, 8, 2)
    documented = CALCULIX[0][1][8] * BOXES[0].compression / box.compression
    assert found == pytest.approx(documented, rel=1e-5)


def test_unsupported_cases_are_refused(tmp_path: Path) -> None:
    case = pt.load_case(pt.CASES / "spatial.toml")
    with refused(
        "case.toml: joint.lateral_play: cannot be exported to CalculiX, for which one process "
        "writes a flat boom, with no load on a rope; leave it out"
    ):
        write(case, "case.toml", MPI.COMM_SELF, tmp_path / "x.inp", None)
    beams = reading.select(case, "", ["beam-fe"])
    with refused("case.toml: --model: must be a shell, and there is none"):
        write(beams, "case.toml", MPI.COMM_SELF, tmp_path / "x.inp", None)
