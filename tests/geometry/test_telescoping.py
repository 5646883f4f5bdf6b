# SPDX-License-Identifier: LGPL-3.0-or-later
"""Permitted travels of drives. Reference: lengths by hand."""

from dataclasses import replace
from typing import Any

import pytest

from protractile.dynamics.motion_laws import SCurve
from protractile.geometry.boom import (
    Boom,
    BoomError,
    Diaphragm,
    Joint,
    Material,
    Pad,
    Segment,
    SlidePad,
    Support,
)
from protractile.geometry.box import BoxSection
from protractile.geometry.fit import room
from protractile.geometry.joint import Drive

BASE = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
FLY = BoxSection(height=0.34, width=0.24, flange=0.006, web=0.005)


def drawn(
    steel: Material,
    start: float,
    end: float,
    travel: float,
    least: float = 0.0,
    base: dict[str, Any] | None = None,
    fly: dict[str, Any] | None = None,
    **joint: Any,
) -> Boom:
    """Return a base of 6.5 m, and a fly from start to end in m, touching at the overlap's ends."""
    held = (Support(0.0, "clamped"),)
    segments = (
        Segment.of_section("base", 0.0, 6.5, steel, BASE, supports=held, **(base or {})),
        Segment.of_section("fly", start, end, steel, FLY, **(fly or {})),
    )
    drive = Drive(SCurve(travel, 2.0), ("inner", "outer"), least)
    joint = {"play": 3.0e-3, "stations": (start, 6.5), **joint}
    return Boom(segments, (Joint(0, 1, drive=drive, **joint),))


@pytest.mark.parametrize(
    ("start", "end", "travel", "least"),
    [(6.5 + 4.8 - 6.0, 11.3, 0.7, 0.5), (0.5, 6.8, -0.3, 0.0)],
    ids=["out", "in"],
)
def test_travel_may_reach_the_least_overlap(
    steel: Material, start: float, end: float, travel: float, least: float
) -> None:
    """Overlaps of 0.5 m and 0.3 m of the fly remain; both are smaller by round-off."""
    assert drawn(steel, start, end, travel, least).telescopes


def test_no_segment_is_drawn_in_through_a_diaphragm(steel: Material) -> None:
    """From 2.5 to 1.5 m the segment hits a plate at 2 m; with 0.4 m it does not reach it."""
    plated = {"diaphragms": (Diaphragm(2.0, 0.008),)}
    assert drawn(steel, 2.5, 9.0, -0.4, base=plated)
    with pytest.raises(BoomError) as caught:
        drawn(steel, 2.5, 9.0, -1.0, base=plated)
    assert (caught.value.where, caught.value.what) == (
        "joints[0].drive",
        "retracts 'fly' by 1 m, and the diaphragm of 'base' at 2 m is in its way; it must be less "
        "than 0.5 m",
    )


def test_tapered_segments_fit_all_of_the_way(steel: Material) -> None:
    """Sections taper from 0.40 to 0.36 m and from 0.34 to 0.30 m. Initially 26 mm are free between
    the walls, at 9 m 16 mm less.
    """
    sections = (
        BoxSection(height, width, flange, web=0.006)
        for height, width, flange in (
            (0.40, 0.30, 0.008), (0.36, 0.30, 0.008), (0.34, 0.24, 0.006), (0.30, 0.24, 0.006),
        )
    )  # fmt: skip
    tail, head, *inner = sections
    held = (Support(0.0, "clamped"),)
    base = Segment.of_section("base", 0.0, 10.0, steel, tail, supports=held, head_section=head)
    fly = Segment.of_section("fly", 5.0, 15.0, steel, inner[0], head_section=inner[1])
    joint = Joint(0, 1, (5.0, 10.0), play=0.014)
    assert room(joint, base, fly)[0] == pytest.approx(0.026)
    assert room(joint, base, fly, 4.0)[0] == pytest.approx(0.010)
    for travel, clearance in ((3.0, 0.007), (4.0, 0.005)):
        drive = Drive(SCurve(travel, 2.0), ("inner", "outer"))
        assert Boom((base, fly), (replace(joint, play=2.0 * clearance, drive=drive),)).telescopes
    drive = Drive(SCurve(4.0, 2.0), ("inner", "outer"))
    with pytest.raises(BoomError) as caught:
        Boom((base, fly), (replace(joint, drive=drive),))
    assert (caught.value.where, caught.value.what) == (
        "joints[0].drive",
        "moves 'fly' by 4 m to where it does not fit in 'base': 0.01 m of height and 0.048 m of "
        "width are free there, and a play of 0.014 m is asked for; make the travel or the taper "
        "smaller",
    )


LEFT = "must not be above the overlap of 0.1 m that is left where 'fly' extends by 1.1 m, got "
PAD = Pad(0.12, 0.05)
PADS = (
    SlidePad(0.08, 0.05, side="above", thickness=0.02),
    SlidePad(0.11, 0.05, side="below", thickness=0.02),
)


@pytest.mark.parametrize(
    ("joint", "key", "message"),
    [
        ({"pad": PAD}, "pad.length", LEFT + "0.12 m"),
        ({"contact_length": 0.15}, "contact_length", LEFT + "0.15 m"),
        ({"pads": PADS}, "pads[1].length", LEFT + "0.11 m"),
        ({"pad": replace(PAD, length=0.08), "stations": (5.38, 6.5)}, "pad.length", "the pad at "
         "5.38 m leaves 'base' as 'fly' telescopes by 1.1 m; make it shorter, or move the station"),
    ],
)  # fmt: skip
def test_pads_stay_on_both_segments(
    steel: Material, joint: dict[str, Any], key: str, message: str
) -> None:
    """The initial overlap is 1.2 m. A pad at 5.38 m ends at 5.42 m, or 0.02 m beyond the base."""
    place = 6.5 + 4.8 - 6.0
    assert drawn(steel, place, 11.3, 1.0, **joint).telescopes
    with pytest.raises(BoomError) as caught:
        drawn(steel, place, 11.3, 1.1, **joint)
    assert (caught.value.where, caught.value.what) == (f"joints[0].{key}", message)
