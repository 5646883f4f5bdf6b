# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plates of a section, their clearances and contact faces, and the fit of pads."""

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.geometry.boom import (
    Boom,
    BoomError,
    Joint,
    Material,
    Segment,
    SlidePad,
    Stop,
    Support,
)
from protractile.geometry.box import BoxSection, infer_inner_section
from protractile.geometry.joint import PadSide
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.section import Section
from protractile.geometry.walls import free_room, trapezoids
from tests.geometry.test_polygon import HEXAGON, offset_corners


def test_plates_meet_at_the_corners_of_their_surfaces() -> None:
    """Reference: analytic. Trapezoids of a box have its outer and inner corners."""
    walls = trapezoids(BoxSection(0.6, 0.4, flange=0.04, web=0.01).plates)
    outside = [(-0.205, -0.32), (0.205, -0.32), (0.205, 0.32), (-0.205, 0.32)]
    hole = [(-0.195, -0.28), (0.195, -0.28), (0.195, 0.28), (-0.195, 0.28)]
    assert walls[:, 0] == pytest.approx(np.array(outside), rel=1e-12)
    assert walls[:, 3] == pytest.approx(np.array(hole), rel=1e-12)


def test_room_of_boxes() -> None:
    """Reference: analytic, a box with outer sizes 0.52 x 0.34 m in a hole of 0.58 x 0.38 m."""
    outer, inner = BoxSection(0.6, 0.4, 0.02, 0.02), BoxSection(0.5, 0.33, 0.02, 0.01)
    assert free_room(outer, inner) == pytest.approx((0.06, 0.04), rel=1e-12)
    assert free_room(outer, inner, 0.05) == pytest.approx((0.06, 0.04), rel=1e-12)


def _smaller(section: Section, clear: float) -> PolygonSection:
    """Return the section with plates inside the given ones by a gap of ``clear`` in m."""
    walls = np.array([plate.thickness for plate in section.plates])
    corners = offset_corners(section, -walls - clear)
    return PolygonSection(tuple((y, z) for y, z in corners.tolist()), tuple(walls))


def test_room_between_inclined_plates() -> None:
    """Reference: analytic. In a hexagon with a uniform gap g, the flat plates leave 2 g along z,
    less than the 2 g/n_z of inclined plates. Along y inclined plates leave 2 g/n_y. If the section
    is at one end of its play along z, this decreases by n_z times half the play.
    """
    inner, gap = _smaller(HEXAGON, 0.01), 0.01
    n_y, n_z = HEXAGON.plates[1].tangent[1], -HEXAGON.plates[1].tangent[0]
    height, width = free_room(HEXAGON, inner)
    assert height == pytest.approx(2.0 * gap, rel=1e-9)
    assert width == pytest.approx(2.0 * gap / n_y, rel=1e-9)
    _, pressed = free_room(HEXAGON, inner, 0.5 * gap)
    assert pressed == pytest.approx(2.0 * (gap - 0.25 * gap * abs(n_z)) / n_y, rel=1e-9)


def test_inclined_plates_stand_in_the_way() -> None:
    """Reference: analytic. The corners of a box in an octagon touch the chamfers first."""
    outer = octagon(0.5, 0.4, 0.1, 0.01, 0.01, 0.01)
    box = BoxSection(0.28, 0.28, 0.01, 0.01)
    # Chamfers are at |y| + |z| = 0.35 − 0.01/√2 within, the box's corner at (0.145, 0.145).
    room = 0.35 - 0.01 / np.sqrt(2.0) - 2.0 * 0.145
    assert free_room(outer, box)[0] == pytest.approx(2.0 * room, rel=1e-9)
    assert free_room(outer, replace(box, height=0.4))[0] < 0.0


def _in(boom: Boom, outer: Section, inner: Section) -> Boom:
    first, second = boom.segments
    return replace(boom, segments=(replace(first, section=outer), replace(second, section=inner)))


def test_contact_sections_need_flat_faces(paper_boom: Boom, spatial_boom: Boom) -> None:
    inner = octagon(0.45, 0.25, 0.05, 0.005, 0.005, 0.005)
    outer = octagon(0.50, 0.32, 0.05, 0.006, 0.006, 0.006)
    for boom in (paper_boom, spatial_boom):
        assert _in(boom, outer, inner).segments[0].section is outer
    beside = hexagon(0.5, 0.5, 0.3, 0.006, 0.006, 0.006)
    within = hexagon(0.40, 0.40, 0.24, 0.005, 0.005, 0.005)
    assert _in(paper_boom, beside, within).segments[0].section is beside
    message = (
        "segments[0].section: has no single plate at right angles to y at its right, where the "
        "boom touches it; folds and inclined plates cannot be touched, give it a flat there"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        _in(spatial_boom, beside, within)
    folded = PolygonSection(
        ((0, -0.22), (0.11, -0.18), (0.11, 0.2), (-0.11, 0.2), (-0.11, -0.18)), (0.005,) * 5
    )
    message = (
        "segments[1].section: has no single plate at right angles to z at its bottom, where the "
        "boom touches it; folds and inclined plates cannot be touched, give it a flat there"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        _in(paper_boom, outer, folded)
    joint = replace(paper_boom.joints[0], bonded=True)
    bonded = _in(replace(paper_boom, joints=(joint,)), outer, folded)
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        replace(bonded, stops=(Stop(1, 15.0, 0.2, PowerContact(1e7, 1.0, stiffness_below=1e7)),))


def test_a_flat_lies_on_one_as_wide(paper_boom: Boom) -> None:
    outer = u_section(0.50, 0.32, 0.15, 3, 0.006, 0.006, 0.006)
    inner = u_section(0.30, 0.20, 0.02, 1, 0.005, 0.005, 0.005)
    message = (
        "segments[1].section: its bottom is 0.176569 m wide, and that of 'outer', which it "
        "touches, 0.0796737 m; make it narrower"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        _in(paper_boom, outer, inner)


def test_a_box_is_inferred_in_boxes_alone() -> None:
    message = (
        "a box is inferred within a box alone, and the section around it has inclined plates; give "
        "the section explicitly"
    )
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        infer_inner_section(0.007, 2.2e-4, HEXAGON, 0.007)


BASE = BoxSection(height=0.56, width=0.26, flange=0.008, web=0.006)
FLY = BoxSection(height=0.50, width=0.20, flange=0.006, web=0.005)
# In m.
WIDTHS: Mapping[PadSide, float] = {"above": 0.05, "below": 0.05, "left": 0.15, "right": 0.15}


def padded(steel: Material, widths: Mapping[PadSide, float]) -> Boom:
    """Return a boom in space with a pad on each side of its fly."""
    held = (Support(0.0, "clamped"),)
    base = Segment.of_section("base", 0.0, 6.0, steel, BASE, supports=held)
    fly = Segment.of_section("fly", 5.0, 11.0, steel, FLY)
    pads = tuple(SlidePad(0.1, width, side=side, thickness=0.02) for side, width in widths.items())
    return Boom((base, fly), (Joint(0, 1, (5.0, 6.0), play=0.01, lateral_play=0.01, pads=pads),))


def test_pads_of_a_wall_lie_side_by_side(steel: Material) -> None:
    """Reference: by hand, a pad of 40 mm from the corner inwards, and another from 30 mm on."""
    boom = padded(steel, WIDTHS)
    (joint,) = boom.joints
    second = SlidePad(0.1, 0.03, side="above", thickness=0.02, offset=0.06)
    assert replace(boom, joints=(replace(joint, pads=(*joint.pads, second)),)).joints[0].padded
    over = replace(joint, pads=(*joint.pads, replace(second, offset=0.03)))
    with pytest.raises(BoomError) as caught:
        replace(boom, joints=(over,))
    assert (caught.value.where, caught.value.what) == (
        "joints[0].pads",
        "two lie on one another above, 0.03 m from the corner; give the outer one a width of at "
        "most 0.03 m",
    )


def test_a_pad_has_the_room_of_its_own_wall(steel: Material) -> None:
    """Half a wall of 0.5 m has room for 0.15 m, half a wall of 0.2 m does not."""
    assert padded(steel, WIDTHS).joints[0].padded
    with pytest.raises(BoomError) as caught:
        padded(steel, {**WIDTHS, "below": 0.15})
    assert caught.value.where == "joints[0].pads[1].width"
    assert caught.value.what.startswith("must be above 0 and not above half a wall of the inner")
