# SPDX-License-Identifier: LGPL-3.0-or-later
"""How two shells approach each other and slide at a station: by lines, corners or patches.

The points of each wall have weights that sum to one, so that a uniform approach gives the paper's
law (4) exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from geometry.boom import Direction
from geometry.pads import Pad, Patch, Side
from geometry.section import BoxSection
from shell_model.outline import Outline, Reading, Row, combine_readings, relative
from shell_model.surface_contact import gauss
from shell_model.wall_points import Wall, WallPoints

ContactLine = Literal["near webs", "across", "surface"]

# Gauss's rule over a patch, along x and across.
_PATCH_POINTS = 4


class Touch(NamedTuple):
    """Side, weight and approach of each pair of points of a pad, and how the pad slides."""

    points: Sequence[tuple[int, float, Reading]]
    slide: Reading


class ContactPoint(NamedTuple):
    """A mirrored pair of points on facing flanges, with the part of the force it carries.

    ``inner`` and ``outer`` are the distances in m from the middle of each flange.
    """

    inner: float
    outer: float
    weight: float


def contact_points(line: ContactLine, inner: BoxSection, outer: BoxSection) -> list[ContactPoint]:
    """Where facing flanges of a flat boom touch at a station; the weights sum to one.

    Args:
        line: ``across`` takes Gauss's rule with eight points over the inner flange; all others
            pass the force from web to web, at a surface that of friction.
        inner, outer: the sections of the joint's segments.
    """
    if line != "across":
        return [ContactPoint(0.5 * inner.width, 0.5 * outer.width, 1.0)]
    nodes, weights = np.polynomial.legendre.leggauss(8)
    places = 0.5 * inner.width * nodes[nodes > 0.0]
    return [
        ContactPoint(float(y), float(y), float(w))
        for y, w in zip(places, weights[nodes > 0.0], strict=True)
    ]


def flanges(pad: Pad, inner: Outline, outer: Outline, line: ContactLine) -> Touch:
    """A station of a flat boom; both flanges together slide as their mean does."""
    points = [
        (
            side,
            point.weight,
            _approach(
                pad,
                inner.flange_deflection(side, point.inner),
                outer.flange_deflection(side, point.outer),
            ),
        )
        for side in (1, -1)
        for point in contact_points(line, inner.section, outer.section)
    ]
    return Touch(points, combine_readings([(0.5 * weight, row) for _, weight, row in points]))


def corner(pad: Pad, inner: Outline, outer: Outline) -> Touch:
    """A pad of a boom in space."""

    def along(direction: Direction) -> Reading:
        rows = inner.point(direction, *pad.inner), outer.point(direction, *pad.outer)
        return _approach(pad, *rows)

    return Touch([(pad.side, pad.weight, along(pad.direction))], along(pad.rubs))


def flange_patches(pad: Pad, patch: Patch, inner: WallPoints, outer: WallPoints) -> Touch:
    """A station of a flat boom with pads of a size; it slides as :func:`flanges`. Collective."""
    sides: tuple[Side, Side] = (1, -1)
    points = [
        (
            int(side),
            1.0,
            combine_readings(
                [(0.5, _mean_approach(pad, patch, side, half, inner, outer)) for half in (1, -1)]
            ),
        )
        for side in sides
    ]
    return Touch(points, combine_readings([(0.5, row) for _, _, row in points]))


def corner_patch(
    pad: Pad, patch: Patch, at_corner: Touch, inner: WallPoints, outer: WallPoints
) -> Touch:
    """A pad of a size in space; it slides as its corner does. Collective."""
    reading = _mean_approach(pad, patch, pad.side, half_of(pad), inner, outer)
    return Touch([(pad.side, pad.weight, reading)], at_corner.slide)


def half_of(pad: Pad) -> int:
    """On which half of its wall a pad in space sits: 1 where the coordinate across is positive."""
    return int(np.sign(pad.inner[0] if pad.direction == "z" else pad.inner[1]))


def _mean_approach(
    pad: Pad, patch: Patch, side: Side, half: int, inner: WallPoints, outer: WallPoints
) -> Reading:
    """Mean of u − w over a patch: read the other way round, a uniform pressure on both walls."""
    x, along = gauss(patch.start, patch.end, _PATCH_POINTS)
    across, over = gauss(half * patch.near, half * patch.far, _PATCH_POINTS)
    places = np.column_stack([np.repeat(x, across.size), np.tile(across, x.size)])
    weights = np.outer(along, over).ravel()
    wall = Wall(pad.direction, side)
    return _approach(
        pad,
        inner.mean(wall, places, weights, pad.direction),
        outer.mean(wall, places, weights, pad.direction),
    )


def _approach(pad: Pad, inner: Row, outer: Row) -> Reading:
    return relative((pad.joint.inner, inner), (pad.joint.outer, outer))
