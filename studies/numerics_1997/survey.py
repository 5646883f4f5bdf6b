# SPDX-License-Identifier: LGPL-3.0-or-later
"""Survey of the numerical methods of 1997 that reproduce the statements S3, S7, S8 and S10.

:mod:`.runs.paper.rules` defines the measures. The modal technique integrates beam elements and the
series. A general solver with at most 2000 steps also integrates the series.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.integrate import LSODA, RK45

from protractile.dynamics.arrays import Array
from protractile.dynamics.gap_system import GapSystem
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.paper.rules import ELEMENT_STEPS, INTERVAL, MOST, SERIES_STEPS
from studies.cost.generic_solvers import array_rates
from studies.numerics_1997.samples import (
    MEMBERS,
    PAPER_STEP,
    SERIES,
    Example,
    Numerics,
    Sample,
    all_numerics,
)

METHODS = {"LSODA": LSODA, "RK45": RK45}
# Deflection in m that ends the integration: half the boom's length.
LARGEST_TIP = 10.0


class Solved(NamedTuple):
    """Motion by a general solver up to its last step."""

    time: Array  #: (num_steps + 1,) in s
    #: (num_steps + 1, num_modes).
    states: Array
    velocities: Array


def solve(system: GapSystem, duration: float, method: str, tolerance: float, most: int) -> Solved:
    """Integrate a system from rest until ``duration`` in s, with ``most`` steps at most.

    Loads are constant, without damping. The tolerance is relative, and absolute in the units of a
    and ȧ.
    """
    start = np.zeros(2 * system.num_modes)
    within = {"rtol": tolerance, "atol": tolerance}
    solver = METHODS[method](array_rates(system), 0.0, start, duration, **within)
    time, states = [0.0], [start]
    tip = system.observers["tip"].row
    while solver.status == "running" and len(time) <= most:
        solver.step()
        time.append(solver.t)
        states.append(solver.y.copy())
        if not abs(tip @ solver.y[: tip.size]) < LARGEST_TIP:
            break
    whole = np.array(states)
    return Solved(np.array(time), *np.split(whole, 2, axis=1))


WITHOUT, WITH = CASES / "paper.toml", CASES / "paper-friction.toml"

# Tolerances of the general solver, from rough to fine.
TOLERANCES = (1.0e-2, 1.0e-3, 1.0e-4, 1.0e-6, 1.0e-8)
# Interval in s around 7 s, when the beam elements of the paper with friction diverged.
ABOUT = 1.0


# Method and tolerance of a general solver, a model of ``SERIES``, and whether it has friction.
Way = tuple[str, float, str, bool]


class Outcome(NamedTuple):
    """Results for one statement by numerical methods of 1997."""

    shown: bool  #: whether most runs with some numerics show it
    why: str  #: which, and in how many runs


@dataclass(frozen=True)
class Survey:
    """All runs of both examples."""

    #: The examples.
    without: Example
    with_friction: Example
    #: Samples of both examples, by numerical method.
    free: Mapping[Numerics, Sequence[Sample]]
    frictional: Mapping[Numerics, Sequence[Sample]]
    #: By the general solver in the steps that the paper allows the series, in s.
    reached: Mapping[Way, float]

    @classmethod
    def of(cls, progress: Callable[[str], None]) -> Survey:
        """Run all numerical methods on both examples."""
        progress("both examples solved accurately")
        free, frictional = (case_file.load(str(path)) for path in (WITHOUT, WITH))
        without, with_friction = Example.of(free, MEMBERS), Example.of(frictional, 1)
        progress("the general solver")
        reached = reach(without, False) | reach(with_friction, True)
        progress("without friction")
        of_free = {how: without.samples(how) for how in all_numerics()}
        progress("with friction")
        of_rubbed = {how: with_friction.samples(how) for how in all_numerics()}
        return cls(without, with_friction, of_free, of_rubbed, reached)

    @cached_property
    def outcomes(self) -> dict[str, Outcome]:
        """The results for each statement."""
        free, frictional = (
            named(self.without, self.free),
            named(self.with_friction, self.frictional),
        )
        return {
            "S3": _most(free, lambda one: one.conforms_then_diverges(self.without.cutoff)),
            "S7": _most(frictional, Sample.stratifies),
            "S8": self._s8(),
            "S10": self._s10(),
        }

    def _s8(self) -> Outcome:
        at_the_step = {
            how: found for how, found in self.frictional.items() if how.step == PAPER_STEP
        }
        found = _most({str(how): found for how, found in at_the_step.items()}, diverges_near_7_s)
        breaks = {
            how: sorted(
                one.elements.divergence_time
                for one in found
                if one.elements.divergence_time < np.inf
            )
            for how, found in at_the_step.items()
        }
        how = max(breaks, key=lambda how: max(breaks[how], default=0.0))
        if not breaks[how]:
            return Outcome(found.shown, f"{found.why}; energy breaks out in none")
        part = f"{len(breaks[how])} of {len(at_the_step[how])} runs"
        when = f"at {breaks[how][0]:.1f} to {breaks[how][-1]:.1f} s"
        return Outcome(found.shown, f"{found.why}; by {how} energy breaks out in {part}, {when}")

    def _s10(self) -> Outcome:
        way = max((way for way in self.reached if not way[-1]), key=self.reached.__getitem__)
        (method, tolerance, *_), farthest = way, self.reached[way]
        reach = (
            f"{SERIES_STEPS} steps of a general solver reach {farthest:.2g} s of the "
            f"{INTERVAL:g} s at most, by {method} at a tolerance of {tolerance:g}"
        )
        stand = {
            round(INTERVAL / how.step)
            for how, found in self.free.items()
            if share(one.elements.divergence_time > INTERVAL for one in found) >= MOST
        }
        fewest = f"elements stand in {min(stand)} steps" if stand else "no elements stand so long"
        shown = farthest >= INTERVAL and bool(stand) and min(stand) > ELEMENT_STEPS
        return Outcome(shown, f"{reach}; {fewest}")


def named(
    example: Example, samples: Mapping[Numerics, Sequence[Sample]]
) -> dict[str, Sequence[Sample]]:
    """Return the samples by name of the method, also those with accurate motions of the series."""
    return {str(how): found for how, found in samples.items()} | {
        f"{how}, the series solved accurately": example.with_accurate_series(found)
        for how, found in samples.items()
    }


def diverges_near_7_s(sample: Sample) -> bool:
    """Return whether the elements diverge at about 7 s, as in the paper (S8)."""
    return abs(sample.elements.divergence_time - INTERVAL) <= ABOUT


def reach(example: Example, friction: bool) -> dict[Way, float]:
    """Return the time in s that the general solver reaches, for each tolerance and series."""
    return {
        (method, tolerance, model, friction): float(
            solve(example.systems[model], INTERVAL, method, tolerance, SERIES_STEPS).time[-1]
        )
        for method, tolerance, model in product(METHODS, TOLERANCES, SERIES)
    }


def share(shows: Iterable[bool]) -> float:
    """Return the fraction of results that reproduce a statement."""
    return float(np.mean(list(shows)))


def _most(samples: Mapping[str, Sequence[Sample]], shows: Callable[[Sample], bool]) -> Outcome:
    """Return the results of the numerical method that reproduces a statement most often."""
    shares = {how: share(map(shows, found)) for how, found in samples.items()}
    best = max(shares, key=lambda how: shares[how])
    often = f"in {100.0 * shares[best]:.0f} % of runs"
    if shares[best] == 0.0:
        return Outcome(False, f"in no run of {len(shares)} numerics")
    if shares[best] < MOST:
        return Outcome(False, f"{often} at most, by {best}")
    return Outcome(True, f"{often} by {best}")
