# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of motion over time: tip and heads, with ensembles."""

from __future__ import annotations

import numpy as np

from protractile.dynamics.predictability import SHARES
from protractile.geometry.arrays import Array
from protractile.geometry.typography import TO_MILLI, fixed
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve, Vertical
from protractile.runs.report.figure_context import Figure, FigureContext
from protractile.runs.report.labels import farthest

# Lower and upper percentile of the band of an ensemble.
BAND = (5.0, 95.0)
# Direction of each tip displacement in titles and captions.
DIRECTIONS = {"tip": ", vertical (z)", "tip_lateral": ", lateral (y)"}


def tip(run: FigureContext) -> list[Figure]:
    """Show the tip deflection of all models, in a figure for each direction."""
    figures = []
    for place in run.tips:
        way = DIRECTIONS[place] * (len(run.tips) > 1)
        caption = f"Deflection of the tip{way}, all models.{_accuracy_note(run, place)}"
        title, name = f"Tip{way}: {_largest_deflection(run, place)}", place.replace("_", "-")
        figures.append(Figure(name, title, caption, chart=_chart(run, place), main=True))
    return figures


def close_up(run: FigureContext) -> list[Figure]:
    """Show the first peak of the tip; nothing if no model has a peak."""
    place = run.tips[0]
    if not any(run.summary[name].first_peak[place].time for name in run.models):
        return []
    end = run.first_peak_window
    in_window = run.time <= end
    curves, contacts, peaks, peakless = [], {}, {}, []
    for name in run.models:
        deflection = TO_MILLI * run.result(name, place)
        curves.append(run.curve(name, deflection[in_window], at=run.time[in_window]))
        contact = run.summary[name].first_contact
        if contact and contact <= end:
            contacts[contact] = float(np.interp(contact, run.time, deflection))
        peak, height = run.summary[name].first_peak[place]
        if peak is None or height is None:
            peakless.append(name)
        elif peak <= end:
            peaks[peak] = TO_MILLI * height
    for label, marker, marks in (("first contact", "o", contacts), ("first peak", "v", peaks)):
        if marks:
            times, heights = np.array([*marks.items()]).T
            curves.append(Curve(label, heights, theme.INK, "", at=times, marker=marker))
    way = DIRECTIONS[place] * (len(run.tips) > 1)
    title, marked = f"Tip{way}, first {end:g} s", "Triangles mark each model's"
    if contacts:
        title += f": the segments first touch at {min(contacts):.2f} s"
        marked = "Circles mark the first contact of each model, triangles its"
    caption = f"Close-up of the tip{way}. {marked} first peak."
    if peakless:
        caption += f" No peak within {run.case.time.duration:g} s: {', '.join(peakless)}."
    chart = run.over_time(["deflection (mm)"], curves, window=(0.0, end))
    return [Figure("tip-close-up", title, caption, chart=chart)]


def heads(run: FigureContext) -> list[Figure]:
    """Show the deflection of the heads of outer segments."""
    joints = range(1, len(run.case.joints) + 1)
    places = ["head", *(f"head-{number}" for number in joints if number > 1)]
    return [_head(run, place) for place in places if place in run.data]


def _head(run: FigureContext, place: str) -> Figure:
    number = int(place.partition("-")[2] or 1)
    which = run.case.joints[number - 1].outer if run.case.joints else run.case.segments[0].name
    bonded = [run.labels[name] for name in run.bonded if name in run.models]
    dashed = f" Dashed: {', '.join(bonded)}, without play." if bonded else ""
    caption = (
        f"Deflection of the head of the segment {which!r}.{dashed}{_accuracy_note(run, place)}"
    )
    title = f"Head of {which!r}: {_largest_deflection(run, place)}"
    return Figure(place, title, caption, chart=_chart(run, place))


def _chart(run: FigureContext, place: str) -> Chart:
    """Return the chart of an output in all models, with bands and horizons of ensembles."""
    curves = [
        run.curve(name, TO_MILLI * run.result(name, place), band=_band(run, name, place))
        for name in run.models
    ]
    if limit := _limit(run, place):
        curves.append(Curve("limit", np.full(run.time.size, limit), theme.INK, ":"))
    horizons = [
        Vertical(horizon, curve.color, dashes)
        for name, curve in zip(run.models, curves, strict=False)
        if curve.band is not None and (ensemble := run.summary[name].ensemble)
        for share, dashes in zip(SHARES, (":", "--"), strict=True)
        if (horizon := ensemble.horizon(share)) is not None
    ]
    return run.over_time(["deflection (mm)"], curves, verticals=horizons)


def _limit(run: FigureContext, place: str) -> float | None:
    """Return the permitted tip deflection in mm, with the sign of the largest deflection."""
    permitted = getattr(run.case.limits, place, None) if place in DIRECTIONS else None
    if permitted is None:
        return None
    reaches = [farthest(run.result(name, place)) for name in run.models]
    return float(np.copysign(TO_MILLI * permitted, max(reaches, key=abs)))


def _largest_deflection(run: FigureContext, place: str) -> str:
    """Return a text on the largest deflection of the models with play, or else of all models."""
    reaches = {name: farthest(run.result(name, place)) for name in run.with_play or run.models}
    name = max(reaches, key=lambda candidate: np.nan_to_num(abs(reaches[candidate]), nan=-1.0))
    most = fixed(reaches[name], 0, TO_MILLI)
    return f"largest deflection {most} mm" + (f" in {name}" if len(reaches) > 1 else "")


def _band(run: FigureContext, name: str, place: str) -> tuple[Array, Array] | None:
    """Return the limits (num_times,) in mm of the band of an ensemble; None without one."""
    if run.ensembles is None or name not in run.ensembles["model"] or place not in run.ensembles:
        return None
    members = TO_MILLI * run.ensembles[place].sel(model=name).values
    low, high = np.percentile(members, BAND, axis=0)
    return low, high


def _accuracy_note(run: FigureContext, place: str) -> str:
    """Return sentences on the accuracy of curves and on the marks of ensembles."""
    if not run.with_play or run.stays_in_contact:
        return ""
    if run.ensembles is None or place not in run.ensembles:
        if run.regular or run.ensembles is not None or place != run.tips[0]:
            return ""
        return (
            " After the first contacts, motion with play may be chaotic: then each curve is one "
            "of many possible motions. An ensemble of motions with slightly different data shows "
            "whether the motion is chaotic: add a table `ensemble` to the case."
        )
    low, high = BAND
    band = (
        f" Shaded: {low:g} to {high:g} % of the {run.ensembles.sizes['member']} members of each "
        "model's ensemble."
    )
    sampled = [ensemble for name in run.with_play if (ensemble := run.summary[name].ensemble)]
    if not any(time is not None for ensemble in sampled for time in ensemble.horizons.values()):
        return f"{band} They do not diverge."
    first, last = (f"{100.0 * share:g} %" for share in SHARES)
    beyond = "" if run.regular else "; a later curve is one of many possible motions"
    return (
        f"{band} Vertical lines: times at which its members differ by {first} (dotted) and {last} "
        f"(dashed) of the tip's range{beyond}."
    )
