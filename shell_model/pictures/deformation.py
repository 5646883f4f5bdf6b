# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where a picture shows the points of a deformed shell.

Displacements of millimetres are invisible on a boom of many metres, so pictures magnify them.
They magnify the play alike, at the cost of the inner section's height: segments touch in the
picture when they touch in the run.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt
import xarray as xr

from geometry.arrays import Array
from shell_model.stress.stresses import ShellStress

# As the files of runs have them.
Numbers = npt.NDArray[np.int32]

# Walls are drawn with this part of the outer section's height; their thickness is not known here.
WALL_DRAWN = 0.03

# Lengths in m that are the same; a displacement, as a part of the largest one, that is none in
# single precision.
SAME_PLACE, AT_REST = 1.0e-6, 1.0e-6

# Times for which displacements are computed together.
AT_ONCE = 10

# x stays, y comes up, z comes towards the eye.
_FROM_ABOVE = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


class Overlap(NamedTuple):
    """Two segments that slide in one another.

    Args:
        outer, inner: their numbers.
        stations: where they touch, as positions in the trajectories.
        clearance: Δ in m.
    """

    outer: int
    inner: int
    stations: list[int]
    clearance: float


class Stop(NamedTuple):
    """A rest on the ground.

    Args:
        segment: the number of the one that it stops.
        x: m.
        side: 1 above the segment, -1 below it.
        clearance: Δ in m.
    """

    segment: int
    x: float
    side: float
    clearance: float


class Lug(NamedTuple):
    """Where a cylinder meets a segment.

    Args:
        segment: its number.
        x: m.
        along, up: the unit vector from the ground to it.
    """

    segment: int
    x: float
    along: float
    up: float


class Sign(NamedTuple):
    """What else is on a segment.

    Args:
        segment: its number.
        x: m.
        kind: ``MASS``, ``SPRING``, an elastic support, or a force that pushes ``UP`` or ``DOWN``.
    """

    segment: int
    x: float
    kind: int


DOWN, MASS, UP, SPRING = -1, 0, 1, 2

_Kind = TypeVar("_Kind", Stop, Lug, Sign)


@dataclass(frozen=True, slots=True)
class MovingShell:
    """A reduced shell and its motion.

    Args:
        points: (num_points, 3) in m.
        triangles: (num_triangles, 3) point numbers.
        segment: (num_triangles,) of each triangle.
        members: for each segment (num_members,) point numbers.
        overlaps: from the base to the tip, where the segments touch along the third direction.
        stops: above and below segments.
        lugs: of cylinders.
        signs: of what else holds and loads it.
        modes: (num_modes, num_points, 3) in 1/√kg.
        state: (time, mode) modal coordinates.
        motion: trajectories of this shell alone, in which ``tip`` is along the third direction.
        stress: of the triangles.
        from_above: whether y has taken the place of z, see :meth:`views`.
        names: of the segments.
        ways: (num_times, num_segments) how far drives have moved each along x since the start, in
            m, at the times of ``motion``; nothing where there is no drive.
    """

    points: Array
    triangles: Numbers
    segment: Numbers
    members: Sequence[Numbers]
    overlaps: Sequence[Overlap]
    stops: Sequence[Stop]
    lugs: Sequence[Lug]
    signs: Sequence[Sign]
    modes: npt.NDArray[np.float32]
    state: xr.DataArray
    motion: xr.Dataset
    stress: ShellStress
    from_above: bool
    names: Sequence[str]
    ways: Array = field(default_factory=lambda: np.zeros((0, 0)))

    @classmethod
    def views(cls, fields: xr.Dataset, motion: xr.Dataset) -> list[MovingShell]:
        """From what a run has written: seen from the side, and a boom in space from above too.

        For the view from above the boom is turned about x, so that y points up.

        Args:
            fields: what ``shell_model.stress.fields`` gathers, ``state`` (time, mode), and the
                joints: ``joint_outer``, ``joint_inner``, ``clearance`` and ``lateral_clearance``
                (joint), ``station_joint`` (station); ``stop_segment``, ``stop_x``, ``stop_side``
                and ``stop_clearance`` (stop); ``lug_segment``, ``lug_x``, ``lug_along`` and
                ``lug_up`` (lug); ``sign_segment``, ``sign_x`` and ``sign_kind`` (sign); attribute
                ``drawn``, for each segment the names in ``motion`` of what draws it, as JSON. What
                the boom has none of may be missing.
            motion: dims ``time``, ``station``: ``tip``, in space ``tip_lateral``, in m,
                ``contact_force`` and ``contact_force_peak`` in N; coordinate ``direction`` of the
                stations.
        """
        directions = np.asarray(motion["direction"].values)
        triangles, segment = fields["triangles"].values, fields["segment"].values
        side = cls(
            points=fields["points"].values,
            triangles=triangles,
            segment=segment,
            members=[np.unique(triangles[segment == k]) for k in range(int(segment.max()) + 1)],
            overlaps=_overlaps(fields, directions, "z"),
            stops=_listed(fields, "stop", Stop),
            lugs=_listed(fields, "lug", Lug),
            signs=_listed(fields, "sign", Sign),
            modes=fields["modes"].values,
            state=fields["state"].load(),
            motion=motion,
            stress=ShellStress.of(fields),
            from_above=False,
            names=_names(fields),
            ways=_ways(fields, motion),
        )
        sideways = _overlaps(fields, directions, "y")
        if not sideways:
            return [side]
        above = replace(
            side,
            points=side.points @ _FROM_ABOVE,
            overlaps=sideways,
            stops=[],
            lugs=[],
            signs=[],
            modes=side.modes @ _FROM_ABOVE.astype(np.float32),
            motion=motion.assign(tip=motion["tip_lateral"]),
            from_above=True,
        )
        return [side, above]

    def displacement(self, t: float) -> Array:
        """(num_points, 3) in m, at the output time next to ``t`` (s)."""
        return next(self.displacements([t]))

    def displacements(self, times: Sequence[float]) -> Iterator[Array]:
        """(num_points, 3) each in m, at the output times next to ``times`` (s)."""
        states = self.state.sel(time=list(times), method="nearest").values
        # The modes, which do not fit into a processor's memory, are read once for several times.
        for begin in range(0, len(states), AT_ONCE):
            moved = np.tensordot(states[begin : begin + AT_ONCE], self.modes, axes=1)
            yield from moved.astype(np.float64)

    def smooth(self, values: npt.ArrayLike) -> Array:
        """(num_points,) the mean of the triangles around each point, by their areas."""
        around, count = self.triangles.ravel(), len(self.points)
        weights = np.repeat(self.stress.areas, 3)
        total = np.bincount(around, weights * np.repeat(np.asarray(values), 3), count)
        return np.asarray(total / np.maximum(np.bincount(around, weights, count), 1e-300))

    def beside(self, t: float, segment: int, between: tuple[float, float]) -> Array:
        """(num_points, 3) displacement in m beside a part of a segment, which seems to rest.

        What moves and turns the part, ``between`` two x in m, as a whole in the picture's plane is
        taken from all points: magnified it would tilt a sloping boom, and tells nothing of what
        touches what.
        """
        moved = self.displacement(t)
        mine = self.members[segment]
        x, _, z = self.points[mine].T
        mine = mine[(x >= between[0] - SAME_PLACE) & (x <= between[1] + SAME_PLACE)]
        x, _, z = self.points[mine].T
        none, unit = np.zeros_like(x), np.ones_like(x)
        rigid = np.concatenate(
            [np.stack([unit, none, -z], axis=1), np.stack([none, unit, x], axis=1)]
        )
        (along, up, turn), *_ = np.linalg.lstsq(rigid, moved[mine][:, [0, 2]].T.ravel(), rcond=None)
        x, _, z = self.points.T
        whole = np.stack([along - turn * z, np.zeros_like(x), up + turn * x], axis=1)
        return np.asarray(moved - whole)

    def along(self, t: float) -> Array:
        """(num_points,) how far drives have moved each along x in m, at a time in s."""
        if not self.ways.size:
            return np.zeros(len(self.points))
        step = int(np.abs(self.motion["time"].values - t).argmin())
        return self._at_points(self.ways[step])

    def slides(self, overlap: Overlap) -> bool:
        """Whether a drive moves the inner segment of an overlap in the outer one."""
        both = [overlap.outer, overlap.inner]
        return bool(self.ways.size and np.ptp(self.ways[:, both], axis=1).any())

    def half_height(self, segment: int) -> float:
        """Half of how tall a segment's section is, in m."""
        return 0.5 * float(np.ptp(self.points[self.members[segment], 2]))

    def middle(self, segment: int) -> float:
        """z in m half-way up a segment's section."""
        z = self.points[self.members[segment], 2]
        return 0.5 * float(z.min() + z.max())

    def supports(self) -> list[Array]:
        """(num_points, 3) each: the outlines that no mode moves across the boom."""
        across = np.abs(self.modes[..., 1:]).max(axis=(0, 2))
        held = self.points[across <= AT_REST * across.max()]
        return [held[np.abs(held[:, 0] - x) < SAME_PLACE] for x in np.unique(held[:, 0].round(6))]

    def flange_in_plane(self, segment: int, side: int) -> Numbers:
        """(num_points,) points of a flange in the plane of bending, from base to tip.

        ``side`` is 1 for the top, -1 for the bottom.
        """
        mine = self.members[segment]
        _, y, z = self.points[mine].T
        mine = mine[(np.abs(y) < SAME_PLACE) & (side * (z - self.middle(segment)) > 0.0)]
        x, _, z = self.points[mine].T
        order = np.lexsort([side * z, x.round(6)])
        outermost = np.diff(x[order], append=np.inf) > SAME_PLACE
        return np.asarray(mine[order][outermost])

    def half_between(self, segment: int, overlap: Overlap) -> float:
        """Half of how tall a segment's section is in the middle of an overlap's stations, in m."""
        x = float(np.mean(self.motion["station"].values[overlap.stations]))
        lines = [self.points[self.flange_in_plane(segment, side)] for side in (-1, 1)]
        low, high = (float(np.interp(x, line[:, 0], line[:, 2])) for line in lines)
        return 0.5 * (high - low)

    def change_of_shape(self, moved: Array, segment: int, x: float) -> tuple[Array, Array]:
        """(num_points + 1, 2) y and z in m once around a section, and how they change.

        What moves and turns the section as a whole is left out: two shifts and a turn, fitted
        by least squares. ``moved`` (num_points, 3) is in m, x a mesh line.
        """
        walls = (self.segment == segment) & (self.stress.wall < len(self.stress.plates[segment]))
        mine = np.unique(self.triangles[walls])
        mine = mine[np.abs(self.points[mine, 0] - x) < SAME_PLACE]
        y, z = self.points[mine, 1:].T
        mine = mine[np.arctan2(z, y).argsort()]
        y, z = self.points[mine, 1:].T
        none, unit = np.zeros_like(y), np.ones_like(y)
        whole = np.concatenate(
            [np.stack([unit, none, -z], axis=1), np.stack([none, unit, y], axis=1)]
        )
        fitted, *_ = np.linalg.lstsq(whole, moved[mine, 1:].T.ravel(), rcond=None)
        change = moved[mine, 1:] - (whole @ fitted).reshape(2, -1).T
        around = np.append(np.arange(mine.size), 0)
        return self.points[mine[around], 1:], change[around]

    def wall(self, overlap: Overlap) -> float:
        """Thickness in m with which the walls of an overlap are drawn."""
        return 2.0 * WALL_DRAWN * self.half_height(overlap.outer)

    def drawn(self, moved: Array, scale: float, section: float = 1.0) -> Array:
        """(num_points, 3) places in m at which a picture shows the points.

        A section that is drawn larger also turns with its larger height. What moves along the
        line of sight stays, or it would come out of the picture.

        Args:
            moved: (num_points, 3) displacement in m.
            scale: of displacement and play.
            section: of the outermost section.
        """
        factor = self._at_points(self._section_factors(scale, section))
        x, y, z = self.points.T
        z = z - self._at_points(np.array([self.middle(k) for k in range(len(self.members))]))
        ux, _, uz = scale * moved.T
        return np.stack([x + factor * ux, factor * y, factor * z + uz], axis=1)

    def _section_factors(self, scale: float, section: float) -> Array:
        """(num_segments,) of y and z; every inner segment makes room for the play around it."""
        factors = np.full(len(self.members), section)
        for overlap in sorted(self.overlaps, key=lambda o: -self.half_height(o.outer)):
            outer, inner = (self.half_between(n, overlap) for n in (overlap.outer, overlap.inner))
            room = scale * overlap.clearance + section * self.wall(overlap)
            factors[overlap.inner] = (factors[overlap.outer] * outer - room) / inner
        return factors

    def _at_points(self, of_segments: Array) -> Array:
        """(num_points,) what each segment's points have of it."""
        at_points = np.ones(len(self.points))
        at_points[self.triangles] = of_segments[self.segment][:, None]
        return at_points


def _names(fields: xr.Dataset) -> list[str]:
    """Of the segments, their numbers where a file has none."""
    given = str(fields.attrs.get("segments", ""))
    count = int(fields["segment"].max()) + 1
    return list(json.loads(given)) if given else [f"segment {n + 1}" for n in range(count)]


def _ways(fields: xr.Dataset, motion: xr.Dataset) -> Array:
    """Of each segment, the sum of the results that tell how far it is drawn along."""
    names = json.loads(str(fields.attrs.get("drawn", "[]")))
    if not any(names):
        return np.zeros((0, 0))
    none = np.zeros(motion.sizes["time"])
    return np.column_stack([sum((motion[n].values for n in own), none) for own in names])


def _overlaps(fields: xr.Dataset, directions: npt.NDArray[np.str_], along: str) -> list[Overlap]:
    """The overlaps of the joints that have play along ``z`` or ``y``, from the base to the tip.

    A stop belongs to no joint, wherever it is.
    """
    if "joint_outer" not in fields:
        return []
    clearances = fields["clearance" if along == "z" else "lateral_clearance"].values
    return [
        Overlap(
            outer=int(fields["joint_outer"][number]),
            inner=int(fields["joint_inner"][number]),
            stations=np.flatnonzero(
                (fields["station_joint"].values == number) & (directions == along)
            ).tolist(),
            clearance=float(clearance),
        )
        for number, clearance in enumerate(clearances)
        if np.isfinite(clearance)
    ]


def _listed(fields: xr.Dataset, what: str, kind: type[_Kind]) -> list[_Kind]:
    """What stands in columns, one for each of its fields."""
    if f"{what}_segment" not in fields:
        return []
    columns = [fields[f"{what}_{name}"].values.tolist() for name in kind._fields]
    return [kind(*row) for row in zip(*columns, strict=True)]
