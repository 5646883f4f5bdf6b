# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of a gap system by splitting: exact modal flow between contact impulses.

One step is half a contact impulse, the exact flow of every mode under its load, and half an
impulse at the new place (Strang 1968; for stiff springs known as the impulse method, Grubmüller
et al. 1991). It is second order, symplectic without damping and time-reversible, so the energy
error stays bounded over any number of contacts, which Newmark's method does not give.

While the gaps are so wide that none can shut for some steps, these are made at once: the flow is
exact over any time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit
from scipy.linalg import expm

from dynamics.energy import ENERGY_BOUND, check_energy
from dynamics.gap_system import GapSystem
from dynamics.step import contact_step, initial_speeds
from dynamics.trajectory import Trajectory

Array = npt.NDArray[np.float64]

# How many steps may be made at once while nothing touches.
STRIDES = np.array([1, 8, 64, 512])


@dataclass(frozen=True, slots=True)
class ModalFlow:
    """The exact map (a, v) → (a, v) of uncoupled damped modes over one step.

    Each array is (num_modes,): a' = aa a + av v + ap, v' = va a + vv v + vp.
    """

    aa: Array
    av: Array
    ap: Array
    va: Array
    vv: Array
    vp: Array

    @classmethod
    def over(cls, system: GapSystem, step: float) -> ModalFlow:
        """The flow of ``system`` without contact over ``step`` seconds."""
        omega = np.sqrt(system.omega2)
        cosine = np.cos(omega * step)
        # h·sinc and h²·sinc²/2 reach through ω = 0, where the mode is rigid.
        sine = step * np.sinc(omega * step / np.pi)
        rise = 0.5 * step**2 * np.sinc(0.5 * omega * step / np.pi) ** 2
        rows = np.array([cosine, sine, rise, -system.omega2 * sine, cosine, sine])
        for i in np.flatnonzero(system.damping):
            rows[:, i] = _damped_flow(float(omega[i]), float(system.damping[i]), step)
        rows[[2, 5]] *= system.load
        return cls(*rows)

    def stacked(self) -> Array:
        """(6, num_modes), the layout of the compiled loop."""
        return np.array([self.aa, self.av, self.ap, self.va, self.vv, self.vp])


def _damped_flow(omega: float, damping: float, step: float) -> Array:
    """(6,) aa, av, ap, va, vv, vp of one damped mode under a unit load.

    By the matrix exponential: its closed forms cancel where damping or step is small. Lengths are
    scaled so that both unknowns are velocities.
    """
    scale = max(omega, 1.0 / step)
    generator = np.array([[0.0, scale, 0.0], [-(omega**2) / scale, -damping, 1.0], [0.0] * 3])
    (aa, av, ap), (va, vv, vp), _ = expm(step * generator)
    return np.array([aa, av / scale, ap / scale, va * scale, vv, vp])


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _forces(a: Array, rows: Array, law: Array, y: Array, force: Array) -> bool:
    """Relative displacements and contact forces of every row; whether any row touches."""
    touching = False
    for j in range(rows.shape[0]):
        total = 0.0
        for i in range(a.size):
            total += rows[j, i] * a[i]
        y[j] = total
        depth = abs(total) - law[2, j]
        if depth > 0.0:
            n = law[3, j]
            power = depth if n == 1.0 else depth * depth if n == 2.0 else depth**n
            force[j] = law[0, j] * power if total > 0.0 else -law[1, j] * power
            touching = touching or force[j] != 0.0
        else:
            force[j] = 0.0
    return touching


@njit(cache=True, nogil=True)
def _pressed(y: float, law: Array, j: int) -> float:
    """1 where row j presses above, -1 below, 0 where it is open."""
    if y > law[2, j] and law[0, j] > 0.0:
        return 1.0
    if y < -law[2, j] and law[1, j] > 0.0:
        return -1.0
    return 0.0


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _kick(v: Array, rows: Array, force: Array, duration: float) -> None:
    for j in range(rows.shape[0]):
        if force[j] != 0.0:
            impulse = duration * force[j]
            for i in range(v.size):
                v[i] -= rows[j, i] * impulse


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _modal_energy(a: Array, v: Array, omega2: Array) -> tuple[float, float]:
    kinetic = 0.0
    strain = 0.0
    for i in range(a.size):
        kinetic += v[i] * v[i]
        strain += omega2[i] * a[i] * a[i]
    return 0.5 * kinetic, 0.5 * strain


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _flow(a: Array, v: Array, flow: Array) -> None:
    for i in range(a.size):
        ai = a[i]
        vi = v[i]
        a[i] = flow[0, i] * ai + flow[1, i] * vi + flow[2, i]
        v[i] = flow[3, i] * ai + flow[4, i] * vi + flow[5, i]


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _closing_bounds(
    a: Array, v: Array, system: tuple[Array, ...], duration: float, bounds: Array
) -> None:
    """What no row's |ẏ| can exceed within ``duration`` while nothing touches.

    A mode's amplitude √(v² + ω² s²) about its rest position does not grow; rigid modes fall.
    """
    omega2, load, _, rows = system
    for j in range(rows.shape[0]):
        swing = 0.0
        speed = 0.0
        fall = 0.0
        for i in range(a.size):
            if omega2[i] > 0.0:
                off = a[i] - load[i] / omega2[i]
                swing += abs(rows[j, i]) * np.sqrt(v[i] * v[i] + omega2[i] * off * off)
            else:
                speed += abs(rows[j, i] * v[i])
                fall += abs(rows[j, i] * load[i])
        bounds[j] = swing + speed + fall * duration


@njit(cache=True, nogil=True)
def _stride(y: Array, law: Array, bounds: Array, step: float, left: int) -> int:
    """Position in ``STRIDES`` of the most steps, up to ``left``, that no gap can shut within."""
    free = float(left)
    for j in range(y.size):
        reach = bounds[j] * step
        if reach > 0.0 and law[0, j] > 0.0:
            free = min(free, (law[2, j] - y[j]) / reach)
        if reach > 0.0 and law[1, j] > 0.0:
            free = min(free, (law[2, j] + y[j]) / reach)
    stride = 0
    while stride + 1 < STRIDES.size and STRIDES[stride + 1] <= free:
        stride += 1
    return stride


@njit(cache=True, nogil=True)
def _march(
    a: Array,
    v: Array,
    flows: Array,
    system: tuple[Array, ...],
    law: Array,
    step: float,
    substeps: int,
    out: tuple[Array, ...],
    tally: Array,
) -> None:
    """Advance by ``len(out[0])`` output intervals and record each.

    ``system`` = (omega2, load, damping, rows); ``law`` (4, rows) = k above, k below, Δ, n.
    ``out`` = (states, energies, gaps, mean forces, peak forces), one row an interval;
    energies are kinetic, strain, contact, work, damping. ``tally`` carries over from call to
    call: time, first contact, contact changes, work, dissipation, steps. ``flows`` has one
    (6, num_modes) for each of ``STRIDES``.
    """
    omega2, load, damping, rows = system
    states, energies, gaps, means, peaks = out
    num_rows = rows.shape[0]
    y = np.zeros(num_rows)
    before = np.zeros(num_rows)
    force = np.zeros(num_rows)
    damped = damping.any()
    bounds = np.zeros(num_rows)
    touching = _forces(a, rows, law, y, force)
    for interval in range(states.shape[0]):
        start = a.copy()
        done = 0
        flying = False
        while done < substeps:
            stride = 0
            if not touching:
                if not flying:
                    _closing_bounds(a, v, system, substeps * step, bounds)
                stride = _stride(y, law, bounds, step, substeps - done)
            flying = not touching
            time = STRIDES[stride] * step
            flow = flows[stride]
            if touching:
                _kick(v, rows, force, 0.5 * step)
                for j in range(num_rows):
                    means[interval, j] += 0.5 * force[j] / substeps
            if damped:
                kinetic, strain = _modal_energy(a, v, omega2)
                held = kinetic + strain - np.dot(load, a)
                _flow(a, v, flow)
                kinetic, strain = _modal_energy(a, v, omega2)
                tally[4] += held - (kinetic + strain - np.dot(load, a))
            else:
                _flow(a, v, flow)
            before[:] = y
            touching = _forces(a, rows, law, y, force)
            done += STRIDES[stride]
            tally[0] += time
            tally[5] += 1.0
            closing = np.inf
            for j in range(num_rows):
                side = _pressed(y[j], law, j)
                if side != _pressed(before[j], law, j):
                    tally[2] += 1.0
                    if side != 0.0:
                        deep = side * y[j] - law[2, j]
                        since = time * deep / (side * (y[j] - before[j]))
                        closing = min(closing, tally[0] - since)
            if np.isnan(tally[1]) and closing < np.inf:
                tally[1] = closing
            if touching:
                _kick(v, rows, force, 0.5 * step)
                for j in range(num_rows):
                    means[interval, j] += 0.5 * force[j] / substeps
                    if abs(force[j]) > abs(peaks[interval, j]):
                        peaks[interval, j] = force[j]
        tally[3] += np.dot(load, a - start)
        kinetic, strain = _modal_energy(a, v, omega2)
        states[interval] = a
        gaps[interval] = y
        energies[interval, 0] = kinetic
        energies[interval, 1] = strain
        for j in range(num_rows):
            depth = abs(y[j]) - law[2, j]
            if depth > 0.0:
                side = law[0, j] if y[j] > 0.0 else law[1, j]
                energies[interval, 2] += side * depth ** (law[3, j] + 1.0) / (law[3, j] + 1.0)
        energies[interval, 3] = tally[3]
        energies[interval, 4] = tally[4]


def integrate(
    system: GapSystem,
    duration: float,
    output_step: float = 1.0e-3,
    step: float | None = None,
    position: Array | None = None,
    velocity: Array | None = None,
    energy_bound: float = ENERGY_BOUND,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Move a gap system from its initial state.

    Args:
        system: what moves.
        duration: in s; a whole number of output steps is made, at least one.
        output_step: in s.
        step: in s, made smaller to fit the output step; from :func:`contact_step` unless given.
        position: (num_modes,) initial a in √kg·m, zero unless given.
        velocity: (num_modes,) initial ȧ in √kg·m/s, zero unless given.
        energy_bound: largest energy residual that passes, see :class:`Trajectory`.
        progress: called with the part done, 0 to 1.

    Raises:
        NumericsError: the state is not finite, or the energy residual passes its bound.
    """
    outputs = max(1, round(duration / output_step))
    n, m = system.num_modes, len(system.laws)
    a = np.zeros(n) if position is None else np.array(position, dtype=np.float64)
    v = np.zeros(n) if velocity is None else np.array(velocity, dtype=np.float64)
    if step is None:
        step = contact_step(system, output_step, initial_speeds(system, a, v))
    substeps = max(1, int(np.ceil(output_step / step * (1.0 - 1e-12))))
    h = output_step / substeps
    law = np.array(
        [[law.stiffness, law.below, law.clearance, law.exponent] for law in system.laws]
    ).reshape(m, 4).T.copy()  # fmt: skip
    arrays = tuple(
        np.ascontiguousarray(array)
        for array in (system.omega2, system.load, system.damping, system.rows)
    )
    flows = np.array([ModalFlow.over(system, stride * h).stacked() for stride in STRIDES])

    states, gaps = np.zeros((outputs + 1, n)), np.zeros((outputs + 1, m))
    means, peaks = np.zeros((outputs + 1, m)), np.zeros((outputs + 1, m))
    energies = np.zeros((outputs + 1, 5))
    states[0], gaps[0] = a, system.rows @ a
    energies[0, :2] = 0.5 * v @ v, 0.5 * system.omega2 @ a**2
    energies[0, 2] = sum(float(w.energy(y)) for w, y in zip(system.laws, gaps[0], strict=True))
    pressed = energies[0, 2] > 0.0
    tally = np.array([0.0, 0.0 if pressed else np.nan, 0.0, 0.0, 0.0, 0.0])

    chunk = max(1, outputs // 100)
    for begin in range(1, outputs + 1, chunk):
        part = slice(begin, min(begin + chunk, outputs + 1))
        out = (states[part], energies[part], gaps[part], means[part], peaks[part])
        _march(a, v, flows, arrays, law, h, substeps, out, tally)
        check_energy(energies[: part.stop], h, energy_bound)
        if progress is not None:
            progress((part.stop - 1) / outputs)
    return Trajectory.record(
        system,
        time=output_step * np.arange(outputs + 1),
        states=states,
        energies=energies,
        row_gaps=gaps,
        row_forces=means,
        row_peaks=peaks,
        step=h,
        steps=int(tally[5]),
        first_contact=float(tally[1]),
        contact_changes=int(tally[2]),
    )
