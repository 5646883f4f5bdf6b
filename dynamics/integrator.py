# SPDX-License-Identifier: LGPL-3.0-or-later
"""Integrators with adaptive steps, a constant step, or the steps of another run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Protocol

import numpy as np
import numpy.typing as npt

from protractile.dynamics.arrays import Array, is_finite
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.kernels.march import State
from protractile.dynamics.motion import MOST_STEPS, Motion
from protractile.dynamics.time_step import Integration
from protractile.dynamics.trajectory import Output, Trajectory

# Default permitted error of the time step, as a fraction of the range of observed deflections.
TOLERANCE = 1.0e-3

# Initial and minimum number of steps per output interval. With one step, mean forces alternate.
_FIRST, _FEWEST = 8, 2

# Number of output intervals and steps per call of the time loop, between which a run can be
# interrupted.
_CALL, _STEPS_OF_CALL = 1000, 2**16

# Maximum number of output intervals of a window, and ω in rad/s if all modes are rigid.
_LONGEST, _DEFAULT_OMEGA = 128, 100.0

# Times in periods at which free motions after a window are compared.
_FREE_TIMES = np.linspace(0.0, 0.25, 9)

# Maximum product of the step and the highest circular frequency of a history.
_HISTORY_PHASE = 0.5

# Minimum range of a deflection as a fraction of the largest deflection, which excludes round-off.
_LEAST_RANGE = 1.0e-4

# Fraction of the tolerance below which the next window has half as many steps.
_COARSEN_BELOW = 0.125

# Fraction of the error that remains in chaotic motion after two halvings of the step, or after
# three with friction, whose sticking begins at a random phase of a step. In regular motion at most
# a quarter remains.
_REMAINS = 0.5

# Sum of the errors of all windows, as a multiple of the tolerance, with which the comparison of
# whole motions begins. The sum is far above the error of motions with damping.
_LOOSE = 10.0

# Difference of two motions, as a fraction of the range, beyond which chaos is assumed. Motions of
# shells with friction differ by 4 % at steps from which they converge.
_INDEPENDENT = 0.1

# Number of steps at which the refinement of a whole motion ends, as a multiple of ``MOST_STEPS``.
_MOST_REFINED = 4

Progress = Callable[[float], None]


class Integrator(Protocol):
    """Interface of integrators; a user-defined integrator needs these three methods."""

    def __call__(self, motion: Motion, progress: Progress | None = None) -> Trajectory:
        """Return the trajectory. ``progress`` receives the completed fraction, 0 to 1."""

    def like(self, trajectory: Trajectory) -> Integrator:
        """Return an integrator with the steps of ``trajectory``, which this integrator computed."""

    def finer(self) -> Integrator:
        """Return an integrator with smaller errors, for comparison."""


@dataclass(frozen=True, slots=True)
class StepSchedule:
    """Integrator with a prescribed number of steps in each window of the motion."""

    #: number of steps per output interval in each window; the last number applies to all further
    #: windows
    substeps: tuple[int, ...]
    window: int  #: number of output intervals of a window

    def __call__(self, motion: Motion, progress: Progress | None = None) -> Trajectory:
        return self.run(motion, progress).trajectory(self.substeps, self.window)

    def run(self, motion: Motion, progress: Progress | None = None) -> Integration:
        """Return the completed integration of a motion."""
        run = Integration.begin(motion)
        for number, (first, last) in enumerate(_windows(motion, self.window)):
            substeps = self.substeps[min(number, len(self.substeps) - 1)]
            run.advance(first, last, substeps, run.state, run.part(first, last))
            if progress is not None:
                progress(last / motion.outputs)
        return run

    def steps(self, motion: Motion) -> int:
        """Return the number of steps of a motion."""
        ends = enumerate(_windows(motion, self.window))
        last = len(self.substeps) - 1
        return sum(self.substeps[min(i, last)] * (b - a) for i, (a, b) in ends)

    def coarser(self) -> StepSchedule:
        """Return the integrator with twice the steps, at most an output interval."""
        return replace(self, substeps=tuple(max(1, count // 2) for count in self.substeps))

    def like(self, trajectory: Trajectory) -> StepSchedule:
        return self

    def finer(self) -> StepSchedule:
        """Return the integrator with half the steps, and a quarter of the error."""
        return replace(self, substeps=tuple(2 * count for count in self.substeps))


@dataclass(frozen=True, slots=True)
class FixedStep:
    """Integrator with a constant step.

    >>> motion = FixedStep(1e-5)(Motion(ball, duration=1.0, position=[0.5]))
    >>> motion.energy_residual < 1e-11
    True
    """

    step: float  #: step in s; it is reduced so that the output step is a multiple

    def __call__(self, motion: Motion, progress: Progress | None = None) -> Trajectory:
        substeps = max(1, int(np.ceil(motion.output_step / self.step * (1.0 - 1e-12))))
        window = min(_CALL, max(1, _STEPS_OF_CALL // substeps))
        return StepSchedule((substeps,), window)(motion, progress)

    def like(self, trajectory: Trajectory) -> FixedStep:
        return self

    def finer(self) -> FixedStep:
        """Return the integrator with half the step, and a quarter of the error."""
        return FixedStep(0.5 * self.step)


@dataclass(frozen=True, slots=True)
class AdaptiveStep:
    """Integrator with error control by step doubling (Hairer, Nørsett and Wanner 1993).

    The error is the largest difference of an observed deflection from its exact value, as a
    fraction of the range of this deflection. Windows of about a period of the slowest mode are
    computed first, each with a step and with twice that step from the same state, so that their
    errors are about equal. Then whole motions are compared, one with half the steps of the other,
    and all steps are halved until the error of the coarser motion, the attribute ``step_error``, is
    at most the tolerance. This motion is the result, since its error is known. Motions have second
    order, with dry friction first order.

    In chaotic motion no step meets a tolerance. So a step that resolves the largest impact is not
    halved further if two halvings leave more than half of the error, in a whole motion with
    friction three, or if the difference of whole motions is above 10 % and ten times the tolerance.
    Then the finer motion is the result. The number of steps is limited.

    >>> motion = AdaptiveStep()(Motion(ball, duration=1.0, position=[0.5]))
    >>> motion.data.attrs["step_error"] < 1e-3
    True

    Args:
        tolerance: permitted error of each observed deflection by the time step, as a fraction of
            its range.

    Raises:
        ValueError: the tolerance is not between 0 and 1.
    """

    tolerance: float = TOLERANCE

    def __post_init__(self) -> None:
        if not (is_finite(self.tolerance) and 0.0 < self.tolerance < 1.0):
            raise ValueError(f"tolerance must be between 0 and 1, got {self.tolerance}")

    def __call__(self, motion: Motion, progress: Progress | None = None) -> Trajectory:
        report = progress or (lambda part: None)
        error = _Error(motion)
        schedule, fine = self._distribute(motion, error, lambda part: report(0.5 * part))
        coarse = schedule.run(motion)
        differences = [error.between(coarse, schedule.coarser().run(motion))]
        most = _MOST_REFINED * MOST_STEPS * max(1.0, TOLERANCE / self.tolerance)
        independent = max(_INDEPENDENT, 10.0 * self.tolerance)
        halvings = 3 if motion.system.frictions else 2
        while True:
            differences.append(error.between(fine, coarse))
            # Motions with sticking have first order. The error of smooth motions, which have second
            # order, is overestimated by half. Since steps end at random phases of sticking and
            # impacts, one difference may be small by chance.
            estimate = max(2.0 * differences[-1], 0.5 * differences[-2])
            if estimate <= self.tolerance:
                fine = coarse
                break
            schedule = schedule.finer()
            stalls = (
                len(differences) > halvings
                and differences[-1] > _REMAINS * differences[-1 - halvings]
            )
            chaotic = differences[-1] > independent or stalls
            if 2 * schedule.steps(motion) > most or (chaotic and np.isinf(fine.resolving_step)):
                break
            left = 0.5 ** (len(differences) - 1)
            rest = partial(lambda left, part: report(1.0 - left + 0.5 * left * part), left)
            coarse, fine = fine, schedule.finer().run(motion, rest)
        report(1.0)
        return fine.trajectory(schedule.substeps, schedule.window, estimate)

    def _distribute(
        self, motion: Motion, error: _Error, progress: Progress
    ) -> tuple[StepSchedule, Integration]:
        """Return the steps with which the windows have equal errors, for a first comparison.

        The motion with half the steps follows.
        """
        run = Integration.begin(motion)
        outputs, output_step = motion.outputs, motion.output_step
        window = _power_of_two(error.period / output_step, 1, _LONGEST)
        histories = [x.history for x in run.motion.system.excitations]
        histories += [travel.history for travel in run.motion.system.travels]
        fastest = max((history.fastest for history in histories), default=0.0)
        fewest = _power_of_two(2.0 * output_step * fastest / _HISTORY_PHASE, _FEWEST, MOST_STEPS)
        affordable = MOST_STEPS * np.sqrt(TOLERANCE / self.tolerance) / outputs
        most = _power_of_two(affordable, fewest, MOST_STEPS)
        # A pilot run with long steps gives the ranges.
        error.set_ranges(StepSchedule((fewest,), _CALL).run(motion))
        substeps, steps_of_windows = min(max(_FIRST, fewest), most), list[int]()
        for first, last in _windows(motion, window):
            limit = _LOOSE * self.tolerance * (last - first) / outputs
            part, errors = run.part(first, last), list[float]()
            previous = _copy(run.state)
            coarse = run.advance(first, last, substeps // 2, previous)
            while True:
                state = _copy(run.state)
                run.advance(first, last, substeps, state, part)
                errors.append(error.of_window(part, coarse, state, previous))
                resolved = output_step <= substeps * state.resolving.min(initial=np.inf)
                chaotic = resolved and len(errors) > 2 and errors[-1] > _REMAINS * errors[-3]
                if errors[-1] <= limit or chaotic or substeps >= most:
                    break
                previous, coarse = state, Output(*(array.copy() for array in part))
                substeps *= 2
            for kept, reached in zip(run.state, state, strict=True):
                kept[...] = reached
            steps_of_windows.append(substeps)
            if errors[-1] > limit:
                # The next window may need fewer halvings than this one.
                substeps = max(fewest, substeps // 8)
            elif errors[-1] < _COARSEN_BELOW * limit:
                substeps = max(fewest, substeps // 2)
            progress(last / outputs)
        schedule = StepSchedule(tuple(max(fewest, n // 2) for n in steps_of_windows), window)
        finer = schedule.finer()
        return schedule, run if finer.substeps == tuple(steps_of_windows) else finer.run(motion)

    def like(self, trajectory: Trajectory) -> StepSchedule:
        """Return the integrator with the steps of a trajectory."""
        attributes = trajectory.data.attrs
        substeps = tuple(np.atleast_1d(attributes["substeps"]).tolist())
        return StepSchedule(substeps, attributes["window"])

    def finer(self) -> AdaptiveStep:
        """Return the integrator with a quarter of the tolerance, and about half the step."""
        return AdaptiveStep(0.25 * self.tolerance)


class _Error:
    """Difference of two motions in a deflection, as a fraction of the range of this deflection.

    Attributes:
        period: period of the slowest elastic mode in s.
    """

    def __init__(self, motion: Motion) -> None:
        system = motion.system
        observed = [x.row for x in system.observers.values() if (x.unit, x.derivative) == ("m", 0)]
        self._rows = np.array(observed or system.rows).reshape(-1, system.num_modes)
        self._ranges = np.ones(len(self._rows))
        omega = system.omega
        self.period = 2.0 * np.pi / min(omega[omega > 0.0], default=_DEFAULT_OMEGA)
        # Free response (num_times, num_observed, num_modes) of the deflections to a unit initial
        # displacement and a unit initial velocity of each mode, over a quarter of the period.
        times = _FREE_TIMES[:, None] * self.period
        sines = np.divide(np.sin(omega * times), omega, out=times + 0.0 * omega, where=omega > 0.0)
        self._places = self._rows * np.cos(omega * times)[:, None]
        self._speeds = self._rows * sines[:, None]

    def set_ranges(self, run: Integration) -> None:
        """Set the ranges of the deflections to those of a motion."""
        read = self._read(run.output.states)
        ranges = np.ptp(read, axis=0)
        least = _LEAST_RANGE * max(ranges.max(initial=0.0), np.abs(read).max(initial=0.0))
        self._ranges = np.maximum(ranges, least) if least > 0.0 else np.ones(len(ranges))

    def of_window(self, fine: Output, coarse: Output, state: State, other: State) -> float:
        """Return the largest difference within a window and in free motion after it."""
        places = (self._places * (state.a - other.a)).sum(axis=2)
        after = np.abs(places + (self._speeds * (state.v - other.v)).sum(axis=2)) / self._ranges
        return max(self._largest(fine.states - coarse.states), float(after.max(initial=0.0)))

    def between(self, fine: Integration, coarse: Integration) -> float:
        """Return the largest difference of two whole motions."""
        self.set_ranges(fine)
        return self._largest(fine.output.states - coarse.output.states)

    def _largest(self, states: Array) -> float:
        return float((np.abs(self._read(states)) / self._ranges).max(initial=0.0))

    def _read(self, states: Array) -> Array:
        # BLAS is not used, since its last bits depend on addresses in memory.
        return np.asarray(np.einsum("ti,ri->tr", states, self._rows))


def _copy(state: State) -> State:
    return State(*(array.copy() for array in state))


def _windows(motion: Motion, length: int) -> Iterator[tuple[int, int]]:
    """Yield the first and the last output index of each window."""
    for first in range(0, motion.outputs, length):
        yield first, min(first + length, motion.outputs)


def _power_of_two(number: float, least: int, most: int) -> int:
    """Return the power of two nearest to a number on a logarithmic scale, within limits."""
    power: int = 2 ** round(float(np.log2(max(number, 1.0))))
    return min(max(power, least), most)


def simulate(
    system: GapSystem,
    duration: float,
    output_step: float = 1.0e-3,
    position: npt.ArrayLike = (),
    velocity: npt.ArrayLike = (),
    integrator: Integrator | None = None,
) -> Trajectory:
    """Return the motion of a system from its initial state.

    >>> motion = simulate(ball, duration=1.0, position=[0.5])
    >>> print(f"{motion.first_contact:.3f} s")
    0.319 s

    Args:
        system, duration, output_step, position, velocity: arguments of the :class:`Motion`.
        integrator: integrator, :class:`AdaptiveStep` unless given.

    Raises:
        ValueError: an argument is invalid.
        NumericsError: the motion cannot be computed.
    """
    a, v = (np.asarray(state, dtype=np.float64) for state in (position, velocity))
    return (integrator or AdaptiveStep())(Motion(system, duration, output_step, a, v))
