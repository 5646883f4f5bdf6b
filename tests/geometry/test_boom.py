# SPDX-License-Identifier: LGPL-3.0-or-later
"""A boom knows its places, and refuses with the key of the fault what cannot be one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from geometry.boom import Boom, BoomError, Joint, Material, Segment

Fault = Callable[[Segment, Segment, Joint], tuple[tuple[Segment, ...], tuple[Joint, ...]]]

pytestmark = pytest.mark.quick


def test_numbers_of_a_segment(paper_boom: Boom) -> None:
    """Reference: analytic, by hand from the paper's data."""
    outer, inner = paper_boom.segments
    assert outer.material.shear_modulus == pytest.approx(2.1e11 / 2.6, rel=1e-14)
    assert outer.bending_stiffness == pytest.approx(7.97706e7, rel=1e-14)
    assert (outer.length, inner.length) == (10.0, 10.0)
    assert (outer.rigid_modes, inner.rigid_modes) == (0, 2)
    assert replace(outer, supports=(2.0,)).rigid_modes == 1
    assert replace(outer, supports=(0.0, 2.0, 10.0)).rigid_modes == 0


def test_ends_belong_to_a_segment(paper_boom: Boom) -> None:
    inner = paper_boom.segments[1]
    assert inner.holds(9.0)
    assert inner.holds(19.0)
    assert inner.holds(9.0 - 1e-10)
    assert not inner.holds(9.0 - 1e-8)
    assert not inner.holds(19.0 + 1e-8)


def test_places_of_the_paper(paper_boom: Boom) -> None:
    assert paper_boom.tip == 19.0
    assert paper_boom.stations_of(0) == paper_boom.stations_of(1) == (9.0, 10.0)
    assert paper_boom.observed() == {"tip": (1, 19.0), "head": (0, 10.0), "tail": (1, 9.0)}


def test_places_of_three_segments(paper_boom: Boom) -> None:
    outer, middle = paper_boom.segments
    (joint,) = paper_boom.joints
    last = replace(middle, name="last", start=17.5, end=27.0, section=None)
    second = replace(joint, outer=1, inner=2, stations=(17.5, 19.0))
    boom = Boom((outer, middle, last), (joint, second))
    assert boom.tip == 27.0
    assert boom.stations_of(1) == (9.0, 10.0, 17.5, 19.0)
    assert boom.stations_of(2) == (17.5, 19.0)
    assert boom.observed() == {
        "tip": (2, 27.0),
        "head": (0, 10.0),
        "tail": (1, 9.0),
        "head-2": (1, 19.0),
        "tail-2": (2, 17.5),
    }


FAULTS: dict[str, tuple[str, str, Fault]] = {
    "no segment": (
        "segment",
        "a boom needs at least one segment",
        lambda outer, inner, joint: ((), ()),
    ),
    "span reversed": (
        "segment[2].span",
        "must run from a smaller to a larger x, got [19, 9] m",
        lambda outer, inner, joint: ((outer, replace(inner, start=19.0, end=9.0)), (joint,)),
    ),
    "span not a number": (
        "segment[1].span",
        "must run from a smaller to a larger x, got [0, nan] m",
        lambda outer, inner, joint: ((replace(outer, end=float("nan")), inner), (joint,)),
    ),
    "support outside": (
        "segment[1].supports",
        "10.5 m lies outside the segment; it must be between 0 and 10 m",
        lambda outer, inner, joint: ((replace(outer, supports=(0.0, 10.5)), inner), (joint,)),
    ),
    "support twice": (
        "segment[1].supports",
        "a place is given twice; give each once",
        lambda outer, inner, joint: ((replace(outer, supports=(2.0, 2.0)), inner), (joint,)),
    ),
    "support twice but for round-off": (
        "segment[1].supports",
        "a place is given twice; give each once",
        lambda outer, inner, joint: (
            (replace(outer, supports=(0.3, 0.1 + 0.2)), inner),
            (joint,),
        ),
    ),
    "no overlap": (
        "joint[1]",
        "'outer' ends at 8.5 m before 'inner' starts at 9 m; the segments of a joint must overlap",
        lambda outer, inner, joint: ((replace(outer, end=8.5), inner), (joint,)),
    ),
    "station outside the overlap": (
        "joint[1].stations",
        "8 m lies outside the overlap of 'outer' and 'inner'; it must be between 9 and 10 m",
        lambda outer, inner, joint: ((outer, inner), (replace(joint, stations=(8.0, 10.0)),)),
    ),
    "stations falling": (
        "joint[1].stations",
        "must rise from the base to the tip, each given once",
        lambda outer, inner, joint: ((outer, inner), (replace(joint, stations=(10.0, 9.0)),)),
    ),
    "segments from the tip": (
        "segment[2].span",
        "must start and end beyond 'inner'; give the segments from the base to the tip",
        lambda outer, inner, joint: ((inner, outer), (replace(joint, outer=1, inner=0),)),
    ),
    "outer and inner exchanged": (
        "joint[1]",
        "'outer' is nearer to the base than 'inner'; exchange inner and outer",
        lambda outer, inner, joint: (
            (replace(outer, section=None), replace(inner, section=None)),
            (replace(joint, outer=1, inner=0),),
        ),
    ),
    "station twice": (
        "joint[1].stations",
        "must rise from the base to the tip, each given once",
        lambda outer, inner, joint: ((outer, inner), (replace(joint, stations=(9.0, 9.0)),)),
    ),
    "station twice but for round-off": (
        "joint[1].stations",
        "must rise from the base to the tip, each given once",
        lambda outer, inner, joint: (
            (outer, inner),
            (replace(joint, stations=(9.0, 9.0 + 1e-12, 10.0)),),
        ),
    ),
    "inner box too high": (
        "joint[1].play",
        "'inner' does not fit in 'outer': 0.014 m of height and 0.0399939 m of width are free, "
        "and a play of 0.028 m is asked for; make the inner section or the play smaller",
        lambda outer, inner, joint: ((outer, inner), (replace(joint, clearance=14.0e-3),)),
    ),
    "outer not held": (
        "segment[1]",
        "nothing holds 'outer': give it two supports, or a joint with two stations to a segment "
        "that is held",
        lambda outer, inner, joint: ((replace(outer, supports=(0.0,)), inner), (joint,)),
    ),
    "inner not held": (
        "segment[2]",
        "nothing holds 'inner': give it two supports, or a joint with two stations to a segment "
        "that is held",
        lambda outer, inner, joint: ((outer, inner), (replace(joint, stations=(9.5,)),)),
    ),
}


@pytest.mark.parametrize(("where", "what", "fault"), FAULTS.values(), ids=FAULTS.keys())
def test_refuses_what_is_no_boom(paper_boom: Boom, where: str, what: str, fault: Fault) -> None:
    with pytest.raises(BoomError) as caught:
        Boom(*fault(*paper_boom.segments, *paper_boom.joints))
    assert (caught.value.where, caught.value.what) == (where, what)
    assert str(caught.value) == f"{where}: {what}"


def test_a_chain_is_held_from_either_end(steel: Material, paper_boom: Boom) -> None:
    """Supports on the last segment hold the first one as well as the other way round."""
    outer, inner = (replace(s, section=None, supports=()) for s in paper_boom.segments)
    (joint,) = paper_boom.joints
    last = replace(inner, name="last", start=18.0, end=27.0, supports=(26.0, 27.0))
    second = replace(joint, outer=1, inner=2, stations=(18.0, 19.0))
    Boom((outer, inner, last), (joint, second))


def test_boxes_that_just_fit_are_taken(paper_boom: Boom) -> None:
    """The inferred boxes leave the play to round-off, and that is enough."""
    outer, inner = paper_boom.segments
    assert outer.section is not None
    assert inner.section is not None
    assert outer.section.clear_height_around(inner.section) == pytest.approx(14.0e-3, rel=1e-12)
