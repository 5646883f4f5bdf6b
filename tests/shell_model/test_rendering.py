# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures show the displacement they say, at the instants they say, or say why there is none."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib import rc_context
from PIL import Image

from geometry.arrays import Array
from shell_model.pictures import opengl, rendering
from shell_model.pictures.boom import BoomView, Instant, _rod, draw_boom
from shell_model.pictures.deformation import DOWN, MASS, SPRING, Lug, MovingShell
from shell_model.pictures.opengl import RenderingUnavailable
from shell_model.pictures.overlap import draw_overlap
from shell_model.pictures.rendering import render_film, render_stills, telling_instants
from shell_model.pictures.still import draw_mesh, draw_sections
from shell_model.pictures.stress import OVERLAP_PIXELS, StressScale, draw_stress
from shell_model.pictures.theme import LETTERS, Camera, Scene, Sheet
from tests.shell_model.moving_segments import TIME, moving_fields, moving_trajectories

# Of the film, each as any other.
FRAMES = 12


@pytest.fixture(scope="module")
def fields() -> xr.Dataset:
    return moving_fields()


@pytest.fixture(scope="module")
def trajectories() -> xr.Dataset:
    return moving_trajectories()


@pytest.fixture(scope="module")
def _opengl() -> None:
    try:
        opengl.require_opengl()
    except RenderingUnavailable as reason:
        pytest.skip(str(reason))


def test_telling_instants_are_those_of_the_motion(trajectories: xr.Dataset) -> None:
    """Reference: analytic. The tip's sin² has its first peak at 0.5 s."""
    instants = telling_instants(trajectories.sel(model="shell"))
    expected = {"first-peak": 0.5, "largest-force": 1.6, "first-contact": 0.2}
    assert instants == pytest.approx(expected)


def test_an_instant_is_told_once(trajectories: xr.Dataset) -> None:
    """Reference: by hand. Pressed from the start there is no first contact, and a largest force
    within 2 % of the run of the first peak is not seen twice."""
    motion = trajectories.sel(model="shell").copy(deep=True)
    motion["contact_force_peak"][:] = 1.0e3
    assert telling_instants(motion) == pytest.approx({"first-peak": 0.5, "largest-force": 0.0})
    end = float(TIME[-1])
    for apart, names in ((0.01, ["first-peak"]), (0.03, ["first-peak", "largest-force"])):
        blow = motion.copy(deep=True)
        at = int(np.abs(TIME - 0.5 - apart * end).argmin())
        blow["contact_force_peak"][at, 0] = 2.0e3
        assert list(telling_instants(blow)) == names


def test_motion_without_contact_or_peak_still_has_an_instant(trajectories: xr.Dataset) -> None:
    """Half a period has no peak inside, and a model without stations NaN for its forces."""
    motion = trajectories.sel(model="shell").where(trajectories["time"] < 0.0)
    motion["tip"] = trajectories["tip"].sel(model="shell")
    assert telling_instants(motion.isel(time=slice(0, 100))) == {
        "largest-deflection": pytest.approx(TIME[99])
    }


@pytest.mark.parametrize(
    ("probe", "seconds", "message"),
    [
        (
            "import os; os.abort()",
            60.0,
            "VTK finds no working OpenGL and dies of SIGABRT; install libegl1 and libgl1-mesa-dri "
            "beside pip's vtk, or give Debian's VTK a display",
        ),
        (
            "import no_such_pyvista",
            60.0,
            "pyvista makes no picture: ModuleNotFoundError: No module named 'no_such_pyvista'",
        ),
        ("raise SystemExit(3)", 60.0, "pyvista makes no picture: it does not say why"),
        (
            "import time; time.sleep(60.0)",
            1.0,
            "VTK makes no picture within 1 s; install libegl1 and libgl1-mesa-dri beside pip's "
            "vtk, or give Debian's VTK a display",
        ),
    ],
)
def test_missing_opengl_is_said(
    monkeypatch: pytest.MonkeyPatch, probe: str, seconds: float, message: str
) -> None:
    monkeypatch.setattr(opengl, "PROBE", probe)
    monkeypatch.setattr(opengl, "PROBE_SECONDS", seconds)
    with pytest.raises(RenderingUnavailable) as caught:
        opengl.require_opengl()
    assert str(caught.value) == message


def test_refuses_a_time_outside_the_run(
    fields: xr.Dataset, trajectories: xr.Dataset, tmp_path: Path
) -> None:
    views = MovingShell.views(fields, trajectories.sel(model="shell"))
    with pytest.raises(ValueError, match=r"^time must be between 0 and 2 s, got 2\.5$"):
        render_stills(views, tmp_path, [0.5, 2.5])


@pytest.mark.slow
@pytest.mark.usefixtures("_opengl")
@pytest.mark.parametrize("place", [(4.0, 0.0, 1.0), (-6.0, 2.0, -0.5)])
def test_letters_stand_where_the_camera_sees_their_place(place: tuple[float, ...]) -> None:
    """Reference: other code. The middle of a small plate that VTK has drawn."""
    camera = Camera(np.array([0.0, 0.0, 0.5]), 20.0, (400, 160), elevation=10.0)
    corners = np.array([[-0.3, 0, -0.3], [0.3, 0, -0.3], [0.3, 0, 0.3], [-0.3, 0, 0.3]])
    two = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    with Scene(camera.pixels) as scene:
        scene.surface("plate", np.array(place) + corners, two, color="black", lighting=False)
        seen = scene.seen_by(camera)
    row, column = (axis.mean() + 0.5 for axis in np.nonzero(seen[..., 0] < 128))
    np.testing.assert_allclose(camera.project(place), [column, 160 - row], atol=0.6)


@pytest.mark.parametrize("up", [0.8, -0.8])
def test_a_cylinder_is_a_bar_along_its_line(up: float) -> None:
    """Reference: analytic. From the flange that is towards the ground, closed: the divergence
    theorem gives length × thickness × width, |2 · 0.35 h / s_z| · 0.3 · 0.35 h · b / 2.
    """
    section = np.array([[4.0, y, z] for y in (-0.3, 0.3) for z in (-0.5, 0.5)])
    points, triangles = _rod(section, Lug(0, 4.0, 0.6, up))
    a, b, c = points[triangles].transpose(1, 0, 2)
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    assert abs(volume) == pytest.approx(2.0 * 0.35 / 0.8 * 0.3 * 0.35 * 0.3)
    near, far = points[[0, 1, 4, 5]].mean(axis=0), points[[2, 3, 6, 7]].mean(axis=0)
    assert near == pytest.approx([4.0, 0.0, -0.5 if up > 0.0 else 0.5])
    assert (far - near) / np.linalg.norm(far - near) == pytest.approx([-0.6, 0.0, -up])


@pytest.fixture(scope="module")
def pictures(
    _opengl: None,
    fields: xr.Dataset,
    trajectories: xr.Dataset,
    tmp_path_factory: pytest.TempPathFactory,
) -> list[Path]:
    folder = tmp_path_factory.mktemp("snapshots")
    views = MovingShell.views(fields, trajectories.sel(model="shell"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rendering, "FRAMES", FRAMES)
        written = [
            path for render in (render_stills, render_film) for path in render(views, folder)
        ]
    assert sorted(folder.iterdir()) == sorted(written)
    return written


def picture_of(files: list[Path], name: str) -> Array:
    (path,) = (file for file in files if file.name == name)
    return np.asarray(Image.open(path).convert("RGB"), dtype=float)


@pytest.mark.slow
def test_pictures_have_the_names_of_what_they_show(pictures: list[Path]) -> None:
    when = ("first-peak", "largest-force", "first-contact")
    expected = [f"{what}-{w}.png" for what in ("boom", "overlap", "stress") for w in when]
    assert [path.name for path in pictures] == [*expected, "motion.gif"]


@pytest.mark.slow
def test_boom_is_drawn_and_moves(pictures: list[Path]) -> None:
    """Reference: analytic. Columns and rows of coloured pixels against the camera's projection.

    The tip rises from 9 to 163 mm between the two pictures; grey, black and white have no hue.
    """
    top = {}
    for name in ("first-peak", "first-contact"):
        picture = picture_of(pictures, f"boom-{name}.png")[110:570]
        coloured = np.ptp(picture, axis=2) > 40.0
        assert 0.05 < coloured.mean() < 0.5
        columns = np.flatnonzero(coloured.any(axis=0))
        assert np.ptp(columns) > 0.75 * picture.shape[1]
        top[name] = np.flatnonzero(coloured.any(axis=1)).min()
    assert top["first-contact"] - top["first-peak"] > 100


@pytest.mark.slow
def test_overlap_shows_both_segments_and_the_forces(pictures: list[Path]) -> None:
    """Three colours at the first peak, and red on both sides: up at 10 m, down at 9 m."""
    picture = picture_of(pictures, "overlap-first-peak.png")[190:800]
    red, green, blue = np.moveaxis(picture, 2, 0)
    is_outer, is_inner = blue > red + 60.0, red > blue + 100.0
    is_force = (red > 120.0) & (green < 70.0) & (blue < 40.0)
    assert is_outer.mean() > 0.08
    assert (is_inner & ~is_force).mean() > 0.08
    left, right = np.array_split(is_force, 2, axis=1)
    rows = [np.flatnonzero(part.any(axis=1)).mean() for part in (right, left)]
    assert rows[0] + 200.0 < rows[1]


@pytest.mark.slow
def test_the_scale_of_deflections_ends_with_what_there_is(
    fields: xr.Dataset, trajectories: xr.Dataset
) -> None:
    """Reference: the displacements; a boom that hangs down is coloured by how far it does."""
    hanging = fields.assign(state=-1.0 * fields["state"])
    (shell,) = MovingShell.views(hanging, trajectories.sel(model="shell"))
    deflection = 1e3 * shell.displacement(0.5)[:, 2]
    assert BoomView.of(shell, [Instant(0.5)]).largest == np.abs(deflection).max()


@pytest.mark.slow
@pytest.mark.parametrize("steep", [0.0, 1.0, 1.2345, 4.0])
def test_the_scale_of_stresses_ends_with_what_there_is(
    fields: xr.Dataset, trajectories: xr.Dataset, steep: float
) -> None:
    """What is written at the end of the bar is not above the largest stress, 0 at rest.

    Reference: analytic, the stresses themselves.
    """
    steeper = fields.assign(state=steep * fields["state"])
    (shell,) = MovingShell.views(steeper, trajectories.sel(model="shell"))
    scale = StressScale.of(shell, [Instant(0.5)])
    sheet = Sheet(OVERLAP_PIXELS, 0)
    scale.add_bar(sheet)
    labels = [label.get_text() for label in sheet.figure.axes[-1].get_xticklabels()]
    largest = 1e-6 * float(shell.stress.at(0.5).largest().max())
    assert 0.99 * largest < float(labels[-1].removeprefix("≥ ")) <= largest or labels == ["0"]
    assert (labels == ["0"]) == (steep == 0.0)


@pytest.mark.slow
@pytest.mark.usefixtures("_opengl")
@pytest.mark.parametrize("steep", [1.0, 4.0])
def test_arrows_and_their_numbers_stay_above_the_axis(
    fields: xr.Dataset, trajectories: xr.Dataset, steep: float
) -> None:
    """Two red arrows, as long as their forces make them, however steep the overlap is.

    Reference: analytic. The forces of the first peak are 1 and 0.9 of the largest, and the
    arrows 110 and 104 pixels.
    """
    steeper = fields.assign(state=steep * fields["state"])
    (shell,) = MovingShell.views(steeper, trajectories.sel(model="shell"))
    instants, (overlap,) = [Instant(0.5)], shell.overlaps
    with rc_context(LETTERS):
        scale = StressScale.of(shell, instants)
        (plain,) = draw_overlap(shell, instants, overlap)
        (stress,) = draw_stress(shell, instants, scale, overlap)
    for picture, top, axis in ((plain, 190, 810), (stress, 345, 815)):
        red, green, blue = np.moveaxis(np.asarray(picture, dtype=float), 2, 0)
        is_force = (red > 120.0) & (green < 70.0) & (blue < 40.0)
        assert not is_force[axis:].any()
        halves = np.array_split(is_force[top:axis], 2, axis=1)
        tallest = [half.sum(axis=0).max() for half in halves]
        assert tallest == pytest.approx([110.0, 104.0], abs=4.0)


@pytest.mark.slow
def test_stress_is_dark_where_it_is_large(pictures: list[Path]) -> None:
    """Reference: the fixture. The inner segment is pressed from 9 to 9.4 m, and nowhere else; at
    the end of the light scale red is above blue, at its dark end below.
    """
    overlap = picture_of(pictures, "stress-first-peak.png")[390:800]
    red, blue = overlap[..., 0], overlap[..., 2]
    dark, light = blue > red + 30.0, red > blue + 60.0
    assert dark.mean() > 0.02
    assert light.mean() > 0.1
    columns = np.flatnonzero(dark.any(axis=0))
    # The picture shows 3.8 m round x = 9.5 m.
    assert 0.25 * 1600 < columns.min() < columns.max() < 0.6 * 1600


@pytest.mark.slow
@pytest.mark.usefixtures("_opengl")
def test_mesh_and_sections_are_drawn(fields: xr.Dataset, trajectories: xr.Dataset) -> None:
    """Both segments are seen in their colours: two walls of the outer one do not hide the inner."""
    (shell,) = MovingShell.views(fields, trajectories.sel(model="shell"))
    (overlap,) = shell.overlaps
    with rc_context(LETTERS):
        mesh = draw_mesh(shell, overlap)
        sections = draw_sections(shell, Instant(0.5), overlap)
    for picture, share in ((mesh, 0.05), (sections, 0.001)):
        pixels = np.asarray(picture, dtype=float)[190:800]
        red, _, blue = np.moveaxis(pixels, 2, 0)
        assert (blue > red + 60.0).mean() > share
        assert (red > blue + 100.0).mean() > share


@pytest.mark.slow
@pytest.mark.usefixtures("_opengl")
def test_masses_hang_and_loads_push(fields: xr.Dataset, trajectories: xr.Dataset) -> None:
    """Reference: analytic. A ball of 20 points across and a red arrow of 60 pixels at the tip, of
    which matplotlib leaves out some at its ends, and a grey block under a spring at 9 m.
    """
    marked = fields.assign(
        sign_segment=("sign", np.int32([1, 1, 0])),
        sign_x=("sign", [19.0, 19.0, 9.0]),
        sign_kind=("sign", np.int32([MASS, DOWN, SPRING])),
    )
    instant = Instant(0.5)
    pictures = []
    for each in (fields, marked):
        (shell,) = MovingShell.views(each, trajectories.sel(model="shell"))
        with rc_context(LETTERS):
            view = BoomView.of(shell, [instant])
            (picture,) = draw_boom(shell, [instant], view, 2.0)
        pictures.append(np.asarray(picture, dtype=float)[120:570])
    differs = np.abs(pictures[1] - pictures[0]).max(axis=2) > 60.0
    red, green, _ = np.moveaxis(pictures[1], 2, 0)
    arrow = differs & (red > 120.0) & (green < 70.0)
    assert arrow.sum(axis=0).max() == pytest.approx(56.0, abs=6.0)
    (tip, _) = view.camera.project([19.0, 0.0, 0.0])
    assert abs(np.flatnonzero(arrow.any(axis=0)).mean() - tip) < 60.0
    ball = differs & (pictures[1].max(axis=2) < 60.0)
    across = 20.0 * 100.0 / 72.0
    assert ball.sum() > 0.6 * across**2
    (spring, _) = view.camera.project([9.0, 0.0, 0.0])
    columns = np.flatnonzero(differs.any(axis=0))
    assert (np.abs(columns - spring) < 40.0).any()


@pytest.mark.slow
def test_animation_is_small_and_moves(pictures: list[Path]) -> None:
    """A whole film is below 4 MB."""
    assert 40 <= rendering.FRAMES <= 60
    assert pictures[-1].stat().st_size < 4.0e6 * FRAMES / rendering.FRAMES
    with Image.open(pictures[-1]) as animation:
        assert animation.n_frames == FRAMES
        stills = []
        for frame in (0, animation.n_frames // 4):
            animation.seek(frame)
            stills.append(np.asarray(animation.convert("RGB"), dtype=float))
    assert (np.abs(stills[1] - stills[0]).max(axis=2) > 60.0).mean() > 0.01


@pytest.mark.slow
@pytest.mark.usefixtures("_opengl")
def test_given_times_name_the_files(
    fields: xr.Dataset,
    trajectories: xr.Dataset,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(rendering, "FRAMES", 2)
    views = MovingShell.views(fields, trajectories.sel(model="shell"))
    written = [
        path for render in (render_stills, render_film) for path in render(views, tmp_path, [0.05])
    ]
    names = [f"{kind}-0.05s.png" for kind in ("boom", "overlap", "stress")]
    assert [path.name for path in written] == [*names, "motion.gif"]
    overlap = picture_of(written, "overlap-0.05s.png")[190:800]
    assert not ((overlap[..., 0] > 120.0) & (overlap[..., 1:].max(axis=2) < 70.0)).any()
