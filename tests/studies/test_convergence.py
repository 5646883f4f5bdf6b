# SPDX-License-Identifier: LGPL-3.0-or-later
"""Proofs with refined meshes, pages, the report of studies, and the gallery."""

import io
import json
import re
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Self

import numpy as np
import pytest
from PIL import Image
from rich.console import Console

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.report.tables import Table
from studies import convergence, direct, gallery, step_tolerance, taper, working_load
from studies.convergence import STUDIES, verification_table
from studies.motions import friction_case
from studies.refined import Reference, Refined, refined_table
from studies.study import Plot, Study, Verification

ROOT = Path(__file__).parents[2]


def verification(value: float, allowed: float = 0.01) -> Verification:
    return Verification(
        "roof", value, 0.3024, "m", "external", "MacNeal and Harder 1985", allowed, 1.9
    )


def test_a_proof_holds_within_its_bar_and_the_page_marks_failures() -> None:
    """Reference: by hand, 1 % of 0.3024 m. Where the reference is zero, the value is the error."""
    assert verification(0.3024 * 1.009).holds
    assert not verification(0.3024 * 1.011).holds
    assert not Verification("strain", 0.02, 0.0, "", "analytic", "rigid motion", 0.01).holds
    study = Study("shells", "Shells", verifications=[verification(0.3030), verification(0.4)])
    rows = [
        line for line in convergence.markdown([study]).splitlines() if line.startswith("| roof")
    ]
    assert rows[0] == (
        "| roof | 0.303 m | 0.3024 m | 0.2 | 1 | ✓ | 1.90 | external | MacNeal and Harder 1985 |"
    )
    assert "| 32 | 1 | ✗ | 1.90 |" in rows[1]


def test_studies_leave_a_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    roof = Table.of_rows("roof", "Roof", {"mesh": "", "m": ".2f"}, [("fine", 0.3), ("no", None)])
    curves = {"roof": ([1, 2], [1, 4])}
    plot = Plot("roof", "It settles", "h (m)", "error", curves, "So.")
    study = Study("shells", "Shells", [roof], verifications=[verification(0.3030)], plots=[plot])
    monkeypatch.setattr(convergence, "run", lambda name: (study, 1.0))
    monkeypatch.setattr(convergence, "ProcessPoolExecutor", _Here)
    shown = io.StringIO()
    folder = tmp_path / "convergence"
    convergence.survey(["shells"], folder, Console(file=shown, width=120))
    assert "fine   0.30" in shown.getvalue()
    data = json.loads((folder / "convergence.json").read_text(encoding="utf-8"))
    assert data["shells"]["roof"] == [{"mesh": "fine", "m": 0.3}, {"mesh": "no", "m": None}]
    assert "Shells: 1 s" in shown.getvalue()
    pages = {"convergence.json", "convergence.md", "report.html", "verification.md"}
    assert {path.name for path in folder.iterdir()} == {*pages, "figures"}
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "data:image/svg+xml" in page
    assert page.count("MacNeal and Harder 1985") == 1


class _Here:
    """A pool that works at once."""

    def __init__(self, *_: object, **__: object) -> None: ...

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None: ...

    map = staticmethod(map)


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
    assert np.isnan([found.order, found.limit, found.index]).all()
    assert found.best == values[-1]
    assert found.against_limit("p", found.sizes[0], "finest", 0.01).source == "finest"
    with pytest.raises(ValueError, match=r"^p: the finest mesh would be held against itself$"):
        found.against_limit("p", found.sizes[-1], "finest", 0.01)


def test_the_finest_is_held_against_its_reference() -> None:
    short = Refined("p", "m", [2.0, 1.0], [1.2, 1.1], Reference(1.0, "external", "known", 0.2))
    assert short.errors == pytest.approx([0.2, 0.1])
    assert short.verification.holds
    assert short.verification.order is None
    long = Refined("q", "", [4.0, 2.0, 1.0], [1.4, 1.2, 1.1])
    first, second = refined_table("t", "T", [short, long], "h = {:g}").data
    assert (first["quantity"], first["h = 4"], first["h = 2"]) == ("p (m)", None, 1.2)
    assert (second["h = 4"], second["order"]) == (1.4, pytest.approx(1.0))


# Which point is the worst is measured.
POINT = re.compile(r" \([^)]*\)$")


def moved(kind: working_load.ContactType, sizes: working_load.Sizes) -> working_load.ContactResults:
    motion = working_load.PointMotion(np.arange(2.0), np.ones(sizes.peaks), np.ones(2))
    motions = dict.fromkeys(kind.points, [motion] * len(sizes.meshes))
    return working_load.ContactResults(kind, motions)


def run(_case: Case, steps: Sequence[float], *_: object) -> list[direct.Run]:
    hows = ["reduced", "reduced, more coordinates", *["unreduced"] * len(steps)]
    return [
        direct.Run(how, 1, 1.0 / i, np.array([0.0, i]), 1.0, 0.0, 1.0)
        for i, how in enumerate(hows, start=1)
    ]


def two(*_: object) -> tuple[float, float]:
    return 1.0, 1.0


def one(*_: object) -> float:
    return 1.0


def results(*_: object) -> SimpleNamespace:
    """Return what stands for a state, a swing, a section and a comparison."""
    of_pair = {"top": two, "shear": two, "near": two, "measured": two, "errors": (0.0, 0.0)}
    exact = SimpleNamespace(tip=1.0, foot_moment=1.0)
    numbers = {"tip": 1.0, "moment": 1.0, "stations": np.ones(2), "exact": exact}
    return SimpleNamespace(boom=build_boom(friction_case()), **of_pair, **numbers)


# Study → what of it takes long → what stands in for it here.
STAND_INS: Mapping[str, Mapping[str, object]] = {
    "contact_size": {
        "station_compliances": lambda *_: np.ones(2),
        "support_compliance": lambda _, meshes: np.ones(len(meshes)),
        "first_peaks": lambda _, sizes: np.ones(len(sizes.loads)),
    },
    "working_load": {"measure": moved},
    "direct": {"runs_of": run},
    "stress": dict.fromkeys(["InnerSegmentState.on_mesh", "InnerSegmentState.reduced"], results),
    "stiffeners": dict.fromkeys(["measure", "table", "racking_stiffness", "ring_flexibility"], one),
    "step_tolerance": {
        "measure": lambda kind: [step_tolerance.Found(1.0, 1.0, 1) for _ in kind.tolerances]
    },
    "damping": {"PressedBoom.of": results, "_system": one},
    "second_order": {},
    "large_deflections": {"compare": results},
    "telescoping_column": {},
    "design_results": {},
    "sections": dict.fromkeys(["ring_of_shell", "beam_peak", "shell_peak", "tip_of_shell"], one),
    "polygon_distortion": {"of_beam": results, "of_shell": results},
    "taper": {"MODELS": taper.MODELS | {"shell": taper.MODELS[taper.ELEMENTS]}},
}
# Studies without a verification have no section; validation has its own page.
TABLES_ALONE = ("surface_contact", "stick_slip", "interpretations", "numerics_1997", "verdicts")
PROVING = [name for name in STUDIES if name not in (*TABLES_ALONE, "validation")]


def row(cells: Sequence[str]) -> tuple[str, str, str]:
    """Return the compared quantity without place, the tolerance, and the kind of reference."""
    return POINT.sub("", cells[0]), cells[4], cells[7]


PAGE = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
# Cells of each row by the title of its section.
SECTIONS = {
    title: [cells.split(" | ") for cells in re.findall(r"^\| (?!what|:--)(.*) \|$", rows, re.M)]
    for title, rows in re.findall(r"^## (.*)\n((?:(?!## ).*\n)*)", PAGE, re.M)
}


def test_the_page_has_the_sections_of_the_studies_and_proven_values_alone() -> None:
    """docs/verification.md has the output of the last run of all studies."""
    for name, title in zip(PROVING, SECTIONS, strict=True):
        source = (ROOT / "studies" / f"{name}.py").read_text(encoding="utf-8")
        assert name in STAND_INS or f'"{title}"' in source
    rows = [cells for section in SECTIONS.values() for cells in section]
    assert len(rows) > 50
    assert {cells[5] for cells in rows} == {"✓"}
    assert {cells[7] for cells in rows} <= {"analytic", "external", "other code", "non-regression"}


def test_facts_that_tests_hold_have_their_tests() -> None:
    """A test of a fact on the page is part of its verification."""
    rows = re.findall(r"^\| .* \| `(tests/[a-z0-9_/]+\.py)`: (.*?) \|", PAGE, re.M)
    assert len(rows) == 22
    for path, tests in rows:
        code = (ROOT / path).read_text(encoding="utf-8")
        assert [name for name in re.findall(r"`(\w+)`", tests) if f"def {name}(" not in code] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", STAND_INS)
def test_rows_are_those_of_the_study(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: the study, with constants in place of slow computations. Measured values hold."""
    if name == "design_results":
        pytest.importorskip("rainflow", reason="the cycles are counted by it")
    for what, surrogate in STAND_INS[name].items():
        monkeypatch.setattr(f"studies.{name}.{what}", surrogate)
    study: Study = import_module(f"studies.{name}").study(lambda what: None)
    given = [row(cells) for cells in SECTIONS[study.title]]
    assert given == [row(cells) for cells in verification_table(study).rows]
    assert STAND_INS[name] or all(one.holds for one in study.verifications)


def test_gallery_page_equals_the_output_of_its_script() -> None:
    """Reference: the script, its table of copied pictures and the names of those it makes."""
    docs = ROOT / "docs"
    page = (docs / "gallery.md").read_text(encoding="utf-8")
    origins = dict(re.findall(r"!\[[^]]+\]\(gallery/([a-z-]+)\.png\)\n\n`([^`]+)`", page))
    made = {*gallery.COPIED, "lift", "mesh", "sections-largest-force", "crane-speeds"}
    assert {*re.findall(r"\(gallery/([a-z-]+)\.png\)", page)} >= made
    for name, (run, picture) in gallery.COPIED.items():
        assert origins[name] == f"runs/out/{run}/{picture}"
    for name in origins:
        path = docs / "gallery" / f"{name}.png"
        assert path.stat().st_size < 320_000
        with Image.open(path) as image:
            image.verify()
