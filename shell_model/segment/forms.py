# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shell forms in UFL: flat facets with displacement u and rotation θ, both vectors in space.

Reissner-Mindlin kinematics in the facet's own frame: membrane strain ε, bending strain κ,
transverse shear γ. The rotation about the normal (drilling) has no stiffness of its own in
this theory; it is tied to the rotation that the displacement has in the facet's plane (Hughes
and Brezzi 1989), so that folded plates transfer their bending moments to one another.
Displacement quadratic and rotation Crouzeix-Raviart (Campello, Pimenta and Wriggers 2003) do
not lock as the wall becomes thin.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc

from geometry.boom import Material

SHEAR_CORRECTION = 5.0 / 6.0

# Part of G t that ties the drilling rotation. It does not depend on the mesh, so refinement
# does not stiffen the shell. With the wall's own inertia it has a frequency, from
# √(12 DRILLING G/ρ)/(2π t) on: 27 kHz in a wall of 6.5 mm.
#
# Where plates meet at an angle the tie must be soft: the rotation of one plate in its plane, which
# has half of its shear strain in it, is the slope of the other. A stiff tie takes both for the same
# and resists the shear flow around a box.
DRILLING = 1.0e-2

# Where facets approach a curved surface it must be stiff: a surface with the twist b (1/m)
# transfers a couple b M about its normal, and a soft tie gives way to it by some (b t)² / DRILLING
# of the bending. This is the modulus G, as the skew strain counts twice (Hughes and Brezzi 1989).
DRILLING_OF_CURVED = 2.0


class Strains(NamedTuple):
    """Strains of the mid-surface, in the facet's frame (e1, e2, e3).

    At the height ζ along e3 the strain in the facet is ``membrane`` + ζ ``bending``.

    Args:
        membrane: (2, 2) ε.
        bending: (2, 2) κ in 1/m.
        shear: (2,) γ.
        drilling: turn of the facet in its plane beyond the rotation about e3, in rad.
    """

    membrane: Any
    bending: Any
    shear: Any
    drilling: Any


def facet_frame(domain: Any) -> tuple[Any, Any, Any]:
    """Return orthonormal e1, e2 in the facet and e3 normal to it, from the cell's Jacobian.

    e3 has no preferred side: every strain is even in it, so the energy does not depend on it.
    """
    jacobian = ufl.Jacobian(domain)
    t1, t2 = (ufl.as_vector([jacobian[i, k] for i in range(3)]) for k in range(2))
    e3 = ufl.cross(t1, t2)
    e3 = e3 / ufl.sqrt(ufl.dot(e3, e3))
    e1 = t1 / ufl.sqrt(ufl.dot(t1, t1))
    return e1, ufl.cross(e3, e1), e3


def strains(domain: Any, u: Any, theta: Any) -> Strains:
    """Return the strains of a displacement u in m and a rotation θ in rad."""
    e1, e2, e3 = facet_frame(domain)
    plane = ufl.as_matrix([[e1[i] for i in range(3)], [e2[i] for i in range(3)]])
    gradient = ufl.grad(u)
    in_plane = plane * gradient * plane.T
    return Strains(
        membrane=ufl.sym(in_plane),
        bending=ufl.sym(plane * ufl.grad(ufl.cross(theta, e3)) * plane.T),
        shear=plane * (gradient.T * e3 + ufl.cross(theta, e3)),
        drilling=0.5 * (in_plane[1, 0] - in_plane[0, 1]) - ufl.dot(theta, e3),
    )


def plane_stress(young: Any, nu: Any, strain: Any) -> Any:
    """Return the stress (2, 2) in Pa of a strain (2, 2) in a plate in plane stress."""
    return young / (1.0 - nu**2) * ((1.0 - nu) * strain + nu * ufl.tr(strain) * ufl.Identity(2))


class ShellForms:
    """Bilinear forms of one shell and the linear form of a unit load, compiled on first use.

    The load is 1 N/m³ along ``load_direction`` on the thickness that carries it.

    Args:
        space: displacement and rotation, see :func:`compat.shell_space`.
        thickness: wall thickness t in m, constant on each cell.
        material: isotropic.
        drilling: part of G t that ties the drilling rotation.
        shear_correction: part of G t that resists transverse shear; a large one is a thin shell
            after Kirchhoff and Love, whatever its thickness.
        compression: membrane force along x in N/m, constant on each cell, positive where it
            presses; none unless given.

    Attributes:
        loaded: thickness in m that carries the unit load, constant on each cell; all of it unless
            whoever assembles the load sets another.
        load_direction: (3,) a constant that whoever assembles the load sets.
    """

    def __init__(
        self,
        space: Any,
        thickness: Any,
        material: Material,
        drilling: float = DRILLING,
        shear_correction: float = SHEAR_CORRECTION,
        compression: Any | None = None,
    ) -> None:
        self._space, self._thickness, self._material = space, thickness, material
        self._drilling, self._shear_correction = drilling, shear_correction
        self._compression = compression
        self.loaded = thickness.copy()
        self.load_direction = fem.Constant(space.mesh, np.zeros(3, dtype=PETSc.ScalarType))

    @cached_property
    def stiffness(self) -> Any:
        """Bilinear form of K (num_dofs, num_dofs), in N/m, N and N·m between u and θ.

        Twice the strain energy of a motion with itself.
        """
        domain, t, material = self._space.mesh, self._thickness, self._material
        young, nu = map(self._constant, (material.youngs_modulus, material.poissons_ratio))
        correction, drilling = map(self._constant, (self._shear_correction, self._drilling))
        shear_modulus = young / (2.0 * (1.0 + nu))
        (u, theta), (v, eta) = self._trial_and_test()
        strain, virtual = strains(domain, u, theta), strains(domain, v, eta)
        energy = (
            t * ufl.inner(plane_stress(young, nu, strain.membrane), virtual.membrane)
            + t**3 / 12.0 * ufl.inner(plane_stress(young, nu, strain.bending), virtual.bending)
            + correction * shear_modulus * t * ufl.inner(strain.shear, virtual.shear)
            + drilling * shear_modulus * t * strain.drilling * virtual.drilling
        )
        return fem.form(energy * ufl.dx(degree=2, domain=domain))

    @cached_property
    def mass(self) -> Any:
        """Bilinear form of M (num_dofs, num_dofs), in kg for u and kg·m² for θ.

        Twice the kinetic energy of velocities with themselves; u and θ do not couple.
        """
        t, density = self._thickness, self._constant(self._material.density)
        (u, theta), (v, eta) = self._trial_and_test()
        inertia = density * (t * ufl.inner(u, v) + t**3 / 12.0 * ufl.inner(theta, eta))
        return fem.form(inertia * ufl.dx(degree=4, domain=self._space.mesh))

    @cached_property
    def geometric(self) -> Any:
        """Bilinear form of K_G (num_dofs, num_dofs), in N/m for u and 0 for θ.

        It is twice the work that the membrane forces do as a motion shortens the walls along x.
        """
        (u, _), (v, _) = self._trial_and_test()
        work = self._compression * ufl.dot(ufl.grad(u)[:, 0], ufl.grad(v)[:, 0])
        return fem.form(work * ufl.dx(degree=2, domain=self._space.mesh))

    @cached_property
    def unit_load(self) -> Any:
        """Linear form of the unit load (num_dofs,), in N for u and 0 for θ."""
        _, (v, _) = self._trial_and_test()
        load = self.loaded * ufl.dot(self.load_direction, v)
        return fem.form(load * ufl.dx(degree=2, domain=self._space.mesh))

    def _trial_and_test(self) -> tuple[Any, Any]:
        """Return the displacement and rotation of the trial and the test function."""
        return ufl.split(ufl.TrialFunction(self._space)), ufl.split(ufl.TestFunction(self._space))

    def _constant(self, value: float) -> Any:
        """Return a form constant instead of a number: the compiled form serves every material."""
        return fem.Constant(self._space.mesh, PETSc.ScalarType(value))
