# SPDX-License-Identifier: LGPL-3.0-or-later
"""Clearances between sections, also on the way of a drive, and positions and shares of pads."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from protractile.dynamics.motion_laws import SCurve
from protractile.geometry.boom import (
    Boom,
    BoomError,
    Joint,
    Material,
    Pad,
    Segment,
    SlidePad,
    Support,
)
from protractile.geometry.box import BoxSection
from protractile.geometry.contact_places import ContactInterval, pads
from protractile.geometry.fit import room
from protractile.geometry.joint import Drive, PadSide
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.profiles import octagon
from protractile.geometry.section import Section
from protractile.geometry.walls import free_room
from tests.geometry.test_section import HEXAGON, offset_corners

CLAMP = (Support(0.0, "clamped"),)


def _smaller(section: Section, clear: float) -> PolygonSection:
    """Return the section with plates inside the given ones by a gap of ``clear`` in m."""
    walls = np.array([plate.thickness for plate in section.plates])
    corners = offset_corners(section, -walls - clear)
    return PolygonSection(tuple((y, z) for y, z in corners.tolist()), tuple(walls))


def test_room_within_sections() -> None:
    """Reference: analytic. In a hexagon with a uniform gap g, the flat plates leave 2 g along z,
    less than the 2 g/n_z of inclined plates. Along y inclined plates leave 2 g/n_y. If the section
    is at one end of its play along z, this decreases by n_z times half the play. The corners of a
    box in an octagon touch the chamfers first.
    """
    outer, inner = BoxSection(0.6, 0.4, 0.02, 0.02), BoxSection(0.5, 0.33, 0.02, 0.01)
    for play in (0.0, 0.05):
        assert free_room(outer, inner, play) == pytest.approx((0.06, 0.04), rel=1e-12)
    gap, within = 0.01, _smaller(HEXAGON, 0.01)
    n_y, n_z = HEXAGON.plates[1].tangent[1], -HEXAGON.plates[1].tangent[0]
    assert free_room(HEXAGON, within) == pytest.approx((2.0 * gap, 2.0 * gap / n_y), rel=1e-9)
    _, pressed = free_room(HEXAGON, within, 0.5 * gap)
    assert pressed == pytest.approx(2.0 * (gap - 0.25 * gap * abs(n_z)) / n_y, rel=1e-9)
    around, box = octagon(0.5, 0.4, 0.1, 0.01, 0.01, 0.01), BoxSection(0.28, 0.28, 0.01, 0.01)
    # Chamfers are at |y| + |z| = 0.35 − 0.01/√2 within, the box's corner at (0.145, 0.145).
    left = 0.35 - 0.01 / np.sqrt(2.0) - 2.0 * 0.145
    assert free_room(around, box)[0] == pytest.approx(2.0 * left, rel=1e-9)
    assert free_room(around, replace(box, height=0.4))[0] < 0.0


def drawn(
    steel: Material, start: float, end: float, travel: float, least: float = 0.0, **joint: Any
) -> Boom:
    """Return a base of 6.5 m, and a fly from start to end in m, touching at the overlap's ends."""
    base = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
    fly = BoxSection(height=0.34, width=0.24, flange=0.006, web=0.005)
    segments = (
        Segment.of_section("base", 0.0, 6.5, steel, base, supports=CLAMP),
        Segment.of_section("fly", start, end, steel, fly),
    )
    drive = Drive(SCurve(travel, 2.0), ("inner", "outer"), least)
    joint = {"play": 3.0e-3, "stations": (start, 6.5), **joint}
    return Boom(segments, (Joint(0, 1, drive=drive, **joint),))


def test_travel_may_reach_the_least_overlap(steel: Material) -> None:
    """Overlaps of 0.5 m and 0.3 m of the fly remain; both are smaller by round-off."""
    assert drawn(steel, 6.5 + 4.8 - 6.0, 11.3, 0.7, 0.5).telescopes
    assert drawn(steel, 0.5, 6.8, -0.3).telescopes


def test_tapered_segments_fit_all_of_the_way(steel: Material) -> None:
    """Reference: by hand. Sections taper from 0.40 to 0.36 m and from 0.34 to 0.30 m. Initially 26
    mm are free between the walls, at 9 m 16 mm less.
    """
    tail, head, *inner = (
        BoxSection(height, width, flange, web=0.006)
        for height, width, flange in (
            (0.40, 0.30, 0.008), (0.36, 0.30, 0.008), (0.34, 0.24, 0.006), (0.30, 0.24, 0.006),
        )
    )  # fmt: skip
    base = Segment.of_section("base", 0.0, 10.0, steel, tail, supports=CLAMP, head_section=head)
    fly = Segment.of_section("fly", 5.0, 15.0, steel, inner[0], head_section=inner[1])
    joint = Joint(0, 1, (5.0, 10.0), play=0.014)
    assert room(joint, base, fly)[0] == pytest.approx(0.026)
    assert room(joint, base, fly, 4.0)[0] == pytest.approx(0.010)
    for travel, play in ((3.0, 0.014), (4.0, 0.010)):
        drive = Drive(SCurve(travel, 2.0), ("inner", "outer"))
        assert Boom((base, fly), (replace(joint, play=play, drive=drive),)).telescopes
    with pytest.raises(BoomError) as caught:
        Boom((base, fly), (replace(joint, drive=drive),))
    assert str(caught.value) == (
        "joints[0].drive: moves 'fly' by 4 m to where it does not fit in 'base': 0.01 m of height "
        "and 0.048 m of width are free there, and a play of 0.014 m is asked for; make the travel "
        "or the taper smaller"
    )


LEFT = "must not be above the overlap of 0.1 m that is left where 'fly' extends by 1.1 m, got "
PADS = tuple(
    SlidePad(length, 0.05, side=side, thickness=0.02)
    for side, length in (("above", 0.08), ("below", 0.11))
)


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ({"pad": Pad(0.12, 0.05)}, f"pad.length: {LEFT}0.12 m"),
        ({"contact_length": 0.15}, f"contact_length: {LEFT}0.15 m"),
        ({"pads": PADS}, f"pads[1].length: {LEFT}0.11 m"),
        ({"pad": Pad(0.08, 0.05), "stations": (5.38, 6.5)}, "pad.length: the pad at 5.38 m leaves "
         "'base' as 'fly' telescopes by 1.1 m; make it shorter, or move the station"),
    ],
)  # fmt: skip
def test_pads_stay_on_both_segments(steel: Material, joint: dict[str, Any], message: str) -> None:
    """The initial overlap is 1.2 m. A pad at 5.38 m ends at 5.42 m, or 0.02 m beyond the base."""
    place = 6.5 + 4.8 - 6.0
    assert drawn(steel, place, 11.3, 1.0, **joint).telescopes
    with pytest.raises(BoomError) as caught:
        drawn(steel, place, 11.3, 1.1, **joint)
    assert str(caught.value) == f"joints[0].{message}"


def test_pads_lie_side_by_side_on_walls_of_their_width(steel: Material) -> None:
    """Reference: by hand. Half a wall of 0.5 m has room for 0.15 m, half a wall of 0.2 m does not.
    A pad reaches 40 mm from the corner inwards, and another from 30 mm on.
    """
    base = BoxSection(height=0.56, width=0.26, flange=0.008, web=0.006)
    fly = BoxSection(height=0.50, width=0.20, flange=0.006, web=0.005)
    segments = (
        Segment.of_section("base", 0.0, 6.0, steel, base, supports=CLAMP),
        Segment.of_section("fly", 5.0, 11.0, steel, fly),
    )

    def padded(widths: Mapping[PadSide, float], *more: SlidePad) -> Boom:
        each = [SlidePad(0.1, w, side=side, thickness=0.02) for side, w in widths.items()]
        joint = Joint(0, 1, (5.0, 6.0), play=0.01, lateral_play=0.01, pads=(*each, *more))
        return Boom(segments, (joint,))

    widths: dict[PadSide, float] = {"above": 0.05, "below": 0.05, "left": 0.15, "right": 0.15}
    second = SlidePad(0.1, 0.03, side="above", thickness=0.02, offset=0.06)
    assert padded(widths, second).joints[0].padded
    with pytest.raises(BoomError, match=r"^joints\[0\].pads: two lie on one another above, 0.03 m"):
        padded(widths, replace(second, offset=0.03))
    with pytest.raises(BoomError, match=r"^joints\[0\].pads\[1\].width: must be above 0 and not a"):
        padded({**widths, "below": 0.15})


def test_pads_in_space_are_in_the_corners(spatial_boom: Boom) -> None:
    """Reference: analytic, by hand: 4 flange pads at each station, then 4 web pads at each. The
    pads of a side have the whole law, all pads the whole N.
    """
    (joint,) = spatial_boom.joints
    rubbing = replace(joint, friction=0.2, normal_forces=(4500.0, 5000.0))
    boom = replace(spatial_boom, joints=(rubbing,))
    outer, inner = (segment.section for segment in boom.segments)
    found = pads(boom)
    assert [pad.station.name for pad in found[::4]] == ["9", "10", "9y", "10y"]
    across = [(pad.station.direction, pad.sliding_direction) for pad in found[::4]]
    assert across == 2 * [("z", "y")] + 2 * [("y", "z")]
    b, h = 0.5 * inner.width, 0.5 * inner.height
    top, side = 0.5 * (outer.height - outer.flange), 0.5 * (outer.width - outer.web)
    assert [(pad.side, pad.inner, pad.outer) for pad in (*found[:4], *found[8:12])] == [
        *((s, (y, s * (top - 7.0e-3)), (y, s * top)) for s in (1, -1) for y in (-b, b)),
        *((s, (s * (side - 5.0e-3), z), (s * side, z)) for s in (1, -1) for z in (-h, h)),
    ]
    # The boxes of this boom leave the vertical clearance by themselves.
    assert top - 7.0e-3 == pytest.approx(0.5 * (inner.height + inner.flange), rel=1e-12)
    for station, force in enumerate((4500.0, 5000.0, 4500.0, 5000.0)):
        here = [pad for pad in found if pad.station.index == station]
        for one in (1, -1):
            assert sum(pad.weight for pad in here if pad.side == one) == 1.0
        assert sum(pad.normal_force or 0.0 for pad in here) == force
    # 30 mm and half of 60 mm, towards the middle of each wall.
    padded = replace(joint, pad=Pad(length=0.1, width=0.06, offset=0.03))
    found = pads(replace(spatial_boom, joints=(padded,)))
    assert {pad.half for pad in found} == {-1, 1}
    for pad in found:
        assert pad.across == pytest.approx(-0.06 * pad.half, rel=0.1)


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
