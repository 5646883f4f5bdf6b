# SPDX-License-Identifier: LGPL-3.0-or-later
"""Statics of all combinations of a case in their load cases, side by side, and their envelope.

The boom consists of beam elements with play and axial forces, as in
:mod:`runs.pipeline.largest_loads`; each combination has a system of its own, since axial forces
soften it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from dynamics.failure import NUMERICAL_ERRORS
from runs.case.build import build_boom
from runs.case.combinations import CombinedCase, combined_cases
from runs.case.schema import Case
from runs.case.units import System
from runs.pipeline.largest_loads import StaticBeam, StaticExtreme, beam_note, in_units
from runs.pipeline.statics import boom_with_play
from runs.report.tables import Column, Table

# Mark of the governing values of a table.
_GOVERNS = " *"

# Kinds of results with a column: the start of their names, and the heading.
_KINDS = {
    "tip": "tip",
    "tip to the side": "tip to\nthe side",
    "stress": "stress",
    "pad": "pad",
    "contact": "contact\nforce",
    "cylinder force": "cylinder\nforce",
    "foot": "foot\nforce",
}


class CombinationState(NamedTuple):
    """Static states of a combination in a load case; ``beam`` is None without an equilibrium."""

    combined: CombinedCase
    beam: StaticBeam | None
    extremes: Sequence[StaticExtreme]

    def largest(self, kind: str) -> StaticExtreme | None:
        """Return the largest result of a kind, a key of the table's columns."""
        own = [one for one in self.extremes if one.name.partition(", ")[0] == kind]
        return max(own, key=lambda one: abs(one.largest), default=None)


def combination_states(case: Case) -> list[CombinationState]:
    """Return the static states of all combinations; none without load cases and combinations."""
    found = []
    for combined in combined_cases(case) if case.load_cases or case.combinations else ():
        boom = boom_with_play(combined.case, build_boom(combined.case))
        try:
            beam = StaticBeam.of(combined.case, boom)
        except NUMERICAL_ERRORS:
            found.append(CombinationState(combined, None, []))
            continue
        extremes = [*beam.extremes(case.system), *beam.foot_extremes(case.system)]
        found.append(CombinationState(combined, beam, extremes))
    return found


def combination_tables(states: Sequence[CombinationState], system: System) -> Iterator[Table]:
    """Yield the table of combinations, and that of their envelope, in the units of a case."""
    beams = [one.beam for one in states if one.beam is not None]
    if not beams:
        return
    columns = [Column("combination", [one.combined.name for one in states])]
    for kind, heading in _KINDS.items():
        values = [one.largest(kind) for one in states]
        most = max((abs(one.largest) for one in values if one), default=0.0)
        if most:
            cells = [_marked(one, most, system) if one else None for one in values]
            columns.append(Column(heading, cells))
    notes = [f"{_GOVERNS.strip()} governs.", beam_note(beams[0].boom)]
    missing = [one.combined.name for one in states if one.beam is None]
    notes += [f"{name}: no rest is found." for name in missing]
    yield Table("Combinations at rest, the largest results", columns, notes, "combinations")
    if len(states) > 1:
        yield _envelope(states, system)


def _marked(one: StaticExtreme, most: float, system: System) -> str:
    text = in_units(one.largest, one.unit, system)
    return text + (_GOVERNS if abs(one.largest) == most else " " * len(_GOVERNS))


def _envelope(states: Sequence[CombinationState], system: System) -> Table:
    """Return the least and the largest value of each result, and the combination that governs."""
    of_name: dict[str, list[tuple[StaticExtreme, str]]] = {}
    for state in states:
        for one in state.extremes:
            of_name.setdefault(one.name, []).append((one, state.combined.name))
    least = [min(several, key=lambda pair: pair[0].largest) for several in of_name.values()]
    most = [max(several, key=lambda pair: pair[0].largest) for several in of_name.values()]
    governs = [
        max(pair, key=lambda one: abs(one[0].largest))[1] for pair in zip(least, most, strict=True)
    ]
    columns = [
        Column("result", [*of_name]),
        Column("least", [in_units(one.largest, one.unit, system) for one, _ in least]),
        Column("largest", [in_units(one.largest, one.unit, system) for one, _ in most]),
        Column("governs", governs),
    ]
    return Table("Envelope of the combinations", columns, name="envelope")
