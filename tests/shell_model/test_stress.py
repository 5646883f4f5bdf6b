# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stresses of plates with known strains, and of beams away from contacts."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Collar, Diaphragm, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.mesh import diaphragm_breaks, mesh_segment
from protractile.geometry.plating import PlatedMesh, add_thickness
from protractile.geometry.profiles import octagon
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.segment.segment_shell import assemble_segment
from protractile.shell_model.stress.fields import gather_stress_modes
from protractile.shell_model.stress.history import stress_near_places, summarise
from protractile.shell_model.stress.stresses import Modes, ShellStress, Stress
from studies.reference_models.shell_readings import wall_forces
from studies.second_order import BOX as COLUMN_BOX
from studies.second_order import CLAMP, CRITICAL, LENGTH, column
from studies.taper import arm
from tests.shell_model.booms import LAW, STEEL, box_segment, reduce_quickly, three_segments
from tests.shell_model.conftest import BOX, UNEQUAL
from tests.touching import touching

E, NU = STEEL.youngs_modulus, STEEL.poissons_ratio
Field = Callable[[Array], Array]


def stresses(u: Field, theta: Field) -> tuple[Modes, PlatedMesh]:
    """Return (num_triangles, 6) of displacement and rotation fields (num_places, 3) of a short box
    with a diaphragm at its middle.
    """
    segment = replace(box_segment("box", 0.0, 1.0, BOX), diaphragms=(Diaphragm(0.5, 0.01),))
    closed = diaphragm_breaks(segment)
    mesh = mesh_segment(BOX, {"start": 0.0, "end": 1.0} | closed, 0.25, closed=tuple(closed))
    mesh = add_thickness(segment, mesh)
    shell = assemble_segment(MPI.COMM_SELF, segment, mesh)
    shape = np.zeros((shell.free.size, 1))
    shape[shell.node_dofs, 0] = u(shell.nodes)
    rotation_nodes, rotation_dofs = shell.plates.nodes[1]
    shape[rotation_dofs, 0] = theta(rotation_nodes)
    return gather_stress_modes(shell, shape)[0], mesh


@pytest.mark.slow
def test_pull_along_the_boom_is_a_uniform_stress_of_the_walls() -> None:
    """Reference: analytic, σ_x = E ε, and -ν E ε / (1 - ν) in the plane of the diaphragm."""
    strain = 1.0e-4
    found, mesh = stresses(lambda p: strain * p * [1.0, -NU, -NU], np.zeros_like)
    walls = found[mesh.on_walls]
    assert walls[:, 0] == pytest.approx(E * strain, rel=1e-5)
    assert np.abs(walls[:, 1:]).max() < 1e-5 * E * strain
    plate = found[~mesh.on_walls]
    assert plate[:, :2] == pytest.approx(-NU * E * strain / (1.0 - NU), rel=1e-5)
    assert np.abs(plate[:, 2:]).max() < 1e-5 * E * strain


@pytest.mark.slow
def test_shear_has_the_sign_of_the_way_around() -> None:
    """Reference: analytic, τ = G γ for u_y = γ x: along s on the top, against on the bottom."""
    shear = 1.0e-4
    found, mesh = stresses(lambda p: shear * p[:, [0]] * [0.0, 1.0, 0.0], np.zeros_like)
    expected = {"top": 1.0, "bottom": -1.0, "right": 0.0, "left": 0.0}
    full = shear * E / (2.0 * (1.0 + NU))
    for wall, sign in expected.items():
        mine = found[mesh.walls == mesh.plates.index(wall)]
        assert mine[:, 2] == pytest.approx(sign * full, abs=1e-5 * full)
        assert np.abs(np.delete(mine, 2, axis=1)).max() < 1e-5 * full


@pytest.mark.slow
def test_bending_stress_is_read_at_the_outer_face() -> None:
    """Reference: analytic, ε = κ h/2 in the middle of the top and κ t/2 more on its outer face."""
    bend = 1.0e-4
    found, mesh = stresses(
        lambda p: bend * np.stack([p[:, 0] * p[:, 2], 0 * p[:, 0], -0.5 * p[:, 0] ** 2], axis=1),
        lambda p: bend * np.stack([0 * p[:, 0], p[:, 0], 0 * p[:, 0]], axis=1),
    )
    plane = E * bend / (1.0 - NU**2)
    for wall, side in (("top", 1.0), ("bottom", -1.0)):
        mine = found[mesh.walls == mesh.plates.index(wall)]
        assert mine[:, 0] == pytest.approx(side * plane * 0.5 * BOX.height, rel=1e-4)
        assert mine[:, 3] == pytest.approx(side * plane * 0.5 * BOX.flange, rel=1e-4)
        assert mine[:, 4] == pytest.approx(side * NU * plane * 0.5 * BOX.flange, rel=1e-4)
    web = mesh.walls == mesh.plates.index("right")
    z = mesh.points[mesh.triangles[web], 2].mean(axis=1)
    assert found[web, 0] == pytest.approx(plane * z, abs=1e-4 * plane * BOX.height)
    assert np.abs(found[web, 3:]).max() < 1e-4 * plane * BOX.flange


@pytest.mark.parametrize(
    ("membrane", "expected"),
    [((3.0, 0.0, 0.0), 3.0), ((0.0, 0.0, 1.0), 3.0**0.5), ((2.0, 2.0, 0.0), 2.0)],
)
def test_von_mises_of_simple_states(membrane: tuple[float, ...], expected: float) -> None:
    """Reference: analytic. Tension σ and equal biaxial tension give σ, and shear τ gives √3 τ."""
    stress = Stress(np.float32([membrane]), np.float32([[1.0, 0.0, 0.0]]))
    assert stress.von_mises("middle") == pytest.approx(expected)
    assert stress.largest() >= stress.von_mises("middle")


def stressed(boom: Boom, size: float = 0.4, load: float = 0.0) -> ShellStress:
    """Return the stresses of a boom at rest under a part of its load, without contact."""
    shell = reduce_quickly(touching(boom, LAW), ShellOptions(size), fields=True)
    omega2 = shell.system.omega2
    rest = np.divide(shell.system.load, omega2, out=np.zeros_like(omega2), where=omega2 > 0.0)
    state = ("time", "mode"), load * rest[None].astype(np.float32)
    return ShellStress.from_fields(shell.fields.assign(state=state, time=("time", [0.0])))


@pytest.mark.slow
def test_wall_forces_with_unequal_flanges_are_in_equilibrium() -> None:
    """Reference: analytic, about the centroid; the thicker flange has less stress."""
    clamp = (Support(0.0, kind="clamped"),)
    shell = stressed(Boom((box_segment("box", 0.0, 10.0, UNEQUAL, 100.0, clamp),), ()), 0.2, 1.0)
    forces, row = wall_forces(shell, 0.0, 0, 5.01), shell.row(0, 5.01)
    arm = 10.0 - 0.5 * (shell.spans[row].min() + shell.spans[row].max())
    assert sum(f.moment for f in forces.values()) == pytest.approx(-50.0 * arm**2, rel=5e-3)
    shear = forces["left"].shear + forces["right"].shear
    assert shear == pytest.approx(100.0 * arm, rel=0.02)
    assert abs(forces["top"].shear) < 1e-2 * shear
    axial = sum(f.axial for f in forces.values())
    assert axial == pytest.approx(0.0, abs=2e-3 * abs(forces["top"].axial))
    stresses = [forces[p.name].axial / (p.length * p.thickness) for p in UNEQUAL.plates[::2]]
    midpoints = [plate.midpoint[1] for plate in UNEQUAL.plates[::2]]
    assert stresses[0] / stresses[1] == pytest.approx(midpoints[0] / midpoints[1], rel=5e-3)


@pytest.mark.slow
def test_a_bonded_boom_keeps_each_segments_stresses() -> None:
    """Reference: analytic. Bonded segments are one cantilever beyond the support at 2 m."""
    boom = three_segments(bonded=True)
    shell = stressed(boom, 0.5, 1.0)
    forces = wall_forces(shell, 0.0, 0, 5.01)
    line = np.unique(shell.spans.round(6))
    middle = 0.5 * (line[line < 5.01].max() + line[line > 5.01].min())
    moment = -83.16 * (10.0 - middle) ** 2 / 2.0
    moment -= sum(s.load * s.length * (0.5 * (s.start + s.end) - middle) for s in boom.segments[1:])
    assert sum(f.moment for f in forces.values()) == pytest.approx(moment, rel=0.01)


def axial_force(shell: ShellStress, x: float) -> float:
    """Return the axial force of all walls at a cross-section in N."""
    return sum(forces.axial for forces in wall_forces(shell, 0.0, 0, x).values())


def test_a_column_is_pressed_by_its_load_and_its_weight() -> None:
    """Reference: by hand, −P/A in walls with the weight m̄ g (L − x); a collar bears its part."""
    force, gravity = 0.1 * CRITICAL, 9.80665
    boom = column((CLAMP,), force)
    shell = stressed(boom)
    np.testing.assert_allclose(shell.at(0.0).membrane[:, 0], -force / COLUMN_BOX.area, rtol=1e-6)
    assert np.abs(shell.at(0.0).membrane[:, 1:]).max() == 0.0
    (segment,) = boom.segments
    doubled = replace(segment, collars=(Collar((3.0, 4.0), 0.006),))
    collared = stressed(replace(boom, segments=(doubled,)))
    assert collared.at(0.0).membrane[:, 0].max() == pytest.approx(-0.5 * force / COLUMN_BOX.area)
    assert axial_force(collared, 3.5) == pytest.approx(-force, rel=1e-6)
    weighing = stressed(column((CLAMP,), force, gravity))
    row = weighing.row(0, 2.0)
    middle = 0.5 * (weighing.spans[row, 0].min() + weighing.spans[row, 1].max())
    above = COLUMN_BOX.mass_per_length(STEEL.density) * gravity * (LENGTH - middle)
    assert axial_force(weighing, 2.0) == pytest.approx(-force - above, rel=1e-4)


def test_a_taper_is_pressed_most_at_its_slender_end() -> None:
    """Reference: by hand, −P/A of the local section, four times as large at the head."""
    shell = stressed(arm(1000.0))
    stress, x = shell.at(0.0).membrane[:, 0], shell.centroids[:, 0]
    (segment,) = arm().segments
    local = np.array([segment.section_at(place).area for place in x.tolist()])
    np.testing.assert_allclose(stress, -1000.0 / local, rtol=1e-5)
    assert stress.min() / stress.max() > 3.0
    for place in (1.0, 4.0, 7.0):
        assert axial_force(shell, place) == pytest.approx(-1000.0, rel=2e-3)


THIN = BoxSection(height=0.4, width=0.3, flange=0.005, web=0.005)
TIME = np.linspace(0.0, 1.0, 1001)


@pytest.fixture
def shell() -> ShellStress:
    """Return a box of 4 m with global bending in one coordinate, a spot near 3 m in the other.

    The spot is a triangle of the top in bending. It occurs only at 0.701 s, between the instants at
    which all triangles are evaluated.
    """
    mesh = mesh_segment(THIN, {"start": 0.0, "end": 4.0}, 0.1)
    mesh = add_thickness(box_segment("box", 0.0, 4.0, THIN), mesh)
    centroids = mesh.points[mesh.triangles].mean(axis=1)
    modes = np.zeros((2, len(mesh.triangles), 6), dtype=np.float32)
    modes[0, :, 0] = 5.0e6 * centroids[:, 2]
    spot = np.abs(centroids - [3.05, 0.05, 0.2]).sum(axis=1)
    spot[mesh.walls != mesh.plates.index("top")] = np.inf
    modes[1, spot.argmin(), 3] = 8.0e6
    states = np.stack([np.sin(np.pi * TIME) ** 2, TIME[701] == TIME], axis=1).astype(np.float32)
    still = ShellStress.at_rest(mesh, modes[:1])
    return replace(still, modes=[modes], states=[states], time=TIME)


def test_bands_see_the_spot_and_patches_its_mean(shell: ShellStress) -> None:
    """Reference: analytic, 1 MPa at flanges. The spot adds a thirtieth to a patch's mean."""
    history = stress_near_places(shell, [1.0, 3.0, 9.0], ["box"])
    near = history["von_mises"].sel(segment="box")
    assert near.sel(place=1.0).max() == pytest.approx(1.0e6, rel=1e-5)
    assert near.sel(place=1.0).idxmax("time") == pytest.approx(0.5)
    assert near.sel(place=3.0).idxmax("time") == pytest.approx(0.701)
    bending = 1.0e6 * np.sin(0.701 * np.pi) ** 2
    assert near.sel(place=3.0).max() == pytest.approx(bending + 8.0e6, rel=1e-5)
    patch = history["von_mises_patch"].sel(segment="box", place=3.0)
    top = np.flatnonzero((shell.wall == 2) & (np.abs(shell.centroids[:, 0] - 3.0) <= 0.25))
    half = top[shell.centroids[top, 1] > 0.0]
    share = 8.0e6 / half.size
    assert float(patch[701]) == pytest.approx(bending + share, rel=1e-3)
    assert history["von_mises"].sel(place=9.0).isnull().all()


def test_a_patch_is_half_of_a_chamfer() -> None:
    """Reference: by hand, a triangle's share of the area of half the wall within the band."""
    section = octagon(0.5, 0.4, chamfer=0.1, top=0.006, bottom=0.006, web=0.006)
    mesh = mesh_segment(section, {"start": 0.0, "end": 2.0}, 0.05)
    mesh = add_thickness(box_segment("tube", 0.0, 2.0, section), mesh)
    x, y, z = mesh.points[mesh.triangles].mean(axis=1).T
    # The middle of the chamfer is at y = 0.15 m and z = 0.2 m.
    half = np.flatnonzero((np.abs(x - 1.0) <= 0.25) & (np.abs(y + z - 0.35) < 1e-9) & (z > 0.2))
    modes = np.zeros((1, len(mesh.triangles), 6), dtype=np.float32)
    modes[0, half[0], 3] = 8.0e6
    shell = ShellStress.at_rest(mesh, modes)
    patch = stress_near_places(shell, [1.0], ["tube"])["von_mises_patch"]
    share = shell.areas[half[0]] / shell.areas[half].sum()
    assert float(patch.max()) == pytest.approx(8.0e6 * share, rel=1e-5)


def test_triangles_without_the_largest_stress_alone_are_left_out(shell: ShellStress) -> None:
    """Reference: all triangles at every time, for two slow motions, noise and axial forces."""
    rng = np.random.default_rng(5)
    slow = np.sin(np.outer(TIME, [7.0, 11.0, 0.0, 0.0, 0.0]) + 0.5 * np.eye(1, 5))
    states = slow + 1.0e-4 * rng.standard_normal(slow.shape)
    modes = rng.standard_normal((5, shell.segment.size, 6)).astype(np.float32)
    axial = rng.standard_normal(shell.segment.size).astype(np.float32)
    moving = replace(shell, modes=[modes], states=[states.astype(np.float32)], axial=axial)
    found = stress_near_places(moving, [1.0], ["box"])["von_mises"].values[:, 0, 0]
    every = moving.largest(moving.near(0, 1.0, 0.25)).max(axis=1)
    np.testing.assert_allclose(found, every, rtol=1e-5)


def test_the_largest_is_found(shell: ShellStress) -> None:
    """With a band, the result is the spot; otherwise the largest at the evaluated instants."""
    without = summarise(shell, stress_near_places(shell, [], ["box"]))
    assert (without.von_mises, without.patch) == (pytest.approx(1.0e6, rel=1e-3), None)
    near = stress_near_places(shell, [1.0, 3.0], ["box"])
    found = summarise(shell, near)
    assert found.time == pytest.approx(0.701)
    assert (found.segment, found.wall, found.face) == ("box", "top", "outer")
    assert found.x == pytest.approx(3.05, abs=0.05)
    spotted = near["von_mises"].sel(place=3.0).max()
    assert float(spotted) == pytest.approx(found.von_mises, rel=1e-3)
