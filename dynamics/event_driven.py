# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of a gap system from contact to contact, for few modes.

While no row touches, every gap is a sum of cosines and parabolas: the motion jumps, each time as
far as the gaps cannot shut even if all modes pulled together, so that no contact is missed however
short (:mod:`dynamics.flight`). A linear law (n = 1) leaves the motion a sum of cosines, of other
modes, also while it presses: such systems are exact from event to event. Other laws are
integrated through contact by a fourth-order splitting of modal flow and contact impulses.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numba import njit
from scipy.linalg import eigh

from dynamics.energy import check_energy
from dynamics.failure import NumericsError
from dynamics.flight import flow, safe_time
from dynamics.gap_system import GapSystem
from dynamics.step import contact_frequencies, initial_speeds
from dynamics.trajectory import Trajectory

Array = npt.NDArray[np.float64]

# Step times contact frequency for the fourth-order splitting: an energy residual of about 2e-5
# on the paper's five-term case.
PHASE = 0.2

# A gap is shut within this part of its clearance, or of 1 mm without one.
_SHUT = 1.0e-13

# The shortest jump, as a part of the output step: far below any contact, above round-off.
_SHORTEST = 1.0e-12

# Steps between two outputs beyond which something rattles without end.
_ENDLESS = 10_000_000

# Impulses between flows of the symmetric Runge-Kutta-Nyström splitting with 6 stages and order 4
# (Blanes and Moan 2002, Practical symplectic partitioned Runge-Kutta and Runge-Kutta-Nyström
# methods, table 3).
_B = (0.0829844064174052, 0.396309801498368, -0.0390563049223486)
_A = (0.245298957184271, 0.604872665711080)
_IMPULSES = np.array([*_B, 1.0 - 2.0 * sum(_B), *reversed(_B)])
_FLOWS = np.array([*_A, 0.5 - sum(_A)])


@njit(cache=True, nogil=True)
def _tabulate(omega: Array, load: Array, times: Array, table: Array) -> None:
    """Flows over some times as (num_times, 5, num_modes): z' = t0 z + t1 v + t2,
    v' = t3 z + t0 v + t4.
    """
    for k in range(times.size):
        for i in range(omega.size):
            w, time = omega[i], times[k]
            if w > 0.0:
                c, s, half = np.cos(w * time), np.sin(w * time), np.sin(0.5 * w * time)
                table[k, 0, i] = c
                table[k, 1, i] = s / w
                table[k, 2, i] = 2.0 * half * half * load[i] / (w * w)
                table[k, 3, i] = -w * s
                table[k, 4, i] = s / w * load[i]
            else:
                table[k, 0, i] = 1.0
                table[k, 1, i] = time
                table[k, 2, i] = 0.5 * time * time * load[i]
                table[k, 3, i] = 0.0
                table[k, 4, i] = time * load[i]


@njit(cache=True, nogil=True, fastmath={"reassoc", "contract", "arcp", "nsz"})
def _press(
    z: Array,
    v: Array,
    rows: Array,
    law: Array,
    table: Array,
    step: float,
    impulses: Array,
    peaks: Array,
) -> bool:
    """One step of the fourth-order splitting; tells whether any row still touches."""
    touching = False
    for stage in range(7):
        touching = False
        for j in range(rows.shape[0]):
            y = 0.0
            for i in range(z.size):
                y += rows[j, i] * z[i]
            depth = abs(y) - law[2, j]
            if depth > 0.0:
                n = law[3, j]
                k = law[0, j] if y > 0.0 else -law[1, j]
                force = k * (depth * depth if n == 2.0 else depth**n)
                impulse = _IMPULSES[stage] * step * force
                impulses[j] += impulse
                touching = touching or force != 0.0
                if abs(force) > abs(peaks[j]):
                    peaks[j] = force
                for i in range(z.size):
                    v[i] -= rows[j, i] * impulse
        if stage < 6:
            t = table[min(stage, 5 - stage)]
            for i in range(z.size):
                zi, vi = z[i], v[i]
                z[i] = t[0, i] * zi + t[1, i] * vi + t[2, i]
                v[i] = t[3, i] * zi + t[0, i] * vi + t[4, i]
    return touching


@njit(cache=True, nogil=True)
def _march(
    a: Array,
    v: Array,
    system: tuple[Array, ...],
    law: Array,
    bounds: tuple[Array, ...],
    output_step: float,
    step: float,
    out: tuple[Array, ...],
    tally: Array,
) -> bool:
    """Advance through all output intervals under laws that are not linear.

    ``system`` = (omega, load, rows), ``bounds`` = (low, high, shut) of the open rows, ``out`` =
    (states, velocities, impulses, peaks), one row an interval. ``tally`` = first contact, steps,
    contact changes. False if an interval does not end.
    """
    omega, load, rows = system
    low, high, shut = bounds
    states, velocities, impulses, peaks = out
    whole = np.zeros((3, 5, a.size))
    part = np.zeros((3, 5, a.size))
    _tabulate(omega, load, _FLOWS * step, whole)
    touching = False
    for interval in range(states.shape[0]):
        left = output_step
        counted = tally[1]
        while left > _SHORTEST * output_step:
            if touching:
                h = min(step, left)
                table = whole
                if h < step:
                    _tabulate(omega, load, _FLOWS * h, part)
                    table = part
                touching = _press(a, v, rows, law, table, h, impulses[interval], peaks[interval])
                tally[2] += 0.0 if touching else 1.0
            else:
                h, leaving = safe_time(a, v, omega, load, rows, low, high, shut, left)
                if leaving != 0:
                    touching = True
                    tally[2] += 1.0
                    if np.isnan(tally[0]):
                        tally[0] = interval * output_step + output_step - left
                    continue
                h = min(left, max(h, _SHORTEST * output_step))
                flow(a, v, omega, load, h)
            left -= h
            tally[1] += 1.0
            if tally[1] - counted > _ENDLESS:
                return False
        states[interval] = a
        velocities[interval] = v
    return True


@njit(cache=True, nogil=True)
def _see(z: Array, regime: tuple[Array, ...], law: Array, peaks: Array) -> None:
    """Keep the largest force of each pressed row."""
    _, _, rows, _, pressed = regime
    for j in range(rows.shape[0]):
        if pressed[j] != 0.0:
            k = law[0, j] if pressed[j] > 0.0 else law[1, j]
            force = k * (np.dot(rows[j], z) - pressed[j] * law[2, j])
            if abs(force) > abs(peaks[j]):
                peaks[j] = force


@njit(cache=True, nogil=True)
def _march_regime(
    z: Array,
    v: Array,
    regime: tuple[Array, ...],
    law: Array,
    bounds: tuple[Array, ...],
    output_step: float,
    longest: float,
    out: tuple[Array, ...],
    place: Array,
    tally: Array,
) -> int:
    """Advance exactly until a row touches or parts; gives it as :func:`safe_time` does.

    0 at the end, and more than all rows if an interval does not end.

    ``regime`` = (omega, load, rows, basis, pressed), in the modes z of the rows that press:
    a = basis z, pressed (num_rows,) 1 above, -1 below, 0 open. ``place`` = interval and the time
    left in it, carried over from call to call.
    """
    omega, load, rows, basis, pressed = regime
    low, high, shut = bounds
    states, velocities, impulses, peaks = out
    counted = tally[1]
    integral = np.zeros(z.size)
    while place[0] < states.shape[0]:
        interval = int(place[0])
        while place[1] > _SHORTEST * output_step:
            h, leaving = safe_time(z, v, omega, load, rows, low, high, shut, min(longest, place[1]))
            if leaving != 0:
                return int(leaving)
            h = min(place[1], max(h, _SHORTEST * output_step))
            for i in range(z.size):
                w = omega[i]
                if w > 0.0:
                    rest = load[i] / (w * w)
                    half = np.sin(0.5 * w * h)
                    turned = 2.0 * half * half / (w * w)
                    integral[i] = rest * h + (z[i] - rest) * np.sin(w * h) / w + v[i] * turned
                else:
                    integral[i] = h * (z[i] + h * (0.5 * v[i] + h * load[i] / 6.0))
            _see(z, regime, law, peaks[interval])
            flow(z, v, omega, load, h)
            _see(z, regime, law, peaks[interval])
            for j in range(rows.shape[0]):
                if pressed[j] != 0.0:
                    k = law[0, j] if pressed[j] > 0.0 else law[1, j]
                    mean = np.dot(rows[j], integral) / h - pressed[j] * law[2, j]
                    impulses[interval, j] += k * mean * h
            place[1] -= h
            tally[1] += 1.0
            if tally[1] - counted > _ENDLESS:
                return rows.shape[0] + 1
        states[interval] = basis @ z
        velocities[interval] = basis @ v
        place[0] += 1.0
        place[1] = output_step
        counted = tally[1]
    return 0


@dataclass(frozen=True, slots=True)
class Regime:
    """A system with linear contact while the same rows press: cosines in modes of its own.

    Args:
        omega, load: (num_modes,) of these modes, the rest position of the springs included.
        rows: (num_rows, num_modes) contact rows in these modes.
        basis: (num_modes, num_modes), a = basis z.
        pressed: (num_rows,) 1 above, -1 below, 0 open.
        low, high: (num_rows,) the gaps between which each row stays as it is, in m.
    """

    omega: Array
    load: Array
    rows: Array
    basis: Array
    pressed: Array
    low: Array
    high: Array

    @classmethod
    def of(cls, system: GapSystem, law: Array, pressed: tuple[int, ...]) -> Regime:
        """Natural modes with the springs of the pressed rows in place."""
        side = np.array(pressed, dtype=np.float64)
        k = np.where(side > 0.0, law[0], law[1]) * (side != 0.0)
        clearance = law[2]
        omega2, basis = system.omega2, np.eye(system.num_modes)
        if k.any():
            omega2, basis = eigh(np.diag(omega2) + (system.rows.T * k) @ system.rows)
            # Rigid motions that the springs leave free come out as round-off.
            rigid = system.rows[:, system.omega2 == 0.0] * np.sqrt(k)[:, None]
            if rigid.size:
                omega2[: rigid.shape[1] - np.linalg.matrix_rank(rigid)] = 0.0
            omega2 = np.maximum(omega2, 0.0)
        above = np.where(law[0] > 0.0, clearance, np.inf)
        below = np.where(law[1] > 0.0, -clearance, -np.inf)
        return cls(
            omega=np.sqrt(omega2),
            load=(system.load + (k * side * clearance) @ system.rows) @ basis,
            rows=np.ascontiguousarray(system.rows @ basis),
            basis=np.ascontiguousarray(basis),
            pressed=side,
            low=np.where(side > 0.0, clearance, np.where(side < 0.0, -np.inf, below)),
            high=np.where(side < 0.0, -clearance, np.where(side > 0.0, np.inf, above)),
        )


def integrate_events(
    system: GapSystem,
    duration: float,
    output_step: float = 1.0e-3,
    phase: float = PHASE,
    position: Array | None = None,
    velocity: Array | None = None,
) -> Trajectory:
    """Move an undamped gap system from contact to contact.

    Args:
        system: what moves; the cost of a jump grows with its modes, and jumps shorten with its
            highest frequencies.
        duration: in s; a whole number of output steps is made, at least one.
        output_step: in s.
        phase: step times contact frequency while a law that is not linear presses.
        position: (num_modes,) initial a in √kg·m, zero unless given, with every gap open.
        velocity: (num_modes,) initial ȧ in √kg·m/s, zero unless given.

    Raises:
        ValueError: the system is damped, or the initial position presses a contact.
        NumericsError: the energy residual passes its bound, or contacts follow without end.
    """
    if system.damping.any():
        raise ValueError("a damped system has no closed form from contact to contact")
    n, m = system.num_modes, len(system.laws)
    a = np.zeros(n) if position is None else np.array(position, dtype=np.float64)
    v = np.zeros(n) if velocity is None else np.array(velocity, dtype=np.float64)
    gaps = system.rows @ a
    if any(float(law.energy(y)) > 0.0 for law, y in zip(system.laws, gaps, strict=True)):
        raise ValueError("the initial position presses a contact; start with every gap open")
    outputs = max(1, round(duration / output_step))
    law = np.array(
        [[law.stiffness, law.below, law.clearance, law.exponent] for law in system.laws]
    ).reshape(m, 4).T.copy()  # fmt: skip
    states, velocities = np.zeros((outputs + 1, n)), np.zeros((outputs + 1, n))
    impulses, peaks = np.zeros((outputs + 1, m)), np.zeros((outputs + 1, m))
    states[0], velocities[0] = a, v
    out = (states[1:], velocities[1:], impulses[1:], peaks[1:])
    tally = np.array([np.nan, 0.0, 0.0])
    linear = bool((law[3] == 1.0).all())
    fastest = contact_frequencies(system, initial_speeds(system, a, v)) if m else np.zeros(1)
    step = min(output_step, phase / max(float(fastest.max()), phase / output_step))
    if linear:
        ended = _through_regimes(system, law, a, v, output_step, step, out, tally)
    else:
        regime = Regime.of(system, law, (0,) * m)
        bounds = (regime.low, regime.high, _shut(law))
        arrays = (regime.omega, regime.load, regime.rows)
        ended = _march(a, v, arrays, law, bounds, output_step, step, out, tally)
    if not ended:
        raise NumericsError(
            f"more than {_ENDLESS} contacts follow within {output_step:g} s; make the contact "
            "softer"
        )
    row_gaps = states @ system.rows.T
    energies = np.zeros((outputs + 1, 5))
    energies[:, 0] = 0.5 * (velocities**2).sum(axis=1)
    energies[:, 1] = 0.5 * states**2 @ system.omega2
    energies[:, 2] = sum(w.energy(y) for w, y in zip(system.laws, row_gaps.T, strict=True))
    energies[:, 3] = (states - states[0]) @ system.load
    check_energy(energies, step)
    return Trajectory.record(
        system,
        time=output_step * np.arange(outputs + 1),
        states=states,
        energies=energies,
        row_gaps=row_gaps,
        row_forces=impulses / output_step,
        row_peaks=peaks,
        step=step,
        steps=int(tally[1]),
        first_contact=float(tally[0]),
        contact_changes=int(tally[2]),
    )


def _shut(law: Array) -> Array:
    return _SHUT * np.where(law[2] > 0.0, law[2], 1.0e-3)


def _through_regimes(
    system: GapSystem,
    law: Array,
    a: Array,
    v: Array,
    output_step: float,
    step: float,
    out: tuple[Array, Array, Array, Array],
    tally: Array,
) -> bool:
    """March from regime to regime of a linear law; False if contacts follow without end."""
    regimes: dict[tuple[int, ...], Regime] = {}
    pressed = (0,) * law.shape[1]
    place = np.array([0.0, output_step])
    shut = _shut(law)
    while True:
        if pressed not in regimes:
            regimes[pressed] = Regime.of(system, law, pressed)
        now = regimes[pressed]
        z, w = a @ now.basis, v @ now.basis
        arrays = (now.omega, now.load, now.rows, now.basis, now.pressed)
        bounds = (now.low, now.high, shut)
        # While a row presses, jumps stay short enough to see the peak of its force.
        longest = step if any(pressed) else output_step
        leaving = _march_regime(z, w, arrays, law, bounds, output_step, longest, out, place, tally)
        if leaving == 0 or leaving > len(pressed):
            return bool(leaving == 0)
        if np.isnan(tally[0]):
            tally[0] = (place[0] + 1.0) * output_step - place[1]
        tally[2] += 1.0
        a, v = now.basis @ z, now.basis @ w
        row = abs(leaving) - 1
        side = int(np.sign(leaving)) if pressed[row] == 0 else 0
        pressed = (*pressed[:row], side, *pressed[row + 1 :])
