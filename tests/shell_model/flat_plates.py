# SPDX-License-Identifier: LGPL-3.0-or-later
"""Flat plates with exact solutions: constant strain, and a load on a patch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from geometry.arrays import Array, Indices
from shell_model.segment.shell import ON_LINE
from studies.reference_models.benchmarks import X, Y, Z, grid
from studies.reference_models.plates import STEEL, Field, rectangle, rigidities
from studies.reference_models.static_shell import StaticShell, hold

PATCH_THICKNESS = 0.05

# Columns are the directions of x, y and normal of the patch, oblique to all axes of space.
OBLIQUE = np.asarray(Rotation.from_rotvec([0.7, -1.1, 0.4]).as_matrix())


@dataclass(frozen=True, slots=True)
class ConstantStrain:
    """State of a plate on [0, 1]² with uniform strains.

    Args:
        name: label in tables.
        displacement: function of x and y (num,) in m that returns displacements (num, 3) in m along
            x, y and the normal of the plate.
        rotation: function of x and y that returns rotations (num, 3) in rad about these axes.
        membrane, bending: strains ε and curvatures κ in 1/m, (2, 2) each.
        shear: shear strains γ (2,).
    """

    name: str
    displacement: Field
    rotation: Field
    membrane: Array
    bending: Array
    shear: Array

    @property
    def couple(self) -> Array:
        """The couple (3,) per area in N·m/m² that equilibrium needs: e3 × Q for shear force Q."""
        q1, q2 = rigidities(PATCH_THICKNESS)[1] * self.shear
        return np.array([-q2, q1, 0.0])


def constant_strains() -> list[ConstantStrain]:
    """Return three states that together include all membrane, bending and shear strains.

    Bending is u_z = −κ_xx x²/2 − κ_yy y²/2 − κ_xy x y; normals remain perpendicular to the surface.
    """
    none, strain = np.zeros((2, 2)), 1.0e-3 * np.array([[1.0, 0.4], [0.4, -0.7]])
    spin, tilt = 6.0e-4, np.array([3.0e-4, -5.0e-4])
    gradient = strain + spin * np.array([[0.0, -1.0], [1.0, 0.0]])
    gamma = np.array([8.0e-4, -2.0e-4])
    slope = gamma + tilt

    def columns(x: Array, *values: Array | float) -> Array:
        return np.stack([np.broadcast_to(value, x.shape) for value in values], axis=1)

    def bent(x: Array, y: Array) -> Array:
        xx, yy, xy = strain[0, 0], strain[1, 1], strain[0, 1]
        return columns(x, 0.0, 0.0, -0.5 * (xx * x**2 + yy * y**2) - xy * x * y)

    def turned(x: Array, y: Array) -> Array:
        along_x, along_y = strain @ np.stack([x, y])
        return columns(x, -along_y, along_x, 0.0)

    return [
        ConstantStrain(
            "membrane",
            lambda x, y: columns(x, *(gradient @ np.stack([x, y])), 0.0),
            lambda x, y: columns(x, 0.0, 0.0, spin),
            strain,
            none,
            np.zeros(2),
        ),
        ConstantStrain("bending", bent, turned, none, strain, np.zeros(2)),
        ConstantStrain(
            "shear",
            lambda x, y: columns(x, 0.0, 0.0, slope[0] * x + slope[1] * y),
            lambda x, y: columns(x, tilt[1], -tilt[0], 0.0),
            none,
            none,
            gamma,
        ),
    ]


@dataclass(frozen=True, slots=True)
class Patch:
    """Distorted mesh of the plate on [0, 1]², oblique in space.

    Args:
        points: (num_points, 3) in m.
        triangles: (num_triangles, 3).
        shell: shell of steel, ``PATCH_THICKNESS`` thick.
    """

    points: Array
    triangles: Indices
    shell: StaticShell

    @classmethod
    def of(cls, n: int = 4) -> Patch:
        """Create a patch with n edges along each side and shifted inner points."""

        def surface(x: Array, y: Array) -> Array:
            inside = (np.abs(x - 0.5) < 0.5 - ON_LINE) & (np.abs(y - 0.5) < 0.5 - ON_LINE)
            off = 0.2 / n * inside
            x, y = x + off * np.sin(17.0 * x + 5.0 * y), y + off * np.cos(7.0 * x - 13.0 * y)
            return np.asarray(np.stack([x, y, np.zeros_like(x)], axis=1) @ OBLIQUE.T)

        points, triangles = grid(surface, n, n)
        return cls(points, triangles, StaticShell(points, triangles, PATCH_THICKNESS, STEEL))

    def exact(self, state: ConstantStrain) -> Array:
        """Return the exact solution (num_dofs,) in m and rad."""
        shell = self.shell
        solution = np.zeros(shell.num_dofs)
        for places, dofs, field in (
            (shell.nodes, shell.node_dofs, state.displacement),
            (shell.rotation_nodes, shell.rotation_dofs, state.rotation),
        ):
            x, y, _ = OBLIQUE.T @ places.T
            solution[dofs] = field(x, y) @ OBLIQUE.T
        return solution

    def solve(self, state: ConstantStrain) -> Array:
        """Return the shell's solution (num_dofs,), with the exact solution given at the edges."""
        shell, exact = self.shell, self.exact(state)
        held: dict[int, float] = {}
        for places, dofs in (
            (shell.nodes, shell.node_dofs),
            (shell.rotation_nodes, shell.rotation_dofs),
        ):
            edge = np.abs(places @ OBLIQUE[:, :2] - 0.5).max(axis=1) > 0.5 - ON_LINE
            held |= hold(dofs[edge], exact[dofs[edge]])
        return shell.solve(held, shell.surface_load(np.zeros(3), OBLIQUE @ state.couple))

    def error(self, state: ConstantStrain) -> float:
        """Return the largest error of a displacement or rotation, relative to the largest one."""
        found, exact = self.solve(state), self.exact(state)
        return max(
            float(np.abs(found[dofs] - exact[dofs]).max() / np.abs(exact[dofs]).max())
            for dofs in (self.shell.node_dofs, self.shell.rotation_dofs)
        )


@dataclass(frozen=True, slots=True)
class PressedPlate:
    """Steel plate on [0, length] × [0, width] on hard simple supports, under a load on a patch.

    Args:
        length, width: length and width in m.
        thickness: thickness in m.
        start, end: (x, y) in m of the patch's corners.
    """

    length: float
    width: float
    thickness: float
    start: tuple[float, float]
    end: tuple[float, float]

    def shell(self, size: float) -> float:
        """Return the mean deflection of the patch in m/N by the shell, under a uniform load of 1 N.

        Args:
            size: edge length in m; sides and patch corners are at whole multiples of it.
        """
        sides = (self.length, self.width)
        points, triangles = grid(rectangle(*sides), *(round(side / size) for side in sides))
        shell = StaticShell(points, triangles, self.thickness, STEEL)
        midpoints = points[triangles].mean(axis=1)[:, :2]
        pressed = ((midpoints > self.start) & (midpoints < self.end)).all(axis=1)
        area = (self.end[0] - self.start[0]) * (self.end[1] - self.start[1])
        load = shell.surface_load(np.array([0.0, 0.0, 1.0 / area]), on=pressed)
        held = hold(shell.node_dofs[:, [X, Y]])
        for axis, side in ((X, self.length), (Y, self.width)):
            for edge in (0.0, side):
                held |= shell.hold_at(axis, edge, [Z], [axis])
        held |= hold(shell.rotation_dofs[:, Z])
        return float(load @ shell.solve(held, load))

    def theory(self, terms: int = 400) -> float:
        """Return the deflection of :meth:`shell` by a double sine series (Navier 1823).

        It includes shear deflection, which adds to the bending deflection on these supports.
        """
        plate, shear = rigidities(self.thickness)
        waves = np.pi * np.arange(1, terms + 1)
        means = [
            (np.cos(waves * first / side) - np.cos(waves * last / side)) * side
            / (waves * (last - first))
            for side, first, last in zip(
                (self.length, self.width), self.start, self.end, strict=True
            )
        ]  # fmt: skip
        k2 = np.add.outer((waves / self.length) ** 2, (waves / self.width) ** 2)
        given = 4.0 / (self.length * self.width) * (1.0 / (plate * k2**2) + 1.0 / (shear * k2))
        return float((given * np.outer(*means) ** 2).sum())


# Plate like the outer flange of the paper's boom, under a pad beside its web.
FLANGE = PressedPlate(0.6, 0.3, 6.64e-3, (0.25, 0.025), (0.35, 0.075))
