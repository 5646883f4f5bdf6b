# SPDX-License-Identifier: LGPL-3.0-or-later
"""Energy balance of damped booms under their weight. Reference: conservation of energy."""

import numpy as np
import pytest

from protractile.cases import change
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
