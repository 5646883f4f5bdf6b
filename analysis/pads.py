# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static and dynamic forces and pressures of slide pads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from protractile.dynamics.contact import ContactLaw
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.joint import PADS_OF_SIDE, SIDES, PadSide, PadSize
from protractile.geometry.section import EACH_SIDE
from protractile.geometry.station import Station

# Name of each side, by direction.
_SIDE_NAMES = {on: side for side, on in SIDES.items()}


@dataclass(frozen=True, slots=True)
class PadLoad:
    """Governing slide pad on one side of a station, in one model.

    ``x`` is the position of the station in m, ``force`` in N, ``pressure`` in Pa. ``utilisation``
    is None without an allowable pressure.
    """

    model: str
    outer: str
    inner: str
    x: float
    side: str
    force: float
    pressure: float
    utilisation: float | None


def pad_loads(model: str, boom: Boom, peaks: Array, net: bool) -> Iterator[PadLoad]:
    """Yield the governing pad on each side of each station with play.

    Args:
        model: name of the model.
        boom: boom with the contact laws of the model.
        peaks: contact forces (num_times, num_stations) in N.
        net: True if the forces are those of both sides together, as those of a beam.
    """
    ends = np.stack([peaks.min(axis=0), peaks.max(axis=0)], axis=1)
    for station in boom.stations:
        if station.joint is None:
            continue
        ends_of_joint = station.joint.outer, station.joint.inner
        outer, inner = (boom.segments[number].name for number in ends_of_joint)
        for pad, side, both in _largest_forces(station, ends[station.index], net):
            force, allowable = both / PADS_OF_SIDE, pad.allowable_pressure
            pressure = force / pad.area
            used = None if allowable is None else pressure / allowable
            yield PadLoad(model, outer, inner, station.x, side, force, pressure, used)


def _largest_forces(
    station: Station, pushes: Array, net: bool
) -> Iterator[tuple[PadSize, PadSide, float]]:
    """Yield the governing pads of a station, their side, and the force in N on both of a pair.

    The forces ``pushes`` are those of :func:`_pair_forces`, or the ``net`` forces of both sides.
    """
    if station.joint is not None and station.joint.pad is not None:
        largest = max(pushes, key=abs)
        force = abs(float(largest))
        if net:
            # Without preload by shims, one side carries the net force alone.
            sides = [station.law.one_sided(side) for side in EACH_SIDE]
            preloads = [float(abs(one.force(np.zeros(())))) for one in sides if one]
            force = max(force, max(preloads) + 0.5 * force)
        side = _SIDE_NAMES[station.direction, 1 if largest > 0.0 else -1]
        yield station.joint.pad, side, force
    for pad, force in zip(station.pads, _pair_forces(station, pushes), strict=True):
        yield pad, pad.side, force


def _pair_forces(station: Station, pushes: Array) -> list[float]:
    """Return the largest force in N on each pair of pads of a station.

    Args:
        station: the station.
        pushes: forces (num_pushes,) in N of all pads on one side, negative for side −1. This is the
            side with the larger force. Its approach determines the force on the other side.
    """
    laws, sides = [], [SIDES[pad.side][1] for pad in station.pads]
    for pad, side in zip(station.pads, sides, strict=True):
        whole = sum(other.stiffness for other in station.pads if other.side == pad.side)
        there = station.law.one_sided(side)
        assert there is not None
        part = there.with_weight(pad.stiffness / whole)
        laws.append(part.with_clearance(-pad.shim))
    if not laws:
        return []

    from scipy.optimize import brentq

    def force(approach: float) -> Array:
        return np.array([float(one.force(np.array(approach))) for one in laws])

    def excess(approach: float, push: float) -> float:
        return float(force(approach) @ np.equal(sides, np.sign(push))) - push

    largest = np.zeros(len(laws))
    for push in pushes[pushes != 0.0]:
        reach = 1.0e-3
        while excess(np.sign(push) * reach, push) * push < 0.0:
            reach *= 2.0
        largest = np.maximum(largest, np.abs(force(brentq(excess, -reach, reach, args=(push,)))))
    return [float(most) for most in largest]


def loaded_pads(station: Station, sides: Sequence[Array]) -> list[tuple[PadSize, Array]]:
    """Return the pads of known size at a station, each with its forces (num_states,) in N.

    ``sides`` are the forces (num_states,) on the two sides in N, in the order of ``EACH_SIDE``, not
    negative.
    """
    joint, loads = station.joint, list[tuple[PadSize | None, Array]]()
    if joint is None or not joint.padded:
        return []
    for side, force in zip(EACH_SIDE, sides, strict=True):
        # Pairs with thicker shims close first.
        pairs = sorted(joint.pads_of(station.direction, side), key=lambda pair: -pair[2])
        shares, shims = (np.array([pair[k] for pair in pairs]) for k in (1, 2))
        stiffnesses = [pad.stiffness for pad in station.pads if SIDES[pad.side][1] == side]
        stiffness = PADS_OF_SIDE * sum(stiffnesses) or 1.0
        # Each pair that closes reduces the compression of the pairs that closed before.
        closing = force[:, None] / stiffness - np.cumsum(shares * shims)
        compression = (closing / np.cumsum(shares)).min(axis=1, keepdims=True)
        forces = stiffness * (shares * np.maximum(compression + shims, 0.0)) / PADS_OF_SIDE
        loads += [(pair[0], of_pad) for pair, of_pad in zip(pairs, forces.T, strict=True)]
    return [(pad, force) for pad, force in loads if pad is not None]


def side_force(law: ContactLaw, side: int, gaps: Array) -> Array:
    """Return the contact forces (num_states,) in N on one side at gaps (num_states,) in m.

    They are positive in compression.
    """
    force = np.zeros(gaps.shape)
    for term in law.terms:
        if term.side == side:
            force += term.stiffness * np.maximum(side * gaps - term.onset, 0.0) ** term.exponent
    return force
