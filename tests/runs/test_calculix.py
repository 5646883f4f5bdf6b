# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells of booms at rest as decks for CalculiX."""

from __future__ import annotations

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import protractile as pt
from dynamics.equilibrium import equilibrium_at
from runs.case import reading
from runs.case.build import build_boom
from runs.case.kinds.model import BuildContext
from runs.case.messages import BadInput
from runs.pipeline.models import build

pytest.importorskip("dolfinx", reason="shells need FEniCSx")

from mpi4py import MPI

from runs.report.calculix import deck, write
from shell_model.buckling import buckling_modes
from shell_model.stress.fields import gather_stress_modes
from studies.reference_models.single_segment import at_rest
from studies.wall_buckling import COLUMN, LoadedBox

INSTALLED = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX is missing: apt install calculix-ccx"
)


def readings(deck: Path) -> dict[str, float]:
    """Run a deck, and return the displacements of its readings by their comments."""
    subprocess.run(["ccx", deck.stem], cwd=deck.parent, check=True, capture_output=True)
    lines = deck.with_suffix(".dat").read_text("utf-8").splitlines()[3:]
    found = [float(line.split()[1]) for line in lines if line.strip()]
    names = [line[3:] for line in deck.read_text("utf-8").splitlines() if line.startswith("** ")]
    return dict(zip(names[1:], found, strict=True))


@INSTALLED
@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "size", "changed", "tolerance"),
    [
        # Between webs there is no bending of walls.
        ("coarse", None, {}, 1e-4),
        # Pads on flanges, a cylinder, three segments; level, so that no axial force softens it.
        ("lift", 0.06, {"gravity.angle": 0.0}, 0.01),
    ],
)
def test_a_boom_rests_in_calculix_as_here(
    tmp_path: Path, name: str, size: float | None, changed: dict[str, float], tolerance: float
) -> None:
    """Reference: other code, CalculiX, its elements on the same mesh, from the state of contact."""
    case = pt.change(pt.load_case(pt.CASES / f"{name}.toml"), **changed)
    case = reading.select(case, "", ["shell"], size)
    deck = tmp_path / "boom.inp"
    write(case, "", MPI.COMM_SELF, deck, None)
    found = readings(deck)
    system = build(case, build_boom(case), case.models[0], BuildContext(MPI.COMM_SELF)).system
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


def buckled(box: LoadedBox, count: int, folder: Path) -> tuple[list[float], list[float]]:
    """Return the lowest factors of a box, pressed at its ends, by our shell and by CalculiX."""
    shell = box.supported(8)
    ends = [shell.row(shell.outline(x).mean_displacement(0)) for x in (0.0, box.length)]
    load = box.compression * box.section.area * (ends[0] - ends[1])
    stresses = gather_stress_modes(shell, at_rest(shell, load[:, None]))
    assert stresses is not None
    assert shell.mesh is not None
    forces = shell.mesh.thickness[:, None] * stresses[0, :, :3].astype(float)
    text = deck(box.name, [shell], [], [load], f"*BUCKLE\n{count}")
    (folder / "box.inp").write_text(text, "utf-8")
    subprocess.run(["ccx", "box"], cwd=folder, check=True, capture_output=True)
    found = re.findall(r"^ +\d+ +(\d\.\d+E[+-]\d+)$", (folder / "box.dat").read_text(), re.M)
    return buckling_modes(shell, forces, count).factors.tolist(), sorted(map(float, found))


@INSTALLED
@pytest.mark.slow
def test_a_column_buckles_in_calculix_as_here(tmp_path: Path) -> None:
    """Reference: other code, CalculiX, linear buckling under its own stresses on the same mesh.

    The first factor is the column's, which bends both ways; the next one that of its walls.
    """
    (column, other, walls), found = buckled(COLUMN, 3, tmp_path)
    assert other == pytest.approx(column, rel=1e-6)
    assert found[0] == pytest.approx(column, rel=1e-4)
    # Its search may leave out one of the two equal factors.
    assert next(f for f in found if f > 1.01 * column) == pytest.approx(walls, rel=0.01)


@INSTALLED
@pytest.mark.slow
def test_walls_of_a_stub_buckle_in_calculix_as_here(tmp_path: Path) -> None:
    """Reference: other code, as above; three modes of walls, under stresses uneven at the ends."""
    ours, found = buckled(replace(COLUMN, length=0.9), 3, tmp_path)
    assert found == pytest.approx(ours, rel=5e-3)


def test_what_calculix_would_not_have_is_refused(tmp_path: Path) -> None:
    case = pt.load_case(pt.CASES / "spatial.toml")
    with pytest.raises(BadInput) as error:
        write(case, "case.toml", MPI.COMM_SELF, tmp_path / "x.inp", None)
    assert str(error.value) == (
        "case.toml: joint.lateral_play: cannot be exported to CalculiX, for which one process "
        "writes a flat boom, with no load on a rope; leave it out"
    )
    beams = reading.select(case, "", ["beam-fe"])
    with pytest.raises(BadInput) as error:
        write(beams, "case.toml", MPI.COMM_SELF, tmp_path / "x.inp", None)
    assert str(error.value) == "case.toml: --model: must be a shell, and there is none"
