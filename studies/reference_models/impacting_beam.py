# SPDX-License-Identifier: LGPL-3.0-or-later
"""Ball that falls on the tip of a cantilever, with the data of a Siconos tutorial."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh, lu_factor, lu_solve

from protractile.dynamics.contact import Gap
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array

# Beam of 1 m, 10 mm radius, E, ρ, elements; ball of 1 kg at −2 m/s, 1 µm above the free tip.
RADIUS, YOUNG, DENSITY, ELEMENTS = 0.01, 210.0e9, 7800.0, 100
SPEED, HEIGHT, DURATION = -2.0, 1.0e-6, 0.06


def beam(elements: int) -> tuple[Array, Array]:
    """Return mass and stiffness matrix of Euler-Bernoulli elements, with the tip's rows first."""
    length, area = 1.0 / elements, np.pi * RADIUS**2
    bend, turn = length, length**2
    # Upper triangles, of which the lower ones are the mirror image.
    stiff = [[6, 6 * bend, -12, 6 * bend], [0, 2 * turn, -6 * bend, 2 * turn],
             [0, 0, 6, -6 * bend], [0, 0, 0, 2 * turn]]  # fmt: skip
    heavy = [[78, 22 * bend, 54, -13 * bend], [0, 2 * turn, 13 * bend, -3 * turn],
             [0, 0, 78, -22 * bend], [0, 0, 0, 2 * turn]]  # fmt: skip
    mass, stiffness = np.zeros((2, 2 * elements + 2, 2 * elements + 2))
    for start in range(0, 2 * elements, 2):
        place = slice(start, start + 4), slice(start, start + 4)
        mass[place] += DENSITY * area * length / 420.0 * np.add(heavy, np.transpose(heavy))
        stiffness[place] += (
            YOUNG * 0.25 * np.pi * RADIUS**4 / length**3 * np.add(stiff, np.transpose(stiff))
        )
    return mass[:-2, :-2], stiffness[:-2, :-2]


def moreau_jean(step: float, duration: float = DURATION) -> Array:
    """Return the positions (num_steps + 1, 2) of ball and tip in m by Moreau-Jean with θ = ½.

    If the predicted gap is closed, Newton's impact law with a coefficient of restitution of 0
    determines the velocity at the end of the step (Acary and Brogliato 2008).
    """
    mass, stiffness = beam(ELEMENTS)
    n = len(mass)
    factor = lu_factor(mass + 0.25 * step**2 * stiffness)
    tip = np.eye(n)[0]
    response = lu_solve(factor, tip)
    weight = 1.0 + response[0]
    q, v, ball, speed = np.zeros(n), np.zeros(n), HEIGHT, SPEED
    found = [(ball, q[0])]
    for _ in range(round(duration / step)):
        free = v - lu_solve(factor, step * stiffness @ (q + 0.5 * step * v))
        close = ball - q[0] + 0.5 * step * (speed - v[0]) <= 0.0
        impulse = max(0.0, (free[0] - speed) / weight) if close else 0.0
        after, faster = free - impulse * response, speed + impulse
        q, ball = q + 0.5 * step * (v + after), ball + 0.5 * step * (speed + faster)
        v, speed = after, faster
        found.append((ball, q[0]))
    return np.array(found)


def falling(elements: int, stop: Gap, duration: float) -> Motion:
    """Return the motion of ball and beam, before integration, for a contact law and duration."""
    omega2, shapes = eigh(*beam(elements)[::-1])
    tip, ball = np.append(shapes[0], 0.0), np.eye(omega2.size + 1)[-1]
    system = GapSystem(
        omega2=np.append(omega2, 0.0),
        load=np.zeros(ball.size),
        rows=(ball - tip)[None],
        laws=[stop],
        station_of_row=np.array([0]),
        stations=[1.0],
        observers={"ball": Observer(ball), "tip": Observer(tip)},
    )
    return Motion(system, duration, 1e-3, velocity=SPEED * ball)
