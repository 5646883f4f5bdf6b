# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compliance of a segment whose cross-section distorts under pads, estimated without a shell.

The theory is the generalised beam theory of closed folded plates (Schardt 1989); for boxes it is
the beam on an elastic foundation of Wright, Abdel-Samad and Robinson (1968). Plates bend in their
planes as beams, keep their width, and share the strain along the folds. A section of n plates has
n − 3 modes of distortion. They are orthogonal to the shear flows of forces (Jourawski 1856) and
torques (Bredt 1896), so that the shear flow that balances a pad force does no work in them. So the
distortion is additional to the displacements of a beam. Across x the plates form a frame, which
supports the modes as an elastic foundation along the whole segment.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag, null_space
from scipy.sparse.linalg import splu

from protractile.beam_model.hermite import HermiteAxis, sum_of_products
from protractile.geometry.arrays import Array
from protractile.geometry.material import Material
from protractile.geometry.polygon import ShearFlow
from protractile.geometry.section import COMPONENT, Direction, Section, Side
from protractile.geometry.segment import Segment
from protractile.geometry.stiffeners import Collar

# Length of elements along x as a fraction of the smaller side of the section.
_LENGTH = 0.5
# Fraction of this length below which places share a node.
_SAME_NODE = 1.0e-3
# Fraction of the displacements of the folds below which a displacement is round-off.
_ROUND_OFF = 1.0e-9


class Press(NamedTuple):
    """Contact force on a face of a segment.

    Args:
        x: x of the resultant in m.
        direction, side: direction and side of the face's outward normal.
        parts: fraction of the force, and its start and end across the face in m, for each part. A
            part without width acts along a line.
    """

    x: float
    direction: Direction
    side: Side
    parts: tuple[tuple[float, float, float], ...]


class _Frame(NamedTuple):
    """Plates around a section, which displace in the modes of distortion.

    Args:
        section: the section.
        axes: axis along each plate.
        shapes: outward displacements (num_dofs, num_modes) of each plate.
        bending, twisting, warping: stiffness (num_modes, num_modes) per length of the frame in
            N/m², of the plates against twist in N, and of the strains along x in N·m².
    """

    section: Section
    axes: Sequence[HermiteAxis]
    shapes: Sequence[Array]
    bending: Array
    twisting: Array
    warping: Array

    def row(self, press: Press) -> Array:
        """Return the mean outward displacement (num_modes,) of the pressed part of a face."""
        face = self.section.face(press.direction, press.side)
        plate, axis = self.section.plates[face.plate], self.axes[face.plate]
        across = 0 if press.direction == "z" else 1
        along = np.sign(plate.end[across] - plate.start[across])
        row = np.zeros(axis.nodes.size * 2)
        for part, *ends in press.parts:
            places = np.sort(along * (np.array(ends) - plate.start[across]))
            low, high = np.clip(places, 0.0, plate.length).tolist()
            row += part * (axis.mean(low, high) if high - low > self.section.near else axis.at(low))
        found = np.asarray(row @ self.shapes[face.plate])
        # Symmetric forces cause no antisymmetric distortion, except for round-off.
        return np.where(np.abs(found) > _ROUND_OFF, found, 0.0)


@lru_cache(maxsize=512)
def distortion_compliance(segment: Segment, presses: tuple[Press, ...]) -> Array:
    """Return the compliance (num_presses, num_presses) in m/N of a segment by its distortion.

    An entry is the mean outward displacement of one contact under a unit force on another. Rigid
    supports and diaphragms prevent the distortion at their x.

    Args:
        segment: segment with a section, collars, diaphragms and supports. A tapered one is treated
            as prismatic, with the section between the contacts.
        presses: contact forces.

    Returns:
        A read-only array, which later calls with the same arguments return again.
    """
    places = [press.x for press in presses]
    section = segment.section_at(0.5 * (min(places) + max(places)))
    rigid = [support for support in segment.supports if support.stiffness is None]
    closed = [*(diaphragm.x for diaphragm in segment.diaphragms), *(support.x for support in rigid)]
    ends = np.clip([x for collar in segment.collars for x in collar.span], *segment.ends)
    cuts = np.unique([*segment.ends, *places, *closed, *ends])
    size = _LENGTH * min(section.size("y"), section.size("z"))
    near = _SAME_NODE * size
    cuts = cuts[np.diff(cuts, prepend=-np.inf) > near]
    pieces = [
        np.linspace(*pair, 1 + int(np.ceil((pair[1] - pair[0]) / size))) for pair in pairwise(cuts)
    ]
    axis = HermiteAxis(np.unique(np.concatenate(pieces)), closed=False)

    def collars_at(x: float) -> tuple[Collar, ...]:
        return tuple(
            collar for collar in segment.collars if abs(x - collar.midpoint) < 0.5 * collar.length
        )

    around = [collars_at(x) for x in 0.5 * (axis.nodes[:-1] + axis.nodes[1:])]
    frames = {
        collars: _frame(segment.material, section, collars)
        for collars in dict.fromkeys((*around, *map(collars_at, places)))
    }
    rows = [np.kron(axis.at(press.x), frames[collars_at(press.x)].row(press)) for press in presses]
    compliance = np.zeros((len(rows),) * 2)
    if np.any(rows):
        lefts, rights = list[Array](), list[Array]()
        for collars in dict.fromkeys(around):
            frame = frames[collars]
            lefts += axis.integrals(
                np.array([collars_there == collars for collars_there in around], dtype=float)
            )[:3]
            rights += [frame.bending, frame.twisting, frame.warping]
        free = np.ones((axis.nodes.size, 2, rows[0].size // axis.nodes.size // 2), dtype=bool)
        for x in closed:
            free[np.abs(axis.nodes - x) <= near, 0] = False
        for support in rigid:
            if support.kind == "clamped":
                free[np.abs(axis.nodes - support.x) <= near] = False
        forces = np.array(rows)[:, free.ravel()]
        solve = splu(sum_of_products(lefts, rights, free.ravel())).solve
        compliance = np.asarray(forces @ solve(forces.T))
    compliance.flags.writeable = False
    return compliance


@lru_cache(maxsize=512)
def _frame(material: Material, section: Section, collars: tuple[Collar, ...]) -> _Frame:
    """Return the frame of a section with the thickness of collars."""
    plates, count = section.plates, len(section.plates)
    folds = _modes(section)
    axes, bending, twisting, areas = [], [], [], []
    for number, plate in enumerate(plates):
        strips = [
            (strip.low, strip.high, collar.thickness)
            for collar in collars
            for strip in collar.strips(section)
            if strip.wall == number
        ]
        half = 0.5 * plate.length
        cuts = [half + end for low, high, _ in strips for end in (low, high, -low, -high)]
        nodes = np.unique([0.0, plate.length, *cuts])
        nodes = nodes[np.diff(nodes, prepend=-np.inf) > section.near]
        axis, middle = HermiteAxis(nodes, closed=False), 0.5 * (nodes[:-1] + nodes[1:])
        thickness = np.full(middle.size, plate.thickness)
        for low, high, more in strips:
            from_middle = np.abs(middle - half)
            thickness[(low < from_middle) & (from_middle < high)] += more
        rigidity = (
            material.youngs_modulus * thickness**3 / (12.0 * (1.0 - material.poissons_ratio**2))
        )
        axes.append(axis)
        bending.append(axis.integrals(rigidity)[2])
        twisting.append(axis.integrals(material.shear_modulus * thickness**3 / 3.0)[1])
        areas.append(thickness @ np.diff(nodes))
    first = np.cumsum([0, *(2 * axis.nodes.size for axis in axes)])
    # Values at the ends of plates are those of the folds, and adjacent plates have the same slope.
    given, slopes = np.zeros((first[-1], folds.shape[2])), np.zeros((first[-1], count))
    inner = np.ones(first[-1], dtype=bool)
    for number, plate in enumerate(plates):
        normal = np.array([plate.tangent[1], -plate.tangent[0]])
        for fold, dof in (number, first[number]), ((number + 1) % count, first[number + 1] - 2):
            given[dof], slopes[dof + 1, fold] = normal @ folds[fold], 1.0
            inner[[dof, dof + 1]] = False
    free = np.column_stack([slopes, np.eye(first[-1])[:, inner]])
    stiffness = block_diag(*bending)
    rest = np.linalg.solve(free.T @ stiffness @ free, free.T @ stiffness @ given)
    shapes = given - free @ rest
    return _Frame(
        section,
        axes,
        np.split(shapes, first[1:-1]),
        shapes.T @ stiffness @ shapes,
        shapes.T @ block_diag(*twisting) @ shapes,
        material.youngs_modulus * _warping(section, folds, np.array(areas)),
    )


def _modes(section: Section) -> Array:
    """Return the displacements (num_plates, 2, num_modes) of the starts of plates in the modes."""
    tangents, lengths, flows = _along(section)
    count = len(lengths)
    starts, ends = np.eye(count), np.roll(np.eye(count), 1, axis=1)
    widening = (ends - starts)[:, :, None] * tangents[:, None]
    sliding = (flows @ starts)[:, :, None] * tangents
    conditions = np.concatenate([widening, sliding]).reshape(-1, 2 * count)
    return np.asarray(null_space(conditions)).reshape(count, 2, -1)


def _warping(section: Section, folds: Array, areas: Array) -> Array:
    """Return the integrals (num_modes, num_modes) of products of the displacements along x in m⁴.

    The displacement along x follows from zero shear strain, and its mean is zero.
    """
    tangents, lengths, _ = _along(section)
    slid = np.einsum("kc,kcm->km", tangents, folds) * lengths[:, None]
    end = -np.cumsum(slid, axis=0)
    start = np.roll(end, 1, axis=0)
    mean = areas @ (start + end) / (2.0 * areas.sum())
    start, end = start - mean, end - mean
    products = ((ends.T * areas) @ ends for ends in (start, end, start + end))
    return np.asarray(sum(products) / 6.0)


def _along(section: Section) -> tuple[Array, Array, Array]:
    """Return tangents (num_plates, 2) and lengths (num_plates,) of plates, and three shear flows.

    The flows (3, num_plates) are forces of the plates under forces along y and z and a torque.
    """
    plates = section.plates
    lengths = np.array([plate.length for plate in plates])
    forces = (ShearFlow.from_plates(plates, axis).forces for axis in COMPONENT)
    return np.array([plate.tangent for plate in plates]), lengths, np.array([*forces, lengths])
