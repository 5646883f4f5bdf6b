# SPDX-License-Identifier: LGPL-3.0-or-later
"""How two shells approach each other and slide at a station: by lines, corners or patches.

The points of each wall have weights that sum to one, so that a uniform approach gives the paper's
law (4) exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from geometry.contact_places import Pad, Patch, Stretch
from geometry.rests import Rest
from geometry.section import Direction, Section, Side
from shell_model.contact.corner_lines import CornerLines
from shell_model.contact.wall_points import Wall, WallPoints, gauss
from shell_model.segment.cross_section import Reading, Row

_SIDES: tuple[Side, Side] = (1, -1)

# Gauss's rule over a patch, along x and across.
_POINTS = 4


class Touch(NamedTuple):
    """Side, weight and approach of each pair of points of a pad, and how the pad slides."""

    points: Sequence[tuple[Side, float, Reading]]
    slide: Reading


def near_webs(pad: Pad, inner: CornerLines, outer: CornerLines) -> Touch:
    """A station of a flat boom, from web to web; both flanges together slide as their mean does."""

    def along(side: Side) -> Reading:
        rows = (
            lines.deflection(stretch, "z", 0.0, side)
            for lines, stretch in zip((inner, outer), pad.pressed, strict=True)
        )
        return _approach(pad, *rows)

    return _sliding_as_its_mean([(side, 1.0, along(side)) for side in _SIDES])


def across(pad: Pad, inner: WallPoints, outer: WallPoints) -> Touch:
    """A station of a flat boom over the width of the inner section's faces. Collective."""
    points = []
    for side in _SIDES:
        for y, weight in zip(
            *_half_gauss(_touching(pad, inner).face("z", side).width), strict=True
        ):
            rows = (
                walls.mean(Wall("z", side), *_line(stretch, y), "z")
                for walls, stretch in zip((inner, outer), pad.pressed, strict=True)
            )
            points.append((side, weight, _approach(pad, *rows)))
    return _sliding_as_its_mean(points)


def corner(pad: Pad, inner: CornerLines, outer: CornerLines) -> Touch:
    """A pad of a boom in space."""

    def along(direction: Direction) -> Reading:
        rows = (
            lines.deflection(stretch, direction, *offset)
            for lines, stretch, offset in zip(
                (inner, outer), pad.pressed, (pad.inner, pad.outer), strict=True
            )
        )
        return _approach(pad, *rows)

    return Touch([(pad.side, pad.weight, along(pad.direction))], along(pad.rubs))


def flange_patches(pad: Pad, patch: Patch, inner: WallPoints, outer: WallPoints) -> Touch:
    """A station of a flat boom with pads of a size; it slides as :func:`near_webs`. Collective."""
    points = []
    for side in (pad.side,) if pad.side else _SIDES:
        right, left = (_mean_approach(pad, patch, side, half, inner, outer) for half in (1, -1))
        points.append((side, pad.weight, 0.5 * right + 0.5 * left))
    if pad.side:
        return Touch(points, points[0][2])
    return _sliding_as_its_mean(points)


def corner_patch(
    pad: Pad, patch: Patch, at_corner: Touch, inner: WallPoints, outer: WallPoints
) -> Touch:
    """A pad of a size in space; it slides as its corner does. Collective."""
    reading = _mean_approach(pad, patch, pad.side, pad.half, inner, outer)
    return Touch([(pad.side, pad.weight, reading)], at_corner.slide)


def flanges(rest: Rest, corners: CornerLines) -> list[tuple[Side, float, Reading]]:
    """Side, weight and approach of a stop, which meets a flange above its webs, both at once."""
    return [
        (
            side,
            1.0,
            Reading({rest.stop.segment: corners.deflection(rest.pressed, "z", 0.0, side)}),
        )
        for side in _SIDES
    ]


def _mean_approach(
    pad: Pad, patch: Patch, side: Side, half: int, inner: WallPoints, outer: WallPoints
) -> Reading:
    """Mean of u − w over a patch: read the other way round, a uniform pressure on both walls."""
    x, along = gauss(patch.start, patch.end, _POINTS)
    near, far = patch.across(_touching(pad, inner).face(pad.direction, side))
    y, over = gauss(half * near, half * far, _POINTS)
    places = np.column_stack([np.repeat(x, y.size), np.tile(y, x.size)])
    weights = np.outer(along, over).ravel()
    wall = Wall(pad.direction, side)
    rows = (
        walls.mean(wall, places + np.array([by, 0.0]), weights, pad.direction)
        for walls, by in zip((inner, outer), pad.moved, strict=True)
    )
    return _approach(pad, *rows)


def _touching(pad: Pad, inner: WallPoints) -> Section:
    """The section of the inner segment where a pad presses it."""
    return inner.segment.section_at(pad.x + pad.moved[0])


def _sliding_as_its_mean(points: Sequence[tuple[Side, float, Reading]]) -> Touch:
    first, *others = (0.5 * weight * approach for _, weight, approach in points)
    return Touch(points, sum(others, first))


def _half_gauss(width: float) -> tuple[Array, Array]:
    """Places at positive y of Gauss's rule with eight points over a width; weights sum to one."""
    y, weights = gauss(-0.5 * width, 0.5 * width, 8)
    return y[y > 0.0], 2.0 * weights[y > 0.0]


def _line(stretch: Stretch, y: float) -> tuple[Array, Array]:
    """Places (num_places, 2) at ±y along a stretch, and their weights, which sum to one."""
    x, weights = gauss(stretch.start, stretch.end, _POINTS)
    forces = 0.5 * weights * (stretch.end - stretch.start) * stretch.density(x)
    places = np.column_stack([np.tile(x, 2), np.repeat([y, -y], x.size)])
    return places, np.tile(forces, 2)


def _approach(pad: Pad, inner: Row, outer: Row) -> Reading:
    """u − w of the two points."""
    return Reading({pad.joint.inner: inner, pad.joint.outer: -outer})
