# SPDX-License-Identifier: LGPL-3.0-or-later
"""Members are what a single run of the changed system gives, on any number of cores."""

import os
import re
import subprocess
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import numpy as np
import pytest
import xarray as xr

from dynamics.excitation import Excitation, Sine
from dynamics.failure import NumericsError
from dynamics.integrator import AdaptiveStep, FixedStep, Integrator
from dynamics.motion import Motion
from dynamics.predictability.ensemble import (
    EnsembleMember,
    Vary,
    check_varied,
    integrate_ensemble,
    perturbations,
    run_members,
    vary_motion,
)
from tests.dynamics.two_stops import CHAOTIC, LINEAR

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
            laws=[law.law.behind(factor["clearance"] * law.above)],
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
    """Reference: by hand. 1.001 times 2 and 12 mm are 2.002 and 12.012 mm, and nothing stays so."""
    (law,) = CHAOTIC.laws
    sided = law.law.behind(above, 0.012)
    motion = Motion(replace(CHAOTIC, laws=[sided]), 1.0)
    check_varied(motion, "clearance")
    (found,) = vary_motion(motion, "clearance", 1.001).system.laws
    assert found.above == pytest.approx(expected, rel=1e-12)
    assert found.below == pytest.approx(0.012012, rel=1e-12)


def test_members_make_the_steps_of_the_first() -> None:
    """Reference: other code path, a single run of the changed system in those steps."""
    motion, adaptive = Motion(CHAOTIC, 2.0, 1e-2), AdaptiveStep(1e-2)
    ensemble = integrate_ensemble(motion, 2, 1e-3, 7, "load", adaptive)
    factor = 1.0 + float(ensemble["change"][1])
    same = adaptive.like(adaptive(motion))
    run = same(Motion(replace(CHAOTIC, load=factor * CHAOTIC.load), 2.0, 1e-2))
    np.testing.assert_array_equal(ensemble["tip"][1], run.data["tip"])
    assert ensemble.attrs["integrator"] == "AdaptiveStep(tolerance=0.01)"


@pytest.mark.parametrize("integrator", [FixedStep(1e-3), AdaptiveStep(1e-2)])
def test_other_processes_give_the_same(integrator: Integrator) -> None:
    """Chaotic: a last digit that differed would show."""
    found = []
    with ProcessPoolExecutor(1, get_context("spawn")) as processes:
        assert processes.submit(os.getpid).result() != os.getpid()
        for executor in (None, processes):
            found.append(
                integrate_ensemble(
                    Motion(CHAOTIC, 20.0, 1e-2, velocity=THROWN),
                    5, 1e-6, 3, "load", integrator, executor,
                )
            )  # fmt: skip
    xr.testing.assert_identical(*found)


OTHER_RANK = """
import os
from mpi4py import MPI
from mpi4py.futures import MPICommExecutor
from dynamics.integrator import AdaptiveStep, FixedStep, Integrator
from dynamics.motion import Motion
from dynamics.predictability.ensemble import integrate_ensemble
from tests.dynamics.two_stops import CHAOTIC

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
    """Chaotic: a last digit that differed would show."""
    pytest.importorskip("mpi4py", reason="ranks need mpi4py")
    answer = two_ranks(OTHER_RANK)
    assert (answer.returncode, answer.stdout.split()) == (0, ["identical"]), answer.stderr


def test_keeps_labels_and_nothing_more() -> None:
    ensemble = integrate_ensemble(Motion(CHAOTIC, 1.0, 1e-2), 4, 1e-6, 1, "load")
    assert dict(ensemble.sizes) == {"member": 4, "time": 101, "station": 1}
    assert set(ensemble.data_vars) == {"tip", "contact_force", "energy_residual"}
    assert ensemble["contact_force"].dims == ("member", "time", "station")
    units = [ensemble[name].attrs["units"] for name in ("tip", "contact_force", "time")]
    assert units == ["m", "N", "s"]
    assert set(ensemble.attrs) == {"vary", "relative", "seed", "integrator", "step"}
    assert ensemble.attrs["integrator"] == "AdaptiveStep(tolerance=0.001)"


def test_changes_are_uniform_and_spare_member_0() -> None:
    """Reference: analytic. A uniform law within ±ε has the mean 0 and the deviation ε/√3."""
    changes = perturbations(10_001, 1e-3, 5)
    assert changes[0] == 0.0
    assert np.abs(changes).max() < 1e-3
    assert changes[1:].mean() == pytest.approx(0.0, abs=3e-5)
    assert changes[1:].std() == pytest.approx(1e-3 / np.sqrt(3.0), rel=0.02)


def test_the_same_seed_gives_the_same_on_any_number_of_cores(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Chaotic: a last digit that differed would show."""
    found = []
    for cores in ({0}, {0, 1, 2, 3, 4}):
        monkeypatch.setattr(os, "sched_getaffinity", lambda _, cores=cores: cores)
        found.append(integrate_ensemble(Motion(CHAOTIC, 20.0, 1e-2), 9, 1e-6, 3, "load"))
    xr.testing.assert_identical(*found)
    other = integrate_ensemble(Motion(CHAOTIC, 20.0, 1e-2), 9, 1e-6, 4, "load")
    assert not np.array_equal(other["tip"], found[0]["tip"])


def test_completed_motion_serves_as_member_0() -> None:
    """Chaotic: a last digit that differed would show."""
    motion, way = Motion(CHAOTIC, 20.0, 1e-2), FixedStep(1e-3)
    found = [
        integrate_ensemble(motion, 3, 1e-6, 3, "load", way, unchanged=unchanged)
        for unchanged in (None, way(motion))
    ]
    xr.testing.assert_identical(*found)


def test_tells_its_progress() -> None:
    parts: list[float] = []
    integrate_ensemble(Motion(LINEAR, 1.0, 1e-2), 4, 1e-6, 1, "load", progress=parts.append)
    assert parts == [1.0 / 3.0, 2.0 / 3.0, 1.0]


def test_failing_member_ends_the_ensemble() -> None:
    tipping = replace(LINEAR, omega2=np.array([-1e6, 31.0]))
    message = "the motion is not finite after 2 s"
    with pytest.raises(NumericsError, match=f"^{message}$"):
        integrate_ensemble(Motion(tipping, 2.0, 0.1), 4, 1e-6, 1, "load", FixedStep(0.1))


@pytest.mark.parametrize(
    ("members", "relative", "vary", "message"),
    [
        (1, 1e-9, "load", "an ensemble must have at least 2 members, got 1"),
        (8, 0.0, "load", "relative must be between 0 and 1, got 0"),
        (8, float("nan"), "load", "relative must be between 0 and 1, got nan"),
        (8, 1e-9, "velocity", "the velocity is zero, so that no relative change moves it"),
        (8, 1e-9, "clearance", "the clearance is zero, so that no relative change moves it"),
    ],
)
def test_bad_ensembles_are_refused(members: int, relative: float, vary: Vary, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        integrate_ensemble(Motion(LINEAR, 1.0), members, relative, 1, vary)


@pytest.mark.parametrize("part", [0.25, 0.7])
def test_shortened_run_equals_the_start_of_the_whole_run(part: float) -> None:
    """Reference: the whole run."""
    motion = Motion(CHAOTIC, 2.0, 1e-2)
    whole = EnsembleMember(motion, "load", 0.0, FixedStep(1e-3), ("gap", "contact_force"))
    some, all_ = run_members([whole.shortened(part), whole])
    assert some.sizes["time"] == 1 + round(part * whole.motion.outputs)
    for name in whole.variables:
        assert np.array_equal(some[name], all_[name][: some.sizes["time"]]), name
