# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is measured of a pair of boxes as shells and as solids, and by how much they differ."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeVar

import numpy as np

from geometry.segment import Segment
from runs.studies.box_pair import (
    PROBES,
    Answers,
    Blow,
    Part,
    blow,
    pair,
    shell_parts,
    solid_parts,
)
from runs.studies.grid_convergence import GridConvergence
from shell_model.reduction.mirror import ALONG_Z, BREATHING, TWISTING, Family

Boxes = tuple[Segment, Segment]
Parts = Sequence[Mapping[Family, Part]]

RATIO = 2.0
# Below it the meshes do not tell where they lead.
LEAST_ORDER = 0.5
# What is allowed of the thinnest walls.
ALLOWED = 0.01


@dataclass(frozen=True, slots=True)
class Sizes:
    """What is measured.

    Args:
        walls: thicknesses in m, rising.
        triangles: edge lengths of the shells' meshes in m, each half the one before.
        splits: of the solids' edges around the section, each twice the one before; as many as
            ``triangles``.
        along, around: see :func:`mesh_quarter`.
    """

    walls: Sequence[float] = tuple(np.geomspace(0.004, 0.04, 4).round(4).tolist())
    triangles: Sequence[float] = (0.05, 0.025, 0.0125)
    splits: Sequence[int] = (1, 2, 4)
    along: tuple[float, float] = (0.0125, 0.2)
    around: float = 0.1


class Measured(NamedTuple):
    """A quantity of the pair.

    Args:
        what: it is.
        label: in figures.
        unit: of the values.
        segment: 0 for the outer box, 1 for the inner one.
        family: of the motions.
        probe: whose compliance it is; None for the lowest natural frequency.
        allowed: what counts as proven of the thinnest walls.
    """

    what: str
    label: str
    unit: str
    segment: Literal[0, 1]
    family: Family
    probe: str | None = None
    allowed: float = ALLOWED

    def of(self, answers: Sequence[Mapping[Family, Answers]]) -> float:
        """Its value in one of the models."""
        found = answers[self.segment][self.family]
        return found.frequency if self.probe is None else found.compliances[self.probe]


def answers(parts: Parts) -> Sequence[Mapping[Family, Answers]]:
    """Of both segments."""
    return [{family: part.measure() for family, part in of.items()} for of in parts]


FREQUENCIES = (
    Measured("free inner box, lowest frequency along z", "inner, along z", "Hz", 1, ALONG_Z),
    Measured("free inner box, lowest of twisting", "inner, twisting", "Hz", 1, TWISTING),
    Measured("free inner box, lowest of breathing", "inner, breathing", "Hz", 1, BREATHING),
    Measured("held outer box, lowest frequency along z", "outer, along z", "Hz", 0, ALONG_Z),
    Measured("held outer box, lowest of twisting", "outer, twisting", "Hz", 0, TWISTING),
)
COMPLIANCES = (
    Measured("held outer box, deflection of its head", "head up", "m/N", 0, ALONG_Z, "head"),
    Measured(
        "held outer box, twist of its head",
        "head twisted",
        "rad/(N·m)",
        0,
        TWISTING,
        "head twist",
    ),
    # On a line at a free end, between the corners: what a shell does worst.
    Measured(
        "free inner box, squeeze of its tail",
        "tail squeezed",
        "m/N",
        1,
        BREATHING,
        "tail squeeze",
        allowed=0.04,
    ),
    Measured(
        "free inner box, squeeze of its tail by pads",
        "pads squeezed",
        "m/N",
        1,
        BREATHING,
        "pad squeeze",
        allowed=0.04,
    ),
)


@dataclass(frozen=True, slots=True)
class Values:
    """A quantity of one model on every mesh, from the coarsest to the finest."""

    values: Sequence[float]

    @property
    def limit(self) -> float:
        """Where refinement leads it; the finest mesh's value where that cannot be told."""
        convergence = GridConvergence.of(self.values, RATIO)
        settling = convergence.order > LEAST_ORDER  # False where there is none
        return convergence.limit if settling else self.values[-1]

    @property
    def index(self) -> float:
        """Grid convergence index of the finest mesh."""
        return GridConvergence.of(self.values, RATIO).index


@dataclass(frozen=True, slots=True)
class Comparison:
    """A pair of one wall thickness, as shells and as solids.

    Args:
        wall: in m.
        shell, solid: of each quantity.
        blows: of the shell and of the solid, on the finest mesh but one.
    """

    wall: float
    shell: Mapping[Measured, Values]
    solid: Mapping[Measured, Values]
    blows: tuple[Blow, Blow]

    def error(self, what: Measured) -> float:
        """Of the shell, relative to the solid."""
        return self.shell[what].limit / self.solid[what].limit - 1.0

    def uncertainty(self, measured: Sequence[Measured]) -> float:
        """Largest grid convergence index of both models' finest meshes, where there is one."""
        indices = [model[what].index for what in measured for model in (self.shell, self.solid)]
        return max((index for index in indices if math.isfinite(index)), default=math.nan)

    def slenderness(self, what: Measured) -> float:
        """Wall thickness over the width of the box."""
        section = pair(self.wall)[what.segment].section
        assert section is not None
        return self.wall / section.size("y")


def compare(sizes: Sizes, tell: Callable[[str], None]) -> list[Comparison]:
    """Measure the pair at every wall thickness; ``tell`` is told which."""
    found = []
    for wall in sizes.walls:
        tell(f"walls of {1.0e3 * wall:g} mm")
        boxes = pair(wall)

        def shells(number: int, size: float, boxes: Boxes = boxes) -> Mapping[Family, Part]:
            return shell_parts(boxes[number], PROBES[number], size)

        def solids(number: int, splits: int, boxes: Boxes = boxes) -> Mapping[Family, Part]:
            return solid_parts(boxes[number], PROBES[number], sizes.along, sizes.around, splits)

        shell, of_shell = _refined(wall, sizes.triangles, shells)
        solid, of_solid = _refined(wall, sizes.splits, solids)
        found.append(Comparison(wall, shell, solid, (of_shell, of_solid)))
    return found


_Size = TypeVar("_Size")


def _refined(
    wall: float, sizes: Sequence[_Size], parts_of: Callable[[int, _Size], Mapping[Family, Part]]
) -> tuple[dict[Measured, Values], Blow]:
    """Every quantity on every mesh, and the blow on the finest but one."""
    values: dict[Measured, list[float]] = {what: [] for what in FREQUENCIES + COMPLIANCES}
    for size in sizes:
        parts = parts_of(0, size), parts_of(1, size)
        measured = answers(parts)
        for what, found in values.items():
            found.append(what.of(measured))
        if size == sizes[-2]:
            struck = blow(parts[0][ALONG_Z], parts[1][ALONG_Z], wall)
    return {what: Values(found) for what, found in values.items()}, struck


def order(comparisons: Sequence[Comparison], what: Measured) -> float:
    """Power of the thickness with which the shell's error grows, over the two thickest walls."""
    thin, thick = comparisons[-2:]
    growth = thick.error(what) / thin.error(what)
    return math.log(growth) / math.log(thick.wall / thin.wall) if growth > 0.0 else math.nan


def slenderness_at(comparisons: Sequence[Comparison], what: Measured, limit: float) -> str:
    """Wall over width at which the error passes a limit, on a power law between two walls."""
    errors = [abs(one.error(what)) for one in comparisons]
    ratios = [one.slenderness(what) for one in comparisons]
    above = [error > limit for error in errors]
    if not any(above):
        return f"> {ratios[-1]:.3f}"
    if above[0]:
        return f"< {ratios[0]:.3f}"
    # The last time: an error that changes its sign is small in between.
    last = max(i for i in range(1, len(above)) if above[i] and not above[i - 1])
    part = math.log(limit / errors[last - 1]) / math.log(errors[last] / errors[last - 1])
    return f"{ratios[last - 1] * (ratios[last] / ratios[last - 1]) ** part:.3f}"
