# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion in contact by its Taylor series in time.

While the same rows press, the force (4) is an analytic function of the motion, and the
coefficients of one follow from those of the other, order by order (Jorba and Zou 2005, *A software
package for the numerical integration of ODEs by means of high-order Taylor methods*). The
polynomials also tell when a row parts, or another one touches.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from dynamics.arrays import Array
from dynamics.contact_term import Terms
from dynamics.kernels.flight import stay

# Highest power of the time: from 16 to 24 the work is about the same at every tolerance.
ORDER = 20

_FACTORIAL = np.array([float(math.factorial(k)) for k in range(ORDER + 1)])

# Newton's iteration for an exit doubles its digits; what takes longer is begun anew.
_TRIES = 30


class Series(NamedTuple):
    """Room for what is known about one time: derivatives, and coefficients of powers of the time.

    Args:
        state: (num_modes, ORDER + 1) derivatives of a.
        gap: (num_rows, ORDER + 1) coefficients of y = B a.
        powers: (num_rows, highest exponent, ORDER - 1) those of the depth p, p², … of pressed rows.
        force: (num_rows, ORDER - 1) those of F(y) of pressed rows.
        weights: (ORDER + 1,) powers of a time over their factorials.
    """

    state: Array
    gap: Array
    powers: Array
    force: Array
    weights: Array

    @classmethod
    def room(cls, num_modes: int, rows: int, terms: Terms) -> Series:
        """For contact rows whose laws have these terms, with whole exponents."""
        highest = int(max(terms["exponent"], default=1.0))
        return cls(
            np.zeros((num_modes, ORDER + 1)),
            np.zeros((rows, ORDER + 1)),
            np.zeros((rows, highest, ORDER - 1)),
            np.zeros((rows, ORDER - 1)),
            np.zeros(ORDER + 1),
        )


# The sums here are too short for vector instructions: to reorder them would cost time.
@njit(cache=True, nogil=True, fastmath={"contract"}, forceinline=True)
def expand(
    series: Series, a: Array, v: Array, system: tuple[Array, ...], terms: Terms, pressed: Array
) -> None:
    """Fill the series about the state (a, v), each (num_modes,).

    Args:
        series: to be filled.
        a, v: in √kg·m and √kg·m/s.
        system: ω² and load (num_modes,), rows (num_rows, num_modes).
        terms: one on each side of a row at most, all exponents whole.
        pressed: (num_rows,) 1 above, −1 below, 0 open.
    """
    omega2, load, rows = system
    state, gap, powers, force, _ = series
    for i in range(a.size):
        state[i, 0] = a[i]
        state[i, 1] = v[i]
        state[i, 2] = load[i] - omega2[i] * a[i]
    for j in range(pressed.size):
        gap[j, 0] = 0.0
        gap[j, 1] = 0.0
        for i in range(a.size):
            gap[j, 0] += rows[j, i] * a[i]
            gap[j, 1] += rows[j, i] * v[i]
    for k in range(ORDER - 1):
        if k > 0:
            for i in range(a.size):
                state[i, k + 2] = -omega2[i] * state[i, k]
        for t in range(terms.size):
            j, side = terms[t]["row"], terms[t]["side"]
            if pressed[j] == side:
                depth = side * gap[j, k]
                powers[j, 0, k] = depth - terms[t]["onset"] if k == 0 else depth
                power = powers[j, 0, k]
                for r in range(1, int(terms[t]["exponent"])):
                    power = 0.0
                    for i in range(k + 1):
                        power += powers[j, r - 1, i] * powers[j, 0, k - i]
                    powers[j, r, k] = power
                force[j, k] = side * terms[t]["stiffness"] * power
                derivative = _FACTORIAL[k] * force[j, k]
                for i in range(a.size):
                    state[i, k + 2] -= rows[j, i] * derivative
        for j in range(pressed.size):
            total = 0.0
            for i in range(a.size):
                total += rows[j, i] * state[i, k + 2]
            gap[j, k + 2] = total / _FACTORIAL[k + 2]


@njit(nogil=True, inline="always")
def reach(state: Array, omega2: Array, highest: int, tolerance: float) -> float:
    """Time in s over which the last terms of the velocity stay below a part of the motion.

    The motion counts as √Σ(v² + ω² a²). From the moment of touch, a series under the exponent n
    has every (n + 1)-th term alone: as many are looked at.
    """
    motion = 0.0
    for i in range(omega2.size):
        motion += state[i, 1] ** 2 + omega2[i] * state[i, 0] ** 2
    time = np.inf
    for k in range(max(2, ORDER - highest), ORDER + 1):
        term = 0.0
        for i in range(omega2.size):
            term += state[i, k] ** 2
        if term > 0.0:
            ratio = tolerance * _FACTORIAL[k - 1] * np.sqrt(motion / term)
            time = min(time, ratio ** (1.0 / (k - 1)))
    return time


@njit(nogil=True, inline="always")
def evaluate(series: Series, time: float, a: Array, v: Array) -> None:
    """The state (a, v), each (num_modes,), after ``time``."""
    weights = series.weights
    weights[0] = 1.0
    for k in range(1, ORDER + 1):
        weights[k] = weights[k - 1] * time / k
    for i in range(a.size):
        position = series.state[i, 0]
        velocity = 0.0
        for k in range(ORDER):
            position += series.state[i, k + 1] * weights[k + 1]
            velocity += series.state[i, k + 1] * weights[k]
        a[i] = position
        v[i] = velocity


@njit(cache=True, nogil=True)
def gap_after(gap: Array, time: float) -> tuple[float, float]:
    """One gap in m and its rate in m/s after ``time``, of its coefficients (ORDER + 1,)."""
    y = 0.0
    speed = 0.0
    for k in range(ORDER, -1, -1):
        speed = speed * time + y
        y = y * time + gap[k]
    return y, speed


@njit(nogil=True, inline="always")
def exit_time(
    gap: Array, low: float, high: float, shut: float, longest: float
) -> tuple[float, int]:
    """When within ``longest`` a gap leaves [low, high], and whether above (1) or below (−1).

    (longest, 0) if it does not. None is missed: no trial passes the earliest possible exit.
    """
    pull = 0.0
    for k in range(ORDER, 1, -1):
        pull = pull * longest + k * (k - 1) * abs(gap[k])
    time = 0.0
    y, speed = gap[0], gap[1]
    for _ in range(_TRIES):
        free, side = stay(y, speed, pull, low, high, shut)
        if side != 0:
            return time, side
        if not time + free < longest:
            return longest, 0
        time += free
        y, speed = gap_after(gap, time)
    return time, 0


@njit(nogil=True, inline="always")
def impulse(force: Array, begin: float, end: float) -> float:
    """∫ F dt in N·s between two times, of the force's coefficients (ORDER - 1,)."""
    until_begin = 0.0
    until_end = 0.0
    for k in range(ORDER - 2, -1, -1):
        until_begin = until_begin * begin + force[k] / (k + 1)
        until_end = until_end * end + force[k] / (k + 1)
    return until_end * end - until_begin * begin


@njit(nogil=True, inline="always")
def farthest(gap: Array, side: float, begin: float, end: float) -> float:
    """Largest side · y in m between two times of a row that presses on that side."""
    first, opening = gap_after(gap, begin)
    last, closing = gap_after(gap, end)
    found: float = max(side * first, side * last)
    if side * opening > 0.0 and side * closing < 0.0:
        # It turns between: twice by the chord of the speed, then by a parabola.
        y, speed, bend = first, opening, 0.0
        for _ in range(2):
            bend = (closing - opening) / (end - begin)
            turn = begin - opening / bend
            y, speed = gap_after(gap, turn)
            if side * speed > 0.0:
                begin, opening = turn, speed
            else:
                end, closing = turn, speed
        found = max(found, side * (y - 0.5 * speed * speed / bend))
    return found
