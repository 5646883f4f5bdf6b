# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is read of a boom's shells while they move."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from dynamics.gap_builder import Observed
from geometry.boom import Boom
from geometry.observation import Quantity, Read
from shell_model.segment.cross_section import Outline, Reading, Row
from shell_model.segment.segment_shell import SegmentShell


def observers(boom: Boom, shells: Sequence[SegmentShell]) -> dict[str, Observed[Reading]]:
    """What is reported of the boom's ends, and what is observed besides. Collective."""
    ends: tuple[Quantity, ...] = ("deflection", "rotation", "distortion")
    if boom.spatial:
        ends += ("lateral", "twist")
    outlines: dict[tuple[int, float], Outline] = {}
    observed = {}
    for place in boom.recorded(ends):
        at = place.segment, place.x
        if at not in outlines:
            outlines[at] = shells[place.segment].outline(place.x)
        kind = place.kind
        row = _READ[kind.read](outlines[at])
        observed[place.name] = Observed(Reading({place.segment: row}), kind.unit, kind.derivative)
    return observed


_READ: Mapping[Read, Callable[[Outline], Row]] = {
    "deflection": Outline.mean_deflection,
    "rotation": Outline.rotation,
    "distortion": Outline.distortion,
    "lateral": partial(Outline.mean_deflection, direction="y"),
    "twist": Outline.twist,
}
