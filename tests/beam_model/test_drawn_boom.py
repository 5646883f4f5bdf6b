# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms that are drawn out: their rows, statics on the way, an integration of its own."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from dynamics.contact import PowerContact
from dynamics.drive.travel import SCurve, Stroke, Together
from dynamics.equilibrium import equilibrium
from dynamics.excitation import History, Table
from dynamics.gap_system import GapSystem
from dynamics.integrator import FixedStep
from dynamics.motion import Motion
from geometry.boom import Boom, BoomError, Joint, Stop, Support
from geometry.joint import Drive
from tests.beam_model.drawn import DRAWN, LAW, LONGEST, runge_kutta, shifted, telescope, tips
from tests.beam_model.systems import finite_element_system, kantorovich_system
from tests.touching import touching


def three(boom: Boom, ways: tuple[float, float], drives: Sequence[Drive | None]) -> Boom:
    """Three segments, a rest on the ground below the last one, dashpots across the first joint."""
    outer, inner = boom.segments
    middle = shifted(inner, ways[0] - 3.0)
    last = replace(shifted(inner, sum(ways) + 3.0), name="last", section=None)
    stops = (Stop(2, 16.0, 0.04, PowerContact(0.0, 1.0, stiffness_below=1.0e6)),)
    stations = (middle.start, outer.end), (last.start, middle.end)
    joints = (
        Joint(0, 1, stations[0], play=0.014, dashpot=300.0, drive=drives[0]),
        Joint(1, 2, stations[1], play=0.014, drive=drives[1]),
    )
    plain = (replace(outer, section=None), replace(middle, section=None))
    return Boom((*plain, last), joints, stops=stops)


SYSTEMS: dict[str, Callable[[Boom], GapSystem]] = {
    "Euler-Bernoulli": lambda boom: finite_element_system(touching(boom, LAW), element_length=0.5),
    "Timoshenko": lambda boom: finite_element_system(
        touching(boom, LAW), element_length=0.5, theory="timoshenko"
    ),
    "series": lambda boom: kantorovich_system(touching(boom, LAW), (4, 6), base="complete"),
}


@pytest.mark.parametrize("kind", SYSTEMS)
def test_standing_on_the_way_is_the_boom_built_there(paper_boom: Boom, kind: str) -> None:
    """Reference: analytic, the boom whose segments lie there, with nodes at the same places."""
    system = SYSTEMS[kind](telescope(paper_boom, 0.0, DRAWN))
    for way, time in ((0.0, 0.0), (2.0, 2.5), (4.0, 5.0)):
        there = SYSTEMS[kind](telescope(paper_boom, way))
        assert tips(system.standing(time)) == pytest.approx(tips(there), rel=1e-7)
    assert tips(system)[0] < 0.5 * tips(there)[0]


def test_three_segments_a_stop_and_dashpots_on_the_way(paper_boom: Boom) -> None:
    """Reference: analytic, the boom whose segments lie there; a stop reads the last segment where
    both joints have drawn it to.
    """
    drives = (Drive(SCurve(1.0, 2.0), ("inner", "outer")), Drive(SCurve(2.0, 2.0), DRAWN.carriers))

    def built(ways: tuple[float, float], drives: Sequence[Drive | None]) -> GapSystem:
        return finite_element_system(touching(three(paper_boom, ways, drives), [LAW, LAW]))

    system, there = built((0.0, 0.0), drives).standing(2.0), built((1.0, 2.0), (None, None))
    assert [type(t.history) for t in built((0.0, 0.0), drives).travels] == [
        SCurve, SCurve, Together,
    ]  # fmt: skip
    assert tips(system) == pytest.approx(tips(there), rel=1e-8)
    for rows in ("rows", "dashpots"):
        found, expected = ((r := getattr(s, rows)) @ r.T for s in (system, there))
        assert found == pytest.approx(expected, rel=1e-8, abs=1e-12)


def test_in_space_the_rows_turn_with_the_sections(spatial_boom: Boom) -> None:
    """Reference: analytic, the boom in space whose segments lie there."""

    def built(way: float, drive: Drive | None) -> GapSystem:
        boom = telescope(spatial_boom, way, drive, friction=0.2)
        return finite_element_system(touching(boom, LAW, LAW), element_length=0.5)

    system, there = built(0.0, DRAWN).standing(5.0), built(4.0, None)
    for rows in ("rows", "friction_rows"):
        found, expected = ((r := getattr(s, rows)) @ r.T for s in (system, there))
        assert found == pytest.approx(expected, rel=1e-8, abs=1e-10)
    run = FixedStep(5.0e-5)(Motion(built(0.0, Drive(SCurve(4.0, 0.5), DRAWN.carriers)), 0.5))
    assert run.energy_residual < 1.0e-3
    assert float(np.abs(run.data["drive_work"]).max()) > 0.0


@pytest.mark.slow
def test_a_slow_drive_follows_the_statics(paper_boom: Boom) -> None:
    """Reference: analytic, the rest of each position, within 0.1 % of the tip's deflection."""
    boom = telescope(paper_boom, 1.0, Drive(SCurve(3.0, 80.0), DRAWN.carriers))
    system = finite_element_system(touching(boom, LAW), element_length=1.0)
    system = replace(system, damping=np.ones(system.num_modes))
    rest = equilibrium(system, system.load)
    run = FixedStep(1.0e-4)(Motion(system, 80.0, 0.1, position=rest))
    for time in np.linspace(0.0, 80.0, 9):
        there = tips(system.standing(time))[0]
        found = float(run.data["tip"].sel(time=time, method="nearest"))
        assert found == pytest.approx(there, rel=1.0e-3)
    assert float(run.data["tip"][-1]) > 2.0 * float(run.data["tip"][0])
    # Loads give twice what is stored; the rest goes to the drive, which a boom pushes out.
    stored = sum(run.data[name] for name in ("strain_energy", "contact_energy"))
    gained, work, drive = (
        float(one[-1] - one[0]) for one in (stored, run.data["work"], run.data["drive_work"])
    )
    assert work + drive == pytest.approx(gained, rel=0.02)
    assert drive < -0.2 * work


@pytest.mark.slow
def test_an_integration_of_its_own(paper_boom: Boom) -> None:
    """Reference: other code, Hermite elements with moving rows by Runge and Kutta's method
    (DOP853), assembled here; a second-order approach to it.
    """
    history = SCurve(4.0, 0.6)
    boom = telescope(paper_boom, 0.0, Drive(history, DRAWN.carriers))
    segments = tuple(replace(segment, rotary_inertia=0.0) for segment in boom.segments)
    boom = replace(boom, segments=segments)
    system = finite_element_system(
        touching(boom, LAW), element_length=LONGEST, rotary_inertia=False
    )
    runs = [FixedStep(step)(Motion(system, 0.6, 5.0e-3)) for step in (2.0e-5, 1.0e-5)]
    tip, work = runge_kutta(boom, history, runs[0].time)
    assert runs[0].data.attrs["contact_changes"] > 2
    errors = [np.abs(run.data["tip"].values - tip).max() / np.ptp(tip) for run in runs]
    assert errors[1] < 1.0e-5
    assert errors[1] < 0.4 * errors[0]
    assert float(runs[1].data["drive_work"][-1]) == pytest.approx(work, rel=1e-4)
    # Without the drive the tip is elsewhere.
    still = FixedStep(2.0e-5)(Motion(replace(system, travels=()), 0.6, 5.0e-3))
    assert np.abs(still.data["tip"].values - tip).max() > 0.05 * np.ptp(tip)


@pytest.mark.slow
def test_the_ledger_of_the_papers_boom(paper_boom: Boom) -> None:
    """Reference: analytic, the balance within 1e-5 of the load's work, with friction as well."""
    joint = {"friction": 0.2, "normal_forces": (45.0, 50.0), "dashpot": 50.0}
    for changes in ({}, joint):
        boom = telescope(paper_boom, 0.0, Drive(Stroke(4.0, 4.0, 0.2), DRAWN.carriers), **changes)
        system = finite_element_system(touching(boom, LAW), element_length=1.0)
        run = FixedStep(1.0e-5)(Motion(system, 1.5))
        put_in = float(np.abs(run.data["work"]).max())
        assert run.energy_residual < 1.0e-5
        assert abs(float(run.data["drive_work"][-1])) > 0.01 * put_in
        assert (float(run.data["friction_loss"][-1]) > 0.01 * put_in) == bool(changes)


def test_out_and_in_again(paper_boom: Boom) -> None:
    """Reference: analytic, the same boom at rest: what never touches swings on as it did."""
    there_and_back = Table([0.0, 0.2, 0.4], [0.0, 4.0, 0.0])
    boom = telescope(paper_boom, 0.0, Drive(there_and_back, DRAWN.carriers))
    boom = replace(boom, segments=tuple(replace(one, load=0.0) for one in boom.segments))
    system = finite_element_system(touching(boom, LAW), element_length=1.0)
    speeds = 1.0e-3 * np.cos(np.arange(system.num_modes))
    drawn, rest = (
        FixedStep(1.0e-4)(Motion(one, 0.4, 1.0e-2, velocity=speeds))
        for one in (system, replace(system, travels=()))
    )
    assert drawn.data.attrs["contact_changes"] == 0
    assert np.abs(drawn.states - rest.states).max() < 1.0e-9 * np.abs(rest.states).max()
    gaps = drawn.data["gap"].values
    assert np.abs(gaps[20] - rest.data["gap"].values[20]).max() > 0.01 * np.abs(gaps[20]).max()
    assert gaps[-1] == pytest.approx(rest.data["gap"].values[-1], rel=1e-6, abs=1e-12)


def drawn(history: History, least: float = 0.0) -> Drive:
    return Drive(history, DRAWN.carriers, least)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda boom: telescope(boom, 0.0, drawn(SCurve(4.5, 5.0), 1.0)),
         "joint[1].drive: draws 'inner' out by 4.5 m until 0.5 m of overlap are left; it must "
         "leave at least 1 m"),
        (lambda boom: telescope(boom, 0.0, drawn(SCurve(5.0, 5.0))),
         "joint[1].drive: draws 'inner' out by 5 m until 0 m of overlap are left; it must leave "
         "above 0 m"),
        (lambda boom: telescope(boom, 0.0, drawn(SCurve(-5.5, 5.0))),
         "joint[1].drive: draws 'inner' in by 5.5 m; it must be at most 5 m, where it is wholly "
         "in 'outer'"),
        (lambda boom: telescope(boom, 0.0, drawn(Table([0.0, 1.0], [0.0, 0.0]))),
         "joint[1].drive: draws 'inner' nowhere; leave it out"),
        (lambda boom: telescope(boom, 0.0, DRAWN, tied=True),
         "joint[1].drive: the joint is tied, and nothing slides; leave it out"),
        (lambda boom: replace(boom, joints=(Joint(0, 1, (9.3, 9.5), play=0.014,
            drive=Drive(SCurve(0.3, 1.0), ("inner", "outer"))),)),
         "joint[1].drive: stations pass one another as 'inner' is drawn by 0.3 m; make the travel "
         "shorter, or move them"),
        (lambda boom: replace(boom, joints=(Joint(0, 1, (9.5, 10.0), play=0.014,
            drive=Drive(SCurve(0.6, 1.0), ("outer", "outer"))),)),
         "joint[1].drive: the station at 9.5 m leaves the overlap as 'inner' is drawn by 0.6 m; "
         "make the travel shorter, or move the station"),
        (lambda boom: replace(telescope(boom, 0.0, DRAWN),
            stops=(Stop(1, 6.0, 0.2, PowerContact(1e6, 1.0, stiffness_below=1e6)),)),
         "stop[1].x: 'inner' is drawn past 6 m; it must be there all the way"),
        (lambda boom: replace(telescope(boom, 0.0, DRAWN), segments=(
            telescope(boom, 0.0).segments[0],
            replace(telescope(boom, 0.0).segments[1], supports=(Support(12.0),)))),
         "segment[2].supports: the ground holds 'inner', which a drive moves along; let it hold a "
         "segment that stays, or leave drive out"),
    ],
)  # fmt: skip
def test_drives_that_cannot_be(
    paper_boom: Boom, make: Callable[[Boom], Boom], message: str
) -> None:
    """Reference: what cannot be drawn, in one line."""
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        make(paper_boom)
