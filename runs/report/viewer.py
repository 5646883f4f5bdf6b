# SPDX-License-Identifier: LGPL-3.0-or-later
"""Interactive page of the deformed boom, with rotation and a time slider.

A page stores displacements as a few shapes of 16-bit numbers, and stresses as 8-bit numbers.
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

# Truncation error of the shapes, as a part of the largest displacement.
LEFT = 2.0e-3
# Limit of a page's mesh; finer meshes need dedicated programs.
MOST_POINTS = 60_000
# Largest numbers of 16 and of 8 bits.
_SHORT, _BYTE = 32767, 255


class Shown(NamedTuple):
    """Content of a page.

    Args:
        model: of the motion.
        scene: the boom.
        time: (num_frames,) in s.
        stress: (num_frames, num_points) in MPa.
        quantity: name of the stress, with its unit.
        end: of the colour scale, which also colours stresses above it.
    """

    model: str
    scene: Scene
    time: Array
    stress: Array
    quantity: str
    end: float


def viewer(run: Run) -> str | None:
    """Return the page as HTML: library and numbers inside, no external resource.

    Return None without plotly, and for a mesh that is too fine for a page.
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
    """Return the first shell in motion, or the leading beam; None for finer meshes."""
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
    """Return the von Mises stresses of the plates: larger of both faces, means around points."""
    stress = scene.stress
    assert stress is not None
    means = [
        means_around(scene.triangles, stress.areas, found.largest())
        for found in stress.instants(time.tolist())
    ]
    end = StressScale.of(stress, time.tolist()).end * TO_MEGA
    return Shown(model, scene, time, TO_MEGA * np.array(means), "von Mises stress (MPa)", end)


def of_beam(model: str, scene: Scene, time: Array, stress: Array) -> Shown:
    """Return the bending stresses of :meth:`Scene.of_beam`."""
    shown = TO_MEGA * stress
    return Shown(model, scene, time, shown, "bending stress (MPa)", float(shown.max()))


def packed(shown: Shown, angle: float) -> dict[str, Any]:
    """Return the numbers of a page, for a boom at an angle in degrees about y."""
    scene = shown.scene
    scale = scene.fitting_scale(shown.time.tolist())
    rest = scene.drawn(np.zeros_like(scene.points), scale)
    moved = [
        scene.drawn(each, scale) - rest + scale * each * [0.0, 1.0, 0.0]
        for each in scene.displacements(shown.time.tolist())
    ]
    parts, flat = few_shapes(np.array(moved).reshape(shown.time.size, -1))
    ways = extensions(scene, shown.time)
    # Drives move segments along x by true distances, not magnified.
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
    """Return the extension by drives: name of the inner segment → its points, and distances.

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
    """Return parts (num_frames, num_shapes) and shapes (num_shapes, num_values) of a motion.

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
    """Return an array in the format of the page's script."""
    return {
        "kind": values.dtype.name,
        "bytes": base64.b64encode(values.tobytes()).decode("ascii"),
    }
