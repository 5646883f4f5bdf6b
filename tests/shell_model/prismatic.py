# SPDX-License-Identifier: LGPL-3.0-or-later
"""Prismatic members with flat walls: torsion of open and closed sections, and boxes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from protractile.geometry.arrays import Array, Indices
from protractile.geometry.mesh import mesh_segment
from protractile.geometry.plating import plain_thickness
from protractile.geometry.section import Section
from protractile.shell_model.segment.cross_section import SectionNodes
from protractile.shell_model.segment.forms import DRILLING
from studies.reference_models.benchmarks import X, Y, Z, grid
from studies.reference_models.plates import STEEL
from studies.reference_models.shell_readings import flange_deflection
from studies.reference_models.single_segment import natural_frequencies
from studies.reference_models.static_shell import StaticShell, hold


@dataclass(frozen=True, slots=True)
class Member:
    """Member with flat walls between corners, along x from 0.

    Args:
        corners: (y, z) in m of the corners of the mid-line in order; the shear centre, about which
            the member twists, is y = z = 0.
        closed: True if a wall connects the last corner with the first.
        thickness: thickness of the walls in m.
        length: length in m.
    """

    corners: Sequence[tuple[float, float]]
    closed: bool
    thickness: float
    length: float

    @property
    def widths(self) -> Array:
        """Widths (num_walls,) in m."""
        return np.asarray(np.linalg.norm(np.diff(self._line, axis=0), axis=1))

    @property
    def thin_walled_constant(self) -> float:
        """Torsion constant J in m⁴: Σ b t³/3 (Saint-Venant 1855).

        A closed section adds 4 A² t/Σ b (Bredt 1896).
        """
        around = float(self.widths.sum())
        constant = around * self.thickness**3 / 3.0
        if self.closed:
            (y0, z0), (y1, z1) = self._line[:-1].T, self._line[1:].T
            area = 0.5 * abs(float(y0 @ z1 - y1 @ z0))
            constant += 4.0 * area**2 * self.thickness / around
        return constant

    @property
    def _line(self) -> Array:
        last = [self.corners[0]] if self.closed else []
        return np.array([*self.corners, *last])

    def mesh(self, n: int, m: int) -> tuple[Array, Indices]:
        """Return points (num_points, 3) in m and triangles: n edges across walls, m along x."""
        line = self._line
        count = n * (len(line) - 1)

        def surface(along: Array, around: Array) -> Array:
            place = around * (len(line) - 1)
            y, z = (np.interp(place, np.arange(len(line)), line[:, i]) for i in range(2))
            return np.stack([self.length * along, y, z], axis=1)

        points, triangles = grid(surface, m, count)
        if self.closed:
            column = np.arange(len(points)) % (count + 1)
            # On a closed section, the last point is the first one.
            same = np.arange(len(points)) - np.where(column == count, count, 0)
            kept = column < count
            number = np.cumsum(kept) - 1
            points, triangles = points[kept], number[same[triangles]]
        return points, triangles

    def torsion_constant(self, n: int, m: int) -> float:
        """Return J in m⁴ of the shell: torque over G times the rate of twist of the middle half.

        End sections rotate without distortion and are free to warp. The rate of twist is measured
        between the quarter points, away from local bending at the ends. The mesh has n edges across
        each wall and m along x; m is a multiple of four.
        """
        shell = StaticShell(*self.mesh(n, m), self.thickness, STEEL)
        turn = np.cross([1.0, 0.0, 0.0], shell.nodes)
        held: dict[int, float] = {}
        for x, angle in ((0.0, 0.0), (self.length, 1.0)):
            at = shell.at(X, x)
            held |= hold(shell.node_dofs[at][:, [Y, Z]], angle * turn[at][:, [Y, Z]])
        held |= hold(shell.node_dofs[:1, X])
        solution = shell.solve(held, np.zeros(shell.num_dofs))
        moved = solution[shell.node_dofs]
        end = shell.at(X, self.length)
        torque = float((shell.forces(solution)[shell.node_dofs] * turn)[end].sum())
        angles = []
        for x in (0.25 * self.length, 0.75 * self.length):
            at = shell.at(X, x)
            off = turn[at] - turn[at].mean(axis=0)
            angles.append(float((off * moved[at]).sum() / (off**2).sum()))
        rate = (angles[1] - angles[0]) / (0.5 * self.length)
        return torque / (STEEL.shear_modulus * rate)


# An angle section with two legs of 100 mm, and a box of 100 mm by 60 mm.
ANGLE = Member([(0.1, 0.0), (0.0, 0.0), (0.0, 0.1)], False, 0.001, 1.0)
BOX = Member([(-0.03, -0.05), (0.03, -0.05), (0.03, 0.05), (-0.03, 0.05)], True, 0.001, 1.0)


@dataclass(frozen=True, slots=True)
class PlainBox:
    """Steel box along x from 0.

    Args:
        section: section of the box.
        length: length in m.
    """

    section: Section
    length: float

    def shell(
        self,
        size: float,
        drilling: float = DRILLING,
        turn: Array | None = None,
        breaks: Mapping[str, float] | None = None,
    ) -> StaticShell:
        """Return the shell of the box.

        Args:
            size: target edge length in m.
            drilling: see ``forms.ShellForms``.
            turn: rotation matrix (3, 3) of the box.
            breaks: x in m of mesh lines, in addition to the ends.
        """
        lines = {"start": 0.0, "end": self.length, **(breaks or {})}
        mesh = mesh_segment(self.section, lines, size)
        points = mesh.points if turn is None else mesh.points @ turn.T
        thickness = plain_thickness(self.section, mesh)
        return StaticShell(points, mesh.triangles, thickness, STEEL, drilling)

    def free_frequencies(
        self, size: float, count: int, drilling: float = DRILLING, turn: Array | None = None
    ) -> Array:
        """Return the lowest elastic frequencies (count,) in Hz; arguments as in :meth:`shell`."""
        free = self.shell(size, drilling, turn).held({})
        return np.asarray(natural_frequencies(free, 6 + count)[6:])

    def compliance(
        self, size: float, supports: Sequence[float], x: float, y: float, drilling: float = DRILLING
    ) -> float:
        """Return the vertical compliance in m/N of the top flange at the points (x, ±y).

        Args:
            size: target edge length in m.
            supports: x in m at which the outline is fixed along y and z.
            x, y: x and y in m.
            drilling: see ``forms.ShellForms``.
        """
        breaks = {f"place-{place:g}": place for place in (*supports, x)}
        shell = self.shell(size, drilling, breaks=breaks)
        held = hold(shell.node_dofs[:1, X])
        for support in supports:
            held |= shell.hold_at(X, support, [Y, Z])
        at = shell.at(X, x)
        outline = SectionNodes(x, shell.nodes[at], shell.node_dofs[at], self.section)
        force = np.zeros(shell.num_dofs)
        for dof, weight in flange_deflection(outline, 1.0, y).items():
            force[dof] = weight
        return float(force @ shell.solve(held, force))
