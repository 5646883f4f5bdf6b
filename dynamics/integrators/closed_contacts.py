# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contacts that stay closed, as springs of the modes.

A linear term F = s k (s y − Δ) that presses is a spring k with a preload s k Δ. While it does, the
boom swings in the modes of Ω² + Σ k Bᵀ B, exactly and over any time, as it does without contact in
those of Ω². What the spring would pull where the contact opens is taken back by a term of the other
side, −s, −k, −Δ. So nothing but the coordinates changes, a = Φ b, and motion in them needs no
impulses until a contact opens or another one closes.

Damping couples those modes. A mode that swings with the amplitude q_i moves another one by no more
than |C_hi| ω_i q_i/|ω_h² − ω_i²| (Hasselman 1976). With the damping ratio of a boom that is below
1e-3 of its swing and left out; where it is more, as with dashpots at joints or while a segment can
still fly, no contact is closed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.linalg import eigh

from dynamics.arrays import Array
from dynamics.contact import contact_limits, contact_terms
from dynamics.contact_term import Limits, Terms
from dynamics.gap_system import GapSystem
from dynamics.kernels.contact_kicks import contact_forces
from dynamics.kernels.integrator_state import WORK, State

# Part of the swing that may be lost with the damping between modes.
_COUPLED = 2.0e-3

# ω², as a part of the largest, of what is free to fly.
_ROUND_OFF = 1.0e-12

# Of every term, whether it is closed.
Closed = npt.NDArray[np.bool_]


def closable(system: GapSystem) -> Closed:
    """(num_terms,) which terms are linear; none where losses ask for the forces of every step."""
    lossy = bool(system.frictions) or any(law.damping for law in system.laws)
    return np.asarray((contact_terms(system.laws)["exponent"] == 1.0) & (not lossy))


def pressing(system: GapSystem, y: Array) -> Closed:
    """(num_terms,) which terms press at the gaps y (num_rows,) in m."""
    terms = contact_terms(system.laws)
    return np.asarray(terms["side"] * y[terms["row"]] > terms["onset"])


@dataclass(frozen=True, slots=True)
class ClosedContacts:
    """A gap system in the modes that it has with some of its contacts closed.

    Args:
        opened: the system in the modes of its segments.
        system: in those modes, without observers.
        shapes: (num_modes, num_modes) Φ.
        terms, limits: of what acts beside the modes.
        stiffness: (num_rows,) of the closed terms in N/m, and
        preload: (num_rows,) theirs in N: they press with stiffness · y − preload.
    """

    opened: GapSystem
    system: GapSystem
    shapes: Array
    terms: Terms
    limits: Limits
    stiffness: Array
    preload: Array

    @classmethod
    def of(cls, system: GapSystem, closed: Closed) -> ClosedContacts:
        """With the terms ``closed`` (num_terms,), of those that are :func:`closable`.

        With none where damping couples the modes too much.
        """
        terms, limits = contact_terms(system.laws), contact_limits(system.laws)
        stiffness, preload = np.zeros((2, len(system.laws)))
        if not closed.any():
            return cls(system, system, np.eye(0), terms, limits, stiffness, preload)
        springs, rows = terms[closed], system.rows
        side, k, onset = (springs[name] for name in ("side", "stiffness", "onset"))
        np.add.at(stiffness, springs["row"], k)
        np.add.at(preload, springs["row"], side * k * onset)
        for name in ("side", "stiffness", "onset"):
            terms[name][closed] *= -1.0
        for row in np.unique(springs["row"]):
            low, high = (
                terms["onset"][(terms["row"] == row) & (terms["side"] == side)].min(initial=np.inf)
                for side in (-1.0, 1.0)
            )
            limits["low"][row], limits["high"][row] = -low, high
        _, shapes = eigh(np.diag(system.omega2) + (rows.T * stiffness) @ rows)
        # By Rayleigh's quotient: low modes keep digits that stiff springs would take.
        omega2 = system.omega2 @ shapes**2 + stiffness @ (rows @ shapes) ** 2
        damping = shapes.T @ system.damping_matrix @ shapes
        turned = replace(
            system,
            omega2=omega2,
            load=(system.load + preload @ rows) @ shapes,
            rows=rows @ shapes,
            damping=np.diag(damping).copy(),
            dashpots=np.zeros(0),
            excitations=[replace(x, load=x.load @ shapes) for x in system.excitations],
            observers={},
        )
        if _coupled(turned, damping) > _COUPLED:
            return cls.of(system, np.zeros_like(closed))
        return cls(system, turned, shapes, terms, limits, stiffness, preload)

    @property
    def any(self) -> bool:
        """Whether a contact is closed."""
        return bool(self.stiffness.any())

    def enter(self, state: State) -> None:
        """Take a state to these modes."""
        if self.any:
            self._turn(state, self.shapes.T)
            contact_forces(state[1], self.system.rows, self.terms, state[3], state[4])

    def leave(self, state: State, before: Array, out: tuple[Array, ...]) -> None:
        """Take a state, and ``out`` of the compiled loop, back to the modes of the segments.

        ``before`` (num_rows,) are the gaps in m at the start of the way.
        """
        if not self.any:
            return
        states, velocities, energies, gaps = out[:4]
        self._turn(state, self.shapes)
        terms = contact_terms(self.opened.laws)
        contact_forces(state[1], self.opened.rows, terms, state[3], state[4])
        state[6][WORK] -= self.preload @ (state[3] - before)
        states[:] = states @ self.shapes.T
        if velocities.size:
            velocities[:] = velocities @ self.shapes.T
        energies[:, 1] = 0.5 * states**2 @ self.opened.omega2
        energies[:, 2] = sum(
            law.energy(gap) for law, gap in zip(self.opened.laws, gaps.T, strict=True)
        )
        energies[:, 3] -= (gaps - before) @ self.preload

    def _turn(self, state: State, shapes: Array) -> None:
        _, a, v = state[:3]
        a[:], v[:] = shapes @ a, shapes @ v


def _coupled(system: GapSystem, damping: Array) -> float:
    """Part of the swing under its loads that damping (num_modes, num_modes) in 1/s couples in."""
    omega2 = system.omega2
    if not damping.any() or omega2.min() < _ROUND_OFF * omega2.max():
        return np.inf if damping.any() else 0.0
    swing = system.largest_load / omega2
    if not swing.any():
        # Swings that nothing but the start tells count alike.
        swing = np.ones(omega2.size)
    apart = np.abs(np.subtract.outer(omega2, omega2))
    pulls = np.abs(damping) * system.omega
    parts = np.divide(pulls, apart, out=np.zeros(apart.shape), where=apart > 0.0)
    return float(np.linalg.norm(np.minimum(parts, 1.0) @ swing) / np.linalg.norm(swing))
