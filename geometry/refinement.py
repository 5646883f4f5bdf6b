# SPDX-License-Identifier: LGPL-3.0-or-later
"""Refinement zones of meshes, for an accurate local compliance at loads and contacts.

Edge lengths are fractions of the loaded size: the length of a corner contact, the smaller side of a
pad, or the size of the section if its walls share the force. The fractions are calibrated so that
the error of the local compliance by the mesh is below the tolerance. The local compliance is the
compliance under a force less the compliance under the same force distributed over the webs. Its
error is proportional to the square of the edge length.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import (
    ContactInterval,
    ContactLine,
    ContactPair,
    pads,
    stop_patches,
)
from protractile.geometry.section import Direction, Face, Section

# Tolerance for which the fractions below are calibrated.
CALIBRATION_TOLERANCE = 0.01

# Edge length as a fraction of the length of a corner contact, of the smaller side of a pad and of
# the smaller side of the section, each with the growth of the edge length per unit of distance.
_CORNER, _CORNER_GROWTH = 0.2, 0.5
_PAD, _PAD_GROWTH = 0.18, 0.3
_WALLS, _WALLS_GROWTH = 0.1, 0.5


@dataclass(frozen=True, slots=True)
class RefinementZone:
    """Refinement zone of a mesh. It also applies to its mirror images.

    Args:
        low, high: (x, y, z) in m of opposite corners, on the positive side of the symmetry planes.
        size: edge length in the zone in m.
        growth: growth of the permitted edge length per unit of distance from the zone.
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    size: float
    growth: float

    def edge_length(self, places: Array) -> Array:
        """Return the permitted edge length (num_places,) in m at points (num_places, 3)."""
        outside = np.maximum(np.maximum(self.low - places, places - self.high), 0.0)
        return np.asarray(self.size + self.growth * np.sqrt((outside**2).sum(axis=1)))

    def reach(self, size: float) -> tuple[float, float]:
        """Return the range of x in m with a permitted edge length below ``size`` in m."""
        distance = max((size - self.size) / self.growth, 0.0)
        return self.low[0] - distance, self.high[0] + distance

    def num_squares(self, size: float) -> float:
        """Return the number of square elements with a permitted edge length below ``size`` in m.

        It is estimated for an infinite flat wall, in and around the zone.
        """
        if self.size >= size:
            return 0.0
        length, *across = (high - low for low, high in zip(self.low, self.high, strict=True))
        width, ratio = sum(across), size / self.size
        sides = 2.0 * (length + width) / self.growth * (1.0 / self.size - 1.0 / size)
        corners = 2.0 * np.pi / self.growth**2 * (np.log(ratio) + 1.0 / ratio - 1.0)
        return float(length * width / self.size**2 + sides + corners)


def refinement_zones(
    boom: Boom, number: int, tolerance: float, line: ContactLine
) -> list[RefinementZone]:
    """Return the refinement zones of a segment with a section.

    Args:
        number: index of the segment in ``Boom.segments``.
        tolerance: relative error of the local compliance.
        line: contact line on the walls.
    """
    finer = float(np.sqrt(tolerance / CALIBRATION_TOLERANCE))
    # Zones with the same data, such as mirror images, are merged.
    return [
        replace(zone, size=finer * zone.size, growth=finer * zone.growth)
        for zone in dict.fromkeys(_zones(boom, number, line))
    ]


def _zones(boom: Boom, number: int, line: ContactLine) -> Iterator[RefinementZone]:
    """Yield the zones for the ``CALIBRATION_TOLERANCE``."""
    segment = boom.segments[number]
    section = segment.widest
    lowest, high = section.bounds
    low_y, low_z = (
        0.0 if axis in section.mirrors else place
        for axis, place in zip(("y", "z"), lowest, strict=True)
    )
    across = min(section.size("y"), section.size("z"))
    for x in _walls(boom, number):
        yield RefinementZone((x, low_y, low_z), (x, *high), _WALLS * across, _WALLS_GROWTH)
    for rest in stop_patches(boom):
        if rest.stop.segment == number:
            extended = [rest.at_extension(boom, extension) for extension in rest.reach]
            for face in _faces(section, "z"):
                yield _envelope(_corner(patch.interval, face) for patch in extended)
    for pad in pads(boom):
        for end, of in enumerate((pad.joint.inner, pad.joint.outer)):
            if of == number:
                for face in _faces(section, pad.station.direction):
                    extended_pads = (pad.at_extension(boom, extension) for extension in pad.reach)
                    yield _envelope(_pad_zone(boom, pad, end, face, line) for pad in extended_pads)


def _walls(boom: Boom, number: int) -> Iterator[float]:
    """Yield the x in m of stiffeners, and of forces in the planes of walls."""
    segment = boom.segments[number]
    yield from (support.x for support in segment.supports)
    yield from (mass.x for mass in segment.masses)
    yield from (lug.x for lug in boom.cylinders if lug.segment == number)
    yield from (load.x for load in boom.loads if load.segment == number and load.x is not None)
    for joint in boom.joints:
        if joint.bonded and number in (joint.outer, joint.inner):
            yield from joint.stations
    for collar in segment.collars:
        yield from collar.span
    yield from (plate.x for plate in segment.diaphragms)


def _faces(section: Section, direction: Direction) -> list[Face]:
    """Return the faces normal to a direction, without mirror images."""
    mirrored = direction in section.mirrors
    return [
        face
        for face in section.faces
        if face.direction == direction and not (mirrored and face.side < 0)
    ]


def _place(face: Face, x: float, across: float) -> tuple[float, float, float]:
    return (x, across, face.offset) if face.direction == "z" else (x, face.offset, across)


def _corner(stretch: ContactInterval, face: Face) -> RefinementZone:
    size = _CORNER * (stretch.end - stretch.start)
    low, high = (_place(face, x, face.high) for x in (stretch.start, stretch.end))
    return RefinementZone(low, high, size, _CORNER_GROWTH)


def _envelope(zones: Iterable[RefinementZone]) -> RefinementZone:
    """Return the zone that covers zones which differ in x only."""
    first, last = zones
    return replace(first, low=min(first.low, last.low), high=max(first.high, last.high))


def _pad_zone(
    boom: Boom, pad: ContactPair, end: int, face: Face, line: ContactLine
) -> RefinementZone:
    """Return the zone of a pad on a face of the inner (``end`` 0) or outer segment (``end`` 1)."""
    covered = pad.patch
    if covered is None:
        zone = _corner(pad.intervals[end], face)
        return replace(zone, low=(zone.low[0], 0.0, zone.low[2])) if line == "across" else zone
    size = _PAD * min(covered.end - covered.start, covered.width)
    near, far = covered.across(
        boom.segments[pad.joint.inner].widest.face(face.direction, face.side)
    )
    low, high = (
        _place(face, x + pad.travel[end], across)
        for x, across in ((covered.start, near), (covered.end, far))
    )
    return RefinementZone(low, high, size, _PAD_GROWTH)
