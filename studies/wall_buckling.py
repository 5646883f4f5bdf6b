# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling of walls: plates with known factors, boxes against finite strips and CalculiX."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.boom import Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.contact_places import ContactInterval
from protractile.geometry.section import Section
from protractile.shell_model.buckling import BucklingModes, buckling_modes, with_springs
from protractile.shell_model.contact.wall_rows import CornerLines
from protractile.shell_model.segment.segment_shell import SegmentShell
from protractile.shell_model.stress.fields import gather_stress_modes
from studies.reference_models.benchmarks import X, Y, Z, grid
from studies.reference_models.finite_strip import StressField, Strips
from studies.reference_models.plates import STEEL, rectangle
from studies.reference_models.single_segment import at_rest, shell_alone
from studies.reference_models.static_shell import StaticShell, hold
from studies.refined import Reference, Refined, refined_table
from studies.study import Piece, Progress, define_study

# Thickness of the plates over their width.
THIN = 0.005

# π² D/t³ in Pa, with the bending stiffness D of a plate.
UNIT = np.pi**2 * STEEL.youngs_modulus / (12.0 * (1.0 - STEEL.poissons_ratio**2))

NOTES = (
    "Edges across a plate, or across the widest wall of a box. Order, limit and index of the three "
    "finest values. Plates are k = σ t b²/(π² D); boxes are load factors of a stress of 100 MPa.",
    "Finite strips are Kirchhoff's; shear lowers the factor of a wall by about 5.6 (t/b)².",
)


class Sizes(NamedTuple):
    """Numbers of edges across a plate or a wall; each is twice the previous number."""

    plate: Sequence[int] = (8, 16, 32)
    box: Sequence[int] = (8, 16, 32)
    column: Sequence[int] = (4, 8, 16)


@dataclass(frozen=True, slots=True)
class LoadedPlate:
    """Simply supported plate, 1 m wide, under membrane forces constant along its length."""

    name: str
    aspect: float  #: length over width
    #: N_x, N_s, N_xs over π² D/b² at the lower and at the upper edge, linear in between.
    forces: tuple[tuple[float, float, float], tuple[float, float, float]]
    factor: float  #: buckling coefficient k of the source
    source: str  #: author and year

    def shell(self, n: int, count: int = 1) -> Array:
        """Return the lowest buckling coefficients (count,) by a shell with n edges across."""
        points, triangles = grid(rectangle(self.aspect, 1.0), round(n * self.aspect), n)
        shell = StaticShell(points, triangles, THIN, STEEL)
        held = hold(shell.node_dofs[:, [X, Y]]) | hold(shell.rotation_dofs[:, Z])
        for axis, size in ((X, self.aspect), (Y, 1.0)):
            for edge in (0.0, size):
                held |= shell.hold_at(axis, edge, [Z], [axis])
        unit = UNIT * THIN**3
        across = points[triangles, Y].mean(axis=1)[:, None]
        lower, upper = np.array(self.forces)
        forces = unit * ((1.0 - across) * lower + across * upper)
        return buckling_modes(shell.held(held), forces, count).factors


_PRESSED, _PULLED, _SHEARED = (-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)

_TIMOSHENKO = "Timoshenko and Gere 1961"

PLATES = (
    LoadedPlate("square plate in compression", 1.0, (_PRESSED, _PRESSED), 4.0, "Bryan 1891"),
    LoadedPlate("square plate in shear", 1.0, (_SHEARED, _SHEARED), 9.34, _TIMOSHENKO),
    LoadedPlate("plate 2 × 1 in bending", 2.0, (_PRESSED, _PULLED), 23.88, _TIMOSHENKO),
)


class LoadedBox(NamedTuple):
    """Box under axial stresses, on supports that keep the shape of its ends."""

    name: str
    section: Section
    length: float  #: length in m
    bending: float = 0.0  #: bending stress in Pa at z = 1 m, positive in tension
    compression: float = 0.0  #: uniform compressive stress in Pa

    def stress(self, y: Array, z: Array) -> Array:
        """Return the axial stress (num_places,) in Pa at y and z (num_places,) in m."""
        return self.bending * z - self.compression

    def supported(self, n: int) -> SegmentShell:
        """Return the shell on its supports, with n edges across the widest wall."""
        return _supported(self.section, self.length, n)

    def shell(self, n: int, count: int = 1) -> tuple[SegmentShell, BucklingModes]:
        """Return the shell and its buckling modes, with n edges across the widest wall."""
        shell = self.supported(n)
        return shell, buckling_modes(shell, self.membrane_forces(shell), count)

    def pressed(self, n: int) -> tuple[SegmentShell, Array, Array]:
        """Return the shell, its loads (num_owned,) at both ends, and its membrane forces in N/m.

        The supports prevent transverse strain of the ends, so that stresses vary near them.
        """
        shell = self.supported(n)
        start, end = (shell.row(shell.outline(x).mean_displacement(X)) for x in (0.0, self.length))
        load = self.compression * self.section.area * (start - end)
        return shell, load, _forces_under(shell, load)

    def membrane_forces(self, shell: SegmentShell) -> Array:
        """Return N_x, N_s, N_xs (num_triangles, 3) in N/m."""
        mesh = shell.mesh
        assert mesh is not None
        _, y, z = mesh.points[mesh.triangles].mean(axis=1).T
        return np.outer(mesh.thickness * self.stress(y, z), [1.0, 0.0, 0.0])

    def strips(self, most: int = 12) -> float:
        """Return the lowest factor by finite strips, over numbers of half-waves up to a maximum."""
        stress: StressField = self.stress
        return Strips.of(self.section, STEEL).lowest(self.length, range(1, most + 1), stress)


class PressedBox(NamedTuple):
    """Box on the supports of :class:`LoadedBox`, under patch loads at midspan on both webs."""

    section: BoxSection  #: section with thick flanges
    length: float  #: length a of the box in m
    patch: float  #: length of the load in m

    def shell(self, n: int) -> float:
        """Return k_F = F h/(π² D) of a web by a shell with n edges over its height.

        The membrane forces are those of the same shell under the load.
        """
        shell = _supported(self.section, self.length, n)
        middle, half = 0.5 * self.length, 0.5 * self.patch
        pressed = ContactInterval(middle - half, middle + half, middle)
        force = -shell.row(CornerLines(shell).deflection(pressed, "z", 0.0, 1))
        each = 0.5 * float(buckling_modes(shell, _forces_under(shell, force), 1).factors[0])
        height, web = self.section.height, self.section.web
        return each * height / (UNIT * web**3)

    @property
    def fitted(self) -> float:
        """The coefficient k_F by the formula of EN 1993-1-5, 6.4 (1)."""
        return float(6.0 + 2.0 * (self.section.height / self.length) ** 2)


def _supported(section: Section, length: float, n: int) -> SegmentShell:
    """Return a box on supports at its ends and along x, with n edges across its widest wall."""
    supports = Support(0.0), Support(length)
    segment = Segment.of_section("box", 0.0, length, STEEL, section, supports=supports)
    shell = shell_alone(segment, max(plate.length for plate in section.plates) / n)
    slide = shell.row(shell.outline(0.0).mean_displacement(X))
    springs = with_springs(shell.springs, slide[:, None], np.array([1.0e10]))
    return replace(shell, springs=springs)


def _forces_under(shell: SegmentShell, load: Array) -> Array:
    """Return N_x, N_s, N_xs (num_triangles, 3) in N/m under a load (num_owned,)."""
    modes = gather_stress_modes(shell, at_rest(shell, load[:, None]))
    assert modes is not None
    assert shell.mesh is not None
    forces: Array = shell.mesh.thickness[:, None] * modes[0, :, :3].astype(float)
    return forces


_STRESS = 1.0e8
TUBE = BoxSection(height=0.4, width=0.4, flange=0.004, web=0.004)
UNEQUAL = BoxSection(height=0.6, width=0.45, flange=0.006, web=0.004, bottom_flange=0.005)
STOUT = BoxSection(height=0.3, width=0.3, flange=0.01, web=0.01)

BOXES = (
    LoadedBox("square tube in compression", TUBE, 1.2, compression=_STRESS),
    LoadedBox("square tube in bending", TUBE, 1.2, bending=_STRESS / 0.2),
    LoadedBox("box of unequal walls in compression", UNEQUAL, 1.2, compression=_STRESS),
    LoadedBox("box of unequal walls in bending", UNEQUAL, 1.2, bending=_STRESS / 0.3),
    LoadedBox("the same in both", UNEQUAL, 1.2, 0.5 * _STRESS / 0.3, 0.5 * _STRESS),
)
# Column of a length for which walls and whole column buckle at about the same stress.
COLUMN = LoadedBox("column of box section", STOUT, 22.0 * 0.3, compression=_STRESS)

# Lowest factors of boxes with loads at their ends by CalculiX 2.20, by the number of edges across a
# wall. Runs had a tenth of the stress of the tube and five times the stress of the column, since
# CalculiX does not find factors below 1.
CALCULIX = (
    (BOXES[0], {8: 0.7870369, 16: 0.7482351, 32: 0.7425086}),
    (COLUMN, {4: 6.954725, 8: 6.95531, 16: 6.955495}),
)

PRESSED = tuple(
    PressedBox(BoxSection(height=0.5, width=0.25, flange=0.012, web=0.004), length, 0.1)
    for length in (0.5, 1.0)
)


@define_study("wall-buckling", "Buckling of walls")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Compare plates with known factors, and boxes with finite strips and CalculiX."""
    sizes = sizes or Sizes()
    progress("plates")
    found = []
    for plate in PLATES:
        values = [float(plate.shell(n)[0]) for n in sizes.plate]
        reference = Reference(plate.factor, "analytic", plate.source, 0.01)
        found.append(Refined.by_edges(plate.name, "", sizes.plate, values, reference))
    for box, edges in (*((box, sizes.box) for box in BOXES), (COLUMN, sizes.column)):
        progress(box.name)
        values = [float(box.shell(n)[1].factors[0]) for n in edges]
        reference = Reference(box.strips(), "other code", "finite strips, Cheung 1976", 0.01)
        found.append(Refined.by_edges(box.name, "", edges, values, reference))
    source = "CalculiX 2.20, S6 elements on the same mesh"
    for box, known in CALCULIX:
        edges = sizes.column if box is COLUMN else sizes.box
        progress(f"{box.name}, loads at its ends")
        states = [box.pressed(n) for n in edges]
        values = [float(buckling_modes(shell, forces, 1).factors[0]) for shell, _, forces in states]
        reference = Reference(known[edges[-1]], "external", source, 0.01)
        found.append(
            Refined.by_edges(f"{box.name}, loads at its ends", "", edges, values, reference)
        )
    for pressed in PRESSED:
        progress(f"patch load on {pressed.length:g} m")
        values = [pressed.shell(n) for n in sizes.box]
        reference = Reference(pressed.fitted, "external", "EN 1993-1-5, 6.4, a fit", 0.15)
        what = f"k_F of a patch load, a/h = {pressed.length / pressed.section.height:g}"
        found.append(Refined.by_edges(what, "", sizes.box, values, reference))
    yield from (one.verification for one in found)
    title = "Walls of shells that buckle, against known factors"
    yield refined_table("wall-buckling", title, found, "edges × {:g}", NOTES)
