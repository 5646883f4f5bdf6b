# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shared shells of booms, the card of a calibrated beam, and errors of motions by reduction."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import numpy as np
import pytest
import xarray as xr

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.beam_model.calibration import Calibration, Stiffness
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.statics import Elements
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.reduction import restrict
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Cylinder, Load, PointMass, SlidePad, Stop
from protractile.geometry.section import EACH_SIDE
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.model_output import ShellOutput
from protractile.runs.pipeline.model_run import RunContext, calibration_card
from protractile.runs.pipeline.models import build
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import ReducedShell, reduce_boom
from protractile.shell_model.standard import standard_boom, with_plays_and_loads
from studies.motions import friction_case
from tests.runs.case_texts import HINGED, STEEL, box, joint, read_case, shipped, table
from tests.runs.summaries import finished
from tests.shell_model.booms import LATERAL_LAW, LAW, boom_in_space
from tests.touching import touching

CASE = """
title = "A boom of one segment"
time = { duration = 0.1 }
model = [{ name = "shell", kind = "shell", mesh_size = 0.4, contact_tolerance = "any" }]
"""
RESTING = f"""
{table("[gravity]", angle=0.0)}
{STEEL}
{box("base", (0.0, 6.0), (0.4, 0.3, 0.008, 0.006), HINGED)}
{table("[[stop]]", segment="base", x=5.0, play=0.01, stiffness=0.0, stiffness_below=1e7)}
"""
# At 50 degrees, its pin 0.35 m below the axis.
RAISED = f"""
{table("[gravity]", angle=50.0)}
{STEEL.replace("7850.0", "1600.0")}
{box("base", (0.0, 10.0), (0.6, 0.4, 0.025, 0.025), "supports = [{ x = 0.0, depth = 0.35 }]")}
{table("[payload]", mass=400.0)}
{table("[[load]]", segment="base", x=8.0, magnitude=-3000.0)}
{table("[[cylinder]]", segment="base", x=2.6, depth=0.3, ground=[0.9, -1.3], stiffness=1e9)}
"""


def at_rest(folder: Path, text: str) -> tuple[Boom, GapSystem, Array]:
    case = read_case(folder, CASE + text)
    boom = build_boom(case)
    system = build(case, boom, case.models[0], BuildContext(MPI.COMM_SELF)).system.gather_loads()
    return boom, system, equilibrium(system, system.load)


def test_boom_held_by_its_weight_becomes_a_shell(tmp_path: Path) -> None:
    """Reference: analytic. The stop at 5 m carries M g · 3/5 of a beam of 6 m."""
    boom, system, position = at_rest(tmp_path, RESTING)
    (gap,) = system.rows @ position
    weight = 9.80665 * boom.segments[0].mass_per_length * 6.0
    assert system.laws[0].force(np.array(gap)) == pytest.approx(-weight * 3.0 / 5.0, rel=1e-6)


def test_axial_forces_turn_a_shared_shell_about_its_lowered_pin(tmp_path: Path) -> None:
    """Reference: analytic, moments about the pin of 80 kg/m, 400 kg and 3 kN: 55.89 kN."""
    boom, system, position = at_rest(tmp_path, RAISED)
    assert boom.segments[0].mass_per_length == pytest.approx(80.0)
    force = system.observers["cylinder_force"].row @ position
    assert force == pytest.approx(55.89e3, rel=1e-3)


def output(boom: Boom) -> ShellOutput:
    shell = reduce_boom(touching(boom, LAW, LATERAL_LAW), ShellOptions(0.5), MPI.COMM_SELF)
    time = np.array([0.0, 1.0])
    data = xr.Dataset(coords={"time": time})
    still = Trajectory(data, np.zeros((time.size, shell.system.omega2.size)))
    return ShellOutput.of(boom, "shell", shell, still)


@pytest.mark.slow
def test_stresses_are_stored_beside_every_contact_and_support() -> None:
    """Reference: the boom. Supports, masses, a lug, stations, a stop inside the overlap, loads."""
    stop = Stop(1, 9.5, 0.04, PowerContact(1.0e9, 1.0).upper())
    cylinder = Cylinder(0, x=4.0, depth=0.25, ground=(1.0, -4.25), stiffness=1.0e7)
    boom = boom_in_space()
    outer = replace(boom.segments[0], masses=(PointMass(4.0, 50.0),))
    pushes = tuple(Load(1, "z", size, 19.0, Step()) for size in (-2.0, 5.0, 7.0))
    segments = (outer, boom.segments[1])
    left = output(
        replace(boom, segments=segments, stops=(stop,), cylinders=(cylinder,), loads=pushes)
    )
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
    boom = touching(build_boom(shipped("three-segments")), PowerContact(1.0e9, 1.0))
    pads = tuple(
        SlidePad(0.1, 0.03, side=side, thickness=0.02, shim=0.001) for side in ("above", "below")
    )
    first, second = boom.joints
    boom = replace(boom, joints=(replace(first, pad=None, pads=pads), second), loads=())

    def system(boom: Boom) -> GapSystem:
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
    law = PowerContact(1.0e9, 1.0).with_clearance(0.007)
    system = gap_system(
        touching(boom, law, ()), finite_element_segments(boom, 2.0, "timoshenko", True), EACH_SIDE
    )
    assert len(system.laws) == 4
    residual = np.diag([2.0e-9, 4.0e-9, 5.0e-9, -1.0e-12, 1.0e-9, 1.0e-9])
    stiffness = [
        Stiffness((1.01 * one.bending_stiffness,), (0.9 * (one.shear_stiffness or 0.0),))
        for one in boom.segments
    ]
    told = calibration_card(boom, system, Calibration(stiffness, residual))
    assert [(spring.x, spring.side) for spring in told.springs] == [
        (9.0, "top"),
        (9.0, "bottom"),
        (10.0, "top"),
        (10.0, "bottom"),
    ]
    springs = [spring.stiffness for spring in told.springs]
    assert springs[:3] == pytest.approx([5.0e8, 2.5e8, 2.0e8], rel=1e-12)
    assert springs[3] is None
    for one in told.segments:
        assert one.bending_part == pytest.approx([1.01], rel=1e-12)
        assert one.shear_part == pytest.approx([0.9], rel=1e-12)
        assert one.torsion is None


SUPPORTS = "supports = [0.0, 1.4]\nload = 880.0"
RUBBING = "friction = 0.2\nnormal_forces = [4500.0, 5000.0]"
TEXT = f"""
title = "Rubbing"
{table("[time]", duration=2.0, step=2.0e-5)}
{STEEL}
{box("outer", (0.0, 8.0), (0.42, 0.40, 0.008, 0.005), SUPPORTS)}
{box("inner", (6.6, 14.5), (0.39, 0.35, 0.006, 0.0045), "load = 620.0")}
{joint("inner", "outer", 0.01, (6.6, 8.0), RUBBING)}
"""


def shells(folder: Path, *tolerances: float, more: str = "") -> Case:
    """Return a case with a shell for each tolerance, named ``shell-TOLERANCE``."""
    models = [
        table(
            "[[model]]",
            name=f"shell-{one:g}",
            kind="shell",
            mesh_size=0.4,
            contact_tolerance="any",
            tolerance=one,
        )
        for one in tolerances
    ]
    return read_case(folder, "\n".join([TEXT, *models, more]))


@pytest.mark.slow
def test_damped_motion_is_as_exact_as_the_tolerance_says(tmp_path: Path) -> None:
    """Reference: the same shell with a tolerance of 1e-8, in motion with 1 % of modal damping.

    The default tolerance is good to 0.3 % of the range, and the estimate is above the error.
    """
    case = shells(tmp_path, 5e-4, 1e-6, 1e-8, more=table("[damping]", modal=0.01))
    run = finished(case, RunContext(MPI.COMM_WORLD))
    tips = run.results.trajectories["tip"]
    exact = tips.sel(model="shell-1e-08").values
    errors = {
        one: float(np.abs(tips.sel(model=one).values - exact).max() / np.ptp(exact))
        for one in ("shell-0.0005", "shell-1e-06")
    }
    assert errors["shell-0.0005"] < 0.003
    assert errors["shell-1e-06"] < 0.7 * errors["shell-0.0005"]
    for name, error in errors.items():
        estimate = run.results.summary.models[name].reduction_error
        assert estimate is not None
        assert error < estimate < 0.005
    assert run.results.summary.models["shell-0.0005"].energy_residual < 1e-11
    assert not [one for one in run.results.summary.cautions if "the reduction of" in one]


@pytest.mark.slow
def test_undamped_plates_make_the_motion_uncertain(tmp_path: Path) -> None:
    """Reference: the same shell with a tolerance of 1e-8, and exact words.

    Without damping, friction depends on vibrations of plates above 50 Hz. The error of 4 % of the
    tip's range is estimated within a factor of 2.5, and told.
    """
    run = finished(shells(tmp_path, 5e-4, 1e-8), RunContext(MPI.COMM_WORLD))
    tips = run.results.trajectories["tip"]
    coarse, exact = (tips.sel(model=f"shell-{one}").values for one in ("0.0005", "1e-08"))
    error = float(np.abs(coarse - exact).max() / np.ptp(exact))
    estimate = run.results.summary.models["shell-0.0005"].reduction_error
    assert estimate is not None
    assert error > 0.03
    assert 0.4 * error < estimate < 2.5 * error
    assert (
        f"caution: the reduction of shell-0.0005 may change the tip's motion by "
        f"{100.0 * estimate:.2g} % of its range, since friction depends on vibrations of its "
        "plates; give damping, which ends these vibrations, and a smaller tolerance"
    ) in run.results.summary.cautions
    assert any(
        f"shell-0.0005: the reduction changes the tip's motion by about {100.0 * estimate:.2g} %"
        in note.line
        for note in run.results.summary.design.quality_notes
    )


@pytest.mark.slow
def test_the_coarser_basis_is_part_of_the_basis(tmp_path: Path) -> None:
    """Reference: analytic, orthonormal columns and Cauchy's interlacing of eigenvalues."""
    case = shells(tmp_path, 5e-4)
    built = build(case, build_boom(case), case.models[0], BuildContext(MPI.COMM_WORLD))
    assert built.shell is not None
    basis, system = built.shell.coarser, built.system
    assert basis.T @ basis == pytest.approx(np.eye(len(basis.T)), abs=1e-10)
    coarser = restrict(system, basis)
    assert 0.3 * system.num_modes < coarser.num_modes < 0.8 * system.num_modes
    rigid = system.omega2 == 0.0
    assert np.count_nonzero(coarser.omega2 == 0.0) == np.count_nonzero(rigid)
    every, fewer = np.sort(system.omega2), np.sort(coarser.omega2)
    assert (fewer >= every[: fewer.size] * (1.0 - 1e-9)).all()
    # Rigid motions and the first elastic mode are in both.
    assert fewer[rigid.sum()] == pytest.approx(every[rigid.sum()], rel=1e-3)
