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
from protractile.runs.paper.verdicts import Verdict, addition, print_verdicts
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.summary import Snapshots, Summary
from protractile.runs.report.additions import Addition
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.document import render
from protractile.runs.report.figure_context import Figure
from protractile.runs.report.snapshots import Snapshot
from protractile.runs.report.static_charts import draw_chart
from protractile.runs.report.terminal_tables import print_models
from tests.runs.case_texts import shipped
from tests.runs.summaries import changed, model_summary, printed
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


@pytest.fixture
def page(results: Results, figures: list[Figure]) -> Page:
    return Page(report(results, figures))


def tables(results: Results, width: int = 100) -> str:
    models = printed(print_models, results, width=width)
    return models + printed(print_verdicts, {"coarse": judge(results)}, width=width)


def skipping(results: Results, why: str) -> Summary:
    return results.summary.model_copy(update={"snapshots": Snapshots(written={}, skipped=why)})


def test_shows_every_verdict_first(results: Results, page: Page) -> None:
    for verdict in judge(results):
        assert verdict.statement in page.text
        assert verdict.why in page.text
    order = [
        page.text.index(heading) for heading in ("Verdicts", "Motion", "Numerics", "Provenance")
    ]
    assert order == sorted(order)


def test_report_shows_every_model_and_its_source(results: Results, page: Page) -> None:
    cells = re.sub(r"\s+", " ", page.text)
    for name, model in results.summary.models.items():
        assert f"{name} {model.kind}" in cells
    contact = results.summary.models["kantorovich-4"].first_contact
    assert f"{contact:.4f}" in cells
    assert results.summary.case_hash in page.text
    assert results.summary.versions["numpy"] in page.text
    assert toml.dumps(results.case) in page.text


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


def test_links_have_targets(page: Page) -> None:
    """Reference: the ids of the page, which are unique. Every link has a target."""
    ids = [str(attributes["id"]) for _, attributes in page.tags if "id" in attributes]
    assert len(set(ids)) == len(ids)
    links = [str(link["href"]).removeprefix("#") for link in page.all("a")]
    assert set(links) <= set(ids)
    assert set(STATEMENTS) < set(ids)


def test_a_verdict_leads_to_its_evidence(results: Results, figures: list[Figure]) -> None:
    """Reference: S2 concerns the tip, S10 steps, S9 contact laws."""
    text = report(results, figures)
    rows = {key: text[text.index(f'<tr id="{key}">') :].split("</tr>")[0] for key in STATEMENTS}
    found = {key: re.findall(r'href="#([^"]+)">([^<]+)<', row) for key, row in rows.items()}
    assert found["S2"] == [("figure-tip", "Figure\N{NO-BREAK SPACE}1")]
    tables = {key: found[key][0] for key in ("S10", "S9")}
    assert {key: anchor for key, (anchor, _) in tables.items()} == {
        "S10": "table-steps", "S9": "table-laws"
    }  # fmt: skip
    for anchor, label in tables.values():
        heading = text[text.index(f'id="{anchor}"') :]
        assert heading.split("<h3>")[1].startswith(f"{label}. ")
    assert found["S7"] == found["S8"] == []
    assert all(link in text for key in ("S2", "S9") for link, _ in found[key])


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
    lines = {line.split()[0]: line for line in tables(results).splitlines() if line.split()}
    assert re.search(" – +– ", lines["kantorovich-4"])
    assert not re.search(" – +– ", lines["beam-fe-bonded"])


def test_cautions_and_skipped_pictures_are_said(results: Results, figures: list[Figure]) -> None:
    summary = results.summary.model_copy(update={"cautions": ["caution: <of> the tip"]})
    text = Page(report(replace(results, summary=summary), figures)).text
    assert text.index("caution: <of> the tip") < text.index("Verdicts")
    assert "Snapshots" not in Page(report(results, figures)).text
    summary = skipping(results, "no GL here")
    page = Page(report(replace(results, summary=summary), figures))
    assert "Skipped: no GL here" in page.text


def test_escapes_everything(results: Results, figures: list[Figure]) -> None:
    attack = "<script>alert('x')</script> & \"so\""
    case = results.case.model_copy(update={"title": attack})
    verdicts = [replace(verdict, why=attack) for verdict in judge(results)]
    summary = skipping(results, attack)
    page = Page(report(replace(results, case=case, summary=summary), figures, verdicts))
    assert not page.all("script")
    assert page.text.count(attack) == 2 + len(verdicts) + 1  # title, heading; whys; snapshots
    assert page.all("img")[0]["alt"] == "Tip <of> the boom"


def test_report_states_the_demands_of_the_case(results: Results, figures: list[Figure]) -> None:
    case = results.case.model_copy(update={"demand": ("S1",)})
    demanding = replace(results, case=case)
    assert Page(report(demanding, figures)).text.count("(demanded)") == 1
    assert tables(demanding).count("Demanded: S1.") == 1


@pytest.mark.parametrize("width", [80, 100])
def test_terminal_shows_both_tables(results: Results, width: int) -> None:
    shown = tables(results, width).splitlines()
    assert max(map(len, shown)) <= width
    lines = [line.split() for line in shown]
    for name, model in results.summary.models.items():
        (line,) = [words for words in lines if words[:1] == [name] and len(words) > 1]
        assert line[1] == str(model.degrees_of_freedom)
    for verdict in judge(results):
        (line,) = [words for words in lines if words[:1] == [verdict.id]]
        assert verdict.verdict in line


def test_terminal_does_not_read_markup(results: Results) -> None:
    case = results.case.model_copy(update={"title": "[red]play[/nothing]"})
    assert "[red]play[/nothing]" in tables(replace(results, case=case))


def told(results: Results) -> list[str]:
    return cautions(Context.of_run(results))


def test_large_displacement_gives_a_caution(results: Results) -> None:
    assert results.summary.cautions == []
    wild = results.trajectories.copy(deep=True)
    wild["tip"][0, -1] = 2.0
    (line,) = told(replace(results, trajectories=wild))
    name = str(wild["model"].values[0])
    assert line == (
        f"In {name} the tip moves by 2 m, 11 % of the boom's length: small displacements make it "
        "about 1.2 % too large, and moments about 0.72 %, on the safe side."
    )
    wild["tip"][0, -1] = 3.0
    (line,) = told(replace(results, trajectories=wild))
    assert line == (
        f"caution: in {name} the tip moves by 3 m, 16 % of the boom's length: small displacements "
        "make it about 2.7 % too large, and moments about 1.6 %; check units and loads"
    )
    summary = results.summary.model_copy(update={"cautions": [line]})
    assert line in tables(replace(results, summary=summary), width=200)


POOR_REDUCTION = (
    "caution: the reduction of {} to 6 coordinates has an error of 93 % of the local contact "
    "compliance; allow more modes, or --modes auto"
)
REDUCTION = {"contact_compliance": 0.93, "deflections": 0.0}
POOR_MESH = (
    "caution: the mesh of {} causes an error of 34 % of the local contact compliance; give a "
    "smaller mesh_size"
)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"modes": 6, "reduction_errors": REDUCTION | {"contact_compliance": 0.009}}, ""),
        ({"modes": 6, "reduction_errors": REDUCTION}, POOR_REDUCTION),
        ({"mesh_error": None}, ""),
        ({"mesh_error": 0.009}, ""),
        ({"mesh_error": 0.34}, POOR_MESH),
    ],
)
def test_cautions_against_poor_shell(results: Results, changes: dict[str, Any], line: str) -> None:
    name = str(results.trajectories["model"].values[0])
    assert told(changed(results, name, **changes)) == ([line.format(name)] if line else [])


def test_a_mesh_that_follows_its_tolerance_needs_a_smaller_one(results: Results) -> None:
    """Reference: exact words."""
    name = str(results.trajectories["model"].values[0])
    case = results.case.model_copy(update={"models": (Shell(name=name),)})
    poor = replace(changed(results, name, mesh_error=0.34), case=case)
    assert told(poor)[-1] == POOR_MESH.format(name).replace("mesh_size", "contact_tolerance")


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


@pytest.mark.parametrize(
    ("name", "cautioned"), [("crane-telescopes", True), ("crane", False), ("drawn-out", False)]
)
def test_axial_forces_beyond_the_wall_limit_give_a_caution(name: str, cautioned: bool) -> None:
    """Reference: by hand. Only one of these booms has axial forces and telescopes."""
    shell = model_summary().model_copy(update={"stress": object()})
    case = shipped(name)
    models = {"beam": model_summary(), "shell": shell}
    told = [*axial_stresses(Context(case, build_boom(case), models=models))]
    assert [line.partition(" carry ")[0] for line in told] == (
        ["the walls of shell"] if cautioned else []
    )


def test_only_requested_statements_are_judged(results: Results, figures: list[Figure]) -> None:
    other = replace(results, case=results.case.model_copy(update={"statements": ()}))
    one = results.case.model_copy(update={"statements": ("S9",), "demand": ("S1",)})
    assert [verdict.id for verdict in judge(replace(results, case=one))] == ["S1", "S9"]
    assert "Statements of the paper" in tables(results)
    assert "Statements of the paper" not in tables(other)
    assert "Verdicts" in Page(report(results, figures)).text
    assert "Verdicts" not in Page(report(other, figures)).text
