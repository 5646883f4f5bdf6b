# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of what the walls of a shell carry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from geometry.typography import TO_KILO, TO_MEGA, TO_PERCENT
from runs.case.build import material_of
from runs.case.schema import Case
from runs.pipeline.results import Results
from runs.report.numerals import number
from runs.report.tables import Column, Table

if TYPE_CHECKING:
    from shell_model.stress.history import LargestPatch, StressSummary


def wall_tables(results: Results) -> list[Table]:
    """Forces of the walls at the instant of the largest stress; none without shells."""
    shells = {n: model.stress for n, model in results.summary.models.items() if model.stress}
    walls = [
        (name, section, wall, carried)
        for name, stress in shells.items()
        for section in stress.walls
        for wall, carried in section.forces.items()
    ]
    if not walls:
        return []
    columns = (
        Column("model", [name for name, *_ in walls]),
        Column("segment", [section.segment for _, section, _, _ in walls]),
        Column("at x\nm", [f"{section.x:g}" for _, section, _, _ in walls]),
        Column("wall", [wall for _, _, wall, _ in walls]),
        Column("axial force\nkN", [carried.axial for *_, carried in walls], ".2f", TO_KILO),
        Column("shear force\nkN", [carried.shear for *_, carried in walls], ".2f", TO_KILO),
        Column("moment\nkN m", [carried.moment for *_, carried in walls], ".2f", TO_KILO),
    )
    largest = [f"{name}: {_largest(results.case, stress)}" for name, stress in shells.items()]
    means = (
        "Means over the row of elements at x, at a mesh line of that towards the tip. Axial forces "
        "pull; shear forces act on the part before the section, along each wall, upwards where it "
        "is steep and else towards larger y; moments about the section's y-axis pull at the top."
    )
    title = "What the walls carry at the instant of the largest stress"
    return [Table(title, columns, (*largest, means), "walls")]


def _largest(case: Case, stress: StressSummary) -> str:
    """What is judged, the mean over a patch, before what tells the instant alone."""
    triangle = (
        f"single triangle, beside a line of contact the more the finer the mesh: "
        f"{number(TO_MEGA * stress.von_mises, 3)} MPa{_of_yield(case, stress)} at "
        f"x = {stress.x:.2f} m in {stress.segment!r}, {stress.face} face of the wall "
        f"{stress.wall!r}, at {stress.time:.3f} s, the instant of this table."
    )
    if (patch := stress.patch) is None:
        return f"largest von Mises stress of a {triangle}"
    return (
        "largest von Mises stress over a patch of half a wall, which settles as the mesh refines: "
        f"{number(TO_MEGA * patch.von_mises, 3)} MPa{_of_yield(case, patch)} near "
        f"x = {patch.x:.2f} m in {patch.segment!r}, at {patch.time:.3f} s; of a {triangle}"
    )


def _of_yield(case: Case, stress: StressSummary | LargestPatch) -> str:
    """What part of the yield strength it is, where the case tells that."""
    names = [segment.name for segment in case.segments]
    strength = material_of(case, names.index(stress.segment)).yield_strength
    if strength is None:
        return ""
    return f" ({number(TO_PERCENT * stress.von_mises / strength, 3)} % of the yield strength)"
