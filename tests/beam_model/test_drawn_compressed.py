# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms that axial forces press while they are drawn out: on the way, slowly, in motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import eigh

from beam_model.boom_modes import critical_factor
from beam_model.component import SegmentModel
from beam_model.finite_element import finite_element_segments
from beam_model.kantorovich import kantorovich_segments
from beam_model.segment_model import gap_system
from dynamics.arrays import Array
from dynamics.drive.travel import SCurve, Stroke
from dynamics.equilibrium import equilibrium
from dynamics.gap_system import GapSystem
from dynamics.integrator import FixedStep
from dynamics.motion import Motion
from geometry.axial import Thrust, with_compression
from geometry.boom import Boom, PointMass
from geometry.joint import Carrier, Drive
from tests.beam_model.drawn import DRAWN, LAW, LONGEST, runge_kutta, telescope, tips
from tests.beam_model.systems import finite_element_system
from tests.touching import touching

GRAVITY = 8.5
THRUST = 1.5e4


def pressed(
    boom: Boom, way: float, drive: Drive | None = None, locked: float | None = None
) -> Boom:
    """The paper's boom drawn out by a way in m, with a payload, its weight along it and a rope."""
    drawn = telescope(boom, way, drive, locked_at=locked)
    outer, inner = drawn.segments
    inner = replace(inner, masses=(PointMass(inner.end, 300.0),))
    ropes = [Thrust(1, inner.end, THRUST)]
    return replace(drawn, segments=with_compression((outer, inner), drawn.joints, ropes, GRAVITY))


Build = Callable[[Boom], list[SegmentModel]]

BUILDS: dict[str, Build] = {
    "Euler-Bernoulli": lambda boom: finite_element_segments(boom, 0.5, "euler-bernoulli", True),
    "Timoshenko": lambda boom: finite_element_segments(boom, 0.5, "timoshenko", True),
    "series": lambda boom: kantorovich_segments(boom, (6, 8), "complete", True),
}

# On what the place sits where axial force passes, and its x in m: the inner tail, a place on the
# inner segment, the outer head, a foot below the tail.
LOCKS: list[tuple[Carrier, float | None]] = [
    ("inner", None),
    ("inner", 5.5),
    ("outer", 10.0),
    ("outer", 3.0),
]


def frequencies(system: GapSystem) -> Array:
    """(3,) the lowest ones in Hz of the boom whose contacts are springs."""
    stiffness = system.stiffness + 1.0e6 * system.rows.T @ system.rows
    found = eigh(stiffness, eigvals_only=True, subset_by_index=[0, 2])
    return np.asarray(np.sqrt(found) / (2.0 * np.pi))


@pytest.mark.parametrize("kind", BUILDS)
@pytest.mark.parametrize("lock", LOCKS)
def test_on_the_way_it_is_the_boom_built_there(
    paper_boom: Boom, kind: str, lock: tuple[Carrier, float | None]
) -> None:
    """Reference: other code path, the boom whose segments lie there: its rest, its frequencies, and
    the force under which it buckles, which is the smallest where it is farthest out.
    """
    build, (carrier, x) = BUILDS[kind], lock
    boom = pressed(paper_boom, 0.0, replace(DRAWN, locked=carrier), x)
    system = gap_system(touching(boom, LAW), build(boom))
    factors = []
    for way, time in ((0.0, 0.0), (2.0, 2.5), (4.0, 5.0)):
        along = x + way if x is not None and carrier == "inner" else x
        still = pressed(paper_boom, way, None, along)
        there = gap_system(touching(still, LAW), build(still))
        stands = system.standing(time)
        assert tips(stands) == pytest.approx(tips(there), rel=1e-6)
        assert frequencies(stands) == pytest.approx(frequencies(there), rel=1e-6)
        factors.append(critical_factor(still, build(still)))
    assert critical_factor(boom, build(boom)) == pytest.approx(factors[-1], rel=1e-6)
    assert factors[-1] is not None
    assert 1.5 < factors[-1] < 0.7 * float(factors[0] or 0.0)
    # Without the force that goes along it would rest elsewhere.
    first = replace(system, travels=[replace(t, thrusts=()) for t in system.travels])
    moves = x is None or x > 4.0
    off = abs(tips(first.standing(5.0))[0] / tips(there)[0] - 1.0)
    assert (off > 3e-4) == moves


def test_in_space_both_planes_soften(spatial_boom: Boom) -> None:
    """Reference: other code path, the boom in space that lies there."""

    def built(way: float, drive: Drive | None) -> GapSystem:
        boom = pressed(spatial_boom, way, drive)
        return finite_element_system(touching(boom, LAW, LAW), element_length=0.5)

    here, there = built(0.0, DRAWN).standing(5.0), built(4.0, None)
    assert frequencies(here) == pytest.approx(frequencies(there), rel=1e-6)
    plain = replace(here, softening=np.zeros((0, 0)))
    assert (frequencies(plain) > 1.0005 * frequencies(there)).sum() >= 2


@pytest.mark.slow
def test_a_slow_drive_follows_the_second_order_statics(paper_boom: Boom) -> None:
    """Reference: other code path, the rest of the boom that lies there, within 0.1 %."""
    boom = pressed(paper_boom, 2.0, Drive(SCurve(2.0, 60.0), DRAWN.carriers))
    system = finite_element_system(touching(boom, LAW), element_length=1.0)
    system = replace(system, damping=0.2 * np.ones(system.num_modes))
    rest = equilibrium(system, system.load)
    run = FixedStep(1.0e-4)(Motion(system, 60.0, 0.1, position=rest))
    for way, time in ((2.0, 0.0), (3.0, 30.0), (4.0, 60.0)):
        there = finite_element_system(touching(pressed(paper_boom, way), LAW), element_length=1.0)
        found = float(run.data["tip"].sel(time=time, method="nearest"))
        assert found == pytest.approx(tips(there)[0], rel=1.0e-3)
        plain = telescope(paper_boom, way)
        first = tips(finite_element_system(touching(plain, LAW), element_length=1.0))[0]
        assert abs(found / first - 1.0) > 0.01


@pytest.mark.slow
def test_an_integration_of_its_own(paper_boom: Boom) -> None:
    """Reference: other code, Hermite elements with moving rows and a moving thrust by Runge and
    Kutta's method (DOP853), assembled in the tests; a second-order approach to it.
    """
    history = SCurve(4.0, 0.6)
    drawn = telescope(paper_boom, 0.0, Drive(history, DRAWN.carriers))
    outer, inner = (replace(segment, rotary_inertia=0.0) for segment in drawn.segments)
    thrust = 1.0e5
    ropes = [Thrust(1, inner.end, thrust)]
    boom = replace(drawn, segments=with_compression((outer, inner), drawn.joints, ropes))
    system = finite_element_system(
        touching(boom, LAW), element_length=LONGEST, rotary_inertia=False
    )
    runs = [FixedStep(step)(Motion(system, 0.6, 5.0e-3)) for step in (2.0e-5, 1.0e-5)]
    tip, work = runge_kutta(boom, history, runs[0].time, thrust)
    errors = [np.abs(run.data["tip"].values - tip).max() / np.ptp(tip) for run in runs]
    assert errors[1] < 1.0e-5
    assert errors[1] < 0.4 * errors[0]
    assert float(runs[1].data["drive_work"][-1]) == pytest.approx(work, rel=1e-4)
    still = replace(system, travels=[replace(t, thrusts=()) for t in system.travels])
    off = FixedStep(2.0e-5)(Motion(still, 0.6, 5.0e-3)).data["tip"].values - tip
    assert np.abs(off).max() > 3.0e-4 * np.ptp(tip)


@pytest.mark.slow
def test_the_ledger_and_the_order(paper_boom: Boom) -> None:
    """Reference: analytic, the balance to round-off, with friction and dashpots
    as well, and errors that fall with the square of the step.
    """
    joint = {"friction": 0.2, "normal_forces": (45.0, 50.0), "dashpot": 50.0}
    for changes in ({}, joint):
        boom = pressed(paper_boom, 0.0, Drive(Stroke(4.0, 4.0, 0.2), DRAWN.carriers))
        boom = replace(boom, joints=(replace(boom.joints[0], **changes),))
        system = finite_element_system(touching(boom, LAW), element_length=1.0)
        steps = (4.0e-5, 2.0e-5, 1.0e-5)
        runs = [FixedStep(step)(Motion(system, 1.5, 5.0e-3)) for step in steps]
        assert max(run.energy_residual for run in runs) < 1.0e-11
        ends = [run.data["tip"].values for run in runs]
        first, then = (np.abs(b - a).max() for a, b in pairwise(ends))
        assert then < 0.35 * first
        passed = system.travels[0].thrusts[0].softening(4.0)
        taken = 0.5 * runs[-1].states[-1] @ passed @ runs[-1].states[-1]
        assert taken > 2.0e-4 * float(np.abs(runs[-1].data["work"]).max())
