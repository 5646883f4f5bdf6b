# SPDX-License-Identifier: LGPL-3.0-or-later
"""The deformed boom in a page of its own: to be turned, with its time to be drawn along.

A page holds what moves as a few shapes, 16 bits a number, and stresses as 8 bits.
"""

from __future__ import annotations

import base64
import gzip
import json
from collections.abc import Mapping
from importlib.util import find_spec
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from geometry.arrays import Array
from geometry.telescoping import drives_below
from geometry.typography import TO_MEGA
from runs.pipeline.model_output import frames
from runs.pipeline.model_quality import leading
from runs.pipeline.run import Run
from runs.report.charts import packed_plotly
from runs.report.overlap_pictures import StressScale
from runs.report.pages import page
from runs.report.scene import SECTION_DRAWN, Scene, means_around

VIEWER = "viewer.html"

# What shapes may leave of the largest displacement.
LEFT = 2.0e-3
# Finer meshes are for programs that are made for them.
MOST_POINTS = 60_000
# Largest numbers of 16 and of 8 bits.
_SHORT, _BYTE = 32767, 255


class Shown(NamedTuple):
    """What a page shows.

    Args:
        model: whose motion it is.
        scene: the boom.
        time: (num_frames,) in s.
        stress: (num_frames, num_points) in MPa.
        quantity: what stress that is, with its unit.
        end: of the colours; what is above has the last one.
    """

    model: str
    scene: Scene
    time: Array
    stress: Array
    quantity: str
    end: float


def viewer(run: Run) -> str | None:
    """The page as HTML: library and numbers inside, no resource from elsewhere.

    None without plotly, and of a mesh that is too fine for a page.
    """
    shown = _shown(run) if find_spec("plotly") else None
    if shown is None:
        return None
    case = run.results.case
    angle = 0.0 if case.gravity is None else case.gravity.angle
    numbers = packed(shown, angle)
    content = json.dumps(numbers, default=_typed)
    return page(
        "viewer.html",
        title=case.title,
        surface=numbers,
        plotly=packed_plotly(),
        content=base64.b64encode(gzip.compress(content.encode(), 6, mtime=0)).decode("ascii"),
    )


def _shown(run: Run) -> Shown | None:
    """The first shell in motion, or the beam that is read first; none of a finer mesh."""
    results = run.results
    for name, shell in run.shells.items():
        if shell.fields.sizes["point"] > MOST_POINTS:
            return None
        motion = results.trajectories.sel(model=name)
        scene = Scene.views(shell.fields, motion, results.case)[0]
        known = np.asarray(shell.fields["time"].values, dtype=float)
        return of_shell(name, scene, known[frames(known.size)])
    first = leading(results.case, list(run.beams))
    with_play = [m.name for m in results.ran if m.name in first and not m.play_free]
    name = [*first, *with_play][-1]
    beam = run.beams[name]
    scene, stress = Scene.of_beam(results.boom, beam, results.trajectories.sel(model=name))
    return of_beam(name, scene, beam.time, stress)


def of_shell(model: str, scene: Scene, time: Array) -> Shown:
    """The von Mises stresses of the walls, the larger of both faces, means around each point."""
    stress = scene.stress
    assert stress is not None
    means = [
        means_around(scene.triangles, stress.areas, found.largest())
        for found in stress.instants(time.tolist())
    ]
    end = StressScale.of(stress, time.tolist()).end * TO_MEGA
    return Shown(model, scene, time, TO_MEGA * np.array(means), "von Mises stress (MPa)", end)


def of_beam(model: str, scene: Scene, time: Array, stress: Array) -> Shown:
    """The bending stresses of :meth:`Scene.of_beam`."""
    shown = TO_MEGA * stress
    return Shown(model, scene, time, shown, "bending stress (MPa)", float(shown.max()))


def packed(shown: Shown, angle: float) -> dict[str, Any]:
    """The numbers of a page, of a boom that has risen by an angle in degrees about y."""
    scene = shown.scene
    scale = scene.fitting_scale(shown.time.tolist())
    rest = scene.drawn(np.zeros_like(scene.points), scale)
    moved = [
        scene.drawn(each, scale) - rest + scale * each * [0.0, 1.0, 0.0]
        for each in scene.displacements(shown.time.tolist())
    ]
    parts, flat = few_shapes(np.array(moved).reshape(shown.time.size, -1))
    ways = extensions(scene, shown.time)
    # Drives move segments along x as they do, not magnified.
    along = [own[None, :, None] * [1.0, 0.0, 0.0] for own, _ in ways.values()]
    parts = np.column_stack([parts, *(way for _, way in ways.values())])
    rise = Rotation.from_euler("y", -angle, degrees=True).as_matrix().T
    shapes = np.concatenate([flat.reshape(len(flat), -1, 3), *along]) @ rise
    size = np.abs(shapes).max(axis=(1, 2)) + 1.0e-300
    end = shown.end or 1.0
    return {
        "model": shown.model,
        "quantity": shown.quantity,
        "magnified": scale,
        "enlarged": SECTION_DRAWN,
        "end": end,
        "time": shown.time.tolist(),
        "drawn": {name: way.tolist() for name, (_, way) in ways.items()},
        "parts": (parts * size / _SHORT).tolist(),
        "points": (rest @ rise).astype("<f4"),
        "triangles": scene.triangles.astype(np.uint32),
        "shapes": np.round(shapes / size[:, None, None] * _SHORT).astype("<i2"),
        "colors": np.round(np.minimum(shown.stress / end, 1.0) * _BYTE).astype(np.uint8),
    }


def extensions(scene: Scene, time: Array) -> Mapping[str, tuple[Array, Array]]:
    """What drives move: name of the inner segment → which points, and by how much.

    1 for each of (num_points,) that moves, else 0; (num_frames,) in m at times (num_frames,) in s.
    """
    boom, found = scene.boom, {}
    for number, joint in enumerate(boom.joints):
        if joint.drive is None:
            continue
        moves = [number in drives_below(boom.joints, n) for n in range(len(boom.segments))]
        way = scene.motion[f"drawn_out-{number + 1}" if number else "drawn_out"]
        own = np.array(moves, dtype=float)[scene.owner]
        found[boom.segments[joint.inner].name] = own, way.sel(time=time, method="nearest").values
    return found


def few_shapes(moved: Array) -> tuple[Array, Array]:
    """Parts (num_frames, num_shapes) and shapes (num_shapes, num_values) of what has moved.

    Singular vectors (Eckart and Young 1936), as many as leave at most ``LEFT`` of the largest value
    anywhere.

    Args:
        moved: (num_frames, num_values).
    """
    left, sizes, right = np.linalg.svd(moved, full_matrices=False)
    largest = float(np.abs(moved).max())
    for count in range(1, sizes.size + 1):
        parts = left[:, :count] * sizes[:count]
        if np.abs(parts @ right[:count] - moved).max() <= LEFT * largest:
            break
    return parts, right[:count]


def _typed(values: Array) -> dict[str, str]:
    """An array as the page's script reads it."""
    return {
        "kind": values.dtype.name,
        "bytes": base64.b64encode(values.tobytes()).decode("ascii"),
    }
