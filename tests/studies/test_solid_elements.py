# SPDX-License-Identifier: LGPL-3.0-or-later
"""Elements of the solid reference model, and its study."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the study needs DOLFINx")

from mpi4py import MPI

from protractile.geometry.arrays import Array
from protractile.geometry.boom import Collar, PointMass, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.mesh import mesh_segment
from protractile.geometry.plating import add_thickness
from protractile.shell_model.reduction import mirror
from protractile.shell_model.reduction.mirror import ALONG_Y, ALONG_Z, BREATHING, TWISTING
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from protractile.shell_model.segment.segment_shell import assemble_segment
from protractile.shell_model.segment.solver import times
from studies.reference_models.shell_readings import quadratic_form
from studies.reference_models.single_segment import natural_frequencies
from studies.reference_models.solid import SolidFamily, SolidMesh, assemble_solid, mesh_quarter
from studies.refined import Refined
from studies.solid import COMPLIANCES, EVERY, Comparison, order, rod_verification, slenderness_at
from tests.shell_model.booms import STEEL, box_segment
from tests.shell_model.conftest import compliance

BOX = BoxSection(height=0.40, width=0.30, flange=0.04, web=0.03)
LENGTH = 2.0


def coarse() -> SolidMesh:
    return mesh_quarter(BOX, (0.0, LENGTH), (0.2, 0.5), 0.2)


def segment() -> Segment:
    return box_segment("box", 0.0, LENGTH, BOX)


def distorted(mesh: SolidMesh) -> SolidMesh:
    """Return the mesh with every inner point moved by a fifth of a cell."""
    clear = 0.5 * np.array([BOX.width - BOX.web, BOX.height - BOX.flange]) + 1.0e-9
    inner = (mesh.points[:, 1:] > clear).any(axis=1)
    shift = np.empty_like(mesh.points)
    for axis, planes in enumerate(mesh.planes):
        at = mesh.points[:, axis]
        inner &= np.abs(at[:, None] - planes[[0, -1]]).min(axis=1) > 1.0e-9
        shift[:, axis] = 0.2 * np.diff(planes).min() * np.sin(37.0 * np.arange(at.size) + axis)
    assert inner.sum() > 10
    return replace(mesh, points=mesh.points + shift * inner[:, None])


def energy(solid: SolidFamily, field: Array) -> float:
    """uᵀ K u of a displacement (num_nodes, 3) in J."""
    return quadratic_form(solid.stiffness, field.ravel())


@pytest.mark.parametrize(
    ("family", "strain"),
    [
        (BREATHING, np.diag([1.0, 0.0, 0.0])),
        (BREATHING, np.diag([0.3, -0.2, 0.5])),
        (ALONG_Z, np.array([[0, 0, 1], [0, 0, 0], [1, 0, 0]])),
        (ALONG_Y, np.array([[0, 1, 0], [1, 0, 0], [0, 0, 0]])),
        (TWISTING, np.array([[0, 0, 0], [0, 0, 1], [0, 1, 0]])),
    ],
)
def test_patch_of_constant_strain(family: mirror.SymmetryClass, strain: Array) -> None:
    """Reference: analytic, V (2 μ ε:ε + λ tr² ε) in a distorted mesh, inner nodes free."""
    solid = assemble_solid(segment(), distorted(coarse()), family)
    field = solid.nodes @ strain
    mu, nu = STEEL.shear_modulus, STEEL.poissons_ratio
    lame = 2.0 * mu * nu / (1.0 - 2.0 * nu)
    density = 2.0 * mu * (strain**2).sum() + lame * np.trace(strain) ** 2
    assert energy(solid, field) == pytest.approx(density * BOX.area * LENGTH, rel=1.0e-10)
    forces = times(solid.stiffness, field.reshape(-1, 1))[:, 0].reshape(-1, 3)
    x, y, z = solid.nodes.T
    in_web = (y > 0.136) & (y < 0.164) & (z > 0.001) & (z < 0.219)
    in_flange = (z > 0.181) & (z < 0.219) & (y > 0.001) & (y < 0.164)
    within = (in_web | in_flange) & (x > 0.001) & (x < LENGTH - 0.001)
    assert within.sum() > 20
    assert np.abs(forces[within]).max() < 1.0e-9 * np.abs(forces).max()


def test_pure_bending_is_exact() -> None:
    """Reference: analytic, Saint-Venant (1856): E J κ² L, with the corners' share of J."""
    solid = assemble_solid(segment(), coarse(), ALONG_Z)
    x, y, z = solid.nodes.T
    nu = STEEL.poissons_ratio
    field = np.column_stack([x * z, -nu * y * z, -0.5 * (x**2 + nu * (z**2 - y**2))])
    stiffness = STEEL.youngs_modulus * BOX.second_moment_of_area
    assert energy(solid, field) == pytest.approx(stiffness * LENGTH, rel=1.0e-8)


def test_rigid_motions_cost_nothing_and_carry_the_mass() -> None:
    """Reference: analytic, ρ A L for translations, ρ (J_y + J_z) L for roll."""
    mass = STEEL.density * BOX.area * LENGTH
    polar = STEEL.density * BOX.polar_second_moment_of_area * LENGTH
    counts = []
    for family, motion, carried in (
        (BREATHING, lambda places: np.tile([1.0, 0.0, 0.0], (len(places), 1)), mass),
        (ALONG_Z, lambda places: np.tile([0.0, 0.0, 1.0], (len(places), 1)), mass),
        (ALONG_Y, lambda places: np.tile([0.0, 1.0, 0.0], (len(places), 1)), mass),
        (TWISTING, lambda places: np.cross([1.0, 0.0, 0.0], places), polar),
    ):
        solid = assemble_solid(segment(), coarse(), family)
        motions = solid.rigid_motions()
        counts.append(motions.shape[1])
        trial = np.sin(np.arange(solid.num_dofs)) * solid.free
        stiff = energy(solid, trial) / (trial @ trial)
        for rigid in motions.T:
            assert abs(energy(solid, rigid)) < 1.0e-12 * stiff * (rigid @ rigid)
        u = motion(solid.nodes).reshape(-1, 1)
        assert (u.T @ times(solid.mass, u))[0, 0] == pytest.approx(carried, rel=1.0e-12)
    assert counts == [1, 2, 2, 1]


@pytest.mark.slow
def test_the_shell_of_a_thin_box_is_the_solid_s() -> None:
    """Reference: other code, elasticity in space: the overhang's tip, lowest frequencies."""
    thin = BoxSection(0.40, 0.30, 0.01, 0.01)
    box = box_segment("box", 0.0, 2.0, thin, supports=(Support(0.0), Support(0.5)))
    mesh = mesh_segment(thin, {"a": 0.0, "held": 0.5, "b": 2.0}, 0.05)
    shell = assemble_segment(MPI.COMM_SELF, box, add_thickness(box, mesh))
    lift = shell.row(shell.outline(2.0).wall_deflection("z"))
    symmetry = SymmetryReduction(shell)
    (job,) = symmetry.jobs(lift[:, None], *np.zeros((2, lift.size, 0)))
    assert job.symmetry_class == ALONG_Z
    quarter = job.shell(symmetry.cell)
    solid = assemble_solid(box, mesh_quarter(thin, (0.0, 0.5, 2.0), (0.02, 0.2), 0.05), ALONG_Z)
    of_shell, of_solid = (
        compliance(model, model.outline(2.0).wall_deflection("z")) for model in (shell, solid)
    )
    assert of_shell == pytest.approx(of_solid, rel=6.0e-3)
    assert of_shell > of_solid  # a shell's corners are hinges of no size
    assert natural_frequencies(quarter, 1) == pytest.approx(
        natural_frequencies(solid, 1), rel=6.0e-3
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"masses": (PointMass(1.0, 5.0),)}, "has plain walls and carries no masses"),
        ({"collars": (Collar((0.5, 1.0), 0.01),)}, "has plain walls and carries no masses"),
        ({"supports": (Support(0.0, stiffness=1.0e6), Support(2.0))}, "takes rigid supports alone"),
    ],
)
def test_unsupported_parts_are_refused(change: dict[str, Any], message: str) -> None:
    """Reference: exact words."""
    with pytest.raises(ValueError, match=f"^'box' as a solid {message}$"):
        assemble_solid(replace(segment(), **change), coarse(), ALONG_Z)


def comparison(wall: float, error: float) -> Comparison:
    """Return a comparison in which every quantity has the same error."""
    return Comparison(
        wall,
        *(
            {what: Refined(what.what, what.unit, [4.0, 2.0, 1.0], [value] * 3) for what in EVERY}
            for value in (1.0 + error, 1.0)
        ),
    )


def test_order_and_passed_limits_are_those_of_a_power_law() -> None:
    """Reference: analytic, errors of 3 (t/b)^1.5 for a box 0.3 m wide."""
    head = COMPLIANCES[0]
    found = [comparison(t, 3.0 * (t / 0.3) ** 1.5) for t in (0.005, 0.01, 0.02)]
    assert order(found, head) == pytest.approx(1.5, rel=1.0e-9)
    for limit in (0.01, 0.02, 0.05):
        at = (limit / 3.0) ** (2.0 / 3.0)
        assert slenderness_at(found, head, limit) == f"{at:.3f}"
    assert slenderness_at(found, head, 0.2) == "> 0.067"
    assert slenderness_at(found, head, 0.001) == "< 0.017"
    assert np.isnan(order([comparison(0.01, -0.01), comparison(0.02, 0.01)], head))


@pytest.mark.slow
def test_the_solid_stands_by_itself() -> None:
    """Reference: analytic. The effect of the rod's lateral inertia is twice the permitted error."""
    rod = rod_verification()
    assert rod.holds
    without = 0.5 * np.sqrt(2.1e11 / 7850.0) / 2.0
    assert rod.allowed < 0.5 * (without / rod.reference - 1.0)
