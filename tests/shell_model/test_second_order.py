# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells under axial forces: geometric stiffness, and reduced and full booms."""

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
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.failure import NumericsError
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, Collar, Joint, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.shell_model.boom_shell import ShellOptions, segment_mesh
from protractile.shell_model.reduced_shell import ReducedShell, reduce_boom
from protractile.shell_model.segment.segment_shell import assemble_segment
from studies.reference_models.statics import static_response
from tests.shell_model.booms import STEEL
from tests.touching import touching

# Walls so thick that they do not buckle by themselves.
OUTER = BoxSection(height=0.40, width=0.30, flange=0.016, web=0.012)
INNER = BoxSection(height=0.33, width=0.23, flange=0.012, web=0.010)
HELD = (Support(4.5), Support(10.5))
LAW = PowerContact(1e9, 1.0).with_clearance(5e-3)
OPTIONS = ShellOptions(mesh_size=0.4)
THRUST = 1.0e5


def telescope(thrust: float, lateral: float | None = None) -> Boom:
    arm = Segment.of_section("arm", 0.0, 6.0, STEEL, OUTER, supports=(Support(0.0, "clamped"),))
    fly = Segment.of_section("fly", 4.5, 10.5, STEEL, INNER, load=-300.0)
    joint = Joint(0, 1, stations=(4.5, 6.0), play=0.01, lateral_play=lateral and 2.0 * lateral)
    pressed = with_compression((arm, fly), (joint,), [Thrust(1, 10.5, thrust)], gravity=5.0)
    return Boom(pressed, (joint,))


@cache
def shell(lateral: float | None = None) -> ReducedShell:
    laws = [PowerContact(1e9, 1.0).with_clearance(lateral)] if lateral is not None else []
    return reduce_boom(touching(telescope(THRUST, lateral), LAW, laws), OPTIONS, MPI.COMM_SELF)


def sparse(matrix: PETSc.Mat) -> csr_array:
    first, columns, values = matrix.getValuesCSR()
    return csr_array((values, columns, first), shape=matrix.getSize()[0:2])


def test_geometric_stiffness_of_a_rigid_rotation() -> None:
    """Reference: analytic, ∫P dx of a unit rotation with collar and self-weight; shift 0."""
    fly = replace(telescope(0.0).segments[1], collars=(Collar((7.0, 8.0), 0.004),))
    (pressed,) = with_compression([fly], [], [Thrust(0, 9.0, 4e4)], gravity=9.0)
    mesh = segment_mesh(Boom((replace(pressed, supports=HELD),), ()), 0, OPTIONS)
    shell_of = assemble_segment(MPI.COMM_SELF, pressed, mesh)
    geometric = shell_of.geometric
    motions = np.zeros((shell_of.free.size, 2))
    rows = shell_of.node_dofs
    motions[rows[:, 2], 0] = shell_of.nodes[:, 0] - 7.0
    motions[rows[:, 0], 0] = -shell_of.nodes[:, 2]
    motions[rows[:, 2], 1] = 1.0
    x = np.linspace(4.5, 10.5, 60_001)
    midpoints = 0.5 * (x[1:] + x[:-1])
    total = float(pressed.compression(midpoints).sum() * (x[1] - x[0]))
    energies = motions.T @ (sparse(geometric) @ motions)
    np.testing.assert_allclose(energies, [[total, 0.0], [0.0, 0.0]], rtol=1e-6, atol=1e-6 * total)


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
    assert full.geometric is not None
    reduced = reduce_boom(boom, OPTIONS, MPI.COMM_SELF)
    assert reduced.critical_factor == pytest.approx(2.5, rel=5e-3)
    system = reduced.system
    found = system.observers["tip"].row @ static_response(system, system.load)
    row = full.row(full.outline(8.0).mean_deflection())
    stiffness = sparse(full.stiffness) - sparse(full.geometric)
    moved = spsolve(stiffness.tocsc(), full.own_load(("z",)))
    assert found == pytest.approx(float(row @ moved), rel=1e-5)


def test_basis_for_axial_forces_keeps_its_accuracy() -> None:
    """Reference: other code path, solves of all degrees of freedom at the test frequencies."""
    errors = shell().errors
    assert errors["contact_compliance"] < 1e-6
    assert errors["deflections"] < 1e-4


def test_shell_held_by_contacts_tips_over_as_a_beam() -> None:
    """Reference: analytic, ∫P dx over the inertia about the centre; walls bend 1 %."""
    boom = telescope(THRUST)
    fly = boom.segments[1]
    x = np.linspace(4.5, 10.5, 2001)
    pressed = float(fly.compression(0.5 * (x[1:] + x[:-1])).sum() * (x[1] - x[0]))
    inertia = fly.mass_per_length * 6.0**3 / 12.0 + fly.rotary_inertia * 6.0
    tipping = shell().system.omega2[shell().system.omega2 < 0.0]
    np.testing.assert_allclose(tipping, [-pressed / inertia], rtol=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("lateral", [None, 6e-3])
def test_bonded_shell_has_the_buckling_load_of_its_beam(lateral: float | None) -> None:
    """Reference: other code, shear-flexible elements; local compliance takes up to 2 %."""
    boom = telescope(THRUST, lateral)
    beam = critical_factor(boom, finite_element_segments(boom, 0.25, "timoshenko", True))
    assert shell(lateral).critical_factor == pytest.approx(beam, rel=0.02)


def test_buckling_shell_is_refused() -> None:
    with pytest.raises(NumericsError) as caught:
        reduce_boom(column(1.25), OPTIONS, MPI.COMM_SELF)
    assert str(caught.value) == (
        "the shell of the boom buckles under 0.798 times its axial forces; make these smaller, or "
        "the sections larger"
    )
