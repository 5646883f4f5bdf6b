# SPDX-License-Identifier: LGPL-3.0-or-later
"""Which pads have room on their walls. Reference: sizes by hand."""

from collections.abc import Mapping

import pytest

from geometry.boom import Boom, BoomError, Joint, Material, Segment, SlidePad, Support
from geometry.joint import PadSide
from geometry.section import BoxSection

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


def test_a_pad_has_the_room_of_its_own_wall(steel: Material) -> None:
    """Half of a wall 0.5 m high has room for 0.15 m, half of one 0.2 m wide has not."""
    assert padded(steel, WIDTHS).joints[0].padded
    with pytest.raises(BoomError) as caught:
        padded(steel, {**WIDTHS, "below": 0.15})
    assert caught.value.where == "joints[0].pads[1].width"
    assert caught.value.what.startswith("must be above 0 and not above half a wall of the inner")
