# SPDX-License-Identifier: LGPL-3.0-or-later
"""The time step that a contact needs.

Between contacts the motion is exact at any step; a contact is resolved when the step is a
small part of the period that the pressed spring and the mass at its row would have alone.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dynamics.gap_system import GapSystem

Array = npt.NDArray[np.float64]

# Step times contact frequency. The energy error of the splitting is second order in it.
PHASE = 0.03


def initial_speeds(system: GapSystem, position: Array, velocity: Array) -> Array:
    """(num_modes,) √(v² + ω² a²), the speed that each mode reaches from its initial state."""
    return np.asarray(np.sqrt(velocity**2 + system.omega2 * position**2))


def closing_speeds(system: GapSystem, initial: Array | float = 0.0) -> Array:
    """(num_rows,) estimate in m/s of how fast each row closes.

    Elastic modes swing to |Q_i|/ω_i under the load; rigid ones fall freely across the whole play
    2Δ. The initial state adds its own.

    Args:
        system: with contact rows.
        initial: (num_modes,) of :func:`initial_speeds`; at rest unless given.
    """
    elastic = system.omega2 > 0.0
    omega = np.sqrt(system.omega2[elastic])
    swing = np.abs(system.rows[:, elastic] * system.load[elastic]) @ (1.0 / omega)
    fall = np.abs(system.rows[:, ~elastic] @ system.load[~elastic])
    play = np.array([2.0 * law.clearance for law in system.laws])
    thrown = (np.abs(system.rows) * initial).sum(axis=1)
    return np.asarray(swing + np.sqrt(2.0 * fall * play) + thrown)


def contact_frequencies(system: GapSystem, initial: Array | float = 0.0) -> Array:
    """(num_rows,) √(F'(p)/m) in rad/s, with m the row's mass and p its deepest penetration.

    p follows from the kinetic energy of the row's own mass at twice the closing speed, since
    the second segment may come towards it as fast: k pⁿ⁺¹/(n+1) = ½ m (2v)².
    """
    mass = system.row_masses
    speed = 2.0 * closing_speeds(system, initial)
    k = np.array([max(law.stiffness, law.below) for law in system.laws])
    n = np.array([law.exponent for law in system.laws])
    depth = ((n + 1.0) * mass * speed**2 / (2.0 * k)) ** (1.0 / (n + 1.0))
    return np.asarray(np.sqrt(n * k * depth ** (n - 1.0) / mass))


def contact_step(
    system: GapSystem, output_step: float, initial: Array | float = 0.0, phase: float = PHASE
) -> float:
    """The largest whole part of the output step that resolves every contact, in s.

    It is also at most 1/ω of the highest mode.

    Args:
        system: without contact rows the motion is exact, and the output step itself serves.
        output_step: in s.
        initial: (num_modes,) of :func:`initial_speeds`; at rest unless given.
        phase: step times the highest contact frequency.
    """
    if not system.laws:
        return output_step
    # An impulse every half period of a mode pumps it (García-Archilla et al. 1999): stay well
    # away from that for all modes, however soft the contact.
    stiffest = phase * float(np.sqrt(system.omega2.max()))
    fastest = max(float(contact_frequencies(system, initial).max()), stiffest)
    return output_step / max(1, int(np.ceil(output_step * fastest / phase)))
