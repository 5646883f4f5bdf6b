# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms of two boxes in other proportions than the paper's, with its friction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from runs.case.schema import Case
from runs.case.sections import SectionTable
from studies.motions import friction_case
from studies.pads import with_pads

_DENSITY = 7850.0


@dataclass(frozen=True, slots=True)
class Proportions:
    """Of a boom of two boxes, the paper's unless given."""

    length: float = 10.0  #: of each segment in m
    overlap: float = 1.0  #: in m
    aspect: float = 1.634  #: height over width of the outer box
    walls: float = 1.0  #: thickness over the paper's
    #: Length and width of pads beside the webs in m; pressed near the webs without.
    pad: tuple[float, float] | None = None


# The paper's boxes, mid-lines and walls in m, and the room of the inner one in them.
HEIGHT, OUTER_WALL, INNER_WALL = 0.4945, 6.64e-3, 4.87e-3
_ROOM, BESIDE = 0.0141, 0.17

BOOMS: Mapping[str, Proportions] = {
    "the paper's": Proportions(),
    "half as long": Proportions(length=5.0, overlap=0.7),
    "a third as long": Proportions(length=3.5, overlap=0.5),
    "longer": Proportions(length=13.0),
    "long overlap": Proportions(overlap=3.0),
    "short overlap": Proportions(overlap=0.6),
    "thin walls": Proportions(walls=0.6),
    "thick walls": Proportions(walls=2.0),
    "narrow": Proportions(aspect=2.5),
    "wide": Proportions(aspect=1.0),
    "pads": Proportions(pad=(0.1, 0.06)),
    "pads, thick walls": Proportions(walls=2.0, pad=(0.1, 0.06)),
}


def boom_case(given: Proportions) -> Case:
    """The paper's case with friction, of these proportions, under its weight at 1 m/s²."""
    case = friction_case()
    walls = given.walls * OUTER_WALL, given.walls * INNER_WALL
    width = HEIGHT / given.aspect
    heights = HEIGHT, HEIGHT - sum(walls) - _ROOM
    boxes = [
        SectionTable.model_validate({"height": height, "width": wide, "flange": wall, "web": wall})
        for height, wide, wall in zip(heights, (width, (1.0 - BESIDE) * width), walls, strict=True)
    ]
    head = given.length
    spans = (0.0, head), (head - given.overlap, 2.0 * head - given.overlap)
    segments = []
    for table, box, span in zip(case.segments, boxes, spans, strict=True):
        supports = tuple(
            support.model_copy(update={"x": 0.2 * head if number else 0.0})
            for number, support in enumerate(table.supports)
        )
        # The box tells its own numbers.
        of_box = "height_to_width", "mass_per_length", "second_moment_of_area", "rotary_inertia"
        own = {"section": box, "span": span, "supports": supports}
        own["load"] = _DENSITY * box.section().area
        segments.append(table.model_copy(update=dict.fromkeys(of_box) | own))
    # Friction as large a part of the weight as the paper's.
    lighter = sum(table.load for table in segments) / sum(table.load for table in case.segments)
    forces = tuple(
        0.1 * head * lighter * force for joint in case.joints for force in joint.normal_forces
    )
    joint = case.joints[0].model_copy(
        update={"stations": (head - given.overlap, head), "normal_forces": forces}
    )
    found = case.model_copy(update={"segments": tuple(segments), "joints": (joint,)})
    return found if given.pad is None else with_pads(found, *given.pad)
