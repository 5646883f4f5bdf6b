# SPDX-License-Identifier: LGPL-3.0-or-later
"""The gallery and its script: the same pictures, each with its source."""

import re
from pathlib import Path

import pytest
from PIL import Image

from studies import gallery

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
