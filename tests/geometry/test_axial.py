# SPDX-License-Identifier: LGPL-3.0-or-later
"""Axial forces of each segment, compared with sums by hand."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.dynamics.excitation import PiecewiseLinear, Step
from protractile.geometry.axial import (
    AxialChange,
    MovingForce,
    Thrust,
    axial_force,
    moving_force,
    with_compression,
)
from protractile.geometry.boom import (
    Collar,
    Diaphragm,
    Joint,
    Material,
    PointMass,
    Segment,
    Support,
)
from protractile.geometry.box import BoxSection
from protractile.geometry.joint import Carrier, Drive

STEEL = Material(2.1e11, 0.3, 7850.0)
OUTER = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
INNER = BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005)
# Of both segments in kg/m.
HEAVY, LIGHT = 7850.0 * OUTER.area, 7850.0 * INNER.area
JOINT = Joint(outer=0, inner=1, stations=(6.0, 8.0), play=0.01)


def segments() -> tuple[Segment, Segment]:
    arm = Segment.of_section("arm", 0.0, 8.0, STEEL, OUTER, supports=(Support(1.0), Support(3.0)))
    return arm, Segment.of_section("fly", 6.0, 14.0, STEEL, INNER)


def at(segment: Segment, *places: float) -> list[float]:
    return segment.compression(np.array(places)).tolist()


def test_weights_compress_below_and_pull_behind_the_support() -> None:
    """Reference: analytic. The fly transfers its weight at its tail; the arm's foot is at 1 m."""
    arm, fly = with_compression(segments(), [JOINT], [], gravity=5.0)
    assert at(fly, 6.5, 10.0, 13.9) == pytest.approx(
        [5.0 * LIGHT * length for length in (7.5, 4.0, 0.1)], rel=1e-12
    )
    expected = [-0.5 * HEAVY, 7.0 * HEAVY, 2.5 * HEAVY + 8.0 * LIGHT, HEAVY]
    assert at(arm, 0.5, 6.999999, 5.5, 7.0) == pytest.approx(
        [5.0 * expected[0], 5.0 * 1.000001 * HEAVY, 5.0 * expected[2], 5.0 * expected[3]], rel=1e-9
    )


def test_a_thrust_goes_by_the_lock_into_the_next_segment() -> None:
    """Reference: analytic. Force transfers at the tail by default, at a lock, or at the foot."""
    rope = [Thrust(1, 14.0, 1000.0)]
    for locked, of_fly, of_arm in (
        (None, [1000.0, 1000.0, 1000.0], [1000.0, 0.0, 0.0]),
        (7.5, [0.0, 0.0, 1000.0], [1000.0, 1000.0, 0.0]),
        (2.0, [1000.0, 1000.0, 1000.0], [0.0, 0.0, 0.0]),
    ):
        joint = replace(JOINT, locked_at=locked)
        arm, fly = with_compression(segments(), [joint], rope)
        assert at(fly, 6.5, 7.0, 9.0) == of_fly
        assert at(arm, 5.0, 7.0, 7.9) == of_arm
        assert at(arm, 0.5) == [0.0]
    assert at(arm, 1.5) == [1000.0]


def test_masses_collars_and_diaphragms_weigh_along_the_boom() -> None:
    """Reference: analytic, their masses times the acceleration."""
    arm, fly = segments()
    fly = replace(
        fly,
        masses=(PointMass(14.0, 300.0), PointMass(10.0, 50.0)),
        collars=(Collar((8.0, 9.0), 0.01),),
        diaphragms=(Diaphragm(12.0, 0.02),),
    )
    _, pressed = with_compression((arm, fly), [JOINT], [], gravity=2.0)
    collar, plate = 7850.0 * INNER.perimeter * 0.01, 7850.0 * INNER.enclosed_area * 0.02
    assert at(pressed, 13.0, 11.0, 8.5, 7.0) == pytest.approx(
        [
            2.0 * (LIGHT + 300.0),
            2.0 * (3.0 * LIGHT + 300.0 + plate),
            2.0 * (5.5 * LIGHT + 350.0 + plate + 0.5 * collar),
            2.0 * (7.0 * LIGHT + 350.0 + plate + collar),
        ],
        rel=1e-12,
    )


def test_each_of_three_segments_carries_the_outboard_forces() -> None:
    """Reference: analytic, the sum of the outboard thrusts, with negative tension."""
    arm, fly = segments()
    jib = Segment.of_section("jib", 12.0, 20.0, STEEL, INNER)
    second = Joint(outer=1, inner=2, stations=(12.0, 14.0), play=0.01)
    thrusts = [Thrust(2, 20.0, 700.0), Thrust(1, 13.0, -100.0), Thrust(0, 7.0, 10.0)]
    arm, fly, jib = with_compression((arm, fly, jib), [JOINT, second], thrusts)
    assert at(jib, 13.0, 19.0) == [700.0, 700.0]
    assert at(fly, 7.0, 12.5, 13.5) == pytest.approx([600.0, -100.0, 0.0], abs=1e-9)
    assert at(arm, 5.0, 6.5, 7.5) == pytest.approx([610.0, 10.0, 0.0], abs=1e-9)


def test_axial_forces_and_masses_soften_a_mode() -> None:
    """Reference: analytic, ∫ P w′² dx = P π²/2L and m w² of w = sin πx/L with a mass at L/3."""
    (arm,) = with_compression([segments()[0]], [], [Thrust(0, 8.0, 900.0)])
    x = np.linspace(0.0, 8.0, 81)
    lines = {"z": (x, np.sin(np.pi * x / 8.0)[:, None]), "y": (x, 0.0 * x[:, None])}
    masses = [[PointMass(8.0 / 3.0, 60.0)]]
    found = AxialChange(Step(), [arm.compression], masses, "z").geometric_stiffness([lines])
    # The force ends at the foot, at 1 m.
    bent = 900.0 * (np.pi / 8.0) ** 2 * (3.5 - np.sin(0.25 * np.pi) / (0.5 * np.pi))
    assert found == pytest.approx(np.array([[bent + 0.75 * 60.0]]), rel=1e-5)


@pytest.mark.parametrize(
    ("carrier", "locked", "entered"),
    [
        ("inner", None, MovingForce(0, 6.0, 1, 1000.0 + 40.0 * LIGHT)),
        ("inner", 7.0, MovingForce(0, 7.0, 1, 1000.0 + 40.0 * LIGHT)),
        ("outer", 8.0, MovingForce(1, 8.0, -1, 1000.0 + 40.0 * LIGHT)),
        ("outer", 6.0, MovingForce(1, 6.0, -1, 1000.0 + 40.0 * LIGHT)),
        ("outer", 5.0, None),
    ],
)
def test_drawn_out_a_force_goes_along(
    carrier: Carrier, locked: float | None, entered: MovingForce | None
) -> None:
    """Reference: other code path, the forces in the boom built at this extension."""
    ways = PiecewiseLinear([0.0, 1.0], [0.0, 1.0])
    rope, drive = [Thrust(1, 14.0, 1000.0)], Drive(ways, ("inner", "outer"), 0.0, carrier)
    joint = replace(JOINT, drive=drive, locked_at=locked)
    own = with_compression(segments(), [joint], rope, gravity=5.0)
    found = moving_force(own, [joint], 0)
    if found is not None:
        found = replace(found, force=round(found.force, 6))
    assert found == (None if entered is None else replace(entered, force=round(entered.force, 6)))
    arm, fly = segments()
    for way in (1.0, -1.0):
        along = locked
        if carrier == "inner" and locked is not None:
            along = locked + way
        there = replace(JOINT, locked_at=along)
        drawn = arm, replace(fly, start=6.0 + way, end=14.0 + way)
        expected = with_compression(drawn, [there], [Thrust(1, 14.0 + way, 1000.0)], gravity=5.0)
        for number, moved in ((0, 0.0), (1, way)):
            x = np.linspace(own[number].start, own[number].end, 97)[1:-1] + 1e-3
            here = own[number].compression(x)
            if way > 0.0:
                here = axial_force(own, [joint], number, x, np.array([0.3, way]))[1]
            elif found is not None and found.segment == number:
                here = here + found.change(x, np.array(way))
            assert here == pytest.approx(expected[number].compression(x + moved), abs=1e-6)
