# SPDX-License-Identifier: LGPL-3.0-or-later
"""Surface contact over the whole overlap: points on the facing walls of two segments.

They are Gauss points along the overlap and across each half of the wall of the inner segment. The
stiffness of a point is the penalty k_A in N/mⁿ⁺² times the area of the point. Displacements are
interpolated in the triangles that contain the point. The side in contact follows from the joint,
since facet normals have arbitrary signs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from mpi4py import MPI

from protractile.dynamics.contact import ContactLaw
from protractile.dynamics.reduction import independent_columns
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import ContactPair
from protractile.shell_model.contact.wall_rows import Wall, WallPoints, gauss
from protractile.shell_model.reduction.segment import ReducedSegment
from protractile.shell_model.segment.cross_section import Operator
from protractile.shell_model.segment.segment_shell import SegmentShell
from protractile.shell_model.segment.solver import exact_product

# Fraction of the compliance of a row that is neglected. It changes the tip deflection of the
# paper's boom with friction by 0.01 % of its range.
STIFF = 1.0e-4

# Default numbers of points; more points change the first tip peak of the paper's boom by less than
# 0.3 %.
POINTS = (8, 4)

# Shifts in Hz and moments of the reduction. Few suffice, since all points are inputs: more moments
# change the tip deflection of the paper's boom with friction by 0.05 % of its range.
SURFACE_SHIFTS, SURFACE_MOMENTS = (10.0, 60.0), 1


@dataclass(frozen=True, slots=True)
class SurfaceOptions:
    """Discretisation and stiffness of surface contact.

    Args:
        points: numbers of points along the overlap, and across each half of a wall.
        stiffness: k_A in N/mⁿ⁺² of the stiffer side of all joints. By default it is the sum of the
            stiffnesses of the stations over the area, so that a uniform displacement causes the
            same force.
    """

    points: tuple[int, int] = POINTS
    stiffness: float | None = None


class SurfacePoint(NamedTuple):
    """Contact point of a surface; in a flat boom a symmetric pair of points."""

    operator: Operator  #: operator of the relative displacement u − w, the mean for a pair
    law: ContactLaw  #: one-sided contact law, with the penalty times the area of the point
    station: int  #: index of the nearest station of the joint in the same direction
    side: int  #: side of the inner segment in contact, 1 or −1
    half: int  #: half of the wall with the point, 1 or −1; 0 for a pair

    def presses(self, pad: ContactPair) -> bool:
        """Return whether the force of the point is a normal force of a pad."""
        if self.station != pad.station.index:
            return False
        return pad.side == 0 or (self.side, self.half) == (pad.side, pad.half)


def surface_points(
    boom: Boom,
    shells: Sequence[SegmentShell],
    options: SurfaceOptions,
) -> list[SurfacePoint]:
    """Return the contact points of all joints that are not bonded. Collective."""
    walls = [WallPoints(shell) for shell in shells]
    return [
        point
        for direction in boom.directions
        for number, joint in enumerate(boom.joints)
        if not joint.bonded
        for side in (1, -1)
        for point in _on_wall(boom, walls, number, Wall(direction, side), options)
    ]


def _on_wall(
    boom: Boom,
    walls: Sequence[WallPoints],
    number: int,
    wall: Wall,
    options: SurfaceOptions,
) -> Iterator[SurfacePoint]:
    """Yield the points on a wall of a joint, whose index is ``number``."""
    joint, stations = boom.joints[number], boom.joint_stations(number, wall.normal)
    law = joint.law(wall.normal)
    one_sided = law.one_sided(wall.side)
    if one_sided is None:
        return
    section = boom.segments[joint.inner].section
    assert section is not None
    width, (start, end) = section.face(wall.normal, wall.side).width, boom.overlap(joint)
    # Stiffness of the whole wall over the stiffness of one station.
    share = float(len(joint.stations))
    if options.stiffness is not None:
        area = width * (end - start)
        share = options.stiffness * area / max(term.stiffness for term in law.terms)
    pressing = one_sided.with_weight(share)
    along, across = gauss(start, end, options.points[0]), gauss(0.0, 0.5 * width, options.points[1])
    # Fraction of the area of the wall that a pair of points represents.
    weights = np.outer(along[1], across[1]).ravel()
    x, beside = np.repeat(along[0], across[0].size), np.tile(across[0], along[0].size)
    nearest = np.abs(np.subtract.outer(x, joint.stations)).argmin(axis=1).tolist()

    def approaches(half: int) -> list[Operator]:
        """Return the operators of u − w along the normal at the points of one half."""
        places, ends = np.column_stack([x, half * beside]), (joint.inner, joint.outer)
        rows = (walls[number].rows(wall, places, wall.normal) for number in ends)
        return [
            Operator({ends[0]: inner, ends[1]: -outer}) for inner, outer in zip(*rows, strict=True)
        ]

    points = zip(approaches(1), approaches(-1), weights, nearest, strict=True)
    for right, left, weight, place in points:
        station = stations[place].index
        if boom.spatial:
            part = pressing.with_weight(0.5 * weight)
            yield SurfacePoint(right, part, station, wall.side, 1)
            yield SurfacePoint(left, part, station, wall.side, -1)
        else:
            mean = 0.5 * right + 0.5 * left
            yield SurfacePoint(mean, pressing.with_weight(weight), station, wall.side, 0)


def without_stiff_modes(comm: MPI.Comm, reduced: ReducedSegment, rows: Array) -> ReducedSegment:
    """Return the segment without the highest modes, whose compliance is negligible. Collective.

    With many contact points, the basis has modes of very high frequencies, up to the thickness
    shear of plates, which would require short time steps.

    Args:
        comm: ranks that share the segment.
        reduced: reduced coordinates of the segment.
        rows: (num_owned, num_rows) this rank's part of the rows of contacts, friction and bonded
            joints, as columns.
    """
    gains = np.array([exact_product(comm, row, reduced.shapes) for row in rows.T])
    elastic = reduced.omega2 > 0.0
    compliances = gains[:, elastic] ** 2 / reduced.omega2[elastic]
    above = np.cumsum(compliances[:, ::-1], axis=1)[:, ::-1]
    shares = (above / above[:, :1]).max(axis=0)
    num_elastic = int(np.count_nonzero(shares >= STIFF))
    kept = int(np.count_nonzero(~elastic)) + num_elastic
    lost = above[:, num_elastic] if num_elastic < shares.size else np.zeros(len(above))
    return replace(
        reduced,
        omega2=reduced.omega2[:kept],
        shapes=reduced.shapes[:, :kept],
        geometric=reduced.geometric[:kept, :kept],
        coarser=independent_columns(reduced.coarser[:kept]),
        compliance_error=max(reduced.compliance_error, float((lost / above[:, 0]).max())),
        lost_compliance=reduced.lost_compliance
        + np.pad(lost, (0, reduced.lost_compliance.size - lost.size)),
    )
