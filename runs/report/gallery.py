# SPDX-License-Identifier: LGPL-3.0-or-later
"""The pictures of docs/gallery.md, from runs that are there.

``python -m runs.report.gallery`` takes them from the folders ``paper``, ``spatial``,
``three-segments`` and ``convergence`` of runs/out, which ``make verify convergence`` leaves, and
``drawn-out-sweep``, which ``make gallery`` makes, and writes the pictures in docs/gallery.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from matplotlib import rc_context
from PIL import Image

from runs import CASES
from runs.case import reading as case_file
from runs.case.messages import BadInput
from runs.folder.files import whole
from runs.pipeline.results import FIELDS, Results, read_fields
from runs.process.terminal import show_notices
from runs.report.boom_drawing import draw_boom_of
from shell_model.pictures.boom import Instant
from shell_model.pictures.deformation import MovingShell
from shell_model.pictures.opengl import require_opengl
from shell_model.pictures.rendering import TITLES, telling_instants
from shell_model.pictures.still import draw_mesh, draw_sections
from shell_model.pictures.theme import LETTERS

RUNS, GALLERY = Path("runs/out"), Path("docs/gallery")
MODEL = "shell"

# Picture of the gallery → the run that has it, and where.
COPIED = {
    "boom-first-peak": ("paper", "snapshots/boom-first-peak.png"),
    "overlap-largest-force": ("paper", "snapshots/overlap-largest-force.png"),
    "stress-largest-force": ("paper", "snapshots/stress-largest-force.png"),
    "stress-history": ("paper", f"figures/stress-{MODEL}.png"),
    "space-from-the-side": ("spatial", "snapshots/boom-first-peak.png"),
    "space-from-above": ("spatial", "snapshots/boom-above-first-peak.png"),
    "space-overlap": ("spatial", "snapshots/overlap-above-first-peak.png"),
    "three-segments": ("three-segments", "snapshots/boom-first-peak.png"),
    "three-segments-overlap": ("three-segments", "snapshots/overlap-2-first-peak.png"),
    "three-segments-stress": ("three-segments", "snapshots/stress-2-first-peak.png"),
    "drawn-out-swing": ("drawn-out-sweep", "figures/sweep-swing.png"),
    "benchmarks": ("convergence", "figures/benchmarks.png"),
    "meshes": ("convergence", "figures/mesh.png"),
    "solid": ("convergence", "figures/solid-frequencies.png"),
}


def pictures(runs: Path) -> Iterator[tuple[str, Image.Image]]:
    """Names and pictures, one after the other.

    Args:
        runs: the folder of the runs' folders.

    Raises:
        BadInput: a run or one of its pictures is not there.
    """
    for name, (run, picture) in COPIED.items():
        path = runs / run / picture
        if not path.is_file():
            raise BadInput(
                str(path), "file", "missing; run the case with its shell, or make verify"
            )
        yield name, Image.open(path).convert("RGB")
    with TemporaryDirectory() as folder:
        drawing = Path(folder) / "lift.png"
        draw_boom_of(case_file.load(str(CASES / "lift.toml")), drawing)
        yield "lift", Image.open(drawing).convert("RGB")
    results = Results.load(runs / "paper")
    motion = results.trajectories.sel(model=MODEL)
    shell = MovingShell.views(read_fields(runs / "paper" / FIELDS), motion)[0]
    (overlap,) = shell.overlaps
    require_opengl()
    with rc_context(LETTERS):
        yield "mesh", draw_mesh(shell, overlap)
        time = telling_instants(motion)["largest-force"]
        instant = Instant(time, TITLES["largest-force"])
        yield "sections-largest-force", draw_sections(shell, instant, overlap)


def main() -> int:
    """Write the gallery; the exit status."""
    show_notices()
    GALLERY.mkdir(parents=True, exist_ok=True)
    try:
        for name, picture in pictures(RUNS):
            path = GALLERY / f"{name}.png"
            with whole(path) as part:
                # A page loads all of them; no eye sees more colours.
                picture.quantize(256).save(part, format="PNG", optimize=True)
            print(f"{path}  {path.stat().st_size // 1000} kB")
    except BadInput as error:
        print(f"gallery: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
