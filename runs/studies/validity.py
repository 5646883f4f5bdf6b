# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where a beam may stand for the shell: a chart over play and load, for each kind of beam.

The paper's boom with friction, which makes motions comparable from moment to moment, its sections
held. One reduced shell serves all points: plays and loads are the laws' and the load's.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import rc_context

from geometry.arrays import Array
from runs.folder.files import whole
from runs.report import theme
from runs.report.figure_context import new_sheet
from runs.report.tables import Cell, Table, wide_console, write
from runs.studies.calibrated_beams import (
    EULER,
    PLAIN,
    SPRUNG,
    WITH_FIELDS,
    Compared,
    Sizes,
    measure,
)
from runs.studies.motions import friction_case

OUT = Path("runs/out/validity")
SIZES = Sizes(
    mesh_size=0.1,
    plays=(0.0, 5.0e-3, 10.0e-3, 15.0e-3, 20.0e-3),
    loads=(1.0, 2.0, 5.0, 10.0),
    coordinates=(),
)
BEAMS = (EULER, PLAIN, SPRUNG, WITH_FIELDS)
# Contours in parts of the tip's range, in percent.
CONTOURS = (1.0, 5.0, 20.0)


def chart(compared: Compared, sizes: Sizes) -> dict[str, Array]:
    """Kind of beam → (num_plays, num_loads) the tip off the shell's, in % of its range."""
    shape = len(sizes.plays), len(sizes.loads)
    return {name: 100.0 * compared.off(name).reshape(shape) for name in BEAMS}


def draw(off: dict[str, Array], sizes: Sizes, path: Path) -> None:
    """A map of each kind of beam with its contours, as PNG."""
    plays, loads = 1.0e3 * np.array(sizes.plays), np.array(sizes.loads)
    with rc_context(theme.RC):
        sheet, panels = new_sheet(len(off), 1.4 + 2.2 * len(off))
        for axes, (name, values) in zip(panels, off.items(), strict=True):
            shade = axes.contourf(
                plays,
                loads,
                np.clip(values.T, 0.0, 100.0),
                levels=[0.0, *CONTOURS, 100.0],
                colors=["#2e7d32", "#a5c882", "#f2c14e", "#b23a2e"],
            )
            if values.min() < CONTOURS[-1] and values.max() > CONTOURS[0]:
                lines = axes.contour(plays, loads, values.T, levels=CONTOURS, colors="black")
                axes.clabel(lines, fmt="%g %%", fontsize=9.0)
            axes.set(title=f"{name}: {values.min():.2g} to {values.max():.2g} %", yscale="log")
            axes.set_yticks(loads, [f"× {load:g}" for load in loads])
            axes.set_ylabel("load")
            axes.label_outer()
        panels[-1].set_xlabel("play (mm)")
        sheet.colorbar(shade, ax=panels, label="tip off the shell's (% of its range)", aspect=40)
        title = f"Where a beam may stand for the shell: the tip over {sizes.duration:g} s"
        sheet.suptitle(title, x=0.02, ha="left", fontsize=12.0, fontweight="bold", wrap=True)
        sheet.savefig(path)


def table(off: dict[str, Array], sizes: Sizes) -> Table:
    """A row of each point, a column of each kind of beam."""
    rows: list[Sequence[Cell]] = [
        (f"{1e3 * play:g}", f"{load:g}", *(float(off[name][i, j]) for name in off))
        for i, play in enumerate(sizes.plays)
        for j, load in enumerate(sizes.loads)
    ]
    return Table.of_rows(
        "validity",
        "The tip off the shell's (% of its range)",
        {"play\nmm": "", "load, over\nthe paper's": "", **dict.fromkeys(off, ".2f")},
        rows,
        (
            f"With the paper's friction, over {sizes.duration:g} s, near webs, shells of "
            f"{sizes.mesh_size:g} m.",
        ),
    )


def main() -> None:
    """Draw the chart of the paper's boom, and print its numbers."""
    off = chart(measure(friction_case(), "near webs", SIZES), SIZES)
    numbers = table(off, SIZES)
    numbers.text.show(wide_console())
    OUT.mkdir(parents=True, exist_ok=True)
    with whole(OUT / "validity.png") as part:
        draw(off, SIZES, part)
    title = "Where a beam may stand for the shell"
    write(OUT, "validity", title, {"validity": numbers.data}, [numbers.text])
    print(f"written to {OUT}")


if __name__ == "__main__":
    main()
