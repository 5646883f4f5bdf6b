# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is measured of a pair of boxes as shells and as solids, and by how much they differ."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeVar

import numpy as np

from shell_model.reduction.mirror import ALONG_Z, BREATHING, TWISTING, Family
from studies.box_pair import (
    FREQUENCY,
    PROBES,
    Blow,
    Quarter,
    blow,
    pair,
    shell_parts,
    solid_parts,
)
from studies.refined import Refined

# What is allowed of the thinnest walls; on a line at a free end, between the corners, a shell does
# worst.
ALLOWED, ALLOWED_OF_A_SQUEEZE = 0.01, 0.04


@dataclass(frozen=True, slots=True)
class Sizes:
    """What is measured."""

    #: Thicknesses in m, rising.
    walls: Sequence[float] = tuple(np.geomspace(0.004, 0.04, 4).round(4).tolist())
    #: Edge lengths of the shells' meshes in m, each half the one before.
    triangles: Sequence[float] = (0.05, 0.025, 0.0125)
    #: Of the solids' edges around the section, each twice the one before; as many as ``triangles``.
    splits: Sequence[int] = (1, 2, 4)
    #: See :func:`studies.reference_models.solid_mesh.mesh_quarter`.
    along: tuple[float, float] = (0.0125, 0.2)
    around: float = 0.1


class Measured(NamedTuple):
    """A quantity of the pair."""

    what: str  #: it is
    label: str  #: in figures
    unit: str  #: of the values
    segment: Literal[0, 1]  #: 0 for the outer box, 1 for the inner one
    family: Family  #: of the motions
    probe: str = FREQUENCY  #: whose compliance it is, or ``FREQUENCY``, the lowest natural one
    allowed: float = ALLOWED  #: what counts as proven of the thinnest walls

    def of(self, answers: Sequence[Mapping[Family, Mapping[str, float]]]) -> float:
        """Its value in one of the models."""
        return answers[self.segment][self.family][self.probe]


FREQUENCIES = (
    Measured("free inner box, lowest frequency along z", "inner, along z", "Hz", 1, ALONG_Z),
    Measured("free inner box, lowest of twisting", "inner, twisting", "Hz", 1, TWISTING),
    Measured("free inner box, lowest of breathing", "inner, breathing", "Hz", 1, BREATHING),
    Measured("held outer box, lowest frequency along z", "outer, along z", "Hz", 0, ALONG_Z),
    Measured("held outer box, lowest of twisting", "outer, twisting", "Hz", 0, TWISTING),
)
COMPLIANCES = (
    Measured("held outer box, deflection of its head", "head up", "m/N", 0, ALONG_Z, "head"),
    Measured("held outer box, twist of its head", "head twisted", "rad/(N·m)", 0, TWISTING,
             "head twist"),
    Measured("free inner box, squeeze of its tail", "tail squeezed", "m/N", 1, BREATHING,
             "tail squeeze", ALLOWED_OF_A_SQUEEZE),
    Measured("free inner box, squeeze of its tail by pads", "pads squeezed", "m/N", 1, BREATHING,
             "pad squeeze", ALLOWED_OF_A_SQUEEZE),
)  # fmt: skip
EVERY = FREQUENCIES + COMPLIANCES


@dataclass(frozen=True, slots=True)
class Comparison:
    """A pair of one wall thickness, as shells and as solids."""

    wall: float  #: in m
    #: Of each quantity.
    shell: Mapping[Measured, Refined]
    solid: Mapping[Measured, Refined]
    blows: tuple[Blow, Blow]  #: of the shell and of the solid, on the finest mesh but one

    @property
    def walls(self) -> str:
        """For people."""
        return f"{1.0e3 * self.wall:g} mm"

    def error(self, what: Measured) -> float:
        """Of the shell, relative to the solid."""
        return self.shell[what].settled / self.solid[what].settled - 1.0

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

    def compared(wall: float) -> Comparison:
        boxes = pair(wall)
        tell(f"walls of {1.0e3 * wall:g} mm")

        def shells(number: int, size: float) -> Mapping[Family, Quarter]:
            return shell_parts(boxes[number], PROBES[number], size)

        def solids(number: int, splits: int) -> Mapping[Family, Quarter]:
            return solid_parts(boxes[number], PROBES[number], sizes.along, sizes.around, splits)

        shell, of_shell = _refined(wall, "shell", sizes.triangles, shells)
        solid, of_solid = _refined(wall, "solid", sizes.splits, solids)
        return Comparison(wall, shell, solid, (of_shell, of_solid))

    return [compared(wall) for wall in sizes.walls]


_Size = TypeVar("_Size")


def _refined(
    wall: float,
    model: str,
    sizes: Sequence[_Size],
    parts_of: Callable[[int, _Size], Mapping[Family, Quarter]],
) -> tuple[dict[Measured, Refined], Blow]:
    """Every quantity on every mesh, and the blow on the finest but one."""
    answers = []
    for size in sizes:
        outer, inner = parts_of(0, size), parts_of(1, size)
        answers.append(measure([outer, inner]))
        if size == sizes[-2]:
            struck = blow(outer[ALONG_Z], inner[ALONG_Z], wall)
    halvings = [2.0**i for i in reversed(range(len(sizes)))]
    where = f"{1.0e3 * wall:g} mm, {model}"
    return {
        what: Refined(f"{where}: {what.what}", what.unit, halvings, [what.of(a) for a in answers])
        for what in EVERY
    }, struck


def measure(parts: Sequence[Mapping[Family, Quarter]]) -> list[dict[Family, dict[str, float]]]:
    """Of both segments."""
    return [{family: part.measure() for family, part in of.items()} for of in parts]


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
