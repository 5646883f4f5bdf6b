# SPDX-License-Identifier: LGPL-3.0-or-later
"""What drives take and do, as tables: forces, power and work, and how the tip swings."""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.typography import TO_KILO, TO_MILLI
from runs.pipeline.results import Results
from runs.report.tables import Column, Table


def drive_table(results: Results) -> Table | None:
    """Of every model and drive; None where nothing is drawn out."""
    data = results.trajectories
    rows = [
        _taken(
            str(model),
            inner,
            data["time"].values,
            *(_of(results, str(model), n + suffix) for n in _READ),
        )
        for suffix, inner in results.case.driven.items()
        if f"drive_power{suffix}" in data
        for model in data["model"].values
    ]
    if not rows:
        return None
    columns = (
        Column("model", [row[0] for row in rows]),
        Column("drive of", [row[1] for row in rows]),
        Column("against friction:\nmean, kN", [row[2] for row in rows], ".3g", TO_KILO),
        Column("at most\nkN", [row[3] for row in rows], ".3g", TO_KILO),
        Column("power, at most\nkW", [row[4] for row in rows], ".3g", TO_KILO),
        Column("work\nkJ", [row[5] for row in rows], ".3g", TO_KILO),
    )
    notes = (
        "Against the friction of pads along the boom, while it is drawn; power and work with what "
        "contact forces do on their slope, and against what presses along the boom.",
    )
    return Table("Drives", columns, notes, "drives")


def stick_slip_table(results: Results) -> Table | None:
    """Of every model and drive of a given stiffness; None where all are stiff."""
    rows = [
        (str(model), inner, own.stick_slip[name])
        for suffix, inner in results.case.driven.items()
        for model, own in results.summary.models.items()
        if (name := f"drive_force{suffix}") in own.stick_slip
    ]
    if not rows:
        return None
    found = [told for *_, told in rows]
    columns = (
        Column("model", [model for model, *_ in rows]),
        Column("drive of", [inner for _, inner, _ in rows]),
        Column("force:\nmean, kN", [one.mean for one in found], ".3g", TO_KILO),
        Column("at most\nkN", [one.peak for one in found], ".3g", TO_KILO),
        Column("sticks\ntimes", [one.sticks for one in found]),
        Column("slips by at most\nmm", [one.slip for one in found], ".3g", TO_MILLI),
        Column("ends behind by\nmm", [one.behind for one in found], ".3g", TO_MILLI),
        Column("at most\nm/s", [one.speed for one in found], ".3g"),
        Column("at most\nm/s²", [one.acceleration for one in found], ".3g"),
    )
    notes = (
        "Force: against friction, with what weighs along and what is sped up. Sticks: how often it "
        "comes to stand while it is drawn. Slips: how far it catches up with its drive in one "
        "slip. Then its own speed and acceleration. The boom moves as it is drawn by a stiff one. "
        "Friction is that of the mean force of each output step: where pads chatter faster than "
        "that, it sticks at other times, and a smaller output_step tells.",
    )
    return Table("Drives that give way", columns, notes, "stick-slip")


def swing_table(results: Results) -> Table | None:
    """Of every model that is drawn out, beside the same boom that stands; None of none."""
    models = results.summary.answers.models
    rows = {name: own.swing for name, own in models.items() if own.swing is not None}
    if not rows:
        return None
    swings = list(rows.values())
    columns = (
        Column("model", list(rows)),
        Column("tip swings\nmm", [one.tip for one in swings], ".4g", TO_MILLI),
        Column("at\ns", [one.time for one in swings], ".3f"),
        Column(
            "at rest where\nit begins, mm", [one.where_begun for one in swings], ".4g", TO_MILLI
        ),
        Column("at rest where\nit ends, mm", [one.where_ended for one in swings], ".4g", TO_MILLI),
    )
    notes = (
        "The largest distance of the tip from where it would rest, drawn out as far as it is and "
        "under the loads of that moment; beside it that of the same boom that is not drawn.",
    )
    return Table("Swing while it is drawn", columns, notes, "swing")


_READ = ("drawn_out", "drive_friction", "drive_power")


def _of(results: Results, model: str, name: str) -> Array:
    return np.asarray(results.trajectories[name].sel(model=model).values, dtype=float)


def _taken(
    model: str, inner: str, time: Array, way: Array, friction: Array, power: Array
) -> tuple[str, str, float, float, float, float]:
    """Model, segment, mean and largest force in N, largest power in W, work in J."""
    moving = np.diff(way, prepend=way[0]) != 0.0
    mean = float(np.abs(friction[moving]).mean()) if moving.any() else 0.0
    work = float((power[1:] * np.diff(time)).sum())
    return model, inner, mean, float(np.abs(friction).max()), float(power.max()), work
