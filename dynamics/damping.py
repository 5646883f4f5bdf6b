# SPDX-License-Identifier: LGPL-3.0-or-later
"""Modal damping of a boom with its joints in contact.

The coordinates of a boom with play are modes of separate segments. Damping of these modes does not
affect the rigid motions, which contribute much to the vibration. So the damping ratio ζ is
specified for the modes Φ with closed contacts, Φᵀ Φ = 1, of the circular frequencies ω. With the
rigid and elastic coordinates Φ_r and Φ_e of Φ, the pseudo-inverse Φ_e⁺, the diagonal matrix Ω of
the circular frequencies of the segments, and a factor η,

    C = 2ζ [½ ω₁ on rigid coordinates + η Ω on elastic ones
            + Φ_e⁺ᵀ (ω − ½ ω₁ Φ_rᵀ Φ_r − η Φ_eᵀ Ω Φ_e) Φ_e⁺]

gives Φᵀ C Φ = 2ζ ω. The speed of a segment without contact decays at the rate ζ ω₁. C is positive
semidefinite at least for η ≤ ½, since Φ_eᵀ Ω Φ_e ≤ (Φ_eᵀ Ω² Φ_e)^½ ≤ ω (Hansen 1980). η is the
largest permitted value up to 1. The coordinates of a load on a rope belong to Φ_r and to Φ_e⁺: its
mass may exceed that of the boom, so that bending has a small part of the first mode.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.linalg import eigh, null_space, pinv

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import ContactLaw
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem

# Number of modes with the given damping ratio: in 3D, three per direction and two of twist.
DAMPED_MODES = 8

# Relative bending of segments below which a mode has the damping of rigid motion.
_BENT = 5.0e-3

# Fraction of the largest value (dashpot rate or contact force) below which a value is round-off.
_ROUND_OFF = 1.0e-9

# Fraction of the largest contact force at rest below which a station without play is not loaded:
# the bulging walls of a shell press on pads at right angles to the load.
_UNLOADED = 0.01


def closed_contact_modes(system: GapSystem, rest: Array | None = None) -> tuple[Array, Array]:
    """Return ω (num_shapes,) in rad/s, ascending, and modes Φ (num_modes, num_shapes).

    Contacts that are closed at rest have the stiffness F′(y) at rest. A contact whose force is
    round-off counts as open. A station between segments whose contacts are all open is bonded. A
    station without play is not open: if it has no load, the contacts of one side are closed.

    Args:
        rest: equilibrium (num_modes,) in √kg·m; equilibrium under constant loads unless given.
    """
    try:
        rest = equilibrium(system, system.load) if rest is None else rest
    except NumericsError:
        stiffness = np.zeros(len(system.laws))
    else:
        stiffness = closed_stiffness(system, rest)
    closed = np.isin(system.station_of_row, system.station_of_row[stiffness > 0.0])
    bonded = system.rows[~closed & ~np.isin(system.station_of_row, system.grounded)]
    free = null_space(bonded) if bonded.size else np.eye(system.num_modes)
    rows = system.rows @ free
    omega2, combination = eigh(free.T @ system.stiffness @ free + (rows.T * stiffness) @ rows)
    # A load on a rope may swing far more slowly than any segment bends. Without elastic modes, the
    # scale of round-off is the largest ω² with closed contacts.
    scales = np.append(system.omega2, stiffness @ (system.rows @ system.hung.T) ** 2)
    least = min(scales[scales > 0.0], default=_ROUND_OFF * omega2.max(initial=0.0))
    moving = omega2 > 1.0e-6 * least
    return np.sqrt(omega2[moving]), free @ combination[:, moving]


def closed_stiffness(system: GapSystem, rest: Array) -> Array:
    """Return the stiffness (num_rows,) in N/m of closed contacts, 0 for open ones.

    Args:
        rest: equilibrium (num_modes,) in √kg·m.
    """
    gaps = list(zip(system.laws, system.rows @ rest, strict=True))
    force = np.abs([float(law.force(y)) for law, y in gaps])
    slope = np.array([law.slope(y) for law, y in gaps])
    stiffness = np.where(force > _ROUND_OFF * force.max(initial=0.0), slope, 0.0)
    for station in _unloaded_stations(system, force):
        stiffness[station] = _touching(system, station, force)
    return stiffness


def _unloaded_stations(system: GapSystem, force: Array) -> Iterator[list[int]]:
    """Yield the rows of each station that has neither play nor load at rest.

    Args:
        force: size of the force (num_rows,) in N of each row at rest.
    """
    for station in range(len(system.stations)):
        rows = np.flatnonzero(system.station_of_row == station).tolist()
        play = sum(min(system.laws[row].onset(side) for row in rows) for side in (1.0, -1.0))
        loaded = force[rows].max(initial=0.0) > _UNLOADED * force.max(initial=0.0)
        if play <= 0.0 and not loaded:
            yield rows


def _touching(system: GapSystem, rows: list[int], force: Array) -> Array:
    """Return the stiffness (num_rows,) of rows that touch: of the more loaded side, 0 elsewhere."""
    slopes = {
        side: np.array([_first_slope(system.laws[row], side) for row in rows])
        for side in (1.0, -1.0)
    }
    side = max(slopes, key=lambda candidate: float(force[rows] @ (slopes[candidate] > 0.0)))
    return slopes[side]


def _first_slope(law: ContactLaw, side: float) -> float:
    """Return dF/dy in N/m where contact begins on a side; 0 for powers above 1."""
    terms = [term for term in law.terms if term.side == side and term.onset == law.onset(side)]
    return sum(term.stiffness for term in terms if term.exponent == 1.0)


def with_modal_damping(system: GapSystem, ratio: float, rest: Array | None = None) -> GapSystem:
    """Return the system with the damping ratio ``ratio`` added to its first modes.

    These are the first eight modes of :func:`closed_contact_modes`, but at most as many as the
    segments have elastic modes. A system of rigid segments is not damped.
    """
    rigid = system.omega2 <= 0.0
    count = min(DAMPED_MODES, np.count_nonzero(~rigid))
    omega, shapes = (part[..., :count] for part in closed_contact_modes(system, rest))
    if not omega.size:
        return system
    rates_of_modes = np.where(rigid, 0.5 * omega[0], system.omega)
    bent = np.where(rigid[:, None], system.hung.T @ (system.hung @ shapes), shapes)
    required = np.diag(omega) - (shapes - bent).T @ (rates_of_modes[:, None] * (shapes - bent))
    damping = bent.T @ (rates_of_modes[:, None] * bent)
    eta = 1.0 / max(1.0, eigh(damping, required, eigvals_only=True)[-1])
    missing, directions = eigh(required - eta * damping)
    rates = 2.0 * ratio * np.where(rigid, rates_of_modes, eta * rates_of_modes)
    needed = missing > _ROUND_OFF * omega[-1]
    strengths = np.sqrt(2.0 * ratio * missing[needed])
    dashpots = strengths[:, None] * (directions[:, needed].T @ pinv(bent, rtol=_BENT))
    return replace(
        system,
        damping=system.damping + rates,
        dashpots=np.concatenate([system.dashpots, dashpots]),
    )


def closed_contact_damping(system: GapSystem, rest: Array | None = None) -> tuple[Array, Array]:
    """Return frequencies in Hz and damping ratios (num_shapes,) of the modes with closed contacts.

    ``rest`` is the equilibrium, as in :func:`closed_contact_modes`.
    """
    omega, shapes = closed_contact_modes(system, rest)
    rates = system.damping @ shapes**2 + np.square(system.dashpots @ shapes).sum(axis=0)
    return omega / (2.0 * np.pi), rates / (2.0 * omega)
