# SPDX-License-Identifier: LGPL-3.0-or-later
"""Measured channels: keys and files, values by a model, comparison; identified numbers."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from protractile.cases import load_case, run_case
from protractile.geometry.arrays import Array
from protractile.runs import CASES
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.measured.compare import compare
from protractile.runs.measured.experiment import Experiment, free_travel
from protractile.runs.measured.fit import CHI_SQUARE_95, Fit, fit, profile
from protractile.runs.measured.identify import identify, parse
from protractile.runs.measured.residuals import STEADY, Features
from protractile.runs.process.bad_input import BadInput
from protractile.runs.report.additions import judge
from protractile.runs.report.document import render
from tests.runs.case_texts import refused

E, LENGTH, HEIGHT, WIDTH, WALL = 2.1e11, 5.0, 0.3, 0.2, 0.006
BASE: dict[str, Any] = {
    "name": "base", "length": LENGTH, "supports": [{"x": 0.0, "kind": "clamped"}],
    "section": {"height": HEIGHT, "width": WIDTH, "flange": WALL, "web": WALL},
}  # fmt: skip
CANTILEVER: dict[str, Any] = {
    "title": "Cantilever", "time": {"duration": 1.0, "output_step": 0.01},
    "material": {"youngs_modulus": E, "poissons_ratio": 0.3, "density": 7850.0},
    "start": {"state": "equilibrium"}, "payload": {"mass": 100.0}, "segment": [BASE],
    "model": [
        {"name": "beam", "kind": "finite-element", "theory": "euler-bernoulli",
         "element_length": 1.0, "rotary_inertia": False}
    ],
}  # fmt: skip
BOOM = CANTILEVER | {
    "title": "Boom",
    "segment": [
        BASE,
        {"name": "fly", "length": 4.0,
         "section": {"height": 0.25, "width": 0.15, "flange": 0.005, "web": 0.005}},
    ],
    "joint": [
        {"outer": "base", "inner": "fly", "extension": 3.0, "stations": ["tail", "head"],
         "play": 0.004, "stiffness": 1.0e9, "exponent": 1.0}
    ],
}  # fmt: skip


def pairs(curve: Array, times: Array) -> list[tuple[float, float]]:
    return [*zip(times.tolist(), curve.tolist(), strict=True)]


def channel(name: str, **keys: Any) -> dict[str, Any]:
    return {"name": name, "quantity": name, "uncertainty": 1.0e-3, **keys}


def measured(tables: dict[str, Any], *channels: dict[str, Any]) -> Case:
    return load_case({**tables, "measured": [*channels]})


def values(case: Case, **settings: float) -> list[float]:
    found = Experiment(case, "case").evaluate(settings)
    return [float(value) for _, several in found for value in several.ravel()]


def test_single_values_of_a_cantilever() -> None:
    """Reference: analytic. F L³/(3 E J) at the tip, M z/(E J) at a gauge, its opposite below.

    Without payload, 1.8751² √(E J/(m L⁴))/2π, and the given damping.
    """
    gauge = {"quantity": "strain", "segment": "base", "x": 1.0, "value": 0.0}
    case = measured(
        CANTILEVER,
        channel("tip", value=0.0),
        channel("top", **gauge),
        channel("bottom", side="bottom", **gauge),
        channel("more", quantity="tip", value=0.0, changes={"payload.mass": 300.0},
                since={"payload.mass": 100.0}),
    )  # fmt: skip
    (segment,) = build_boom(case).segments
    force, bending = 100.0 * 9.80665, E * segment.second_moment_of_area
    strain = force * (LENGTH - 1.0) * 0.5 * (HEIGHT + WALL) / bending
    tip = -force * LENGTH**3 / (3.0 * bending)
    assert values(case) == pytest.approx([tip, strain, -strain, 2.0 * tip], rel=1.0e-6)
    case = measured(
        {**CANTILEVER, "damping": {"modal": 0.03}, "payload": {"mass": 1.0e-6}},
        channel("frequency", value=0.0),
        channel("frequency-2", quantity="frequency", number=2, value=0.0),
        channel("damping_ratio", value=0.0),
    )
    speed = np.sqrt(bending / segment.mass_per_length) / LENGTH**2
    expected = [root**2 * speed / (2.0 * np.pi) for root in (1.875104, 4.694091)]
    assert values(case) == pytest.approx([*expected, 0.03], rel=1.0e-3)


@pytest.mark.parametrize("above", [None, 0.001])
def test_free_travel_is_that_of_rigid_segments(above: float | None) -> None:
    """Reference: analytic. The fly turns by play/overlap: p + 2 p a/l with its arm a beyond it.

    Play on one side only moves the range. The travel of elastic beams that are pushed up and down
    grows in proportion to the force, from this travel on. Travels of joints add up.
    """
    joint = BOOM["joint"][0] | ({} if above is None else {"play_above": above})
    case = measured({**BOOM, "joint": [joint]}, channel("free_travel", value=0.0))
    assert values(case) == pytest.approx([0.004 * (1.0 + 2.0 * 3.0 / 1.0)], rel=1.0e-9)
    pushed = {}
    for force in (-600.0, -300.0, 300.0, 600.0):
        loads = [{"segment": "fly", "x": "head", "magnitude": force}]
        light = {**BOOM, "payload": {"mass": 1.0e-6}, "joint": [joint], "load": loads}
        pushed[force] = values(measured(light, channel("tip", value=0.0)))[0]
    small, large = (pushed[force] - pushed[-force] for force in (300.0, 600.0))
    assert 2.0 * small - large == pytest.approx(values(case)[0], rel=1.0e-6)
    smaller = BOOM["segment"][1]["section"] | {"height": 0.2, "width": 0.1}
    third = BOOM["segment"][1] | {"name": "third", "section": smaller}
    joints = [joint, joint | {"outer": "fly", "inner": "third", "play": 0.002}]
    boom = build_boom(load_case({**BOOM, "segment": [*BOOM["segment"], third], "joint": joints}))
    expected = 0.004 * (1.0 + 2.0 * 6.0) + 0.002 * (1.0 + 2.0 * 3.0)
    assert free_travel(boom) == pytest.approx(expected, rel=1.0e-9)


def test_readings_over_time_have_gaps_units_and_offsets(here: Path) -> None:
    """Reference: by construction. A line without a reading is left out; others are read alike."""
    Path("log.csv").write_text(
        "time (ms),tip (mm),strain (um/m)\n0,1.0,10\n100,,20\n250,3.0,nan\n400,4.0,40\n"
    )
    gauge = {"quantity": "strain", "segment": "base", "x": 1.0}
    case = measured(
        CANTILEVER,
        channel("tip", file="log.csv", columns=["time", "tip"], time_offset=0.1),
        channel("gauge", file="log.csv", columns=["time", "strain"], **gauge),
    )
    experiment = Experiment(case, "case")
    tip, strain = experiment.channels
    assert tip.times == pytest.approx([0.1, 0.35, 0.5])
    assert tip.readings == pytest.approx([0.001, 0.003, 0.004])
    assert strain.readings == pytest.approx([1.0e-5, 2.0e-5, 4.0e-5])
    assert experiment.number("measured[1].time_offset") == (0.1, "s")
    shifted = experiment.changed({"measured.time_offset": 0.2}).measured
    assert [channel.time_offset for channel in shifted] == [0.2, 0.2]


TIMES = np.arange(0.0, 1.0, 0.01)


def swinging(**load: float) -> tuple[dict[str, Any], Any]:
    """Return the tables of a cantilever under a force, and its tip in m at ``TIMES``."""
    loads = [{"segment": "base", "x": "head", "magnitude": -500.0, **load}]
    tables = {**CANTILEVER, "load": loads, "damping": {"modal": 0.02}, "start": {"state": "rest"}}
    blank = channel("tip", table=pairs(0.0 * TIMES, TIMES))
    ((_, (tip, *_)),) = Experiment(measured(tables, blank), "case").evaluate({})
    return tables, tip


def test_a_model_agrees_with_itself_and_not_with_another() -> None:
    """Reference: by construction. Noise of one uncertainty leaves a misfit of 1, within 3/√(2n)."""
    tables, tip = swinging()
    noise = np.random.default_rng(1).normal(0.0, 1.0e-3, tip.size)
    table = pairs(tip + noise, TIMES)
    right = compare(measured(tables, channel("tip", table=table)))
    (found,) = right.agreements
    assert found.misfit == pytest.approx(1.0, abs=3.0 / np.sqrt(2.0 * tip.size))
    assert abs(found.bias) < 3.0e-3 / np.sqrt(tip.size)
    assert right.agrees
    _, computed = found.features.values()
    assert right.frame.loc["tip", "slow_of_model"] == computed.slow
    other = compare(measured({**tables, "payload": {"mass": 150.0}}, channel("tip", table=table)))
    assert not other.agrees
    assert other.agreements[0].features["model"].frequency < 0.9 * computed.frequency
    # A zero that is unknown hides a constant difference.
    moved = [(time, reading + 0.5) for time, reading in table]
    relative = compare(measured(tables, channel("tip", table=moved, relative=True)))
    assert relative.agreements[0].misfit == pytest.approx(found.misfit, rel=0.02)
    assert relative.frame.loc["tip", "bias"] == pytest.approx(0.0, abs=1.0e-12)


@pytest.mark.parametrize(
    ("factor", "shift", "caution"),
    [
        (1.0, 0.0, ""),
        (1000.0, 0.0, "tip: the readings have 1000 times the size of the model; their unit is m "
         "unless the heading of the column gives another"),
        (1.0, 0.12, "tip: the readings fit the model 0.12 s later; give time_offset = 0.12, or "
         "identify measured.time_offset"),
        (1.0, -0.05, "tip: the readings fit the model 0.05 s earlier; give time_offset = -0.05, or "
         "identify measured.time_offset"),
    ],
)  # fmt: skip
def test_a_wrong_unit_and_a_forgotten_time_offset_are_told(
    factor: float, shift: float, caution: str
) -> None:
    """Reference: by construction, readings of the model in mm, or of a logger that started late."""
    tables, tip = swinging(ramp=0.3)
    read_at = TIMES[(TIMES + shift >= 0.0) & (TIMES + shift <= TIMES[-1])]
    late = factor * np.interp(read_at + shift, TIMES, tip)
    read = channel("tip", table=pairs(late, read_at))
    (agreement,) = compare(measured(tables, read | {"uncertainty": 1.0e-4})).agreements
    assert agreement.mistakes == ([caution] if caution else [])


def test_frequency_and_decay_of_a_damped_oscillation() -> None:
    """Reference: analytic."""
    time = np.linspace(0.0, 10.0, 2001)
    signal = np.exp(-0.03 * 2.0 * np.pi * 1.7 * time) * np.cos(2.0 * np.pi * 1.7 * time)
    found = Features.of(time, signal + 3.0, 3.0)
    assert found.frequency == pytest.approx(1.7, rel=0.01)
    assert found.decay == pytest.approx(0.03, rel=0.02)
    assert np.isnan(Features.of(time, time, 3.0).decay)


def test_a_peak_between_two_readings() -> None:
    """Reference: analytic. Steps of 0.02 s would leave 6 ms of the time, and 2e-4 of the height."""
    time = np.linspace(0.0, 8.0, 401)
    found = Features.of(time, 1.0 - np.cos(2.0 * np.pi * 0.7 * time), 5.0)
    assert found.time_of_peak == pytest.approx(1.0 / 1.4, abs=1e-4)
    assert found.peak == pytest.approx(2.0, abs=1e-5)
    # Too short for the filter, and flat at its peak, as readings of few digits are.
    flat = Features.of(time[:7], np.array([0.0, 1.0, 2.0, 2.0, 2.0, 1.0, 0.0]), 5.0)
    assert (flat.time_of_peak, flat.peak) == (time[3], 2.0)


SERIES = [(0.0, 0.0), (1.0, 0.0)]


@pytest.mark.parametrize(
    ("keys", "what"),
    [
        ({"quantity": "tip"}, "measured[1].value: missing; it is a single value in the unit of the "
         "quantity, at rest under the loads at t = 0"),
        ({"quantity": "tip", "value": 0.0, "table": SERIES},
         "measured[1].value: the channel has readings over time; leave one of them out"),
        ({"quantity": "strain", "value": 0.0, "segment": "base"},
         "measured[1].x: missing; it is the x in m; strain and motions of a place need it"),
        ({"quantity": "frequency", "table": SERIES},
         "measured[1].quantity: natural frequency is a single value; give it as value"),
        ({"quantity": "rope_force", "value": 1.0},
         "measured[1].quantity: rope force varies over time; give a table or a file"),
        ({"quantity": "tip", "relative": True, "value": 1.0},
         "measured[1].relative: a single value has since instead"),
        ({"quantity": "tip", "table": SERIES, "since": {"payload.mass": 1.0}},
         "measured[1].since: only a single value has this key"),
        ({"quantity": "strain", "segment": "fly", "x": 1.0, "value": 0.0},
         "measured[1].segment: 'fly' is no segment; give 'base'"),
        ({"quantity": "strain", "segment": "base", "x": 9.0, "value": 0.0},
         "measured[1].x: 9 m lies outside 'base'; it must be between 0 and 5 m"),
        ({"quantity": "tip", "value": 0.0, "changes": {"payload.weight": 1.0}},
         "payload.weight: is not a number of the case; give 'payload.mass'"),
        ({"quantity": "rope_force", "table": SERIES},
         "measured[1].quantity: the case has no hoist, whose rope would have this force"),
        ({"quantity": "cylinder_force", "value": 0.0},
         "measured[1].number: the boom has 0 cylinders"),
        ({"quantity": "tip", "valeu": 0.0},
         "measured[1].valeu: unknown key; the nearest known one is value"),
        ({"quantity": "tipp", "value": 0.0},
         "measured[1].quantity: must be 'tip', 'tip_lateral', 'deflection', 'rotation', "),
        ({"quantity": "tip", "table": [(2.0, 0.0), (3.0, 0.0)]},
         "measured[1].time_offset: has no two readings from 0 to 1 s of the run"),
        (None, "measured: missing; give a [[measured]]"),
        ({"quantity": "tip", "value": 0.0},
         "--model: 'shell' is not a beam of the case; give 'beam'"),
    ],
)  # fmt: skip
def test_wrong_channels_are_refused(keys: dict[str, Any] | None, what: str) -> None:
    channels = [] if keys is None else [{"name": "one", "uncertainty": 1.0e-3, **keys}]
    model = "shell" if what.startswith("--model") else None
    with pytest.raises(BadInput) as refused:
        compare(measured(CANTILEVER, *channels), model)
    assert str(refused.value).startswith(f"case: {what}")


def test_the_report_of_a_run_has_the_readings() -> None:
    """Reference: the comparison itself. Without channels, or if they do not fit, it has none."""
    case = measured(CANTILEVER, channel("tip", value=-0.01))
    results = run_case(case)
    (table,) = judge(results).tables
    assert table.rows == compare(case).table().rows
    assert '<h2 id="readings">Readings</h2>' in render(results, judge(results), [], [])
    results.case = load_case(CANTILEVER)
    assert judge(results).tables == []
    results.case = measured(CANTILEVER, channel("frequency", number=900, value=0.0))
    assert judge(results).tables == []


X = np.linspace(0.0, 1.0, 40)


def test_standard_errors_and_profile_of_a_linear_model() -> None:
    """Reference: analytic. Regression line: σ/√S_xx, and σ √(1/n + x̄²/S_xx); their correlation."""
    noise = np.random.default_rng(3).normal(0.0, 0.05, X.size)

    def fitted(noise: Array, upper: float = 9.0, starts: int = 1) -> tuple[Any, Fit]:
        readings = 2.0 + 3.0 * X + noise
        line = lambda p: (p[0] + p[1] * X - readings) / 0.1  # noqa: E731
        return line, fit(line, [-9.0, -9.0], [9.0, upper], [0.0, 0.0], starts)

    line, found = fitted(noise, starts=3)
    spread = float(np.sum((X - X.mean()) ** 2))
    errors = [0.1 * np.sqrt(1.0 / X.size + X.mean() ** 2 / spread), 0.1 / np.sqrt(spread)]
    assert found.errors == pytest.approx(errors, rel=1.0e-6)
    correlation = -X.mean() / np.sqrt(np.mean(X**2))
    assert found.correlation == pytest.approx(np.array([[1, correlation], [correlation, 1]]))
    assert found.values[::-1] == pytest.approx(np.polyfit(X, 2.0 + 3.0 * X + noise, 1), abs=1e-6)
    assert found.agreeing == 3
    assert found.determined.all()
    assert not found.at_bound.any()
    assert fitted(noise, 1.0)[1].at_bound.tolist() == [False, True]
    # χ² grows by (distance/standard error)²; by 3.84 at 1.96 of them.
    values, increases = profile(line, found, 1)
    expected = ((values - found.values[1]) / found.errors[1]) ** 2
    assert increases == pytest.approx(expected, abs=1.0e-4)
    assert pytest.approx(1.95996**2, rel=1.0e-4) == CHI_SQUARE_95
    # A model that misses the readings has errors with the factor √(χ²/(m − n)).
    (_, found), (_, plain) = fitted(np.sign(np.sin(99.0 * X))), fitted(0.0 * X)
    assert found.misfit > 5.0
    assert found.errors == pytest.approx(found.misfit * plain.errors)


def test_the_best_of_several_starts() -> None:
    """Reference: analytic. (x² − 4)² + 0.1 (x − 3)² has a second minimum near −2."""

    def residuals(p: Array) -> Array:
        return np.array([p[0] ** 2 - 4.0, np.sqrt(0.1) * (p[0] - 3.0)])

    assert fit(residuals, [-5.0], [5.0], [-2.0]).values[0] < 0.0
    best = fit(residuals, [-5.0], [5.0], [-2.0], 4)
    assert best.values[0] == pytest.approx(2.0, abs=0.02)
    assert best.agreeing < 4


def test_a_prediction_follows_the_covariance() -> None:
    """Reference: analytic. A weight that is known within 5 kg scatters the tip in proportion."""
    case = measured(CANTILEVER, channel("tip", value=-0.01, uncertainty=5.0e-4))
    found = identify(case, {"payload.mass": (10.0, 900.0)})
    experiment = Experiment(found.case, "case")
    (deflection, predicted) = (
        float(experiment.evaluate({"payload.mass": mass})[0][1][0, 0])
        for mass in (100.0, found.case.payload.mass)
    )
    stiffness = 100.0 / -deflection
    assert found.frame.loc["payload.mass", "value"] == pytest.approx(0.01 * stiffness, rel=1e-4)
    assert found.frame.loc["payload.mass", "error"] == pytest.approx(5e-4 * stiffness, rel=1e-4)
    assert predicted == pytest.approx(-0.01, rel=1e-4)
    # A tape measure with 1 mm would share the largest systematic error, 5 % of 10 mm.
    tape = channel("tip", value=-0.01)
    rough = channel("frequency", value=3.0, uncertainty=1.0e4, systematic=0.05)
    helpful = identify(measured(CANTILEVER, tape, rough), {"payload.mass": (10.0, 9e3)}).helpful
    left = 1.0 / np.sqrt(1.0 + 1.0 / (1.0 + 0.5**2))
    assert dict(helpful)["tip at rest"] == pytest.approx([left], rel=1e-3)
    # At rest, records over time have no range but round-off.
    assert {name for name, _ in helpful} <= {"tip at rest", "first frequency"}
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
    with refused(f"case: {what}"):
        identify(measured(CANTILEVER, channel("tip", value=-0.01)), unknown)


def test_a_senseless_option_is_refused() -> None:
    assert parse("joint.play = 0:0.03", "case.toml") == ("joint.play", (0.0, 0.03))
    what = "not understood; give KEY=LOW:HIGH, such as joint.play=0:0.03"
    with refused(f"case.toml: --unknown joint.play=0.03: {what}"):
        parse("joint.play=0.03", "case.toml")


@pytest.mark.slow
def test_accelerations_after_a_release_have_one_minimum() -> None:
    """Reference: by construction. Play in mm within 0.3 %, from 3 mm and bounds of 0 to 15 mm.

    Impacts make χ² rough: searches from the start and from a few random points end up to 2 mm from
    the true play, at misfits above 10.
    """
    play = 2.4
    times = np.arange(0.0, 0.2, 0.002)
    load = {"segment": "fly", "x": "head", "magnitude": -4000.0, "released": True}
    boom = BOOM | {
        "time": {"duration": 0.2, "output_step": 0.002, "step": 1.0e-4}, "load": [load],
        "damping": {"modal": 0.02}, "gravity": {"angle": 10.0}, "payload": {"mass": 20.0},
        "joint": [BOOM["joint"][0] | {"play": 0.003}],
    }  # fmt: skip
    head = channel("head", quantity="acceleration", segment="fly", x=8.0)

    def case_of(curve: Array, uncertainty: float = 1.0) -> Case:
        return measured(boom, head | {"table": pairs(curve, times), "uncertainty": uncertainty})

    experiment = Experiment(case_of(0.0 * times), "case")
    ((_, (curve, *_)),) = experiment.evaluate({"joint.play": 1.0e-3 * play})
    noise = 0.01 * float(np.ptp(curve))
    noisy = curve + np.random.default_rng(1).normal(0.0, noise, curve.size)
    found = identify(case_of(noisy, noise), {"joint.play": (0.0, 0.015)}).found
    assert found.values[0] == pytest.approx(1.0e-3 * play, rel=3.0e-3)
    assert found.misfit < 2.0


@pytest.mark.slow
def test_chaotic_motions_are_compared_by_their_features() -> None:
    """Reference: by construction. The paper's boom hits its play; 16.8 mm within two errors."""
    tables = tomllib.loads((CASES / "paper.toml").read_text("utf-8"))
    tables["time"] = {"duration": 6.0, "output_step": 0.02, "step": 1.0e-4}
    times = np.arange(0.0, 6.0, 0.02)

    def case_of(curve: Array) -> Case:
        return measured(tables, channel("tip", uncertainty=2.0e-3, table=pairs(curve, times)))

    experiment = Experiment(case_of(np.zeros(times.size)), "case", "kantorovich-5")
    ((_, (curve, *_)),) = experiment.evaluate({"joint.play": 0.0168})
    noisy = curve + np.random.default_rng(0).normal(0.0, 2.0e-3, curve.size)
    found = identify(case_of(noisy), {"joint.play": (0.004, 0.03)}, "kantorovich-5", starts=1)
    assert found.residuals.horizons[0] < 4.5
    assert found.found.residuals.size == STEADY
    play = found.frame.loc["joint.play"]
    assert abs(play["value"] - 0.0168) < 2.0 * play["error"] < 4.0e-4
    # Without features the fit would follow the motion beyond its predictable time.
    assert "unpredictable" in found.after.table().notes[1]
