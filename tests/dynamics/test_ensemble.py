# SPDX-License-Identifier: LGPL-3.0-or-later
"""Ensembles of changed systems, and horizons of predictability."""

import os
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from protractile.dynamics.excitation import Excitation, Sine
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.predictability import (
    EARLY,
    Growth,
    Horizons,
    Vary,
    check_varied,
    ensemble_horizons,
    horizon,
    integrate_ensemble,
    measure_horizons,
    perturbations,
    vary_motion,
)
from tests.at_once import AtOnce
from tests.dynamics.reference import CHAOTIC, LINEAR

THROWN = np.array([0.5, -1.0])


@pytest.mark.parametrize("vary", ["load", "clearance", "velocity"])
def test_a_member_is_a_run_of_the_changed_system(vary: Vary) -> None:
    """Reference: other code path, runs of systems changed by hand, with the steps of the first."""
    pushed, (law,) = Excitation(np.array([1.0, -2.0]), Sine(0.7)), CHAOTIC.laws
    start, way = {"position": np.array([0.01, 0.0]), "velocity": THROWN}, AdaptiveStep(1e-2)
    motion = Motion(replace(CHAOTIC, excitations=[pushed]), 2.0, 1e-2, **start)
    first = way(motion)
    ensemble = integrate_ensemble(motion, 3, 1e-3, 7, vary, integrator=way)
    completed = integrate_ensemble(motion, 3, 1e-3, 7, vary, integrator=way, unchanged=first)
    xr.testing.assert_identical(completed, ensemble)
    for member, change in enumerate(ensemble["change"].values):
        factor = {"load": 1.0, "clearance": 1.0, "velocity": 1.0, vary: 1.0 + change}
        system = replace(
            CHAOTIC,
            load=factor["load"] * CHAOTIC.load,
            laws=[law.law.with_clearance(factor["clearance"] * law.above)],
            excitations=[replace(pushed, load=factor["load"] * pushed.load)],
        )
        thrown = start | {"velocity": factor["velocity"] * THROWN}
        run = way.like(first)(Motion(system, 2.0, 1e-2, **thrown))
        one = ensemble.isel(member=member)
        for name in ("tip", "contact_force"):
            np.testing.assert_array_equal(one[name], run.data[name])
        assert float(one["energy_residual"]) == run.energy_residual
    assert np.ptp(ensemble["tip"].values, axis=0).max() > 1e-4


@pytest.mark.parametrize(("above", "expected"), [(0.002, 0.002002), (0.0, 0.0)])
def test_unequal_plays_vary_by_equal_fractions(above: float, expected: float) -> None:
    """Reference: by hand. 1.001 times 2 and 12 mm are 2.002 and 12.012 mm; zero plays stay zero."""
    (law,) = CHAOTIC.laws
    sided = law.law.with_clearance(above, 0.012)
    motion = Motion(replace(CHAOTIC, laws=[sided]), 1.0)
    check_varied(motion, "clearance")
    (found,) = vary_motion(motion, "clearance", 1.001).system.laws
    assert found.above == pytest.approx(expected, rel=1e-12)
    assert found.below == pytest.approx(0.012012, rel=1e-12)


def test_changes_are_uniform_and_spare_member_0() -> None:
    """Reference: analytic. Uniform within ±ε: the mean is 0, the deviation ε/√3."""
    changes = perturbations(10_001, 1e-3, 5)
    assert changes[0] == 0.0
    assert np.abs(changes).max() < 1e-3
    assert changes[1:].mean() == pytest.approx(0.0, abs=3e-5)
    assert changes[1:].std() == pytest.approx(1e-3 / np.sqrt(3.0), rel=0.02)


def test_the_same_seed_gives_same_on_any_number_of_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: other code path. Chaos would amplify any difference of bits."""
    found = []
    for cores in ({0}, {0, 1, 2, 3, 4}):
        monkeypatch.setattr(os, "sched_getaffinity", lambda _, cores=cores: cores)
        found.append(integrate_ensemble(Motion(CHAOTIC, 10.0, 1e-2), 6, 1e-6, 3, "load"))
    xr.testing.assert_identical(*found)
    executor = AtOnce()  # as of several ranks
    apart = integrate_ensemble(Motion(CHAOTIC, 10.0, 1e-2), 6, 1e-6, 3, "load", executor=executor)
    xr.testing.assert_identical(apart, found[0])
    other = integrate_ensemble(Motion(CHAOTIC, 10.0, 1e-2), 6, 1e-6, 4, "load")
    assert not np.array_equal(other["tip"], found[0]["tip"])


def test_failing_member_ends_the_ensemble() -> None:
    tipping = replace(LINEAR, omega2=np.array([-1e6, 31.0]))
    message = "the motion is not finite after 2 s"
    with pytest.raises(NumericsError, match=f"^{message}$"):
        integrate_ensemble(Motion(tipping, 2.0, 0.1), 4, 1e-6, 1, "load", FixedStep(0.1))


def test_spread_of_a_linear_system_is_in_proportion_to_the_change() -> None:
    """Reference: analytic. All outputs of a linear system from rest scale with the load, and it has
    no horizon.
    """
    for relative in (1e-9, 1e-3):
        ensemble = integrate_ensemble(Motion(LINEAR, 30.0, 1e-2), 8, relative, 2, "load")
        tip, changes = ensemble["tip"].values, ensemble["change"].values
        expected = 0.5 * np.ptp(changes) * np.abs(tip[0])
        np.testing.assert_allclose(
            0.5 * np.ptp(tip, axis=0), expected, rtol=1e-4, atol=1e-14 + 1e-9 * expected.max()
        )
        assert np.isnan(ensemble_horizons(ensemble)).all()
    found = measure_horizons(Motion(LINEAR, 30.0, 1e-2), [1e-12, 1e-6], "load")
    assert np.isnan([*found.times.ravel(), found.growth[0].rate, found.step_change]).all()
    assert found.limits == ["nothing", "nothing"]


def test_early_divergence_ends_the_run() -> None:
    """Reference: other code, all members over the whole duration."""
    motion, sizes = Motion(CHAOTIC, 20.0, 1e-2), [1e-8, 1e-6]
    way = FixedStep(1e-3)
    parts: list[float] = []
    found = measure_horizons(motion, sizes, "load", 1, way, progress=parts.append)
    assert np.all(np.diff(parts) >= 0.0)
    assert parts[-1] == 1.0
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
    """Reference: analytic. ±1e-6 exp(2t) exceeds 1 % of 2 at ln(2e4)/2, 20 % at ln(4e5)/2."""
    time = np.linspace(0.0, 10.0, 10_001)
    apart = 1e-6 * np.exp(2.0 * time)
    members = np.sin(10.0 * time) + np.array([0.0, 1.0, -1.0, 0.3])[:, None] * apart
    assert 0.0 < horizon(members, time, 0.01) - 0.5 * np.log(2e4) < 1e-3
    assert 0.0 < horizon(members, time, 0.20) - 0.5 * np.log(4e5) < 1e-3
    assert np.isnan(horizon(members[:, :4000], time[:4000], 0.01))


def test_growth_of_known_horizons() -> None:
    """Reference: analytic, the given line. Unknown horizons do not count. With a scatter of ±0.1 s,
    a slope of −0.01 s per size is within twice its error, 0.1/√(5·2); a slope of −0.1 s is not.
    """
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
    noise = 0.1 * np.array([1.0, -1.0, 0.0, -1.0, 1.0])
    flat, steep = (-slope * np.arange(5.0) + noise for slope in (0.01, 0.1))
    assert np.isnan(Growth.fit(relatives, flat).rate)
    assert Growth.fit(relatives, steep).rate == pytest.approx(np.log(100.0) / 0.1)


def test_smaller_changes_put_off_the_horizon_of_a_chaotic_system() -> None:
    """Reference: analytic. T falls with ln ε at the rate λ, with one partner or three."""
    rates, motion = [], Motion(CHAOTIC, 25.0, 1e-2)
    for partners in (1, 3):
        found = measure_horizons(motion, [1e-6, 1e-12, 1e-8, 1e-10], "load", partners=partners)
        assert found.relatives.tolist() == [1e-12, 1e-10, 1e-8, 1e-6]
        times = found.times[:, 0]
        assert (np.diff(times) < -1.0).all()
        growth = found.growth[0]
        assert growth.scatter < 0.1 * (times[0] - times[-1])
        rates.append(growth.rate)
    assert rates[0] == pytest.approx(rates[1], rel=0.05)


def test_a_finer_step_acts_as_a_change() -> None:
    """Reference: other code path. Data with the equivalent change diverge from the run at the same
    time as the finer step, within the time in which a difference doubles. A change ten times as
    large diverges earlier by more than three times this.
    """
    motion, sizes = Motion(CHAOTIC, 20.0, 1e-2), [1e-10, 1e-9, 1e-8, 1e-7, 1e-6]
    found = measure_horizons(motion, sizes, "load", integrator=AdaptiveStep(1e-3))
    assert 1e-10 < found.step_change < 1e-2
    alike = measure_horizons(motion, [found.step_change], "load", integrator=AdaptiveStep(1e-3))
    doubling = np.log(2.0) / found.growth[0].rate
    assert alike.times[0, 0] == pytest.approx(found.of_step[0], abs=doubling)


def test_growth_decides_instead_of_chance() -> None:
    """Reference: by hand. The finer step is the first to reach the large share by chance. At the
    small share it is equivalent to 1e-9.
    """
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
