# SPDX-License-Identifier: LGPL-3.0-or-later
"""Modal damping of a boom with its joints in contact.

The coordinates of a boom with play are modes of separate segments. Damping of these modes does not
affect the rigid motions, which contribute much to the vibration. So damping is specified for the
modes with closed contacts: Φ (num_modes, r), Φᵀ Φ = 1, of frequencies ω. With ρ and ε the rigid and
elastic coordinates of Φ, Ω the frequencies of the segments, and ε⁺ the pseudo-inverse,

    C = 2ζ [½ ω₁ on rigid coordinates + s Ω on elastic ones + ε⁺ᵀ (ω − ½ ω₁ ρᵀρ − s εᵀ Ω ε) ε⁺]

gives Φᵀ C Φ = 2ζ ω. The speed of a segment without contact decays at the rate ζ ω₁. C is
positive semidefinite at least for s ≤ ½, since εᵀ Ω ε ≤ (εᵀ Ω² ε)^½ ≤ ω (Hansen 1980); s is the
largest permitted value up to 1.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh, null_space, pinv

from dynamics.arrays import Array
from dynamics.equilibrium import equilibrium
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem

# Number of modes with the given damping ratio: in 3D, three per direction and two of twist.
DAMPED_MODES = 8

# Relative bending of segments below which a mode has the damping of rigid motion.
_BENT = 5.0e-3

# Fraction of the largest value (dashpot rate or contact force) below which a value is round-off.
_ROUND_OFF = 1.0e-9


def closed_contact_modes(system: GapSystem, rest: Array | None = None) -> tuple[Array, Array]:
    """Return ω (num_shapes,) in rad/s, ascending, and shapes (num_modes, num_shapes).

    Contacts that press at rest have their stiffness F'(y) at rest; a force that is round-off does
    not press. If no contact presses at a station between segments, all its rows are bonded.

    Args:
        system: gap system of a boom.
        rest: equilibrium (num_modes,) in √kg·m; equilibrium under constant loads unless given.
    """
    try:
        rest = equilibrium(system, system.load) if rest is None else rest
    except NumericsError:
        stiffness = np.zeros(len(system.laws))
    else:
        gaps = list(zip(system.laws, system.rows @ rest, strict=True))
        force = np.abs([float(law.force(y)) for law, y in gaps])
        slope = np.array([law.slope(y) for law, y in gaps])
        stiffness = np.where(force > _ROUND_OFF * force.max(initial=0.0), slope, 0.0)
    pressed = np.isin(system.station_of_row, system.station_of_row[stiffness > 0.0])
    tied = system.rows[~pressed & ~np.isin(system.station_of_row, system.grounded)]
    free = null_space(tied) if tied.size else np.eye(system.num_modes)
    rows = system.rows @ free
    omega2, combination = eigh(
        free.T @ (system.omega2[:, None] * free) + (rows.T * stiffness) @ rows
    )
    # Without elastic modes, the scale of round-off is the largest ω² with closed contacts.
    least = min(system.omega2[system.omega2 > 0.0], default=_ROUND_OFF * omega2.max(initial=0.0))
    moving = omega2 > 1.0e-6 * least
    return np.sqrt(omega2[moving]), free @ combination[:, moving]


def with_modal_damping(system: GapSystem, ratio: float, rest: Array | None = None) -> GapSystem:
    """Return the system with the damping ratio ``ratio`` added to the first closed-contact modes.

    It applies to the first eight modes of :func:`closed_contact_modes`, or fewer if the segments
    have fewer elastic modes. A system of rigid segments is not damped.
    """
    rigid = system.omega2 <= 0.0
    count = min(DAMPED_MODES, np.count_nonzero(~rigid))
    omega, shapes = (part[..., :count] for part in closed_contact_modes(system, rest))
    if not omega.size:
        return system
    rates_of_modes = np.where(rigid, 0.5 * omega[0], system.omega)
    bent = np.where(rigid[:, None], 0.0, shapes)
    required = np.diag(omega) - (shapes - bent).T @ (rates_of_modes[:, None] * (shapes - bent))
    damping = bent.T @ (rates_of_modes[:, None] * bent)
    share = 1.0 / max(1.0, eigh(damping, required, eigvals_only=True)[-1])
    missing, directions = eigh(required - share * damping)
    rates = 2.0 * ratio * np.where(rigid, rates_of_modes, share * rates_of_modes)
    needed = missing > _ROUND_OFF * omega[-1]
    strengths = np.sqrt(2.0 * ratio * missing[needed])
    dashpots = strengths[:, None] * (directions[:, needed].T @ pinv(bent, rtol=_BENT))
    return replace(
        system,
        damping=system.damping + rates,
        dashpots=np.concatenate([system.dashpots, dashpots]),
    )


def closed_contact_damping(system: GapSystem, rest: Array | None = None) -> tuple[Array, Array]:
    """Return frequencies in Hz and damping ratios Φ·CΦ/2ω (num_shapes,) with closed contacts.

    ``rest`` is the equilibrium, as in :func:`closed_contact_modes`.
    """
    omega, shapes = closed_contact_modes(system, rest)
    rates = system.damping @ shapes**2 + np.square(system.dashpots @ shapes).sum(axis=0)
    return omega / (2.0 * np.pi), rates / (2.0 * omega)
