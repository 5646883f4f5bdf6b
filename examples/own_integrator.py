# SPDX-License-Identifier: LGPL-3.0-or-later
"""User-defined integrator, scipy's Runge-Kutta formulas, compared with that of protractile."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import solve_ivp

import protractile as pt
from protractile.dynamics.motion import Motion


@dataclass(frozen=True, slots=True)
class RungeKutta:
    """Dormand and Prince's method of order 8, for systems without losses."""

    tolerance: float = 1.0e-10

    def __call__(
        self, motion: Motion, progress: Callable[[float], None] | None = None
    ) -> pt.Trajectory:
        system = motion.system.gather_loads()
        n, rows, laws = system.num_modes, system.rows, system.laws

        def rates(time: float, state: np.ndarray) -> np.ndarray:
            a, v = state[:n], state[n:]
            pressed = [law.force(y) for law, y in zip(laws, rows @ a, strict=True)]
            return np.concatenate([v, system.load - system.omega2 * a - pressed @ rows])

        time = motion.output_step * np.arange(motion.outputs + 1)
        start, fine = np.concatenate([motion.position, motion.velocity]), self.tolerance
        run = solve_ivp(rates, time[[0, -1]], start, "DOP853", time, rtol=fine, atol=fine)
        return pt.Trajectory.from_states(system, time, run.y[:n].T, run.y[n:].T)

    def like(self, trajectory: pt.Trajectory) -> "RungeKutta":
        return self

    def finer(self) -> "RungeKutta":
        return replace(self, tolerance=0.01 * self.tolerance)
