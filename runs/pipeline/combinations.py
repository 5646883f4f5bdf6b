# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static results of all combinations of a case in their load cases.

The boom consists of beam elements with play and axial forces, as in
:mod:`.pipeline.beam_states`. Combinations with the same extension share their elements.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from protractile.analysis.measure import Measured, measure
from protractile.analysis.rows import BEAM, COMBINATION, Rows, extremes
from protractile.analysis.states import States
from protractile.analysis.wall_buckling import WallBuckling
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import CombinedCase, combined_cases
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.beam_states import (
    moving_states,
    static_states,
)
from protractile.runs.pipeline.quantities import Limit
from protractile.runs.pipeline.statics import boom_with_play
from protractile.runs.pipeline.tipping import foot_of, outrigger_rows
from protractile.runs.process.terminal import Progress, ignore_progress


@dataclass(frozen=True)
class CombinationState:
    """Static states of a combination in a load case."""

    combined: CombinedCase  #: the case of the combination
    states: States | None  #: the states; None without an equilibrium
    model: str = BEAM  #: name of the model
    walls: Sequence[Measured] = ()  #: wall stresses of each segment of a shell
    #: buckling of the segments of a shell; empty if it is not computed
    buckling: Sequence[WallBuckling] = ()
    #: buckling factor of the axial forces by a shell; None if it is that of beams
    critical_factor: float | None = None

    @cached_property
    def rows(self) -> Rows:
        """The extremes of the states; empty without an equilibrium."""
        if self.states is None:
            return Rows()
        measured = [*measure(self.states), *self.walls]
        found = extremes(measured, self.model, COMBINATION + self.combined.name)
        return Rows([*found, *outrigger_rows(self.combined, self.states)])


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
        boom, of_case = boom_with_play(combined.case, build_boom(combined.case)), None
        with suppress(*NUMERICAL_ERRORS), np.errstate(all="ignore"):
            if moving and combined.combination.motion:
                of_case = moving_states(combined.case).at_extremes
            else:
                of_case = static_states(combined.case, boom)
        states.append(CombinationState(combined, of_case))
    progress("combinations", "static states", 1.0)
    return states


def combination_rows(case: Case, progress: Progress = ignore_progress) -> Rows:
    """Return the static results of all combinations; empty without load cases and combinations."""
    if not (case.load_cases or case.combinations):
        return Rows()
    return Rows(row for state in combination_states(case, False, progress) for row in state.rows)


def limit_in_combinations(limit: Limit, rows: Rows, case: Case) -> tuple[str, float, Limit] | None:
    """Return the governing combination of those that demand a limit, its value and its limit.

    These are the combinations with the proof of deflection. None without them, or for limits other
    than that of the static tip deflection.
    """
    largest = limited_tips(rows, case).largest if limit.quantity.name == "tip_at_rest" else None
    if largest is None or largest.limit is None:
        return None
    name = f"{largest.state.removeprefix(COMBINATION)!r}"
    return name, abs(largest.value), replace(limit, permitted=largest.limit)


def limited_tips(rows: Rows, case: Case) -> Rows:
    """Return the tip deflections, with limits, of combinations that demand their proof."""
    if case.limits is None or case.limits.tip_at_rest is None:
        return Rows()
    demanding = [
        COMBINATION + combined.name
        for combined in combined_cases(case)
        if "deflection" in combined.combination.proofs
    ]
    limits, foot = case.limits, foot_of(build_boom(case)).x
    tips = rows.where(state=demanding, quantity="tip")
    return Rows(row._replace(limit=limits.tip_of((row.x or 0.0) - foot)) for row in tips)
