# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motions with fixed and with adaptive steps, their tolerance, and compiled loops."""

import os
import pickle
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import Excitation, Sine
from protractile.dynamics.gap_system import Observer
from protractile.dynamics.integrator import AdaptiveStep, FixedStep, Integrator, StepSchedule
from protractile.dynamics.kernels import march
from protractile.dynamics.motion import MOST_STEPS, Motion
from protractile.runs.pipeline.models import MotionPlan
from tests.dynamics.reference import CHAOTIC, LINEAR, RATTLING, two_modes
from tests.dynamics.test_time_step import driven, lossy_press, pressed, sliding, telescoping
from tests.modal import one_mass, oscillator

MOTION = Motion(CHAOTIC, 2.0, 1e-2, np.array([0.01, 0.0]), np.array([0.5, -1.0]))
EVERY: list[Integrator] = [FixedStep(1e-3), AdaptiveStep(1e-2), StepSchedule((4, 16, 2), 30)]


@pytest.mark.parametrize("integrator", EVERY, ids=str)
def test_the_steps_of_a_run_can_be_made_again(integrator: Integrator) -> None:
    """Reference: other code path, a chaotic motion to the last bit. The progress is reported."""
    parts: list[float] = []
    run = pickle.loads(pickle.dumps(integrator))(MOTION, parts.append)
    again = integrator.like(run)(MOTION)
    np.testing.assert_array_equal(run.states, again.states)
    for name in ("contact_force", "contact_force_peak", "work"):
        np.testing.assert_array_equal(run.data[name], again.data[name])
    assert again.data.attrs["steps"] == run.data.attrs["steps"]
    assert parts == sorted(parts)
    assert parts[-1] == 1.0


def unjoined(motion: Motion) -> Motion:
    """Return the motion with a dashpot of 0 N·s/m, so that no steps are joined."""
    system = motion.system
    return replace(motion, system=replace(system, dashpots=np.zeros((1, system.num_modes))))


def test_a_schedule_makes_its_steps() -> None:
    """Reference: by hand. Two windows of 30 outputs have 4 and 16 steps each, later ones 2."""
    run = StepSchedule((4, 16, 2), 30)(unjoined(MOTION))
    assert run.data.attrs["steps"] == 30 * 4 + 30 * 16 + 140 * 2
    assert run.data.attrs["step"] == pytest.approx(1e-2 / 16.0)
    assert StepSchedule((4, 1), 30).finer() == StepSchedule((8, 2), 30)
    assert FixedStep(0.2).finer() == FixedStep(0.1)
    assert AdaptiveStep(1e-3).finer() == AdaptiveStep(2.5e-4)
    assert AdaptiveStep().like(run) == StepSchedule((4, 16, 2), 30)


def test_the_step_fits_the_output() -> None:
    """Reference: by hand. 0.1 s has four steps; the duration is a whole number of outputs."""
    motion = Motion(one_mass(1.0, spring=1.0), 1.04, output_step=0.1)
    run = FixedStep(0.03)(unjoined(motion))
    assert run.time[-1] == pytest.approx(1.0, rel=1e-15)
    assert run.data.attrs["step"] == pytest.approx(0.025, rel=1e-12)
    assert run.data.attrs["steps"] == 40
    assert FixedStep(0.03)(motion).data.attrs["steps"] == 10


def test_steps_without_contact_are_joined() -> None:
    """Reference: other code path, single steps, to round-off until chaos amplifies it."""
    for step in (1e-2 / 64.0, 1e-2 / 96.0):
        motion = replace(MOTION, duration=0.5)
        joined, single = FixedStep(step)(motion), FixedStep(step)(unjoined(motion))
        assert joined.data.attrs["contact_changes"] == single.data.attrs["contact_changes"] > 10
        assert joined.states == pytest.approx(single.states, abs=1e-9 * np.abs(single.states).max())
        assert joined.first_contact == pytest.approx(single.first_contact, rel=1e-12)
        for name in ("contact_force", "contact_force_peak"):
            largest = float(np.abs(single.data[name]).max())
            assert joined.data[name].values == pytest.approx(
                single.data[name].values, abs=1e-6 * largest
            )
        assert joined.energy_residual < 1e-12
        assert joined.data.attrs["steps"] < 0.6 * single.data.attrs["steps"]


@pytest.mark.parametrize("integrator", EVERY[::2], ids=str)
def test_a_shorter_motion_is_the_beginning_of_a_longer_one(integrator: Integrator) -> None:
    """Reference: other code path, to the last bit."""
    some, whole = (integrator(replace(MOTION, duration=time)) for time in (0.7, 2.0))
    for name in ("tip", "contact_force", "contact_force_peak", "kinetic_energy"):
        np.testing.assert_array_equal(some.data[name], whole.data[name][: some.time.size])


# The way has a range of a thousand times that of the tip.
ROWS = {"tip": np.array([1.0, 0.7, -0.4, 0.0]), "way": np.eye(4)[3]}
SEEN = replace(sliding().system, observers={name: Observer(row) for name, row in ROWS.items()})
REGULAR = {
    "pressed": pressed(2.0), "losses": lossy_press(), "sliding": replace(sliding(), system=SEEN),
    "telescoping": telescoping(), "driven": driven(), "one blow": Motion(two_modes(), 0.6, 0.02),
    "linear": Motion(LINEAR, 3.0, 0.01),
}  # fmt: skip


@pytest.mark.parametrize("what", REGULAR)
def test_a_regular_motion_keeps_its_tolerance(what: str) -> None:
    """Reference: a tenth of the step. The reported error of each deflection is near its error."""
    motion, tolerance = replace(REGULAR[what], output_step=5e-3), 2e-4
    run = AdaptiveStep(tolerance)(motion)
    substeps = run.data.attrs["substeps"]
    fine = StepSchedule(tuple(10 * n for n in substeps), run.data.attrs["window"])(motion)
    seen = list(motion.system.observers)
    error = max(
        float(np.abs(run.data[name] - fine.data[name]).max() / np.ptp(fine.data[name].values))
        for name in seen
    )
    assert error < tolerance
    assert run.data.attrs["step_error"] < 1.01 * tolerance
    assert error < 2.0 * run.data.attrs["step_error"] + 1e-9


@pytest.mark.parametrize(
    ("motion", "fraction"),
    [(Motion(CHAOTIC, 40.0, 1e-2), 1.1), (Motion(RATTLING, 4.0, 1e-2), 0.2)],
    ids=["chaotic", "rattling"],
)
def test_chaos_ends_the_refinement(motion: Motion, fraction: float) -> None:
    """Reference: by hand, a fraction of the maximum number of steps. The largest impact is
    resolved, energy is conserved, and the error is reported.
    """
    run = AdaptiveStep()(motion)
    assert run.data.attrs["steps"] <= fraction * MOST_STEPS
    assert run.data.attrs["resolving_step"] == np.inf
    assert run.data.attrs["step_error"] > 1e-3
    assert run.energy_residual < 1e-9


def test_fast_loads_are_sampled() -> None:
    """Reference: analytic. h times 2π · 300 Hz is at most ½, although the tip hardly reacts."""
    push = Excitation(np.array([1.0]), Sine(300.0))
    system = replace(one_mass(1.0, spring=4.0, force=3.0), excitations=[push])
    run = AdaptiveStep(0.1)(Motion(system, 1.0, 1e-2))
    assert run.data.attrs["step"] * 2.0 * np.pi * 300.0 < 0.5


def test_mean_forces_of_two_steps_do_not_alternate() -> None:
    """Reference: analytic, the weight. With 32 rad per step on a stiff floor, forces of single
    steps oscillate about their mean, and means of pairs do not.
    """
    system = one_mass(1.0, PowerContact(1.0e9, 1.0).lower(), force=-1000.0)
    start = np.array([-1.0e-6]), np.array([-0.028])
    pairs, single = (FixedStep(1e-3)(Motion(system, 0.1, h, *start)) for h in (2e-3, 1e-3))
    assert np.ptp(single.data["contact_force"].values[1:, 0]) > 80.0
    assert pairs.data["contact_force"].values[1:, 0] == pytest.approx(-1000.0, abs=4.0)
    assert AdaptiveStep(0.5)(Motion(system, 0.1, 1e-3, *start)).data.attrs["steps"] >= 200


@pytest.mark.parametrize(
    ("stiffness", "exponent", "speed"), [(1e8, 1.0, 0.3), (1e12, 2.0, 0.77), (1e15, 3.0, 0.45)]
)
def test_unresolved_peak_is_marked(stiffness: float, exponent: float, speed: float) -> None:
    """Reference: analytic, k pⁿ with ½ m v² = k pⁿ⁺¹/(n + 1), and a step of ½ √(m/F′(p))."""
    depth = ((exponent + 1.0) * 0.5 * speed**2 / stiffness) ** (1.0 / (exponent + 1.0))
    force, slope = stiffness * depth**exponent, exponent * stiffness * depth ** (exponent - 1.0)
    system = one_mass(2.0, PowerContact(stiffness, exponent).with_clearance(1e-3))
    motion = Motion(system, 0.02, 1e-3, velocity=np.array([speed]))
    coarse = FixedStep(1e-3)(motion)
    told = coarse.data.attrs["resolving_step"]
    assert told == pytest.approx(0.5 * np.sqrt(2.0 / slope), rel=0.02)
    fine = FixedStep(told)(motion)
    assert fine.data.attrs["resolving_step"] == np.inf
    peaks = [float(np.abs(run.data["contact_force_peak"]).max()) for run in (coarse, fine)]
    assert peaks[0] < 0.5 * force
    assert peaks[1] == pytest.approx(force, rel=0.05)


def test_only_the_first_compilation_is_announced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Reference: by construction, numba's folder of the real loop without and with its file."""
    plan = MotionPlan(Motion(oscillator(), 1.0, 0.1), FixedStep(0.1), None)
    plan.integrator(plan.motion)
    (compiled, *_) = Path(march.march.stats.cache_path).glob("march.march-*.nbc")
    loop = SimpleNamespace(signatures=[], stats=SimpleNamespace(cache_path=str(tmp_path)))
    monkeypatch.setattr("protractile.dynamics.kernels.march.march", loop)
    plan.warm()
    assert caplog.messages == [
        f"compiling the time loop (half a minute), for later runs too, into {tmp_path}"
    ]
    (tmp_path / compiled.name).touch()
    plan.warm()
    assert len(caplog.messages) == 1


def test_large_first_differences_are_no_chaos() -> None:
    """Reference: other code path, a fixed step. Motions in which the first steps compared differ by
    2 to 10 % of the range converge, since few impacts have amplified the error.
    """
    motion = Motion(CHAOTIC, 5.0, 1e-2)
    tip, data = FixedStep(5e-6)(motion).data["tip"], AdaptiveStep(1e-3)(motion).data
    error = float(np.abs(data["tip"] - tip).max() / np.ptp(tip.values))
    assert error <= data.attrs["step_error"] <= 1e-3


ROOT = Path(__file__).parents[2]


def cache_of(folder: Path, more: str = "", locked: bool = False, **environment: str) -> Path:
    """Return where dynamics that are installed in a folder keep their loops, by another process.

    ``more`` is text in a module of formulas. Nothing can be written to a ``locked`` installation.
    """
    place = folder / "protractile"
    no_cache = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "dynamics", place / "dynamics", ignore=no_cache)
    (place / "__init__.py").touch()
    with (place / "dynamics" / "contact.py").open("a", encoding="utf-8") as source:
        source.write(more)
    for package in place.glob("**/__init__.py") if locked else ():
        (package.parent / "__pycache__").touch()
    run = subprocess.run(
        [sys.executable, "-B", "-c", "from protractile.dynamics.kernels.march import march; "
         "print(march.stats.cache_path)"],
        cwd=folder, env=os.environ | environment | {"PYTHONPATH": str(folder)},
        capture_output=True, check=True, text=True,
    )  # fmt: skip
    assert not run.stderr
    return Path(run.stdout.strip())


@pytest.mark.slow
def test_installations_with_equal_sources_share_their_loops(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: by construction; one installation differs in a formula that loops inline. A file
    in place of a folder prevents writing, also for root.
    """
    cache, own = tmp_path / "cache", Path(march.march.stats.cache_path).name
    other = cache_of(tmp_path / "other", "# changed\n", NUMBA_CACHE_DIR=str(cache))
    assert other.parent == cache
    assert other.name != own
    (tmp_path / "tmp").mkdir()
    home = tmp_path / "home"
    home.touch()
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    nowhere = {"HOME": str(home), "XDG_CACHE_HOME": str(home), "TMPDIR": str(tmp_path / "tmp")}
    found = cache_of(tmp_path / "locked", locked=True, **nowhere)
    assert found.is_relative_to(tmp_path / "tmp")
    assert found.name == own
    assert list((tmp_path / "tmp").iterdir()) == []
