# SPDX-License-Identifier: LGPL-3.0-or-later
"""Initial velocities and rotation rates of segments, and observations."""

from pathlib import Path

import numpy as np
import pytest

from protractile.cases import run_case
from runs import CASES
from runs.case import reading, toml
from runs.case.build import build_boom
from runs.case.kinds.model import BuildContext
from runs.pipeline.models import build
from runs.pipeline.results import Results
from tests.runs.case_texts import read_case, refusal, table
from tests.runs.coarse_case import COARSE


def observe(name: str, x: float, quantity: str = "deflection", segment: str = "inner") -> str:
    return table("[[observe]]", name=name, segment=segment, x=x, quantity=quantity)


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


def turned(folder: Path, model: str) -> Results:
    case = read_case(folder, UNLOADED.replace("[[model]]", TURNED + "\n[[model]]", 1))
    return run_case(case, models=[model])


@pytest.mark.parametrize(
    "model",
    ["kantorovich-5", "beam-fe", "timoshenko", pytest.param("shell", marks=pytest.mark.slow)],
)  # fmt: skip
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


@pytest.mark.parametrize(
    "kind", ["kantorovich-24", "timoshenko", pytest.param("shell", marks=pytest.mark.slow)]
)
def test_segments_in_space_turn_in_both_planes(tmp_path: Path, kind: str) -> None:
    """Reference: analytic, the rigid body's velocities and rates, in every model."""
    text = (CASES / "spatial.toml").read_text(encoding="utf-8")
    text = text.replace("[[model]]", SIDEWAYS + "\n[[model]]", 1)
    text = text.replace("contact_tolerance = 0.01", 'contact_tolerance = "any"')
    text = text.replace("mesh_size = 0.1", "mesh_size = 0.25")
    case = read_case(tmp_path, text)
    (model,) = reading.select(case, "case.toml", [kind]).models
    tools = None
    if kind == "shell":
        pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")
        from mpi4py import MPI

        tools = BuildContext(MPI.COMM_SELF)
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
    text = text.replace("output_step = 1e-3", "output_step = 5e-5")
    data = run_case(read_case(tmp_path, text), models=["beam-fe"]).trajectories.isel(model=0)
    step = 5.0e-5
    assert np.abs(data["contact_force"].values).max() > 0.0
    way, rate, push = (data[name].values for name in ("seat", "seat rate", "seat_push"))
    covered = step * np.cumsum(0.5 * (rate[1:] + rate[:-1]))
    assert covered == pytest.approx(way[1:] - way[0], abs=3e-3 * np.ptp(way))
    assert push[0] == 0.0
    assert step * np.cumsum(push) == pytest.approx(rate - rate[0], abs=1e-11)


def test_data_have_names_and_units(tmp_path: Path) -> None:
    data = turned(tmp_path, "kantorovich-4").trajectories
    assert data.attrs["Conventions"] == "CF-1.8"
    assert [
        name for name, values in data.variables.items() if "long_name" not in values.attrs
    ] == []
    assert data["tip"].attrs["long_name"] == "deflection along z of 'inner' at x = 19 m"
    assert data["seat rate"].attrs["long_name"] == "velocity along z of 'inner' at x = 14.2 m"
    assert data["place"].values.tolist() == ["9", "10"]
    at_head = data.swap_dims(station="place").sel(place="10")
    assert float(at_head["station"]) == 10.0


def test_a_segment_s_name_may_have_blanks_and_points(tmp_path: Path) -> None:
    text = UNLOADED.replace('"inner"', '"fly 2.1"')
    start = '[start]\nvelocity = { "fly 2.1" = { z = 0.1 }, outer = 0.2 }\n\n'
    case = read_case(tmp_path, text.replace("[[model]]", start + "[[model]]", 1))
    assert read_case(tmp_path, toml.dumps(case)) == case


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (observe("a", 1.0, segment="jib"),
         "observe[1].segment: 'jib' is no segment; give 'outer' or 'inner'"),
        (observe("contact_force", 11.0),
         "observe[1].name: 'contact_force' is the name of another output already; give it its "
         "own"),
        (observe("a", 11.0) + observe("a", 12.0),
         "observe[2].name: 'a' is the name of observe[1] already; give each its own"),
        (observe("a", 11.0, "twist"),
         "observe[1].quantity: the boom is flat, and nothing moves along 'y' or twists; give "
         "another quantity, or the joints lateral_play"),
        (observe("a", 11.0, "speed"),
         "observe[1].quantity: must be 'deflection', 'rotation', 'velocity', 'acceleration', "
         "'lateral' or 'twist', got 'speed'"),
        ("[start]\nvelocity = { inner = { speed = 1.0 } }",
         "start.velocity.inner.speed: unknown key; known ones are z, y, turn, lateral_turn, x"),
        ("[start]\nvelocity = { inner = { lateral_turn = 1.0 } }",
         "start.velocity.inner.lateral_turn: the boom is flat, and nothing moves along 'y'; "
         "give the joints lateral_play"),
    ],
)  # fmt: skip
def test_bad_observers_are_refused(tmp_path: Path, text: str, line: str) -> None:
    assert refusal(tmp_path, COARSE.replace("[[model]]", f"{text}\n\n[[model]]", 1)) == line
