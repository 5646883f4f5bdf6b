# SPDX-License-Identifier: LGPL-3.0-or-later
"""By which steps the motions of a model are computed, and what is left where one cannot be."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from dynamics.integrators.integrator import Events, Splitting

from dynamics.contact import PowerContact
from dynamics.failure import StepTooLong
from dynamics.gap_system import GapSystem
from dynamics.motion import Motion
from dynamics.trajectory import Trajectory
from protractile.cases import change
from runs import CASES
from runs.case.reading import load
from runs.pipeline.answers import ModelAnswers
from runs.pipeline.means import Means
from runs.pipeline.motion import Plan
from runs.pipeline.run import Run, run_case


def bouncing() -> Motion:
    """A ball of 1 kg on a floor of 1e6 N/m."""
    floor, one = PowerContact(1e6, 1.0, clearance=0.0).lower(), np.ones(1)
    system = GapSystem(0.0 * one, -9.81 * one, one[None], [floor], np.array([0]), [0.0], {})
    return Motion(system, 1.0)


def up_to(step: float) -> Callable[[Plan], float]:
    """Computes a step, where it is short enough."""

    def compute(plan: Plan) -> float:
        assert isinstance(plan.integrator, Splitting)
        if plan.integrator.step > step:
            raise StepTooLong(f"{plan.integrator.step} s is too long")
        return plan.integrator.step

    return compute


def test_a_step_is_halved_twice_at_most() -> None:
    """Reference: by hand."""
    plan = Plan(bouncing(), Splitting(1.0))
    assert plan.halved(up_to(1.0)) == (1.0, [])
    refused = ["1.0 s is too long", "0.5 s is too long"]
    assert plan.halved(up_to(0.3)) == (0.25, refused)
    with pytest.raises(StepTooLong, match=r"^0.25 s is too long$"):
        plan.halved(up_to(0.2))


def short(name: str, model: str, **values: object) -> Run:
    """The run of one model, without answers."""
    case = change(load(str(CASES / name)), **values)
    models = tuple(one for one in case.models if one.name == model)
    run = run_case(case.model_copy(update={"models": models}), "", Means())
    assert run is not None
    return run


def answers(run: Run) -> ModelAnswers:
    run.answer()
    (own,) = run.results.summary.answers.models.values()
    return own


PULLED = {"joint.drive.time": 0.02, "time.duration": 0.03, "joint.play": 0.0}


@pytest.mark.parametrize(
    ("name", "model", "values", "motions"),
    [
        ("coarse.toml", "kantorovich-4", {"time.duration": 0.03}, 1),
        ("drawn-out.toml", "kantorovich-5", PULLED, 2),
    ],
)
def test_all_motions_of_a_model_take_the_step_of_the_case(
    name: str,
    model: str,
    values: dict[str, object],
    motions: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Reference: the case. Without play, and standing where a drive begins and ends."""
    run = short(name, model, **values, **{"time.step": 4.0e-5})
    steps: list[float] = []
    move = Splitting.__call__

    def note(way: Splitting, motion: Motion, progress: None = None) -> Trajectory:
        steps.append(way.step)
        return move(way, motion, progress)

    monkeypatch.setattr(Splitting, "__call__", note)
    answers(run)
    assert steps == motions * [4.0e-5]


def test_what_rests_without_play_is_told_where_it_cannot_move(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Reference: the same where it moves."""
    run = short("coarse.toml", "kantorovich-4", **{"time.duration": 0.03})
    whole = answers(run)

    def fail(way: Events, motion: Motion, progress: None = None) -> Trajectory:
        raise StepTooLong("it is not accounted for")

    monkeypatch.setattr(Events, "__call__", fail)
    left = answers(run)
    assert whole.tied_moved is not None
    assert left.tied_moved is None
    assert left.tied == whole.tied != []
    assert left.tied_modes == whole.tied_modes != []
