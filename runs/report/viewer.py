# SPDX-License-Identifier: LGPL-3.0-or-later
"""Interactive page of the deformed boom, with rotation and a time slider.

A page stores displacements as a few shapes of 16-bit numbers, and stresses as 8-bit numbers.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex
from scipy.spatial.transform import Rotation

from protractile.geometry.arrays import Array
from protractile.geometry.telescoping import drives_below
from protractile.geometry.typography import TO_MEGA
from protractile.runs.pipeline.model_output import frame_indices
from protractile.runs.pipeline.model_quality import main_models
from protractile.runs.pipeline.run import Run
from protractile.runs.report import theme
from protractile.runs.report.boom_pictures import PERCENTILE
from protractile.runs.report.charts import compress, pack_plotly, typed
from protractile.runs.report.marks import Mark, marks_of
from protractile.runs.report.pages import page
from protractile.runs.report.scene import SECTION_DRAWN, Scene

VIEWER = "viewer.html"

# Largest truncation error of the shapes, over the largest displacement.
TRUNCATION = 2.0e-3
# Maximum number of points in a page; finer meshes need other programs.
MOST_POINTS = 60_000
# Margin around the boom as a fraction of its length.
MARGIN = 0.02
# Largest integers of 16 and of 8 bits.
_SHORT, _BYTE = 32767, 255


class View(NamedTuple):
    """Boom and stresses that a page shows."""

    model: str  #: name of the model
    scene: Scene  #: scene of the boom
    time: Array  #: (num_frames,) in s
    stress: Array  #: (num_frames, num_points) in MPa
    quantity: str  #: name of the stress, with its unit

    @property
    def end(self) -> float:
        """The end of the colour scale in MPa, which stress peaks may exceed."""
        return float(np.percentile(self.stress, PERCENTILE)) or 1.0

    @classmethod
    def of_shell(cls, model: str, scene: Scene, time: Array) -> View:
        """Return the view of a shell."""
        stress = np.array([*scene.point_stresses(time.tolist())])
        return cls(model, scene, time, stress, "von Mises stress (MPa)")


def viewer(run: Run) -> str | None:
    """Return the page as HTML; None without plotly, or if the mesh is too fine for a page."""
    view = _view(run) if find_spec("plotly") else None
    if view is None:
        return None
    case = run.results.case
    content = pack_view(view, 0.0 if case.gravity is None else case.gravity.angle)
    return page(
        "viewer.html",
        title=case.title,
        view=content,
        plotly=pack_plotly(),
        content=compress(json.dumps(content, default=typed)),
    )


def _view(run: Run) -> View | None:
    """Return the view of the first shell or main beam; None if its mesh is too fine."""
    results = run.results
    for name, shell in run.shells.items():
        if shell.fields.sizes["point"] > MOST_POINTS:
            return None
        motion = results.trajectories.sel(model=name)
        scene = Scene.views(shell.fields, motion, results.case)[0]
        times = np.asarray(shell.fields["time"].values, dtype=float)
        return View.of_shell(name, scene, times[frame_indices(times.size)])
    first = main_models(results.case, list(run.beams))
    with_play = [m.name for m in results.completed_models if m.name in first and not m.bonded]
    name = [*first, *with_play][-1]
    beam, motion = run.beams[name], results.trajectories.sel(model=name)
    scene, stress = Scene.of_beam(results.case, results.boom, beam, motion)
    return View(name, scene, beam.time, TO_MEGA * stress, "bending stress (MPa)")


def pack_view(view: View, angle: float) -> dict[str, Any]:
    """Return the data of the page, for a boom at an angle in degrees about y."""
    scene = view.scene
    scale = scene.fitting_scale(view.time.tolist())
    rest = scene.magnify(np.zeros_like(scene.points), scale)
    displacement = np.array(
        [
            scene.magnify(each, scale) - rest + scale * each * [0.0, 1.0, 0.0]
            for each in scene.displacements(view.time.tolist())
        ]
    )
    parts, flat = few_shapes(displacement.reshape(view.time.size, -1))
    ways = extensions(scene, view.time)
    # The travel of drives along x is not magnified.
    along = [moves[None, :, None] * [1.0, 0.0, 0.0] for moves, _ in ways.values()]
    parts = np.column_stack([parts, *(way for _, way in ways.values())])
    rotation = Rotation.from_euler("y", -angle, degrees=True).as_matrix().T
    shapes = np.concatenate([flat.reshape(len(flat), -1, 3), *along]) @ rotation
    size = np.abs(shapes).max(axis=(1, 2)) + 1.0e-300
    marks = [
        mark._replace(offset=mark.offset @ rotation) for mark in marks_of(scene, rest, scale, angle)
    ]
    points = rest @ rotation
    places = points + np.tensordot(parts, shapes, axes=1)
    everything = np.concatenate([places.reshape(-1, 3), *(mark.at(points) for mark in marks)])
    return {
        "model": view.model,
        "magnified": scale,
        "enlarged": SECTION_DRAWN,
        "end": view.end,
        "time": view.time.tolist(),
        "drawn": {name: way.tolist() for name, (_, way) in ways.items()},
        "parts": (parts * size / _SHORT).tolist(),
        "points": points.astype("<f4"),
        "shapes": np.round(shapes / size[:, None, None] * _SHORT).astype("<i2"),
        "colors": np.round(np.minimum(view.stress / view.end, 1.0) * _BYTE).astype(np.uint8),
        "lines": [
            {"anchor": mark.anchor.astype("<i4"), "offset": mark.offset.astype("<f4")}
            for mark in marks
        ],
        "figure": _figure(
            view, marks, np.array([np.nanmin(everything, axis=0), np.nanmax(everything, axis=0)])
        ),
    }


def _figure(view: View, marks: Sequence[Mark], reach: Array) -> dict[str, Any]:
    """Return the figure of plotly; ``reach`` (2, 3) has the limits of all points in m."""
    colors = colormaps[theme.STRESS](np.linspace(0.0, 1.0, 9))
    boom = {
        "type": "mesh3d",
        **dict(zip("ijk", view.scene.triangles.T.astype(np.uint32), strict=True)),
        "cmin": 0.0,
        "cmax": view.end,
        "colorscale": [[i / 8.0, to_hex(color)] for i, color in enumerate(colors)],
        "colorbar": {"title": {"text": view.quantity, "side": "right"}, "thickness": 14},
        "flatshading": True,
        "lighting": {"ambient": 0.75, "diffuse": 0.4, "specular": 0.05},
        "hovertemplate": "%{intensity:.3g}<extra></extra>",
    }
    wires = [
        {
            "type": "scatter3d",
            "mode": "lines",
            "line": {"color": mark.color, "width": mark.width},
            "hoverinfo": "skip",
            "showlegend": False,
        }
        for mark in marks
    ]
    reach = reach + MARGIN * np.ptp(reach) * np.array([[-1.0], [1.0]])
    sizes = np.ptp(reach, axis=0)
    axes = {
        f"{name}axis": {
            "title": {"text": heading},
            "range": ends.tolist(),
            "nticks": max(2, round(8 * size / sizes.max())),
            "showbackground": False,
            "gridcolor": theme.RULE,
            "zeroline": False,
        }
        for name, heading, ends, size in zip(
            "xyz", ("x (m)", "", "z (m)"), reach.T, sizes, strict=True
        )
    }
    layout = {
        "template": "none",
        "margin": dict.fromkeys("lrtb", 0),
        "uirevision": "stays",
        "scene": axes
        | {
            "aspectmode": "manual",
            "aspectratio": dict(zip("xyz", (sizes / sizes.max()).tolist(), strict=True)),
            "dragmode": "orbit",
        },
    }
    return {"data": [boom, *wires], "layout": layout}


def extensions(scene: Scene, time: Array) -> Mapping[str, tuple[Array, Array]]:
    """Return the points that each drive moves, and its travel, by the name of the inner segment.

    The first array (num_points,) is 1 for points that the drive moves, else 0. The second is the
    travel (num_frames,) in m at the times (num_frames,) in s.
    """
    boom, travels = scene.boom, {}
    for number, joint in enumerate(boom.joints):
        if joint.drive is None:
            continue
        moves = [number in drives_below(boom.joints, n) for n in range(len(boom.segments))]
        way = scene.motion[f"extension-{number + 1}" if number else "extension"]
        factors = np.array(moves, dtype=float)[scene.owner]
        travels[boom.segments[joint.inner].name] = (
            factors,
            way.sel(time=time, method="nearest").values,
        )
    return travels


def few_shapes(displacement: Array) -> tuple[Array, Array]:
    """Return a motion as factors (num_frames, num_shapes) and shapes (num_shapes, num_values).

    This is a truncated singular value decomposition of displacements (num_frames, num_values)
    (Eckart and Young 1936), by eigenvectors of the Gram matrix of the frames. The truncation error
    is at most 0.2 % of the largest value.
    """
    _, parts = np.linalg.eigh(displacement @ displacement.T)
    parts = parts[:, ::-1]
    shapes, largest = parts.T @ displacement, float(np.abs(displacement).max())
    residual = displacement.copy()
    for count in range(1, len(parts) + 1):
        residual -= np.outer(parts[:, count - 1], shapes[count - 1])
        if np.abs(residual).max() <= TRUNCATION * largest:
            break
    return parts[:, :count], shapes[:count]
