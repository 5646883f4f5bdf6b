# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures: displacements, instants, scales, captions, and messages without pictures."""

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from multiprocessing import active_children
from pathlib import Path
from time import sleep

import numpy as np
import pytest
import xarray as xr
from matplotlib import rc_context
from PIL import Image

from protractile.geometry.arrays import Array
from protractile.runs.case import reading as case_file
from protractile.runs.case.load_tables import LoadTable, PayloadTable
from protractile.runs.pipeline.results import Results
from protractile.runs.report import opengl, sheet, snapshots, theme
from protractile.runs.report.boom_pictures import BoomView, draw_boom
from protractile.runs.report.opengl import RenderingUnavailable
from protractile.runs.report.overlap_pictures import draw_overlap
from protractile.runs.report.scene import Instant, Scene
from protractile.runs.report.sheet import Camera, stage, surface
from protractile.runs.report.snapshots import (
    _describe,
    characteristic_instant,
    render_motion,
    start_rendering,
)
from tests.runs.case_texts import shipped
from tests.runs.moving_segments import CASE, TIME, moving_scene


@pytest.fixture(scope="module")
def shell() -> Scene:
    return moving_scene()


@pytest.fixture(autouse=True, scope="module")
def _coarse() -> Iterator[None]:
    """Render each pixel once, with rougher edges at a quarter of the cost."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sheet, "OVERSAMPLING", 1)
        yield


def test_a_motion_is_drawn_at_its_first_peak(shell: Scene) -> None:
    """Reference: analytic. The tip's sin² has its first peak at 0.5 s."""
    assert characteristic_instant(shell.motion) == (pytest.approx(0.5), "first peak of the tip")
    rising = characteristic_instant(shell.motion.isel(time=slice(0, 100)))
    assert rising == (pytest.approx(TIME[99]), "largest deflection of the tip")


@pytest.mark.parametrize(
    ("probe", "message"),
    [
        ("import os; os.abort()", "VTK finds no working OpenGL and dies of SIGABRT; install "
         "libegl1 and libgl1-mesa-dri beside pip's vtk, or give Debian's VTK a display"),
        ("import no_such_pyvista",
         "pyvista makes no picture: ModuleNotFoundError: No module named 'no_such_pyvista'"),
        ("raise SystemExit(3)", "pyvista makes no picture: it does not say why"),
    ],
)  # fmt: skip
def test_missing_opengl_is_said(monkeypatch: pytest.MonkeyPatch, probe: str, message: str) -> None:
    monkeypatch.setattr(opengl, "PROBE", probe)
    with pytest.raises(RenderingUnavailable) as caught:
        opengl.require_opengl()
    assert str(caught.value) == message


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
def test_labels_are_at_the_projected_points() -> None:
    """Reference: other code, the centre of a small plate in VTK's picture."""
    place = (-6.0, 2.0, -0.5)
    camera = Camera(np.array([0.0, 0.0, 0.5]), 20.0, (400, 160), elevation=10.0)
    corners = np.array([[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]])
    two = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    with stage(camera.pixels) as plotter:
        plotter.add_mesh(surface(np.array(place) + corners, two), color="black", lighting=False)
        seen = camera.render(plotter)
    row, column = (axis.mean() + 0.5 for axis in np.nonzero(seen[..., 0] < 128))
    np.testing.assert_allclose(camera.project(place), [column, 160 - row], atol=0.6)


def red(picture: Array) -> Array:
    """Return the mask of pixels with the colour of forces."""
    return (picture[..., 0] > 120.0) & (picture[..., 1:].max(axis=2) < 70.0)


def picture_of(path: Path) -> Array:
    return np.asarray(Image.open(path).convert("RGB"), dtype=float)


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
def test_pictures_show_the_boom_its_overlap_and_its_motion(
    shell: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: the shares of colours; analytic, the tip at the first peak of its motion."""
    assert 40 <= snapshots.FRAMES <= 60
    monkeypatch.setattr(snapshots, "FRAMES", 4)
    boom, overlap, film = drawn = render_motion([shell], tmp_path)
    names = ["boom-first-peak.png", "overlap-first-peak.png", "motion.gif"]
    assert [snapshot.path.name for snapshot in drawn] == names
    coloured = np.ptp(picture_of(boom.path)[110:570], axis=2) > 20.0
    assert 0.05 < coloured.mean() < 0.5
    assert np.ptp(np.flatnonzero(coloured.any(axis=0))) > 0.75 * coloured.shape[1]
    picture = picture_of(overlap.path)[190:800]
    is_force = red(picture)
    # Red less blue, negative in the outer segment.
    warmth = picture[..., 0] - picture[..., 2]
    assert (warmth < -60.0).mean() > 0.08
    assert ((warmth > 100.0) & ~is_force).mean() > 0.08
    left, right = np.array_split(is_force, 2, axis=1)
    rows = [np.flatnonzero(part.any(axis=1)).mean() for part in (right, left)]
    assert rows[0] + 200.0 < rows[1]
    assert film.path.stat().st_size < 4.0e6 * 4 / 60
    with Image.open(film.path) as animation:
        stills = []
        for frame in range(animation.n_frames):
            animation.seek(frame)
            assert animation.info["duration"] == 5000 / 4
            stills.append(np.asarray(animation.convert("RGB"), dtype=float))
    assert len(stills) == 4
    assert (np.abs(stills[1] - stills[0]).max(axis=2) > 60.0).mean() > 0.01
    deflection = 1e3 * float(shell.motion["tip"].sel(time=0.5, method="nearest"))
    assert boom.title == "Boom: first peak of the tip at 0.500 s"
    state = f"'shell', at the first peak of the tip (0.500 s, tip +{deflection:.1f} mm)"
    assert boom.caption.startswith(f"Boom in {state}. Colour: von Mises stress")
    assert overlap.caption.startswith(f"In {state}: the overlap")
    assert "sum of the forces" not in overlap.caption
    assert (film.title, film.name) == ("Boom in motion, first 2 s", "motion")
    assert all("magnif" in snapshot.caption for snapshot in drawn)
    # Of another time, without forces, and of a boom from above.
    other = tmp_path / "other"
    other.mkdir()
    boom, overlap = render_motion([shell], other, [0.05], every_view=True)
    assert {*other.iterdir()} == {other / "boom-0.05s.png", other / "overlap-0.05s.png"}
    assert not red(picture_of(overlap.path)[190:800]).any()
    with pytest.raises(ValueError, match=r"^time must be between 0 and 2 s, got 2\.5$"):
        render_motion([shell], other, [0.5, 2.5])
    above = replace(shell, motion=shell.motion.assign(tip=-shell.motion["tip"]), from_above=True)
    state = f"'shell', seen from above, at 0.500 s (lateral tip −{deflection:.1f} mm)"
    assert _describe(above, Instant(0.5)) == ("0.500 s", state)


def test_the_scale_of_stresses_ends_near_the_largest() -> None:
    """Reference: the stresses of the scene, of which 1 % may exceed the scale."""
    pytest.importorskip("pyvista")
    hanging = moving_scene(state=-1.0)
    view = BoomView.of(hanging, [Instant(0.5)])
    (stress,) = hanging.point_stresses([0.5])
    assert (stress > view.largest).mean() <= 0.01 < (stress >= view.largest).mean()
    np.testing.assert_array_equal(view.stresses[0.5], stress)
    # A deep boom is within the picture, too.
    deep = replace(hanging, points=hanging.points * [1.0, 1.0, 5.0])
    view = BoomView.of(deep, [Instant(0.5)])
    pixels = view.camera.project(view.places(deep.displacement(0.5), 0.5))
    assert pixels.min() > 0.0
    assert (pixels.max(axis=0) < view.camera.pixels).all()


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
def test_arrows_and_their_numbers_stay_above_the_axis() -> None:
    """Reference: analytic. Forces of 1 and 0.9 of the maximum have arrows of 110 and 104 pixels."""
    with rc_context(theme.PAGE_RC):
        picture = draw_overlap([moving_scene(state=4.0)], Instant(0.5))
    top, axis = 190, 810
    is_force = red(np.asarray(picture, dtype=float))
    assert not is_force[axis:].any()
    halves = np.array_split(is_force[top:axis], 2, axis=1)
    tallest = [half.sum(axis=0).max() for half in halves]
    assert tallest == pytest.approx([110.0, 104.0], abs=4.0)


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
def test_symbols_of_loads_and_masses_follow_the_boom(shell: Scene) -> None:
    """Reference: analytic. A red arrow of 3 % of the boom and a black ball at the tip."""
    down = LoadTable(segment="inner", x="head", magnitude=-1.0e3)
    update = {"payload": PayloadTable(mass=100.0), "loads": (down,)}
    marked = moving_scene(CASE.model_copy(update=update))
    instant, drawn = Instant(0.5), []
    for each in (shell, marked):
        with rc_context(theme.PAGE_RC):
            view = BoomView.of(each, [instant])
            (picture,) = draw_boom(view, [instant], 2.0)
        # From the lower edge of the picture, upside down as the camera counts.
        drawn.append(np.asarray(picture, dtype=float)[574:124:-1])
    differs = np.abs(drawn[1] - drawn[0]).max(axis=2) > 60.0
    at_tip = np.abs(marked.points[:, 0] - marked.boom.tip) < 1e-6
    x, middle = view.camera.project(view.places(marked.displacement(0.5), 0.5)[at_tip]).mean(axis=0)
    rows, columns = np.nonzero(differs & red(drawn[1]))
    assert columns.mean() == pytest.approx(x, abs=25.0)
    assert np.ptp(rows) == pytest.approx(0.03 * each.boom.length * 1600 / view.camera.width, abs=12)
    assert rows.mean() > middle
    _, columns = np.nonzero(differs & (drawn[1].max(axis=2) < 60.0))
    assert columns[columns > 1000].mean() == pytest.approx(x, abs=25.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("work", "probe", "seconds", "error", "message"),
    [
        (os.abort, "import os; os.abort()", 60, RenderingUnavailable, "dies of SIGABRT; install"),
        (os.abort, "pass", 60, MemoryError, "the system has killed the process that draws"),
        (partial(sleep, 60), "pass", 0.1, RenderingUnavailable, "makes no picture within 0.1 s"),
    ],
    ids=["no OpenGL", "killed", "hangs"],
)
def test_failing_picture_process_is_reported(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    work: Callable[[], None],
    probe: str,
    seconds: float,
    error: type[Exception],
    message: str,
) -> None:
    """Reference: processes that are killed, or do not end."""
    monkeypatch.setattr(opengl, "render_test_picture", work)
    monkeypatch.setattr(opengl, "PROBE", probe)
    monkeypatch.setattr(opengl, "PROBE_SECONDS", seconds)
    case = case_file.select(shipped("lift"), "", ["shell"], None)
    results = Results(case, xr.Dataset(coords={"model": ["shell"]}), {})
    fields, motion = tmp_path / "fields.nc", tmp_path / "trajectories.nc"
    with (
        pytest.raises(error, match=message),
        start_rendering(results, [fields], motion, tmp_path) as gather,
    ):
        gather()
    assert not list(tmp_path.iterdir())
    assert not active_children()
