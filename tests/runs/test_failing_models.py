# SPDX-License-Identifier: LGPL-3.0-or-later
"""Failing models without effect on others, and reuse of finished results."""

import json
from pathlib import Path
from threading import Event, current_thread, main_thread
from time import sleep
from types import SimpleNamespace
from typing import Any

import pytest

from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.trajectory import Trajectory
from protractile.runs.folder.cache import VARIABLE
from protractile.runs.paper.rules import judge
from protractile.runs.pipeline import run
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.models import MotionPlan
from protractile.runs.pipeline.results import Results
from tests.runs.case_texts import COARSE
from tests.system.run_folder import protractile

pytestmark = pytest.mark.usefixtures("few_figures", "unprinted")

RUN = "run", "case.toml", "--models", "kantorovich-4,kantorovich-5", "--out", "out"
# Of kantorovich-4, which would take days.
TOO_SHORT = "1e-12"
WHY = "a step of 1e-12 s makes 3e+11 steps; make it longer"


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.setenv(VARIABLE, str(tmp_path / "cache"))


def write_case(step: str) -> None:
    base = 'base = "as printed"'
    text = COARSE.replace("duration = 0.6", "duration = 0.3")
    Path("case.toml").write_text(text.replace(base, f"{base}\nstep = {step}", 1), "utf-8")


@pytest.fixture
def moved(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Return a list of the numbers of modes of integrated systems with play."""
    modes: list[int] = []
    move = MotionPlan.trajectory

    def count(plan: MotionPlan, progress: Any = None) -> Trajectory:
        if plan.motion.system.laws:
            modes.append(plan.motion.system.num_modes)
        return move(plan, progress)

    monkeypatch.setattr(MotionPlan, "trajectory", count)
    return modes


def test_other_models_are_written_and_the_failure_is_reported(
    capsys: pytest.CaptureFixture[str],
) -> None:
    write_case(TOO_SHORT)
    assert protractile(*RUN, "--large") == 3
    out, err = capsys.readouterr()
    assert err == f"protractile: case.toml: model[1]: {WHY}\n"
    assert f"failed: kantorovich-4: {WHY}" in out
    results = Results.load(Path("out"))
    assert results.trajectories["model"].values.tolist() == ["kantorovich-5"]
    first = judge(results)[0]
    assert (first.id, first.verdict) == ("S1", "undecided")
    assert first.why == f"'kantorovich-4' failed: {WHY}."
    page = Path("out/report.html").read_text(encoding="utf-8")
    assert ">failed</td>" in page
    assert protractile("report", "out") == 0


def test_the_next_run_goes_on(moved: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    """The first run is interrupted in its second model. Reference: an uninterrupted run."""
    write_case("1e-4")
    assert protractile(*RUN, "--no-cache") == 0
    undisturbed = Path("out/trajectories.nc").read_bytes()
    assert moved == [4, 5]
    move = MotionPlan.trajectory

    def break_off(plan: MotionPlan, progress: Any = None) -> Trajectory:
        if plan.motion.system.num_modes == 5:
            raise OSError("broken off")
        return move(plan, progress)

    with monkeypatch.context() as patch:
        patch.setattr(MotionPlan, "trajectory", break_off)
        assert protractile(*RUN) == 2
    assert protractile(*RUN) == 0
    assert moved == [4, 5, 4, 5]
    assert Path("out/trajectories.nc").read_bytes() == undisturbed
    assert protractile(*RUN, "--no-cache") == 0
    assert moved == [4, 5, 4, 5, 4, 5]


def test_wall_times_are_this_run_s_but_for_the_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    write_case("1e-4")

    def seconds() -> dict[str, float]:
        assert protractile(*RUN) == 0
        models = json.loads(Path("out/summary.json").read_text(encoding="utf-8"))["models"]
        found: dict[str, float] = models["kantorovich-4"]["seconds"]
        return found

    first = seconds()

    def build(*arguments: Any) -> GapSystem:
        sleep(0.2 + first["build"])
        return gap_system(*arguments)

    monkeypatch.setattr("protractile.runs.case.kinds.model.gap_system", build)
    second = seconds()
    assert second["motion"] == first["motion"]
    assert second["build"] > 0.2 + first["build"]


def test_another_case_is_another_motion(moved: list[int]) -> None:
    write_case("1e-4")
    assert protractile(*RUN) == 0
    text = Path("case.toml").read_text("utf-8").replace("load = 55.07", "load = 55.08")
    Path("case.toml").write_text(text, "utf-8")
    assert protractile(*RUN) == 0
    assert moved == [4, 5, 4, 5]


def test_beams_move_beside_shells_and_fail_for_themselves() -> None:
    """Reference: by hand. The main thread makes the shell, as PETSc requires."""
    beam, lost, shell = (
        SimpleNamespace(name=name, needs_shell=name == "shell")
        for name in ("beam", "lost", "shell")
    )
    at_work = Event()

    def move(model: Any) -> Any:
        if model is lost:
            return NumericsError("lost")
        # Each waits for the other one: both are at it at a time.
        if model is beam:
            assert at_work.wait(10.0)
        else:
            at_work.set()
        return model.name, current_thread() is main_thread()

    left = run._attempt_all((beam, lost, shell), move, RunContext())
    assert list(left) == ["beam", "lost", "shell"]
    assert left["beam"] == ("beam", False)
    assert left["shell"] == ("shell", True)
    assert str(left["lost"]) == "lost"
    assert run._attempt_all((beam, lost), move, RunContext())["beam"] == ("beam", True)


def test_interrupted_shell_waits_for_at_most_one_beam() -> None:
    """Reference: by hand. One beam is in motion, another one waits."""
    names = ("beam", "queued", "shell")
    models = [SimpleNamespace(name=name, needs_shell=name == "shell") for name in names]
    at_work, moved = Event(), []

    def move(model: Any) -> None:
        if model.needs_shell:
            assert at_work.wait(10.0)
            raise KeyboardInterrupt
        moved.append(model.name)
        at_work.set()
        sleep(0.2)

    with pytest.raises(KeyboardInterrupt):
        run._attempt_all(models, move, RunContext())
    assert moved == ["beam"]
