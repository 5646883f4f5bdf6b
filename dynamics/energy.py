# SPDX-License-Identifier: LGPL-3.0-or-later
"""The energy ledger of a motion: what there was, what came in, what went out, what is left."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dynamics.failure import NumericsError

Array = npt.NDArray[np.float64]

# The energy residual, as a part of the energy put in, beyond which a run is not a result.
ENERGY_BOUND = 1.0e-2

ENERGIES = ("kinetic_energy", "strain_energy", "contact_energy", "work", "dissipation")


def energy_residual(energies: Array) -> Array:
    """(num_times,) energy that is not accounted for, as a part of the energy put in.

    Args:
        energies: (num_times, 5), the columns of ``ENERGIES`` in J.
    """
    held = energies[:, :3].sum(axis=1)
    missing = held - held[0] - energies[:, 3] + energies[:, 4]
    put_in = max(float(np.abs(energies[:, 3]).max()), float(np.abs(held[0])))
    return np.asarray(missing / put_in if put_in > 0.0 else missing)


def check_energy(energies: Array, step: float, bound: float = ENERGY_BOUND) -> None:
    """Stop a motion whose numbers cannot be trusted.

    Args:
        energies: (num_times, 5), the columns of ``ENERGIES`` in J.
        step: of the integrator in s, for the message.
        bound: largest energy residual that passes.

    Raises:
        NumericsError: an energy is not finite, or the residual passes the bound.
    """
    if not np.isfinite(energies).all():
        raise NumericsError(f"the motion is not finite at a step of {step:.3g} s; halve the step")
    worst = float(np.abs(energy_residual(energies)).max())
    if worst > bound:
        raise NumericsError(
            f"the energy residual is {worst:.3g} of the work done, above the bound of {bound:.3g}, "
            f"at a step of {step:.3g} s; halve the step"
        )
