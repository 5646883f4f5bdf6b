# SPDX-License-Identifier: LGPL-3.0-or-later
"""A surface in motion, small enough for a page: its displacements by a few shapes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from geometry.arrays import Array
from geometry.boom import Boom
from geometry.drawing import drives_below
from geometry.typography import TO_MEGA
from runs.pipeline.beam_output import frames
from shell_model.pictures.boom import SECTION_DRAWN, BoomView, Instant
from shell_model.pictures.deformation import MovingShell
from shell_model.pictures.stress import StressScale

# What shapes may leave of the largest displacement.
LEFT = 2.0e-3
# Finer meshes are for programs that are made for them.
MOST_POINTS = 60_000


@dataclass(frozen=True, slots=True)
class MovingSurface:
    """Triangles whose points move.

    Args:
        model: whose motion it is.
        time: (num_frames,) in s.
        points: (num_points, 3) where they are drawn at rest, in m.
        triangles: (num_triangles, 3) point numbers.
        segment: (num_points,) of each point, its position in the boom.
        shapes: (num_shapes, num_points, 3), how they are drawn to move.
        parts: (num_frames, num_shapes) of each shape.
        colors: (num_frames, num_points) what is coloured.
        quantity: what that is, with its unit.
        magnified: by how much displacements are drawn larger.
        enlarged: by how much sections are.
        end: of the colours; what is above has the last one.
        drawn: (num_frames,) in m by which each segment that a drive moves is drawn out of its outer
            one, by its name.
    """

    model: str
    time: Array
    points: Array
    triangles: npt.NDArray[np.int32]
    segment: npt.NDArray[np.int32]
    shapes: Array
    parts: Array
    colors: Array
    quantity: str
    magnified: float
    enlarged: float
    end: float
    drawn: Mapping[str, Array] = field(default_factory=dict)

    @classmethod
    def of_shell(cls, fields: xr.Dataset, motion: xr.Dataset) -> MovingSurface:
        """The whole boom, with the von Mises stresses of its walls, the larger of both faces.

        Stresses are means of the triangles around a point, by their areas.

        Args:
            fields, motion: as of :meth:`MovingShell.views`.
        """
        shell = MovingShell.views(fields, motion)[0]
        known = np.asarray(fields["time"].values, dtype=float)
        time = known[frames(known.size)]
        instants = [Instant(float(t)) for t in time]
        scale = BoomView.of(shell, instants).scale
        rest = shell.drawn(np.zeros_like(shell.points), scale, SECTION_DRAWN)
        drawn = [
            shell.drawn(moved, scale, SECTION_DRAWN) - rest + scale * moved * [0.0, 1.0, 0.0]
            for moved in shell.displacements(time.tolist())
        ]
        parts, shapes = few_shapes(np.array(drawn).reshape(time.size, -1))
        segment = np.zeros(len(rest), dtype=np.int32)
        for number, members in enumerate(shell.members):
            segment[members] = number
        stresses = [shell.smooth(s.largest()) for s in shell.stress.instants(time.tolist())]
        return cls(
            model=str(fields.attrs["model"]),
            time=time,
            points=rest,
            triangles=shell.triangles,
            segment=segment,
            shapes=shapes.reshape(len(shapes), *rest.shape),
            parts=parts,
            colors=np.array(stresses) * TO_MEGA,
            quantity="von Mises stress (MPa)",
            magnified=scale,
            end=StressScale.of(shell, instants).end * TO_MEGA,
            enlarged=SECTION_DRAWN,
        )

    def drawn_out(self, boom: Boom) -> MovingSurface:
        """The same, its segments moved along x as the boom's drives move them, not magnified."""
        names, shapes, ways = [], [], []
        for number, joint in enumerate(boom.joints):
            if joint.drive is None:
                continue
            moves = [number in drives_below(boom.joints, n) for n in range(len(boom.segments))]
            names.append(boom.segments[joint.inner].name)
            shapes.append(np.array(moves)[self.segment, None] * np.array([1.0, 0.0, 0.0]))
            ways.append(joint.drive.history(self.time))
        if not names:
            return self
        return replace(
            self,
            shapes=np.concatenate([self.shapes, shapes]),
            parts=np.column_stack([self.parts, *ways]),
            drawn=dict(zip(names, ways, strict=True)),
        )

    def turned(self, angle: float) -> MovingSurface:
        """The same, risen by an angle in degrees about y."""
        turn = np.radians(angle)
        risen = np.array(
            [[np.cos(turn), 0.0, np.sin(turn)], [0.0, 1.0, 0.0], [-np.sin(turn), 0.0, np.cos(turn)]]
        )
        return replace(self, points=self.points @ risen, shapes=self.shapes @ risen)


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


def packed(surface: MovingSurface) -> dict[str, Any]:
    """Numbers as typed arrays: shapes in 16 bits of their largest value, colours in 8 bits."""
    size = np.abs(surface.shapes).max(axis=(1, 2)) + 1.0e-300
    end = surface.end or 1.0
    wide = np.uint32 if len(surface.points) > np.iinfo(np.uint16).max else np.uint16
    return {
        "model": surface.model,
        "quantity": surface.quantity,
        "magnified": surface.magnified,
        "enlarged": surface.enlarged,
        "end": end,
        "time": surface.time.tolist(),
        "drawn": {name: ways.tolist() for name, ways in surface.drawn.items()},
        "parts": (surface.parts * size / np.iinfo(np.int16).max).tolist(),
        "points": surface.points.astype("<f4"),
        "triangles": surface.triangles.astype(wide),
        "shapes": np.round(surface.shapes / size[:, None, None] * np.iinfo(np.int16).max).astype(
            "<i2"
        ),
        "colors": np.round(np.minimum(surface.colors / end, 1.0) * 255.0).astype(np.uint8),
    }
