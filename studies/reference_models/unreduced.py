# SPDX-License-Identifier: LGPL-3.0-or-later
"""The motion of the unreduced shells: what the reduction is held against.

Every segment goes by the generalised-α method, its matrix factorised once. Contact and friction
are condensed: a step is one back-substitution for each segment as if nothing resisted, then a small
problem in the forces of the rows, whose compliance does not change from step to step, then their
displacements, which are known combinations of columns. The forces are those at the time of the
method's own balance, friction opposes the way over the whole step, and what it holds stays where it
is to round-off.

Energy that is not accounted for is what the method takes, and what a step misses of a contact that
opens or closes within it. Any number of ranks may share the shells.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse

from dynamics.energy import ENERGIES, check_energy, energy_residual
from geometry.arrays import Array
from geometry.boom import BoomError
from shell_model.boom_shell import BoomShell
from shell_model.segment.cross_section import Reading, Row
from shell_model.segment.segment_shell import SegmentShell
from studies.reference_models.generalised_alpha import GeneralisedAlpha, SegmentStepper
from studies.reference_models.resisting_rows import ResistingRows

RADIUS = 0.8

# The energy residual beyond which a motion is not a result: the method takes energy where its
# steps are long.
LOSS_BOUND = 1.0e-2

# How often a motion looks whether its energies can be trusted.
_CHECKS = 20


@dataclass(frozen=True, slots=True)
class DirectMotion:
    """A motion of the unreduced shells.

    Args:
        time: (num_times,) in s.
        observed: name → (num_times,) in the unit of what is read.
        contact_forces: (num_times, num_contacts) in N, means over the output interval that ends at
            the time, positive where the inner segment presses up.
        friction_forces: (num_times, num_frictions) in N, likewise, positive where they push the
            inner segment along its row.
        slides: (num_times, num_frictions) what the friction rows read, in m.
        energies: (num_times, 7), the columns of ``ENERGIES`` in J.
        step: in s.
    """

    time: Array
    observed: Mapping[str, Array]
    contact_forces: Array
    friction_forces: Array
    slides: Array
    energies: Array
    step: float

    @property
    def energy_residual(self) -> float:
        """Largest unaccounted energy as a part of the energy put in."""
        return float(np.abs(energy_residual(self.energies)).max())


def integrate_directly(
    full: BoomShell,
    duration: float,
    step: float,
    output_step: float = 1.0e-3,
    radius: float = RADIUS,
    energy_bound: float = LOSS_BOUND,
) -> DirectMotion:
    """Move the unreduced shells from rest. Collective.

    Args:
        full: a flat boom with constant loads and prescribed normal forces.
        duration: in s; a whole number of output steps is made, at least one.
        step: in s, made smaller to fit the output step.
        output_step: in s.
        radius: ρ∞, see :class:`GeneralisedAlpha`.
        energy_bound: largest energy residual that passes.

    Raises:
        BoomError: it has what the direct integration does not take.
        NumericsError: forces are not found, numbers are not finite, or the energy residual passes
            its bound.
    """
    _check(full)
    outputs = max(1, round(duration / output_step))
    substeps = max(1, int(np.ceil(output_step / step * (1.0 - 1e-12))))
    alpha = GeneralisedAlpha(output_step / substeps, radius)
    steppers = [
        SegmentStepper(shell, load, _rows(full.resisting, number, shell), alpha)
        for number, (shell, load) in enumerate(zip(full.shells, full.own_loads, strict=True))
    ]
    try:
        return _march(full, alpha, steppers, outputs, substeps, energy_bound)
    finally:
        for stepper in steppers:
            stepper.destroy()


def _check(full: BoomShell) -> None:
    in_space = any(direction == "y" for _, direction in full.stations)
    if in_space or full.loads or full.ties:
        raise BoomError(
            "joint",
            "the unreduced shell moves in the plane, under constant loads, without tied joints",
        )
    if any(contact.law.damping > 0.0 for contact in full.rows.contacts):
        raise BoomError("joint", "the unreduced shell takes contacts without damping")
    if full.rows.dashpots:
        raise BoomError("joint", "the unreduced shell takes joints without dashpots")
    if any(shell.segment.compression for shell in full.shells):
        raise BoomError("axial", "the unreduced shell takes no axial forces")
    if full.lines:
        raise BoomError("cylinder", "the unreduced shell takes neither cylinders nor dashpots")
    if any(friction.law.pressed_by for friction in full.rows.frictions):
        raise BoomError("joint", "the unreduced shell takes friction under normal_forces alone")


def _march(
    full: BoomShell,
    alpha: GeneralisedAlpha,
    steppers: Sequence[SegmentStepper],
    outputs: int,
    substeps: int,
    energy_bound: float,
) -> DirectMotion:
    """Make ``substeps`` steps for each of the outputs."""
    rows = ResistingRows(
        [contact.law for contact in full.rows.contacts],
        [friction.law for friction in full.rows.frictions],
        np.sum([stepper.compliance for stepper in steppers], axis=0),
        1.0 / (1.0 - alpha.force_shift),
    )
    readings = [seen.reading for seen in full.observed.values()]
    observers = [_rows(readings, number, shell) for number, shell in enumerate(full.shells)]
    contacts = len(full.rows.contacts)
    observed = np.zeros((outputs + 1, len(readings)))
    means = np.zeros((outputs + 1, contacts + len(full.rows.frictions)))
    slides = np.zeros((outputs + 1, len(full.rows.frictions)))
    energies = np.zeros((outputs + 1, len(ENERGIES)))
    energies[0, 2] = rows.contact_energy
    for k in range(1, outputs + 1):
        for _ in range(substeps):
            for stepper in steppers:
                stepper.free_response()
            read = np.sum([stepper.read() for stepper in steppers], axis=0)
            forces = rows.forces(full.comm.allreduce(read))
            for stepper in steppers:
                stepper.push(forces)
            means[k] += forces / substeps
        parts = zip(observers, steppers, strict=True)
        seen = np.sum([row @ stepper.displacement() for row, stepper in parts], axis=0)
        observed[k] = full.comm.allreduce(seen)
        slides[k] = rows.readings[contacts:]
        energies[k, [0, 1, 3]] = np.sum([stepper.energies() for stepper in steppers], axis=0)
        energies[k, [2, 5]] = rows.contact_energy, rows.friction_loss
        if k == outputs or k % max(1, outputs // _CHECKS) == 0:
            check_energy(energies[: k + 1], energy_bound)
    return DirectMotion(
        time=substeps * alpha.step * np.arange(outputs + 1),
        observed=dict(zip(full.observed, observed.T, strict=True)),
        contact_forces=means[:, :contacts],
        friction_forces=-means[:, contacts:],
        slides=slides,
        energies=energies,
        step=alpha.step,
    )


def _rows(readings: Sequence[Reading], number: int, shell: SegmentShell) -> scipy.sparse.csr_matrix:
    """(num_readings, num_owned) this rank's part of what readings read of a segment."""
    parts = [shell.row(reading.get(number, Row())) for reading in readings]
    return scipy.sparse.csr_matrix(np.array(parts).reshape(-1, shell.free.size))
