# SPDX-License-Identifier: LGPL-3.0-or-later
"""Common polygons: hexagons, octagons, and U-sections of folded plates with a flat top.

Sizes refer to mid-lines and are in m. The origin y = z = 0 is in the middle of height and width.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.fields import check_numbers
from protractile.geometry.polygon import PolygonSection, bent
from protractile.geometry.section import SectionError


def hexagon(
    height: float, width: float, flat: float, top: float, bottom: float, web: float
) -> PolygonSection:
    """Return a hexagon: level top and bottom, and two inclined plates on each side.

    >>> print(pt.hexagon(0.5, 0.4, flat=0.2, top=0.006, bottom=0.008, web=0.005))
    500 x 400 x 8 / 5 / 6, 6 plates

    Args:
        height: distance between bottom and top.
        width: distance between the folds of both sides.
        flat: width of the top, and of the bottom.
        top, bottom, web: thicknesses of the top, the bottom, and the inclined plates.

    Raises:
        SectionError: the top is not narrower than the section, or as in :class:`PolygonSection`.
    """
    check_numbers("hexagon", height=height, width=width, flat=flat)
    if not flat < width:
        raise SectionError(f"flat must be below the width of {width:g} m, got {flat:g}")
    return _mirror_right_half(
        [(flat, -height), (width, 0.0), (flat, height)], [bottom, web, web, top]
    )


def octagon(
    height: float, width: float, chamfer: float, top: float, bottom: float, web: float
) -> PolygonSection:
    """Return a rectangle with corners cut at 45°.

    >>> print(pt.octagon(0.5, 0.4, chamfer=0.1, top=0.006, bottom=0.008, web=0.005))
    500 x 400 x 8 / 5 / 6, 8 plates

    Args:
        height, width: height and width of the rectangle.
        chamfer: length by which each cut shortens the sides.
        top, bottom, web: thicknesses of the top, the bottom, and all other plates.

    Raises:
        SectionError: the cuts remove a whole side, or as in :class:`PolygonSection`.
    """
    check_numbers("octagon", height=height, width=width, chamfer=chamfer)
    if not 2.0 * chamfer < min(height, width):
        raise SectionError(
            f"chamfer must be below half the height and half the width, "
            f"{0.5 * min(height, width):g} m, got {chamfer:g}"
        )
    flat, upright = width - 2.0 * chamfer, height - 2.0 * chamfer
    right = [(flat, -height), (width, -upright), (width, upright), (flat, height)]
    return _mirror_right_half(right, [bottom, web, web, web, top])


def u_section(
    height: float,
    width: float,
    radius: float,
    facets: int,
    top: float,
    bottom: float,
    web: float,
    weld: float | None = None,
) -> PolygonSection:
    """Return a U-section with a flat top; each bend consists of plates tangent to its circle.

    Area, second moments and torsion constant are those of the circle.

    >>> print(pt.u_section(0.5, 0.4, radius=0.15, facets=3, top=0.008, bottom=0.006, web=0.006))
    500 x 400 x 6 / 8, 10 plates, R 150

    Args:
        height: distance between bottom and top.
        width: distance between the webs.
        radius: radius of the bends; if it is half the width, both form one semicircle.
        facets: number of flat plates in each bend between the level bottom and the web, at least
            one.
        top, bottom, web: thicknesses of the top, of the bottom with its bends, and of the webs.
        weld: height of the welds of two half shells above the bottom; below them the webs are as
            thick as the bottom.

    Raises:
        SectionError: the bends are larger than the section or have no facet, the welds are not
            between bends and top, or as in
            :class:`PolygonSection`.
    """
    check_numbers("u_section", height=height, width=width, radius=radius, facets=facets)
    if facets < 1:
        raise SectionError(f"a bend has one facet at least, got {facets}")
    most = min(0.5 * width, height)
    if not 0.0 < radius <= most:
        raise SectionError(
            f"radius must be above 0 and not above half the width and the height, {most:g} m, got "
            f"{radius:g}"
        )
    if weld is not None and not radius < weld < height:
        raise SectionError(
            f"weld must be above the bends, {radius:g} m, and below the height of {height:g} m, "
            f"got {weld:g}"
        )
    welds = [] if weld is None else [[width, 2.0 * weld - height]]
    fold = 0.5 * np.pi / (facets + 1)
    angles = (np.arange(facets + 1) + 0.5) * fold
    corner = radius / np.cos(0.5 * fold)
    y = 0.5 * width - radius + corner * np.sin(angles)
    z = -0.5 * height + radius - corner * np.cos(angles)
    right = np.vstack([2.0 * np.column_stack([y, z]), *welds, [width, height]])
    sharp = _mirror_right_half(right, [bottom, *[bottom] * (facets + len(welds)), web, top])
    return bent(sharp, radius, below=0.5 * height)


def _mirror_right_half(
    twice: Sequence[tuple[float, float]] | Array, thicknesses: Sequence[float]
) -> PolygonSection:
    """Return the mirror-symmetric section with this right half.

    Args:
        twice: doubled (y, z) in m of the right half's corners (num_corners, 2), upwards.
        thicknesses: thicknesses in m of the bottom, the plates between the corners, and the top.
    """
    right = 0.5 * np.array(twice)
    left = right[::-1] * [-1.0, 1.0]
    bottom, *between, top = thicknesses
    corners = tuple((float(y), float(z)) for y, z in [*left[-1:], *right, *left[:-1]])
    return PolygonSection(corners, (bottom, *between, top, *between[::-1]))
