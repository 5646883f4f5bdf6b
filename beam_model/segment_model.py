# SPDX-License-Identifier: LGPL-3.0-or-later
"""Gap systems of beams: series, finite elements and rigid segments, planar or three-dimensional."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from protractile.beam_model.boom_modes import BoomModes, travel
from protractile.beam_model.component import Motion, SegmentModel
from protractile.dynamics.gap_builder import GapBuilder, OutputOperator
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import pads
from protractile.geometry.ground import ground_lines, pin_moments
from protractile.geometry.observation import Displacement, Observation, Quantity
from protractile.geometry.section import Side
from protractile.geometry.telescoping import drives_below, telescoping_stations

# Sides of the contact rows of a flat joint or a stop, with one row for both sides.
BOTH_SIDES: Sequence[Side] = (0,)


def gap_system(
    boom: Boom,
    models: Sequence[SegmentModel],
    sides: Sequence[Side] = BOTH_SIDES,
) -> GapSystem:
    """Return the gap system of a boom of beams.

    Forces act at the centres of pads. ``sides`` is ``BOTH_SIDES`` for one contact row for both
    sides of a joint or stop, ``EACH_SIDE`` for one row for each side.
    """
    modes = BoomModes(boom, models)
    system = system_without_drives(boom, modes, sides)
    rows_at = partial(contact_rows, boom, modes, sides)
    groups = telescoping_stations(boom)
    moved = [travel(boom, models, rows_at, modes.beams, group) for group in groups]
    return replace(system, travels=moved)


def system_without_drives(
    boom: Boom, modes: BoomModes, sides: Sequence[Side] = BOTH_SIDES
) -> GapSystem:
    """Return the gap system at the initial extension, without drives.

    Args:
        boom, sides: as in :func:`gap_system`.
        modes: modes of the boom's segments.
    """
    return system_of_rows(contact_rows(boom, modes, sides, {}), boom, modes, modes.load)


def system_of_rows(
    rows: GapBuilder[Array], boom: Boom, modes: BoomModes, uniform: Array
) -> GapSystem:
    """Return the gap system of :func:`system_without_drives` from its rows.

    ``uniform`` (num_modes,) in N/√kg are the uniform loads of the segments.
    """
    beams = modes.beams
    ends: tuple[Quantity, ...] = ("deflection", "lateral") if boom.spatial else ("deflection",)
    return rows.system(
        lambda row: row,
        modes.omega2,
        sum((push for _, push in pin_moments(boom, beams)), uniform),
        [(station.x, station.direction) for station in boom.stations],
        {
            place.name: OutputOperator(_row(place, modes), place.kind.unit, place.kind.derivative)
            for place in boom.all_observations(ends)
        },
        [(load.push(beams[load.segment]), load.history) for load in boom.loads],
        [
            (line.force, line.push, line.stiffness, line.dashpot)
            for line in ground_lines(boom, beams)
        ],
        modes.damping,
    )


def contact_rows(
    boom: Boom,
    modes: BoomModes,
    sides: Sequence[Side],
    extensions: Mapping[int, float],
) -> GapBuilder[Array]:
    """Return the rows of contacts, friction and dashpots for the modes of a beam.

    Args:
        extensions: extension in m of each joint that telescopes.
    """
    rows: GapBuilder[Array] = GapBuilder()
    for pad in pads(boom):
        on_outer, on_inner = pad.travels(extensions.get(pad.station.number, 0.0))
        station, joint = pad.station, pad.joint
        slide_x = pad.midpoint if joint.lateral_play is None else station.x
        # u − w of both points of the pad.
        approach, slide = (
            modes.displacement(joint.inner, x + on_inner, direction, inner)
            - modes.displacement(joint.outer, x + on_outer, direction, outer)
            for direction, x, (inner, outer) in (
                (station.direction, pad.midpoint, pad.area_centres),
                (pad.sliding_direction, slide_x, (pad.inner, pad.outer)),
            )
        )
        pressing_sides = (pad.side,) if pad.side else sides
        points = [(side, pad.weight, approach) for side in pressing_sides]
        pressing = rows.add_contact(station.index, station.law, points, pad.shim)
        rows.add_dashpot(station.index, joint.dashpot, points)
        rows.add_friction(station.index, joint.friction, slide, pad.normal_force, pressing)
    for station in (station for station in boom.stations if station.stop is not None):
        drives = drives_below(boom.joints, station.segment)
        moved = sum(extensions.get(number, 0.0) for number in drives)
        row = modes.displacement(station.segment, station.x - moved, "z")
        rows.add_stop(station.index, station.law, [(side, 1.0, row) for side in sides])
    return rows


# Motion of each displacement, and order of its row.
_ROWS: Mapping[Displacement, tuple[Motion, int]] = {
    "deflection": ("z", 0), "rotation": ("z", 1), "lateral": ("y", 0), "twist": ("twist", 0),
}  # fmt: skip


def _row(place: Observation, modes: BoomModes) -> Array:
    """Return the row (num_modes,) of the displacement of an observation."""
    if place.kind.displacement not in _ROWS:
        raise ValueError("the cross-section of a beam keeps its shape")
    motion, order = _ROWS[place.kind.displacement]
    return modes.beams[place.segment].at(motion, place.x, order)
