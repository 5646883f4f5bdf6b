# SPDX-License-Identifier: LGPL-3.0-or-later
"""What numerics of the paper's time show stands beside the verdicts of a run."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from runs import CASES
from runs.case import reading as case_file
from runs.case import toml
from runs.case.messages import BadInput
from runs.case.schema import Case
from runs.paper.statements import THEN_FILE
from runs.paper.verdicts import Outcome, Verdict, beside, print_verdicts
from tests.runs.summaries import printed

SAYS = "not shown: in no run of 18 numerics"
REMEDY = "remove it, or run python -m studies.as_computed_then again"


@pytest.fixture
def paper() -> Case:
    return case_file.load(str(CASES / "paper.toml"))


@pytest.fixture
def verdicts() -> list[Verdict]:
    return [Verdict(key, key, 1.0, 2.0, "", "undecided", "") for key in ("S1", "S3")]


def leave(folder: Path, case_hash: str) -> Path:
    """Write the file as the study does."""
    outcomes = {"S3": {"shown": False, "why": "in no run of 18 numerics"}}
    path = folder / THEN_FILE
    path.write_text(json.dumps({"case_hashes": [case_hash], "outcomes": outcomes}))
    return path


def test_a_statement_that_was_tried_says_so(
    paper: Case, verdicts: list[Verdict], tmp_path: Path
) -> None:
    leave(tmp_path, toml.digest(paper))
    assert [one.then for one in beside(verdicts, tmp_path, paper)] == ["", SAYS]


def test_without_the_file_verdicts_stay_what_they_are(
    paper: Case, verdicts: list[Verdict], tmp_path: Path
) -> None:
    assert beside(verdicts, tmp_path, paper) == verdicts


def test_what_was_shown_says_so() -> None:
    assert str(Outcome(shown=True, why="in 60 % of runs")) == "shown: in 60 % of runs"


def test_the_table_has_the_column_where_something_was_tried(
    paper: Case, verdicts: list[Verdict], tmp_path: Path
) -> None:
    leave(tmp_path, toml.digest(paper))
    with_file = printed(print_verdicts, {"paper": beside(verdicts, tmp_path, paper)})
    assert "as computed then" in with_file
    assert SAYS in with_file
    assert "as computed then" not in printed(print_verdicts, {"paper": verdicts})


def test_a_file_of_another_case_is_one_line(paper: Case, tmp_path: Path) -> None:
    leave(tmp_path, "another")
    with pytest.raises(BadInput) as refused:
        beside([], tmp_path, paper)
    assert str(refused.value) == (
        f"{tmp_path}: then.json: is not of the case in case.toml; {REMEDY}"
    )


def test_a_damaged_file_is_one_line(paper: Case, tmp_path: Path) -> None:
    path = leave(tmp_path, toml.digest(paper))
    whole = path.read_text()
    path.write_text(whole[:-9])
    with pytest.raises(BadInput) as refused:
        beside([], tmp_path, paper)
    message = str(refused.value)
    assert message.startswith(f"{tmp_path}: then.json: cannot be understood (")
    assert message.endswith(f"); {REMEDY}")
    path.write_text(whole.replace('"why"', '"because"'))
    with pytest.raises(BadInput) as refused:
        beside([], tmp_path, paper)
    assert str(refused.value) == (
        f"{tmp_path}: then.json: outcomes: S3: why: Field required; is damaged or another "
        f"version's; {REMEDY}"
    )
