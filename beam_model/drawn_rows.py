# SPDX-License-Identifier: LGPL-3.0-or-later
"""The rows of a boom of beams over all of the way that its joints are drawn out.

Between the nodes that pass a station rows are the shape functions of an element: cubics, which
tables hold exactly, or polynomials of a series, within a tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from beam_model.component import SegmentModel
from dynamics.gap_builder import GapBuilder
from dynamics.row_table import RowTable
from dynamics.travel import KINDS, Kind, Together, Travel
from geometry.arrays import Array
from geometry.boom import SAME_PLACE, Boom
from geometry.drawing import drives_below
from geometry.drive import Drive

# Rows of the boom where each joint is drawn out by its way in m.
RowsAt = Callable[[Sequence[float]], GapBuilder[Array]]


def travels(boom: Boom, models: Sequence[SegmentModel], rows_at: RowsAt) -> list[Travel]:
    """What moves the rows of a boom: the drive of each joint, several together for stops.

    Args:
        boom: its joints may have drives.
        models: one for each segment.
        rows_at: m of each joint → what touches, rubs and drags.
    """
    drives_of = _drives_of_stations(boom)
    return [
        _travel(boom, models, rows_at, numbers, stations)
        for numbers in dict.fromkeys(drives_of.values())
        if numbers
        for stations in [[s for s, of in drives_of.items() if of == numbers]]
    ]


def _drives_of_stations(boom: Boom) -> dict[int, tuple[int, ...]]:
    """Positions of the joints whose drives move what is read at each station."""
    found, station = {}, 0
    for _ in boom.directions:
        for number, joint in enumerate(boom.joints):
            for _ in () if joint.tied else joint.stations:
                found[station] = () if joint.drive is None else (number,)
                station += 1
    stops = {s: drives_below(boom.joints, stop.segment) for s, stop in boom.numbered_stops}
    return found | stops


def _travel(
    boom: Boom,
    models: Sequence[SegmentModel],
    rows_at: RowsAt,
    numbers: tuple[int, ...],
    stations: Sequence[int],
) -> Travel:
    """Of what the drives of some joints move together, at its stations."""
    drives = [drive for n in numbers for drive in [boom.joints[n].drive] if drive is not None]
    moving = list(_moving(rows_at([0.0] * len(boom.joints)), stations))

    def rows(way: float) -> Array:
        # Only the sum of the ways tells where stops are.
        ways = [way if n == numbers[0] else 0.0 for n in range(len(boom.joints))]
        of_kind = _by_kind(rows_at(ways))
        return np.array([of_kind[kind][position] for kind, position in moving])

    history = drives[0].history if len(drives) == 1 else Together(tuple(d.history for d in drives))
    breaks = _breaks(boom, models, numbers, drives)
    suffix = None if len(numbers) > 1 else "" if numbers[0] == 0 else f"-{numbers[0] + 1}"
    return Travel(history, RowTable.of(rows, breaks), tuple(moving), suffix)


def _by_kind(rows: GapBuilder[Array]) -> dict[Kind, list[Array]]:
    contacts = [contact.reading for contact in rows.contacts]
    frictions = [friction.reading for friction in rows.frictions]
    return dict(zip(KINDS, (contacts, frictions, rows.dashpot_rows(lambda row: row)), strict=True))


def _moving(rows: GapBuilder[Array], stations: Sequence[int]) -> Iterator[tuple[Kind, int]]:
    """Rows at some stations."""
    where = (
        [contact.station for contact in rows.contacts],
        [friction.law.station for friction in rows.frictions],
        list(rows.dashpots),
    )
    for kind, of_rows in zip(KINDS, where, strict=True):
        yield from ((kind, row) for row, station in enumerate(of_rows) if station in stations)


def _breaks(
    boom: Boom, models: Sequence[SegmentModel], numbers: tuple[int, ...], drives: Sequence[Drive]
) -> list[float]:
    """Ways in m at which a node passes a station, between the ends of the reach."""
    low, high = (sum(drive.reach[end] for drive in drives) for end in (0, 1))
    joint = boom.joints[numbers[-1]]
    outer, inner = (
        np.concatenate([c.breaks for c in models[segment].components.values()])
        for segment in (joint.outer, joint.inner)
    )
    passed = [np.array([low, high])]
    if len(numbers) == 1:
        passed += [x - inner for x in joint.stations] + [outer - x for x in joint.stations]
    for stop in boom.stops:
        if drives_below(boom.joints, stop.segment) == numbers:
            passed += [stop.x - c.breaks for c in models[stop.segment].components.values()]
    ways = np.unique(np.clip(np.concatenate(passed), low, high))
    near = SAME_PLACE * boom.length
    kept = [low, *(way for way in ways[1:-1] if low + near < way < high - near), high]
    apart = np.diff(kept, prepend=low - 1.0) > near
    return [way for way, keep in zip(kept, apart, strict=True) if keep]
