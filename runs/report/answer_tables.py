# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a designer asks of a boom, as tables: each answer by itself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from geometry.typography import TO_KILO, TO_MILLI, TO_PERCENT
from runs.pipeline.answers import Added, AtRest, Peak
from runs.pipeline.results import Results
from runs.report.drawn_axis import of_rests
from runs.report.drive_tables import drive_table, stick_slip_table, swing_table
from runs.report.numerals import NONE, amount, number
from runs.report.strength_tables import life_table, pad_table, stress_table
from runs.report.tables import Column, Table

# A part of a number that is next to nothing.
HARDLY = 0.005
# A part of what the others have that is none.
ROUND_OFF = 1.0e-9


def play_table(results: Results) -> Table | None:
    """Every number beside that of the same boom tied."""
    found = results.play
    if found is None:
        return None
    rows = found.numbers
    columns = (
        Column("", [_named(one.what, one.where) for one in rows]),
        Column("with play", [amount(one.played, one.unit) for one in rows]),
        Column("without play", [amount(one.tied, one.unit) for one in rows]),
        Column(
            "play adds",
            ["next to nothing" if hardly(one) else amount(one.added, one.unit) for one in rows],
        ),
        Column("%", [None if hardly(one) else one.share for one in rows], ".3g", TO_PERCENT),
    )
    notes = ("By their absolute values.",)
    return Table(f"What play adds: {found.model}", columns, notes, "play")


def rest_tables(results: Results) -> list[Table]:
    """Tilts by play, what presses and what holds, at rest under the largest loads."""
    answers = results.summary.answers
    farthest = {name: own.farthest_rest for name, own in answers.models.items()}
    rests = {name: rest for name, rest in farthest.items() if rest is not None}
    as_drawn = of_rests(results.case, rests.values())
    tables = []
    tilts = [(name, tilt) for name, rest in rests.items() for tilt in rest.tilts]
    if tilts:
        columns = (
            Column("model", [name for name, _ in tilts]),
            Column("joint", [f"{tilt.inner} in {tilt.outer}" for _, tilt in tilts]),
            Column("rotation\nmrad", [tilt.rotation for _, tilt in tilts], ".3g", TO_MILLI),
            Column("moves the tip\nmm", [tilt.tip for _, tilt in tilts], ".1f", TO_MILLI),
        )
        tables.append(
            Table(
                "At rest under the largest loads: what joints give way",
                columns,
                (
                    "By play and by what is pressed in: of a shell, also by its walls beside them."
                    + as_drawn,
                ),
                "tilts",
            )
        )
    places = {pressed.place: pressed for rest in rests.values() for pressed in rest.stations}
    if places:
        tables.append(_pressed_table(rests, list(places), as_drawn))
    if answers.reactions:
        tied = {(one.segment, one.x): one for one in answers.tied_reactions}
        beside = [tied.get((one.segment, one.x)) for one in answers.reactions]
        held = (
            Column("holds", [f"{one.segment} at {one.x:g} m" for one in answers.reactions]),
            Column("force\nkN", [one.force for one in answers.reactions], ".4g", TO_KILO),
            *_unless_none("along the boom\nkN", [one.along for one in answers.reactions], ".4g"),
            *_unless_none("moment\nkN m", [one.moment for one in answers.reactions], ".3g"),
            Column(
                "tied: force\nkN", [one.force if one else None for one in beside], ".4g", TO_KILO
            ),
        )
        notes = (
            "Of beam elements, under the loads of t = 0; positive upwards, along the boom towards "
            "its tip.",
        )
        tables.append(Table("At rest at t = 0: what holds the boom", held, notes, "reactions"))
    return tables


def _unless_none(heading: str, borne: Sequence[float], form: str) -> Iterator[Column]:
    """What is borne, in kilo, without the round-off of what bears none; no column of zeros."""
    most = max(map(abs, borne), default=0.0)
    if most > 0.0:
        told = [each if abs(each) > ROUND_OFF * most else 0.0 for each in borne]
        yield Column(heading, told, form, TO_KILO)


def _pressed_table(rests: dict[str, AtRest], places: Sequence[str], as_drawn: str) -> Table:
    columns = [Column("station", [f"x = {place} m" for place in places])]
    for name, rest in rests.items():
        forces = {one.place: one for one in rest.stations}
        if forces:
            cells = [forces[place].force if place in forces else None for place in places]
            columns.append(Column(f"{name}\nkN", cells, ".4g", TO_KILO))
    what = "Forces of stations, positive where the inner segment presses up, or to larger y."
    return Table(
        "At rest under the largest loads: what presses", columns, (what + as_drawn,), "pressed"
    )


def mode_table(results: Results) -> Table | None:
    """The first modes of the boom as it works, its joints pressed, of all models side by side."""
    answers = results.summary.answers.models
    with_modes = {name: own.modes for name, own in answers.items() if own.modes}
    if not with_modes:
        return None
    ways = dict.fromkeys((mode.way, mode.number) for modes in with_modes.values() for mode in modes)
    of = {
        name: {(mode.way, mode.number): mode.frequency for mode in modes}
        for name, modes in with_modes.items()
    }
    rows = sorted(ways, key=lambda way: min(found.get(way, float("inf")) for found in of.values()))
    columns = [Column("mode", [f"{way} {count}" for way, count in rows])]
    columns += [
        Column(f"{name}\nHz", [found.get(way) for way in rows], ".4g") for name, found in of.items()
    ]
    notes = ("Of the boom at rest under the loads of t = 0, its joints pressed as they are then.",)
    return Table("Modes at rest at t = 0", columns, notes, "modes")


def peak_table(results: Results) -> Table | None:
    """Largest of the motion beside what is at rest, of the models that are read first."""
    moved = results.moved
    wheres = dict.fromkeys(
        (peak.what, peak.where, peak.unit) for own in moved.values() for peak in own.peaks
    )
    if not wheres:
        return None
    columns = [Column("at most", [_named(what, where) for what, where, _ in wheres])]
    for name, own in moved.items():
        found = {(peak.what, peak.where, peak.unit): peak for peak in own.peaks}
        cells = [_peak_cell(found.get(where)) for where in wheres]
        columns.append(Column(name, cells))
    notes = (
        "By their absolute values. In brackets: how many times what is at rest under the largest "
        "loads.",
    )
    return Table("Forces and deflections in motion", columns, notes, "peaks")


def answer_tables(results: Results) -> list[Table]:
    """All but the first look, in the order of the questions."""
    found = [
        play_table(results),
        *rest_tables(results),
        mode_table(results),
        peak_table(results),
        drive_table(results),
        stick_slip_table(results),
        swing_table(results),
        pad_table(results),
        stress_table(results),
        life_table(results),
    ]
    return [table for table in found if table is not None]


def hardly(one: Added) -> bool:
    """Whether play adds next to nothing."""
    return one.share is not None and abs(one.share) < HARDLY


def _peak_cell(peak: Peak | None) -> str:
    if peak is None:
        return NONE
    factor = "" if peak.factor is None else f" (× {number(peak.factor)})"
    return f"{amount(peak.largest, peak.unit)}{factor}"


def _named(what: str, where: str) -> str:
    if what == "contact force":
        return f"{what}, x = {where} m"
    if what == "deflection at rest":
        return "tip at rest, largest loads"
    if what == "cylinder force":
        return where.replace("_", " ").replace("-", " ")
    return f"{what}, {where}" if where else what
