# SPDX-License-Identifier: LGPL-3.0-or-later
"""Energy balance of a motion: stored energies, work and losses."""

from __future__ import annotations

import numpy as np

from protractile.dynamics.arrays import Array
from protractile.dynamics.failure import NumericsError

# Largest energy residual of a valid run, as a fraction of the input energy. The time step leaves
# only round-off, below 1e-9 of the work.
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

# Energies of a system with drives.
DRIVEN_ENERGIES = (*ENERGIES, "drive_work")


def energy_residual(energies: Array, energy_floor: float = 0.0) -> Array:
    """Return the error (num_times,) of the energy balance, as a fraction of the input energy.

    Args:
        energies: columns of ``ENERGIES`` or ``DRIVEN_ENERGIES`` in J, (num_times, 7) or (num_times,
            8).
        energy_floor: least input energy in J for this fraction, above round-off; it is needed if,
            for example, friction prevents all motion.
    """
    work = energies[:, 3]
    signs = np.ones(energies.shape[1])
    signs[3] = signs[len(ENERGIES) :] = -1.0
    initial = float(energies[0, :3].sum())
    # BLAS is not used, since its last bits depend on addresses in memory.
    missing = (energies * signs).sum(axis=1) - initial
    # The strain energy may be negative, since axial forces do work on an unstable segment.
    input_energy = max(
        float(np.abs(work).max()), abs(initial), -float(energies[:, 1].min()), energy_floor
    )
    return np.asarray(missing / input_energy if input_energy > 0.0 else missing)


def check_energy(energies: Array, bound: float = ENERGY_BOUND, energy_floor: float = 0.0) -> None:
    """Check the energies of a motion.

    Args:
        energies, energy_floor: as in :func:`energy_residual`.
        bound: largest permitted energy residual.

    Raises:
        NumericsError: an energy is not finite, or the residual exceeds the bound.
    """
    if not np.isfinite(energies).all():
        raise NumericsError("the motion is not finite; check the loads and the stiffnesses")
    worst = float(np.abs(energy_residual(energies, energy_floor)).max())
    if worst > bound:
        raise NumericsError(
            f"the energy residual is {worst:.3g} of the work done, above the bound of {bound:.3g}"
        )
