# SPDX-License-Identifier: LGPL-3.0-or-later
"""Survey of the readings of the paper's data: ``python -m runs.paper.readings``.

The print leaves open whether the play of 14 mm is 2Δ or Δ, whether the contact stiffness has lost
its exponent, which functions the series has at its ends, and which contact law a figure belongs
to. Every combination is run with the beam models and judged; the authors cannot have computed a
combination that a statement contradicts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, replace
from itertools import product
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter
from rich.console import Console

from beam_model.kantorovich import Base
from runs import CASES
from runs.case import reading as case_file
from runs.case import toml
from runs.case.schema import Case
from runs.folder.files import write_whole
from runs.paper.reading import (
    CHANGE,
    JUDGED,
    LITERAL,
    MEMBERS,
    MODELS,
    PAD_FORCE,
    STRATIFIED_FROM,
    Judged,
    Reading,
    ReadingFinding,
    Stiffness,
    by_base,
    judge_bases,
    judge_exponents,
)
from runs.paper.rules import DIVERGENCE
from runs.paper.statements import SURVEY_FILE
from runs.paper.verdicts import MARKS, TEMPLATES, read_copy
from runs.process.terminal import show_notices
from runs.report.formatting import number
from runs.report.pages import page
from runs.report.tables import Table, write

PAPER = CASES / "paper.toml"
OUT = Path("runs/out/readings")

TITLE = "Readings of the paper's data"


def all_readings() -> list[Reading]:
    """Return every combination."""
    clearances = (0.007, 0.014)
    stiffnesses: tuple[Stiffness, ...] = ("restored", "literal")
    bases: tuple[Base, ...] = ("as printed", "pinned", "complete")
    return [Reading(*values) for values in product(clearances, stiffnesses, bases, (1.0, 1.5, 2.0))]


def conclude(judged: Sequence[Judged]) -> list[str]:
    """Return sentences on the readings that the statements exclude."""
    left = [entry for entry in judged if not entry.excluded_by()]
    sentences = [f"{len(judged) - len(left)} of {len(judged)} readings are excluded."]
    aspects: Mapping[str, Callable[[Reading], str]] = {
        "clearance": lambda reading: f"{1e3 * reading.clearance:g} mm",
        "stiffness": lambda reading: reading.stiffness,
        "base": lambda reading: reading.base,
        "exponent": lambda reading: f"{reading.exponent:g}",
    }
    for aspect, value in aspects.items():
        values = list(dict.fromkeys(value(entry.reading) for entry in judged))
        for one in values if len(values) > 1 else ():
            with_it = [entry for entry in judged if value(entry.reading) == one]
            by = [key for entry in with_it for key in entry.excluded_by()]
            counts = ", ".join(f"{key} {by.count(key)} times" for key in JUDGED if key in by)
            excluded = sum(bool(entry.excluded_by()) for entry in with_it)
            how = "all" if excluded == len(with_it) else f"{excluded} of {len(with_it)}"
            sentences.append(
                f"{aspect} {one}: {how if excluded else 'none'} excluded"
                + (f", by {counts}." if counts else ".")
            )
    return sentences


def verdict_table(judged: Sequence[Judged]) -> Table:
    """Return a line for each reading with its verdict on each statement."""
    return Table.of_rows(
        "readings",
        "Readings of the data, and the statements on them",
        ("Δ mm, stiffness, base, n", *JUDGED, "excluded"),
        [
            (
                str(entry.reading),
                *(MARKS[entry.findings[key].verdict] for key in JUDGED),
                " ".join(entry.excluded_by()) or "–",
            )
            for entry in judged
        ],
        (
            "✓ reproduced, ✗ contradicted, ? undecided. S2 and S3 are decided where all of the "
            f"runs with loads changed by up to {CHANGE:g} agree. S3 here: the models with play "
            f"are more than {100.0 * DIVERGENCE:g} % apart at some time from "
            f"{STRATIFIED_FROM:g} s on. S4 without the shell.",
        ),
    )


def number_table(judged: Sequence[Judged]) -> Table:
    """Return a line for each reading with the numbers of its verdicts."""

    def cell(finding: ReadingFinding) -> str:
        ends = (min(finding.measured), max(finding.measured)) if finding.measured else ()
        return "…".join(dict.fromkeys(number(end, 2) for end in ends))

    return Table.of_rows(
        "readings-measured",
        "Measured",
        (
            "Δ mm, stiffness, base, n",
            "k\nN/mⁿ",
            *JUDGED,
            "first tip peaks\nmm",
            "energy residual",
        ),
        [
            (
                str(entry.reading),
                number(entry.reading.contact_stiffness),
                *(cell(entry.findings[key]) for key in JUDGED),
                ", ".join(f"{1e3 * entry.peaks[name]:.0f}" for name in MODELS),
                number(entry.energy_residual, 1),
            )
            for entry in judged
        ],
        (
            "S1, S2, S3: parts of the range, S2 and S3 from the smallest to the largest of all "
            "runs. S4: the smallest rise of the first tip peak from model to model. S5, S6: "
            "ratios. S9: by how much the first tip peak of one exponent exceeds that of another.",
            f"The peaks are those of {', '.join(MODELS)}.",
            f"The restored stiffness of n = 1 and 3/2 has the tangent of the quadratic law at "
            f"{PAD_FORCE / 1e3:g} kN; the literal one is {number(LITERAL)} for every n.",
        ),
    )


def shown(judged: Sequence[Judged]) -> list[Table]:
    """Return the tables of a survey, its conclusion below the first."""
    table = verdict_table(judged)
    return [replace(table, notes=(*table.notes, *conclude(judged))), number_table(judged)]


def survey(
    readings: Sequence[Reading], folder: Path, console: Console, members: int = MEMBERS
) -> list[Judged]:
    """Run the survey, print it, and write ``readings.json``, ``.md`` and ``.html``."""
    paper = case_file.load(str(PAPER))
    with ThreadPoolExecutor(2) as pool:
        groups = pool.map(lambda group: judge_bases(group, paper, members), by_base(readings))
        found = {entry.reading: entry for group in groups for entry in group}
    judged = judge_exponents([found[reading] for reading in readings])
    tables = shown(judged)
    tables[0].show(console)
    entries: list[dict[str, Any]] = [
        {
            **asdict(entry),
            "contact_stiffness": entry.reading.contact_stiffness,
            "excluded_by": entry.excluded_by(),
        }
        for entry in judged
    ]
    data = {
        "case_hash": toml.digest(paper),
        "readings": entries,
        "conclusion": conclude(judged),
    }
    write(folder, "readings", TITLE, data, tables)
    content = page(TEMPLATES / "readings.html", title=TITLE, tables=tables)
    write_whole(folder / "readings.html", content)
    return judged


def load(folder: Path, case: Case) -> list[Table]:
    """Return the tables of the survey in a run's folder; none without a survey.

    Args:
        folder: of a run.
        case: the run's.

    Raises:
        BadInput: the file is damaged, or of another case.
    """

    def read(data: Any) -> tuple[list[str], list[Table]]:
        judged = TypeAdapter(list[Judged]).validate_python(data["readings"])
        return [data["case_hash"]], shown(judged)

    return read_copy(folder / SURVEY_FILE, case, read, "survey the readings again") or []


if __name__ == "__main__":
    show_notices()
    survey(all_readings(), OUT, Console())
