# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of a run, as PNG."""

from __future__ import annotations

import json
import pickle
import shutil
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, Executor
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

import matplotlib

from protractile.runs.folder.files import write_atomically
from protractile.runs.folder.versions import program
from protractile.runs.pipeline.results import CASE, ENSEMBLES, TRAJECTORIES, Results
from protractile.runs.pipeline.summary import Snapshots
from protractile.runs.report import boom_drawing, force_figures, motion_figures, rest_figures, theme
from protractile.runs.report.figure_context import Figure, FigureContext

FOLDER = "figures"
FIGURE_DIGEST = ".drawn-of"

# A function that draws some figures of a run.
Draw = Callable[[FigureContext], list[Figure]]

FIGURES: Sequence[Draw] = (
    boom_drawing.boom,
    motion_figures.tip,
    motion_figures.close_up,
    motion_figures.heads,
    motion_figures.slow_peaks,
    motion_figures.horizons,
    force_figures.first_contacts,
    force_figures.contact_peaks,
    force_figures.friction,
    force_figures.drives,
    force_figures.hoisting,
    force_figures.stress_history,
    rest_figures.at_rest,
    rest_figures.envelopes,
    rest_figures.mode_shapes,
    motion_figures.energies,
    motion_figures.residuals,
)


def draw(results: Results, folder: Path, helper: Executor | None = None) -> list[Figure]:
    """Draw all figures for which a run has data.

    The folder of the PNG files must exist, and existing files are kept. The helper, a second
    process, draws figures from the last one backwards.
    """
    futures = {}
    with suppress(BrokenExecutor):
        if helper is not None:
            # Pickled before drawing, which adds cached values to the results.
            content = pickle.dumps(results)
            for figures in reversed(FIGURES):
                futures[figures] = helper.submit(_draw_in_helper, figures, content, folder)
    finished_figures: list[Figure] = []
    for figures in FIGURES:
        with suppress(BrokenExecutor):
            if figures in futures and not futures[figures].cancel():
                finished_figures += futures[figures].result()
                continue
        finished_figures += _draw_some(figures, results, folder)
    return finished_figures


def _draw_in_helper(figures: Draw, results: bytes, folder: Path) -> list[Figure]:
    return _draw_some(figures, pickle.loads(results), folder)


def _draw_some(figures: Draw, results: Results, folder: Path) -> list[Figure]:
    with matplotlib.rc_context(theme.RC):
        return figures(FigureContext(results, folder))


def draw_in_folder(results: Results, folder: Path, helper: Executor | None = None) -> list[Figure]:
    """Draw the figures in the folder of a run, and remove figures of other data."""
    figures, digest_file = folder / FOLDER, folder / FIGURE_DIGEST
    figure_digest = _figure_digest(results, folder)
    figures.mkdir(exist_ok=True)
    if not digest_file.is_file() or digest_file.read_text(encoding="utf-8") != figure_digest:
        shutil.rmtree(figures)
        figures.mkdir()
    new_figures = draw(results, figures, helper)
    for earlier in set(figures.iterdir()) - {figure.path for figure in new_figures}:
        earlier.unlink()
    write_atomically(digest_file, figure_digest)
    return new_figures


def _figure_digest(results: Results, folder: Path) -> str:
    """Return the SHA-256 of the data of figures and of the program."""
    summary = results.summary.model_copy(update={"snapshots": Snapshots(written=[], skipped=None)})
    digest = sha256(json.dumps([str(summary), program(), matplotlib.__version__]).encode())
    for path in (folder / name for name in (CASE, TRAJECTORIES, ENSEMBLES)):
        digest.update(path.read_bytes() if path.is_file() else b"")
    return digest.hexdigest()
