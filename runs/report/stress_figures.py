# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of the stresses near stations and supports."""

from __future__ import annotations

import numpy as np

from geometry.typography import TO_MEGA
from runs.report.figure_context import Figure, Pen, new_sheet
from runs.report.theme import PALETTE


def stress_history(pen: Pen) -> list[Figure]:
    """Largest von Mises stresses of each shell in each part of the run, place by place."""
    figures = []
    for name in pen.models:
        stress = pen.summary[name].stress
        if stress is None or not stress.history.places:
            continue
        time = np.array(stress.history.time)
        rows = stress.history.places
        places = sorted({row.x for row in rows})
        segments = [segment.name for segment in pen.case.segments]
        sheet, panels = new_sheet(len(places), 1.4 + 1.6 * len(places), share_y=True)
        for axes, x in zip(panels, places, strict=True):
            for row in (row for row in rows if row.x == x):
                color = PALETTE[segments.index(row.segment) % len(PALETTE)]
                for largest, label, width in (
                    (row.von_mises_patch, "over a patch", 1.8),
                    (row.von_mises, "any triangle", 0.8),
                ):
                    axes.plot(
                        time,
                        np.array(largest) * TO_MEGA,
                        color=color,
                        linewidth=width,
                        label=f"{row.segment}, {label}",
                    )
            axes.set(title=f"x = {x:g} m", ylabel="stress (MPa)", xlim=(0.0, pen.time[-1]))
        panels[-1].set(xlabel="time (s)", ylim=(0.0, None))
        fullest = max(panels, key=lambda axes: len(axes.lines))
        patch = max(max(row.von_mises_patch) for row in rows) * TO_MEGA
        title = (
            f"{name}: von Mises stress over a patch up to {patch:.3g} MPa, in a triangle up to "
            f"{stress.von_mises * TO_MEGA:.3g} MPa"
        )
        caption = (
            f"Largest von Mises stress of {name} at either face within {stress.band:g} m of "
            f"each station and support, in every {pen.time[-1] / time.size:.2g} s. Beside a line "
            "of contact the stress of a triangle grows as the mesh refines, and tells where and "
            "when alone; the mean over a patch of half a wall settles."
        )
        figures.append(pen.finish(sheet, fullest, f"stress-{name}", title, caption))
    return figures
