# SPDX-License-Identifier: LGPL-3.0-or-later
"""Refinement zones of meshes, for an accurate local compliance at loads and contacts.

Edge lengths are fractions of the loaded size: the length of a corner contact, the smaller side of a
pad, or the size of the box if its walls share the force. The fractions are measured: with them, the
local compliance (less that of the same force distributed over the webs) differs from that of
infinitely fine meshes by less than the tolerance. The error is proportional to the square of the
edge length.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.boom import Boom
from geometry.contact_places import ContactLine, Pad, StopPatch, Stretch
from geometry.section import Direction, Face, Section

# The tolerance at which the fractions below were measured.
MEASURED_AT = 0.01

# Edge length as a fraction of the length of a corner contact, the smaller side of a pad, and the
# smaller side of the box; growth of the edge length per unit of distance.
_CORNER, _CORNER_GROWTH = 0.2, 0.5
_PAD, _PAD_GROWTH = 0.18, 0.3
_WALLS, _WALLS_GROWTH = 0.1, 0.5


@dataclass(frozen=True, slots=True)
class RefinementZone:
    """Refinement zone of a segment's mesh, with all its mirror images.

    Args:
        low, high: (x, y, z) in m of opposite corners, on the positive side of the mirrors.
        size: edge length in the zone in m.
        growth: growth of the permitted edge length per unit of distance from the zone.
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    size: float
    growth: float

    def allowed(self, places: Array) -> Array:
        """Return the permitted edge length (num_places,) in m at places (num_places, 3)."""
        outside = np.maximum(np.maximum(self.low - places, places - self.high), 0.0)
        return np.asarray(self.size + self.growth * np.sqrt((outside**2).sum(axis=1)))

    def reach(self, size: float) -> tuple[float, float]:
        """Return the limits of x in m between which edges of a size are too long for the zone."""
        distance = max((size - self.size) / self.growth, 0.0)
        return self.low[0] - distance, self.high[0] + distance

    def squares(self, size: float) -> float:
        """Return the number of squares with permitted edge lengths below ``size``.

        It is counted on an infinite flat wall: in the zone, along its sides, and at its corners.
        """
        if self.size >= size:
            return 0.0
        length, *across = (high - low for low, high in zip(self.low, self.high, strict=True))
        width, ratio = sum(across), size / self.size
        sides = 2.0 * (length + width) / self.growth * (1.0 / self.size - 1.0 / size)
        corners = 2.0 * np.pi / self.growth**2 * (np.log(ratio) + 1.0 / ratio - 1.0)
        return float(length * width / self.size**2 + sides + corners)


def refinement_zones(
    boom: Boom,
    number: int,
    tolerance: float,
    line: ContactLine,
    stop_patches: Sequence[StopPatch],
    pads: Sequence[Pad],
) -> list[RefinementZone]:
    """Return the refinement zones of a segment with a section.

    Args:
        boom: boom of the segment.
        number: index in ``Boom.segments``.
        tolerance: relative error of the local compliance.
        line: contact line on the walls.
        stop_patches, pads: stop patches and pads of the boom.
    """
    finer = float(np.sqrt(tolerance / MEASURED_AT))
    # Zones on several sides, or mirror images, are merged.
    measured = dict.fromkeys(_measured(boom, number, line, stop_patches, pads))
    return [
        RefinementZone(low, high, finer * size, finer * growth)
        for low, high, size, growth in measured
    ]


_Place = tuple[float, float, float]
_Measured = tuple[_Place, _Place, float, float]


def _measured(
    boom: Boom,
    number: int,
    line: ContactLine,
    stop_patches: Sequence[StopPatch],
    pads: Sequence[Pad],
) -> Iterator[_Measured]:
    """Yield corners, size and growth of each zone for the tolerance ``MEASURED_AT``."""
    segment = boom.segments[number]
    section = segment.widest
    lowest, high = section.bounds
    low_y, low_z = (
        0.0 if axis in section.mirrors else place
        for axis, place in zip(("y", "z"), lowest, strict=True)
    )
    across = min(section.size("y"), section.size("z"))
    for x in _walls(boom, number):
        yield (x, low_y, low_z), (x, *high), _WALLS * across, _WALLS_GROWTH
    for rest in stop_patches:
        if rest.stop.segment == number:
            extended = [rest.extended(boom, extension) for extension in rest.reach]
            for face in _faces(section, "z"):
                yield _swept(_corner(one.pressed, face) for one in extended)
    for pad in pads:
        for end, of in enumerate((pad.joint.inner, pad.joint.outer)):
            if of == number:
                for face in _faces(section, pad.direction):
                    telescoping_pads = (pad.extended(boom, extension) for extension in pad.reach)
                    yield _swept(_pressed(boom, one, end, face, line) for one in telescoping_pads)


def _walls(boom: Boom, number: int) -> Iterator[float]:
    """Yield x of supports, ties, loads, masses and stiffeners, which act in the walls' plane."""
    segment = boom.segments[number]
    yield from (support.x for support in segment.supports)
    yield from (mass.x for mass in segment.masses)
    yield from (lug.x for lug in boom.cylinders if lug.segment == number)
    yield from (load.x for load in boom.loads if load.segment == number and load.x is not None)
    for joint in boom.joints:
        if joint.tied and number in (joint.outer, joint.inner):
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


def _place(face: Face, x: float, across: float) -> _Place:
    return (x, across, face.offset) if face.direction == "z" else (x, face.offset, across)


def _corner(stretch: Stretch, face: Face) -> _Measured:
    size = _CORNER * (stretch.end - stretch.start)
    low, high = (_place(face, x, face.high) for x in (stretch.start, stretch.end))
    return low, high, size, _CORNER_GROWTH


def _swept(places: Iterable[_Measured]) -> _Measured:
    """Return the range from the first to the last of places that differ only in x."""
    lows, highs, sizes, growths = zip(*places, strict=True)
    return min(lows), max(highs), sizes[0], growths[0]


def _pressed(boom: Boom, pad: Pad, end: int, face: Face, line: ContactLine) -> _Measured:
    """Return the pad's area on the face of the inner (``end`` 0) or outer segment."""
    covered = pad.patch
    if covered is None:
        low, high, size, growth = _corner(pad.pressed[end], face)
        return (low if line != "across" else (low[0], 0.0, low[2])), high, size, growth
    size = _PAD * min(covered.end - covered.start, covered.width)
    near, far = covered.across(
        boom.segments[pad.joint.inner].widest.face(face.direction, face.side)
    )
    low, high = (
        _place(face, x + pad.moved[end], across)
        for x, across in ((covered.start, near), (covered.end, far))
    )
    return low, high, size, _PAD_GROWTH
