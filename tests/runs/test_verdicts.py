# SPDX-License-Identifier: LGPL-3.0-or-later
"""Verdicts on the statements of the paper, and their tables in the terminal."""

from typing import Any

import numpy as np
import pytest

from protractile.runs.case import reading as case_file
from protractile.runs.case.contact import ContactTable
from protractile.runs.case.schema import Case
from protractile.runs.paper.statements import STATEMENTS
from protractile.runs.paper.verdicts import Judgement, Verdict, decisive, print_verdicts
from tests.runs.summaries import (
    FIRST_CONTACT,
    PEAKS,
    curves,
    members,
    paper,
    printed,
    rubbing,
    steps_for_peaks,
    stratifying,
    swing,
    verdict,
    verdicts,
)

TIME = np.arange(10_001) / 1000
Tips = dict[str, np.ndarray]
Motions = dict[str, dict[str, np.ndarray]]


def parted(start: float) -> Motions:
    """Return motions of which two series are 1e-3 of the range apart from a time in s on."""
    motion = curves()
    motion["kantorovich-4"]["tip"] = motion["kantorovich-5"]["tip"].copy()
    motion["kantorovich-4"]["tip"][round(1000 * start) :] += 1.71e-4
    return motion


def headed(scale: float, added: float = 0.0) -> Motions:
    """Return motions whose heads differ by 0.3 of the tips' differences, times the scale."""
    motion = curves()
    common = motion["kantorovich-5"]["head"]
    for both in motion.values():
        head = common + scale * (both["head"] - common)
        both["head"] = head + added * motion["kantorovich-5"]["tip"]
    return motion


def stepped(series: int, elements: int) -> dict[str, dict[str, Any]]:
    needed = {"kantorovich-4": 400, "kantorovich-5": series, "beam-fe": elements}
    return {name: {"steps_for_peaks": steps_for_peaks(steps)} for name, steps in needed.items()}


def lengthened() -> Case:
    """Return the paper's case with a third segment."""
    case = paper()
    third = case.segments[1].model_copy(update={"name": "third", "span": (18.0, 28.0)})
    return case.model_copy(update={"segments": (*case.segments, third)})


def linear() -> Case:
    """Return the paper's case with another contact law in one model more."""
    case = paper()
    law = ContactTable(stiffness=1.0e10, exponent=1.0)
    model = case.models[1].model_copy(update={"name": "linear", "contact": law})
    return case.model_copy(update={"models": (*case.models, model)})


def beside(height: float) -> Motions:
    return curves() | {"linear": {"tip": swing(height), "head": swing(0.01)}}


EIGHT = {name: {"modes": 8} for name in PEAKS}


@pytest.mark.parametrize(
    ("key", "given", "expected", "measured"),
    [
        # Up to the first contact two series are one curve.
        ("S1", {"motion": parted(FIRST_CONTACT + 0.01)}, "reproduced", 0.0),
        ("S1", {"motion": parted(0.05)}, "contradicted", 1e-3),
        # The first peak of a shell rises by 1 % over that of beams.
        ("S4", {"motion": curves(shell=0.186)}, "reproduced", 100.0 * 0.002 / 0.184),
        ("S4", {"motion": curves(shell=0.1835)}, "undecided", -100.0 * 0.0005 / 0.184),
        ("S4", {"motion": curves(shell=0.180)}, "contradicted", -100.0 * 0.004 / 0.184),
        # The lowest peak with play is twice that without.
        ("S5", {"motion": curves(beam_fe_bonded=0.019)}, "reproduced", 0.169 / 0.019),
        ("S5", {"motion": curves(beam_fe_bonded=0.0845)}, "undecided", 2.0),
        ("S5", {"motion": curves(beam_fe_bonded=0.150)}, "contradicted", 0.169 / 0.150),
        # Heads and tips have one level, and greater relative differences at the heads.
        ("S6", {"motion": headed(1.0)}, "reproduced", 1.0 / 0.3),
        ("S6", {"motion": headed(0.3)}, "contradicted", 1.0 / 0.09),
        ("S6", {"motion": headed(40.0)}, "contradicted", 1.0 / 12.0),
        ("S6", {"motion": headed(0.68)}, "undecided", 1.0 / 0.204),
        ("S6", {"motion": headed(1.0, 0.9)}, "contradicted", 1.0 / 0.3),
        # Two contact laws give the same peaks.
        ("S9", {"motion": beside(0.172), "case": linear()}, "reproduced", 100.0 * 0.001 / 0.172),
        ("S9", {"motion": beside(0.190), "case": linear()}, "contradicted", 100.0 * 0.019 / 0.19),
        # Steps for the peaks; one sample of the motion may need twice the steps of another one.
        ("S10", {"summary": stepped(500, 12000)}, "reproduced", 500),
        ("S10", {"summary": stepped(7000, 12000)}, "contradicted", 7000),
        ("S10", {"summary": stepped(500, 1000)}, "contradicted", 500),
        ("S10", {"summary": stepped(1900, 12000)}, "undecided", 1900),
        ("S10", {"summary": stepped(500, 9000)}, "undecided", 500),
        ("S10", {"summary": stepped(500, 3000)}, "undecided", 500),
        # The longest series has the peak of elements.
        ("S11", {"motion": curves(kantorovich_5=0.171), "summary": EIGHT, "case": lengthened()},
         "reproduced", 100.0 * 0.013 / 0.184),
        ("S11", {"motion": curves(kantorovich_5=0.120), "summary": EIGHT, "case": lengthened()},
         "contradicted", 100.0 * 0.064 / 0.184),
    ],
)  # fmt: skip
def test_a_rule_decides_by_its_number(
    key: str, given: dict[str, Any], expected: str, measured: float
) -> None:
    """Reference: by hand, from the heights of curves, and by construction."""
    assert verdict(key, **given)[:2] == (expected, pytest.approx(measured, rel=1e-2, abs=1e-3))


@pytest.mark.parametrize(("duration", "expected"), [(10.0, "contradicted"), (7.0, "undecided")])
def test_s8_asks_how_long_elements_last(duration: float, expected: str) -> None:
    """Reference: by construction."""
    assert verdict("S8", curves(duration), case=rubbing(paper()))[0] == expected


@pytest.mark.parametrize(
    ("share", "expected"), [(1.0, "reproduced"), (0.5, "undecided"), (0.0, "contradicted")]
)
def test_s2_asks_for_the_mean_of_the_members(share: float, expected: str) -> None:
    """Reference: analytic. Some members differ by 0.3 of the range, the others by 0.1."""
    five = np.tile(curves()["kantorovich-5"]["tip"], (32, 1))
    four = five.copy()
    four[:, 4950] = 0.0  # far apart, and too early to count
    four[:, 9500] -= 0.1 * 0.171
    four[: round(share * 32), 9500] -= 0.2 * 0.171
    tips = stratifying(0.0) | {"kantorovich-4": four, "kantorovich-5": five}
    found, measured, why = verdict("S2", tips=tips)
    assert (found, measured) == (expected, pytest.approx(0.1 + 0.2 * share, rel=1e-3))
    # 0.1 / √31 for halves, times Student's over the normal distribution's quantile, 3.2603 / 3.
    error = "0.020" if share == 0.5 else "0.000"
    assert f"of 32 members, with a standard error of {error}; from " in why


ALL = slice(None)
CALM, PARTING = stratifying(0.0, count=12), stratifying(0.3, count=12)
DELAYED = stratifying(0.3, 0.2)["shell"]
HALF = np.concatenate([DELAYED[:6], PARTING["shell"][:6]])


@pytest.mark.parametrize(
    ("tips", "change", "expected", "measured", "told"),
    [
        (PARTING, ("", 5, 5.5, 0.0), "reproduced", 1.0,
         "100 % of 11 have peaks further apart later"),
        # One model without peaks that the others have parts from them, before and after.
        (CALM, ("shell", ALL, 4.0, 0.0), "contradicted", 0.0,
         "100 % of 12 have peaks further apart later"),
        (PARTING, ("shell", ALL, -1.0, 1.5), "contradicted", 0.0, ""),
        # Half of the members conform: chance, at 12 of them, and so no verdict.
        (PARTING | {"shell": HALF}, None, "undecided", 0.5, ""),
        # If half of the runs have a property, three members may all.
        (stratifying(0.5, count=3), None, "undecided", 1.0, ""),
        (CALM, ("", ALL, -1.0, 0.0), "undecided", None, "No member has a peak within 6 s."),
        (CALM, ("", ALL, 5.5, 0.0), "undecided", None, "No member has a peak after 6 s."),
        # The period is 1.1 s; the last of four models has 3 times the delay.
        (stratifying(0.3, 0.02, 12), None, "reproduced", 1.0, "first such peak is at 6."),
        (CALM, None, "contradicted", 1.0, "In most members no peaks are further apart"),
        (stratifying(0.3, 0.2, 12), None, "contradicted", 0.0, "first such peak is at 0.6 "),
    ],
)  # fmt: skip
def test_s3_counts_members_with_peaks_further_apart_after_six_seconds(
    tips: Tips,
    change: tuple[str, Any, float, float] | None,
    expected: str,
    measured: float | None,
    told: str,
) -> None:
    """Reference: analytic, by construction. A change is that of a model, or all, from a time on."""
    tips = {name: own.copy() for name, own in tips.items()}
    if change is not None:
        model, some, start, factor = change
        for name in [model] if model else tips:
            tips[name][some, start < TIME] *= factor
    *found, why = verdict("S3", tips=tips)
    assert found == [expected, measured]
    assert told in why


@pytest.mark.parametrize(
    ("apart", "expected"), [(7, "reproduced"), (8, "undecided"), (25, "contradicted")]
)
def test_three_standard_errors_decide(apart: int, expected: str) -> None:
    """Reference: analytic. The standard error of a share of one half of 32 members is 0.088."""
    tips = stratifying(0.3)
    tips["shell"][:apart] = DELAYED[:apart]
    found = verdicts(paper(), curves(), ensembles=members(tips))["S3"]
    distance = abs(0.5 - apart / 32) / (0.5 / np.sqrt(32))
    assert (found.verdict, found.distance) == (expected, pytest.approx(distance))
    assert (distance >= 3.0) == (expected != "undecided")


def conforming(late: float) -> Motions:
    """Return models with differences by height, ``late`` times as much more after 6 s."""
    motion = curves()
    for name, both in motion.items():
        if name != "beam-fe-bonded":
            ratio = PEAKS[name] / 0.171 - 1.0
            apart = ratio * (1.0 + late * (TIME > 6.0)) * swing(0.171)
            both["tip"] = swing(0.171) + apart
            both["head"] = 0.1 * swing(0.171) + 0.5 * apart
    return motion


@pytest.mark.parametrize(
    "fault", ["", "no stratification", "apart at once", "play-free too", "head"]
)
def test_s7_looks_at_the_whole_length(fault: str) -> None:
    """Reference: by hand."""
    motion = conforming(-0.5 if fault == "no stratification" else 0.5)
    if fault == "apart at once":
        motion["shell"]["tip"] = 1.5 * motion["shell"]["tip"]
    if fault == "play-free too":
        motion["beam-fe-bonded"]["tip"] = motion["beam-fe"]["tip"].copy()
    if fault == "head":
        for both in motion.values():
            both["head"] = 0.1 * swing(0.171)
    found, measured, _ = verdict("S7", motion, case=rubbing(paper()))
    assert found == ("contradicted" if fault else "reproduced")
    assert fault or measured == pytest.approx(0.017 / 0.1935, rel=1e-3)


NO_CONTACT = {name: {"first_contact": None} for name in ("kantorovich-4", "kantorovich-5")}
NO_ENSEMBLE = {"kantorovich-5": {"ensemble": None}}
SAMPLE = "One run is a sample of a chaotic motion; it takes [ensemble]."
RUBS = "This case has no friction; it takes the case with friction."


def without(case: Case, model: str) -> Case:
    return case_file.select(case, "", [m.name for m in case.models if m.name != model])


@pytest.mark.parametrize(
    ("key", "given", "why"),
    [
        ("S1", {"summary": NO_CONTACT}, "'kantorovich-4' has no first contact."),
        ("S2", {}, SAMPLE),
        ("S2", {"motion": curves(duration=5.0)}, "The run ends at 5 s; it takes 7 s."),
        ("S3", {}, SAMPLE),
        ("S3", {"motion": curves(duration=5.0)}, "The run ends at 5 s; it takes 6 s."),
        ("S3", {"summary": NO_ENSEMBLE, "tips": stratifying(0.3, count=2)},
         "'kantorovich-5' has no ensemble."),
        ("S4", {"summary": {"kantorovich-5": {"first_peak": {"tip": [None, None]}}}},
         "'kantorovich-5' has no first peak."),
        ("S7", {}, RUBS),
        ("S8", {}, RUBS),
        ("S9", {}, "No two models of the case differ in the contact law alone."),
        ("S10", {}, "'kantorovich-4' has no steps for peaks."),
        ("S11", {}, "This case has 2 segments; it takes the case of three segments."),
        *((key, {"case": without(paper(), name)}, f"The case has no model like {name!r}.")
          for name, keys in (("kantorovich-4", ["S1", "S2", "S4", "S10"]), ("shell", ["S4"]),
                             ("beam-fe", ["S4"]), ("beam-fe-bonded", ["S5"])) for key in keys),
    ],
)  # fmt: skip
def test_rule_names_its_missing_data(key: str, given: dict[str, Any], why: str) -> None:
    assert verdict(key, **given) == ("undecided", None, why)


def test_models_are_found_by_their_properties() -> None:
    """Reference: the same curves under other names, and a series of another base."""
    case, motion = paper(), curves()
    motion["kantorovich-5"]["tip"][7000] = np.nan
    expected = verdicts(case, motion)
    assert list(expected) == list(STATEMENTS) == [f"S{i}" for i in range(1, 12)]
    assert expected["S1"].why == "The tip of 'kantorovich-5' is not finite."
    models = tuple(m.model_copy(update={"name": f"model {i}"}) for i, m in enumerate(case.models))
    names = dict(zip([m.name for m in case.models], [m.name for m in models], strict=True))
    renamed = {names[name]: both for name, both in motion.items()}
    found = verdicts(case.model_copy(update={"models": models}), renamed)
    assert [(v.verdict, v.measured) for v in found.values()] == [
        (v.verdict, v.measured) for v in expected.values()
    ]
    four, five, *others = case.models
    pinned = five.model_copy(update={"base": "pinned"})
    why = "The case has no model like 'kantorovich-5'."
    changed = case.model_copy(update={"models": (four, pinned, *others)})
    assert verdict("S2", case=changed) == ("undecided", None, why)


UNIT = "of the members"


def judged(case: str, **judgements: Judgement) -> list[Verdict]:
    """Return verdicts; those that are not given are undecided."""
    return [
        Verdict(key, statement, 1.23e-20, 1e-6, UNIT, judgements.get(key, "undecided"), case)
        for key, statement in STATEMENTS.items()
    ]


def test_each_verdict_is_a_line_of_a_terminal() -> None:
    """Reference: by construction, of the first decisive run; lines of 80 characters at most."""
    runs = {
        "paper": judged("paper", S1="reproduced", S3="contradicted"),
        "paper-friction": judged("paper-friction", S3="reproduced", S7="contradicted"),
    }
    assert {v.id: (name, v.verdict) for name, v in decisive(runs) if v.verdict != "undecided"} == {
        "S1": ("paper", "reproduced"),
        "S3": ("paper", "contradicted"),
        "S7": ("paper-friction", "contradicted"),
    }
    lines = printed(print_verdicts, runs, width=80).splitlines()
    rows = [line for line in lines if line.rstrip().endswith(UNIT)]
    marks = ["✓" if key == "S1" else "✗" if key in ("S3", "S7") else "?" for key in STATEMENTS]
    assert [row.split()[:2] for row in rows] == [
        [*pair] for pair in zip(marks, STATEMENTS, strict=True)
    ]
    assert max(map(len, lines)) <= 80
    assert "S7 in paper-friction." in " ".join(lines)
