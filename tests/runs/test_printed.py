# SPDX-License-Identifier: LGPL-3.0-or-later
"""One table of verdicts over several runs."""

from __future__ import annotations

from dataclasses import replace
from io import StringIO

import pytest
import xarray as xr
from rich.console import Console

from runs import CASES
from runs.case import reading as case_file
from runs.paper.statements import STATEMENTS, Judgement, Verdict
from runs.pipeline.results import Results
from runs.report.printed import decisive, print_models, print_verdicts


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


def test_every_run_tells_how_near_its_reduction_is(monkeypatch: pytest.MonkeyPatch) -> None:
    errors = {"contact_compliance": 2.3e-9, "readings": 8.1e-7, "frequency_limit_in_hz": 84.6}
    shell = {"modes": 110, "reduction_errors": errors, "mesh_error": 0.0083}
    summary = {"models": {"shell": shell}}
    results = replace(RUNS["paper"], summary=summary)
    monkeypatch.setattr("runs.report.printed.model_rows", lambda results: [])
    monkeypatch.setattr(Results, "cautions", lambda self: [])
    console = Console(file=StringIO(), width=160)
    print_models(results, console)
    assert isinstance(console.file, StringIO)
    assert console.file.getvalue().splitlines()[-2:] == [
        "shell: 110 coordinates answer as the full shell does, contacts within 2 × 10⁻⁹, tip and "
        "head within 8 × 10⁻⁷",
        "shell: the mesh answers where the segments touch as an infinitely fine one does, within "
        "0.83 % of what the walls give way",
    ]
