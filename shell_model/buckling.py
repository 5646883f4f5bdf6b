# SPDX-License-Identifier: LGPL-3.0-or-later
"""Linear buckling of the walls of a shell under the membrane forces of a static state.

A shell that carries the membrane forces n_ab, positive in tension, buckles under λ times these
forces in the shape d where

    (K + λ K_n) d = 0,    dᵀ K_n d = ∫ n_ab u,a · u,b dA,

with all three components of its displacement u, which includes buckling of plates and of columns
(Bryan 1891; Zienkiewicz 1971). Forces keep their directions, and displacements before buckling are
neglected. Since K is positive definite, the lowest λ are the reciprocals of the largest eigenvalues
of −K_n d = λ⁻¹ K d: shift-and-invert at λ = 0, with one Cholesky factorisation of K. Many modes of
walls have nearly the same λ; a Krylov space with several vectors for each mode separates them.

Each segment buckles separately, on its supports, its cylinders and the tangent stiffness of its
closed contacts. At these places lateral motion and twist are fixed; at one of them, motion along
the boom is also fixed. :func:`.dynamics.second_order.buckling_factor` covers buckling of the whole
boom, such as column buckling.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import ufl
import xarray as xr
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc
from slepc4py import SLEPc

from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.ground import ground_lines
from protractile.geometry.plating import PlatedMesh
from protractile.shell_model import compat
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.contact.rows import ShellContacts, ties
from protractile.shell_model.segment.segment_shell import SegmentShell, assemble_segment
from protractile.shell_model.segment.shell import RIGID_TURN, Attachments, ShellMatrices
from protractile.shell_model.stress.fields import vertex_displacements, wall_frame
from protractile.shell_model.stress.stresses import ShellStress

# Relative residual of a mode. The error of its factor is of the order of the square.
_RESIDUAL = 1.0e-6

# Vectors of the Krylov space for each mode, and further ones.
_VECTORS, _BESIDES = 2, 20

# Fraction of the largest membrane force below which a force is round-off in single precision.
_ROUND_OFF = 1.0e-6

# Gap in m below which a contact counts as closed.
TOUCHING = 1.0e-6

# Order of convergence of the factors in the edge length.
_ORDER = 2.0


class BucklingModes(NamedTuple):
    """Lowest buckling modes of a shell."""

    factors: Array  #: (num_modes,) load factors λ in ascending order; empty without compression
    #: (num_owned, num_modes) this rank's displacements and rotations; the magnitude of the largest
    #: displacement is 1
    shapes: Array


def buckling_modes(shell: ShellMatrices, forces: Array, count: int) -> BucklingModes:
    """Return the lowest buckling modes of a shell. Collective.

    Args:
        shell: shell without rigid motions.
        forces: (num_triangles, 3) membrane forces n_x, n_s, n_xs in N/m, positive in tension, in
            the frame of :func:`.shell_model.stress.fields.wall_frame`; the same on every rank.
        count: number of modes.

    Raises:
        NumericsError: the shell has a rigid motion, or modes do not converge.
    """
    if shell.rigid_motions().shape[1]:
        raise NumericsError("the shell has a rigid motion, and cannot buckle; add a support")
    if not _has_compression(forces):
        return BucklingModes(np.zeros(0), np.zeros((shell.free.size, 0)))
    geometric_stiffness = _geometric_stiffness(shell, forces)
    solver = SLEPc.EPS().create(shell.comm)
    solver.setOperators(geometric_stiffness, shell.stiffness)
    solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    solver.setWhichEigenpairs(SLEPc.EPS.Which.LARGEST_REAL)
    solver.setDimensions(count, min(_VECTORS * count + _BESIDES, shell.num_dofs))
    solver.setTolerances(tol=_RESIDUAL)
    solve = solver.getST().getKSP()
    solve.setType(PETSc.KSP.Type.PREONLY)
    solve.getPC().setType(PETSc.PC.Type.CHOLESKY)
    solve.getPC().setFactorSolverType("mumps")
    shell.stiffness.setOption(PETSc.Mat.Option.SPD, True)
    solver.solve()
    converged = solver.getConverged()
    if converged < count:
        raise NumericsError(f"{converged} of {count} buckling modes converged; refine the mesh")
    inverse = np.array([solver.getEigenvalue(i).real for i in range(count)])
    vector, _ = shell.stiffness.createVecs()
    shapes = np.empty((vector.getLocalSize(), count), order="F")
    for i in range(count):
        solver.getEigenvector(i, vector)
        shapes[:, i] = vector.array
    for thing in (vector, solver, geometric_stiffness):
        thing.destroy()
    first, _ = shell.owned
    lengths = np.linalg.norm(shapes[shell.node_dofs - first], axis=1)
    largest = np.max(shell.comm.allgather(lengths.max(axis=0, initial=0.0)), axis=0)
    positive = inverse > 0.0
    return BucklingModes(1.0 / inverse[positive], (shapes / largest)[:, positive])


def _has_compression(forces: Array) -> bool:
    """Return whether a triangle has a compressive principal membrane force, beyond round-off."""
    n_x, n_s, n_xs = forces.T
    least = 0.5 * (n_x + n_s) - np.hypot(0.5 * (n_x - n_s), n_xs)
    return bool(least.min() < -_ROUND_OFF * np.abs(forces).max())


def with_springs(springs: Attachments, rows: Array, stiffness: Array) -> Attachments:
    """Return ``springs`` with further springs.

    Args:
        rows: (num_owned, num_springs) this rank's rows of the further springs.
        stiffness: (num_springs,) stiffness of each row in N/m or N·m.
    """
    return Attachments(np.hstack([springs.rows, rows]), np.append(springs.factors, stiffness))


def _geometric_stiffness(shell: ShellMatrices, forces: Array) -> PETSc.Mat:
    """Return −K_n (num_dofs, num_dofs) of membrane forces (num_triangles, 3). Collective."""
    domain = shell.space.mesh
    along, around, _ = wall_frame(domain)
    n_x, n_s, n_xs = (compat.cellwise_function(domain, component) for component in forces.T)
    u, _ = ufl.split(ufl.TrialFunction(shell.space))
    v, _ = ufl.split(ufl.TestFunction(shell.space))
    (u_x, u_s), (v_x, v_s) = (
        (ufl.dot(ufl.grad(w), along), ufl.dot(ufl.grad(w), around)) for w in (u, v)
    )
    work: Any = (
        n_x * ufl.dot(u_x, v_x)
        + n_s * ufl.dot(u_s, v_s)
        + n_xs * (ufl.dot(u_x, v_s) + ufl.dot(u_s, v_x))
    )
    form = fem.form(-work * ufl.dx(degree=2, domain=domain))
    matrix = compat.assemble_matrix(form, shell.conditions, 0.0)
    matrix.scale(shell.plates.copies)
    return matrix


@dataclass(frozen=True, slots=True)
class ShellState:
    """Static state of the shells of a boom."""

    #: membrane forces (num_triangles, 3) of each segment in N/m, as for :func:`buckling_modes`; the
    #: same on every rank
    forces: Sequence[Array]
    contact_stiffness: Array  #: (num_contacts,) tangent stiffness of each contact row in N/m
    #: extension of each joint in m, by its position in ``Boom.joints``
    extensions: Mapping[int, float]

    @classmethod
    def from_fields(
        cls,
        fields: xr.Dataset,
        system: GapSystem,
        position: Array,
        extensions: Mapping[int, float] = MappingProxyType({}),
    ) -> ShellState:
        """Return the state of a reduced shell at an equilibrium, on rank 0.

        Args:
            fields: fields of :func:`.shell_model.stress.fields.gather_fields`.
            system: gap system of the shell at these extensions.
            position: (num_modes,) equilibrium.
            extensions: extension of each joint in m.
        """
        static_fields = fields.assign(
            state=(("time", "mode"), position[None]), time=("time", [0.0])
        )
        stress = ShellStress.from_fields(static_fields)
        forces = stress.thickness[:, None] * stress.at(0.0).membrane.astype(np.float64)
        near = (system.rows @ position)[:, None] + [-TOUCHING, TOUCHING]
        slopes = [law.slope(gaps).max() for law, gaps in zip(system.laws, near, strict=True)]
        parts = np.flatnonzero(np.diff(stress.segment)) + 1
        return cls(np.split(forces, parts), np.array(slopes), extensions)


@dataclass(frozen=True, slots=True)
class SegmentBuckling:
    """The lowest buckling modes of the walls of a segment."""

    factors: Array  #: (num_modes,) λ in ascending order, extrapolated to a mesh size of zero
    mesh_errors: Array  #: (num_modes,) relative error of each factor on the finer mesh
    mesh: PlatedMesh | None  #: the finer mesh, on rank 0
    #: (num_modes, num_points, 3) displacements of the points of ``mesh``, on rank 0; the
    #: magnitude of the largest one is about 1
    shapes: Array | None


def buckle_segments(
    boom: Boom,
    meshes: Sequence[PlatedMesh | None],
    state: ShellState,
    options: ShellOptions,
    count: int,
    comm: MPI.Comm,
) -> list[SegmentBuckling]:
    """Return the lowest buckling modes of each segment of a boom at rest. Collective.

    Factors are computed on the given mesh and on one with edges of half the length. The logarithm
    of each factor is extrapolated (Richardson 1911), so that the factor stays positive. Factors of
    both meshes are paired in ascending order, since close modes may change places.

    Args:
        boom: boom of the shells.
        meshes: meshes of the segments, on rank 0; None elsewhere.
        count: number of modes of each segment.
        comm: the ranks that share the work.

    Raises:
        NumericsError: see :func:`buckling_modes`.
    """
    finer = [None if mesh is None else mesh.refined for mesh in meshes]
    coarse = _modes_on(boom, meshes, state, options, count, comm)
    halves = replace(state, forces=[np.repeat(force, 4, axis=0) for force in state.forces])
    fine = _modes_on(boom, finer, halves, options, count, comm)
    results = []
    for mesh, (before, _), (after, shapes) in zip(finer, coarse, fine, strict=True):
        common = min(before.size, after.size)
        before, after = before[:common], after[:common]
        factors = after * (after / before) ** (1.0 / (2.0**_ORDER - 1.0))
        # Extrapolation may change the order of close factors.
        order = np.argsort(factors)
        after, factors = after[order], factors[order]
        shapes = None if shapes is None else shapes[order]
        results.append(SegmentBuckling(factors, after / factors - 1.0, mesh, shapes))
    return results


def _modes_on(
    boom: Boom,
    meshes: Sequence[PlatedMesh | None],
    state: ShellState,
    options: ShellOptions,
    count: int,
    comm: MPI.Comm,
) -> Iterator[tuple[Array, Array | None]]:
    """Yield factors (num_modes,) and shapes (num_modes, num_points, 3) of each segment."""
    shells = [
        assemble_segment(comm, segment, mesh)
        for segment, mesh in zip(boom.segments, meshes, strict=True)
    ]
    touching = ShellContacts.from_shells(boom, shells, options.contact_line, options.surface)
    contacts = [contact.operator for contact in touching.rows(state.extensions).contacts]
    joined = [
        *zip(contacts, state.contact_stiffness.tolist(), strict=True),
        *((tie, None) for tie in ties(boom, shells)),
    ]
    lines = [line for line in ground_lines(boom, shells) if line.stiffness > 0.0]
    for number, shell in enumerate(shells):
        springs = [
            *(
                (shell.row(spring[number]), k or rigid_stiffness(shell))
                for spring, k in joined
                if number in spring and k != 0.0
            ),
            *((line.push, line.stiffness) for line in lines if line.segment == number),
            *lateral_springs(boom, number, shell),
        ]
        rows, stiffness = (np.array(part) for part in zip(*springs, strict=True))
        restrained = replace(shell, springs=with_springs(shell.springs, rows.T, stiffness))
        modes = buckling_modes(restrained, state.forces[number], count)
        restrained.stiffness.destroy()
        shapes = vertex_displacements(shell, modes.shapes)
        if shapes is not None:
            shapes = shapes.T.reshape(modes.factors.size, -1, 3)
        yield modes.factors, shapes


def rigid_stiffness(shell: SegmentShell) -> float:
    """Return the stiffness in N/m of a spring that is rigid compared with a segment."""
    segment = shell.segment
    return RIGID_TURN * segment.material.youngs_modulus * segment.area / segment.length


def lateral_springs(boom: Boom, number: int, shell: SegmentShell) -> Iterator[tuple[Array, float]]:
    """Yield (row, stiffness) of rigid springs against lateral motion, twist and axial motion.

    Rows are (num_owned,); stiffness is in N/m or N·m/rad. Collective.
    """
    segment = boom.segments[number]
    places = {
        x for joint in boom.joints if number in (joint.outer, joint.inner) for x in joint.stations
    }
    places |= {stop.x for stop in boom.stops if stop.segment == number}
    places |= {cylinder.x for cylinder in boom.cylinders if cylinder.segment == number}
    places |= {support.x for support in segment.supports}
    for x in sorted(places):
        outline = shell.outline(x)
        torsion = segment.material.shear_modulus * outline.section.torsion_constant
        yield shell.row(outline.wall_deflection("y")), rigid_stiffness(shell)
        yield shell.row(outline.twist()), RIGID_TURN * torsion / segment.length
    yield shell.row(outline.mean_displacement(0)), rigid_stiffness(shell)
