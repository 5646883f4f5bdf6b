# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact over the whole overlap: points on the facing walls of two segments.

Gauss's rule along the overlap, and across each half of the inner segment's wall, so that a wall's
points mirror each other. A point carries the penalty k_A times its area, k_A in N/mⁿ⁺². Neither
mesh needs a node there: both segments are read in the triangles that hold the point. Which side
touches comes from the joint, never from a facet's normal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from mpi4py import MPI

from dynamics.contact import ContactLaw
from geometry.arrays import Array
from geometry.boom import Boom, Joint
from geometry.contact_places import Pad
from shell_model.contact.wall_rows import Wall, WallPoints, gauss
from shell_model.reduction.coordinates import exact_product
from shell_model.reduction.segment import ReducedSegment
from shell_model.segment.cross_section import Reading
from shell_model.segment.segment_shell import SegmentShell

# The part of a row's flexibility that may be left out. With it the tip of the paper's boom with
# friction moves by 0.01 % of its range.
STIFF = 1.0e-4

# With more the first tip peak of the paper's boom moves by less than 0.3 %.
POINTS = (8, 4)


@dataclass(frozen=True, slots=True)
class SurfaceOptions:
    """How finely a surface touches, and how stiffly.

    Args:
        points: how many along the overlap, and how many across each half of a wall.
        stiffness: k_A in N/mⁿ⁺² of the stiffer side of every joint. Unless given it is the law of
            all the joint's stations together over the area, so that segments that approach each
            other uniformly press as they would at the stations.
        shifts, moments: of the reduction, see :class:`shell_model.reduction.krylov.KrylovOptions`.
            Each point is an input of its own; against these many a few suffice: with more, the tip
            of the paper's boom with friction moves by 0.05 % of its range.
    """

    points: tuple[int, int] = POINTS
    stiffness: float | None = None
    shifts: tuple[float, ...] = (10.0, 60.0)
    moments: int = 1


class SurfacePoint(NamedTuple):
    """A point of a surface; in a flat boom a mirrored pair of points, which move alike.

    Args:
        reading: the mean approach.
        law: one-sided, with the area's part of the penalty.
        station: the nearest one of the joint along the same direction.
        side: of the inner segment's wall that touches, 1 or −1.
        half: of this wall on which the point lies, 1 or −1; 0 for a mirrored pair.
    """

    reading: Reading
    law: ContactLaw
    station: int
    side: int
    half: int

    def presses(self, pad: Pad) -> bool:
        """Whether it belongs to a pad: that of its station, in space of its corner."""
        if self.station != pad.station:
            return False
        return pad.side == 0 or (self.side, self.half) == (pad.side, pad.half)


def surface_points(
    boom: Boom,
    shells: Sequence[SegmentShell],
    options: SurfaceOptions,
) -> list[SurfacePoint]:
    """All points of all joints that are not tied. Collective."""
    walls = [WallPoints(shell) for shell in shells]
    found: list[SurfacePoint] = []
    first = 0
    for direction in boom.directions:
        for joint in boom.joints:
            if joint.tied:
                continue
            law = joint.law(direction)
            for side in (1, -1):
                one_sided = law.one_sided(side)
                if one_sided is not None:
                    patch = _Patch.of(boom, joint, Wall(direction, side), options.points)
                    share = patch.share(law, options.stiffness)
                    found += patch.points(walls, one_sided.shared(share), first, boom.spatial)
            first += len(joint.stations)
    return found


@dataclass(frozen=True, slots=True)
class _Patch:
    """The overlap on one wall of the inner segment.

    Args:
        joint: whose.
        wall: that touches.
        x, across: (num_points,) places on the half of the wall where the other coordinate is
            positive, in m.
        weights: (num_points,) parts of the wall's area that the mirrored pairs stand for.
        area: of the wall in m².
    """

    joint: Joint
    wall: Wall
    x: Array
    across: Array
    weights: Array
    area: float

    @classmethod
    def of(cls, boom: Boom, joint: Joint, wall: Wall, points: tuple[int, int]) -> _Patch:
        section = boom.segments[joint.inner].section
        assert section is not None
        width = section.face(wall.normal, wall.side).width
        start, end = boom.overlap(joint)
        x, along = gauss(start, end, points[0])
        across, over = gauss(0.0, 0.5 * width, points[1])
        return cls(
            joint=joint,
            wall=wall,
            x=np.repeat(x, across.size),
            across=np.tile(across, x.size),
            weights=np.outer(along, over).ravel(),
            area=width * (end - start),
        )

    def share(self, law: ContactLaw, stiffness: float | None) -> float:
        """The penalty of the whole wall over the joint's stiffness at one station."""
        if stiffness is None:
            return float(len(self.joint.stations))
        return stiffness * self.area / max(term.stiffness for term in law.terms)

    def points(
        self, walls: Sequence[WallPoints], law: ContactLaw, first: int, spatial: bool
    ) -> list[SurfacePoint]:
        """Those of the wall, under its law. ``first`` is the joint's first station."""
        right, left = (self._approaches(walls, half) for half in (1, -1))
        stations = np.abs(np.subtract.outer(self.x, self.joint.stations)).argmin(axis=1) + first
        found = []
        for i, (weight, station) in enumerate(zip(self.weights, stations.tolist(), strict=True)):
            if not spatial:
                mean = 0.5 * right[i] + 0.5 * left[i]
                found.append(SurfacePoint(mean, law.shared(weight), station, self.wall.side, 0))
                continue
            part = law.shared(0.5 * weight)
            found.append(SurfacePoint(right[i], part, station, self.wall.side, 1))
            found.append(SurfacePoint(left[i], part, station, self.wall.side, -1))
        return found

    def _approaches(self, walls: Sequence[WallPoints], half: int) -> list[Reading]:
        """u − w along the wall's normal at the places on one half of it."""
        places = np.column_stack([self.x, half * self.across])
        ends = self.joint.inner, self.joint.outer
        rows = (walls[number].rows(self.wall, places, self.wall.normal) for number in ends)
        return [
            Reading({ends[0]: inner, ends[1]: -outer}) for inner, outer in zip(*rows, strict=True)
        ]


def without_stiff_modes(comm: MPI.Comm, reduced: ReducedSegment, rows: Array) -> ReducedSegment:
    """The segment without its highest modes, which hardly any row notices. Collective.

    Many points leave modes up to the frequencies at which a plate shears through its thickness.
    These would need short steps, and have no part in what the rows give way.

    Args:
        comm: the ranks that share the segment.
        reduced: its coordinates.
        rows: (num_owned, num_rows) this rank's part of what contacts, frictions and ties read.
    """
    gains = np.array([exact_product(comm, row, reduced.shapes) for row in rows.T])
    elastic = reduced.omega2 > 0.0
    given = gains[:, elastic] ** 2 / reduced.omega2[elastic]
    above = np.cumsum(given[:, ::-1], axis=1)[:, ::-1]
    shares = (above / above[:, :1]).max(axis=0)
    left = int(np.count_nonzero(shares >= STIFF))
    kept = int(np.count_nonzero(~elastic)) + left
    lost = above[:, left] if left < shares.size else np.zeros(len(above))
    return replace(
        reduced,
        omega2=reduced.omega2[:kept],
        shapes=reduced.shapes[:, :kept],
        geometric=reduced.geometric[:kept, :kept],
        compliance_error=max(reduced.compliance_error, float((lost / above[:, 0]).max())),
        lost_compliance=reduced.lost_compliance
        + np.pad(lost, (0, reduced.lost_compliance.size - lost.size)),
    )
