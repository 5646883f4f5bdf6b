# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of drives: forces, powers and work, luffing by cylinders, stick-slip."""

from __future__ import annotations

import numpy as np

from protractile.geometry.ground import force_name
from protractile.runs.case.motions import frame_motion
from protractile.runs.pipeline.results import Results
from protractile.runs.report.tables import Column, Table


def drive_table(results: Results) -> Table:
    """Return the table of forces, powers and work of drives."""
    data = results.trajectories
    rows = [
        (str(model), inner, *_effort(results, str(model), suffix))
        for suffix, inner in results.case.driven_segments.items()
        if f"drive_power{suffix}" in data
        for model in data["model"].values
    ]
    columns = (
        "model",
        "drive of",
        ("against friction:\nmean", ".3g", "kN"),
        ("at most", ".3g", "kN"),
        ("power, at most", ".3g", "kW"),
        ("work", ".3g", "kJ"),
    )
    notes = (
        "Forces against the friction of the pads during telescoping. Power and work include "
        "contact forces on sloping segments and axial loads.",
    )
    return Table.of_rows("drives", "Drives", columns, rows, notes)


def _effort(results: Results, model: str, suffix: str) -> tuple[float, float, float, float]:
    """Return a drive's mean and maximum friction force in N, maximum power in W and work in J."""
    data = results.trajectories.sel(model=model)
    extension, friction, power = (
        np.asarray(data[name + suffix].values, dtype=float)
        for name in ("extension", "drive_friction", "drive_power")
    )
    moving = np.diff(extension, prepend=extension[0]) != 0.0
    mean = float(np.abs(friction[moving]).mean()) if moving.any() else 0.0
    work = float((power[1:] * np.diff(data["time"].values)).sum())
    return mean, float(np.abs(friction).max()), float(power.max()), work


def luffing_table(results: Results) -> Table | None:
    """Return the table of cylinder lengths and forces in luffing; None without luffing."""
    boom, data = results.boom, results.trajectories
    foot = next((segment.foot for segment in boom.segments if segment.foot), None)
    if results.case.luff is None or not boom.cylinders or foot is None:
        return None
    frame = frame_motion(results.case, boom.segments)
    time, rows = data["time"].values, []
    turns = frame.luff_angle(time) - frame.luff_angle(time[0])
    for position, cylinder in enumerate(boom.cylinders, start=1):
        luffed = [cylinder.luffed(turn, foot) for turn in turns.tolist()]
        lengths = np.array([raised.length for raised in luffed])
        arms = cylinder.arm(foot) / np.array([raised.arm(foot) for raised in luffed])
        for model in data["model"].values:
            force = arms * data[force_name(position)].sel(model=model).values
            ends = lengths[0], lengths[-1], np.ptp(lengths)
            rows.append((str(model), position, *ends, force.min(), force.max()))
    columns = (
        "model",
        "cylinder",
        ("length at\nthe start", ".4g", "m"),
        ("at the end", ".4g", "m"),
        ("stroke", ".4g", "m"),
        ("least force", ".4g", "kN"),
        ("largest force", ".4g", "kN"),
    )
    notes = ("Compression is positive. Forces refer to the lever arm at the current angle.",)
    return Table.of_rows("luffing", "Luffing", columns, rows, notes)


def stick_slip_table(results: Results) -> Table:
    """Return the table of stick-slip results of elastic drives."""
    rows = [
        (model, inner, model_summary.stick_slip[name])
        for suffix, inner in results.case.driven_segments.items()
        for model, model_summary in results.summary.models.items()
        if (name := f"drive_force{suffix}") in model_summary.stick_slip
    ]
    motions = [motion for *_, motion in rows]
    columns = (
        Column("model", [model for model, *_ in rows]),
        Column("drive of", [inner for _, inner, _ in rows]),
        Column("force:\nmean", [motion.mean for motion in motions], ".3g", "kN"),
        Column("at most", [motion.peak for motion in motions], ".3g", "kN"),
        Column("sticks", [motion.sticks for motion in motions], unit="times"),
        Column("slips by at most", [motion.slip for motion in motions], ".3g", "mm"),
        Column("lag at the end", [motion.behind for motion in motions], ".3g", "mm"),
        Column("at most", [motion.speed for motion in motions], ".3g", "m/s"),
        Column("at most", [motion.acceleration for motion in motions], ".3g", "m/s²"),
    )
    notes = (
        "Force: against friction, weight and inertia. Sticks: number of stops during telescoping. "
        "Slips: largest advance in one slip. Speed and acceleration of the segment. "
        "The boom moves as with a rigid drive. Friction follows the mean contact force of each "
        "output step; "
        "where pads chatter faster, use a smaller output_step.",
    )
    return Table("Elastic drives: stick-slip", columns, notes, "stick-slip")
