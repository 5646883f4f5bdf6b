# SPDX-License-Identifier: LGPL-3.0-or-later
"""A run for reading: one HTML file that needs nothing else, and the tables of the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib.util import find_spec
from itertools import chain

from runs.case import toml
from runs.pipeline.results import Results
from runs.report import theme
from runs.report.answer_tables import answer_tables
from runs.report.calibration_tables import calibration_tables
from runs.report.charts import packed_charts, packed_plotly
from runs.report.figure_context import Figure
from runs.report.first_look import first_look
from runs.report.knowledge import compared_tables, known_tables
from runs.report.model_tables import model_tables
from runs.report.numerals import number
from runs.report.pages import Addition, page
from runs.report.stress_tables import wall_tables
from runs.report.tables import Table, TextTable

# Kinds of pictures in the order of their numbers.
PARTS = "case", "motion", "rest", "snapshots", "knowledge", "numerics"


def render(
    results: Results,
    addition: Addition,
    figures: Sequence[Figure],
    snapshots: Sequence[Figure],
    viewer: str = "",
) -> str:
    """The report as HTML: every picture and script inside, no resource from elsewhere.

    Args:
        results: one run.
        addition: of a client.
        figures: on disk.
        snapshots: on disk.
        viewer: file beside the report, in which the boom can be turned.

    Where plotly is not installed the pictures of curves stand alone.
    """
    look = first_look(results)
    tables: dict[str, list[Table]] = {
        "first": [look.answers] if look.answers else [],
        "answers": answer_tables(results),
        "known": known_tables(results),
        "compared": compared_tables(results),
        "added": [],
        "models": [*model_tables(results), *calibration_tables(results), *wall_tables(results)],
    }
    texts = {
        part: [text for table in several if (text := table.text).rows]
        for part, several in tables.items()
    }
    texts |= {"added": [*addition.tables]}
    pictures = {part: [figure for figure in figures if figure.part == part] for part in PARTS}
    pictures |= {"snapshots": [*snapshots]}
    shown = [
        *_numbered("Table", chain(*texts.values())),
        *_numbered("Figure", chain(*pictures.values())),
    ]
    charts = {f.path.stem: f.chart for f in figures if f.chart} if find_spec("plotly") else {}
    costs = _costs(results)
    names = list(results.summary.models)
    strokes = theme.strokes(names, [m.name for m in results.case.models if m.play_free])
    return page(
        addition.template,
        title=results.case.title,
        duration=f"{results.case.time.duration:g}",
        cautions=results.summary.cautions,
        remarks=addition.remarks,
        labels={thing.anchor: label for thing, label in shown},
        colors={name: strokes[name].color for name in names},
        look=look,
        trust=[known.line for known in results.summary.answers.trust],
        viewer=viewer,
        charts=packed_charts(charts) if charts else "",
        plotly=packed_plotly() if charts else "",
        skipped=results.summary.snapshots.skipped,
        versions={k: v for k, v in results.summary.versions.items() if v is not None},
        case_hash=results.summary.case_hash,
        costs=costs,
        case_text=toml.dumps(results.case),
        **texts,
        **pictures,
        **addition.content,
    )


def _numbered(
    kind: str, things: Iterable[TextTable | Figure]
) -> list[tuple[TextTable | Figure, str]]:
    """Each with what the text calls it, *Table 1* and so forth; the blank does not break."""
    return [(thing, f"{kind}\N{NO-BREAK SPACE}{i}") for i, thing in enumerate(things, start=1)]


def _costs(results: Results) -> Mapping[str, str]:
    """What each model's stages took, and how near a reduction is."""
    costs = {}
    for name, model in results.summary.models.items():
        parts = [f"{stage} {seconds:.2f} s" for stage, seconds in model.seconds.items()]
        errors = dict(model.reduction_errors)
        right_to = errors.pop("frequency_limit_in_hz", None)
        parts += [
            f"{what.replace('_', ' ')} of the reduction within {number(error, 2)}"
            for what, error in errors.items()
        ]
        if right_to is not None:
            parts.append(f"its modes right up to {number(right_to, 2)} Hz")
        if error := model.mesh_error:
            off = number(100.0 * error, 2)
            parts.append(f"local compliance {off} % off an infinitely fine mesh's")
        costs[name] = ", ".join(parts)
    return costs
