# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of a gap system by splitting: exact modal flow between impulses of contact and friction.

One step is half a contact impulse, the exact flow of every mode under its load, and half an
impulse at the new place (Strang 1968; for stiff springs known as the impulse method, Grubmüller
et al. 1991). It is second order, symplectic without damping and time-reversible, so the energy
error stays bounded over any number of contacts, which Newmark's method does not give. Damping acts
outside the contact impulses, where speeds are smooth: between them a mode that rests under a force
swings by the impulses alone, and would be damped in vain (:mod:`dynamics.kernels.decay`). Dry
friction acts in the middle of the flow (:mod:`dynamics.kernels.friction_step`); a step in which a
sliding row turns is made in two, so that it turns between them.

While the gaps are so wide that none can shut for some steps, these are made at once: the flow is
exact over any time. Dashpots act at the ends of such strides and hand speed from mode to mode, so
that each stride asks anew what can shut.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.contact import contact_limits, contact_terms
from dynamics.contact_term import Limits, Terms
from dynamics.energy import ENERGIES, ENERGY_BOUND
from dynamics.integrators.closed_contacts import ClosedContacts, closable, pressing
from dynamics.integrators.drawn_out import integrate_drawn
from dynamics.integrators.record import Record
from dynamics.integrators.step import DRAGGED, contact_step
from dynamics.kernels.compiled import LOOP
from dynamics.kernels.contact_kicks import (
    add_closed_forces,
    contact_energy,
    contact_forces,
    elastic_kick,
    law_forces,
)
from dynamics.kernels.decay import Damping, damp, damping_arrays, drag, kept_after
from dynamics.kernels.integrator_state import (
    CHANGES,
    DAMPING,
    WORK,
    Dry,
    Excitations,
    State,
    System,
    enter,
    excitation_arrays,
    excite,
    friction_arrays,
    look,
    no_excitations,
    system_arrays,
)
from dynamics.kernels.lossy_steps import Lossy, Space, lossy_steps, space_for
from dynamics.kernels.modal_flow import (
    mean_place,
    modal_energy,
    move,
    stacked_flows,
    tabulate,
    travel,
)
from dynamics.kernels.pressed_steps import pressed_steps
from dynamics.kernels.strides import STRIDES, closing_bounds, dragged_speeds, safe_stride
from dynamics.motion import Motion
from dynamics.trajectory import Trajectory

# How many steps may be made at once while contacts stay closed, which dashpots and the recorded
# peaks want told more finely.
_CLOSED_STRIDES = np.array([1, 4, 16, 64, 256, 1024])

# Single steps of a system with dashpots before it is asked for a stride again.
_AGAIN = int(STRIDES[1])

# Part of a contact's force by which its peak may pass what the ends of strides tell.
_UNTOLD = 0.01


@njit(**LOOP)
def _telling(
    reach: Array,
    omega2: Array,
    rows: Array,
    stiffness: Array,
    pressed: Array,
    step: float,
    strides: Indices,
) -> int:
    """How many of the ``strides`` tell the peaks of closed contacts at their ends.

    Between samples T apart a swing of amplitude p passes what they tell by no more than
    p min(1, (ωT)²/8); all modes together by no more than ``_UNTOLD`` of the force.
    """
    for s in range(1, strides.size):
        time = strides[s] * step
        for j in range(rows.shape[0]):
            beyond = 0.0
            for i in range(reach.size):
                if stiffness[j] != 0.0 and omega2[i] > 0.0:
                    part = min(1.0, omega2[i] * time * time / 8.0)
                    beyond += part * abs(rows[j, i]) * reach[i] / np.sqrt(omega2[i])
            if stiffness[j] * beyond > _UNTOLD * abs(pressed[j]):
                return s
    return strides.size


@njit(**LOOP)
def _march(
    lossy: Lossy, strides: Indices, flows: Array, springs: tuple[Array, Array, Terms, Limits],
    step: float, substeps: int, steady: bool, out: tuple[Array, ...],
) -> int:  # fmt: skip
    """Advance by up to ``len(out[0])`` output intervals and record each.

    ``out`` = (states, velocities, energies, gaps, mean forces, peak forces, friction forces), one
    row an interval; velocities may have no columns. ``flows`` has one (11, num_modes) for each of
    the ``strides`` that may be made, with the rates of damping. ``springs`` are the
    stiffness and the preload (num_rows,) of closed contacts, which are in the modes, and the terms
    and limits of all laws.

    Gives how many intervals were made: all of them, or, where that is ``steady``, those up to the
    end of one in which something pressed and nothing opened or closed.
    """
    state, system, damping, dry, excitations, _ = lossy
    _, a, v, y, force, grip, tally, mean, peak, friction, _, before = state
    omega2, load, rows, terms, limits = system
    rates, directions, dashpot_rates = damping
    friction_rows, given, _, _ = dry
    loads, _, spans, parts, straight, pushes = excitations
    now, _, then = pushes
    stiffness, preload, laws, touch = springs
    states, velocities, energies, gaps, means, peaks, frictions = out
    bounds, telling = np.zeros(y.size), strides
    place, reach, speeds = np.zeros((3, a.size))
    piece, undamped = np.zeros((2, *flows[0].shape))
    faded, none = np.zeros(rates.size), np.zeros(a.size)
    tabulate(undamped, omega2, load, none, step)
    kept_after(rates, 0.25 * step, faded)
    dragged = np.zeros((len(flows), dashpot_rates.size))
    for stride in range(len(flows)):
        kept_after(dashpot_rates, 0.5 * strides[stride] * step, dragged[stride])
    damped, dragging = rates.size > 0, dashpot_rates.size > 0
    excited = loads.shape[0] > 0
    # A prescribed normal force rubs always.
    single = (given[0] * given[1]).any() or strides.size == 1 or straight.max() < strides[1]
    losing = friction.size > 0 or limits["damping"].any()
    touching, closed = force.any(), stiffness.any()
    plain = not (losing or damped or dragging or excited or closed)
    pressed = force
    if closed:
        pressed = np.zeros(y.size)
        law_forces(y, laws, pressed)
    for interval in range(states.shape[0]):
        start, changes = a.copy(), tally[CHANGES]
        mean[:] = 0.0
        peak[:] = 0.0
        friction[:] = 0.0
        done = 0
        until = 0
        flying = False
        again = 0
        while done < substeps:
            if plain and touching:
                left = substeps - done
                done += pressed_steps(state, system, touch, flows[0], step, left, substeps)
                touching = force.any()
                continue
            k = interval * substeps + done
            stride = 0
            if not (touching or single or done < again):
                if not flying:
                    until = done + min(straight[k], substeps - done)
                    excite(excitations, parts[k], parts[k + until - done], 0.0, 1.0)
                    fastest = v
                    if dragging:
                        dragged_speeds(v, directions, dragged[-1], speeds)
                        fastest = speeds
                    closing_bounds(
                        a, fastest, omega2, load, now, then, rows, substeps * step, reach, bounds
                    )
                    telling = strides
                    if closed:
                        count = _telling(reach, omega2, rows, stiffness, pressed, step, strides)
                        telling = strides[:count]
                stride = safe_stride(y, limits, bounds, step, until - done, telling)
                if dragging and stride == 0:
                    again = done + _AGAIN
            flying = not (touching or losing or dragging) and done + strides[stride] < until
            if losing and stride == 0:
                done += lossy_steps(lossy, step, k, k - done + substeps, substeps, single) - k
                touching = force.any()
                continue
            before[:] = y
            time = strides[stride] * step
            first, last = parts[k], parts[k + strides[stride]]
            # The damped flow is exact where nothing presses.
            apart = damped and touching
            within = damped and not touching
            flow = undamped if apart else flows[stride]
            if apart:
                tally[DAMPING] += damp(v, faded, directions, dragged[0])
            elif dragging:
                tally[DAMPING] += drag(v, directions, dragged[stride])
            striding = closed and stride > 0
            if touching:
                elastic_kick(v, rows, force, 0.5 * step)
            if touching or (closed and not striding):
                for j in range(y.size):
                    mean[j] += 0.5 * pressed[j] / substeps
            if stride == 0 and last > first + 1:
                for p in range(first, last):
                    tabulate(piece, omega2, load, rates if within else none, spans[p])
                    excite(excitations, p, p + 1, 0.0, 1.0)
                    travel(a, v, piece, spans[p], within, now, then, tally)
            else:
                if excited:
                    excite(excitations, first, last, 0.0, 1.0)
                if striding:
                    share = strides[stride] / substeps
                    mean_place(a, v, flow, time, now, then, place)
                    add_closed_forces(place, rows, stiffness, preload, share, mean)
                if excited or within:
                    travel(a, v, flow, time, within, now, then, tally)
                else:
                    move(a, v, flow)
            touching = contact_forces(a, rows, terms, y, force)
            done += strides[stride]
            enter(y, before, touch, time, tally)
            if touching:
                elastic_kick(v, rows, force, 0.5 * step)
            if closed:
                law_forces(y, laws, pressed)
            if touching or closed:
                for j in range(y.size):
                    if not striding:
                        mean[j] += 0.5 * pressed[j] / substeps
                    if abs(pressed[j]) > abs(peak[j]):
                        peak[j] = pressed[j]
            if apart:
                tally[DAMPING] += damp(v, faded, directions, dragged[0])
            elif dragging:
                tally[DAMPING] += drag(v, directions, dragged[stride])
            if friction.size > 0:
                look(a, v, friction_rows, grip)
        tally[WORK] += np.dot(load, a - start)
        states[interval] = a
        velocities[interval] = v[: velocities.shape[1]]
        gaps[interval] = y
        means[interval] = mean
        peaks[interval] = peak
        frictions[interval] = friction
        energies[interval, 0], energies[interval, 1] = modal_energy(a, v, omega2)
        energies[interval, 2] = contact_energy(y, terms)
        energies[interval, 3:] = tally[WORK:]
        if steady and touching and tally[CHANGES] == changes:
            return interval + 1
    return len(states)


@dataclass(frozen=True, slots=True)
class _Steps:
    """Steps of a system while some of its contacts are closed, as the compiled loop takes them."""

    contacts: ClosedContacts
    strides: Indices
    flows: Array
    system: System
    damping: Damping
    dry: Dry
    space: Space
    step: float

    @classmethod
    def of(cls, contacts: ClosedContacts, step: float) -> _Steps:
        system = contacts.system
        damping = damping_arrays(system)
        longest = DRAGGED / (step * damping[2].max(initial=0.0) + 1.0e-300)
        strides = _CLOSED_STRIDES if contacts.any else STRIDES
        strides = strides[max(1.0, longest) >= strides]
        flows = stacked_flows(system, strides * step)
        arrays = (*system_arrays(system)[:3], contacts.terms, contacts.limits)
        space = space_for(system, damping)
        return cls(contacts, strides, flows, arrays, damping, friction_arrays(system), space, step)

    def march(
        self, state: State, first: int, substeps: int, steady: bool, out: tuple[Array, ...]
    ) -> int:
        """Advance from the step ``first`` as :func:`_march` does."""
        contacts, step = self.contacts, self.step
        laws = contacts.opened.laws
        springs = contacts.stiffness, contacts.preload, contact_terms(laws), contact_limits(laws)
        before = state[3].copy()
        contacts.enter(state)
        excitations = self._excitations(first, len(out[0]) * substeps)
        lossy = state, self.system, self.damping, self.dry, excitations, self.space
        made: int = _march(lossy, self.strides, self.flows, springs, step, substeps, steady, out)
        contacts.leave(state, before, tuple(array[:made] for array in out))
        return made

    def _excitations(self, first: int, steps: int) -> Excitations:
        system = self.contacts.system
        if not system.excitations:
            return no_excitations(system.num_modes, 1 << steps.bit_length(), self.step)
        return excitation_arrays(system, self.step * np.arange(first, first + steps + 1), self.step)


def integrate(
    motion: Motion,
    step: float | None = None,
    energy_bound: float = ENERGY_BOUND,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Move a gap system from its initial state.

    Args:
        motion: of any system.
        step: in s, made smaller to fit the output step; from :func:`contact_step` unless given.
        energy_bound: largest energy residual that passes, see :class:`Trajectory`.
        progress: called with the part done, 0 to 1.

    Raises:
        NumericsError: the state is not finite, or the energy residual passes its bound.
    """
    motion = replace(motion, system=motion.system.gathered())
    system = motion.system
    if step is None:
        step = contact_step(system, motion.output_step, motion.initial_speeds)
    if system.travels:
        return integrate_drawn(motion, step, energy_bound, progress)
    record = Record.begin(motion, step, len(ENERGIES))
    state, y = record.state, record.state[3]
    # Impacts keep their steps, which run back as they came.
    linear = closable(system) & pressing(system, y).any()
    known: dict[bytes, _Steps] = {}
    done = 0
    while done < motion.outputs:
        closed = linear & pressing(system, y)
        if closed.tobytes() not in known:
            known[closed.tobytes()] = _Steps.of(ClosedContacts.of(system, closed), record.step)
        out = record.rows(done, motion.until(done, record.substeps))
        steps, first = known[closed.tobytes()], done
        steady = bool(linear.any())
        done += steps.march(state, first * record.substeps, record.substeps, steady, out)
        record.check(first, done, energy_bound, progress)
    return record.trajectory()
