# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms that are drawn out, and an integration of their motion that shares nothing with ours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from dynamics.arrays import Array
from dynamics.contact import PowerContact
from dynamics.equilibrium import equilibrium
from dynamics.gap_system import GapSystem
from dynamics.travel import SCurve
from geometry.boom import Boom, Segment
from geometry.drive import Drive

LAW = PowerContact(1.0e6, 1.0, clearance=7.0e-3)
DRAWN = Drive(SCurve(4.0, 5.0), ("inner", "outer"))


def shifted(segment: Segment, way: float) -> Segment:
    return replace(segment, start=segment.start + way, end=segment.end + way)


def telescope(boom: Boom, way: float, drive: Drive | None = None, **changes: Any) -> Boom:
    """The paper's boom with an overlap of 5 m, drawn out by a way in m already."""
    outer, inner = boom.segments
    inner = shifted(inner, way - 4.0)
    joint = replace(boom.joints[0], stations=(inner.start, outer.end), drive=drive, **changes)
    return replace(boom, segments=(outer, inner), joints=(joint,))


def tips(system: GapSystem) -> list[float]:
    """What observers of the ends read at rest."""
    rest = equilibrium(system, system.load)
    return [float(system.observers[name].row @ rest) for name in ("tip", "head", "tail")]


def hermite(xi: float, h: float) -> Array:
    """(2, 4) cubics of an element and their slopes."""
    return np.array(
        [
            [1 - 3 * xi**2 + 2 * xi**3, h * (xi - 2 * xi**2 + xi**3),
             3 * xi**2 - 2 * xi**3, h * (xi**3 - xi**2)],
            [6 * (xi**2 - xi) / h, 1 - 4 * xi + 3 * xi**2,
             6 * (xi - xi**2) / h, 3 * xi**2 - 2 * xi],
        ]
    )  # fmt: skip


class Beam:
    """Cubic elements of a uniform beam, assembled by the closed forms of textbooks."""

    def __init__(self, segment: Segment, nodes: Sequence[float]) -> None:
        self.nodes = np.array(nodes)
        dofs = 2 * len(nodes)
        self.stiffness, self.mass = np.zeros((2, dofs, dofs))
        self.load = np.zeros(dofs)
        for e, h in enumerate(np.diff(self.nodes)):
            at = slice(2 * e, 2 * e + 4)
            self.stiffness[at, at] += segment.bending_stiffness / h**3 * np.array(
                [[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2],
                 [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h**2, -6 * h, 4 * h**2]]
            )  # fmt: skip
            self.mass[at, at] += segment.mass_per_length * h / 420 * np.array(
                [[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2],
                 [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]]
            )  # fmt: skip
            self.load[at] += segment.load * h * np.array([0.5, h / 12, 0.5, -h / 12])
        held = [2 * int(np.argmin(np.abs(self.nodes - s.x))) for s in segment.supports]
        self.free = np.setdiff1d(np.arange(dofs), held)

    @cached_property
    def _whole(self) -> list[Array]:
        """What elements take up to each node, see :meth:`pressed`."""
        parts = [self._part(a, b) for a, b in pairwise(self.nodes)]
        return list(accumulate(parts, initial=np.zeros((self.free.size, self.free.size))))

    def pressed(self, end: float) -> Array:
        """(num_free, num_free) ∫ w′ᵀ w′ dx from its start up to an x in m."""
        e = min(int(np.searchsorted(self.nodes, end, "right")) - 1, self.nodes.size - 2)
        return np.asarray(self._whole[e] + self._part(self.nodes[e], end))

    def _part(self, a: float, b: float) -> Array:
        total = np.zeros((self.free.size, self.free.size))
        for point, weight in zip(*np.polynomial.legendre.leggauss(3), strict=True):
            slope = self.rows(0.5 * (a + b + point * (b - a)))[1]
            total += 0.5 * (b - a) * weight * np.outer(slope, slope)
        return total

    def rows(self, x: float) -> Array:
        """(2, num_free) that read the deflection at x and its slope."""
        e = min(int(np.searchsorted(self.nodes, x, "right")) - 1, self.nodes.size - 2)
        h = self.nodes[e + 1] - self.nodes[e]
        rows = np.zeros((2, self.load.size))
        rows[:, 2 * e : 2 * e + 4] = hermite((x - self.nodes[e]) / h, h)
        return rows[:, self.free]


def runge_kutta(
    boom: Boom, history: SCurve, times: Array, thrust: float = 0.0
) -> tuple[Array, float]:
    """Tip (num_times,) in m and the work of the drive in J, by Hermite elements.

    A thrust in N presses the inner segment, and the outer one as far as the inner one's tail.
    """
    nodes = (0.0, 2.0, 3.5, 5.0, 7.5, 10.0), (5.0, 7.5, 10.0, 12.5, 15.0)
    outer, inner = (Beam(segment, own) for segment, own in zip(boom.segments, nodes, strict=True))
    n = outer.free.size
    blocks = [
        (beam.stiffness[np.ix_(beam.free, beam.free)], beam.mass[np.ix_(beam.free, beam.free)])
        for beam in (outer, inner)
    ]
    inverses = [np.linalg.inv(mass) for _, mass in blocks]
    tail, head = boom.joints[0].stations
    softer = thrust * inner.pressed(boom.tip)

    def change(time: float, state: Array) -> Array:
        part = np.clip(time / history.duration, 0.0, 1.0)
        way = history.travel * (part - np.sin(2 * np.pi * part) / (2 * np.pi))
        speed = history.travel / history.duration * (1 - np.cos(2 * np.pi * part))
        (q, v), forces, power = np.split(state[:-1], 2), [outer.load, inner.load], 0.0
        forces = [force[beam.free] for force, beam in zip(forces, (outer, inner), strict=True)]
        forces[0] = forces[0] - blocks[0][0] @ q[:n]
        forces[1] = forces[1] - blocks[1][0] @ q[n:]
        if thrust:
            slope = outer.rows(tail + way)[1] @ q[:n]
            forces[0] = forces[0] + thrust * outer.pressed(tail + way) @ q[:n]
            forces[1] = forces[1] + softer @ q[n:]
            power -= 0.5 * thrust * speed * slope**2
        for x_outer, x_inner, moved in ((tail + way, tail, 0), (head, head - way, 1)):
            (w, w_slope), (u, u_slope) = outer.rows(x_outer), inner.rows(x_inner)
            gap = u @ q[n:] - w @ q[:n]
            force = 1.0e6 * np.sign(gap) * max(abs(gap) - 7.0e-3, 0.0)
            forces[0] = forces[0] + force * w
            forces[1] = forces[1] - force * u
            power += force * speed * (-u_slope @ q[n:] if moved else -w_slope @ q[:n])
        rates = np.concatenate([b @ f for b, f in zip(inverses, forces, strict=True)])
        return np.concatenate([v, rates, [power]])

    start = np.zeros(2 * (n + inner.free.size) + 1)
    found = solve_ivp(
        change, (0.0, times[-1]), start, "DOP853", times, rtol=1e-9, atol=1e-12, max_step=1e-3
    )
    places = found.y[: (len(start) - 1) // 2]
    return np.asarray(inner.rows(boom.tip)[0] @ places[n:]), float(found.y[-1, -1])
