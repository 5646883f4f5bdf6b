# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells as calibration of beams: cards, motions, weights, stored stresses, reduction errors."""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import numpy as np
import pytest
import xarray as xr

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

import protractile as pt
from protractile.beam_model.calibration import Calibration, Stiffness, elastic_compliance
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.statics import Elements
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import SlidePad
from protractile.geometry.section import EACH_SIDE
from protractile.runs.case import reading as case_file
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.model_output import ShellOutput
from protractile.runs.pipeline.model_run import RunContext, calibration_card
from protractile.runs.pipeline.models import build
from protractile.runs.pipeline.run import run_case as run_models
from protractile.runs.report.additions import Addition
from protractile.runs.report.output import write
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import ReducedShell, reduce_boom
from protractile.shell_model.standard import standard_boom, with_plays_and_loads
from studies.motions import friction_case, move
from studies.working_load import Point, set_point
from tests.runs.case_texts import COARSE, STEEL, box, elements, joint, read_case, shipped, table
from tests.runs.summaries import finished
from tests.shell_model.booms import LATERAL_LAW, LAW, boom_in_space
from tests.touching import touching

CONTACT = {"contact": {"stiffness": 1e9, "exponent": 1.0}}
CALIBRATED_BY = {"calibrated_by": "shell"} | CONTACT
LONG_SERIES = {"kind": "kantorovich", "terms": [12, 12], "base": "complete"}
CALIBRATED = (
    table("[[model]]", name="series", **LONG_SERIES, **CONTACT)
    + elements("sprung", **CALIBRATED_BY)
    + elements("fielded", section_fields=True, **CALIBRATED_BY)
    + table("[[model]]", name="sprung-series", **LONG_SERIES, **CALIBRATED_BY)
)
# What rubs makes motions comparable pointwise.
RUBBING = COARSE.replace(
    "exponent = 2.0\n", "exponent = 2.0\nfriction = 0.2\nnormal_forces = [4500.0, 5000.0]\n", 1
)


@pytest.fixture(scope="module")
def rubbing_case(tmp_path_factory: pytest.TempPathFactory) -> pt.Case:
    return read_case(tmp_path_factory.mktemp("case"), RUBBING + CALIBRATED)


@pytest.mark.slow
def test_a_calibrated_beam_gives_way_and_moves_as_the_shell(
    rubbing_case: pt.Case, tmp_path: Path
) -> None:
    """Reference: other code, the static compliance of the shell at contact and friction rows, and
    its tip at a small play and ten times the load. Textbook beams err much more.
    """
    boom, tools = build_boom(rubbing_case), BuildContext(MPI.COMM_SELF, cache=Cache(tmp_path))
    calibrated = {"sprung": 1e-3, "fielded": 1e-9, "sprung-series": 1e-3}
    names = ("shell", *calibrated, "timoshenko", "series")
    models = {model.name: model for model in rubbing_case.models}
    built = {name: build(rubbing_case, boom, models[name], tools) for name in names}
    # All read one entry of the cache.
    assert "reduction" in built["shell"].seconds
    assert all("cache" in built[name].seconds for name in calibrated)
    shell = elastic_compliance(built["shell"].system)
    sizes = np.sqrt(np.outer(np.diag(shell), np.diag(shell)))
    for name, within in calibrated.items():
        off = elastic_compliance(built[name].system) - shell
        assert np.abs(off / sizes).max() < within, name
    points = {n: set_point(b.system, Point(play=4.0e-3, load=10.0)) for n, b in built.items()}
    tips = {name: move(point, 1.0).data["tip"].values for name, point in points.items()}
    exact = tips["shell"]
    errors = {name: np.abs(tip - exact).max() / np.ptp(exact) for name, tip in tips.items()}
    assert errors["sprung"] < 0.012, errors
    assert errors["timoshenko"] > 2.5 * errors["sprung"], errors
    assert errors["fielded"] < 1e-3, errors
    assert errors["series"] > 1.5 * errors["sprung-series"], errors


def test_a_case_without_its_shell_still_has_it(rubbing_case: pt.Case, tmp_path: Path) -> None:
    """Reference: the table of the named shell, after writing and reading the case."""
    alone = case_file.select(rubbing_case, "", ["sprung"], 0.5)
    (model,) = alone.models
    assert model.needs_shell
    (read,) = read_case(tmp_path, toml.dumps(alone)).models
    shell = read.model_dump()["calibrated_by"]
    assert (shell["name"], shell["mesh_size"]) == ("shell", 0.5)
    assert isinstance(read.calibrated_by, pt.Shell)


@pytest.mark.usefixtures("few_figures")
def test_a_run_leaves_its_card(rubbing_case: pt.Case, tmp_path: Path) -> None:
    """Reference: non-regression, the calibration in the summary."""
    alone = case_file.select(rubbing_case, "", ["sprung"])
    run = run_models(alone, "", RunContext(MPI.COMM_SELF))
    run.evaluate()
    write(run, Addition(), tmp_path)
    told = json.loads((tmp_path / "calibration.json").read_text(encoding="utf-8"))
    summary = run.results.summary.models["sprung"].calibration
    assert told == {"sprung": summary.model_dump()}
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Local springs of the stations, for sprung" in report
    assert "Equivalent beam stiffnesses of the segments, for sprung" in report


# At 50 degrees, its pin 0.35 m below the axis.
RAISED = f"""
title = "A boom of one segment"
time = {{ duration = 0.1 }}
model = [{{ name = "shell", kind = "shell", mesh_size = 0.4, contact_tolerance = "any" }}]
{table("[gravity]", angle=50.0)}
{STEEL.replace("7850.0", "1600.0")}
{box("base", (0.0, 10.0), (0.6, 0.4, 0.025, 0.025), "supports = [{ x = 0.0, depth = 0.35 }]")}
{table("[payload]", mass=400.0)}
{table("[[load]]", segment="base", x=8.0, magnitude=-3000.0)}
{table("[[cylinder]]", segment="base", x=2.6, depth=0.3, ground=[0.9, -1.3], stiffness=1e9)}
"""


def test_axial_forces_turn_a_shared_shell_about_its_lowered_pin(tmp_path: Path) -> None:
    """Reference: analytic, moments about the pin of 80 kg/m, 400 kg and 3 kN: 55.89 kN."""
    case = read_case(tmp_path, RAISED)
    boom = build_boom(case)
    assert boom.segments[0].mass_per_length == pytest.approx(80.0)
    system = build(case, boom, case.models[0], BuildContext(MPI.COMM_SELF)).system.gather_loads()
    force = system.observers["cylinder_force"].row @ equilibrium(system, system.load)
    assert force == pytest.approx(55.89e3, rel=1e-3)


@pytest.mark.slow
def test_stresses_are_stored_beside_every_contact_and_support() -> None:
    """Reference: the boom. Supports, masses, a lug, stations, a stop inside the overlap, loads."""
    stop = pt.Stop(1, 9.5, 0.04, pt.PowerContact(1.0e9, 1.0).upper())
    cylinder = pt.Cylinder(0, x=4.0, depth=0.25, ground=(1.0, -4.25), stiffness=1.0e7)
    boom = boom_in_space()
    outer = replace(boom.segments[0], masses=(pt.PointMass(4.0, 50.0),))
    pushes = tuple(pt.Load(1, "z", size, 19.0, pt.Step()) for size in (-2.0, 5.0, 7.0))
    parts = {"stops": (stop,), "cylinders": (cylinder,), "loads": pushes}
    boom = replace(boom, segments=(outer, boom.segments[1]), **parts)
    shell = reduce_boom(touching(boom, LAW, LATERAL_LAW), ShellOptions(0.5), MPI.COMM_SELF)
    data = xr.Dataset(coords={"time": [0.0, 1.0]})
    still = pt.Trajectory(data, np.zeros((2, shell.system.omega2.size)))
    left = ShellOutput.of(boom, "shell", shell, still)
    assert left.stresses["place"].values.tolist() == [0.0, 2.0, 4.0, 9.0, 9.5, 10.0, 19.0]
    assert left.largest.von_mises == 0.0
    moved = np.tensordot(left.modes["state"].values, left.modes["modes"].values, axes=1)
    np.testing.assert_allclose(np.linalg.norm(moved, axis=2).max(axis=1), 1.0, rtol=1e-5)
    assert set(left.meshes) == {"outer", "inner"}


@dataclass(frozen=True)
class Shared:
    """The parts of a reduced shell that plays and loads change, here of beams."""

    system: GapSystem
    own_loads: Array


def test_a_shared_shell_gets_the_plays_of_its_joints() -> None:
    """Reference: the boom itself. Of two joints, the first has pads with shims, which stay."""
    boom = touching(build_boom(shipped("three-segments")), pt.PowerContact(1.0e9, 1.0))
    pads = tuple(
        SlidePad(0.1, 0.03, side=side, thickness=0.02, shim=0.001) for side in ("above", "below")
    )
    first, second = boom.joints
    boom = replace(boom, joints=(replace(first, pad=None, pads=pads), second), loads=())

    def system(boom: pt.Boom) -> GapSystem:
        return gap_system(boom, Elements(boom).segments, EACH_SIDE)

    shared = system(standard_boom(boom))
    loads = np.zeros((len(boom.segments), shared.num_modes))
    shell = cast(ReducedShell, Shared(shared, loads))
    found, expected = with_plays_and_loads(shell, boom).system.laws, system(boom).laws
    onsets = [[law.terms[0].onset for law in laws] for laws in (found, expected)]
    assert onsets[0] == pytest.approx(onsets[1])
    assert onsets[1] == pytest.approx(4 * [0.5 * first.play - 0.001] + 4 * [0.5 * second.play])


def test_card_has_stiffness_and_springs() -> None:
    """Reference: analytic, 1/D of a diagonal residual compliance, and given factors."""
    boom = build_boom(friction_case())
    law = pt.PowerContact(1.0e9, 1.0).with_clearance(0.007)
    models = finite_element_segments(boom, 2.0, "timoshenko", True)
    system = gap_system(touching(boom, law, ()), models, EACH_SIDE)
    residual = np.diag([2.0e-9, 4.0e-9, 5.0e-9, -1.0e-12, 1.0e-9, 1.0e-9])
    stiffness = [
        Stiffness((1.01 * segment.bending_stiffness,), (0.9 * (segment.shear_stiffness or 0.0),))
        for segment in boom.segments
    ]
    told = calibration_card(boom, system, Calibration(stiffness, residual))
    places = [(x, side) for x in (9.0, 10.0) for side in ("top", "bottom")]
    assert [(spring.x, spring.side) for spring in told.springs] == places
    assert told.springs[3].stiffness is None
    springs = [spring.stiffness for spring in told.springs[:3]]
    assert springs == pytest.approx([5.0e8, 2.5e8, 2.0e8], rel=1e-12)
    for segment in told.segments:
        assert (*segment.bending_part, *segment.shear_part) == pytest.approx((1.01, 0.9), rel=1e-12)
        assert segment.torsion is None


SUPPORTS = "supports = [0.0, 1.4]\nload = 880.0"
RUBBING_JOINT = "friction = 0.2\nnormal_forces = [4500.0, 5000.0]"
RUBBING_SHELLS = f"""
title = "Rubbing"
{table("[time]", duration=2.0, step=5.0e-5)}
{STEEL}
{box("outer", (0.0, 8.0), (0.42, 0.40, 0.008, 0.005), SUPPORTS)}
{box("inner", (6.6, 14.5), (0.39, 0.35, 0.006, 0.0045), "load = 620.0")}
{joint("inner", "outer", 0.01, (6.6, 8.0), RUBBING_JOINT)}
"""


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.0, 0.01])
def test_the_error_of_a_motion_by_the_reduction_is_estimated(tmp_path: Path, ratio: float) -> None:
    """Reference: the same shell with a tolerance of 1e-8, and exact words.

    Without damping, friction depends on vibrations of plates above 50 Hz. The error of 4 % of the
    tip's range is estimated within a factor of 2.5, and told. Damping leaves less than 0.3 %.
    """
    keys = {"kind": "shell", "mesh_size": 0.4, "contact_tolerance": "any"}
    models = [table("[[model]]", name=f"shell-{x:g}", tolerance=x, **keys) for x in (5e-4, 1e-8)]
    damping = table("[damping]", modal=ratio) if ratio else ""
    case = read_case(tmp_path, "\n".join([RUBBING_SHELLS, *models, damping]))
    run = finished(case, RunContext(MPI.COMM_WORLD, cache=Cache.of_user()))
    tips = run.results.trajectories["tip"]
    coarse, exact = (tips.sel(model=f"shell-{x}").values for x in ("0.0005", "1e-08"))
    error = float(np.abs(coarse - exact).max() / np.ptp(exact))
    estimate = run.results.summary.models["shell-0.0005"].reduction_error
    assert estimate is not None
    told = [line for line in run.results.summary.cautions if "the reduction of" in line]
    if ratio:
        assert error < 0.003
        assert error < estimate < 0.005
        assert told == []
        return
    assert error > 0.03
    assert 0.4 * error < estimate < 2.5 * error
    assert told == [
        "caution: the reduction of shell-0.0005 may change the tip's motion by "
        f"{100.0 * estimate:.2g} % of its range, since friction depends on vibrations of its "
        "plates; give damping, which ends these vibrations, and a smaller tolerance"
    ]
    notes = " ".join(note.line for note in run.results.summary.design.quality_notes)
    assert f"the reduction changes the tip's motion by about {100.0 * estimate:.2g} %" in notes
