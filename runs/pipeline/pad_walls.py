# SPDX-License-Identifier: LGPL-3.0-or-later
"""Share of the tip deflection that soft walls and sections at contacts cause, and remedies."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from itertools import product
from typing import Any

from protractile.analysis.states import States
from protractile.geometry.boom import Boom, Collar
from protractile.geometry.joint import Pad
from protractile.geometry.typography import join_words
from protractile.runs.case.schema import Case, Model
from protractile.runs.pipeline.statics import state_at_rest

# Fraction to which a remedy reduces the tip deflection at least.
HELPFUL = 0.9


def wall_part(case: Case, beam: States) -> float | None:
    """Return the share of the largest static tip deflection that walls or sections cause.

    The share is 1 if they cause all of it; None if nothing yields, or if a section is unknown.
    """
    boom, (time, tip) = beam.boom, largest_tip(beam)
    if not boom.yielding or any(segment.section is None for segment in boom.segments):
        return None
    rigid = state_at_rest(case, boom, walls=0.0, time=time).tip
    return 1.0 - rigid / tip if tip else 0.0


def largest_tip(beam: States) -> tuple[float, float]:
    """Return the time in s and the value in m of the largest tip deflection along z."""
    farthest = beam.largest("tip")
    return float(farthest.time[0]), float(farthest.observed("tip")[0])


def remedies(case: Case, beam: States) -> list[tuple[float, str]]:
    """Return what makes the largest static tip deflection smaller: its tip in m, in words.

    The best remedy is the first one. The states are those of a boom with the contact laws of the
    first model with play.

    Raises:
        NumericsError: the boom has no equilibrium after a change that a remedy makes.
    """
    time, largest = largest_tip(beam)
    tips = (
        (state_at_rest(case, changed, time=time).tip, what)
        for what, changed in _stiffer_booms(beam.boom)
        if changed != beam.boom
    )
    better = sorted((tip / largest, tip, what) for tip, what in tips)
    return [(tip, what) for part, tip, what in better if part < HELPFUL]


def rigid_wall_note(models: Iterable[Model], boom: Boom) -> str:
    """Return a sentence that names the beams without what yields; empty without them."""
    with_play = [model for model in models if not model.bonded]
    names = [repr(model.name) for model in with_play if not model.needs_shell]
    elastic = [repr(model.name) for model in with_play if model.needs_shell]
    if not names or not boom.yielding:
        return ""
    others = f", elastic in {join_words(elastic)}" if elastic else ""
    return f"{boom.yielding.capitalize()} are rigid in {join_words(names)}{others}."


def _stiffer_booms(boom: Boom) -> Iterator[tuple[str, Boom]]:
    """Yield changes that may stiffen walls or sections: a description and the changed boom."""

    def longer(pad: Pad, longest: float) -> dict[str, Any]:
        return {"length": max(min(2.0 * pad.length, longest), pad.length)}

    offset = any(
        pad is not None and pad.offset > 0.0
        for joint in boom.joints
        for pad in (*joint.pads, joint.pad)
    )
    if offset:
        beside = _with_pads(boom, lambda *_: {"offset": 0.0})
        yield "pads beside the corners, offset left out", beside
    narrower = _with_pads(boom, lambda pad, _: {"width": 0.5 * pad.width})
    yield "pads half as wide (width), at twice the pressure", narrower
    yield "pads twice as long (length)", _with_pads(boom, longer)
    without = " and offset left out" if offset else ""
    corners = _with_pads(boom, lambda *_: {"bears": "corner", "offset": 0.0})
    yield f"pads that bear on the corners, bears = 'corner'{without}", corners
    walls = _with_pads(boom, lambda *_: {"bears": "wall"})
    yield "pads that bear on the walls, beside the corners, bears = 'wall'", walls
    place = "pad" if any(joint.padded for joint in boom.joints) else "station"
    collars = (
        f"collars around both segments at each {place}, as thick as the walls and one section "
        "height long (the boom can then not telescope)"
    )
    yield collars, _with_collars(boom)


def _with_pads(boom: Boom, changes: Callable[[Pad, float], dict[str, Any]]) -> Boom:
    """Return the boom with changed pads.

    ``changes`` takes a pad and half the overlap in m, and returns changed fields.
    """
    joints = []
    for joint in boom.joints:
        start, end = boom.overlap(joint)
        half = 0.5 * (end - start)
        pad = None if joint.pad is None else replace(joint.pad, **changes(joint.pad, half))
        pads = tuple(replace(pad, **changes(pad, half)) for pad in joint.pads)
        joints.append(replace(joint, pad=pad, pads=pads))
    return replace(boom, joints=tuple(joints))


def _with_collars(boom: Boom) -> Boom:
    """Return the boom with collars at all contacts, each as thick as the wall.

    A new collar extends half the height of the section on both sides of the station. Where there is
    a collar, it stays.
    """
    segments = list(boom.segments)
    for joint in (joint for joint in boom.joints if not joint.bonded):
        for index, x in product((joint.outer, joint.inner), joint.stations):
            segment, section = segments[index], segments[index].section_at(x)
            reach, thickness = 0.5 * section.size("z"), section.face("z", 1).thickness
            start, end = max(segment.start, x - reach), min(segment.end, x + reach)
            if not any(
                collar.span[0] < end and collar.span[1] > start for collar in segment.collars
            ):
                collars = (*segment.collars, Collar((start, end), thickness))
                segments[index] = replace(segment, collars=collars)
    return replace(boom, segments=tuple(segments))
