# SPDX-License-Identifier: LGPL-3.0-or-later
"""The report: a self-contained file with escaped content of the run."""

import base64
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from protractile.cases import run_case
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.response import axial_stresses
from protractile.runs.cautions.rules import cautions
from protractile.runs.paper.rules import judge
from protractile.runs.paper.statements import STATEMENTS
from protractile.runs.paper.verdicts import Verdict, addition
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.summary import Snapshots
from protractile.runs.report.additions import Addition
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.document import render
from protractile.runs.report.figure_context import Figure
from protractile.runs.report.snapshots import Snapshot
from protractile.runs.report.static_charts import draw_chart
from protractile.runs.report.terminal_tables import print_models
from tests.runs.case_texts import shipped
from tests.runs.summaries import changed, model_summary, printed, summary_of
from tests.system.run_folder import Page

MODELS = ["kantorovich-4", "kantorovich-5", "beam-fe-bonded"]
GIF = base64.b64decode("R0lGODlhAQABAIAAAP///wAAACwAAAAAAQABAAACAkQBADs=")


@pytest.fixture(scope="module")
def results() -> Results:
    return run_case(shipped("coarse"), MODELS)


@pytest.fixture
def figures() -> list[Figure]:
    curve = Curve("beam <1>", np.array([1.0, 2.0]), "#000000")
    chart = Chart(np.array([0.0, 1.0]), [curve], ["deflection (mm)"])
    title = "Tip <of> the boom"
    return [Figure("tip", title, "A caption & more.", drawing=lambda: draw_chart(chart, title))]


def report(
    results: Results,
    figures: list[Figure],
    verdicts: list[Verdict] | None = None,
    snapshots: Sequence[Snapshot] = (),
) -> str:
    found = judge(results) if verdicts is None else verdicts
    return render(results, addition(results.case, found), figures, snapshots)


def test_a_missing_peak_is_said_to_be_missing(results: Results, figures: list[Figure]) -> None:
    """Reference: the summary. The run ends before the first peak of the series."""
    peaks = {name: model.first_peak["tip"].height for name, model in results.summary.models.items()}
    assert peaks["kantorovich-4"] is None
    assert peaks["beam-fe-bonded"] == pytest.approx(0.0193, rel=0.01)
    text = report(results, figures)
    text = text[text.index('id="table-models"') :]
    shown = r"<tr>\s*<td[^>]*>[^\n]*kantorovich-4</td>.*?</tr>"
    row = re.findall(shown, text, re.DOTALL)[0]
    assert len(re.findall(r"<td[^>]*>–</td>", row)) == 2
    assert "First tip peak –: none within 0.6 s." in text
    terminal = printed(print_models, results, width=80).splitlines()
    assert max(map(len, terminal)) <= 80
    lines = {line.split()[0]: line for line in terminal if line.split()}
    assert re.search(" – +– ", lines["kantorovich-4"])
    assert not re.search(" – +– ", lines["beam-fe-bonded"])


def test_shows_every_verdict_first(results: Results, figures: list[Figure]) -> None:
    """Reference: the run. Every link has a target, whose id is unique."""
    page = Page(report(results, figures))
    for verdict in judge(results):
        assert verdict.statement in page.text
        assert verdict.why in page.text
    order = [
        page.text.index(heading) for heading in ("Verdicts", "Motion", "Numerics", "Provenance")
    ]
    assert order == sorted(order)
    cells = re.sub(r"\s+", " ", page.text)
    for name, model in results.summary.models.items():
        assert f"{name} {model.kind}" in cells
    assert results.summary.case_hash in page.text
    assert results.summary.versions["numpy"] in page.text
    assert toml.dumps(results.case) in page.text
    ids = [str(attributes["id"]) for _, attributes in page.tags if "id" in attributes]
    assert len(set(ids)) == len(ids)
    links = {str(link["href"]).removeprefix("#") for link in page.all("a")}
    assert links | {*STATEMENTS} <= {*ids}


def test_needs_nothing_else(results: Results, figures: list[Figure], tmp_path: Path) -> None:
    motion = tmp_path / "motion.gif"
    motion.write_bytes(GIF)
    page = Page(report(results, figures, snapshots=[Snapshot(motion, "Motion", "It moves.")]))
    assert not [script for script in page.all("script") if "src" in script]
    assert not page.all("link") + page.all("iframe")
    assert all(str(link["href"]).startswith("#") for link in page.all("a"))
    assert "url(" not in page.style
    assert "@import" not in page.style
    sources = [str(picture["src"]) for picture in page.all("img")]
    kinds, pictures = zip(*(source.split(";base64,") for source in sources), strict=True)
    assert kinds == ("data:image/svg+xml", "data:image/gif")
    drawn = ElementTree.fromstring(base64.b64decode(pictures[0]))
    assert {"deflection (mm)", "Tip <of> the boom"} <= {*drawn.itertext()}
    assert base64.b64decode(pictures[1]) == GIF


def test_is_well_formed(results: Results, figures: list[Figure]) -> None:
    text = report(results, figures)
    closed = re.sub(r"<(meta|img)\b([^>]*)>", r"<\1\2/>", text.replace("<!DOCTYPE html>", ""))
    root = ElementTree.fromstring(closed.strip())
    assert root.tag == "html"
    verdicts = next(table for table in root.iter("table") if table.get("class") == "verdicts")
    assert len(list(verdicts.iter("tr"))) - 1 == len(STATEMENTS)
    rows = {
        part.get("id"): len(list(part.iter("tr"))) - 1
        for part in root.iter("div")
        if part.get("class") == "table"
    }
    found = [rows[f"table-{name}"] for name in ("models", "steps", "laws")]
    assert found == [len(MODELS), len(MODELS), 2]


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
    summary = results.summary.model_copy(update=update)
    told = replace(results, case=case, summary=summary)
    page = Page(report(told, figures, verdicts))
    assert not page.all("script")
    # Title, heading; caution; whys; snapshots.
    assert page.text.count(attack) == 2 + 1 + len(verdicts) + 1
    assert page.text.index(f"caution: {attack}") < page.text.index("Verdicts")
    assert f"Skipped: {attack}" in page.text
    assert page.all("img")[0]["alt"] == "Tip <of> the boom"
    assert attack in " ".join(printed(print_models, told, width=250).split())


def told(results: Results) -> list[str]:
    return cautions(Context.of_run(results))


@pytest.mark.parametrize(
    ("tip", "line"),
    [
        (2.0, "In {} the tip moves by 2 m, 11 % of the boom's length: small displacements make it "
         "about 1.2 % too large, and moments about 0.72 %, on the safe side."),
        (3.0, "caution: in {} the tip moves by 3 m, 16 % of the boom's length: small displacements "
         "make it about 2.7 % too large, and moments about 1.6 %; check units and loads"),
    ],
)  # fmt: skip
def test_large_displacement_gives_a_caution(results: Results, tip: float, line: str) -> None:
    """Reference: by hand."""
    wild = results.trajectories.copy(deep=True)
    wild["tip"][0, -1] = tip
    assert told(replace(results, trajectories=wild)) == [line.format("kantorovich-4")]


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
    found = told(Results(case, data, summary))
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
    assert [line.partition(" carry ")[0] for line in told] == (
        ["the walls of shell"] if cautioned else []
    )
