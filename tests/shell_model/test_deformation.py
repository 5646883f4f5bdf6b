# SPDX-License-Identifier: LGPL-3.0-or-later
"""A moving shell is displaced, held, in touch and seen as its fields say."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from shell_model.pictures.boom import Instant, reach
from shell_model.pictures.deformation import MovingShell
from shell_model.pictures.rendering import where_pressed
from shell_model.pictures.stress import apart, smoothed
from shell_model.pictures.theme import round_scale
from tests.shell_model.moving_segments import (
    CLEARANCE,
    INNER,
    OUTER,
    TIME,
    moving_fields,
    moving_trajectories,
)


@pytest.fixture(scope="module")
def fields() -> xr.Dataset:
    return moving_fields()


@pytest.fixture(scope="module")
def trajectories() -> xr.Dataset:
    return moving_trajectories()


def test_displacement_is_the_sum_of_the_modes(fields: xr.Dataset, trajectories: xr.Dataset) -> None:
    """Reference: analytic. The shapes of the fixture, evaluated point by point."""
    (shell,) = MovingShell.views(fields, trajectories.sel(model="shell"))
    moved = shell.displacement(0.5)
    x, _, z = shell.points.T
    is_inner = np.arange(x.size) >= shell.members[1].min()
    deflection = np.where(is_inner, 0.013 + 0.015 * (x - 9.0), 0.02 * x * (x - 2.0) / 80.0)
    slope = np.where(is_inner, 0.015, 0.02 * (2.0 * x - 2.0) / 80.0)
    np.testing.assert_allclose(moved[:, 2], deflection, atol=1e-7)
    np.testing.assert_allclose(moved[:, 0], -z * slope, atol=1e-8)
    assert not moved[:, 1].any()
    assert not shell.displacement(0.0)[~is_inner].any()


def test_segments_move_along_as_they_are_drawn_out(
    fields: xr.Dataset, trajectories: xr.Dataset
) -> None:
    """Reference (analytic): the inner segment is 2 m farther out at 0.5 s, the outer one stays."""
    motion = trajectories.sel(model="shell")
    still = MovingShell.views(fields, motion)[0]
    assert not still.along(0.5).any()
    assert not still.slides(still.overlaps[0])
    drawn = motion.assign(drawn_out=("time", 4.0 * motion["time"].values))
    shell = MovingShell.views(fields.assign_attrs(drawn='[[], ["drawn_out"]]'), drawn)[0]
    assert shell.slides(shell.overlaps[0])
    is_inner = np.arange(len(shell.points)) >= shell.members[1].min()
    np.testing.assert_allclose(shell.along(0.5), np.where(is_inner, 2.0, 0.0))
    end = shell.points[:, 0].max()
    assert reach(shell, [Instant(0.5)]) == pytest.approx((0.0, end + 2.0))


def test_supports_are_where_nothing_moves(fields: xr.Dataset, trajectories: xr.Dataset) -> None:
    held = MovingShell.views(fields, trajectories.sel(model="shell"))[0].supports()
    assert [float(outline[0, 0]) for outline in held] == [0.0, 2.0]
    assert all(np.ptp(outline[:, 2]) == pytest.approx(OUTER.height) for outline in held)


def test_the_change_of_a_sections_shape_leaves_out_what_moves_it(
    fields: xr.Dataset, trajectories: xr.Dataset
) -> None:
    """Reference: analytic. A section that widens by c y while it moves and turns by φ."""
    shell = MovingShell.views(fields, trajectories.sel(model="shell"))[0]
    _, y, z = shell.points.T
    moved = np.stack([0.0 * y, 0.03 - 0.02 * z + 0.01 * y, -0.05 + 0.02 * y], axis=1)
    places, change = shell.change_of_shape(moved, 1, 10.0)
    assert places[0] == pytest.approx(places[-1])
    assert np.ptp(places, axis=0) == pytest.approx([INNER.width, INNER.height])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps.sum() == pytest.approx(2.0 * (INNER.width + INNER.height))
    assert change[:, 0] == pytest.approx(0.01 * places[:, 0], abs=1e-9)
    assert np.abs(change[:, 1]).max() < 1e-9


@pytest.mark.parametrize(("scale", "section"), [(1.0, 1.0), (5.0, 1.0), (20.0, 2.0)])
def test_what_touches_in_the_run_touches_in_the_picture(
    fields: xr.Dataset, trajectories: xr.Dataset, scale: float, section: float
) -> None:
    """Reference: analytic. A relative displacement by the clearance leaves one wall between the
    middles of two walls, and one by its opposite leaves twice the clearance besides."""
    (shell,) = MovingShell.views(fields, trajectories.sel(model="shell"))
    (overlap,) = shell.overlaps
    assert (overlap.outer, overlap.inner, overlap.stations) == (0, 1, [0, 1])
    assert overlap.clearance == pytest.approx(CLEARANCE)
    moved = np.zeros_like(shell.points)
    moved[shell.members[1], 2] = CLEARANCE
    drawn = shell.drawn(moved, scale, section)
    for side, gap in ((1, 0.0), (-1, 2.0 * scale * CLEARANCE)):
        outer, inner = (drawn[shell.flange_in_plane(k, side), 2] for k in (0, 1))
        between = side * (outer[0] - inner[0]) - section * shell.wall(overlap)
        assert between == pytest.approx(gap, abs=1e-9)


@pytest.fixture(scope="module")
def two_joints(fields: xr.Dataset, trajectories: xr.Dataset) -> list[MovingShell]:
    """Two joints along z, the first along y too, and a stop inside the first overlap, which is no
    contact of the segments. Seen from the side and from above.
    """
    motion = trajectories.sel(model="shell").isel(station=[0, 1, 0, 1, 0, 1, 0])
    motion = motion.assign_coords(
        station=[9.0, 10.0, 17.5, 19.0, 9.0, 10.0, 9.5],
        direction=("station", ["z", "z", "z", "z", "y", "y", "z"]),
    ).assign(tip_lateral=0.5 * motion["tip"])
    longer = fields.drop_dims(["joint", "station"]).assign(
        joint_outer=("joint", np.int32([0, 1])),
        joint_inner=("joint", np.int32([1, 2])),
        clearance=("joint", [CLEARANCE, 0.5 * CLEARANCE]),
        lateral_clearance=("joint", [3.0e-3, np.nan]),
        station_joint=("station", np.int32([0, 0, 1, 1, 0, 0, -1])),
        stop_segment=("stop", np.int32([1])),
        stop_x=("stop", [9.5]),
        stop_side=("stop", [-1.0]),
        stop_clearance=("stop", [0.02]),
        lug_segment=("lug", np.int32([0])),
        lug_x=("lug", [4.0]),
        lug_along=("lug", [0.6]),
        lug_up=("lug", [0.8]),
    )
    return MovingShell.views(longer, motion)


def test_each_overlap_gets_its_stations(two_joints: list[MovingShell]) -> None:
    side, above = two_joints
    assert [tuple(overlap) for overlap in side.overlaps] == [
        (0, 1, [0, 1], CLEARANCE),
        (1, 2, [2, 3], 0.5 * CLEARANCE),
    ]
    assert [tuple(overlap) for overlap in above.overlaps] == [(0, 1, [4, 5], 3.0e-3)]
    assert [tuple(stop) for stop in side.stops] == [(1, 9.5, -1.0, 0.02)]
    assert [tuple(lug) for lug in side.lugs] == [(0, 4.0, 0.6, 0.8)]
    assert not above.stops
    assert not above.lugs


@pytest.mark.parametrize(
    ("station", "place"),
    [(1, " (joint 1)"), (2, " (joint 2)"), (4, " (joint 1 sideways)"), (6, " (a stop)")],
)
def test_of_several_joints_the_pressed_one_is_named(
    two_joints: list[MovingShell], station: int, place: str
) -> None:
    """Reference: the fixture. One station with a force, up or down, the others with none."""
    side, above = two_joints
    peak = xr.zeros_like(side.motion["contact_force_peak"])
    peak[200, station] = (-1.0) ** (station // 2) * 3.0e4
    side = replace(side, motion=side.motion.assign(contact_force_peak=peak))
    assert where_pressed([side, above], float(TIME[200])) == place


def test_the_only_joint_is_not_named(fields: xr.Dataset, trajectories: xr.Dataset) -> None:
    assert where_pressed(MovingShell.views(fields, trajectories.sel(model="shell")), 0.5) == ""


def test_from_above_y_points_up(fields: xr.Dataset, trajectories: xr.Dataset) -> None:
    """Reference: analytic. A boom in space, turned so that its width is its height; what moves
    up comes towards the eye.
    """
    motion = trajectories.sel(model="shell")
    motion = motion.assign_coords(direction=("station", ["z", "y"])).assign(
        tip_lateral=-2.0 * motion["tip"]
    )
    in_space = fields.assign(lateral_clearance=("joint", [5.0e-3]))
    side, above = MovingShell.views(in_space, motion)
    assert above.from_above
    assert not side.from_above
    assert above.half_height(0) == pytest.approx(0.5 * OUTER.width)
    moved = side.displacement(0.5), above.displacement(0.5)
    assert moved[1][:, 1] == pytest.approx(-moved[0][:, 2])
    assert not moved[1][:, 2].any()
    assert above.motion["tip"].values == pytest.approx(-2.0 * side.motion["tip"].values)


@pytest.mark.parametrize(
    ("largest", "scale"), [(0.7, 0.5), (1.0, 1.0), (19.9, 10.0), (20.0, 20.0), (0.031, 0.02)]
)
def test_scale_is_round_and_not_above_what_fits(largest: float, scale: float) -> None:
    assert round_scale(largest) == pytest.approx(scale)


def test_what_moves_and_turns_an_overlap_as_a_whole_is_left_out(
    fields: xr.Dataset, trajectories: xr.Dataset
) -> None:
    """Reference: analytic. Of a parabola w = c x² over 1 m a chord's turn is taken, at the chord's
    middle w″/12 · (1/2)² of it is left at most; the inner segment keeps how it lies beside it."""
    (shell,) = MovingShell.views(fields, trajectories.sel(model="shell"))
    whole, left = shell.displacement(0.5), shell.beside(0.5, 0, (9.0, 10.0))
    x, _, z = shell.points.T
    flange = shell.flange_in_plane(0, 1)
    flange = flange[(x[flange] > 8.99) & (x[flange] < 10.01)]
    slope = np.polyfit(x[flange], left[flange, 2], 1)[0]
    assert abs(np.polyfit(x[flange], whole[flange, 2], 1)[0]) > 4e-3
    assert abs(slope) < 1e-6
    assert np.abs(left[flange, 2]).max() < 0.02 / 80.0 / 4.0
    inner = shell.flange_in_plane(1, 1)
    taken = (whole - left)[inner]
    turn = np.polyfit(x[inner], taken[:, 2], 1)[0]
    np.testing.assert_allclose(
        taken[:, 0], taken[0, 0] - turn * (z[inner] - z[inner][0]), atol=1e-12
    )


def test_smoothed_stresses_keep_to_their_walls(
    fields: xr.Dataset, trajectories: xr.Dataset
) -> None:
    """Reference: analytic. What is the same all over a wall stays so up to its folds; a field that
    is linear along x is met between the triangles around a point."""
    (shell,) = MovingShell.views(fields, trajectories.sel(model="shell"))
    walls = shell.stress.wall.astype(float) + 10.0 * shell.segment
    np.testing.assert_allclose(smoothed(shell, walls), np.repeat(walls[:, None], 3, axis=1))
    along = shell.stress.centroids[:, 0]
    corners = smoothed(shell, along)
    inside = np.abs(shell.points[shell.triangles, 0] - 5.0) < 3.0
    off = corners - shell.points[shell.triangles, 0]
    assert np.abs(off[inside]).max() < 0.15  # half an edge


def test_points_apart_show_the_same_triangles(fields: xr.Dataset, trajectories: xr.Dataset) -> None:
    """Reference: the triangles' corners themselves."""
    (shell,) = MovingShell.views(fields, trajectories.sel(model="shell"))
    points, triangles = apart(shell.points, shell.triangles)
    np.testing.assert_array_equal(points[triangles], shell.points[shell.triangles])


def test_segments_have_the_names_that_a_file_knows(
    fields: xr.Dataset, trajectories: xr.Dataset
) -> None:
    """Reference: the attribute; an earlier file has none."""
    motion = trajectories.sel(model="shell")
    assert MovingShell.views(fields, motion)[0].names == ["segment 1", "segment 2"]
    named = fields.assign_attrs(segments='["base; of", "fly"]')
    assert MovingShell.views(named, motion)[0].names == ["base; of", "fly"]
