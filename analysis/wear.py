# SPDX-License-Identifier: LGPL-3.0-or-later
"""Wear of slide pads in motions that telescope.

A pad of the area A that slides by s under the force F loses the volume k F s, so that its depth
grows by k F s/A (Archard 1953, *Contact and rubbing of flat surfaces*, J. Appl. Phys. 24, 981). The
coefficient k is that of pad and surface; the wear of the steel is neglected. Forces are those of
the play at the start. In each joint the worn pads let the rigid inner segment move and turn.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

import numpy as np

from protractile.analysis.fatigue import Life
from protractile.analysis.measure import station_label
from protractile.analysis.pads import loaded_pads
from protractile.analysis.rows import MOTION, Row
from protractile.analysis.states import States

# Size of the unit mm³/(N m) of coefficients of wear in m²/N.
_PER_UNIT = 1.0e-9


def wear_rows(states: States, model: str, life: Life, tip: float = 0.0) -> Iterator[Row]:
    """Yield wear, and runs until a pad is worn through, of each pad that slides, and worn plays.

    Then follow the deflection of the tip at rest with worn pads, and the runs until its limit.

    Args:
        states: states of a motion.
        model: name of the model.
        life: coefficient of wear, number of runs, and limit of the tip at rest.
        tip: largest static deflection of the tip in m with new pads.
    """
    boom, data, at = states.boom, states.recorded, (model, MOTION, True)
    # Height in m by which each joint lets its inner segment rise at x in a run.
    rises = defaultdict[int, dict[float, float]](dict)
    farthest = defaultdict[int, float](float)
    for station in boom.stations if life.wear is not None and data is not None else ():
        assert data is not None
        assert life.wear is not None
        extension = f"extension-{station.number + 1}" if station.number else "extension"
        if station.joint is None or extension not in data:
            continue
        part, place = station_label(boom, station)
        # Forces are means of the interval that ends at each time.
        way = data[extension].values
        forces, slides = data["contact_force"].values[1:, station.index], np.abs(np.diff(way))
        sides = [np.maximum(forces, 0.0), np.maximum(-forces, 0.0)]
        deepest = defaultdict[str, float](float)
        for pad, name, force in loaded_pads(station, sides):
            depth = _PER_UNIT * life.wear * float(force @ slides) / pad.area
            side = name.split()[0]
            deepest[side] = max(deepest[side], depth)
            where, worn = (part, f"{place}, {name}"), life.repeats * depth
            yield Row(*at, "wear", *where, worn, station.x, limit=pad.thickness)
            if pad.thickness is not None and depth > 0.0:
                yield Row(*at, "wear_life", *where, pad.thickness / depth, station.x)
        play = station.joint.play if station.direction == "z" else station.joint.lateral_play or 0.0
        if deepest:
            worn = play + life.repeats * sum(deepest.values())
            yield Row(*at, "worn_play", part, place, worn, station.x)
        if deepest and station.direction == "z":
            farthest[station.number] = float(way.max())
            # A station at the tail moves with the inner segment.
            rides = np.isclose(station.x, boom.segments[station.segment].start)
            x = station.x + (farthest[station.number] if rides else 0.0)
            rises[station.number][x] = deepest["above"] - deepest["below"]
    fall = 0.0
    for joint, rise in rises.items():
        if len(rise) > 1:
            end = boom.tip + sum(way for number, way in farthest.items() if number >= joint)
            fall -= float(np.polyval(np.polyfit([*rise], [*rise.values()], 1), end))
    if fall > 0.0:
        yield Row(*at, "worn_tip", "", "tip", tip + life.repeats * fall, boom.tip, limit=life.tip)
        if life.tip is not None:
            yield Row(*at, "wear_life", "", "tip", max(life.tip - tip, 0.0) / fall, boom.tip)
