# SPDX-License-Identifier: LGPL-3.0-or-later
"""Least squares against closed forms, and numbers identified from readings of other models."""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np
import pytest

from protractile.analysis.equilibria import equilibria
from protractile.analysis.states import States
from protractile.cases import change, load_case
from protractile.geometry.arrays import Array
from protractile.runs import CASES
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.schema import Case
from protractile.runs.measured.experiment import Computed, Experiment
from protractile.runs.measured.fit import CHI_SQUARE_95, fit, profile
from protractile.runs.measured.identify import identify, parse
from protractile.runs.measured.residuals import STEADY
from protractile.runs.pipeline.models import MotionPlan, build
from tests.runs.case_texts import refused
from tests.runs.test_measured import CANTILEVER

X = np.linspace(0.0, 1.0, 40)


def line(noise: Array) -> Any:
    return lambda p: (p[0] + p[1] * X - (2.0 + 3.0 * X + noise)) / 0.1


def test_standard_errors_and_profile_of_a_linear_model() -> None:
    """Reference: analytic. Regression line: σ/√S_xx, and σ √(1/n + x̄²/S_xx); their correlation."""
    noise = np.random.default_rng(3).normal(0.0, 0.05, X.size)
    found = fit(line(noise), [-9.0, -9.0], [9.0, 9.0], [0.0, 0.0], 3)
    spread = float(np.sum((X - X.mean()) ** 2))
    errors = [0.1 * np.sqrt(1.0 / X.size + X.mean() ** 2 / spread), 0.1 / np.sqrt(spread)]
    assert found.errors == pytest.approx(errors, rel=1.0e-6)
    correlation = -X.mean() / np.sqrt(np.mean(X**2))
    assert found.correlation == pytest.approx(np.array([[1, correlation], [correlation, 1]]))
    assert found.values[::-1] == pytest.approx(np.polyfit(X, 2.0 + 3.0 * X + noise, 1), abs=1e-6)
    assert found.agreeing == 3
    assert found.determined.all()
    assert not found.at_bound.any()
    bounded = fit(line(noise), [-9.0, -9.0], [9.0, 1.0], [0.0, 0.0])
    assert bounded.at_bound.tolist() == [False, True]
    # χ² grows by (distance/standard error)²; by 3.84 at 1.96 of them.
    values, increases = profile(line(noise), found, 1)
    expected = ((values - found.values[1]) / found.errors[1]) ** 2
    assert increases == pytest.approx(expected, abs=1.0e-4)
    assert pytest.approx(1.95996**2, rel=1.0e-4) == CHI_SQUARE_95
    # A model that misses the readings has errors with the factor √(χ²/(m − n)).
    found = fit(line(np.sign(np.sin(99.0 * X))), [-9.0, -9.0], [9.0, 9.0], [0.0, 0.0])
    plain = fit(line(np.zeros(X.size)), [-9.0, -9.0], [9.0, 9.0], [0.0, 0.0])
    assert found.misfit > 5.0
    assert found.errors == pytest.approx(found.misfit * plain.errors)


def test_unknowns_that_are_not_determined_are_marked() -> None:
    """Reference: by construction. Of two unknowns with the same effect none is determined."""

    def residuals(p: Array) -> Array:
        return (p[0] + p[1] + p[2] * X - 1.0 - X) / 0.1

    found = fit(residuals, [-9.0, -9.0, -9.0], [9.0, 9.0, 9.0], [0.0, 3.0, 0.0])
    assert found.determined.tolist() == [False, False, True]
    assert np.isinf(found.errors[:2]).all()
    assert found.values[2] == pytest.approx(1.0)
    assert np.isnan(found.correlation[0]).all()
    # A reading of the first one determines both.
    known = np.array([[18.0 / 0.1, 0.0, 0.0]])
    assert np.sqrt(np.diag(found.covariance_with(known)))[0] == pytest.approx(0.1, rel=1.0e-3)


def test_the_best_of_several_starts() -> None:
    """Reference: analytic. (x² − 4)² + 0.1 (x − 3)² has a second minimum near −2."""

    def residuals(p: Array) -> Array:
        return np.array([p[0] ** 2 - 4.0, np.sqrt(0.1) * (p[0] - 3.0)])

    assert fit(residuals, [-5.0], [5.0], [-2.0]).values[0] < 0.0
    best = fit(residuals, [-5.0], [5.0], [-2.0], 4)
    assert best.values[0] == pytest.approx(2.0, abs=0.02)
    assert best.agreeing < 4


# The numbers that only the twin knows.
TIMES = np.arange(0.0, 2.0, 0.02)
CLAMP = "segment[1].supports[1].rotation_stiffness"
TRUTH = {"joint.play": 0.0042, "damping.modal": 0.027, "payload.mass": 93.0, CLAMP: 1.6e7}
BOUNDS = {
    "joint.play": (0.0, 0.01), "damping.modal": (0.0, 0.08), "payload.mass": (50.0, 150.0),
    CLAMP: (0.8e7, 4.0e7),
}  # fmt: skip
BOOM: dict[str, Any] = {
    "title": "Boom with a twin", "time": {"duration": 2.0, "output_step": 0.01},
    "damping": {"modal": 0.02}, "gravity": {"angle": 10.0}, "payload": {"mass": 80.0},
    "start": {"state": "equilibrium"},
    "load": [{"segment": "fly", "x": "head", "magnitude": -400.0, "ramp": 0.05}],
    "material": {"youngs_modulus": 2.1e11, "poissons_ratio": 0.3, "density": 7850.0},
    "segment": [
        {"name": "base", "length": 5.0,
         "supports": [{"x": 0.0, "stiffness": 2.0e8, "rotation_stiffness": 2.0e7}],
         "section": {"height": 0.3, "width": 0.22, "flange": 0.006, "web": 0.005}},
        {"name": "fly", "length": 4.5,
         "section": {"height": 0.256, "width": 0.18, "flange": 0.005, "web": 0.004}},
    ],
    "joint": [
        {"outer": "base", "inner": "fly", "extension": 3.5, "stations": ["tail", "head"],
         "play": 0.003, "pad": {"length": 0.1, "width": 0.05, "thickness": 0.012}}
    ],
    "model": [
        {"name": "shell", "kind": "shell", "mesh_size": 0.15, "contact_tolerance": "any"},
        {"name": "calibrated", "kind": "finite-element", "theory": "timoshenko",
         "element_length": 0.5, "calibrated_by": "shell"},
        {"name": "series", "kind": "kantorovich", "terms": [10, 10], "base": "complete"},
    ],
}  # fmt: skip


def table(curve: Array, times: Array = TIMES) -> list[tuple[float, float]]:
    return [*zip(times.tolist(), curve.tolist(), strict=True)]


@pytest.mark.slow
def test_a_calibrated_beam_identifies_a_shell(tools: BuildContext) -> None:
    """Reference: by construction, readings of the shell. Noise 1 %, unknowns within 2 σ.

    The stiffness is that of the clamp's rotation: the calibration has that of the plates.
    """
    blank = {"uncertainty": 1.0, "table": table(0.0 * TIMES)}
    channels = [
        {"name": "tip", "quantity": "tip", **blank},
        {"name": "gauge", "quantity": "strain", "segment": "base", "x": 0.5, **blank},
    ]
    case = change(load_case({**BOOM, "measured": channels}), **TRUTH)
    boom, (shell, *_) = build_boom(case), case.models
    built = build(case, boom, shell, tools)
    loaded = shell.analysis_model(boom, built)
    plan = MotionPlan.of(built.system, case, shell)
    rest = States.of(loaded, equilibria(loaded.system))
    motions = [States.in_motion(loaded, plan.trajectory())]
    computed = Computed(plan.motion.system, rest, motions)
    rng = np.random.default_rng(0)
    for channel, keys in zip(case.measured, channels, strict=True):
        curve = computed.read(channel)[0]
        noise = 0.01 * float(np.ptp(curve))
        noisy = curve + rng.normal(0.0, noise, curve.size)
        keys |= {"uncertainty": noise, "systematic": 0.005, "table": table(noisy)}
    twin = load_case({**BOOM, "measured": channels})
    found = identify(twin, BOUNDS, "calibrated", starts=1).found
    assert found.determined.all()
    assert (np.abs(found.values - [*TRUTH.values()]) < 2.0 * found.errors).all()


def test_a_prediction_follows_the_covariance() -> None:
    """Reference: analytic. A weight that is known within 5 kg scatters the tip in proportion."""
    tip = {"name": "tip", "quantity": "tip", "value": -0.01, "uncertainty": 5.0e-4}
    found = identify(load_case({**CANTILEVER, "measured": [tip]}), {"payload.mass": (10.0, 900.0)})
    experiment = Experiment(found.case, "case")
    (deflection, predicted) = (
        float(experiment.evaluate({"payload.mass": mass})[0][1][0, 0])
        for mass in (100.0, found.case.payload.mass)
    )
    stiffness = 100.0 / -deflection
    assert found.frame.loc["payload.mass", "value"] == pytest.approx(0.01 * stiffness, rel=1e-4)
    assert found.frame.loc["payload.mass", "error"] == pytest.approx(5e-4 * stiffness, rel=1e-4)
    assert predicted == pytest.approx(-0.01, rel=1e-4)
    case_in_mm = found.case.model_copy(update={"shown_units": "mm-t-s"})
    in_mm = identify(case_in_mm, {"payload.mass": (0.01, 0.9)}).frame
    assert in_mm.loc["payload.mass", "value"] == pytest.approx(0.01e-3 * stiffness, rel=1e-4)


@pytest.mark.parametrize(
    ("unknown", "what"),
    [
        ({"payload.mass": (2.0, 1.0)},
         "--unknown payload.mass: must have a lower bound below the upper one, got 2 and 1"),
        ({"payload.weight": (1.0, 2.0)},
         "payload.weight: is not a number of the case; give 'payload.mass'"),
        ({"payload.gravity": (1.0, 2.0)},
         "payload.gravity: is not a number of the case; give it a value, from which the search "
         "starts"),
        ({"measured[2].time_offset": (0.0, 1.0)},
         "measured[2].time_offset: the case has no measured[2], its last one is measured[1]"),
        ({"damping.modal": (0.0, 2.0)},
         "--unknown damping.modal: 2 is not valid: must be a number less than 1, got 2"),
    ],
)  # fmt: skip
def test_senseless_unknowns_are_refused(unknown: dict[str, tuple[float, float]], what: str) -> None:
    tip = {"name": "tip", "quantity": "tip", "value": -0.01, "uncertainty": 5.0e-4}
    with refused(f"case: {what}"):
        identify(load_case({**CANTILEVER, "measured": [tip]}), unknown)


def test_a_senseless_option_is_refused() -> None:
    assert parse("joint.play = 0:0.03", "case.toml") == ("joint.play", (0.0, 0.03))
    what = "not understood; give KEY=LOW:HIGH, such as joint.play=0:0.03"
    with refused(f"case.toml: --unknown joint.play=0.03: {what}"):
        parse("joint.play=0.03", "case.toml")


@pytest.mark.slow
def test_accelerations_after_a_release_have_one_minimum() -> None:
    """Reference: by construction. Play in mm within 0.3 %, from 3 mm and bounds of 0 to 15 mm.

    Impacts make χ² rough: searches from the start and from a few random points end up to 5 mm from
    the true play, at misfits of 10.
    """
    play = 2.4
    times = np.arange(0.0, 0.2, 0.002)
    blank = {
        "name": "head", "quantity": "acceleration", "segment": "fly", "x": 8.4, "uncertainty": 1.0
    }  # fmt: skip

    def case_of(curve: Array, uncertainty: float = 1.0) -> Case:
        load = {"segment": "fly", "x": "head", "magnitude": -4000.0, "released": True}
        changed = {
            "time": {"duration": 0.2, "output_step": 0.002, "step": 1.0e-4},
            "load": [load],
            "payload": {"mass": 20.0},
            "model": [BOOM["model"][2] | {"terms": [4, 4]}],
            "measured": [blank | {"table": table(curve, times), "uncertainty": uncertainty}],
        }
        return load_case({**BOOM, **changed})

    experiment = Experiment(case_of(np.zeros(times.size)), "case")
    ((_, (curve, *_)),) = experiment.evaluate({"joint.play": 1.0e-3 * play})
    noise = 0.01 * float(np.ptp(curve))
    noisy = curve + np.random.default_rng(1).normal(0.0, noise, curve.size)
    found = identify(case_of(noisy, noise), {"joint.play": (0.0, 0.015)})
    assert found.found.values[0] == pytest.approx(1.0e-3 * play, rel=3.0e-3)
    assert found.found.misfit < 2.0


@pytest.mark.slow
def test_chaotic_motions_are_compared_by_their_features() -> None:
    """Reference: by construction. The paper's boom hits its play; 16.8 mm within two errors."""
    tables = tomllib.loads((CASES / "paper.toml").read_text("utf-8"))
    tables["time"] = {"duration": 8.0, "output_step": 0.01}
    times = np.arange(0.0, 8.0, 0.02)
    blank = {"name": "tip", "quantity": "tip", "uncertainty": 2.0e-3}

    def case_of(curve: Array) -> Case:
        return load_case({**tables, "measured": [{**blank, "table": table(curve, times)}]})

    experiment = Experiment(case_of(np.zeros(times.size)), "case", "kantorovich-5")
    ((_, (curve, *_)),) = experiment.evaluate({"joint.play": 0.0168})
    noisy = curve + np.random.default_rng(0).normal(0.0, 2.0e-3, curve.size)
    found = identify(case_of(noisy), {"joint.play": (0.004, 0.03)}, "kantorovich-5", starts=1)
    assert found.residuals.horizons[0] < 6.0
    assert found.found.residuals.size == STEADY
    play = found.frame.loc["joint.play"]
    assert abs(play["value"] - 0.0168) < 2.0 * play["error"] < 4.0e-4
    # Without features the fit would follow the motion beyond its predictable time.
    assert "unpredictable" in found.after.table().notes[1]
