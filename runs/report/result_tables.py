# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of design results: static states, modes, motion, drives, pads, stresses, fatigue."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

import numpy as np

from protractile.analysis.motion_results import Peak
from protractile.analysis.states import StaticResult
from protractile.geometry.cylinder import force_name
from protractile.runs.case.motions import frame_motion
from protractile.runs.pipeline.combinations import combination_tables
from protractile.runs.pipeline.design_results import ModelDesignResults, PlayDifference
from protractile.runs.pipeline.metrics import records
from protractile.runs.pipeline.pad_walls import rigid_wall_note
from protractile.runs.pipeline.proofs import proof_table
from protractile.runs.pipeline.results import Results
from protractile.runs.report.figure_context import extension_note
from protractile.runs.report.formatting import ROUND_OFF, amount, number, without_round_off
from protractile.runs.report.model_tables import metric_columns
from protractile.runs.report.tables import Cell, Column, Table

# Relative difference below which an effect is negligible.
NEGLIGIBLE = 0.005


def result_tables(results: Results) -> list[Table]:
    """Return the tables of design results in the order of the report, without the summary."""
    design = results.summary.design
    tables = [
        play_table(results),
        *rest_tables(results),
        mode_table(results),
        peak_table(results),
        drive_table(results),
        luffing_table(results),
        stick_slip_table(results),
        *record_tables(results),
        pad_table(results),
        stress_table(results),
        buckling_table(results),
        life_table(results),
        *combination_tables(design.combinations, results.case),
        design.proofs and proof_table(design.proofs, results.case),
    ]
    return [table for table in tables if table is not None and table.rows]


def play_table(results: Results) -> Table | None:
    """Return the table of results with play and with bonded joints."""
    effect = results.play
    if effect is None:
        return None
    rows = effect.numbers
    added = ["negligible" if is_negligible(one) else amount(one.increase, one.unit) for one in rows]
    columns = (
        Column("", [_named(one.what, one.where) for one in rows]),
        Column("with play", [amount(one.with_play, one.unit) for one in rows]),
        Column("without play", [amount(one.bonded, one.unit) for one in rows]),
        Column("play adds", added),
        Column("", [None if is_negligible(one) else one.share for one in rows], ".3g", "%"),
    )
    notes = (
        "Magnitudes, and the difference of the magnitudes. Forces, moments, reactions and stresses "
        "are maxima of the motion.",
    )
    return Table(f"Effect of play: {effect.model}", columns, notes, "play")


def rest_tables(results: Results) -> list[Table]:
    """Return the tables of static joint rotations, contact forces and support reactions."""
    farthest = {
        name: design.farthest_static for name, design in results.summary.design.models.items()
    }
    rests = {name: rest for name, rest in farthest.items() if rest is not None}
    as_extended = extension_note(results.case, rests.values())
    return [
        _tilt_table(rests, as_extended),
        _contact_table(rests, as_extended),
        _reaction_table(results),
    ]


def _tilt_table(rests: dict[str, StaticResult], as_extended: str) -> Table:
    tilts = [(name, tilt) for name, rest in rests.items() for tilt in rest.tilts]
    columns = (
        Column("model", [name for name, _ in tilts]),
        Column("joint", [f"{tilt.inner} in {tilt.outer}" for _, tilt in tilts]),
        Column("rotation", [tilt.rotation for _, tilt in tilts], ".3g", "mrad"),
        Column("resulting tip deflection", [tilt.tip for _, tilt in tilts], ".1f", "mm"),
    )
    note = "The rotation is due to play and contact compliance, in a shell also to wall compliance."
    title = "Static state with the largest tip deflection: rotation of joints by play and walls"
    return Table(title, columns, (note + as_extended,), "tilts")


def _contact_table(rests: dict[str, StaticResult], as_extended: str) -> Table:
    places = dict.fromkeys(station.place for rest in rests.values() for station in rest.stations)
    columns = [Column("station", [_station(place) for place in places])]
    for name, rest in rests.items():
        forces = {one.place: one.force for one in rest.stations}
        if forces:
            columns.append(Column(name, [forces.get(place) for place in places], ".4g", "kN"))
    note = "Forces on the outer segment, positive upwards, lateral ones towards larger y."
    title = "Static state with the largest tip deflection: contact forces"
    return Table(title, columns, (note + as_extended,), "pressed")


def _reaction_table(results: Results) -> Table:
    design = results.summary.design
    reactions = design.reactions
    largest = max((abs(one.force) for one in reactions), default=0.0)
    least = ROUND_OFF * largest * results.boom.length
    moments = without_round_off([one.moment for one in reactions], least)
    bonded = {(one.segment, one.x): one.force for one in design.reactions_bonded}
    beside = [bonded.get((one.segment, one.x)) for one in reactions]
    lugs = {(results.boom.segments[one.segment].name, one.x) for one in results.boom.cylinders}
    kinds = ["lug" if (one.segment, one.x) in lugs else "support" for one in reactions]
    places = [
        f"{kind}, {one.segment} at {one.x:g} m" for kind, one in zip(kinds, reactions, strict=True)
    ]
    columns = (
        Column("support or cylinder lug", places),
        Column("transverse force", [one.force for one in reactions], ".4g", "kN"),
        *_force_column("axial force", [one.along for one in reactions], ".4g", "kN"),
        *_force_column("moment", moments, ".3g", "kN m"),
        Column("transverse force,\nwithout play", beside, ".4g", "kN"),
    )
    notes = (
        "Computed with beam elements. The forces act on the boom and are positive towards its "
        "upper side or the tip. Moments are positive if they turn the tip upwards.",
    )
    return Table("Static state at t = 0: support reactions", columns, notes, "reactions")


def _force_column(title: str, carried: list[float], form: str, unit: str) -> Iterator[Column]:
    """Yield a column of forces, with 0 in place of round-off; nothing if all forces are 0."""
    if any(carried):
        yield Column(title, without_round_off(carried), form, unit)


def mode_table(results: Results) -> Table:
    """Return the table of the first modes with closed contacts, all models side by side."""
    of = {
        name: {(mode.motion, mode.number): mode.frequency for mode in design.modes}
        for name, design in results.summary.design.models.items()
        if design.modes
    }
    lowest: dict[tuple[str, int], float] = {}
    for frequencies in of.values():
        for mode, frequency in frequencies.items():
            lowest[mode] = min(frequency, lowest.get(mode, frequency))
    rows = sorted(lowest, key=lambda mode: lowest[mode])
    columns = [Column("mode", [f"{motion} {count}" for motion, count in rows])]
    columns += [
        Column(name, [frequencies.get(mode) for mode in rows], ".4g", "Hz")
        for name, frequencies in of.items()
    ]
    notes = (
        "The modes keep the contacts of the static state at t = 0: closed ones stay closed, open "
        "ones stay open.",
        *filter(None, [rigid_wall_note(results.completed_models, results.boom)]),
    )
    return Table("Modes in the static state at t = 0", columns, notes, "modes")


def peak_table(results: Results) -> Table:
    """Return the table of maxima in motion, with ratios to static values, for the main models."""
    of = {
        name: {
            (peak.what, peak.where): f"{amount(peak.largest, peak.unit)}{times(peak)}"
            for peak in motion.peaks
        }
        for name, motion in results.motions.items()
    }
    rows = dict.fromkeys(where for peaks in of.values() for where in peaks)
    columns = [Column("maximum", [_named(what, where) for what, where in rows])]
    columns += [Column(name, [peaks.get(where) for where in rows]) for name, peaks in of.items()]
    notes = ("Absolute values. In brackets: ratio to the static value under the maximum load.",)
    return Table("Forces and deflections in motion", columns, notes, "peaks")


def is_negligible(one: PlayDifference) -> bool:
    """Return True if the effect of play is negligible."""
    return one.share is not None and abs(one.share) < NEGLIGIBLE


def times(peak: Peak) -> str:
    """Return the dynamic factor of a maximum as text; empty if it has none."""
    return "" if peak.factor is None else f" (× {number(peak.factor)})"


# Names of results at a place.
_NAMES = {
    "deflection": "maximum dynamic {} deflection",
    "deflection at rest": "static tip deflection (maximum load)",
    "reaction": "transverse reaction, {}",
    "reaction along the boom": "axial reaction, {}",
    "reaction, across and along": "foot reaction, {}",
    "stress": "bending stress, {}",
}


def _station(place: str) -> str:
    """Return the position of a station, from its name in the results: ``x = 3.8 m, lateral``."""
    x, *more = re.split("(?=[y#])", place)
    return ", ".join([f"x = {x} m", *("lateral" if one == "y" else one for one in more)])


def _named(what: str, where: str) -> str:
    if what == "contact force":
        return f"{what}, {_station(where)}"
    if what == "cylinder force":
        return where.replace("_", " ").replace("-", " ")
    return _NAMES.get(what, f"{what}, {{}}" if where else what).format(where)


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


def luffing_table(results: Results) -> Table | None:
    """Return the table of cylinder lengths and forces in luffing; None without luffing."""
    boom, data = results.boom, results.trajectories
    foot = next((one.foot for one in boom.segments if one.foot), None)
    if results.case.luff is None or not boom.cylinders or foot is None:
        return None
    frame = frame_motion(results.case, boom.segments)
    time, rows = data["time"].values, []
    turns = frame.luff_angle(time) - frame.luff_angle(time[0])
    for position, cylinder in enumerate(boom.cylinders, start=1):
        luffed = [cylinder.luffed(turn, foot) for turn in turns.tolist()]
        lengths = np.array([one.length for one in luffed])
        arms = cylinder.arm(foot) / np.array([one.arm(foot) for one in luffed])
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


def stick_slip_table(results: Results) -> Table:
    """Return the table of stick-slip results of elastic drives."""
    rows = [
        (model, inner, model_summary.stick_slip[name])
        for suffix, inner in results.case.driven_segments.items()
        for model, model_summary in results.summary.models.items()
        if (name := f"drive_force{suffix}") in model_summary.stick_slip
    ]
    motions = [one for *_, one in rows]
    columns = (
        Column("model", [model for model, *_ in rows]),
        Column("drive of", [inner for _, inner, _ in rows]),
        Column("force:\nmean", [one.mean for one in motions], ".3g", "kN"),
        Column("at most", [one.peak for one in motions], ".3g", "kN"),
        Column("sticks", [one.sticks for one in motions], unit="times"),
        Column("slips by at most", [one.slip for one in motions], ".3g", "mm"),
        Column("lag at the end", [one.behind for one in motions], ".3g", "mm"),
        Column("at most", [one.speed for one in motions], ".3g", "m/s"),
        Column("at most", [one.acceleration for one in motions], ".3g", "m/s²"),
    )
    notes = (
        "Force: against friction, weight and inertia. Sticks: number of stops during telescoping. "
        "Slips: largest advance in one slip. Speed and acceleration of the segment. "
        "The boom moves as with a rigid drive. Friction follows the mean contact force of each "
        "output step; "
        "where pads chatter faster, use a smaller output_step.",
    )
    return Table("Elastic drives: stick-slip", columns, notes, "stick-slip")


def record_tables(results: Results) -> Iterator[Table]:
    """Yield a table for each kind of record, with a row for each model."""
    design = results.summary.design.models
    for name, kind in records(ModelDesignResults).items():
        found = {model: one for model in design if (one := getattr(design[model], name))}
        if found:
            columns = Column("model", [*found]), *metric_columns(kind, [*found.values()])
            yield Table(kind.title, columns, kind.notes, name)


def pad_table(results: Results) -> Table:
    """Return the table of pad forces and pressures, without rows if no pad has a known size."""
    pads = results.summary.pads
    columns = (
        Column("model", [pad.model for pad in pads]),
        Column("joint", [f"{pad.inner} in {pad.outer}" for pad in pads]),
        Column("at", [f"{pad.x:g}" for pad in pads], unit="m"),
        Column("side", [pad.side for pad in pads]),
        Column("maximum force", [pad.force for pad in pads], ".3g", "kN"),
        Column("pressure", [pad.pressure for pad in pads], ".3g", "MPa"),
        Column("utilisation", [pad.utilisation for pad in pads], ".0f", "%"),
    )
    note = (
        "Largest force of one pad during the motion. Pads on one side of a station share its force "
        "in proportion to their stiffness; the two pads of a pair carry equal forces. The pressure "
        "on a pad is taken as uniform."
    )
    return Table("Slide pads", columns, (note,), "pads")


def stress_table(results: Results) -> Table:
    """Return the table of bending stresses of all models, and local plate stresses of shells."""
    rows: list[Sequence[Cell]] = []
    for name, motion in results.motions.items():
        walls = {wall.segment: wall for wall in sorted(motion.walls, key=lambda wall: wall.patch)}
        for fibre in motion.fibres:
            wall = walls.get(fibre.segment)
            plate = (wall.patch, wall.utilisation) if wall else (None, None)
            at_fibre = abs(fibre.stress), fibre.x, fibre.time, fibre.utilisation
            rows.append((name, fibre.segment, *at_fibre, *plate))
    columns = (
        "model",
        "segment",
        ("bending stress", ".4g", "MPa"),
        ("at x", ".4g", "m"),
        ("at", ".3f", "s"),
        ("utilisation", ".3g", "%"),
        ("local plate stress", ".4g", "MPa"),
        ("its utilisation", ".3g", "%"),
    )
    notes = (
        "Bending stress: axial stress in an outer fibre, from section forces. Utilisations are "
        "fractions of the yield strength.",
    )
    return Table.of_rows(
        "stress", "Bending stress and local plate stress", columns, rows, notes, sparse=True
    )


def buckling_table(results: Results) -> Table:
    """Return the table of buckling factors of walls, without rows if they are not requested."""
    rows: list[Sequence[Cell]] = []
    for name, model_results in results.summary.design.models.items():
        shells = {
            one.segment: (one.factors[0], one.walls[0], one.x[0], one.mesh_errors[0])
            for one in model_results.buckling
            if one.factors
        }
        panels = {one.segment: (one.factor, one.wall, one.x) for one in model_results.panels}
        rows += [
            (name, segment, *shells.get(segment, (None,) * 4), *panels.get(segment, (None,) * 3))
            for segment in dict.fromkeys([*shells, *panels])
        ]
    columns = (
        "model",
        "segment",
        ("factor, shell", ".3g"),
        "wall",
        ("at x", ".4g", "m"),
        ("mesh error", ".2g", "%"),
        ("factor, panel\nformulas", ".3g"),
        "panel",
        ("panel at x", ".4g", "m"),
    )
    notes = (
        "Factor of all loads at which a wall buckles, in the static state with the largest tip "
        "deflection; "
        "walls are elastic and flat. Shell: pads included; extrapolated from two meshes, of which "
        "the finer one has the mesh error. Panel formulas: long, simply supported walls without "
        "pads.",
    )
    return Table.of_rows("buckling", "Buckling of walls", columns, rows, notes, sparse=True)


def life_table(results: Results) -> Table:
    """Return the table of rainflow stress ranges of segments, for the main models."""
    models = results.summary.design.models
    rows = [
        (name, life)
        for name, model_results in models.items()
        if name in results.main_models
        for life in model_results.life
    ]
    lives = [life for _, life in rows]
    columns = [
        Column("model", [name for name, _ in rows]),
        Column("segment", [life.segment for life in lives]),
        Column("at x", [life.x for life in lives], ".4g", "m"),
        Column("cycles", [life.cycles for life in lives], ".3g"),
        Column("largest range", [life.largest for life in lives], ".4g", "MPa"),
        Column("damage-equivalent\nrange", [life.equivalent for life in lives], ".4g", "MPa"),
    ]
    damages = [life.damage for life in lives]
    if any(damage is not None for damage in damages):
        runs = [1.0 / damage if damage else None for damage in damages]
        columns.append(Column("damage of a run", damages, ".3g"))
        columns.append(Column("runs to failure", runs, ".3g"))
    if any(life.life_damage is not None for life in lives):
        columns.append(Column("damage of the life", [one.life_damage for one in lives], ".3g"))
    notes = [
        "Rainflow ranges of the bending stress where it varies most, of a run that is repeated: "
        "its end leads to its start. Damage-equivalent "
        "range: one cycle of this range does the damage of all cycles of a run, on an S-N curve of "
        "slope 3; it may exceed the largest range."
    ]
    if len(columns) > 6:
        notes.append("Runs to failure: number of runs until the damage is 1; empty without damage.")
    return Table("Fatigue", columns, notes, "life")
