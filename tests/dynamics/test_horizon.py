# SPDX-License-Identifier: LGPL-3.0-or-later
"""Impacts end the predictability of a motion; a linear system has no horizon."""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pytest

from dynamics.integrator import AdaptiveStep, FixedStep, Integrator
from dynamics.motion import Motion
from dynamics.predictability.ensemble import integrate_ensemble, vary_motion
from dynamics.predictability.horizon import (
    EARLY,
    Growth,
    Horizons,
    ensemble_horizons,
    horizon,
    measure_horizons,
)
from dynamics.trajectory import Trajectory
from tests.dynamics.two_stops import CHAOTIC, LINEAR


def test_spread_of_a_linear_system_is_in_proportion_to_the_change() -> None:
    """Reference: analytic. All outputs of a linear system from rest scale with the load."""
    for relative in (1e-9, 1e-6, 1e-3):
        ensemble = integrate_ensemble(Motion(LINEAR, 30.0, 1e-2), 8, relative, 2, "load")
        tip, changes = ensemble["tip"].values, ensemble["change"].values
        expected = 0.5 * np.ptp(changes) * np.abs(tip[0])
        np.testing.assert_allclose(
            0.5 * np.ptp(tip, axis=0), expected, rtol=1e-4, atol=1e-14 + 1e-9 * expected.max()
        )
        assert np.isnan(ensemble_horizons(ensemble)).all()


def test_a_linear_system_has_no_horizon() -> None:
    found = measure_horizons(Motion(LINEAR, 30.0, 1e-2), [1e-12, 1e-6], "load")
    assert np.isnan(found.times).all()
    assert np.isnan([found.growth[0].rate, found.step_change]).all()
    assert found.limits == ["nothing", "nothing"]


@dataclass(frozen=True)
class Counted:
    """Steps whose runs are counted."""

    way: Integrator
    runs: list[Motion]

    def __call__(
        self, motion: Motion, progress: Callable[[float], None] | None = None
    ) -> Trajectory:
        self.runs.append(motion)
        return self.way(motion, progress)

    def like(self, trajectory: Trajectory) -> Self:
        return replace(self, way=self.way.like(trajectory))

    def finer(self) -> Self:
        return replace(self, way=self.way.finer())


def test_stops_when_it_is_known() -> None:
    """Reference: by hand, the numbers of runs: 4 besides the motion of the linear system, 3 for
    each change of the chaotic one; within a quarter the finer step alone has parted."""
    sizes = [1e-12, 1e-10, 1e-8, 1e-6]
    for system, begun, ended in ((LINEAR, 1 + 3, 1 + 3), (CHAOTIC, 1 + 4 * 3, 4 * 3)):
        motion = Motion(system, 20.0, 1e-2)
        counted = Counted(FixedStep(1e-3), [])
        unchanged = counted.way(motion)
        found = measure_horizons(motion, sizes, "load", integrator=counted, unchanged=unchanged)
        durations = [run.duration for run in counted.runs]
        assert (durations.count(5.0), durations.count(20.0)) == (begun, ended)
        assert (found.of_step <= 5.0).all() == (system is CHAOTIC)
        again = measure_horizons(motion, sizes, "load", integrator=counted)
        assert len(counted.runs) == 2 * (begun + ended) + 1
        np.testing.assert_array_equal(found.times, again.times)
        np.testing.assert_array_equal(found.of_step, again.of_step)


def test_early_divergence_ends_the_run() -> None:
    """Reference: other code, all members over the whole duration."""
    motion, sizes = Motion(CHAOTIC, 20.0, 1e-2), [1e-8, 1e-6]
    way = FixedStep(1e-3)
    found = measure_horizons(motion, sizes, "load", 1, way)
    tips = [
        way(vary_motion(motion, "load", 1.0 + size)).data["tip"].values for size in (0.0, *sizes)
    ]
    time = 1e-2 * np.arange(tips[0].size)
    expected = [
        [horizon(np.array([tips[0], tip]), time, share) for share in (EARLY, 0.01)]
        for tip in tips[1:]
    ]
    assert np.max(expected) < 20.0
    np.testing.assert_array_equal(found.times, expected)


def test_horizon_of_a_known_growth() -> None:
    """Reference: analytic. ±1e-6 exp(2t) passes 1 % of the range of 2 at ln(2e4)/2, and 20 % at
    ln(4e5)/2."""
    time = np.linspace(0.0, 10.0, 10_001)
    apart = 1e-6 * np.exp(2.0 * time)
    members = np.sin(10.0 * time) + np.array([0.0, 1.0, -1.0, 0.3])[:, None] * apart
    assert horizon(members, time, 0.01) == pytest.approx(0.5 * np.log(2e4), abs=2e-3)
    assert horizon(members, time, 0.20) == pytest.approx(0.5 * np.log(4e5), abs=2e-3)
    assert np.isnan(horizon(members[:, :4000], time[:4000], 0.01))


def test_growth_of_known_horizons() -> None:
    """Reference: analytic, the line itself; a horizon that is not known does not count."""
    relatives = np.array([1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
    times = (np.log(0.02) - np.log(relatives * 0.7)) / 3.0
    times[0] = np.nan
    growth = Growth.fit(relatives, times)
    assert growth.rate == pytest.approx(3.0, rel=1e-9)
    assert growth.start == pytest.approx(np.log(0.02 / 0.7) / 3.0, rel=1e-9)
    assert growth.scatter < 1e-12
    assert growth.change(times[2]) == pytest.approx(1e-8, rel=1e-9)
    # A horizon that a smaller change does not put off is no growth; one alone is no line.
    assert np.isnan(Growth.fit(relatives, np.arange(5.0)).rate)
    assert np.isnan(Growth.fit(relatives[:2], times[:2]).rate)


def test_chance_is_no_growth() -> None:
    """Reference: analytic. A slope of −0.01 s per size under a scatter of ±0.1 s is within twice
    its error, 0.1/√(5·2); one of −0.1 s is not."""
    relatives = np.array([1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
    noise = 0.1 * np.array([1.0, -1.0, 0.0, -1.0, 1.0])
    flat, steep = (-slope * np.arange(5.0) + noise for slope in (0.01, 0.1))
    assert np.isnan(Growth.fit(relatives, flat).rate)
    assert Growth.fit(relatives, steep).rate == pytest.approx(np.log(100.0) / 0.1)


def test_smaller_changes_put_off_the_horizon_of_a_chaotic_system() -> None:
    """Reference: analytic in kind. T falls with ln ε, and λ is what the line says, from one
    partner a size as from seven."""
    rates = []
    for partners in (1, 7):
        found = measure_horizons(
            Motion(CHAOTIC, 40.0, 1e-2), [1e-6, 1e-12, 1e-8, 1e-10], "load", partners=partners
        )
        assert found.relatives.tolist() == [1e-12, 1e-10, 1e-8, 1e-6]
        times = found.times[:, 0]
        assert (np.diff(times) < -1.0).all()
        growth = found.growth[0]
        assert times[0] - times[-1] == pytest.approx(np.log(1e6) / growth.rate, rel=0.15)
        assert growth.scatter < 0.1 * (times[0] - times[-1])
        rates.append(growth.rate)
    assert rates[0] == pytest.approx(rates[1], rel=0.2)


@pytest.mark.parametrize("integrator", [FixedStep(1e-4), AdaptiveStep(1e-3)])
def test_a_finer_step_acts_as_a_change(integrator: Integrator) -> None:
    """Reference: other code path. Data changed by as much part from the run at the time at which
    the finer one does, within a tenth of it."""
    found = measure_horizons(
        Motion(CHAOTIC, 40.0, 1e-2), [1e-10, 1e-8, 1e-6], "load", integrator=integrator
    )
    assert 1e-10 < found.step_change < 1e-2
    alike = measure_horizons(
        Motion(CHAOTIC, 40.0, 1e-2), [found.step_change], "load", integrator=integrator
    )
    assert alike.times[0, 0] == pytest.approx(found.of_step[0], rel=0.1)


def test_says_whether_step_or_physics_limits() -> None:
    """The step's error changes a run more than 1e-12 of the load does, and less than 1e-2."""
    for relative, expected in ((1e-12, "step"), (1e-2, "physics")):
        found = measure_horizons(Motion(CHAOTIC, 20.0, 1e-2), [relative], "load", partners=1)
        assert found.limits[0] == expected
        assert (found.of_step[0] < found.times[0, 0]) == (expected == "step")


def test_growth_decides_where_chance_would() -> None:
    """Reference: by hand. The finer step passes the large share first by chance, and acts as 1e-9
    at the small one."""
    growth = Growth(rate=10.0, start=-1.0, scatter=0.0)
    found = Horizons(
        relatives=np.array([1e-12, 1e-6]),
        shares=np.array([1e-4, 0.01, 0.2]),
        times=np.array([[1.8, 2.0, np.nan], [0.4, 2.1, np.nan]]),
        of_step=np.array([1.0, 1.9, np.nan]),
        growth=[growth, Growth.fit(np.ones(1), np.ones(1)), Growth.fit(np.ones(1), np.ones(1))],
        step_change=growth.change(1.0),
    )
    assert found.step_change == pytest.approx(np.exp(-20.0))
    assert found.limits == ["physics", "physics", "nothing"]
    coarse = replace(found, step_change=1e-5)
    assert coarse.limits == ["step", "step", "nothing"]


def test_tells_its_progress() -> None:
    parts: list[float] = []
    measure_horizons(
        Motion(LINEAR, 1.0, 1e-2), [1e-9, 1e-6], "load", partners=1, progress=parts.append
    )
    assert parts == [0.125, 0.25, 0.375, 0.5, 1.0]
    parts.clear()
    measure_horizons(
        Motion(CHAOTIC, 20.0, 1e-2), [1e-9, 1e-6], "load", partners=1, progress=parts.append
    )
    assert np.all(np.diff(parts) >= 0.0)
    assert parts[-1] == 1.0


def test_insensitive_systems_are_refused() -> None:
    message = "the velocity is zero, so that no relative change moves it"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        measure_horizons(Motion(LINEAR, 1.0), [1e-9], "velocity")
