# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far the shell is from a solid as walls become thicker.

A short pair of boxes keeps its mid-lines while its walls grow. Of both models every quantity is
taken where refinement leads it, so that what is left is the theory's error: a shell's walls end on
one another's mid-lines, where a solid has corners.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeVar

import numpy as np

from geometry.segment import Segment
from runs.studies.box_pair import (
    PROBES,
    SPEED,
    Blow,
    Part,
    blow,
    pair,
    shell_parts,
    solid_parts,
)
from runs.studies.grid_convergence import GridConvergence
from runs.studies.solid_itself import solid_proofs
from runs.studies.study import Plot, Proof, Study
from runs.tables import TextTable
from runs.theme import fixed, number
from shell_model.mirror import ALONG_Z, BREATHING, TWISTING, Family

Boxes = tuple[Segment, Segment]
Parts = tuple[Mapping[Family, Part], Mapping[Family, Part]]

RATIO = 2.0
# Below it the meshes do not tell where they lead.
LEAST_ORDER = 0.5
# Errors of which the table says how thick a wall they take.
LIMITS = (0.01, 0.02, 0.05)
# What is allowed of the thinnest walls, and of a blow that they make, which is on finite meshes.
ALLOWED = 0.01
ALLOWED_OF_A_BLOW = 0.02


@dataclass(frozen=True, slots=True)
class Sizes:
    """What is measured.

    Args:
        walls: thicknesses in m, rising.
        triangles: edge lengths of the shells' meshes in m, each half the one before.
        edges: of the solids' from a wall's middle to the corner, each twice the ones before; as
            many as ``triangles``.
        along: the solids' smallest and largest edge along x in m.
    """

    walls: Sequence[float] = tuple(np.geomspace(0.004, 0.04, 4).round(4).tolist())
    triangles: Sequence[float] = (0.05, 0.025, 0.0125)
    edges: Sequence[int] = (2, 4, 8)
    along: tuple[float, float] = (0.0125, 0.2)


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

    def of(self, parts: Parts) -> float:
        """Its value in one of the models."""
        part = parts[self.segment][self.family]
        return part.lowest_frequency() if self.probe is None else part.compliance(self.probe)


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
        allowed=0.03,
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
        blows: of the shell and of the solid, on the finest mesh.
    """

    wall: float
    shell: Mapping[Measured, Values]
    solid: Mapping[Measured, Values]
    blows: tuple[Blow, Blow]

    def error(self, what: Measured) -> float:
        """Of the shell, relative to the solid."""
        return self.shell[what].limit / self.solid[what].limit - 1.0

    def slenderness(self, what: Measured) -> float:
        """Wall thickness over the width of the box."""
        section = pair(self.wall)[what.segment].section
        assert section is not None
        return self.wall / section.width


def compare(sizes: Sizes, tell: Callable[[str], None]) -> list[Comparison]:
    """Measure the pair at every wall thickness; ``tell`` is told which."""
    found = []
    for wall in sizes.walls:
        tell(f"walls of {1.0e3 * wall:g} mm")
        boxes = pair(wall)

        def shells(number: int, size: float, boxes: Boxes = boxes) -> Mapping[Family, Part]:
            return shell_parts(boxes[number], PROBES[number], size)

        def solids(number: int, edges: int, boxes: Boxes = boxes) -> Mapping[Family, Part]:
            return solid_parts(boxes[number], PROBES[number], sizes.along, edges)

        shell, of_shell = _refined(wall, sizes.triangles, shells)
        solid, of_solid = _refined(wall, sizes.edges, solids)
        found.append(Comparison(wall, shell, solid, (of_shell, of_solid)))
    return found


_Size = TypeVar("_Size")


def _refined(
    wall: float, sizes: Sequence[_Size], parts_of: Callable[[int, _Size], Mapping[Family, Part]]
) -> tuple[dict[Measured, Values], Blow]:
    """Every quantity on every mesh, and the blow on the finest."""
    values: dict[Measured, list[float]] = {what: [] for what in FREQUENCIES + COMPLIANCES}
    for size in sizes:
        parts = parts_of(0, size), parts_of(1, size)
        for what, found in values.items():
            found.append(what.of(parts))
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


def error_table(comparisons: Sequence[Comparison]) -> TextTable:
    """The shell's error at every thickness, its order, and where it passes each limit."""
    return TextTable(
        "Error of the shell against a solid",
        (
            "quantity",
            *(f"{1.0e3 * one.wall:g} mm\n(%)" for one in comparisons),
            "order in t",
            *(f"{100.0 * limit:g} %\nat t/b" for limit in LIMITS),
        ),
        [
            (
                what.what,
                *(fixed(one.error(what), 2, 100.0) for one in comparisons),
                fixed(order(comparisons, what), 2),
                *(slenderness_at(comparisons, what, limit) for limit in LIMITS),
            )
            for what in FREQUENCIES + COMPLIANCES
        ],
        (
            "Two boxes of 2 m, mid-lines 0.40 m x 0.30 m and 0.31 m x 0.21 m, walls t, "
            "b the width of the box itself. Both models at Richardson's limit of three meshes. "
            "The order is that between the two thickest walls.",
            "A lowest frequency is that of the walls' own bending where walls are thin, and of the "
            "box as a beam where they are thick.",
        ),
        name="solid-error",
    )


def index_table(comparisons: Sequence[Comparison]) -> TextTable:
    """How well both models are refined themselves."""
    return TextTable(
        "Grid convergence index of both models' finest mesh",
        (
            "quantity",
            *(
                f"{name}\n{1.0e3 * one.wall:g} mm (%)"
                for one in comparisons
                for name in ("shell", "solid")
            ),
        ),
        [
            (
                what.what,
                *(
                    fixed(values[what].index, 2, 100.0)
                    for one in comparisons
                    for values in (one.shell, one.solid)
                ),
            )
            for what in FREQUENCIES + COMPLIANCES
        ],
        ("From three meshes each, with the safety factor 1.25 (Roache 1994).",),
        name="solid-index",
    )


def blow_table(comparisons: Sequence[Comparison]) -> TextTable:
    """One blow of the inner box against the outer one."""
    rows = []
    for one in comparisons:
        for what, unit, factor, read in _BLOW:
            shell, solid = (factor * read(struck) for struck in one.blows)
            rows.append(
                (
                    f"{1.0e3 * one.wall:g} mm: {what} ({unit})",
                    number(shell, 5),
                    number(solid, 5),
                    fixed(shell / solid - 1.0, 2, 100.0),
                )
            )
    worst = max(struck.compliance_error for one in comparisons for struck in one.blows)
    return TextTable(
        "One blow of the inner box against the outer one's head",
        ("walls", "shell", "solid", "difference (%)"),
        rows,
        (
            f"The inner box rises at {SPEED:g} m/s and hits the head from within. Finest meshes; "
            f"the reductions' compliances err by {worst:.1e} at most.",
        ),
        name="solid-blow",
    )


_BLOW: Sequence[tuple[str, str, float, Callable[[Blow], float]]] = (
    ("largest force", "kN", 1.0e-3, lambda struck: struck.peak),
    ("impulse", "N·s", 1.0, lambda struck: struck.impulse),
    ("time in contact", "ms", 1.0e3, lambda struck: struck.duration),
    ("tip at the end", "mm", 1.0e3, lambda struck: struck.left),
)


def shell_proofs(comparisons: Sequence[Comparison]) -> list[Proof]:
    """The shell of the thinnest walls against the solid."""
    thinnest = comparisons[0]
    walls = f"walls of {1.0e3 * thinnest.wall:g} mm"
    found = [
        Proof(
            f"{what.what}, {walls}",
            thinnest.shell[what].limit,
            thinnest.solid[what].limit,
            what.unit,
            "other code",
            "elasticity in space",
            what.allowed,
        )
        for what in FREQUENCIES + COMPLIANCES
    ]
    for what, unit, factor, read in _BLOW:
        shell, solid = (factor * read(struck) for struck in thinnest.blows)
        found.append(
            Proof(
                f"blow, {what}, {walls}",
                shell,
                solid,
                unit,
                "other code",
                "elasticity in space",
                ALLOWED_OF_A_BLOW,
            )
        )
    return found


def study(tell: Callable[[str], None], sizes: Sizes | None = None) -> Study:
    """The shell against a solid, and the solid against formulas."""
    sizes = sizes or Sizes()
    tell("the solid against formulas")
    itself = solid_proofs()
    comparisons = compare(sizes, tell)
    thickest = comparisons[-1]
    millimetres = 1.0e3 * thickest.wall
    return Study(
        name="solid",
        title="Shells against solids",
        tables=[error_table(comparisons), index_table(comparisons), blow_table(comparisons)],
        proofs=[*itself, *shell_proofs(comparisons)],
        plots=[
            _error_plot("solid-frequencies", "frequencies", FREQUENCIES, comparisons),
            _error_plot("solid-compliances", "compliances", COMPLIANCES, comparisons),
            Plot(
                "solid-blow",
                f"A blow of boxes with walls of {millimetres:g} mm",
                "time (ms)",
                "contact force (kN)",
                {
                    name: ((1.0e3 * struck.time).tolist(), (1.0e-3 * struck.force).tolist())
                    for name, struck in zip(("shell", "solid"), thickest.blows, strict=True)
                },
                "The inner box hits the outer one's head; the force of the thickest walls.",
                logarithmic=False,
            ),
        ],
        data={
            "walls": list(sizes.walls),
            "quantities": [
                {
                    "what": what.what,
                    "unit": what.unit,
                    "shell": [list(one.shell[what].values) for one in comparisons],
                    "solid": [list(one.solid[what].values) for one in comparisons],
                    "errors": [one.error(what) for one in comparisons],
                }
                for what in FREQUENCIES + COMPLIANCES
            ],
            "blows": [
                {
                    what: [factor * read(struck) for struck in one.blows]
                    for what, _, factor, read in _BLOW
                }
                for one in comparisons
            ],
        },
    )


def _error_plot(
    name: str, what: str, measured: Sequence[Measured], comparisons: Sequence[Comparison]
) -> Plot:
    curves = {
        one.label: (
            [1.0e3 * comparison.wall for comparison in comparisons],
            [100.0 * abs(comparison.error(one)) for comparison in comparisons],
        )
        for one in measured
    }
    return Plot(
        name,
        f"Thicker walls, worse shells: {what}",
        "wall thickness (mm)",
        "error of the shell (%)",
        curves,
        f"Distance of the shell's {what} from those of a solid of the same walls, both at the "
        "limit of their refinement.",
    )
