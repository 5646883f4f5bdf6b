# SPDX-License-Identifier: LGPL-3.0-or-later
"""What steps of the splitting leave at every output time, from the initial state on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dynamics.arrays import Array
from dynamics.energy import check_energy
from dynamics.kernels.integrator_state import CHANGES, FIRST_CONTACT, STEPS, State, initial_state
from dynamics.motion import Motion
from dynamics.trajectory import Trajectory


@dataclass(frozen=True, slots=True)
class Record:
    """A motion that is being made.

    Args:
        motion: its loads are gathered.
        substeps: of which an output step is made.
        state: of the loops, where they have come.
        arrays: (num_outputs + 1, …) states, velocities, energies, gaps, mean and peak forces of
            rows, friction forces, and what else there is; velocities may have no columns.
    """

    motion: Motion
    substeps: int
    state: State
    arrays: tuple[Array, ...]

    @classmethod
    def begin(cls, motion: Motion, step: float, terms: int, *others: int) -> Record:
        """With the initial state as the first row, so many terms of energy, and columns of others.

        The step in s is made smaller to fit the output step.
        """
        system = motion.system
        n, m, f = system.num_modes, len(system.laws), len(system.frictions)
        state = initial_state(system, motion.position.copy(), motion.velocity.copy())
        columns = (n, n if system.observes_rates else 0, terms, m, m, m, f, *others)
        arrays = tuple(np.zeros((motion.outputs + 1, count)) for count in columns)
        states, velocities, energies, gaps, means, peaks, *_ = arrays
        _, a, v, y, *_ = state
        states[0], gaps[0] = a, y
        velocities[0] = v[: velocities.shape[1]]
        means[0] = peaks[0] = [law.force(gap) for law, gap in zip(system.laws, y, strict=True)]
        energies[0, :2] = 0.5 * v @ v, 0.5 * system.omega2 @ a**2
        energies[0, 2] = sum(
            float(law.energy(gap)) for law, gap in zip(system.laws, y, strict=True)
        )
        substeps = max(1, int(np.ceil(motion.output_step / step * (1.0 - 1e-12))))
        return cls(motion, substeps, state, arrays)

    @property
    def step(self) -> float:
        """In s."""
        return self.motion.output_step / self.substeps

    @property
    def least_energy(self) -> float:
        """What the loads give within one step, in J."""
        load = self.motion.system.largest_load
        return 0.5 * self.step**2 * float(load @ load)

    def rows(self, first: int, last: int) -> tuple[Array, ...]:
        """Of the arrays, at the ends of the output steps from ``first`` to before ``last``."""
        return tuple(array[1 + first : 1 + last] for array in self.arrays)

    def check(
        self, first: int, done: int, bound: float, progress: Callable[[float], None] | None
    ) -> None:
        """Whether output steps from ``first`` on keep their energy within a bound; tells the part.

        Raises:
            NumericsError: they do not.
        """
        for end in self.motion.checks(first, done):
            check_energy(self.arrays[2][: 1 + end], self.step, bound, self.least_energy)
        if progress is not None:
            progress(done / self.motion.outputs)

    def trajectory(self) -> Trajectory:
        """What has been made."""
        states, velocities, energies, gaps, means, peaks, frictions, *_ = self.arrays
        tally = self.state[6]
        return Trajectory.record(
            self.motion.system,
            time=self.motion.output_step * np.arange(self.motion.outputs + 1),
            states=states,
            velocities=velocities,
            energies=energies,
            row_gaps=gaps,
            row_forces=means,
            row_peaks=peaks,
            row_frictions=frictions,
            step=self.step,
            steps=int(tally[STEPS]),
            first_contact=float(tally[FIRST_CONTACT]),
            contact_changes=int(tally[CHANGES]),
            least_energy=self.least_energy,
        )
