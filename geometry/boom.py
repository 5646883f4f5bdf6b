# SPDX-License-Identifier: LGPL-3.0-or-later
"""The boom: segments that slide in one another, their supports, joints and loads.

x runs along the boom, z is the plane of bending, y is lateral. Everything is in SI units.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from geometry.section import BoxSection

# Two lengths closer than this (m) are the same place: far below any plate, far above round-off.
SAME_PLACE = 1.0e-9


class BoomError(ValueError):
    """A boom that cannot be. ``where`` is the key of the fault, ``segment[2].span`` say."""

    def __init__(self, where: str, what: str) -> None:
        super().__init__(f"{where}: {what}")
        self.where = where
        self.what = what


@dataclass(frozen=True, slots=True)
class Material:
    """Isotropic linear elasticity: E in Pa, ν, density in kg/m³."""

    youngs_modulus: float
    poissons_ratio: float
    density: float

    @property
    def shear_modulus(self) -> float:
        """G = E / 2(1 + ν) in Pa."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))


@dataclass(frozen=True, slots=True)
class Segment:
    """One box of the boom, with the numbers of its beam and, where known, its plates.

    Args:
        name: how messages and results call it.
        start, end: x of its ends in m.
        material: elastic constants and density.
        mass_per_length: m̄ in kg/m.
        second_moment_of_area: J in m⁴.
        rotary_inertia: I_p in kg·m.
        section: the box; only shear-flexible beams and shells need it.
        load: uniform load along z in N/m, applied at t = 0 and kept.
        supports: x of the places whose deflection is held at zero.
        viscous_damping: μ̄ of (25) in N·s/m².
    """

    name: str
    start: float
    end: float
    material: Material
    mass_per_length: float
    second_moment_of_area: float
    rotary_inertia: float
    section: BoxSection | None = None
    load: float = 0.0
    supports: tuple[float, ...] = ()
    viscous_damping: float = 0.0

    @property
    def length(self) -> float:
        """Length in m."""
        return self.end - self.start

    @property
    def bending_stiffness(self) -> float:
        """E J in N·m²."""
        return self.material.youngs_modulus * self.second_moment_of_area

    @property
    def rigid_modes(self) -> int:
        """How many motions in the plane of bending the supports leave free of strain."""
        return max(0, 2 - len(self.supports))

    def holds(self, x: float) -> bool:
        """Whether x lies on the segment, its ends included."""
        return self.start - SAME_PLACE <= x <= self.end + SAME_PLACE


@dataclass(frozen=True, slots=True)
class Joint:
    """Where an inner segment slides in an outer one, touching it at the stations.

    Args:
        outer, inner: positions of the two in ``Boom.segments``.
        stations: x at which they may touch, rising.
        clearance: Δ in m each way, half the play.
        stiffness: k of (4) in N/mⁿ when the inner segment presses up.
        stiffness_below: k when it presses down.
        exponent: n of (4).
    """

    outer: int
    inner: int
    stations: tuple[float, ...]
    clearance: float
    stiffness: float
    stiffness_below: float
    exponent: float


@dataclass(frozen=True, slots=True)
class Boom:
    """Segments from the base to the tip, and the joints between them.

    Raises:
        BoomError: supports or stations outside the segments, an inner box that does not fit
            its outer one, a segment that nothing holds.
    """

    segments: tuple[Segment, ...]
    joints: tuple[Joint, ...]

    def __post_init__(self) -> None:
        if not self.segments:
            raise BoomError("segment", "a boom needs at least one segment")
        for number, segment in enumerate(self.segments, start=1):
            _check_segment(f"segment[{number}]", segment)
        for number, joint in enumerate(self.joints, start=1):
            _check_joint(f"joint[{number}]", joint, self.segments)
        self._check_order()
        self._check_held()

    @property
    def tip(self) -> float:
        """x of the free end of the last segment in m."""
        return self.segments[-1].end

    def stations_of(self, segment: int) -> tuple[float, ...]:
        """x of all places at which a segment may touch another, rising."""
        places = {
            x for joint in self.joints if segment in (joint.outer, joint.inner)
            for x in joint.stations
        }  # fmt: skip
        return tuple(sorted(places))

    def observed(self) -> dict[str, tuple[int, float]]:
        """Places whose deflection every model reports: name → (segment, x).

        ``tip`` is the end of the last segment; ``head`` the end of an outer and ``tail`` the
        start of an inner segment, with the joint's number behind it from the second joint on.
        """
        places = {"tip": (len(self.segments) - 1, self.tip)}
        for number, joint in enumerate(self.joints, start=1):
            suffix = "" if number == 1 else f"-{number}"
            places[f"head{suffix}"] = (joint.outer, self.segments[joint.outer].end)
            places[f"tail{suffix}"] = (joint.inner, self.segments[joint.inner].start)
        return places

    def _check_order(self) -> None:
        for number, (before, after) in enumerate(pairwise(self.segments), start=2):
            if after.start < before.start or after.end < before.end:
                raise BoomError(
                    f"segment[{number}].span",
                    f"must start and end beyond {before.name!r}; give the segments from the base "
                    "to the tip",
                )
        for number, joint in enumerate(self.joints, start=1):
            if joint.outer > joint.inner:
                inner, outer = self.segments[joint.inner], self.segments[joint.outer]
                raise BoomError(
                    f"joint[{number}]",
                    f"{inner.name!r} is nearer to the base than {outer.name!r}; exchange inner and "
                    "outer",
                )

    def _check_held(self) -> None:
        held = {i for i, segment in enumerate(self.segments) if len(segment.supports) >= 2}
        for _ in self.joints:
            for joint in self.joints:
                if len(joint.stations) >= 2 and held & {joint.outer, joint.inner}:
                    held |= {joint.outer, joint.inner}
        for i, segment in enumerate(self.segments):
            if i not in held:
                raise BoomError(
                    f"segment[{i + 1}]",
                    f"nothing holds {segment.name!r}: give it two supports, or a joint with two "
                    "stations to a segment that is held",
                )


def _check_segment(where: str, segment: Segment) -> None:
    if not segment.start < segment.end:
        raise BoomError(
            f"{where}.span",
            f"must run from a smaller to a larger x, got [{segment.start:g}, {segment.end:g}] m",
        )
    for x in segment.supports:
        if not segment.holds(x):
            raise BoomError(
                f"{where}.supports",
                f"{x:g} m lies outside the segment; it must be between {segment.start:g} and "
                f"{segment.end:g} m",
            )
    places = sorted(segment.supports)
    if any(right - left <= SAME_PLACE for left, right in pairwise(places)):
        raise BoomError(f"{where}.supports", "a place is given twice; give each once")


def _check_joint(where: str, joint: Joint, segments: tuple[Segment, ...]) -> None:
    outer, inner = segments[joint.outer], segments[joint.inner]
    start, end = max(outer.start, inner.start), min(outer.end, inner.end)
    if not start < end:
        raise BoomError(
            where,
            f"{outer.name!r} ends at {outer.end:g} m before {inner.name!r} starts at "
            f"{inner.start:g} m; the segments of a joint must overlap",
        )
    for x in joint.stations:
        if not (outer.holds(x) and inner.holds(x)):
            raise BoomError(
                f"{where}.stations",
                f"{x:g} m lies outside the overlap of {outer.name!r} and {inner.name!r}; it must "
                f"be between {start:g} and {end:g} m",
            )
    if any(right - left <= SAME_PLACE for left, right in pairwise(joint.stations)):
        raise BoomError(f"{where}.stations", "must rise from the base to the tip, each given once")
    if outer.section is None or inner.section is None:
        return
    height = outer.section.clear_height_around(inner.section)
    width = outer.section.clear_width_around(inner.section)
    if height < 2.0 * joint.clearance - SAME_PLACE or width < 0.0:
        raise BoomError(
            f"{where}.play",
            f"{inner.name!r} does not fit in {outer.name!r}: {height:.6g} m of height and "
            f"{width:.6g} m of width are free, and a play of {2.0 * joint.clearance:.6g} m is "
            "asked for; make the inner section or the play smaller",
        )
