# SPDX-License-Identifier: LGPL-3.0-or-later
"""Statics of a boom as beam elements: masses, deflection at rest, reactions."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from rich.console import Console

from beam_model.statics import Elements, StaticState, net_reactions, static_state
from dynamics.damping import pressed_modes
from dynamics.failure import NUMERICS
from geometry.axial import on_foot
from geometry.boom import Boom
from geometry.cylinder import force_name
from geometry.typography import TO_KILO, TO_MILLI
from runs.case.schema import Case
from runs.case.units import System
from runs.pipeline.proportions import of_period, of_tip
from runs.pipeline.static_results import pressed, tilts
from runs.report.tables import Table

# Part of the other reactions below which a reaction counts as zero.
ROUND_OFF = 1.0e-9
# Moment in N·m below which a moment counts as zero.
_NO_MOMENT = 1.0e-3


@dataclass(frozen=True, slots=True)
class Reaction:
    """The reaction of a support, a cylinder or a stop on a segment at x in m.

    Args:
        segment: its name.
        x: in m.
        force: along z in N.
        moment: towards a larger slope in N·m.
        depth: compression of a stop in m; None for other reactions.
        along: axial force towards the tip in N.
    """

    segment: str
    x: float
    force: float
    moment: float
    depth: float | None
    along: float = 0.0


class Statics(NamedTuple):
    """The boom at rest under the loads of t = 0, as beam elements, and the same without play.

    Both are without play if no model of the case has any.
    """

    played: StaticState
    tied: StaticState


def statics(case: Case, boom: Boom) -> Statics | None:
    """Return the static states; None without an equilibrium."""
    with_play = not all(model.play_free for model in case.models)
    try:
        with np.errstate(all="ignore"):
            elements = Elements(boom)
            tied = static_state(boom.play_free, elements)
            if not with_play:
                return Statics(tied, tied)
            return Statics(static_state(with_play_seen(case, boom), elements), tied)
    except NUMERICS:
        return None


def with_play_seen(case: Case, boom: Boom) -> Boom:
    """Return the boom of the first model with play."""
    with_play = next((model for model in case.models if not model.play_free), case.models[0])
    return with_play.joined(boom).boom


def reactions(state: StaticState) -> list[Reaction]:
    """Return the support reactions."""
    between = _between_segments(state.boom)
    return [one for place, one in _held(state).items() if place not in between]


def _between_segments(boom: Boom) -> set[tuple[int, float]]:
    """Return the stations of joints by the inner segment and x in m."""
    return {(joint.inner, x) for joint in boom.joints for x in joint.stations}


def _held(state: StaticState) -> dict[tuple[int, float], Reaction]:
    """Return the reactions of ground and joints by segment and x in m, without round-off."""
    boom, depths, along = state.boom, _depths(state), _along(state)
    places = _between_segments(boom)
    places |= {(number, one.x) for number, s in enumerate(boom.segments) for one in s.supports}
    places |= {(stop.segment, stop.x) for stop in boom.stops}
    places |= {(cylinder.segment, cylinder.x) for cylinder in boom.cylinders}
    reactions = [
        reaction for reaction in net_reactions(boom, state.reactions) if reaction[:2] in places
    ]
    least = ROUND_OFF * max((abs(reaction.force) for reaction in reactions), default=0.0)
    return {
        reaction[:2]: Reaction(
            segment=boom.segments[reaction.segment].name,
            x=reaction.x,
            force=reaction.force if abs(reaction.force) > least else 0.0,
            moment=reaction.moment,
            depth=depths.get(reaction[:2]),
            along=along[reaction[:2]],
        )
        for reaction in reactions
    }


def _along(state: StaticState) -> dict[tuple[int, float], float]:
    """Return the axial forces of feet and cylinders in N, by segment and x in m; default 0."""
    boom = state.boom
    found: dict[tuple[int, float], float] = defaultdict(float)
    for number, segment in enumerate(boom.segments):
        if segment.foot is not None:
            found[number, segment.foot.x] = on_foot(boom.segments, boom.joints, number)
    for number, cylinder in enumerate(boom.cylinders, start=1):
        push = cylinder.direction[0] * cylinder_force(state, number)
        foot = boom.segments[cylinder.segment].foot
        found[cylinder.segment, cylinder.x] += push
        if foot is not None:
            found[cylinder.segment, foot.x] -= push
    return found


def _depths(state: StaticState) -> dict[tuple[int, float], float]:
    """Return the compression in m of stations along z, by the inner segment and x in m."""
    boom = state.boom
    joints = [joint for joint in boom.joints if not joint.tied]
    inner = [one.inner for _ in boom.directions for one in joints for _ in one.stations]
    owners = [*inner, *(stop.segment for stop in boom.stops)]
    found = pressed(boom, state.system, state.position)
    return {
        (number, one.x): one.depth
        for number, one in zip(owners, found, strict=True)
        if one.direction == "z"
    }


def cylinder_force(state: StaticState, number: int) -> float:
    """Return the force of a cylinder's spring in N; the first cylinder has number 1."""
    return float(state.system.observers[force_name(number)].row @ state.position)


def print_statics(case: Case, boom: Boom, console: Console) -> None:
    """Print the masses and the static state of the boom."""
    _masses(boom, case.system).show(console)
    found = statics(case, boom)
    if found is None:
        console.print("No rest under the loads of t = 0 is found.")
        return
    played, tied = found
    _reactions(played, case.system).show(console)
    if boom.cylinders:
        _cylinders(played, case.system).show(console)
    hertz = [
        float(pressed_modes(state.system, state.position)[0][0]) / (2.0 * np.pi) for state in found
    ]
    lines = [
        f"At rest the tip is at {played.tip * TO_MILLI:.4g} mm, without play at "
        f"{tied.tip * TO_MILLI:.4g} mm; the first frequency is {hertz[0]:.4g} Hz with the "
        f"joints pressed, {hertz[1]:.4g} Hz without play."
    ]
    lines += [
        f"Play turns {tilt.inner!r} by {tilt.rotation * TO_MILLI:.4g} mrad in {tilt.outer!r}, "
        f"which moves the tip by {tilt.tip * TO_MILLI:.4g} mm."
        for tilt in tilts(played.boom, played.system, played.position)
    ]
    model = "as beam elements"
    for line in (*lines, *of_tip(model, played.tip, boom), *of_period(model, hertz[0], case)):
        console.print(line, markup=False, highlight=False)


def _masses(boom: Boom, system: System) -> Table:
    """Return the table of masses of each segment with its attachments, and their sum."""
    kg, m = system.label("kg"), system.label("m")
    rows = []

    def mass(value: float) -> str:
        return f"{system.of(value, 'kg'):.4g}"

    def place(value: float) -> str:
        return f"{system.of(value, 'm'):.5g}"

    whole, moment = 0.0, 0.0
    for segment in boom.segments:
        own, here = segment.mass_per_length * segment.length, segment.mass
        middle = own * segment.mass_middle
        middle += sum(point.mass * point.x for point in segment.carried)
        rows.append((segment.name, mass(own), mass(here - own), place(middle / here)))
        whole, moment = whole + here, moment + middle
    rows.append(("all", mass(whole), "", place(moment / whole)))
    return Table.of_rows(
        "", "", ("mass", f"segment ({kg})", f"on it ({kg})", f"middle ({m})"), rows
    )


def _reactions(state: StaticState, system: System) -> Table:
    """Return the table of support reactions and contact compressions."""
    held = list(_held(state).values())
    pushed = any(one.along for one in held)
    along = ["along (kN)"] if pushed else []
    x = f"x ({system.label('m')})"
    rows = []
    for one in held:
        row = (
            one.segment,
            f"{system.of(one.x, 'm'):g}",
            f"{one.force * TO_KILO:.4g}",
            *([f"{one.along * TO_KILO:.4g}" if one.along else ""] if pushed else []),
            f"{one.moment * TO_KILO:.4g}" if abs(one.moment) > _NO_MOMENT else "",
            "" if one.depth is None else f"{one.depth * TO_MILLI:.3g}",
        )
        rows.append(row)
    return Table.of_rows(
        "",
        "",
        ("holds at rest", x, "force (kN)", *along, "moment (kN m)", "pressed in (mm)"),
        rows,
    )


def _cylinders(state: StaticState, system: System) -> Table:
    """Return the table of cylinder axes and forces; a pair side by side counts together."""
    lengths = [f"{name} ({system.label('m')})" for name in ("x", "length", "arm")]
    rows = []
    for number, cylinder in enumerate(state.boom.cylinders, start=1):
        segment = state.boom.segments[cylinder.segment]
        arm = None if segment.foot is None else cylinder.arm(segment.foot)
        row = (
            segment.name,
            f"{system.of(cylinder.x, 'm'):g}",
            f"{system.of(cylinder.length, 'm'):.5g}",
            "" if arm is None else f"{system.of(arm, 'm'):.5g}",
            f"{cylinder_force(state, number) * TO_KILO:.4g}",
        )
        rows.append(row)
    return Table.of_rows("", "", ("cylinder of", *lengths, "force (kN)"), rows)
