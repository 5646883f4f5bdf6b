# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of forces and stresses over time: contact, drives, walls of shells."""

from __future__ import annotations

import numpy as np

from protractile.analysis.curves import HISTORY
from protractile.geometry.arrays import Array
from protractile.geometry.typography import TO_KILO, TO_MEGA, TO_MILLI, fixed, number
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.figure_context import (
    Figure,
    FigureContext,
    initial_position_note,
)
from protractile.runs.report.labels import farthest

# Averaging time of contact forces in s. Successive impacts are milliseconds apart.
FORCE_WINDOW = 0.010


def first_contacts(run: FigureContext) -> list[Figure]:
    """Show the mean contact force at each station during the first contacts."""
    if not run.with_play or not run.data.sizes["station"]:
        return []
    end = run.first_peak_window
    panels = [f"{station}: force (kN)" for station in run.stations()]
    curves = [
        run.curve(name, running_mean(run, force * TO_KILO), i)
        for name in run.with_play
        for i, force in enumerate(run.result(name, "contact_force").T)
    ]
    title = f"Mean contact forces, first {end:g} s"
    caption = (
        f"Contact force at each station, mean over {TO_MILLI * FORCE_WINDOW:g} ms"
        + ("" if run.stays_in_contact else " of many short impacts")
        + ". Forces act on the outer segment, positive upwards, lateral ones towards larger y."
        + initial_position_note(run.case)
    )
    chart = run.over_time(panels, curves, window=(0.0, end))
    return [Figure("contact-first", title, caption, chart=chart)]


def running_mean(run: FigureContext, force: Array) -> Array:
    """Return the running mean (num_times,) of a force. The window does not exceed the run."""
    width = min(max(1, round(FORCE_WINDOW / (run.time[1] - run.time[0]))), force.size)
    window = np.ones(width)
    counts = np.convolve(np.ones(force.size), window, mode="same")
    return np.convolve(force, window, mode="same") / counts


def drives(run: FigureContext) -> list[Figure]:
    """Show force and power of each drive, and force and speed of each elastic drive."""
    return [
        draw(run, suffix, inner)
        for suffix, inner in run.case.driven_segments.items()
        for name, draw in (("drive_power", _drive), ("drive_force", _stick_slip))
        if f"{name}{suffix}" in run.data
    ]


def hoisting(run: FigureContext) -> list[Figure]:
    """Show the force of the rope and the height of the hoisted load."""
    if "rope_force" not in run.data:
        return []
    panels = {
        "rope force (kN)": ("rope_force", TO_KILO),
        "height (mm)": ("load_height", TO_MILLI),
        "swing in plane (m)": ("swing_out", 1.0),
        "swing aside (m)": ("swing_aside", 1.0),
    }
    chart = run.results_over_time(
        {title: panel for title, panel in panels.items() if panel[0] in run.data}
    )
    weight = TO_KILO * run.data["rope_force_peak"].attrs["weight"]
    caption = (
        "Above: force of all falls of the rope, means of the output intervals. Below: height of "
        "the load above its place at t = 0, and its distances from the tip if it swings. "
        f"The load weighs {fixed(weight, 1)} kN."
    )
    largest = farthest([farthest(curve.values) for curve in chart.curves if curve.panel == 0])
    title = f"Hoisting: rope force up to {fixed(largest, 1)} kN"
    return [Figure("hoist", title, caption, chart=chart)]


def _stick_slip(run: FigureContext, suffix: str, inner: str) -> Figure:
    chart = run.results_over_time(
        {
            "force of the drive (kN)": (f"drive_force{suffix}", TO_KILO),
            "speed (m/s)": (f"extension_speed{suffix}", 1.0),
        }
    )
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
    return Figure(f"stick-slip{suffix}", title, caption, chart=chart)


def _drive(run: FigureContext, suffix: str, inner: str) -> Figure:
    panels = {
        "force against friction (kN)": "drive_friction",
        "power (kW)": "drive_power",
    }
    curves = [
        run.curve(name, running_mean(run, TO_KILO * run.result(name, f"{result}{suffix}")), panel)
        for panel, result in enumerate(panels.values())
        for name in run.models
    ]
    force = farthest([farthest(curve.values) for curve in curves if curve.panel == 0])
    caption = (
        f"Above: force of the drive of {inner!r} against the friction of its pads, the "
        f"coefficient times their contact forces. Below: its power, including contact forces on "
        f"sloping segments and axial loads; negative where the boom would slide by itself. "
        f"Means over {TO_MILLI * FORCE_WINDOW:g} ms."
    )
    title = f"Drive of {inner}: up to {fixed(force, 2)} kN against friction"
    return Figure(f"drive{suffix}", title, caption, chart=run.over_time([*panels], curves))


def stress_history(run: FigureContext) -> list[Figure]:
    """Show the maximum von Mises stress of each shell in each interval, at each station."""
    figures = []
    for name in run.models:
        stress, curves = run.summary[name].stress, run.curves.where(model=name, state=HISTORY)
        if stress is None or not curves:
            continue
        places = sorted({curve.place for curve in curves})
        segments = [segment.name for segment in run.case.segments]
        lines = [
            Curve(f"{curve.segment}, {label}", curve.values[quantity] * TO_MEGA,
                  theme.segment_color(segments.index(curve.segment)),
                  panel=places.index(curve.place), at=curve.x, width=width)
            for curve in curves
            for quantity, label, width in (
                ("von_mises_patch", "local plate stress", 2.2),
                ("von_mises", "one element", 0.9),
            )
        ]  # fmt: skip
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
        panels = [f"x = {x:g} m: stress (MPa)" for x in places]
        chart = Chart(run.time, lines, panels, common=len(panels))
        figures.append(Figure(f"stress-{name}", title, caption, chart=chart))
    return figures
