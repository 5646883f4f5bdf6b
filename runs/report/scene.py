# SPDX-License-Identifier: LGPL-3.0-or-later
"""Scene of a boom in motion: its surfaces, supports and loads, with magnified displacements.

Pictures magnify displacements and play by the same factor, and reduce the inner section
accordingly. So segments touch in the picture when they touch in the run. Scenes of shells and of
beams have the same interface.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, pairwise, repeat
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from protractile.analysis.curves import Curves
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Segment
from protractile.geometry.contact_places import pads
from protractile.geometry.section import Direction
from protractile.geometry.station import Station
from protractile.geometry.telescoping import drives_below
from protractile.geometry.typography import TO_MEGA, with_minus_signs
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.model_output import BeamOutput, SegmentMotion
from protractile.runs.report.symbols import Symbol, boom_symbols, edges
from protractile.shell_model.stress.stresses import ShellStress

Numbers = npt.NDArray[np.int32]

# Limit of magnified displacements over the length of the boom; magnification of sections; limit of
# the magnified play over the size of the section.
DISPLACEMENT_DRAWN, SECTION_DRAWN, PLAY_OF_SECTION = 0.2, 2.0, 0.5

# Displayed wall thickness over the height of the outer section. True thicknesses are invisible.
WALL_DRAWN = 0.03

# Tolerance in m for equal lengths.
SAME_PLACE = 1.0e-6

# Number of times for which displacements are computed together.
BATCH = 10

# Rotation for the view from above: x stays, y points up, z points to the viewer.
_FROM_ABOVE = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


class Overlap(NamedTuple):
    """Two telescoping segments that overlap."""

    outer: int  #: index of the outer segment
    inner: int  #: index of the inner segment
    stations: list[Station]  #: stations of the joint
    centres: list[float]  #: x in m of the pad centres of the stations
    clearance: float  #: clearance Δ in m


class Instant(NamedTuple):
    """A time in s, with the name of its event."""

    time: float
    title: str = ""

    def heading(self, scene: Scene) -> str:
        """Return the line above a picture, with time and tip deflection."""
        title = f"{self.title}:  " if self.title else ""
        tip = float(scene.motion["tip"].sel(time=self.time, method="nearest"))
        lateral = " (lateral)" if scene.from_above else ""
        deflection = with_minus_signs(f"{1.0e3 * tip:+.1f}")
        return f"{title}t = {self.time:.3f} s,  tip {deflection} mm{lateral}"


@dataclass(frozen=True)
class Scene:
    """A boom in motion, for pictures."""

    boom: Boom  #: the boom
    symbols: Sequence[Symbol]  #: symbols of its supports and loads
    points: Array  #: (num_points, 3) in m
    triangles: Numbers  #: (num_triangles, 3) point numbers
    segment: Numbers  #: (num_triangles,) segment of each triangle
    #: (num_modes, num_points, 3) displacements for unit coordinates
    modes: npt.NDArray[np.floating[Any]]
    state: xr.DataArray  #: modal coordinates (time, mode)
    #: trajectories of the model; ``tip`` is the deflection upwards in the picture
    motion: xr.Dataset
    stress: ShellStress | None = None  #: stresses of the triangles of a shell
    from_above: bool = False  #: True if y replaces z, see :meth:`views`
    model: str = ""  #: name of the model
    drives: bool = False  #: True for a crane that hoists, slews or luffs
    surface_contact: bool = False  #: True if the contact of the model is over surfaces

    @classmethod
    def views(cls, fields: xr.Dataset, motion: xr.Dataset, case: Case) -> list[Scene]:
        """Return the scenes of a shell: from the side, and for a boom in space also from above.

        For the view from above, the boom is rotated about x, so that y points up. The fields are
        those of :mod:`.stress.fields`, with ``state`` (time, mode); ``motion`` has the
        trajectories of the shell.
        """
        boom, model = build_boom(case), str(motion["model"].item())
        lines = {shell.name: shell.contact_line for shell in select_kind(Shell, case.models)}
        side = cls(
            boom=boom,
            symbols=list(boom_symbols(case, boom)),
            points=fields["points"].values,
            triangles=fields["triangles"].values,
            segment=fields["segment"].values,
            modes=fields["modes"].values,
            state=fields["state"].load(),
            motion=motion,
            stress=ShellStress.from_fields(fields),
            model=model,
            drives=any((case.hoist, case.slew, case.luff)),
            surface_contact=lines.get(model) == "surface",
        )
        if not boom.spatial:
            return [side]
        above = replace(
            side,
            symbols=[],
            points=side.points @ _FROM_ABOVE,
            modes=side.modes @ _FROM_ABOVE.astype(np.float32),
            motion=motion.assign(tip=motion["tip_lateral"]),
            from_above=True,
        )
        return [side, above]

    @classmethod
    def at_rest(cls, case: Case, boom: Boom, curves: Curves | None = None) -> Scene:
        """Return the scene of a boom in one state, as at t = 0 without ``curves`` of segments."""
        symbols, shapes = list(boom_symbols(case, boom)), []
        for number, segment in enumerate(boom.segments):
            marked = [symbol.places for symbol in symbols if symbol.segment == number]
            lugs = [cylinder.x for cylinder in boom.cylinders if cylinder.segment == number]
            x = np.unique([*segment.ends, *chain(*marked), *lugs])
            shapes.append(SegmentMotion(x, {"deflection": np.zeros((1, x.size))}))
        for number, curve in enumerate(curves or []):
            # Where a section force jumps, a curve has two values.
            x, first = np.unique(curve.x, return_index=True)
            deflection = curve.values.get("deflection", np.zeros(curve.x.size))[first]
            shapes[number] = SegmentMotion(x, {"deflection": deflection[None]})
        return cls.of_beam(case, boom, BeamOutput(np.zeros(1), shapes), xr.Dataset())[0]

    @classmethod
    def of_beam(
        cls, case: Case, boom: Boom, output: BeamOutput, motion: xr.Dataset
    ) -> tuple[Scene, Array]:
        """Return the scene of a beam as tubes along its axis, with bending stresses in Pa.

        Sections stay plane and keep their shape: a point at (y, z) moves along x by −z w′ − y v′,
        and with the section's twist. Stresses (num_frames, num_points) apply at the mid-lines of
        the plates. ``motion`` has the trajectories of the model.
        """
        tubes = map(_tube, repeat(boom), boom.segments, output.segments)
        points, triangles, displacements, stresses = zip(*tubes, strict=True)
        first = np.cumsum([0, *map(len, points)])
        numbered = [own + k for own, k in zip(triangles, first, strict=False)]
        # Each frame serves as a mode.
        frames = np.eye(output.time.size)
        scene = cls(
            boom=boom,
            symbols=list(boom_symbols(case, boom)),
            points=np.concatenate(points),
            triangles=np.concatenate(numbered).astype(np.int32),
            segment=np.repeat(np.arange(len(points)), [*map(len, triangles)]).astype(np.int32),
            modes=np.concatenate(displacements, axis=1),
            state=xr.DataArray(frames, {"time": output.time}, ("time", "mode")),
            motion=motion,
        )
        return scene, np.concatenate(stresses, axis=1)

    @property
    def direction(self) -> Direction:
        """The direction that points upwards in the picture."""
        return "y" if self.from_above else "z"

    @cached_property
    def owner(self) -> Numbers:
        """The segment (num_points,) of each point."""
        owner = np.zeros(len(self.points), dtype=np.int32)
        owner[self.triangles] = self.segment[:, None]
        return owner

    @cached_property
    def overlaps(self) -> list[Overlap]:
        """The overlaps of joints with play in the plane of the picture, from base to tip."""
        midpoints = defaultdict[int, list[float]](list)
        for pad in pads(self.boom):
            midpoints[pad.station.index].append(pad.midpoint)
        overlaps = []
        for number, joint in enumerate(self.boom.joints):
            if stations := self.boom.joint_stations(number, self.direction):
                clearance = 0.5 * ((joint.lateral_play or 0.0) if self.from_above else joint.play)
                centres = [float(np.mean(midpoints[station.index])) for station in stations]
                overlaps.append(Overlap(joint.outer, joint.inner, stations, centres, clearance))
        return overlaps

    def displacement(self, t: float) -> Array:
        """Return displacements (num_points, 3) in m at the output time nearest to ``t`` in s."""
        return next(self.displacements([t]))

    def displacements(self, times: Sequence[float]) -> Iterator[Array]:
        """Yield the displacements (num_points, 3) in m at the output times nearest to ``times``."""
        states = self.state.sel(time=list(times), method="nearest").values
        # The modes exceed the cache of the processor; a batch of times reads each mode once.
        for begin in range(0, len(states), BATCH):
            displacement = np.tensordot(states[begin : begin + BATCH], self.modes, axes=1)
            yield from displacement.astype(np.float64)

    def point_stresses(self, times: Sequence[float]) -> Iterator[Array]:
        """Yield the von Mises stress (num_points,) of a shell in MPa at output times in s.

        It is the larger stress of both faces, averaged over the triangles around a point.
        """
        assert self.stress is not None
        weights, around = np.repeat(self.stress.areas, 3), self.triangles.ravel()
        total = np.maximum(np.bincount(around, weights, len(self.points)), 1e-300)
        for stress in self.stress.instants(times):
            sums = weights * np.repeat(stress.largest(), 3)
            yield TO_MEGA * np.bincount(around, sums, len(self.points)) / total

    def travel(self, segment: int) -> Array:
        """Return the travel (num_times,) of a segment by drives in m, at the output times."""
        names = [
            f"extension-{n + 1}" if n else "extension"
            for n in drives_below(self.boom.joints, segment)
        ]
        none = np.zeros(self.motion.sizes["time"])
        return np.asarray(sum((self.motion[name].values for name in names), none))

    def along(self, t: float) -> Array:
        """Return the travel (num_points,) of each point by drives in m, at a time in s."""
        step = int(np.abs(self.motion["time"].values - t).argmin())
        travels = [self.travel(number)[step] for number in range(len(self.boom.segments))]
        return np.array(travels)[self.owner]

    def telescopes(self, overlap: Overlap) -> bool:
        """Return True if a drive moves the inner segment of an overlap in the outer one."""
        return bool((self.travel(overlap.outer) != self.travel(overlap.inner)).any())

    def reach(self, times: Sequence[float]) -> tuple[float, float]:
        """Return the smallest and largest x in m of the boom over given times."""
        x = self.points[:, 0]
        places = [x, *(x + self.along(time) for time in times)]
        return float(np.min(places)), float(np.max(places))

    def relative_displacements(self, t: float, segment: int, between: tuple[float, float]) -> Array:
        """Return displacements (num_points, 3) in m relative to a part of a segment.

        The in-plane rigid motion of the part ``between`` two x in m is subtracted from all points,
        since its magnification would tilt the boom.
        """
        displacement = self.displacement(t)
        x, _, z = self.points.T
        mine = (self.owner == segment) & (
            np.abs(x - np.mean(between)) <= np.ptp(between) / 2.0 + SAME_PLACE
        )
        along, up, turn = rigid_motion(self.points[mine][:, [0, 2]], displacement[mine][:, [0, 2]])
        return np.asarray(
            displacement - np.stack([along - turn * z, np.zeros_like(x), up + turn * x], axis=1)
        )

    def at(self, places: Array, segment: int, x: float, z: float) -> tuple[Array, int]:
        """Return the displayed position (3,) in m of a point in the plane of symmetry.

        The second result is the number of the lowest mesh point in the nearest cross-section.
        Displayed points (num_points, 3) and coordinates are in m.
        """
        mine = np.flatnonzero(self.owner == segment)
        off = np.abs(self.points[mine, 0] - x)
        mine = mine[off <= off.min() + SAME_PLACE]
        section, (low, high) = places[mine], self.edges(segment, x)
        bottom, top = section[section[:, 2].argmin()], section[section[:, 2].argmax()]
        place = bottom + (z - low) / (high - low) * (top - bottom)
        place[1] = section[:, 1].mean()
        return place, int(mine[section[:, 2].argmin()])

    def edges(self, segment: int, x: float) -> tuple[float, float]:
        """Return the lowest and highest z in m of a section at x in m."""
        return edges(self.boom, self.boom.segments[segment], x, self.direction)

    def half_height(self, segment: int, x: float | None = None) -> float:
        """Return half the height in m of a segment at x, or the largest half height."""
        ends = self.boom.segments[segment].ends if x is None else (x,)
        return max(0.5 * float(np.ptp(self.edges(segment, end))) for end in ends)

    def flange_in_plane(self, segment: int, side: int) -> Numbers:
        """Return the numbers (num_points,) of the points where the plane of bending cuts a flange.

        ``side`` is 1 for the top flange, -1 for the bottom flange.
        """
        mine = np.flatnonzero((self.owner == segment) & (np.abs(self.points[:, 1]) < SAME_PLACE))
        x, _, z = self.points[mine].T
        order = mine[np.lexsort([side * z, x.round(6)])]
        outermost = np.diff(self.points[order, 0], append=np.inf) > SAME_PLACE
        return np.asarray(order[outermost], dtype=np.int32)

    def wall(self, overlap: Overlap) -> float:
        """Return the thickness in m at which pictures show the walls of an overlap."""
        return 2.0 * WALL_DRAWN * self.half_height(overlap.outer)

    def fitting_scale(self, times: Sequence[float]) -> float:
        """Return a round magnification of displacements and play for the whole boom.

        Magnified displacements at given times in s stay below a fraction of the length.
        """
        begin, end = self.reach(times)
        largest = max(
            float(np.abs(displacement[:, 2]).max()) for displacement in self.displacements(times)
        )
        tallest = max(self.half_height(number) for number in range(len(self.boom.segments)))
        play = sum(overlap.clearance for overlap in self.overlaps)
        return round_scale(
            min(
                DISPLACEMENT_DRAWN * (end - begin) / max(largest, SAME_PLACE),
                PLAY_OF_SECTION * SECTION_DRAWN * tallest / max(play, SAME_PLACE),
            )
        )

    def magnify(self, displacement: Array, scale: float, section: float = SECTION_DRAWN) -> Array:
        """Return the displayed points (num_points, 3) in m.

        The rotation of a section moves its points in proportion to the magnified height. The
        displacements (num_points, 3) in m are magnified by ``scale`` like play, except those along
        the line of sight; ``section`` is the magnification of the outermost section.
        """
        factor = self._section_factors(scale, section)[self.owner]
        midpoints = [np.mean(self.edges(k, s.start)) for k, s in enumerate(self.boom.segments)]
        x, y, z = self.points.T
        ux, _, uz = scale * displacement.T
        return np.stack(
            [x + factor * ux, factor * y, factor * (z - np.array(midpoints)[self.owner]) + uz],
            axis=1,
        )

    def _section_factors(self, scale: float, section: float) -> Array:
        """Return magnifications (num_segments,) of sections; inner ones leave room for play."""
        factors = np.full(len(self.boom.segments), section)
        for overlap in sorted(self.overlaps, key=lambda o: -self.half_height(o.outer)):
            x = float(np.mean([station.x for station in overlap.stations]))
            outer, inner = (self.half_height(n, x) for n in (overlap.outer, overlap.inner))
            room = scale * overlap.clearance + section * self.wall(overlap)
            factors[overlap.inner] = (factors[overlap.outer] * outer - room) / inner
        return factors


def _tube(boom: Boom, segment: Segment, output: SegmentMotion) -> tuple[Array, ...]:
    """Return the tube of a beam segment: rings of corners, two triangles per plate and interval.

    The results are points (num_points, 3), triangles (num_triangles, 3), displacements (num_frames,
    num_points, 3) and stresses (num_frames, num_points) in Pa.
    """
    x, curves = output.x, output.curves
    corners = np.array([_corners(boom, segment, place) for place in x.tolist()])
    none = np.zeros_like(curves["deflection"])
    w, v, twist = (curves.get(name, none)[..., None] for name in ("deflection", "lateral", "twist"))
    turn_z, turn_y = (np.gradient(line[..., 0], x, axis=1)[..., None] for line in (w, v))
    y, z = np.moveaxis(corners, -1, 0)
    displacement = [-z * turn_z - y * turn_y, v - z * twist, w + y * twist]
    rings = np.arange(y.size).reshape(y.shape)
    quads = [(low, np.roll(low, -1), np.roll(high, -1), high) for low, high in pairwise(rings)]
    a, b, c, d = np.array(quads).transpose(1, 0, 2).reshape(4, -1)
    there = [segment.prismatic_at(place) for place in x.tolist()]
    # Rigid segments have no bending moments.
    stress = _bending(curves.get("moment", none), there, "second_moment_of_area") * z
    if "lateral_moment" in curves:
        stress += _bending(curves["lateral_moment"], there, "lateral.second_moment_of_area") * y
    shape = (len(w), -1)
    return (
        np.stack([np.repeat(x, y.shape[1]), y.ravel(), z.ravel()], axis=1),
        np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]),
        np.stack([part.reshape(shape) for part in displacement], axis=-1),
        np.abs(stress).reshape(shape),
    )


def _corners(boom: Boom, segment: Segment, x: float) -> Array:
    """Return y and z (num_corners, 2) in m of a section at x; without plates a square."""
    if segment.section is not None:
        return np.array([plate.start for plate in segment.section_at(x).plates])
    _, half = edges(boom, segment, x)
    return half * np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


def _bending(moments: Array, there: Sequence[Segment], number: str) -> Array:
    """Return moment over second moment of area (num_frames, num_places, 1) in Pa/m."""
    return np.asarray(moments / [attrgetter(number)(segment) for segment in there])[..., None]


def rigid_motion(places: Array, displacement: Array) -> Array:
    """Return two translations and a rotation (3,) that fit the motion of points (num_places, 2).

    The displacements are u₁ = t₁ − r x₂ and u₂ = t₂ + r x₁.
    """
    first, second = places.T
    none, unit = np.zeros_like(first), np.ones_like(first)
    whole = np.concatenate(
        [np.stack([unit, none, -second], axis=1), np.stack([none, unit, first], axis=1)]
    )
    return np.asarray(np.linalg.lstsq(whole, displacement.T.ravel(), rcond=None)[0])


def round_scale(largest: float) -> float:
    """Return the largest of the numbers …, 1, 2, 5, 10, … that does not exceed ``largest``."""
    decade = 10.0 ** np.floor(np.log10(largest))
    return float(decade * max(step for step in (1.0, 2.0, 5.0) if step * decade <= largest))
