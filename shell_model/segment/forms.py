# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shell forms in UFL: flat facets with the displacement u and the rotation θ, both 3D vectors.

Reissner-Mindlin kinematics in the frame of the facet: membrane strain ε, bending strain κ,
transverse shear γ. The rotation about the normal (drilling) has no stiffness in this theory. A
penalty couples this rotation to the in-plane rotation of the displacement (Hughes and Brezzi 1989),
so that bending moments pass folds. Quadratic displacements with Crouzeix-Raviart rotations
(Campello, Pimenta and Wriggers 2003) do not lock in thin walls.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from petsc4py import PETSc

from protractile.geometry.boom import Material

SHEAR_CORRECTION = 5.0 / 6.0

# Drilling penalty as a fraction of G t_w for a wall of the thickness t_w. It is independent of the
# mesh, so that refinement does not stiffen the shell. The drilling frequency is at least
# √(12 DRILLING G/ρ)/(2π t_w), 27 kHz for t_w = 6.5 mm.
#
# At a fold, the penalty must be soft: it couples the slope of one plate to the in-plane rotation of
# the other, which includes half of its shear strain. A stiff penalty would resist the shear flow.
DRILLING = 1.0e-2

# Drilling penalty as a fraction of G t_w for facets of a curved surface, where it must be stiff. In
# a surface with the twist b in 1/m, a bending moment m_ab has a couple b m_ab about the normal, and
# a soft penalty adds about (b t_w)² / DRILLING of the bending. The fraction 2 corresponds to the
# modulus G, since the skew strain counts twice (Hughes and Brezzi 1989).
DRILLING_OF_CURVED = 2.0


class Strains(NamedTuple):
    """Strains of the mid-surface in the frame (e1, e2, e3) of the facet.

    At the coordinate ζ along e3, the in-plane strain is ``membrane`` + ζ ``bending``.
    """

    membrane: Any  #: (2, 2) ε
    bending: Any  #: (2, 2) κ in 1/m
    shear: Any  #: (2,) γ
    drilling: Any  #: in-plane rotation of the facet less the rotation about e3, in rad


def facet_frame(domain: Any) -> tuple[Any, Any, Any]:
    """Return orthonormal e1 and e2 in the facet, and its normal e3, whose sign is arbitrary."""
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
    """Bilinear forms of a shell, and the linear form of a load of 1 N/m³, compiled at first use.

    Args:
        space: displacement and rotation, see :func:`compat.shell_space`.
        thickness: wall thickness t_w in m, constant on each cell.
        material: isotropic material.
        drilling: drilling penalty as a fraction of G t_w.
        shear_correction: transverse shear stiffness as a fraction of G t_w; a large value gives the
            thin shell of Kirchhoff and Love.
        compression: membrane force along x in N/m, constant on each cell, positive in compression.
        heavy: thickness in m that has mass, constant on each cell; ``thickness`` unless given.

    Attributes:
        loaded: thickness in m on which the unit load acts, constant on each cell; the caller may
            change it before assembly.
        load_direction: direction (3,) of the unit load; the caller sets it before assembly.
    """

    def __init__(
        self,
        space: Any,
        thickness: Any,
        material: Material,
        drilling: float = DRILLING,
        shear_correction: float = SHEAR_CORRECTION,
        compression: Any | None = None,
        heavy: Any | None = None,
    ) -> None:
        self._space, self._thickness, self._material = space, thickness, material
        self._drilling, self._shear_correction = drilling, shear_correction
        self._compression, self._heavy = compression, thickness if heavy is None else heavy
        self.loaded = thickness.copy()
        self.load_direction = fem.Constant(space.mesh, np.zeros(3, dtype=PETSc.ScalarType))

    @cached_property
    def stiffness(self) -> Any:
        """The bilinear form of the stiffness matrix K (num_dofs, num_dofs)."""
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
        """The bilinear form of the mass matrix M (num_dofs, num_dofs)."""
        t, density = self._thickness, self._constant(self._material.density)
        (u, theta), (v, eta) = self._trial_and_test()
        inertia = density * (self._heavy * ufl.inner(u, v) + t**3 / 12.0 * ufl.inner(theta, eta))
        return fem.form(inertia * ufl.dx(degree=4, domain=self._space.mesh))

    @cached_property
    def geometric(self) -> Any:
        """The bilinear form of the geometric stiffness K_G (num_dofs, num_dofs)."""
        (u, _), (v, _) = self._trial_and_test()
        work = self._compression * ufl.dot(ufl.grad(u)[:, 0], ufl.grad(v)[:, 0])
        return fem.form(work * ufl.dx(degree=2, domain=self._space.mesh))

    @cached_property
    def unit_load(self) -> Any:
        """The linear form of a load vector (num_dofs,) of 1 N/m³ on the thickness ``loaded``."""
        _, (v, _) = self._trial_and_test()
        load = self.loaded * ufl.dot(self.load_direction, v)
        return fem.form(load * ufl.dx(degree=2, domain=self._space.mesh))

    def _trial_and_test(self) -> tuple[Any, Any]:
        """Return the displacement and rotation of the trial and the test function."""
        return ufl.split(ufl.TrialFunction(self._space)), ufl.split(ufl.TestFunction(self._space))

    def _constant(self, value: float) -> Any:
        """Return a constant whose value is not compiled, so that all materials share a form."""
        return fem.Constant(self._space.mesh, PETSc.ScalarType(value))
