# SPDX-License-Identifier: LGPL-3.0-or-later
"""Ensembles of changed systems, and horizons of predictability."""

import os
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pytest
import xarray as xr

from protractile.dynamics.excitation import Excitation, Sine
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.integrator import AdaptiveStep, FixedStep, Integrator
from protractile.dynamics.motion import Motion
from protractile.dynamics.predictability import (
    EARLY,
    EnsembleMember,
    Growth,
    Horizons,
    Vary,
    check_varied,
    ensemble_horizons,
    horizon,
    integrate_ensemble,
    measure_horizons,
    perturbations,
    run_members,
    vary_motion,
)
from protractile.dynamics.trajectory import Trajectory
from tests.dynamics.reference import CHAOTIC, LINEAR

THROWN = np.array([0.5, -1.0])


@pytest.mark.parametrize("vary", ["load", "clearance", "velocity"])
def test_a_member_is_a_run_of_the_changed_system(vary: Vary) -> None:
    """Reference: other code path, single runs of systems changed by hand."""
    ensemble = integrate_ensemble(
        Motion(CHAOTIC, 5.0, 1e-2, velocity=THROWN), 3, 1e-3, 7, vary, integrator=FixedStep(1e-3)
    )
    for member, change in enumerate(ensemble["change"].values):
        factor = {"load": 1.0, "clearance": 1.0, "velocity": 1.0, vary: 1.0 + change}
        (law,) = CHAOTIC.laws
        system = replace(
            CHAOTIC,
            load=factor["load"] * CHAOTIC.load,
            laws=[law.law.with_clearance(factor["clearance"] * law.above)],
        )
        run = FixedStep(1e-3)(Motion(system, 5.0, 1e-2, velocity=factor["velocity"] * THROWN))
        one = ensemble.isel(member=member)
        for name in ("tip", "contact_force"):
            np.testing.assert_array_equal(one[name], run.data[name])
        assert float(one["energy_residual"]) == run.energy_residual
    assert np.ptp(ensemble["tip"].values, axis=0).max() > 1e-4


def test_all_loads_vary_and_nothing_else() -> None:
    """Reference: other code path, a single run of the system changed by hand."""
    pushed = Excitation(np.array([1.0, -2.0]), Sine(0.7))
    system = replace(CHAOTIC, excitations=[pushed])
    start = {"position": np.array([0.01, 0.0]), "velocity": THROWN}
    ensemble = integrate_ensemble(
        Motion(system, 2.0, 1e-2, **start), 2, 1e-3, 7, "load", integrator=FixedStep(1e-3)
    )
    factor = 1.0 + float(ensemble["change"][1])
    louder = replace(pushed, load=factor * pushed.load)
    alone = replace(system, load=factor * system.load, excitations=[louder])
    run = FixedStep(1e-3)(Motion(alone, 2.0, 1e-2, **start))
    np.testing.assert_array_equal(ensemble["tip"][1], run.data["tip"])
    unloaded = replace(system, load=0.0 * system.load)
    spread = integrate_ensemble(Motion(unloaded, 2.0, 1e-2), 2, 1e-3, 7, "load")["tip"]
    assert np.ptp(spread.values, axis=0).max() > 1e-6


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


def test_members_make_the_steps_of_the_first() -> None:
    """Reference: other code path, a single run of the changed system with the same steps."""
    motion, adaptive = Motion(CHAOTIC, 2.0, 1e-2), AdaptiveStep(1e-2)
    ensemble = integrate_ensemble(motion, 2, 1e-3, 7, "load", adaptive)
    factor = 1.0 + float(ensemble["change"][1])
    same = adaptive.like(adaptive(motion))
    run = same(Motion(replace(CHAOTIC, load=factor * CHAOTIC.load), 2.0, 1e-2))
    np.testing.assert_array_equal(ensemble["tip"][1], run.data["tip"])
    assert ensemble.attrs["integrator"] == "AdaptiveStep(tolerance=0.01)"


OTHER_RANK = """
import os
from mpi4py import MPI
from mpi4py.futures import MPICommExecutor
from protractile.dynamics.integrator import AdaptiveStep, FixedStep, Integrator
from protractile.dynamics.motion import Motion
from protractile.dynamics.predictability import integrate_ensemble
from tests.dynamics.reference import CHAOTIC

with MPICommExecutor(MPI.COMM_WORLD, root=0) as ranks:
    if ranks is not None:
        assert ranks.submit(os.getpid).result() != os.getpid()
        one, two = (
            integrate_ensemble(Motion(CHAOTIC, 20.0, 1e-2), 5, 1e-6, 3, "load", executor=executor)
            for executor in (None, ranks)
        )
        print("identical" if one.identical(two) else "different")
"""


def test_another_rank_gives_the_same(
    two_ranks: Callable[..., subprocess.CompletedProcess[str]],
) -> None:
    """Reference: other code path. Chaos would amplify any difference of bits."""
    pytest.importorskip("mpi4py", reason="ranks need mpi4py")
    answer = two_ranks(OTHER_RANK)
    assert (answer.returncode, answer.stdout.split()) == (0, ["identical"]), answer.stderr


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
        found.append(integrate_ensemble(Motion(CHAOTIC, 20.0, 1e-2), 9, 1e-6, 3, "load"))
    xr.testing.assert_identical(*found)
    other = integrate_ensemble(Motion(CHAOTIC, 20.0, 1e-2), 9, 1e-6, 4, "load")
    assert not np.array_equal(other["tip"], found[0]["tip"])


def test_completed_motion_serves_as_member_0() -> None:
    """Reference: other code path. Chaos would amplify any difference of bits."""
    motion, way = Motion(CHAOTIC, 20.0, 1e-2), FixedStep(1e-3)
    found = [
        integrate_ensemble(motion, 3, 1e-6, 3, "load", way, unchanged=unchanged)
        for unchanged in (None, way(motion))
    ]
    xr.testing.assert_identical(*found)


def test_failing_member_ends_the_ensemble() -> None:
    tipping = replace(LINEAR, omega2=np.array([-1e6, 31.0]))
    message = "the motion is not finite after 2 s"
    with pytest.raises(NumericsError, match=f"^{message}$"):
        integrate_ensemble(Motion(tipping, 2.0, 0.1), 4, 1e-6, 1, "load", FixedStep(0.1))


@pytest.mark.parametrize("part", [0.25, 0.7])
def test_shortened_run_equals_the_start_of_the_whole_run(part: float) -> None:
    """Reference: the whole run."""
    motion = Motion(CHAOTIC, 2.0, 1e-2)
    whole = EnsembleMember(motion, "load", 0.0, FixedStep(1e-3), ("gap", "contact_force"))
    some, all_ = run_members([whole.shorten(part), whole])
    assert some.sizes["time"] == 1 + round(part * whole.motion.outputs)
    for name in whole.variables:
        assert np.array_equal(some[name], all_[name][: some.sizes["time"]]), name


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
    """Integrator that counts its runs."""

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


def test_runs_stop_at_known_horizons() -> None:
    """Reference: by hand, the numbers of runs. The linear system needs 4 besides its motion, the
    chaotic system 3 for each change. Within a quarter of the run only the finer step diverges.
    """
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
    """Reference: analytic. ±1e-6 exp(2t) exceeds 1 % of 2 at ln(2e4)/2, 20 % at ln(4e5)/2."""
    time = np.linspace(0.0, 10.0, 10_001)
    apart = 1e-6 * np.exp(2.0 * time)
    members = np.sin(10.0 * time) + np.array([0.0, 1.0, -1.0, 0.3])[:, None] * apart
    assert horizon(members, time, 0.01) == pytest.approx(0.5 * np.log(2e4), abs=2e-3)
    assert horizon(members, time, 0.20) == pytest.approx(0.5 * np.log(4e5), abs=2e-3)
    assert np.isnan(horizon(members[:, :4000], time[:4000], 0.01))


def test_growth_of_known_horizons() -> None:
    """Reference: analytic, the given line. Unknown horizons do not count."""
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
    """Reference: analytic. With a scatter of ±0.1 s, a slope of −0.01 s per size is within twice
    its error, 0.1/√(5·2); a slope of −0.1 s is not.
    """
    relatives = np.array([1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
    noise = 0.1 * np.array([1.0, -1.0, 0.0, -1.0, 1.0])
    flat, steep = (-slope * np.arange(5.0) + noise for slope in (0.01, 0.1))
    assert np.isnan(Growth.fit(relatives, flat).rate)
    assert Growth.fit(relatives, steep).rate == pytest.approx(np.log(100.0) / 0.1)


def test_smaller_changes_put_off_the_horizon_of_a_chaotic_system() -> None:
    """Reference: analytic. T falls with ln ε at the rate λ, with one partner or seven."""
    rates = []
    for partners in (1, 7):
        found = measure_horizons(
            Motion(CHAOTIC, 40.0, 1e-2), [1e-6, 1e-12, 1e-8, 1e-10], "load", partners=partners
        )
        assert found.relatives.tolist() == [1e-12, 1e-10, 1e-8, 1e-6]
        times = found.times[:, 0]
        assert (np.diff(times) < -1.0).all()
        growth = found.growth[0]
        assert growth.scatter < 0.1 * (times[0] - times[-1])
        rates.append(growth.rate)
    assert rates[0] == pytest.approx(rates[1], rel=0.05)


@pytest.mark.parametrize("integrator", [FixedStep(1e-4), AdaptiveStep(1e-3)])
def test_a_finer_step_acts_as_a_change(integrator: Integrator) -> None:
    """Reference: other code path. Data with the equivalent change diverge from the run at the same
    time as the finer step, within the time in which a difference doubles. A change ten times as
    large diverges earlier by more than three times this.
    """
    motion, sizes = Motion(CHAOTIC, 20.0, 1e-2), [1e-10, 1e-9, 1e-8, 1e-7, 1e-6]
    found = measure_horizons(motion, sizes, "load", integrator=integrator)
    assert 1e-10 < found.step_change < 1e-2
    alike = measure_horizons(motion, [found.step_change], "load", integrator=integrator)
    doubling = np.log(2.0) / found.growth[0].rate
    assert alike.times[0, 0] == pytest.approx(found.of_step[0], abs=doubling)


def test_says_whether_step_or_physics_limits() -> None:
    """The error of the step exceeds the effect of 1e-12 of the load, and 1e-2 exceeds it."""
    for relative, expected in ((1e-12, "step"), (1e-2, "physics")):
        found = measure_horizons(Motion(CHAOTIC, 20.0, 1e-2), [relative], "load", partners=1)
        assert found.limits[0] == expected
        assert (found.of_step[0] < found.times[0, 0]) == (expected == "step")


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


def test_progress_of_horizons_is_reported() -> None:
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
