# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a designer asks of a boom, as tables: first a look at all, then each answer by itself."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import log, pi

from geometry.typography import signed
from runs.case.schema import Case
from runs.pipeline.answers import Added, Answers, AtRest, ModelAnswers, Moved, Peak, PlayAdds
from runs.pipeline.comparisons import reference_of
from runs.pipeline.results import Results
from runs.report.drive_tables import drive_table
from runs.report.figure_context import leading
from runs.report.tables import Column, Table
from runs.report.theme import NONE, fixed, number

MILLI, PER_KILO, PER_MEGA, PERCENT = 1.0e3, 1.0e-3, 1.0e-6, 100.0

# To which part a swing has died that nobody heeds any more.
TENTH = 0.1
# A part of a number that is next to nothing.
HARDLY = 0.005


def first_table(results: Results) -> Table | None:
    """The six answers of the models that are read first; None where a run has none."""
    answers = results.summary.answers
    if answers is None:
        return None
    first = leading(results.case, list(results.summary.models))
    names = [name for name in answers.models if name in first]
    questions: dict[str, Callable[[ModelAnswers], str]] = {
        "Tip at rest at t = 0, mm": lambda own: _at_rest(own.rests[:1]),
        "Tip at rest under all loads, mm": lambda own: _at_rest(own.rests[1:]),
        "Tip in motion, at most, mm": lambda own: _largest_of(own, "deflection"),
        "Tip to the sides, at most, mm": lambda own: _largest_of(own, "lateral deflection"),
        "First frequency, Hz": lambda own: number(own.modes[0].frequency) if own.modes else NONE,
        "A swing takes, s": _period,
        "It dies to a tenth in, s": lambda own: _dying(results.case, own),
        "Pressed most, kN": lambda own: _largest_of(own, "contact force"),
        "Cylinder, at most, kN": lambda own: _largest_of(own, "cylinder force"),
        "Stress, at most, MPa": _stress,
        "Of the yield strength, %": _utilisation,
        "Damage of its life": _damage,
    }
    rows = {
        asked: [answer(answers.models[name]) for name in names]
        for asked, answer in questions.items()
    }
    told = {asked: cells for asked, cells in rows.items() if any(cell != NONE for cell in cells)}
    columns = [Column("", list(told))]
    columns += [Column(name, [told[asked][i] for asked in told]) for i, name in enumerate(names)]
    notes = ["×: so many times what is at rest under the largest loads."]
    shown = notes if any("×" in cell for cells in told.values() for cell in cells) else []
    return Table("The answers", columns, shown, "answers")


def play_sentence(results: Results) -> str:
    """What play adds, of the model that the others are held against; else empty."""
    found = _play(results)
    if found is None:
        return ""
    by_kind: dict[str, list[Added]] = {}
    for each in found.numbers:
        by_kind.setdefault(each.what, []).append(each)
    first = {what: max(several, key=lambda one: one.played) for what, several in by_kind.items()}
    told = [(_SAID[what], one) for what, one in first.items() if what in _SAID]
    more = [f"{_more(one)} to {what}" for what, one in told if not _hardly(one)]
    same = [what for what, one in told if _hardly(one)]
    said = [f"Play adds {_listed(more)}."] if more else []
    said += [f"It hardly changes {_listed(same)}."] if same else []
    frequency = first.get("first frequency")
    if frequency is not None and frequency.tied and not _hardly(frequency):
        both = f"{number(frequency.played)} Hz in place of {number(frequency.tied)} Hz"
        said.append(f"The first frequency is {both}.")
    return " ".join(said)


_SAID = {
    "deflection at rest": "the tip at rest",
    "deflection": "its farthest in motion",
    "stress": "the largest stress",
}


def play_note(results: Results) -> str:
    """Whose numbers the sentences have."""
    found = _play(results)
    if found is None:
        return ""
    return f"Of the model {found.model}, beside the same without play."


def play_table(results: Results) -> Table | None:
    """Every number beside that of the same boom tied."""
    found = _play(results)
    if found is None:
        return None
    rows = found.numbers
    columns = (
        Column("", [_named(one.what, one.where) for one in rows]),
        Column("with play", [_amount(one.played, one.unit) for one in rows]),
        Column("tied", [_amount(one.tied, one.unit) for one in rows]),
        Column(
            "play adds",
            ["next to nothing" if _hardly(one) else _amount(one.added, one.unit) for one in rows],
        ),
        Column("%", [None if _hardly(one) else one.share for one in rows], ".3g", PERCENT),
    )
    return Table(f"What play adds: {found.model}", columns, (), "play")


def rest_tables(results: Results) -> list[Table]:
    """Tilts by play, what presses and what holds, at rest under the largest loads."""
    answers = results.summary.answers
    if answers is None:
        return []
    rests = {name: _largest(own) for name, own in answers.models.items() if own.rests}
    tables = []
    tilts = [(name, tilt) for name, rest in rests.items() for tilt in rest.tilts]
    if tilts:
        columns = (
            Column("model", [name for name, _ in tilts]),
            Column("joint", [f"{tilt.inner} in {tilt.outer}" for _, tilt in tilts]),
            Column("rotation by play\nmrad", [tilt.rotation for _, tilt in tilts], ".3g", MILLI),
            Column("moves the tip\nmm", [tilt.tip for _, tilt in tilts], ".1f", MILLI),
        )
        tables.append(Table("At rest: what joints give way", columns, (), "tilts"))
    places = {pressed.place: pressed for rest in rests.values() for pressed in rest.stations}
    if places:
        tables.append(_pressed_table(rests, list(places)))
    if answers.reactions:
        tied = {(one.segment, one.x): one for one in answers.tied_reactions}
        beside = [tied.get((one.segment, one.x)) for one in answers.reactions]
        columns = (
            Column("holds", [f"{one.segment} at {one.x:g} m" for one in answers.reactions]),
            Column("force\nkN", [one.force for one in answers.reactions], ".4g", PER_KILO),
            Column("moment\nkN m", [one.moment for one in answers.reactions], ".3g", PER_KILO),
            Column(
                "tied: force\nkN", [one.force if one else None for one in beside], ".4g", PER_KILO
            ),
        )
        notes = ("Of beam elements, under the loads of t = 0; positive upwards.",)
        tables.append(Table("At rest: what holds the boom", columns, notes, "reactions"))
    return tables


def _pressed_table(rests: dict[str, AtRest], places: Sequence[str]) -> Table:
    columns = [Column("station", [f"x = {place} m" for place in places])]
    for name, rest in rests.items():
        forces = {one.place: one for one in rest.stations}
        if forces:
            cells = [forces[place].force if place in forces else None for place in places]
            columns.append(Column(f"{name}\nkN", cells, ".4g", PER_KILO))
    notes = (
        "Forces of stations under the largest loads, positive where the inner segment presses up, "
        "or to larger y.",
    )
    return Table("At rest: what presses", columns, notes, "pressed")


def mode_table(results: Results) -> Table | None:
    """The first modes of the boom as it works, its joints pressed, of all models side by side."""
    answers = results.summary.answers
    with_modes = (
        {name: own.modes for name, own in answers.models.items() if own.modes} if answers else {}
    )
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
    return Table("Modes", columns, notes, "modes")


def peak_table(results: Results) -> Table | None:
    """Largest of the motion beside what is at rest, of the models that are read first."""
    moved = _moved(results)
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
    notes = ("In brackets: how many times what is at rest under the largest loads.",)
    return Table("Forces and deflections in motion", columns, notes, "peaks")


def stress_table(results: Results) -> Table | None:
    """Largest stresses of each segment: outer fibres of all models, walls of shells."""
    rows = []
    for name, own in _moved(results).items():
        walls = {wall.segment: wall for wall in sorted(own.walls, key=lambda wall: wall.patch)}
        for fibre in own.fibres:
            wall = walls.get(fibre.segment)
            rows.append((name, fibre, wall))
    if not rows:
        return None
    used = [
        max((part for part in (f.utilisation, w.utilisation if w else None) if part), default=None)
        for _, f, w in rows
    ]
    columns = [
        Column("model", [name for name, _, _ in rows]),
        Column("segment", [fibre.segment for _, fibre, _ in rows]),
        Column("outer fibre\nMPa", [abs(f.stress) for _, f, _ in rows], ".4g", PER_MEGA),
        Column("at x\nm", [fibre.x for _, fibre, _ in rows], ".4g"),
        Column("at\ns", [fibre.time for _, fibre, _ in rows], ".3f"),
    ]
    if any(wall for _, _, wall in rows):
        columns.append(
            Column(
                "wall, over a patch\nMPa",
                [w.patch if w else None for _, _, w in rows],
                ".4g",
                PER_MEGA,
            )
        )
    if any(used):
        columns.append(Column("of the yield strength\n%", used, ".3g", PERCENT))
    notes = (
        "Outer fibre: along x, of section forces. Wall: von Mises, the mean over a patch of half a "
        "wall near stations and supports, where plates bend besides.",
    )
    return Table("Stress", columns, notes, "stress")


def life_table(results: Results) -> Table | None:
    """Rainflow ranges of each segment, of the models that are read first."""
    answers = results.summary.answers
    first = leading(results.case, list(results.summary.models))
    rows = [
        (name, life)
        for name, own in (answers.models.items() if answers else ())
        if name in first
        for life in own.life
    ]
    if not rows:
        return None
    columns = [
        Column("model", [name for name, _ in rows]),
        Column("segment", [life.segment for _, life in rows]),
        Column("at x\nm", [life.x for _, life in rows], ".4g"),
        Column("cycles", [life.cycles for _, life in rows], ".3g"),
        Column("largest range\nMPa", [life.largest for _, life in rows], ".4g", PER_MEGA),
        Column("equivalent range\nMPa", [life.equivalent for _, life in rows], ".4g", PER_MEGA),
    ]
    if any(life.damage is not None for _, life in rows):
        columns.append(Column("damage of a run", [life.damage for _, life in rows], ".3g"))
    if any(life.life_damage is not None for _, life in rows):
        columns.append(Column("of its life", [life.life_damage for _, life in rows], ".3g"))
    notes = (
        "Rainflow ranges of the outer fibre's stress where it varies most. Equivalent: what, once "
        "in a run, does as much as all of them at a slope of 3.",
    )
    return Table("Life", columns, notes, "life")


def answer_tables(results: Results) -> list[Table]:
    """All but the first look, in the order of the questions."""
    found = [
        play_table(results),
        *rest_tables(results),
        mode_table(results),
        peak_table(results),
        drive_table(results),
        stress_table(results),
        life_table(results),
    ]
    return [table for table in found if table is not None]


def trust_lines(results: Results) -> list[str]:
    """How far the numbers can be trusted."""
    answers = results.summary.answers
    return [] if answers is None else [known.line for known in answers.trust]


def _play(results: Results) -> PlayAdds | None:
    """Of the model that the others are held against."""
    answers, reference = results.summary.answers, reference_of(results.ran)
    known = answers.play if answers else []
    return next((one for one in known if one.model == reference and one.numbers), None)


def _hardly(one: Added) -> bool:
    """Whether play adds next to nothing."""
    return one.share is not None and abs(one.share) < HARDLY


def _moved(results: Results) -> dict[str, Moved]:
    """Of the models that are read first."""
    answers: Answers | None = results.summary.answers
    first = leading(results.case, list(results.summary.models))
    own = answers.models if answers else {}
    return {name: one.moved for name, one in own.items() if name in first and one.moved}


def _largest(own: ModelAnswers) -> AtRest:
    """Under the loads that move the tip farthest."""
    return max(own.rests, key=lambda rest: abs(rest.tip))


def _at_rest(rests: Sequence[AtRest]) -> str:
    farthest = max(rests, key=lambda rest: abs(rest.tip), default=None)
    return NONE if farthest is None else fixed(farthest.tip, 1, MILLI)


def _largest_of(own: ModelAnswers, what: str) -> str:
    """Of some peaks; of stations with their place."""
    peaks = [peak for peak in own.moved.peaks if peak.what == what] if own.moved else []
    if not peaks:
        return NONE
    peak = max(peaks, key=lambda one: one.largest)
    _, factor = _SHOWN[peak.unit]
    times = "" if peak.factor is None else f" (× {number(peak.factor)})"
    where = f"\nat {peak.where} m" if what == "contact force" else ""
    return f"{number(factor * peak.largest, 4)}{times}{where}"


def _period(own: ModelAnswers) -> str:
    return number(1.0 / own.modes[0].frequency) if own.modes else NONE


def _dying(case: Case, own: ModelAnswers) -> str:
    """By its modal damping, of an oscillation that nothing else takes energy from."""
    ratio = case.damping.modal
    if not own.modes or ratio == 0.0:
        return NONE
    return number(log(1.0 / TENTH) / (2.0 * pi * ratio * own.modes[0].frequency), 2)


def _stress(own: ModelAnswers) -> str:
    if own.moved is None:
        return NONE
    found = [(wall.patch, wall.segment, wall.x) for wall in own.moved.walls]
    found = found or [(abs(one.stress), one.segment, one.x) for one in own.moved.fibres]
    if not found:
        return NONE
    stress, segment, x = max(found)
    return f"{number(PER_MEGA * stress)}\n{segment}, {x:.1f} m"


def _utilisation(own: ModelAnswers) -> str:
    if own.moved is None:
        return NONE
    walls = [wall.utilisation for wall in own.moved.walls]
    found = [part for part in (*walls, *(f.utilisation for f in own.moved.fibres)) if part]
    return number(PERCENT * max(found)) if found else NONE


def _damage(own: ModelAnswers) -> str:
    found = [life.life_damage for life in own.life if life.life_damage is not None]
    return number(max(found)) if found else NONE


def _peak_cell(peak: Peak | None) -> str:
    if peak is None:
        return NONE
    factor = "" if peak.factor is None else f" (× {number(peak.factor)})"
    return f"{_amount(peak.largest, peak.unit)}{factor}"


_SHOWN = {"m": ("mm", MILLI), "N": ("kN", PER_KILO), "N m": ("kN m", PER_KILO)}
_SHOWN |= {"Pa": ("MPa", PER_MEGA), "Hz": ("Hz", 1.0), "1": ("", 1.0)}


def _amount(value: float, unit: str) -> str:
    name, factor = _SHOWN[unit]
    return f"{number(factor * value)} {name}".strip()


def _more(one: Added) -> str:
    share = "" if one.share is None else f" ({signed(f'{PERCENT * one.share:+.0f}')} %)"
    return f"{_amount(one.added, one.unit)}{share}"


def _named(what: str, where: str) -> str:
    if what == "contact force":
        return f"{what}, x = {where} m"
    if what == "cylinder force":
        return where.replace("_", " ").replace("-", " ")
    return f"{what}, {where}" if where else what


def _listed(parts: Iterable[str]) -> str:
    *most, last = parts
    return f"{', '.join(most)} and {last}" if most else last
