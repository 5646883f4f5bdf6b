# SPDX-License-Identifier: LGPL-3.0-or-later
"""Folder of a run: its files, its report, its summary, and unique names of columns."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from pydantic import ValidationError

from protractile.cases import change
from protractile.dynamics.contact import PowerContact
from protractile.geometry.joint import Stop
from protractile.geometry.station import stations
from protractile.runs.case import reading as case_file
from protractile.runs.cautions.rules import add_cautions
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.design_results import ModelDesignResults
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import Run
from protractile.runs.pipeline.summary import Summary
from protractile.runs.report.additions import Addition, judge
from protractile.runs.report.output import write, write_csv
from tests.runs.case_texts import shipped
from tests.runs.summaries import finished, model_summary, summary_of

pytestmark = pytest.mark.usefixtures("few_figures")


@pytest.fixture(scope="module")
def run() -> Run:
    case = case_file.select(shipped("coarse"), "", ["kantorovich-4"], None)
    return finished(change(case, **{"time.duration": 0.05}))


@pytest.fixture
def folder(run: Run, tmp_path: Path, few_figures: None) -> Path:
    out = tmp_path / "out"
    out.mkdir()
    write(run, judge(run.results), out)
    return out


def header(folder: Path) -> list[str]:
    return [*pd.read_csv(folder / "trajectories.csv", nrows=0).columns]


def test_columns_of_stations_are_distinct(run: Run, folder: Path, tmp_path: Path) -> None:
    plain = run.results.trajectories
    places = [("9", "z"), ("10", "z"), ("9", "y"), ("10", "y"), ("9", "z")]
    rest = Stop(1, 9.0, 0.1, PowerContact(1.0e6))
    stations_in_space = stations(run.results.boom.joints, [rest], ["z", "y"])
    names = [station.name for station in stations_in_space]
    assert names == ["9", "10", "9y", "10y", "9#2"]
    data = plain.isel(station=[0, 1, 0, 1, 0]).assign_coords(
        direction=("station", [direction for _, direction in places]), place=("station", names)
    )
    in_space = replace(run, results=replace(run.results, trajectories=data))
    out = tmp_path / "in space"
    out.mkdir()
    write(in_space, Addition(), out)
    gaps = [name for name in header(out) if name.startswith("gap@")]
    assert gaps == ["gap@9", "gap@10", "gap@9y", "gap@10y", "gap@9#2"]
    assert [name for name in header(folder) if name.startswith("gap@")] == ["gap@9", "gap@10"]


def test_the_table_is_pandas_s(run: Run, tmp_path: Path) -> None:
    """Reference: other code, pandas, to the byte. A model without friction has an empty column."""
    plain = run.results.trajectories
    data = xr.concat(
        [plain, plain.assign(friction_force=np.nan * plain["friction_force"])], "model"
    )
    data = data.assign_coords(model=["a, b", "nan"])
    write_csv(data, tmp_path / "ours.csv")
    columns = {}
    for name, variable in data.data_vars.items():
        if "station" in variable.dims:
            for number, place in enumerate(data["place"].values):
                columns[f"{name}@{place}"] = variable.isel(station=number, drop=True)
        else:
            columns[str(name)] = variable
    table = xr.Dataset(columns).to_dataframe(["model", "time"])
    table.to_csv(tmp_path / "theirs.csv", float_format="%.9g", lineterminator="\r\n")
    assert (tmp_path / "ours.csv").read_bytes() == (tmp_path / "theirs.csv").read_bytes()


def test_model_without_design_results_keeps_its_motion(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: the trajectory. Files and report are still written."""

    def singular(*_: object) -> ModelDesignResults:
        raise np.linalg.LinAlgError("Singular matrix")

    monkeypatch.setattr("protractile.runs.pipeline.run.evaluate_both", singular)
    again = replace(run, results=replace(run.results, summary=run.results.summary.model_copy()))
    again.results.summary.failures = {}
    again.evaluate()
    add_cautions(again.results)
    write(again, Addition(), tmp_path)
    found = Results.load(tmp_path)
    xr.testing.assert_identical(found.trajectories.load(), run.results.trajectories)
    assert found.summary.failures == {
        "kantorovich-4": "cannot be computed (Singular matrix); look for an extreme number of "
        "the case, for example in another unit"
    }
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "cannot be computed (Singular matrix)" in page
    assert found.summary.cautions == [
        f"failed: {name}: {why}" for name, why in found.summary.failures.items()
    ]


# All keys of a summary.
STORED = Path(__file__).parent / "data" / "summary.json"


def content() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(STORED.read_text(encoding="utf-8"))
    return found


def test_keys_and_values_are_unchanged() -> None:
    """Reference: the stored file, to the last digit and in its order."""
    text = str(Summary.load(STORED))
    assert json.dumps(json.loads(text)) == json.dumps(content())
    # A list of numbers is one line.
    assert max(map(len, re.findall(r"\d,\n\s*-?\d", text)), default=0) == 0


def test_a_title_keeps_its_brackets() -> None:
    """Reference: the title."""
    title = "Boom [1,   2] and [ 3 ]"
    summary = Summary.load(STORED).model_copy(update={"title": title})
    assert json.loads(str(summary))["title"] == title


def test_a_summary_comes_back_from_a_cache(tmp_path: Path) -> None:
    summary = Summary.load(STORED)
    Cache(tmp_path).store("a", summary)
    assert str(Cache(tmp_path).load("a", Summary)) == str(summary)


def test_values_that_are_not_finite_are_null() -> None:
    nan, infinite = float("nan"), float("inf")
    model = model_summary(first_contact=nan, first_peak={"tip": (nan, nan)})
    model.mesh_error = infinite
    found = json.loads(str(summary_of({"boom": model})))["models"]["boom"]
    assert (found["first_contact"], found["first_peak"]["tip"]) == (None, [None, None])
    assert found["mesh_error"] is None
    assert "step_error" not in found


@pytest.mark.parametrize(
    ("model", "key", "wrong"),
    [
        ("shell", "steps", None), ("shell", "kind", 3), ("kantorovich-4", "ensemble", {}),
        ("beam-fe-bonded", "first_peak", {"tip": [1.0]}), ("shell", "stress", {"von_mises": 1.0}),
        ("shell", "colour", "red"),
    ],
)  # fmt: skip
def test_another_version_s_is_refused(tmp_path: Path, model: str, key: str, wrong: Any) -> None:
    other = content()
    other["models"][model][key] = wrong
    (tmp_path / "summary.json").write_text(json.dumps(other), encoding="utf-8")
    with pytest.raises(ValidationError) as refused:
        Summary.load(tmp_path / "summary.json")
    assert refused.value.errors()[0]["loc"][:3] == ("models", model, key)
