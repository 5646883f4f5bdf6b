# SPDX-License-Identifier: LGPL-3.0-or-later
"""Files of a comparison and of an identification: figures, tables, report, identified case.

A prediction adds those of :mod:`.runs.sweep.sampling`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from protractile.geometry.typography import join_words
from protractile.runs.case import toml
from protractile.runs.folder.files import write_atomically
from protractile.runs.measured.compare import AGREES, Comparison
from protractile.runs.measured.fit import CHI_SQUARE_95
from protractile.runs.measured.identify import Identification
from protractile.runs.process import workers
from protractile.runs.process.terminal import Progress, Terminal
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.document import figure_page
from protractile.runs.report.figure_context import Figure
from protractile.runs.report.figures import write_pictures
from protractile.runs.sweep.run import prepare, run_points
from protractile.runs.sweep.sampling import conclude_samples, normal_points, plan_points

REPORT, CSV, CASE = "report.html", "comparison.csv", "identified.toml"


def channel_figures(comparisons: Mapping[str, Comparison]) -> Iterator[Figure]:
    """Yield the readings of each channel over time with the curves of models, by their labels."""
    (*_, last) = comparisons.values()
    for number, (channel, _) in enumerate(last.evaluated):
        if channel.table is None:
            continue
        factor, unit = channel.measures.factor, channel.measures.shown_unit
        readings, limit = channel.readings, np.full(channel.times.size, AGREES)
        curves = [Curve("readings", factor * readings, theme.FAINT, "", marker="o")]
        curves += [Curve("", level, theme.FAINT, ":", panel=1) for level in (limit, -limit)]
        for color, (label, of) in zip(theme.PALETTE, comparisons.items(), strict=False):
            values = of.evaluated[number][1][0]
            off = (values - readings) / channel.uncertainty
            curves += [Curve(label, factor * values, color), Curve("", off, color, panel=1)]
        difference = f"difference over uncertainty, dotted: ±{AGREES:g}"
        chart = Chart(channel.times, curves, (f"{channel.measures.title} ({unit})", difference))
        caption = f"{channel.name}: readings and model, and their difference over the uncertainty."
        yield Figure(f"channel-{number + 1}", channel.name, caption, chart=chart, main=True)


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


def write_comparison(comparison: Comparison, folder: Path) -> None:
    """Write table, figures and report of a comparison into an empty folder."""
    figures = [*channel_figures({"model": comparison})]
    few = comparison.agreements
    off = [agreement.channel.name for agreement in few if not agreement.agrees]
    lead = [f"{len(few) - len(off)} of {len(few)} channels agree with the model."]
    lead += [f"Beyond their uncertainty differ: {join_words(off)}."] if off else []
    title = f"{comparison.residuals.experiment.case.title}: compared with readings"
    write_pictures(figures, folder)
    write_atomically(folder / REPORT, figure_page(title, figures, comparison.tables, lead))
    comparison.frame.to_csv(folder / CSV, float_format="%.9g", lineterminator="\r\n")


def write_identification(
    identification: Identification, folder: Path, profiles: Sequence[str] = ()
) -> None:
    """Write identified case, tables, figures and report of an identification.

    Args:
        folder: an empty folder.
        profiles: keys of the unknowns whose profile likelihood is drawn.
    """
    case, found, after = identification.case, identification.found, identification.after
    figures = [
        profile_figure(identification, key, f"profile-{number}")
        for number, key in enumerate(profiles, start=1)
    ]
    figures += channel_figures({"case": identification.before, "identified": after})
    loose = [
        key for key, known in zip(identification.keys, found.determined, strict=True) if not known
    ]
    lead = [f"Identified from {found.residuals.size} readings or features of readings."]
    lead += [f"The readings do not determine {join_words(loose)}."] if loose else []
    tables = [*identification.tables, identification.before.table("Model and readings before")]
    title = f"{case.title}: identified from readings"
    write_pictures(figures, folder)
    write_atomically(folder / REPORT, figure_page(title, figures, tables, lead))
    write_atomically(folder / CASE, toml.dumps(case))
    identification.frame.to_csv(folder / "unknowns.csv", float_format="%.9g")
    after.frame.to_csv(folder / CSV, float_format="%.9g", lineterminator="\r\n")


def predict(found: Identification, count: int, folder: Path, progress: Progress) -> None:
    """Run samples of the identified numbers, print the scatter of results, and write its files.

    Samples have the identified values as means and the covariance of the fit; those beyond a bound
    are moved to it.

    Args:
        found: identified numbers of a case.
        count: number of samples, checked by :func:`.runs.sweep.sampling.check_count`.
        folder: folder of the files of :mod:`.runs.sweep.sampling`.
        progress: callback that receives model, stage and completed fraction.

    Raises:
        BadInput: a sample is invalid.
    """
    fit, experiment = found.found, found.residuals.experiment
    root = np.linalg.cholesky(fit.covariance_with())
    points = normal_points(fit.values.size, count)
    values = np.clip(fit.values + points @ root.T, fit.low, fit.high)
    # The time offset of a channel does not change the boom.
    settings = experiment.variations(found.residuals.settings(fit.values))
    of_boom = [found.keys.index(variation.key) for variation, _ in settings]
    plan, samples = plan_points(
        found.case, experiment.file, [experiment.whole.models[0].name], None,
        [variation for variation, _ in settings], values[:, of_boom],
    )  # fmt: skip
    with TemporaryDirectory() as temporary, workers.workers(None) as pool:
        prepare(Path(temporary), experiment.file)
        outcomes = run_points(plan, Path(temporary), pool, progress)
    conclude_samples(samples, plan, outcomes, folder, Terminal())
