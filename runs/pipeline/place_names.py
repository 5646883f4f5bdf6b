# SPDX-License-Identifier: LGPL-3.0-or-later
"""What results call the stations of a boom."""

from __future__ import annotations

from collections.abc import Sequence


def place_names(stations: Sequence[tuple[float, str]]) -> list[str]:
    """A name for each station: its x in m, behind it ``y`` where it works to the sides.

    ``#2`` and so forth stands behind the name where others are at the same place.
    """
    names = [f"{x:g}" + ("y" if direction == "y" else "") for x, direction in stations]
    before = [names[:i].count(name) for i, name in enumerate(names)]
    return [
        f"{name}#{count + 1}" if count else name for name, count in zip(names, before, strict=True)
    ]
