# SPDX-License-Identifier: LGPL-3.0-or-later
"""The scene of a boom, its two-dimensional drawing and its viewer."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from matplotlib.transforms import Affine2D
from plotly.graph_objects import Figure as Plot

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.line import Line
from protractile.dynamics.motion_laws import SCurve
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.boom import Boom, Material, Segment, Stop, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.joint import Drive
from protractile.runs.case.build import build_boom
from protractile.runs.pipeline.model_output import BeamOutput, SegmentMotion
from protractile.runs.report import theme
from protractile.runs.report.boom_drawing import boom_sheet
from protractile.runs.report.marks import elevation, marks_of
from protractile.runs.report.overlap_pictures import OverlapView
from protractile.runs.report.scene import Scene, round_scale
from protractile.runs.report.symbols import PAYLOAD, boom_symbols
from protractile.runs.report.viewer import TRUNCATION, View, pack_view
from tests.runs.case_texts import shipped
from tests.runs.moving_segments import (
    BOOM,
    CASE,
    CLEARANCE,
    OUTER,
    TIME,
    moving_fields,
    moving_scene,
    moving_trajectories,
)


@pytest.fixture(scope="module")
def shell() -> Scene:
    return moving_scene()


def telescoping(scene: Scene) -> Scene:
    """Return the scene whose inner segment moves inwards at 2 m/s."""
    out = Drive(SCurve(travel=-4.0, duration=2.0), carriers=("inner", "outer"))
    boom = replace(BOOM, joints=(replace(BOOM.joints[0], drive=out),))
    return replace(scene, boom=boom, motion=moving_scene(extension=-2.0 * TIME).motion)


def test_displacement_is_the_sum_of_the_modes(shell: Scene) -> None:
    """Reference: analytic. The shapes of the fixture, evaluated point by point; at 0.5 s the drive
    has moved the inner segment by 1 m.
    """
    moved = shell.displacement(0.5)
    x, _, z = shell.points.T
    inner = shell.owner == 1
    deflection = np.where(inner, 0.013 + 0.015 * (x - 9.0), 0.02 * x * (x - 2.0) / 80.0)
    slope = np.where(inner, 0.015, 0.02 * (2.0 * x - 2.0) / 80.0)
    exact = np.stack([-z * slope, 0.0 * x, deflection], axis=1)
    np.testing.assert_allclose(moved, exact, atol=1e-7)
    extended = telescoping(shell)
    assert [one.telescopes(one.overlaps[0]) for one in (shell, extended)] == [False, True]
    assert OverlapView.of_largest_force([extended], 0.5) is None
    assert not shell.along(0.5).any()
    np.testing.assert_allclose(extended.along(0.5), np.where(inner, -1.0, 0.0))
    assert extended.reach([0.5]) == pytest.approx((0.0, BOOM.tip))


def test_an_elevation_is_luffed(shell: Scene) -> None:
    """Reference: analytic. At 30° a point (x, z) is at (x cos − z sin, x sin + z cos)."""
    flat, luffed = (elevation(shell, shell.points, 1.0, angle, 1.0) for angle in (0.0, 30.0))
    cosine, sine = np.sqrt(0.75), 0.5
    for before, after in zip(flat.curves[:2], luffed.curves[:2], strict=True):
        x, z = before.at, before.values
        np.testing.assert_allclose(after.at, cosine * x - sine * z, atol=1e-12)
        np.testing.assert_allclose(after.values, sine * x + cosine * z, atol=1e-12)


@pytest.mark.parametrize(("scale", "section"), [(1.0, 1.0), (20.0, 2.0)])
def test_contact_in_run_is_contact_in_picture(shell: Scene, scale: float, section: float) -> None:
    """Reference: analytic, a wall between mid-surfaces; opposite, twice the clearance more."""
    (overlap,) = shell.overlaps
    assert overlap == (0, 1, [*BOOM.stations], [9.0, 10.0], CLEARANCE)
    moved = np.zeros_like(shell.points)
    moved[shell.owner == 1, 2] = CLEARANCE
    drawn = shell.magnify(moved, scale, section)
    for side, gap in ((1, 0.0), (-1, 2.0 * scale * CLEARANCE)):
        outer, inner = (drawn[shell.flange_in_plane(k, side), 2] for k in (0, 1))
        between = side * (outer[0] - inner[0]) - section * shell.wall(overlap)
        assert between == pytest.approx(gap, abs=1e-9)


def test_the_pressed_overlap_is_drawn(shell: Scene) -> None:
    """Reference: the joints of the case; by hand, a force at one station only, and a stop."""
    boom = build_boom(shipped("inspection-arm"))
    one, two = boom.joints
    stop = Stop(1, one.stations[0], 0.04, PowerContact(1e9, 1.0).upper())
    boom = replace(boom, stops=(stop,))
    motion = shell.motion.isel(station=[0] * len(boom.stations))
    motion = motion.assign_coords(station=[station.x for station in boom.stations])
    side = replace(shell, boom=boom, motion=motion)
    views = [side, replace(side, from_above=True)]
    found = [(*at[:3], at.clearance) for scene in views for at in scene.overlaps]
    assert found == [
        (0, 1, [*boom.stations[0:2]], 0.5 * one.play),
        (1, 2, [*boom.stations[2:4]], 0.5 * two.play),
        (0, 1, [*boom.stations[4:6]], 0.5 * one.lateral_play),
        (1, 2, [*boom.stations[6:8]], 0.5 * two.lateral_play),
    ]
    # Pads are 0.12 m long and begin at the ends of the overlap.
    assert views[1].overlaps[0].centres == pytest.approx([3.56, 4.44])
    for station, above, outer in ((1, False, 0), (2, False, 1), (4, True, 0), (7, True, 1)):
        force = xr.zeros_like(motion["contact_force"])
        force[200, station] = (-1.0) ** (station // 2) * 3.0e4
        pressed = [replace(view, motion=motion.assign(contact_force=force)) for view in views]
        chosen = OverlapView.of_largest_force(pressed, float(TIME[200]))
        assert chosen is not None
        assert (chosen.scene.from_above, chosen.overlap.outer) == (above, outer)


def test_from_above_y_points_up(shell: Scene) -> None:
    """Reference: analytic, a boom rotated about x. Upward displacements face the viewer."""
    motion = moving_trajectories().sel(model="shell").isel(station=[0, 1, 0, 1])
    motion = motion.assign(tip_lateral=-2.0 * motion["tip"])
    side, above = Scene.views(moving_fields(), motion, shipped("spatial"))
    assert (side.from_above, above.from_above, above.symbols) == (False, True, [])
    assert above.half_height(0) == pytest.approx(0.5 * OUTER.size("y"))
    moved = side.displacement(0.5), above.displacement(0.5)
    assert moved[1][:, 1] == pytest.approx(-moved[0][:, 2])
    assert not moved[1][:, 2].any()
    assert above.motion["tip"].values == pytest.approx(-2.0 * side.motion["tip"].values)


def test_rigid_motion_of_an_overlap_is_subtracted(shell: Scene) -> None:
    """Reference: analytic, a parabola w = c x² over 1 m leaves at most w″/12 · (1/2)²; scales have
    one digit.
    """
    scales = {0.7: 0.5, 1.0: 1.0, 19.9: 10.0, 20.0: 20.0, 0.031: 0.02}
    assert [round_scale(largest) for largest in scales] == pytest.approx([*scales.values()])
    whole, left = shell.displacement(0.5), shell.relative_displacements(0.5, 0, (9.0, 10.0))
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


def test_sections_of_a_beam_stay_plane_with_the_stress_of_its_moment() -> None:
    """Reference: by hand, w = t x²/100, so that w′ = 0.16 at the tip, and M z/J of boxes of 0.4 and
    0.2 m at tail and head under 1 kN m.
    """
    tail, head = (BoxSection(height, 0.2, 0.01, 0.008) for height in (0.4, 0.2))
    steel, clamp = Material(2.1e11, 0.3, 7850.0), Support(0.0, "clamped")
    arm = Segment.of_section("arm", 0.0, 8.0, steel, tail, head_section=head, supports=(clamp,))
    x, time = np.linspace(0.0, 8.0, 33), np.array([0.0, 0.5, 1.0])
    curves = {"deflection": np.outer(time, x**2 / 100.0), "moment": np.outer(time, 1e3 + 0.0 * x)}
    output = BeamOutput(time, [SegmentMotion(x, curves)])
    still = xr.Dataset(coords={"time": time})
    scene, stress = Scene.of_beam(CASE, Boom((arm,), (), ()), output, still)
    drawn = scene.magnify(np.zeros_like(scene.points), 1.0, 3.0)
    for place, box in ((0.0, tail), (8.0, head)):
        there = scene.points[:, 0] == place
        assert np.ptp(drawn[there, 2]) == pytest.approx(3.0 * box.size("z"))
        expected = 1e3 * 0.5 * box.size("z") / box.second_moment_of_area
        assert stress[-1, there].max() == pytest.approx(expected, rel=1e-9)
    assert stress[0].max() == 0.0
    moved, z = scene.displacement(1.0)[there], scene.points[there, 2]
    np.testing.assert_allclose(moved[:, 2], 0.64)
    # One-sided differences of a parabola over 0.25 m are w″ times half of that off.
    np.testing.assert_allclose(moved[:, 0], -z * 0.16, atol=0.0026 * np.abs(z).max())


def test_values_at_jumps_are_read_beyond_the_jump() -> None:
    """Reference: by hand. Double positions become single."""
    rows = np.array([[0.0], [1.0], [5.0], [0.0]])
    line = Line(np.array([0.0, 1.0, 1.0, 2.0]), {"moment": rows}, {})
    data = xr.Dataset(coords={"time": np.array([0.0, 1.0])})
    output = BeamOutput.of([line], Trajectory(data, np.array([[0.0], [2.0]])))
    (segment,) = output.segments
    assert segment.x.tolist() == [0.0, 1.0, 2.0]
    assert segment.curves["moment"].tolist() == [[0.0, 0.0, 0.0], [0.0, 10.0, 0.0]]


def drawn(name: str, boom: Boom | None = None) -> Figure:
    case = shipped(name)
    with rc_context(theme.RC):
        return boom_sheet(case, boom or build_boom(case))


def legend(sheet: Figure) -> list[str]:
    return [text.get_text().replace("\n", " ") for text in sheet.legends[0].get_texts()]


def test_a_lift_is_drawn_and_labelled_at_its_angle() -> None:
    """Reference: analytic, a tip at 15.7 m and 45 degrees; the case file."""
    sheet = drawn("lift")
    places = np.concatenate([line.get_xydata() for line in sheet.axes[0].lines])
    for reference in ((11.1016, 11.1016), (1.2728, -0.2828)):
        nearest = np.nanmin(np.abs(places - reference).max(axis=1))
        assert nearest < 0.11  # half the height of the fly
    (arc,) = (line.get_xydata() for line in sheet.axes[0].lines if len(line.get_xdata()) == 30)
    turned = np.linspace(0.0, np.pi / 4.0, 30)[:, None]
    assert arc == pytest.approx(0.18 * 15.7 * np.hstack([np.cos(turned), np.sin(turned)]))
    (label,) = (text for text in sheet.axes[0].texts if text.get_text() == "45°")
    assert label.get_position() == pytest.approx(1.15 * arc[15])
    texts = [text.get_text() for axes in sheet.axes for text in axes.texts]
    # The last box has equal walls.
    assert [text for text in texts if " × " in text] == [
        "300 × 220\nweb 5\nflange 6", "256 × 180\nweb 4\nflange 5", "218 × 146\nwalls 4"
    ]  # fmt: skip
    assert legend(sheet) == [
        "slide pads", "support", "cylinder, 30 MN/m", "mass at the tip, 150 kg",
        "1.595 kN perpendicular to the boom, towards its lower side, ramp of 0.1 s", "play 3 mm",
        "self-weight, g = 9.807 m/s²",
    ]  # fmt: skip


def test_sections_are_as_large_as_the_case_says() -> None:
    """Reference: by hand, the sizes in the case file; pads of unknown thickness fill the gap."""
    arm = build_boom(shipped("inspection-arm"))
    plates = [one for section in arm.segments for one in section.section.plates]
    first, second = arm.joints
    unknown = replace(arm, joints=(replace(first, pad=replace(first.pad, thickness=None)), second))
    # The left upper pads of the second segment: lowest (y, z), width and height in m.
    for boom, pads in (
        (arm, [(-0.105, 0.149, 0.05, 0.0125), (-0.121, 0.095, 0.0125, 0.05)]),
        (unknown, [(-0.105, 0.149, 0.05, 0.016)]),
    ):
        sheet = drawn("inspection-arm", boom)
        (panel,) = (one for one in sheet.axes if one.get_title("left").startswith("sections"))
        assert panel.get_aspect() == 1.0
        found = [one.get_bbox().bounds for one in panel.patches if isinstance(one, Rectangle)]
        assert len(found) == 16
        pitch = 1.35 * boom.segments[0].section.size("y")
        for pad in pads:
            assert np.abs(np.subtract(found, pad) - [pitch, 0, 0, 0]).max(axis=1).min() < 1e-9
    shapes = [one.get_xy() for one in panel.patches if isinstance(one, Polygon)]
    assert len(shapes) == len(plates)
    own = arm.segments[0].section
    low, high = own.reach("z")
    heights = np.concatenate([shape[:, 1] for shape in shapes[: len(own.plates)]])
    thickest = max(plate.thickness for plate in own.plates)
    assert high - low < np.ptp(heights) < high - low + 1.01 * thickest
    # A long legend fits on its sheet.
    assert {"lateral play 4 mm", "350 N/m lateral, wind, root"} <= {*legend(sheet)}
    sheet.draw_without_rendering()
    box = sheet.legends[0].get_window_extent()
    assert 0.0 <= box.x0 < box.x1 <= sheet.bbox.width
    assert box.y0 >= 0.0


def test_a_force_down_points_down() -> None:
    """Reference: the loaded point; on an upright boom forces turn with it, loads hang."""
    case = shipped("crane")
    acts = {symbol.meaning: symbol for symbol in boom_symbols(case, build_boom(case))}
    load_across = acts["24.52 kN perpendicular to the boom, towards its lower side, ramp of 0.5 s"]
    (_, tail), (_, head) = load_across.on_boom(90.0).vertices[:2]
    assert tail > head == 0.0
    payload = acts["mass at the tip, 350 kg"]
    turned = payload.on_boom(60.0).transformed(Affine2D().rotate_deg(60.0))
    np.testing.assert_allclose(turned.vertices, PAYLOAD.vertices, atol=1e-12)


FRAMES = TIME[::40]


@pytest.fixture(scope="module")
def shown() -> View:
    return View.of_shell("shell", moving_scene(), FRAMES)


def places(page: dict[str, Any]) -> np.ndarray:
    """Return displayed points (num_frames, num_points, 3), summed as in the script of the page."""
    shapes = page["shapes"].astype(float)
    return page["points"] + np.tensordot(np.array(page["parts"]), shapes, axes=1)


def test_a_page_shows_the_drawn_places_and_stresses(shown: View) -> None:
    """Reference: the points of the scene, with 16 bits for each shape and 8 for stress."""
    page, scene = pack_view(shown, 0.0), shown.scene
    Plot(page["figure"])
    expected = [scene.magnify(moved, page["magnified"]) for moved in scene.displacements(FRAMES)]
    largest = float(np.abs(np.subtract(expected, expected[0])).max())
    np.testing.assert_allclose(places(page), expected, atol=2.0 * TRUNCATION * largest)
    assert 0.005 < (shown.stress > shown.end).mean() <= 0.01
    colours = page["colors"] / 255.0 * page["end"]
    clipped = np.minimum(shown.stress, shown.end)
    np.testing.assert_allclose(colours, clipped, atol=shown.end / 500.0)


def test_drives_move_segments_in_the_viewer(shown: View) -> None:
    """Reference: analytic, 2 m/s inwards for the inner segment; both bend as without a drive."""
    page = pack_view(shown._replace(scene=telescoping(shown.scene)), 0.0)
    before = pack_view(shown, 0.0)
    assert before["drawn"] == {}
    assert page["drawn"] == {"inner": pytest.approx(-2.0 * FRAMES)}
    assert page["magnified"] == before["magnified"]
    shift = places(page) - places(before)
    expected = np.zeros_like(shift)
    expected[:, shown.scene.owner == 1, 0] = -2.0 * FRAMES[:, None]
    np.testing.assert_allclose(shift, expected, atol=1e-4)


def test_symbols_follow_the_boom_and_its_supports_stay(shown: View) -> None:
    """Reference: analytic, arrow heads at lower edges in mid-plane; hinges at 0 and 2 m."""
    scene = shown.scene
    scale = pack_view(shown, 0.0)["magnified"]
    rest = scene.magnify(np.zeros_like(scene.points), scale)
    marks = marks_of(scene, rest, scale, 0.0)
    tops = []
    for hinge in (mark for mark in marks if mark.color == theme.INK):
        assert (hinge.anchor == -1).all()
        tops.append(hinge.offset[np.nanargmax(hinge.offset[:, 2]), 0].round(9))
    assert sorted(tops) == [0.0, 2.0]
    arrows = [mark for mark in marks if mark.color == theme.FORCE]
    assert {int(number) for mark in arrows for number in scene.owner[mark.anchor]} == {0, 1}
    for mark in arrows:
        places = mark.at(rest)
        ends = np.unique(mark.anchor)
        edge = [np.nanmax(places[mark.anchor == near, 2]) for near in ends]
        np.testing.assert_allclose(edge, rest[ends, 2], atol=1e-9)
        np.testing.assert_allclose(places[np.isfinite(places[:, 1]), 1], 0.0, atol=1e-9)


def test_points_and_shapes_rotate_with_the_boom(shown: View) -> None:
    """Reference: analytic. At 90 degrees x points upwards and z backwards."""
    flat, risen = (places(pack_view(shown, angle)) for angle in (0.0, 90.0))
    expected = np.stack([-flat[..., 2], flat[..., 1], flat[..., 0]], axis=-1)
    np.testing.assert_allclose(risen, expected, atol=1e-3)
