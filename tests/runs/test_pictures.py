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
from protractile.geometry.boom import Cylinder
from protractile.runs.case import reading as case_file
from protractile.runs.case.load_tables import LoadTable, PayloadTable
from protractile.runs.pipeline.results import Results
from protractile.runs.report import opengl, sheet, snapshots, theme
from protractile.runs.report.boom_pictures import BoomView, draw_boom
from protractile.runs.report.opengl import RenderingUnavailable
from protractile.runs.report.overlap_pictures import draw_overlap
from protractile.runs.report.scene import Instant, Scene
from protractile.runs.report.sheet import Camera, Snapshot, stage, surface
from protractile.runs.report.snapshots import (
    _describe,
    characteristic_instant,
    render_motion,
    start_rendering,
)
from studies.gallery import draw_mesh, draw_sections
from tests.runs.case_texts import shipped
from tests.runs.moving_segments import CASE, TIME, moving_scene

# Of the film, each as any other.
FRAMES = 12


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
    ("probe", "seconds", "message"),
    [
        ("import os; os.abort()", 60.0, "VTK finds no working OpenGL and dies of SIGABRT; install "
         "libegl1 and libgl1-mesa-dri beside pip's vtk, or give Debian's VTK a display"),
        ("import no_such_pyvista", 60.0,
         "pyvista makes no picture: ModuleNotFoundError: No module named 'no_such_pyvista'"),
        ("raise SystemExit(3)", 60.0, "pyvista makes no picture: it does not say why"),
        ("import time; time.sleep(60.0)", 1.0, "VTK makes no picture within 1 s; install libegl1 "
         "and libgl1-mesa-dri beside pip's vtk, or give Debian's VTK a display"),
    ],
)  # fmt: skip
def test_missing_opengl_is_said(
    monkeypatch: pytest.MonkeyPatch, probe: str, seconds: float, message: str
) -> None:
    monkeypatch.setattr(opengl, "PROBE", probe)
    monkeypatch.setattr(opengl, "PROBE_SECONDS", seconds)
    with pytest.raises(RenderingUnavailable) as caught:
        opengl.require_opengl()
    assert str(caught.value) == message


def test_refuses_a_time_outside_the_run(shell: Scene, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"^time must be between 0 and 2 s, got 2\.5$"):
        render_motion([shell], tmp_path, [0.5, 2.5])


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
@pytest.mark.parametrize("place", [(4.0, 0.0, 1.0), (-6.0, 2.0, -0.5)])
def test_labels_are_at_the_projected_points(place: tuple[float, ...]) -> None:
    """Reference: other code, the centre of a small plate in VTK's picture."""
    camera = Camera(np.array([0.0, 0.0, 0.5]), 20.0, (400, 160), elevation=10.0)
    corners = np.array([[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]])
    two = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    with stage(camera.pixels) as plotter:
        plotter.add_mesh(surface(np.array(place) + corners, two), color="black", lighting=False)
        seen = camera.render(plotter)
    row, column = (axis.mean() + 0.5 for axis in np.nonzero(seen[..., 0] < 128))
    np.testing.assert_allclose(camera.project(place), [column, 160 - row], atol=0.6)


@pytest.fixture(scope="module")
def drawn(opengl: None, shell: Scene, tmp_path_factory: pytest.TempPathFactory) -> list[Snapshot]:
    folder = tmp_path_factory.mktemp("snapshots")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(snapshots, "FRAMES", FRAMES)
        written = render_motion([shell], folder)
    assert sorted(folder.iterdir()) == sorted(snapshot.path for snapshot in written)
    return written


@pytest.fixture(scope="module")
def pictures(drawn: list[Snapshot]) -> list[Path]:
    return [snapshot.path for snapshot in drawn]


def red(picture: Array) -> Array:
    """Return the mask of pixels with the colour of forces."""
    return (picture[..., 0] > 120.0) & (picture[..., 1:].max(axis=2) < 70.0)


def warmth(picture: Array) -> Array:
    """Return red less blue of a picture, negative in the outer segment."""
    return np.asarray(picture[..., 0] - picture[..., 2])


def picture_of(files: list[Path], name: str) -> Array:
    (path,) = (file for file in files if file.name == name)
    return np.asarray(Image.open(path).convert("RGB"), dtype=float)


@pytest.mark.slow
def test_pictures_are_named_after_their_content(pictures: list[Path]) -> None:
    names = ["boom-first-peak.png", "overlap-first-peak.png", "motion.gif"]
    assert [path.name for path in pictures] == names


@pytest.mark.slow
def test_boom_is_drawn(pictures: list[Path]) -> None:
    picture = picture_of(pictures, "boom-first-peak.png")[110:570]
    coloured = np.ptp(picture, axis=2) > 20.0
    assert 0.05 < coloured.mean() < 0.5
    columns = np.flatnonzero(coloured.any(axis=0))
    assert np.ptp(columns) > 0.75 * picture.shape[1]


@pytest.mark.slow
def test_overlap_shows_both_segments_and_the_forces(pictures: list[Path]) -> None:
    picture = picture_of(pictures, "overlap-first-peak.png")[190:800]
    is_force = red(picture)
    assert (warmth(picture) < -60.0).mean() > 0.08
    assert ((warmth(picture) > 100.0) & ~is_force).mean() > 0.08
    left, right = np.array_split(is_force, 2, axis=1)
    rows = [np.flatnonzero(part.any(axis=1)).mean() for part in (right, left)]
    assert rows[0] + 200.0 < rows[1]


def test_the_scale_of_stresses_ends_near_the_largest() -> None:
    """Reference: the stresses of the scene, of which 1 % may exceed the scale."""
    pytest.importorskip("pyvista")
    hanging = moving_scene(state=-1.0)
    view = BoomView.of(hanging, [Instant(0.5)])
    (stress,) = hanging.point_stresses([0.5])
    assert (stress > view.largest).mean() <= 0.01 < (stress >= view.largest).mean()
    np.testing.assert_array_equal(view.stresses[0.5], stress)


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
@pytest.mark.parametrize("steep", [1.0, 4.0])
def test_arrows_and_their_numbers_stay_above_the_axis(steep: float) -> None:
    """Reference: analytic. Forces of 1 and 0.9 of the maximum have arrows of 110 and 104 pixels."""
    with rc_context(theme.PAGE_RC):
        picture = draw_overlap([moving_scene(state=steep)], Instant(0.5))
    top, axis = 190, 810
    is_force = red(np.asarray(picture, dtype=float))
    assert not is_force[axis:].any()
    halves = np.array_split(is_force[top:axis], 2, axis=1)
    tallest = [half.sum(axis=0).max() for half in halves]
    assert tallest == pytest.approx([110.0, 104.0], abs=4.0)


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
def test_mesh_and_sections_are_drawn(shell: Scene) -> None:
    (overlap,) = shell.overlaps
    with rc_context(theme.PAGE_RC):
        mesh = draw_mesh(shell, overlap)
        sections = draw_sections(shell, Instant(0.5), overlap)
    for picture, share in ((mesh, 0.05), (sections, 0.001)):
        hue = warmth(np.asarray(picture, dtype=float)[190:800])
        assert (hue < -60.0).mean() > share
        assert (hue > 100.0).mean() > share


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
def test_symbols_of_loads_masses_and_cylinders_follow_the_boom(shell: Scene) -> None:
    """Reference: analytic. A red arrow of 3 % of the boom, a black ball at the tip, a cylinder."""
    payload = PayloadTable(mass=100.0)
    down = LoadTable(segment="inner", x="head", magnitude=-1.0e3)
    marked = moving_scene(CASE.model_copy(update={"payload": payload, "loads": (down,)}))
    jack = Cylinder(0, x=2.0, depth=0.25, ground=(0.5, -2.25), stiffness=1.0e7)
    marked = replace(marked, boom=replace(marked.boom, cylinders=(jack,)))
    instant, drawn = Instant(0.5), []
    for each in (shell, marked):
        with rc_context(theme.PAGE_RC):
            view = BoomView.of(each, [instant])
            (picture,) = draw_boom(view, [instant], 2.0)
        # From the lower edge of the picture, upside down as the camera counts.
        drawn.append(np.asarray(picture, dtype=float)[574:124:-1])
    differs = np.abs(drawn[1] - drawn[0]).max(axis=2) > 60.0
    at_tip = np.abs(marked.points[:, 0] - marked.boom.tip) < 1e-6
    places = view.places(marked.displacement(0.5), 0.5)[at_tip]
    seen = view.camera.project(places)
    x, middle = seen[:, 0].mean(), seen[:, 1].mean()
    rows, columns = np.nonzero(differs & red(drawn[1]))
    assert columns.mean() == pytest.approx(x, abs=25.0)
    assert np.ptp(rows) == pytest.approx(0.03 * each.boom.length * 1600 / view.camera.width, abs=12)
    assert rows.mean() > middle
    rows, columns = np.nonzero(differs & (drawn[1].max(axis=2) < 60.0))
    ball = columns > 1000
    assert columns[ball].mean() == pytest.approx(x, abs=25.0)
    assert rows[ball].mean() < middle
    # Letters of the explanation reach down into the picture, above the boom.
    bar = ~ball & (rows < middle)
    slope = np.polyfit(columns[bar], rows[bar], 1)[0]
    assert slope == pytest.approx(2.0 / 1.5, rel=0.2)


@pytest.mark.slow
def test_animation_is_small_and_moves(pictures: list[Path]) -> None:
    assert 40 <= snapshots.FRAMES <= 60
    assert pictures[-1].stat().st_size < 4.0e6 * FRAMES / snapshots.FRAMES
    with Image.open(pictures[-1]) as animation:
        assert animation.n_frames == FRAMES
        stills = []
        for frame in (0, animation.n_frames // 4):
            animation.seek(frame)
            stills.append(np.asarray(animation.convert("RGB"), dtype=float))
    assert (np.abs(stills[1] - stills[0]).max(axis=2) > 60.0).mean() > 0.01


@pytest.mark.slow
@pytest.mark.usefixtures("opengl")
def test_given_times_name_the_files(
    shell: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(snapshots, "FRAMES", 2)
    pictures = render_motion([shell], tmp_path, [0.05], every_view=True)
    written = [snapshot.path for snapshot in pictures]
    assert [path.name for path in written] == [f"{kind}-0.05s.png" for kind in ("boom", "overlap")]
    assert not red(picture_of(written, "overlap-0.05s.png")[190:800]).any()


@pytest.mark.slow
def test_captions_describe_the_pictures(drawn: list[Snapshot], shell: Scene) -> None:
    """Reference: analytic, the tip at the first peak of its motion."""
    deflection = 1e3 * float(shell.motion["tip"].sel(time=0.5, method="nearest"))
    boom, overlap, film = drawn
    assert boom.title == "Boom: first peak of the tip at 0.500 s"
    state = f"'shell', at the first peak of the tip (0.500 s, tip +{deflection:.1f} mm)"
    assert boom.caption.startswith(f"Boom in {state}. Colour: von Mises stress")
    assert overlap.title == "Overlap: first peak of the tip at 0.500 s"
    assert overlap.caption.startswith(f"In {state}: the overlap")
    assert "sum of the forces" not in overlap.caption
    assert (film.title, film.name) == ("Boom in motion, first 2 s", "motion")
    assert all("magnif" in snapshot.caption for snapshot in drawn)


def test_captions_tell_view_and_sign(shell: Scene) -> None:
    """Reference: analytic; a hyphen is no minus sign."""
    above = replace(shell, motion=shell.motion.assign(tip=-shell.motion["tip"]), from_above=True)
    deflection = 1e3 * float(shell.motion["tip"].sel(time=0.5, method="nearest"))
    when, state = _describe(above, Instant(0.5))
    assert when == "0.500 s"
    tip = f"lateral tip −{deflection:.1f} mm"
    assert state == f"'shell', seen from above, at 0.500 s ({tip})"


CASE_OF_SHELL = case_file.select(shipped("lift"), "", ["shell"], None)
RESULTS = Results(CASE_OF_SHELL, xr.Dataset(coords={"model": ["shell"]}), {})


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
    fields, motion = tmp_path / "fields.nc", tmp_path / "trajectories.nc"
    with (
        pytest.raises(error, match=message),
        start_rendering(RESULTS, [fields], motion, tmp_path) as gather,
    ):
        gather()
    assert not list(tmp_path.iterdir())
    assert not active_children()
