# SPDX-License-Identifier: LGPL-3.0-or-later
"""Readings become the cases that they say, and what a statement contradicts is excluded."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console

from dynamics.contact import PowerContact
from runs.case import reading as case_file
from runs.case.build import build_boom
from runs.case.kinds.kantorovich import Kantorovich
from runs.case.messages import BadInput
from runs.case.schema import Case
from runs.paper.reading import (
    COMMON,
    JUDGED,
    MODELS,
    Judged,
    Reading,
    ReadingFinding,
    judge_exponents,
)
from runs.paper.readings import PAPER, all_readings, conclude, load, shown, survey
from runs.paper.verdicts import Judgement
from tests.touching import contact_laws

LITERAL = Reading(0.007, "literal", "as printed", 2.0)
RESTORED = Reading(0.007, "restored", "as printed", 2.0)


@pytest.fixture
def paper() -> Case:
    return case_file.load(str(PAPER))


def judged(reading: Reading, peak: float = 0.17, **verdicts: Judgement) -> Judged:
    """Return a reading with given verdicts, by default reproduced, and one peak height in m."""
    findings: Mapping[str, ReadingFinding] = {
        key: ReadingFinding(verdicts.get(key, "reproduced"), ()) for key in JUDGED
    }
    return Judged(reading, findings, dict.fromkeys(MODELS, peak), 0.0)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
def test_restored_laws_are_equally_stiff_where_the_pads_work(exponent: float) -> None:
    """Reference: 1e9 N/m, the quadratic law's slope 2 √(1e13 · 25e3) by hand; the slope here is a
    difference of forces, good to 1e-6.
    """
    stiffness = replace(RESTORED, exponent=exponent).contact_stiffness
    law = PowerContact(stiffness, exponent)
    depth = (2.5e4 / stiffness) ** (1.0 / exponent)
    assert float(law.force(depth)) == pytest.approx(2.5e4)
    slope = (law.force(depth * 1.001) - law.force(depth * 0.999)) / (0.002 * depth)
    assert float(slope) == pytest.approx(1.0e9, rel=1e-6)


def test_a_literal_stiffness_is_literal_for_every_exponent() -> None:
    for reading in all_readings():
        assert (reading.contact_stiffness == 1.01e6) == (reading.stiffness == "literal")


def test_all_combinations_are_read_once() -> None:
    """Reference: 2 clearances, 2 stiffnesses, 3 bases, 3 exponents."""
    assert len(set(all_readings())) == len(all_readings()) == 36


def test_a_reading_is_in_every_model_of_its_case(paper: Case) -> None:
    reading = Reading(0.014, "literal", "pinned", 1.5)
    case = reading.case(paper, 0.5)
    boom = build_boom(case)
    assert [model.name for model in case.models] == list(MODELS)
    for model in case.models:
        (law,) = contact_laws(case, model)
        assert law == PowerContact(1.01e6, 1.5).behind(0.014)
        assert not isinstance(model, Kantorovich) or model.base == "pinned"
    assert [segment.load for segment in boom.segments] == [1.5 * 83.16, 1.5 * 55.07]


def test_what_a_statement_contradicts_is_excluded_by_it() -> None:
    verdicts = [judged(LITERAL, S2="contradicted", S9="contradicted"), judged(RESTORED)]
    assert [entry.excluded_by() for entry in verdicts] == [["S2", "S9"], []]
    assert conclude(verdicts) == [
        "1 of 2 readings are excluded.",
        "stiffness literal: all excluded, by S2 1 times, S9 1 times.",
        "stiffness restored: none excluded.",
    ]


def test_an_undecided_statement_excludes_nothing() -> None:
    verdicts = [judged(LITERAL, S2="undecided"), judged(RESTORED, S4="undecided")]
    assert conclude(verdicts)[0] == "0 of 2 readings are excluded."


def test_a_value_that_is_excluded_in_part_is_said_to_be() -> None:
    others = [replace(reading, base="pinned") for reading in (LITERAL, RESTORED)]
    verdicts = [judged(LITERAL, S1="contradicted"), *map(judged, (RESTORED, *others))]
    assert "stiffness literal: 1 of 2 excluded, by S1 1 times." in conclude(verdicts)


@pytest.mark.parametrize(
    ("peak", "verdict"), [(0.171, "reproduced"), (0.1785, "undecided"), (0.34, "contradicted")]
)
def test_exponents_are_compared_within_their_group(peak: float, verdict: str) -> None:
    """Reference: peaks 0.6 %, 5.0 % and 100 % apart by hand, against 5 % ± 0.5 %."""
    group = [judged(RESTORED), judged(replace(RESTORED, exponent=1.0), peak)]
    alone = judged(LITERAL, 1.7)
    *both, other = judge_exponents([*group, alone])
    for entry in both:
        assert entry.findings["S9"].verdict == verdict
        assert entry.findings["S9"].measured == pytest.approx([peak / 0.17 - 1.0])
    assert other.findings["S9"] == ReadingFinding("undecided", ())


@pytest.mark.slow
def test_a_survey_of_two_readings(tmp_path: Path) -> None:
    """Reference: the literal stiffness gives n = 1 and n = 2 first tip peaks that differ by more
    than half, and the series stay within a tenth of one another; non-regression.
    """
    readings = [replace(LITERAL, exponent=exponent) for exponent in (1.0, 2.0)]
    found = survey(readings, tmp_path / "out", Console(quiet=True), members=2)
    for entry in found:
        assert sorted(entry.findings) == sorted(JUDGED)
        assert set(COMMON) < set(entry.findings)
        assert {"S2", "S9"} <= set(entry.excluded_by())
        assert entry.findings["S9"].measured[0] > 0.5
        assert max(entry.findings["S2"].measured) < 0.15
        assert entry.energy_residual < 1e-2
    data = json.loads((tmp_path / "out" / "readings.json").read_text(encoding="utf-8"))
    assert [entry["reading"]["exponent"] for entry in data["readings"]] == [1.0, 2.0]
    assert data["conclusion"] == conclude(found)
    text = (tmp_path / "out" / "readings.md").read_text(encoding="utf-8")
    assert text.count("| 7, literal, as printed, ") == 4
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == ["readings.html", "readings.json", "readings.md"]
    paper = case_file.load(str(PAPER))
    assert load(tmp_path / "out", paper) == shown(found)
    page = (tmp_path / "out" / "readings.html").read_text(encoding="utf-8")
    assert page.count("7, literal, as printed, ") == 4
    check_refusals(tmp_path / "out", paper)


def check_refusals(folder: Path, paper: Case) -> None:
    """Check that a survey of another case, or a damaged one, gives a message of one line."""
    other = paper.model_copy(update={"title": "another"})
    remedy = "remove it, or survey the readings again"
    with pytest.raises(BadInput) as refused:
        load(folder, other)
    assert str(refused.value) == (
        f"{folder}: readings.json: is not of the case in case.toml; {remedy}"
    )
    path = folder / "readings.json"
    whole = path.read_text(encoding="utf-8")
    for text in (whole[:-20], "[]", '{"readings": []}'):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(BadInput) as refused:
            load(folder, paper)
        message = str(refused.value)
        assert message.startswith(f"{folder}: readings.json: cannot be understood (")
        assert message.endswith(f"); {remedy}")
    path.write_text(whole.replace('"exponent"', '"power"'), encoding="utf-8")
    with pytest.raises(BadInput) as refused:
        load(folder, paper)
    assert str(refused.value) == (
        f"{folder}: readings.json: 0: reading: exponent: Field required; is damaged or another "
        f"version's; {remedy}"
    )


def test_a_folder_without_a_survey_has_none(paper: Case, tmp_path: Path) -> None:
    assert load(tmp_path, paper) == []
