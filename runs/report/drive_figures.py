# SPDX-License-Identifier: LGPL-3.0-or-later
"""What drives do: how far segments are drawn out, by what force and power."""

from __future__ import annotations

from geometry.typography import TO_KILO, TO_MILLI
from runs.report.charts import Chart
from runs.report.contact_figures import FORCE_WINDOW, running_mean
from runs.report.drawn_axis import drawn_axis
from runs.report.figure_context import Figure, Pen, farthest, new_sheet
from runs.report.numerals import fixed


def drives(pen: Pen) -> list[Figure]:
    """Force and power of each drive; of one that gives way its own force, and how it follows."""
    return [
        draw(pen, suffix, inner)
        for suffix, inner in pen.case.driven.items()
        for name, draw in (("drive_power", _drive), ("drive_force", _stick_slip))
        if f"{name}{suffix}" in pen.data
    ]


def _stick_slip(pen: Pen, suffix: str, inner: str) -> Figure:
    sheet, panels = new_sheet(2, 5.2)
    headings = "force of the drive (kN)", "speed (m/s)"
    curves = []
    for panel, (axes, name, unit) in enumerate(
        zip(panels, ("drive_force", "drawn_speed"), (TO_KILO, 1.0), strict=True)
    ):
        for model in pen.models:
            values = pen.of(model, f"{name}{suffix}") * unit
            pen.line(axes, model, pen.time, values, linewidth=1.0)
            curves.append(pen.curve(model, values, panel))
        axes.set(ylabel=headings[panel], xlim=(0.0, pen.time[-1]))
        drawn_axis(pen, axes)
    panels[-1].set_xlabel("time (s)")
    told = [
        of for own in pen.summary.values() if (of := own.stick_slip.get(f"drive_force{suffix}"))
    ]
    sticks, slip = max(one.sticks for one in told), max(one.slip for one in told)
    caption = (
        f"Above the force of the drive of {inner!r} on its own stiffness, with friction and what "
        "speeds up; below the speed at which the segment moves along, which is 0 where it sticks."
    )
    title = f"Drive of {inner}: sticks {sticks} times, slips by up to {TO_MILLI * slip:.2g} mm"
    chart = Chart(pen.time, "force (kN), speed (m/s)", curves, list(headings))
    return pen.finish(sheet, panels[0], f"stick-slip{suffix}", title, caption, chart=chart)


def _drive(pen: Pen, suffix: str, inner: str) -> Figure:
    sheet, panels = new_sheet(2, 5.2)
    names = f"drive_friction{suffix}", f"drive_power{suffix}"
    headings = "force against friction (kN)", "power (kW)"
    curves = []
    for panel, (axes, name, heading) in enumerate(zip(panels, names, headings, strict=True)):
        for model in pen.models:
            values = running_mean(pen, pen.of(model, name)) * TO_KILO
            pen.line(axes, model, pen.time, values, linewidth=1.0)
            curves.append(pen.curve(model, values, panel))
        axes.set(ylabel=heading, xlim=(0.0, pen.time[-1]))
        drawn_axis(pen, axes)
    panels[-1].set_xlabel("time (s)")
    force = farthest([farthest(curve.values) for curve in curves[: len(pen.models)]])
    caption = (
        f"Above what the drive of {inner!r} pushes with against the friction of its pads along the "
        "boom, the coefficient times all that presses them; below its power, with what contact "
        "forces do on their slope as it is drawn and what presses along the boom, negative where "
        "the boom would slide by itself. "
        f"Means over {TO_MILLI * FORCE_WINDOW:g} ms."
    )
    title = f"Drive of {inner}: up to {fixed(force, 2)} kN against friction"
    chart = Chart(pen.time, "force (kN), power (kW)", curves, list(headings))
    return pen.finish(sheet, panels[0], f"drive{suffix}", title, caption, chart=chart)
