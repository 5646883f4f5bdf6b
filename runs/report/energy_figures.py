# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where the energy of a run is, and how much of it is unaccounted for."""

from __future__ import annotations

import numpy as np

from dynamics.energy import DRIVEN_ENERGIES, energy_residual
from geometry.arrays import Array
from runs.report import theme
from runs.report.drawn_axis import drawn_axis
from runs.report.figure_context import Figure, Pen, highest, new_sheet
from runs.report.numerals import scientific

# Of the numbers that an energy is the sum of.
ROUND_OFF = 1.0e-16
# Shades of what is held, of the model's colour, and of what is lost.
HELD = {"strain_energy": 0.65, "kinetic_energy": 0.3, "contact_energy": 1.0}
LOST = (0.75, 0.45, 0.2)


def energies(pen: Pen) -> list[Figure]:
    """Where the energy of one model is: the last with play, the most complicated."""
    name = (pen.with_play or pen.models)[-1]
    columns = dict(zip(DRIVEN_ENERGIES, _energies(pen, name).T, strict=False))
    drawn = columns.pop("drive_work", None)
    work = columns.pop("work") + (0.0 if drawn is None else drawn)
    of = "work of the load" if drawn is None else "work of load and drive"
    held = {energy: columns.pop(energy) for energy in HELD}
    lost = {energy: values for energy, values in columns.items() if values.any()}
    parts = held | lost
    color = pen.strokes[name].color
    tints = [theme.tint(color, strength) for strength in HELD.values()]
    tints += [theme.tint(theme.LOSS, strength) for strength in LOST[: len(lost)]]
    sheet, (axes,) = new_sheet(1, 3.9)
    areas = axes.stackplot(
        pen.time,
        *parts.values(),
        labels=[_named(energy) for energy in parts],
        colors=tints,
        linewidth=0,
    )
    for area in areas[len(held) :]:
        # Whatever the model's colour is.
        area.set(hatch="///", edgecolor="white")
    start = float(sum(values[0] for values in parts.values()))
    total = f"start and {of}" if start else of
    axes.plot(pen.time, start + work, color=theme.INK, linewidth=1.3, label=total)
    axes.set(xlabel="time (s)", ylabel="energy (J)", xlim=(0.0, pen.time[-1]))
    drawn_axis(pen, axes)
    losses = " and ".join(_named(energy) for energy in lost)
    hatched = f"; hatched: {losses}" if lost else ""
    more = " and what was there at the start" if start else ""
    caption = (
        f"Strain, kinetic and contact energy of {name} on top of one another{hatched}. Their sum "
        f"is the {of}{more}, up to the residual of the next figure."
    )
    title = f"{name}: the load's work, and where it is"
    return [pen.finish(sheet, axes, "energies", title, caption, part="numerics")]


def residuals(pen: Pen) -> list[Figure]:
    """Unaccounted energy of every model, the largest so far."""
    sheet, (axes,) = new_sheet(1, 3.9)
    worst = []
    for name in pen.models:
        so_far = np.fmax.accumulate(np.abs(energy_residual(_energies(pen, name))))
        worst.append(float(so_far[-1]))
        pen.line(axes, name, pen.time, np.maximum(so_far, ROUND_OFF))
    axes.set_yscale("log")
    axes.set(xlabel="time (s)", ylabel="part of the work (–)", xlim=(0.0, pen.time[-1]))
    caption = (
        "Kinetic, strain and contact energy, plus what was lost, less the work of the load, over "
        "the largest work: the largest so far. Without contact the motion is exact to round-off."
    )
    title = f"Unaccounted energy: up to {scientific(highest(worst), 2)} of the work"
    return [pen.finish(sheet, axes, "energy-residual", title, caption, part="numerics")]


def _energies(pen: Pen, name: str) -> Array:
    """(num_times, num_energies) in J, as in :func:`dynamics.energy.energy_residual`."""
    known = [energy for energy in DRIVEN_ENERGIES if energy in pen.data]
    return np.array([pen.of(name, energy) for energy in known]).T


def _named(energy: str) -> str:
    """``strain_energy`` as *strain*, ``friction_loss`` as *friction loss*."""
    return energy.removesuffix("_energy").replace("_", " ")
