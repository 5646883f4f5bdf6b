# SPDX-License-Identifier: LGPL-3.0-or-later
"""Lines of the supports, loads and cylinders of a scene, and its elevation to scale."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from matplotlib.transforms import Affine2D

from protractile.geometry.arrays import Array
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.scene import Scene
from protractile.runs.report.symbols import abbreviate

# Size of a symbol over the length of the boom; of a small symbol over this size; scale at which
# matplotlib converts the curves of a symbol into polygons.
SYMBOL, SMALL, FINE = 0.03, 0.6, 100.0


class Mark(NamedTuple):
    """Lines of a symbol or of a cylinder.

    Each vertex follows a point of the scene. ``anchor`` has the point numbers, -1 for vertices on
    the ground and for gaps. ``offset`` (num_vertices, 3) has the vertices relative to these points
    in m, NaN for gaps.
    """

    kind: str  #: kind of the symbol, or ``cylinders``
    meaning: str  #: what it stands for, with its size
    color: str  #: colour in CSS notation
    width: float  #: width in pixels
    anchor: npt.NDArray[np.int64]
    offset: Array

    def at(self, places: Array) -> Array:
        """Return the vertices (num_vertices, 3) for points (num_points, 3) of the scene in m."""
        return self.offset + places[self.anchor] * (self.anchor >= 0)[:, None]


def marks_of(
    scene: Scene, rest: Array, scale: float, angle: float, size: float = SYMBOL
) -> list[Mark]:
    """Return the lines of symbols of supports and loads, and of cylinders.

    The boom at rest has the displayed points (num_points, 3) in m, and is drawn at an angle in
    degrees, at which some symbols stay upright. ``scale`` magnifies displacements and play;
    ``size`` is the size of a symbol over the length of the boom.
    """
    marks, gap = [], np.full((1, 3), np.nan)
    for symbol in scene.symbols:
        length = size * scene.boom.length * (1.0 if len(symbol.places) == 1 else SMALL)
        path = symbol.on_boom(angle)
        polygons = path.transformed(Affine2D().scale(FINE)).to_polygons(closed_only=False)
        anchors, offsets = [], []
        for x in symbol.places:
            place, near = scene.at(rest, symbol.segment, x, symbol.z(scene.boom, x))
            place[2] += (1.0 if symbol.edge == "top" else -1.0) * scale * symbol.clearance
            if not isinstance(symbol.edge, str):
                # The symbol lies in front of the wall, which would hide it otherwise.
                place[1] = 1.02 * rest[scene.owner == symbol.segment, 1].min()
            fixed = np.zeros(3) if symbol.grounded else rest[near]
            if any(symbol.arm):
                offsets += [np.array([place, place + symbol.arm]) - fixed, gap]
                anchors += [near] * 3
                place = place + symbol.arm
            for outline in polygons:
                corners = np.insert(length / FINE * np.asarray(outline), 1, 0.0, axis=1)
                offsets += [corners + place - fixed, gap]
                anchors += [-1 if symbol.grounded else near] * (len(corners) + 1)
        lines = np.array(anchors), np.concatenate(offsets)
        marks.append(Mark(symbol.kind, symbol.meaning, symbol.color, 3.0, *lines))
    for cylinder in () if scene.from_above else scene.boom.cylinders:
        side = 0 if cylinder.direction[1] > 0.0 else 1
        edge = scene.edges(cylinder.segment, cylinder.x)[side]
        place, near = scene.at(rest, cylinder.segment, cylinder.x, edge)
        down = np.subtract(cylinder.ground, (cylinder.x, -cylinder.depth))
        ends = np.array([place - rest[near], place + np.insert(down, 1, 0.0)])
        meaning = f"cylinder, {abbreviate(cylinder.axial_stiffness, 'N/m')}"
        lines = np.array([near, -1]), ends
        marks.append(Mark("cylinders", meaning, theme.INK, 8.0, *lines))
    return marks


def elevation(scene: Scene, places: Array, scale: float, angle: float, size: float) -> Chart:
    """Return the boom at displayed points (num_points, 3) in m, at an angle in degrees.

    The curves are the axis of the undeformed boom if it is deformed, the outlines of the segments
    from tip to base, and the marks of :func:`marks_of`, which explains ``scale`` and ``size``.
    """
    boom = scene.boom
    axis = np.array([[boom.segments[0].start, 0.0], [boom.tip, 0.0]])
    parts: list[tuple[str, Array, str, float, dict[str, Any]]] = []
    if (places != scene.points).any():
        parts.append(("", axis, theme.FAINT, 1.0, {"linestyle": "--"}))
    for index in reversed(range(len(boom.segments))):
        along, _, up = places[scene.owner == index].T
        x, number = np.unique(along.round(9), return_inverse=True)
        low, high = np.full(x.size, np.inf), np.full(x.size, -np.inf)
        np.minimum.at(low, number, up)
        np.maximum.at(high, number, up)
        around = np.stack([[*x, *x[::-1], x[0]], [*low, *high[::-1], low[0]]], axis=1)
        color = theme.segment_color(index)
        parts.append((boom.segments[index].name, around, color, 1.2, {"filled": True}))
    parts += [
        (mark.meaning, mark.at(places)[:, [0, 2]], mark.color, 0.5 * mark.width, {})
        for mark in marks_of(scene, scene.points, scale, angle, size)
    ]
    turn = np.radians(angle)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    turned = [matrix @ corners.T for _, corners, *_ in parts]
    curves = [
        Curve(name, z, color, at=x, width=width, **more)
        for (name, _, color, width, more), (x, z) in zip(parts, turned, strict=True)
    ]
    every = np.concatenate(turned, axis=1)[0]
    return Chart(np.array([np.nanmin(every), np.nanmax(every)]), curves, along="", equal=True)
