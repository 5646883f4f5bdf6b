# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static shell with any mesh of triangles, on one process.

Degrees of freedom are components along x, y and z, so that supports, loads and outputs do not
depend on the coordinate systems of the facets.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc

from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array, Indices, Mask
from protractile.geometry.boom import Material
from protractile.shell_model import compat
from protractile.shell_model.segment.forms import DRILLING, SHEAR_CORRECTION, ShellForms
from protractile.shell_model.segment.shell import ON_LINE, Attachments, Plates, ShellMatrices
from protractile.shell_model.segment.solver import times

# Permitted residual of a solution as a fraction of the load.
_UNBALANCED = 1.0e-3

# Prescribed value in m or rad by degree of freedom.
Held = Mapping[int, float]


class StaticShell:
    """Shell without supports.

    Args:
        points: (num_points, 3) in m.
        triangles: (num_triangles, 3) point numbers.
        thickness: thickness in m, one for all triangles or (num_triangles,).
        material: isotropic.
        drilling, shear_correction: see :func:`forms.ShellForms`.

    Attributes:
        nodes: positions (num_nodes, 3) of the displacement nodes in m: points and mid-sides.
        node_dofs: (num_nodes, 3) rows of their displacements.
        rotation_nodes: positions (num_edges, 3) of the rotation nodes in m: mid-sides.
        rotation_dofs: (num_edges, 3) rows of their rotations.
        stiffness: (num_dofs, num_dofs).
    """

    def __init__(
        self,
        points: Array,
        triangles: Indices,
        thickness: float | Array,
        material: Material,
        drilling: float = DRILLING,
        shear_correction: float = SHEAR_CORRECTION,
    ) -> None:
        domain = compat.create_mesh(MPI.COMM_SELF, points, triangles)
        space = compat.shell_space(domain)
        walls = compat.cellwise_function(
            domain, np.broadcast_to(np.asarray(thickness, dtype=float), len(triangles))
        )
        forms = ShellForms(space, walls, material, drilling, shear_correction=shear_correction)
        self._plates = Plates(space, forms, [])
        self.stiffness = compat.assemble_matrix(forms.stiffness, [], diagonal=1.0)
        (self.nodes, self.node_dofs), rotations = self._plates.nodes
        self.rotation_nodes, self.rotation_dofs = rotations

    @property
    def num_dofs(self) -> int:
        """Number of degrees of freedom."""
        return int(self.stiffness.getSize()[0])

    def node_at(self, place: Array) -> int:
        """Return the number of the displacement node at a place (3,) in m."""
        distance = np.linalg.norm(self.nodes - place, axis=1)
        node = int(distance.argmin())
        assert distance[node] < ON_LINE, f"no node at {place}"
        return node

    def at(self, axis: int, place: float) -> Mask:
        """Return the mask (num_nodes,) of displacement nodes at a coordinate in m along an axis."""
        return np.asarray(np.abs(self.nodes[:, axis] - place) < ON_LINE)

    def hold_at(
        self, axis: int, place: float, along: Sequence[int], about: Sequence[int] = ()
    ) -> dict[int, float]:
        """Return constraints of displacements along and rotations about axes, at a place in m."""
        turned = np.abs(self.rotation_nodes[:, axis] - place) < ON_LINE
        moved = self.node_dofs[self.at(axis, place)]
        return hold(moved[:, list(along)]) | hold(self.rotation_dofs[turned][:, list(about)])

    def mirror(self, axis: int) -> dict[int, float]:
        """Return the symmetry constraints on the plane through the origin normal to an axis."""
        return self.hold_at(axis, 0.0, [axis], [i for i in range(3) if i != axis])

    def surface_load(
        self, force: Array, couple: Array | None = None, on: Mask | None = None
    ) -> Array:
        """Return the load (num_dofs,) of a uniform force (3,) in N/m² and couple (3,) in N m/m².

        The load acts on the facets of the mask ``on`` (num_triangles,), by default on all.
        """
        v, eta = ufl.split(ufl.TestFunction(self._plates.space))
        domain = self._plates.space.mesh
        force_density, couple_density = (
            fem.Constant(domain, np.asarray(density, dtype=PETSc.ScalarType))
            for density in (force, np.zeros(3) if couple is None else couple)
        )
        power = ufl.dot(force_density, v) + ufl.dot(couple_density, eta)
        if on is not None:
            power *= compat.cellwise_function(domain, on.astype(float))
        form: Any = fem.form(power * ufl.dx(degree=2, domain=domain))
        return compat.assemble_vector(form)

    def point_load(self, place: Array, force: Array) -> Array:
        """Return the load (num_dofs,) of a force (3,) in N on the node at a position (3,) in m."""
        load = np.zeros(self.num_dofs)
        load[self.node_dofs[self.node_at(place)]] = force
        return load

    def line_load(self, on_line: Mask, force: Array) -> Array:
        """Return the load (num_dofs,) of a force (3,) in N, uniform along a line of edges.

        ``on_line`` is the mask (num_nodes,) of its nodes, alternately points and mid-sides.
        """
        nodes = np.flatnonzero(on_line)
        places = self.nodes[nodes]
        along = (places - places[0]) @ np.linalg.svd(places - places.mean(axis=0))[2][0]
        order = along.argsort()
        lengths = np.diff(along[order][::2])
        weights = np.zeros(nodes.size)
        # Simpson's rule, exact for quadratic functions along an edge.
        weights[:-1:2] += lengths / 6.0
        weights[1::2] += 4.0 * lengths / 6.0
        weights[2::2] += lengths / 6.0
        load = np.zeros(self.num_dofs)
        load[self.node_dofs[nodes[order]]] = np.outer(weights / lengths.sum(), force)
        return load

    def solve(self, held: Held, load: Array) -> Array:
        """Return displacements in m and rotations in rad (num_dofs,), by MUMPS.

        Args:
            held: constraints that prevent all rigid motions.
            load: load (num_dofs,) in N and N·m.

        Raises:
            NumericsError: rigid motions are possible, so that there is no equilibrium.
        """
        rows = np.fromiter(held, dtype=PETSc.IntType, count=len(held))
        matrix = self.stiffness.copy()
        right, solution = matrix.createVecs()
        right.array[:] = load
        solution.array[rows] = np.fromiter(held.values(), dtype=float, count=len(held))
        matrix.zeroRowsColumns(rows, 1.0, solution, right)
        matrix.setOption(PETSc.Mat.Option.SPD, True)
        solver = PETSc.KSP().create(MPI.COMM_SELF)
        solver.setOperators(matrix)
        solver.setType(PETSc.KSP.Type.PREONLY)
        factor = solver.getPC()
        factor.setType(PETSc.PC.Type.CHOLESKY)
        factor.setFactorSolverType("mumps")
        solver.solve(right, solution)
        found = solution.array.copy()
        size = right.norm()
        matrix.multAdd(-solution, right, right)
        unbalanced = right.norm()
        for thing in (solver, matrix, right, solution):
            thing.destroy()
        if not unbalanced <= _UNBALANCED * size:
            raise NumericsError("the shell does not carry its load; hold its rigid motions")
        return np.asarray(found)

    def forces(self, solution: Array) -> Array:
        """Return K times a solution (num_dofs,): forces in N and moments in N m."""
        return np.asarray(times(self.stiffness, solution[:, None])[:, 0])

    def held(self, dofs: Held) -> ShellMatrices:
        """Return the shell with fixed degrees of freedom, for vibration."""
        rows = np.fromiter(dofs, dtype=np.int32, count=len(dofs))
        zero = fem.Function(self._plates.space)
        conditions = [fem.dirichletbc(zero, np.sort(rows))]
        nothing = Attachments.from_rows([], [], self.num_dofs)
        return ShellMatrices(MPI.COMM_SELF, self._plates, conditions, nothing, nothing)


def hold(dofs: Indices, values: float | Array = 0.0) -> dict[int, float]:
    """Return constraints that prescribe a value, or a value for each degree of freedom."""
    values = np.broadcast_to(np.asarray(values, dtype=float), dofs.shape)
    return dict(zip(dofs.ravel().tolist(), values.ravel().tolist(), strict=True))
