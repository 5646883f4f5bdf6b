# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a model has gone through: section forces, stresses, and how they exceed those at rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr

from dynamics.line import Line
from dynamics.trajectory import Trajectory
from geometry.arrays import Array
from geometry.boom import Boom, Segment, Support
from geometry.cylinder import forces
from runs.pipeline.answers import (
    AtRest,
    Envelope,
    FibreStress,
    Moved,
    Peak,
    WallStress,
    rounded,
)
from runs.pipeline.fibres import Fibres
from runs.pipeline.results import place_names


class Varying(NamedTuple):
    """The stress of a segment at (x, y, z) in m, (num_times,) in Pa."""

    segment: str
    at: tuple[float, float, float]
    stress: Array


@dataclass(frozen=True, slots=True)
class Motions:
    """A motion, and the rests that it is held against.

    Args:
        boom: with the play that the model has.
        lines: along its segments.
        trajectory: the motion.
        positions: (num_rests, num_modes) of the rests; none where there is no rest.
        rests: what is told of them.
        jumps: whether lines jump where forces act, as those of series do not.
    """

    boom: Boom
    lines: Sequence[Line]
    trajectory: Trajectory
    positions: Array
    rests: Sequence[AtRest]
    jumps: bool

    @property
    def told(self) -> Moved:
        """Of beams, or of a shell but for its walls."""
        return Moved(
            envelopes=[
                _envelope(segment, line, self.trajectory.states)
                for segment, line in zip(self.boom.segments, self.lines, strict=True)
            ],
            peaks=[*_observed(self), *_section_peaks(self)],
            fibres=[_largest_stress(*of, self) for of in self._fibres()],
            walls=[],
        )

    @property
    def varying(self) -> list[Varying]:
        """The stress of each segment where it varies most."""
        return [_varying(*of, self.trajectory.states) for of in self._fibres()]

    def _fibres(self) -> Iterator[tuple[Segment, Fibres]]:
        for segment, line in zip(self.boom.segments, self.lines, strict=True):
            fibres = Fibres.of(segment, line)
            if fibres is not None:
                yield segment, fibres


def _envelope(segment: Segment, line: Line, states: Array) -> Envelope:
    curves = line.read(states)
    return Envelope(
        segment.name,
        rounded(line.x),
        {name: rounded(values.min(axis=0)) for name, values in curves.items()},
        {name: rounded(values.max(axis=0)) for name, values in curves.items()},
    )


def _largest_stress(segment: Segment, fibres: Fibres, motions: Motions) -> FibreStress:
    trajectory, largest, where = motions.trajectory, 0.0, (0, 0, 0)
    for fibre in range(len(fibres.z)):
        stress = fibres.stress(fibre, trajectory.states)
        step, place = np.unravel_index(np.abs(stress).argmax(), stress.shape)
        if abs(stress[step, place]) > abs(largest):
            largest, where = float(stress[step, place]), (fibre, int(step), int(place))
    fibre, at_step, at_place = where
    still = [
        float(np.abs(fibres.stress(k, motions.positions)).max())
        for k in range(len(fibres.z))
        if motions.positions.size
    ]
    return FibreStress(
        segment=segment.name,
        x=float(fibres.x[at_place]),
        y=float(fibres.y[fibre, at_place]),
        z=float(fibres.z[fibre, at_place]),
        stress=largest,
        time=float(trajectory.time[at_step]),
        utilisation=utilisation(segment, largest),
        at_rest=max(still, default=None),
    )


def _varying(segment: Segment, fibres: Fibres, states: Array) -> Varying:
    found = []
    for fibre in range(len(fibres.z)):
        stress = fibres.stress(fibre, states)
        place = int(np.ptp(stress, axis=0).argmax())
        at = float(fibres.x[place]), float(fibres.y[fibre, place]), float(fibres.z[fibre, place])
        found.append(Varying(segment.name, at, stress[:, place].copy()))
    return max(found, key=lambda one: float(np.ptp(one.stress)))


def utilisation(segment: Segment, stress: float) -> float | None:
    """Of its yield strength; None where that is not known."""
    strength = segment.material.yield_strength
    return None if strength is None else abs(stress) / strength


class _Measured(NamedTuple):
    """Something over time beside what it is in each rest, (num_times,) and (num_rests,)."""

    what: str
    where: str
    unit: str
    values: Array
    still: Sequence[float]


def _peak(one: _Measured, time: Array) -> Peak:
    step = int(np.abs(one.values).argmax())
    still = max((abs(value) for value in one.still), default=None)
    return Peak(
        one.what, one.where, one.unit, float(abs(one.values[step])), float(time[step]), still
    )


def _observed(motions: Motions) -> Iterator[Peak]:
    """Of what trajectories hold."""
    data, rests = motions.trajectory.data, motions.rests
    found = [_Measured("deflection", "tip", "m", data["tip"].values, [r.tip for r in rests])]
    if motions.boom.spatial:
        still = [rest.tip_lateral or 0.0 for rest in rests]
        found.append(_Measured("lateral deflection", "tip", "m", data["tip_lateral"].values, still))
    for number, name in enumerate(place_names(motions.boom.stations)):
        values = data["contact_force"].values[:, number]
        still = [rest.stations[number].force for rest in rests]
        found.append(_Measured("contact force", name, "N", values, still))
    for name in forces(motions.boom):
        still = [rest.cylinders[name] for rest in rests]
        found.append(_Measured("cylinder force", name, "N", data[name].values, still))
    return (_peak(one, motions.trajectory.time) for one in found)


def _section_peaks(motions: Motions) -> Iterator[Peak]:
    """Of bending moments, and of what supports bear."""
    states = motions.trajectory.states
    for segment, line in zip(motions.boom.segments, motions.lines, strict=True):
        if "moment" not in line.rows:
            continue
        rows = {("bending moment", segment.name, "N m"): line.rows["moment"]}
        for support in segment.supports if motions.jumps else ():
            rows |= _support_rows(segment, support, line)
        for named, of in rows.items():
            values = states @ of.T
            most = values[:, np.abs(values).max(axis=0).argmax()]
            still = [float(np.abs(of @ position).max()) for position in motions.positions]
            yield _peak(_Measured(*named, most, still), motions.trajectory.time)


def wall_stresses(boom: Boom, stresses: xr.Dataset) -> list[WallStress]:
    """Of each segment of a shell that comes near a place.

    Args:
        boom: of the shell.
        stresses: of :func:`shell_model.stress.history.near_places`.
    """
    found = []
    for segment in boom.segments:
        patches = stresses["von_mises_patch"].sel(segment=segment.name).values
        if not np.isfinite(patches).any():
            continue
        step, place = np.unravel_index(np.nanargmax(patches), patches.shape)
        patch = float(patches[step, place])
        found.append(
            WallStress(
                segment=segment.name,
                x=float(stresses["place"].values[place]),
                patch=patch,
                time=float(stresses["time"].values[step]),
                triangle=float(np.nanmax(stresses["von_mises"].sel(segment=segment.name).values)),
                utilisation=utilisation(segment, patch),
            )
        )
    return found


def _support_rows(
    segment: Segment, support: Support, line: Line
) -> Mapping[tuple[str, str, str], Array]:
    """(1, num_modes) what a support bears: the jump of the shear force, and of the moment."""
    where = f"{segment.name} at {support.x:g} m"
    before, behind = (line.beside("shear", support.x, side) for side in (-1, 1))
    rows = {("reaction", where, "N"): (before - behind)[None]}
    if support.kind == "clamped" or support.rotation_stiffness:
        before, behind = (line.beside("moment", support.x, side) for side in (-1, 1))
        rows["moment at the support", where, "N m"] = (behind - before)[None]
    return rows
