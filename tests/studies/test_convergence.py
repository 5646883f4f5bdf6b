# SPDX-License-Identifier: LGPL-3.0-or-later
"""Proofs with refined meshes, the report of the studies and the page of verifications."""

import io
import json
import math
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Self

import pytest
from rich.console import Console

from protractile.runs.report.tables import Table
from studies import convergence
from studies.refined import Reference, Refined, refined_table
from studies.study import Plot, Study, Verification

DOCUMENT = Path(__file__).parents[2] / "docs" / "verification.md"


def verification(value: float, allowed: float = 0.01) -> Verification:
    return Verification(
        "roof", value, 0.3024, "m", "external", "MacNeal and Harder 1985", allowed, 1.9
    )


def test_a_proof_holds_within_its_bar() -> None:
    assert verification(0.3024 * 1.009).holds
    assert not verification(0.3024 * 1.011).holds
    # Where the reference is zero, the value is the error.
    assert not Verification("strain", 0.02, 0.0, "", "analytic", "rigid motion", 0.01).holds


def test_page_of_proofs_marks_failures() -> None:
    study = Study("shells", "Shells", verifications=[verification(0.3030), verification(0.4)])
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
        verifications=[verification(0.3030)],
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
    assert "data:image/svg+xml" in page
    assert page.count("MacNeal and Harder 1985") == 1


def test_every_documented_value_is_proven() -> None:
    """docs/verification.md has the output of the last run of all studies."""
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
    """A pool that works at once."""

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


def refined(values: Sequence[float], ratio: float = 2.0) -> Refined:
    sizes = [ratio ** (len(values) - i) for i in range(len(values))]
    return Refined("pressure", "", sizes, values)


def test_the_published_example() -> None:
    """Reference: external, NPARC Alliance's tutorial: 0.96178, 0.96854, 0.97050 on halved grids."""
    found = refined([0.96178, 0.96854, 0.97050])
    assert found.order == pytest.approx(1.7862, abs=1.0e-4)
    assert found.limit == found.best == pytest.approx(0.97130, abs=1.0e-5)
    assert 100.0 * found.index == pytest.approx(0.1031, abs=1.0e-4)


def test_power_law_has_its_exact_order() -> None:
    """Reference: analytic, 2 + 3 h^1.5 at h = 0.9, 0.3, 0.1."""
    found = refined([2.0 + 3.0 * h**1.5 for h in (2.7, 0.9, 0.3, 0.1)], ratio=3.0)
    assert found.order == pytest.approx(1.5, rel=1.0e-12)
    assert found.limit == pytest.approx(2.0, rel=1.0e-12)
    assert found.index == pytest.approx(1.25 * 3.0 * 0.1**1.5 / (2.0 + 3.0 * 0.1**1.5))
    coarse = found.against_limit("p", found.sizes[0], "finest", 0.01)
    assert (coarse.value, coarse.reference, coarse.order) == (
        found.values[0], found.limit, found.order,
    )  # fmt: skip
    assert coarse.source.startswith("limit of its refinement")


@pytest.mark.parametrize("values", [(1.0, 2.0, 1.5), (1.0, 1.1, 1.3), (1.0, 1.0, 1.0), (1.0, 1.1)])
def test_no_order_without_convergence(values: tuple[float, ...]) -> None:
    """Values that oscillate, diverge or are constant have no order and no limit."""
    found = refined(values)
    assert math.isnan(found.order)
    assert math.isnan(found.limit)
    assert math.isnan(found.index)
    assert found.best == values[-1]
    assert found.against_limit("p", found.sizes[0], "finest", 0.01).source == "finest"
    with pytest.raises(ValueError, match=r"^p: the finest mesh would be held against itself$"):
        found.against_limit("p", found.sizes[-1], "finest", 0.01)


def test_a_slow_order_leads_nowhere() -> None:
    """Reference: analytic. Differences that decrease to nine tenths have the order 0.15."""
    found = refined([2.0, 1.9, 1.81])
    assert found.order == pytest.approx(0.152, abs=1.0e-3)
    assert found.best == 1.81


def test_the_finest_is_held_against_its_reference() -> None:
    short = Refined("p", "m", [2.0, 1.0], [1.2, 1.1], Reference(1.0, "external", "known", 0.2))
    assert short.errors == pytest.approx([0.2, 0.1])
    assert short.verification.holds
    assert short.verification.order is None
    long = Refined("q", "", [4.0, 2.0, 1.0], [1.4, 1.2, 1.1])
    first, second = refined_table("t", "T", [short, long], "h = {:g}").data
    assert (first["quantity"], first["h = 4"], first["h = 2"]) == ("p (m)", None, 1.2)
    assert (second["h = 4"], second["order"]) == (1.4, pytest.approx(1.0))
