# SPDX-License-Identifier: LGPL-3.0-or-later
"""The command line of a user, and the required files of every run."""

import csv
import json
import tomllib
from collections.abc import Sequence
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from PIL import Image

from runs import cli
from runs.case.schema import Case

ROOT = Path(__file__).parents[2]
COARSE = str(ROOT / "runs" / "cases" / "coarse.toml")
SERIES = ["kantorovich-4", "kantorovich-5"]


def protractile(*arguments: str | Path) -> int | str | None:
    """Return the exit status of a command."""
    with pytest.raises(SystemExit) as ended:
        cli.main([str(argument) for argument in arguments])
    return ended.value.code


def files(folder: Path) -> set[str]:
    """All files of a folder, by their paths in it."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def summary_of(folder: Path) -> Any:
    """Return the content of summary.json."""
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def trajectories(folder: Path) -> xr.Dataset:
    """Return the trajectories of a run."""
    return xr.load_dataset(folder / "trajectories.nc", engine="scipy")


class _Page(HTMLParser):
    """Parser of unclosed tags, and of external resources of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.fetched: list[str] = []
        self.pictures = 0

    def handle_starttag(self, tag: str, attrs: Sequence[tuple[str, str | None]]) -> None:
        if tag not in {"meta", "link", "img", "br", "hr", "input", "col", "wbr"}:
            self.open.append(tag)
        source = dict(attrs).get("src") or ""
        if tag == "img" and source.startswith("data:image/"):
            self.pictures += 1
        elif source or tag == "link":
            self.fetched.append(source)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def check_common_files(folder: Path, models: list[str]) -> None:
    """Check the files that every run writes, whatever its models."""
    case = Case.model_validate(tomllib.loads((folder / "case.toml").read_text(encoding="utf-8")))
    assert [model.name for model in case.models] == models
    data = trajectories(folder)
    assert data["model"].values.tolist() == models
    assert data["time"].values == pytest.approx(1e-3 * np.arange(601), abs=1e-12)
    units = {name: variable.attrs["units"] for name, variable in data.data_vars.items()}
    assert (units["tip"], units.get("contact_force", "N"), units["work"]) == ("m", "N", "J")
    with (folder / "trajectories.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 601 * len(models)
    last = data.isel(model=-1, time=-1)
    assert rows[-1]["model"] == models[-1]
    assert float(rows[-1]["tip"]) == pytest.approx(float(last["tip"]), rel=1e-8)
    summary = summary_of(folder)
    assert list(summary["models"]) == models
    judged = folder / "verdicts.json"
    verdicts = json.loads(judged.read_text(encoding="utf-8")) if judged.exists() else []
    assert [verdict["id"] for verdict in verdicts] == list(case.statements)
    for picture in (folder / "figures").iterdir():
        with Image.open(picture) as image:
            image.verify()
    page = _Page()
    page.feed((folder / "report.html").read_text(encoding="utf-8"))
    assert (page.open, page.fetched) == ([], [])
    pictures = [*(folder / "figures").iterdir(), *summary["snapshots"]["written"]]
    assert page.pictures == len(pictures)
