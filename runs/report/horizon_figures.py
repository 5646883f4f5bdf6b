# SPDX-License-Identifier: LGPL-3.0-or-later
"""What can be known of a chaotic motion: its slow peaks, and how long it can be predicted."""

from __future__ import annotations

import numpy as np

from geometry.typography import TO_MILLI
from runs.report import theme
from runs.report.figure_context import Figure, Pen, new_sheet

# A stroke for each part of the range.
DASHES = ("-", ":", "--")


def slow_peaks(pen: Pen) -> list[Figure]:
    """The peaks of the slow motion that all members of an ensemble share, with their spreads."""
    found = {
        name: peaks
        for name in pen.with_play
        if (ensemble := pen.summary[name].ensemble)
        and (peaks := ensemble.slow_peaks)
        and peaks.time
    }
    if not found:
        return []
    sheet, (axes,) = new_sheet(1, 3.9)
    for name, peaks in found.items():
        stroke = pen.strokes[name]
        axes.errorbar(
            peaks.time,
            TO_MILLI * np.array(peaks.height),
            xerr=peaks.time_spread,
            yerr=TO_MILLI * np.array(peaks.height_spread),
            color=stroke.color,
            linestyle=stroke.linestyle,
            linewidth=0.7,
            elinewidth=1.6,
            marker="o",
            markersize=4.0,
            label=name,
        )
    axes.set(xlabel="time (s)", ylabel="height (mm)", xlim=(0.0, pen.time[-1]))
    counts = [len(peaks.time) for peaks in found.values()]
    number = f"{min(counts)} to {max(counts)}" if min(counts) < max(counts) else f"{counts[0]}"
    caption = (
        "Peaks of the tip's slow motion, each with half the distance between the first and the "
        "last, the lowest and the highest of the ensemble's members. A model's points end where "
        "not all its members have the next peak."
    )
    title = f"Slow peaks: {number} are common to all members"
    return [pen.finish(sheet, axes, "slow-peaks", title, caption, "knowledge")]


def horizons(pen: Pen) -> list[Figure]:
    """Horizon against the size of the change, of each model whose growth has been measured."""
    measured = {name: found for name in pen.with_play if (found := pen.summary[name].horizons)}
    if not measured:
        return []
    sheet, (axes,) = new_sheet(1, 3.9)
    shares: dict[float, str] = {}
    for name, found in measured.items():
        color = pen.strokes[name].color
        logs = np.log10(found.relatives)
        times = np.array(found.times, dtype=float)
        for i, (share, dashes) in enumerate(zip(found.shares, DASHES, strict=False)):
            shares[share] = dashes
            axes.plot(logs, times[:, i], color=color, linestyle=dashes, marker="o", markersize=4.5)
            of_step = found.of_step[i]
            if of_step is not None:
                axes.plot(logs[0], of_step, "s", color=color, mfc="white", ms=7, mew=1.4, zorder=4)
        axes.plot([], [], color=color, marker="o", markersize=4.5, label=name)
    for share, dashes in shares.items():
        axes.plot([], [], color=theme.INK, linestyle=dashes, label=f"{100.0 * share:g} %")
    axes.plot([], [], "s", color=theme.INK, mfc="white", ms=7, mew=1.4, label="finer step")
    axes.set(xlabel="log₁₀ of the relative change", ylabel="horizon (s)")
    axes.set_ylim(bottom=0.0)
    caption = (
        "When ensembles whose data change by so much are parts of the tip's range apart. The "
        "flatter a line, the less better data buy. Squares, at the smallest change: when a run "
        "with a finer step is as far from the run; below the line's end a finer step would help."
    )
    title = "Horizons: how long a motion can be predicted"
    return [pen.finish(sheet, axes, "horizons", title, caption, "knowledge")]
