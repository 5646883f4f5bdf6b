# SPDX-License-Identifier: LGPL-3.0-or-later
"""Modal damping of a boom with its joints in contact.

The modes of its separate segments describe a boom with play. Much of its vibration is in their
rigid motions, which modal damping of the segments does not affect. Its own modes are those with the
joints pressed: Φ (num_modes, r), Φᵀ Φ = 1, of frequencies ω. With ρ and ε the rigid and elastic
coordinates of Φ, Ω the frequencies of the segments, and ε⁺ the pseudo-inverse,

    C = 2ζ [½ ω₁ on rigid coordinates + s Ω on elastic ones + ε⁺ᵀ (ω − ½ ω₁ ρᵀρ − s εᵀ Ω ε) ε⁺]

gives Φᵀ C Φ = 2ζ ω, and reduces the speed of a segment without contact at the rate ζ ω₁. C is
positive semidefinite for s ≤ ½ at least, since εᵀ Ω ε ≤ (εᵀ Ω² ε)^½ ≤ ω (Hansen 1980); s is the
largest up to 1.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh, null_space, pinv

from dynamics.arrays import Array
from dynamics.equilibrium import equilibrium
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem

# Number of modes with the given ratio: in space, three of each direction and two of twisting.
DAMPED_MODES = 8

# Motions of the pressed boom that bend its segments less than this part of what others do are left
# to what damps the rigid segments.
_BENT = 5.0e-3

# Fraction of the largest dashpot rate that is round-off.
_ROUND_OFF = 1.0e-9


def pressed_modes(system: GapSystem, rest: Array | None = None) -> tuple[Array, Array]:
    """Return ω (num_shapes,) in rad/s, rising, and shapes (num_modes, num_shapes), joints pressed.

    Rows that press at rest have their stiffness F'(y) there. Where none presses at a station
    between segments, all its rows are bonded.

    Args:
        system: system of a boom.
        rest: (num_modes,) its rest in √kg·m; that under the constant loads unless given.
    """
    try:
        rest = equilibrium(system, system.load) if rest is None else rest
    except NumericsError:
        stiffness = np.zeros(len(system.laws))
    else:
        gaps = system.rows @ rest
        stiffness = np.array([law.slope(y) for law, y in zip(system.laws, gaps, strict=True)])
    pressed = np.isin(system.station_of_row, system.station_of_row[stiffness > 0.0])
    tied = system.rows[~pressed & ~np.isin(system.station_of_row, system.grounded)]
    free = null_space(tied) if tied.size else np.eye(system.num_modes)
    rows = system.rows @ free
    omega2, combination = eigh(
        free.T @ (system.omega2[:, None] * free) + (rows.T * stiffness) @ rows
    )
    # Rigid segments have no frequency of their own to distinguish motions from round-off.
    least = min(system.omega2[system.omega2 > 0.0], default=_ROUND_OFF * omega2.max(initial=0.0))
    moving = omega2 > 1.0e-6 * least
    return np.sqrt(omega2[moving]), free @ combination[:, moving]


def add_damping(
    system: GapSystem, ratio: float, rayleigh: tuple[float, float], rest: Array | None = None
) -> GapSystem:
    """Return the system with damping besides its segments' own.

    Args:
        system: system of a boom.
        ratio: as of :func:`with_ratio`.
        rayleigh: α in 1/s and β in s of α + β ω² in the modes of the segments.
        rest: as of :func:`pressed_modes`.
    """
    mass, stiffness = rayleigh
    rates = system.damping + mass + stiffness * np.maximum(system.omega2, 0.0)
    system = replace(system, damping=rates)
    return system if ratio == 0.0 else with_ratio(system, ratio, rest)


def with_ratio(system: GapSystem, ratio: float, rest: Array | None = None) -> GapSystem:
    """Return the system with ζ = ``ratio`` added in the first modes of the pressed boom.

    These are ``DAMPED_MODES``, or as many as its segments can bend; pressed as at ``rest``, see
    :func:`pressed_modes`. Nothing damps rigid segments that no contact presses.
    """
    rigid = system.omega2 <= 0.0
    count = min(DAMPED_MODES, np.count_nonzero(~rigid))
    omega, shapes = (part[..., :count] for part in pressed_modes(system, rest))
    if not omega.size:
        return system
    own = np.where(rigid, 0.5 * omega[0], system.omega)
    bent = np.where(rigid[:, None], 0.0, shapes)
    required = np.diag(omega) - (shapes - bent).T @ (own[:, None] * (shapes - bent))
    found = bent.T @ (own[:, None] * bent)
    share = 1.0 / max(1.0, eigh(found, required, eigvals_only=True)[-1])
    missing, directions = eigh(required - share * found)
    rates = 2.0 * ratio * np.where(rigid, own, share * own)
    needed = missing > _ROUND_OFF * omega[-1]
    strengths = np.sqrt(2.0 * ratio * missing[needed])
    dashpots = strengths[:, None] * (directions[:, needed].T @ pinv(bent, rtol=_BENT))
    return replace(
        system,
        damping=system.damping + rates,
        dashpots=np.concatenate([system.dashpots, dashpots]),
    )


def pressed_ratios(system: GapSystem, rest: Array | None = None) -> tuple[Array, Array]:
    """Return frequencies in Hz and damping ratios Φ·CΦ/2ω (num_shapes,) of the pressed boom.

    It is pressed as at ``rest``, see :func:`pressed_modes`.
    """
    omega, shapes = pressed_modes(system, rest)
    rates = system.damping @ shapes**2 + np.square(system.dashpots @ shapes).sum(axis=0)
    return omega / (2.0 * np.pi), rates / (2.0 * omega)
