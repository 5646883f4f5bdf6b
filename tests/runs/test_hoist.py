# SPDX-License-Identifier: LGPL-3.0-or-later
"""Hoisting in a case: statics and results of a hanging load, messages for bad input."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from protractile.analysis.bonded import bonded_system
from protractile.analysis.rows import INITIAL, MOTION
from protractile.cases import change, run_case
from protractile.dynamics.arrays import Array
from protractile.dynamics.damping import closed_contact_damping, closed_contact_modes
from protractile.dynamics.equilibrium import equilibrium
from protractile.runs import CASES
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import check_combinations, combined_cases
from protractile.runs.case.load_tables import AxialTable, CombinationTable, LoadCaseTable, LoadTable
from protractile.runs.case.motion_tables import HoistTable, WindTable
from protractile.runs.case.motions import with_initial_slack
from protractile.runs.case.reading import CheckedCase, select
from protractile.runs.case.schema import Case, EnsembleTable
from protractile.runs.check import check_case
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.combinations import combination_rows, combination_states
from protractile.runs.pipeline.models import build, initial_motion
from protractile.runs.pipeline.pad_walls import largest_tip
from protractile.runs.pipeline.statics import boom_with_play, state_at_rest
from tests.runs.case_texts import CLAMPED, REST, STEEL, elements, refusal, shipped, table
from tests.runs.summaries import static_tip

HOIST = (CASES / "hoist.toml").read_text(encoding="utf-8")


@pytest.fixture(scope="module", name="case")
def _case() -> Case:
    return select(shipped("hoist"), "", ["series"])


def test_hanging_load_at_rest(case: Case) -> None:
    """Reference: the same boom under the components of the load across and along it."""
    weight = 5000.0 * 9.80665
    across = LoadTable(segment="fly", x="head", magnitude=-0.5 * weight)  # type: ignore[arg-type] # pydantic reads "head" as a place
    force = case.axial[0].force
    axial = case.axial[0].model_copy(update={"force": force + np.sqrt(0.75) * weight})
    loaded = case.model_copy(update={"hoist": None, "loads": (across,), "axial": (axial,)})
    assert static_tip(case, 5.0) == pytest.approx(static_tip(loaded, 0.0), rel=1e-6)
    assert abs(static_tip(case, 0.0)) < 0.5 * abs(static_tip(case, 5.0))


@pytest.mark.parametrize("mass", [1000.0, 4000.0, 5000.0])
def test_maximum_load_hangs_for_any_mass(case: Case, mass: float) -> None:
    """Reference: the same load that hangs from the start. 4 t had −0.675 m in place of −1.821 m."""
    lifted = change(case, **{"hoist.mass": mass})
    hung = change(lifted, **{"hoist.hanging": True})
    states, hanging = (
        static_states(one, boom_with_play(one, build_boom(one))) for one in (lifted, hung)
    )
    (_, tip), (_, hanging_tip) = largest_tip(states), largest_tip(hanging)
    assert tip == pytest.approx(hanging_tip, rel=1e-6)
    assert tip < 1.2 * states.observed("tip")[0] < 0.0


@pytest.mark.slow
def test_lift_off_does_not_depend_on_the_output_step(case: Case) -> None:
    """Reference: other code path, an output step of 1 ms. A mean over 50 ms is late by 25 ms."""
    times = []
    for step in (1e-3, 5e-2):
        results = run_case(change(case, **{"time.duration": 3.5, "time.output_step": step}))
        found = results.summary.design.models["series"].hoisting
        assert found.lift_off is not None
        times.append(found.lift_off)
    assert times[1] == pytest.approx(times[0], abs=5e-3)


def test_results_of_a_hoist(case: Case) -> None:
    """Reference: the height at which the load leaves the ground, and the energy balance."""
    case = change(case, **{"hoist.phi_2_min": 1.1, "hoist.beta_2": 0.34})
    results = run_case(change(case, **{"time.duration": 4.0, "time.output_step": 2e-3}))
    (summary,) = results.summary.models.values()
    assert summary.energy_residual < 1e-11
    found = results.summary.design.models["series"].hoisting
    data = results.trajectories.sel(model="series")
    height = data["load_height"].values
    # The ground, a hundred times as stiff as four falls, is left at this height.
    left = 5000.0 * 9.80665 / (100.0 * 4.0 * 1.0e11 * 1.1e-4 / 35.0)
    first = data["time"].values[np.argmax(height > left)]
    # The load oscillates on the ground; both times differ by at most a quarter of its 40 ms.
    assert found.lift_off == pytest.approx(first, abs=0.01)
    assert found.force == float(data["rope_force_peak"].max())
    assert found.factor == pytest.approx(found.force / (5000.0 * 9.80665), rel=1e-9)
    assert found.by_class == pytest.approx(1.1 + 0.34 * 0.2)
    assert (found.swing_out, found.swing_aside) == (None, None)


def test_work_of_the_winch(case: Case) -> None:
    """Reference: the energy balance of a horizontal boom, in which only the winch moves rows."""
    results = run_case(change(case, **{"time.duration": 1.0, "gravity.angle": 0.0}))
    drives = results.summary.design.models["series"].drives
    work = float(results.trajectories["drive_work"].values[0, -1])
    assert work > 100.0
    assert drives.winch_work == pytest.approx(work, rel=1e-4)
    force = float(results.trajectories["rope_force"].values.max())
    assert drives.winch_power == pytest.approx(0.2 * force, rel=1e-2)


def test_ensemble_and_comparison_without_play(case: Case) -> None:
    """Reference: energy balance of all members, and the stiffer boom without play."""
    case = change(case, **{"time.duration": 0.6})
    table = EnsembleTable(members=2, vary="load", relative=1e-3, seed=1)
    results = run_case(case.model_copy(update={"ensemble": table}))
    found = results.summary.models["series"].ensemble
    assert found.energy_residual < 1e-11
    tips = results.rows.where(model="series", quantity="tip")
    assert tips.where(state=MOTION, play=False)
    static, bonded = (tips.where(state="rest", play=play)[0].value for play in (True, False))
    assert static < 1.02 * bonded < 0.0


def test_rope_of_a_boom_without_play_is_straight_at_rest(case: Case) -> None:
    """Reference: the series without play. A taut rope would raise the first frequency to 1.9 Hz."""
    boom, (model,) = build_boom(case), case.models
    system = build(case, boom, model).system.gather_loads()
    bonded = bonded_system(system, [equilibrium(system, system.load)])[0]
    same = build(case, boom, model.model_copy(update={"bonded": True})).system.gather_loads()
    own, other = (
        closed_contact_modes(one)[0][0] for one in (with_initial_slack(bonded, case), same)
    )
    assert own == pytest.approx(other, rel=0.02)


@pytest.mark.parametrize("hanging", [True, False])
def test_combinations_have_the_hoisted_mass_as_payload(case: Case, hanging: bool) -> None:
    """Reference: the same load written as a load case's payload, and the rope's pull by hand.

    Combinations of a case with a hoist and without a load case's payload ended with a traceback.
    """
    rope = AxialTable(falls=4)
    factors = {"dead": 1.22, "payload": 1.34}
    combination = CombinationTable.model_validate({"name": "A1", "factors": factors})
    hoist = case.hoist.model_copy(update={"hanging": hanging})
    hung = case.model_copy(
        update={"hoist": hoist, "axial": (rope,), "combinations": (combination,)}
    )
    by_hand = hung.model_copy(
        update={
            "hoist": None,
            "axial": (AxialTable(force=5350.0 * 9.80665 / 4.0),),
            "load_cases": (LoadCaseTable(name="lift", payload=5000.0),),
        }
    )
    own, other = combination_rows(hung), combination_rows(by_hand)
    assert own == tuple(row._replace(state=own[0].state) for row in other)
    (tip,) = own.where(quantity="tip")
    assert tip.value < -2.0
    # An empty hook without a payload leaves the rope without force.
    empty = hung.model_copy(
        update={"payload": None, "load_cases": (LoadCaseTable(name="empty", payload=0.0),)}
    )
    assert next(combined_cases(empty)).case.axial[0].force == 0.0
    check_combinations(empty)
    # Without factors the state is that of the hanging load.
    (plain,) = combination_states(hung.model_copy(update={"combinations": ()}))
    beam = static_states(hung, boom_with_play(hung, build_boom(hung)))
    (tip,) = plain.rows.where(quantity="tip")
    assert tip.value == pytest.approx(largest_tip(beam)[1], rel=1e-6)


def test_check_counts_the_load_on_the_rope() -> None:
    """Reference: a run of beam elements, whose sections are rigid. Those of check distort, too.

    The static states had the load along the boom only: the tip rested at -543 mm.
    """
    checked = CheckedCase(select(shipped("hoist"), "", ["timoshenko"]))
    results = run_case(change(checked.case, **{"time.duration": 5.0, "time.output_step": 0.05}))
    boom = boom_with_play(checked.case, checked.boom)
    rigid, elastic = (
        state_at_rest(checked.case, boom, walls=walls, time=5.0).tip for walls in (0.0, 1.0)
    )
    right = results.rows.where(model="timoshenko", state="rest", quantity="tip")[0].value
    assert right == pytest.approx(-1.816, abs=0.001)
    assert rigid == pytest.approx(right, rel=3e-3)
    frame = check_case(checked).frames["Static results at t = 0 and under the maximum loads"]
    (tip,) = frame[frame.iloc[:, 0] == "tip"]["maximum"]
    assert tip == pytest.approx(1e3 * elastic, rel=1e-6)
    assert {*frame["maximum, unit"]} <= {"mm", "MPa", "kN"}


def test_modes_with_a_heavy_load_have_the_given_damping(case: Case) -> None:
    """Reference: analytic, the ratio of the case; it was 1.81 % in the first mode."""
    hung = HoistTable(mass=20000.0, stiffness=1.0e6, hanging=True)
    case = case.model_copy(update={"hoist": hung})
    motion = initial_motion(build(case, build_boom(case), case.models[0]).system, case)
    ratios = closed_contact_damping(motion.system, motion.position)[1]
    assert ratios[:8] == pytest.approx(0.01, rel=1e-9)


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
    of the pendulum l/(m g). The pendulum of 0.189 Hz was missing, and the first mode at 0.903 Hz.
    """
    text = 'title = "bar"\n' + STEEL + REST + table("[time]", duration=0.02)
    text += table("[gravity]", angle=60.0) + table("[damping]", modal=0.02)
    text += table("[[segment]]", name="bar", length=12.0, mass_per_length=0.1)
    text += f"second_moment_of_area = 2e-5\n{CLAMPED}\n" + model
    text += table("[hoist]", mass=800.0, stiffness=1e6, hanging=True, pendulum=6.0)
    hertz, ratios = at_rest(Case.model_validate(tomllib.loads(text)))
    weight, along = 800.0 * 9.80665, np.array([0.5, -np.sqrt(0.75)])
    k = np.sqrt(-along[1] * weight / (2.1e11 * 2e-5))
    bar = (np.tan(12.0 * k) / k - 12.0) / (-along[1] * weight)
    compliance = bar * np.outer(along, along) + np.diag([1e-6, 6.0 / weight])
    right = 1.0 / (2.0 * np.pi * np.sqrt(800.0 * np.linalg.eigvalsh(compliance)))
    assert hertz[:2] == pytest.approx(right[::-1], rel=1e-3)
    assert ratios[:4] == pytest.approx(0.02, rel=1e-6)


@pytest.mark.parametrize("model", ["timoshenko", "bonded"])
def test_a_load_swings_to_all_sides(model: str) -> None:
    """Reference: analytic, √(g/l)/2π in both directions below a stiff boom, which lowers it a bit.

    Bending a thousand times faster than the pendulum hid it as round-off.
    """
    case = select(shipped("slew"), "", [model])
    stiff = replace(case.material, youngs_modulus=100.0 * case.material.youngs_modulus)
    hertz, ratios = at_rest(case.model_copy(update={"material": stiff}))
    right = np.sqrt(9.80665 / 5.0) / (2.0 * np.pi)
    assert hertz[:2] == pytest.approx(right, rel=1e-3)
    assert hertz[2] > 5.0
    assert ratios[:2] == pytest.approx(0.02, rel=1e-4)


def test_dropped_load(case: Case) -> None:
    """Reference: a force of the same size at the tip that is released at t = 0, boom level."""
    case = change(case, **{"time.duration": 0.4, "gravity.angle": 0.0})
    weight = LoadTable(
        segment="fly",
        x="head",  # type: ignore[arg-type] # read as in a file
        magnitude=-5000.0 * 9.80665,
        released=True,
    )
    hung = HoistTable(mass=5000.0, stiffness=1.0e6, hanging=True, dropped=True)
    tips = [
        run_case(case.model_copy(update=one)).trajectories["tip"].values
        for one in ({"hoist": hung}, {"hoist": None, "loads": (weight,)})
    ]
    assert tips[0] == pytest.approx(tips[1], abs=1e-6)
    assert np.ptp(tips[0]) > 0.1


def test_dropped_load_presses_along_the_boom_until_it_falls() -> None:
    """Reference: analytic, a clamped bar under the constant force P across and along its end.

    The tip is (P cos α/P sin α) (tan kL/k − L) with k² = P sin α/E J.
    Without the force along the bar, it was F L³/(3 E J), 319 mm instead of 337 mm.
    """
    bar = (
        'title = "bar"\n'
        + STEEL
        + REST
        + table("[time]", duration=0.02)
        + table("[gravity]", angle=70.0)
    )
    bar += """
    [[segment]]
    name = "bar"
    length = 20.0
    supports = [{ x = 0.0, kind = "clamped" }]
    mass_per_length = 0.1
    second_moment_of_area = 2e-4
    """
    bar += table("[hoist]", mass=1500.0, stiffness=1e8, hanging=True)
    bar += elements("fe", theory="euler-bernoulli", rotary_inertia=False)
    case = Case.model_validate(tomllib.loads(bar))
    along, across = (1500.0 * 9.80665 * part for part in (np.sin(1.2217305), np.cos(1.2217305)))
    k = np.sqrt(along / (2.1e11 * 2e-4))
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
    hertz = 1.8751**2 / (2.0 * np.pi * 20.0**2) * np.sqrt(2.1e11 * 2e-4 / 0.1)
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
    assert found.swing_out == pytest.approx(500.0 * 2.0 / (5000.0 * 9.80665), rel=1e-6)
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
