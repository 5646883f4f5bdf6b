# SPDX-License-Identifier: LGPL-3.0-or-later
"""All views of one boom show the same numbers: check, prove, run, live and frequencies.

Each case has one model of beam elements as fine as those of ``check``, and ends early, so that the
views have the same loads. Two differences have their reason in the output: walls under pads bend
in ``check`` and ``prove`` only, and proofs have the initial extension.
"""

import re
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from typing import Any, NamedTuple

import pytest

import protractile as pt
from protractile.analysis.rows import INITIAL
from protractile.analysis.rows import REST as AT_REST
from protractile.dynamics.damping import closed_contact_damping
from protractile.geometry.boom import Boom
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.reading import CheckedCase
from protractile.runs.check import Check
from protractile.runs.live.beam import beam_results
from protractile.runs.live.controls import Draft
from protractile.runs.pipeline.combinations import combination_states
from protractile.runs.pipeline.models import build, initial_motion
from protractile.runs.pipeline.proofs import prove
from protractile.runs.report.result_tables import peaks
from protractile.runs.sweep.frequencies import first_frequencies
from tests.runs.case_texts import CLAMPED, HINGED, REST, STEEL, elements, joint, shipped, table

# Relative error of numbers in texts of three and of four digits, and of computed numbers.
THREE, FOUR, NONE = 5.0e-3, 5.0e-4, 1.5e-4
# Quantities of which the largest one counts, with the beginnings of their rows in ``check``.
LARGEST = {"stress": "stress, ", "pad_pressure": "pad, "}
# Durations in s of cases whose load leaves the ground later than the others' loads begin.
LIFTED = {"hoist": 5.0, "luffed": 3.0}


def own_boom(angle: float, more: str, play: str = "") -> pt.Case:
    """Return a boom of two octagons at an angle in degrees, with further tables."""
    text = 'title = "own"\n' + STEEL + REST + table("[time]", duration=1.0)
    text += table("[gravity]", angle=angle) + table("[damping]", modal=0.015)
    for name, span, (height, width, chamfer) in (
        ("base", [0.0, 8.0], (0.5, 0.4, 0.1)),
        ("fly", [6.5, 14.0], (0.44, 0.34, 0.08)),
    ):
        walls = {"chamfer": chamfer, "top": 0.008, "bottom": 0.008, "web": 0.006}
        section = {"shape": "octagon", "height": height, "width": width, **walls}
        text += table("[[segment]]", name=name, span=span, section=section)
        if name == "base":
            text += CLAMPED if play else HINGED
    text += joint("fly", "base", 0.004, (6.5, 8.0), play) + more + elements("any")
    return pt.load_case(tomllib.loads(text))


_JACK = {"segment": "base", "x": 3.0, "depth": 0.3, "ground": [1.0, -1.5], "stiffness": 5e7}
_CYLINDER, _ROPE = table("[[cylinder]]", **_JACK), {"mass": 2000.0, "stiffness": 2e6}
OWN = {
    "hanging": (
        50.0,
        table("[hoist]", **_ROPE, hanging=True)
        + table("[rope]", falls=4)
        + table("[limits]", tip_at_rest=0.2)
        + _CYLINDER,
    ),
    "luffed": (
        50.0,
        table("[hoist]", **_ROPE, travel=0.5, speed=0.5, ramp=0.1)
        + table("[payload]", mass=100.0, group="dead")
        + table("[[load_case]]", name="low", angle=10.0)
        + table("[[combination]]", name="A", factors={"dead": 1.1, "payload": 1.3})
        + table("[limits]", tip_at_rest=0.5)
        + _CYLINDER,
    ),
    "space": (
        20.0,
        table("[payload]", mass=300.0)
        + table("[[load]]", segment="fly", x="head", direction="y", magnitude=800.0)
        + table("[limits]", tip_at_rest=0.2),
        "lateral_play = 0.003",
    ),
}
NAMES = "coarse", "crane-proof", "friction-walk", "hoist", "inspection-arm", "lift", "slew"


class View(NamedTuple):
    """A number that a view shows."""

    quantity: str
    name: str
    value: float
    error: float  #: relative, of its text
    walls: bool = False  #: True if walls under pads bend


def case_of(name: str) -> tuple[pt.Case, Boom]:
    """Return a case with one model of beam elements, and its boom."""
    case = own_boom(*OWN[name]) if name in OWN else shipped(name)
    boom = build_boom(case)
    contacts = [getattr(model, "contact", None) for model in case.models]
    whole = all(segment.section is not None for segment in boom.segments)
    beam = BeamElements(
        name="beam",
        theory="timoshenko" if whole else "euler-bernoulli",
        element_length=max(segment.length for segment in boom.segments) / 20.0,
        contact=next(filter(None, contacts), None),
    )
    duration = LIFTED.get(name, 0.02)
    time = case.time.model_copy(update={"duration": duration, "output_step": duration / 20.0})
    changes: dict[str, Any] = {"models": (beam,), "ensemble": None, "buckling": None, "time": time}
    if "paper" in type(case).model_fields:
        changes["paper"] = None
    return case.model_copy(update=changes), boom


def number(text: object) -> float:
    """Return the first number of a text."""
    return float(str(text).split()[0].replace("−", "-"))


def of_check(checked: Check) -> Iterator[View]:
    frames, lines = checked.frames, " ".join(checked.lines)
    static = next(frame for title, frame in frames.items() if title.startswith("Static results"))
    static = static.set_index(static.columns[0])
    largest = "maximum" if "maximum" in static else "t = 0"
    for quantity, row, column in (
        ("tip at t = 0", "tip", "t = 0"),
        ("largest tip", "tip", largest),
        ("cylinder force", "cylinder force", largest),
    ):
        if row in static.index:
            yield View(quantity, "check", number(static.loc[row, column]), THREE, True)
    for quantity, row in LARGEST.items():
        shown = [number(cell) for cell in static.loc[static.index.str.startswith(row), largest]]
        if shown:
            yield View(quantity, "check", max(map(abs, shown)), THREE, True)
    for quantity, words, unit in (
        ("tip at t = 0", "Static tip deflection", "mm"),
        ("first frequency", "First natural frequency", "Hz"),
    ):
        (text,) = re.findall(rf"{words}[^:]*: (\S+) {unit};", lines)
        yield View(quantity, "first screen", number(text), FOUR, True)
    yield View("mass", "check", frames["Masses"].iloc[-1, 1:3].astype(float).sum(), FOUR)
    for title, frame in frames.items():
        if title.startswith("Buckling under"):
            yield View("buckling factor", "check", frame.iloc[0, 1], NONE)
        if title.startswith("Damping"):
            ratio, hertz = re.findall(r"(\S+) % at (\S+) Hz", frame.iloc[0, 1])[0]
            yield View("damping ratio", "check", number(ratio), THREE)
            yield View("first frequency", "table of damping", number(hertz), THREE)


def of_prove(case: pt.Case, boom: Boom) -> Iterator[View]:
    plain = case.model_copy(update={"combinations": (), "load_cases": (), "spectra": ()})
    (state,) = combination_states(plain)
    (tip,) = state.rows.where(quantity="tip")
    yield View("largest tip", "prove", 1e3 * tip.value, NONE, True)
    for kind in ("cylinder force", "foot reaction"):
        if row := state.rows.where(quantity=kind.replace(" ", "_")).largest:
            yield View(kind, "prove", 1e-3 * row.value, NONE, True)
    # Combinations do not slew.
    for quantity in () if case.slew else LARGEST:
        if row := state.rows.where(quantity=quantity).largest:
            yield View(quantity, "prove", 1e-6 * abs(row.value), NONE, True)
    table = state.combined.combination.model_copy(update={"proofs": ("column",)})
    state = replace(state, combined=state.combined._replace(combination=table))
    for proof in prove(plain, [state]).rows:
        if not boom.telescopes:
            yield View("buckling factor", "prove", proof.limit / proof.value, NONE, True)


def of_run(case: pt.Case, boom: Boom) -> Iterator[View]:
    results = pt.run_case(case)
    rows, motion = results.rows.where(model="beam", play=True), results.trajectories
    static = rows.where(state=[INITIAL, AT_REST])
    for state, what in ((INITIAL, "tip at t = 0"), (AT_REST, "largest tip")):
        (tip,) = static.where(state=state, quantity="tip")
        yield View(what, "run", 1e3 * tip.value, NONE)
    if case.start.at_rest:
        yield View("tip at t = 0", "motion", 1e3 * float(motion["tip"][0, 0]), NONE)
    yield View("first frequency", "run", static.where(quantity="frequency")[0].value, NONE)
    if force := static.where(quantity="cylinder_force").largest:
        yield View("cylinder force", "run", 1e-3 * force.value, NONE)
    for quantity in LARGEST:
        if row := static.where(state=AT_REST, quantity=quantity).largest:
            yield View(quantity, "run", 1e-6 * abs(row.value), NONE)
    if not (boom.telescopes or boom.spatial or case.slew or case.luff):
        for peak in peaks(rows).where(quantity="foot_reaction"):
            yield View("foot reaction", "run", 1e-3 * rows.at_rest(peak), NONE)
    for check in results.check_limits():
        if check.limit.quantity.name == "tip_at_rest":
            yield View("largest tip", "limit", -1e3 * check.values["beam"], NONE)
    if case.damping.modal:
        yield View("damping ratio", "case", 100.0 * case.damping.modal, NONE)
        if case.start.at_rest:
            plan = initial_motion(build(case, boom, case.models[0]).system, case)
            ratio = closed_contact_damping(plan.system, plan.position)[1][0]
            yield View("damping ratio", "motion", 100.0 * ratio, NONE)


def of_live(case: pt.Case, boom: Boom) -> Iterator[View]:
    answer = next(beam_results(CheckedCase(case), Draft("", case, boom), lambda: None))
    for words, quantity in (
        ("Static tip deflection (t = 0)", "tip at t = 0"),
        ("Static tip deflection (maximum load)", "largest tip"),
        ("First natural frequency", "first frequency"),
    ):
        for row in answer["rows"]:
            if row[0].startswith(words):
                yield View(quantity, "live", number(row[1]), THREE)


@pytest.mark.slow
@pytest.mark.usefixtures("empty_cache")
@pytest.mark.parametrize("name", [*NAMES, *OWN])
def test_views_show_the_same_numbers(name: str) -> None:
    """Reference: each other, up to the digits that they show.

    ``check`` left a load on a rope out across the boom: -543 mm for -1816 mm of ``hoist``.
    """
    case, boom = case_of(name)
    checked = pt.check(case)
    hertz = first_frequencies(case, case.models[0], None, None)[0, 0]
    views = [
        *of_check(checked), *of_prove(case, boom), *of_run(case, boom), *of_live(case, boom),
        View("first frequency", "frequencies", hertz, NONE), View("mass", "boom", boom.mass, NONE),
    ]  # fmt: skip
    stated = f"{boom.yielding.capitalize()} are rigid in 'beam'." in checked.lines
    assert stated == bool(boom.yielding)
    for one, other in combinations(views, 2):
        alike = one.walls == other.walls or not boom.yielding
        if one.quantity == other.quantity and alike:
            within = (one.error + other.error) * max(abs(one.value), abs(other.value))
            assert abs(one.value - other.value) <= within, (one, other)
    if case.limits is not None and case.limits.tip_at_rest is not None:
        (tip,) = (x for x in views if (x.quantity, x.name) == ("largest tip", "check"))
        exceeded = abs(tip.value) > 1e3 * case.limits.tip_at_rest
        assert any("is exceeded: the static tip" in one for one in checked.lines) == exceeded
