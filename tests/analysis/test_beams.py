# SPDX-License-Identifier: LGPL-3.0-or-later
"""Statics and modes of a boom from Python, without a case file."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import protractile as pt
from protractile.analysis.rows import INITIAL, REST, Rows
from protractile.geometry.axial import with_compression

STEEL = pt.Material(2.1e11, 0.3, 7850.0, yield_strength=355e6)
BOX = pt.BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
LENGTH, FORCE = 8.0, -5.0e3


@pytest.fixture(scope="module")
def arm() -> pt.Boom:
    """Return a cantilever with a force at its tip."""
    clamp = pt.Support(0.0, "clamped")
    segment = pt.Segment.of_section("arm", 0.0, LENGTH, STEEL, BOX, supports=(clamp,))
    return pt.Boom([segment], [], loads=[pt.Load("arm", "z", FORCE, x=LENGTH, history=pt.Step())])


@pytest.fixture(scope="module")
def telescope() -> pt.Boom:
    """Return two segments with play, slide pads and a gust in the plane."""
    clamp = pt.Support(0.0, "clamped")
    arm = pt.Segment.of_section("arm", 0.0, 8.0, STEEL, BOX, supports=(clamp,))
    inner = pt.BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005)
    fly = pt.Segment.of_section("fly", 6.0, 14.0, STEEL, inner)
    pad = pt.Pad(length=0.1, width=0.08, thickness=0.02, modulus=2e9)
    joint = pt.Joint("arm", "fly", stations=(6.0, 8.0), play=0.010, pad=pad)
    gust = pt.Load("fly", "z", -500.0, x=14.0, history=pt.Ramp(0.1))
    return pt.with_weight(pt.Boom([arm, fly], [joint], loads=[gust]), angle=30.0)


def value(rows: Rows, quantity: str, state: str = REST) -> float:
    (row,) = rows.where(quantity=quantity, state=state)
    return row.value


def test_a_cantilever_has_the_results_of_a_handbook(arm: pt.Boom) -> None:
    """Reference: analytic, F L³/3EI + F L/GA_s, F L, F, and F L h/2J (Timoshenko 1955)."""
    rows, curves = pt.statics(arm)
    (segment,) = arm.segments
    bent = FORCE * LENGTH**3 / (3.0 * segment.bending_stiffness)
    tip = bent + FORCE * LENGTH / segment.shear_stiffness
    assert value(rows, "tip") == pytest.approx(tip, rel=1e-6)
    assert abs(value(rows, "bending_moment")) == pytest.approx(abs(FORCE) * LENGTH, rel=1e-6)
    assert abs(value(rows, "reaction")) == pytest.approx(abs(FORCE), rel=1e-6)
    height = 0.5 * BOX.height + 0.5 * BOX.flange
    stress = abs(FORCE) * LENGTH * height / BOX.second_moment_of_area
    (row,) = rows.where(quantity="stress", state=REST)
    assert abs(row.value) == pytest.approx(stress, rel=1e-6)
    assert (row.x, row.utilisation) == (0.0, pytest.approx(stress / 355e6, rel=1e-6))
    (curve,) = curves
    np.testing.assert_allclose(
        np.abs(curve.values["moment"]), np.abs(FORCE) * (LENGTH - curve.x), rtol=1e-6, atol=1e-3
    )


def test_a_cantilever_has_the_frequency_of_a_handbook(arm: pt.Boom) -> None:
    """Reference: analytic, (βL)² = 3.51602 of a slender beam; shear lowers it by less than 2 %."""
    rows, curves = pt.modes(arm)
    (segment,) = arm.segments
    speed = np.sqrt(segment.bending_stiffness / segment.mass_per_length) / LENGTH**2
    slender = 3.51602 * speed / (2.0 * np.pi)
    first = rows.where(state=INITIAL)[0].value
    assert 0.98 * slender < first < slender
    (shape,) = curves.where(state="mode 1")
    assert shape.values["deflection"][[0, -1]] == pytest.approx([0.0, 1.0], abs=1e-9)


def test_results_scale_with_loads_where_nothing_is_nonlinear(arm: pt.Boom) -> None:
    """Reference: analytic, linearity."""
    (load,) = arm.loads
    thrice = replace(arm, loads=[replace(load, magnitude=3.0 * FORCE)])
    for row, other in zip(pt.statics(arm).rows, pt.statics(thrice).rows, strict=True):
        assert other.key == row.key
        assert other.value == pytest.approx(3.0 * row.value, rel=1e-9)


def test_two_halves_of_a_load_are_the_load(telescope: pt.Boom) -> None:
    """Reference: analytic, superposition of loads; with play, since both act together."""
    halves = [
        half
        for load in telescope.loads
        for half in 2 * [replace(load, magnitude=0.5 * load.magnitude)]
    ]
    split = pt.statics(replace(telescope, loads=halves)).rows
    for row, other in zip(pt.statics(telescope).rows, split, strict=True):
        assert other.key == row.key
        assert other.value == pytest.approx(row.value, rel=1e-7, abs=1e-7 * abs(row.value) + 1e-12)


def test_pads_carry_the_forces_of_their_stations(telescope: pt.Boom) -> None:
    """Reference: by hand, a pair of pads at the loaded side of each station."""
    rows = pt.statics(telescope).rows.where(state=REST)
    for station in ("station 1", "station 2"):
        (force,) = rows.where(quantity="contact_force", place=station)
        pads = [row for row in rows.where(quantity="pad_force") if row.place.startswith(station)]
        assert 2.0 * max(row.value for row in pads) == pytest.approx(abs(force.value), rel=1e-9)
        assert min(row.value for row in pads) == 0.0
        (pressed,) = (
            row for row in rows.where(quantity="pad_pressure") if row.place == pads[0].place
        )
        assert pressed.value == pytest.approx(pads[0].value / (0.1 * 0.08), rel=1e-9)


def test_a_segment_counts_the_stations_of_all_its_joints(telescope: pt.Boom) -> None:
    """Reference: by construction, one joint with two stations or two joints with one each."""
    (joint,) = telescope.joints
    split = replace(telescope, joints=[replace(joint, stations=(x,)) for x in joint.stations])
    rows, whole = (pt.statics(boom).rows for boom in (split, telescope))
    for quantity in ("contact_force", "pad_force"):
        of_split, of_whole = (one.where(quantity=quantity, state=REST) for one in (rows, whole))
        assert [row.key for row in of_split] == [row.key for row in of_whole]
        values = [row.value for row in of_whole]
        assert [row.value for row in of_split] == pytest.approx(values, rel=1e-6)


def test_proofs_compare_states_of_each_combination(arm: pt.Boom) -> None:
    """Reference: by hand, half the yield strength, and the larger of two forces governs."""
    forces = {name: pt.Load("arm", "z", 3.0 * FORCE, x=x, history=pt.Step())
              for name, x in (("far", LENGTH), ("near", 0.5 * LENGTH))}  # fmt: skip
    found = pt.prove(
        arm,
        {name: [load] for name, load in forces.items()},
        resistance=pt.Resistance(material=2.0),
        permitted_tip=0.5,
    )
    assert [*found] == sorted(found, key=lambda row: -(row.utilisation or 0.0))
    assert {row.state for row in found} == {"combination far"}
    (strength,) = found.where(quantity="yield", part="arm")
    height = 0.5 * BOX.height + 0.5 * BOX.flange
    bent = 4.0 * abs(FORCE) * LENGTH * height / BOX.second_moment_of_area
    assert strength.limit == 355e6 / 2.0
    # Shear adds less than 1 % to the equivalent stress.
    assert bent <= strength.value < 1.01 * bent
    (tip,) = found.where(quantity="deflection")
    assert tip.value == pytest.approx(4.0 * abs(value(pt.statics(arm).rows, "tip")), rel=1e-6)
    only = pt.prove(arm, {"own": []}, requested=["deflection"], permitted_tip=0.5)
    assert [row.quantity for row in only] == ["deflection"]


def test_a_motion_is_evaluated_as_a_run_of_a_case(telescope: pt.Boom) -> None:
    """Reference: other code path, the tip of the trajectory and the deflection at rest."""
    beam = pt.BeamElements(telescope, theory="timoshenko")
    motion = beam.simulate(0.3)
    rows, curves = beam.evaluate(motion)
    (moved,) = rows.where(quantity="tip", state="motion")
    tips = motion.data["tip"].values
    assert abs(moved.value) == np.abs(tips).max()
    assert moved.value == tips[np.isclose(motion.time, moved.time)][0]
    (rest,) = rows.where(quantity="tip", state=REST)
    assert rows.dynamic_factor(moved) == abs(moved.value) / abs(rest.value)
    names = {curve.state for curve in curves}
    assert {REST, "minimum", "maximum", "mode 1"} <= names


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"requested": ["yeild"]}, "'yeild' is no kind of proof by beams; give 'yield', 'plate'"),
        ({"requested": ["patch"]}, "'patch' is no kind of proof by beams"),
        ({"permitted_tip": 0.0}, "permitted_tip: must be a number above 0"),
        ({"resistance": pt.Resistance(pad=-1.0)}, "resistance.pad: must be a number above 0"),
    ],
)
def test_a_wrong_request_is_an_error(arm: pt.Boom, wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(pt.BoomError, match=message):
        pt.prove(arm, {"own": []}, **wrong)


def test_the_combination_without_an_equilibrium_is_named(arm: pt.Boom) -> None:
    """Reference: analytic, about 50 times the buckling force of a cantilever (Euler 1744)."""
    thrust = pt.Thrust("arm", x=LENGTH, force=1e8)
    buckled = replace(arm, segments=with_compression(arm.segments, [], [thrust]))
    with pytest.raises(pt.NumericsError, match="far: the boom has no static equilibrium"):
        pt.prove(buckled, {"far": []})


def test_plates_that_bend_leave_the_force_to_pads_at_corners() -> None:
    """Reference: by hand, E A/t of the pads at the corner, which carry the whole force.

    The pads away from the corners would have to bend the plates by more than those at the corners
    are pressed in. Shares as the pads are stiff would be 1 to 2.
    """
    clamp = pt.Support(0.0, "clamped")
    base = pt.Segment.of_section("arm", 0.0, 8.0, STEEL, BOX, supports=(clamp,))
    inner = pt.BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005)
    fly = pt.Segment.of_section("fly", 6.0, 14.0, STEEL, inner)
    pads = tuple(
        pt.SlidePad(
            side=side, length=length, width=0.03, thickness=0.02, modulus=2e9, bears="wall",
            offset=offset,
        )
        for side, length, offset in (
            ("above", 0.1, 0.0), ("below", 0.1, 0.0), ("below", 0.2, 0.04),
        )
    )  # fmt: skip
    joint = pt.Joint("arm", "fly", stations=(6.0, 8.0), play=0.010, pads=pads)
    load = pt.Load("fly", "z", -1000.0, x=14.0, history=pt.Step())
    rows = pt.statics(pt.Boom([base, fly], [joint], loads=[load])).rows.where(state=REST)
    whole, pressed, corner, beside = (
        rows.where(quantity=quantity, place=f"station 2{name}")[0].value
        for quantity, name in (
            ("contact_force", ""), ("penetration", ""),
            ("pad_force", ", below"), ("pad_force", ", below 2"),
        )
    )  # fmt: skip
    assert corner == pytest.approx(2e9 * 0.1 * 0.03 / 0.02 * pressed, rel=1e-6)
    assert [2.0 * corner, beside] == pytest.approx([abs(whole), 0.0], rel=1e-6)
