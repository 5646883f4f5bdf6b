# SPDX-License-Identifier: LGPL-3.0-or-later
"""Parts of a boom check their fields, and give places from the ends of their segments."""

from dataclasses import replace
from typing import Any

import pytest
from pydantic import ValidationError

from dynamics.contact import PowerContact
from geometry.boom import (
    Boom,
    Collar,
    Cylinder,
    Diaphragm,
    Observation,
    PadSize,
    PointMass,
    SlidePad,
    Stop,
    Support,
)
from geometry.fields import Distance

JACK = {"segment": 0, "x": 4.0, "ground": (1.0, -2.0), "stiffness": 1.0e7}


@pytest.mark.parametrize(
    ("part", "fields", "key", "message"),
    [
        (Support, {"x": 2.0, "stiffness": -5.0}, "stiffness", "greater than 0"),
        (Support, {"x": 2.0, "dashpot": -1.0}, "dashpot", "greater than or equal to 0"),
        (Support, {"x": 0.0, "rotation_stiffness": 0.0}, "rotation_stiffness", "greater than 0"),
        (Support, {"x": "tip"}, "x", "a place"),
        (PointMass, {"x": 19.0, "mass": 0.0}, "mass", "greater than 0"),
        (Collar, {"span": (1.0, 2.0), "thickness": 0.0}, "thickness", "greater than 0"),
        (Diaphragm, {"x": 1.0, "thickness": float("inf")}, "thickness", "a finite number"),
        (Cylinder, JACK | {"dashpot": -1.0}, "dashpot", "greater than or equal to 0"),
        (Cylinder, JACK | {"stiffness": 0.0}, "stiffness", "greater than 0"),
        (Observation, {"name": "a/b", "segment": 0, "x": 1.0}, "name", "match pattern"),
        (PadSize, {"length": 0.0, "width": 0.1}, "length", "greater than 0"),
        (SlidePad, {"length": 0.1, "width": 0.1, "side": "above"}, "thickness", "required"),
    ],
)
def test_impossible_numbers_are_refused(
    part: type, fields: dict[str, Any], key: str, message: str
) -> None:
    with pytest.raises(ValidationError) as caught:
        part(**fields)
    (error,) = caught.value.errors()
    assert error["loc"][0] == key
    assert message in error["msg"]


def test_a_boom_finds_the_places_of_its_parts(paper_boom: Boom) -> None:
    outer, inner = paper_boom.segments
    # Fields are typed as they are in a boom, with x in m; a user may give other places before.
    arm = replace(
        outer,
        supports=(Support("tail"), Support(2.0)),  # type: ignore[arg-type]
        collars=(Collar((Distance(head=0.5), "head"), 0.01),),  # type: ignore[arg-type]
    )
    stop = Stop("inner", Distance(head=1.0), 0.002, PowerContact(1.0e9))  # type: ignore[arg-type]
    boom = Boom((arm, inner), paper_boom.joints, stops=(stop,))
    assert boom.segments[0].supports == (Support(0.0), Support(2.0))
    assert boom.segments[0].collars[0].span == (9.5, 10.0)
    assert (boom.stops[0].segment, boom.stops[0].x) == (1, 18.0)
