# SPDX-License-Identifier: LGPL-3.0-or-later
"""Energy balance of a motion: stored energies, work and losses."""

from __future__ import annotations

import numpy as np

from dynamics.arrays import Array
from dynamics.failure import NumericsError

# Largest energy residual of a valid run, as a part of the energy put in. The time step leaves
# round-off, below 1e-9 of the work.
ENERGY_BOUND = 1.0e-6

# Stored energies, work of the loads, losses.
ENERGIES = (
    "kinetic_energy",
    "strain_energy",
    "contact_energy",
    "work",
    "damping_loss",
    "friction_loss",
    "contact_loss",
)

# With a drive, its work as well.
DRIVEN_ENERGIES = (*ENERGIES, "drive_work")


def energy_residual(energies: Array, least: float = 0.0) -> Array:
    """Return the unaccounted energy (num_times,) as a part of the energy put in.

    Args:
        energies: (num_times, 7) or (num_times, 8), the columns of ``ENERGIES`` or
            ``DRIVEN_ENERGIES`` in J.
        least: an energy in J below which that put in is round-off, as where friction holds all.
    """
    work = energies[:, 3]
    signs = np.ones(energies.shape[1])
    signs[3] = signs[len(ENERGIES) :] = -1.0
    initial = float(energies[0, :3].sum())
    # No product of BLAS, whose last bits depend on where in memory the energies lie.
    missing = (energies * signs).sum(axis=1) - initial
    # Axial forces do work as a segment tips over: its strain energy falls below zero.
    put_in = max(float(np.abs(work).max()), abs(initial), -float(energies[:, 1].min()), least)
    return np.asarray(missing / put_in if put_in > 0.0 else missing)


def check_energy(energies: Array, bound: float = ENERGY_BOUND, least: float = 0.0) -> None:
    """Check the energies of a motion.

    Args:
        energies: as in :func:`energy_residual`.
        bound: largest energy residual that passes.
        least: as in :func:`energy_residual`.

    Raises:
        NumericsError: an energy is not finite, or the residual passes the bound.
    """
    if not np.isfinite(energies).all():
        raise NumericsError("the motion is not finite; check the loads and the stiffnesses")
    worst = float(np.abs(energy_residual(energies, least)).max())
    if worst > bound:
        raise NumericsError(
            f"the energy residual is {worst:.3g} of the work done, above the bound of {bound:.3g}"
        )
