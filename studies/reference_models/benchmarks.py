# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shell benchmarks (MacNeal and Harder 1985).

Flat facets between points on a structured grid form curved surfaces. Lengths, forces and moduli are
in the consistent units of the sources.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from protractile.geometry.arrays import Array, Indices
from protractile.geometry.boom import Material
from protractile.shell_model.segment.forms import DRILLING_OF_CURVED, SHEAR_CORRECTION
from studies.reference_models.static_shell import StaticShell, hold

X, Y, Z = 0, 1, 2
# Shear correction in place of 5/6, which makes shear strain negligible.
SHEAR_RIGID = 100.0


class TwistedBeam(NamedTuple):
    """Tip deflections of a pretwisted cantilever under unit forces.

    One force acts along the width of the tip, the other across it.
    """

    in_plane: float
    out_of_plane: float


class Published(NamedTuple):
    """Published values; the fields have the names of the functions of this module."""

    scordelis_lo_roof: float
    pinched_cylinder: float
    hemisphere: float
    twisted_beam: TwistedBeam


PUBLISHED = Published(0.3024, 1.8248e-5, 0.0940, TwistedBeam(5.4245e-3, 1.7532e-3))


def grid(surface: Callable[[Array, Array], Array], n: int, m: int) -> tuple[Array, Indices]:
    """Return points and triangles on a surface, with alternating diagonals.

    ``surface`` returns positions (num, 3) for two parameters (num,) from 0 to 1. With n and m edges
    along them, the grid has points ((n + 1)(m + 1), 3) and triangles (2 n m, 3).
    """
    first, second = np.meshgrid(
        np.linspace(0.0, 1.0, n + 1), np.linspace(0.0, 1.0, m + 1), indexing="ij"
    )
    number = np.arange((n + 1) * (m + 1)).reshape(n + 1, m + 1)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    turn = np.add.outer(np.arange(n), np.arange(m)) % 2 == 0
    one = np.where(turn, [a, b, c], [a, b, d])
    other = np.where(turn, [a, c, d], [b, c, d])
    triangles = np.concatenate([one.reshape(3, -1).T, other.reshape(3, -1).T])
    return surface(first.ravel(), second.ravel()), triangles


def scordelis_lo_roof(n: int, drilling: float = DRILLING_OF_CURVED) -> float:
    """Return the deflection at mid-length of the free edges of a barrel vault under its weight.

    Scordelis and Lo (1964): radius 25, length 50, thickness 0.25, half angle 40°, diaphragms at
    both ends. The mesh is a quarter with n edges along each side.
    """
    radius, half_length, opening = 25.0, 25.0, np.radians(40.0)

    def surface(along: Array, around: Array) -> Array:
        angle = opening * around
        return np.stack(
            [half_length * along, radius * np.sin(angle), radius * np.cos(angle)], axis=1
        )

    shell = StaticShell(*grid(surface, n, n), 0.25, Material(4.32e8, 0.0, 1.0), drilling)
    held = shell.mirror(X) | shell.mirror(Y) | shell.hold_at(X, half_length, [Y, Z])
    solution = shell.solve(held, shell.surface_load(np.array([0.0, 0.0, -90.0])))
    middle = shell.node_at(surface(np.zeros(1), np.ones(1))[0])
    return float(-solution[shell.node_dofs[middle, Z]])


def pinched_cylinder(
    n: int, drilling: float = DRILLING_OF_CURVED, shear_correction: float = SHEAR_CORRECTION
) -> float:
    """Return the displacement of two opposite forces of 1 at mid-length of a cylinder.

    Radius 300, length 600, thickness 3, diaphragms at its ends (Flügge 1960; Belytschko et al.
    1985). The mesh is an eighth. The published value belongs to a shell without shear strain, in
    which the deflection under a point force is finite. With shear it diverges as ln(1/h) / (2π ·
    5/6 G t), by 0.3 % of the value for each factor e of h.

    Args:
        n: number of edges along each side of the eighth; edges are shorter near the force.
        drilling, shear_correction: see ``forms.ShellForms``.
    """
    radius, half_length = 300.0, 300.0

    def surface(along: Array, around: Array) -> Array:
        angle = 0.5 * np.pi * around**2
        return np.stack(
            [half_length * along**2, radius * np.sin(angle), radius * np.cos(angle)], axis=1
        )

    material = Material(3.0e6, 0.3, 1.0)
    shell = StaticShell(*grid(surface, n, n), 3.0, material, drilling, shear_correction)
    held = shell.hold_at(X, half_length, [Y, Z])
    held |= shell.mirror(X) | shell.mirror(Y) | shell.mirror(Z)
    pushed = np.array([0.0, 0.0, radius])
    solution = shell.solve(held, shell.point_load(pushed, np.array([0.0, 0.0, -0.25])))
    return float(-solution[shell.node_dofs[shell.node_at(pushed), Z]])


def hemisphere(n: int, drilling: float = DRILLING_OF_CURVED) -> float:
    """Return the displacement of a force at the equator of a hemisphere: two pairs of forces of 2.

    Radius 10, thickness 0.04, a hole of 18° at the pole. The mesh is a quarter with n edges per
    side.
    """
    radius, top = 10.0, np.radians(72.0)

    def surface(up: Array, around: Array) -> Array:
        latitude, longitude = top * up, 0.5 * np.pi * around
        out = radius * np.cos(latitude)
        return np.stack(
            [out * np.cos(longitude), out * np.sin(longitude), radius * np.sin(latitude)], axis=1
        )

    shell = StaticShell(*grid(surface, n, n), 0.04, Material(6.825e7, 0.3, 1.0), drilling)
    out, inward = np.array([radius, 0.0, 0.0]), np.array([0.0, radius, 0.0])
    pulled = shell.node_at(out)
    held = shell.mirror(X) | shell.mirror(Y) | hold(shell.node_dofs[[pulled], Z])
    load = shell.point_load(out, np.array([1.0, 0.0, 0.0]))
    load += shell.point_load(inward, np.array([0.0, -1.0, 0.0]))
    return float(shell.solve(held, load)[shell.node_dofs[pulled, X]])


def twisted_beam(n: int, drilling: float = DRILLING_OF_CURVED) -> TwistedBeam:
    """Return tip deflections of a strip with a twist of 90° over its length.

    Length 12, width 1.1, thickness 0.32; n edges over the width and 6 n along.
    """
    length, width = 12.0, 1.1

    def surface(along: Array, across: Array) -> Array:
        angle, s = 0.5 * np.pi * along, width * (across - 0.5)
        return np.stack([length * along, s * np.cos(angle), s * np.sin(angle)], axis=1)

    shell = StaticShell(*grid(surface, 6 * n, n), 0.32, Material(29.0e6, 0.22, 1.0), drilling)
    held = shell.hold_at(X, 0.0, [X, Y, Z], [X, Y, Z])
    tip = shell.at(X, length)
    middle = shell.node_dofs[shell.node_at(np.array([length, 0.0, 0.0]))]
    in_plane, out_of_plane = (
        shell.solve(held, shell.line_load(tip, np.eye(3)[axis]))[middle[axis]] for axis in (Z, Y)
    )
    return TwistedBeam(float(in_plane), float(out_of_plane))
