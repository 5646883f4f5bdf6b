# SPDX-License-Identifier: LGPL-3.0-or-later
"""One table of verdicts over several runs."""

from __future__ import annotations

import pytest
import xarray as xr

from runs import CASES
from runs.case import reading as case_file
from runs.paper.statements import STATEMENTS
from runs.paper.verdicts import Judgement, Verdict, decisive, print_verdicts
from runs.pipeline.design_results import DesignResults, ModelDesignResults
from runs.pipeline.residual_vibration import ResidualVibration
from runs.pipeline.results import Results
from runs.report.document import print_models
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
def test_the_first_run_that_decides_is_heard(statement: str, name: str, verdict: Judgement) -> None:
    (found,) = [entry for entry in decisive(RUNS) if entry[1].id == statement]
    assert (found[0], found[1].verdict) == (name, verdict)


def test_names_the_case_of_each_verdict_where_there_are_several() -> None:
    lines = [line.split() for line in printed(print_verdicts, RUNS).splitlines() if line.strip()]
    for statement, verdict, name in (
        ("S7", "contradicted", "paper-friction"),
        ("S1", "reproduced", "paper"),
    ):
        at = next(i for i, words in enumerate(lines) if words[0] == statement)
        assert lines[at][1:4] == [verdict, "–", "–"]
        assert lines[at + 1][:2] == ["in", name]
    assert "in paper" not in printed(print_verdicts, {"paper": RUNS["paper"]})


def test_runs_that_are_not_judged_show_no_table() -> None:
    assert printed(print_verdicts, {"boom": []}) == ""


def test_every_run_tells_how_near_its_reduction_is() -> None:
    errors = {"contact_compliance": 2.3e-9, "readings": 8.1e-7, "frequency_limit_in_hz": 84.6}
    shell = model_summary(modes=110, reduction_errors=errors, mesh_error=0.0083)
    case = case_file.load(str(CASES / "paper.toml"))
    results = Results(case, xr.Dataset(), summary_of({"shell": shell}))
    assert printed(print_models, results).splitlines()[-2:] == [
        "shell: 110 coordinates answer as the full shell does, contacts within 2 × 10⁻⁹, tip and "
        "head within 8 × 10⁻⁷",
        "shell: where the segments touch, the local compliance is within 0.83 % of that of an "
        "infinitely fine mesh",
    ]


def test_a_boom_that_is_drawn_out_tells_how_its_tip_swings() -> None:
    """Reference: the summary's numbers in mm."""
    case = case_file.load(str(CASES / "drawn-out.toml"))
    swing = ResidualVibration(0.0182, 1.0, 0.8, 0.0181, None)
    summary = summary_of({"beam": model_summary()})
    summary.design = DesignResults({"beam": ModelDesignResults(residual_vibration=swing)})
    assert printed(print_models, Results(case, xr.Dataset(), summary)).splitlines()[-1] == (
        "beam: residual vibration of the tip, telescoping at a mean 0.8 m/s: 18.2 mm; standing "
        "18.1 and – mm where that begins and ends"
    )
