# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of what the walls of a shell carry."""

from __future__ import annotations

from runs.pipeline.results import Results
from runs.report.tables import TextTable
from runs.report.theme import fixed, number

KILO, MEGA = 1.0e3, 1.0e6


def wall_table(results: Results) -> TextTable | None:
    """Forces of the walls at the instant of the largest stress; None without shells."""
    rows, notes = [], []
    for name, model in results.summary.models.items():
        stress = model.stress
        if stress is None:
            continue
        notes.append(
            f"{name}, at {stress.time:.3f} s: the largest von Mises stress of the run, "
            f"{number(stress.von_mises / MEGA, 3)} MPa, at x = {stress.x:.2f} m in "
            f"{stress.segment!r}, {stress.face} face of the wall {stress.wall!r}."
        )
        for section in stress.walls:
            for wall, forces in section.forces.items():
                of_wall = (forces.axial, forces.shear, forces.moment)
                place = f"{name}, {section.segment}, {section.x:g} m, {wall}"
                rows.append((place, *(fixed(force / KILO, 2) for force in of_wall)))
    if not rows:
        return None
    notes.append(
        "Means over the row of elements at x, at a mesh line of that towards the tip. Axial forces "
        "pull; shear forces act on the part before the section, along z in the webs (right, left) "
        "and along y in the flanges; moments about the section's y-axis pull at the top."
    )
    return TextTable(
        "What the walls carry at the instant of the largest stress",
        ("shell, segment, x, wall", "axial (kN)", "shear (kN)", "moment (kN\N{NO-BREAK SPACE}m)"),
        rows,
        tuple(notes),
        name="walls",
    )
