# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of motion over time: tip and heads with ensembles, predictability, energies."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from protractile.dynamics.energy import DRIVEN_ENERGIES, energy_residual
from protractile.dynamics.predictability import SHARES
from protractile.geometry.arrays import Array
from protractile.geometry.typography import TO_MILLI, fixed, scientific
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.figure_context import (
    Figure,
    FigureContext,
    highest,
    new_sheet,
)
from protractile.runs.report.labels import farthest

# Lower and upper percentile of the band of an ensemble.
BAND = (5.0, 95.0)
# Opacity of overlapping bands.
SHADE = 0.8
# Line style of each share of the range.
DASHES = ("-", ":", "--")
# Relative energy that counts as zero.
ROUND_OFF = 1.0e-16
# Strength of the colour of each stored energy, and of dissipated energies.
STORED = {"strain_energy": 0.65, "kinetic_energy": 0.3, "contact_energy": 1.0}
DISSIPATED = (0.75, 0.45, 0.2)


# Direction of each tip displacement in titles and captions.
DIRECTIONS = {"tip": ", vertical (z)", "tip_lateral": ", lateral (y)"}


def tip(run: FigureContext) -> list[Figure]:
    """Draw the tip deflection of all models, with a panel for each direction."""
    figures = []
    for place in run.tips:
        sheet, (axes,) = run.over_time(1, 3.9)
        axes.set_ylabel("deflection (mm)")
        for name in run.models:
            run.line(axes, name, run.time, TO_MILLI * run.result(name, place))
            _members(run, axes, name, place)
        if limit := _limit(run, place):
            axes.axhline(limit, label="limit", **theme.LIMIT)
        way = DIRECTIONS[place] * (len(run.tips) > 1)
        caption = f"Deflection of the tip{way}, all models.{_accuracy_note(run, place)}"
        title, stem = f"Tip{way}: {_largest_deflection(run, place)}", place.replace("_", "-")
        figures.append(run.finish(sheet, axes, stem, title, caption, chart=_chart(run, place)))
    return figures


def close_up(run: FigureContext) -> list[Figure]:
    """Draw a close-up of the first peak of the tip; nothing if no model has a peak."""
    place = run.tips[0]
    if not any(run.summary[name].first_peak[place].time for name in run.models):
        return []
    end = run.first_peak_window
    in_window = run.time <= end
    sheet, (axes,) = run.over_time(1, 3.9, end)
    contacts, peakless = [], []
    circle: dict[str, Any] = {"mfc": "white", "ms": 7, "mew": 1.6}
    for name in run.models:
        deflection = TO_MILLI * run.result(name, place)
        run.line(axes, name, run.time[in_window], deflection[in_window])
        color = run.line_styles[name].color
        contact = run.summary[name].first_contact
        if contact and contact <= end:
            contacts.append(contact)
            touching = np.interp(contact, run.time, deflection)
            axes.plot(contact, touching, "o", color=color, zorder=4, **circle)
        peak, height = run.summary[name].first_peak[place]
        if peak is None or height is None:
            peakless.append(name)
        elif peak <= end:
            axes.plot(peak, TO_MILLI * height, "v", color=color, ms=8, zorder=4)
    if contacts:
        axes.plot([], [], "o", color=theme.INK, label="first contact", **circle)
    axes.plot([], [], "v", color=theme.INK, ms=8, label="first peak")
    axes.set_ylabel("deflection (mm)")
    axes.margins(y=0.08)
    way = DIRECTIONS[place] * (len(run.tips) > 1)
    title, marked = f"Tip{way}, first {end:g} s", "Triangles mark each model's"
    if contacts:
        title += f": the segments first touch at {min(contacts):.2f} s"
        marked = "Circles mark the first contact of each model, triangles its"
    caption = f"Close-up of the tip{way}. {marked} first peak."
    if peakless:
        caption += f" No peak within {run.case.time.duration:g} s: {', '.join(peakless)}."
    return [run.finish(sheet, axes, "tip-close-up", title, caption)]


def heads(run: FigureContext) -> list[Figure]:
    """Draw the deflection of the heads of outer segments, with a panel for each model."""
    joints = range(1, len(run.case.joints) + 1)
    places = ["head", *(f"head-{number}" for number in joints if number > 1)]
    return [_head(run, place) for place in places if place in run.data]


def _head(run: FigureContext, place: str) -> Figure:
    models = run.with_play or run.models
    # A single panel has room for the names of its axes.
    height = 1.1 + max(1.25 * len(models), 2.2)
    sheet, panels = run.over_time(len(models), height, share_y=True)
    curves = {name: TO_MILLI * run.result(name, place) for name in run.models}
    for axes, name in zip(panels, models, strict=True):
        for other in run.bonded:
            if other != name:
                run.line(axes, other, run.time, curves[other], linewidth=0.9)
        run.line(axes, name, run.time, curves[name], linewidth=1.1, alone=True)
        _members(run, axes, name, place)
        axes.set_title(name, color=run.line_styles[name].color)
    sheet.supylabel("deflection (mm)", fontsize=theme.RC["font.size"])
    number = int(place.partition("-")[2] or 1)
    which = run.case.joints[number - 1].outer if run.case.joints else run.case.segments[0].name
    bonded = [run.labels[name] for name in run.bonded if name in run.models]
    dashed = f" Dashed: {', '.join(bonded)}, without play." if bonded else ""
    caption = (
        f"Deflection of the head of the segment {which!r}, model by model.{dashed}"
        f"{_accuracy_note(run, place)}"
    )
    title = f"Head of {which!r}: {_largest_deflection(run, place)}"
    return run.finish(sheet, panels[0], place, title, caption, chart=_chart(run, place))


def _chart(run: FigureContext, place: str) -> Chart:
    """Return the chart of an output in all models, with bands of ensembles."""
    curves = [
        run.curve(name, TO_MILLI * run.result(name, place), band=_band(run, name, place))
        for name in run.models
    ]
    if limit := _limit(run, place):
        curves.append(Curve("limit", np.full(run.time.size, limit), theme.INK, ":"))
    return Chart(run.time, "deflection (mm)", curves)


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


def _members(run: FigureContext, axes: Axes, name: str, place: str) -> None:
    """Draw the band of a model's ensemble, and its horizons of predictability."""
    band = _band(run, name, place)
    if band is None:
        return
    color = run.line_styles[name].color
    low, high = band
    shade = min(0.25, SHADE / len(run.with_play))
    axes.fill_between(run.time, low, high, color=color, alpha=shade, linewidth=0, zorder=1)
    for share, dashes in zip(SHARES, (":", "--"), strict=True):
        ensemble = run.summary[name].ensemble
        if ensemble and (horizon := ensemble.horizon(share)) is not None:
            axes.axvline(horizon, color=color, linestyle=dashes, linewidth=0.9)


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


def slow_peaks(run: FigureContext) -> list[Figure]:
    """Draw the slow-motion peaks of ensembles, with their spreads over the members."""
    peaks_of_models = {
        name: peaks
        for name in run.with_play
        if (ensemble := run.summary[name].ensemble)
        and (peaks := ensemble.slow_peaks)
        and peaks.time.size
    }
    if not peaks_of_models:
        return []
    sheet, (axes,) = new_sheet(1, 3.9)
    for name, peaks in peaks_of_models.items():
        style = run.line_styles[name]
        axes.errorbar(
            peaks.time,
            TO_MILLI * np.array(peaks.height),
            xerr=peaks.time_spread,
            yerr=TO_MILLI * np.array(peaks.height_spread),
            color=style.color,
            linestyle=style.linestyle,
            linewidth=0.7,
            elinewidth=1.6,
            marker="o",
            markersize=4.0,
            label=name,
        )
    axes.set(xlabel="time (s)", ylabel="height (mm)", xlim=(0.0, run.time[-1]))
    counts = [len(peaks.time) for peaks in peaks_of_models.values()]
    number = f"{min(counts)} to {max(counts)}" if min(counts) < max(counts) else f"{counts[0]}"
    caption = (
        "Peaks of the slow motion of the tip: means of the members of the ensemble, with half "
        "their range in time and height. Points end with the last peak that all members have."
    )
    title = f"Slow peaks: {number} are common to all members"
    return [run.finish(sheet, axes, "slow-peaks", title, caption, "horizons")]


def horizons(run: FigureContext) -> list[Figure]:
    """Draw each model's predictability horizon over the relative perturbation of its data."""
    measured = {
        name: horizons_of_model
        for name in run.with_play
        if (horizons_of_model := run.summary[name].horizons)
    }
    if not measured:
        return []
    sheet, (axes,) = new_sheet(1, 3.9)
    shares: dict[float, str] = {}
    for name, horizons_of_model in measured.items():
        color = run.line_styles[name].color
        logs = np.log10(horizons_of_model.relatives)
        times = np.array(horizons_of_model.times, dtype=float)
        for i, (share, dashes) in enumerate(zip(horizons_of_model.shares, DASHES, strict=False)):
            shares[share] = dashes
            axes.plot(logs, times[:, i], color=color, linestyle=dashes, marker="o", markersize=4.5)
            of_step = horizons_of_model.of_step[i]
            if of_step is not None:
                axes.plot(logs[0], of_step, "s", color=color, mfc="white", ms=7, mew=1.4, zorder=4)
        axes.plot([], [], color=color, marker="o", markersize=4.5, label=name)
    for share, dashes in shares.items():
        axes.plot([], [], color=theme.INK, linestyle=dashes, label=f"{100.0 * share:g} %")
    axes.plot([], [], "s", color=theme.INK, mfc="white", ms=7, mew=1.4, label="finer step")
    axes.set(xlabel="log₁₀ of the relative change", ylabel="horizon (s)")
    axes.set_ylim(bottom=0.0)
    caption = (
        "Time at which members of an ensemble differ by a fraction of the tip's range, over the "
        "relative change of their data. The flatter a line, the smaller the benefit of better "
        "data. Squares: a run with a finer step; below the line a finer step would help."
    )
    title = "Horizons: how long a motion can be predicted"
    return [run.finish(sheet, axes, "horizons", title, caption, "horizons")]


def energies(run: FigureContext) -> list[Figure]:
    """Draw the energies of the last model with play."""
    name = (run.with_play or run.models)[-1]
    columns = dict(zip(DRIVEN_ENERGIES, _energies(run, name).T, strict=False))
    drive_work = columns.pop("drive_work", None)
    work = columns.pop("work") + (0.0 if drive_work is None else drive_work)
    of = "work of loads" if drive_work is None else "work of loads and drives"
    held = {energy: columns.pop(energy) for energy in STORED}
    lost = {energy: values for energy, values in columns.items() if values.any()}
    parts = held | lost
    color = run.line_styles[name].color
    tints = [theme.tint(color, strength) for strength in STORED.values()]
    tints += [theme.tint(theme.LOSS, strength) for strength in DISSIPATED[: len(lost)]]
    sheet, (axes,) = run.over_time(1, 3.9)
    areas = axes.stackplot(
        run.time,
        *parts.values(),
        labels=[_energy_name(energy) for energy in parts],
        colors=tints,
        linewidth=0,
    )
    for area in areas[len(held) :]:
        # Losses have the same colour in all models.
        area.set(hatch="///", edgecolor="white")
    start = float(sum(values[0] for values in parts.values()))
    total = f"initial energy + {of}" if start else of
    axes.plot(run.time, start + work, color=theme.INK, linewidth=1.3, label=total)
    axes.set_ylabel("energy (J)")
    losses = " and ".join(_energy_name(energy) for energy in lost)
    hatched = f"; hatched: {losses}" if lost else ""
    more = " and the initial energy" if start else ""
    caption = (
        f"Stacked: strain, kinetic and contact energy of {name}{hatched}. Their sum "
        f"equals the {of}{more}, except for the residual in the next figure."
    )
    title = f"{name}: work of the loads, stored and dissipated energy"
    return [run.finish(sheet, axes, "energies", title, caption, part="numerics")]


def residuals(run: FigureContext) -> list[Figure]:
    """Draw the running maximum of the energy residual of each model."""
    sheet, (axes,) = new_sheet(1, 3.9)
    worst = []
    for name in run.models:
        so_far = np.fmax.accumulate(np.abs(energy_residual(_energies(run, name))))
        worst.append(float(so_far[-1]))
        run.line(axes, name, run.time, np.maximum(so_far, ROUND_OFF))
    axes.set_yscale("log")
    axes.set(xlabel="time (s)", ylabel="residual / largest work (–)", xlim=(0.0, run.time[-1]))
    caption = (
        "Energy residual: (kinetic + strain + contact energy + losses − initial energy − work), "
        "divided by the largest work or, if larger, the initial energy. Plotted: its largest "
        "magnitude so far."
    )
    title = f"Energy residual: up to {scientific(highest(worst), 2)} of the largest work"
    return [run.finish(sheet, axes, "energy-residual", title, caption, part="numerics")]


def _energies(run: FigureContext, name: str) -> Array:
    """Return energies (num_times, num_energies) in J by :func:`.energy.energy_residual`."""
    names = [energy for energy in DRIVEN_ENERGIES if energy in run.data]
    return np.array([run.result(name, energy) for energy in names]).T


def _energy_name(energy: str) -> str:
    """Return the displayed name of an energy: *strain* for ``strain_energy``."""
    return energy.removesuffix("_energy").replace("_", " ")
