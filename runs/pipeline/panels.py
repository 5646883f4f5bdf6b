# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling of walls by formulas for long panels: a quick estimate from section forces.

Each wall is a long plate, simply supported at its folds, under a linear stress along the boom and a
mean shear stress. The estimate neglects the restraint by adjacent walls and the local load of pads.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.segment import Material, Segment
from runs.pipeline.static_results import Diagram, StaticResult

# Coefficient k of a long plate in shear (Southwell and Skan 1924).
SHEAR = 5.34


@dataclass(frozen=True, slots=True)
class PanelBuckling:
    """Wall of a segment that buckles first by panel formulas.

    Args:
        segment: name of the segment.
        wall: name of the wall.
        x: x of the cross-section in m.
        factor: buckling factor of the section forces.
    """

    segment: str
    wall: str
    x: float
    factor: float


def normal_coefficient(ratio: float) -> float:
    """Return k of a long plate for the ratio ψ of the stresses at its edges.

    ψ is the stress at the other edge over the largest compression (EN 1993-1-5, table 4.1): 4.0 in
    compression, 23.9 in bending.
    """
    if ratio >= 0.0:
        return 8.2 / (1.05 + ratio)
    if ratio > -1.0:
        return 7.81 - 6.29 * ratio + 9.78 * ratio**2
    # The table ends at −3, beyond which tension is neglected.
    return 5.98 * (1.0 - max(ratio, -3.0)) ** 2


def panel_factor(
    material: Material, slenderness: float, edges: tuple[float, float], shear: float
) -> float:
    """Return the buckling factor of a long panel; infinite without compression and shear.

    Stresses interact by EN 1993-1-5, (10.6).

    Args:
        material: isotropic material.
        slenderness: width over thickness.
        edges: axial stresses at both edges in Pa, positive in tension.
        shear: shear stress in Pa.
    """
    young, nu = material.youngs_modulus, material.poissons_ratio
    unit = np.pi**2 * young / (12.0 * (1.0 - nu**2) * slenderness**2)
    sheared = abs(shear) / (SHEAR * unit)
    largest = -min(edges)
    if largest <= 0.0:
        return 1.0 / sheared if sheared else np.inf
    ratio = max(-max(edges) / largest, -3.0)
    pressed = largest / (normal_coefficient(ratio) * unit)
    mean = 0.25 * (1.0 + ratio) * pressed
    return float(1.0 / (mean + np.sqrt(mean**2 + 0.5 * (1.0 - ratio) * pressed**2 + sheared**2)))


def weakest_panels(segments: Sequence[Segment], rest: StaticResult) -> list[PanelBuckling]:
    """Return the wall of each segment with a known section that buckles first in a static state."""
    found = []
    for segment, diagram in zip(segments, rest.diagrams, strict=True):
        if segment.section is not None and "moment" in diagram.curves:
            weakest = min(_panels(segment, diagram), key=lambda panel: panel.factor)
            if np.isfinite(weakest.factor):
                found.append(weakest)
    return found


def _panels(segment: Segment, diagram: Diagram) -> Iterator[PanelBuckling]:
    """Yield all walls of a segment at all places of its diagram."""
    none = [0.0] * len(diagram.x)
    curves = [
        diagram.normal,
        *(
            diagram.curves.get(name, none)
            for name in ("moment", "lateral_moment", "shear", "lateral_shear", "torque")
        ),
    ]
    for x, normal, moment, lateral, shear, aside, torque in zip(diagram.x, *curves, strict=True):
        section = segment.section_at(x)
        slopes = np.array(
            [
                lateral / section.lateral_second_moment_of_area,
                moment / section.second_moment_of_area,
            ]
        )
        forces = [(shear, section.shear_plates("z")), (aside, section.shear_plates("y"))]
        for number, plate in enumerate(section.plates):
            first, last = (
                float(normal / section.area + slopes @ place) for place in (plate.start, plate.end)
            )
            along = sum(abs(force * dict(shares).get(number, 0.0)) for force, shares in forces)
            flow = along / plate.length + abs(torque) / (2.0 * section.enclosed_area)
            slenderness = plate.length / plate.thickness
            factor = panel_factor(
                segment.material, slenderness, (first, last), flow / plate.thickness
            )
            yield PanelBuckling(segment.name, plate.name, x, factor)
