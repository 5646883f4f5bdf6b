# SPDX-License-Identifier: LGPL-3.0-or-later
"""The command line of a user, also in a process of its own, and the files of every run."""

import json
import os
import subprocess
import sys
import tomllib
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from protractile.runs import cli
from protractile.runs.case.schema import Case

ROOT = Path(__file__).parents[2]
COARSE = str(ROOT / "runs" / "cases" / "coarse.toml")
SERIES = ["kantorovich-4", "kantorovich-5"]


def protractile(*arguments: str | Path) -> int | str | None:
    """Return the exit status of a command."""
    with pytest.raises(SystemExit) as ended:
        cli.main([str(argument) for argument in arguments])
    return ended.value.code


def python(
    *arguments: str | Path,
    folder: Path = ROOT,
    prepare: Callable[[], object] | None = None,
    **environment: str,
) -> subprocess.CompletedProcess[str]:
    """Run Python in a process of its own, which imports this program and is no test worker."""
    outside = {k: v for k, v in os.environ.items() if not k.startswith("PYTEST_")}
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env=outside | {"PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"} | environment,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=prepare,
    )


def write_coarse(folder: Path, duration: float) -> Path:
    """Write the coarse case with a duration in s to case.toml, and return its path."""
    text = Path(COARSE).read_text("utf-8").replace("duration = 0.6", f"duration = {duration:g}")
    (folder / "case.toml").write_text(text, "utf-8")
    return folder / "case.toml"


def files(folder: Path) -> set[str]:
    """All files of a folder, by their paths in it."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def summary_of(folder: Path) -> Any:
    """Return the content of summary.json."""
    return json.loads((folder / "summary.json").read_text(encoding="utf-8"))


def trajectories(folder: Path) -> xr.Dataset:
    """Return the trajectories of a run."""
    return xr.load_dataset(folder / "trajectories.nc", engine="scipy")


class Page(HTMLParser):
    """Parser of tags, all of which must be closed, and of the text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in {"meta", "link", "img", "br", "hr", "input", "col", "wbr"}:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


def check_common_files(folder: Path, models: list[str]) -> None:
    """Check the files that every run writes, whatever its models."""
    case = Case.model_validate(tomllib.loads((folder / "case.toml").read_text(encoding="utf-8")))
    assert [model.name for model in case.models] == models
    data = trajectories(folder)
    assert data["model"].values.tolist() == models
    assert data["time"].values == pytest.approx(1e-3 * np.arange(601), abs=1e-12)
    units = {name: variable.attrs["units"] for name, variable in data.data_vars.items()}
    assert (units["tip"], units.get("contact_force", "N"), units["work"]) == ("m", "N", "J")
    rows = pd.read_csv(folder / "trajectories.csv")
    assert list(rows["model"]) == [name for name in models for _ in range(601)]
    np.testing.assert_allclose(rows["tip"], data["tip"].values.ravel(), rtol=1e-8)
    summary = summary_of(folder)
    assert list(summary["models"]) == models
    judged = folder / "verdicts.json"
    verdicts = json.loads(judged.read_text(encoding="utf-8")) if judged.exists() else []
    assert [verdict["id"] for verdict in verdicts] == list(case.statements)
    page = Page((folder / "report.html").read_text(encoding="utf-8"))
    assert page.open == page.all("link") == []
    sources = [str(attributes["src"]) for _, attributes in page.tags if attributes.get("src")]
    assert all(source.startswith("data:image/") for source in sources)
    snapshots = [source for source in sources if "svg+xml" not in source]
    assert len(snapshots) == len(summary["snapshots"]["written"])
