# SPDX-License-Identifier: LGPL-3.0-or-later
"""Gap systems of segments as beams.

Kantorovich series and beam finite elements share this code. So do the flat boom and the one in
space, which has more components and more pads.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from beam_model.boom_modes import BoomModes
from beam_model.component import SegmentModel
from beam_model.telescoping import travels
from dynamics.gap_builder import GapBuilder, Observed
from dynamics.gap_system import GapSystem
from geometry.arrays import Array
from geometry.axial import pin_moments
from geometry.boom import Boom
from geometry.contact_places import Pad, pads
from geometry.cylinder import ground_lines
from geometry.observation import Observation, Quantity
from geometry.section import Offset
from geometry.telescoping import drives_below


class ContactGeometry(NamedTuple):
    """Contact geometry of beams.

    Args:
        sides: of a pad or stop that presses both ways, see ``GapBuilder.add_contact``.
        x: m of a pad's approach, and of its slide.
        offsets: (y, z) in m of a pad's inner and outer point.
    """

    sides: Sequence[int]
    x: Callable[[Pad], tuple[float, float]]
    offsets: Callable[[Pad], tuple[Offset, Offset]]


# At the stations, by the whole law on the axis.
AT_STATIONS = ContactGeometry((0,), lambda pad: (pad.x, pad.x), lambda pad: (pad.inner, pad.outer))
# At the pads of a shell, each side separately, like a shell's walls.
AT_PADS = ContactGeometry((1, -1), lambda pad: (pad.middle, pad.slide_x), lambda pad: pad.covered)


def gap_system(
    boom: Boom,
    models: Sequence[SegmentModel],
    contact: ContactGeometry = AT_STATIONS,
) -> GapSystem:
    """Return segments in modal coordinates, coupled by contact, friction and ties alone.

    ``contact`` gives the places where pads are read.
    """
    modes = BoomModes(boom, models)
    system = undriven_system(boom, modes, contact)
    rows_at = partial(_rows, boom, modes, contact)
    members = [modes.member(number) for number in range(len(boom.segments))]
    return replace(system, travels=travels(boom, models, rows_at, members))


def undriven_system(
    boom: Boom, modes: BoomModes, contact: ContactGeometry = AT_STATIONS
) -> GapSystem:
    """Return the gap system at the start, without drives.

    Args:
        boom, contact: as of :func:`gap_system`.
        modes: of the boom's segments.
    """
    members = [modes.member(number) for number in range(len(boom.segments))]
    ends: tuple[Quantity, ...] = ("deflection", "lateral") if boom.spatial else ("deflection",)
    return _rows(boom, modes, contact, {}).system(
        lambda row: row,
        modes.omega2,
        sum((push for _, push in pin_moments(boom.segments, boom.joints, members)), modes.load),
        boom.stations,
        {
            place.name: Observed(_row(place, modes), place.kind.unit, place.kind.derivative)
            for place in boom.recorded(ends)
        },
        [(load.push(members[load.segment]), load.history) for load in boom.loads],
        [
            (line.force, line.push, line.stiffness, line.dashpot)
            for line in ground_lines(boom, members)
        ],
        modes.damping,
    )


def _rows(
    boom: Boom,
    modes: BoomModes,
    contact: ContactGeometry,
    extensions: Mapping[int, float],
) -> GapBuilder[Array]:
    """Return contact, friction and dashpot rows at the extensions of joints in m."""
    rows: GapBuilder[Array] = GapBuilder()
    for pad in pads(boom):
        on_outer, on_inner = pad.travels(extensions.get(pad.number, 0.0))
        law = pad.joint.law(pad.direction)
        pressed, slide_x = contact.x(pad)
        joint = pad.joint
        # u − w of the pad's two points.
        approach, slide = (
            modes.displacement(joint.inner, x + on_inner, direction, inner)
            - modes.displacement(joint.outer, x + on_outer, direction, outer)
            for direction, x, (inner, outer) in (
                (pad.direction, pressed, contact.offsets(pad)),
                (pad.rubs, slide_x, (pad.inner, pad.outer)),
            )
        )
        sides = (pad.side,) if pad.side else contact.sides
        points = [(side, pad.weight, approach) for side in sides]
        pressing = rows.add_contact(pad.station, law, points, pad.raised)
        rows.add_dashpot(pad.station, joint.dashpot, points)
        rows.add_friction(pad.station, joint.friction, slide, pad.normal_force, pressing)
    for station, stop in boom.numbered_stops:
        drives = drives_below(boom.joints, stop.segment)
        moved = sum(extensions.get(number, 0.0) for number in drives)
        row = modes.displacement(stop.segment, stop.x - moved, "z")
        rows.add_stop(station, stop.law, [(side, 1.0, row) for side in contact.sides])
    return rows


def _row(place: Observation, modes: BoomModes) -> Array:
    """Return the row (num_modes,) that reads a quantity, or that of which it is the derivative."""
    match place.kind.read:
        case "rotation":
            return modes.rotation(place.segment, place.x, "z")
        case "twist":
            return modes.twist(place.segment, place.x)
        case "lateral":
            return modes.displacement(place.segment, place.x, "y")
        case "distortion":
            raise ValueError("the cross-section of a beam keeps its shape")
        case "deflection":
            return modes.displacement(place.segment, place.x, "z")
