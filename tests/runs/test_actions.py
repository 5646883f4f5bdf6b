# SPDX-License-Identifier: LGPL-3.0-or-later
"""Loads of all kinds, initial states and observations of a case, and their motions."""

from pathlib import Path

import numpy as np
import pytest

import protractile as pt
from protractile.runs.case import reading, toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.pipeline.models import build
from tests.runs.case_texts import (
    CLAMPED,
    COARSE,
    REST,
    STEEL,
    edited,
    elements,
    read_case,
    refusal,
    table,
)
from tests.runs.summaries import static_tip

CANTILEVER = f"""
title = "One segment"
time = {{ duration = 2.0, output_step = 1e-3 }}
{STEEL}
[[segment]]
name = "beam"
span = [0.0, 10.0]
{CLAMPED}
mass_per_length = 83.16
second_moment_of_area = 3.7986e-4
rotary_inertia = 0.0
"""

ELEMENTS = elements("beam-fe", theory="euler-bernoulli", element_length=1.0)
BENDING = 2.1e11 * 3.7986e-4
# βL of a cantilever's first mode.
FIRST = (1.875104069 / 10.0) ** 2 * np.sqrt(BENDING / 83.16)


def run(folder: Path, text: str) -> pt.Results:
    """Return the results of the cantilever with the additional tables ``text``."""
    return pt.run_case(read_case(folder, CANTILEVER + text + ELEMENTS))


def load(**keys: object) -> str:
    return table("[[load]]", segment="beam", **keys)


def observe(name: str, x: float, quantity: str = "deflection", segment: str = "inner") -> str:
    return table("[[observe]]", name=name, segment=segment, x=x, quantity=quantity)


def tip(folder: Path, text: str) -> np.ndarray:
    return np.asarray(run(folder, text).trajectories["tip"].values[0])


def test_boom_at_rest_has_contact_forces_and_no_peak(tmp_path: Path) -> None:
    """Reference: analytic. A stiff stop carries 3/8 of a uniform load."""
    floor = {"x": 10.0, "play": 0.0, "stiffness": 0.0, "stiffness_below": 1e12}
    stop = table("[[stop]]", segment="beam", **floor)
    results = run(tmp_path, REST + load(magnitude=-1000.0) + stop)
    forces = results.trajectories["contact_force"].values[0, :, 0]
    assert forces == pytest.approx(np.full(forces.size, -0.375 * 10_000.0), rel=1e-3)
    assert results.summary.models["beam-fe"].first_peak["tip"] == (None, None)


def test_a_released_load_leaves_the_beam_swinging(tmp_path: Path) -> None:
    """Reference: analytic. It starts from the deflection under the load, and vibrates about 0."""
    results = run(tmp_path, load(x=10.0, magnitude=-500.0, released=True))
    moved = results.trajectories["tip"].values[0]
    held = -500.0 * 10.0**3 / (3.0 * BENDING)
    assert moved[0] == pytest.approx(held, rel=1e-6)
    # 97 % of the deflection is in the first mode; the others may be against it.
    swing = held * np.cos(FIRST * np.arange(moved.size) / 1000)
    assert moved == pytest.approx(swing, abs=0.06 * abs(held))
    rests = [x.values["deflection"][-1] for x in results.curves.where(state="rest", play=True)]
    assert rests == pytest.approx([held, 0.0], rel=1e-6)
    assert results.summary.models["beam-fe"].static_tip == pytest.approx(held, rel=1e-6)


def test_a_payload_hangs_from_the_tip_with_its_mass(tmp_path: Path) -> None:
    """Reference: analytic, √(3 E J / m L³) of a large mass, about its static deflection."""
    moved = tip(tmp_path, "[payload]\nmass = 2e4\n")
    static = -2.0e4 * 9.80665 * 10.0**3 / (3.0 * BENDING)
    # A beam's mass adds 33/140 of itself to the tip (Rayleigh).
    omega = np.sqrt(3.0 * BENDING / ((2.0e4 + 33.0 / 140.0 * 831.6) * 10.0**3))
    time = np.arange(moved.size) / 1000
    assert moved == pytest.approx(static * (1.0 - np.cos(omega * time)), abs=0.01 * abs(static))


def test_the_ground_s_acceleration_is_a_load_on_every_mass(tmp_path: Path) -> None:
    """Reference: the same inertia loads, specified one by one."""
    payload = table("[payload]", mass=300.0, gravity=0.0)
    given = load(magnitude=83.16, frequency=0.7) + load(x=10.0, magnitude=300.0, frequency=0.7)
    shaken = table("[[base]]", acceleration=-1.0, frequency=0.7)
    expected, found = (tip(tmp_path, text + payload) for text in (given, shaken))
    assert found == pytest.approx(expected, abs=1e-9 * np.ptp(expected))


def test_histories_follow_the_case(tmp_path: Path) -> None:
    """Reference: the histories made in Python, and the case that its own text gives."""
    (tmp_path / "gust.csv").write_text("0, 0\n0.5, 1\n2, -0.25\n", encoding="utf-8")
    given = {}, {"ramp": 0.3}, {"frequency": 2.0}, {"table": [[0, 1], [1, 2]]}, {"file": "gust.csv"}
    text = "".join(load(magnitude=1.0, **history) for history in given)
    text += load(magnitude=1.0, moment=True, x=6.0)
    case = read_case(tmp_path, CANTILEVER + text + ELEMENTS)
    assert read_case(tmp_path, toml.dumps(case)) == case
    tables = ((0.0, 1.0), (1.0, 2.0)), ((0.0, 0.5, 2.0), (0.0, 1.0, -0.25))
    histories = [pt.Step(), pt.Ramp(0.3), pt.Sine(2.0), *(pt.PiecewiseLinear(*x) for x in tables)]
    assert [x.history for x in build_boom(case).loads] == [*histories, pt.Step()]
    # A segment's name may have blanks and points, also as a key.
    start = '[start]\nvelocity = { "fly 2.1" = { z = 0.1 }, outer = 0.2 }\n\n[[model]]'
    text = UNLOADED.replace('"inner"', '"fly 2.1"').replace("[[model]]", start, 1)
    named = read_case(tmp_path, text)
    assert read_case(tmp_path, toml.dumps(named)) == named


PART = '[[load]]\nsegment = "beam"\nfrom = 3.0\nto = 7.0\nmagnitude = -500.0\n'
MOMENT = '[[load]]\nsegment = "beam"\nx = 6.0\nmagnitude = 2.0e4\nmoment = true\n'


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (MOMENT.replace("x = 6.0\n", ""),
         "load[1].x: missing; it is the x in m at which the moment acts"),
        (PART.replace("to = 7.0", "to = 2.0"), "load[1].to: must be beyond from, 3 m, got 2 m"),
        (PART.replace("from = 3.0", "x = 3.0"), "load[1].to: x is given; leave one of them out"),
        ('[[load]]\nsegment = "beam"\nmagnitude = 1.0\nramp = 1.0\nfrequency = 1.0',
         "load[1].frequency: ramp is given; leave one of them out"),
        ('[[base]]\nacceleration = 1.0\nfile = "back.csv"',
         "base[1].file: 'back.csv' has a time in line 3 that does not rise; sort them"),
        ('[[load]]\nsegment = "beam"\nmagnitude = 1.0\nramp = 1.0\nreleased = true',
         "load[1].released: a load that is let go has acted for ever, without a history; leave one "
         "of them out"),
        ('[[stop]]\nsegment = "beam"\nx = 10.0\nplay = 0.01\nstiffness = 0.0',
         "stop[1].stiffness: must be positive on one side at least, got 0 on both"),
        (observe("contact_force", 9.0, segment="beam"),
         "observe[1].name: 'contact_force' is the name of another output already; give it its own"),
        (observe("a", 9.0, "twist", "beam"),
         "observe[1].quantity: the boom is flat, and nothing moves along 'y' or twists; give "
         "another quantity, or the joints lateral_play"),
    ],
)  # fmt: skip
def test_bad_actions_are_refused(tmp_path: Path, text: str, line: str) -> None:
    (tmp_path / "back.csv").write_text("0, 1\n0.2, 2\n0.1, 3\n", encoding="utf-8")
    assert refusal(tmp_path, CANTILEVER + text + ELEMENTS) == line


SERIES = '[[model]]\nname = "series"\nkind = "kantorovich"\nterms = [6]\nbase = "complete"\n'
SHELL = '[[model]]\nname = "shell"\nkind = "shell"\nmesh_size = 0.2\ncontact_tolerance = "any"\n'
BOXED = edited(
    CANTILEVER,
    ("mass_per_length = 83.16\nsecond_moment_of_area = 3.7986e-4",
     "section = { height = 0.47, width = 0.41, flange = 0.006, web = 0.006 }"),
)  # fmt: skip
# The tip of a cantilever, −q ∫ x² (3 L − x)/6 dx from 3 to 7 m over E J, and M a (L − a/2)/E J.
UNDER_PART = -500.0 * (10.0 * (7.0**3 - 3.0**3) / 6.0 - (7.0**4 - 3.0**4) / 24.0) / BENDING
UNDER_MOMENT = 2.0e4 * 6.0 * (10.0 - 3.0) / BENDING


@pytest.mark.parametrize(("load", "expected"), [(PART, UNDER_PART), (MOMENT, UNDER_MOMENT)])
def test_models_have_the_deflections_of_statics(
    tmp_path: Path, load: str, expected: float, tools: BuildContext
) -> None:
    """Reference: analytic. Elements and series contain the influence line of the tip, a cubic; a
    shell with a mesh error of 0.5 % is shear-flexible.
    """
    for model in (ELEMENTS, SERIES):
        found = static_tip(read_case(tmp_path, CANTILEVER + load + model))
        assert found == pytest.approx(expected, rel=1e-9)
    elements = ELEMENTS.replace("euler-bernoulli", "timoshenko")
    beam, shell = (
        static_tip(read_case(tmp_path, BOXED + load + x), tools=tools) for x in (elements, SHELL)
    )
    assert shell == pytest.approx(beam, rel=5e-3)


TURNED = "[start]\nvelocity = { inner = { z = 0.01, turn = 0.02, x = 9.0 } }\n"
TURNED += observe("seat", 14.2)
TURNED += observe("seat rate", 14.2, "velocity") + observe("seat_push", 14.2, "acceleration")
TURNED += observe("seat_slope", 14.2, "rotation")
SIDEWAYS = """[start.velocity]
inner = { z = 0.03, y = -0.02, turn = 0.004, lateral_turn = 0.005, x = 12.0 }
outer = -0.01
"""
SIDEWAYS += observe("sideways", 14.0, "lateral") + observe("roll", 14.0, "twist")
SIDEWAYS += observe("slope", 14.0, "rotation")
UNLOADED = (
    COARSE.replace("load = 83.16\n", "").replace("load = 55.07\n", "").replace("0.6", "0.2", 1)
)


def turned(folder: Path, model: str) -> pt.Results:
    case = read_case(folder, UNLOADED.replace("[[model]]", TURNED + "\n[[model]]", 1))
    return pt.run_case(case, models=[model])


@pytest.mark.parametrize(
    "model", ["kantorovich-5", "timoshenko", pytest.param("shell", marks=pytest.mark.slow)]
)
def test_a_free_segment_turns_as_a_rigid_body(tmp_path: Path, model: str) -> None:
    """Reference: analytic, (0.01 + 0.02 (x − 9)) t until contact at the head, 7 mm at 0.233 s."""
    if model == "shell":
        pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")
    data = turned(tmp_path, model).trajectories.isel(model=0)
    time = data["time"].values
    assert data["tip"].values == pytest.approx(0.21 * time, rel=1e-6, abs=1e-9)
    assert data["tail"].values == pytest.approx(0.01 * time, rel=1e-5, abs=1e-8)
    assert data["seat"].values == pytest.approx(0.114 * time, rel=1e-6, abs=1e-9)
    assert data["seat rate"].values == pytest.approx(0.114, rel=1e-6)
    assert data["seat_slope"].values == pytest.approx(0.02 * time, rel=1e-5, abs=1e-9)
    # Round-off in the elastic modes, whose accelerations are large.
    assert np.abs(data["seat_push"].values).max() < 1e-4
    units = [data[name].attrs["units"] for name in ("seat", "seat rate", "seat_push", "seat_slope")]
    assert units == ["m", "m/s", "m/s2", "rad"]


@pytest.mark.parametrize("kind", ["timoshenko", pytest.param("shell", marks=pytest.mark.slow)])
def test_segments_in_space_turn_in_both_planes(
    tmp_path: Path, kind: str, request: pytest.FixtureRequest
) -> None:
    """Reference: analytic, the rigid body's velocities and rates, in every model."""
    text = (pt.CASES / "spatial.toml").read_text(encoding="utf-8")
    text = text.replace("[[model]]", SIDEWAYS + "\n[[model]]", 1)
    text = text.replace("contact_tolerance = 0.01", 'contact_tolerance = "any"')
    text = text.replace("mesh_size = 0.1", "mesh_size = 0.25")
    case = read_case(tmp_path, text)
    (model,) = reading.select(case, "case.toml", [kind]).models
    tools = request.getfixturevalue("tools") if model.needs_shell else None
    system = build(case, build_boom(case), model, tools).system
    rates = {
        name: float(seen.row @ system.initial_impulse) for name, seen in system.observers.items()
    }
    expected = {
        "tip": 0.03 + 0.004 * 7.0, "tail": 0.03 - 0.004 * 3.0, "tip_lateral": -0.02 + 0.005 * 7.0,
        "tail_lateral": -0.02 - 0.005 * 3.0, "sideways": -0.02 + 0.005 * 2.0, "slope": 0.004,
    }  # fmt: skip
    assert {name: rates[name] for name in expected} == pytest.approx(expected, rel=1e-6)
    assert rates["roll"] == pytest.approx(0.0, abs=1e-9)


def test_velocity_is_the_slope_of_the_deflection(tmp_path: Path) -> None:
    """Reference: analytic, integrals of velocity and acceleration through contacts."""
    text = COARSE.replace(
        "[[model]]", TURNED.replace("turn = 0.02", "turn = 0.05") + "[[model]]", 1
    )
    text = text.replace("output_step = 1e-3", "output_step = 5e-5").replace("= 0.6", "= 0.3", 1)
    data = pt.run_case(read_case(tmp_path, text), models=["beam-fe"]).trajectories.isel(model=0)
    step = 5.0e-5
    assert np.abs(data["contact_force"].values).max() > 0.0
    way, rate, push = (data[name].values for name in ("seat", "seat rate", "seat_push"))
    covered = step * np.cumsum(0.5 * (rate[1:] + rate[:-1]))
    assert covered == pytest.approx(way[1:] - way[0], abs=3e-3 * np.ptp(way))
    assert push[0] == 0.0
    assert step * np.cumsum(push) == pytest.approx(rate - rate[0], abs=1e-11)
