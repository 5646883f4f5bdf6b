# SPDX-License-Identifier: LGPL-3.0-or-later
"""Wear of slide pads in motions that telescope.

A pad of the area A that slides by s under the force F loses the volume k F s, so that its depth
grows by k F s/A (Archard 1953, *Contact and rubbing of flat surfaces*, J. Appl. Phys. 24, 981). The
coefficient k is that of pad and surface; the wear of the steel is neglected. Forces are those of
the play at the start.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from protractile.analysis.fatigue import Life
from protractile.analysis.measure import station_label
from protractile.analysis.pads import loaded_pads
from protractile.analysis.rows import MOTION, Row
from protractile.analysis.states import States

# Size of the unit mm³/(N m) of coefficients of wear in m²/N.
_PER_UNIT = 1.0e-9


def wear_rows(states: States, model: str, life: Life) -> Iterator[Row]:
    """Yield wear, and runs until a pad is worn through, of each pad that slides, and worn plays.

    Args:
        states: states of a motion.
        model: name of the model.
        life: coefficient of wear, and number of runs.
    """
    data = states.recorded
    for station in states.boom.stations if life.wear is not None and data is not None else ():
        assert data is not None
        assert life.wear is not None
        extension = f"extension-{station.number + 1}" if station.number else "extension"
        if station.joint is None or extension not in data:
            continue
        part, place = station_label(states.boom, station)
        # Forces are means of the interval that ends at each time.
        slides = np.abs(np.diff(data[extension].values))
        forces = data["contact_force"].values[1:, station.index]
        sides = [np.maximum(forces, 0.0), np.maximum(-forces, 0.0)]
        at, deepest = (model, MOTION, True), dict[str, float]()
        for pad, name, force in loaded_pads(station, sides):
            depth = _PER_UNIT * life.wear * float(force @ slides) / pad.area
            side = name.split()[0]
            deepest[side] = max(deepest.get(side, 0.0), life.repeats * depth)
            where = part, f"{place}, {name}"
            worn = life.repeats * depth
            yield Row(*at, "wear", *where, worn, station.x, limit=pad.thickness)
            if pad.thickness is not None and depth > 0.0:
                yield Row(*at, "wear_life", *where, pad.thickness / depth, station.x)
        play = station.joint.play if station.direction == "z" else station.joint.lateral_play or 0.0
        if deepest:
            yield Row(*at, "worn_play", part, place, play + sum(deepest.values()), station.x)
