# SPDX-License-Identifier: LGPL-3.0-or-later
"""Telescoping booms, and an independent integration of their motion."""

from bisect import bisect
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from itertools import accumulate
from math import copysign, cos, pi, sin
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import block_diag

from beam_model.elements import Theory
from beam_model.finite_element import finite_element_segments
from beam_model.segment_model import gap_system
from dynamics.arrays import Array
from dynamics.contact import PowerContact
from dynamics.equilibrium import equilibrium
from dynamics.excitation import SCurve
from dynamics.gap_system import GapSystem
from geometry.boom import Boom, Segment
from geometry.joint import Drive

LAW = PowerContact(1.0e6, 1.0).with_clearance(7.0e-3)
DRIVE = Drive(SCurve(4.0, 5.0), ("inner", "outer"))


def shifted(segment: Segment, way: float) -> Segment:
    return replace(segment, start=segment.start + way, end=segment.end + way)


def telescope(boom: Boom, way: float, drive: Drive | None = None, **changes: Any) -> Boom:
    """Return the paper's boom with an overlap of 5 m, reduced by an initial extension in m."""
    outer, inner = boom.segments
    inner = shifted(inner, way - 4.0)
    joint = replace(boom.joints[0], stations=(inner.start, outer.end), drive=drive, **changes)
    return replace(boom, segments=(outer, inner), joints=(joint,))


def elements(
    boom: Boom,
    length: float = 0.5,
    theory: Theory = "euler-bernoulli",
    rotary_inertia: bool = True,
) -> GapSystem:
    return gap_system(boom, finite_element_segments(boom, length, theory, rotary_inertia))


def tips(system: GapSystem) -> list[float]:
    """Return the outputs of the ends at rest."""
    rest = equilibrium(system, system.load)
    return [float(system.observers[name].row @ rest) for name in ("tip", "head", "tail")]


# The longest element in m, of the library's beams and of those here.
LONGEST = 3.0

# Coefficients (4, 4) of 1, ξ, ξ², ξ³ in the cubics of an element of unit length.
HERMITE = np.array([[1, 0, 0, 0], [0, 1, 0, 0], [-3, -2, 3, -1], [2, 1, -2, 1]], dtype=float)
# i j and i + j − 1 of the powers from 1 on: ∫ d(ξⁱ) d(ξʲ) = i j ξⁱ⁺ʲ⁻¹/(i + j − 1).
POWERS = np.outer([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])
DEGREE = np.add.outer([0.0, 1.0, 2.0], [1.0, 2.0, 3.0])


class Beam:
    """Cubic elements of a uniform beam, assembled by the closed forms of textbooks."""

    def __init__(self, segment: Segment, nodes: Sequence[float]) -> None:
        self.nodes = list(nodes)
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
        held = [2 * self.nodes.index(s.x) for s in segment.supports]
        self.free = np.setdiff1d(np.arange(dofs), held)
        self.cubics = []
        for e, h in enumerate(np.diff(self.nodes)):
            own = np.zeros((4, dofs))
            own[:, 2 * e : 2 * e + 4] = HERMITE * [1.0, h, 1.0, h]
            self.cubics.append(own[:, self.free])

    @cached_property
    def _whole(self) -> list[Array]:
        """The integrals of :meth:`pressed` up to each node."""
        parts = [self._part(e, 1.0, h) for e, h in enumerate(np.diff(self.nodes))]
        return list(accumulate(parts, initial=np.zeros((self.free.size, self.free.size))))

    def pressed(self, end: float) -> Array:
        """Return ∫ w′ᵀ w′ dx (num_free, num_free) from the start of the beam to x in m."""
        e, xi, h = self._place(end)
        return np.asarray(self._whole[e] + self._part(e, xi, h))

    def _part(self, e: int, xi: float, h: float) -> Array:
        own = self.cubics[e][1:]
        return np.asarray(own.T @ (POWERS * xi**DEGREE / (DEGREE * h)) @ own)

    def _place(self, x: float) -> tuple[int, float, float]:
        """Return the element at x in m, the relative position in it, and its length in m."""
        e = min(bisect(self.nodes, x) - 1, len(self.cubics) - 1)
        h = self.nodes[e + 1] - self.nodes[e]
        return e, (x - self.nodes[e]) / h, h

    def rows(self, x: float) -> Array:
        """Return the rows (2, num_free) of the deflection and the slope at x in m."""
        e, xi, h = self._place(x)
        powers = np.array([[1.0, xi, xi**2, xi**3], [0.0, 1.0 / h, 2.0 * xi / h, 3.0 * xi**2 / h]])
        return np.asarray(powers @ self.cubics[e])


def runge_kutta(boom: Boom, history: SCurve, times: Array, thrust: float) -> tuple[Array, float]:
    """Return the tip deflection (num_times,) in m and the work of the drive in J by Hermite
    elements.

    A thrust in N compresses the inner segment, and the outer segment up to the tail of the inner
    one.
    """
    # Those of the library's elements, of LONGEST at most.
    nodes = (0.0, 2.0, 5.0, 7.5, 10.0), (5.0, 7.5, 10.0, 12.5, 15.0)
    outer, inner = (Beam(segment, own) for segment, own in zip(boom.segments, nodes, strict=True))
    n, ends = outer.free.size, outer.free.size + inner.free.size
    stiffness, mass = (
        block_diag(*(getattr(one, name)[np.ix_(one.free, one.free)] for one in (outer, inner)))
        for name in ("stiffness", "mass")
    )
    stiffness[n:, n:] -= thrust * inner.pressed(boom.tip)
    inverse = np.linalg.inv(mass)
    turned = -inverse @ stiffness
    pushed = inverse @ np.concatenate([outer.load[outer.free], inner.load[inner.free]])
    tail, head = boom.joints[0].stations

    def change(time: float, state: Array) -> Array:
        part = min(max(time / history.duration, 0.0), 1.0)
        way = history.travel * (part - sin(2 * pi * part) / (2 * pi))
        speed = history.travel / history.duration * (1 - cos(2 * pi * part))
        q, v = state[:ends], state[ends:-1]
        softened = thrust * outer.pressed(tail + way) @ q[:n]
        rates = turned @ q + pushed + inverse[:, :n] @ softened
        power = -0.5 * thrust * speed * (outer.rows(tail + way)[1] @ q[:n]) ** 2
        for x_outer, x_inner, moved in ((tail + way, tail, 0), (head, head - way, 1)):
            (w, w_slope), (u, u_slope) = outer.rows(x_outer), inner.rows(x_inner)
            gap = u @ q[n:] - w @ q[:n]
            if abs(gap) > 7.0e-3:
                force = 1.0e6 * (gap - copysign(7.0e-3, gap))
                rates += force * (inverse @ np.concatenate([w, -u]))
                power += force * speed * (-u_slope @ q[n:] if moved else -w_slope @ q[:n])
        return np.concatenate([v, rates, [power]])

    start = np.zeros(2 * ends + 1)
    found = solve_ivp(
        change, (0.0, times[-1]), start, "DOP853", times, rtol=1e-9, atol=1e-12, max_step=1e-3
    )
    places = found.y[:ends]
    return np.asarray(inner.rows(boom.tip)[0] @ places[n:]), float(found.y[-1, -1])
