# SPDX-License-Identifier: LGPL-3.0-or-later
"""Exact motion of uncoupled damped modes within one time step.

Each mode obeys ä + c ȧ + ω² a = Q + ΔQ (t/h − ½) within a step of length h, with the mean load Q
and its change ΔQ. r_v(t) is the response to a unit initial velocity, and r_f = ∫ r_v dt the
response to a unit force. With p = ∫ r_f dt/h and u = ∫∫ r_f dt dt/h², the step from a₀ to a₁ is

    a₁ = (1 − ω² r_f) a₀ + r_v ȧ₀ + r_f Q + (p − r_f/2) ΔQ
    ȧ₁ = −ω² r_v a₀ + (1 − c r_v − ω² r_f) ȧ₀ + r_v Q + (r_f/h − r_v/2) ΔQ
    ā  = (1 − ω² p) a₀ + (r_f/h) ȧ₀ + p Q + (u − p/2) ΔQ

with the mean ā over the step. The work of Q is Q (a₁ − a₀), the work of ΔQ is
ΔQ ((a₀ + a₁)/2 − ā). The damping loss c ∫ ȧ² dt is a quadratic form of ȧ₀, ä₀ and ΔQ/h.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.special import spherical_jn

from protractile.dynamics.arrays import Array
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.kernels.compiled import SUMS

# Number of terms with which the power series converge for (c + |ω|) h ≤ 1.
_TERMS = 24


class Flow(NamedTuple):
    """Coefficients of steps of several lengths, each half as long as the one before.

    Args:
        time: (num_lengths,) h in s.
        omega2, damping: (num_modes,) ω² in 1/s² and c in 1/s.
        impulse, gain, ramp, drift: (num_lengths, num_modes) r_v in s, and r_f, p, u in s².
        loss: (num_lengths, 6, num_modes) coefficients of the loss c ∫ ȧ² dt with
            ȧ = α ȧ₀ + β ä₀ + r_f ΔQ/h: c ∫ αα dt, and likewise αβ, ββ, αr_f, βr_f, r_f r_f; no
            columns without damping.
    """

    time: Array
    omega2: Array
    damping: Array
    impulse: Array
    gain: Array
    ramp: Array
    drift: Array
    loss: Array


def modal_flow(system: GapSystem, times: Array) -> Flow:
    """Return the coefficients of a system's modes for steps of the lengths ``times`` in s."""
    n = system.num_modes
    omega2, damping = (np.ascontiguousarray(part) for part in (system.omega2, system.damping))
    tiled = np.tile([omega2, damping], times.size)
    *coefficients, loss = _flow_over(tiled[0], tiled[1], np.repeat(times, n))
    impulse, gain, ramp, drift = (part.reshape(times.size, n) for part in coefficients)
    losses = np.zeros((times.size, 6, n if loss.size else 0))
    losses[:] = loss.reshape(6, times.size, -1).swapaxes(0, 1)
    return Flow(times, omega2, damping, impulse, gain, ramp, drift, losses)


def _flow_over(omega2: Array, c: Array, time: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return r_v, r_f, p, u (num_modes,) and loss coefficients (6, num_modes) for times in s."""
    phase = np.sqrt(np.maximum(omega2, 0.0)) * time
    half = _sinc(0.5 * phase)
    impulse, gain = time * _sinc(phase), 0.5 * time**2 * half**2
    ramp = time**2 * _lag(phase)
    drift = 0.125 * time**2 * (1.0 + half) * _lag(0.5 * phase)
    loss = np.zeros((6, c.size if c.any() else 0))
    general = np.flatnonzero((c > 0.0) | (omega2 < 0.0))
    if general.size:
        *coefficients, integrals = _damped_flow(omega2[general], c[general], time[general])
        for of_all, of_some in zip((impulse, gain, ramp, drift), coefficients, strict=True):
            of_all[general] = of_some
        if loss.size:
            loss[:, general] = c[general] * integrals
    return impulse, gain, ramp, drift, loss


def _lag(x: Array) -> Array:
    """Return (1 − sin(x)/x)/x². A spherical Bessel function avoids cancellation near x = 0."""
    return np.asarray(0.5 * _sinc(0.5 * x) ** 2 - (_sinc(x) + spherical_jn(2, x)) / 3.0)


def _sinc(x: Array) -> Array:
    """Return sin(x)/x. The round-off of numpy's sinc would make cos² + sin² drift from 1."""
    return np.divide(np.sin(x), x, out=np.ones(x.shape), where=x > 0.0)


def _damped_flow(omega2: Array, c: Array, time: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return r_v, r_f, p, u and loss integrals (6, num_modes) of damped or unstable modes.

    A power series solves r̈_v = −c ṙ_v − ω² r_v over a fraction of the step, which is then doubled
    repeatedly. Closed forms would suffer from cancellation for small damping or a small step.
    """
    doublings = np.maximum(0.0, np.ceil(np.log2(time * (c + np.sqrt(np.abs(omega2))) + 1e-300)))
    t = time / 2.0**doublings
    older, newer = np.zeros(t.size), t.copy()
    sine, gain, fall, drift = t.copy(), t**2 / 2.0, t**3 / 6.0, t**4 / 24.0
    # Taylor coefficients of α, β and r_f in this fraction, for the integrals of their products.
    series = np.zeros((3, _TERMS, t.size))
    series[1, 1], series[2, 2] = t, 0.5 * t**2
    for k in range(2, _TERMS):
        older, newer = newer, -t / k * (c * newer + omega2 * t / (k - 1) * older)
        sine += newer
        gain += newer * t / (k + 1)
        fall += newer * t**2 / ((k + 1) * (k + 2))
        drift += newer * t**3 / ((k + 1) * (k + 2) * (k + 3))
        series[1, k] = newer
        if k + 1 < _TERMS:
            series[2, k + 1] = newer * t / (k + 1)
    # α = ṙ_v + c r_v.
    powers = np.arange(1, _TERMS)
    series[0, :-1] = series[1, 1:] * powers[:, None] / t
    series[0] += c * series[1]
    number = np.arange(_TERMS)
    weights = 1.0 / (1.0 + number[:, None] + number)
    gram = t * np.einsum(
        "akm,bkm->abm", series, np.tensordot(series, weights, (1, 0)).swapaxes(1, 2)
    )
    numbers = np.array([omega2, c, t, sine, gain, fall, drift])
    for doubling in range(int(doublings.max(initial=0.0))):
        go = np.flatnonzero(doubling < doublings)
        omega2, c, t, sine, gain, fall, drift = numbers[:, go]
        vv, aa = 1.0 - c * sine - omega2 * gain, 1.0 - omega2 * gain
        # Matrix of (ȧ, ä, ΔQ/h) over a fraction of the step: ȧ = α ȧ₀ + β ä₀ + r_f ΔQ/h.
        zero, one = np.zeros(t.size), np.ones(t.size)
        onward = np.array(
            [[vv + c * sine, sine, gain], [-omega2 * sine, vv, sine], [zero, zero, one]]
        )
        gram[..., go] += np.einsum("kam,klm,lbm->abm", onward, gram[..., go], onward)
        numbers[2:, go] = (
            2.0 * t,
            sine * (aa + vv),
            gain + aa * gain + sine**2,
            fall + aa * fall + sine * gain + t * gain,
            2.0 * drift + (t - omega2 * fall) * fall + gain**2 + t * fall,
        )
    *_, sine, gain, fall, drift = numbers
    pairs = gram[(0, 0, 1, 0, 1, 2), (0, 1, 1, 2, 2, 2)]
    return sine, gain, fall / time, drift / time**2, pairs


@njit(**SUMS)
def free_flow(
    a: Array, v: Array, flow: Flow, length: int, force: Array, change: Array, end: Array
) -> None:
    """Set ``end`` to the coordinates a₁ after a step; see :func:`finish_flow`."""
    impulse, gain, ramp = flow.impulse[length], flow.gain[length], flow.ramp[length]
    for i in range(a.size):
        end[i] = a[i] + impulse[i] * v[i] + gain[i] * (force[i] - flow.omega2[i] * a[i])
    for i in range(change.size):
        end[i] += (ramp[i] - 0.5 * gain[i]) * change[i]


@njit(**SUMS)
def finish_flow(
    a: Array, v: Array, flow: Flow, length: int, force: Array, change: Array, end: Array,
    load: Array,
) -> tuple[float, float]:  # fmt: skip
    """Advance a and v = ȧ to the end of a step, and return work and damping loss in J.

    Args:
        a, v: coordinates and velocities (num_modes,) at the start of the step; they are changed.
        flow: coefficients of steps of several lengths.
        length: index of the length of this step.
        force: (num_modes,) mean load Q in N/√kg.
        change: (num_modes,) change ΔQ of the load in N/√kg; empty for constant loads.
        end: (num_modes,) coordinates a₁ at the end of the step, by :func:`free_flow`.
        load: (num_modes,) part of Q whose work is returned, with the work of ΔQ.
    """
    h, omega2, damping = flow.time[length], flow.omega2, flow.damping
    impulse, gain, ramp = flow.impulse[length], flow.gain[length], flow.ramp[length]
    drift, loss = flow.drift[length], flow.loss[length]
    work = 0.0
    lost = 0.0
    for i in range(a.size):
        work += load[i] * (end[i] - a[i])
    for i in range(change.size):
        mean = (1.0 - omega2[i] * ramp[i]) * a[i] + gain[i] / h * v[i] + ramp[i] * force[i]
        mean += (drift[i] - 0.5 * ramp[i]) * change[i]
        work += change[i] * (0.5 * (a[i] + end[i]) - mean)
    for i in range(loss.shape[1]):
        tilt = change[i] if change.size > 0 else 0.0
        rate = force[i] - 0.5 * tilt - damping[i] * v[i] - omega2[i] * a[i]
        tilt /= h
        lost += v[i] * (loss[0, i] * v[i] + 2.0 * (loss[1, i] * rate + loss[3, i] * tilt))
        lost += rate * (loss[2, i] * rate + 2.0 * loss[4, i] * tilt) + loss[5, i] * tilt * tilt
    for i in range(a.size):
        pull = force[i] - damping[i] * v[i] - omega2[i] * a[i]
        v[i] += impulse[i] * pull - omega2[i] * gain[i] * v[i]
        a[i] = end[i]
    for i in range(change.size):
        v[i] += (gain[i] / h - 0.5 * impulse[i]) * change[i]
    return work, lost


@njit(**SUMS)
def modal_energy(a: Array, v: Array, omega2: Array) -> tuple[float, float]:
    """Return kinetic and strain energy in J."""
    kinetic = 0.0
    strain = 0.0
    for i in range(a.size):
        kinetic += v[i] * v[i]
        strain += omega2[i] * a[i] * a[i]
    return 0.5 * kinetic, 0.5 * strain


@njit(**SUMS)
def compliance(ends: Array, rows: Array, gain: Array) -> Array:
    """Return the compliance H = S₁ diag(r_f) S̄ᵀ (num_rows, num_rows) in m/N in a step.

    ``ends`` are the rows S₁ at the end of the step, ``rows`` the mean rows S̄, and ``gain`` is r_f.
    The function avoids BLAS so that results are bitwise reproducible.
    """
    count = rows.shape[0]
    result = np.zeros((count, count))
    for j in range(count):
        for k in range(count):
            total = 0.0
            for i in range(gain.size):
                total += ends[j, i] * gain[i] * rows[k, i]
            result[j, k] = total
    return result
