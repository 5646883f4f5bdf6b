# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a model has gone through: section forces, stresses, and how they exceed those at rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dynamics.line import Line, Quantity
from dynamics.trajectory import Trajectory
from geometry.arrays import Array
from geometry.axial import on_foot
from geometry.boom import Boom, Segment, Support
from geometry.cylinder import forces
from geometry.section import Direction
from runs.pipeline.at_rest import AtRest, place_names
from runs.pipeline.section_forces import rounded, section_forces
from runs.pipeline.stresses import Fibres, FibreStress, Varying, WallStress, largest_stresses


@dataclass(frozen=True, slots=True)
class Envelope:
    """What a segment has gone through: the least and the largest of every curve of a diagram.

    Args:
        segment: its name.
        x: (num_places) in m; a place where something jumps stands twice.
        low, high: of each curve over the run, as of :class:`Diagram`.
    """

    segment: str
    x: list[float]
    low: dict[str, list[float]]
    high: dict[str, list[float]]


@dataclass(frozen=True, slots=True)
class Peak:
    """The largest of a motion beside the largest at rest, by their absolute values.

    Args:
        what: ``deflection``, ``contact force``, ``cylinder force``, ``reaction``, where something
            acts along the boom also ``reaction along the boom`` and ``reaction, across and along``,
            ``moment at the support`` or ``bending moment``; in space those to the sides, called
            ``lateral``, and ``torque at the support``.
        where: the place, as the results or the case name it.
        unit: of the SI.
        largest: of the motion; of contacts the mean over an output interval, which is what a pad
            feels, not the peak of a blow.
        time: when, in s.
        at_rest: the largest at rest under the largest loads, wherever it is drawn to; None where
            there is no rest.
    """

    what: str
    where: str
    unit: str
    largest: float
    time: float
    at_rest: float | None

    @property
    def factor(self) -> float | None:
        """The dynamic factor; None where nothing is at rest."""
        return self.largest / self.at_rest if self.at_rest else None


@dataclass(frozen=True, slots=True)
class Moved:
    """What a model has gone through.

    Args:
        envelopes: of each segment.
        peaks: largest over static.
        fibres: of each segment whose section is known; none of rigid ones.
        walls: of shells.
    """

    envelopes: list[Envelope]
    peaks: list[Peak]
    fibres: list[FibreStress]
    walls: list[WallStress]


class _Plane(NamedTuple):
    """What the section forces of a plane of bending are called."""

    direction: Direction
    name: str
    shear: Quantity
    moment: Quantity


_PLANES = (
    _Plane("z", "", "shear", "moment"),
    _Plane("y", "lateral ", "lateral_shear", "lateral_moment"),
)


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


class _Gone(NamedTuple):
    """What a segment has gone through, (num_times, num_places), and at rest (num_rests, ...).

    ``on_foot`` is the axial force in N that its foot bears.
    """

    segment: Segment
    on_foot: float
    line: Line
    curves: Mapping[Quantity, Array]
    still: Mapping[Quantity, Array]


def gone_through(motions: Motions) -> tuple[Moved, list[Varying]]:
    """Of beams, or of a shell but for its walls, and the stress where it varies most."""
    envelopes, peaks = [], list(_observed(motions))
    fibres, varying = [], []
    times = motions.trajectory.time, np.array([rest.time for rest in motions.rests])
    states = motions.trajectory.states, motions.positions
    for number, line in enumerate(motions.lines):
        segment = motions.boom.segments[number]
        curves, still = (
            section_forces(motions.boom, number, line, *one)
            for one in zip(states, times, strict=True)
        )
        borne = on_foot(motions.boom.segments, motions.boom.joints, number)
        gone = _Gone(segment, borne, line, curves, still)
        envelopes.append(_envelope(gone))
        if "moment" in curves:
            peaks += _section_peaks(motions, gone)
        if (found := Fibres.of(segment, line)) is not None:
            largest, most = largest_stresses(segment, found, curves, still, times[0])
            fibres.append(largest)
            varying.append(most)
    return Moved(envelopes, peaks, fibres, walls=[]), varying


def _envelope(gone: _Gone) -> Envelope:
    return Envelope(
        gone.segment.name,
        rounded(gone.line.x),
        {name: rounded(values.min(axis=0)) for name, values in gone.curves.items()},
        {name: rounded(values.max(axis=0)) for name, values in gone.curves.items()},
    )


class _Measured(NamedTuple):
    """Something over time beside what it is in each rest, (num_times,) and (num_rests,)."""

    what: str
    where: str
    unit: str
    values: Array
    still: Sequence[float] | Array


def _peak(one: _Measured, time: Array) -> Peak:
    step = int(np.abs(one.values).argmax())
    still = max((float(abs(value)) for value in one.still), default=None)
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


def _section_peaks(motions: Motions, gone: _Gone) -> Iterator[Peak]:
    """Of the bending moments, and of what supports bear."""
    for plane in _PLANES:
        if plane.moment in gone.curves:
            moments = gone.curves[plane.moment]
            most = moments[:, np.abs(moments).max(axis=0).argmax()]
            still = np.abs(gone.still[plane.moment]).max(axis=1).tolist()
            bent = _Measured(f"{plane.name}bending moment", gone.segment.name, "N m", most, still)
            yield _peak(bent, motions.trajectory.time)
    for support in gone.segment.supports if motions.jumps else ():
        for borne in _borne(motions, gone, support):
            yield _peak(borne, motions.trajectory.time)


def _borne(motions: Motions, gone: _Gone, support: Support) -> Iterator[_Measured]:
    """What a support bears: the jumps of the section forces."""
    segment, line = gone.segment, gone.line
    where = f"{segment.name} at {support.x:g} m"
    forces = []
    for plane in _PLANES:
        if plane.shear not in line.rows:
            continue
        forces.append(_jump(motions, line, plane.shear, support.x))
        yield _Measured(f"{plane.name}reaction", where, "N", *forces[-1])
        if support.holds_slope(plane.direction) or support.rotation_stiffness:
            held = _jump(motions, line, plane.moment, support.x)
            yield _Measured(f"{plane.name}moment at the support", where, "N m", *held)
    if "torque" in line.rows:
        held = _jump(motions, line, "torque", support.x)
        yield _Measured("torque at the support", where, "N m", *held)
    if support is segment.foot and (segment.compression or "normal" in line.rows):
        along = [gone.on_foot + each for each in _jump(motions, line, "normal", support.x)]
        yield _Measured("reaction along the boom", where, "N", *along)
        whole = [np.linalg.norm(parts, axis=0) for parts in zip(*forces, along, strict=True)]
        yield _Measured("reaction, across and along", where, "N", *whole)


def _jump(motions: Motions, line: Line, name: Quantity, x: float) -> tuple[Array, Array]:
    """(num_times,) and (num_rests,) what a line reads less behind x than before it."""
    states = motions.trajectory.states, motions.positions
    row = np.zeros(states[0].shape[1])
    if name in line.rows:
        row = line.beside(name, x, -1) - line.beside(name, x, 1)
    return states[0] @ row, states[1] @ row
