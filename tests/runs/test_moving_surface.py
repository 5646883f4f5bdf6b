# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms in motion as a page has them: beams as their sections along their axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from dynamics.drive.travel import SCurve
from dynamics.line import Line
from dynamics.trajectory import Trajectory
from geometry.boom import Boom, Material, Segment, Support
from geometry.drive import Drive
from geometry.section import BoxSection
from runs.pipeline.beam_output import BeamOutput, MovedSegment
from runs.report.extruded import of_beam
from runs.report.moving_surface import LEFT, few_shapes, packed


def bent(boom: Boom) -> BeamOutput:
    """Both segments along w = t x²/100, with the moment of that curvature in each."""
    time = np.array([0.0, 0.5, 1.0])
    segments = []
    for segment in boom.segments:
        x = np.linspace(segment.start, segment.end, 41)
        moment = np.outer(time, segment.bending_stiffness * 0.02 * np.ones(x.size))
        segments.append(
            MovedSegment(x, {"deflection": np.outer(time, x**2 / 100.0), "moment": moment})
        )
    return BeamOutput(time, segments)


def test_sections_stay_plane_and_follow_their_axis(paper_boom: Boom) -> None:
    """Reference (analytic): at the end of the boom w = 3.61 m and w′ = 0.38, of which the points of
    a section at z have z w′ along x; what is drawn is 1 time as large."""
    surface = of_beam(paper_boom, "beam", bent(paper_boom))
    ends = np.flatnonzero(surface.points[:, 0] == paper_boom.tip)
    moved = np.tensordot(surface.parts[-1], surface.shapes[:, ends], axes=1) / surface.magnified
    allowed = 2.0 * LEFT * 3.61
    np.testing.assert_allclose(moved[:, 2], 3.61, atol=allowed)
    z = surface.points[ends, 2]
    # One-sided differences of a parabola over 0.25 m are w″ times half of that off.
    np.testing.assert_allclose(moved[:, 0], -z * 0.38, atol=allowed + 0.0025 * np.abs(z).max())


def test_bending_stress_is_that_of_the_curvature(paper_boom: Boom) -> None:
    """Reference (analytic): σ = E κ z at the flanges of the outer box, κ = 0.02 1/m."""
    surface = of_beam(paper_boom, "beam", bent(paper_boom))
    section = paper_boom.segments[0].section
    assert section is not None
    highest = max(abs(z) for z in section.reach("z"))
    assert surface.colors[0].max() == 0.0
    assert surface.colors[-1].max() == pytest.approx(2.1e5 * 0.02 * highest, rel=1e-9)


def test_a_taper_is_drawn_and_stressed_as_it_is_there() -> None:
    """Reference: by hand, M z/J of boxes of 0.4 and 0.2 m at tail and head, 1 kN m in both."""
    tail, head = (BoxSection(height, 0.2, 0.01, 0.008) for height in (0.4, 0.2))
    steel, clamp = Material(2.1e11, 0.3, 7850.0), Support(0.0, "clamped")
    arm = Segment.of_section("arm", 0.0, 8.0, steel, tail, head_section=head, supports=(clamp,))
    x, one = np.linspace(0.0, 8.0, 5), np.ones((1, 5))
    moved = MovedSegment(x, {"deflection": 0.0 * one, "moment": 1e3 * one})
    surface = of_beam(Boom((arm,), (), ()), "beam", BeamOutput(np.zeros(1), [moved]))
    for place, box in ((0.0, tail), (8.0, head)):
        there = surface.points[:, 0] == place
        half = 0.5 * box.height
        assert np.ptp(surface.points[there, 2]) == pytest.approx(2.0 * half * surface.enlarged)
        stress = 1e-6 * 1e3 * half / box.second_moment_of_area
        assert surface.colors[0, there].max() == pytest.approx(stress, rel=1e-9)


def test_play_stays_visible(paper_boom: Boom) -> None:
    """Reference: the inner section is drawn lower than the outer one by more than both plays."""
    surface = of_beam(paper_boom, "beam", bent(paper_boom))
    x, _, z = surface.points.T
    outer, inner = z[x < 9.0].max(), z[x > 10.0].max()
    assert outer - inner > surface.magnified * paper_boom.joints[0].clearance


def test_segments_move_along_as_they_are_drawn_out(paper_boom: Boom) -> None:
    """Reference (analytic): the inner segment moves 2 m back along x as half of the drive's time is
    over, the outer one not; both bend as they do without a drive."""
    out = Drive(SCurve(travel=-4.0, duration=1.0), carriers=("inner", "outer"))
    boom = replace(paper_boom, joints=(replace(paper_boom.joints[0], drive=out),))
    still = of_beam(paper_boom, "beam", bent(paper_boom))
    drawn = still.drawn_out(boom)
    assert still.drawn_out(paper_boom) is still
    assert drawn.drawn["inner"].tolist() == pytest.approx([0.0, -2.0, -4.0])
    moved, before = (np.tensordot(one.parts, one.shapes, axes=1) for one in (drawn, still))
    inner = drawn.segment == 1
    assert still.points[inner, 0].min() == paper_boom.segments[1].start
    shift = moved - before
    np.testing.assert_allclose(shift[1, inner], [[-2.0, 0.0, 0.0]] * inner.sum(), atol=1e-9)
    np.testing.assert_allclose(shift[:, ~inner], 0.0, atol=1e-9)
    assert packed(drawn)["drawn"] == {"inner": pytest.approx([0.0, -2.0, -4.0])}


def test_few_shapes_leave_little() -> None:
    """Reference: the motion itself, of 3 shapes and a noise below what may be left."""
    rng = np.random.default_rng(1)
    moved = rng.standard_normal((40, 3)) @ rng.standard_normal((3, 300))
    noise = 0.1 * LEFT * np.abs(moved).max() * rng.uniform(-1.0, 1.0, moved.shape)
    parts, shapes = few_shapes(moved + noise)
    assert parts.shape == (40, 3)
    assert np.abs(parts @ shapes - moved).max() < 2.0 * LEFT * np.abs(moved).max()


def test_a_slope_raises_points_and_shapes_alike(paper_boom: Boom) -> None:
    """Reference (analytic): at 90 degrees x points up, and z backwards."""
    surface = of_beam(paper_boom, "beam", bent(paper_boom))
    risen = surface.turned(90.0)
    for before, after in ((surface.points, risen.points), (surface.shapes, risen.shapes)):
        expected = np.stack([-before[..., 2], before[..., 1], before[..., 0]], axis=-1)
        np.testing.assert_allclose(after, expected, atol=1e-9)


def test_a_page_has_numbers_of_few_bits(paper_boom: Boom) -> None:
    """Reference: the surface; 16 bits of each shape, 8 of the stress."""
    surface = of_beam(paper_boom, "beam", bent(paper_boom))
    found = packed(surface)
    shapes = np.tensordot(np.array(found["parts"]), found["shapes"], axes=1)
    exact = np.tensordot(surface.parts, surface.shapes, axes=1)
    np.testing.assert_allclose(shapes, exact, atol=1e-4 * np.abs(exact).max())
    colors = found["colors"] / 255.0 * found["end"]
    np.testing.assert_allclose(colors, surface.colors, atol=surface.end / 500.0)


def test_what_jumps_is_read_beyond() -> None:
    """Reference: by hand; a place that stands twice stays once."""
    rows = np.array([[0.0], [1.0], [5.0], [0.0]])
    line = Line(np.array([0.0, 1.0, 1.0, 2.0]), {"moment": rows}, {})
    data = xr.Dataset(coords={"time": np.array([0.0, 1.0])})
    output = BeamOutput.of([line], Trajectory(data, np.array([[0.0], [2.0]])))
    (segment,) = output.segments
    assert segment.x.tolist() == [0.0, 1.0, 2.0]
    assert segment.read["moment"].tolist() == [[0.0, 0.0, 0.0], [0.0, 10.0, 0.0]]
