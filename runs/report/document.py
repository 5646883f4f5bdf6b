# SPDX-License-Identifier: LGPL-3.0-or-later
"""The report of a run: one self-contained HTML file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from itertools import chain
from typing import Any

import matplotlib

from protractile.geometry.typography import number, percent
from protractile.runs.case import toml
from protractile.runs.pipeline.results import Results
from protractile.runs.report import theme
from protractile.runs.report.additions import Addition
from protractile.runs.report.charts import pack_charts, pack_plotly
from protractile.runs.report.figure_context import Figure
from protractile.runs.report.model_tables import model_tables
from protractile.runs.report.pages import file_uris, page
from protractile.runs.report.predictability import comparison_tables, predictability_tables
from protractile.runs.report.proof_tables import governing_proof
from protractile.runs.report.result_tables import result_tables
from protractile.runs.report.sheet import Snapshot
from protractile.runs.report.static_charts import svg_uri
from protractile.runs.report.summary_table import (
    deviation_note,
    limit_table,
    play_effect,
    summary_table,
    utilisation_verdict,
)
from protractile.runs.report.tables import Table

# Parts of the report in which figures are numbered, in order.
PARTS = "case", "motion", "rest", "snapshots"

# Text for stages of the computation with a name of the program.
_STAGES = {"rows": "contacts and friction"}
# Text for each error of the reduction of a shell.
_REDUCTION_ERRORS = {
    "contact_compliance": "relative errors of the reduced shell: local contact compliance {}",
    "deflections": "deflections of tip and segment heads {}",
    "frequency_limit_in_hz": "its natural frequencies are accurate up to {} Hz",
}


def render(
    results: Results,
    addition: Addition,
    figures: Sequence[Figure],
    snapshots: Sequence[Snapshot],
    viewer: str = "",
    pictures: bool = False,
) -> str:
    """Return the report as one HTML text, which includes all pictures and scripts.

    The main figures, with ``pictures`` all figures, are pictures on paper and for readers without
    JavaScript; so are all if plotly is not installed, which makes figures interactive. Snapshots
    have existing files; ``viewer`` is the file name of the interactive viewer, empty for none.
    """
    texts, proofs = tables_by_part(results) | {"readings": [*addition.tables]}, results.proofs
    shown: dict[str, list[Figure | Snapshot]] = {
        part: [figure for figure in figures if figure.part == part] for part in PARTS
    }
    shown |= {"snapshots": [*snapshots]}
    uris, plots = embed(figures, pictures)
    names = list(results.summary.models)
    line_styles = theme.line_styles(names, [m.name for m in results.case.models if m.bonded])
    return page(
        addition.template,
        uris | file_uris({snapshot.anchor: snapshot.path for snapshot in snapshots}),
        title=results.case.title,
        duration=f"{results.case.time.duration:g}",
        cautions=results.summary.cautions,
        remarks=addition.remarks,
        labels={
            thing.anchor: f"{kind}\N{NO-BREAK SPACE}{i}"
            for kind, several in (("Table", texts), ("Figure", shown))
            for i, thing in enumerate(chain(*several.values()), start=1)
        },
        colors={name: line_styles[name].color for name in names},
        adds=play_effect(results),
        of=results.reference,
        strength=utilisation_verdict(results),
        proved=governing_proof(proofs, results.case.system) if proofs.rows else "",
        deviation=deviation_note(results),
        quality=[note.line for note in results.summary.design.quality_notes],
        viewer=viewer,
        skipped=results.summary.snapshots.skipped,
        versions={k: v for k, v in results.summary.versions.items() if v is not None},
        case_hash=results.summary.case_hash,
        costs=_costs(results),
        case_text=toml.dumps(results.case),
        **plots,
        **texts,
        **shown,
        **addition.content,
    )


def figure_page(
    title: str, figures: Sequence[Figure], tables: Sequence[Table] = (), lead: Sequence[str] = ()
) -> str:
    """Return a page of sentences, tables that have rows, and figures as one HTML text."""
    uris, plots = embed(figures, pictures=False)
    filled = [table for table in tables if table.rows]
    content: dict[str, Any] = {"title": title, "lead": lead, "tables": filled, "figures": figures}
    return page("figures.html", uris, **content, **plots)


def embed(figures: Sequence[Figure], pictures: bool) -> tuple[dict[str, str], dict[str, Any]]:
    """Return the data URIs of pictures of figures by their anchors, and the data of their charts.

    The charts are variables of templates. Without ``pictures`` only the main figures and those
    without an interactive chart have pictures.
    """
    charts = {f.name: f.chart for f in figures if f.chart} if find_spec("plotly") else {}
    with matplotlib.rc_context(theme.RC):
        uris = {
            figure.anchor: svg_uri(figure.draw())
            for figure in figures
            if pictures or figure.main or figure.name not in charts
        }
    return uris, {
        "interactive": [*charts],
        "charts": pack_charts(charts) if charts else "",
        "plotly": pack_plotly() if charts else "",
    }


def tables_by_part(results: Results) -> dict[str, list[Table]]:
    """Return the tables of each part of the report, without empty ones."""
    tables: dict[str, list[Table]] = {
        "summary": [*filter(None, (summary_table(results), limit_table(results)))],
        "results": result_tables(results),
        "predictability": predictability_tables(results),
        "compared": comparison_tables(results),
        "models": model_tables(results),
    }
    return {part: [table for table in several if table.rows] for part, several in tables.items()}


def _costs(results: Results) -> Mapping[str, str]:
    """Return a text on stages, computing times and reduction errors for each model."""
    costs = {}
    for name, model in results.summary.models.items():
        parts = [
            f"{_STAGES.get(stage, stage)} {seconds:.2f} s"
            for stage, seconds in model.seconds.items()
        ]
        parts += [
            text.format(number(error, 2))
            for key, text in _REDUCTION_ERRORS.items()
            if (error := model.reduction_errors.get(key)) is not None
        ]
        if error := model.mesh_error:
            parts.append(f"mesh error of the local contact compliance {percent(error, 2)}")
        costs[name] = ", ".join(parts)
    return costs
