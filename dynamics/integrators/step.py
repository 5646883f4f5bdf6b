# SPDX-License-Identifier: LGPL-3.0-or-later
"""The time step that contacts, friction and excitations need.

Between contacts the motion is exact at any step; a contact is resolved when the step is a
small part of the period that the pressed spring and the mass at its row would have alone, sliding
when it is a small part of the period with which the row swings, an excitation when it is a small
part of its own.
"""

from __future__ import annotations

import numpy as np

from dynamics.arrays import Array
from dynamics.contact_term import energy_of
from dynamics.excitation import History
from dynamics.gap_system import GapSystem

# Step times the highest frequency. The energy error of the splitting is second order in it.
PHASE = 0.03

# Where a boom that is drawn out is looked at.
_POSITIONS = 21

# What part of a speed dashpots may take in a step.
DRAGGED = 0.2


def modal_speeds(system: GapSystem, initial: Array | float = 0.0) -> Array:
    """(num_modes,) estimate in m/s·√kg of how fast each elastic mode swings, |Q_i|/ω_i and more.

    Excitations count with their largest value, as if it came at once. Rigid modes keep their
    initial speed.
    """
    load, omega = system.largest_load, system.omega
    return np.asarray(np.divide(load, omega, out=np.zeros(load.size), where=omega > 0.0) + initial)


def closing_speeds(system: GapSystem, initial: Array | float = 0.0) -> Array:
    """(num_rows,) estimate in m/s of how fast each row closes.

    Elastic modes swing as :func:`modal_speeds` says; rigid ones fall freely across the whole play
    2Δ. The initial state adds its own.

    Args:
        system: with contact rows.
        initial: (num_modes,) ``Motion.initial_speeds``; at rest unless given.
    """
    rigid = system.omega2 <= 0.0
    loads = [(system.load, 1.0), *((x.load, x.history.peak) for x in system.excitations)]
    fall = sum(np.abs(system.rows[:, rigid] @ load[rigid]) * peak for load, peak in loads)
    play = np.array([law.play for law in system.laws])
    swing = np.abs(system.rows) @ modal_speeds(system, initial)
    return np.asarray(swing + np.sqrt(2.0 * fall * play))


def contact_frequencies(system: GapSystem, initial: Array | float = 0.0) -> Array:
    """(num_rows,) √(F'(p)/m) in rad/s, with m the row's mass and p its deepest penetration.

    p follows from the kinetic energy of the row's own mass at twice the closing speed, since
    the second segment may come towards it as fast: k pⁿ⁺¹/(n+1) = ½ m (2v)².
    """
    mass = system.row_masses
    speed = 2.0 * closing_speeds(system, initial)
    energies = 0.5 * mass * speed**2
    stiffness = [w.slope_where(energy_of, e) for w, e in zip(system.laws, energies, strict=True)]
    return np.asarray(np.sqrt(np.array(stiffness) / mass))


def sliding_frequencies(system: GapSystem, initial: Array | float = 0.0) -> Array:
    """(num_frictions,) mean ω of the modes in a friction row in rad/s, weighted by their speeds."""
    weights = np.abs(system.friction_rows) * modal_speeds(system, initial)
    total = weights.sum(axis=1)
    change = weights @ system.omega
    return np.asarray(np.divide(change, total, out=np.zeros(total.size), where=total > 0.0))


def _passed(history: History) -> Array:
    """(num_times,) in s, over all that a history of a travel does between its kinks."""
    kinks = np.array([0.0, *history.kinks])
    return np.linspace(float(kinks.min()), float(kinks.max()), _POSITIONS)


def contact_step(
    system: GapSystem, output_step: float, initial: Array | float = 0.0, phase: float = PHASE
) -> float:
    """The largest whole part of the output step that resolves contacts, friction, excitations.

    With contact or friction it is also at most 1/ω of the highest mode. Within it dashpots take no
    more than ``DRAGGED`` of a speed.

    Args:
        system: without any of these the motion is exact, and the output step itself serves.
        output_step: in s.
        initial: (num_modes,) ``Motion.initial_speeds``; at rest unless given.
        phase: step times the highest frequency.
    """
    if system.travels:
        histories = [travel.history for travel in system.travels]
        times = {time for history in histories for time in _passed(history) if time >= 0.0}
        steps = [contact_step(system.standing(time), output_step, initial, phase) for time in times]
        fastest = max(history.fastest for history in histories)
        return min(*steps, output_step / max(1, int(np.ceil(output_step * fastest / phase))))
    frequencies = [x.history.fastest for x in system.excitations]
    if system.laws:
        frequencies.extend(contact_frequencies(system, initial))
    if system.frictions:
        frequencies.extend(sliding_frequencies(system, initial))
    if system.laws or system.frictions:
        # An impulse every half period of a mode pumps it (García-Archilla et al. 1999): stay well
        # away from that for all modes, however soft the contact.
        frequencies.append(phase * float(system.omega.max()))
    if system.dashpots.size:
        frequencies.append(phase / DRAGGED * float(np.linalg.norm(system.dashpots, 2) ** 2))
    fastest = max(frequencies, default=0.0)
    return output_step / max(1, int(np.ceil(output_step * fastest / phase)))
