# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells on hinges and cylinders, and under axial forces, compared with beams."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve

from protractile.beam_model.boom_modes import critical_factor
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import closed_contact_damping
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, Cylinder, Joint, Load, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.shell_model.boom_shell import ShellOptions, segment_mesh
from protractile.shell_model.reduced_shell import ReducedShell
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.segment.segment_shell import assemble_segment
from protractile.shell_model.stress.stresses import ShellStress
from studies.reference_models.shell_readings import wall_forces
from studies.reference_models.statics import static_response
from tests.shell_model.booms import STEEL, boom_in_space, box_segment, reduce_quickly
from tests.touching import raised, touching

# Thick walls: the section hardly distorts.
BOX = BoxSection(height=0.4, width=0.3, flange=0.02, web=0.02)
HINGE = Support(0.0, "hinged", depth=0.1)
CYLINDER = Cylinder(0, x=2.5, depth=0.3, ground=(1.0, -1.8), stiffness=2.0e7, dashpot=2.0e4)


def luffed(cylinder: Cylinder = CYLINDER) -> Boom:
    segment = box_segment("boom", 0.0, 10.0, BOX, load=-1500.0, supports=(HINGE,))
    return Boom((segment,), (), (Load(0, "z", -5.0e3, 10.0, Step()),), cylinders=(cylinder,))


@cache
def reduced(boom: Boom) -> ReducedShell:
    options = ShellOptions(0.2, krylov=KrylovOptions(moments=2))
    return reduce_quickly(boom, options, fields=True)


def beam(boom: Boom) -> GapSystem:
    return gap_system(boom, finite_element_segments(boom, 0.25, "timoshenko", rotary_inertia=True))


def at_rest(system: GapSystem) -> dict[str, float]:
    position = equilibrium(system, system.gather_loads().load)
    return {
        name: float(system.observers[name].row @ position) for name in ("cylinder_force", "tip")
    }


@pytest.mark.slow
def test_walls_carry_the_axial_force_of_the_cylinder() -> None:
    """Reference: by hand, the axial component of its force, from the lug to the hinge."""
    made = reduced(luffed())
    position = equilibrium(made.system, made.system.gather_loads().load)
    force = float(made.system.observers["cylinder_force"].row @ position)
    state = ("time", "mode"), position[None].astype(np.float32)
    stress = ShellStress.from_fields(made.fields.assign(state=state, time=("time", [0.0])))
    along, _ = CYLINDER.direction
    for x, expected in ((1.0, along * force), (2.0, along * force), (4.0, 0.0)):
        axial = sum(wall.axial for wall in wall_forces(stress, 0.0, 0, x).values())
        assert axial == pytest.approx(expected, abs=2e-3 * force)


@pytest.mark.slow
def test_a_luffed_shell_rests_as_its_beam() -> None:
    """Reference: other code, Timoshenko elements: force, tip, frequencies and dashpot's ratios."""
    systems = reduced(luffed()).system, beam(luffed())
    found, expected = (at_rest(system) for system in systems)
    assert found["cylinder_force"] == pytest.approx(expected["cylinder_force"], rel=1e-6)
    assert found["tip"] == pytest.approx(expected["tip"], rel=5e-3)
    (hertz, ratios), (of_beam, expected_ratios) = map(closed_contact_damping, systems)
    assert hertz[:2] == pytest.approx(of_beam[:2], rel=1e-2)
    assert ratios[:2] == pytest.approx(expected_ratios[:2], rel=2e-2)


@pytest.mark.slow
def test_axial_forces_turn_a_shell_about_its_lowered_pin() -> None:
    """Reference: analytic, moments about the pin; without axial forces 4 to 21 % larger."""
    boom, expected = raised()
    assert at_rest(reduced(boom).system)["cylinder_force"] == pytest.approx(expected, rel=1e-3)


@pytest.mark.slow
def test_a_shell_turns_on_a_spring() -> None:
    """Reference: other code, Timoshenko elements on the same hinge."""
    support = replace(HINGE, depth=0.0, rotation_stiffness=1.0e7)
    segment = replace(luffed().segments[0], supports=(support,))
    boom = replace(luffed(), segments=(segment,), cylinders=())
    found, expected = (system.frequencies[:2] for system in (reduced(boom).system, beam(boom)))
    assert found[0] == pytest.approx(expected[0], rel=5e-3)
    assert found[1] == pytest.approx(expected[1], rel=1e-2)


@pytest.mark.slow
def test_two_cylinders_hold_a_shell_in_space_as_a_beam() -> None:
    """Reference: other code, Timoshenko and Bredt: statics under wind and two frequencies."""
    free = boom_in_space()
    outer, inner = free.segments
    joint = replace(free.joints[0], bonded=True)
    pair = Cylinder(0, x=4.0, depth=0.3, ground=(1.5, -1.5), stiffness=5.0e7, spread=1.5)
    pushed = (Load(1, "y", 1.0e3, 19.0, Step()),)
    hinge = Support(0.0, "hinged")
    boom = Boom((replace(outer, supports=(hinge,)), inner), (joint,), pushed, cylinders=(pair,))
    systems = reduced(boom).system, beam(boom)
    names = "cylinder_force", "cylinder_force_difference", "tip_lateral", "tip"
    found, expected = (
        [float(system.observers[name].row @ static_response(system, load)) for name in names]
        for system in systems
        for load in [system.gather_loads().load]
    )
    assert abs(expected[1]) > 100.0
    assert found == pytest.approx(expected, rel=1.5e-2)
    frequencies = [system.frequencies[:2] for system in systems]
    assert frequencies[0] == pytest.approx(frequencies[1], rel=2e-2)


OPTIONS = ShellOptions(mesh_size=0.4)


def sparse(matrix: PETSc.Mat) -> csr_array:
    first, columns, values = matrix.getValuesCSR()
    return csr_array((values, columns, first), shape=matrix.getSize()[0:2])


def column(part: float) -> Boom:
    """Return a slender cantilever under a part of Euler's force."""
    box = BoxSection(height=0.2, width=0.15, flange=0.006, web=0.006)
    clamp = (Support(0.0, "clamped"),)
    arm = Segment.of_section("arm", 0.0, 8.0, STEEL, box, supports=clamp, load=-100.0)
    euler = 0.25 * np.pi**2 * arm.bending_stiffness / 8.0**2
    return Boom(with_compression([arm], [], [Thrust(0, 8.0, part * euler)]), ())


def test_a_reduced_column_bends_as_the_full_one_under_its_axial_force() -> None:
    """Reference: other code path, (K − K_G) u = f of all dofs, 1e-5 at 40 % of buckling."""
    boom = column(0.4)
    full = assemble_segment(MPI.COMM_SELF, boom.segments[0], segment_mesh(boom, 0, OPTIONS))
    found = reduce_quickly(boom, OPTIONS)
    assert found.critical_factor == pytest.approx(2.5, rel=5e-3)
    system = found.system
    tip = system.observers["tip"].row @ static_response(system, system.load)
    row = full.row(full.outline(8.0).mean_deflection())
    stiffness = sparse(full.stiffness) - sparse(full.geometric)
    moved = spsolve(stiffness.tocsc(), full.own_load(("z",)))
    assert tip == pytest.approx(float(row @ moved), rel=1e-5)


@pytest.mark.slow
def test_a_pressed_shell_held_by_contacts_tips_over_and_buckles_as_beams() -> None:
    """Reference: analytic, ∫P dx over the inertia in both planes; bonded, shear-flexible elements.

    Walls are so thick that they bend by 1 %; local compliance takes up to 2 % of the factor.
    """
    outer, inner = BoxSection(0.40, 0.30, 0.016, 0.012), BoxSection(0.33, 0.23, 0.012, 0.010)
    arm = Segment.of_section("arm", 0.0, 6.0, STEEL, outer, supports=(Support(0.0, "clamped"),))
    fly = Segment.of_section("fly", 4.5, 10.5, STEEL, inner, load=-300.0)
    law = PowerContact(1e9, 1.0).with_clearance(5e-3)
    joint = Joint(0, 1, stations=(4.5, 6.0), play=0.01, lateral_play=0.01)
    pressed = with_compression((arm, fly), (joint,), [Thrust(1, 10.5, 1.0e5)], gravity=5.0)
    boom = Boom(pressed, (joint,))
    shell = reduce_quickly(touching(boom, law, law), OPTIONS)
    assert shell.errors["contact_compliance"] < 1e-6
    assert shell.errors["deflections"] < 1e-4
    x = np.linspace(4.5, 10.5, 2001)
    force = float(pressed[1].compression(0.5 * (x[1:] + x[:-1])).sum() * (x[1] - x[0]))
    bar = fly.mass_per_length * 6.0**3 / 12.0
    turned = [bar + 6.0 * plane.rotary_inertia for plane in (fly.turned(), fly)]
    tipping = np.sort(shell.system.omega2[shell.system.omega2 < 0.0])
    np.testing.assert_allclose(tipping, -force / np.array(turned), rtol=0.01)
    factor = critical_factor(boom, finite_element_segments(boom, 0.25, "timoshenko", True))
    assert shell.critical_factor == pytest.approx(factor, rel=0.02)
