# SPDX-License-Identifier: LGPL-3.0-or-later
"""The exact motion of uncoupled damped modes under loads that are straight lines in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from scipy.linalg import expm
from scipy.special import spherical_jn

from dynamics.arrays import Array
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import LOOP, SUMS
from dynamics.kernels.integrator_state import DAMPING, WORK


@dataclass(frozen=True, slots=True)
class ModalFlow:
    """The exact map (a, v) → (a, v) of uncoupled damped modes over one step.

    Each array is (num_modes,): a' = aa a + av v + ap, v' = va a + vv v + vp under the constant
    load. A further unit load moves a by ``rise`` and v by av; one that grows from 0 to 1 over the
    step moves a by ``ramp`` and v by rise / step, and a in the mean over the step by ``mean``.
    """

    aa: Array
    av: Array
    ap: Array
    va: Array
    vv: Array
    vp: Array
    rise: Array
    ramp: Array
    mean: Array

    @classmethod
    def over(cls, system: GapSystem, step: float) -> ModalFlow:
        """The flow of ``system`` without contact over ``step`` seconds."""
        omega = system.omega
        cosine = np.cos(omega * step)
        # h·sinc and h²·sinc²/2 reach through ω = 0, where the mode is rigid.
        sine = step * np.sinc(omega * step / np.pi)
        half = np.sinc(0.5 * omega * step / np.pi)
        rise = 0.5 * step**2 * half**2
        ramp = step**2 * _lag(omega * step)
        mean = 0.125 * step**2 * (1.0 + half) * _lag(0.5 * omega * step)
        rows = np.array([cosine, sine, -system.omega2 * sine, cosine, rise, ramp, mean])
        for i in np.flatnonzero((system.damping > 0.0) | (system.omega2 < 0.0)):
            rows[:, i] = _general_flow(float(system.omega2[i]), float(system.damping[i]), step)
        aa, av, va, vv, rise, ramp, mean = rows
        return cls(aa, av, rise * system.load, va, vv, av * system.load, rise, ramp, mean)


def stacked_flows(system: GapSystem, times: Array) -> Array:
    """(num_times, 11, num_modes) in the compiled loops' layout, with ω² and the constant load."""
    flows = [ModalFlow.over(system, time) for time in times.tolist()]
    own = [[getattr(flow, name) for name in ModalFlow.__slots__] for flow in flows]
    return np.array([[*rows, system.omega2, system.load] for rows in own])


def _lag(x: Array) -> Array:
    """(1 − sinc x)/x² with sinc x = sin x / x, through x = 0 by a spherical Bessel function."""
    sinc, half = np.sinc(x / np.pi), np.sinc(0.5 * x / np.pi)
    return np.asarray(0.5 * half**2 - (sinc + spherical_jn(2, x)) / 3.0)


def _general_flow(omega2: float, damping: float, step: float) -> Array:
    """(7,) aa, av, va, vv, rise, ramp, mean of one damped mode, or of one that tips over.

    By the matrix exponential: its closed forms cancel where damping or step is small. Lengths are
    scaled so that both unknowns are velocities.
    """
    scale = max(np.sqrt(np.abs(omega2)), 1.0 / step)
    generator = np.zeros((5, 5))
    generator[0, 1] = scale
    generator[1] = [-omega2 / scale, -damping, 1.0, 0.0, 0.0]
    generator[2, 3] = generator[3, 4] = 1.0 / step
    (aa, av, rise, ramp, mean), (va, vv, _, _, _), _, _, _ = expm(step * generator)
    return np.array([aa, av / scale, va * scale, vv, rise / scale, ramp / scale, mean / scale])


@njit(**LOOP)
def tabulate(flow: Array, omega2: Array, load: Array, damping: Array, time: float) -> None:
    """Fill ``flow`` (11, num_modes) for any time, as :func:`stacked_flows` does.

    By the power series of the response to a unit impulse, x'' = −c x' − ω² x, and of its
    integrals over a time as short as needed, and doublings of that time.
    """
    for i in range(omega2.size):
        c, square = damping[i], omega2[i]
        doublings = max(0.0, np.ceil(np.log2(time * (c + np.sqrt(abs(square))) + 1.0e-300)))
        t = time / 2.0**doublings
        older, newer = 0.0, t  # terms of x's derivatives at 0
        sine, rise, fall, drift = t, 0.5 * t * t, t * t * t / 6.0, t * t * t * t / 24.0
        for k in range(2, 40):
            older, newer = newer, -t / k * (c * newer + square * t / (k - 1) * older)
            sine += newer
            rise += newer * t / (k + 1)
            fall += newer * t * t / ((k + 1) * (k + 2))
            drift += newer * t * t * t / ((k + 1) * (k + 2) * (k + 3))
            if abs(newer) + abs(older) < 1.0e-18 * t:
                break
        for _ in range(int(doublings)):
            aa, vv = 1.0 - square * rise, 1.0 - c * sine - square * rise
            drift += drift + (t - square * fall) * fall + rise * rise + t * fall
            fall += aa * fall + sine * rise + t * rise
            rise += aa * rise + sine * sine
            sine *= aa + vv
            t *= 2.0
        flow[0, i] = 1.0 - square * rise
        flow[1, i] = sine
        flow[2, i] = rise * load[i]
        flow[3, i] = -square * sine
        flow[4, i] = 1.0 - c * sine - square * rise
        flow[5, i] = sine * load[i]
        flow[6, i] = rise
        flow[7, i] = fall / time
        flow[8, i] = drift / (time * time)
        flow[9, i], flow[10, i] = square, load[i]


@njit(**SUMS)
def modal_energy(a: Array, v: Array, omega2: Array) -> tuple[float, float]:
    """Kinetic and strain energy in J."""
    kinetic = 0.0
    strain = 0.0
    for i in range(a.size):
        kinetic += v[i] * v[i]
        strain += omega2[i] * a[i] * a[i]
    return 0.5 * kinetic, 0.5 * strain


@njit(**SUMS)
def _energy_under_load(a: Array, v: Array, flow: Array) -> float:
    """Kinetic and strain energy less load times way, which modes without damping keep."""
    total = 0.0
    for i in range(a.size):
        total += 0.5 * (v[i] * v[i] + flow[9, i] * a[i] * a[i]) - flow[10, i] * a[i]
    return total


@njit(**SUMS)
def move(a: Array, v: Array, flow: Array) -> None:
    for i in range(a.size):
        ai = a[i]
        vi = v[i]
        a[i] = flow[0, i] * ai + flow[1, i] * vi + flow[2, i]
        v[i] = flow[3, i] * ai + flow[4, i] * vi + flow[5, i]


@njit(**SUMS)
def drive(a: Array, flow: Array, now: Array, then: Array) -> None:
    """Add to ``a`` what a load does to it that goes straight from now to then, (num_modes,)."""
    for i in range(a.size):
        a[i] += flow[6, i] * now[i] + flow[7, i] * (then[i] - now[i])


@njit(**SUMS)
def _driven_move(a: Array, v: Array, flow: Array, time: float, now: Array, then: Array) -> float:
    """Move under a load that goes from now to then too; gives its work in J.

    ∫ p·ȧ dt = [p·a] − ṗ·∫ a dt, the integral exact as the flow is.
    """
    work = 0.0
    for i in range(a.size):
        ai, vi, more = a[i], v[i], then[i] - now[i]
        held = flow[10, i] + now[i]
        a[i] = flow[0, i] * ai + flow[1, i] * vi + flow[2, i] + flow[6, i] * now[i]
        a[i] += flow[7, i] * more
        v[i] = flow[3, i] * ai + flow[4, i] * vi + flow[5, i] + flow[1, i] * now[i]
        v[i] += flow[6, i] / time * more
        mean = (1.0 - flow[9, i] * flow[7, i]) * ai + flow[6, i] / time * vi
        mean += flow[7, i] * held + flow[8, i] * more
        work += then[i] * a[i] - now[i] * ai - more * mean
    return work


@njit(**SUMS)
def mean_place(
    a: Array, v: Array, flow: Array, time: float, now: Array, then: Array, mean: Array
) -> None:
    """Fill in where the modes are in the mean while they move under a load from now to then."""
    for i in range(a.size):
        mean[i] = (1.0 - flow[9, i] * flow[7, i]) * a[i] + flow[6, i] / time * v[i]
        mean[i] += flow[7, i] * (flow[10, i] + now[i]) + flow[8, i] * (then[i] - now[i])


@njit(**LOOP)
def travel(
    a: Array, v: Array, flow: Array, time: float, damped: bool, now: Array, then: Array,
    tally: Array,
) -> None:  # fmt: skip
    """:func:`move`, with excitations; enters their work and the damping loss in J.

    Args:
        now, then: (num_modes,) what they push with at the start and at the end, in N/√kg.
        tally: of the integration.
    """
    held = _energy_under_load(a, v, flow) if damped else 0.0
    work = _driven_move(a, v, flow, time, now, then)
    tally[WORK] += work
    if damped:
        tally[DAMPING] += held + work - _energy_under_load(a, v, flow)
