# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of design results: static states, modes, motion, pads, stresses, fatigue."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from protractile.analysis.quantities import records
from protractile.analysis.rows import BEAM, FARTHEST, INITIAL, MOTION, REST, Row, Rows
from protractile.geometry.typography import ROUND_OFF, without_round_off
from protractile.runs.pipeline.design_results import ModelDesignResults
from protractile.runs.pipeline.pad_walls import rigid_wall_note
from protractile.runs.pipeline.results import Results
from protractile.runs.report.drive_tables import drive_table, luffing_table, stick_slip_table
from protractile.runs.report.labels import amount_of, extension_note, label, place, times
from protractile.runs.report.model_tables import metric_columns
from protractile.runs.report.proof_tables import proof_table
from protractile.runs.report.static_tables import combination_tables
from protractile.runs.report.tables import Cell, Column, Table

# Relative difference below which an effect is negligible.
NEGLIGIBLE = 0.005
# Fraction of the value with play below which a value without play is near zero.
_LEAST = 0.01


def result_tables(results: Results) -> list[Table]:
    """Return the tables of design results in the order of the report, without the summary."""
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
        *combination_tables(results.rows, results.case),
        proof_table(results.proofs, results.case),
    ]
    return [table for table in tables if table is not None and table.rows]


class PlayPair(NamedTuple):
    """A result with play, and the same result without play."""

    with_play: Row
    without: Row

    @property
    def increase(self) -> float:
        """The increase of the magnitude by play, in SI units."""
        return abs(self.with_play.value) - abs(self.without.value)

    @property
    def share(self) -> float | None:
        """The increase as a fraction of the value without play; None if this value is near zero."""
        bonded = abs(self.without.value)
        return self.increase / bonded if bonded > _LEAST * abs(self.with_play.value) else None

    @property
    def is_negligible(self) -> bool:
        """True if the effect of play is negligible."""
        return self.share is not None and abs(self.share) < NEGLIGIBLE


def play_pairs(results: Results) -> list[PlayPair]:
    """Return the results of the reference model, at rest and in motion, with and without play."""
    rows = results.rows.where(model=results.reference)
    without = {(row.state, row.key): row for row in rows.where(play=False)}
    loose = rows.where(play=True)
    chosen = [
        *loose.where(state=REST, quantity="tip"),
        *loose.where(state=INITIAL, quantity="frequency")[:1],
        *peaks(loose),
        *loose.where(state=MOTION, quantity=["stress", "damage"]),
    ]
    both = [(row, without.get((row.state, row.key))) for row in chosen]
    return [PlayPair(row, other) for row, other in both if other is not None]


# Quantities with tables of their own.
_ELSEWHERE = {
    "pad_force", "pad_pressure", "stress", "wall_stress", "triangle_stress", "cycles",
    "stress_range", "equivalent_range", "run_damage", "damage",
}  # fmt: skip


def peaks(rows: Rows) -> Rows:
    """Return the quantities in motion that have no table of their own.

    Without axial force, the reaction of a foot is the transverse one.
    """
    moved = rows.where(state=MOTION)
    axial = {(row.model, row.part) for row in moved.where(quantity="axial_reaction")}
    return Rows(
        row
        for row in moved
        if row.quantity not in _ELSEWHERE
        if row.quantity != "foot_reaction" or (row.model, row.part) in axial
    )


def play_table(results: Results) -> Table | None:
    """Return the table of results with play and with bonded joints."""
    pairs = play_pairs(results)
    if not pairs:
        return None
    changes = [
        "negligible" if pair.is_negligible else amount_of(pair.with_play.of, pair.increase)
        for pair in pairs
    ]
    columns = (
        Column("", [label(pair.with_play) for pair in pairs]),
        Column("with play", [_magnitude(pair.with_play) for pair in pairs]),
        Column("without play", [_magnitude(pair.without) for pair in pairs]),
        Column("play adds", changes),
        Column("", [None if pair.is_negligible else pair.share for pair in pairs], ".3g", "%"),
    )
    notes = (
        "Magnitudes, and the difference of the magnitudes. Forces, moments, reactions and stresses "
        "are maxima of the motion.",
    )
    return Table(f"Effect of play: {results.reference}", columns, notes, "play")


def _magnitude(row: Row) -> str:
    return amount_of(row.of, abs(row.value))


def _side_by_side(
    heading: str, cells: Mapping[tuple[str, str], Cell], models: Iterable[str], *more: str
) -> list[Column]:
    """Return a column of labels and one per model, from cells by label and model.

    ``more`` are number format and unit.
    """
    labels = dict.fromkeys(label for label, _ in cells)
    of_models = {name: [cells.get((label, name)) for label in labels] for name in models}
    return [Column(heading, [*labels]), *(Column(*column, *more) for column in of_models.items())]


def _models(rows: Rows) -> dict[str, None]:
    return dict.fromkeys(row.model for row in rows)


def rest_tables(results: Results) -> list[Table]:
    """Return the tables of static joint rotations, contact forces and support reactions."""
    farthest = results.rows.where(state=FARTHEST, play=True)
    as_extended = extension_note(results.case, [row.time for row in farthest])
    contacts = farthest.where(quantity="contact_force")
    forces = {(place(row), row.model): row.value for row in contacts}
    columns = _side_by_side("station", forces, _models(contacts), ".4g", "kN")
    note = "Forces on the outer segment, positive upwards, lateral ones towards larger y."
    title = "Static state with the largest tip deflection: contact forces"
    pressed = Table(title, columns, (note + as_extended,), "pressed")
    return [_tilt_table(farthest, as_extended), pressed, _reaction_table(results)]


def _tilt_table(farthest: Rows, as_extended: str) -> Table:
    rotations, tips = (farthest.where(quantity=name) for name in ("rotation", "rotation_tip"))
    columns = (
        Column("model", [row.model for row in rotations]),
        Column("joint", [place(row) for row in rotations]),
        Column("rotation", [row.value for row in rotations], ".3g", "mrad"),
        Column("resulting tip deflection", [row.value for row in tips], ".1f", "mm"),
    )
    note = "The rotation is due to play and contact compliance, in a shell also to wall compliance."
    title = "Static state with the largest tip deflection: rotation of joints by play and walls"
    return Table(title, columns, (note + as_extended,), "tilts")


def _reaction_table(results: Results) -> Table:
    rows = results.rows.where(model=BEAM, state=INITIAL)
    across, along, held, without = (
        {
            (row.part, row.place): row.value
            for row in rows.where(quantity=name, play=play)
            if not row.place.startswith("contact")
        }
        for name, play in (
            ("reaction", True), ("axial_reaction", True), ("support_moment", True),
            ("reaction", False),
        )
    )  # fmt: skip
    least = ROUND_OFF * max(map(abs, across.values()), default=0.0) * results.boom.length
    moments = without_round_off([held.get(at, 0.0) for at in across], least)
    places = [
        f"{'lug' if at.startswith('lug') else 'support'}, {part} {at.removeprefix('lug ')}"
        for part, at in across
    ]
    columns = (
        Column("support or cylinder lug", places),
        Column("transverse force", [*across.values()], ".4g", "kN"),
        *_force_column("axial force", [along.get(at, 0.0) for at in across], ".4g", "kN"),
        *_force_column("moment", moments, ".3g", "kN m"),
        Column("transverse force,\nwithout play", [*map(without.get, across)], ".4g", "kN"),
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
    rows = results.rows.where(state=INITIAL, play=True, quantity="frequency")
    lowest_first = sorted(rows, key=lambda row: row.value)
    frequencies = {(place(row), row.model): row.value for row in lowest_first}
    columns = _side_by_side("mode", frequencies, _models(rows), ".4g", "Hz")
    notes = (
        "The modes keep the contacts of the static state at t = 0: closed ones stay closed, open "
        "ones stay open.",
        *filter(None, [rigid_wall_note(results.completed_models, results.boom)]),
    )
    return Table("Modes in the static state at t = 0", columns, notes, "modes")


def peak_table(results: Results) -> Table:
    """Return the table of maxima in motion, with ratios to static values, for the main models."""
    largest = peaks(results.rows.where(model=results.main_models, play=True))
    texts = {
        (label(row), row.model): f"{_magnitude(row)}{times(results.rows, row)}" for row in largest
    }
    main = (name for name in results.main_models if name in _models(largest))
    columns = _side_by_side("maximum", texts, main)
    notes = ("Absolute values. In brackets: ratio to the static value under the maximum load.",)
    return Table("Forces and deflections in motion", columns, notes, "peaks")


def record_tables(results: Results) -> Iterator[Table]:
    """Yield a table for each kind of record, with a row for each model."""
    design = results.summary.design.models
    for name, kind in records(ModelDesignResults).items():
        found = {model: rows for model in design if (rows := getattr(design[model], name))}
        if found:
            columns = Column("model", [*found]), *metric_columns(kind, [*found.values()])
            yield Table(kind.title, columns, kind.notes, name)


def pad_table(results: Results) -> Table:
    """Return the table of pad forces and pressures, without rows if no pad has a known size."""
    moved, boom = results.rows.where(state=MOTION, play=True), results.boom
    pads, forces = (moved.where(quantity=name) for name in ("pad_pressure", "pad_force"))
    outers = {
        boom.segments[joint.inner].name: boom.segments[joint.outer].name for joint in boom.joints
    }
    columns = (
        Column("model", [pad.model for pad in pads]),
        Column("joint", [f"{pad.part} in {outers[pad.part]}" for pad in pads]),
        Column("at", [f"{pad.x:g}" for pad in pads], unit="m"),
        Column("side", [pad.place.rpartition(", ")[2] for pad in pads]),
        Column("maximum force", [force.value for force in forces], ".3g", "kN"),
        Column("pressure", [pad.value for pad in pads], ".3g", "MPa"),
        Column("utilisation", [pad.utilisation for pad in pads], ".0f", "%"),
    )
    note = (
        "Largest force of one pad of a pair during the motion, in space of the one that carries "
        "more. The pressure on a pad is taken as uniform."
    )
    return Table("Slide pads", columns, (note,), "pads")


def stress_table(results: Results) -> Table:
    """Return the table of bending stresses of all models, and local plate stresses of shells."""
    moved = results.rows.where(model=results.main_models, state=MOTION, play=True)
    plates = {(row.model, row.part): row for row in moved.where(quantity="wall_stress")}
    rows: list[Sequence[Cell]] = []
    for fibre in moved.where(quantity="stress"):
        plate = plates.get((fibre.model, fibre.part))
        of_plate = (plate.value, plate.utilisation) if plate else (None, None)
        at_fibre = abs(fibre.value), fibre.x, fibre.time, fibre.utilisation
        rows.append((fibre.model, fibre.part, *at_fibre, *of_plate))
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


def weakest_panels(rows: Rows) -> dict[tuple[str, str], Row]:
    """Return the plate that buckles first by panel formulas, by model and segment."""
    found = rows.where(state=FARTHEST, play=True, quantity="plate_buckling")
    largest_first = sorted(found, key=lambda row: -row.value)
    return {(row.model, row.part): row for row in largest_first}


def buckling_table(results: Results) -> Table:
    """Return the table of buckling factors of walls, without rows if they are not requested."""
    panels = {at: (row.value, row.place, row.x) for at, row in weakest_panels(results.rows).items()}
    shells = {
        (name, buckling.segment): (
            buckling.factors[0],
            buckling.walls[0],
            buckling.x[0],
            buckling.mesh_errors[0],
        )
        for name, design in results.summary.design.models.items()
        for buckling in design.buckling
        if buckling.factors
    }
    rows = [
        (name, segment.name, *shells.get(at, (None,) * 4), *panels.get(at, (None,) * 3))
        for name in results.summary.design.models
        for segment in results.boom.segments
        if (at := (name, segment.name)) in shells or at in panels
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
    moved = results.rows.where(model=results.main_models, state=MOTION, play=True)
    lives = moved.where(quantity="cycles")
    values = {(row.quantity, row.model, row.part): row.value for row in moved}

    def cells(quantity: str) -> list[float | None]:
        return [values.get((quantity, row.model, row.part)) for row in lives]

    columns = [
        Column("model", [row.model for row in lives]),
        Column("segment", [row.part for row in lives]),
        Column("at x", [row.x for row in lives], ".4g", "m"),
        Column("cycles", cells("cycles"), ".3g"),
        Column("largest range", cells("stress_range"), ".4g", "MPa"),
        Column("damage-equivalent\nrange", cells("equivalent_range"), ".4g", "MPa"),
    ]
    damages = cells("run_damage")
    if any(damage is not None for damage in damages):
        columns += [
            Column("damage of a run", damages, ".3g"),
            Column(
                "runs to failure", [1.0 / damage if damage else None for damage in damages], ".3g"
            ),
            Column("damage of the life", cells("damage"), ".3g"),
        ]
    notes = [
        "Rainflow ranges of the bending stress where it varies most, of a run that is repeated: "
        "its end leads to its start. Damage-equivalent "
        "range: one cycle of this range does the damage of all cycles of a run, on an S-N curve of "
        "slope 3; it may exceed the largest range."
    ]
    if len(columns) > 6:
        notes.append("Runs to failure: number of runs until the damage is 1; empty without damage.")
    return Table("Fatigue", columns, notes, "life")
