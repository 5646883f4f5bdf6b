# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells on hinges, cylinders and rotational springs, compared with beams."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from mpi4py import MPI

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import closed_contact_damping
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.boom import Boom, Cylinder, Load, Stop, Support
from protractile.geometry.box import BoxSection
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.stress.stresses import ShellStress, wall_forces
from studies.reference_models.statics import static_response
from tests.shell_model.booms import boom_in_space, box_segment
from tests.touching import level, raised, touching

# Thick walls: the section hardly distorts.
BOX = BoxSection(height=0.4, width=0.3, flange=0.02, web=0.02)
HINGE = Support(0.0, "hinged", depth=0.1)
CYLINDER = Cylinder(0, x=2.5, depth=0.3, ground=(1.0, -1.8), stiffness=2.0e7, dashpot=2.0e4)


def luffed(cylinder: Cylinder = CYLINDER) -> Boom:
    segment = box_segment("boom", 0.0, 10.0, BOX, load=-1500.0, supports=(HINGE,))
    return Boom((segment,), (), (Load(0, "z", -5.0e3, 10.0, Step()),), cylinders=(cylinder,))


@cache
def shell(boom: Boom, size: float = 0.2) -> GapSystem:
    laws = [PowerContact(1.0e9, 1.0).with_clearance(0.5 * joint.play) for joint in boom.joints]
    options = ShellOptions(size, krylov=KrylovOptions(moments=2))
    return reduce_boom(touching(boom, laws, laws), options, MPI.COMM_WORLD).system


def beam(boom: Boom) -> GapSystem:
    models = finite_element_segments(boom, 0.25, "timoshenko", rotary_inertia=True)
    laws = [PowerContact(1.0e9, 1.0).with_clearance(0.5 * joint.play) for joint in boom.joints]
    return gap_system(touching(boom, laws, laws), models)


def at_rest(system: GapSystem) -> dict[str, float]:
    position = equilibrium(system, system.gather_loads().load)
    return {
        name: float(system.observers[name].row @ position) for name in ("cylinder_force", "tip")
    }


@pytest.mark.slow
def test_walls_carry_the_axial_force_of_the_cylinder() -> None:
    """Reference: by hand, the axial component of its force, from the lug to the hinge."""
    boom = luffed()
    made = reduce_boom(boom, ShellOptions(0.2, krylov=KrylovOptions(moments=2)), MPI.COMM_SELF)
    position = equilibrium(made.system, made.system.gather_loads().load)
    force = float(made.system.observers["cylinder_force"].row @ position)
    state = ("time", "mode"), position[None].astype(np.float32)
    stress = ShellStress.from_fields(made.fields.assign(state=state, time=("time", [0.0])))
    along, _ = CYLINDER.direction
    for x, expected in ((1.0, along * force), (2.0, along * force), (4.0, 0.0)):
        axial = sum(wall.axial for wall in wall_forces(stress, 0.0, 0, x).values())
        assert axial == pytest.approx(expected, abs=2e-3 * force)


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [2.0e7, 1.0e11], ids=["elastic", "stiff"])
def test_a_luffed_shell_rests_as_its_beam(stiffness: float) -> None:
    """Reference: other code, Timoshenko elements: force to round-off, tip 0.2 and 0.4 %."""
    boom = luffed(replace(CYLINDER, stiffness=stiffness))
    found, expected = at_rest(shell(boom)), at_rest(beam(boom))
    assert found["cylinder_force"] == pytest.approx(expected["cylinder_force"], rel=1e-6)
    assert found["tip"] == pytest.approx(expected["tip"], rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("luffed", [raised, level])
def test_axial_forces_turn_a_shell_about_its_lowered_pin(
    luffed: Callable[[], tuple[Boom, float]],
) -> None:
    """Reference: analytic, moments about the pin; without axial forces 4 to 21 % larger."""
    boom, expected = luffed()
    assert at_rest(shell(boom))["cylinder_force"] == pytest.approx(expected, rel=1e-3)


@pytest.mark.slow
def test_a_luffed_shell_swings_as_its_beam() -> None:
    """Reference: other code, Timoshenko elements: frequencies and ratios of its dashpot."""
    (found, ratios), (expected, of_beam) = (
        closed_contact_damping(system) for system in (shell(luffed()), beam(luffed()))
    )
    assert found[:2] == pytest.approx(expected[:2], rel=1e-2)
    assert of_beam[0] > 0.005
    assert ratios[:2] == pytest.approx(of_beam[:2], rel=2e-2)


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [1.0e6, 1.0e8])
def test_a_shell_turns_on_a_spring(stiffness: float) -> None:
    """Reference: other code, Timoshenko elements on the same hinge."""
    support = replace(HINGE, depth=0.0, rotation_stiffness=stiffness)
    boom = luffed()
    segment = replace(boom.segments[0], supports=(support,))
    boom = replace(boom, segments=(segment,), cylinders=())
    found, expected = (system.frequencies[:2] for system in (shell(boom), beam(boom)))
    assert found[0] == pytest.approx(expected[0], rel=5e-3)
    assert found[1] == pytest.approx(expected[1], rel=1e-2)


@pytest.mark.slow
def test_two_cylinders_hold_a_shell_in_space_as_a_beam() -> None:
    """Reference: other code, Timoshenko and Bredt: statics and two frequencies. Two cylinders
    resist the slope and the twist of a boom under wind.
    """
    free = boom_in_space()
    outer, inner = free.segments
    joint = replace(free.joints[0], bonded=True)
    pair = Cylinder(0, x=4.0, depth=0.3, ground=(1.5, -1.5), stiffness=5.0e7, spread=1.5)
    pushed = (Load(1, "y", 1.0e3, 19.0, Step()),)
    hinge = Support(0.0, "hinged")
    boom = Boom((replace(outer, supports=(hinge,)), inner), (joint,), pushed, cylinders=(pair,))
    systems = shell(boom), beam(boom)
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


@pytest.mark.slow
def test_a_shell_rests_on_a_hinge_and_a_stop() -> None:
    """Reference: analytic, the lever rule. The weight presses the shell on the stop."""
    stop = Stop(0, 6.0, 0.02, PowerContact(0.0, 1.0, stiffness_below=1e7))
    segment = replace(luffed().segments[0], supports=(Support(0.0),))
    boom = replace(luffed(), segments=(segment,), stops=(stop,), cylinders=())
    system = shell(boom)
    gaps = system.rows @ equilibrium(system, system.gather_loads().load)
    pressed = sum(float(law.force(gap)) for law, gap in zip(system.laws, gaps, strict=True))
    assert pressed == pytest.approx((-1500.0 * 10.0 * 5.0 - 5.0e3 * 10.0) / 6.0, rel=1e-6)
