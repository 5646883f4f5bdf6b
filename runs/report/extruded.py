# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beams in motion as surfaces: their sections drawn along their axes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from geometry.boom import Boom, Segment
from geometry.typography import TO_MEGA
from runs.pipeline.beam_output import BeamOutput, MovedSegment
from runs.report.moving_surface import MovingSurface, few_shapes
from shell_model.pictures.boom import DISPLACEMENT_DRAWN, PLAY_OF_SECTION, SECTION_DRAWN
from shell_model.pictures.deformation import SAME_PLACE, WALL_DRAWN
from shell_model.pictures.theme import round_scale

# A segment whose plates are unknown is drawn so high and wide, as a part of the boom's length.
UNKNOWN = 0.015


class _Tube(NamedTuple):
    """One segment: points (num_points, 3), triangles, how they move (num_frames, num_points, 3),
    stress (num_frames, num_points) in Pa."""

    points: Array
    triangles: Array
    moved: Array
    stress: Array


def of_beam(boom: Boom, model: str, output: BeamOutput) -> MovingSurface:
    """A beam's boom, with the bending stress at the mid-lines of its plates.

    Sections stay plane and keep their shape: a point at (y, z) moves along x by −z w′ − y v′, and
    with the section's twist.

    Args:
        boom: whose model has moved.
        model: its name.
        output: how it has.
    """
    largest = max(float(np.abs(moved.read["deflection"]).max()) for moved in output.segments)
    corners = [
        np.array([_corners(boom, segment, x) for x in moved.x.tolist()])
        for segment, moved in zip(boom.segments, output.segments, strict=True)
    ]
    half = SECTION_DRAWN * max(float(np.abs(each[..., 1]).max()) for each in corners)
    play = sum(joint.clearance for joint in boom.joints if not joint.tied)
    scale = round_scale(
        min(
            DISPLACEMENT_DRAWN * boom.length / max(largest, SAME_PLACE),
            PLAY_OF_SECTION * half / max(play, SAME_PLACE),
        )
    )
    factors = _factors(boom, corners, scale)
    tubes = [
        _tube(segment, moved, around, factor, scale)
        for segment, moved, around, factor in zip(
            boom.segments, output.segments, corners, factors, strict=True
        )
    ]
    first = np.cumsum([0, *(len(tube.points) for tube in tubes)])
    moved = np.concatenate([tube.moved for tube in tubes], axis=1)
    parts, shapes = few_shapes(moved.reshape(output.time.size, -1))
    stress = np.concatenate([tube.stress for tube in tubes], axis=1) * TO_MEGA
    return MovingSurface(
        model=model,
        time=output.time,
        points=np.concatenate([tube.points for tube in tubes]),
        triangles=np.concatenate(
            [tube.triangles + begin for tube, begin in zip(tubes, first, strict=False)]
        ).astype(np.int32),
        segment=np.repeat(np.arange(len(tubes)), [len(tube.points) for tube in tubes]).astype(
            np.int32
        ),
        shapes=shapes.reshape(len(shapes), -1, 3),
        parts=parts,
        colors=stress,
        quantity="bending stress (MPa)",
        magnified=scale,
        enlarged=SECTION_DRAWN,
        end=float(stress.max()),
    )


def _corners(boom: Boom, segment: Segment, x: float) -> Array:
    """(num_corners, 2) y and z in m at x in m, once around."""
    if segment.section is not None:
        return np.array([plate.start for plate in segment.section_at(x).plates])
    half = 0.5 * UNKNOWN * boom.length
    return half * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


def _factors(boom: Boom, corners: list[Array], scale: float) -> list[float]:
    """By how much each section is drawn larger: inner ones make room for the play around them."""
    factors = [SECTION_DRAWN] * len(corners)
    halves = [0.5 * float(np.ptp(each[..., 1])) for each in corners]
    for joint in boom.joints:
        room = scale * joint.clearance + SECTION_DRAWN * 2.0 * WALL_DRAWN * halves[joint.outer]
        around = factors[joint.outer] * halves[joint.outer]
        factors[joint.inner] = (around - room) / halves[joint.inner]
    return factors


def _tube(
    segment: Segment, moved: MovedSegment, corners: Array, factor: float, scale: float
) -> _Tube:
    """Rings (place, corner) of a segment, joined by two triangles for each plate and stretch.

    ``corners`` (num_places, num_corners, 2) are the y and z of each ring in m.
    """
    x, read = moved.x, moved.read
    none = np.zeros_like(read["deflection"])
    w, v, twist = read["deflection"], read.get("lateral", none), read.get("twist", none)
    slopes = [np.gradient(line, x, axis=1)[..., None] for line in (w, v)]
    y, z = np.moveaxis(corners, -1, 0)
    along = -factor * (z * slopes[0] + y * slopes[1])
    across = v[..., None] - factor * z * twist[..., None]
    up = w[..., None] + factor * y * twist[..., None]
    shape = (len(w), -1)
    places = np.stack([np.repeat(x, y.shape[1]), factor * y.ravel(), factor * z.ravel()], axis=1)
    rings = np.arange(y.size).reshape(y.shape)
    quads = [(low, np.roll(low, -1), np.roll(high, -1), high) for low, high in pairwise(rings)]
    a, b, c, d = np.array(quads).transpose(1, 0, 2).reshape(4, -1)
    there = [segment.local(place) for place in x.tolist()]
    # Rigid segments know no moments.
    bending = _bent(read.get("moment", none), there, "second_moment_of_area") * z
    if "lateral_moment" in read:
        bending += _bent(read["lateral_moment"], there, "lateral.second_moment_of_area") * y
    return _Tube(
        points=places,
        triangles=np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]),
        moved=scale * np.stack([part.reshape(shape) for part in (along, across, up)], axis=-1),
        stress=np.abs(bending).reshape(shape),
    )


def _bent(moments: Array, there: Sequence[Segment], number: str) -> Array:
    """(num_frames, num_places, 1) curvature times Young's modulus, in Pa/m."""
    return np.asarray(moments / [attrgetter(number)(segment) for segment in there])[..., None]
