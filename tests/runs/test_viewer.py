# SPDX-License-Identifier: LGPL-3.0-or-later
"""A page holds a boom in motion by few numbers of few bits."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from dynamics.excitation import SCurve
from geometry.joint import Drive
from runs.report import theme
from runs.report.viewer import TRUNCATION, View, few_shapes, pack_view, symbol_lines
from tests.runs.moving_segments import BOOM, TIME, moving_scene

FRAMES = TIME[::40]


@pytest.fixture(scope="module")
def shown() -> View:
    return View.of_shell("shell", moving_scene(), FRAMES)


def places(page: dict[str, Any]) -> np.ndarray:
    """(num_frames, num_points, 3) as the page's script sums them."""
    shapes = page["shapes"].astype(float)
    return page["points"] + np.tensordot(np.array(page["parts"]), shapes, axes=1)


def test_a_page_shows_the_drawn_places_and_stresses(shown: View) -> None:
    """Reference: the scene's own places; 16 bits of each shape, 8 of the stress."""
    page, scene = pack_view(shown, 0.0), shown.scene
    expected = [scene.magnify(moved, page["magnified"]) for moved in scene.displacements(FRAMES)]
    largest = float(np.abs(np.subtract(expected, expected[0])).max())
    np.testing.assert_allclose(places(page), expected, atol=2.0 * TRUNCATION * largest)
    assert 0.005 < (shown.stress > shown.end).mean() <= 0.01
    colours = page["colors"] / 255.0 * page["end"]
    clipped = np.minimum(shown.stress, shown.end)
    np.testing.assert_allclose(colours, clipped, atol=shown.end / 500.0)


def test_segments_move_along_as_drives_extend_them(shown: View) -> None:
    """Reference (analytic): the inner segment moves back along x by 2 m a second, the outer one
    not; both bend as they do without a drive."""
    out = Drive(SCurve(travel=-4.0, duration=2.0), carriers=("inner", "outer"))
    boom = replace(BOOM, joints=(replace(BOOM.joints[0], drive=out),))
    motion = moving_scene(extension=-2.0 * TIME).motion
    driven = shown._replace(scene=replace(shown.scene, boom=boom, motion=motion))
    page, before = pack_view(driven, 0.0), pack_view(shown, 0.0)
    assert before["drawn"] == {}
    assert page["drawn"] == {"inner": pytest.approx(-2.0 * FRAMES)}
    if page["magnified"] != before["magnified"]:
        pytest.fail("the reference is magnified otherwise")
    shift = places(page) - places(before)
    inner = shown.scene.owner == 1
    expected = np.zeros_like(shift)
    expected[:, inner, 0] = -2.0 * FRAMES[:, None]
    np.testing.assert_allclose(shift, expected, atol=1e-4)


def test_symbols_follow_the_boom_and_its_supports_stay(shown: View) -> None:
    """Reference (analytic): the heads of the arrows are at the lower edge of the segment that they
    load, in its plane of symmetry; hinges stand at 0 and 2 m."""
    scene = shown.scene
    scale = pack_view(shown, 0.0)["magnified"]
    rest = scene.magnify(np.zeros_like(scene.points), scale)
    by_color = {one.color: one for one in symbol_lines(scene, rest, np.eye(3), 0.0, scale)}
    hinges, arrows = by_color[theme.INK], by_color[theme.FORCE]
    assert (hinges.anchor == -1).all()
    tops = hinges.offset[hinges.offset[:, 2] >= np.nanmax(hinges.offset[:, 2]) - 1e-9]
    assert sorted(set(tops[:, 0].round(9))) == [0.0, 2.0]
    assert set(scene.owner[arrows.anchor]) == {0, 1}
    places = arrows.offset + rest[arrows.anchor]
    heads = [places[arrows.anchor == near] for near in np.unique(arrows.anchor)]
    edge = [np.nanmax(head[:, 2]) for head in heads]
    np.testing.assert_allclose(edge, rest[np.unique(arrows.anchor), 2], atol=1e-9)
    np.testing.assert_allclose(places[np.isfinite(places[:, 1]), 1], 0.0, atol=1e-9)


def test_few_shapes_leave_little() -> None:
    """Reference: the motion itself, of 3 shapes and a noise below what may be left."""
    rng = np.random.default_rng(1)
    moved = rng.standard_normal((40, 3)) @ rng.standard_normal((3, 300))
    noise = 0.1 * TRUNCATION * np.abs(moved).max() * rng.uniform(-1.0, 1.0, moved.shape)
    parts, shapes = few_shapes(moved + noise)
    assert parts.shape == (40, 3)
    assert np.abs(parts @ shapes - moved).max() < 2.0 * TRUNCATION * np.abs(moved).max()


def test_a_slope_raises_points_and_shapes_alike(shown: View) -> None:
    """Reference (analytic): at 90 degrees x points up, and z backwards."""
    flat, risen = (places(pack_view(shown, angle)) for angle in (0.0, 90.0))
    expected = np.stack([-flat[..., 2], flat[..., 1], flat[..., 0]], axis=-1)
    np.testing.assert_allclose(risen, expected, atol=1e-3)
