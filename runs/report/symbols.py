# SPDX-License-Identifier: LGPL-3.0-or-later
"""Signs of a drawing that keep their size and their upright stand, however the boom lies.

Each is a matplotlib path in units of its own size, about the place that it marks.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from geometry.arrays import Array

# Strokes of a zigzag, and how far it swings.
TURNS, SWING = 6, 0.18


def _strokes(*lines: Sequence[tuple[float, float]]) -> Path:
    """Lines that are not joined."""
    codes = [code for line in lines for code in (Path.MOVETO, *[Path.LINETO] * (len(line) - 1))]
    return Path([point for line in lines for point in line], codes)


def _zigzag(top: float, bottom: float) -> list[tuple[float, float]]:
    heights = np.linspace(top, bottom, TURNS + 1)
    swings = [0.0, *(SWING * (-1) ** i for i in range(TURNS - 1)), 0.0]
    return list(zip(swings, heights.tolist(), strict=True))


def _ground(z: float) -> list[Sequence[tuple[float, float]]]:
    """A hatched line."""
    hatches = [((x, z), (x - 0.15, z - 0.15)) for x in np.linspace(-0.3, 0.45, 6).tolist()]
    return [((-0.45, z), (0.45, z)), *hatches]


def _circle(z: float, radius: float) -> Path:
    """Its lowest point first."""
    turns = np.linspace(0.0, 2.0 * np.pi, 33)
    points: Array = np.stack([radius * np.sin(turns), z - radius * np.cos(turns)], axis=1)
    return Path(points, closed=True)


def turned(path: Path, degrees: float) -> Path:
    """A sign that leans to the left by an angle."""
    return path.transformed(Affine2D().rotate_deg(degrees))


PINNED = _strokes([(0.0, 0.0), (-0.35, -0.7), (0.35, -0.7), (0.0, 0.0)], *_ground(-0.7))
CLAMPED = _strokes(
    [(0.0, -0.8), (0.0, 0.8)],
    *([(0.0, z), (-0.25, z - 0.2)] for z in np.linspace(-0.6, 0.8, 8).tolist()),
)
ELASTIC = _strokes(_zigzag(0.0, -0.7), *_ground(-0.7))
PAYLOAD = Path.make_compound_path(_strokes([(0.0, 0.0), (0.0, -0.45)]), _circle(-0.72, 0.27))
FORCE_DOWN = _strokes([(0.0, 1.0), (0.0, 0.0)], [(-0.2, 0.35), (0.0, 0.0), (0.2, 0.35)])
FORCE_UP = turned(FORCE_DOWN, 180.0)
FORCE_BACK = turned(FORCE_DOWN, -90.0)
FORCE_ON = turned(FORCE_DOWN, 90.0)
AWAY = Path.make_compound_path(
    _circle(0.0, 0.4), _strokes([(-0.28, -0.28), (0.28, 0.28)], [(-0.28, 0.28), (0.28, -0.28)])
)
TOWARDS = Path.make_compound_path(_circle(0.0, 0.4), _circle(0.0, 0.1))
_TURNS = np.linspace(-0.3, 1.3, 17) * np.pi
CLOCKWISE = _strokes(
    [(0.5 * float(np.cos(t)), 0.5 * float(np.sin(t))) for t in _TURNS],
    [(0.02, -0.24), (0.5 * float(np.cos(_TURNS[0])), 0.5 * float(np.sin(_TURNS[0]))), (0.42, -0.7)],
)
MOMENT = CLOCKWISE.transformed(Affine2D().scale(-1.0, 1.0))


def rest(side: float) -> Path:
    """A block on the ground above (1) or below (-1) a segment."""
    upward = side * np.array([[-0.4, 0.25], [0.4, 0.25], [0.4, 0.6], [-0.4, 0.6], [-0.4, 0.25]])
    upward[:, 0] *= side
    return Path(upward)
