# SPDX-License-Identifier: LGPL-3.0-or-later
"""Friction and damping of the shipped lift and arm. Reference: conservation of energy."""

import numpy as np
import pytest

from protractile.cases import change, run_case
from runs.case.schema import DampingTable
from tests.runs.case_texts import shipped
from tests.runs.summaries import motion_of


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
