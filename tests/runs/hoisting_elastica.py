# SPDX-License-Identifier: LGPL-3.0-or-later
"""A clamped inextensible bar that hoists a load, with large rotations, integrated by scipy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import Legendre, leggauss
from scipy.integrate import solve_ivp
from scipy.optimize import root

from protractile.dynamics.arrays import Array
from protractile.dynamics.excitation import History

GRAVITY = 9.80665
# Number of polynomials of the rotation, and of Gauss points along the bar.
_TERMS, _POINTS = 4, 10


@dataclass(frozen=True, slots=True)
class HoistingBar:
    """A bar whose axis has the angle α + Σ q_i s^i at s L, and a load on a rope along gravity.

    Every point moves as the integral of its rotations says, so that no rotation is small. The load
    moves along gravity only.

    Args:
        length, stiffness, mass_per_length: L in m, EI in N·m² and kg/m.
        angle: α in rad.
        load, payload: masses on the rope and at the tip in kg.
        rope: stiffness of the rope in N/m.
        hoist: hoisted length in m over time.
        hanging: whether the load hangs at rest at t = 0, or lies on the ground below a straight
            rope without force.
    """

    length: float
    stiffness: float
    mass_per_length: float
    angle: float
    load: float
    rope: float
    hoist: History
    hanging: bool = False
    payload: float = 0.0

    def tips(self, times: Array) -> Array:
        """Return the deflection (num_times,) of the tip in m across the bar, positive upwards."""
        points, weights = leggauss(_POINTS)
        s, weights = 0.5 * (points + 1.0), 0.5 * self.length * weights
        powers = np.arange(1, _TERMS + 1)
        shapes, slopes = s[:, None] ** powers, powers * s[:, None] ** (powers - 1) / self.length
        # Integrals up to each Gauss point and to the tip of the polynomials through these points.
        ends = np.append(points, 1.0)
        basis = [Legendre.basis(k) for k in range(_POINTS)]
        integrals = np.array([p.integ(lbnd=-1.0)(ends) for p in basis]).T
        upto = 0.5 * self.length * integrals @ np.linalg.inv(np.array([p(points) for p in basis]).T)
        bending = self.stiffness * (slopes.T * weights) @ slopes
        masses = np.append(self.mass_per_length * weights, self.payload)

        def kinematics(q: Array) -> tuple[Array, Array, Array]:
            """Return directions (2, points), places (2, ends) and their derivatives."""
            rotation = self.angle + shapes @ q
            along = np.array([np.cos(rotation), np.sin(rotation)])
            across = np.array([-along[1], along[0]])
            return along, along @ upto.T, np.einsum("es,ds,si->dei", upto, across, shapes)

        def forces(q: Array, pull: float) -> Array:
            _, _, moves = kinematics(q)
            return np.asarray(-bending @ q - GRAVITY * masses @ moves[1] - pull * moves[1, -1])

        weight = self.load * GRAVITY
        start = root(forces, np.zeros(_TERMS), args=(weight if self.hanging else 0.0,), tol=1e-12).x
        lowest = kinematics(start)[1][1, -1]
        sag = weight / self.rope if self.hanging else 0.0

        def rate(time: float, state: Array) -> Array:
            q, dq = state[:_TERMS], state[_TERMS : 2 * _TERMS]
            height, speed = state[-2:]
            along, places, moves = kinematics(q)
            wound = float(self.hoist(np.array(time)))
            pull = self.rope * max(places[1, -1] - lowest - height + wound, 0.0)
            lift = pull / self.load - GRAVITY
            if not self.hanging and height <= 0.0:
                lift = max(lift, 0.0)
            turning = -(along * (shapes @ dq) ** 2) @ upto.T
            inertia = np.einsum("dei,e,dej->ij", moves, masses, moves)
            gyration = np.einsum("dei,e,de->i", moves, masses, turning)
            ddq = np.linalg.solve(inertia, forces(q, pull) - gyration)
            return np.concatenate([dq, ddq, [speed, lift]])

        state = np.concatenate([start, np.zeros(_TERMS), [-sag, 0.0]])
        found = solve_ivp(
            rate, times[[0, -1]], state, "LSODA", times, rtol=1e-6, atol=1e-8, max_step=0.02
        )
        normal = np.array([-np.sin(self.angle), np.cos(self.angle)])
        return np.array([normal @ kinematics(q)[1][:, -1] for q in found.y[:_TERMS].T])
