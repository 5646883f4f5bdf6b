# SPDX-License-Identifier: LGPL-3.0-or-later
"""Local compliance of walls under slide pads, estimated without a shell.

A wall under a pad bends as a plate. Neighbouring walls, which are stiff in their planes, support it
along the folds. So the unfolded walls of a segment form one continuous plate on line supports at
the folds, with a free edge at the end of the segment. Elements are the conforming rectangles of
Bogner, Fox and Schmit (1965): products of cubic Hermite polynomials along the boom and around the
section, so that matrices are Kronecker products. The folds themselves move as the section distorts
(:mod:`.beam_model.distortion`); the compliance of a contact is the sum of both.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse.linalg import splu

from protractile.beam_model.boom_modes import ContactPlace, StationCompliance
from protractile.beam_model.calibration import with_springs
from protractile.beam_model.distortion import Press, distortion_compliance
from protractile.beam_model.hermite import HermiteAxis, sum_of_products
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.compression import NO_COMPRESSION
from protractile.geometry.contact_places import Pad, pads
from protractile.geometry.material import Material
from protractile.geometry.section import EACH_SIDE, Direction, Section, Side
from protractile.geometry.segment import Segment

# Length of wall beyond a pad that is modelled, as a fraction of the larger side of the section.
_REACH = 1.5
# Element length as a fraction of the smaller side of the section, and its growth away from a pad.
_LENGTH, _GROWTH = 0.2, 1.6


class PressedArea(NamedTuple):
    """Area of a wall under the uniform pressure of a pad or a pair of pads.

    Args:
        start, end: x in m.
        direction, side: direction and side of the wall's outward normal.
        spans: intervals of the coordinate across the wall in m.
    """

    start: float
    end: float
    direction: Direction
    side: Side
    spans: tuple[tuple[float, float], ...]


def with_wall_springs(system: GapSystem, boom: Boom, factor: float = 1.0) -> GapSystem:
    """Return the system of a beam with springs for the compliance of walls under pads.

    Args:
        system: gap system with a contact row for each side.
        factor: factor of the compliance, 0 for rigid walls.
    """
    return with_compliance(system, factor * contact_compliance(boom)) if factor else system


def with_compliance(system: GapSystem, walls: Array) -> GapSystem:
    """Return the system with springs for a compliance (num_rows, num_rows) in m/N of contacts."""
    if not walls.any():
        return system
    rest = len(system.frictions) + len(system.dashpots)
    return with_springs(system, block_diag(walls, np.zeros((rest, rest))))


def contact_compliance(boom: Boom) -> Array:
    """Return the local compliance (num_rows, num_rows) in m/N of segments at contact rows.

    It includes the bending of walls under pads, and the distortion of sections. Under symmetric
    forces on its corners, a box has none.

    Args:
        boom: boom of beams with a contact row for each side.
    """
    rows = _contact_rows(boom)
    stops = sum(len(stop.sides) for stop in boom.stops)
    compliance = np.zeros((len(rows) + stops,) * 2)
    # Load cases and combinations share the cached results of the unloaded segments.
    unloaded = [
        replace(segment, load=0.0, lateral=None, compression=NO_COMPRESSION, masses=())
        for segment in boom.segments
    ]

    def add(at: list[int], outward: Array) -> None:
        # The signs relate the directions of rows to the outward normals of faces.
        sides = np.array([rows[i][1] for i in at])
        compliance[np.ix_(at, at)] += np.outer(sides, sides) * outward

    # Vertical and lateral pads at one x belong together: flanges that bend make webs bulge.
    places = [pad.patch and (pad.station.number, pad.station.place) for pad, _ in rows]
    for place in {*places} - {None}:
        at = [i for i, one in enumerate(places) if one == place]
        joint = rows[at[0]][0].joint
        inner = unloaded[joint.inner]
        areas = tuple(_pad_area(*rows[i], inner) for i in at)
        for segment in (inner, unloaded[joint.outer]):
            add(at, wall_compliance(segment, areas))
    # A distortion extends from one station of a joint to the next.
    for number, joint in enumerate(boom.joints):
        at = [i for i, (pad, _) in enumerate(rows) if pad.station.number == number]
        members = unloaded[joint.inner], unloaded[joint.outer]
        for member, segment in enumerate(members if at else ()):
            if segment.section is not None:
                presses = tuple(_press(*rows[i], members, member) for i in at)
                add(at, distortion_compliance(segment, presses))
    return compliance


def station_compliance(
    boom: Boom, stiffness: Array, walls: Array | None = None
) -> StationCompliance:
    """Return the compliance of closed contacts, and of the walls and sections under them.

    Forces of one station distort the section at others, too.

    Args:
        boom: boom of beams with a contact row for each side.
        stiffness: stiffness (num_rows,) in N/m of the contact rows, 0 where a contact is open.
        walls: compliance of :func:`contact_compliance`, if available.
    """
    of_rows = [
        ContactPlace(
            pad.station.number,
            pad.station.direction,
            pad.station.place,
            pad.midpoint - pad.station.x,
        )
        for pad, _ in _contact_rows(boom)
    ]
    closed = np.flatnonzero(stiffness[: len(of_rows)])
    places = tuple(dict.fromkeys(of_rows[row] for row in closed))
    at = np.array([[float(of_rows[row] == place) for place in places] for row in closed])
    at = at.reshape(closed.size, len(places))
    walls = contact_compliance(boom) if walls is None else walls
    of_contacts = walls[np.ix_(closed, closed)] + np.diag(1.0 / stiffness[closed])
    together = at.T @ np.linalg.solve(of_contacts, at)
    return StationCompliance(places, np.linalg.inv(together))


def _contact_rows(boom: Boom) -> list[tuple[Pad, Side]]:
    """Return the pad and the side of each contact of the joints."""
    return [
        (pad, side)
        for pad in pads(boom)
        for side in ((pad.side,) if pad.side else EACH_SIDE)
        if pad.station.law.one_sided(side) is not None
    ]


def _pad_area(pad: Pad, side: Side, inner: Segment) -> PressedArea:
    """Return the area of a pad, or of a symmetric pair of pads in a planar boom."""
    assert pad.patch is not None
    near, far = pad.patch.across(inner.section_at(pad.station.x).face(pad.station.direction, side))
    halves = (1, -1) if pad.face is None else (pad.half,)
    spans = tuple((half * near, half * far) for half in halves)
    return PressedArea(pad.patch.start, pad.patch.end, pad.station.direction, side, spans)


def _press(pad: Pad, side: Side, members: tuple[Segment, Segment], member: int) -> Press:
    """Return the force of a contact on the inner (0) or the outer segment (1) of its joint."""
    if pad.patch is not None:
        area = _pad_area(pad, side, members[0])
        parts = tuple((1.0 / len(area.spans), *span) for span in area.spans)
        return Press(pad.midpoint, pad.station.direction, side, parts)
    # The corners of the segment carry the force in static equilibrium.
    face = members[member].section_at(pad.midpoint).face(pad.station.direction, side)
    point = (pad.inner, pad.outer)[member][0 if pad.station.direction == "z" else 1]
    high = (point - face.low) / face.width
    parts = (1.0 - high, face.low, face.low), (high, face.high, face.high)
    return Press(pad.midpoint, pad.station.direction, side, parts)


@lru_cache(maxsize=512)
def wall_compliance(segment: Segment, areas: tuple[PressedArea, ...]) -> Array:
    """Return the compliance (num_areas, num_areas) in m/N of the walls of a segment.

    An entry is the mean outward displacement of one area under a unit force on another.

    Args:
        segment: segment with a section, collars and diaphragms.
        areas: pressed areas of one station.

    Returns:
        A read-only array, which later calls with the same arguments return again.
    """
    start, end = min(area.start for area in areas), max(area.end for area in areas)
    section = segment.section_at(0.5 * (start + end))
    reach = _REACH * max(section.size("y"), section.size("z"))
    low, high = max(segment.start, start - reach), min(segment.end, end + reach)
    length = _LENGTH * min(section.size("y"), section.size("z"))

    # The axis around the section has nodes at folds and edges of pads.
    plates = section.plates
    folds = np.concatenate([[0.0], np.cumsum([plate.length for plate in plates])])
    spans = [_span_around(section, folds, area) for area in areas]
    # Collars with the intervals around the section that they cover.
    strips = [
        (collar, folds[k] + 0.5 * plates[k].length + np.array(ends))
        for collar in segment.collars
        for k, near, far in collar.strips(section)
        for ends in ((-far, -near), (near, far))
    ]
    cuts_around = [*(span.ravel() for span in spans), *(ends for _, ends in strips)]
    edges = np.concatenate([folds, *cuts_around])
    around = HermiteAxis(_nodes_around(edges, folds, length, section.near), closed=True)

    closed_at = [one.x for one in segment.diaphragms if low < one.x < high]
    pad_ends = [x for area in areas for x in (area.start, area.end)]
    collar_ends = [x for collar in segment.collars for x in collar.span if low < x < high]
    cuts = np.unique([low, high, *pad_ends, *closed_at, *collar_ends])
    # A pad at the end of a segment ends there, except for round-off.
    cuts = cuts[np.diff(cuts, prepend=-np.inf) > section.near]
    along_x = HermiteAxis(_graded_nodes(cuts, length, (start, end)), closed=False)
    midpoints = 0.5 * (along_x.nodes[:-1] + along_x.nodes[1:])
    midpoints_around = 0.5 * (around.nodes[:-1] + around.nodes[1:])
    doubled = np.zeros((midpoints.size, midpoints_around.size))
    for collar, (near, far) in strips:
        within = np.abs(midpoints - collar.midpoint) < 0.5 * collar.length
        covered = (near < midpoints_around) & (midpoints_around < far)
        doubled += collar.thickness * np.outer(within, covered)

    plate_of_element = np.searchsorted(folds, around.nodes[:-1], side="right") - 1
    walls = np.array([plates[number].thickness for number in plate_of_element])
    factors = _bending_factors(segment.material, along_x, around, walls + doubled)
    # Values on folds and diaphragms are zero; slopes are free.
    free = np.ones((along_x.nodes.size, 2, around.nodes.size - 1, 2), dtype=bool)
    free[:, :, np.isin(around.nodes[:-1], folds), 0] = False
    for x in closed_at:
        free[np.abs(along_x.nodes - x) < section.near, 0] = False
    rows = np.array(
        [
            np.kron(
                along_x.mean(area.start, area.end),
                np.mean([around.mean(*span) for span in places], axis=0),
            )[free.ravel()]
            for area, places in zip(areas, spans, strict=True)
        ]
    )
    # The matrix is symmetric positive definite, so that the factorisation needs no pivoting.
    factor = splu(
        sum_of_products(*factors, free.ravel()),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    compliance = np.asarray(rows @ factor.solve(rows.T))
    compliance.flags.writeable = False
    return compliance


def _span_around(section: Section, folds: Array, area: PressedArea) -> Array:
    """Return the intervals (num_spans, 2) in m of an area on the axis around the section."""
    face = section.face(area.direction, area.side)
    plate, across = section.plates[face.plate], 0 if area.direction == "z" else 1
    along = np.sign(plate.end[across] - plate.start[across])
    places = folds[face.plate] + along * (np.array(area.spans) - plate.start[across])
    return np.sort(places, axis=1)


def _bending_factors(
    material: Material, along_x: HermiteAxis, around: HermiteAxis, thickness: Array
) -> tuple[list[Array], list[Array]]:
    """Return the factors along x and around the section of the products in the bending energy.

    ``thickness`` in m is that of the elements (num_along_x, num_around).
    """
    modulus, ratio = material.youngs_modulus, material.poissons_ratio
    lefts, rights = list[Array](), list[Array]()
    kinds, kind = np.unique(thickness, axis=0, return_inverse=True)
    for number, walls in enumerate(kinds):
        rigidity = modulus * walls**3 / (12.0 * (1.0 - ratio**2))
        x0, x1, x2, x02 = along_x.integrals((kind == number).astype(float))
        s0, s1, s2, s02 = around.integrals(rigidity)
        lefts += [x2, x0, ratio * x02, ratio * x02.T, 2.0 * (1.0 - ratio) * x1]
        rights += [s0, s2, s02.T, s02, s1]
    return lefts, rights


def _nodes_around(edges: Array, folds: Array, length: float, near: float) -> Array:
    """Return the nodes (num_nodes,) in m around a section, with all folds and other edges."""
    # Collars over a whole wall end at the folds of the wall, except for round-off.
    at_fold = np.abs(np.subtract.outer(edges, folds)).min(axis=1) < near
    edges = np.unique(np.concatenate([folds, edges[~at_fold]]))
    # Each wall has elements that mirror each other, so that a symmetric section remains symmetric.
    divided = [
        np.linspace(*wall, int(np.ceil(round((wall[1] - wall[0]) / length, 9))) + 1)
        for wall in pairwise(folds)
    ]
    return _with_cuts(edges, length, np.concatenate(divided))


def _graded_nodes(cuts: Array, length: float, fine: tuple[float, float]) -> Array:
    """Return nodes (num_nodes,) in m, with ``cuts``; elements become longer outside ``fine``."""
    count = int(np.ceil((fine[1] - fine[0]) / length))
    beyond = length * np.cumsum(_GROWTH ** np.arange(1, 30))
    nodes = np.concatenate([fine[0] - beyond, np.linspace(*fine, count + 1), fine[1] + beyond])
    return _with_cuts(cuts, length, nodes)


def _with_cuts(cuts: Array, length: float, nodes: Array) -> Array:
    """Return ``cuts`` and the nodes (num_nodes,) in m between them that are not near a cut."""
    inside = nodes[(cuts[0] < nodes) & (nodes < cuts[-1])]
    apart = np.abs(np.subtract.outer(inside, cuts)).min(axis=1) > 0.3 * length
    return np.sort(np.concatenate([cuts, inside[apart]]))
