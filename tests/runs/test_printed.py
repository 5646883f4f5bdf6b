# SPDX-License-Identifier: LGPL-3.0-or-later
"""Verdicts over several runs, and models, in the terminal."""

import pytest
import xarray as xr

from runs import CASES
from runs.case import reading as case_file
from runs.paper.statements import STATEMENTS
from runs.paper.verdicts import Judgement, Verdict, decisive, print_verdicts
from runs.pipeline.results import Results
from runs.report.terminal_tables import print_models
from tests.runs.summaries import model_summary, printed, summary_of


def judged(case: str, **judgements: Judgement) -> list[Verdict]:
    """Verdicts that leave open what is not given."""
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


def test_names_the_case_of_each_verdict_where_there_are_several() -> None:
    """Each statement is a paragraph that needs no column of its own."""
    paragraphs = printed(print_verdicts, RUNS, width=80).split("\n\n")[1:]
    heads = [paragraph.splitlines()[0] for paragraph in paragraphs]
    assert heads[0] == "S1 reproduced in paper"
    assert heads[6] == "S7 contradicted in paper-friction"
    assert "in paper" not in printed(print_verdicts, {"paper": RUNS["paper"]})


def test_a_verdict_shows_number_and_threshold() -> None:
    verdict = Verdict("S4", "It grows.", 1.25, 0.5, "%", "reproduced", "", demanded=True)
    assert printed(print_verdicts, {"paper": [verdict]}).splitlines()[2:] == [
        "S4 reproduced (demanded): 1.25 % measured, threshold 0.5",
        "It grows.",
    ]


def test_runs_without_verdicts_show_no_table() -> None:
    assert printed(print_verdicts, {"boom": []}) == ""


def test_every_run_shows_the_errors_of_its_reduction() -> None:
    errors = {"contact_compliance": 2.3e-9, "readings": 8.1e-7, "frequency_limit_in_hz": 84.6}
    shell = model_summary(modes=110, reduction_errors=errors, mesh_error=0.0083)
    case = case_file.load(str(CASES / "paper.toml"))
    results = Results(case, xr.Dataset(), summary_of({"shell": shell}))
    assert printed(print_models, results).splitlines()[-1] == (
        "shell: 110 coordinates; error of the local compliance at contacts 2 × 10⁻⁹, of tip and "
        "head 8 × 10⁻⁷, of the mesh at contacts 0.83 %"
    )
