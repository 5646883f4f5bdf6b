# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pages and the gallery have the sections, rows and pictures of the current studies."""

import re
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from studies import direct, gallery, step_tolerance, taper, working_load
from studies.convergence import STUDIES, verification_table
from studies.motions import friction_case
from studies.study import Study

ROOT = Path(__file__).parents[2]
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


def pressed(*_: object) -> SimpleNamespace:
    return SimpleNamespace(boom=build_boom(friction_case()), top=two, shear=two, near=two)


def swung(*_: object) -> SimpleNamespace:
    return SimpleNamespace(measured=two)


def squeezed(*_: object) -> SimpleNamespace:
    return SimpleNamespace(stations=np.ones(2), tip=1.0)


def two(*_: object) -> tuple[float, float]:
    return 1.0, 1.0


def compared(*_: object) -> SimpleNamespace:
    exact = SimpleNamespace(tip=1.0, foot_moment=1.0)
    return SimpleNamespace(tip=1.0, moment=1.0, exact=exact, errors=(0.0, 0.0))


def controlled(kind: step_tolerance.Kind) -> list[step_tolerance.Found]:
    return [step_tolerance.Found(1.0, 1.0, 1) for _ in kind.tolerances]


def one(*_: object) -> float:
    return 1.0


# Study → what of it takes long → what stands in for it here.
STAND_INS: Mapping[str, Mapping[str, object]] = {
    "contact_size": {
        "station_compliances": lambda *_: np.ones(2),
        "support_compliance": lambda _, meshes: np.ones(len(meshes)),
        "first_peaks": lambda _, sizes: np.ones(len(sizes.loads)),
    },
    "working_load": {"measure": moved},
    "direct": {"runs_of": run},
    "stress": {"InnerSegmentState.on_mesh": pressed, "InnerSegmentState.reduced": pressed},
    "stiffeners": {"measure": one, "table": one, "racking_stiffness": one, "ring_flexibility": one},
    "step_tolerance": {"measure": controlled},
    "damping": {"PressedBoom.of": swung, "_system": one},
    "second_order": {},
    "large_deflections": {"compare": compared},
    "telescoping_column": {},
    "design_results": {},
    "sections": {"ring_of_shell": one, "beam_peak": one, "shell_peak": one, "tip_of_shell": one},
    "polygon_distortion": {"of_beam": squeezed, "of_shell": squeezed},
    "taper": {"MODELS": taper.MODELS | {"shell": taper.MODELS[taper.ELEMENTS]}},
}  # fmt: skip
# Studies without a verification have no section; validation has its own page.
TABLES_ALONE = ("surface_contact", "stick_slip", "interpretations", "numerics_1997", "verdicts")
PROVING = [name for name in STUDIES if name not in (*TABLES_ALONE, "validation")]


def row(cells: Sequence[str]) -> tuple[str, str, str]:
    """Return the compared quantity without place, the tolerance, and the kind of reference."""
    return POINT.sub("", cells[0]), cells[4], cells[7]


def sections() -> dict[str, list[tuple[str, str, str]]]:
    """Return the rows of each section by its title."""
    page = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
    return {
        title: [
            row(cells.split(" | ")) for cells in re.findall(r"^\| (?!what|:--)(.*) \|$", rows, re.M)
        ]
        for title, rows in re.findall(r"^## (.*)\n((?:(?!## ).*\n)*)", page, re.M)
    }


def test_sections_follow_the_order_of_the_studies() -> None:
    for name, title in zip(PROVING, sections(), strict=True):
        source = (ROOT / "studies" / f"{name}.py").read_text(encoding="utf-8")
        assert name in STAND_INS or f'"{title}"' in source


def test_facts_that_tests_hold_have_their_tests() -> None:
    """A test of a fact on the page is part of its verification."""
    page = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| .* \| `(tests/[a-z0-9_/]+\.py)`: (.*?) \|", page, re.M)
    assert len(rows) == 22
    for path, tests in rows:
        code = (ROOT / path).read_text(encoding="utf-8")
        assert [name for name in re.findall(r"`(\w+)`", tests) if f"def {name}(" not in code] == []


@pytest.mark.parametrize("name", STAND_INS)
def test_rows_are_those_of_the_study(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: the study, with constants in place of slow computations. Measured values hold."""
    if name == "design_results":
        pytest.importorskip("rainflow", reason="the cycles are counted by it")
    for what, surrogate in STAND_INS[name].items():
        monkeypatch.setattr(f"studies.{name}.{what}", surrogate)
    study: Study = import_module(f"studies.{name}").study(lambda what: None)
    assert sections()[study.title] == [row(cells) for cells in verification_table(study).rows]
    if not STAND_INS[name]:
        assert [
            verification.what for verification in study.verifications if not verification.holds
        ] == []


DOCS = Path(__file__).parents[2] / "docs"
MADE = {*gallery.COPIED, "lift", "mesh", "sections-largest-force", "crane-speeds"}


def test_gallery_page_equals_the_output_of_its_script() -> None:
    page = (DOCS / "gallery.md").read_text(encoding="utf-8")
    shown = re.findall(r"!\[[^]]+\]\(gallery/([a-z-]+)\.png\)\n\n`([^`]+)`", page)
    assert {*re.findall(r"\(gallery/([a-z-]+)\.png\)", page)} >= MADE
    origins = dict(shown)
    for name, (run, picture) in gallery.COPIED.items():
        assert origins[name] == f"runs/out/{run}/{picture}"
    for name, _ in shown:
        path = DOCS / "gallery" / f"{name}.png"
        assert path.stat().st_size < 320_000
        with Image.open(path) as image:
            image.verify()


def test_missing_run_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(gallery, "RUNS", tmp_path / "out")
    monkeypatch.setattr(gallery, "GALLERY", tmp_path / "gallery")
    assert gallery.main() == 2
    missing = tmp_path / "out" / "paper" / "snapshots" / "boom-first-peak.png"
    assert capsys.readouterr().err == (
        f"gallery: {missing}: file: missing; run the case with its shell, or make verify\n"
    )
