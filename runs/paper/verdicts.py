# SPDX-License-Identifier: LGPL-3.0-or-later
"""Verdicts on the statements of the paper in the report, the terminal and ``verdicts.json``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from rich.console import Console

from protractile.geometry.typography import NONE, join_words, number
from protractile.runs.case.schema import Case
from protractile.runs.paper.keys import Keys
from protractile.runs.paper.statements import STATEMENTS, TITLES
from protractile.runs.process.terminal import message, say, shorten
from protractile.runs.report.additions import Addition
from protractile.runs.report.tables import Column, Table, as_json

Judgement = Literal["reproduced", "contradicted", "undecided"]
MARKS: Mapping[Judgement, str] = {"reproduced": "✓", "contradicted": "✗", "undecided": "?"}

TEMPLATES = Path(__file__).parent / "templates"
FILE = "verdicts.json"


@dataclass(frozen=True, slots=True)
class Verdict:
    """Verdict on one statement."""

    id: str  #: identifier of the statement in the case
    statement: str  #: text of the statement
    #: number that the rule compares with the threshold; None if data are missing
    measured: float | None
    threshold: float | None  #: threshold of this number
    unit: str  #: unit of both numbers; empty if dimensionless
    verdict: Judgement  #: result of the rule
    why: str  #: explanation of the number and of the verdict
    #: distance of the deciding number from its threshold in standard errors, of which three decide
    #: the verdict; None if no number of the rule depends on the sample of a chaotic motion
    distance: float | None = None
    demanded: bool = False  #: True if the case demands the verdict ``reproduced``

    def with_unit(self, value: float | None) -> str:
        """Return a number as text with the unit of the verdict."""
        text = number(value)
        return f"{text} {self.unit}" if self.unit and text != NONE else text

    @property
    def certainty(self) -> str:
        """The distance from the threshold as text; empty without standard errors."""
        if self.distance is None:
            return ""
        return f"{number(self.distance, 2)} standard errors away"


def addition(case: Case, verdicts: Sequence[Verdict]) -> Addition:
    """Return the additions to the report of a run: its verdicts, and notes under figures."""
    assert isinstance(case, Keys)
    judgements = [verdict.verdict for verdict in verdicts]
    anchors = evidence(case)
    figures = {"tip": 8, "head": 9} if case.regular else {"tip": 6, "head": 7}
    remarks = {
        f"figure-{place}": f"The counterpart of Fig. {number} of the paper."
        for place, number in figures.items()
    }
    remarks["figure-tip-close-up"] = "Several verdicts rest on the first peak."
    remarks["table-steps"] = (
        "The paper names at most 2000 steps for the series and more than 4000 for beam elements, "
        "and 4375 for these with friction."
    )
    content = {
        "verdicts": verdicts,
        "marks": MARKS,
        "counts": {kind: judgements.count(kind) for kind in MARKS},
        "evidence": {verdict.id: anchors[verdict.id] for verdict in verdicts},
    }
    files = {FILE: as_json([asdict(verdict) for verdict in verdicts])} if verdicts else {}
    return Addition(
        TEMPLATES / "judged_report.html",
        content,
        remarks if case.statements else {},
        files,
    )


def evidence(case: Case) -> Mapping[str, Sequence[str]]:
    """Return the anchors of figures and tables in the report by the statement that they support."""
    regular = case.regular
    heads = [f"figure-head-{number}" for number in range(2, len(case.joints) + 1)]
    heads = ["figure-head", *heads]
    tip, close_up = "figure-tip", "figure-tip-close-up"
    slow = [] if regular else [tip]
    slow += ["table-horizons", "table-slow-peaks"]
    numerics = ["table-models", "table-steps"] if regular else []
    return {
        "S1": [close_up],
        "S2": slow,
        "S3": [*slow, "table-peaks-against"],
        "S4": [close_up, "table-pointwise"],
        "S5": [close_up],
        "S6": [close_up, *heads],
        "S7": [*([tip, *heads] if regular else []), "table-whole"],
        "S8": numerics,
        "S9": ["table-laws"],
        "S10": ["table-steps"],
        "S11": [tip, close_up] if len(case.segments) > 2 else [],
    }


def show(judged: Mapping[str, Addition], console: Console) -> int:
    """Print all verdicts and each demand that is not met; return 1 if there is one, else 0."""
    runs: dict[str, Sequence[Verdict]] = {
        file: verdict.content["verdicts"] for file, verdict in judged.items()
    }
    print_verdicts({Path(file).stem: verdicts for file, verdicts in runs.items()}, console)
    status = 0
    for file, verdicts in runs.items():
        for verdict in verdicts:
            if verdict.demanded and verdict.verdict != "reproduced":
                status = 1
                demand = (
                    f"{verdict.id} is {verdict.verdict}, and the case demands that it is reproduced"
                )
                say(message(f"{shorten(file)}: demand: {demand}: {verdict.why}"))
    return status


def print_verdicts(runs: Mapping[str, Sequence[Verdict]], console: Console) -> None:
    """Print a line for each statement, with the mark of the first run that decides it.

    ``runs`` has the verdicts by the name of their case.
    """
    found = decisive(runs)
    columns = [
        Column(
            "statement",
            [
                f"{MARKS[verdict.verdict]} {verdict.id:3} {TITLES[verdict.id]}"
                for _, verdict in found
            ],
        ),
        Column("measured", [number(verdict.measured) for _, verdict in found]),
        Column("threshold", [verdict.with_unit(verdict.threshold) for _, verdict in found]),
    ]
    names = {name: [verdict.id for case, verdict in found if case == name] for name, _ in found}
    notes = [f"{', '.join(f'{mark} {judgement}' for judgement, mark in MARKS.items())}."]
    notes += [f"{join_words(ids)} in {name}." for name, ids in names.items() if len(names) > 1]
    demanded = [verdict.id for _, verdict in found if verdict.demanded]
    notes += [f"Demanded: {join_words(demanded)}."] if demanded else []
    if found:
        Table("Statements of the paper", columns, [" ".join(notes)]).show(console)


def decisive(runs: Mapping[str, Sequence[Verdict]]) -> list[tuple[str, Verdict]]:
    """Return the name of a run and its verdict for each statement.

    This is the first run that decides the statement; if no run decides it, the first run.
    """
    verdicts_by_id: dict[str, tuple[str, Verdict]] = {}
    for name, verdicts in runs.items():
        for verdict in verdicts:
            first = verdicts_by_id.setdefault(verdict.id, (name, verdict))[1]
            if first.verdict == "undecided" != verdict.verdict:
                verdicts_by_id[verdict.id] = name, verdict
    return [verdicts_by_id[statement] for statement in STATEMENTS if statement in verdicts_by_id]
