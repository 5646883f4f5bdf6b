# SPDX-License-Identifier: LGPL-3.0-or-later
"""Symmetry classes of motions: four for a box, two for a section with one mirror."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.dynamics.failure import NumericsError
from protractile.geometry.boom import Collar, Diaphragm, PointMass, Support
from protractile.geometry.mesh import SegmentMesh, collar_breaks, diaphragm_breaks, mesh_segment
from protractile.geometry.plating import add_thickness
from protractile.geometry.section import Section
from protractile.shell_model.reduction.mirror import (
    ALONG_Y,
    ALONG_Z,
    BREATHING,
    TWISTING,
    SymmetryClass,
)
from protractile.shell_model.reduction.symmetry import Job, SymmetryReduction
from protractile.shell_model.segment.segment_shell import SegmentShell, assemble_segment
from protractile.shell_model.segment.solver import times
from studies.reference_models.shell_readings import flange_deflection
from tests.shell_model.booms import HELD, box_segment
from tests.shell_model.conftest import BOX, UNEQUAL, box_shell


def _laden(section: Section) -> SegmentShell:
    """Return a box with all features of a segment."""
    segment = replace(
        box_segment("box", 0.0, 10.0, section),
        supports=(Support(0.0, stiffness=1.0e6), Support(2.0)),
        masses=(PointMass(10.0, 70.0),),
        collars=(Collar((4.0, 5.0), 0.004),),
        diaphragms=(Diaphragm(6.0, 0.01),),
    )
    breaks = {"start": 0.0, "support": 2.0, "end": 10.0}
    breaks |= collar_breaks(segment) | diaphragm_breaks(segment)
    mesh = mesh_segment(section, breaks, 0.5, closed=tuple(diaphragm_breaks(segment)))
    return assemble_segment(MPI.COMM_WORLD, segment, add_thickness(segment, mesh))


def _everything(shell: SegmentShell) -> tuple[SymmetryReduction, list[Job]]:
    """Return the symmetry classes that a force on every row excites."""
    symmetry = SymmetryReduction(shell)
    force = np.random.default_rng(1).standard_normal((shell.num_dofs, 1)) * shell.free[:, None]
    return symmetry, symmetry.jobs(force, force, force[:, :0])


@pytest.mark.parametrize(
    ("section", "own"),
    [
        (BOX, {BREATHING: [0], ALONG_Z: [2, 4], ALONG_Y: [1, 5], TWISTING: [3]}),
        (UNEQUAL, {SymmetryClass(1, 0): [0, 2, 4], SymmetryClass(-1, 0): [1, 3, 5]}),
    ],
    ids=["box", "unequal"],
)
def test_rigid_motions_belong_to_their_families(
    section: Section, own: Mapping[SymmetryClass, list[int]]
) -> None:
    """Reference: analytic, translations along x, y and z, then rotations about them."""
    shell = box_shell(0.5, section=section)
    motions = shell.rigid_motions()
    symmetry, jobs = _everything(shell)
    assert [job.symmetry_class for job in jobs] == list(own)
    for job in jobs:
        found = symmetry.expand(job.shell(symmetry.cell).rigid_motions(), job.symmetry_class, 0)
        expected = motions[:, own[job.symmetry_class]]
        assert found.shape == expected.shape
        combination = np.linalg.lstsq(expected, found, rcond=None)[0]
        assert expected @ combination == pytest.approx(found, abs=1.0e-12)


@pytest.mark.parametrize("kind", ["held", "laden", "unequal"])
def test_a_quarter_moves_as_its_family_does_in_the_whole(kind: str) -> None:
    """Reference: other code path, the whole shell under the forces of this class."""
    shells = {
        "held": lambda: box_shell(0.5, supports=HELD),
        "laden": lambda: _laden(BOX),
        "unequal": lambda: _laden(UNEQUAL),
    }
    shell = shells[kind]()
    symmetry, jobs = _everything(shell)
    for job in jobs:
        quarter = job.shell(symmetry.cell)
        motion = np.random.default_rng(2).standard_normal((quarter.num_dofs, 1))
        motion *= quarter.free[:, None]
        whole = symmetry.expand(motion, job.symmetry_class, 0)
        assert not whole[~shell.free].any()
        for full, part in ((shell.stiffness, quarter.stiffness), (shell.mass, quarter.mass)):
            force = times(full, whole) * shell.free[:, None]
            (found,) = symmetry.jobs(force, force, force[:, :0])
            assert found.symmetry_class == job.symmetry_class
            expected = times(part, motion) * quarter.free[:, None]
            off = found.forces * quarter.free[:, None] - expected
            assert np.abs(off).max() < 1.0e-12 * np.abs(expected).max()


@pytest.mark.parametrize("section", [BOX, UNEQUAL], ids=["box", "unequal"])
def test_forces_do_the_same_work_on_the_parts(section: Section) -> None:
    """Reference: analytic. The sum over the classes is the whole force."""
    shell = box_shell(0.5, supports=HELD, section=section)
    symmetry = SymmetryReduction(shell)
    force = np.random.default_rng(1).standard_normal((shell.num_dofs, 2)) * shell.free[:, None]
    total, parts = np.zeros(2), np.zeros(2)
    for job in symmetry.jobs(force, force, force[:, :0]):
        assert np.array_equal(job.forces, job.outputs)
        motion = np.random.default_rng(2).standard_normal((len(job.forces), 1))
        motion *= job.shell(symmetry.cell).free[:, None]
        parts += (job.forces.T @ motion)[:, 0]
        total += (force.T @ symmetry.expand(motion, job.symmetry_class, 0))[:, 0]
    assert parts == pytest.approx(total, rel=1.0e-10)


def test_a_load_in_the_plane_of_bending_excites_two_families() -> None:
    """A load along z excites bending along z; a force on one flange also excites breathing."""
    shell = box_shell(0.5, supports=HELD)
    push = shell.row(flange_deflection(shell.outline(10.0), 1.0, 0.1))
    for force, expected in (
        (shell.unit_loads["z"], [ALONG_Z]),
        (shell.unit_loads["y"], [ALONG_Y]),
        (push, [BREATHING, ALONG_Z]),
    ):
        jobs = SymmetryReduction(shell).jobs(
            force[:, None], force[:, None], np.zeros((force.size, 0))
        )
        assert [job.symmetry_class for job in jobs] == expected


def _shifted(mesh: SegmentMesh) -> SegmentMesh:
    points = mesh.points.copy()
    points[np.abs(points[:, 0] - 5.0).argmin(), 0] += 0.01
    return replace(mesh, points=points)


def _one_diagonal_turned(mesh: SegmentMesh) -> SegmentMesh:
    """Return the mesh with the other diagonal in one rectangle, and unchanged nodes."""
    triangles = mesh.triangles.copy()
    for other in range(1, len(triangles)):
        shared = np.intersect1d(triangles[0], triangles[other])
        ends = mesh.points[shared]
        if shared.size == 2 and (np.abs(ends[0] - ends[1]) > 1.0e-9).sum() == 2:
            break
    (a,), (b,) = (np.setdiff1d(triangles[k], shared) for k in (0, other))
    triangles[0], triangles[other] = [a, b, shared[0]], [a, b, shared[1]]
    return replace(mesh, triangles=triangles)


@pytest.mark.parametrize(("spoil", "what"), [(_shifted, "mesh"), (_one_diagonal_turned, "shell")])
def test_asymmetric_mesh_is_refused(spoil: Callable[[SegmentMesh], SegmentMesh], what: str) -> None:
    mesh = spoil(mesh_segment(BOX, {"start": 0.0, "end": 10.0}, 0.5))
    segment = box_segment("box", 0.0, 10.0, BOX)
    shell = assemble_segment(MPI.COMM_WORLD, segment, add_thickness(segment, mesh))
    message = f"^a segment's {what} is not its own mirror image in y$"
    with pytest.raises(NumericsError, match=message):
        SymmetryReduction(shell)
