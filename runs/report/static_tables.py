# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of static results, of combinations and of their envelope."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from protractile.analysis.rows import COMBINATION, INITIAL, REST, Row, Rows
from protractile.beam_model.statics import static_theory
from protractile.geometry.boom import Boom
from protractile.geometry.typography import amount, join_words
from protractile.geometry.units import System
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import combined_cases
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.combinations import limited_tips
from protractile.runs.pipeline.statics import boom_with_play
from protractile.runs.report.load_table import release_note
from protractile.runs.report.tables import Amount, Cell, Column, Table

# Fraction of the largest result of a unit that is displayed as 0.
_NEGLIGIBLE = 1.0e-4

# Quantities of tables in their order, with their names there.
_NAMES: Mapping[str, str] = {
    "tip": "tip",
    "tip_lateral": "lateral tip",
    "stress": "stress",
    "pad_pressure": "pad",
    "contact_force": "contact force",
    "cylinder_force": "cylinder force",
    "cylinder_force_difference": "cylinder force difference",
    "larger_cylinder_force": "larger force of two cylinders",
    "foot_reaction": "foot reaction",
}
# Mark of governing values in a table.
_GOVERNS = "*"

# Mark of a tip deflection above its limit.
_EXCEEDS = "✗"

# Quantities of each column of a table, by its heading.
_COLUMNS: Mapping[str, list[str]] = {
    "tip": ["tip"],
    "lateral\ntip": ["tip_lateral"],
    "bending\nstress": ["stress"],
    "pad\npressure": ["pad_pressure"],
    "contact\nforce": ["contact_force"],
    "cylinder\nforce": ["cylinder_force", "cylinder_force_difference"],
    "foot\nreaction": ["foot_reaction"],
}


def static_table(case: Case, boom: Boom, rows: Rows) -> Table:
    """Return the table of static results at t = 0 and their extremes, in the units of the case."""
    shown = shown_rows(Rows(row for row in rows if row.quantity != "foot_reaction"))
    initial = {row.key: row for row in shown.where(state=INITIAL)}
    largest = shown.where(state=REST)
    vary = any(row.time for row in largest)
    starts = [initial[row.key].value for row in largest]
    used = [row.utilisation for row in largest]
    columns = [
        Column("", [row_name(row, case.system) for row in largest]),
        Column(
            "t = 0", [Amount.of(at, row.of.unit) for at, row in zip(starts, largest, strict=True)]
        ),
    ]
    if vary:
        columns += [
            Column("maximum", [Amount.of(row.value, row.of.unit) for row in largest]),
            Column("time of\nmaximum", [row.time for row in largest], ".4g", "s"),
        ]
    if any(used):
        columns.append(Column("utilisation", used, ".3g", "%"))
    more = [*filter(None, [release_note(case)])]
    more += ["Extensions are those at t = 0."] if boom.telescopes else []
    if any(joint.padded for joint in boom.joints):
        more.append("Local plate stresses are not included; a run with a shell has them.")
    title = "Static results at t = 0" + (" and under the maximum loads" if vary else "")
    kinds = "Stresses are bending stresses, axial in outer fibres."
    if largest.where(quantity="contact_force"):
        kinds += " Contact forces act on the outer segment, upwards where positive."
    return Table(title, columns, [beam_note(boom), kinds, *more])


def shown_rows(rows: Rows) -> Rows:
    """Return the rows of static tables in their order, with 0 for negligible values.

    Values far below the largest one of their unit are negligible. Results that are negligible in
    all states are left out, and so are contact forces at pads. Stresses are magnitudes.
    """
    padded = {
        (row.part, row.place.rpartition(", ")[0]) for row in rows.where(quantity="pad_pressure")
    }
    chosen = [
        row._replace(value=abs(row.value)) if row.quantity == "stress" else row
        for row in rows.where(quantity=[*_NAMES])
        if row.quantity != "contact_force" or (row.part, row.place) not in padded
    ]
    least: dict[str, float] = {}
    for row in chosen:
        least[row.of.unit] = max(_NEGLIGIBLE * abs(row.value), least.get(row.of.unit, 0.0))
    matter = {row.key for row in chosen if abs(row.value) > least[row.of.unit]}
    order = [*_NAMES]
    return Rows(
        row if abs(row.value) > least[row.of.unit] else row._replace(value=0.0)
        for row in sorted(chosen, key=lambda row: order.index(row.quantity))
        if row.key in matter
    )


def row_name(row: Row, system: System, placed: bool = True) -> str:
    """Return the name of a row in tables.

    The name has the position in units of ``system`` if the row is ``placed`` or at a station.
    """
    name, at_station = _NAMES[row.quantity], row.quantity in ("pad_pressure", "contact_force")
    if row.quantity not in ("tip", "tip_lateral") and row.part != "cylinder":
        name += f", {row.part}"
    if at_station or (placed and row.quantity == "stress"):
        assert row.x is not None
        name += f" at {system.text(row.x, 'm', 5)}"
    # After the station, the place has the direction of a force, or the side of a pad.
    return ", ".join([name, *row.place.split(", ")[1:][-1:]])


def beam_note(boom: Boom) -> str:
    """Return a sentence on the model of the statics."""
    theory = "Timoshenko" if static_theory(boom) == "timoshenko" else "Euler-Bernoulli"
    walls = f", with elastic {boom.yielding}," if boom.yielding else ""
    return f"A separate {theory} beam{walls} gives these estimates."


def combination_tables(rows: Rows, case: Case, shell: str = "") -> Iterator[Table]:
    """Yield the table of combinations and the table of their envelope.

    ``rows`` may include others. ``shell`` is the name of the shell; empty for results of beam
    elements.
    """
    names = [combined.name for combined in combined_cases(case)]
    shown = shown_rows(rows.where(state=[COMBINATION + name for name in names]))
    if not shown:
        return
    of_names = [shown.where(state=COMBINATION + name) for name in names]
    limit, limited = case.limits and case.limits.tip_at_rest, limited_tips(rows, case)
    exceeding = {row.state for row in limited if (row.utilisation or 0.0) > 1.0}
    columns = [Column("combination,\nload case", names)]
    for heading, quantities in _COLUMNS.items():
        values = [name.where(quantity=quantities).largest for name in of_names]
        most = max((abs(value.value) for value in values if value), default=0.0)
        if most:
            cells = [_marked(value, most, exceeding) if value else None for value in values]
            columns.append(Column(heading, cells))
    notes = [f"{_GOVERNS} is the largest of its column."]
    if limit and limited:
        which = dict.fromkeys(
            row.state.removeprefix(COMBINATION).partition(", ")[0] for row in limited
        )
        told = f"{limit} of the length" if isinstance(limit, str) else amount(limit, "m")
        notes.append(
            f"The limit of the static tip deflection, {told}, applies to "
            f"{join_words([*which])} only{f'; {_EXCEEDS} exceeds it' if exceeding else ''}."
        )
    moving = [combination.name for combination in case.combinations if combination.motion]
    if moving:
        notes.append(f"In `prove` and reports, {join_words(moving)}: extremes of the motion.")
    if build_boom(case).telescopes:
        notes.append("Extensions are those at t = 0, or those of the load case.")
    if shell:
        notes.append(f"By {shell}, with the axial forces of each combination.")
    else:
        notes.append(beam_note(boom_with_play(case, build_boom(case))))
    without = (name for name, of_name in zip(names, of_names, strict=True) if not of_name)
    notes += [f"{name}: there is no static equilibrium." for name in without]
    yield Table("Largest results of each combination", columns, notes, "combinations")
    if len(names) > 1:
        yield _envelope(shown, case.system)


def _marked(row: Row, most: float, exceeding: Collection[str]) -> Amount:
    mark = _GOVERNS if abs(row.value) == most else " " * len(_GOVERNS)
    mark += f" {_EXCEEDS}" if row.quantity == "tip" and row.state in exceeding else ""
    return Amount.of(row.value, row.of.unit, mark)


def _envelope(shown: Rows, system: System) -> Table:
    """Return the table of minimum, maximum and governing combination of each result."""
    of_key: dict[tuple[str, str, str], list[Row]] = {}
    for row in shown:
        of_key.setdefault(row.key, []).append(row)
    lines = list[Sequence[Cell]]()
    for several in of_key.values():
        least, most = (end(several, key=lambda row: row.value) for end in (min, max))
        governing = max((least, most), key=lambda row: abs(row.value))
        # The positions of stations depend on the extension.
        name = row_name(governing, system, placed=False)
        ends = (Amount.of(row.value, row.of.unit) for row in (least, most))
        lines.append((name, *ends, governing.state.removeprefix(COMBINATION)))
    moving = shown.where(quantity=["pad_pressure", "contact_force"])
    note = "Pads and contacts move with the extension; x is given for the governing combination."
    headings, notes = ("result", "minimum", "maximum", "governing"), [note] if moving else []
    return Table.of_rows("envelope", "Envelope of the combinations", headings, lines, notes)
