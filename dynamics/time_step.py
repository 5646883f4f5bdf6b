# SPDX-License-Identifier: LGPL-3.0-or-later
"""Time integration of a gap system, the same for all models, contact laws and losses.

Within a step of length h, contact and friction forces are constant and the solution of each mode is
exact. A contact force is the discrete gradient of the contact energy (Gonzalez 1996). Friction
obeys the set-valued law for the displacement in the step (Moreau 1988). A dashpot resists the mean
rate of its row. The energy balance holds to round-off for every h. The scheme has second order
(first order with stick-slip), and is reversible without losses. The time loop is
:func:`.dynamics.kernels.march.march`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import contact_limits
from protractile.dynamics.energy import DRIVEN_ENERGIES, ENERGIES, check_energy
from protractile.dynamics.excitation import History
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.kernels.march import (
    CHANGES,
    FIRST_CONTACT,
    STEPS,
    TALLY,
    LoopSystem,
    Schedule,
    State,
    march,
)
from protractile.dynamics.kernels.modal_flow import Flow, compliance, modal_flow
from protractile.dynamics.kernels.row_forces import row_laws, row_problem
from protractile.dynamics.kernels.telescoping import (
    add_axial_forces,
    moving_axial_forces,
    moving_rows,
)
from protractile.dynamics.motion import Motion
from protractile.dynamics.stick_slip import ELASTIC_DRIVE_VARIABLES, move_segment
from protractile.dynamics.trajectory import DRIVE_VARIABLES, Output, Trajectory
from protractile.dynamics.travel import Travel

# Maximum number of halvings of a step whose forces do not converge.
_HALVINGS = 10

# Gauss points and weights on [0, 1], exact for polynomials of degree five.
_POINTS = 0.5 + np.sqrt(0.15) * np.array([-1.0, 0.0, 1.0])
_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0


@dataclass(frozen=True, eq=False)
class Integration:
    """Time integration of a motion in progress."""

    motion: Motion  #: motion with all constant loads in the ``load`` of its system
    output: Output  #: output at all times, beginning with the initial state
    state: State  #: state after the last computed output
    _tables: dict[int, tuple[Flow, Array]] = field(default_factory=dict)

    @classmethod
    def begin(cls, motion: Motion) -> Integration:
        """Return the integration of a motion at t = 0."""
        motion = replace(motion, system=motion.system.gather_loads())
        system, laws = motion.system, motion.system.laws
        n, m, f = system.num_modes, len(laws), len(system.frictions)
        a, v, rows = motion.position.copy(), motion.velocity.copy(), system.all_rows
        y, axial, axial_push = (rows * a).sum(axis=1), moving_axial_forces(system), np.zeros(n)
        extensions, stored, driven = np.zeros((3, len(system.travels)))
        add_axial_forces(extensions, axial, a, 1.0, axial_push, stored)
        forces = [float(law.force(gap)) for law, gap in zip(laws, y, strict=False)]
        tally = np.zeros(TALLY)
        limits, gaps = contact_limits(laws), y[:m]
        touching = (gaps > limits["high"]) | (gaps < limits["low"])
        tally[FIRST_CONTACT] = 0.0 if touching.any() else np.nan
        state = State(
            a, v, rows, y, np.zeros(y.size), axial_push, tally, driven, np.zeros(m),
            np.full(m, np.inf),
        )  # fmt: skip
        kinds = DRIVEN_ENERGIES if driven.size else ENERGIES
        rates = n if any(observer.derivative for observer in system.observers.values()) else 0
        columns = (n, rates, len(kinds), m, m, m, f, driven.size)
        output = Output(*(np.zeros((motion.outputs + 1, count)) for count in columns))
        output.states[0], output.gaps[0] = a, y[:m]
        output.velocities[0] = v[: output.velocities.shape[1]]
        output.means[0] = output.peaks[0] = forces
        strain = 0.5 * float((system.omega2 * a**2).sum()) - float(stored.sum())
        contact = sum(float(law.energy(gap)) for law, gap in zip(laws, y, strict=False))
        output.energies[0, :3] = 0.5 * float((v**2).sum()), strain, contact
        return cls(motion, output, state)

    @cached_property
    def _system(self) -> LoopSystem:
        system = self.motion.system
        loads = np.array([x.load for x in system.excitations]).reshape(-1, system.num_modes)
        moving, axial = moving_rows(system), moving_axial_forces(system)
        load = np.ascontiguousarray(system.load)
        return LoopSystem(load, loads, row_laws(system), moving, axial)

    @property
    def _has_free_flight(self) -> bool:
        """True if only constant loads act while all contacts are open."""
        system = self.motion.system
        others = len(system.excitations), len(system.travels), len(system.dashpots)
        has_friction = any(friction.normal_force for friction in system.frictions)
        return not (any(others) or has_friction or (system.omega2 < 0.0).any())

    def advance(
        self, first: int, last: int, substeps: int, state: State, output: Output | None = None
    ) -> Output:
        """Advance a state through output intervals, and return the output at their ends.

        Args:
            first, last: indices of the outputs at start and end.
            substeps: number of steps of each interval.
            state: state at the start; the method changes it to the state at the end.
            output: output to fill in; a new one unless given.

        Raises:
            NumericsError: the state is not finite, or contact and friction forces do not converge.
        """
        system, step = self.motion.system, self.motion.output_step / substeps
        joined = (substeps & -substeps).bit_length() - 1 if self._has_free_flight else 0
        stretches = substeps >> joined
        if substeps not in self._tables:
            lengths = step * 2.0**joined * 0.5 ** np.arange(joined + _HALVINGS + 1)
            flow = modal_flow(system, lengths)
            matrices = [compliance(state.rows, state.rows, gain) for gain in flow.gain]
            self._tables[substeps] = flow, np.array(matrices)
        if output is None:
            output = Output(*(np.zeros((last - first, x.shape[1])) for x in self.output))
        times = step * 2.0**joined * np.arange(first * stretches, last * stretches + 1)
        problem = row_problem(len(state.rows), len(system.frictions))
        if not march(
            self._system, *self._tables[substeps], state, step_schedule(system, times), stretches,
            joined, problem, output,
        ):  # fmt: skip
            raise NumericsError(
                f"contact and friction forces do not converge even in steps of "
                f"{step * 0.5**_HALVINGS:.3g} s; make the contact softer"
            )
        if not (np.isfinite(state.a).all() and np.isfinite(state.v).all()):
            raise NumericsError(f"the motion is not finite after {times[-1]:.3g} s")
        return output

    def part(self, first: int, last: int) -> Output:
        """Return a view of the outputs from index ``first`` + 1 to ``last``."""
        return Output(*(array[1 + first : 1 + last] for array in self.output))

    @property
    def resolving_step(self) -> float:
        """The largest step in s that resolves all impacts so far; infinite if the steps do."""
        return float(self.state.resolving.min(initial=np.inf))

    def trajectory(
        self, substeps: tuple[int, ...], window: int, step_error: float = np.nan
    ) -> Trajectory:
        """Return the trajectory of the whole motion.

        For each travel with a suffix it includes the extension in m, the force of the drive against
        friction in N, and the power of the drive in W. For an elastic drive it also includes force,
        lag, speed and acceleration, and the :class:`StickSlip` in the attribute ``stick_slip``.

        Args:
            substeps, window: as in :class:`.dynamics.integrator.StepSchedule`.
            step_error: error of the observed deflections due to the time step, as a fraction of
                the range of each; NaN if unknown.

        Raises:
            NumericsError: the energy residual exceeds its bound.
        """
        motion, output, tally = self.motion, self.output, self.state.tally
        step = motion.output_step / max(substeps)
        # The work of the loads within one output interval is the scale of round-off.
        load = motion.system.largest_load
        energy_floor = 0.5 * step**2 * float((load * load).sum())
        check_energy(output.energies, energy_floor=energy_floor)
        trajectory = Trajectory.record(
            motion.system,
            motion.output_step * np.arange(motion.outputs + 1),
            output,
            {
                "step": step,
                "steps": int(tally[STEPS]),
                "first_contact": float(tally[FIRST_CONTACT]),
                "contact_changes": int(tally[CHANGES]),
                "substeps": list(substeps),
                "window": window,
                "step_error": step_error,
                "resolving_step": self.resolving_step,
            },
            energy_floor,
        )
        return self._with_drives(trajectory) if motion.system.travels else trajectory

    def _with_drives(self, trajectory: Trajectory) -> Trajectory:
        """Return the trajectory with the results of drives."""
        system, added, stick_slip = self.motion.system, {}, {}
        for travel, work in zip(system.travels, self.output.drives.T, strict=True):
            if travel.suffix is None:
                continue
            extension = travel.history(trajectory.time)
            friction = axial_friction(system, travel, self.output.means)
            steps = np.diff(extension, prepend=extension[0])
            resistance = np.sign(steps) * friction
            power = np.diff(work + np.cumsum((resistance + travel.axial_load) * steps), prepend=0.0)
            power[1:] /= np.diff(trajectory.time)
            values = dict(zip(DRIVE_VARIABLES, (extension, resistance, power), strict=True))
            if travel.elastic is not None:
                lagged = move_segment(travel.elastic, travel.history, trajectory.time, friction)
                stick_slip[f"drive_force{travel.suffix}"] = lagged.results
                values |= lagged.series
            for name, value in values.items():
                of = {**DRIVE_VARIABLES, **ELASTIC_DRIVE_VARIABLES}[name]
                added[f"{name}{travel.suffix}"] = ("time", value, of)
        data = trajectory.data.assign(added)
        data.attrs |= {"stick_slip": stick_slip} if stick_slip else {}
        return Trajectory(data, trajectory.states, trajectory.row_peaks)


def step_schedule(system: GapSystem, times: Array) -> Schedule:
    """Return loads and extensions in the steps between times (num_steps + 1,) in s."""
    lines = [line_within(x.history, times) for x in system.excitations]
    mean, change = np.array(lines).reshape(-1, 2, times.size - 1).transpose(1, 2, 0)
    extensions = np.array([travel.history(times) for travel in system.travels])
    return Schedule(mean.copy(), change.copy(), extensions.reshape(-1, times.size).T.copy())


def line_within(history: History, times: Array) -> tuple[Array, Array]:
    """Return mean and change (num_steps,) of the straight line that replaces a history in a step.

    The line has the same integral and first moment as the history. So steps need not end at kinks:
    with the step h, the response of a mode of frequency ω has an error of at most (ωh)⁴/720 of the
    effect of a kink.

    Args:
        times: ends (num_steps + 1,) of the steps in s, evenly spaced.
    """
    kinks = np.asarray(history.kinks, dtype=np.float64)
    ends = np.union1d(times, kinks[(kinks > times[0]) & (kinks < times[-1])])
    lengths, step = np.diff(ends), (times[-1] - times[0]) / (times.size - 1)
    inside = ends[:-1, None] + lengths[:, None] * _POINTS
    owner = np.searchsorted(times, ends[:-1], side="right") - 1
    weighed = history(inside) * _WEIGHTS * (lengths / step)[:, None]
    part = (inside - times[owner, None]) / step - 0.5
    number = times.size - 1
    mean, moment = (
        np.asarray(np.bincount(owner, each.sum(axis=1), number), dtype=np.float64)
        for each in (weighed, weighed * part)
    )
    return mean, 12.0 * moment


def axial_friction(system: GapSystem, travel: Travel, forces: Array) -> Array:
    """Return the friction μ Σ|N_l| (num_times,) in N of the pads that a travel moves.

    ``forces`` are contact forces (num_times, num_rows) in N.
    """
    coefficients = {friction.station: friction.coefficient for friction in system.frictions}
    total = np.zeros(len(forces))
    for kind, row in travel.moved_rows:
        if kind == "rows":
            coefficient = coefficients.get(int(system.station_of_row[row]), 0.0)
            total += coefficient * np.abs(forces[:, row])
        elif kind == "friction_rows":
            friction = system.frictions[row]
            total += friction.coefficient * friction.normal_force
    return total
