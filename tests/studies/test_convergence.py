# SPDX-License-Identifier: LGPL-3.0-or-later
"""The report of the studies, and the page of proofs."""

import io
import json
import sys
import warnings
from pathlib import Path
from typing import Self

import pytest
from rich.console import Console

from runs.report.tables import Table
from studies import convergence
from studies.study import Plot, Proof, Study

DOCUMENT = Path(__file__).parents[2] / "docs" / "verification.md"


def proof(value: float, allowed: float = 0.01) -> Proof:
    return Proof("roof", value, 0.3024, "m", "external", "MacNeal and Harder 1985", allowed, 1.9)


def test_a_proof_holds_within_its_bar() -> None:
    assert proof(0.3024 * 1.009).holds
    assert not proof(0.3024 * 1.011).holds
    # Where the reference is zero, the value is the error.
    assert not Proof("strain", 0.02, 0.0, "", "analytic", "rigid motion", 0.01).holds


def test_page_of_proofs_marks_failures() -> None:
    study = Study("shells", "Shells", proofs=[proof(0.3030), proof(0.4)])
    lines = convergence.markdown([study]).splitlines()
    rows = [line for line in lines if line.startswith("| roof")]
    assert rows[0] == (
        "| roof | 0.303 m | 0.3024 m | 0.2 | 1 | ✓ | 1.90 | external | MacNeal and Harder 1985 |"
    )
    assert "| 32 | 1 | ✗ | 1.90 |" in rows[1]


def test_studies_leave_a_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    study = Study(
        "shells",
        "Shells",
        tables=[
            Table.of_rows("roof", "Roof", {"mesh": "", "m": ".2f"}, [("fine", 0.3), ("no", None)])
        ],
        proofs=[proof(0.3030)],
        plots=[Plot("roof", "It settles", "h (m)", "error", {"roof": ([1, 2], [1, 4])}, "So.")],
    )
    monkeypatch.setattr(convergence, "run", lambda name: (study, 1.0))
    monkeypatch.setattr(convergence, "ProcessPoolExecutor", _Here)
    shown = io.StringIO()
    folder = tmp_path / "convergence"
    convergence.survey(["shells"], folder, Console(file=shown, width=120))
    assert "fine   0.30" in shown.getvalue()
    data = json.loads((folder / "convergence.json").read_text(encoding="utf-8"))
    assert data["shells"]["roof"] == [{"mesh": "fine", "m": 0.3}, {"mesh": "no", "m": None}]
    assert "Shells: 1 s" in shown.getvalue()
    names = sorted(path.name for path in folder.iterdir())
    assert names == [
        "convergence.json", "convergence.md", "figures", "report.html", "verification.md",
    ]  # fmt: skip
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "data:image/webp" in page
    assert page.count("MacNeal and Harder 1985") == 1


def test_every_documented_value_is_proven() -> None:
    """docs/verification.md is what the last run of all studies has written."""
    _, _, sections = DOCUMENT.read_text(encoding="utf-8").partition("\n## ")
    rows = [
        line.strip("|").split("|")
        for line in sections.splitlines()
        if line.startswith("| ") and not line.startswith(("| what", "| :--"))
    ]
    assert len(rows) > 50
    assert {row[5].strip() for row in rows} == {"✓"}
    kinds = {row[7].strip() for row in rows}
    assert kinds <= {"analytic", "external", "other code", "non-regression"}


class _Here:
    """A pool that does its work at once."""

    def __init__(self, *_: object, **__: object) -> None: ...

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None: ...

    map = staticmethod(map)


def test_library_warnings_are_hidden(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def survey(*_: object) -> list[object]:
        warnings.warn("of a library", stacklevel=1)
        return []

    monkeypatch.setattr(sys, "argv", ["convergence"])
    monkeypatch.setattr(convergence, "survey", survey)
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        with pytest.raises(SystemExit, match="0"):
            convergence.main()
    assert "of a library" not in capsys.readouterr().err
