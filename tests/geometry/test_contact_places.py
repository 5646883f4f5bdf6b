# SPDX-License-Identifier: LGPL-3.0-or-later
"""Positions of pads: on the axis in flat booms, in the corners of boxes in space."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.geometry.boom import Boom, Pad, Stop
from protractile.geometry.contact_places import ContactInterval, ContactPair, Patch, pads


def test_a_flat_boom_touches_on_its_axis(paper_boom: Boom) -> None:
    (joint,) = paper_boom.joints
    joint = replace(joint, friction=0.2, normal_forces=(4500.0, 5000.0))
    boom = replace(paper_boom, joints=(joint,))
    axis = (0.0, 0.0)
    outer, inner = paper_boom.segments
    # A tenth of the overlap from 9 to 10 m.
    tail, head = (
        (ContactInterval.from_station(inner, x, 0.1), ContactInterval.from_station(outer, x, 0.1))
        for x in joint.stations
    )
    assert pads(boom) == [
        ContactPair(boom.stations[0], joint, 0, axis, axis, 1.0, "z", 4500.0, tail, None),
        ContactPair(boom.stations[1], joint, 0, axis, axis, 1.0, "z", 5000.0, head, None),
    ]


def test_a_pad_keeps_its_distance_from_the_corner(paper_boom: Boom) -> None:
    """Reference: by hand, 30 mm inwards from half the width, then 60 mm wide."""
    (joint,) = paper_boom.joints
    padded = replace(joint, pad=Pad(length=0.1, width=0.06, offset=0.03))
    tail, _ = pads(replace(paper_boom, joints=(padded,)))
    assert tail.patch == Patch(9.0, 9.1, 0.03, 0.06)


def test_the_centre_of_a_pad_lies_inwards_of_its_corner(spatial_boom: Boom) -> None:
    """Reference: by hand, 30 mm and half of 60 mm, towards the middle of each wall."""
    (joint,) = spatial_boom.joints
    padded = replace(joint, pad=Pad(length=0.1, width=0.06, offset=0.03))
    found = pads(replace(spatial_boom, joints=(padded,)))
    assert {pad.half for pad in found} == {-1, 1}
    for pad in found:
        assert pad.across == pytest.approx(-0.06 * pad.half, rel=0.1)


def test_pads_in_space_are_in_the_corners(spatial_boom: Boom) -> None:
    """Reference: analytic, by hand: 4 flange pads at each station, then 4 web pads at each."""
    outer, inner = (segment.section for segment in spatial_boom.segments)
    found = pads(spatial_boom)
    assert [pad.station for pad in found[::4]] == [*spatial_boom.stations]
    assert [pad.station.name for pad in found[::4]] == ["9", "10", "9y", "10y"]
    assert [(pad.station.direction, pad.sliding_direction) for pad in found[::4]] == 2 * [
        ("z", "y")
    ] + 2 * [("y", "z")]
    b, h = 0.5 * inner.width, 0.5 * inner.height
    top, side = 0.5 * (outer.height - outer.flange), 0.5 * (outer.width - outer.web)
    flange = [(pad.side, pad.inner, pad.outer) for pad in found[:4]]
    assert flange == [
        (1, (-b, top - 7.0e-3), (-b, top)),
        (1, (b, top - 7.0e-3), (b, top)),
        (-1, (-b, 7.0e-3 - top), (-b, -top)),
        (-1, (b, 7.0e-3 - top), (b, -top)),
    ]
    web = [(pad.side, pad.inner, pad.outer) for pad in found[8:12]]
    assert web == [
        (1, (side - 5.0e-3, -h), (side, -h)),
        (1, (side - 5.0e-3, h), (side, h)),
        (-1, (5.0e-3 - side, -h), (-side, -h)),
        (-1, (5.0e-3 - side, h), (-side, h)),
    ]
    # The boxes of this boom leave the vertical clearance by themselves.
    assert top - 7.0e-3 == pytest.approx(0.5 * (inner.height + inner.flange), rel=1e-12)


def test_stations_are_those_of_the_boom(spatial_boom: Boom) -> None:
    """The boom has three segments and a stop, and one bonded joint or none."""
    (joint,) = spatial_boom.joints
    inner = spatial_boom.segments[1]
    box = replace(inner.section, height=0.4, width=0.2)
    last = replace(inner, name="last", start=17.0, end=26.0, section=box)
    for bonded in (False, True):
        boom = Boom(
            (*spatial_boom.segments, last),
            (
                replace(joint, bonded=bonded),
                replace(joint, outer=1, inner=2, stations=(17.0, 18.0, 19.0)),
            ),
            stops=(Stop(2, 26.0, 0.02, PowerContact(1.0e8, 1.0, stiffness_below=1.0e8)),),
        )
        found = pads(boom)
        assert len(boom.stations) == (7 if bonded else 11)
        assert len(found) == 4 * (len(boom.stations) - 1)
        for pad in found:
            assert pad.station is boom.stations[pad.station.index]
            assert pad.joint is pad.station.joint is boom.joints[pad.station.number]
            assert pad.station.x == pad.joint.stations[pad.station.place]


def test_shares_of_a_station_sum_to_one(spatial_boom: Boom) -> None:
    """Reference: analytic. The pads of a side have the whole law, all pads the whole N."""
    (joint,) = spatial_boom.joints
    joint = replace(joint, friction=0.2, normal_forces=(4500.0, 5000.0))
    found = pads(replace(spatial_boom, joints=(joint,)))
    assert len(found) == 16
    for station, force in enumerate((4500.0, 5000.0, 4500.0, 5000.0)):
        here = [pad for pad in found if pad.station.index == station]
        for side in (1, -1):
            assert sum(pad.weight for pad in here if pad.side == side) == 1.0
        assert sum(pad.normal_force or 0.0 for pad in here) == force


@pytest.mark.parametrize(
    ("station", "start", "ends"),
    [(4.0, 3.95, (10.0, 10.0)), (10.0, 9.9, (-20.0, 40.0)), (0.02, 0.0, (28.0, -8.0))],
)
def test_a_station_presses_corners_evenly_or_about_itself(
    paper_boom: Boom, station: float, start: float, ends: tuple[float, float]
) -> None:
    """Reference: analytic. A unit force on 0.1 m of the outer segment, [0, 10] m, has its resultant
    at the station. It is uniform inside the segment, and linear from 4/c to −2/c at an end.
    """
    stretch = ContactInterval.from_station(paper_boom.segments[0], station, 0.1)
    assert (stretch.start, stretch.end) == pytest.approx((start, start + 0.1))
    assert stretch.line_load(np.array([start, start + 0.1])) == pytest.approx(ends)
    x, weights = np.polynomial.legendre.leggauss(2)
    x = start + 0.05 + 0.05 * x
    forces = 0.05 * weights * stretch.line_load(x)
    assert [forces.sum(), forces @ x] == pytest.approx([1.0, station])
