# SPDX-License-Identifier: LGPL-3.0-or-later
"""Forces and stresses over time: contact and friction at stations, drives, stresses near these."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from geometry.arrays import Array
from geometry.typography import TO_KILO, TO_MEGA, TO_MILLI
from runs.report import theme
from runs.report.charts import Chart
from runs.report.figure_context import (
    Figure,
    Pen,
    farthest,
    highest,
    new_sheet,
    no_closer,
    of_start,
)
from runs.report.numerals import fixed

# Over a whole run only the maximum of each of this number of intervals is visible.
FORCE_BINS = 100
# Contact forces below this value in N count as zero in a picture.
LEAST_FORCE = 1000.0
# Impacts follow one another within milliseconds; the mean over this time in s supports the boom.
FORCE_WINDOW = 0.010
# Labels of a logarithmic axis that fit a panel of two inches.
MOST_LABELS = 7
# Margin above the largest and below the smallest mark, as a factor.
LOG_MARGIN = 1.2


def first_contacts(pen: Pen) -> list[Figure]:
    """Draw the mean contact force at each station while single contacts are distinguishable."""
    if not _touches(pen):
        return []
    end = pen.first_stretch
    shown = pen.time <= end
    stations = pen.stations()
    sheet, panels = pen.over_time(len(stations), 1.3 + 2.0 * len(stations), end)
    curves = []
    for i, (axes, station) in enumerate(zip(panels, stations, strict=True)):
        for name in pen.with_play:
            mean = running_mean(pen, pen.of(name, "contact_force")[:, i] * TO_KILO)
            pen.line(axes, name, pen.time[shown], mean[shown], linewidth=1.3)
            curves.append(pen.curve(name, mean, i))
        axes.set(title=station, ylabel="force (kN)")
        no_closer(axes)
    title = f"Mean contact forces, first {end:g} s"
    caption = (
        f"Contact force at each station, mean over {TO_MILLI * FORCE_WINDOW:g} ms"
        + ("" if pen.stays_pressed else ": what the many short impacts of a press amount to")
        + ". Positive where the inner segment presses up."
        + of_start(pen.case)
    )
    chart = Chart(pen.time, "force (kN)", curves, stations, (0.0, end))
    return [pen.finish(sheet, panels[0], "contact-first", title, caption, chart=chart)]


def contact_peaks(pen: Pen) -> list[Figure]:
    """Draw the maximum contact force at each station in each interval of the run."""
    if not _touches(pen):
        return []
    bins = np.array_split(np.arange(pen.time.size), min(FORCE_BINS, pen.time.size))
    middle = np.array([pen.time[part].mean() for part in bins])
    stations = pen.stations()
    sheet, panels = pen.over_time(len(stations), 1.3 + 2.0 * len(stations), share_y=True)
    drawn = []
    for i, (axes, station) in enumerate(zip(panels, stations, strict=True)):
        for name in pen.with_play:
            force = np.abs(pen.of(name, "contact_force_peak")[:, i])
            largest = np.array([highest(force[part]) for part in bins])
            largest[~(largest > LEAST_FORCE)] = np.nan
            drawn.append(largest * TO_KILO)
            pen.line(axes, name, middle, largest * TO_KILO, linewidth=1.1, marker="o")
        axes.set(title=station, ylabel="force (kN)")
    _log_scale(panels, np.concatenate(drawn))
    peaks = [pen.summary[name].peak_contact_force for name in pen.with_play]
    known = [peak for peak in peaks if peak is not None]
    title = "Peak contact forces" + (f": up to {max(known) * TO_KILO:.0f} kN" if known else "")
    caption = (
        f"Largest contact force at each station in every {pen.time[-1] / len(bins):.2g} s, up or "
        f"down, on a logarithmic scale; no mark where it stays below {LEAST_FORCE * TO_KILO:g} kN."
        + of_start(pen.case)
    )
    return [pen.finish(sheet, panels[0], "contact-peaks", title, caption)]


def friction(pen: Pen) -> list[Figure]:
    """Draw the friction force at each station of the most detailed model with friction."""
    if "friction_force" not in pen.data or not pen.with_play:
        return []
    name = pen.with_play[-1]
    force = np.nan_to_num(pen.of(name, "friction_force")) * TO_KILO
    places = [(i, label) for i, label in enumerate(pen.stations()) if force[:, i].any()]
    if not places:
        return []
    sheet, panels = pen.over_time(len(places), 1.1 + 1.8 * len(places))
    for axes, (i, station) in zip(panels, places, strict=True):
        pen.line(axes, name, pen.time, running_mean(pen, force[:, i]), linewidth=1.1, alone=True)
        axes.set(title=station, ylabel="force (kN)")
    caption = (
        f"Force of dry friction on {name} at each station, mean over "
        f"{TO_MILLI * FORCE_WINDOW:g} ms. Positive where it pushes the inner segment up. Where the "
        "segments stick, it is what holds them, and less than the coefficient times the normal "
        "force."
    )
    title = f"{name}: friction forces up to {highest(np.abs(force).ravel()):.2g} kN"
    return [pen.finish(sheet, None, "friction", title, caption)]


def running_mean(pen: Pen, force: Array) -> Array:
    """Return the running mean (num_times,) over the window of impacts, at most over the run."""
    width = min(max(1, round(FORCE_WINDOW / (pen.time[1] - pen.time[0]))), force.size)
    window = np.ones(width)
    held = np.convolve(np.ones(force.size), window, mode="same")
    return np.convolve(force, window, mode="same") / held


def _touches(pen: Pen) -> bool:
    return bool(pen.with_play) and bool(pen.data.sizes["station"])


def _log_scale(panels: Sequence[Axes], values: Array) -> None:
    """Set one logarithmic scale for all panels, with labels however few decades it spans."""
    known = values[np.isfinite(values)]
    if known.size == 0:
        return
    low, high = known.min() / LOG_MARGIN, known.max() * LOG_MARGIN
    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
    for steps in ((1.0, 2.0, 5.0), (1.0, 3.0), (1.0,)):
        labels = np.outer(decades, steps).ravel()
        labels = labels[(labels >= low) & (labels <= high)]
        if labels.size <= MOST_LABELS:
            break
    if labels.size < 2:
        labels = np.unique([known.min(), known.max()])
    for axes in panels:
        axes.set_yscale("log")
        axes.set_ylim(low, high)
        axes.yaxis.set_major_locator(FixedLocator(labels.tolist()))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.3g}"))
        axes.yaxis.set_minor_locator(NullLocator())


def drives(pen: Pen) -> list[Figure]:
    """Draw force and power of each drive; of elastic drives also their force and deflection."""
    return [
        draw(pen, suffix, inner)
        for suffix, inner in pen.case.driven.items()
        for name, draw in (("drive_power", _drive), ("drive_force", _stick_slip))
        if f"{name}{suffix}" in pen.data
    ]


def _stick_slip(pen: Pen, suffix: str, inner: str) -> Figure:
    shown = {
        "force of the drive (kN)": _of_models(pen, f"drive_force{suffix}", TO_KILO),
        "speed (m/s)": _of_models(pen, f"drawn_speed{suffix}", 1.0),
    }
    told = [
        of for own in pen.summary.values() if (of := own.stick_slip.get(f"drive_force{suffix}"))
    ]
    sticks, slip = max(one.sticks for one in told), max(one.slip for one in told)
    caption = (
        f"Above the force of the drive of {inner!r} on its own stiffness, with friction and what "
        "speeds up; below the speed at which the segment moves along, which is 0 where it sticks."
    )
    title = f"Drive of {inner}: sticks {sticks} times, slips by up to {TO_MILLI * slip:.2g} mm"
    return _of_drive(pen, f"stick-slip{suffix}", shown, "force (kN), speed (m/s)", title, caption)


def _drive(pen: Pen, suffix: str, inner: str) -> Figure:
    shown = {
        heading: {
            name: running_mean(pen, values)
            for name, values in _of_models(pen, f"{result}{suffix}", TO_KILO).items()
        }
        for heading, result in (
            ("force against friction (kN)", "drive_friction"),
            ("power (kW)", "drive_power"),
        )
    }
    force = farthest([farthest(values) for values in shown["force against friction (kN)"].values()])
    caption = (
        f"Above what the drive of {inner!r} pushes with against the friction of its pads along the "
        "boom, the coefficient times all that presses them; below its power, with what contact "
        "forces do on their slope as it is drawn and what presses along the boom, negative where "
        "the boom would slide by itself. "
        f"Means over {TO_MILLI * FORCE_WINDOW:g} ms."
    )
    title = f"Drive of {inner}: up to {fixed(force, 2)} kN against friction"
    return _of_drive(pen, f"drive{suffix}", shown, "force (kN), power (kW)", title, caption)


def _of_models(pen: Pen, result: str, unit: float) -> dict[str, Array]:
    return {name: unit * pen.of(name, result) for name in pen.models}


def _of_drive(
    pen: Pen,
    stem: str,
    shown: Mapping[str, Mapping[str, Array]],
    heading: str,
    title: str,
    caption: str,
) -> Figure:
    """Draw two results of a drive in all models, given by their headings."""
    sheet, panels = pen.over_time(2, 5.2)
    curves = []
    for panel, (axes, (label, values)) in enumerate(zip(panels, shown.items(), strict=True)):
        axes.set_ylabel(label)
        curves += pen.plot(axes, values, panel, linewidth=1.0)
    chart = Chart(pen.time, heading, curves, list(shown))
    return pen.finish(sheet, panels[0], stem, title, caption, chart=chart)


def stress_history(pen: Pen) -> list[Figure]:
    """Draw the maximum von Mises stresses of each shell per interval and position."""
    figures = []
    for name in pen.models:
        stress = pen.summary[name].stress
        if stress is None or not stress.history.places:
            continue
        time = np.array(stress.history.time)
        rows = stress.history.places
        places = sorted({row.x for row in rows})
        segments = [segment.name for segment in pen.case.segments]
        sheet, panels = new_sheet(len(places), 1.4 + 1.6 * len(places), share_y=True)
        for axes, x in zip(panels, places, strict=True):
            for row in (row for row in rows if row.x == x):
                color = theme.segment_color(segments.index(row.segment))
                for largest, label, width in (
                    (row.von_mises_patch, "over a patch", 1.8),
                    (row.von_mises, "any triangle", 0.8),
                ):
                    axes.plot(
                        time,
                        np.array(largest) * TO_MEGA,
                        color=color,
                        linewidth=width,
                        label=f"{row.segment}, {label}",
                    )
            axes.set(title=f"x = {x:g} m", ylabel="stress (MPa)", xlim=(0.0, pen.time[-1]))
        panels[-1].set(xlabel="time (s)", ylim=(0.0, None))
        fullest = max(panels, key=lambda axes: len(axes.lines))
        patch = max(max(row.von_mises_patch) for row in rows) * TO_MEGA
        title = (
            f"{name}: von Mises stress over a patch up to {patch:.3g} MPa, in a triangle up to "
            f"{stress.von_mises * TO_MEGA:.3g} MPa"
        )
        caption = (
            f"Largest von Mises stress of {name} at either face within {stress.band:g} m of "
            f"each station and support, in every {pen.time[-1] / time.size:.2g} s. Beside a line "
            "of contact the stress of a triangle grows as the mesh refines, and tells where and "
            "when alone; the mean over a patch of half a wall settles."
        )
        figures.append(pen.finish(sheet, fullest, f"stress-{name}", title, caption))
    return figures
