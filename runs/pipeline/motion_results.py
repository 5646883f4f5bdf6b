# SPDX-License-Identifier: LGPL-3.0-or-later
"""Extreme section forces and stresses of a motion, and their dynamic factors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dynamics.line import Line, Quantity
from dynamics.trajectory import Trajectory
from geometry.arrays import Array
from geometry.axial import foot_thrust
from geometry.boom import Boom, Segment
from geometry.cylinder import forces
from geometry.section import Direction
from runs.pipeline.section_forces import rounded, section_forces
from runs.pipeline.static_results import StaticResult, place_names
from runs.pipeline.strength import Fibres, FibreStress, Varying, WallStress, largest_stresses


@dataclass(frozen=True, slots=True)
class Envelope:
    """Envelope of a segment: minimum and maximum of every curve of a diagram.

    Args:
        segment: name of the segment.
        x: (num_places) in m; a place with a jump occurs twice.
        low, high: minimum and maximum of each curve over the run, as in :class:`Diagram`.
    """

    segment: str
    x: list[float]
    low: dict[str, list[float]]
    high: dict[str, list[float]]


@dataclass(frozen=True, slots=True)
class Peak:
    """Maximum absolute value of a quantity in motion, and its static value.

    Args:
        what: name of the quantity: ``deflection``, ``contact force``, ``cylinder force``,
            ``rope force`` (at rest the weight of the load), ``reaction``, with axial loads also
            ``reaction along the boom`` and ``reaction, across and along``, ``moment at the
            support`` or ``bending moment``; in space the same for y, marked ``lateral``, and
            ``torque at the support``.
        where: name of the place in the results or the case.
        unit: SI unit.
        largest: maximum of the motion; for contacts the maximum of the means over output intervals,
            which is the design load of a pad, and not the peak of an impact.
        time: time of the maximum in s.
        at_rest: maximum at rest under the extreme loads, at any extension; None without an
            equilibrium.
    """

    what: str
    where: str
    unit: str
    largest: float
    time: float
    at_rest: float | None

    @property
    def factor(self) -> float | None:
        """The dynamic factor; None without a value at rest."""
        return self.largest / self.at_rest if self.at_rest else None


@dataclass(frozen=True, slots=True)
class MotionResult:
    """Extreme values of a model's motion.

    Args:
        envelopes: envelope of each segment.
        peaks: maxima of all quantities, with their static values.
        fibres: stress of each elastic segment with a known section.
        walls: wall stresses of shells.
    """

    envelopes: list[Envelope]
    peaks: list[Peak]
    fibres: list[FibreStress]
    walls: list[WallStress]


class _Plane(NamedTuple):
    """Names of the section forces of a plane of bending."""

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
    """A motion with the static states for comparison.

    Args:
        boom: the boom, with the play of the model.
        lines: lines along the segments.
        trajectory: the motion.
        positions: equilibria (num_rests, num_modes).
        rests: static states at the equilibria.
        jumps: whether section forces jump at point forces; those of series are smooth.
    """

    boom: Boom
    lines: Sequence[Line]
    trajectory: Trajectory
    positions: Array
    rests: Sequence[StaticResult]
    jumps: bool


def evaluate_motion(motions: Motions) -> tuple[MotionResult, list[Varying]]:
    """Return the extreme values of a motion, without those of walls.

    The second result is the stress history of each segment at the place where it varies most.
    """
    boom, envelopes, peaks = motions.boom, [], list(_observed(motions))
    fibres, varying = [], []
    time, rest_times = motions.trajectory.time, np.array([rest.time for rest in motions.rests])
    for number, (segment, line) in enumerate(zip(boom.segments, motions.lines, strict=True)):
        curves = section_forces(boom, number, line, motions.trajectory.states, time)
        still = section_forces(boom, number, line, motions.positions, rest_times)
        low: dict[str, list[float]] = {n: rounded(one.min(axis=0)) for n, one in curves.items()}
        high: dict[str, list[float]] = {n: rounded(one.max(axis=0)) for n, one in curves.items()}
        envelopes.append(Envelope(segment.name, rounded(line.x), low, high))
        if "moment" in curves:
            peaks += _bending_moments(segment, curves, still, time)
            if motions.jumps:
                peaks += _reactions(motions, number)
        if (found := Fibres.of(segment, line)) is not None:
            largest, most = largest_stresses(segment, found, curves, still, time)
            fibres.append(largest)
            varying.append(most)
    return MotionResult(envelopes, peaks, fibres, walls=[]), varying


def _peak(
    what: str, where: str, unit: str, time: Array, values: Array, still: Sequence[float] | Array
) -> Peak:
    """Return the maximum over time (num_times,), with the maximum at rest (num_rests,)."""
    step = int(np.abs(values).argmax())
    at_rest = max((float(abs(value)) for value in still), default=None)
    return Peak(what, where, unit, float(abs(values[step])), float(time[step]), at_rest)


def _observed(motions: Motions) -> Iterator[Peak]:
    """Yield the maxima of the quantities in the trajectories."""
    data, rests, time = motions.trajectory.data, motions.rests, motions.trajectory.time
    tips = [rest.tip for rest in rests]
    yield _peak("deflection", "tip", "m", time, data["tip"].values, tips)
    if motions.boom.spatial:
        still = [rest.tip_lateral or 0.0 for rest in rests]
        yield _peak("lateral deflection", "tip", "m", time, data["tip_lateral"].values, still)
    for number, name in enumerate(place_names(motions.boom.stations)):
        values = data["contact_force"].values[:, number]
        still = [rest.stations[number].force for rest in rests]
        yield _peak("contact force", name, "N", time, values, still)
    for name in forces(motions.boom):
        still = [rest.cylinders[name] for rest in rests]
        yield _peak("cylinder force", name, "N", time, data[name].values, still)
    if "rope_force_peak" in data:
        rope = data["rope_force_peak"]
        yield _peak("rope force", "", "N", time, rope.values, [rope.attrs["weight"]])


def _bending_moments(
    segment: Segment,
    curves: Mapping[Quantity, Array],
    still: Mapping[Quantity, Array],
    time: Array,
) -> Iterator[Peak]:
    for plane in _PLANES:
        if plane.moment in curves:
            moments = curves[plane.moment]
            most = moments[:, np.abs(moments).max(axis=0).argmax()]
            at_rest = np.abs(still[plane.moment]).max(axis=1)
            yield _peak(f"{plane.name}bending moment", segment.name, "N m", time, most, at_rest)


def _reactions(motions: Motions, number: int) -> Iterator[Peak]:
    """Yield the maxima of a segment's support reactions, which are jumps of its section forces."""
    segment, line = motions.boom.segments[number], motions.lines[number]
    states, time = (motions.trajectory.states, motions.positions), motions.trajectory.time

    def jump(name: Quantity, x: float) -> list[Array]:
        """Return a section force's jumps at x, in motion (num_times,) and at rest (num_rests,)."""
        row = np.zeros(states[0].shape[1])
        if name in line.rows:
            row = line.one_sided_row(name, x, -1) - line.one_sided_row(name, x, 1)
        return [each[:, : row.size] @ row for each in states]

    for support in segment.supports:
        where, across = f"{segment.name} at {support.x:g} m", []
        for plane in _PLANES:
            if plane.shear not in line.rows:
                continue
            across.append(jump(plane.shear, support.x))
            yield _peak(f"{plane.name}reaction", where, "N", time, *across[-1])
            if support.holds_slope(plane.direction) or support.rotation_stiffness:
                held = jump(plane.moment, support.x)
                yield _peak(f"{plane.name}moment at the support", where, "N m", time, *held)
        if "torque" in line.rows:
            yield _peak("torque at the support", where, "N m", time, *jump("torque", support.x))
        if support is segment.foot and (segment.compression or "normal" in line.rows):
            foot = foot_thrust(motions.boom.segments, motions.boom.joints, number)
            along = [foot + each for each in jump("normal", support.x)]
            yield _peak("reaction along the boom", where, "N", time, *along)
            whole = [np.linalg.norm(parts, axis=0) for parts in zip(*across, along, strict=True)]
            yield _peak("reaction, across and along", where, "N", time, *whole)
