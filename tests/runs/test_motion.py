# SPDX-License-Identifier: LGPL-3.0-or-later
"""Time steps, damping and friction of the motions of a model, and results if a motion fails."""

import numpy as np
import pytest

from protractile.analysis.rows import MOTION, REST, Row, Rows
from protractile.cases import change, run_case
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.trajectory import Trajectory
from protractile.runs.case.reading import select
from protractile.runs.case.schema import DampingTable
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import Run
from protractile.runs.pipeline.run import run_case as run_models
from tests.runs.case_texts import shipped
from tests.runs.summaries import motion_of


def short(name: str, model: str, **values: object) -> Run:
    return run_models(change(select(shipped(name), "", [model]), **values), "", RunContext())


def answers(run: Run) -> Rows:
    run.evaluate()
    return run.results.rows


PULLED = {"joint.drive.time": 0.02, "time.duration": 0.03, "joint.play": 0.0}


@pytest.mark.parametrize(
    ("name", "model", "values", "motions"),
    [
        ("coarse", "kantorovich-4", {"time.duration": 0.03}, 1),
        ("drawn-out", "kantorovich-5", PULLED, 2),
    ],
)
def test_all_motions_of_a_model_take_the_step_of_the_case(
    name: str,
    model: str,
    values: dict[str, object],
    motions: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Reference: the case. Motions include those without play and at a drive's extremes."""
    run = short(name, model, **values, **{"time.step": 4.0e-5})
    steps: list[float] = []
    move = FixedStep.__call__

    def note(way: FixedStep, motion: Motion, progress: None = None) -> Trajectory:
        steps.append(way.step)
        return move(way, motion, progress)

    monkeypatch.setattr(FixedStep, "__call__", note)
    answers(run)
    assert steps == motions * [4.0e-5]


def test_bonded_rest_is_known_without_a_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: the same static state after a motion."""
    run = short("coarse", "kantorovich-4", **{"time.duration": 0.03})
    whole = answers(run)

    def fail(way: AdaptiveStep, motion: Motion, progress: None = None) -> Trajectory:
        raise NumericsError("it does not converge")

    monkeypatch.setattr(AdaptiveStep, "__call__", fail)
    left = answers(run)
    assert whole.where(play=False, state=MOTION)
    assert not left.where(play=False, state=MOTION)
    assert left.where(play=False) == tuple(
        row for row in whole.where(play=False) if row.state != MOTION
    )
    assert left.where(play=False, quantity="tip")
    assert left.where(play=False, quantity="frequency")


@pytest.mark.parametrize(("at_rest", "factor"), [(2.0, 1.5), (1e-4, None), (None, None)])
def test_factor_needs_a_static_value_of_some_size(
    at_rest: float | None, factor: float | None
) -> None:
    """Reference: by hand; a torque of round-off at rest gives no factor of 30000."""
    moved = Row("beam", MOTION, True, "support_torque", "base", "at 0 m", -3.0)
    rest = [] if at_rest is None else [moved._replace(state=REST, value=at_rest)]
    other = moved._replace(state=REST, place="at 2 m", value=5.0)
    assert Rows([moved, *rest, other]).dynamic_factor(moved) == factor


@pytest.mark.parametrize("damping", [{"modal": 0.015}, {"stiffness": 3e-4}], ids=str)
@pytest.mark.parametrize("name", ["lift", "inspection-arm"])
def test_a_pressed_boom_keeps_its_ledger(name: str, damping: dict[str, float]) -> None:
    case = change(shipped(name), **{"time.duration": 0.5, "time.output_step": 0.01})
    run = motion_of(case.model_copy(update={"damping": DampingTable(**damping)}), 1)
    assert run.energy_residual < 1e-4
    loss = np.diff(run.data["damping_loss"].values)
    assert loss.min() >= 0.0
    assert loss.sum() > 0.0


@pytest.mark.parametrize("friction", [0.05, 0.15])
def test_arm_with_friction_moves_in_a_gust(friction: float) -> None:
    """Reference: analytic, the balance of energy; steps of half the length, to 1 % of the range."""
    joint = {"joint.friction": friction, "joint.lateral_play": 0.002}
    case = change(shipped("inspection-arm"), **joint, **{"time.duration": 1.6})
    beam = case.models[1]
    steps = {"coarse": 1e-3, "fine": 5e-4}
    models = (beam.model_copy(update={"name": one, "step": step}) for one, step in steps.items())
    nothing = dict.fromkeys(("load_cases", "combinations", "spectra"), ())
    results = run_case(case.model_copy(update=nothing | {"models": tuple(models)}))
    coarse, fine = (results.trajectories["tip_lateral"].sel(model=one).values for one in steps)
    assert float(np.abs(coarse - fine).max()) < 0.01 * float(np.ptp(fine))
    for model in results.summary.models.values():
        assert model.energy_residual < 1e-10


def test_results_are_shown_as_soon_as_each_model_has_finished() -> None:
    """Reference: the results of the whole run, which are the same numbers."""
    case = change(
        select(shipped("coarse"), "", ["kantorovich-4", "kantorovich-5"]), **{"time.duration": 0.03}
    )
    shown: list[Results] = []
    run = run_models(case, "", RunContext(), shown.append)
    assert run is not None
    assert [[*results.summary.models] for results in shown] == [
        ["kantorovich-4"],
        ["kantorovich-4", "kantorovich-5"],
    ]
    run.evaluate_with_play()
    assert [*shown[-1].rows] == [*run.results.rows]
