# SPDX-License-Identifier: LGPL-3.0-or-later
"""Verdicts on the statements of the paper, and their tables in the terminal."""

import json
import re
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import pytest
import xarray as xr

from protractile.beam_model.kantorovich import kantorovich_segments
from protractile.beam_model.segment_model import gap_system
from protractile.cases import run_case
from protractile.dynamics.integrator import AdaptiveStep
from protractile.dynamics.motion import Motion
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.contact import ContactTable
from protractile.runs.case.schema import Case
from protractile.runs.paper.decision import Excess, decide
from protractile.runs.paper.rules import PEAK_SCATTER, judge
from protractile.runs.paper.statements import STATEMENTS
from protractile.runs.paper.verdicts import Judgement, Verdict, decisive, print_verdicts
from protractile.runs.pipeline.results import Results
from protractile.runs.report.terminal_tables import print_models
from tests.runs.case_texts import shipped
from tests.runs.summaries import (
    FIRST_CONTACT,
    PEAKS,
    curves,
    members,
    model_summary,
    paper,
    printed,
    rubbing,
    steps_for_peaks,
    stratifying,
    summary_of,
    swing,
    verdict,
    verdicts,
)
from tests.touching import contact_laws, touching

TIME = np.arange(10_001) / 1000
Tips = dict[str, np.ndarray]


@pytest.fixture
def case() -> Case:
    return paper()


def test_judges_every_statement_once_and_in_json(case: Case) -> None:
    found = verdicts(case, curves())
    assert list(found) == list(STATEMENTS) == [f"S{i}" for i in range(1, 12)]
    json.dumps([asdict(verdict) for verdict in found.values()], allow_nan=False)


def test_s1_holds_for_the_series_themselves(case: Case) -> None:
    """Reference: analytic. Without contact the inner segment moves as a rigid body."""
    short = case.model_copy(update={"time": case.time.model_copy(update={"duration": 0.2})})
    found = judge(run_case(short, ["kantorovich-4", "kantorovich-5"]))[0]
    assert found.verdict == "reproduced"
    assert found.measured < 1.0e-12


@pytest.mark.parametrize(
    ("start", "expected", "part"),
    [(FIRST_CONTACT + 0.01, "reproduced", 0.0), (0.05, "contradicted", 1e-3)],
)
def test_s1_looks_up_to_the_first_contact(start: float, expected: str, part: float) -> None:
    motion = curves()
    motion["kantorovich-4"]["tip"] = motion["kantorovich-5"]["tip"].copy()
    motion["kantorovich-4"]["tip"][round(1000 * start) :] += 1.71e-4
    assert verdict("S1", motion)[:2] == (expected, pytest.approx(part, rel=1e-6))


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


def without_late_peaks(tips: Tips) -> None:
    for model in tips:
        tips[model][5, TIME > 5.5] = 0.0


def stopping(tips: Tips) -> None:
    tips["shell"][:, TIME > 4.0] = 0.0


def higher(tips: Tips) -> None:
    tips["shell"] = 1.5 * tips["shell"]


def half_apart(tips: Tips) -> None:
    tips["shell"][:16] = stratifying(0.3, 0.2)["shell"][:16]


@pytest.mark.parametrize(
    ("drift", "changed", "expected", "measured", "told"),
    [
        (0.3, without_late_peaks, "reproduced", 1.0, "100 % of 31 have peaks further apart later"),
        # One model without peaks that the others have parts from them, before and after.
        (0.0, stopping, "contradicted", 0.0, "100 % of 32 have peaks further apart later"),
        (0.3, higher, "contradicted", 0.0, ""),
        # Half of the members conform: chance, at 32 of them, and so no verdict.
        (0.3, half_apart, "undecided", 0.5, ""),
    ],
)
def test_s3_counts_members(
    drift: float, changed: Callable[[Tips], None], expected: str, measured: float, told: str
) -> None:
    tips = stratifying(drift)
    changed(tips)
    found = verdict("S3", tips=tips)
    assert found[:2] == (expected, measured)
    assert told in found[2]


@pytest.mark.parametrize(("still", "when"), [(slice(None), "within"), (slice(5500, None), "after")])
def test_s3_needs_peaks(still: slice, when: str) -> None:
    tips = stratifying(0.0)
    for model in tips:
        tips[model][:, still] = 1.0e-6 * np.arange(10_001)[still]
    assert verdict("S3", tips=tips)[::2] == ("undecided", f"No member has a peak {when} 6 s.")


@pytest.mark.parametrize(
    ("apart", "expected"),
    [(7, "reproduced"), (8, "undecided"), (24, "undecided"), (25, "contradicted")],
)
def test_three_standard_errors_decide(apart: int, expected: str) -> None:
    """Reference: analytic. The standard error of a share of one half of 32 members is 0.088."""
    tips = stratifying(0.3)
    tips["shell"][:apart] = stratifying(0.3, 0.2)["shell"][:apart]
    found = verdicts(paper(), curves(), ensembles=members(tips))["S3"]
    distance = abs(0.5 - apart / 32) / (0.5 / np.sqrt(32))
    assert (found.verdict, found.distance) == (expected, pytest.approx(distance))
    assert (distance >= 3.0) == (expected != "undecided")


def test_exact_numbers_have_no_standard_errors() -> None:
    """Reference: analytic. The lowest excess decides; exact numbers decide at any excess."""
    assert decide(Excess(1.0, 1.0 - 1e-12)) == ("reproduced", None)
    assert decide(Excess(1.0, 1.0)) == ("undecided", 0.0)
    assert decide(Excess(2.0, 1.0), Excess(0.4, 0.1, 0.1)) == ("reproduced", pytest.approx(3.0))
    assert decide(Excess(0.4, 0.1, 0.11), Excess(0.1, 0.6, 0.1)) == (
        "contradicted", pytest.approx(5.0),
    )  # fmt: skip
    assert decide(Excess(0.4, 0.1, 0.11)) == ("undecided", pytest.approx(0.3 / 0.11))


def test_few_members_decide_nothing() -> None:
    """Reference: analytic. If half of the runs have a property, three members may all."""
    assert verdict("S3", tips=stratifying(0.5, count=3))[:2] == ("undecided", 1.0)


@pytest.mark.parametrize(
    ("early", "drift", "conforming", "expected"),
    [
        (0.0, 0.3, 1.0, "reproduced"),
        (0.02, 0.3, 1.0, "reproduced"),
        (0.0, 0.0, 1.0, "contradicted"),  # no stratification
        (0.2, 0.3, 0.0, "contradicted"),  # shifted peaks from the start
    ],
)
def test_s3_needs_diverging_peaks_after_six_seconds(
    early: float, drift: float, conforming: float, expected: str
) -> None:
    """Reference: analytic. The period is 1.1 s; the last of four models has 3 times the delay."""
    *found, why = verdict("S3", tips=stratifying(drift, early))
    assert found == [expected, conforming]
    assert "part by 20 % of the range from 3.2 s on" in why
    if drift == 0.0:
        assert "In most members no peaks are further apart." in why
    else:
        # The first of all peaks, or the first or second after the sixth second.
        first = float(why.split("first such peak is at ")[1].split()[0])
        assert first == 0.6 if early == 0.2 else 6.0 <= first <= 7.2


@pytest.mark.parametrize(
    ("key", "height", "expected"),
    [
        ("S4", 0.186, "reproduced"), ("S4", 0.1835, "undecided"), ("S4", 0.1845, "undecided"),
        ("S4", 0.180, "contradicted"), ("S5", 0.019, "reproduced"), ("S5", 0.0845, "undecided"),
        ("S5", 0.150, "contradicted"),
    ],
)  # fmt: skip
def test_s4_asks_for_a_rise_s5_for_twice_the_play_free_peak(
    key: str, height: float, expected: str
) -> None:
    motion = curves(**{"shell" if key == "S4" else "beam_fe_bonded": height})
    part = 100.0 * (height / 0.184 - 1.0) if key == "S4" else 0.169 / height
    assert verdict(key, motion)[:2] == (expected, pytest.approx(part, rel=1e-3, abs=1e-3))


def test_s4_knows_how_far_a_first_peak_can_be_trusted(case: Case) -> None:
    """Reference: non-regression, of the five-term series under a load changed by 1e-4."""
    boom = build_boom(case)
    segments = kantorovich_segments(boom, (2, 3), "as printed", False)
    system = gap_system(touching(boom, contact_laws(case, case.models[1])), segments)
    loads = [system.load * (1.0 + change) for change in (0.0, 1.0e-4, -1.0e-4)]
    motions = [AdaptiveStep()(Motion(replace(system, load=load), 0.7)) for load in loads]
    peaks = np.array([motion.first_peak()[1] for motion in motions])
    scatter = np.abs(peaks[1:] / peaks[0] - 1.0).max()
    # Far more than the change itself, which is chaos, and not more than the rule allows for.
    assert 1.0e-3 < scatter < 1.05 * PEAK_SCATTER


@pytest.mark.parametrize(
    ("head_scale", "expected"),
    [(1.0, "reproduced"), (0.3, "contradicted"), (40.0, "contradicted"), (0.68, "undecided")],
)
def test_s6_asks_for_one_absolute_level(head_scale: float, expected: str) -> None:
    """Reference: analytic. Head differences are 0.3 of the tip's, times the scale."""
    motion = curves()
    common = motion["kantorovich-5"]["head"]
    for both in motion.values():
        both["head"] = common + head_scale * (both["head"] - common)
    ratio = pytest.approx(1.0 / (0.3 * head_scale), rel=1e-3)
    assert verdict("S6", motion)[:2] == (expected, ratio)


def test_s6_asks_for_greater_relative_differences() -> None:
    motion = curves()
    for both in motion.values():
        both["head"] = both["head"] + 0.9 * motion["kantorovich-5"]["tip"]
    assert verdict("S6", motion)[:2] == ("contradicted", pytest.approx(1.0 / 0.3, rel=1e-3))


def conforming(late: float) -> dict[str, dict[str, np.ndarray]]:
    """Return models with differences by height, ``late`` times as much more after 6 s."""
    motion = curves()
    for name, both in motion.items():
        if name != "beam-fe-bonded":
            ratio = PEAKS[name] / 0.171 - 1.0
            apart = ratio * (1.0 + late * (TIME > 6.0)) * swing(0.171)
            both["tip"] = swing(0.171) + apart
            both["head"] = 0.1 * swing(0.171) + 0.5 * apart
    return motion


def test_s7_looks_at_the_whole_length() -> None:
    part = pytest.approx(0.017 / 0.1935, rel=1e-3)
    assert verdict("S7", conforming(0.5), case=rubbing(paper()))[:2] == ("reproduced", part)


@pytest.mark.parametrize("fault", ["no stratification", "apart at once", "play-free too", "head"])
def test_s7_is_turned_by_each_of_its_parts(fault: str) -> None:
    motion = conforming(-0.5 if fault == "no stratification" else 0.5)
    if fault == "apart at once":
        motion["shell"]["tip"] = 1.5 * motion["shell"]["tip"]
    if fault == "play-free too":
        motion["beam-fe-bonded"]["tip"] = motion["beam-fe"]["tip"].copy()
    if fault == "head":
        for both in motion.values():
            both["head"] = 0.1 * swing(0.171)
    assert verdict("S7", motion, case=rubbing(paper()))[0] == "contradicted"


@pytest.mark.parametrize(
    ("duration", "expected", "told"),
    [
        (10.0, "contradicted", "energy residual of 1.0e-04"),
        (7.0, "undecided", ""),
        (5.0, "undecided", ""),
    ],
)
def test_s8_asks_how_long_elements_last(duration: float, expected: str, told: str) -> None:
    found, _, why = verdict("S8", curves(duration), case=rubbing(paper()))
    assert found == expected
    assert told in why


@pytest.mark.parametrize(("height", "expected"), [(0.172, "reproduced"), (0.190, "contradicted")])
def test_s9_compares_contact_laws(case: Case, height: float, expected: str) -> None:
    law = ContactTable(stiffness=1.0e10, exponent=1.0)
    linear = case.models[1].model_copy(update={"name": "linear", "contact": law})
    case = case.model_copy(update={"models": (*case.models, linear)})
    motion = curves() | {"linear": {"tip": swing(height), "head": swing(0.01)}}
    apart = pytest.approx(100.0 * abs(0.171 / height - 1.0), rel=1e-2)
    assert verdict("S9", motion, case=case)[:2] == (expected, apart)


@pytest.mark.parametrize(
    ("series", "elements", "expected"),
    [
        (500, 12000, "reproduced"),
        (7000, 12000, "contradicted"),
        (500, 1000, "contradicted"),
        # One sample of the motion may need twice the steps of another one.
        (1900, 12000, "undecided"),
        (500, 9000, "undecided"),
        (500, 3000, "undecided"),
    ],
)
def test_s10_counts_the_steps_for_the_peaks(series: int, elements: int, expected: str) -> None:
    needed = {"kantorovich-4": 400, "kantorovich-5": series, "beam-fe": elements}
    summary = {name: {"steps_for_peaks": steps_for_peaks(steps)} for name, steps in needed.items()}
    assert verdict("S10", summary=summary)[:2] == (expected, series)


@pytest.mark.parametrize(("height", "expected"), [(0.171, "reproduced"), (0.120, "contradicted")])
def test_s11_compares_the_longest_series_with_elements(
    case: Case, height: float, expected: str
) -> None:
    third = case.segments[1].model_copy(update={"name": "third", "span": (18.0, 28.0)})
    case = case.model_copy(update={"segments": (*case.segments, third)})
    modes = {name: {"modes": 8} for name in PEAKS}
    apart = pytest.approx(100.0 * (1.0 - height / PEAKS["beam-fe"]), rel=1e-2)
    found = verdict("S11", curves(kantorovich_5=height), modes, case=case)
    assert found[:2] == (expected, apart)


NO_CONTACT = {name: {"first_contact": None} for name in ("kantorovich-4", "kantorovich-5")}
NO_ENSEMBLE = {"kantorovich-5": {"ensemble": None}}
SAMPLE = "One run is a sample of a chaotic motion; it takes [ensemble]."
RUBS = "This case has no friction; it takes the case with friction."


@pytest.mark.parametrize(
    ("key", "given", "why"),
    [
        ("S1", {"summary": NO_CONTACT}, "'kantorovich-4' has no first contact."),
        ("S2", {}, SAMPLE),
        ("S2", {"motion": curves(duration=5.0)}, "The run ends at 5 s; it takes 7 s."),
        ("S3", {}, SAMPLE),
        ("S3", {"motion": curves(duration=5.0)}, "The run ends at 5 s; it takes 6 s."),
        ("S3", {"summary": NO_ENSEMBLE, "tips": stratifying(0.3)},
         "'kantorovich-5' has no ensemble."),
        ("S7", {}, RUBS),
        ("S8", {}, RUBS),
        ("S9", {}, "No two models of the case differ in the contact law alone."),
        ("S10", {}, "'kantorovich-4' has no steps for peaks."),
        ("S11", {}, "This case has 2 segments; it takes the case of three segments."),
    ],
)  # fmt: skip
def test_rule_names_its_missing_data(key: str, given: dict[str, Any], why: str) -> None:
    assert verdict(key, **given) == ("undecided", None, why)


def test_models_are_found_by_their_properties(case: Case) -> None:
    """Reference: the same curves under the names of the paper's case."""
    expected = verdicts(case, curves())
    models = tuple(m.model_copy(update={"name": f"model {i}"}) for i, m in enumerate(case.models))
    names = dict(zip([m.name for m in case.models], [m.name for m in models], strict=True))
    renamed = {names[name]: both for name, both in curves().items()}
    found = verdicts(case.model_copy(update={"models": models}), renamed)
    assert [(v.verdict, v.measured) for v in found.values()] == [
        (v.verdict, v.measured) for v in expected.values()
    ]


def test_compares_series_of_one_base(case: Case) -> None:
    four, five, *others = case.models
    pinned = five.model_copy(update={"base": "pinned"})
    case = case.model_copy(update={"models": (four, pinned, *others)})
    why = "The case has no model like 'kantorovich-5'."
    assert verdict("S2", case=case) == ("undecided", None, why)


@pytest.mark.parametrize(
    ("model", "statements"),
    [
        ("kantorovich-4", ["S1", "S2", "S4", "S10"]),
        ("shell", ["S4"]),
        ("beam-fe", ["S4"]),
        ("beam-fe-bonded", ["S5"]),
    ],
)
def test_missing_model_is_named(case: Case, model: str, statements: list[str]) -> None:
    motion = {name: both for name, both in curves().items() if name != model}
    fewer = case_file.select(case, "", [m.name for m in case.models if m.name != model])
    why = f"The case has no model like {model!r}."
    for statement in statements:
        assert verdict(statement, motion, case=fewer) == ("undecided", None, why)


def test_motion_that_is_not_finite_is_named(case: Case) -> None:
    motion = curves()
    motion["kantorovich-5"]["tip"][7000] = np.nan
    found = verdicts(case, motion, {"kantorovich-5": {"first_peak": {"tip": [None, None]}}})
    for statements, why in (
        (("S1", "S2", "S3"), "The tip of 'kantorovich-5' is not finite."),
        (("S4", "S5", "S6"), "'kantorovich-5' has no first peak."),
    ):
        for one in statements:
            assert (found[one].verdict, found[one].why) == ("undecided", why)


def judged(case: str, **judgements: Judgement) -> list[Verdict]:
    """Return verdicts; those that are not given are undecided."""
    return [
        Verdict(key, statement, None, None, "", judgements.get(key, "undecided"), case)
        for key, statement in STATEMENTS.items()
    ]


RUNS = {
    "paper": judged("paper", S1="reproduced", S3="contradicted"),
    "paper-friction": judged("paper-friction", S3="reproduced", S7="contradicted"),
}


@pytest.mark.parametrize(
    ("statement", "name", "verdict"),
    [
        ("S1", "paper", "reproduced"),
        ("S3", "paper", "contradicted"),
        ("S7", "paper-friction", "contradicted"),
        ("S8", "paper", "undecided"),
    ],
)
def test_verdict_comes_from_the_first_decisive_run(
    statement: str, name: str, verdict: Judgement
) -> None:
    (found,) = [entry for entry in decisive(RUNS) if entry[1].id == statement]
    assert (found[0], found[1].verdict) == (name, verdict)


def test_each_verdict_is_a_line_of_a_terminal() -> None:
    """Reference: by construction; lines of 80 characters at most, none broken."""
    lines = printed(print_verdicts, RUNS, width=80).splitlines()
    rows = [line for line in lines if re.match(r" S\d", line)]
    assert [row.split()[0] for row in rows] == [*STATEMENTS]
    assert "✓ reproduced" in rows[0]
    assert "✗ contradicted" in rows[6]
    assert "S7 in paper-friction." in " ".join(lines)
    assert " in paper" not in printed(print_verdicts, {"paper": RUNS["paper"]})


def test_a_verdict_shows_number_and_threshold() -> None:
    verdict = Verdict("S4", "It grows.", 1.25, 0.5, "%", "reproduced", "", 7.51, demanded=True)
    (row,) = (
        line
        for line in printed(print_verdicts, {"paper": [verdict]}, width=80).splitlines()
        if " S4 " in line
    )
    assert re.split(r"  +", row.strip()) == [
        "S4", "deflection grows with the model", "✓ reproduced", "1.25 %", "0.5 %",
    ]  # fmt: skip
    assert "Demanded: S4." in printed(print_verdicts, {"paper": [verdict]})
    assert printed(print_verdicts, {"boom": []}) == ""


def test_every_run_shows_the_errors_of_its_reduction() -> None:
    errors = {"contact_compliance": 2.3e-9, "deflections": 8.1e-7, "frequency_limit_in_hz": 84.6}
    shell = model_summary(modes=110, reduction_errors=errors, mesh_error=0.0083)
    case = shipped("paper")
    results = Results(case, xr.Dataset(), summary_of({"shell": shell}))
    assert " ".join(printed(print_models, results).split()).endswith(
        "shell: 110 generalised coordinates. Relative errors of the reduction: local contact "
        "compliance 2 × 10⁻⁹, deflections of tip and segment heads 8 × 10⁻⁷. Mesh error of the "
        "local contact compliance: 0.83 %."
    )
