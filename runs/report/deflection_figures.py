# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where the boom is: tip and heads over time, with the bands and horizons of the ensembles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from dynamics.predictability.horizon import SHARES
from geometry.arrays import Array
from geometry.typography import TO_MILLI
from runs.report import theme
from runs.report.charts import Chart
from runs.report.drawn_axis import drawn_axis
from runs.report.figure_context import Figure, Pen, farthest, highest, new_sheet
from runs.report.numerals import fixed

# Of an ensemble this part of the members lies in its band, in percent.
BAND = (5.0, 95.0)
# How dark the bands of all models are where they lie on one another.
SHADE = 0.8


def tip(pen: Pen) -> list[Figure]:
    """The tip in all models, over one another."""
    sheet, (axes,) = new_sheet(1, 3.9)
    for name in pen.models:
        pen.line(axes, name, pen.time, TO_MILLI * pen.of(name, "tip"))
        _members(pen, axes, name, "tip")
    axes.set(xlabel="time (s)", ylabel="deflection (mm)", xlim=(0.0, pen.time[-1]))
    drawn_axis(pen, axes)
    caption = f"Deflection of the tip, all models.{_sampled(pen, 'tip')}"
    title = f"Tip: {_reach(pen, 'tip')}"
    return [pen.finish(sheet, axes, "tip", title, caption, chart=_chart(pen, "tip"))]


def close_up(pen: Pen) -> list[Figure]:
    """The tip up to shortly after its first peak; nothing where none has one."""
    if not any(pen.summary[name].first_peak["tip"].time for name in pen.models):
        return []
    end = pen.first_stretch
    shown = pen.time <= end
    sheet, (axes,) = new_sheet(1, 3.9)
    contacts, peakless = [], []
    circle: dict[str, Any] = {"mfc": "white", "ms": 7, "mew": 1.6}
    for name in pen.models:
        deflection = TO_MILLI * pen.of(name, "tip")
        pen.line(axes, name, pen.time[shown], deflection[shown])
        color = pen.strokes[name].color
        contact = pen.summary[name].first_contact
        if contact and contact <= end:
            contacts.append(contact)
            then = np.interp(contact, pen.time, deflection)
            axes.plot(contact, then, "o", color=color, zorder=4, **circle)
        peak, height = pen.summary[name].first_peak["tip"]
        if peak is None or height is None:
            peakless.append(name)
        elif peak <= end:
            axes.plot(peak, TO_MILLI * height, "v", color=color, ms=8, zorder=4)
    if contacts:
        axes.plot([], [], "o", color=theme.INK, label="first contact", **circle)
    axes.plot([], [], "v", color=theme.INK, ms=8, label="first peak")
    axes.set(xlabel="time (s)", ylabel="deflection (mm)", xlim=(0.0, end))
    axes.margins(y=0.08)
    drawn_axis(pen, axes)
    title = f"Tip, first {end:g} s" + (
        f": the segments first touch at {min(contacts):.2f} s" if contacts else ""
    )
    caption = (
        "Close-up of the tip. "
        + (
            "Circles mark where a model's segments first touch, triangles its"
            if contacts
            else "Triangles mark each model's"
        )
        + " first peak."
    )
    if peakless:
        caption += f" No peak within {pen.case.time.duration:g} s: {', '.join(peakless)}."
    return [pen.finish(sheet, axes, "tip-close-up", title, caption)]


def heads(pen: Pen) -> list[Figure]:
    """The head of each outer segment; it rattles, so each model has its own panel."""
    joints = range(1, len(pen.case.joints) + 1)
    places = ["head", *(f"head-{number}" for number in joints if number > 1)]
    return [_head(pen, place) for place in places if place in pen.data]


def _head(pen: Pen, place: str) -> Figure:
    models = pen.with_play or pen.models
    # One panel alone has room for the names of its axes.
    sheet, panels = new_sheet(len(models), 1.1 + max(1.25 * len(models), 2.2))
    curves = {name: TO_MILLI * pen.of(name, place) for name in pen.models}
    for axes, name in zip(panels, models, strict=True):
        for other in pen.play_free:
            if other != name:
                pen.line(axes, other, pen.time, curves[other], linewidth=0.9)
        pen.line(axes, name, pen.time, curves[name], linewidth=1.1, alone=True)
        _members(pen, axes, name, place)
        axes.set_title(name, color=pen.strokes[name].color)
        axes.set(xlim=(0.0, pen.time[-1]), ylim=_limits(list(curves.values())))
        drawn_axis(pen, axes)
    panels[-1].set_xlabel("time (s)")
    sheet.supylabel("deflection (mm)", fontsize=theme.RC["font.size"])
    number = int(place.partition("-")[2] or 1)
    which = pen.case.joints[number - 1].outer if pen.case.joints else pen.case.segments[0].name
    tied = [pen.labels[name] for name in pen.play_free if name in pen.models]
    dashed = f" Dashed: {', '.join(tied)}, without play." if tied else ""
    caption = (
        f"Deflection of the head of the segment {which!r}, model by model.{dashed}"
        f"{_sampled(pen, place)}"
    )
    title = f"{place.replace('-', ' ').capitalize()}: {_reach(pen, place)}"
    return pen.finish(sheet, panels[0], place, title, caption, chart=_chart(pen, place))


def lateral_tip(pen: Pen) -> list[Figure]:
    """The tip to the sides, where the boom is spatial."""
    if "tip_lateral" not in pen.data:
        return []
    sheet, (axes,) = new_sheet(1, 3.9)
    for name in pen.models:
        pen.line(axes, name, pen.time, TO_MILLI * pen.of(name, "tip_lateral"))
    axes.set(xlabel="time (s)", ylabel="displacement (mm)", xlim=(0.0, pen.time[-1]))
    caption = "Displacement of the tip along y, to the sides, all models."
    title = f"Tip, to the sides: {_reach(pen, 'tip_lateral')}"
    chart = _chart(pen, "tip_lateral", "displacement (mm)")
    return [pen.finish(sheet, axes, "tip-lateral", title, caption, chart=chart)]


def _chart(pen: Pen, place: str, heading: str = "deflection (mm)") -> Chart:
    """One place in all models, with the bands of their ensembles."""
    curves = [
        pen.curve(name, TO_MILLI * pen.of(name, place), band=_band(pen, name, place))
        for name in pen.models
    ]
    return Chart(pen.time, heading, curves)


def _reach(pen: Pen, place: str) -> str:
    """How far the models, with play where any have it, deflect at one place, up or down."""
    reaches = {name: farthest(pen.of(name, place)) for name in pen.with_play or pen.models}
    name = max(reaches, key=lambda one: np.nan_to_num(abs(reaches[one]), nan=-1.0))
    most = fixed(reaches[name], 0, TO_MILLI)
    return f"up to {most} mm" + (f" in {name}" if len(reaches) > 1 else "")


def _members(pen: Pen, axes: Axes, name: str, place: str) -> None:
    """The band of a model's ensemble behind its curve, and its horizons."""
    band = _band(pen, name, place)
    if band is None:
        return
    color = pen.strokes[name].color
    low, high = band
    shade = min(0.25, SHADE / len(pen.with_play))
    axes.fill_between(pen.time, low, high, color=color, alpha=shade, linewidth=0, zorder=1)
    for share, dashes in zip(SHARES, (":", "--"), strict=True):
        ensemble = pen.summary[name].ensemble
        if ensemble and (known := ensemble.horizon(share)) is not None:
            axes.axvline(known, color=color, linestyle=dashes, linewidth=0.9)


def _band(pen: Pen, name: str, place: str) -> tuple[Array, Array] | None:
    """(num_times,) each in mm, between which most members of an ensemble are."""
    if pen.ensembles is None or name not in pen.ensembles["model"] or place not in pen.ensembles:
        return None
    members = TO_MILLI * pen.ensembles[place].sel(model=name).values
    low, high = np.percentile(members, BAND, axis=0)
    return low, high


def _sampled(pen: Pen, place: str) -> str:
    """What a curve is worth, and what the marks of its ensemble are."""
    if not pen.with_play or pen.stays_pressed:
        return ""
    if pen.ensembles is None or place not in pen.ensembles:
        if pen.regular or pen.ensembles is not None:
            return ""
        return (
            " After the first presses a curve with play may be one sample of a chaotic motion; an "
            "ensemble tells."
        )
    low, high = BAND
    band = (
        f" Shaded: {low:g} to {high:g} % of the {pen.ensembles.sizes['member']} members of each "
        "model's ensemble."
    )
    sampled = [found for name in pen.with_play if (found := pen.summary[name].ensemble)]
    if not any(time is not None for found in sampled for time in found.horizons.values()):
        return f"{band} They stay together to the end."
    first, last = (f"{100.0 * share:g} %" for share in SHARES)
    beyond = "" if pen.regular else ", beyond which a curve is one sample of a chaotic motion"
    return (
        f"{band} Vertical lines: from when its members are {first} (dotted) and {last} (dashed) of "
        f"the tip's range around one another{beyond}."
    )


def _limits(curves: Sequence[Array]) -> tuple[float, float]:
    """Limits of an axis on which all curves fit."""
    high = highest([highest(curve) for curve in curves])
    low = -highest([highest(-curve) for curve in curves])
    margin = 0.05 * (high - low) or 1.0
    return low - margin, high + margin
