# SPDX-License-Identifier: LGPL-3.0-or-later
"""Deflections and section forces along segments of shells.

Mesh lines around the whole section divide a segment into bands. Deflections of a band are means
over the walls, along z of the walls in their planes, so that local bending of walls does not
contribute; section forces are integrals of membrane and bending stresses over the walls,
divided by the length of the band. The shear force also has the part −P w′ of the compression P.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from scipy.sparse import csr_matrix

from protractile.dynamics.line import Line, LineQuantity
from protractile.geometry.arrays import Array, Indices
from protractile.geometry.boom import Boom
from protractile.shell_model.stress.stresses import (
    SAME_LINE,
    ShellStress,
    linear_stress_weights,
    lines_around,
)

# Maximum number of bands of a segment.
_BANDS = 60


def lines(fields: xr.Dataset, boom: Boom) -> list[Line]:
    """Return rows of deflection and section forces along each segment, as a line with bands.

    Bands end at supports, loads and contacts.
    """
    unit_states = fields.assign(
        state=(("time", "mode"), np.zeros((1, fields.sizes["mode"]))), time=("time", np.zeros(1))
    )
    shell = ShellStress.from_fields(unit_states)
    return [_line(shell, fields, boom, number) for number in range(len(shell.plates))]


def _line(shell: ShellStress, fields: xr.Dataset, boom: Boom, number: int) -> Line:
    walls = shell.wall < len(shell.plates[number])
    triangles = np.flatnonzero((shell.segment == number) & walls)
    places = {support.x for support in boom.segments[number].supports}
    cuts = band_boundaries(shell.spans[triangles], sorted(places.union(boom.stations_of(number))))
    band = np.searchsorted(cuts, shell.centroids[triangles, 0]) - 1
    means = _mean_deflections(shell, fields, triangles, band, cuts.size - 1)
    corners = fields["points"].values[fields["triangles"].values[triangles]]
    part = band * len(shell.plates[number]) + shell.wall[triangles]
    reaches = _reaches(corners, part)
    forces = _forces(shell, number, triangles, band, part, np.diff(cuts), reaches)
    forces = forces @ fields[f"coordinates_{number + 1}"].values
    segment = boom.segments[number]
    if segment.compression:
        compression = segment.compression(0.5 * (cuts[1:] + cuts[:-1]))[:, None]
        along_y, along_z = _slopes(shell, fields, triangles, band, cuts.size - 1)
        forces[0] -= compression * along_z
        forces[2] -= compression * along_y
    rows: dict[LineQuantity, Array] = {
        "deflection": means[1],
        "shear": forces[0],
        "moment": forces[1],
    }
    if boom.spatial:
        rows |= {
            "lateral": means[0],
            "lateral_shear": forces[2],
            "lateral_moment": forces[3],
            "twist": means[2],
            "torque": forces[4],
        }
    return Line(0.5 * (cuts[1:] + cuts[:-1]), rows, paired=False)


def band_boundaries(spans: Array, places: Sequence[float]) -> Array:
    """Return the ascending x in m of the boundaries of bands, which are mesh lines.

    Args:
        spans: smallest and largest x (num_triangles, 2) of the triangles in m.
        places: ascending x in m of required boundaries.
    """
    free = lines_around(spans)
    near = np.abs(np.subtract.outer(free, places)).min(axis=1, initial=np.inf) < SAME_LINE
    needed = [free[0], *free[near], free[-1]]
    shortest = (free[-1] - free[0]) / _BANDS
    cuts = [free[0]]
    for x in free[1:]:
        ahead = min(place for place in needed if place >= x)
        if x == ahead or (x - cuts[-1] >= shortest and ahead - x >= shortest):
            cuts.append(x)
    return np.array(cuts)


def _mean_deflections(
    shell: ShellStress, fields: xr.Dataset, triangles: Indices, band: Indices, num_bands: int
) -> tuple[Array, Array, Array]:
    """Return the mean deflections along y and z, and the twist, (num_bands, num_modes) each."""
    corners = fields["triangles"].values[triangles]
    y, z = (fields["points"].values[corners, way] for way in (1, 2))
    area = np.repeat(shell.areas[triangles, None] / 3.0, 3, axis=1)
    num_points = fields.sizes["point"]

    def mean(weight: Array, of: Array) -> csr_matrix:
        rows = np.repeat(band, 3)
        total = np.bincount(rows, of.ravel(), num_bands)
        values = weight.ravel() / total[rows]
        return csr_matrix((values, (rows, corners.ravel())), (num_bands, num_points))

    modes = fields["modes"].values
    along_y, along_z = modes[:, :, 1].T, modes[:, :, 2].T
    polar = area * (y**2 + z**2)
    twist = mean(area * y, polar) @ along_z - mean(area * z, polar) @ along_y
    # The tangent around the section is (up, -across).
    across, up = (part[:, None] for part in shell.outward[triangles, 1:].T)
    webs = area * across**2
    in_plane = mean(webs, webs) @ along_z - mean(area * across * up, webs) @ along_y
    return (
        np.asarray(mean(area, area) @ along_y, dtype=float),
        np.asarray(in_plane, dtype=float),
        np.asarray(twist, dtype=float),
    )


def _slopes(
    shell: ShellStress, fields: xr.Dataset, triangles: Indices, band: Indices, num_bands: int
) -> Array:
    """Return the slopes v′ and w′ (2, num_bands, num_modes), averaged over the volume of bands."""
    corners = fields["triangles"].values[triangles]
    points = fields["points"].values[corners]
    across = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    # The gradient of a linear shape function is normal × opposite edge / (2 A).
    opposite = np.roll(points, 1, axis=1) - np.roll(points, -1, axis=1)
    along = np.cross(across[:, None], opposite)[..., 0] / (across**2).sum(axis=1)[:, None]
    volume = shell.areas[triangles] * shell.thickness[triangles]
    weight = (volume / np.bincount(band, volume, num_bands)[band])[:, None] * along
    indices = np.repeat(band, 3), corners.ravel()
    mean = csr_matrix((weight.ravel(), indices), (num_bands, fields.sizes["point"]))
    modes = fields["modes"].values
    return np.array([mean @ modes[:, :, way].T for way in (1, 2)], dtype=float)


def _reaches(corners: Array, part: Indices) -> tuple[Array, Array]:
    """Return the extents (num_parts,) along z and y in m of each wall in each band."""
    extents = []
    for way in (2, 1):
        low, high = np.full((2, int(part.max()) + 1), [[np.inf], [-np.inf]])
        np.minimum.at(low, part, corners[..., way].min(axis=1))
        np.maximum.at(high, part, corners[..., way].max(axis=1))
        extents.append(high - low)
    return extents[0], extents[1]


def _forces(
    shell: ShellStress,
    number: int,
    triangles: Indices,
    band: Indices,
    part: Indices,
    lengths: Array,
    reaches: tuple[Array, Array],
) -> Array:
    """Return section forces (5, num_bands, num_own) per unit of each coordinate of a segment.

    They are shear, moment, lateral shear, lateral moment and torque.
    """
    strength = shell.thickness[triangles] * shell.areas[triangles] / lengths[band]
    y, z = shell.centroids[triangles, 1:].T
    slope, across, up = shell.outward[triangles].T
    # s, x and the normal n are right-handed.
    s_y, s_z = up, -across
    bending_moment = shell.thickness[triangles] * strength / 6.0
    within_z, within_y = (
        linear_stress_weights(part, reach, strength, place)
        for reach, place in zip(reaches, (z, y), strict=True)
    )
    weights = (
        {2: s_z * strength, 0: -slope * up * strength},
        {0: strength * z + within_z, 3: up * bending_moment},
        {2: s_y * strength, 0: -slope * across * strength},
        {0: strength * y + within_y, 3: across * bending_moment},
        {2: strength * (y * s_z - z * s_y)},
    )
    first = int(np.searchsorted(shell.segment, number))
    modes = shell.modes[number][:, triangles - first]
    shape = lengths.size, triangles.size
    columns = np.arange(triangles.size)
    totals = []
    for of_component in weights:
        total = np.zeros((lengths.size, len(modes)))
        for component, weight in of_component.items():
            total += csr_matrix((weight, (band, columns)), shape) @ modes[:, :, component].T
        totals.append(total)
    return np.array(totals)
