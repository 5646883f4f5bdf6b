# SPDX-License-Identifier: LGPL-3.0-or-later
"""The figures of a run, as PNG: deflections, contact forces, energies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Sheet
from matplotlib.ticker import FuncFormatter, NullFormatter

from dynamics.energy import ENERGIES, energy_residual
from dynamics.horizon import SHARES
from runs import theme
from runs.questions import tied
from runs.results import Results

Array = npt.NDArray[np.float64]

MILLI = 1.0e3
KILO = 1.0e3

# The stretch that shows the first press of the play and the first peak, in s.
CLOSE_UP = 1.2
# The stretch in which single contacts can be told apart, in s.
FIRST_CONTACTS = 1.0
# Over a whole run only the largest force of each of so many intervals can be seen.
FORCE_BINS = 100
# Below this a contact force is as good as none in a picture, in N.
LEAST_FORCE = 1000.0
# Impacts follow one another within milliseconds; their mean over so many s holds the boom.
FORCE_WINDOW = 0.010
# Of an ensemble this part of the members lies in its band, in percent.
BAND = (5.0, 95.0)
# Of the numbers that an energy is the sum of.
ROUND_OFF = 1.0e-16


@dataclass(frozen=True, slots=True)
class Figure:
    """A picture on disk, and what it shows."""

    path: Path
    title: str
    caption: str


def draw(results: Results, folder: Path) -> list[Figure]:
    """Draw all figures of a run that it has the numbers for.

    Args:
        results: one run.
        folder: where the PNG files go; it must exist.
    """
    with matplotlib.rc_context(theme.RC):
        pen = _Pen(results, folder)
        figures = [pen.tip(), pen.close_up()]
        if "head" in results.trajectories:
            figures.append(pen.head())
        if pen.with_play and results.trajectories.sizes["station"]:
            figures += [pen.first_contacts(), pen.contact_peaks()]
        return [*figures, pen.energies(), pen.residuals()]


class _Pen:
    """Draws one run's figures with one stroke per model."""

    def __init__(self, results: Results, folder: Path) -> None:
        self.data = results.trajectories
        self.ensembles = results.ensembles
        self.summary = results.summary["models"]
        self.folder = folder
        self.time = np.asarray(self.data["time"].values, dtype=float)
        self.models = [str(name) for name in self.data["model"].values]
        self.play_free = [model.name for model in results.case.models if tied(model)]
        self.with_play = [name for name in self.models if name not in self.play_free]
        self.strokes = theme.strokes(self.models, self.play_free)

    def tip(self) -> Figure:
        """The tip in all models, over one another."""
        sheet, (axes,) = _sheet(1, 3.9)
        for name in self.models:
            self._line(axes, name, self.time, MILLI * self._of(name, "tip"))
            self._members(axes, name, "tip")
        axes.set(xlabel="time (s)", ylabel="deflection (mm)", xlim=(0.0, self.time[-1]))
        caption = "Deflection of the tip, all models: the counterpart of Fig. 6 of the paper."
        return self._finish(
            sheet, axes, "tip", f"Tip: {self._reach('tip')}", caption + self._sampled()
        )

    def head(self) -> Figure:
        """The head of the first segment; it rattles, so each model has its own panel."""
        models = self.with_play or self.models
        sheet, panels = _sheet(len(models), 1.1 + 1.25 * len(models))
        heads = {name: MILLI * self._of(name, "head") for name in self.models}
        for axes, name in zip(panels, models, strict=True):
            for other in self.play_free:
                if other != name:
                    self._line(axes, other, self.time, heads[other], linewidth=0.9)
            self._line(axes, name, self.time, heads[name], linewidth=1.1)
            self._members(axes, name, "head")
            axes.set_title(name, color=self.strokes[name].color)
            axes.set(xlim=(0.0, self.time[-1]), ylim=_limits(list(heads.values())))
        panels[-1].set_xlabel("time (s)")
        sheet.supylabel("deflection (mm)", fontsize=theme.RC["font.size"])
        caption = (
            "Deflection of the first segment's head, model by model: the counterpart of Fig. 7 of "
            "the paper." + (" Dashed: without play." if self.play_free else "")
        )
        return self._finish(
            sheet, None, "head", f"Head: {self._reach('head')}", caption + self._sampled()
        )

    def close_up(self) -> Figure:
        """The tip up to shortly after its first peak."""
        end = min(CLOSE_UP, self.time[-1])
        shown = self.time <= end
        sheet, (axes,) = _sheet(1, 3.9)
        for name in self.models:
            tip = MILLI * self._of(name, "tip")
            self._line(axes, name, self.time[shown], tip[shown])
            color = self.strokes[name].color
            contact = self.summary[name]["first_contact"]
            if contact is not None and contact <= end:
                height = float(np.interp(contact, self.time, tip))
                axes.plot(contact, height, "o", color=color, mfc="white", ms=7, mew=1.6, zorder=4)
            peak, height = self.summary[name]["first_peak"]["tip"]
            if peak is not None and peak <= end:
                axes.plot(peak, MILLI * height, "v", color=color, ms=8, zorder=4)
        axes.plot([], [], "o", color=theme.INK, mfc="white", ms=7, mew=1.6, label="first contact")
        axes.plot([], [], "v", color=theme.INK, ms=8, label="first peak")
        axes.set(xlabel="time (s)", ylabel="deflection (mm)", xlim=(0.0, end))
        axes.margins(y=0.08)
        contacts = [self.summary[name]["first_contact"] for name in self.with_play]
        known = [contact for contact in contacts if contact is not None and contact <= end]
        title = f"Tip, first {end:g} s" + (
            f": the segments first touch at {min(known):.2f} s" if known else ""
        )
        caption = (
            "Close-up of the tip. Circles mark where a model's segments first touch, triangles "
            "its first peak, on which several verdicts rest."
        )
        return self._finish(sheet, axes, "tip-close-up", title, caption)

    def first_contacts(self) -> Figure:
        """Mean contact force at each station while single presses can be told apart."""
        end = min(FIRST_CONTACTS, self.time[-1])
        shown = self.time <= end
        stations = self.data["station"].values
        width = max(1, round(FORCE_WINDOW / (self.time[1] - self.time[0])))
        window = np.full(width, 1.0 / width)
        sheet, panels = _sheet(len(stations), 1.3 + 2.0 * len(stations))
        for i, (axes, station) in enumerate(zip(panels, stations, strict=True)):
            for name in self.with_play:
                force = self._force(name, "contact_force")[:, i] / KILO
                mean = np.convolve(force, window, mode="same")
                self._line(axes, name, self.time[shown], mean[shown], linewidth=1.3)
            axes.set(title=f"x = {station:g} m", ylabel="force (kN)", xlim=(0.0, end))
        panels[-1].set_xlabel("time (s)")
        title = f"Mean contact forces, first {end:g} s"
        caption = (
            f"Contact force at each station, mean over {MILLI * FORCE_WINDOW:g} ms: what the many "
            "short impacts of a press amount to. Positive where the inner segment presses up."
        )
        return self._finish(sheet, panels[0], "contact-first", title, caption)

    def contact_peaks(self) -> Figure:
        """Largest contact force at each station in each part of the run."""
        bins = np.array_split(np.arange(self.time.size), min(FORCE_BINS, self.time.size))
        middle = np.array([self.time[part].mean() for part in bins])
        stations = self.data["station"].values
        sheet, panels = _sheet(len(stations), 1.3 + 2.0 * len(stations))
        for i, (axes, station) in enumerate(zip(panels, stations, strict=True)):
            for name in self.with_play:
                force = np.abs(self._force(name, "contact_force_peak")[:, i])
                largest = np.array([_highest(force[part]) for part in bins])
                largest[~(largest > LEAST_FORCE)] = np.nan
                self._line(axes, name, middle, largest / KILO, linewidth=1.1, marker="o")
            axes.set_yscale("log")
            axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axes.yaxis.set_minor_formatter(NullFormatter())
            axes.set(title=f"x = {station:g} m", ylabel="force (kN)", xlim=(0.0, self.time[-1]))
        panels[-1].set_xlabel("time (s)")
        peaks = [self.summary[name]["peak_contact_force"] for name in self.with_play]
        known = [peak for peak in peaks if peak is not None]
        title = "Peak contact forces" + (f": up to {max(known) / KILO:.0f} kN" if known else "")
        caption = (
            f"Largest contact force at each station in every {self.time[-1] / len(bins):.2g} s, up "
            f"or down, on a logarithmic scale; no mark where it stays below {LEAST_FORCE / KILO:g} "
            "kN."
        )
        return self._finish(sheet, panels[0], "contact-peaks", title, caption)

    def energies(self) -> Figure:
        """Where the energy of one model is: the last with play, the most complicated."""
        name = (self.with_play or self.models)[-1]
        kinetic, strain, contact, work, dissipated = self._energies(name).T
        sheet, (axes,) = _sheet(1, 3.9)
        parts = {"strain": strain, "kinetic": kinetic, "contact": contact}
        if dissipated.any():
            parts["dissipated"] = dissipated
        color = self.strokes[name].color
        tints = [theme.tint(color, strength) for strength in (0.65, 0.3, 1.0, 0.1)]
        axes.stackplot(
            self.time, *parts.values(), labels=list(parts), colors=tints[: len(parts)], linewidth=0
        )
        axes.plot(self.time, work, color=theme.INK, linewidth=1.3, label="work of the load")
        axes.set(xlabel="time (s)", ylabel="energy (J)", xlim=(0.0, self.time[-1]))
        caption = (
            f"Strain, kinetic and contact energy of {name} on top of one another. Their sum is the "
            "work of the load, up to the residual of the next figure."
        )
        return self._finish(
            sheet, axes, "energies", f"{name}: the load's work, and where it is", caption
        )

    def residuals(self) -> Figure:
        """Unaccounted energy of every model, the largest so far."""
        sheet, (axes,) = _sheet(1, 3.9)
        worst = []
        for name in self.models:
            so_far = np.fmax.accumulate(np.abs(energy_residual(self._energies(name))))
            worst.append(float(so_far[-1]))
            self._line(axes, name, self.time, np.maximum(so_far, ROUND_OFF))
        axes.set_yscale("log")
        axes.set(xlabel="time (s)", ylabel="part of the work (–)", xlim=(0.0, self.time[-1]))
        caption = (
            "Kinetic, strain and contact energy, plus what was dissipated, less the work of the "
            "load, over the largest work: the largest so far. Without contact the motion is exact "
            "to round-off."
        )
        title = f"Unaccounted energy: at most {theme.scientific(_highest(worst))} of the work"
        return self._finish(sheet, axes, "energy-residual", title, caption)

    def _reach(self, place: str) -> str:
        """How far the models deflect at one place, upwards or downwards."""
        parts = [
            f"{MILLI * _farthest([_farthest(self._of(name, place)) for name in names]):.0f} mm{how}"
            for names, how in ((self.with_play, " with play"), (self.play_free, " without"))
            if names
        ]
        return "up to " + ", ".join(parts)

    def _sampled(self) -> str:
        if not self.with_play:
            return ""
        if self.ensembles is not None:
            low, high = BAND
            first, last = (f"{100.0 * share:g} %" for share in SHARES)
            return (
                f" Shaded: {low:g} to {high:g} % of the {self.ensembles.sizes['member']} members "
                f"of each model's ensemble. Vertical lines: from when its members are {first} "
                f"(dotted) and {last} (dashed) of the tip's range around one another, beyond which "
                "a curve is one sample of a chaotic motion."
            )
        return " After the first presses a curve with play is one sample of a chaotic motion."

    def _of(self, name: str, variable: str) -> Array:
        return np.asarray(self.data[variable].sel(model=name).values, dtype=float)

    def _force(self, name: str, variable: str) -> Array:
        """(num_times, num_stations) in N."""
        force = self.data[variable].sel(model=name).transpose("time", "station")
        return np.asarray(force.values, dtype=float)

    def _energies(self, name: str) -> Array:
        """(num_times, 5) in J, the columns of ``ENERGIES``."""
        return np.array([self._of(name, energy) for energy in ENERGIES]).T

    def _line(
        self, axes: Axes, name: str, x: Array, y: Array, linewidth: float = 1.5, marker: str = ""
    ) -> None:
        stroke = self.strokes[name]
        axes.plot(
            x,
            y,
            color=stroke.color,
            linestyle=stroke.linestyle,
            linewidth=linewidth,
            marker=marker,
            markersize=2.5,
            label=name,
        )

    def _members(self, axes: Axes, name: str, place: str) -> None:
        """The band of a model's ensemble behind its curve, and its horizons."""
        if self.ensembles is None or name not in self.ensembles["model"]:
            return
        if place not in self.ensembles:
            return
        color = self.strokes[name].color
        members = MILLI * self.ensembles[place].sel(model=name).values
        low, high = np.percentile(members, BAND, axis=0)
        axes.fill_between(self.time, low, high, color=color, alpha=0.25, linewidth=0, zorder=1)
        horizons = self.summary[name]["ensemble"]["horizons"]
        for share, dashes in zip(SHARES, (":", "--"), strict=True):
            if horizons[f"{share:g}"] is not None:
                axes.axvline(horizons[f"{share:g}"], color=color, linestyle=dashes, linewidth=0.9)

    def _finish(
        self, sheet: Sheet, legend_of: Axes | None, stem: str, title: str, caption: str
    ) -> Figure:
        """Title above, legend below, and onto the disk."""
        if legend_of is not None:
            handles, labels = legend_of.get_legend_handles_labels()
            sheet.legend(handles, labels, loc="outside lower left", ncols=2)
        sheet.suptitle(title, x=0.02, ha="left", fontsize=12.0, fontweight="bold", wrap=True)
        path = self.folder / f"{stem}.png"
        sheet.savefig(path)
        return Figure(path, title, caption)


def _sheet(panels: int, height: float) -> tuple[Sheet, list[Axes]]:
    """A sheet with panels above one another that share their time."""
    sheet = Sheet(figsize=(theme.WIDTH, height))
    FigureCanvasAgg(sheet)
    column = sheet.subplots(panels, 1, sharex=True, squeeze=False)
    return sheet, list(column[:, 0])


def _farthest(values: Sequence[float] | Array) -> float:
    """The finite one that is farthest from zero, with its sign, NaN if there are none."""
    finite = np.asarray(values)[np.isfinite(values)]
    return float(finite[np.abs(finite).argmax()]) if finite.size else float("nan")


def _highest(values: Sequence[float] | Array) -> float:
    """The largest of the finite ones, NaN if there are none."""
    finite = np.asarray(values)[np.isfinite(values)]
    return float(finite.max()) if finite.size else float("nan")


def _limits(curves: Sequence[Array]) -> tuple[float, float]:
    """Limits of an axis on which all curves fit."""
    high = _highest([_highest(curve) for curve in curves])
    low = -_highest([_highest(-curve) for curve in curves])
    margin = 0.05 * (high - low) or 1.0
    return low - margin, high + margin
