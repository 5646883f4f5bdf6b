# SPDX-License-Identifier: LGPL-3.0-or-later
"""The same boom in SI units and in mm, t and s, to exclude dimensional constants in the program."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from beam_model.finite_element import finite_element_segments
from beam_model.kantorovich import kantorovich_segment
from beam_model.segment_model import gap_system
from dynamics.contact import Gap, PowerContact
from dynamics.gap_system import GapSystem
from dynamics.integrator import AdaptiveStep, FixedStep, Integrator
from dynamics.motion import Motion
from geometry.boom import Boom, Joint, Lateral, Material, PadSize, PointMass, Segment, Support
from geometry.section import BoxSection
from tests.shell_model.booms import flat_boom
from tests.touching import touching

pytestmark = pytest.mark.slow


# Millimetres of a metre, tonnes of a kilogram.
MM, T = 1.0e3, 1.0e-3

# n = 1, so that the shell's contacts are no stiffer than a run's.
LINEAR = PowerContact(stiffness=1.0e9, exponent=1.0).with_clearance(7.0e-3)
QUADRATIC = PowerContact(stiffness=1.0e13, exponent=2.0).with_clearance(7.0e-3)


def law_in_mm(law: Gap) -> Gap:
    """Return the law with k in N/mmⁿ, Δ in mm and d in s/mm."""
    power = law.law
    return replace(
        power,
        stiffness=power.stiffness / MM**power.exponent,
        stiffness_below=power.below / MM**power.exponent,
        damping=power.damping / MM,
    ).with_clearance(law.above * MM)


def boom_in_mm(boom: Boom) -> Boom:
    return Boom(
        tuple(_segment(segment) for segment in boom.segments),
        tuple(_joint(joint) for joint in boom.joints),
    )


def _segment(segment: Segment) -> Segment:
    material, section, lateral = segment.material, segment.section, segment.lateral
    return replace(
        segment,
        start=segment.start * MM,
        end=segment.end * MM,
        material=Material(
            material.youngs_modulus / MM**2, material.poissons_ratio, material.density * T / MM**3
        ),
        mass_per_length=segment.mass_per_length * T / MM,
        second_moment_of_area=segment.second_moment_of_area * MM**4,
        rotary_inertia=segment.rotary_inertia * T * MM,
        section=section
        and BoxSection(
            *(MM * d for d in (section.height, section.width, section.flange, section.web))
        ),
        load=segment.load / MM,
        supports=tuple(
            Support(s.x * MM, s.kind, s.stiffness and s.stiffness / MM) for s in segment.supports
        ),
        masses=tuple(PointMass(mass.x * MM, mass.mass * T) for mass in segment.masses),
        lateral=lateral
        and Lateral(
            lateral.second_moment_of_area * MM**4,
            lateral.rotary_inertia * T * MM,
            lateral.torsion_constant * MM**4,
            lateral.polar_inertia * T * MM,
            lateral.load / MM,
        ),
    )


def _joint(joint: Joint) -> Joint:
    return replace(
        joint,
        stations=tuple(x * MM for x in joint.stations),
        play=joint.play * MM,
        lateral_play=joint.lateral_play and joint.lateral_play * MM,
        pad=joint.pad and PadSize(joint.pad.length * MM, joint.pad.width * MM),
    )


def series(boom: Boom, law: PowerContact) -> GapSystem:
    models = [kantorovich_segment(s, 3, "complete", rotary_inertia=True) for s in boom.segments]
    return gap_system(touching(boom, law), models)


def elements(boom: Boom, law: PowerContact) -> GapSystem:
    longest = 0.05 * max(segment.length for segment in boom.segments)
    models = finite_element_segments(boom, longest, "timoshenko", True)
    return gap_system(touching(boom, law), models)


def _shell(line: str) -> Callable[[Boom, PowerContact], GapSystem]:
    def shell(boom: Boom, law: PowerContact) -> GapSystem:
        pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")
        from mpi4py import MPI

        from shell_model.boom_shell import ShellOptions
        from shell_model.contact.surface import SurfaceOptions
        from shell_model.reduced_shell import reduce_boom

        options = ShellOptions(
            mesh_size=0.05 * boom.segments[0].length,
            contact_line="surface" if line == "surface" else "near webs",
            surface=SurfaceOptions(points=(4, 2)),
        )
        return reduce_boom(touching(boom, law), options, MPI.COMM_SELF).system

    return shell


def agree(
    model: Callable[[Boom, PowerContact], GapSystem],
    boom: Boom,
    law: PowerContact,
    integrator: Integrator,
    duration: float,
) -> None:
    """Check that motions agree: tip within 1e-9 of its range, gaps and energies within 1e-8."""
    si, mm = (
        integrator(Motion(model(*data), duration))
        for data in ((boom, law), (boom_in_mm(boom), law_in_mm(law)))
    )
    assert mm.first_contact == pytest.approx(si.first_contact, rel=1.0e-6)
    assert mm.first_contact < 0.5
    assert mm.energy_residual == pytest.approx(si.energy_residual, rel=0.01, abs=1.0e-9)
    for name, unit in (("tip", MM), ("tail", MM), ("gap", MM), ("work", MM), ("friction_loss", MM)):
        expected = si.data[name].values
        apart = np.abs(mm.data[name].values / unit - expected).max()
        within = 1.0e-9 if name == "tip" else 1.0e-8
        assert apart <= within * np.ptp(expected), name


@pytest.mark.parametrize("model", [series, elements], ids=["series", "elements"])
@pytest.mark.parametrize("law", [LINEAR, QUADRATIC], ids=["linear", "quadratic"])
def test_beams_do_not_know_the_units(
    model: Callable[[Boom, PowerContact], GapSystem], law: PowerContact
) -> None:
    """Reference: the model in SI units within 1e-9, with friction and contacts."""
    agree(model, flat_boom(friction=0.2), law, FixedStep(1.0e-4), 1.0)


def test_steps_by_tolerance_do_not_know_the_units() -> None:
    """Reference: the same model in SI units, without play or without friction, until chaos."""
    agree(series, flat_boom(), LINEAR.law.with_clearance(0.0), AdaptiveStep(), 0.3)


@pytest.mark.parametrize("line", ["near webs", "pads", "surface"])
def test_shells_do_not_know_the_units(line: str) -> None:
    """Reference: the model in SI units within 1e-9, a coarse mesh with friction."""
    boom = flat_boom(friction=0.2)
    if line == "pads":
        boom = replace(boom, joints=(replace(boom.joints[0], pad=PadSize(0.1, 0.06)),))
    agree(_shell(line), boom, LINEAR, FixedStep(1.0e-4), 0.6)
