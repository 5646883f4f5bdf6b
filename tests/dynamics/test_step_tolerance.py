# SPDX-License-Identifier: LGPL-3.0-or-later
"""The adaptive step keeps its tolerance in every deflection of a motion with sticking."""

import numpy as np
import pytest

from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import load
from protractile.runs.pipeline.models import MotionPlan, build
from tests.dynamics.two_stops import CHAOTIC, RATTLING

CASE = """
title = "boom with constant friction"
time = { duration = 5.0, output_step = 1e-2 }
material = { youngs_modulus = 2.1e11, poissons_ratio = 0.3, density = 7850.0 }
model = [{ name = "series", kind = "kantorovich", terms = [4, 6] }]

[[segment]]
name = "outer"
span = [0.0, 10.0]
supports = [0.0, 2.0]
mass_per_length = 83.16
second_moment_of_area = 3.7986e-4
load = 83.16

[[segment]]
name = "inner"
span = [9.0, 19.0]
mass_per_length = 55.07
second_moment_of_area = 2.1829e-4
load = 55.07

[[joint]]
outer = "outer"
inner = "inner"
stations = [9.0, 10.0]
play = 0.028
stiffness = 1e13
exponent = 2.0
friction = 0.2
normal_forces = [4500.0, 5000.0]
"""


@pytest.mark.slow
def test_the_tolerance_holds_for_every_deflection(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Reference: other code path, a fixed step of 2e-6 s. The ranges of head and tail are a tenth
    of the tip's. The reported error is between the true error and five times this error.
    """
    path = tmp_path_factory.mktemp("case") / "case.toml"
    path.write_text(CASE)
    case = load(str(path))
    (model,) = case.models
    motion: Motion = MotionPlan.of(build(case, build_boom(case), model).system, case, model).motion
    exact = FixedStep(2.0e-6)(motion).data
    errors = []
    for tolerance in (1.0e-2, 1.0e-3):
        data = AdaptiveStep(tolerance)(motion).data
        of = {
            name: float(np.abs(data[name] - exact[name]).max() / np.ptp(exact[name].values))
            for name in motion.system.observers
        }
        assert set(of) == {"tip", "head", "tail"}
        errors.append(max(of.values()))
        assert errors[-1] <= data.attrs["step_error"] <= min(tolerance, 5.0 * errors[-1])
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "duration", "output_step", "step"),
    [(CHAOTIC, 5.0, 1e-2, 5e-6), (RATTLING, 0.3, 1e-3, 5e-7)],
    ids=["chaotic", "rattling"],
)
def test_large_first_differences_are_no_chaos(
    system: GapSystem, duration: float, output_step: float, step: float
) -> None:
    """Reference: other code path, a fixed step. Motions in which the first steps compared differ by
    2 to 10 % of the range converge, since few impacts have amplified the error.
    """
    motion = Motion(system, duration, output_step)
    tip, data = FixedStep(step)(motion).data["tip"], AdaptiveStep(1e-3)(motion).data
    error = float(np.abs(data["tip"] - tip).max() / np.ptp(tip.values))
    assert error <= data.attrs["step_error"] <= 1e-3
