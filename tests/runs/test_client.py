# SPDX-License-Identifier: LGPL-3.0-or-later
"""The paper is one client: what it adds to a report, and that no other module knows it."""

import re
from pathlib import Path

import pytest

from runs import CASES
from runs.case import reading as case_file
from runs.paper.statements import STATEMENTS
from runs.paper.verdicts import addition, evidence

ROOT = Path(__file__).parents[2]
ROOMS = ("beam_model", "dynamics", "geometry", "protractile", "runs", "shell_model")
CLIENT = ROOT / "runs" / "client.py", *(ROOT / "runs" / "paper").glob("**/*")
KNOWS = re.compile(
    r"\"S\d+\"|\bstatements?\b(?! import CaseKeys)|\bverdicts?\b|reproduced|contradicted|undecided"
)


def test_no_other_module_knows_the_paper() -> None:
    """Neither modules nor templates of the report; who imports it: ``test_imports.py``."""
    modules = [path for room in ROOMS for path in (ROOT / room).glob("**/*.py")]
    general = {*modules, *(ROOT / "runs/report/templates").iterdir()}.difference(CLIENT)
    assert len(general) > 150
    lines = [(path, line) for path in general for line in path.read_text("utf-8").splitlines()]
    assert [(path, line) for path, line in lines if KNOWS.search(line)] == []


TIP, CLOSE_UP, HEAD = "figure-tip", "figure-tip-close-up", "figure-head"
SLOW = "figure-slow-peaks", "table-horizons", "table-slow-peaks"


@pytest.mark.parametrize(
    ("case", "changed"),
    [
        ("paper", {}),
        ("paper-friction",
         {
             "S2": [*SLOW], "S3": [*SLOW, "table-peaks-against"],
             "S7": [TIP, HEAD, "figure-friction", "table-whole"],
             "S8": ["figure-friction", "figure-energy-residual", "table-steps"],
         }),
        ("three-segments", {"S6": [CLOSE_UP, HEAD, "figure-head-2"], "S11": [TIP, CLOSE_UP]}),
    ],
)  # fmt: skip
def test_evidence_of_each_statement(case: str, changed: dict[str, list[str]]) -> None:
    """Reference: the statements themselves; with friction others are meant."""
    found = evidence(case_file.load(str(CASES / f"{case}.toml")))
    assert {key: [*anchors] for key, anchors in found.items()} == {
        "S1": [CLOSE_UP],
        "S2": [TIP, *SLOW],
        "S3": [TIP, *SLOW, "table-peaks-against"],
        "S4": [CLOSE_UP, "table-pointwise"],
        "S5": [CLOSE_UP],
        "S6": [CLOSE_UP, HEAD],
        "S7": ["figure-friction", "table-whole"],
        "S8": ["figure-friction"],
        "S9": ["table-laws"],
        "S10": ["table-steps"],
        "S11": [],
    } | changed
    assert [*found] == [*STATEMENTS]


@pytest.mark.parametrize(("case", "numbers"), [("paper", (6, 7)), ("paper-friction", (8, 9))])
def test_figures_name_their_counterparts(case: str, numbers: tuple[int, int]) -> None:
    """Reference: the paper's Figs. 6 and 7 are without, 8 and 9 with friction."""
    found = case_file.load(str(CASES / f"{case}.toml"))
    remarks = addition(found, []).remarks
    for place, number in zip(("tip", "head"), numbers, strict=True):
        assert f"counterpart of Fig. {number} of the paper" in remarks[f"figure-{place}"]
    assert addition(found.without_judgements(), []).remarks == {}
