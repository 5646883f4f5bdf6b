# SPDX-License-Identifier: LGPL-3.0-or-later
"""One table of verdicts over several runs."""

from __future__ import annotations

from dataclasses import replace
from io import StringIO
from pathlib import Path

import pytest
import xarray as xr
from rich.console import Console

from runs import case as case_file
from runs.printed import decisive, print_verdicts
from runs.results import Results
from runs.statements import STATEMENTS, Judgement, Verdict

pytestmark = pytest.mark.quick

CASES = Path(case_file.__file__).parent / "cases"


def run(case: str, **judgements: Judgement) -> Results:
    """A run that leaves open what is not given."""
    verdicts = [
        Verdict(key, statement, None, None, "", judgements.get(key, "undecided"), case)
        for key, statement in STATEMENTS.items()
    ]
    return Results(case_file.load(str(CASES / f"{case}.toml")), xr.Dataset(), {}, verdicts)


RUNS = {
    "paper": run("paper", S1="reproduced", S3="contradicted"),
    "paper-friction": run("paper-friction", S3="reproduced", S7="contradicted"),
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
def test_the_first_run_that_decides_is_heard(statement: str, name: str, verdict: Judgement) -> None:
    found, heard = decisive(RUNS, statement)
    assert (found, heard.id, heard.verdict) == (name, statement, verdict)


def printed(runs: dict[str, Results]) -> str:
    console = Console(file=StringIO(), width=160)
    print_verdicts(runs, console)
    assert isinstance(console.file, StringIO)
    return console.file.getvalue()


def test_names_the_case_of_each_verdict_where_there_are_several() -> None:
    lines = [line.split() for line in printed(RUNS).splitlines() if line.strip()]
    for statement, verdict, name in (
        ("S7", "contradicted", "paper-friction"),
        ("S1", "reproduced", "paper"),
    ):
        at = next(i for i, words in enumerate(lines) if words[0] == statement)
        assert lines[at][1:4] == [verdict, "–", "–"]
        assert lines[at + 1][:2] == ["in", name]
    assert "in paper" not in printed({"paper": RUNS["paper"]})


def test_runs_without_a_series_judge_nothing() -> None:
    beams = case_file.select(RUNS["paper"].case, "", ["beam-fe"])
    assert printed({"beams": replace(RUNS["paper"], case=beams)}) == ""
