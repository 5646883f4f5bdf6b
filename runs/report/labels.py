# SPDX-License-Identifier: LGPL-3.0-or-later
"""Texts of rows: titles with places, amounts, factors, utilisations; extremes of curves."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from protractile.analysis.quantities import Quantity
from protractile.analysis.rows import MOTION, REST, Row, Rows
from protractile.geometry.arrays import Array
from protractile.geometry.typography import DECIMALS, TO_PERCENT, join_words, number
from protractile.runs.case.schema import Case

if TYPE_CHECKING:
    import xarray as xr


def title(row: Row) -> str:
    """Return what a row measures, without its place."""
    titles = {REST: row.of.at_rest, MOTION: row.of.in_motion}
    return titles.get(row.state) or row.of.title


def place(row: Row) -> str:
    """Return the part and the place of a row, such as ``fly, x = 3.8 m, lateral``.

    Stations and stops have their position instead of their number.
    """
    there = re.sub(
        r"^(station|stop) \d+", f"x = {row.x:g} m" if row.x is not None else "", row.place
    )
    continued = there.startswith(("at ", "in ")) or there.isdigit()
    return (" " if continued else ", ").join(filter(None, (row.part, there)))


def label(row: Row) -> str:
    """Return title and place of a row, such as ``transverse reaction, base at 0 m``."""
    # The title may name the part: tip, rope, or the only cylinder.
    return title(row) if row.part in title(row).split() else f"{title(row)}, {place(row)}"


def amount_of(quantity: Quantity, value: float, digits: int = 3) -> str:
    """Return a value in SI units as text in the displayed unit of its quantity."""
    shown = number(round(quantity.factor * value, DECIMALS), digits)
    return f"{shown} {quantity.unit_of_heading}".strip()


def times(rows: Rows, row: Row) -> str:
    """Return the dynamic factor of a maximum as text; empty if the rows give none."""
    factor = rows.dynamic_factor(row)
    return "" if factor is None else f" (× {number(factor)})"


def used(row: Row) -> str:
    """Return utilisation, place, and comparison with the limit as text; the row has a limit."""
    assert row.utilisation is not None
    relation = "exceeds" if row.utilisation > 1.0 else "below"
    return (
        f"{TO_PERCENT * row.utilisation:.3g} % by {row.of.title} ({row.part}, x = {row.x:.4g} m): "
        f"{relation} {row.of.limit}"
    )


def tip_directions(trajectories: xr.Dataset) -> list[str]:
    """Return the names of the tip's displacements, largest amplitude first."""
    places = [name for name in ("tip", "tip_lateral") if name in trajectories]
    spans = {name: float(np.ptp(trajectories[name].values, axis=-1).max()) for name in places}
    return sorted(places, key=lambda name: -spans[name])


def farthest(values: Sequence[float] | Array) -> float:
    """Return the finite value of largest magnitude, with its sign; NaN without finite values."""
    finite = np.asarray(values)[np.isfinite(values)]
    return float(finite[np.abs(finite).argmax()]) if finite.size else float("nan")


def extension_note(case: Case, times: Iterable[float | None]) -> str:
    """Return a note on the extensions at the times of static states; empty without telescoping."""
    several = [f"{time:g}" for time in sorted({time for time in times if time is not None})]
    return f" Extension as at {join_words(several)} s." if case.driven_segments and several else ""
