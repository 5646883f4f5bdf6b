# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stresses of walls from section forces, and buckling of walls by formulas for long panels.

Each wall is a long plate, simply supported at its folds; a weld on a straight line is none. Across
its width the axial stress is linear and the shear stress constant. Restraint by adjacent walls and
pad forces are neglected.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from protractile.analysis.measure import Measured
from protractile.analysis.rows import Row, Rows
from protractile.analysis.states import States
from protractile.analysis.stresses import outer_corners
from protractile.dynamics.line import LineQuantity
from protractile.geometry.arrays import Array
from protractile.geometry.material import Material
from protractile.geometry.section import Plate, Section
from protractile.geometry.segment import Segment
from protractile.geometry.walls import in_line

# Coefficient k of a long plate in shear (Southwell and Skan 1924).
SHEAR = 5.34

# Relative difference below which buckling factors are equal.
_EQUAL = 1.0e-9


class PlateStresses(NamedTuple):
    """Stresses of the plates of a segment in static states."""

    segment: Segment  #: the segment
    plates: tuple[Plate, ...]  #: the walls
    x: Array  #: (num_places,) x of the cross-sections in m
    #: (2, num_plates, num_states, num_places) axial stress at the ends of mid-lines in Pa, in
    #: tension
    edges: Array
    panel: Array  #: the same at the folds, between which welds may join a plate to others
    fibres: Array  #: (2, num_plates, num_states, num_places) axial stress at outer corners in Pa
    shear: Array  #: (num_plates, num_states, num_places) mean shear stress in Pa, not negative
    slenderness: Array  #: (num_plates, 1, 1) width for buckling over thickness

    @property
    def strengths(self) -> Array:
        """The yield strengths (num_plates, 1, 1) in Pa; NaN where unknown."""
        known = [self.segment.strength(plate) or np.nan for plate in self.plates]
        return np.array(known)[:, None, None]


def normal_coefficient(ratio: float | Array) -> Array:
    """Return the buckling coefficients k of long plates for the stress ratio ψ of their edges.

    ψ is the stress at the other edge over the largest compression. k is 4.0 in compression and
    23.9 in bending (EN 1993-1-5, table 4.1).
    """
    ratio = np.asarray(ratio)
    compressed, bent = 8.2 / (1.05 + np.maximum(ratio, 0.0)), 7.81 - 6.29 * ratio + 9.78 * ratio**2
    # The table ends at ψ = −3. More tension at the other edge is neglected.
    beyond = 5.98 * (1.0 - np.maximum(ratio, -3.0)) ** 2
    return np.asarray(np.select([ratio >= 0.0, ratio > -1.0], [compressed, bent], beyond))


def stress_ratio(edges: Array) -> Array:
    """Return the stress ratio ψ of two edges (2, ...), at least −3; 1 without compression.

    Axial stresses are in Pa, positive in tension.
    """
    largest = -edges.min(axis=0)
    compressed = largest > 0.0
    ratio = -edges.max(axis=0) / np.where(compressed, largest, 1.0)
    return np.asarray(np.where(compressed, np.maximum(ratio, -3.0), 1.0))


def panel_factor(
    material: Material,
    slenderness: float | Array,
    edges: tuple[float, float] | Array,
    shear: float | Array,
) -> Array:
    """Return the buckling factors (...) of a long panel; infinite without compression and shear.

    Stresses interact by EN 1993-1-5, (10.6).

    Args:
        material: isotropic material.
        slenderness: width over thickness, (...) or a number.
        edges: axial stresses (2, ...) at both edges in Pa, positive in tension.
        shear: shear stress (...) in Pa.
    """
    young, nu, edges = material.youngs_modulus, material.poissons_ratio, np.asarray(edges)
    unit = np.pi**2 * young / (12.0 * (1.0 - nu**2) * slenderness**2)
    shear_ratio = shear / (SHEAR * unit)
    ratio = stress_ratio(edges)
    compression = np.maximum(-edges.min(axis=0), 0.0) / (normal_coefficient(ratio) * unit)
    mean = 0.25 * (1.0 + ratio) * compression
    part = mean + np.sqrt(mean**2 + 0.5 * (1.0 - ratio) * compression**2 + shear_ratio**2)
    return np.asarray(np.divide(1.0, part, out=np.full_like(part, np.inf), where=part > 0.0))


def measure_plates(states: States) -> Iterator[Measured]:
    """Yield the buckling factors of each plate in static states, by panel formulas.

    Plates without compression and shear have none.
    """
    for found in plate_stresses(states):
        name, at = found.segment.name, (found.x, None, None)
        for plate, factors in zip(found.plates, _elastic_factor(found), strict=True):
            if np.isfinite(factors).any():
                yield Measured("plate_buckling", name, plate.name, factors, states.time, at)


def weakest_plates(rows: Rows) -> list[Row]:
    """Return the lowest buckling factor of each segment in the rows of a model."""
    weakest: dict[str, Row] = {}
    for row in rows.where(quantity="plate_buckling"):
        # Walls that mirror each other are equal; the first one counts.
        if row.value < (1.0 - _EQUAL) * weakest.setdefault(row.part, row).value:
            weakest[row.part] = row
    return [*weakest.values()]


def plate_stresses(states: States) -> Iterator[PlateStresses]:
    """Yield the stresses of the plates of each segment with a known section.

    A tapered segment has a section of its own at each place, each with its stresses.
    """
    for number, segment in enumerate(states.boom.segments):
        x, curves = states.model.lines[number].x, states.section_forces(number)
        if segment.section is None or "moment" not in curves:
            continue
        tapered = segment.head_section is not None
        for part in [slice(k, k + 1) for k in range(x.size)] if tapered else [slice(None)]:
            of_part = {name: values[:, part] for name, values in curves.items()}
            section = segment.section_at(float(x[part][0]))
            yield _of_section(segment, section, x[part], of_part)


def _of_section(
    segment: Segment, section: Section, x: Array, curves: Mapping[LineQuantity, Array]
) -> PlateStresses:
    """Return the stresses of plates under section forces (num_states, num_places)."""
    names: tuple[LineQuantity, ...] = (
        "moment", "lateral_moment", "shear", "lateral_shear", "torque",
    )  # fmt: skip
    moment, lateral, shear, lateral_shear, torque = (
        curves.get(name, np.zeros(x.size)) for name in names
    )
    mean = curves["normal"] / section.area
    along_y = lateral / section.lateral_second_moment_of_area
    along_z = moment / section.second_moment_of_area
    data = _plate_data(section)
    edges, panel, fibres = (
        mean + along_y * y + along_z * z for y, z in (data.edges, data.panel, data.fibres)
    )
    along = np.abs(shear * data.shares_z) + np.abs(lateral_shear * data.shares_y)
    flow = along / data.lengths + np.abs(torque) / (2.0 * section.enclosed_area)
    return PlateStresses(
        segment, section.plates, x, edges, panel, fibres, flow / data.thicknesses, data.slenderness
    )


class _PlateData(NamedTuple):
    """Data of the plates of a section; numbers of plates are (num_plates, 1, 1)."""

    edges: Array  #: (2, 2, num_plates, 1, 1) y and z in m of the start and the end of mid-lines
    panel: Array  #: the same at the folds
    fibres: Array  #: (2, 2, num_plates, 1, 1) y and z in m of the outer corners
    shares_z: Array  #: parts of plates of a shear force along z
    shares_y: Array  #: parts of plates of a shear force along y
    lengths: Array  #: lengths of mid-lines in m
    thicknesses: Array  #: thicknesses in m
    slenderness: Array  #: width for buckling over thickness


# Combinations and load cases share the sections of a case.
@lru_cache(maxsize=256)
def _plate_data(section: Section) -> _PlateData:
    plates = section.plates
    corners = np.array(outer_corners(section))
    ends = np.transpose([[plate.start for plate in plates], [plate.end for plate in plates]])
    edges, lines = ends.transpose(0, 2, 1), in_line(plates)
    first, last = np.transpose([(line[0], line[-1]) for line in lines])
    panel = np.stack([edges[:, 0, first], edges[:, 1, last]], axis=1)
    widths = [sum(section.buckling_widths[number] for number in line) for line in lines]
    fibres = np.stack([corners, np.roll(corners, -1, axis=1)], axis=1)
    shares_z, shares_y = np.zeros((2, len(plates)))
    for k, share in section.shear_plates("z"):
        shares_z[k] = share
    for k, share in section.shear_plates("y"):
        shares_y[k] = share
    lengths, walls = np.transpose([(plate.length, plate.thickness) for plate in plates])
    slenderness = np.array(widths) / walls
    data = edges, panel, fibres, shares_z, shares_y, lengths, walls, slenderness
    return _PlateData(*(np.asarray(each)[..., None, None] for each in data))


def reduced_stress(stresses: PlateStresses, curve: Sequence[tuple[float, float]] = ()) -> Array:
    """Return the equivalent stress (num_plates, num_states, num_places) in Pa, with buckling.

    √((σ/ρ)² + 3 (τ/χ)²) with the largest compression σ of the mid-line (EN 1993-1-5, 10 (5) b).
    It is NaN for plates without yield strength.

    Args:
        stresses: stresses of plates.
        curve: pairs of slenderness and reduction factor, for ρ and χ; if empty, :func:`winter` and
            :func:`shear_reduction` apply.
    """
    largest_compression = np.maximum(-stresses.edges.min(axis=0), 0.0)
    slenderness = relative_slenderness(stresses)
    along, across = reduction_factors(slenderness, stress_ratio(stresses.panel), curve)
    return np.asarray(np.hypot(largest_compression / along, np.sqrt(3.0) * stresses.shear / across))


def relative_slenderness(stresses: PlateStresses) -> Array:
    """Return the slenderness λ̄ (num_plates, num_states, num_places); NaN without strength."""
    largest_compression = np.maximum(-stresses.panel.min(axis=0), 0.0)
    equivalent = np.sqrt(largest_compression**2 + 3.0 * stresses.shear**2)
    with np.errstate(divide="ignore"):
        # Without stress the factor is infinite, and the slenderness zero.
        relative = np.where(equivalent > 0.0, stresses.strengths / equivalent, 0.0)
    return np.asarray(np.sqrt(relative / _elastic_factor(stresses)))


def _elastic_factor(stresses: PlateStresses) -> Array:
    """Return the factors (num_plates, num_states, num_places) at which plates buckle."""
    material, slenderness = stresses.segment.material, stresses.slenderness
    return panel_factor(material, slenderness, stresses.panel, stresses.shear)


def reduction_factors(
    slenderness: float | Array, ratio: float | Array, curve: Sequence[tuple[float, float]]
) -> tuple[Array, Array]:
    """Return the reduction factors ρ and χ, both by the curve if it is not empty.

    Beyond the curve they fall as the stress of elastic buckling, with 1/λ̄². Postbuckling strength
    falls less steeply, so that this is safe.
    """
    if curve:
        beyond = np.maximum(slenderness, curve[-1][0]) / curve[-1][0]
        both = np.asarray(np.interp(slenderness, *np.transpose(curve)) / beyond**2)
        return both, both
    return winter(slenderness, ratio), shear_reduction(slenderness)


def winter(slenderness: float | Array, ratio: float | Array = 1.0) -> Array:
    """Return the reduction factor ρ of an internal wall (Winter 1947; EN 1993-1-5, (4.2)).

    Args:
        slenderness: λ̄, the square root of strength over critical stress.
        ratio: ψ, the stress at the other edge over the largest compression.
    """
    slenderness, ratio = np.asarray(slenderness, dtype=float), np.maximum(ratio, -3.0)
    stocky = slenderness <= 0.5 + np.sqrt(0.085 - 0.055 * ratio)
    square = np.where(stocky, 1.0, slenderness**2)
    return np.asarray(np.where(stocky, 1.0, (slenderness - 0.055 * (3.0 + ratio)) / square))


def shear_reduction(slenderness: float | Array) -> Array:
    """Return the factor χ of a wall in shear, 0.83/λ̄ ≤ 1 (EN 1993-1-5, table 5.1, η = 1)."""
    return np.asarray(0.83 / np.maximum(slenderness, 0.83))
