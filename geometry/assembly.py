# SPDX-License-Identifier: LGPL-3.0-or-later
"""The parts of a boom before its checks, which read them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

from protractile.geometry.axial import AxialChange, Lead
from protractile.geometry.cylinder import Cylinder
from protractile.geometry.joint import Joint, Stop
from protractile.geometry.load import Load
from protractile.geometry.observation import Observation, Quantity
from protractile.geometry.section import Direction
from protractile.geometry.segment import Segment
from protractile.geometry.station import Station, stations


@dataclass(frozen=True)
class Assembly:
    """Segments from the base to the tip, with joints, loads and cylinders, before any check."""

    segments: Sequence[Segment]
    joints: Sequence[Joint] = ()
    loads: Sequence[Load] = ()
    stops: Sequence[Stop] = ()
    observations: Sequence[Observation] = ()
    cylinders: Sequence[Cylinder] = ()
    axial_changes: Sequence[AxialChange] = ()
    leads: Sequence[Lead] = ()

    @property
    def tip(self) -> float:
        """The x in m of the free end of the last segment."""
        return self.segments[-1].end

    @property
    def length(self) -> float:
        """The length in m from the start of the first segment to the tip."""
        return self.tip - self.segments[0].start

    @property
    def spatial(self) -> bool:
        """True if the segments also move along y and twist."""
        return any(joint.lateral_play is not None for joint in self.joints)

    @property
    def directions(self) -> tuple[Direction, ...]:
        """The directions in which the segments can touch."""
        return ("z", "y") if self.spatial else ("z",)

    @cached_property
    def stations(self) -> tuple[Station, ...]:
        """All contact stations, without bonded joints.

        The order is: joints along z, in three-dimensional booms joints along y, stops.
        """
        return stations(self.joints, self.stops, self.directions)

    def overlap(self, joint: Joint) -> tuple[float, float]:
        """Return both ends in m of the overlap of a joint's segments."""
        outer, inner = self.segments[joint.outer], self.segments[joint.inner]
        return max(outer.start, inner.start), min(outer.end, inner.end)

    @property
    def observed(self) -> dict[str, tuple[int, float]]:
        """The (segment, x in m) of the points with a deflection in all results, by name.

        ``tip`` is the end of the last segment, ``head`` the end of a joint's outer segment,
        ``tail`` the start of its inner segment. A suffix such as ``-2`` numbers further joints.
        """
        places = {"tip": (len(self.segments) - 1, self.tip)}
        for number, joint in enumerate(self.joints, start=1):
            suffix = "" if number == 1 else f"-{number}"
            places[f"head{suffix}"] = (joint.outer, self.segments[joint.outer].end)
            places[f"tail{suffix}"] = (joint.inner, self.segments[joint.inner].start)
        return places

    def end_observations(self, quantities: Iterable[Quantity]) -> list[Observation]:
        """Return an observation of each quantity at each place of :attr:`observed`."""
        return [
            Observation(f"{name}_{what}".removesuffix("_deflection"), segment, x, what)
            for name, (segment, x) in self.observed.items()
            for what in quantities
        ]
