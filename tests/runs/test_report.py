# SPDX-License-Identifier: LGPL-3.0-or-later
"""Report and files of a run."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import xarray as xr
from pydantic import ValidationError

from protractile.cases import change, run_case
from protractile.dynamics.contact import PowerContact
from protractile.geometry.joint import Stop
from protractile.geometry.station import stations
from protractile.runs.case import reading as case_file
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.response import axial_stresses
from protractile.runs.cautions.rules import add_cautions, cautions
from protractile.runs.paper.rules import judge
from protractile.runs.paper.statements import STATEMENTS
from protractile.runs.paper.verdicts import addition
from protractile.runs.pipeline.design_results import ModelDesignResults
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import Run
from protractile.runs.pipeline.summary import Snapshots, Summary
from protractile.runs.report.additions import Addition
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.document import render
from protractile.runs.report.figure_context import Figure
from protractile.runs.report.output import write, write_csv
from protractile.runs.report.static_charts import draw_chart
from protractile.runs.report.terminal_tables import print_models
from tests.runs.case_texts import shipped
from tests.runs.summaries import changed, finished, model_summary, printed, summary_of
from tests.system.run_folder import Page

MODELS = ["kantorovich-4", "kantorovich-5", "beam-fe-bonded"]


@pytest.fixture(scope="module")
def results() -> Results:
    return run_case(shipped("coarse"), MODELS)


@pytest.fixture
def figures() -> list[Figure]:
    curve = Curve("beam <1>", np.array([1.0, 2.0]), "#000000")
    chart = Chart(np.array([0.0, 1.0]), [curve], ["deflection (mm)"])
    title = "Tip <of> the boom"
    return [Figure("tip", title, "A caption & more.", drawing=lambda: draw_chart(chart, title))]


def report(results: Results, figures: list[Figure]) -> str:
    return render(results, addition(results.case, judge(results)), figures, [])


def test_a_missing_peak_is_said_to_be_missing(results: Results, figures: list[Figure]) -> None:
    """Reference: the summary. The run ends before the first peak of the series."""
    peaks = {name: model.first_peak["tip"].height for name, model in results.summary.models.items()}
    assert peaks["kantorovich-4"] is None
    assert peaks["beam-fe-bonded"] == pytest.approx(0.0193, rel=0.01)
    assert "First tip peak –: none within 0.6 s." in report(results, figures)
    terminal = printed(print_models, results, width=80).splitlines()
    assert max(map(len, terminal)) <= 80
    lines = {line.split()[0]: line for line in terminal if line.split()}
    assert re.search(" – +– ", lines["kantorovich-4"])
    assert not re.search(" – +– ", lines["beam-fe-bonded"])


def test_shows_every_verdict_first(results: Results, figures: list[Figure]) -> None:
    """Reference: the run. Every link has a target, whose id is unique; XML is well-formed.

    The style sheet needs no other file.
    """
    text = report(results, figures)
    page = Page(text)
    for verdict in judge(results):
        assert verdict.statement in page.text
        assert verdict.why in page.text
    headings = [page.text.index(x) for x in ("Verdicts", "Motion", "Numerics", "Provenance")]
    assert headings == sorted(headings)
    assert results.summary.case_hash in page.text
    assert toml.dumps(results.case) in page.text
    ids = [str(attributes["id"]) for _, attributes in page.tags if "id" in attributes]
    assert len(set(ids)) == len(ids)
    links = {str(link["href"]).removeprefix("#") for link in page.all("a")}
    assert links | {*STATEMENTS} <= {*ids}
    closed = re.sub(r"<(meta|img)\b([^>]*)>", r"<\1\2/>", text.replace("<!DOCTYPE html>", ""))
    style = next(ElementTree.fromstring(closed.strip()).iter("style")).text
    assert style
    assert not re.search(r"url\(|@import", style)


def test_a_verdict_leads_to_its_evidence(results: Results, figures: list[Figure]) -> None:
    """Reference: S2 concerns the tip, S10 steps, S9 contact laws; two statements of the case."""
    text = report(results, figures)
    rows = {key: text[text.index(f'<tr id="{key}">') :].split("</tr>")[0] for key in STATEMENTS}
    found = {key: re.findall(r'href="#([^"]+)">([^<]+)<', row) for key, row in rows.items()}
    assert found["S2"] == [("figure-tip", "Figure\N{NO-BREAK SPACE}1")]
    for key, target in (("S10", "table-steps"), ("S9", "table-laws")):
        anchor, label = found[key][0]
        assert anchor == target
        heading = text[text.index(f'id="{anchor}"') :]
        assert heading.split("<h3>")[1].startswith(f"{label}. ")
    assert found["S7"] == found["S8"] == []
    case = results.case.model_copy(update={"statements": ("S9",), "demand": ("S1",)})
    two = replace(results, case=case)
    assert [verdict.id for verdict in judge(two)] == ["S1", "S9"]
    assert Page(report(two, figures)).text.count("(demanded)") == 1
    none = replace(results, case=results.case.model_copy(update={"statements": ()}))
    assert "Verdicts" not in Page(report(none, figures)).text


def test_escapes_everything(results: Results, figures: list[Figure]) -> None:
    attack = "<script>alert('x')</script> & \"so\" [red]play[/nothing]"
    case = results.case.model_copy(update={"title": attack})
    verdicts = [replace(verdict, why=attack) for verdict in judge(results)]
    skipped = Snapshots(written={}, skipped=attack)
    update = {"snapshots": skipped, "cautions": [f"caution: {attack}"]}
    told = replace(results, case=case, summary=results.summary.model_copy(update=update))
    page = Page(render(told, addition(case, verdicts), figures, []))
    assert not page.all("script")
    # Title, heading; caution; whys; snapshots.
    assert page.text.count(attack) == 2 + 1 + len(verdicts) + 1
    assert page.text.index(f"caution: {attack}") < page.text.index("Verdicts")
    assert f"Skipped: {attack}" in page.text
    assert page.all("img")[0]["alt"] == "Tip <of> the boom"
    assert attack in " ".join(printed(print_models, told, width=250).split())


@pytest.mark.parametrize(
    ("tip", "line"),
    [
        (2.0, "In kantorovich-4 the tip moves by 2 m, 11 % of the boom's length: small displacement"
         "s make it about 1.2 % too large, and moments about 0.72 %, on the safe side."),
        (3.0, "caution: in kantorovich-4 the tip moves by 3 m, 16 % of the boom's length: small "
         "displacements make it about 2.7 % too large, and moments about 1.6 %; check units and "
         "loads"),
    ],
)  # fmt: skip
def test_large_displacement_gives_a_caution(results: Results, tip: float, line: str) -> None:
    """Reference: by hand."""
    wild = results.trajectories.copy(deep=True)
    wild["tip"][0, -1] = tip
    assert cautions(Context.of_run(replace(results, trajectories=wild))) == [line]


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"modes": 6, "reduction_errors": {"contact_compliance": 0.009, "deflections": 0.0}}, ""),
        ({"modes": 6, "reduction_errors": {"contact_compliance": 0.93, "deflections": 0.0}},
         "caution: the reduction of shell to 6 coordinates has an error of 93 % of the local "
         "contact compliance; allow more modes, or --modes auto"),
        ({"mesh_error": 0.009}, ""),
        ({"mesh_error": 0.34},
         "caution: the mesh of shell causes an error of 34 % of the local contact compliance; give "
         "a smaller contact_tolerance"),
    ],
)  # fmt: skip
def test_cautions_against_poor_shell(results: Results, changes: dict[str, Any], line: str) -> None:
    """Reference: exact words."""
    case = results.case.model_copy(update={"models": (Shell(name="shell"),)})
    summary = summary_of({"shell": model_summary(**changes)})
    data = results.trajectories.isel(model=[0]).assign_coords(model=["shell"])
    found = cautions(Context.of_run(Results(case, data, summary)))
    assert [one for one in found if "error" in one] == ([line] if line else [])


def test_how_near_a_shell_is_stands_with_its_costs(results: Results) -> None:
    name = str(results.trajectories["model"].values[0])
    errors = {"contact_compliance": 2.4e-9, "deflections": 0.013, "frequency_limit_in_hz": 84.6}
    shell = {"reduction_errors": errors, "mesh_error": 0.26, "seconds": {"reduction": 1.204}}
    page = render(changed(results, name, **shell), Addition(), [], [])
    assert (
        "reduction 1.20 s, relative errors of the reduced shell: local contact compliance "
        "2.4 × 10⁻⁹, deflections of tip and segment heads 0.013, its natural frequencies "
        "are accurate up to 85 Hz, mesh error of the local contact compliance 26 %" in page
    )


@pytest.mark.parametrize(("name", "cautioned"), [("crane-telescopes", True), ("drawn-out", False)])
def test_axial_forces_beyond_the_wall_limit_give_a_caution(name: str, cautioned: bool) -> None:
    """Reference: by hand. Only one of these booms has axial forces and telescopes."""
    shell = model_summary().model_copy(update={"stress": object()})
    case = shipped(name)
    models = {"beam": model_summary(), "shell": shell}
    told = [*axial_stresses(Context(case, build_boom(case), models=models))]
    assert [line.partition(" carry ")[0] for line in told] == ["the walls of shell"] * cautioned


pytestmark = pytest.mark.usefixtures("few_figures")


@pytest.fixture(scope="module")
def run() -> Run:
    case = case_file.select(shipped("coarse"), "", ["kantorovich-4"], None)
    return finished(change(case, **{"time.duration": 0.05}))


def test_the_table_is_pandas_s(run: Run, tmp_path: Path) -> None:
    """Reference: other code, pandas, to the byte. A model without friction has an empty column.

    Columns of stations at one place are distinct.
    """
    plain = run.results.trajectories
    boom = run.results.boom
    places = stations(boom.joints, [Stop(1, 9.0, 0.1, PowerContact(1.0e6))], ["z", "y"])
    names = [station.name for station in places]
    assert names == ["9", "10", "9y", "10y", "9#2"]
    without = plain.assign(friction_force=np.nan * plain["friction_force"])
    data = xr.concat([plain, without], "model").isel(station=[0, 1, 0, 1, 0])
    data = data.assign_coords(model=["a, b", "nan"], place=("station", names))
    write_csv(data, tmp_path / "ours.csv")
    columns = {}
    for name, variable in data.data_vars.items():
        if "station" in variable.dims:
            for number, place in enumerate(names):
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
    assert "cannot be computed (Singular matrix)" in (tmp_path / "report.html").read_text("utf-8")
    assert found.summary.cautions == [
        f"failed: {name}: {why}" for name, why in found.summary.failures.items()
    ]


STORED = Path(__file__).parent / "data" / "summary.json"


def test_keys_and_values_are_unchanged() -> None:
    """Reference: the stored file, to the last digit and in its order, and a title."""
    summary = Summary.load(STORED)
    text = str(summary)
    assert json.dumps(json.loads(text)) == json.dumps(json.loads(STORED.read_text("utf-8")))
    # A list of numbers is one line.
    assert max(map(len, re.findall(r"\d,\n\s*-?\d", text)), default=0) == 0
    title = "Boom [1,   2] and [ 3 ]"
    assert json.loads(str(summary.model_copy(update={"title": title})))["title"] == title


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
    other = json.loads(STORED.read_text("utf-8"))
    other["models"][model][key] = wrong
    (tmp_path / "summary.json").write_text(json.dumps(other), encoding="utf-8")
    with pytest.raises(ValidationError) as refused:
        Summary.load(tmp_path / "summary.json")
    assert refused.value.errors()[0]["loc"][:3] == ("models", model, key)
