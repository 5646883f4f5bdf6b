# SPDX-License-Identifier: LGPL-3.0-or-later
"""Computation of load charts, with the cells of finished configurations in the user's cache."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import TYPE_CHECKING, NamedTuple

from protractile.analysis.proofs import governing
from protractile.analysis.rows import Row
from protractile.geometry.typography import choices
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom, telescoped_joints
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case
from protractile.runs.chart.cells import (
    Cell,
    Configuration,
    chart_of,
    combined_case,
    configurations,
    hook_of,
    load_case_of,
    solve,
)
from protractile.runs.folder.cache import Cache, key
from protractile.runs.pipeline.combined_shells import shell_states
from protractile.runs.pipeline.proofs import proofs_of
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.ending import when_interrupted
from protractile.runs.process.terminal import Progress, ignore_progress
from protractile.runs.process.workers import end

if TYPE_CHECKING:
    import pandas as pd


class Chart(NamedTuple):
    """Load chart of a case."""

    case: Case  #: the case
    cells: Sequence[Sequence[Cell]]  #: cells (num_configurations, num_radii)

    @property
    def frame(self) -> pd.DataFrame:
        """The cells as a data frame, in SI units and degrees."""
        import pandas as pd

        rows = []
        for cell in (cell for several in self.cells for cell in several):
            found = cell.governing
            judged = [row.value for row in cell.proofs if row.quantity == "deflection"]
            rows.append(
                {
                    "length, m": cell.length,
                    "radius, m": cell.radius,
                    "capacity, kg": cell.capacity,
                    "governing proof": found.of.title if found else "",
                    "place": ", ".join(filter(None, (found.part, found.place))) if found else "",
                    "x, m": found.x if found else None,
                    "combination": cell.combination,
                    "limited otherwise by": cell.reason,
                    "luffing angle, deg": cell.angle,
                    "tip height, m": cell.height,
                    "tip deflection, m": cell.tip,
                    "proved tip deflection, m": judged[0] if judged else None,
                    "droop of the radius, m": cell.droop,
                    "cylinder force, N": cell.cylinder_force,
                }
            )
        return pd.DataFrame(rows)


def chart(case: Case) -> Chart:
    """Return the load chart of a case, computed in this process.

    >>> import protractile as pt
    >>> case = pt.load_case(pt.CASES / "chart-lift.toml")
    >>> case = pt.change(case, **{"chart.lengths": [15.7], "chart.radii": [15.0]})
    >>> pt.chart(case).frame["governing proof"][0]
    'plate buckling'

    Raises:
        BadInput: the case has no valid table ``chart``.
    """
    return solve_all(case, plan(case, "case"), None, Cache.of_user())


def utilisations_by_shell(
    chart: Chart, shell: Shell, context: BuildContext
) -> Iterator[tuple[Cell, Row]]:
    """Yield the largest cell of each governing proof, and this proof by a shell. Collective.

    The shell carries the capacity that beams give.
    """
    largest: dict[str, Cell] = {}
    for cell in (cell for cells in chart.cells for cell in cells if cell.governing):
        kind = cell.proofs[0].quantity
        largest[kind] = max(cell, largest.get(kind, cell), key=lambda one: one.capacity or 0.0)
    for kind, cell in largest.items():
        assert cell.angle is not None
        assert cell.capacity is not None
        table = load_case_of(chart.case, cell.capacity, cell.configuration.extension, cell.angle)
        case = combined_case(chart.case, table)
        states = shell_states(case, shell, context)
        rows = [row for state in states for row in proofs_of(state, case) if row.quantity == kind]
        if rows:
            yield cell, governing(rows)[0]


def plan(case: Case, file: str) -> list[Configuration]:
    """Return the configurations of the chart of a case.

    Raises:
        BadInput: the case has no chart, no load whose weight it knows, or no proofs; a name is
            unknown; a length, an extension or a radius is out of reach.
    """
    if getattr(case, "chart", None) is None:
        raise BadInput(file, "chart", "missing; give its load_case and radii")
    chart = chart_of(case)
    if case.gravity is None:
        raise BadInput(file, "gravity", "missing; the payload of a chart weighs by it")
    names = [one.name for one in case.load_cases]
    if chart.load_case not in names:
        what = f"{chart.load_case!r} is no load case; give {choices(names) or '[[load_case]]'}"
        raise BadInput(file, "chart.load_case", what)
    if bool(chart.radii) == bool(chart.luffing):
        raise BadInput(file, "chart.radii", "give radii, or luffing, the angles in their place")
    given = [name for name in ("extensions", "telescoped", "lengths") if getattr(chart, name)]
    if len(given) > 1:
        raise BadInput(file, f"chart.{given[1]}", f"{given[0]} is given; leave one of them out")
    inner = [one.inner for one in telescoped_joints(case) if one.extension is not None]
    for number, extension in enumerate(chart.extensions, start=1):
        for name in extension:
            if name not in inner:
                what = f"{name!r} extends in no joint; give {choices(inner)}"
                raise BadInput(file, f"chart.extensions[{number}]", what)
    _check_combinations(case, file)
    try:
        boom = build_boom(case)
        planned = [*configurations(case, boom)]
    except ValueError as error:
        place, _, what = str(error).partition(": ")
        raise BadInput(file, place, case.system.convert(what)) from None
    farthest = max(hook_of(case, boom, one).farthest for one in planned)
    for number, radius in enumerate(chart.radii, start=1):
        if radius > farthest:
            what = (
                f"must be at most {farthest:g} m, the reach of the longest boom, got {radius:g} m"
            )
            raise BadInput(file, f"chart.radii[{number}]", case.system.convert(what))
    return planned


def _check_combinations(case: Case, file: str) -> None:
    """Check that combinations with proofs have the payload of the chart."""
    chart, names = chart_of(case), [one.name for one in case.combinations]
    for name in chart.combinations or ():
        if name not in names:
            what = f"{name!r} is no combination; give {choices(names)}"
            raise BadInput(file, "chart.combinations", what)
    carrying = [
        one
        for one in case.combinations
        if (chart.combinations is None or one.name in chart.combinations)
        and (one.load_cases is None or chart.load_case in one.load_cases)
        and one.factors.of("payload")
    ]
    if not carrying:
        what = f"no combination has the payload of {chart.load_case!r}; its proofs limit the chart"
        raise BadInput(file, "chart.combinations", what)


def solve_all(
    case: Case,
    planned: Sequence[Configuration],
    pool: Executor | None,
    cache: Cache | None,
    progress: Progress = ignore_progress,
) -> Chart:
    """Return the chart of a case; finished configurations come from the cache.

    Raises:
        MemoryError: the system killed a process.
    """
    stage = f"{len(planned)} configurations"
    keys = [key(toml.digest(case), one) for one in planned]
    stored = {} if cache is None else {i: cache.load(name, list) for i, name in enumerate(keys)}
    solved: dict[int, list[Cell]] = {i: cells for i, cells in stored.items() if cells is not None}
    left = [i for i in range(len(planned)) if i not in solved]

    def finish(i: int, cells: list[Cell]) -> None:
        solved[i] = cells
        if cache is not None:
            cache.try_to_store(keys[i], cells)
        progress("chart", stage, len(solved) / len(planned))

    try:
        with when_interrupted(end):
            if pool is None:
                for i in left:
                    finish(i, solve(case, planned[i]))
            else:
                futures = {pool.submit(solve, case, planned[i]): i for i in left}
                for future in as_completed(futures):
                    finish(futures[future], future.result())
    except BrokenProcessPool:
        raise MemoryError("the system has killed a process of the chart") from None
    return Chart(case, [solved[i] for i in range(len(planned))])
