# SPDX-License-Identifier: LGPL-3.0-or-later
"""Accuracy of the reduced segment with its measured errors, and its symmetry classes."""

import math
import os
from concurrent.futures import BrokenExecutor
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Collar, Diaphragm, PointMass, Support
from protractile.geometry.mesh import collar_breaks, diaphragm_breaks, mesh_segment
from protractile.geometry.plating import add_thickness
from protractile.geometry.probe_responses import PROBE_FREQUENCY
from protractile.geometry.section import Section
from protractile.runs.process.workers import workers
from protractile.shell_model.contact.local_compliance import shell_compliance
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.reduction.segment import ReducedSegment, SegmentInputs, reduce_segments
from protractile.shell_model.reduction.symmetry import Job, SymmetryReduction
from protractile.shell_model.segment.segment_shell import SegmentShell, assemble_segment
from protractile.shell_model.segment.solver import ShiftedSolver, exact_product, times
from studies.reference_models.shell_readings import flange_deflection
from studies.reference_models.single_segment import natural_frequencies
from tests.shell_model.booms import HELD, box_segment, reduce_segment
from tests.shell_model.conftest import BOX, UNEQUAL, box_shell


def _inputs(shell: SegmentShell) -> np.ndarray:
    rows = [
        shell.row(flange_deflection(shell.outline(x), side, 0.5 * shell.segment.section.width))
        for x in (2.0, 10.0)
        for side in (1.0, -1.0)
    ]
    return np.column_stack([row for row in rows if row.any()] + [80.0 * shell.unit_loads["z"]])


def _held() -> tuple[SymmetryReduction, Array]:
    shell = box_shell(0.5, supports=HELD)
    return SymmetryReduction(shell), _inputs(shell)


@pytest.mark.slow
def test_modes_below_the_stated_limit_are_the_full_models() -> None:
    """Reference: SLEPc on the full model. Each ω below the limit is a natural one to 1e-6."""
    shell = box_shell(0.5)
    reduced = reduce_segment(SymmetryReduction(shell), _inputs(shell), KrylovOptions())
    frequencies = np.sqrt(reduced.omega2) / (2.0 * np.pi)
    claimed = frequencies[(frequencies > 0.0) & (frequencies <= reduced.frequency_limit)]
    assert claimed.size >= 1
    full = natural_frequencies(shell, 40)
    for frequency in claimed:
        assert np.abs(full / frequency - 1.0).min() < 1.0e-6


@pytest.mark.slow
def test_a_helper_changes_no_bit_and_may_die() -> None:
    """Reference: one process alone."""
    shell, options = box_shell(0.5), KrylovOptions(moments=1)
    inputs = np.column_stack([_inputs(shell), shell.unit_loads["y"]])
    with workers(1) as helper:
        found = [reduce_segment(SymmetryReduction(shell), inputs, options)]
        found.append(reduce_segment(SymmetryReduction(shell), inputs, options, helper=helper))
        with pytest.raises(BrokenExecutor):
            helper.submit(os.abort).result()
        found.append(reduce_segment(SymmetryReduction(shell), inputs, options, helper=helper))
    assert len({one.omega2.tobytes() + one.shapes.tobytes() for one in found}) == 1


def test_dependent_inputs_add_no_coordinates() -> None:
    """The space is the same for any order, and with sums, copies and zeros among the inputs."""
    symmetry, inputs = _held()
    twice = np.column_stack([inputs, inputs[:, :1] + inputs[:, 1:2], 0.0 * inputs, inputs])
    once, again = (
        reduce_segment(symmetry, block, KrylovOptions(moments=2)) for block in (inputs, twice)
    )
    assert again.omega2 == pytest.approx(once.omega2, rel=1.0e-9)


def test_segment_without_inputs_has_no_coordinates() -> None:
    shell = box_shell(0.5)
    message = "^nothing acts on a segment, and it has no motion: give it a load$"
    with pytest.raises(NumericsError, match=message):
        reduce_segment(SymmetryReduction(shell), np.zeros((shell.free.size, 2)), KrylovOptions())


def _measured(shell: SegmentShell, reduced: ReducedSegment, inputs: Array, rows: Array) -> float:
    """Return the larger relative error of compliance and outputs, against full solves."""
    gains, read = reduced.shapes.T @ inputs, reduced.shapes.T @ rows
    worst = 0.0
    for frequency in (0.1, 20.0, 120.0, 400.0, 700.0):
        solve = ShiftedSolver(shell, frequency)
        moved = solve(inputs)
        full, of_rows = inputs.T @ moved, np.einsum("ij,ij->j", rows, solve(rows))
        approximate = gains / (reduced.omega2 + solve.sigma)[:, None]
        solve.destroy()
        of_inputs = np.diag(full)
        off = (gains.T @ approximate - full) / np.sqrt(np.outer(of_inputs, of_inputs))
        off_read = (read.T @ approximate - rows.T @ moved) / np.sqrt(np.outer(of_rows, of_inputs))
        worst = max(worst, np.abs(off).max(), np.abs(off_read).max())
    return float(worst)


@pytest.mark.slow
def test_a_basis_grows_until_it_meets_the_tolerance() -> None:
    """Reference: full solves at other frequencies, below twice the tolerance."""
    symmetry, inputs = _held()
    shell = symmetry.shell
    end = shell.outline(10.0)
    rows = np.column_stack([shell.row(end.mean_deflection()), shell.row(end.rotation())])
    sizes = []
    for tolerance in (1.0e-3, 1.0e-6, 1.0e-9):
        options = KrylovOptions(tolerance=tolerance)
        reduced = reduce_segment(symmetry, inputs, options, outputs=rows)
        sizes.append(reduced.omega2.size)
        assert max(reduced.compliance_error, reduced.output_error) <= tolerance
        assert _measured(shell, reduced, inputs, rows) < 2.0 * tolerance
    assert sizes[0] < sizes[1] < sizes[2]


def test_no_more_coordinates_than_are_allowed() -> None:
    """Measured errors are larger with fewer coordinates; a missed tolerance is refused. Reference
    of the lost compliance: full solves at the frequencies of the tests.
    """
    symmetry, inputs = _held()
    few, more = (reduce_segment(symmetry, inputs, KrylovOptions(most=n)) for n in (12, 24))
    assert few.omega2.size <= 12 < more.omega2.size <= 24
    assert few.compliance_error > 10.0 * more.compliance_error
    lost = []
    for frequency in KrylovOptions().tests:
        solve = ShiftedSolver(symmetry.shell, frequency)
        full = np.einsum("ij,ij->j", inputs, solve(inputs))
        gains = (few.shapes.T @ inputs) ** 2
        lost.append(full - (gains / (few.omega2 + solve.sigma)[:, None]).sum(axis=0))
        solve.destroy()
    assert few.lost_compliance == pytest.approx(np.max(lost, axis=0), rel=1e-6)
    message = (
        r"^a segment's reduction errs by \d\.\de-0\d with \d+ coordinates in one of its planes, "
        r"and 1\.0e-09 is asked for; give a larger tolerance, or a coarser mesh, whose round-off "
        r"is less$"
    )
    with pytest.raises(NumericsError, match=message):
        reduce_segment(symmetry, inputs, KrylovOptions(tolerance=1.0e-9, most=20))


def test_probes_excite_more_classes_than_inputs() -> None:
    """Reference: other code path, a solver for the probes alone. No input acts along y."""
    shell = box_shell(0.5, supports=HELD)
    symmetry = SymmetryReduction(shell)
    up, aside = (shell.unit_load_vector(10.0, direction)[:, None] for direction in ("z", "y"))
    probes = np.hstack([up, aside])
    (found,) = reduce_segments([SegmentInputs(symmetry, up, up[:, :0], probes)], KrylovOptions())
    expected = shell_compliance(symmetry, probes, PROBE_FREQUENCY)
    assert (np.diag(expected) > 0.0).all()
    assert found.probe_compliance == pytest.approx(expected, rel=1e-9, abs=1e-15)
    assert np.abs(found.shapes.T @ aside).max() < 1e-9 * np.abs(found.shapes.T @ up).max()


def test_products_are_rounded_once() -> None:
    """Reference: analytic, Python's exact sum; a force and its negative image but for a bit."""
    generator = np.random.default_rng(3)
    sizes = 10.0 ** generator.uniform(-8.0, 8.0, (50_000, 1))
    left, right = generator.standard_normal(50_000), sizes * generator.standard_normal((50_000, 3))
    found = exact_product(MPI.COMM_SELF, left, right)
    assert found.tolist() == [math.fsum(left * column) for column in right.T]
    mirrored = np.concatenate([right, -right])
    mirrored[0] *= 1.0 + 2.3e-16
    assert not exact_product(MPI.COMM_SELF, np.concatenate([left, left]), mirrored).any()


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


@pytest.mark.parametrize("section", [BOX, UNEQUAL], ids=["box", "unequal"])
def test_a_quarter_moves_as_its_family_does_in_the_whole(section: Section) -> None:
    """Reference: other code path, the whole shell under the forces of this class."""
    shell = _laden(section)
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


def test_asymmetric_mesh_is_refused() -> None:
    mesh = mesh_segment(BOX, {"start": 0.0, "end": 10.0}, 0.5)
    mesh.points[np.abs(mesh.points[:, 0] - 5.0).argmin(), 0] += 0.01
    segment = box_segment("box", 0.0, 10.0, BOX)
    shell = assemble_segment(MPI.COMM_WORLD, segment, add_thickness(segment, mesh))
    message = "^a segment's mesh is not its own mirror image in y$"
    with pytest.raises(NumericsError, match=message):
        SymmetryReduction(shell)
