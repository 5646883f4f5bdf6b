# SPDX-License-Identifier: LGPL-3.0-or-later
"""Extreme section forces and stresses of a motion, and their dynamic factors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from protractile.analysis.model import AnalysisModel, round_values
from protractile.analysis.states import StaticResult
from protractile.analysis.stresses import (
    Fibres,
    FibreStress,
    StressCurve,
    WallStress,
    largest_stresses,
)
from protractile.dynamics.line import Quantity
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.arrays import Array
from protractile.geometry.axial import foot_thrust
from protractile.geometry.boom import Boom
from protractile.geometry.cylinder import forces
from protractile.geometry.section import Direction

# Smallest static value for which a dynamic factor is given, as a fraction of the maximum in motion.
LEAST_STATIC = 1.0e-3


@dataclass(frozen=True, slots=True)
class Envelope:
    """Envelope of a segment: minimum and maximum of every curve of a diagram."""

    segment: str  #: name of the segment
    x: list[float]  #: positions (num_places) in m; a position with a jump occurs twice
    low: dict[str, list[float]]  #: minimum of each curve over the run, named as in :class:`Diagram`
    high: dict[str, list[float]]  #: maximum of each curve over the run


@dataclass(frozen=True, slots=True)
class Peak:
    """Largest magnitude of a quantity in motion, and its static value."""

    #: name of the quantity, ``deflection``, ``contact force``, ``cylinder force``, ``rope force``,
    #: ``reaction``, with axial loads also ``reaction along the boom`` and ``reaction, across and
    #: along``, ``moment at the support``, ``bending moment``; in space also ``torque at the
    #: support``, and the same names with ``lateral`` for y
    what: str
    where: str  #: location in the results or the case
    unit: str  #: SI unit
    #: maximum of the motion; for contacts the maximum of the means over output intervals, which is
    #: the design load of a pad, not the peak of an impact
    largest: float
    time: float  #: time of the maximum in s
    #: static maximum under the extreme loads, at any extension; None without an equilibrium
    at_rest: float | None

    @property
    def factor(self) -> float | None:
        """The dynamic factor; None without a static value, or if it is close to zero."""
        rest = self.at_rest or 0.0
        return self.largest / rest if abs(rest) > LEAST_STATIC * abs(self.largest) else None


@dataclass(frozen=True, slots=True)
class MotionResult:
    """Extreme values of the motion of a model."""

    envelopes: list[Envelope]  #: envelope of each segment
    peaks: list[Peak]  #: maxima of all quantities, with their static values
    fibres: list[FibreStress]  #: largest stress of each elastic segment with a known section
    walls: list[WallStress]  #: largest wall stresses of a shell


class _Plane(NamedTuple):
    """Names of the section forces in a plane of bending."""

    direction: Direction
    name: str
    shear: Quantity
    moment: Quantity


_PLANES = (
    _Plane("z", "", "shear", "moment"),
    _Plane("y", "lateral ", "lateral_shear", "lateral_moment"),
)


def evaluate_motion(
    model: AnalysisModel,
    trajectory: Trajectory,
    positions: Array,
    rests: Sequence[StaticResult],
    jumps: bool,
) -> tuple[MotionResult, list[StressCurve]]:
    """Return extreme values of a motion without wall stresses, and stress histories for fatigue.

    The stress history of a segment belongs to the point where the stress varies most. Static states
    belong to the equilibria (num_rests, num_modes). ``jumps`` is True if section forces jump at
    point forces, False for a series, which is smooth.
    """
    envelopes, peaks = [], list(_output_peaks(model.boom, trajectory, rests))
    fibres, varying = [], []
    time, rest_times = trajectory.time, np.array([rest.time for rest in rests])
    for number, (segment, line) in enumerate(zip(model.boom.segments, model.lines, strict=True)):
        curves = model.section_forces(number, trajectory.states, time)
        forces_at_rest = model.section_forces(number, positions, rest_times)
        low, high = (
            {str(name): round_values(limit(one, axis=0)) for name, one in curves.items()}
            for limit in (np.min, np.max)
        )
        envelopes.append(Envelope(segment.name, round_values(line.x), low, high))
        for plane in _PLANES:
            if plane.moment in curves:
                moments = curves[plane.moment]
                largest_at = moments[:, np.abs(moments).max(axis=0).argmax()]
                at_rest = np.abs(forces_at_rest[plane.moment]).max(axis=1)
                name = f"{plane.name}bending moment"
                peaks.append(_peak(name, segment.name, "N m", time, largest_at, at_rest))
        if "moment" in curves and jumps:
            peaks += _reactions(model, number, trajectory, positions, rest_times)
        if (fibre_set := Fibres.of(segment, line)) is not None:
            largest, most = largest_stresses(segment, fibre_set, curves, forces_at_rest, time)
            fibres.append(largest)
            varying.append(most)
    return MotionResult(envelopes, peaks, fibres, walls=[]), varying


def _peak(
    what: str,
    where: str,
    unit: str,
    time: Array,
    values: Array,
    rest_values: Sequence[float] | Array,
) -> Peak:
    """Return the peak of values (num_times,) in motion, with that of static ones (num_rests,)."""
    step = int(np.abs(values).argmax())
    at_rest = max((float(abs(value)) for value in rest_values), default=None)
    return Peak(what, where, unit, float(abs(values[step])), float(time[step]), at_rest)


def _output_peaks(
    boom: Boom, trajectory: Trajectory, rests: Sequence[StaticResult]
) -> Iterator[Peak]:
    """Yield the peaks of the outputs in the trajectory."""
    data, time = trajectory.data, trajectory.time
    tips = [rest.tip for rest in rests]
    yield _peak("deflection", "tip", "m", time, data["tip"].values, tips)
    if boom.spatial:
        rest_values = [rest.tip_lateral or 0.0 for rest in rests]
        yield _peak("lateral deflection", "tip", "m", time, data["tip_lateral"].values, rest_values)
    for station in boom.stations:
        values = data["contact_force"].values[:, station.index]
        rest_values = [rest.stations[station.index].force for rest in rests]
        yield _peak("contact force", station.name, "N", time, values, rest_values)
    for name in forces(boom):
        rest_values = [rest.cylinders[name] for rest in rests]
        yield _peak("cylinder force", name, "N", time, data[name].values, rest_values)
    if "rope_force_peak" in data:
        rope = data["rope_force_peak"]
        yield _peak("rope force", "", "N", time, rope.values, [rope.attrs["weight"]])


def _reactions(
    model: AnalysisModel, number: int, trajectory: Trajectory, positions: Array, rest_times: Array
) -> Iterator[Peak]:
    """Yield the peaks of the support reactions of a segment, from jumps of its section forces.

    ``positions`` (num_rests, num_modes) are equilibria at ``rest_times`` (num_rests,) in s.
    """
    boom, line, time = model.boom, model.lines[number], trajectory.time
    states = trajectory.states, positions

    def jump(name: Quantity, x: float) -> list[Array]:
        """Return the jump of a section force at x, in motion and in the static states."""
        row = np.zeros(states[0].shape[1])
        if name in line.rows:
            row = line.one_sided_row(name, x, -1) - line.one_sided_row(name, x, 1)
        return [each[:, : row.size] @ row for each in states]

    segment = boom.segments[number]
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
            along = [
                each + foot_thrust(boom.segments, boom.joints, number, times, boom.axial_changes)
                for each, times in zip(jump("normal", support.x), (time, rest_times), strict=True)
            ]
            yield _peak("reaction along the boom", where, "N", time, *along)
            whole = [np.linalg.norm(parts, axis=0) for parts in zip(*across, along, strict=True)]
            yield _peak("reaction, across and along", where, "N", time, *whole)
