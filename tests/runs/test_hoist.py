# SPDX-License-Identifier: LGPL-3.0-or-later
"""Hoisting in a case: statics and results of a hanging load, messages for bad input."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from scipy.integrate import solve_ivp
from scipy.optimize import root

from protractile.analysis.beams import beam_of
from protractile.analysis.bonded import bonded_system
from protractile.analysis.rows import INITIAL
from protractile.cases import change, run_case
from protractile.dynamics.arrays import Array
from protractile.dynamics.damping import closed_contact_damping, closed_contact_modes
from protractile.dynamics.equilibrium import equilibrium
from protractile.runs import CASES
from protractile.runs.case.build import build_boom
from protractile.runs.case.combination_tables import CombinationTable, LoadCaseTable
from protractile.runs.case.combinations import check_combinations, combined_cases
from protractile.runs.case.load_tables import LoadTable, RopeTable
from protractile.runs.case.motion_tables import HoistTable, WindTable
from protractile.runs.case.motions import with_initial_slack
from protractile.runs.case.reading import CheckedCase, select
from protractile.runs.case.schema import Case
from protractile.runs.check import check_case
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.combinations import combination_rows
from protractile.runs.pipeline.hoisting_error import straight_path_error
from protractile.runs.pipeline.models import build, initial_motion
from protractile.runs.pipeline.pad_walls import largest_tip
from protractile.runs.pipeline.statics import boom_with_play
from tests.runs.case_texts import CLAMPED, REST, STEEL, elements, refusal, shipped, table

GRAVITY = 9.80665
MODULUS = 2.1e11
HOIST = (CASES / "hoist.toml").read_text(encoding="utf-8")


@pytest.fixture(scope="module", name="case")
def _case() -> Case:
    return select(shipped("hoist"), "", ["series"])


@pytest.mark.parametrize("mass", [1000.0, 4000.0])
def test_maximum_load_hangs_for_any_mass(case: Case, mass: float) -> None:
    """Reference: the same load that hangs from the start. 4 t had −0.675 m in place of −1.821 m."""
    lifted = change(case, **{"hoist.mass": mass})
    hung = change(lifted, **{"hoist.hanging": True})
    states, hanging = (static_states(x, boom_with_play(x, build_boom(x))) for x in (lifted, hung))
    (_, tip), (_, hanging_tip) = largest_tip(states), largest_tip(hanging)
    assert tip == pytest.approx(hanging_tip, rel=1e-6)
    assert tip < 1.2 * states.observed("tip")[0] < 0.0


@pytest.mark.slow
def test_results_of_a_hoist(case: Case) -> None:
    """Reference: the height at which the load leaves the ground, and the energy balance.

    An output step of 50 ms, whose mean is late by 25 ms, does not move the lift-off.
    """
    given = {"hoist.phi_2_min": 1.1, "hoist.beta_2": 0.34}
    case = change(case, **given, **{"time.duration": 4.0})
    results = run_case(change(case, **{"time.output_step": 2e-3}))
    (summary,) = results.summary.models.values()
    assert summary.energy_residual < 1e-11
    found = results.summary.design.models["series"].hoisting
    data = results.trajectories.sel(model="series")
    height = data["load_height"].values
    # The ground, a hundred times as stiff as four falls, is left at this height.
    left = 5000.0 * GRAVITY / (100.0 * 4.0 * 1.0e11 * 1.1e-4 / 35.0)
    first = data["time"].values[np.argmax(height > left)]
    # The load oscillates on the ground; both times differ by at most a quarter of its 40 ms.
    assert found.lift_off == pytest.approx(first, abs=0.01)
    assert found.force == float(data["rope_force_peak"].max())
    assert found.factor == pytest.approx(found.force / (5000.0 * GRAVITY), rel=1e-9)
    assert found.by_class == pytest.approx(1.1 + 0.34 * 0.2)
    assert (found.swing_out, found.swing_aside) == (None, None)
    coarser = run_case(change(case, **{"time.output_step": 5e-2}))
    again = coarser.summary.design.models["series"].hoisting
    assert again.lift_off == pytest.approx(found.lift_off, abs=5e-3)


def test_work_of_the_winch(case: Case) -> None:
    """Reference: the energy balance of a horizontal boom, in which only the winch moves rows."""
    # The lead of the rope changes the stiffness, which is work too.
    level = change(case, **{"time.duration": 1.0, "gravity.angle": 0.0})
    results = run_case(level.model_copy(update={"rope": None}))
    drives = results.summary.design.models["series"].drives
    work = float(results.trajectories["drive_work"].values[0, -1])
    assert work > 100.0
    assert drives.winch_work == pytest.approx(work, rel=1e-4)
    force = float(results.trajectories["rope_force"].values.max())
    assert drives.winch_power == pytest.approx(0.2 * force, rel=1e-2)


def test_rope_of_a_boom_without_play_is_straight_at_rest(case: Case) -> None:
    """Reference: the series without play. A taut rope would raise the first frequency to 1.9 Hz."""
    boom, (model,) = build_boom(case), case.models
    system = build(case, boom, model).system.gather_loads()
    bonded = bonded_system(system, [equilibrium(system, system.load)])[0]
    same = build(case, boom, model.model_copy(update={"bonded": True})).system.gather_loads()
    own, other = (closed_contact_modes(x)[0][0] for x in (with_initial_slack(bonded, case), same))
    assert own == pytest.approx(other, rel=0.02)


@pytest.mark.parametrize("hanging", [True, False])
def test_combinations_have_the_hoisted_mass_as_payload(case: Case, hanging: bool) -> None:
    """Reference: the same load written as a load case's payload, on as many falls."""
    factors = {"dead": 1.22, "payload": 1.34}
    combination = CombinationTable.model_validate({"name": "A1", "factors": factors})
    hoist = case.hoist.model_copy(update={"hanging": hanging})
    hung = case.model_copy(update={"hoist": hoist, "combinations": (combination,)})
    lift = {"rope": RopeTable(falls=4), "load_cases": (LoadCaseTable(name="lift", payload=5000.0),)}
    own = combination_rows(hung)
    other = combination_rows(hung.model_copy(update={"hoist": None, **lift}))
    assert own == tuple(row._replace(state=own[0].state) for row in other)
    (tip,) = own.where(quantity="tip")
    assert tip.value < -2.0
    # An empty hook without a payload leaves the rope without force.
    nothing = {"payload": None, "load_cases": (LoadCaseTable(name="empty", payload=0.0),)}
    empty = hung.model_copy(update=nothing)
    assert not build_boom(next(combined_cases(empty)).case).leads
    check_combinations(empty)


def clamped_bar(length: float, second_moment: float, angle: float) -> str:
    """Return a bar without mass, to be continued, that is luffed by an angle in degrees."""
    text = 'title = "bar"\n' + STEEL + REST + table("[time]", duration=0.02)
    text += table("[gravity]", angle=angle)
    text += table("[[segment]]", name="bar", length=length, mass_per_length=0.1)
    return text + f"second_moment_of_area = {second_moment}\n{CLAMPED}\n"


def at_rest(case: Case) -> tuple[Array, Array]:
    """Return frequencies in Hz and damping ratios of the modes of the first model at rest."""
    motion = initial_motion(build(case, build_boom(case), case.models[0]).system, case)
    return closed_contact_damping(motion.system, motion.position)


@pytest.mark.parametrize(
    "model",
    [
        elements("bar", theory="euler-bernoulli", rotary_inertia=False),
        table("[[model]]", name="bar", kind="kantorovich", terms=[12], base="complete"),
    ],
)
def test_a_load_at_rest_is_a_pendulum(model: str) -> None:
    """Reference: analytic, a load on a rope below a clamped bar without mass at 60 degrees.

    The compliance of the bar is (tan kL/k − L)/P under the force P along it, with k² = P/E J, that
    of the pendulum l/(m g).
    """
    text = clamped_bar(12.0, 2e-5, 60.0) + table("[damping]", modal=0.02) + model
    text += table("[hoist]", mass=800.0, stiffness=1e6, hanging=True, pendulum=6.0)
    hertz, ratios = at_rest(Case.model_validate(tomllib.loads(text)))
    weight, along = 800.0 * GRAVITY, np.array([0.5, -np.sqrt(0.75)])
    k = np.sqrt(-along[1] * weight / (MODULUS * 2e-5))
    bar = (np.tan(12.0 * k) / k - 12.0) / (-along[1] * weight)
    compliance = bar * np.outer(along, along) + np.diag([1e-6, 6.0 / weight])
    right = 1.0 / (2.0 * np.pi * np.sqrt(800.0 * np.linalg.eigvalsh(compliance)))
    assert hertz[:2] == pytest.approx(right[::-1], rel=1e-3)
    assert ratios[:4] == pytest.approx(0.02, rel=1e-6)


@pytest.mark.parametrize("model", ["timoshenko", "bonded"])
def test_a_load_swings_to_all_sides(model: str) -> None:
    """Reference: analytic, √(g/l)/2π in both directions below a stiff boom."""
    case = select(shipped("slew"), "", [model])
    stiff = replace(case.material, youngs_modulus=100.0 * case.material.youngs_modulus)
    hertz, ratios = at_rest(case.model_copy(update={"material": stiff}))
    right = np.sqrt(GRAVITY / 5.0) / (2.0 * np.pi)
    assert hertz[:2] == pytest.approx(right, rel=1e-3)
    assert hertz[2] > 5.0
    assert ratios[:2] == pytest.approx(0.02, rel=1e-4)


def test_dropped_load(case: Case) -> None:
    """Reference: a force of the same size at the tip that is released at t = 0, boom level."""
    case = change(case, **{"time.duration": 0.4, "gravity.angle": 0.0})
    case = case.model_copy(update={"rope": None})
    force = {"segment": "fly", "x": "head", "magnitude": -5000.0 * GRAVITY, "released": True}
    weight = LoadTable.model_validate(force)
    hung = HoistTable(mass=5000.0, stiffness=1.0e6, hanging=True, dropped=True)
    tips = [
        run_case(case.model_copy(update=loads)).trajectories["tip"].values
        for loads in ({"hoist": hung}, {"hoist": None, "loads": (weight,)})
    ]
    assert tips[0] == pytest.approx(tips[1], abs=1e-6)
    assert np.ptp(tips[0]) > 0.1


def test_dropped_load_presses_along_the_boom_until_it_falls() -> None:
    """Reference: analytic, a clamped bar under the constant force P across and along its end.

    The tip is (P cos α/P sin α) (tan kL/k − L) with k² = P sin α/E J.
    """
    bar = clamped_bar(20.0, 2e-4, 70.0)
    bar += table("[hoist]", mass=1500.0, stiffness=1e8, hanging=True)
    bar += elements("fe", theory="euler-bernoulli", rotary_inertia=False)
    case = Case.model_validate(tomllib.loads(bar))
    along, across = (1500.0 * GRAVITY * part for part in (np.sin(1.2217305), np.cos(1.2217305)))
    k = np.sqrt(along / (MODULUS * 2e-4))
    right = -across / along * (np.tan(20.0 * k) / k - 20.0)
    for hung in (case, change(case, **{"hoist.dropped": True})):
        results = run_case(hung)
        (tip,) = results.rows.where(model="fe", state=INITIAL, quantity="tip")
        assert tip.value == pytest.approx(right, rel=1e-3)
        assert results.trajectories["tip"].values[0, 0] == pytest.approx(right, rel=1e-3)
        frames = check_case(CheckedCase(hung)).frames
        (clamp,) = frames["Reactions of supports and contacts at rest, t = 0"].values.tolist()
        assert clamp[2:5] == pytest.approx(
            [1e-3 * across, 1e-3 * along, 1e-3 * (20.0 * across - along * right)], rel=2e-3
        )
    # Then the bar carries its own weight alone, and vibrates as a cantilever.
    hertz = 1.8751**2 / (2.0 * np.pi * 20.0**2) * np.sqrt(MODULUS * 2e-4 / 0.1)
    fallen = results.curves.where(model="fe", state="rest")[-1]
    assert fallen.values["deflection"][-1] == pytest.approx(0.0, abs=1e-3)
    assert results.rows.where(quantity="frequency")[0].value == pytest.approx(hertz, rel=1e-4)


def test_load_hangs_aside_in_a_steady_wind(case: Case) -> None:
    """Reference: analytic, F l/(m g) of a force F that has always acted."""
    wind = WindTable(direction="x", force=500.0)
    hung = HoistTable(mass=5000.0, stiffness=1.0e6, hanging=True, pendulum=2.0, wind=(wind,))
    results = run_case(change(case.model_copy(update={"hoist": hung}), **{"time.duration": 0.1}))
    assert results.trajectories["swing_out"].attrs["length"] == 2.0
    found = results.summary.design.models["series"].hoisting
    assert found.swing_out == pytest.approx(500.0 * 2.0 / (5000.0 * GRAVITY), rel=1e-6)
    assert (found.lift_off, found.swing_aside) == (None, None)


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("area = 1.1e-4 # a rope of 16 mm\n", "",
         "hoist.area: missing; give it, or the stiffness of the rope"),
        ("falls = 4\n", "falls = 4\nstiffness = 1e6\n",
         "hoist.area: stiffness is given; leave one of them out"),
        ("travel = 1.2\nspeed = 0.2\nramp = 0.2\nstart = 0.1\n", "",
         "hoist.travel: missing; it is the length in m by which the winch hoists"),
        ("falls = 4\n", "falls = 4\nhanging = true\nslack = 0.1\n",
         "hoist.slack: the load hangs; leave slack or hanging out"),
        ("falls = 4\n", "falls = 4\npendulum = 10.0\n",
         "hoist.pendulum: the load lies on the ground; give hanging = true"),
        ("falls = 4\n", "falls = 4\nhanging = true\ndropped = true\n",
         "hoist.travel: the load is dropped at t = 0; leave one of them out"),
        ("falls = 4\n", "falls = 4\nhanging = true\nwind = [{ force = 100.0 }]\n",
         "hoist.wind: the load does not swing; give pendulum, its length in m"),
        ("falls = 4\n", "falls = 4\nhanging = true\npendulum = 10.0\nwind = [{ force = 100.0 }]\n",
         "hoist.wind[1].direction: the boom is flat, and nothing moves along 'y'; give the joints "
         "lateral_play"),
        ("falls = 4\n", "falls = 4\nbeta_2 = 0.34\n",
         "hoist.phi_2_min: missing; the hoisting class has it beside beta_2"),
        ("falls = 4\n", "falls = 4\nhanging = true\nphi_2_min = 1.1\nbeta_2 = 0.34\n",
         "hoist.phi_2_min: the load hangs, and is not lifted; leave it out"),
        ("[gravity]\nangle = 60.0\n", "",
         "hoist.mass: nothing weighs without the table gravity; give it"),
    ],
)  # fmt: skip
def test_bad_input(tmp_path: Path, before: str, after: str, message: str) -> None:
    assert before in HOIST
    assert refusal(tmp_path, HOIST.replace(before, after)) == message


# Number of polynomials of the rotation, and of Gauss points along the bar.
_TERMS, _POINTS = 4, 10


def tips_of_large_rotations(case: Case, times: Array) -> Array:
    """Return the tip (num_times,) in m across a bar whose axis has the angle α + Σ q_i s^i at s L.

    No rotation is small. The load on its rope moves along gravity only.
    """
    (bar,), hoist, angle = case.segments, case.hoist, np.radians(case.gravity.angle)
    rope, wound_at = hoist.rope_stiffness, hoist.history("hoist")
    points, weights = leggauss(_POINTS)
    s, weights = 0.5 * (points + 1.0), 0.5 * bar.length * weights
    powers = np.arange(1, _TERMS + 1)
    slopes = powers * s[:, None] ** (powers - 1) / bar.length
    bending = MODULUS * bar.second_moment_of_area * (slopes.T * weights) @ slopes
    masses = np.append(bar.mass_per_length * weights, 0.0)
    # From the foot to each Gauss point, and to the tip.
    ends = np.append(s, 1.0)[:, None]
    shapes, pieces = (ends * s)[..., None] ** powers, ends * weights

    def kinematics(q: Array) -> tuple[Array, Array, Array]:
        """Return directions (2, ends, points), places (2, ends) and their derivatives."""
        along = np.array([np.cos(angle + shapes @ q), np.sin(angle + shapes @ q)]) * pieces
        across = np.array([-along[1], along[0]])
        return along, along.sum(axis=2), (across[:, :, None] @ shapes)[:, :, 0]

    def forces(q: Array, pull: float) -> Array:
        _, _, moves = kinematics(q)
        return np.asarray(-bending @ q - GRAVITY * masses @ moves[1] - pull * moves[1, -1])

    weight = hoist.mass * GRAVITY if hoist.hanging else 0.0
    start = root(forces, np.zeros(_TERMS), args=(weight,), tol=1e-12).x
    lowest = kinematics(start)[1][1, -1]

    def rate(time: float, state: Array) -> Array:
        q, dq = state[:_TERMS], state[_TERMS : 2 * _TERMS]
        height, speed = state[-2:]
        along, places, moves = kinematics(q)
        pull = rope * max(places[1, -1] - lowest - height + float(wound_at(np.array(time))), 0.0)
        lift = pull / hoist.mass - GRAVITY
        if not hoist.hanging and height <= 0.0:
            lift = max(lift, 0.0)
        turning = -(along * (shapes @ dq) ** 2).sum(axis=2)
        heavy, light = (x.reshape(-1, _TERMS).T for x in (masses[:, None] * moves, moves))
        push = -bending @ q - GRAVITY * masses @ moves[1] - pull * moves[1, -1]
        ddq = np.linalg.solve(heavy @ light.T, push - heavy @ turning.ravel())
        return np.concatenate([dq, ddq, [speed, lift]])

    state = np.concatenate([start, np.zeros(_TERMS), [-weight / rope, 0.0]])
    accuracy = {"rtol": 1e-5, "atol": 1e-7, "max_step": 0.1}
    found = solve_ivp(rate, times[[0, -1]], state, "LSODA", times, **accuracy)
    normal = np.array([-np.sin(angle), np.cos(angle)])
    return np.array([normal @ kinematics(q)[1][:, -1] for q in found.y[:_TERMS].T])


BAR_HOIST = {"stiffness": 2.0e6, "travel": 2.0, "speed": 0.5, "ramp": 0.2, "start": 0.1}


def bar_case(bending: float, duration: float, **hoist: object) -> Case:
    """Return a bar of 20 m at 50 degrees that hoists a load, by its bending stiffness in N·m²."""
    text = clamped_bar(20.0, bending / MODULUS, 50.0).replace("per_length = 0.1", "per_length = 60")
    # Longer elements than the usual ones bring no more than 1 % of the error.
    text += elements("beam", theory="euler-bernoulli", element_length=4.0)
    text += table("[hoist]", **{**BAR_HOIST, **hoist})
    case = Case.model_validate(tomllib.loads(text))
    times = {"time.duration": duration, "time.output_step": 5e-3, "time.step": 2e-4}
    return change(case, **times)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("bending", "duration", "hoist", "within"),
    [
        # 0.5 % of the length: the estimate is small, too, and on the safe side, 0.011 and 0.007.
        (2.0e8, 1.5, {"mass": 300.0, "travel": 0.5}, (1.0, 1.6)),
        # 12 % of the length: 0.080 estimated, 0.086 found.
        (2.0e7, 3.0, {"mass": 2000.0}, (1.0 / 1.2, 1.2)),
        # The load hangs at t = 0: 0.34 estimated, 0.35 found.
        (2.0e7, 3.0, {"mass": 2000.0, "travel": 1.0, "hanging": True}, (1.0 / 1.2, 1.2)),
    ],
)
def test_estimated_error_of_a_hoist(
    bending: float, duration: float, hoist: dict[str, object], within: tuple[float, float]
) -> None:
    """Reference: other code, a bar with large rotations; analytic, none of a level boom."""
    case = bar_case(bending, duration, **hoist)
    results = run_case(case)
    exact = tips_of_large_rotations(case, results.trajectories["time"].values)
    tip = results.trajectories["tip"].values[0]
    level = change(case, **{"gravity.angle": 0.0})
    expected, none = (
        straight_path_error(x, static_states(x, build_boom(x), beam_of)) for x in (case, level)
    )
    assert none < 1e-9
    assert within[0] < expected / float(np.abs(tip - exact).max() / np.ptp(tip)) < within[1]
    told = [line for line in check_case(CheckedCase(case)).lines if "caution: hoist:" in line]
    assert told == [line for line in results.summary.cautions if "caution: hoist:" in line]
    assert len(told) == (within[0] < 1.0)
    assert all(f"is off by about {100.0 * expected:.2g} % of its range" in line for line in told)
