# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is told of a shell's stresses when it has moved."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class WallForces:
    """What one wall carries through a cross-section, at the side towards the tip.

    Args:
        axial: force along x in N, positive in tension.
        shear: force in the wall's plane in N, along y in a flange and along z in a web or in any
            wall steeper than 45°, of the part beyond the section on the part before it.
        moment: of its axial stresses about the section's y-axis in N m, positive where they pull
            at the top.
    """

    axial: float
    shear: float
    moment: float


@dataclass(frozen=True, slots=True)
class LargestPatch:
    """The largest mean stress of a patch in Pa, when in s, in which segment, near which x in m."""

    von_mises: float
    time: float
    segment: str
    x: float


@dataclass(frozen=True, slots=True)
class CarriedAt:
    """What the walls of a segment carry through the cross-section at x in m, by their names."""

    segment: str
    x: float
    forces: dict[str, WallForces]


@dataclass(frozen=True, slots=True)
class PlaceHistory:
    """The largest stresses in Pa of a segment near x in m, in each part of the run."""

    segment: str
    x: float
    von_mises: list[float]
    von_mises_patch: list[float]


@dataclass(frozen=True, slots=True)
class StressHistory:
    """The middles of the parts of a run in s, and what each place has in them."""

    time: list[float]
    places: list[PlaceHistory]


@dataclass(frozen=True, slots=True)
class StressSummary:
    """The largest stress of a run, and what the walls carry then.

    Args:
        von_mises: in Pa, of a triangle.
        time: when, in s.
        segment, wall, face: where.
        x, y, z: of the triangle in m.
        band: how far the places of ``history`` reach to each side, in m.
        patch: None where no segment comes near a place.
        walls: of each segment at each place.
        history: over the run.
    """

    von_mises: float
    time: float
    segment: str
    wall: str
    face: str
    x: float
    y: float
    z: float
    band: float
    patch: LargestPatch | None
    walls: list[CarriedAt]
    history: StressHistory
