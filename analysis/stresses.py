# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stresses of outer fibres and of shell walls, and utilisations.

σ = N/A + M_y z/J + M_z y/J_z (Navier 1826). Section forces of a shell are integrals of its wall
stresses, so that beams and shells give the same nominal stress.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from protractile.analysis.model import AnalysisModel
from protractile.dynamics.line import Line, Quantity
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Segment
from protractile.geometry.section import Section

if TYPE_CHECKING:
    import xarray as xr


# Name of the load of each kind of part, and its limit.
LIMITS: Mapping[str, tuple[str, str]] = {
    "plate": ("local plate stress", "yield"),
    "outer fibre": ("bending stress", "yield"),
    "pad": ("pad pressure", "the allowable pressure"),
    "detail": ("fatigue damage", "the fatigue life"),
}


@dataclass(frozen=True, slots=True)
class FibreStress:
    """Largest axial stress in an outer fibre of a segment, from section forces."""

    segment: str  #: name of the segment
    x: float  #: position along the boom in m
    y: float  #: lateral position in m, 0 for a planar boom
    z: float  #: vertical position in m
    stress: float  #: stress in Pa, positive in tension
    time: float  #: time of the stress in s
    #: utilisation of the yield strength; None if the case has no yield strength
    utilisation: float | None
    #: largest |stress| in Pa of the segment in the static states; None without an equilibrium
    at_rest: float | None


@dataclass(frozen=True, slots=True)
class WallStress:
    """Largest von Mises stresses of a segment of a shell near stations and supports."""

    segment: str  #: name of the segment
    x: float  #: position in m of the station or support near the patch
    patch: float  #: largest mean over a patch of a wall in Pa; it converges with mesh refinement
    time: float  #: time of this mean in s
    triangle: float  #: largest stress of a triangle in Pa; it may grow with mesh refinement
    #: utilisation of the yield strength by the mean over the patch, or None
    utilisation: float | None


class StressCurve(NamedTuple):
    """Stress history (num_times,) of a segment in Pa at (x, y, z) in m."""

    segment: str
    at: tuple[float, float, float]
    stress: Array


@dataclass(frozen=True, slots=True)
class Fibres:
    """Outer fibres of a segment, and their stresses under unit section forces."""

    x: Array  #: positions along the boom (num_places,) in m
    y: Array  #: lateral positions (num_fibres, num_places) in m
    z: Array  #: vertical positions (num_fibres, num_places) in m
    of_moment: Array  #: stress (num_fibres, num_places) in Pa for a vertical moment of 1 N·m
    of_lateral: Array  #: stress (num_fibres, num_places) in Pa for a lateral moment of 1 N·m
    of_normal: Array  #: stress (num_places,) in Pa for a normal force of 1 N

    @classmethod
    def of(cls, segment: Segment, line: Line) -> Fibres | None:
        """Return the fibres; None if the section is unknown or the line has no bending moment."""
        if segment.section is None or "moment" not in line.rows:
            return None
        spatial = "lateral_moment" in line.rows
        there = [segment.prismatic_at(x) for x in line.x.tolist()]
        y, z = _corners(segment, line.x, spatial)
        of_moment = z / _each(there, "second_moment_of_area")
        of_lateral = y / _each(there, "lateral.second_moment_of_area") if spatial else y
        return cls(line.x, y, z, of_moment, of_lateral, 1.0 / _each(there, "section.area"))

    def stress(self, fibre: int, curves: Mapping[Quantity, Array]) -> Array:
        """Return the stress (..., num_places) in Pa of a fibre under section forces."""
        stress = self.of_moment[fibre] * curves["moment"] + self.of_normal * curves["normal"]
        if "lateral_moment" in curves:
            stress += self.of_lateral[fibre] * curves["lateral_moment"]
        return np.asarray(stress)


def _each(segments: Sequence[Segment], number: str) -> Array:
    return np.array([attrgetter(number)(segment) for segment in segments])


def _corners(segment: Segment, x: Array, spatial: bool) -> tuple[Array, Array]:
    """Return y and z (num_fibres, num_places) in m of the outer corners of a segment.

    For a planar boom y is 0, and corners with the same z count once.
    """
    different = x.tolist() if segment.head_section is not None else [float(x[0])]
    corners = np.array([outer_corners(segment.section_at(place)) for place in different])
    points = np.broadcast_to(corners, (x.size, *corners.shape[1:]))
    y, z = np.moveaxis(points, 0, -1)
    if spatial:
        return y, z
    _, heights = np.unique(z[:, 0], return_index=True)
    return np.zeros_like(z[heights]), z[heights]


def outer_corners(section: Section) -> tuple[Array, Array]:
    """Return y and z (num_corners,) in m of the outer corners of the plates, from the centroid.

    Along y and z, a corner lies half a thickness outside the intersection of two mid-lines. The
    thickness is that of the plate with the larger component of its normal in this direction.
    """
    places, beyond = [], []
    for before, after in zip(
        section.plates[-1:] + section.plates[:-1], section.plates, strict=True
    ):
        # The normal has the components of the tangent, exchanged.
        normals = [0.5 * plate.thickness * np.abs(plate.tangent[::-1]) for plate in (before, after)]
        places.append(after.start)
        beyond.append(np.maximum(*normals))
    y, z = (np.array(places) + np.sign(places) * np.array(beyond)).T
    return y, z


def fibre_forces(
    model: AnalysisModel, states: Array, time: Array
) -> Iterator[tuple[Segment, Fibres, dict[Quantity, Array]]]:
    """Yield each segment with a known section, its outer fibres and its section forces.

    ``states`` are modal coordinates (num_times, num_modes) at the times (num_times,) in s.
    """
    for number, (segment, line) in enumerate(zip(model.boom.segments, model.lines, strict=True)):
        if (fibres := Fibres.of(segment, line)) is not None:
            yield segment, fibres, model.section_forces(number, states, time)


def largest_stresses(
    segment: Segment,
    fibres: Fibres,
    curves: Mapping[Quantity, Array],
    forces_at_rest: Mapping[Quantity, Array],
    time: Array,
) -> tuple[FibreStress, StressCurve]:
    """Return the largest stress of a segment, and the stress history with the largest variation.

    Section forces are (num_times, num_places) in motion and (num_rests, num_places) at rest.
    """
    largest, where = 0.0, (0, 0, 0)
    histories, at_rest = [], []
    for fibre in range(len(fibres.z)):
        stress = fibres.stress(fibre, curves)
        step, place = np.unravel_index(np.abs(stress).argmax(), stress.shape)
        if abs(stress[step, place]) > abs(largest):
            largest, where = float(stress[step, place]), (fibre, int(step), int(place))
        widest = int(np.ptp(stress, axis=0).argmax())
        at = float(fibres.x[widest]), float(fibres.y[fibre, widest]), float(fibres.z[fibre, widest])
        histories.append(StressCurve(segment.name, at, stress[:, widest].copy()))
        at_rest.append(np.abs(fibres.stress(fibre, forces_at_rest)).max(initial=0.0))
    fibre, at_step, at_place = where
    largest_stress = FibreStress(
        segment=segment.name,
        x=float(fibres.x[at_place]),
        y=float(fibres.y[fibre, at_place]),
        z=float(fibres.z[fibre, at_place]),
        stress=largest,
        time=float(time[at_step]),
        utilisation=utilisation(segment, largest),
        at_rest=float(max(at_rest)) if len(forces_at_rest["moment"]) else None,
    )
    return largest_stress, max(histories, key=lambda one: float(np.ptp(one.stress)))


def utilisation(segment: Segment, stress: float) -> float | None:
    """Return the utilisation of the yield strength; None if the segment has none."""
    strength = segment.yield_strength
    return None if strength is None else abs(stress) / strength


def wall_stresses(boom: Boom, stresses: xr.Dataset) -> list[WallStress]:
    """Return the largest wall stresses near stations and supports, for each segment of a shell.

    The stresses are those of :func:`.shell_model.stress.history.stress_near_places`.
    """
    largest_of_segments = []
    for segment in boom.segments:
        patches = stresses["von_mises_patch"].sel(segment=segment.name).values
        if not np.isfinite(patches).any():
            continue
        step, place = np.unravel_index(np.nanargmax(patches), patches.shape)
        patch = float(patches[step, place])
        largest_of_segments.append(
            WallStress(
                segment=segment.name,
                x=float(stresses["place"].values[place]),
                patch=patch,
                time=float(stresses["time"].values[step]),
                triangle=float(np.nanmax(stresses["von_mises"].sel(segment=segment.name).values)),
                utilisation=utilisation(segment, patch),
            )
        )
    return largest_of_segments


class Utilisation(NamedTuple):
    """Largest load of a kind of part, compared with its strength."""

    part: str  #: kind of the part, a key of :data:`LIMITS`; plates are walls of shells near pads
    segment: str  #: name of the segment
    x: float  #: position in m
    load: float  #: stress or pressure in Pa, or fatigue damage
    value: float | None  #: utilisation; None if the case gives no strength

    def __str__(self) -> str:
        """Return value, location and comparison with 100 % as text; the value is not None."""
        assert self.value is not None
        relation = "exceeds" if self.value > 1.0 else "below"
        name, limit = LIMITS[self.part]
        return (
            f"{100.0 * self.value:.3g} % by {name} ({self.segment} segment, x = {self.x:.4g} m): "
            f"{relation} {limit}"
        )
