# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms for other programs: OpenSees and CalculiX."""

import re
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="shells need FEniCSx")

from mpi4py import MPI

import protractile as pt
from protractile.dynamics.equilibrium import equilibrium_at
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.export import calculix, opensees
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.models import build
from protractile.shell_model.boom_shell import ShellOptions, segment_mesh
from protractile.shell_model.buckling import buckling_modes
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.segment.segment_shell import assemble_segment
from studies.calibrated_beams import calibrated_beam
from studies.motions import friction_case, model_of, with_pads
from studies.reference_models.statics import static_response
from studies.wall_buckling import BOXES, COLUMN, LoadedBox
from tests.other_codes import INSTALLED, run_elsewhere
from tests.runs.case_texts import elements, read_case, refused, shipped, table
from tests.runs.summaries import motion_of, static_tip
from tests.shell_model.test_cylinder import column

# A load that grows, a weight, a spring: what the paper's boom does not have.
MORE = "".join(
    table("[[load]]", segment="inner", **keys)
    for keys in (
        {"x": 14.0, "magnitude": 300.0, "ramp": 0.2},
        {"from": 11.0, "to": 13.5, "magnitude": 40.0},
    )
)
CONTACT = {"stiffness": 1e9, "exponent": 1.0}
MODEL = elements("timoshenko", theory="timoshenko", contact=CONTACT)


def run(script: Path, *arguments: str) -> float:
    told = run_elsewhere(str(script), *arguments, folder=script.parent)
    found = re.search(r": ([-\d.e]+) m", told)
    assert found is not None, told
    return float(found[1])


def boom_with_more(folder: Path) -> pt.Case:
    text = (pt.CASES / "friction-walk.toml").read_text(encoding="utf-8")
    heavier = text.replace(
        "supports = [0.0, 2.0]", "supports = [0.0, { x = 2.0, stiffness = 5e7 }]"
    )
    boom, _, _ = heavier.replace("[[joint]]", f"{MORE}\n[[joint]]", 1).partition("[[model]]")
    boom = re.sub(r"\b(load|magnitude) = (\d)", r"\1 = -\2", boom)
    return read_case(folder, boom + MODEL)


def exported(case: pt.Case, folder: Path, comm: Any = None, cache: Any = None) -> Path:
    opensees.write(case, "", comm, folder / "boom.py", cache)
    return folder / "boom.py"


@INSTALLED
@pytest.mark.slow
def test_a_beam_rests_and_peaks_elsewhere_as_here(tmp_path: Path) -> None:
    """Reference: other code, OpenSees with its elements, Newton's method and TR-BDF2; downwards."""
    case = pt.change(boom_with_more(tmp_path), **{"time.duration": 0.8})
    script = exported(case, tmp_path)
    assert run(script, "--static") == pytest.approx(static_tip(case), rel=1e-6)
    tip = motion_of(case).data["tip"].values
    assert 500 < tip.argmin() < 790
    peak = run(script, "--duration", "0.8", "--step", "2e-4")
    assert peak == pytest.approx(tip.min(), rel=2e-3)


@INSTALLED
@pytest.mark.slow
def test_lift_rests_on_its_cylinder_in_opensees_as_here(tmp_path: Path) -> None:
    """Reference: other code, OpenSees with a truss as the cylinder of the level lift."""
    level = {"gravity.angle": 0.0, "damping.modal": 0.0, "start.state": "rest"}
    case = case_file.select(pt.change(shipped("lift"), **level), "", ["timoshenko"])
    found = run(exported(case, tmp_path), "--static")
    assert found == pytest.approx(static_tip(case), rel=1e-6)


@INSTALLED
@pytest.mark.slow
def test_a_calibrated_beam_rests_elsewhere_on_its_springs(tmp_path: Path) -> None:
    """Reference: other code, OpenSees. Coupling of springs is less than a thousandth."""
    case = with_pads(friction_case(), 0.1, 0.06)
    shell = model_of(case, "shell").model_copy(update={"mesh_size": 0.5})
    model = calibrated_beam(case, shell, fields=False)
    plain = case.model_copy(update={"models": (model_of(friction_case(), "timoshenko"),)})
    case = case.model_copy(update={"models": (model,)})
    cache = Cache(tmp_path / "cache")
    script = exported(case, tmp_path, MPI.COMM_SELF, cache)
    rest = static_tip(case, tools=BuildContext(MPI.COMM_SELF, cache=cache))
    # Both press at the midpoints of the pads; springs alone lower the tip, by 5 %.
    assert rest > 1.04 * static_tip(plain)
    assert run(script, "--static") == pytest.approx(rest, rel=1e-3)


def test_points_follow_a_law_behind_its_spring() -> None:
    """Reference: analytic, y = Δ + (F/k)^(1/n) + F/K."""
    law = pt.PowerContact(1.0e9, 1.5).with_clearance(0.007).one_sided(-1)
    approaches, forces = np.array(opensees._points(law, 1.0 / 2.0e7))
    pressed = forces < 0.0
    assert (np.diff(approaches) > 0.0).all()
    assert forces.min() == pytest.approx(-1.0e7, rel=0.5)
    expected = 0.007 + (-forces[pressed] / 1.0e9) ** (1.0 / 1.5) - forces[pressed] / 2.0e7
    np.testing.assert_allclose(-approaches[pressed], expected, rtol=1e-9)


CALCULIX_INSTALLED = pytest.mark.skipif(
    shutil.which("ccx") is None, reason="CalculiX is missing: apt install calculix-ccx"
)


def readings(deck: Path) -> dict[str, float]:
    """Run a deck, and return the displacements of its output nodes, keyed by their comments."""
    subprocess.run(["ccx", deck.stem], cwd=deck.parent, check=True, capture_output=True)
    lines = deck.with_suffix(".dat").read_text("utf-8").splitlines()[3:]
    found = [float(line.split()[1]) for line in lines if line.strip()]
    names = [line[3:] for line in deck.read_text("utf-8").splitlines() if line.startswith("** ")]
    return dict(zip(names[1:], found, strict=True))


@CALCULIX_INSTALLED
@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "size", "tolerance"),
    [
        # Between webs there is no bending of walls.
        ("coarse", None, 1e-4),
        # Pads on flanges, a cylinder, three segments; axial forces add 1.5 % to the tip.
        ("lift", 0.07, 0.01),
    ],
)
def test_a_boom_rests_in_calculix_as_here(
    tmp_path: Path, name: str, size: float | None, tolerance: float
) -> None:
    """Reference: other code, CalculiX's own elements, same mesh and contact state."""
    case = case_file.select(shipped(name), "", ["shell"], size)
    deck, cache = tmp_path / "boom.inp", Cache(tmp_path / "cache")
    calculix.write(case, "", MPI.COMM_SELF, deck, cache)
    found = readings(deck)
    context = BuildContext(MPI.COMM_SELF, cache=cache)
    system = build(case, build_boom(case), case.models[0], context).system
    rest = equilibrium_at(system)
    assert found["tip"] == pytest.approx(system.observers["tip"].row @ rest, rel=tolerance)
    for law, gap in zip(system.laws, system.rows @ rest, strict=True):
        force, slope = (float(f(np.array([gap]))[0]) for f in (law.force, law.slope))
        if force != 0.0:
            # The program prints seven digits of the gap, which are 1e-3 of the smallest force.
            change = slope * (found[f"contact that presses with {force:.6g} N"] - gap)
            assert abs(change) < max(tolerance, 1e-3) * abs(force)
    for cylinder in build_boom(case).cylinders:
        expected = system.observers["cylinder_force"].row @ rest
        assert -cylinder.stiffness * found["cylinder_force"] == pytest.approx(expected, rel=1e-3)


@CALCULIX_INSTALLED
@pytest.mark.slow
def test_axial_force_softens_a_boom_as_large_displacements_do_in_calculix(tmp_path: Path) -> None:
    """Reference: other code, CalculiX with NLGEOM, 40 % of Euler's force, which adds 64 %."""
    boom, options = column(0.4), ShellOptions(mesh_size=0.4)
    (arm,) = boom.segments
    shell = assemble_segment(MPI.COMM_SELF, arm, segment_mesh(boom, 0, options))
    end, (thrust,) = shell.outline(arm.end), arm.compression(np.array([arm.end - 1e-3]))
    load = shell.own_load(("z",)) - thrust * shell.row(end.mean_displacement(0))
    tip = calculix.SpringRow("tip", {0: shell.row(end.mean_deflection())})
    text = calculix.deck("column", [shell], [tip], [load])
    found = []
    for name, step in (("linear", "*STEP"), ("large", "*STEP, NLGEOM")):
        path = tmp_path / f"{name}.inp"
        path.write_text(text.replace("*STEP\n", f"{step}\n"), "utf-8")
        found.append(readings(path)["tip"])
    system = reduce_boom(boom, options, MPI.COMM_SELF).system
    ours = system.observers["tip"].row @ static_response(system, system.load)
    assert found[1] == pytest.approx(ours, rel=1e-3)
    assert found[1] / found[0] > 1.6


@CALCULIX_INSTALLED
@pytest.mark.slow
@pytest.mark.parametrize(
    ("box", "n", "count", "tolerance"),
    [
        # A column, which bends in two directions at equal factors.
        (COLUMN._replace(compression=5.0e8), 2, 2, 1e-4),
        # Walls of a tube, b/t = 100, as long as wide.
        (BOXES[0]._replace(length=0.2, compression=4.0e7), 16, 1, 1e-3),
    ],
    ids=["column", "walls"],
)
def test_boxes_buckle_in_calculix_as_here(
    tmp_path: Path, box: LoadedBox, n: int, count: int, tolerance: float
) -> None:
    """Reference: other code, linear buckling by CalculiX on the same mesh."""
    shell, load, forces = box.pressed(n)
    # With one factor more, the iteration of CalculiX does not miss one of two equal factors.
    text = calculix.deck(box.name, [shell], [], [load], "*BUCKLE\n3")
    (tmp_path / "box.inp").write_text(text, "utf-8")
    subprocess.run(["ccx", "box"], cwd=tmp_path, check=True, capture_output=True)
    lines = (tmp_path / "box.dat").read_text()
    found = sorted(map(float, re.findall(r"^ +\d+ +(\d\.\d+E[+-]\d+)$", lines, re.M)))[:count]
    own = buckling_modes(shell, forces, 2).factors[:count]
    assert found == pytest.approx(own, rel=tolerance)


@pytest.mark.parametrize(
    ("write", "bound", "model", "none"),
    [
        (opensees.write, "OpenSees, for which a boom must be flat and undamped, start from rest, "
         "and have friction under given normal_forces only", "kantorovich-24",
         "beam elements with play, and there are none"),
        (calculix.write, "CalculiX, for which one process writes a flat boom, with no load on a "
         "rope", "beam-fe", "a shell, and there is none"),
    ],
)  # fmt: skip
def test_unsupported_cases_are_refused(
    tmp_path: Path, write: Callable[..., None], bound: str, model: str, none: str
) -> None:
    case, rest = shipped("spatial"), (MPI.COMM_SELF, tmp_path / "x", None)
    with refused(f"case.toml: joint.lateral_play: cannot be exported to {bound}; leave it out"):
        write(case, "case.toml", *rest)
    with refused(f"case.toml: --model: must be {none}"):
        write(case_file.select(case, "", [model]), "case.toml", *rest)
