# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of forces and stresses over time: contact, friction, drives, walls of shells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

from protractile.analysis.curves import HISTORY
from protractile.geometry.arrays import Array
from protractile.geometry.typography import TO_KILO, TO_MEGA, TO_MILLI, fixed, number
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart
from protractile.runs.report.figure_context import (
    Figure,
    FigureContext,
    highest,
    initial_position_note,
    new_sheet,
    widen_limits,
)
from protractile.runs.report.labels import farthest

# Number of intervals into which a run is divided; the maximum of each is drawn.
FORCE_BINS = 100
# Smaller contact forces in N count as zero in a figure.
LEAST_FORCE = 1000.0
# Averaging time of contact forces in s. Successive impacts are milliseconds apart.
FORCE_WINDOW = 0.010
# Number of labels of a logarithmic axis that fit a panel of two inches.
MOST_LABELS = 7
# Margin factor above the largest and below the smallest mark.
LOG_MARGIN = 1.2


def first_contacts(run: FigureContext) -> list[Figure]:
    """Draw the mean contact force at each station during the first contacts."""
    if not run.with_play or not run.data.sizes["station"]:
        return []
    end = run.first_peak_window
    in_window = run.time <= end
    stations = run.stations()
    sheet, panels = run.over_time(len(stations), 1.3 + 2.0 * len(stations), end)
    curves = []
    for i, (axes, station) in enumerate(zip(panels, stations, strict=True)):
        for name in run.with_play:
            mean = running_mean(run, run.result(name, "contact_force")[:, i] * TO_KILO)
            run.line(axes, name, run.time[in_window], mean[in_window], linewidth=1.3)
            curves.append(run.curve(name, mean, i))
        axes.set(title=station, ylabel="force (kN)")
        widen_limits(axes)
    title = f"Mean contact forces, first {end:g} s"
    caption = (
        f"Contact force at each station, mean over {TO_MILLI * FORCE_WINDOW:g} ms"
        + ("" if run.stays_in_contact else " of many short impacts")
        + ". Forces act on the outer segment, positive upwards, lateral ones towards larger y."
        + initial_position_note(run.case)
    )
    chart = Chart(run.time, "force (kN)", curves, stations, (0.0, end))
    return [run.finish(sheet, panels[0], "contact-first", title, caption, chart=chart)]


def contact_peaks(run: FigureContext) -> list[Figure]:
    """Draw the maximum contact force at each station in each interval of the run."""
    if not run.with_play or not run.data.sizes["station"]:
        return []
    bins = np.array_split(np.arange(run.time.size), min(FORCE_BINS, run.time.size))
    middle = np.array([run.time[part].mean() for part in bins])
    stations = run.stations()
    sheet, panels = run.over_time(len(stations), 1.3 + 2.0 * len(stations), share_y=True)
    curves_in_kn = []
    for i, (axes, station) in enumerate(zip(panels, stations, strict=True)):
        for name in run.with_play:
            force = np.abs(run.result(name, "contact_force_peak")[:, i])
            largest = np.array([highest(force[part]) for part in bins])
            largest[~(largest > LEAST_FORCE)] = np.nan
            curves_in_kn.append(largest * TO_KILO)
            run.line(axes, name, middle, largest * TO_KILO, linewidth=1.1, marker="o")
        axes.set(title=station, ylabel="force (kN)")
    _log_scale(panels, np.concatenate(curves_in_kn))
    peaks = [run.summary[name].peak_contact_force for name in run.with_play]
    largest_peaks = [peak for peak in peaks if peak is not None]
    title = "Peak contact forces" + (
        f": up to {max(largest_peaks) * TO_KILO:.0f} kN" if largest_peaks else ""
    )
    caption = (
        f"Largest contact force at each station in each interval of "
        f"{run.time[-1] / len(bins):.2g} s, upwards or downwards, on a logarithmic scale. Forces "
        f"below {LEAST_FORCE * TO_KILO:g} kN are not plotted. Use the mean contact force to size "
        "pads and walls." + initial_position_note(run.case)
    )
    return [run.finish(sheet, panels[0], "contact-peaks", title, caption)]


def friction(run: FigureContext) -> list[Figure]:
    """Draw the friction force at each station with friction, for the last model with play."""
    if "friction_force" not in run.data or not run.with_play:
        return []
    name = run.with_play[-1]
    force = np.nan_to_num(run.result(name, "friction_force")) * TO_KILO
    places = [(i, label) for i, label in enumerate(run.stations()) if force[:, i].any()]
    if not places:
        return []
    sheet, panels = run.over_time(len(places), 1.1 + 1.8 * len(places))
    for axes, (i, station) in zip(panels, places, strict=True):
        run.line(axes, name, run.time, running_mean(run, force[:, i]), linewidth=1.1, alone=True)
        axes.set(title=station, ylabel="force (kN)")
    signs = "Positive where it pushes the inner segment up."
    if any(label.endswith("lateral") for label in run.stations()):
        signs = (
            "At lateral stations the force is vertical, positive where it pushes the inner segment "
            "up; at other stations it is lateral, positive towards larger y."
        )
    caption = (
        f"Force of dry friction in {name} at each station, mean over "
        f"{TO_MILLI * FORCE_WINDOW:g} ms. {signs} Where "
        f"the segments stick, it is less than the coefficient times the normal force."
    )
    title = f"{name}: friction forces up to {highest(np.abs(force).ravel()):.2g} kN"
    return [run.finish(sheet, None, "friction", title, caption)]


def running_mean(run: FigureContext, force: Array) -> Array:
    """Return the running mean (num_times,) of a force. The window does not exceed the run."""
    width = min(max(1, round(FORCE_WINDOW / (run.time[1] - run.time[0]))), force.size)
    window = np.ones(width)
    counts = np.convolve(np.ones(force.size), window, mode="same")
    return np.convolve(force, window, mode="same") / counts


def _log_scale(panels: Sequence[Axes], values: Array) -> None:
    """Set a common logarithmic scale for all panels, with enough labels within a decade."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return
    low, high = finite.min() / LOG_MARGIN, finite.max() * LOG_MARGIN
    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
    for steps in ((1.0, 2.0, 5.0), (1.0, 3.0), (1.0,)):
        labels = np.outer(decades, steps).ravel()
        labels = labels[(labels >= low) & (labels <= high)]
        if labels.size <= MOST_LABELS:
            break
    if labels.size < 3:
        labels = np.unique(np.geomspace(finite.min(), finite.max(), 3))
    for axes in panels:
        axes.set_yscale("log")
        axes.set_ylim(low, high)
        axes.set_yticks(labels, [f"{label:.3g}" for label in labels])
        axes.yaxis.set_minor_locator(NullLocator())


def drives(run: FigureContext) -> list[Figure]:
    """Draw force and power of each drive, and force and speed of each elastic drive."""
    return [
        draw(run, suffix, inner)
        for suffix, inner in run.case.driven_segments.items()
        for name, draw in (("drive_power", _drive), ("drive_force", _stick_slip))
        if f"{name}{suffix}" in run.data
    ]


def hoisting(run: FigureContext) -> list[Figure]:
    """Draw the force of the rope and the height of the hoisted load."""
    if "rope_force" not in run.data:
        return []
    forces = _model_results(run, "rope_force", TO_KILO)
    panels = {
        "rope force (kN)": forces,
        "height (mm)": _model_results(run, "load_height", TO_MILLI),
    }
    swings = {"swing_out": "swing in plane (m)", "swing_aside": "swing aside (m)"}
    panels |= {
        label: _model_results(run, key, 1.0) for key, label in swings.items() if key in run.data
    }
    weight = TO_KILO * run.data["rope_force_peak"].attrs["weight"]
    caption = (
        "Above: force of all falls of the rope, means of the output intervals. Below: height of "
        "the load above its place at t = 0, and its distances from the tip if it swings. "
        f"The load weighs {fixed(weight, 1)} kN."
    )
    largest = farthest([farthest(force) for force in forces.values()])
    title = f"Hoisting: rope force up to {fixed(largest, 1)} kN"
    return [_draw_panels(run, "hoist", panels, ", ".join(panels), title, caption)]


def _stick_slip(run: FigureContext, suffix: str, inner: str) -> Figure:
    panels = {
        "force of the drive (kN)": _model_results(run, f"drive_force{suffix}", TO_KILO),
        "speed (m/s)": _model_results(run, f"extension_speed{suffix}", 1.0),
    }
    records = [
        of
        for model_summary in run.summary.values()
        if (of := model_summary.stick_slip.get(f"drive_force{suffix}"))
    ]
    sticks, slip = max(record.sticks for record in records), max(record.slip for record in records)
    caption = (
        f"Above: force of the drive of {inner!r}, including friction and inertia. Below: speed "
        f"of the segment, which is 0 while it sticks."
    )
    title = f"Drive of {inner}: sticks {sticks} times, slips by up to {TO_MILLI * slip:.2g} mm"
    return _draw_panels(
        run, f"stick-slip{suffix}", panels, "force (kN), speed (m/s)", title, caption
    )


def _drive(run: FigureContext, suffix: str, inner: str) -> Figure:
    panels = {
        heading: {
            name: running_mean(run, values)
            for name, values in _model_results(run, f"{result}{suffix}", TO_KILO).items()
        }
        for heading, result in (
            ("force against friction (kN)", "drive_friction"),
            ("power (kW)", "drive_power"),
        )
    }
    force = farthest(
        [farthest(values) for values in panels["force against friction (kN)"].values()]
    )
    caption = (
        f"Above: force of the drive of {inner!r} against the friction of its pads, the "
        f"coefficient times their contact forces. Below: its power, including contact forces on "
        f"sloping segments and axial loads; negative where the boom would slide by itself. "
        f"Means over {TO_MILLI * FORCE_WINDOW:g} ms."
    )
    title = f"Drive of {inner}: up to {fixed(force, 2)} kN against friction"
    return _draw_panels(run, f"drive{suffix}", panels, "force (kN), power (kW)", title, caption)


def _model_results(run: FigureContext, result: str, unit: float) -> dict[str, Array]:
    return {name: unit * run.result(name, result) for name in run.models}


def _draw_panels(
    run: FigureContext,
    stem: str,
    quantities: Mapping[str, Mapping[str, Array]],
    heading: str,
    title: str,
    caption: str,
) -> Figure:
    """Draw several results in all models, with a panel for each."""
    sheet, panels = run.over_time(len(quantities), 1.2 + 2.0 * len(quantities))
    curves = []
    for panel, (axes, (label, values)) in enumerate(zip(panels, quantities.items(), strict=True)):
        axes.set_ylabel(label)
        for name, of_model in values.items():
            run.line(axes, name, run.time, of_model, linewidth=1.0)
            curves.append(run.curve(name, of_model, panel))
    chart = Chart(run.time, heading, curves, list(quantities))
    return run.finish(sheet, panels[0], stem, title, caption, chart=chart)


def stress_history(run: FigureContext) -> list[Figure]:
    """Draw the maximum von Mises stress of each shell in each interval, at each station."""
    figures = []
    for name in run.models:
        stress, curves = run.summary[name].stress, run.curves.where(model=name, state=HISTORY)
        if stress is None or not curves:
            continue
        places = sorted({curve.place for curve in curves})
        segments = [segment.name for segment in run.case.segments]
        sheet, panels = new_sheet(len(places), 1.4 + 1.6 * len(places), share_y=True)
        for axes, x in zip(panels, places, strict=True):
            for curve in curves.where(place=x):
                color = theme.segment_color(segments.index(curve.segment))
                for quantity, label, width in (
                    ("von_mises_patch", "local plate stress", 1.8),
                    ("von_mises", "one element", 0.8),
                ):
                    axes.plot(
                        curve.x,
                        curve.values[quantity] * TO_MEGA,
                        color=color,
                        linewidth=width,
                        label=f"{curve.segment}, {label}",
                    )
            axes.set(title=f"x = {x:g} m", ylabel="stress (MPa)", xlim=(0.0, run.time[-1]))
        panels[-1].set(xlabel="time (s)", ylim=(0.0, None))
        fullest = max(panels, key=lambda axes: len(axes.lines))
        patch = max(curve.values["von_mises_patch"].max() for curve in curves) * TO_MEGA
        title = (
            f"{name}: local plate stress up to {number(patch)} MPa, in one element up to "
            f"{number(stress.von_mises * TO_MEGA)} MPa"
        )
        caption = (
            f"Von Mises stresses of {name!r} within {stress.band:g} m of stations, supports, lugs "
            f"and loads: the largest in each interval of {run.time[-1] / curves[0].x.size:.2g} s. "
            "Thick lines: local plate stress, the mean over half the width of a wall, for design; "
            "it converges with mesh refinement. Thin lines: stress of one element, at either face. "
            "It grows with refinement beside a contact line: use it only to find place and time."
        )
        figures.append(run.finish(sheet, fullest, f"stress-{name}", title, caption))
    return figures
