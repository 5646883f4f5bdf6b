# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stresses of displacement shapes, in the frame of the boom's walls.

On a wall x runs along the boom and s around the section, so that x, s and the outward normal
are right-handed: along y on the top, along -z on the right. A diaphragm has y in the place of
x, and its normal points to the tip. Each triangle has the stresses of its centroid, which are
their means over it: the membrane strain is linear in it, the curvature constant.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc

from geometry.arrays import Array
from geometry.boom import Segment
from shell_model import compat
from shell_model.segment.forms import facet_frame, plane_stress, strains
from shell_model.segment.products import times
from shell_model.segment.segment_shell import SegmentShell
from shell_model.stress.stresses import COMPONENTS, Modes, triangle_areas


def gather_stress_modes(shell: SegmentShell, shapes: Array) -> Modes | None:
    """(num_modes, num_triangles, 6) ``COMPONENTS`` in Pa of displacement shapes on rank 0.

    Shapes are (num_owned, num_modes), this rank's rows. Collective; None elsewhere.
    """
    form, component = _stress_form(shell.space, shell.segment)
    columns = []
    for unit in np.eye(len(COMPONENTS)):
        component.value[:] = unit
        matrix = compat.assemble_matrix(form, [], diagonal=0.0)
        columns.append(times(matrix, shapes).astype(np.float32))
        matrix.destroy()
    domain = shell.space.mesh
    places = np.asarray(domain.topology.original_cell_index)[: len(columns[0])]
    gathered = shell.comm.gather((places, np.array(columns)))
    if gathered is None:
        return None
    mesh = shell.mesh
    assert mesh is not None
    modes = np.zeros((shapes.shape[1], len(mesh.triangles), len(COMPONENTS)), dtype=np.float32)
    for triangles, values in gathered:
        modes[:, triangles, :] = values.transpose(2, 1, 0)
    modes /= triangle_areas(mesh.points, mesh.triangles)[:, None].astype(np.float32)
    # The form knows the curvature; a face is half a thickness off.
    modes[:, :, 3:] *= 0.5 * mesh.thickness[:, None].astype(np.float32)
    return modes


def wall_frame(domain: Any) -> tuple[Any, Any, Any]:
    """Unit vectors x, s and the outward normal of each triangle, see the module."""
    _, _, e3 = facet_frame(domain)
    place = ufl.SpatialCoordinate(domain)
    # Of the two one is zero: the place's distance from the axis, or the slope to the axis.
    side = place[1] * e3[1] + place[2] * e3[2] + _far(domain) * e3[0]
    outward = ufl.conditional(ufl.gt(side, 0.0), 1.0, -1.0) * e3
    across = ufl.gt(abs(e3[0]), 0.5)
    axis = [ufl.conditional(across, float(i == 1), float(i == 0)) for i in range(3)]
    axis = ufl.as_vector(axis)
    along = axis - ufl.dot(axis, outward) * outward
    along = along / ufl.sqrt(ufl.dot(along, along))
    return along, ufl.cross(outward, along), outward


def _far(domain: Any) -> Any:
    """A length beside which no section is large, so that the normal of a diaphragm decides."""
    return fem.Constant(domain, PETSc.ScalarType(1.0e6))


def _stress_form(space: Any, segment: Segment) -> tuple[Any, Any]:
    """Compiled (cell, dof) form of a component times the area, and which component it is.

    The bending part is for a unit of the distance from the mid-surface.
    """
    domain = space.mesh
    component = fem.Constant(domain, np.zeros(len(COMPONENTS), dtype=PETSc.ScalarType))
    young, nu = (
        fem.Constant(domain, PETSc.ScalarType(value))
        for value in (segment.material.youngs_modulus, segment.material.poissons_ratio)
    )
    e1, e2, e3 = facet_frame(domain)
    along, around, outward = wall_frame(domain)
    turn = ufl.as_matrix([[ufl.dot(a, e) for e in (e1, e2)] for a in (along, around)])
    u, theta = ufl.split(ufl.TrialFunction(space))
    strain = strains(domain, u, theta)
    membrane = turn * plane_stress(young, nu, strain.membrane) * turn.T
    bending = turn * plane_stress(young, nu, strain.bending) * turn.T
    values = [
        factor * stress[i, j]
        for factor, stress in ((1.0, membrane), (ufl.dot(outward, e3), bending))
        for i, j in ((0, 0), (1, 1), (0, 1))
    ]
    test = ufl.TestFunction(compat.cellwise_space(domain))
    integrand = sum(weight * value for weight, value in zip(component, values, strict=True))
    return fem.form(integrand * test * ufl.dx(degree=1, domain=domain)), component
