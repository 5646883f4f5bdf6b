# SPDX-License-Identifier: LGPL-3.0-or-later
"""Interpretations of the paper become cases; verdicts and their distances from thresholds."""

from collections.abc import Mapping
from dataclasses import replace

import pytest

from protractile.dynamics.contact import PowerContact
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.kantorovich import Kantorovich
from protractile.runs.case.schema import Case
from protractile.runs.paper.verdicts import Judgement, Verdict
from studies import interpretations, verdicts
from studies.interpretations import (
    ALL,
    COMMON,
    JUDGED,
    MODELS,
    PAPER,
    Finding,
    Interpretation,
    JudgedInterpretation,
    conclude,
    finding_table,
    judge_exponents,
    survey,
)
from tests.touching import contact_laws

LITERAL = Interpretation(0.014, "literal", "as printed", 2.0)
RESTORED = replace(LITERAL, stiffness="restored")


@pytest.fixture
def paper() -> Case:
    return case_file.load(str(PAPER))


def judged(one: Interpretation, peak: float = 0.17, **verdicts: Judgement) -> JudgedInterpretation:
    """Return an interpretation with verdicts, by default reproduced, and a peak height in m."""
    findings: Mapping[str, Finding] = {
        key: Finding(verdicts.get(key, "reproduced"), ()) for key in JUDGED
    }
    return JudgedInterpretation(one, findings, dict.fromkeys(MODELS, peak), 0.0)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
def test_restored_laws_have_equal_stiffness_at_pad_forces(exponent: float) -> None:
    """Reference: 1e9 N/m, the quadratic law's slope 2 √(1e13 · 25e3) by hand, to 1e-6."""
    stiffness = replace(RESTORED, exponent=exponent).contact_stiffness
    law = PowerContact(stiffness, exponent)
    depth = (2.5e4 / stiffness) ** (1.0 / exponent)
    assert float(law.force(depth)) == pytest.approx(2.5e4)
    slope = (law.force(depth * 1.001) - law.force(depth * 0.999)) / (0.002 * depth)
    assert float(slope) == pytest.approx(1.0e9, rel=1e-6)


def test_all_combinations_occur_once() -> None:
    """Reference: 2 plays, 2 stiffnesses, 3 bases, 3 exponents; the literal stiffness by hand."""
    assert len(set(ALL)) == len(ALL) == 36
    for one in ALL:
        assert (one.contact_stiffness == 1.01e6) == (one.stiffness == "literal")


def test_every_model_of_the_case_has_the_interpretation(paper: Case) -> None:
    case = Interpretation(0.028, "literal", "pinned", 1.5).case(paper, 0.5)
    assert [model.name for model in case.models] == list(MODELS)
    for model in case.models:
        (law,) = contact_laws(case, model)
        assert law == PowerContact(1.01e6, 1.5).with_clearance(0.014)
        assert not isinstance(model, Kantorovich) or model.base == "pinned"
    assert [one.load for one in build_boom(case).segments] == [1.5 * 83.16, 1.5 * 55.07]


def test_contradicted_statements_exclude_and_undecided_ones_do_not() -> None:
    """Reference: by hand."""
    verdicts = [
        judged(LITERAL, S2="contradicted", S9="contradicted"),
        judged(RESTORED, S4="undecided"),
    ]
    assert [entry.excluded_by for entry in verdicts] == [["S2", "S9"], []]
    assert conclude(verdicts) == [
        "1 of 2 interpretations are excluded.",
        "stiffness literal: all excluded, by S2 1 times, S9 1 times.",
        "stiffness restored: none excluded.",
    ]
    pinned = [judged(replace(one, base="pinned")) for one in (LITERAL, RESTORED)]
    assert "stiffness literal: 1 of 2 excluded, by S2 1 times, S9 1 times." in conclude(
        [*verdicts, *pinned]
    )


@pytest.mark.parametrize(
    ("peak", "verdict"), [(0.171, "reproduced"), (0.1785, "undecided"), (0.34, "contradicted")]
)
def test_exponents_are_compared_within_their_group(peak: float, verdict: str) -> None:
    """Reference: peaks 0.6 %, 5.0 % and 100 % apart by hand, against 5 % ± 0.5 %."""
    group = [judged(RESTORED), judged(replace(RESTORED, exponent=1.0), peak)]
    *both, other = judge_exponents([*group, judged(LITERAL, 1.7)])
    for entry in both:
        assert entry.findings["S9"].verdict == verdict
        assert entry.findings["S9"].measured == pytest.approx([peak / 0.17 - 1.0])
    assert other.findings["S9"] == Finding("undecided", ())


@pytest.mark.slow
def test_a_survey_of_two_interpretations(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: non-regression: n = 1 and n = 2 differ by more than half in first peaks.

    The energy shows that four times the study's step, which takes a third of the time, suffices.
    """
    monkeypatch.setattr(interpretations, "LITERAL_STEP", 4.0 * interpretations.LITERAL_STEP)
    found = survey([replace(LITERAL, exponent=exponent) for exponent in (1.0, 2.0)], members=2)
    for entry in found:
        assert sorted(entry.findings) == sorted(JUDGED)
        assert set(COMMON) < set(entry.findings)
        assert {"S2", "S9"} <= set(entry.excluded_by)
        assert entry.findings["S9"].measured[0] > 0.5
        assert max(entry.findings["S2"].measured) < 0.15
        assert entry.energy_residual < 1e-2
    rows = finding_table(found).rows
    assert [row[0] for row in rows] == [f"14, literal, as printed, {n}" for n in (1, 2)]
    assert all(row[3].startswith("✗ ") for row in rows)


def test_distances_of_all_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: by hand. The second sample is 0.1 higher, and nearer to its threshold."""

    def judged(case: str, change: float) -> list[Verdict]:
        late = change > 0.0
        distance = 4.0 - late
        return [
            Verdict("S2", case, 0.4 + 0.1 * late, 0.2, "", "reproduced", "", distance),
            Verdict("S8", case, 10.0, 7.0, "s", "contradicted", ""),
        ]

    monkeypatch.setattr(verdicts, "verdicts_on", judged)
    monkeypatch.setattr(verdicts, "CHANGES", (0.0, 1.0e-12))
    (table,) = verdicts.study(lambda what: None).tables
    assert [row[0] for row in table.rows] == [case for case in verdicts.JUDGED for _ in range(2)]
    assert table.rows[0][2:] == ("reproduced", "0.4", "0.2", "", "4.0", "3.0", "0.071")
    assert table.rows[1][2:] == ("contradicted", "10", "7", "s", "–", "–", "0")


def test_a_change_of_the_modulus_reaches_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: analytic."""
    cases = []
    monkeypatch.setattr(verdicts, "run_case", cases.append)
    monkeypatch.setattr(verdicts, "judge", lambda results: [])
    assert verdicts.verdicts_on("paper", 1.0e-12) == []
    assert cases[0].material.youngs_modulus == pytest.approx(2.1e11 * (1.0 + 1e-12), rel=1e-15)
