# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far the shell is from a solid as walls become thicker.

A short pair of boxes keeps its mid-lines while its walls grow. Of both models every quantity is
taken where refinement leads it, so that what is left is the theory's error: a shell's walls end on
one another's mid-lines, where a solid has corners.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from runs.report.tables import TextTable
from runs.report.theme import fixed, number
from runs.studies.box_errors import (
    COMPLIANCES,
    FREQUENCIES,
    Comparison,
    Measured,
    Sizes,
    answers,
    compare,
    order,
    slenderness_at,
)
from runs.studies.box_pair import PROBES, SPEED, Blow, pair, solid_parts
from runs.studies.solid_itself import solid_proofs
from runs.studies.study import Plot, Proof, Study

# Errors of which the table says how thick a wall they take.
LIMITS = (0.01, 0.02, 0.05)
# What is allowed of a blow, which is on finite meshes.
ALLOWED_OF_A_BLOW = 0.02


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
            "Both have the same mass. The shell lacks t_web h t_flange²/2 of the second moment, "
            "which is of the order (t/h)²; and its walls bend from mid-line to mid-line, those of "
            "the solid from corner to corner, which is of the order t/b.",
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


def other_sizes(sizes: Sizes) -> TextTable:
    """What the solid's edges along x and its layers change, which are not refined elsewhere."""
    smallest, largest = sizes.along
    variants = (sizes.along, 2), ((0.5 * smallest, 0.5 * largest), 2), (sizes.along, 4)
    rows = []
    for wall in (sizes.walls[0], sizes.walls[-1]):
        base, longwise, layered = (
            answers(
                [
                    solid_parts(box, probes, along, sizes.around, sizes.splits[0], layers)
                    for box, probes in zip(pair(wall), PROBES, strict=True)
                ]
            )
            for along, layers in variants
        )
        for what in FREQUENCIES + COMPLIANCES:
            changes = [what.of(finer) / what.of(base) - 1.0 for finer in (longwise, layered)]
            rows.append(
                (
                    f"{1.0e3 * wall:g} mm: {what.what}",
                    *(fixed(change, 2, 100.0) for change in changes),
                )
            )
    return TextTable(
        "What further refinement changes of the solid",
        ("walls", "edges along x\nhalved (%)", "four layers\nfor two (%)"),
        rows,
        ("On the coarsest of the three meshes, which refine the edges around the section.",),
        name="solid-sizes",
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
    worst = max(struck.reduction_error for one in comparisons for struck in one.blows)
    return TextTable(
        "One blow of the inner box against the outer one's head",
        ("walls", "shell", "solid", "difference (%)"),
        rows,
        (
            f"The inner box rises at {SPEED:g} m/s and hits the head from within. Middle meshes; "
            f"the reductions err by {worst:.1e} at most.",
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
        tables=[
            error_table(comparisons),
            index_table(comparisons),
            other_sizes(sizes),
            blow_table(comparisons),
        ],
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
    curves["refinement's own"] = (
        [1.0e3 * comparison.wall for comparison in comparisons],
        [100.0 * comparison.uncertainty(measured) for comparison in comparisons],
    )
    return Plot(
        name,
        f"Thicker walls, worse shells: {what}",
        "wall thickness (mm)",
        "error of the shell (%)",
        curves,
        f"Distance of the shell's {what} from those of a solid of the same walls, both at the "
        "limit of their refinement; and the largest grid convergence index of both models.",
    )
