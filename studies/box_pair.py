# SPDX-License-Identifier: LGPL-3.0-or-later
"""Short pair of telescoped boxes, as shells and as solids.

Both are reduced by symmetry classes to a quarter, and read the same way, so that all quantities of
one can be compared with those of the other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

from geometry.arrays import Array
from geometry.boom import Segment, Support
from geometry.section import BoxSection
from shell_model.contact.wall_rows import gauss
from shell_model.reduction.mirror import ALONG_Z, BREATHING, TWISTING, SymmetryClass
from shell_model.reduction.symmetry import SymmetryReduction
from shell_model.segment.cross_section import Outline, Row
from shell_model.segment.shell import Shell
from shell_model.segment.solver import ShiftedSolver, times
from studies.motions import SLOW
from studies.reference_models.plates import STEEL
from studies.reference_models.single_segment import shell_alone
from studies.reference_models.solid import assemble_solid, mesh_quarter

# Distances in m of the mid-lines, which are the same for all wall thicknesses.
OUTER = (0.40, 0.30)
INNER = (0.31, 0.21)
# Positions in m of the outer box's end, and of both ends of the inner one.
HEAD, TAIL, TIP = 2.0, 1.5, 3.5

# Pads of 0.1 m in the inner box's corners at its tail, pressed along three lines (Simpson's rule).
PAD_WIDTH = 0.06
PADDED = {TAIL: 1.0 / 6.0, TAIL + 0.05: 4.0 / 6.0, TAIL + 0.1: 1.0 / 6.0}

FREQUENCY = "frequency"


class Probe(NamedTuple):
    """Reading of a segment, and force on it."""

    what: str  #: its name
    family: SymmetryClass  #: symmetry class of the motions
    places: Mapping[float, float]  #: x in m → weight of what is read there
    read: Callable[[Outline], Row]  #: of the section

    def row(self, outline: Callable[[float], Outline]) -> Row:
        """Return the row over all places; ``outline`` gives the section at x."""
        return sum((weight * self.read(outline(x)) for x, weight in self.places.items()), Row())


def pad_squeeze(outline: Outline) -> Row:
    """Return the increase of the flanges' distance under pads in the corners, in m."""
    half = 0.5 * outline.section.size("y")
    rows = (
        side * weight * outline.flange_deflection(side, y)
        for side in (1.0, -1.0)
        for y, weight in zip(*gauss(half - PAD_WIDTH, half, 4), strict=True)
    )
    return sum(rows, Row())


PROBES: tuple[Sequence[Probe], Sequence[Probe]] = (
    (
        Probe("head", ALONG_Z, {HEAD: 1.0}, partial(Outline.wall_deflection, direction="z")),
        Probe("head twist", TWISTING, {HEAD: 1.0}, Outline.twist),
    ),
    (
        Probe("tip", ALONG_Z, {TIP: 1.0}, partial(Outline.wall_deflection, direction="z")),
        Probe("tip twist", TWISTING, {TIP: 1.0}, Outline.twist),
        Probe("tail squeeze", BREATHING, {TAIL: 1.0}, Outline.distortion),
        Probe("pad squeeze", BREATHING, PADDED, pad_squeeze),
    ),
)


@dataclass(frozen=True, slots=True)
class Quarter:
    """Symmetry class of a segment's motions."""

    model: Shell  #: a quarter of a shell or of a solid, with the energies of the whole segment
    rows: Mapping[str, Array]  #: name of a probe → (num_dofs,)

    def measure(self) -> dict[str, float]:
        """Return the lowest elastic frequency in Hz under ``FREQUENCY``, and compliances by probe.

        Compliances are at ``SLOW``, in m/N or rad/(N·m). There is one factorisation.
        """
        model = self.model
        solve = ShiftedSolver(model, SLOW)
        inverse, mass, stiffness = (
            LinearOperator(
                (model.num_dofs,) * 2, matvec=lambda u, of=of: of(u.reshape(-1, 1))[:, 0]
            )
            for of in (solve, partial(times, model.mass), partial(times, model.stiffness))
        )
        rigid = model.rigid_motions().shape[1]
        # At a negative shift the matrix is positive definite, whatever motions are rigid.
        omega2 = eigsh(
            stiffness,
            rigid + 1,
            mass,
            sigma=-solve.sigma,
            OPinv=inverse,
            v0=np.sin(np.arange(model.num_dofs)) * model.free,
            return_eigenvectors=False,
        )
        moved = {what: float(row @ inverse(row)) for what, row in self.rows.items()}
        solve.destroy()
        return {FREQUENCY: float(np.sqrt(omega2.max()) / (2.0 * np.pi)), **moved}


def pair(wall: float) -> tuple[Segment, Segment]:
    """Return the outer box on two supports, and the free inner one.

    Args:
        wall: thickness of all walls in m.
    """
    held = (Support(0.0), Support(0.5))
    return box("outer", 0.0, HEAD, OUTER, wall, held), box("inner", TAIL, TIP, INNER, wall)


def shell_parts(
    segment: Segment, probes: Sequence[Probe], size: float
) -> dict[SymmetryClass, Quarter]:
    """Return a segment's symmetry classes as shells, with triangles of a size in m."""
    whole = shell_alone(segment, size, [x for probe in probes for x in probe.places])
    rows = np.column_stack([whole.row(probe.row(whole.outline)) for probe in probes])
    symmetry = SymmetryReduction(whole)
    return {
        job.symmetry_class: Quarter(
            job.shell(symmetry.cell),
            {
                probe.what: force
                for probe, force in zip(probes, job.forces.T, strict=True)
                if probe.family == job.symmetry_class
            },
        )
        for job in symmetry.jobs(rows, np.zeros((len(rows), 0)))
    }


def solid_parts(
    segment: Segment,
    probes: Sequence[Probe],
    along: tuple[float, float],
    around: float,
    splits: int,
    layers: int = 2,
) -> dict[SymmetryClass, Quarter]:
    """Return a segment's symmetry classes as solids; see :func:`mesh_quarter` for the sizes."""
    assert isinstance(segment.section, BoxSection)
    read = (x for probe in probes for x in probe.places)
    held = (support.x for support in segment.supports)
    places = sorted({segment.start, segment.end, *held, *read})
    mesh = mesh_quarter(segment.section, places, along, around, splits, layers)
    families = dict.fromkeys(probe.family for probe in probes)
    models = {family: assemble_solid(segment, mesh, family) for family in families}
    return {
        family: Quarter(
            model,
            {
                probe.what: model.row(probe.row(model.outline))
                for probe in probes
                if probe.family == family
            },
        )
        for family, model in models.items()
    }


def box(
    name: str,
    start: float,
    end: float,
    middles: tuple[float, float],
    wall: float,
    supports: tuple[Support, ...] = (),
) -> Segment:
    """Return a box of steel, with the distances in m of its mid-lines."""
    section = BoxSection(*middles, wall, wall)
    return Segment.of_section(name, start, end, STEEL, section, supports=supports)
