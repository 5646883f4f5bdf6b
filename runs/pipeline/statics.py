# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a designer knows by heart: weights, and what the boom at rest does and what holds it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.table import Table

from beam_model.statics import Elements, Hold, Rest, at_rest, handed_on
from dynamics.contact import ContactLaw
from dynamics.damping import pressed_modes
from dynamics.failure import NUMERICS
from geometry.axial import on_foot
from geometry.boom import Boom
from geometry.cylinder import force_name
from geometry.typography import TO_KILO, TO_MILLI
from runs.case.build import joined
from runs.case.schema import Case
from runs.case.units import System
from runs.pipeline.answers import Reaction
from runs.pipeline.at_rest import pressed, tilts
from runs.pipeline.proportions import of_period, of_tip

# A part of what others bear that is none.
ROUND_OFF = 1.0e-9
# Moments in N·m that are none.
_NO_MOMENT = 1.0e-3


class Statics(NamedTuple):
    """The boom at rest under the loads of t = 0, as beam elements, and the same without play.

    Both are without play where no model of the case has any.
    """

    played: Rest
    tied: Rest


def statics(case: Case, boom: Boom) -> Statics | None:
    """None where no rest is found."""
    with_play = not all(model.play_free for model in case.models)
    try:
        with np.errstate(all="ignore"):
            elements = Elements(boom)
            tied = at_rest(boom.play_free, [], [], elements)
            return Statics(at_rest(boom, *laws(case, boom), elements) if with_play else tied, tied)
    except NUMERICS:
        return None


def laws(case: Case, boom: Boom) -> tuple[Sequence[ContactLaw], Sequence[ContactLaw]]:
    """Of the joints along z and along y, as the first model with play sees them."""
    with_play = next((model for model in case.models if not model.play_free), case.models[0])
    seen = joined(case, boom, with_play)
    return seen.laws, seen.lateral_laws


def reactions(rest: Rest) -> list[Reaction]:
    """What holds the boom to the ground."""
    boom, deep, along = rest.boom, _depths(rest), _along(rest)
    return [
        Reaction(
            boom.segments[number].name,
            x,
            force,
            moment,
            deep.get((number, x)),
            along[number, x],
        )
        for number, x, force, moment in _told(rest)
        if (number, x) not in _stands(boom)
    ]


def _stands(boom: Boom) -> set[tuple[int, float]]:
    """Where segments stand in others."""
    return {(joint.inner, x) for joint in boom.joints for x in joint.stations}


def _told(rest: Rest) -> list[Hold]:
    """Holds of the ground and of joints, each once and without round-off."""
    boom = rest.boom
    grounded = {(number, one.x) for number, s in enumerate(boom.segments) for one in s.supports}
    grounded |= {(stop.segment, stop.x) for stop in boom.stops}
    grounded |= {(cylinder.segment, cylinder.x) for cylinder in boom.cylinders}
    holds = [hold for hold in handed_on(boom, rest.holds) if hold[:2] in grounded | _stands(boom)]
    least = ROUND_OFF * max((abs(hold.force) for hold in holds), default=0.0)
    return [hold._replace(force=hold.force if abs(hold.force) > least else 0.0) for hold in holds]


def print_statics(case: Case, boom: Boom, console: Console) -> None:
    """Print masses, and the boom at rest."""
    console.print(_masses(boom, case.system))
    found = statics(case, boom)
    if found is None:
        console.print("No rest under the loads of t = 0 is found.")
        return
    console.print(_holds(found.played, case.system))
    if boom.cylinders:
        console.print(_cylinders(found.played, case.system))
    hertz = [_first_frequency(rest) for rest in found]
    console.print(_line(found, hertz), highlight=False)
    for tilt in tilts(found.played.boom, found.played.system, found.played.position):
        console.print(
            f"Play turns {tilt.inner!r} by {tilt.rotation * TO_MILLI:.4g} mrad in {tilt.outer!r}, "
            f"which moves the tip by {tilt.tip * TO_MILLI:.4g} mm.",
            highlight=False,
            markup=False,
        )
    told = "as beam elements"
    for caution in (*of_tip(told, found.played.tip, boom), *of_period(told, hertz[0], case)):
        console.print(caution, markup=False, highlight=False)


def _along(rest: Rest) -> dict[tuple[int, float], float]:
    """What feet and cylinders push along the boom in N, by the segment and x in m; else 0."""
    boom = rest.boom
    found: dict[tuple[int, float], float] = defaultdict(float)
    for number, segment in enumerate(boom.segments):
        if segment.foot is not None:
            found[number, segment.foot.x] = on_foot(boom.segments, boom.joints, number)
    for number, cylinder in enumerate(boom.cylinders, start=1):
        push = cylinder.direction[0] * cylinder_force(rest, number)
        foot = boom.segments[cylinder.segment].foot
        found[cylinder.segment, cylinder.x] += push
        if foot is not None:
            found[cylinder.segment, foot.x] -= push
    return found


def _depths(rest: Rest) -> dict[tuple[int, float], float]:
    """How far in m stations along z are pressed in, by the inner segment and x in m."""
    boom = rest.boom
    inner = [
        joint.inner
        for _ in boom.directions
        for joint in boom.joints
        if not joint.tied
        for _ in joint.stations
    ]
    owners = [*inner, *(stop.segment for stop in boom.stops)]
    found = pressed(boom, rest.system, rest.position)
    return {
        (number, one.x): one.depth
        for number, one in zip(owners, found, strict=True)
        if one.direction == "z"
    }


def _masses(boom: Boom, system: System) -> Table:
    """Of each segment with what it carries, and of all."""
    kg, m = system.label("kg"), system.label("m")
    table = Table("mass", f"segment ({kg})", f"on it ({kg})", f"middle ({m})")

    def mass(value: float) -> str:
        return f"{system.of(value, 'kg'):.4g}"

    def place(value: float) -> str:
        return f"{system.of(value, 'm'):.5g}"

    whole, moment = 0.0, 0.0
    for segment in boom.segments:
        own, here = segment.mass_per_length * segment.length, segment.mass
        middle = own * segment.mass_middle
        middle += sum(point.mass * point.x for point in segment.carried)
        table.add_row(segment.name, mass(own), mass(here - own), place(middle / here))
        whole, moment = whole + here, moment + middle
    table.add_row("all", mass(whole), "", place(moment / whole))
    return table


def _holds(rest: Rest, system: System) -> Table:
    """Forces on the segments where something holds them, and how deep contacts are pressed."""
    x = f"x ({system.label('m')})"
    headings = ["force (kN)", "moment (kN m)", "pressed in (mm)"]
    along = _along(rest)
    if any(along.values()):
        headings.insert(1, "along (kN)")
    table = Table("holds at rest", x, *headings)
    deep = _depths(rest)
    for hold in _told(rest):
        moment = f"{hold.moment * TO_KILO:.4g}" if abs(hold.moment) > _NO_MOMENT else ""
        depth = f"{deep[hold[:2]] * TO_MILLI:.3g}" if hold[:2] in deep else ""
        cells = [f"{hold.force * TO_KILO:.4g}", moment, depth]
        if any(along.values()):
            here = along.get(hold[:2])
            cells.insert(1, f"{here * TO_KILO:.4g}" if here else "")
        where = f"{system.of(hold.x, 'm'):g}"
        table.add_row(rest.boom.segments[hold.segment].name, where, *cells)
    return table


def _cylinders(rest: Rest, system: System) -> Table:
    """Their lines, and the forces along them: of two side by side together."""
    lengths = [f"{name} ({system.label('m')})" for name in ("x", "length", "arm")]
    table = Table("cylinder of", *lengths, "force (kN)")
    for number, cylinder in enumerate(rest.boom.cylinders, start=1):
        segment = rest.boom.segments[cylinder.segment]
        force = cylinder_force(rest, number)
        arm = None if segment.foot is None else cylinder.arm(segment.foot)
        table.add_row(
            segment.name,
            f"{system.of(cylinder.x, 'm'):g}",
            f"{system.of(cylinder.length, 'm'):.5g}",
            "" if arm is None else f"{system.of(arm, 'm'):.5g}",
            f"{force * TO_KILO:.4g}",
        )
    return table


def cylinder_force(rest: Rest, number: int) -> float:
    """Of a cylinder's spring in N, from 1 on."""
    return float(rest.system.observers[force_name(number)].row @ rest.position)


def _first_frequency(rest: Rest) -> float:
    """In Hz, with the joints pressed."""
    return float(pressed_modes(rest.system, rest.position)[0][0]) / (2.0 * np.pi)


def _line(found: Statics, hertz: Sequence[float]) -> str:
    return (
        f"At rest the tip is at {found.played.tip * TO_MILLI:.4g} mm, without play at "
        f"{found.tied.tip * TO_MILLI:.4g} mm; the first frequency is {hertz[0]:.4g} Hz with the "
        f"joints pressed, {hertz[1]:.4g} Hz without play."
    )
