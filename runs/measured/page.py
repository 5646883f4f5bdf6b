# SPDX-License-Identifier: LGPL-3.0-or-later
"""Files of a comparison and of an identification: figures, tables, report, identified case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.typography import join_words
from protractile.runs.case import toml
from protractile.runs.folder.files import write_atomically
from protractile.runs.measured.compare import Comparison
from protractile.runs.measured.fit import CHI_SQUARE_95
from protractile.runs.measured.identify import Identification
from protractile.runs.measured.keys import Channel
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.document import embed
from protractile.runs.report.figure_context import Figure
from protractile.runs.report.figures import write_pictures
from protractile.runs.report.pages import page
from protractile.runs.report.tables import Table

REPORT, CSV, CASE = "report.html", "comparison.csv", "identified.toml"
TEMPLATE = Path(__file__).parent / "templates" / "measured.html"

# Part of a page: heading, tables and figures.
Chapter = tuple[str, Sequence[Table], Sequence[Figure]]


def channel_figures(comparisons: Mapping[str, Comparison]) -> list[Figure]:
    """Return the readings of each channel over time with the curves of models, by their labels."""
    (*_, last) = comparisons.values()
    figures = list[Figure]()
    for number, (channel, _) in enumerate(last.evaluated):
        if channel.table is not None:
            curves = {name: of.evaluated[number][1][0] for name, of in comparisons.items()}
            figures.append(_channel_figure(channel, curves, f"channel-{number + 1}"))
    return figures


def _channel_figure(channel: Channel, curves: Mapping[str, Array], name: str) -> Figure:
    factor, unit = channel.measures.factor, channel.measures.shown_unit
    time, readings = channel.times, factor * channel.readings
    limit = np.full((2, time.size), [[-2.0], [2.0]])
    shown = [Curve("readings", readings, theme.FAINT, "", marker="o")]
    shown += [Curve("", level, theme.FAINT, ":", panel=1) for level in limit]
    for color, (label, values) in zip(theme.PALETTE, curves.items(), strict=False):
        off = (factor * values - readings) / (factor * channel.uncertainty)
        shown += [Curve(label, factor * values, color), Curve("", off, color, panel=1)]
    panels = f"{channel.measures.title} ({unit})", "difference over uncertainty, dotted: ±2"
    caption = "Readings and model, and their difference over the uncertainty."
    chart = Chart(time, shown, panels)
    return Figure(name, channel.name, caption, chart=chart, main=True)


def profile_figure(identification: Identification, key: str, name: str) -> Figure:
    """Return the profile likelihood of an unknown as a figure."""
    values, increases = identification.profile(key)
    limit = np.full(values.size, CHI_SQUARE_95)
    curves = [
        Curve(key, increases, theme.PALETTE[0], marker="o"),
        Curve("", limit, theme.INK, ":", width=1.2),
    ]
    chart = Chart(values, curves, ("increase of χ²",), along=key)
    inside = values[increases <= CHI_SQUARE_95]
    caption = "Increase of χ² with all other unknowns fitted again; dotted: interval of 95 %"
    caption += f", {inside.min():.4g} to {inside.max():.4g}." if inside.size else "."
    return Figure(name, f"Profile of {key}", caption, chart=chart, main=True)


def write_comparison(comparison: Comparison, folder: Path, label: str = "model") -> None:
    """Write table, figures and report of a comparison into an empty folder."""
    figures = channel_figures({label: comparison})
    comparison.frame.to_csv(folder / CSV, float_format="%.9g", lineterminator="\r\n")
    case, few = comparison.residuals.experiment.case, comparison.agreements
    off = [agreement.channel for agreement in few if not agreement.agrees]
    lead = [f"{len(few) - len(off)} of {len(few)} channels agree with the model."]
    lead += [f"Beyond their uncertainty differ: {join_words(off)}."] if off else []
    tables = [comparison.table(), comparison.vibrations()]
    _write_page(
        folder, f"{case.title}: compared with readings", lead, [("Channels", tables, figures)]
    )


def write_identification(
    identification: Identification, folder: Path, profiles: Sequence[str] = ()
) -> None:
    """Write identified case, tables, figures and report of an identification.

    Args:
        folder: an empty folder.
        profiles: keys of the unknowns whose profile likelihood is drawn.
    """
    case, found = identification.case, identification.found
    write_atomically(folder / CASE, toml.dumps(case))
    identification.frame.to_csv(folder / "unknowns.csv", float_format="%.9g")
    both = {"case": identification.before, "identified": identification.after}
    identification.after.frame.to_csv(folder / CSV, float_format="%.9g", lineterminator="\r\n")
    loose = [
        key for key, known in zip(identification.keys, found.determined, strict=True) if not known
    ]
    lead = [f"Identified from {found.residuals.size} readings or features of readings."]
    lead += [f"The readings do not determine {join_words(loose)}."] if loose else []
    curves = [
        profile_figure(identification, key, f"profile-{number}")
        for number, key in enumerate(profiles, start=1)
    ]
    tables = [identification.table()]
    if len(identification.keys) > 1:
        tables.append(identification.correlation_table())
    chapters: list[Chapter] = [
        ("Unknowns", tables, curves),
        (
            "Fit",
            [both["case"].table("Before"), both["identified"].table("After")],
            channel_figures(both),
        ),
        ("What else to measure", [identification.helpful_table()], []),
    ]
    _write_page(folder, f"{case.title}: identified from readings", lead, chapters)


def _write_page(folder: Path, title: str, lead: Sequence[str], chapters: Sequence[Chapter]) -> None:
    figures = [figure for _, _, several in chapters for figure in several]
    write_pictures(figures, folder)
    uris, plots = embed(figures, pictures=True)
    filled = [(heading, [t for t in tables if t.rows], few) for heading, tables, few in chapters]
    text = page(TEMPLATE, uris, title=title, lead=lead, chapters=filled, **plots)
    write_atomically(folder / REPORT, text)
