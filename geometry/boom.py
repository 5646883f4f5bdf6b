# SPDX-License-Identifier: LGPL-3.0-or-later
"""The boom: telescopic segments with joints, loads and stops.

x runs along the boom, z is in the plane of bending, y is lateral. All units are SI units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from protractile.geometry.assembly import Assembly
from protractile.geometry.axial import AxialChange, Lead, moving_force_places
from protractile.geometry.boom_checks import check_boom
from protractile.geometry.cylinder import Cylinder
from protractile.geometry.fields import BoomError, check_kind, format_value
from protractile.geometry.joint import Joint, Pad, SlidePad, Stop
from protractile.geometry.load import Load
from protractile.geometry.material import Material
from protractile.geometry.observation import Observation, Quantity
from protractile.geometry.place import resolve_segments
from protractile.geometry.section import Direction
from protractile.geometry.segment import SAME_PLACE, Lateral, PointMass, Segment
from protractile.geometry.station import Station
from protractile.geometry.stiffeners import Collar, Diaphragm
from protractile.geometry.support import Support
from protractile.geometry.telescoping import drives_of, reach, station_positions

__all__ = [
    "SAME_PLACE",
    "Boom",
    "BoomError",
    "Collar",
    "Cylinder",
    "Diaphragm",
    "Direction",
    "Joint",
    "Lateral",
    "Load",
    "Material",
    "Observation",
    "Pad",
    "PointMass",
    "Segment",
    "SlidePad",
    "Stop",
    "Support",
]


# Class of the parts of each attribute of a boom.
_KINDS: Mapping[str, type] = {
    "segments": Segment,
    "joints": Joint,
    "loads": Load,
    "stops": Stop,
    "observations": Observation,
    "cylinders": Cylinder,
    "axial_changes": AxialChange,
    "leads": Lead,
}


@dataclass(frozen=True)
class Boom(Assembly):
    """Segments from the base to the tip, with joints, loads and cylinders.

    Example: a clamped arm, and a fly with an overlap of 2 m in it.

    >>> steel = pt.Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
    >>> boxes = (
    ...     pt.BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006),
    ...     pt.BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005),
    ... )
    >>> wall = pt.Support(0.0, "clamped")
    >>> arm = pt.Segment.of_section("arm", 0.0, 8.0, steel, boxes[0], supports=(wall,))
    >>> fly = pt.Segment.of_section("fly", 6.0, 14.0, steel, boxes[1], load=-500.0)
    >>> law = pt.PowerContact(1e9, exponent=1.0)
    >>> joint = pt.Joint("arm", "fly", stations=(6.0, 8.0), play=0.01, contact=law)
    >>> boom = pt.Boom([arm, fly], [joint])
    >>> boom.tip, [station.x for station in boom.stations]
    (14.0, [6.0, 8.0])
    >>> pt.BeamElements(boom).system().num_modes
    66

    Joints, loads, stops, cylinders and observations refer to their segments by name or index.

    Raises:
        BoomError: a segment name is unknown; a support, station, load or stop is outside its
            segment; an inner section does not fit in the outer one; a section is not symmetric; a
            segment can move as a rigid body; friction lacks a normal force; a 3D boom lacks
            lateral properties; or an observed quantity does not exist in 2D.
    """

    def __post_init__(self) -> None:
        for group, kind in _KINDS.items():
            parts = getattr(self, group)
            if not isinstance(parts, list | tuple):
                what = f"must be a list or a tuple, got {format_value(parts)}"
                raise BoomError(group, what)
            for number, part in enumerate(parts):
                check_kind(f"{group}[{number}]", part, kind)
        if not self.segments:
            raise BoomError("segments", "a boom needs at least one segment")
        object.__setattr__(self, "segments", tuple(self.segments))
        for group in [*_KINDS][1:]:
            parts = tuple(
                resolve_segments(part, f"{group}[{number}]", self.segments)
                for number, part in enumerate(getattr(self, group))
            )
            object.__setattr__(self, group, parts)
        check_boom(self)

    @property
    def mass(self) -> float:
        """The mass in kg, with point masses, collars and diaphragms."""
        return sum(segment.mass for segment in self.segments)

    @cached_property
    def bonded(self) -> Boom:
        """The boom with all joints bonded."""
        bonded = (
            replace(
                joint, bonded=True, pad=None, pads=(), contact_length=None, dashpot=0.0, drive=None
            )
            for joint in self.joints
        )
        return replace(self, joints=tuple(bonded))

    @property
    def without_drives(self) -> Boom:
        """The boom with all joints at their initial extension."""
        if not self.telescopes:
            return self
        return replace(self, joints=tuple(replace(joint, drive=None) for joint in self.joints))

    @property
    def telescopes(self) -> bool:
        """True if a joint telescopes during the motion."""
        return any(joint.drive is not None for joint in self.joints)

    @property
    def yielding(self) -> str:
        """What gives way at contacts with play, in words; empty if nothing does.

        Sections with inclined plates distort. The walls of boxes bend under pads; pads on corners
        and points bend none.
        """
        loose = [joint for joint in self.joints if not joint.bonded]
        sections = [
            self.segments[number].section
            for joint in loose
            for number in (joint.outer, joint.inner)
        ]
        if any(
            section is not None and len(section.faces) < len(section.plates) for section in sections
        ):
            return "sections under pads" if any(j.padded for j in loose) else "sections at stations"
        on_walls = any(
            pad is not None and pad.bears == "wall"
            for joint in loose
            if self.segments[joint.inner].section is not None
            for pad in (*joint.pads, joint.pad)
        )
        return "walls under pads" if on_walls else ""

    @property
    def compressed(self) -> bool:
        """True if a segment carries an axial force."""
        return any(segment.compression for segment in self.segments) or bool(self.axial_changes)

    def joint_stations(self, number: int, direction: Direction) -> list[Station]:
        """Return the stations of a joint in a direction; none if the joint is bonded."""
        return [
            station
            for station in self.stations
            if station.joint is not None
            and (station.number, station.direction) == (number, direction)
        ]

    def moving_intervals(self, segment: int) -> tuple[float, ...]:
        """Return the ascending ends in m of the intervals where stations and axial forces move."""
        places = {
            place[joint.inner == segment]
            for joint in self.joints
            if joint.drive is not None and segment in (joint.outer, joint.inner)
            for extension in (0.0, *joint.drive.reach)
            for place in station_positions(joint, extension)
        }
        if drives := drives_of(self.joints, segment):
            stop_places = [stop.x for stop in self.stops if stop.segment == segment]
            places |= {x - extension for x in stop_places for extension in reach(drives)}
        return tuple(sorted(places | moving_force_places(self.segments, self.joints, segment)))

    def stations_of(self, segment: int) -> tuple[float, ...]:
        """Return ascending x in m of the stations, stops, lugs, loads and masses of a segment."""
        joints = (joint for joint in self.joints if segment in (joint.outer, joint.inner))
        places = {x for joint in joints for x in joint.stations}
        places |= {stop.x for stop in self.stops if stop.segment == segment}
        places |= {lug.x for lug in self.cylinders if lug.segment == segment}
        places |= {
            x for load in self.loads if load.segment == segment for x in load.places.values()
        }
        places |= {mass.x for mass in self.segments[segment].masses}
        return tuple(sorted(places))

    def observed_places(self, segment: int) -> tuple[float, ...]:
        """Return ascending x in m of the requested outputs of a segment."""
        return tuple(
            sorted(
                {
                    observation.x
                    for observation in self.observations
                    if observation.segment == segment
                }
            )
        )

    def smallest_overlap(self, joint: Joint) -> float:
        """Return the overlap in m of a joint at the largest extension of its drive, if any."""
        start, end = self.overlap(joint)
        return end - start - (0.0 if joint.drive is None else joint.drive.reach[1])

    def all_observations(self, of_ends: Sequence[Quantity]) -> list[Observation]:
        """Return the observations of the quantities ``of_ends`` at ends, then those of the case.

        Examples of names at ends: ``tip`` for a deflection, ``tip_rotation`` for a rotation.
        """
        return [*self.end_observations(of_ends), *self.observations]
