# SPDX-License-Identifier: LGPL-3.0-or-later
"""Telescoping booms, also under axial forces: rows, statics, motion, energy balance."""

from collections.abc import Sequence
from dataclasses import replace
from math import copysign, cos, pi, sin
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline
from scipy.linalg import block_diag, eigh

from protractile.beam_model.boom_modes import critical_factor
from protractile.beam_model.finite_element import finite_element_segment, finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.motion_laws import HistorySum, SCurve
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, Joint, PointMass, Segment, Stop
from protractile.geometry.joint import Carrier, Drive
from protractile.geometry.segment import NO_COMPRESSION
from tests.beam_model.exact import Build
from tests.touching import touching

LAW = PowerContact(1.0e6, 1.0).with_clearance(7.0e-3)
DRIVE = Drive(SCurve(4.0, 5.0), ("inner", "outer"))
GRAVITY = 8.5


def shifted(segment: Segment, way: float) -> Segment:
    return replace(segment, start=segment.start + way, end=segment.end + way)


def telescope(boom: Boom, way: float, drive: Drive | None = None, **changes: Any) -> Boom:
    """Return the paper's boom with an overlap of 5 m, reduced by an initial extension in m."""
    outer, inner = boom.segments
    inner = shifted(inner, way - 4.0)
    joint = replace(boom.joints[0], stations=(inner.start, outer.end), drive=drive, **changes)
    return replace(boom, segments=(outer, inner), joints=(joint,))


def elements(boom: Boom, length: float = 0.5, rotary_inertia: bool = True) -> GapSystem:
    models = finite_element_segments(boom, length, "euler-bernoulli", rotary_inertia)
    return gap_system(boom, models)


def tips(system: GapSystem) -> list[float]:
    """Return the outputs of the ends at rest."""
    rest = equilibrium(system, system.load)
    return [float(system.observers[name].row @ rest) for name in ("tip", "head", "tail")]


# The longest element in m.
LONGEST = 3.0
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)


def softened(rows: CubicHermiteSpline, start: float, end: float) -> Array:
    """Return ∫ w′ᵀ w′ dx (num_dofs, num_dofs) of the rows of a beam from start to end in m."""
    edges = np.array([start, *rows.x[(rows.x > start) & (rows.x < end)], end])
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    slopes = rows((middle[:, None] + np.outer(half, POINTS)).ravel(), 1)
    return np.asarray((slopes.T * np.outer(half, WEIGHTS).ravel()) @ slopes)


def runge_kutta(boom: Boom, history: SCurve, times: Array, thrust: float) -> tuple[Array, float]:
    """Return the tip deflection (num_times,) in m and the work of the drive in J by Hermite
    elements of ``LONGEST``, whose rows are read where the segments touch.

    A thrust in N compresses the inner segment, and the outer segment up to the tail of the inner
    one.
    """
    plain = [replace(one, compression=NO_COMPRESSION) for one in boom.segments]
    outer, inner = (
        finite_element_segment(one, LONGEST, own, "euler-bernoulli", False).components["z"]
        for one, own in zip(plain, (boom.stations_of(0), boom.stations_of(1)), strict=True)
    )
    n, ends = len(outer.load), len(outer.load) + len(inner.load)
    stiffness, mass = (
        block_diag(getattr(outer, name), getattr(inner, name)) for name in ("stiffness", "mass")
    )
    of_outer, of_inner = (
        CubicHermiteSpline(b := one.breaks, *([one.at(x, k) for x in b] for k in (0, 1)))
        for one in (outer, inner)
    )
    tail, head = boom.joints[0].stations
    stiffness[n:, n:] -= thrust * softened(of_inner, tail, boom.tip)
    inverse = np.linalg.inv(mass)
    turned, pushed = -inverse @ stiffness, inverse @ np.concatenate([outer.load, inner.load])

    def change(time: float, state: Array) -> Array:
        part = min(max(time / history.duration, 0.0), 1.0)
        way = history.travel * (part - sin(2 * pi * part) / (2 * pi))
        speed = history.travel / history.duration * (1 - cos(2 * pi * part))
        q, v = state[:ends], state[ends:-1]
        pull = np.zeros(ends)
        pull[:n] = thrust * softened(of_outer, 0.0, tail + way) @ q[:n]
        power = -0.5 * thrust * speed * (of_outer(tail + way, 1) @ q[:n]) ** 2
        for x_outer, x_inner, moved in ((tail + way, tail, 0), (head, head - way, 1)):
            row = np.concatenate([-of_outer(x_outer), of_inner(x_inner)])
            gap = row @ q
            if abs(gap) > 7.0e-3:
                force = 1.0e6 * (gap - copysign(7.0e-3, gap))
                pull -= force * row
                slope = of_inner(x_inner, 1) @ q[n:] if moved else of_outer(x_outer, 1) @ q[:n]
                power -= force * speed * slope
        return np.concatenate([v, turned @ q + pushed + inverse @ pull, [power]])

    start = np.zeros(2 * ends + 1)
    found = solve_ivp(
        change, (0.0, times[-1]), start, "DOP853", times, rtol=1e-8, atol=1e-11, max_step=2e-3
    )
    return inner.at(boom.tip) @ found.y[n:ends], float(found.y[-1, -1])


def three(boom: Boom, ways: tuple[float, float], drives: Sequence[Drive | None]) -> Boom:
    """Return three segments, with a stop below the last one, and dashpots at the first joint."""
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


def test_three_segments_a_stop_and_dashpots_on_the_way(paper_boom: Boom) -> None:
    """Reference: analytic, the boom built there; the stop's row is at the new position."""
    drives = (Drive(SCurve(1.0, 2.0), ("inner", "outer")), Drive(SCurve(2.0, 2.0), DRIVE.carriers))

    def built(ways: tuple[float, float], drives: Sequence[Drive | None]) -> GapSystem:
        return elements(touching(three(paper_boom, ways, drives), [LAW, LAW]))

    system, there = built((0.0, 0.0), drives).at_time(2.0), built((1.0, 2.0), (None, None))
    histories = [travel.history for travel in built((0.0, 0.0), drives).travels]
    assert [len(one.parts) for one in histories if isinstance(one, HistorySum)] == [1, 1, 2]
    assert tips(system) == pytest.approx(tips(there), rel=1e-8)
    for rows in ("rows", "dashpots"):
        found, expected = ((r := getattr(s, rows)) @ r.T for s in (system, there))
        assert found == pytest.approx(expected, rel=1e-8, abs=1e-12)


def test_in_space_the_rows_turn_with_the_sections(spatial_boom: Boom) -> None:
    """Reference: analytic, the boom in space built at this extension."""

    def built(way: float, drive: Drive | None) -> GapSystem:
        boom = telescope(spatial_boom, way, drive, friction=0.2)
        boom = replace(boom, segments=with_compression(boom.segments, boom.joints, [], GRAVITY))
        return elements(touching(boom, LAW, LAW), length=0.5)

    system, there = built(0.0, DRIVE).at_time(5.0), built(4.0, None)
    assert frequencies(system) == pytest.approx(frequencies(there), rel=1e-6)
    plain = replace(system, geometric_stiffness=np.zeros((0, 0)))
    assert (frequencies(plain) > 1.00005 * frequencies(there)).sum() >= 2
    for rows in ("rows", "friction_rows"):
        found, expected = ((r := getattr(s, rows)) @ r.T for s in (system, there))
        assert found == pytest.approx(expected, rel=1e-8, abs=1e-10)


@pytest.mark.slow
def test_an_integration_of_its_own(paper_boom: Boom) -> None:
    """Reference: other code, Hermite elements, moving rows and thrust by DOP853. Order 2."""
    history = SCurve(2.0, 0.2)
    boom = telescope(paper_boom, 0.0, Drive(history, DRIVE.carriers))
    segments = tuple(replace(segment, rotary_inertia=0.0) for segment in boom.segments)
    ropes = [Thrust(1, segments[1].end, 1.0e5)]
    boom = replace(boom, segments=with_compression(segments, boom.joints, ropes))
    system = elements(touching(boom, LAW), length=LONGEST, rotary_inertia=False)
    runs = [FixedStep(step)(Motion(system, 0.2, 5.0e-3)) for step in (2.0e-5, 1.0e-5)]
    tip, work = runge_kutta(boom, history, runs[0].time, 1.0e5)
    assert runs[0].data.attrs["contact_changes"] > 2
    errors = [np.abs(run.data["tip"].values - tip).max() / np.ptp(tip) for run in runs]
    assert errors[1] < 1.0e-5
    assert errors[1] < 0.4 * errors[0]
    assert float(runs[1].data["drive_work"][-1]) == pytest.approx(work, rel=1e-4)


def pressed(
    boom: Boom, way: float, drive: Drive | None = None, locked: float | None = None
) -> Boom:
    """Return the paper's boom at an extension in m, with a payload, axial weight and a rope."""
    free = telescope(boom, way, drive, locked_at=locked)
    outer, inner = free.segments
    inner = replace(inner, masses=(PointMass(inner.end, 300.0),))
    ropes = [Thrust(1, inner.end, 1.5e4)]
    return replace(free, segments=with_compression((outer, inner), free.joints, ropes, GRAVITY))


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
    """Return the three lowest frequencies in Hz of the boom with springs as contacts."""
    stiffness = system.stiffness + 1.0e6 * system.rows.T @ system.rows
    found = eigh(stiffness, eigvals_only=True, subset_by_index=[0, 2])
    return np.asarray(np.sqrt(found) / (2.0 * np.pi))


@pytest.mark.parametrize(
    ("kind", "lock"),
    [*((kind, LOCKS[0]) for kind in BUILDS), *(("Euler-Bernoulli", lock) for lock in LOCKS[1:])],
)
def test_a_pressed_boom_on_the_way_is_the_boom_built_there(
    paper_boom: Boom, kind: str, lock: tuple[Carrier, float | None]
) -> None:
    """Reference: other code path, the boom built there: statics, frequencies, buckling."""
    build, (carrier, x) = BUILDS[kind], lock
    boom = pressed(paper_boom, 0.0, replace(DRIVE, locked=carrier), x)
    system = gap_system(touching(boom, LAW), build(boom))
    factors = []
    for way, time in ((0.0, 0.0), (2.0, 2.5), (4.0, 5.0)):
        along = x + way if x is not None and carrier == "inner" else x
        still = pressed(paper_boom, way, None, along)
        there = gap_system(touching(still, LAW), build(still))
        stands = system.at_time(time)
        assert tips(stands) == pytest.approx(tips(there), rel=1e-6)
        assert frequencies(stands) == pytest.approx(frequencies(there), rel=1e-6)
        factors.append(critical_factor(still, build(still)))
    assert critical_factor(boom, build(boom)) == pytest.approx(factors[-1], rel=1e-6)
    assert factors[-1] is not None
    assert 1.5 < factors[-1] < 0.7 * float(factors[0] or 0.0)
