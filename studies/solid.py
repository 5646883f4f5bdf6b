# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far the shell is from a solid as walls become thicker.

A short pair of boxes keeps its mid-lines while its walls grow. Of both models every quantity is
taken where refinement leads it, so that what is left is the theory's error: a shell's walls end on
one another's mid-lines, where a solid has corners.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from runs.report.tables import Cell, Table
from studies.box_errors import (
    COMPLIANCES,
    EVERY,
    FREQUENCIES,
    Comparison,
    Measured,
    Sizes,
    compare,
    measure,
    order,
    slenderness_at,
)
from studies.box_pair import PROBES, SPEED, pair, solid_parts
from studies.refined import refined_table
from studies.solid_itself import solid_proofs
from studies.study import Held, Piece, Plot, Proof, Tell, titled

# Errors of which the table says how thick a wall they take.
LIMITS = (0.01, 0.02, 0.05)
# What is allowed of a blow, which is on finite meshes.
ALLOWED_OF_A_BLOW = 0.02

NOTES = (
    "Two boxes of 2 m, mid-lines 0.40 m x 0.30 m and 0.31 m x 0.21 m, walls t, b the width of the "
    "box itself. Both models at Richardson's limit of three meshes. The order is that between the "
    "two thickest walls.",
    "A lowest frequency is that of the walls' own bending where walls are thin, and of the box as "
    "a beam where they are thick.",
    "Both have the same mass. The shell lacks t_web h t_flange²/2 of the second moment, which is "
    "of the order (t/h)²; and its walls bend from mid-line to mid-line, those of the solid from "
    "corner to corner, which is of the order t/b.",
)
SIZES_NOTE = "On the coarsest of the three meshes, which refine the edges around the section."


def error_table(comparisons: Sequence[Comparison]) -> Table:
    """The shell's error at every thickness, its order, and where it passes each limit."""
    columns = {
        "quantity": "", **{f"{one.walls}\n(%)": ".2f" for one in comparisons}, "order in t": ".2f",
        **{f"{100.0 * limit:g} %\nat t/b": "" for limit in LIMITS},
    }  # fmt: skip
    return Table.of_rows(
        "solid-error",
        "Error of the shell against a solid",
        columns,
        [
            (
                what.what,
                *(100.0 * one.error(what) for one in comparisons),
                order(comparisons, what),
                *(slenderness_at(comparisons, what, limit) for limit in LIMITS),
            )
            for what in EVERY
        ],
        NOTES,
    )


def refinements(comparisons: Sequence[Comparison]) -> Table:
    """How well both models are refined themselves."""
    models = [model for one in comparisons for model in (one.shell, one.solid)]
    found = [model[what] for what in EVERY for model in models]
    return refined_table("solid-index", "Both models on ever finer meshes", found, "edges × {:g}")


def other_sizes(sizes: Sizes) -> Table:
    """What the solid's edges along x and its layers change, which are not refined elsewhere."""
    smallest, largest = sizes.along
    variants = (sizes.along, 2), ((0.5 * smallest, 0.5 * largest), 2), (sizes.along, 4)
    rows: list[Sequence[Cell]] = []
    for wall in (sizes.walls[0], sizes.walls[-1]):
        base, *others = (
            measure(
                [
                    solid_parts(box, probes, along, sizes.around, sizes.splits[0], layers)
                    for box, probes in zip(pair(wall), PROBES, strict=True)
                ]
            )
            for along, layers in variants
        )
        rows += [
            (
                f"{1.0e3 * wall:g} mm: {what.what}",
                *(100.0 * (what.of(finer) / what.of(base) - 1.0) for finer in others),
            )
            for what in EVERY
        ]
    columns = {"walls": "", "edges along x\nhalved (%)": ".2f", "four layers\nfor two (%)": ".2f"}
    title = "What further refinement changes of the solid"
    return Table.of_rows("solid-sizes", title, columns, rows, (SIZES_NOTE,))


def blow_table(comparisons: Sequence[Comparison]) -> Table:
    """One blow of the inner box against the outer one."""
    worst = max(struck.reduction_error for one in comparisons for struck in one.blows)
    return Table.of_rows(
        "solid-blow",
        "One blow of the inner box against the outer one's head",
        {"walls": "", "shell": ".5g", "solid": ".5g", "difference (%)": ".2f"},
        [
            (f"{one.walls}: {what} ({unit})", shell, solid, 100.0 * (shell / solid - 1.0))
            for one in comparisons
            for what, unit, shell, solid in _blows(one)
        ],
        (
            f"The inner box rises at {SPEED:g} m/s and hits the head from within. Middle meshes; "
            f"the reductions err by {worst:.1e} at most.",
        ),
    )


def shell_proofs(thinnest: Comparison) -> Iterator[Proof]:
    """The shell of the thinnest walls against the solid."""
    walls, source = f"walls of {thinnest.walls}", "elasticity in space"
    for of in EVERY:
        shell, solid = thinnest.shell[of].settled, thinnest.solid[of].settled
        held: Held = ("other code", source, of.allowed)
        yield Proof(f"{of.what}, {walls}", shell, solid, of.unit, *held)
    held = ("other code", source, ALLOWED_OF_A_BLOW)
    for what, unit, shell, solid in _blows(thinnest):
        yield Proof(f"blow, {what}, {walls}", shell, solid, unit, *held)


@titled("solid", "Shells against solids")
def study(tell: Tell, sizes: Sizes | None = None) -> Iterator[Piece]:
    """The shell against a solid, and the solid against formulas."""
    sizes = sizes or Sizes()
    tell("the solid against formulas")
    yield from solid_proofs()
    comparisons = compare(sizes, tell)
    yield from shell_proofs(comparisons[0])
    yield error_table(comparisons)
    yield refinements(comparisons)
    yield other_sizes(sizes)
    yield blow_table(comparisons)
    yield _error_plot("frequencies", FREQUENCIES, comparisons)
    yield _error_plot("compliances", COMPLIANCES, comparisons)
    thickest = comparisons[-1]
    yield Plot(
        "solid-blow",
        f"A blow of boxes with walls of {thickest.walls}",
        "time (ms)",
        "contact force (kN)",
        {
            name: ((1.0e3 * struck.time).tolist(), (1.0e-3 * struck.force).tolist())
            for name, struck in zip(("shell", "solid"), thickest.blows, strict=True)
        },
        "The inner box hits the outer one's head; the force of the thickest walls.",
        logarithmic=False,
    )


def _blows(one: Comparison) -> list[tuple[str, str, float, float]]:
    """What of a blow, its unit, and its values of the shell and of the solid."""
    shell, solid = (struck.told for struck in one.blows)
    return [(what, unit, shell[what, unit], solid[what, unit]) for what, unit in shell]


def _error_plot(what: str, measured: Sequence[Measured], comparisons: Sequence[Comparison]) -> Plot:
    walls = [1.0e3 * one.wall for one in comparisons]
    curves = {
        of.label: (walls, [100.0 * abs(one.error(of)) for one in comparisons]) for of in measured
    }
    curves["refinement's own"] = walls, [100.0 * one.uncertainty(measured) for one in comparisons]
    return Plot(
        f"solid-{what}",
        f"Thicker walls, worse shells: {what}",
        "wall thickness (mm)",
        "error of the shell (%)",
        curves,
        f"Distance of the shell's {what} from those of a solid of the same walls, both at the "
        "limit of their refinement; and the largest grid convergence index of both models.",
    )
