# SPDX-License-Identifier: LGPL-3.0-or-later
"""Files of a comparison and of an identification: figures, tables, report, identified case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path

import matplotlib

from protractile.geometry.arrays import Array
from protractile.geometry.typography import join_words
from protractile.runs.case import toml
from protractile.runs.folder.files import write_atomically
from protractile.runs.measured.compare import Comparison
from protractile.runs.measured.fit import CHI_SQUARE_95
from protractile.runs.measured.identify import Identification
from protractile.runs.measured.keys import Channel
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve, pack_charts, pack_plotly
from protractile.runs.report.figure_context import Figure, new_sheet
from protractile.runs.report.pages import page
from protractile.runs.report.tables import Table

REPORT, CSV, CASE = "report.html", "comparison.csv", "identified.toml"
TEMPLATE = Path(__file__).parent / "templates" / "measured.html"

# Part of a page: heading, tables and figures.
Chapter = tuple[str, Sequence[Table], Sequence[Figure]]


def draw(comparisons: Mapping[str, Comparison], folder: Path) -> list[Figure]:
    """Draw the readings of each channel over time with the curves of models, by their labels."""
    figures, (*_, last) = list[Figure](), comparisons.values()
    with matplotlib.rc_context(theme.RC):
        for number, (channel, _) in enumerate(last.evaluated):
            if channel.table is not None:
                curves = {name: of.evaluated[number][1][0] for name, of in comparisons.items()}
                figures.append(_draw(channel, curves, folder / f"channel-{number + 1}.png"))
    return figures


def _draw(channel: Channel, curves: Mapping[str, Array], path: Path) -> Figure:
    factor, unit = channel.measures.factor, channel.measures.shown_unit
    time, readings = channel.times, factor * channel.readings
    heading = f"{channel.measures.title} ({unit})"
    sheet, (above, below) = new_sheet(2, 5.0)
    above.plot(time, readings, ".", color=theme.FAINT, markersize=3.0, label="readings")
    shown = [Curve("readings", readings, theme.FAINT)]
    for color, (name, values) in zip(theme.PALETTE, curves.items(), strict=False):
        above.plot(time, factor * values, color=color, linewidth=1.2, label=name)
        off = (factor * values - readings) / (factor * channel.uncertainty)
        below.plot(time, off, color=color, linewidth=1.0)
        shown.append(Curve(name, factor * values, color))
    below.axhspan(-2.0, 2.0, color=theme.FAINT, alpha=0.4, linewidth=0.0)
    above.set_ylabel(heading)
    below.set(ylabel="difference\nover uncertainty", xlabel="time (s)", xlim=time[[0, -1]])
    sheet.legend(*above.get_legend_handles_labels(), loc="outside lower left", ncols=3)
    sheet.savefig(path)
    caption = "Readings and model; in the picture also the difference over the uncertainty."
    return Figure(path, channel.name, caption, chart=Chart(time, heading, shown))


def draw_profile(identification: Identification, key: str, path: Path) -> Figure:
    """Draw the profile likelihood of an unknown."""
    values, increases = identification.profile(key)
    with matplotlib.rc_context(theme.RC):
        sheet, (axes,) = new_sheet(1, 3.2)
        axes.plot(values, increases, "o-", color=theme.PALETTE[0])
        axes.axhline(CHI_SQUARE_95, **theme.LIMIT)
        axes.set(xlabel=key, ylabel="increase of χ²", ylim=(0.0, None))
        sheet.savefig(path)
    inside = values[increases <= CHI_SQUARE_95]
    caption = "Increase of χ² with all other unknowns fitted again; dotted: interval of 95 %"
    caption += f", {inside.min():.4g} to {inside.max():.4g}." if inside.size else "."
    return Figure(path, f"Profile of {key}", caption)


def write_comparison(comparison: Comparison, folder: Path, label: str = "model") -> None:
    """Write table, figures and report of a comparison into an empty folder."""
    figures = draw({label: comparison}, folder)
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
        draw_profile(identification, key, folder / f"profile-{number}.png")
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
            draw(both, folder),
        ),
        ("What else to measure", [identification.helpful_table()], []),
    ]
    _write_page(folder, f"{case.title}: identified from readings", lead, chapters)


def _write_page(folder: Path, title: str, lead: Sequence[str], chapters: Sequence[Chapter]) -> None:
    figures = [figure for _, _, several in chapters for figure in several]
    charts = {f.path.stem: f.chart for f in figures if f.chart} if find_spec("plotly") else {}
    text = page(
        TEMPLATE,
        [figure.path for figure in figures],
        title=title,
        lead=lead,
        chapters=[
            (heading, [t for t in tables if t.rows], few) for heading, tables, few in chapters
        ],
        charts=pack_charts(charts) if charts else "",
        plotly=pack_plotly() if charts else "",
    )
    write_atomically(folder / REPORT, text)
