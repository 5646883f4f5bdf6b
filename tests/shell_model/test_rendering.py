# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures show the displacement they say, at the instants they say, or say why there is none.

The shell of these tests is made by hand: an outer segment that bends beyond its supports at 0
and 2 m, an inner one that moves as a rigid body.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import xarray as xr
from matplotlib import rc_context
from PIL import Image

from geometry.mesh import mesh_segment
from geometry.section import BoxSection
from shell_model.pictures import rendering
from shell_model.pictures.boom import BoomView, Instant
from shell_model.pictures.deformation import MovingShell, round_scale
from shell_model.pictures.overlap import draw_overlap
from shell_model.pictures.rendering import (
    RenderingUnavailable,
    render_snapshots,
    telling_instants,
    where_pressed,
)
from shell_model.pictures.still import draw_mesh, draw_sections
from shell_model.pictures.stress import OVERLAP_PIXELS, StressScale, draw_stress
from shell_model.pictures.theme import LETTERS, Camera, Scene, Sheet

Array = npt.NDArray[np.float64]

OUTER = BoxSection(height=0.4890, width=0.3259, flange=0.0065, web=0.0065)
INNER = BoxSection(height=0.4636, width=0.2706, flange=0.0047, web=0.0047)
CLEARANCE = 7.0e-3
TIME = np.linspace(0.0, 2.0, 401)


def shape(points: Array, deflection: Array, slope: Array) -> Array:
    """(num_points, 3) motion of plane sections."""
    return np.stack([-points[:, 2] * slope, np.zeros(len(points)), deflection], axis=1)


@pytest.fixture(scope="module")
def fields() -> xr.Dataset:
    outer = mesh_segment(OUTER, {"start": 0.0, "support": 2.0, "tail": 9.0, "end": 10.0}, 0.3)
    inner = mesh_segment(INNER, {"start": 9.0, "head": 10.0, "end": 19.0}, 0.3)
    x, xi = outer.points[:, 0], inner.points[:, 0]
    still = np.zeros_like(outer.points), np.zeros_like(inner.points)
    modes = [
        (shape(outer.points, x * (x - 2.0) / 80.0, (2.0 * x - 2.0) / 80.0), still[1]),
        (still[0], shape(inner.points, np.ones_like(xi), np.zeros_like(xi))),
        (still[0], shape(inner.points, (xi - 9.0) / 10.0, np.full_like(xi, 0.1))),
    ]
    swing = np.sin(np.pi * TIME) ** 2
    state = np.stack([0.02 * swing, 0.02 * swing - CLEARANCE, 0.15 * swing], axis=1)
    triangles = [outer.triangles, inner.triangles + len(outer.points)]
    # What the outer segment's bending makes; the inner one is rigid but for a dark end.
    bent = np.zeros((1, len(outer.triangles), 6), dtype=np.float32)
    bent[0, :, 0] = -2.1e11 / 40.0 * outer.points[outer.triangles, 2].mean(axis=1)
    pressed = np.zeros((2, len(inner.triangles), 6), dtype=np.float32)
    pressed[1, :, 0] = 1.0e9 * (inner.points[inner.triangles, 0].mean(axis=1) < 9.4)
    return xr.Dataset(
        {
            "wall": ("triangle", np.concatenate([outer.walls, inner.walls])),
            "thickness": ("triangle", np.full(sum(len(t) for t in triangles), 0.0065)),
            "coordinates_1": (("own_1", "mode"), np.eye(3)[:1]),
            "coordinates_2": (("own_2", "mode"), np.eye(3)[1:]),
            "stress_1": (("own_1", "triangle_1", "stress"), bent),
            "stress_2": (("own_2", "triangle_2", "stress"), pressed),
            "joint_outer": ("joint", np.int32([0])),
            "joint_inner": ("joint", np.int32([1])),
            "clearance": ("joint", [CLEARANCE]),
            "lateral_clearance": ("joint", [np.nan]),
            "station_joint": ("station", np.int32([0, 0])),
            "points": (("point", "component"), np.concatenate([outer.points, inner.points])),
            "triangles": (("triangle", "corner"), np.concatenate(triangles).astype(np.int32)),
            "segment": ("triangle", np.repeat(np.int32([0, 1]), [len(t) for t in triangles])),
            "modes": (
                ("mode", "point", "component"),
                np.array([np.concatenate(mode) for mode in modes], dtype=np.float32),
            ),
            "state": (("time", "mode"), state.astype(np.float32)),
        },
        coords={"time": TIME, "plate_1": list(outer.plates), "plate_2": list(inner.plates)},
    )


@pytest.fixture(scope="module")
def trajectories() -> xr.Dataset:
    """Contact from 0.2 s on; the largest mean force at 0.5 s, the hardest blow at 1.6 s."""
    swing = np.sin(np.pi * TIME) ** 2
    force = np.where(TIME[:, None] >= 0.2 - 1e-9, [-2.0e4, 1.8e4] * swing[:, None], 0.0)
    peak = 1.2 * force
    peak[320, 0] = -9.0e4
    per_station = ("model", "time", "station")
    return xr.Dataset(
        {
            "tip": (("model", "time"), (0.17 * swing - CLEARANCE)[None]),
            "contact_force": (per_station, force[None]),
            "contact_force_peak": (per_station, peak[None]),
        },
        coords={
            "model": ["shell"],
            "time": TIME,
            "station": [9.0, 10.0],
            "direction": ("station", ["z", "z"]),
        },
    )


@pytest.fixture(scope="module")
def _opengl() -> None:
    try:
        rendering.require_opengl()
    except RenderingUnavailable as reason:
        pytest.skip(str(reason))


def test_displacement_is_the_sum_of_the_modes(fields: xr.Dataset, trajectories: xr.Dataset) -> None:
    """Reference: analytic. The shapes of the fixture, evaluated point by point."""
    (shell,) = MovingShell.views(fields, trajectories.sel(model="shell"))
    moved = shell.displacement(0.5)
    x, _, z = shell.points.T
    is_inner = np.arange(x.size) >= shell.members(1).min()
    deflection = np.where(is_inner, 0.013 + 0.015 * (x - 9.0), 0.02 * x * (x - 2.0) / 80.0)
    slope = np.where(is_inner, 0.015, 0.02 * (2.0 * x - 2.0) / 80.0)
    np.testing.assert_allclose(moved[:, 2], deflection, atol=1e-7)
    np.testing.assert_allclose(moved[:, 0], -z * slope, atol=1e-8)
    assert not moved[:, 1].any()
    assert not shell.displacement(0.0)[~is_inner].any()


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
    moved[shell.members(1), 2] = CLEARANCE
    drawn = shell.drawn(moved, scale, section)
    for side, apart in ((1, 0.0), (-1, 2.0 * scale * CLEARANCE)):
        outer, inner = (drawn[shell.flange_in_plane(k, side), 2] for k in (0, 1))
        between = side * (outer[0] - inner[0]) - section * shell.wall(overlap)
        assert between == pytest.approx(apart, abs=1e-9)


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
    assert not above.stops


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


def test_telling_instants_are_those_of_the_motion(trajectories: xr.Dataset) -> None:
    """Reference: analytic. The tip's sin² has its first peak at 0.5 s."""
    instants = telling_instants(trajectories.sel(model="shell"))
    expected = {"first-peak": 0.5, "largest-force": 1.6, "first-contact": 0.2}
    assert instants == pytest.approx(expected)


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
        (
            "import time; time.sleep(60.0)",
            1.0,
            "VTK makes no picture within 1 s; install libegl1 and libgl1-mesa-dri beside pip's "
            "vtk, or give Debian's VTK a display",
        ),
    ],
)
def test_missing_opengl_is_said_and_leaves_nothing(
    fields: xr.Dataset,
    trajectories: xr.Dataset,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    probe: str,
    seconds: float,
    message: str,
) -> None:
    monkeypatch.setattr(rendering, "PROBE", probe)
    monkeypatch.setattr(rendering, "PROBE_SECONDS", seconds)
    with pytest.raises(RenderingUnavailable) as caught:
        render_snapshots(fields, trajectories, "shell", tmp_path)
    assert str(caught.value) == message
    assert not list(tmp_path.iterdir())


def test_refuses_a_time_outside_the_run(
    fields: xr.Dataset, trajectories: xr.Dataset, tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match=r"^time must be between 0 and 2 s, got 2\.5$"):
        render_snapshots(fields, trajectories, "shell", tmp_path, [0.5, 2.5])


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


@pytest.fixture(scope="module")
def pictures(
    _opengl: None,
    fields: xr.Dataset,
    trajectories: xr.Dataset,
    tmp_path_factory: pytest.TempPathFactory,
) -> list[Path]:
    folder = tmp_path_factory.mktemp("snapshots")
    written = render_snapshots(fields, trajectories, "shell", folder)
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
    """A boom that hangs down everywhere has no deflection above 0."""
    hanging = fields.assign(state=-1.0 * fields["state"])
    (shell,) = MovingShell.views(hanging, trajectories.sel(model="shell"))
    deflection = 1e3 * shell.displacement(0.5)[:, 2]
    low, high = BoomView.of(shell, [Instant(0.5)]).deflections
    assert (low, high) == (min(0.0, deflection.min()), max(0.0, deflection.max()))


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
def test_animation_is_small_and_moves(pictures: list[Path]) -> None:
    assert pictures[-1].stat().st_size < 4.0e6
    with Image.open(pictures[-1]) as animation:
        assert 40 <= animation.n_frames <= 60
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
    written = render_snapshots(fields, trajectories, "shell", tmp_path, [0.05])
    names = [f"{kind}-0.05s.png" for kind in ("boom", "overlap", "stress")]
    assert [path.name for path in written] == [*names, "motion.gif"]
    overlap = picture_of(written, "overlap-0.05s.png")[190:800]
    assert not ((overlap[..., 0] > 120.0) & (overlap[..., 1:].max(axis=2) < 70.0)).any()
