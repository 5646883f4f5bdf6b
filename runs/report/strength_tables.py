# SPDX-License-Identifier: LGPL-3.0-or-later
"""What pads and steel bear, as tables."""

from __future__ import annotations

from geometry.typography import TO_KILO, TO_MEGA, TO_PERCENT
from runs.pipeline.results import Results
from runs.report.tables import Column, Table


def pad_table(results: Results) -> Table | None:
    """How hard the pads of each joint are pressed at most; None without pads of a size."""
    pads = results.summary.pads
    if not pads:
        return None
    columns = (
        Column("model", [pad.model for pad in pads]),
        Column("joint", [f"{pad.inner} in {pad.outer}" for pad in pads]),
        Column("at\nm", [f"{pad.x:g}" for pad in pads]),
        Column("side", [pad.side for pad in pads]),
        Column("peak force\nkN", [pad.force for pad in pads], ".3g", TO_KILO),
        Column("pressure\nMPa", [pad.pressure for pad in pads], ".3g", TO_MEGA),
        Column("utilisation\n%", [pad.utilisation for pad in pads], ".0f", TO_PERCENT),
    )
    note = (
        "Of one pad. Those of one side of a station share its force as they are stiff, those of a "
        "pair evenly, and bear it evenly."
    )
    return Table("Slide pads", columns, (note,), "pads")


def stress_table(results: Results) -> Table | None:
    """Largest stresses of each segment: outer fibres of all models, walls of shells."""
    rows = []
    for name, own in results.moved.items():
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
        Column("outer fibre\nMPa", [abs(f.stress) for _, f, _ in rows], ".4g", TO_MEGA),
        Column("at x\nm", [fibre.x for _, fibre, _ in rows], ".4g"),
        Column("at\ns", [fibre.time for _, fibre, _ in rows], ".3f"),
    ]
    if any(wall for _, _, wall in rows):
        columns.append(
            Column(
                "wall, over a patch\nMPa",
                [w.patch if w else None for _, _, w in rows],
                ".4g",
                TO_MEGA,
            )
        )
    if any(used):
        columns.append(Column("of the yield strength\n%", used, ".3g", TO_PERCENT))
    notes = (
        "Outer fibre: along x, of section forces. Wall: von Mises, the mean over a patch of half a "
        "wall near stations and supports, where plates bend besides.",
    )
    return Table("Stress", columns, notes, "stress")


def life_table(results: Results) -> Table | None:
    """Rainflow ranges of each segment, of the models that are read first."""
    rows = [
        (name, life)
        for name, own in results.summary.answers.models.items()
        if name in results.read_first
        for life in own.life
    ]
    if not rows:
        return None
    columns = [
        Column("model", [name for name, _ in rows]),
        Column("segment", [life.segment for _, life in rows]),
        Column("at x\nm", [life.x for _, life in rows], ".4g"),
        Column("cycles", [life.cycles for _, life in rows], ".3g"),
        Column("largest range\nMPa", [life.largest for _, life in rows], ".4g", TO_MEGA),
        Column("equivalent range\nMPa", [life.equivalent for _, life in rows], ".4g", TO_MEGA),
    ]
    if any(life.damage is not None for _, life in rows):
        damages = [life.damage for _, life in rows]
        columns.append(Column("damage of a run", damages, ".3g"))
        borne = [1.0 / damage if damage else None for damage in damages]
        columns.append(Column("runs to failure", borne, ".3g"))
    if any(life.life_damage is not None for _, life in rows):
        columns.append(Column("of its life", [life.life_damage for _, life in rows], ".3g"))
    notes = (
        "Rainflow ranges of the outer fibre's stress where it varies most. Equivalent: what, once "
        "in a run, does as much as all of them at a slope of 3. Runs to failure: how often its "
        "motion may come until the damage is 1; none where no range does any.",
    )
    return Table("Life", columns, notes, "life")
