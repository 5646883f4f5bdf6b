# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static results of all combinations of a case in their load cases, and the envelope.

The boom consists of beam elements with play and axial forces, as in
:mod:`.pipeline.largest_loads`. Each combination has a system of its own, since its axial forces
reduce the stiffness.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from protractile.analysis.stresses import WallStress
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.geometry.typography import join_words
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import CombinedCase, combined_cases
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.largest_loads import (
    BeamStates,
    StaticExtreme,
    StaticKind,
    beam_note,
    without_negligible,
)
from protractile.runs.pipeline.statics import boom_with_play
from protractile.runs.pipeline.wall_buckling import WallBuckling
from protractile.runs.process.terminal import Progress, ignore_progress
from protractile.runs.report.formatting import amount
from protractile.runs.report.tables import Column, Table

# Mark of governing values in a table.
_GOVERNS = "*"

# Column heading of each kind of result.
_KINDS: Mapping[StaticKind, str] = {
    "tip": "tip",
    "lateral tip": "lateral\ntip",
    "bending stress": "bending\nstress",
    "pad": "pad\npressure",
    "contact": "contact\nforce",
    "cylinder force": "cylinder\nforce",
    "foot reaction": "foot\nreaction",
}


@dataclass(frozen=True, slots=True)
class CombinationResult:
    """Extreme results of a combination in a load case; empty without an equilibrium."""

    name: str
    extremes: list[StaticExtreme]

    def largest(self, kind: StaticKind) -> StaticExtreme | None:
        """Return the result with the largest magnitude among those of a kind."""
        extremes = [one for one in self.extremes if one.kind == kind]
        return max(extremes, key=lambda one: abs(one.largest), default=None)


class CombinationState(NamedTuple):
    """Static states of a combination in a load case."""

    combined: CombinedCase  #: the case of the combination
    beam: BeamStates | None  #: the static states; None without an equilibrium
    walls: Sequence[WallStress] = ()  #: largest wall stresses of each segment of a shell
    #: buckling of the segments of a shell; empty if it is not computed
    buckling: Sequence[WallBuckling] = ()
    #: buckling factor of the axial forces by a shell; None if it is that of beams
    critical_factor: float | None = None

    @property
    def result(self) -> CombinationResult:
        """The extreme results. Their names give positions in the units of the case."""
        system, beam = self.combined.case.system, self.beam
        extremes = [*beam.extremes(system), *beam.foot_extremes(system)] if beam else []
        return CombinationResult(self.combined.name, extremes)


def combination_states(
    case: Case, moving: bool = True, progress: Progress = ignore_progress
) -> list[CombinationState]:
    """Return the states of all combinations, or of the case itself if it has none.

    If ``moving``, combinations with ``motion`` are computed in motion, else all of them at rest.
    """
    states: list[CombinationState] = []
    cases = list(combined_cases(case))
    for combined in cases:
        progress("combinations", "static states", len(states) / len(cases))
        boom, beam = boom_with_play(combined.case, build_boom(combined.case)), None
        with suppress(*NUMERICAL_ERRORS), np.errstate(all="ignore"):
            if moving and combined.combination.motion:
                beam = BeamStates.in_motion(combined.case).at_extremes()
            else:
                beam = BeamStates.of(combined.case, boom)
        states.append(CombinationState(combined, beam))
    progress("combinations", "static states", 1.0)
    return states


def combination_results(
    case: Case, progress: Progress = ignore_progress
) -> list[CombinationResult]:
    """Return the static results of all combinations; empty without load cases and combinations."""
    if not (case.load_cases or case.combinations):
        return []
    return [one.result for one in combination_states(case, False, progress)]


def combination_tables(
    results: Sequence[CombinationResult], case: Case, shell: str = ""
) -> Iterator[Table]:
    """Yield the table of combinations and the table of their envelope.

    ``shell`` is the name of the shell; empty for results of beam elements.
    """
    if not any(one.extremes for one in results):
        return
    shown = without_negligible([one.extremes for one in results])
    results = [
        CombinationResult(one.name, extremes) for one, extremes in zip(results, shown, strict=True)
    ]
    columns = [Column("combination,\nload case", [one.name for one in results])]
    for kind, heading in _KINDS.items():
        values = [one.largest(kind) for one in results]
        most = max((abs(one.largest) for one in values if one), default=0.0)
        if most:
            cells = [_marked(one, most) if one else None for one in values]
            columns.append(Column(heading, cells))
    notes = [f"{_GOVERNS} is the largest of its column."]
    limited = [one.name for one in case.combinations if "deflection" in one.proofs]
    if limited and case.limits is not None and (limit := case.limits.tip_at_rest) is not None:
        text = amount(limit, "m")
        notes.append(
            f"The limit {text} of the static tip deflection applies to {join_words(limited)} only."
        )
    moving = [one.name for one in case.combinations if one.motion]
    if moving:
        notes.append(f"In `prove` and reports, {join_words(moving)}: extremes of the motion.")
    if build_boom(case).telescopes:
        notes.append("Extensions are those at t = 0, or those of the load case.")
    if shell:
        notes.append(f"By {shell}, with the axial forces of each combination.")
    else:
        notes.append(beam_note(boom_with_play(case, build_boom(case))))
    notes += [f"{one.name}: there is no static equilibrium." for one in results if not one.extremes]
    yield Table("Largest results of each combination", columns, notes, "combinations")
    if len(results) > 1:
        yield _envelope(results)


def _marked(one: StaticExtreme, most: float) -> str:
    text = amount(one.largest, one.unit)
    return text + (_GOVERNS if abs(one.largest) == most else " " * len(_GOVERNS))


def _envelope(results: Sequence[CombinationResult]) -> Table:
    """Return the table of minimum, maximum and governing combination of each result."""
    of_name: dict[str, list[tuple[StaticExtreme, str]]] = {}
    for result in results:
        for one in result.extremes:
            of_name.setdefault(one.name, []).append((one, result.name))
    rows, moving = [], False
    for several in of_name.values():
        least = min(several, key=lambda pair: pair[0].largest)
        most = max(several, key=lambda pair: pair[0].largest)
        one, governing = max((least, most), key=lambda pair: abs(pair[0].largest))
        # The positions of stations depend on the extension.
        at_station = one.kind in ("pad", "contact")
        moving |= at_station
        ends = (amount(end.largest, end.unit) for end, _ in (least, most))
        rows.append((one.what if at_station else one.name, *ends, governing))
    note = "Pads and contacts move with the extension; x is given for the governing combination."
    headings, notes = ("result", "minimum", "maximum", "governing"), [note] if moving else []
    return Table.of_rows("envelope", "Envelope of the combinations", headings, rows, notes)
