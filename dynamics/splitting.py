# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of a gap system by splitting: exact modal flow between contact impulses.

One step is half a contact impulse, the exact flow of every mode under its load, and half an
impulse at the new place (Strang 1968; for stiff springs known as the impulse method, Grubmüller
et al. 1991). It is second order, symplectic without damping and time-reversible, so the energy
error stays bounded over any number of contacts, which Newmark's method does not give.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit

from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem
from dynamics.step import contact_step
from dynamics.trajectory import Trajectory, energy_residual

Array = npt.NDArray[np.float64]

# The energy residual, as a part of the work done, beyond which a run is not a result.
ENERGY_BOUND = 1.0e-2


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
        half = 0.5 * system.damping
        damped = np.emath.sqrt(system.omega2 - half**2) * step
        decay = np.exp(-half * step)
        cosine = np.real(decay * np.cos(damped))
        # h·sinc reaches through damped = 0, where the mode is rigid or critically damped.
        sine = np.real(decay * step * np.sinc(damped / np.pi))
        aa = cosine + half * sine
        return cls(
            aa=aa,
            av=sine,
            ap=_load_response(system, step, aa, sine) * system.load,
            va=-system.omega2 * sine,
            vv=cosine - half * sine,
            vp=sine * system.load,
        )

    def stacked(self) -> Array:
        """(6, num_modes), the layout of the compiled loop."""
        return np.array([self.aa, self.av, self.ap, self.va, self.vv, self.vp])


def _load_response(system: GapSystem, step: float, aa: Array, sine: Array) -> Array:
    """Displacement after one step from rest under a unit load, without cancellation."""
    omega2, damping = system.omega2, system.damping
    undamped = 0.5 * step**2 * np.sinc(np.sqrt(omega2) * step / (2.0 * np.pi)) ** 2
    sliding = np.divide(step - sine, damping, out=undamped.copy(), where=damping > 0.0)
    return np.divide(1.0 - aa, omega2, out=sliding, where=(omega2 > 0.0) & (damping > 0.0))


@njit(cache=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _forces(a, rows, law, y, force):  # type: ignore[no-untyped-def]
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


@njit(cache=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _kick(v, rows, force, duration):  # type: ignore[no-untyped-def]
    for j in range(rows.shape[0]):
        if force[j] != 0.0:
            impulse = duration * force[j]
            for i in range(v.size):
                v[i] -= rows[j, i] * impulse


@njit(cache=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _modal_energy(a, v, omega2):  # type: ignore[no-untyped-def]
    kinetic = 0.0
    strain = 0.0
    for i in range(a.size):
        kinetic += v[i] * v[i]
        strain += omega2[i] * a[i] * a[i]
    return 0.5 * kinetic, 0.5 * strain


@njit(cache=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _flow(a, v, flow):  # type: ignore[no-untyped-def]
    for i in range(a.size):
        ai = a[i]
        vi = v[i]
        a[i] = flow[0, i] * ai + flow[1, i] * vi + flow[2, i]
        v[i] = flow[3, i] * ai + flow[4, i] * vi + flow[5, i]


@njit(cache=True)
def _march(a, v, flow, system, law, step, substeps, out, tally):  # type: ignore[no-untyped-def]
    """Advance by ``len(out[0])`` output intervals and record each.

    ``system`` = (omega2, load, damping, rows); ``law`` (4, rows) = k above, k below, Δ, n.
    ``out`` = (states, energies, gaps, mean forces, peak forces), one row an interval;
    energies are kinetic, strain, contact, work, damping. ``tally`` carries over from call to
    call: time, first contact, contact changes, work, dissipation.
    """
    omega2, load, damping, rows = system
    states, energies, gaps, means, peaks = out
    num_rows = rows.shape[0]
    y = np.zeros(num_rows)
    before = np.zeros(num_rows)
    force = np.zeros(num_rows)
    damped = damping.any()
    touching = _forces(a, rows, law, y, force)
    for interval in range(states.shape[0]):
        start = a.copy()
        for _sub in range(substeps):
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
            tally[0] += step
            for j in range(num_rows):
                deep = abs(y[j]) - law[2, j]
                shallow = abs(before[j]) - law[2, j]
                side = law[0, j] if y[j] + before[j] > 0.0 else law[1, j]
                if side > 0.0 and (deep > 0.0) != (shallow > 0.0):
                    tally[2] += 1.0
                    if np.isnan(tally[1]):
                        tally[1] = tally[0] - step * deep / (deep - shallow)
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
    wanted = contact_step(system, output_step) if step is None else step
    substeps = max(1, int(np.ceil(output_step / wanted * (1.0 - 1e-12))))
    h = output_step / substeps
    outputs = max(1, round(duration / output_step))
    n, m = system.num_modes, len(system.laws)
    a = np.zeros(n) if position is None else np.array(position, dtype=np.float64)
    v = np.zeros(n) if velocity is None else np.array(velocity, dtype=np.float64)
    law = np.array(
        [[law.stiffness, law.below, law.clearance, law.exponent] for law in system.laws]
    ).reshape(m, 4).T.copy()  # fmt: skip
    arrays = (system.omega2, system.load, system.damping, np.ascontiguousarray(system.rows))
    flow = ModalFlow.over(system, h).stacked()

    states, gaps = np.zeros((outputs + 1, n)), np.zeros((outputs + 1, m))
    means, peaks = np.zeros((outputs + 1, m)), np.zeros((outputs + 1, m))
    energies = np.zeros((outputs + 1, 5))
    states[0], gaps[0] = a, system.rows @ a
    energies[0, :2] = 0.5 * v @ v, 0.5 * system.omega2 @ a**2
    energies[0, 2] = sum(float(w.energy(y)) for w, y in zip(system.laws, gaps[0], strict=True))
    tally = np.array([0.0, np.nan, 0.0, 0.0, 0.0])

    chunk = max(1, outputs // 100)
    for begin in range(1, outputs + 1, chunk):
        part = slice(begin, min(begin + chunk, outputs + 1))
        out = (states[part], energies[part], gaps[part], means[part], peaks[part])
        _march(a, v, flow, arrays, law, h, substeps, out, tally)
        _check(energies[: part.stop], h, energy_bound)
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
        first_contact=float(tally[1]),
        contact_changes=int(tally[2]),
    )


def _check(energies: Array, step: float, bound: float) -> None:
    if not np.isfinite(energies).all():
        raise NumericsError(f"the motion is not finite at a step of {step:.3g} s; halve the step")
    worst = float(np.abs(energy_residual(energies)).max())
    if worst > bound:
        raise NumericsError(
            f"the energy residual is {worst:.3g} of the work done, above the bound of {bound:.3g}, "
            f"at a step of {step:.3g} s; halve the step"
        )
